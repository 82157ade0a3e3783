//! The deck's lines with their files: comments off, tabs out, INCLUDE statements followed.

use std::{
    fs,
    path::{Path, PathBuf},
    sync::Arc,
};

use crate::error::{DeckError, Location};

/// A line of the deck that holds something: without its comment, tabs expanded, trailing blanks off.
#[derive(Debug, Clone)]
pub struct Line {
    /// Where it stands.
    pub at: Location,
    /// Its text.
    pub text: String,
}

/// INCLUDE statements nest no deeper than this; a deeper nest is a mistake.
const DEEPEST: usize = 32;

/// Reads a file and all that it includes.
///
/// # Errors
/// A file that cannot be read, an INCLUDE without an end or that includes itself.
pub fn lines_of_file(path: &Path) -> Result<Vec<Line>, DeckError> {
    let name = path.display().to_string();
    let text = read(path).map_err(|error| DeckError::Read {
        at: None,
        path: name.clone(),
        reason: error.to_string(),
    })?;
    let mut lines = Vec::new();
    let folder = path.parent().unwrap_or(Path::new(".")).to_owned();
    let mut open = vec![canonical(path)];
    include(&text, &Arc::from(name), &folder, &folder, &mut open, &mut lines)?;
    Ok(lines)
}

/// Splits a deck that is already in memory. INCLUDE statements are followed relative to `folder`.
///
/// # Errors
/// As [`lines_of_file`].
pub fn lines_of_text(text: &str, name: &str, folder: &Path) -> Result<Vec<Line>, DeckError> {
    let mut lines = Vec::new();
    include(text, &Arc::from(name), folder, folder, &mut Vec::new(), &mut lines)?;
    Ok(lines)
}

/// Decks come in any 8-bit encoding; what is not UTF-8 can only stand in a comment or a title.
fn read(path: &Path) -> std::io::Result<String> {
    let bytes = fs::read(path)?;
    Ok(match String::from_utf8(bytes) {
        Ok(text) => text,
        Err(error) => error.into_bytes().iter().map(|b| char::from(*b)).collect(),
    })
}

fn canonical(path: &Path) -> PathBuf {
    fs::canonicalize(path).unwrap_or_else(|_| path.to_owned())
}

fn include(
    text: &str,
    file: &Arc<str>,
    folder: &Path,
    top: &Path,
    open: &mut Vec<PathBuf>,
    out: &mut Vec<Line>,
) -> Result<(), DeckError> {
    let mut numbered = text.lines().enumerate();
    while let Some((i, raw)) = numbered.next() {
        let at = Location::new(file, i + 1);
        let line = clean(raw);
        if line.is_empty() {
            continue;
        }
        let Some(rest) = include_operand(&line) else {
            out.push(Line { at, text: line });
            continue;
        };
        let mut name = rest.to_owned();
        while !complete(&name) {
            let Some((_, more)) = numbered.next() else {
                return Err(DeckError::Include {
                    at,
                    what: format!("the quote in {name} is never closed"),
                });
            };
            name.push_str(more.trim());
        }
        let name = unquote(&name);
        if name.is_empty() {
            return Err(DeckError::Include {
                at,
                what: "needed the name of a file, got nothing".to_owned(),
            });
        }
        let path = locate(&name, folder, top, &at)?;
        let real = canonical(&path);
        if open.contains(&real) {
            return Err(DeckError::Include {
                at,
                what: format!("{name} includes itself, directly or through another file; break the circle"),
            });
        }
        if open.len() >= DEEPEST {
            return Err(DeckError::Include {
                at,
                what: format!("more than {DEEPEST} files deep; includes nest no deeper than that"),
            });
        }
        let text = read(&path).map_err(|error| DeckError::Read {
            at: Some(at),
            path: path.display().to_string(),
            reason: error.to_string(),
        })?;
        let below = path.parent().unwrap_or(folder).to_owned();
        open.push(real);
        include(&text, &Arc::from(path.display().to_string()), &below, top, open, out)?;
        open.pop();
    }
    Ok(())
}

/// The line without comment and trailing blanks, tabs expanded to the next column of eight.
fn clean(raw: &str) -> String {
    let mut text = String::with_capacity(raw.len());
    let mut quote = None;
    for (i, c) in raw.char_indices() {
        match (c, quote) {
            // A file name may hold a dollar sign, but only inside quotes; a lone apostrophe quotes nothing.
            ('$', Some(q)) if raw[i..].contains(q) => {}
            ('$', _) => break,
            (c, Some(q)) if c == q => quote = None,
            ('\'' | '"', None) => quote = Some(c),
            _ => {}
        }
        if c == '\t' {
            text.push(' ');
            while !text.chars().count().is_multiple_of(8) {
                text.push(' ');
            }
        } else if c.is_control() {
            text.push(' ');
        } else {
            text.push(c);
        }
    }
    text.truncate(text.trim_end().len());
    text
}

/// What follows the word INCLUDE, if the line begins with it.
fn include_operand(line: &str) -> Option<&str> {
    let line = line.trim_start();
    let word = line.get(..7)?;
    if !word.eq_ignore_ascii_case("include") {
        return None;
    }
    let rest = line.get(7..)?;
    rest.starts_with([' ', '\'', '"', '='])
        .then(|| rest.trim_start_matches([' ', '=']))
}

/// A quoted name is complete when its quote has closed; a bare one ends with its line.
fn complete(name: &str) -> bool {
    match name.chars().next() {
        Some(q @ ('\'' | '"')) => name.chars().skip(1).any(|c| c == q),
        _ => true,
    }
}

fn unquote(name: &str) -> String {
    let name = name.trim();
    match name.chars().next() {
        Some(q @ ('\'' | '"')) => name[1..].split(q).next().unwrap_or("").trim().to_owned(),
        _ => name.to_owned(),
    }
}

/// Finds the file of an INCLUDE statement: beside the including file, beside the deck; a logical name in front
/// (`TPLDIR:bahstru.dat`) and letter case are forgiven, because decks travel between systems.
fn locate(name: &str, folder: &Path, top: &Path, at: &Location) -> Result<PathBuf, DeckError> {
    let mut names = vec![name.to_owned()];
    if name.contains('\\') {
        names.push(name.replace('\\', "/"));
    }
    if let Some((_, bare)) = name.split_once(':') {
        names.push(bare.trim_start_matches(['/', '\\']).replace('\\', "/"));
    }
    let mut tried = Vec::new();
    for folder in [folder, top] {
        for name in &names {
            let path = folder.join(name);
            if path.is_file() {
                return Ok(path);
            }
            if let Some(path) = any_case(&path) {
                return Ok(path);
            }
            let path = path.display().to_string();
            if !tried.contains(&path) {
                tried.push(path);
            }
        }
    }
    Err(DeckError::Read {
        at: Some(at.clone()),
        path: name.to_owned(),
        reason: format!("no such file; looked for {}", tried.join(", ")),
    })
}

fn any_case(path: &Path) -> Option<PathBuf> {
    let wanted = path.file_name()?.to_str()?.to_lowercase();
    let folder = path
        .parent()
        .filter(|p| !p.as_os_str().is_empty())
        .unwrap_or(Path::new("."));
    let mut found: Vec<PathBuf> = fs::read_dir(folder)
        .ok()?
        .filter_map(|entry| entry.ok().map(|e| e.path()))
        .filter(|p| {
            p.file_name()
                .and_then(|n| n.to_str())
                .is_some_and(|n| n.to_lowercase() == wanted)
        })
        .collect();
    found.sort();
    found.into_iter().find(|p| p.is_file())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_tabs_and_blank_lines_go() {
        let lines = lines_of_text("$ nothing\nGRID\t1\t\t0.\r\n\n  $\nA $ b\n", "deck", Path::new(".")).unwrap();
        let text: Vec<&str> = lines.iter().map(|l| l.text.as_str()).collect();
        assert_eq!(text, ["GRID    1               0.", "A"]);
        assert_eq!(lines[0].at.line, 2);
        assert_eq!(lines[1].at.to_string(), "deck:5");
    }

    #[test]
    fn an_apostrophe_in_a_comment_or_a_title_hides_no_dollar() {
        let lines = lines_of_text("TITLE = THE WING'S MODES $ comment\n", "deck", Path::new(".")).unwrap();
        assert_eq!(lines[0].text, "TITLE = THE WING'S MODES");
    }
}
