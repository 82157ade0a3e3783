//! Decks with a wrong field: solved or refused, never a panic, and nothing printed that is not a number.

use std::path::Path;

use dip_deck::solve;
use dip_nastran::Deck;
use proptest::prelude::*;

const DECKS: [&str; 4] = [
    "section_strip.bdf",
    "swept_plate.bdf",
    "jet_wing_genel.bdf",
    "jet_wing_bars.bdf",
];
const FIELDS: [&str; 16] = [
    "", "0", "-1", "1", "2", "3", "7", "24", "1.", "-2.5", "0.", "1.+20", "1.-20", "THRU", "X", "123456",
];

fn text(name: &str) -> String {
    std::fs::read_to_string(
        Path::new(env!("CARGO_MANIFEST_DIR"))
            .join("../../tests/data/nastran")
            .join(name),
    )
    .unwrap()
}

/// The deck with one small field of one bulk data line replaced.
fn changed(text: &str, line: usize, field: usize, by: &str) -> String {
    let begin = text.lines().position(|l| l.starts_with("BEGIN")).unwrap() + 1;
    let count = text.lines().count() - begin - 1;
    let mut out = String::new();
    for (i, l) in text.lines().enumerate() {
        if i == begin + line % count && !l.contains('*') {
            let padded = format!("{l:<72}");
            let from = 8 * (1 + field % 8);
            out += &format!("{}{by:<8}{}\n", &padded[..from], &padded[from + 8..]);
        } else {
            out += &format!("{l}\n");
        }
    }
    out
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(250))]

    #[test]
    fn a_wrong_field_is_solved_or_refused(deck in 0usize..4, line in 0usize..500, field in 0usize..8, by in 0usize..FIELDS.len()) {
        let text = changed(&text(DECKS[deck]), line, field, FIELDS[by]);
        if let Ok(deck) = Deck::parse(&text, "deck", ".")
            && let Ok(solution) = solve(&deck)
        {
            for row in solution.subcases.iter().flat_map(|s| &s.summaries).flat_map(|s| &s.points).flat_map(|p| &p.rows) {
                prop_assert!(row.velocity.is_finite() && row.damping.is_finite() && row.freq_hz.is_finite(), "{row:?}");
            }
            let _ = solution.text();
        }
    }
}

#[test]
fn an_empty_deck_says_what_is_missing() {
    let error = solve(&Deck::parse("SOL 145\nCEND\nBEGIN BULK\nENDDATA\n", "deck", ".").unwrap()).unwrap_err();
    assert!(error.to_string().contains("FMETHOD"), "{error}");
}
