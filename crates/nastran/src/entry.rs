//! Bulk data entries: physical lines in small, large and free field put together with their continuations.
//!
//! A continuation is found by its marker when it has one (the first character, `+` or `*`, does not count) and otherwise
//! by standing below its parent. Markers may be in any order in the deck.

use std::collections::{HashMap, HashSet};

use crate::{
    error::{DeckError, Location},
    source::Line,
};

/// One bulk data entry.
#[derive(Debug, Clone)]
pub struct Entry {
    /// Upper-case name without the `*` of a large field entry.
    pub name: String,
    /// Where its first line stands.
    pub at: Location,
    /// Data fields, trimmed and upper-case, eight a line (the line's fields 2 to 9); missing trailing fields are absent.
    pub fields: Vec<String>,
    /// The line of each group of eight fields.
    pub lines: Vec<Location>,
}

/// One physical line.
struct Piece {
    at: Location,
    /// None on a continuation.
    name: Option<String>,
    /// The marker of field 1 on a continuation, without its first character.
    marker_in: String,
    /// Field 10 without its first character.
    marker_out: String,
    /// Four fields in large format, eight otherwise.
    fields: Vec<String>,
    large: bool,
}

/// Puts the lines of the bulk data section together.
///
/// # Errors
/// Lines that are no entry, replication, too many fields, continuations without parent; all of them.
pub fn entries(lines: &[Line]) -> Result<Vec<Entry>, Vec<DeckError>> {
    let mut errors = Vec::new();
    let mut pieces = Vec::new();
    for line in lines {
        match split(line) {
            Ok(found) => pieces.extend(found),
            Err(error) => errors.push(error),
        }
    }
    let chains = chain(&pieces, &mut errors);
    let entries = chains.into_iter().map(|chain| assemble(&pieces, &chain)).collect();
    if errors.is_empty() { Ok(entries) } else { Err(errors) }
}

/// Cuts a line into its fields; a free-field line of more than ten fields is cut into several pieces.
fn split(line: &Line) -> Result<Vec<Piece>, DeckError> {
    let text = &line.text;
    let card_error = |what: String| DeckError::Card {
        at: line.at.clone(),
        card: first_word(text),
        what,
    };
    let free = text.chars().take(72).any(|c| c == ',');
    let raw: Vec<String> = if free {
        text.split(',').map(|f| f.trim().to_uppercase()).collect()
    } else {
        fixed(text)
    };
    let first = raw.first().cloned().unwrap_or_default();
    if first.starts_with('=') || raw.iter().skip(1).any(|f| f == "=" || f == "==" || f.starts_with("*(")) {
        return Err(card_error(
            "replication (=, ==, *(n)) is not supported; write the generated lines out".to_owned(),
        ));
    }
    if first.starts_with('/') {
        return Err(card_error(
            "deleting lines of an earlier run (/) is not supported; edit the deck itself".to_owned(),
        ));
    }
    let is_continuation = first.is_empty() || first.starts_with(['+', '*']);
    let large = if is_continuation {
        first.starts_with('*')
    } else {
        first.ends_with('*')
    };
    let name = (!is_continuation).then(|| first.trim_end_matches('*').trim().to_owned());
    if let Some(name) = &name
        && (name.is_empty() || name.len() > 8 || !name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_'))
    {
        return Err(card_error(format!(
            "\"{name}\" cannot be the name of a bulk data entry"
        )));
    }
    let width = if large { 4 } else { 8 };
    let marker_in = marker(&first);
    let mut data: Vec<String> = raw.into_iter().skip(1).collect();
    if !free {
        let marker_out = if data.len() > width {
            marker(&data[width])
        } else {
            String::new()
        };
        data.truncate(width);
        return Ok(vec![Piece {
            at: line.at.clone(),
            name,
            marker_in,
            marker_out,
            fields: data,
            large,
        }]);
    }
    // Free field: the marker may stand right behind the last value, and a long line goes on as if cut after field 10.
    let mut pieces = Vec::new();
    let mut name = name;
    let mut marker_in = marker_in;
    loop {
        let mut fields: Vec<String> = data.drain(..data.len().min(width)).collect();
        let mut marker_out = String::new();
        if let Some(ten) = (!data.is_empty()).then(|| data.remove(0)) {
            if !ten.is_empty() && !ten.starts_with(['+', '*']) && !data.is_empty() {
                return Err(card_error(format!(
                    "more than ten fields on a free-field line, and field 10 (\"{ten}\") is no continuation marker; \
                     break the line after field 9"
                )));
            }
            marker_out = marker(&ten);
        } else if fields
            .last()
            .is_some_and(|f| f.starts_with(['+', '*']) && crate::number::number(f).is_none())
        {
            marker_out = marker(&fields.pop().unwrap_or_default());
        }
        let more = !data.is_empty();
        pieces.push(Piece {
            at: line.at.clone(),
            name: name.take(),
            marker_in: std::mem::take(&mut marker_in),
            marker_out: if more { String::new() } else { marker_out },
            fields,
            large,
        });
        if !more {
            return Ok(pieces);
        }
    }
}

/// Fields of a fixed-field line: name, then four of sixteen columns or eight of eight, then field 10.
fn fixed(text: &str) -> Vec<String> {
    let chars: Vec<char> = text.chars().take(80).collect();
    let column = |from: usize, to: usize| -> String {
        let to = to.min(chars.len());
        if from >= to {
            return String::new();
        }
        chars[from..to].iter().collect::<String>().trim().to_uppercase()
    };
    let first = column(0, 8);
    let width = if first.starts_with('*') || (first.ends_with('*') && !first.starts_with('+')) {
        16
    } else {
        8
    };
    let mut fields = vec![first];
    let mut from = 8;
    while from < 72 {
        fields.push(column(from, from + width));
        from += width;
    }
    fields.push(column(72, 80));
    fields
}

fn first_word(text: &str) -> String {
    text.split([' ', ',']).next().unwrap_or("").to_uppercase()
}

/// Nastran compares markers from their second character on.
fn marker(field: &str) -> String {
    field.chars().skip(1).collect::<String>().trim().to_owned()
}

/// Finds the continuations of every parent; each chain lists indices into `pieces`, the parent first.
fn chain(pieces: &[Piece], errors: &mut Vec<DeckError>) -> Vec<Vec<usize>> {
    let asked: HashSet<&str> = pieces
        .iter()
        .map(|p| p.marker_out.as_str())
        .filter(|m| !m.is_empty())
        .collect();
    let mut taken = vec![false; pieces.len()];
    let mut chains: Vec<Vec<usize>> = Vec::new();
    // First those that stand below their parent.
    let adjacent = |last: usize, taken: &[bool]| -> Option<usize> {
        let index = last + 1;
        let next = pieces.get(index)?;
        if next.name.is_some() || taken[index] {
            return None;
        }
        let out = pieces[last].marker_out.as_str();
        let matches = next.marker_in.is_empty()
            || next.marker_in == out
            || (out.is_empty() && !asked.contains(next.marker_in.as_str()));
        matches.then_some(index)
    };
    for (start, _) in pieces.iter().enumerate().filter(|(_, p)| p.name.is_some()) {
        let mut chain = vec![start];
        let mut last = start;
        while let Some(next) = adjacent(last, &taken) {
            taken[next] = true;
            chain.push(next);
            last = next;
        }
        chains.push(chain);
    }
    // Then those that stand elsewhere, by marker, in the order of the deck.
    let mut loose: HashMap<&str, Vec<usize>> = HashMap::new();
    for (i, piece) in pieces.iter().enumerate().rev() {
        if piece.name.is_none() && !taken[i] {
            loose.entry(piece.marker_in.as_str()).or_default().push(i);
        }
    }
    for chain in &mut chains {
        loop {
            let last = chain[chain.len() - 1];
            let out = pieces[last].marker_out.as_str();
            if out.is_empty() {
                break;
            }
            let Some(next) = loose.get_mut(out).and_then(|found| {
                // Lines that another loose line has already drawn along are passed over.
                while let Some(i) = found.pop() {
                    if !taken[i] {
                        return Some(i);
                    }
                }
                None
            }) else {
                break;
            };
            taken[next] = true;
            chain.push(next);
            let mut last = next;
            while let Some(next) = adjacent(last, &taken) {
                taken[next] = true;
                chain.push(next);
                last = next;
            }
        }
    }
    for (i, piece) in pieces.iter().enumerate() {
        if piece.name.is_none() && !taken[i] {
            errors.push(DeckError::Card {
                at: piece.at.clone(),
                card: "continuation".to_owned(),
                what: format!(
                    "no entry ends with the marker \"{}\"; put the line below its entry or make the markers alike",
                    piece.marker_in
                ),
            });
        }
    }
    chains
}

/// Joins the pieces of an entry; the two halves of a large field line make one group of eight.
fn assemble(pieces: &[Piece], chain: &[usize]) -> Entry {
    let parent = &pieces[chain[0]];
    let mut fields: Vec<String> = Vec::new();
    let mut lines: Vec<Location> = Vec::new();
    let mut half = false;
    for &i in chain {
        let piece = &pieces[i];
        let width = if piece.large { 4 } else { 8 };
        // A small-field line after the first half of a large-field pair starts a new group.
        if half && !piece.large {
            fields.resize(fields.len() + 4, String::new());
            half = false;
        }
        if !half {
            lines.push(piece.at.clone());
        }
        let start = fields.len();
        fields.extend(piece.fields.iter().take(width).cloned());
        fields.resize(start + width, String::new());
        half = piece.large && !half;
    }
    while fields.last().is_some_and(String::is_empty) {
        fields.pop();
    }
    Entry {
        name: parent.name.clone().unwrap_or_default(),
        at: parent.at.clone(),
        fields,
        lines,
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::source::lines_of_text;

    fn read(text: &str) -> Result<Vec<Entry>, Vec<DeckError>> {
        entries(&lines_of_text(text, "deck", Path::new(".")).unwrap())
    }

    #[test]
    fn all_formats_give_the_same_fields() {
        let small =
            "CORD2R  1               .0      .0      .0      .0      .0      1.      +C1\n+C1     .96593  -.25882 .0\n";
        let large = "CORD2R* 1                               .0              .0              *A\n\
                     *A      .0              .0              .0              1.\n\
                     *       .96593          -.25882         .0\n";
        let free = "cord2r,1,,.0,.0,.0,.0,.0,1.\n,.96593,-.25882,.0\n";
        let long = "CORD2R,1,,.0,.0,.0,.0,.0,1.,,.96593,-.25882,.0\n";
        let small = read(small).unwrap();
        for other in [large, free, long] {
            assert_eq!(read(other).unwrap()[0].fields, small[0].fields, "{other}");
        }
    }

    #[test]
    fn markers_out_of_order_are_found() {
        let deck = "+B      9.\nSET1    1       1       2       3       4       5       6       7       +A\n\
                    FLFACT  2       1.0     2.      3.      4.      5.      6.      7.      +B\n+A      8\n";
        let entries = read(deck).unwrap();
        assert_eq!(entries[0].fields[8], "8");
        assert_eq!(entries[1].fields[8], "9.");
    }

    #[test]
    fn a_remark_in_field_ten_asks_for_nothing_and_a_lost_line_is_an_error() {
        let entries =
            read("FLFACT  1       0.967                                                   DENS\nPARAM,A,1\n").unwrap();
        assert_eq!(entries.len(), 2);
        let errors = read("GRID,1,,,,,,,,+Y\n+X,3\n").unwrap_err();
        assert_eq!(errors[0].location().unwrap().line, 2);
    }

    #[test]
    fn a_marker_whose_first_character_differs_is_the_same_marker() {
        let entries =
            read("FLFACT  3       .1      .11     .125    .14     .16     .2      .25     KFREQ\n+FREQ   .33     .5\n")
                .unwrap();
        assert_eq!(entries[0].fields.len(), 10);
    }

    #[test]
    fn replication_is_an_error_with_a_hint() {
        for deck in [
            "GRID,1,,0.,0.,0.\n=,*(1),=,=,*(1.)\n",
            "GRID    1\n=       *(1)    ==\n",
        ] {
            let errors = read(deck).unwrap_err();
            assert!(errors[0].to_string().contains("replication"), "{}", errors[0]);
            assert_eq!(errors[0].location().unwrap().line, 2);
        }
    }
}
