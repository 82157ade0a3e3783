//! A TOML file with the place of every value, and `--set key=value` merged into it.

use crate::diagnose::{CaseError, nearest};
use serde::de::DeserializeOwned;
use std::ops::Range;
use std::path::{Path, PathBuf};
use toml::Spanned;
use toml::de::{DeArray, DeTable, DeValue, Deserializer};

/// A case file, read but not yet given a meaning.
#[derive(Debug, Clone)]
pub struct Document {
    file: PathBuf,
    /// The file's text, then one line for each override, so that every span points into one text.
    text: String,
    /// Where the file's own text ends.
    own: usize,
    overrides: Vec<Override>,
}

/// One `--set`: where its key and its value stand in the joined text.
#[derive(Debug, Clone)]
struct Override {
    key: Range<usize>,
    value: Range<usize>,
}

impl Document {
    /// Reads a file and merges overrides of the form `flow.mach=0.678`.
    ///
    /// # Errors
    /// A file that can't be read, text that is no TOML, an override that is no `key=value` or goes through a value.
    pub fn read(file: &Path, overrides: &[String]) -> Result<Self, CaseError> {
        let text = std::fs::read_to_string(file).map_err(|e| {
            let help = match e.kind() {
                std::io::ErrorKind::NotFound => "check the path: paths inside a file are relative to that file",
                std::io::ErrorKind::InvalidData => "a case file is TOML in UTF-8",
                _ => "check that the file can be read",
            };
            CaseError::new(
                format!("{}: cannot read the file: {e}", file.display()),
                Some(help.to_owned()),
            )
        })?;
        Self::parse(file, text, overrides)
    }

    /// As [`Document::read`], for text already in memory.
    ///
    /// # Errors
    /// As [`Document::read`].
    pub fn parse(file: &Path, text: String, overrides: &[String]) -> Result<Self, CaseError> {
        let own = text.len();
        let mut document = Self {
            file: file.to_path_buf(),
            text,
            own,
            overrides: Vec::new(),
        };
        for setting in overrides {
            document.append(setting)?;
        }
        document.root()?;
        Ok(document)
    }

    /// Writes one override behind the text.
    fn append(&mut self, setting: &str) -> Result<(), CaseError> {
        let usage = || Some("write --set table.key=value, as in --set flow.mach=0.678".to_owned());
        let Some((key, value)) = setting.split_once('=') else {
            return Err(CaseError::new(format!("--set {setting}: no `=` in it"), usage()));
        };
        let (key, value) = (key.trim(), value.trim());
        if key.is_empty() || key.split('.').any(str::is_empty) {
            return Err(CaseError::new(format!("--set {setting}: the key is empty"), usage()));
        }
        // A value that is no TOML is a string without its quotes: --set flow.speed="289 m/s" loses them to the shell.
        let literal = match DeValue::parse(value) {
            Ok(_) if !value.is_empty() => value.to_owned(),
            _ => toml::Value::String(value.to_owned()).to_string(),
        };
        self.text.push_str("\n# --set\n");
        let start = self.text.len();
        self.text.push_str(key);
        self.text.push('=');
        let middle = self.text.len();
        self.text.push_str(&literal);
        self.overrides.push(Override {
            key: start..middle - 1,
            value: middle..self.text.len(),
        });
        Ok(())
    }

    /// The table with its overrides; spans point into the joined text.
    fn root(&self) -> Result<Spanned<DeTable<'_>>, CaseError> {
        let mut root = DeTable::parse(&self.text[..self.own]).map_err(|e| {
            let message = e.message().lines().next().unwrap_or("not TOML").to_owned();
            let span = e.span().unwrap_or(0..0);
            CaseError::at(
                &self.file,
                &self.text,
                span,
                message,
                Some("the file must be TOML 1.0".into()),
            )
        })?;
        for setting in &self.overrides {
            let wrong = |message: String| {
                let help = "write --set table.key=value, as in --set flow.mach=0.678".to_owned();
                CaseError::at(
                    &self.label(&setting.key),
                    &self.text,
                    setting.key.clone(),
                    message,
                    Some(help),
                )
            };
            let key = &self.text[setting.key.clone()];
            let value = DeValue::parse(&self.text[setting.value.clone()])
                .map_err(|e| wrong(format!("--set {key}: {}", e.message())))?;
            let parts: Vec<&str> = key.split('.').collect();
            if !put(root.get_mut(), &parts, shift(value, setting.value.start), &setting.key) {
                return Err(wrong(format!(
                    "--set {key}: it goes through something that is not a table"
                )));
            }
        }
        Ok(root)
    }

    /// The path it was read from.
    pub fn file(&self) -> &Path {
        &self.file
    }

    /// The text it was read from, overrides as lines behind it.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// A path that the file names, relative to the folder of the file.
    pub fn path(&self, named: &Path) -> PathBuf {
        self.file.parent().unwrap_or(Path::new(".")).join(named)
    }

    /// True where the file has a table or value at `key` (`"modes.file"`).
    pub fn has(&self, key: &str) -> bool {
        self.lookup(key).is_some()
    }

    /// Gives the file its meaning.
    ///
    /// # Errors
    /// Unknown and missing keys, values of the wrong kind; with the line and the nearest known key.
    pub fn load<T: DeserializeOwned>(&self) -> Result<T, CaseError> {
        T::deserialize(Deserializer::from(self.root()?)).map_err(|e| self.explain(&e))
    }

    /// An error at the value of `key` (dotted, with indices: `"lattice.mach.2"`), or at the nearest table above it.
    pub fn error(&self, key: &str, message: impl Into<String>, help: impl Into<String>) -> CaseError {
        let mut path = key;
        let span = loop {
            match self.lookup(path) {
                Some(span) => break span,
                None => match path.rsplit_once('.') {
                    Some((above, _)) => path = above,
                    None => break 0..0,
                },
            }
        };
        CaseError::at(&self.label(&span), &self.text, span, message, Some(help.into()))
    }

    fn lookup(&self, key: &str) -> Option<Range<usize>> {
        let root = self.root().ok()?;
        let mut span = root.span();
        let mut value: Option<&DeValue<'_>> = None;
        for part in key.split('.') {
            let next = match value {
                None => root.get_ref().get(part)?,
                Some(DeValue::Table(table)) => table.get(part)?,
                Some(DeValue::Array(array)) => array.get(part.parse::<usize>().ok()?)?,
                Some(_) => return None,
            };
            span = next.span();
            value = Some(next.get_ref());
        }
        Some(span)
    }

    /// The file's name, or that name with "--set" where the span lies in an override.
    fn label(&self, span: &Range<usize>) -> PathBuf {
        if span.start > self.own {
            PathBuf::from(format!("{} --set", self.file.display()))
        } else {
            self.file.clone()
        }
    }

    fn explain(&self, error: &toml::de::Error) -> CaseError {
        let span = error.span().unwrap_or(0..0);
        let raw = error.message();
        let quoted: Vec<&str> = raw.split('`').skip(1).step_by(2).collect();
        let (message, help) = if raw.starts_with("unknown field") || raw.starts_with("unknown variant") {
            let what = if raw.starts_with("unknown field") {
                "key"
            } else {
                "value"
            };
            let (got, known) = quoted.split_first().map_or(("", &[][..]), |(g, k)| (*g, k));
            let list = known.join(", ");
            let help = match nearest(got, known.iter().copied()) {
                Some(near) => format!("did you mean `{near}`? Known here: {list}"),
                None if known.is_empty() => "no keys are known here".to_owned(),
                None => format!("known here: {list}"),
            };
            (format!("unknown {what} `{got}`"), help)
        } else if raw.starts_with("missing field") {
            let key = quoted.first().copied().unwrap_or("");
            (
                format!("missing key `{key}`"),
                format!("add `{key} = ...` to this table"),
            )
        } else {
            (
                raw.lines().next().unwrap_or(raw).to_owned(),
                "see docs/case-files.md for this key".to_owned(),
            )
        };
        CaseError::at(&self.label(&span), &self.text, span, message, Some(help))
    }
}

/// Puts `value` at `parts` below `table`; false where a part is a plain value or an index out of range.
fn put<'a>(table: &mut DeTable<'a>, parts: &[&str], value: Spanned<DeValue<'a>>, at: &Range<usize>) -> bool {
    let Some((first, rest)) = parts.split_first() else {
        return false;
    };
    if rest.is_empty() {
        table.insert(Spanned::new(at.clone(), (*first).to_owned().into()), value);
        return true;
    }
    if table.get(*first).is_none() {
        let empty = Spanned::new(at.clone(), DeValue::Table(DeTable::new()));
        table.insert(Spanned::new(at.clone(), (*first).to_owned().into()), empty);
    }
    match table.get_mut(*first).map(Spanned::get_mut) {
        Some(DeValue::Table(inner)) => put(inner, rest, value, at),
        Some(DeValue::Array(array)) => put_in_array(array, rest, value, at),
        _ => false,
    }
}

fn put_in_array<'a>(array: &mut DeArray<'a>, parts: &[&str], value: Spanned<DeValue<'a>>, at: &Range<usize>) -> bool {
    let Some((first, rest)) = parts.split_first() else {
        return false;
    };
    let Some(slot) = first.parse::<usize>().ok().and_then(|i| array.get_mut(i)) else {
        return false;
    };
    if rest.is_empty() {
        *slot = value;
        return true;
    }
    match slot.get_mut() {
        DeValue::Table(inner) => put(inner, rest, value, at),
        DeValue::Array(inner) => put_in_array(inner, rest, value, at),
        _ => false,
    }
}

/// The same value with every span moved by `offset`.
fn shift(value: Spanned<DeValue<'_>>, offset: usize) -> Spanned<DeValue<'_>> {
    let move_by = |span: Range<usize>| span.start + offset..span.end + offset;
    let span = move_by(value.span());
    let inner = match value.into_inner() {
        DeValue::Table(table) => {
            let mut out = DeTable::new();
            for (key, item) in table {
                out.insert(Spanned::new(move_by(key.span()), key.into_inner()), shift(item, offset));
            }
            DeValue::Table(out)
        }
        DeValue::Array(array) => {
            let mut out = DeArray::new();
            for item in array {
                out.push(shift(item, offset));
            }
            DeValue::Array(out)
        }
        other => other,
    };
    Spanned::new(span, inner)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::Speed;

    #[derive(Debug, serde::Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Flow {
        mach: f64,
        speed: Option<Speed>,
    }

    #[derive(Debug, serde::Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Case {
        flow: Flow,
    }

    fn document(text: &str, overrides: &[&str]) -> Result<Document, CaseError> {
        let overrides: Vec<String> = overrides.iter().map(|s| (*s).to_owned()).collect();
        Document::parse(Path::new("case.toml"), text.to_owned(), &overrides)
    }

    #[test]
    fn override_replaces_and_adds() {
        let case: Case = document("[flow]\nmach = 0.5\n", &["flow.mach=0.678", "flow.speed=100 ft/s"])
            .unwrap()
            .load()
            .unwrap();
        assert_eq!(case.flow.mach, 0.678);
        assert!((case.flow.speed.unwrap().0 - 30.48).abs() < 1e-12);
    }

    #[test]
    fn errors_name_the_line_and_the_nearest_key() {
        let error = document("[flow]\nmach = 0.5\nsped = 3\n", &[])
            .unwrap()
            .load::<Case>()
            .unwrap_err();
        assert_eq!(error.line(), Some(3));
        assert!(error.to_string().contains("sped"), "{error}");
        assert!(error.help_text().unwrap().contains("`speed`"), "{error:?}");
        let error = document("[flow]\nmach = 0.5\nspeed = \"3\"\n", &[])
            .unwrap()
            .load::<Case>()
            .unwrap_err();
        assert_eq!(error.line(), Some(3));
        assert!(error.message().contains("missing unit"), "{error}");
    }

    #[test]
    fn errors_in_overrides_say_so() {
        let error = document("[flow]\nmach = 0.5\n", &["flow.speed=3 kg"])
            .unwrap()
            .load::<Case>()
            .unwrap_err();
        assert!(error.to_string().starts_with("case.toml --set"), "{error}");
        assert!(document("[flow]\nmach = 0.5\n", &["flow.mach"]).is_err());
        assert!(document("[flow]\nmach = 0.5\n", &["flow.mach.x=1"]).is_err());
    }

    #[test]
    fn error_points_at_list_items() {
        let document = document("[lattice]\nmach = [0.5,\n 1.2]\n", &[]).unwrap();
        assert_eq!(document.error("lattice.mach.1", "too fast", "").line(), Some(3));
    }
}
