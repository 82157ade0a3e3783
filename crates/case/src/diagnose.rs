//! Errors that point into the user's file: where, what, needed, got, what to do next.

use miette::{Diagnostic, LabeledSpan, NamedSource, SourceCode};
use std::fmt;
use std::path::{Path, PathBuf};

/// What is wrong with a case file, at a place in its text.
#[derive(Debug)]
pub struct CaseError {
    message: String,
    help: Option<String>,
    /// Boxed, so that a `Result` stays small.
    place: Option<Box<Place>>,
}

#[derive(Debug)]
struct Place {
    source: NamedSource<String>,
    file: PathBuf,
    line: usize,
    column: usize,
    span: std::ops::Range<usize>,
}

impl CaseError {
    /// An error without a place in a file, such as a file that can't be opened.
    pub fn new(message: impl Into<String>, help: Option<String>) -> Self {
        Self {
            message: message.into(),
            help,
            place: None,
        }
    }

    /// An error at bytes `span` of `text`, the content of `file`.
    pub fn at(
        file: &Path,
        text: &str,
        span: std::ops::Range<usize>,
        message: impl Into<String>,
        help: Option<String>,
    ) -> Self {
        let start = (0..=span.start.min(text.len()))
            .rev()
            .find(|&i| text.is_char_boundary(i))
            .unwrap_or(0);
        let end = (start..=span.end.clamp(start, text.len()))
            .rev()
            .find(|&i| text.is_char_boundary(i))
            .unwrap_or(start);
        let line = text[..start].matches('\n').count() + 1;
        let column = text[..start].rsplit('\n').next().map_or(1, |l| l.chars().count() + 1);
        let source = NamedSource::new(file.display().to_string(), text.to_owned());
        let place = Place {
            source,
            file: file.to_path_buf(),
            line,
            column,
            span: start..end,
        };
        Self {
            message: message.into(),
            help,
            place: Some(Box::new(place)),
        }
    }

    /// What is wrong, without the place.
    pub fn message(&self) -> &str {
        &self.message
    }

    /// What to do next.
    pub fn help_text(&self) -> Option<&str> {
        self.help.as_deref()
    }

    /// Line of the error, from one.
    pub fn line(&self) -> Option<usize> {
        self.place.as_ref().map(|p| p.line)
    }
}

impl fmt::Display for CaseError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.place {
            Some(p) => write!(f, "{}:{}:{}: {}", p.file.display(), p.line, p.column, self.message),
            None => f.write_str(&self.message),
        }
    }
}

impl std::error::Error for CaseError {}

impl Diagnostic for CaseError {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.help.as_ref().map(|h| Box::new(h) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.place.as_ref().map(|p| &p.source as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let place = self.place.as_ref()?;
        let label = LabeledSpan::new_with_span(Some("here".to_owned()), place.span.clone());
        Some(Box::new(std::iter::once(label)))
    }
}

/// The word of `known` nearest to `word`, if one is near enough to be a slip of the pen.
pub fn nearest<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let fold = |w: &str| w.to_lowercase().replace(['-', ' '], "_");
    let word = fold(word);
    known
        .into_iter()
        .map(|k| (edit_distance(&word, &fold(k)), k))
        .filter(|(distance, k)| *distance <= (k.chars().count().max(word.chars().count())) / 3 + 1)
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, k)| k)
}

/// Damerau-Levenshtein distance (optimal string alignment): insertions, deletions, substitutions, swaps of neighbours.
fn edit_distance(a: &str, b: &str) -> usize {
    let a: Vec<char> = a.chars().collect();
    let b: Vec<char> = b.chars().collect();
    let mut rows = vec![vec![0_usize; b.len() + 1]; a.len() + 1];
    for (i, row) in rows.iter_mut().enumerate() {
        row[0] = i;
    }
    for (j, cell) in rows[0].iter_mut().enumerate() {
        *cell = j;
    }
    for i in 1..=a.len() {
        for j in 1..=b.len() {
            let change = usize::from(a[i - 1] != b[j - 1]);
            let mut best = (rows[i - 1][j] + 1)
                .min(rows[i][j - 1] + 1)
                .min(rows[i - 1][j - 1] + change);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                best = best.min(rows[i - 2][j - 2] + 1);
            }
            rows[i][j] = best;
        }
    }
    rows[a.len()][b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearest_finds_slips_only() {
        let known = ["chordwise", "spanwise", "kernel"];
        assert_eq!(nearest("chordwize", known), Some("chordwise"));
        assert_eq!(nearest("kernle", known), Some("kernel"));
        assert_eq!(nearest("temperature", known), None);
    }

    #[test]
    fn place_survives_any_span() {
        let text = "a = \"é\"\nb = 2\n";
        for start in 0..30 {
            let error = CaseError::at(Path::new("x.toml"), text, start..start + 3, "wrong", None);
            assert!(error.line().unwrap() <= 3, "{error}");
        }
    }
}
