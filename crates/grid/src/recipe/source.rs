//! Reads recipes and everything they name, with messages that point at the line.

use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;
use toml::Value;

use super::RecipeError;
use super::file::Recipe;

/// How many recipes may extend one another.
const DEPTH: usize = 8;

pub(super) fn read(path: &Path) -> Result<Recipe, RecipeError> {
    let table = table(path, DEPTH)?;
    let mut recipe: Recipe = Recipe::deserialize_table(table, path)?;
    recipe.path = path.to_owned();
    Ok(recipe)
}

impl Recipe {
    fn deserialize_table(table: toml::Table, path: &Path) -> Result<Self, RecipeError> {
        // Each file was checked on its own: what can go wrong here has no line any more.
        table.try_into().map_err(|e: toml::de::Error| RecipeError::Key {
            path: path.to_owned(),
            message: e.message().to_owned(),
        })
    }
}

/// The keys of the recipe at `path` and of those it extends, with file names made relative to nothing.
fn table(path: &Path, depth: usize) -> Result<toml::Table, RecipeError> {
    let text = text(path)?;
    let checked: Recipe = parse(path, &text)?;
    let mut own: toml::Table = parse(path, &text)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    for group in ["section", "wing"] {
        let file = own
            .get_mut(group)
            .and_then(Value::as_table_mut)
            .and_then(|t| t.get_mut("file"));
        if let Some(Value::String(name)) = file {
            *name = folder.join(&*name).to_string_lossy().into_owned();
        }
    }
    let Some(base) = checked.extends else { return Ok(own) };
    own.remove("extends");
    if depth == 0 {
        let message = format!("extends: more than {DEPTH} recipes deep, or in a circle");
        return Err(RecipeError::Key {
            path: path.to_owned(),
            message,
        });
    }
    let mut merged = table(&folder.join(base), depth - 1)?;
    overlay(&mut merged, own);
    Ok(merged)
}

fn overlay(base: &mut toml::Table, over: toml::Table) {
    // A wall step is a length or a y+: the later word takes the place of the other.
    for (one, other) in [("wall", "y_plus"), ("y_plus", "wall")] {
        if over.contains_key(one) {
            base.remove(other);
        }
    }
    for (key, value) in over {
        match (base.get_mut(&key), value) {
            (Some(Value::Table(old)), Value::Table(new)) => overlay(old, new),
            (_, value) => {
                base.insert(key, value);
            }
        }
    }
}

/// Text of a file.
pub(super) fn text(path: &Path) -> Result<String, RecipeError> {
    std::fs::read_to_string(path).map_err(|source| RecipeError::Read {
        path: PathBuf::from(path),
        source,
    })
}

/// Parses TOML; an error names line and column, and for an unknown key the nearest known one.
pub(super) fn parse<T: DeserializeOwned>(path: &Path, text: &str) -> Result<T, RecipeError> {
    toml::from_str(text).map_err(|error| {
        let start = error.span().map_or(0, |s| s.start).min(text.len());
        let before = &text.as_bytes()[..start];
        let line = before.iter().filter(|&&b| b == b'\n').count() + 1;
        let column = start - before.iter().rposition(|&b| b == b'\n').map_or(0, |n| n + 1) + 1;
        RecipeError::Syntax {
            path: path.to_owned(),
            line,
            column,
            message: with_nearest(error.message()),
        }
    })
}

/// Adds the nearest name to serde's "unknown field `x`, expected one of `a`, `b`".
fn with_nearest(message: &str) -> String {
    let quoted: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
    if !(message.starts_with("unknown field") || message.starts_with("unknown variant")) || quoted.len() < 2 {
        return message.to_owned();
    }
    let what = if message.starts_with("unknown field") {
        "key"
    } else {
        "value"
    };
    let nearest = quoted[1..]
        .iter()
        .min_by_key(|name| edits(name, quoted[0]))
        .unwrap_or(&"");
    format!(
        "unknown {what} `{}`; did you mean `{nearest}`? Known are: {}",
        quoted[0],
        quoted[1..].join(", ")
    )
}

/// Levenshtein distance: insertions, deletions and changes that turn `a` into `b`.
fn edits(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (n, ca) in a.chars().enumerate() {
        let mut diagonal = row[0];
        row[0] = n + 1;
        for (m, &cb) in b.iter().enumerate() {
            let change = diagonal + usize::from(ca != cb);
            diagonal = row[m + 1];
            row[m + 1] = change.min(row[m] + 1).min(row[m + 1] + 1);
        }
    }
    row[b.len()]
}
