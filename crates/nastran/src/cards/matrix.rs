//! Matrices given directly: DMIG (between degrees of freedom) and DMI (plain).

use std::collections::BTreeMap;

use crate::{
    error::{DeckError, Location},
    fields::{Card, Dof},
};

type Result<T> = std::result::Result<T, DeckError>;

/// A real matrix between degrees of freedom, selected by K2GG, M2GG or B2GG.
#[derive(Debug, Clone)]
pub struct DofMatrix {
    /// Its name.
    pub name: String,
    /// Whether only one triangle is given and the other follows from symmetry (IFO 6).
    pub is_symmetric: bool,
    /// Row, column, value.
    pub terms: Vec<(Dof, Dof, f64)>,
    /// Where its header stands.
    pub at: Location,
}

/// A plain matrix.
#[derive(Debug, Clone)]
pub struct PlainMatrix {
    /// Its name.
    pub name: String,
    /// Rows and columns.
    pub size: [usize; 2],
    /// Row and column from zero, value; zeros left out.
    pub terms: Vec<(usize, usize, f64)>,
    /// Where its header stands.
    pub at: Location,
}

/// A column card that waits for its header, which may stand below it.
#[derive(Debug)]
struct Column<T> {
    matrix: String,
    at: Location,
    terms: Vec<T>,
}

/// Collects the header and column cards of DMIG matrices.
#[derive(Debug, Default)]
pub(crate) struct DofMatrices {
    pub(crate) found: BTreeMap<String, DofMatrix>,
    waiting: Vec<Column<(Dof, Dof, f64)>>,
}

impl DofMatrices {
    /// `DMIG NAME 0 IFO TIN TOUT POLAR . NCOL` or `DMIG NAME GJ CJ . G1 C1 A1 B1 / G2 C2 A2 B2 ...`
    pub(crate) fn read(&mut self, card: &Card) -> Result<()> {
        let name = card.text(0).to_owned();
        if name.is_empty() {
            return Err(card.wrong(0, "NAME", "the name of a matrix", ""));
        }
        if card.text(1) == "0" {
            let form = card.int_or(2, "IFO", 1)?;
            if !matches!(form, 1 | 2 | 6 | 9) {
                return Err(card.wrong(2, "IFO", "1, 2, 6 or 9", ""));
            }
            if !matches!(card.int_or(3, "TIN", 2)?, 1 | 2) {
                return Err(card.unsupported("complex matrices (TIN 3 or 4)"));
            }
            let matrix = DofMatrix {
                name: name.clone(),
                is_symmetric: form == 6,
                terms: Vec::new(),
                at: card.at(),
            };
            if let Some(first) = self.found.get(&name) {
                return Err(card.error(format!("matrix {name} has a second header (first at {})", first.at)));
            }
            self.found.insert(name, matrix);
            return Ok(());
        }
        let column = Dof {
            point: card.id(1, "GJ")?,
            component: card.component(2, "CJ")?,
        };
        let mut terms = Vec::new();
        // Rows stand in groups of four fields: the first in fields 6 to 9, then two groups a line.
        for i in (4..card.len()).step_by(4) {
            if card.has(i) {
                let row = Dof {
                    point: card.id(i, "G")?,
                    component: card.component(i + 1, "C")?,
                };
                terms.push((row, column, card.real(i + 2, "A")?));
            }
        }
        self.waiting.push(Column {
            matrix: name,
            at: card.at(),
            terms,
        });
        Ok(())
    }

    /// Gives the columns to their headers, wherever those stood.
    pub(crate) fn finish(mut self) -> Result<BTreeMap<String, DofMatrix>> {
        for Column {
            matrix: name,
            at,
            terms,
        } in self.waiting
        {
            match self.found.get_mut(&name) {
                Some(matrix) => matrix.terms.extend(terms),
                None => {
                    return Err(DeckError::Card {
                        at,
                        card: "DMIG".to_owned(),
                        what: format!("matrix {name} has no header (DMIG {name} 0 IFO TIN TOUT)"),
                    });
                }
            }
        }
        Ok(self.found)
    }
}

/// Collects the header and column cards of DMI matrices.
#[derive(Debug, Default)]
pub(crate) struct PlainMatrices {
    found: BTreeMap<String, PlainMatrix>,
    waiting: Vec<Column<(usize, usize, f64)>>,
}

impl PlainMatrices {
    /// `DMI NAME 0 FORM TIN TOUT . M N` or `DMI NAME J I1 A(I1,J) ... I2 A(I2,J) ...`
    pub(crate) fn read(&mut self, card: &Card) -> Result<()> {
        let name = card.text(0).to_owned();
        if name.is_empty() {
            return Err(card.wrong(0, "NAME", "the name of a matrix", ""));
        }
        if card.text(1) == "0" {
            if !matches!(card.int_or(3, "TIN", 1)?, 1 | 2) {
                return Err(card.unsupported("complex matrices (TIN 3 or 4)"));
            }
            let size = [card.id(6, "M")? as usize, card.id(7, "N")? as usize];
            self.found.insert(
                name.clone(),
                PlainMatrix {
                    name,
                    size,
                    terms: Vec::new(),
                    at: card.at(),
                },
            );
            return Ok(());
        }
        let column = card.id(1, "J")? as usize - 1;
        let mut terms = Vec::new();
        let mut row = 0;
        let mut i = 2;
        while i < card.len() {
            match (card.text(i), crate::number::number(card.text(i))) {
                ("", _) => {}
                ("THRU", _) => {
                    let to = card.id(i + 1, "I")? as usize;
                    let value = terms.last().map_or(0.0, |(_, x): &(usize, f64)| *x);
                    if to.saturating_sub(row) > 1_000_000 {
                        return Err(card.wrong(i + 1, "I", "a row of the matrix", ""));
                    }
                    while row < to {
                        terms.push((row, value));
                        row += 1;
                    }
                    i += 1;
                }
                (_, Some(crate::number::Number::Integer(_))) => row = card.id(i, "I")? as usize - 1,
                _ => {
                    terms.push((row, card.real(i, "A")?));
                    row += 1;
                }
            }
            i += 1;
        }
        let terms = terms.into_iter().map(|(row, value)| (row, column, value)).collect();
        self.waiting.push(Column {
            matrix: name,
            at: card.at(),
            terms,
        });
        Ok(())
    }

    /// Gives the columns to their headers and checks them against the size.
    pub(crate) fn finish(mut self) -> Result<BTreeMap<String, PlainMatrix>> {
        for Column {
            matrix: name,
            at,
            terms,
        } in self.waiting
        {
            let error = |what: String| DeckError::Card {
                at: at.clone(),
                card: "DMI".to_owned(),
                what,
            };
            let Some(matrix) = self.found.get_mut(&name) else {
                return Err(error(format!(
                    "matrix {name} has no header (DMI {name} 0 FORM TIN TOUT . M N)"
                )));
            };
            for (row, column, value) in terms {
                if row >= matrix.size[0] || column >= matrix.size[1] {
                    return Err(error(format!(
                        "row {}, column {} lies outside matrix {name} of {} by {}",
                        row + 1,
                        column + 1,
                        matrix.size[0],
                        matrix.size[1]
                    )));
                }
                matrix.terms.push((row, column, value));
            }
        }
        Ok(self.found)
    }
}
