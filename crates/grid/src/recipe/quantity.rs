//! Lengths and angles with units.

use std::fmt;

use serde::de::{self, Deserialize, Deserializer, Visitor};

/// A length in metres: a plain number, or text such as `"0.5587 m"`, `"2 mm"`, `"30 in"`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Length(pub f64);

/// An angle in radians: a plain number, or text such as `"2.5 deg"`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Angle(pub f64);

/// Metres a unit (exact by definition).
const LENGTHS: [(&str, f64); 7] = [
    ("m", 1.0),
    ("mm", 1e-3),
    ("cm", 1e-2),
    ("km", 1e3),
    ("in", 0.0254),
    ("ft", 0.3048),
    ("um", 1e-6),
];

/// Radians a unit.
const ANGLES: [(&str, f64); 2] = [("rad", 1.0), ("deg", std::f64::consts::PI / 180.0)];

fn parse(text: &str, units: &[(&str, f64)], example: &str) -> Result<f64, String> {
    let text = text.trim();
    let end = text
        .char_indices()
        .find(|&(n, c)| {
            c.is_alphabetic()
                && !(matches!(c, 'e' | 'E')
                    && text[n + 1..].starts_with(|d: char| d.is_ascii_digit() || d == '-' || d == '+'))
        })
        .map_or(text.len(), |(n, _)| n);
    let (number, unit) = (text[..end].trim(), text[end..].trim());
    let value: f64 = number
        .parse()
        .map_err(|_| format!("\"{text}\" is not a number with a unit such as \"{example}\""))?;
    match units.iter().find(|(name, _)| *name == unit) {
        Some((_, factor)) => Ok(value * factor),
        None => {
            let known: Vec<&str> = units.iter().map(|(name, _)| *name).collect();
            Err(format!(
                "unknown unit in \"{text}\": one of {} is needed, such as \"{example}\"",
                known.join(", ")
            ))
        }
    }
}

struct QuantityVisitor {
    units: &'static [(&'static str, f64)],
    example: &'static str,
}

impl Visitor<'_> for QuantityVisitor {
    type Value = f64;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a number or text such as \"{}\"", self.example)
    }

    fn visit_f64<E>(self, v: f64) -> Result<f64, E> {
        Ok(v)
    }

    fn visit_i64<E>(self, v: i64) -> Result<f64, E> {
        Ok(v as f64)
    }

    fn visit_u64<E>(self, v: u64) -> Result<f64, E> {
        Ok(v as f64)
    }

    fn visit_str<E: de::Error>(self, v: &str) -> Result<f64, E> {
        parse(v, self.units, self.example).map_err(E::custom)
    }
}

impl<'de> Deserialize<'de> for Length {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer
            .deserialize_any(QuantityVisitor {
                units: &LENGTHS,
                example: "0.5587 m",
            })
            .map(Self)
    }
}

impl<'de> Deserialize<'de> for Angle {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer
            .deserialize_any(QuantityVisitor {
                units: &ANGLES,
                example: "2.5 deg",
            })
            .map(Self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_read_with_units() {
        let length = |text| parse(text, &LENGTHS, "1 m");
        assert_eq!(length("0.5587 m"), Ok(0.5587));
        assert_eq!(length("30in"), Ok(30.0 * 0.0254));
        assert_eq!(length("1e-3 m"), Ok(1e-3));
        assert_eq!(length("-2.5e2 mm"), Ok(-0.25));
        assert!(length("3 furlong").unwrap_err().contains("unknown unit"));
        assert!(length("wide").is_err());
        assert!(length("3").is_err());
    }
}
