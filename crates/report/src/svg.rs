//! Writing SVG: escaping, numbers, shapes. No element carries an id, so that any number of pictures can stand in one
//! HTML page.

use crate::text::{self, Level, SCRIPT_SIZE};
use std::fmt::{self, Write};

/// The generic family: the viewer's own font, and nothing to embed.
pub(crate) const FONT: &str = "Helvetica, Arial, 'Liberation Sans', sans-serif";

/// A coordinate with at most two decimals and no trailing zeros: enough for a hundredth of a pixel, and the same text
/// for the same number everywhere.
#[derive(Clone, Copy)]
pub(crate) struct Px(pub(crate) f64);

impl fmt::Display for Px {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let fixed = format!("{:.2}", self.0);
        let short = fixed.trim_end_matches('0').trim_end_matches('.');
        f.write_str(if short == "-0" { "0" } else { short })
    }
}

/// Escapes text for XML and HTML content and attributes, and replaces the control characters XML forbids.
pub(crate) fn escape(raw: &str) -> String {
    let mut out = String::with_capacity(raw.len());
    for c in raw.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\t' | '\n' | '\r' => out.push(c),
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

/// Which part of a text stands at its anchor point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// How a text is set.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TextStyle<'a> {
    pub(crate) size_px: f64,
    pub(crate) anchor: Anchor,
    pub(crate) fill: &'a str,
    pub(crate) bold: bool,
    /// Turned to read upwards.
    pub(crate) upwards: bool,
    /// With a white rim, for text that crosses lines.
    pub(crate) halo: bool,
}

impl TextStyle<'_> {
    pub(crate) const fn new(size_px: f64, anchor: Anchor) -> TextStyle<'static> {
        TextStyle {
            size_px,
            anchor,
            fill: "#222222",
            bold: false,
            upwards: false,
            halo: false,
        }
    }
}

/// An SVG picture as it grows.
#[derive(Default)]
pub(crate) struct Svg {
    body: String,
}

impl Svg {
    /// Writes one element. Formatting into a `String` cannot fail, so the result of `write!` is dropped here, once.
    pub(crate) fn put(&mut self, element: fmt::Arguments<'_>) {
        let _ = self.body.write_fmt(element);
        self.body.push('\n');
    }

    pub(crate) fn rect(&mut self, x: f64, y: f64, w: f64, h: f64, attributes: &str) {
        self.put(format_args!(
            r#"<rect x="{}" y="{}" width="{}" height="{}" {attributes}/>"#,
            Px(x),
            Px(y),
            Px(w),
            Px(h)
        ));
    }

    pub(crate) fn line(&mut self, a: (f64, f64), b: (f64, f64), attributes: &str) {
        self.put(format_args!(
            r#"<line x1="{}" y1="{}" x2="{}" y2="{}" {attributes}/>"#,
            Px(a.0),
            Px(a.1),
            Px(b.0),
            Px(b.1)
        ));
    }

    /// A path; nothing is written for an empty one.
    pub(crate) fn path(&mut self, path: &Path, attributes: &str) {
        if !path.data.is_empty() {
            self.put(format_args!(r#"<path d="{}" {attributes}/>"#, path.data));
        }
    }

    pub(crate) fn open_group(&mut self, attributes: &str) {
        self.put(format_args!("<g {attributes}>"));
    }

    pub(crate) fn close_group(&mut self) {
        self.put(format_args!("</g>"));
    }

    /// Text with its baseline at (x, y); sub- and superscripts as in [`text::runs`].
    pub(crate) fn text(&mut self, x: f64, y: f64, label: &str, style: TextStyle<'_>) {
        let mut inner = String::new();
        let mut shift_now = 0.0;
        let mut gap = 0.0;
        for run in text::runs(label) {
            let (shift, scale) = match run.level {
                Level::Base => (0.0, 1.0),
                Level::Sub => (0.24 * style.size_px, SCRIPT_SIZE),
                Level::Super => (-0.38 * style.size_px, SCRIPT_SIZE),
            };
            // Some viewers drop spaces at the ends of a run, so these become shifts.
            let space = 0.28 * scale * style.size_px;
            let lead = run.text.len() - run.text.trim_start_matches(' ').len();
            let inside = run.text.trim_matches(' ');
            let trail = run.text.len() - lead - inside.len();
            gap += space * lead as f64;
            let body = escape(inside);
            if inner.is_empty() && shift == 0.0 {
                inner.push_str(&body);
            } else {
                // dy, not baseline-shift: not every viewer knows the latter.
                let dx = if gap > 0.0 {
                    format!(r#" dx="{}""#, Px(gap))
                } else {
                    String::new()
                };
                let _ = write!(
                    inner,
                    r#"<tspan{dx} dy="{}" font-size="{}">{body}</tspan>"#,
                    Px(shift - shift_now),
                    Px(scale * style.size_px)
                );
            }
            gap = space * trail as f64;
            shift_now = shift;
        }
        let anchor = match style.anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let weight = if style.bold { r#" font-weight="600""# } else { "" };
        let rim = if style.halo {
            r##" paint-order="stroke" stroke="#ffffff" stroke-width="3.5" stroke-linejoin="round""##
        } else {
            ""
        };
        let turn = if style.upwards {
            format!(r#" transform="rotate(-90 {} {})""#, Px(x), Px(y))
        } else {
            String::new()
        };
        self.put(format_args!(
            r#"<text x="{}" y="{}" font-size="{}" text-anchor="{anchor}" fill="{}"{weight}{rim}{turn}>{inner}</text>"#,
            Px(x),
            Px(y),
            Px(style.size_px),
            style.fill
        ));
    }

    /// The whole document. `title` and `description` are what a screen reader says.
    pub(crate) fn finish(self, width_px: u32, height_px: u32, title: &str, description: &str) -> String {
        let title = escape(&text::plain(title));
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width_px}\" height=\"{height_px}\" \
             viewBox=\"0 0 {width_px} {height_px}\" role=\"img\" aria-label=\"{title}\" font-family=\"{FONT}\">\n\
             <title>{title}</title>\n<desc>{}</desc>\n\
             <rect width=\"{width_px}\" height=\"{height_px}\" fill=\"#ffffff\"/>\n{}</svg>\n",
            escape(description),
            self.body
        )
    }
}

/// Path data: moves, lines and closings.
#[derive(Default)]
pub(crate) struct Path {
    data: String,
}

impl Path {
    pub(crate) fn move_to(&mut self, p: (f64, f64)) {
        let _ = write!(self.data, "M{} {}", Px(p.0), Px(p.1));
    }

    pub(crate) fn line_to(&mut self, p: (f64, f64)) {
        let _ = write!(self.data, "L{} {}", Px(p.0), Px(p.1));
    }

    /// A closed polygon.
    pub(crate) fn polygon(&mut self, points: &[(f64, f64)]) {
        for (i, &p) in points.iter().enumerate() {
            if i == 0 { self.move_to(p) } else { self.line_to(p) }
        }
        if !points.is_empty() {
            self.data.push('Z');
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_are_short_and_never_minus_zero() {
        assert_eq!(Px(-0.001).to_string(), "0");
        assert_eq!(Px(12.50).to_string(), "12.5");
        assert_eq!(Px(100.0).to_string(), "100");
    }

    #[test]
    fn everything_that_xml_minds_is_escaped() {
        assert_eq!(
            escape("a<b & \"c\" 'd'>\u{1}"),
            "a&lt;b &amp; &quot;c&quot; &#39;d&#39;&gt;\u{fffd}"
        );
    }
}
