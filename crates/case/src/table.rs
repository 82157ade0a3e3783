//! Tables of numbers in CSV files: `#` comments, one header line, columns found by name.

use crate::diagnose::{CaseError, nearest};
use std::path::Path;

/// A table: column names and rows of text cells, with the place of each cell.
#[derive(Debug, Clone)]
pub struct Table {
    file: std::path::PathBuf,
    text: String,
    header: Vec<String>,
    /// Cells `[row][column]` as ranges of `text`.
    rows: Vec<Vec<std::ops::Range<usize>>>,
}

impl Table {
    /// Reads a CSV file.
    ///
    /// # Errors
    /// A file that can't be read, has no header, or has a row with another number of cells than the header.
    pub fn read(file: &Path) -> Result<Self, CaseError> {
        let text = std::fs::read_to_string(file).map_err(|e| {
            let help = "check the path: paths inside a file are relative to that file".to_owned();
            CaseError::new(format!("{}: cannot read the table: {e}", file.display()), Some(help))
        })?;
        Self::parse(file, text)
    }

    /// As [`Table::read`], for text already in memory.
    ///
    /// # Errors
    /// As [`Table::read`].
    pub fn parse(file: &Path, text: String) -> Result<Self, CaseError> {
        let mut header: Option<Vec<String>> = None;
        let mut rows = Vec::new();
        let mut offset = 0;
        for line in text.split_inclusive('\n') {
            let start = offset;
            offset += line.len();
            let content = line.trim_end();
            if content.trim_start().is_empty() || content.trim_start().starts_with('#') {
                continue;
            }
            let cells = cells_of(content, start);
            match &header {
                None => header = Some(cells.iter().map(|c| unquote(&text[c.clone()]).to_owned()).collect()),
                Some(names) if names.len() == cells.len() => rows.push(cells),
                Some(names) => {
                    let message = format!("{} cells in this row: needed {}", cells.len(), names.len());
                    let help = format!("the columns are {}", names.join(", "));
                    return Err(CaseError::at(
                        file,
                        &text,
                        start..start + content.len(),
                        message,
                        Some(help),
                    ));
                }
            }
        }
        let Some(header) = header else {
            return Err(CaseError::at(file, &text, 0..0, "no header line in the table", None));
        };
        Ok(Self {
            file: file.to_path_buf(),
            text,
            header,
            rows,
        })
    }

    /// Column names.
    pub fn header(&self) -> &[String] {
        &self.header
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// True where there are no rows.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// True where there is a column of that name.
    pub fn has(&self, column: &str) -> bool {
        self.header.iter().any(|h| h == column)
    }

    fn index(&self, column: &str) -> Result<usize, CaseError> {
        self.header.iter().position(|h| h == column).ok_or_else(|| {
            let list = self.header.join(", ");
            let help = match nearest(column, self.header.iter().map(String::as_str)) {
                Some(near) => format!("the columns are {list}; is it `{near}`?"),
                None => format!("the columns are {list}"),
            };
            let at = self.text.find(&self.header[0]).unwrap_or(0);
            CaseError::at(
                &self.file,
                &self.text,
                at..at + self.header[0].len(),
                format!("no column `{column}`"),
                Some(help),
            )
        })
    }

    /// The text cells of a column.
    ///
    /// # Errors
    /// No such column.
    pub fn text(&self, column: &str) -> Result<Vec<&str>, CaseError> {
        let c = self.index(column)?;
        Ok(self
            .rows
            .iter()
            .map(|row| unquote(&self.text[row[c].clone()]))
            .collect())
    }

    /// The numbers of a column; an empty cell is `None`.
    ///
    /// # Errors
    /// No such column, or a cell that is neither empty nor a finite number.
    pub fn optional_numbers(&self, column: &str) -> Result<Vec<Option<f64>>, CaseError> {
        let c = self.index(column)?;
        self.rows
            .iter()
            .map(|row| {
                let cell = &self.text[row[c].clone()];
                match cell {
                    "" => Ok(None),
                    _ => match cell.parse::<f64>() {
                        Ok(v) if v.is_finite() => Ok(Some(v)),
                        _ => {
                            let message = format!("`{cell}` in column `{column}` is not a finite number");
                            Err(CaseError::at(&self.file, &self.text, row[c].clone(), message, None))
                        }
                    },
                }
            })
            .collect()
    }

    /// The numbers of a column.
    ///
    /// # Errors
    /// No such column, or a cell that is not a finite number.
    pub fn numbers(&self, column: &str) -> Result<Vec<f64>, CaseError> {
        let c = self.index(column)?;
        self.optional_numbers(column)?
            .into_iter()
            .zip(&self.rows)
            .map(|(value, row)| {
                value.ok_or_else(|| {
                    let message = format!("empty cell in column `{column}`: needed a number");
                    CaseError::at(&self.file, &self.text, row[c].clone(), message, None)
                })
            })
            .collect()
    }
}

/// Ranges of the cells of one line that starts at `start`; commas inside double quotes do not split.
fn cells_of(line: &str, start: usize) -> Vec<std::ops::Range<usize>> {
    let mut cells = Vec::new();
    let mut begin = 0;
    let mut quoted = false;
    for (i, c) in line.char_indices().chain(std::iter::once((line.len(), ','))) {
        match c {
            '"' => quoted = !quoted,
            ',' if !quoted || i == line.len() => {
                let cell = &line[begin..i];
                let left = begin + cell.len() - cell.trim_start().len();
                let right = left.max(begin + cell.trim_end().len());
                cells.push(start + left..start + right);
                begin = i + 1;
            }
            _ => {}
        }
    }
    cells
}

fn unquote(cell: &str) -> &str {
    cell.strip_prefix('"').and_then(|c| c.strip_suffix('"')).unwrap_or(cell)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(text: &str) -> Result<Table, CaseError> {
        Table::parse(Path::new("t.csv"), text.to_owned())
    }

    #[test]
    fn reads_columns_by_name() {
        let t = table("# source\na, b ,c\n1,2,\"x, y\"\r\n3,,z\n").unwrap();
        assert_eq!(t.numbers("a").unwrap(), [1.0, 3.0]);
        assert_eq!(t.optional_numbers("b").unwrap(), [Some(2.0), None]);
        assert_eq!(t.text("c").unwrap(), ["x, y", "z"]);
    }

    #[test]
    fn errors_name_the_line() {
        assert_eq!(table("a,b\n1,2\n3\n").unwrap_err().line(), Some(3));
        let t = table("a,b\n1,2\n3,q\n").unwrap();
        assert_eq!(t.numbers("b").unwrap_err().line(), Some(3));
        assert!(t.numbers("A").unwrap_err().help_text().unwrap().contains("`a`"));
        assert!(table("# nothing\n").is_err());
    }
}
