//! Tables: one set of rows, written as aligned text, Markdown, CSV or HTML. Names, units and words may hold `_{..}` and
//! `^{..}` as in pictures.

use crate::error::ReportError;
use crate::number::{NumberFormat, all_digits, write_number};
use crate::text;
use std::fmt::Write;

/// Which side the cells of a column stand on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Align {
    /// Words.
    Left,
    /// Numbers.
    Right,
}

/// How a cell is to be taken.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Tone {
    /// As it stands.
    #[default]
    Plain,
    /// Within what was asked for.
    Good,
    /// To be looked at: marked with `!` in text, in colour and bold in HTML.
    Warning,
}

/// What a cell holds.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    /// Words.
    Text(String),
    /// A number in the column's unit; NaN is written as `NaN`.
    Number(f64),
    /// Nothing is known.
    Missing,
}

/// One cell.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    /// What it holds.
    pub value: Value,
    /// How it is to be taken.
    pub tone: Tone,
}

impl Cell {
    /// An empty cell, written as a dash.
    #[must_use]
    pub fn missing() -> Self {
        Self {
            value: Value::Missing,
            tone: Tone::Plain,
        }
    }

    /// The same cell marked as a warning.
    #[must_use]
    pub fn warning(mut self) -> Self {
        self.tone = Tone::Warning;
        self
    }

    /// The same cell marked as good.
    #[must_use]
    pub fn good(mut self) -> Self {
        self.tone = Tone::Good;
        self
    }
}

impl From<f64> for Cell {
    fn from(number: f64) -> Self {
        Self {
            value: Value::Number(number),
            tone: Tone::Plain,
        }
    }
}

impl From<Option<f64>> for Cell {
    fn from(number: Option<f64>) -> Self {
        number.map_or_else(Self::missing, Self::from)
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::from(text.to_owned())
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self {
            value: Value::Text(text),
            tone: Tone::Plain,
        }
    }
}

/// One column.
#[derive(Debug, Clone, PartialEq)]
pub struct Column {
    /// Name, e.g. `"Flutter speed"`.
    pub name: String,
    /// Unit, e.g. `"m/s"`; empty for none.
    pub unit: String,
    /// How numbers are written.
    pub format: NumberFormat,
    /// Which side cells stand on.
    pub align: Align,
}

impl Column {
    /// A column of numbers, to the right.
    pub fn number(name: impl Into<String>, unit: impl Into<String>, format: NumberFormat) -> Self {
        Self {
            name: name.into(),
            unit: unit.into(),
            format,
            align: Align::Right,
        }
    }

    /// A column of words, to the left.
    pub fn text(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            unit: String::new(),
            format: NumberFormat::Significant(4),
            align: Align::Left,
        }
    }

    fn heading(&self) -> String {
        if self.unit.is_empty() {
            self.name.clone()
        } else {
            format!("{} [{}]", self.name, self.unit)
        }
    }
}

/// A table; every row has one cell for every column.
///
/// ```
/// use dip_report::{Cell, Column, NumberFormat, Table};
/// let mut table = Table::new("Flutter speed", vec![
///     Column::text("Method"),
///     Column::number("U", "m/s", NumberFormat::Fixed(1)),
/// ]);
/// table.push(vec!["PK".into(), 233.14.into()])?;
/// table.push(vec!["KE".into(), Cell::from(240.0).warning()])?;
/// assert!(table.plain().contains("233.1"));
/// assert_eq!(table.csv(), "Method,U [m/s]\nPK,233.14\nKE,240\n");
/// # Ok::<(), dip_report::ReportError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    title: String,
    columns: Vec<Column>,
    rows: Vec<Vec<Cell>>,
}

impl Table {
    /// A table without rows.
    pub fn new(title: impl Into<String>, columns: Vec<Column>) -> Self {
        Self {
            title: title.into(),
            columns,
            rows: Vec::new(),
        }
    }

    /// Adds a row.
    ///
    /// # Errors
    /// [`ReportError::Shape`] if it does not have one cell for every column.
    pub fn push(&mut self, row: Vec<Cell>) -> Result<(), ReportError> {
        if row.len() != self.columns.len() {
            return Err(ReportError::Shape {
                figure: self.title.clone(),
                what: format!("row {}", self.rows.len() + 1),
                needed: self.columns.len(),
                got: row.len(),
            });
        }
        self.rows.push(row);
        Ok(())
    }

    /// The title.
    #[must_use]
    pub fn title(&self) -> &str {
        &self.title
    }

    /// Aligned text for a terminal; warnings carry `!`.
    #[must_use]
    pub fn plain(&self) -> String {
        let cells = self.written("!", text::plain);
        let widths = self.widths(&cells);
        let mut out = String::new();
        if !self.title.is_empty() {
            let _ = writeln!(out, "{}", one_line(&text::plain(&self.title)));
        }
        let line = |out: &mut String, row: &[String]| {
            let padded: Vec<String> = row
                .iter()
                .zip(&self.columns)
                .zip(&widths)
                .map(|((c, column), w)| pad(c, *w, column.align))
                .collect();
            out.push_str(padded.join("  ").trim_end());
            out.push('\n');
        };
        line(&mut out, &self.headings());
        line(&mut out, &widths.iter().map(|w| "-".repeat(*w)).collect::<Vec<_>>());
        for row in &cells {
            line(&mut out, row);
        }
        out
    }

    /// A Markdown table, aligned in its source too; warnings are bold.
    #[must_use]
    pub fn markdown(&self) -> String {
        let clean = |text: &String| text.replace('\\', "\\\\").replace('|', "\\|");
        let headings: Vec<String> = self.headings().iter().map(clean).collect();
        let mut cells: Vec<Vec<String>> = self
            .written("", text::plain)
            .iter()
            .map(|row| row.iter().map(clean).collect())
            .collect();
        for (row, source) in cells.iter_mut().zip(&self.rows) {
            for (cell, _) in row.iter_mut().zip(source).filter(|(_, c)| c.tone == Tone::Warning) {
                *cell = format!("**{cell}**");
            }
        }
        let mut all = cells.clone();
        all.push(headings.clone());
        let widths = self.widths(&all);
        let mut out = String::new();
        let line = |out: &mut String, row: &[String]| {
            out.push('|');
            for ((cell, column), w) in row.iter().zip(&self.columns).zip(&widths) {
                let _ = write!(out, " {} |", pad(cell, *w, column.align));
            }
            out.push('\n');
        };
        line(&mut out, &headings);
        out.push('|');
        for (column, w) in self.columns.iter().zip(&widths) {
            let right = column.align == Align::Right;
            let _ = write!(out, "{}{}|", "-".repeat(w + 1), if right { ":" } else { "-" });
        }
        out.push('\n');
        for row in &cells {
            line(&mut out, row);
        }
        out
    }

    /// Comma-separated values (RFC 4180, with line feeds): a heading row with units, then numbers with all the digits
    /// needed to read back the same number; missing cells are empty.
    #[must_use]
    pub fn csv(&self) -> String {
        let quote = |text: &str| {
            if text.contains([',', '"', '\n', '\r']) {
                format!("\"{}\"", text.replace('"', "\"\""))
            } else {
                text.to_owned()
            }
        };
        let mut out = self
            .columns
            .iter()
            .map(|c| quote(&c.heading()))
            .collect::<Vec<_>>()
            .join(",");
        out.push('\n');
        for row in &self.rows {
            let cells: Vec<String> = row
                .iter()
                .map(|cell| match &cell.value {
                    Value::Text(text) => quote(&text::plain(text)),
                    Value::Number(number) => all_digits(*number),
                    Value::Missing => String::new(),
                })
                .collect();
            out.push_str(&cells.join(","));
            out.push('\n');
        }
        out
    }

    /// The HTML element with its caption, under `number`.
    pub(crate) fn html(&self, number: usize) -> String {
        let class = |column: &Column| if column.align == Align::Right { "num" } else { "txt" };
        let mut out = String::from("<div class=\"table\"><table>\n");
        let _ = writeln!(
            out,
            "<caption><b>Table {number}.</b> {}</caption>",
            text::html(&self.title)
        );
        out.push_str("<thead><tr>");
        for column in &self.columns {
            let _ = write!(
                out,
                "<th scope=\"col\" class=\"{}\">{}",
                class(column),
                text::html(&column.name)
            );
            if !column.unit.is_empty() {
                let _ = write!(out, " <span class=\"unit\">[{}]</span>", text::html(&column.unit));
            }
            out.push_str("</th>");
        }
        out.push_str("</tr></thead>\n<tbody>\n");
        for (row, source) in self.written("", str::to_owned).iter().zip(&self.rows) {
            out.push_str("<tr>");
            for (i, ((cell, from), column)) in row.iter().zip(source).zip(&self.columns).enumerate() {
                let (tone, spoken) = match from.tone {
                    Tone::Plain => ("", ""),
                    Tone::Good => (" good", ""),
                    // Not by colour alone.
                    Tone::Warning => (" warn", "<span title=\"warning\"> \u{26a0}</span>"),
                };
                let body = text::html(cell);
                // A first column of words names its row.
                let (open, close) = if i == 0 && column.align == Align::Left {
                    ("th scope=\"row\"", "th")
                } else {
                    ("td", "td")
                };
                let _ = write!(
                    out,
                    "<{open} class=\"{}{tone}\">{body}{spoken}</{close}>",
                    class(column)
                );
            }
            out.push_str("</tr>\n");
        }
        out.push_str("</tbody></table></div>\n");
        out
    }

    fn headings(&self) -> Vec<String> {
        self.columns.iter().map(|c| one_line(&c.heading())).collect()
    }

    /// All cells as text; warnings get `mark` after them, and `words` treats the markup.
    fn written(&self, mark: &str, words: fn(&str) -> String) -> Vec<Vec<String>> {
        self.rows
            .iter()
            .map(|row| {
                row.iter()
                    .zip(&self.columns)
                    .map(|(cell, column)| {
                        let text = match &cell.value {
                            Value::Text(text) => one_line(&words(text)),
                            Value::Number(number) => write_number(*number, column.format),
                            Value::Missing => "\u{2013}".to_owned(),
                        };
                        if cell.tone == Tone::Warning && !mark.is_empty() {
                            format!("{text} {mark}")
                        } else {
                            text
                        }
                    })
                    .collect()
            })
            .collect()
    }

    fn widths(&self, cells: &[Vec<String>]) -> Vec<usize> {
        let mut widths: Vec<usize> = self.headings().iter().map(|h| columns_of(h)).collect();
        for row in cells {
            for (w, cell) in widths.iter_mut().zip(row) {
                *w = (*w).max(columns_of(cell));
            }
        }
        // A Markdown rule needs three.
        widths.iter().map(|w| (*w).max(3)).collect()
    }
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Columns a text takes up in a terminal.
fn columns_of(text: &str) -> usize {
    text.chars().map(|c| if u32::from(c) >= 0x2e80 { 2 } else { 1 }).sum()
}

fn pad(text: &str, width: usize, align: Align) -> String {
    let room = " ".repeat(width.saturating_sub(columns_of(text)));
    match align {
        Align::Left => format!("{text}{room}"),
        Align::Right => format!("{room}{text}"),
    }
}
