//! One HTML page with everything in it: no scripts, nothing fetched, well-formed XML too. Words may hold `_{..}` and
//! `^{..}` for sub- and superscripts, as in pictures; all else is taken as it stands.

use crate::error::ReportError;
use crate::figure::Figure;
use crate::svg::escape;
use crate::table::Table;
use crate::text;
use std::fmt::Write;

/// One thing on the page, in reading order.
#[derive(Debug, Clone, PartialEq)]
pub enum Block {
    /// A paragraph of plain text.
    Paragraph(String),
    /// A heading below that of the section.
    Heading(String),
    /// Points of a list.
    List(Vec<String>),
    /// A paragraph that must not be overlooked.
    Warning(String),
    /// A table; numbered in order.
    Table(Table),
    /// A picture made with [`Block::figure`]; numbered in order.
    Figure(Picture),
    /// Names and values.
    Pairs(Vec<(String, String)>),
    /// Text as it stands (a case file, a log), folded away under a summary.
    Details {
        /// What is folded away.
        summary: String,
        /// The text.
        text: String,
    },
}

/// A drawn picture with its caption.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    svg: String,
    caption: String,
}

impl Block {
    /// A figure of the given size in px (the page scales it down where it is narrower).
    ///
    /// # Errors
    /// As [`Figure::svg`].
    pub fn figure(
        figure: &Figure,
        width_px: u32,
        height_px: u32,
        caption: impl Into<String>,
    ) -> Result<Self, ReportError> {
        Ok(Self::Figure(Picture {
            svg: figure.svg(width_px, height_px)?,
            caption: caption.into(),
        }))
    }
}

/// A page: title, stamp, sections.
///
/// ```
/// use dip_report::{Block, Page};
/// let html = Page::new("AGARD 445.6: flutter boundary")
///     .stamp("version", "0.1.0")
///     .section("Summary", vec![Block::Paragraph("All points converged.".to_owned())])
///     .html();
/// assert!(html.starts_with("<!DOCTYPE html>"));
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Page {
    title: String,
    stamp: Vec<(String, String)>,
    sections: Vec<(String, Vec<Block>)>,
}

impl Page {
    /// An empty page.
    pub fn new(title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            ..Self::default()
        }
    }

    /// Adds a line to the stamp under the title: version, commit, case, mesh hash.
    #[must_use]
    pub fn stamp(mut self, name: impl Into<String>, value: impl Into<String>) -> Self {
        self.stamp.push((name.into(), value.into()));
        self
    }

    /// Adds a section.
    #[must_use]
    pub fn section(mut self, heading: impl Into<String>, blocks: Vec<Block>) -> Self {
        self.sections.push((heading.into(), blocks));
        self
    }

    /// The page as one HTML document. The same page gives the same bytes.
    #[must_use]
    pub fn html(&self) -> String {
        let title = escape(&text::plain(&self.title));
        let heading = text::html(&self.title);
        let mut out = format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n\
             <title>{title}</title>\n<style>{STYLE}</style>\n</head>\n<body>\n<header>\n<h1>{heading}</h1>\n"
        );
        pairs(&mut out, &self.stamp, "stamp");
        out.push_str("</header>\n");
        if self.sections.len() > 1 {
            out.push_str("<nav aria-label=\"Contents\"><h2>Contents</h2>\n<ol>\n");
            for (i, (heading, _)) in self.sections.iter().enumerate() {
                let _ = writeln!(
                    out,
                    "<li><a href=\"#section-{}\">{}</a></li>",
                    i + 1,
                    text::html(heading)
                );
            }
            out.push_str("</ol></nav>\n");
        }
        out.push_str("<main>\n");
        let mut numbers = Numbers::default();
        for (i, (heading, blocks)) in self.sections.iter().enumerate() {
            let n = i + 1;
            let _ = writeln!(
                out,
                "<section id=\"section-{n}\" aria-labelledby=\"heading-{n}\">\n\
                 <h2 id=\"heading-{n}\">{n}. {}</h2>",
                text::html(heading)
            );
            for block in blocks {
                write_block(&mut out, block, &mut numbers);
            }
            out.push_str("</section>\n");
        }
        out.push_str("</main>\n</body>\n</html>\n");
        out
    }
}

/// Running numbers of tables and figures.
#[derive(Default)]
struct Numbers {
    tables: usize,
    figures: usize,
}

fn write_block(out: &mut String, block: &Block, numbers: &mut Numbers) {
    // Writing into a String cannot fail.
    let _ = match block {
        Block::Paragraph(text) => writeln!(out, "<p>{}</p>", text::html(text)),
        Block::Heading(text) => writeln!(out, "<h3>{}</h3>", text::html(text)),
        Block::Warning(text) => {
            writeln!(
                out,
                "<p class=\"warning\" role=\"note\"><strong>Warning:</strong> {}</p>",
                escape(text)
            )
        }
        Block::List(points) => {
            out.push_str("<ul>\n");
            for point in points {
                let _ = writeln!(out, "<li>{}</li>", text::html(point));
            }
            writeln!(out, "</ul>")
        }
        Block::Table(table) => {
            numbers.tables += 1;
            write!(out, "{}", table.html(numbers.tables))
        }
        Block::Figure(picture) => {
            numbers.figures += 1;
            let n = numbers.figures;
            writeln!(
                out,
                "<figure>\n{}<figcaption><b>Figure {n}.</b> {}</figcaption>\n</figure>",
                picture.svg,
                text::html(&picture.caption)
            )
        }
        Block::Pairs(list) => {
            pairs(out, list, "pairs");
            Ok(())
        }
        Block::Details { summary, text } => {
            writeln!(
                out,
                "<details><summary>{}</summary><pre>{}</pre></details>",
                escape(summary),
                escape(text)
            )
        }
    };
}

fn pairs(out: &mut String, list: &[(String, String)], class: &str) {
    if list.is_empty() {
        return;
    }
    let _ = writeln!(out, "<dl class=\"{class}\">");
    for (name, value) in list {
        let _ = writeln!(
            out,
            "<div><dt>{}</dt><dd>{}</dd></div>",
            text::html(name),
            text::html(value)
        );
    }
    out.push_str("</dl>\n");
}

/// The look: one column that reads well, on paper too. Pictures keep their white ground in the dark.
const STYLE: &str = "
:root{color-scheme:light dark;--ink:#1d1d1f;--soft:#5c6068;--ground:#fff;--rule:#d5d8dd;--band:#f5f6f8;
--link:#005a9c;--warn:#9b1c1c;--warnbg:#fdecec;--good:#176b3a}
@media (prefers-color-scheme:dark){:root{--ink:#e8e8ea;--soft:#a9adb5;--ground:#17181b;--rule:#3a3d44;--band:#212329;
--link:#7cc0ff;--warn:#ff9b9b;--warnbg:#3a1d1f;--good:#7bd8a0}}
*{box-sizing:border-box}
body{margin:0 auto;padding:2rem 1.2rem 4rem;max-width:62rem;color:var(--ink);background:var(--ground);
font:16px/1.55 system-ui,-apple-system,'Segoe UI',Helvetica,Arial,sans-serif}
h1{font-size:1.75rem;line-height:1.2;margin:0 0 .8rem}
h2{font-size:1.3rem;margin:2.4rem 0 .6rem;padding-bottom:.25rem;border-bottom:1px solid var(--rule)}
h3{font-size:1.05rem;margin:1.6rem 0 .4rem}
p,ul,ol{margin:.6rem 0}
p{max-width:46rem}
a{color:var(--link)}
nav h2{font-size:1rem;border:0;margin:1.2rem 0 .2rem;padding:0}
nav ol{margin:0;padding-left:1.4rem}
dl{margin:.6rem 0;display:grid;grid-template-columns:repeat(auto-fill,minmax(15rem,1fr));gap:.15rem 1.5rem}
dl>div{display:flex;gap:.5rem;min-width:0}
dt{color:var(--soft);flex:none}
dt::after{content:':'}
dd{margin:0;overflow-wrap:anywhere}
.stamp{font-size:.88rem;padding:.6rem .8rem;background:var(--band);border-radius:6px}
.table{overflow-x:auto;margin:1.2rem 0}
table{border-collapse:collapse;font-size:.92rem;font-variant-numeric:tabular-nums}
caption{text-align:left;padding:0 0 .4rem;color:var(--ink)}
th,td{padding:.3rem .75rem;text-align:left;vertical-align:top}
th.num,td.num{text-align:right;white-space:nowrap}
thead th{border-top:2px solid var(--ink);border-bottom:1px solid var(--ink);vertical-align:bottom}
tbody th{font-weight:400}
tbody tr:last-child>*{border-bottom:2px solid var(--ink)}
tbody tr:nth-child(even){background:var(--band)}
.unit{color:var(--soft);font-weight:400}
.warn{color:var(--warn);background:var(--warnbg);font-weight:600}
.good{color:var(--good)}
.warning{border-left:4px solid var(--warn);background:var(--warnbg);padding:.6rem .9rem;border-radius:0 6px 6px 0}
figure{margin:1.4rem 0}
figure svg{display:block;max-width:100%;height:auto;background:#fff;border-radius:6px}
figcaption{margin-top:.45rem;font-size:.92rem;max-width:46rem}
details{margin:1rem 0}
summary{cursor:pointer}
pre{overflow-x:auto;padding:.8rem;background:var(--band);border-radius:6px;font:13px/1.45 ui-monospace,Menlo,Consolas,monospace}
@media print{
:root{--ink:#000;--soft:#444;--ground:#fff;--rule:#bbb;--band:#f3f3f3;--link:#000;--warn:#9b1c1c;--warnbg:#fff;--good:#000}
body{max-width:none;padding:0;font-size:10.5pt}
figure,table,.warning{break-inside:avoid}
h2,h3,caption{break-after:avoid}
pre{white-space:pre-wrap}
@page{margin:18mm}}
";
