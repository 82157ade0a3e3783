//! Text in pictures: how wide it is, and sub- and superscripts.
//!
//! A label may hold `_{...}` (subscript) and `^{...}` (superscript), as in `C_{p}` or `m s^{-1}`. Everything else is
//! taken as it stands, so a plain underscore in `mode_1` stays an underscore.

/// A stretch of text on one level.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Run {
    pub(crate) text: String,
    pub(crate) level: Level,
}

/// Where a run stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Level {
    Base,
    Sub,
    Super,
}

/// Size of sub- and superscripts relative to the text around them.
pub(crate) const SCRIPT_SIZE: f64 = 0.72;

/// Splits a label into runs. An opening without its closing brace is plain text.
pub(crate) fn runs(label: &str) -> Vec<Run> {
    let mut out = Vec::new();
    let mut base = String::new();
    let mut rest = label;
    while let Some(c) = rest.chars().next() {
        let level = match c {
            '_' => Some(Level::Sub),
            '^' => Some(Level::Super),
            _ => None,
        };
        if let Some(level) = level
            && let Some(body) = rest[1..].strip_prefix('{')
            && let Some(end) = body.find('}')
        {
            push(&mut out, &mut base, Level::Base);
            let mut script = body[..end].to_owned();
            push(&mut out, &mut script, level);
            rest = &body[end + 1..];
            continue;
        }
        base.push(c);
        rest = &rest[c.len_utf8()..];
    }
    push(&mut out, &mut base, Level::Base);
    out
}

fn push(out: &mut Vec<Run>, text: &mut String, level: Level) {
    if !text.is_empty() {
        out.push(Run {
            text: std::mem::take(text),
            level,
        });
    }
}

/// The label without markup, for terminals, files and reading aloud: `C_p`, `m s^-1`.
pub(crate) fn plain(label: &str) -> String {
    let mut out = String::new();
    for run in runs(label) {
        match run.level {
            Level::Base => {}
            Level::Sub => out.push('_'),
            Level::Super => out.push('^'),
        }
        out.push_str(&run.text);
    }
    out
}

/// The label as HTML, escaped.
pub(crate) fn html(label: &str) -> String {
    let mut out = String::new();
    for run in runs(label) {
        let body = crate::svg::escape(&run.text);
        match run.level {
            Level::Base => out.push_str(&body),
            Level::Sub => out.push_str(&format!("<sub>{body}</sub>")),
            Level::Super => out.push_str(&format!("<sup>{body}</sup>")),
        }
    }
    out
}

/// Advance widths of the printable ASCII characters (32..=126) in thousandths of the font size: Adobe's font metrics
/// for Helvetica, from which the common sans-serif fonts differ little.
const WIDTHS: [u16; 95] = [
    278, 278, 355, 556, 556, 889, 667, 191, 333, 333, 389, 584, 278, 333, 278, 278, 556, 556, 556, 556, 556, 556, 556,
    556, 556, 556, 278, 278, 584, 584, 584, 556, 1015, 667, 667, 722, 722, 667, 611, 778, 722, 278, 500, 667, 556, 833,
    722, 778, 667, 778, 722, 667, 611, 722, 667, 944, 667, 667, 611, 278, 278, 278, 469, 556, 333, 556, 556, 500, 556,
    556, 278, 556, 556, 222, 222, 500, 222, 833, 556, 556, 556, 556, 333, 500, 278, 556, 500, 722, 500, 500, 500, 334,
    260, 334, 584,
];

/// The viewer picks the font, so room is left for one that runs wider than Helvetica (DejaVu Sans does by this much).
const SLACK: f64 = 1.12;

/// Width of a label in pixels, on the generous side.
pub(crate) fn width(label: &str, size_px: f64) -> f64 {
    runs(label)
        .iter()
        .map(|run| {
            let scale = if run.level == Level::Base { 1.0 } else { SCRIPT_SIZE };
            run.text.chars().map(advance).sum::<f64>() * scale
        })
        .sum::<f64>()
        * size_px
        * SLACK
}

fn advance(c: char) -> f64 {
    let code = u32::from(c);
    let table = code.checked_sub(32).and_then(|i| WIDTHS.get(i as usize));
    match table {
        Some(&w) => f64::from(w) / 1000.0,
        // East Asian scripts are set full width; Greek, accents and signs are near a digit.
        None if code >= 0x2e80 => 1.0,
        None => 0.6,
    }
}

/// Breaks a label at spaces into lines no wider than `width_px`; a longer word stays whole.
pub(crate) fn wrap(label: &str, size_px: f64, width_px: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in label.split_whitespace() {
        match lines.last_mut() {
            Some(line) if width(&format!("{line} {word}"), size_px) <= width_px => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scripts_are_split_and_plain_underscores_stay() {
        let got = runs("C_{p} at mode_1 m^{2");
        assert_eq!(got.len(), 3);
        assert_eq!((got[1].text.as_str(), got[1].level), ("p", Level::Sub));
        assert_eq!(got[2].text, " at mode_1 m^{2");
        assert_eq!(plain("C_{p}, 10^{-3}"), "C_p, 10^-3");
        assert_eq!(html("C_{<}"), "C<sub>&lt;</sub>");
    }

    #[test]
    fn multibyte_text_does_not_break_the_scanner() {
        assert_eq!(plain("ω_{α} √µ ^{²}"), "ω_α √µ ^²");
        assert!(width("翼", 10.0) > width("i", 10.0));
    }

    #[test]
    fn wrapping_keeps_every_word_in_order() {
        let text = "a title that is much too long for the picture it stands above";
        let lines = wrap(text, 14.0, 120.0);
        assert!(lines.len() > 2);
        assert_eq!(lines.join(" "), text);
    }
}
