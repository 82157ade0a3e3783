//! Typed access to the fields of an entry; every failure names file, line, card, field, what was needed and what was got.

use std::cell::RefCell;

use crate::{
    entry::Entry,
    error::{DeckError, FieldError, Location, Note, Severity},
    number::{Number, number},
};

/// A set of the six components of a grid point, kept as bits: bit 0 is component 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, PartialOrd, Ord, Hash)]
pub struct Components(pub u8);

impl Components {
    /// No component.
    pub const NONE: Self = Self(0);
    /// All six.
    pub const ALL: Self = Self(0b11_1111);

    /// Reads digits 1 to 6 in any order (0 and blanks mean none, as on scalar points).
    pub fn parse(text: &str) -> Option<Self> {
        let mut bits = 0;
        for c in text.chars() {
            match c {
                '1'..='6' => bits |= 1 << (c as u8 - b'1'),
                '0' => {}
                _ => return None,
            }
        }
        Some(Self(bits))
    }

    /// The components as indices 0 to 5, ascending.
    pub fn iter(self) -> impl Iterator<Item = usize> {
        (0..6).filter(move |i| self.0 >> i & 1 == 1)
    }

    /// Whether the component with this index (0 to 5) is in the set.
    pub fn contains(self, index: usize) -> bool {
        index < 6 && self.0 >> index & 1 == 1
    }

    /// Whether no component is in the set.
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }
}

/// One degree of freedom: a point and the index of its component, 0 to 5 (0 on a scalar point).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Dof {
    /// Number of the grid or scalar point.
    pub point: u32,
    /// Index of the component, 0 to 5.
    pub component: usize,
}

/// An entry whose fields are read by index: 0 is field 2 of the first line, 8 is field 2 of the second, and so on.
pub struct Card<'a> {
    entry: &'a Entry,
    notes: &'a RefCell<Vec<Note>>,
}

type Result<T> = std::result::Result<T, DeckError>;

impl<'a> Card<'a> {
    /// Wraps an entry; notes made while reading it go to `notes`.
    pub fn new(entry: &'a Entry, notes: &'a RefCell<Vec<Note>>) -> Self {
        Self { entry, notes }
    }

    /// The card's name.
    pub fn name(&self) -> &str {
        &self.entry.name
    }

    /// The card's first line.
    pub fn at(&self) -> Location {
        self.entry.at.clone()
    }

    /// Number of fields up to the last that holds something.
    pub fn len(&self) -> usize {
        self.entry.fields.len()
    }

    /// The text of a field; empty when blank or absent.
    pub fn text(&self, index: usize) -> &'a str {
        self.entry.fields.get(index).map_or("", String::as_str)
    }

    /// Whether the field holds something.
    pub fn has(&self, index: usize) -> bool {
        !self.text(index).is_empty()
    }

    /// The error of a field.
    pub fn wrong(&self, index: usize, name: &str, needed: &str, hint: &str) -> DeckError {
        DeckError::Field(Box::new(FieldError {
            at: self.entry.lines.get(index / 8).unwrap_or(&self.entry.at).clone(),
            card: self.entry.name.clone(),
            field: index % 8 + 2,
            name: name.to_owned(),
            needed: needed.to_owned(),
            got: self.text(index).to_owned(),
            hint: hint.to_owned(),
        }))
    }

    /// The error of the whole card.
    pub fn error(&self, what: impl Into<String>) -> DeckError {
        DeckError::Card {
            at: self.at(),
            card: self.entry.name.clone(),
            what: what.into(),
        }
    }

    /// An error that says the card, or this use of it, is not supported.
    pub fn unsupported(&self, hint: impl Into<String>) -> DeckError {
        DeckError::Unsupported {
            at: self.at(),
            card: self.entry.name.clone(),
            hint: hint.into(),
        }
    }

    /// Adds a note about this card.
    pub fn note(&self, severity: Severity, text: impl Into<String>) {
        self.notes.borrow_mut().push(Note {
            at: self.at(),
            card: self.entry.name.clone(),
            severity,
            text: text.into(),
        });
    }

    /// An integer, or none when blank.
    pub fn int_opt(&self, index: usize, name: &str) -> Result<Option<i64>> {
        let text = self.text(index);
        if text.is_empty() {
            return Ok(None);
        }
        match number(text) {
            Some(Number::Integer(i)) => Ok(Some(i)),
            Some(Number::Real(_)) => Err(self.wrong(index, name, "an integer", "write it without decimal point")),
            None => Err(self.wrong(index, name, "an integer", "")),
        }
    }

    /// An integer with a default for blank.
    pub fn int_or(&self, index: usize, name: &str, default: i64) -> Result<i64> {
        Ok(self.int_opt(index, name)?.unwrap_or(default))
    }

    /// The number of something: positive, or none when blank.
    pub fn id_opt(&self, index: usize, name: &str) -> Result<Option<u32>> {
        match self.int_opt(index, name)? {
            None => Ok(None),
            Some(i) => match u32::try_from(i) {
                Ok(id) if id > 0 => Ok(Some(id)),
                _ => Err(self.wrong(index, name, "a positive integer", "")),
            },
        }
    }

    /// The number of something: positive and not blank.
    pub fn id(&self, index: usize, name: &str) -> Result<u32> {
        self.id_opt(index, name)?
            .ok_or_else(|| self.wrong(index, name, "a positive integer", "this field has no default"))
    }

    /// The number of something with a default for blank; zero is allowed (coordinate systems).
    pub fn id_or(&self, index: usize, name: &str, default: u32) -> Result<u32> {
        match self.int_opt(index, name)? {
            None => Ok(default),
            Some(i) => u32::try_from(i).map_err(|_| self.wrong(index, name, "an integer that is not negative", "")),
        }
    }

    /// A real, or none when blank. An integer is taken with a warning, since Nastran itself would refuse it.
    pub fn real_opt(&self, index: usize, name: &str) -> Result<Option<f64>> {
        let text = self.text(index);
        if text.is_empty() {
            return Ok(None);
        }
        match number(text) {
            Some(Number::Real(x)) => Ok(Some(x)),
            Some(Number::Integer(i)) => {
                self.note(
                    Severity::Warning,
                    format!(
                        "field {} ({name}) holds the integer {i} where Nastran needs a decimal point; read as {i}.0",
                        index % 8 + 2
                    ),
                );
                Ok(Some(i as f64))
            }
            None => Err(self.wrong(index, name, "a real number", "")),
        }
    }

    /// A real that must stand there.
    pub fn real(&self, index: usize, name: &str) -> Result<f64> {
        self.real_opt(index, name)?
            .ok_or_else(|| self.wrong(index, name, "a real number", "this field has no default"))
    }

    /// A real with a default for blank.
    pub fn real_or(&self, index: usize, name: &str, default: f64) -> Result<f64> {
        Ok(self.real_opt(index, name)?.unwrap_or(default))
    }

    /// Three reals that default to zero.
    pub fn vector(&self, index: usize, name: &str) -> Result<[f64; 3]> {
        Ok([
            self.real_or(index, name, 0.0)?,
            self.real_or(index + 1, name, 0.0)?,
            self.real_or(index + 2, name, 0.0)?,
        ])
    }

    /// A set of components; blank is none.
    pub fn components(&self, index: usize, name: &str) -> Result<Components> {
        Components::parse(self.text(index)).ok_or_else(|| self.wrong(index, name, "a set of the digits 1 to 6", ""))
    }

    /// One component as an index 0 to 5; blank or 0 means a scalar point.
    pub fn component(&self, index: usize, name: &str) -> Result<usize> {
        match self.text(index) {
            "" | "0" => Ok(0),
            text => match text.parse::<usize>() {
                Ok(c @ 1..=6) => Ok(c - 1),
                _ => Err(self.wrong(index, name, "one digit from 0 to 6", "")),
            },
        }
    }

    /// A word without blanks, or none when blank.
    pub fn word(&self, index: usize) -> Option<&'a str> {
        Some(self.text(index)).filter(|t| !t.is_empty())
    }

    /// A list of positive numbers from `index` to the end, with `THRU`, `BY` and `EXCEPT`.
    pub fn ids(&self, index: usize, name: &str) -> Result<Vec<u32>> {
        /// A range longer than this is a slip of the pen, not a list.
        const LONGEST: u32 = 10_000_000;
        let mut list: Vec<u32> = Vec::new();
        let mut i = index;
        while i < self.len() {
            match self.text(i) {
                "" => i += 1,
                "THRU" => {
                    let Some(from) = list.last().copied() else {
                        return Err(self.wrong(i, name, "a number before THRU", ""));
                    };
                    let to = self.id(i + 1, name)?;
                    if to < from {
                        return Err(self.wrong(i + 1, name, &format!("a number of at least {from} after THRU"), ""));
                    }
                    i += 2;
                    let mut step = 1;
                    if self.text(i) == "BY" {
                        step = self.id(i + 1, name)?;
                        i += 2;
                    }
                    if to - from > LONGEST {
                        return Err(self.wrong(
                            i.saturating_sub(1),
                            name,
                            &format!("a range of at most {LONGEST}"),
                            "",
                        ));
                    }
                    let mut next = from;
                    while next < to {
                        // The last number of `1 THRU 10 BY 4` is 10 even if the steps pass it by.
                        next = next.saturating_add(step).min(to);
                        list.push(next);
                    }
                    if self.text(i) == "EXCEPT" {
                        i += 1;
                        while i < self.len() && self.text(i) != "THRU" {
                            if let Some(id) = self.id_opt(i, name)? {
                                if id > to {
                                    break;
                                }
                                list.retain(|x| *x != id);
                            }
                            i += 1;
                        }
                    }
                }
                _ => {
                    list.push(self.id(i, name)?);
                    i += 1;
                }
            }
        }
        Ok(list)
    }

    /// Reals from `index` to the end of the card, blanks passed over.
    pub fn reals(&self, index: usize, name: &str) -> Result<Vec<f64>> {
        let mut list = Vec::new();
        for i in index..self.len() {
            if let Some(x) = self.real_opt(i, name)? {
                list.push(x);
            }
        }
        Ok(list)
    }
}
