//! Quantities with units, read from text such as `"289 m/s"` or `"0.1 slug/ft^3"`.
//!
//! A unit is a product of named units with whole exponents (`kg/m^3`, `lbf*s^2/in^4`, `rad/s`); it is reduced to a
//! factor to SI and the exponents of length, mass, time, temperature and plane angle. Angle counts as a dimension of
//! its own, so that degrees are never taken for radians and Hz (one turn a second) never for rad/s.

use serde::de::{self, Deserialize, Deserializer, Visitor};
use std::borrow::Cow;
use std::f64::consts::PI;
use std::fmt;

/// Exponents of length, mass, time, temperature and plane angle.
pub type Exponents = [i8; 5];

/// What is wrong with the text of a quantity.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum UnitError {
    /// A string without a unit.
    #[error("missing unit in \"{text}\": needed a number and a unit, such as \"{example}\"")]
    Missing {
        /// The text as it stands in the file.
        text: String,
        /// A correct value of the kind.
        example: &'static str,
    },
    /// A name that is no unit.
    #[error("unknown unit `{unit}` in \"{text}\": needed {kind}, such as \"{example}\"")]
    Unknown {
        /// The name that was not understood.
        unit: String,
        /// The text as it stands in the file.
        text: String,
        /// What kind of quantity is needed.
        kind: &'static str,
        /// A correct value of the kind.
        example: &'static str,
    },
    /// A unit of another kind of quantity.
    #[error("\"{text}\" is not {kind}: needed a unit such as in \"{example}\"")]
    Kind {
        /// The text as it stands in the file.
        text: String,
        /// What kind of quantity is needed.
        kind: &'static str,
        /// A correct value of the kind.
        example: &'static str,
    },
    /// Text that does not start with a number.
    #[error("no number in \"{text}\": needed {kind}, such as \"{example}\"")]
    Number {
        /// The text as it stands in the file.
        text: String,
        /// What kind of quantity is needed.
        kind: &'static str,
        /// A correct value of the kind.
        example: &'static str,
    },
}

/// A kind of quantity: how its values read and what they are in SI.
pub trait Kind {
    /// Exponents that a unit of this kind must have.
    const EXPONENTS: Exponents;
    /// Words for messages, with the article: "a speed".
    const NAME: &'static str;
    /// A correct value, for messages.
    const EXAMPLE: &'static str;
}

/// Factor to SI and exponents of one named unit; `None` where there is no such unit.
fn named(name: &str) -> Option<(f64, Exponents)> {
    const INCH: f64 = 0.0254;
    const FOOT: f64 = 0.3048;
    const POUND: f64 = 0.453_592_37;
    const GRAVITY: f64 = 9.806_65;
    const POUND_FORCE: f64 = POUND * GRAVITY;
    let length = [1, 0, 0, 0, 0];
    let mass = [0, 1, 0, 0, 0];
    let time = [0, 0, 1, 0, 0];
    let force = [1, 1, -2, 0, 0];
    let pressure = [-1, 1, -2, 0, 0];
    let speed = [1, 0, -1, 0, 0];
    Some(match name {
        "m" => (1.0, length),
        "mm" => (1e-3, length),
        "cm" => (1e-2, length),
        "km" => (1e3, length),
        "in" | "inch" => (INCH, length),
        "ft" => (FOOT, length),
        "kg" => (1.0, mass),
        "g" => (1e-3, mass),
        "t" => (1e3, mass),
        "lb" | "lbm" => (POUND, mass),
        "slug" => (POUND_FORCE / FOOT, mass),
        "slinch" => (POUND_FORCE / INCH, mass),
        "s" => (1.0, time),
        "ms" => (1e-3, time),
        "min" => (60.0, time),
        "h" => (3600.0, time),
        "K" => (1.0, [0, 0, 0, 1, 0]),
        "R" => (5.0 / 9.0, [0, 0, 0, 1, 0]),
        "rad" => (1.0, [0, 0, 0, 0, 1]),
        "deg" => (PI / 180.0, [0, 0, 0, 0, 1]),
        "rev" => (2.0 * PI, [0, 0, 0, 0, 1]),
        "Hz" => (2.0 * PI, [0, 0, -1, 0, 1]),
        "rpm" => (2.0 * PI / 60.0, [0, 0, -1, 0, 1]),
        "N" => (1.0, force),
        "kN" => (1e3, force),
        "lbf" => (POUND_FORCE, force),
        "Pa" => (1.0, pressure),
        "hPa" => (1e2, pressure),
        "kPa" => (1e3, pressure),
        "MPa" => (1e6, pressure),
        "GPa" => (1e9, pressure),
        "bar" => (1e5, pressure),
        "psi" => (POUND_FORCE / (INCH * INCH), pressure),
        "ksi" => (1e3 * POUND_FORCE / (INCH * INCH), pressure),
        "Msi" => (1e6 * POUND_FORCE / (INCH * INCH), pressure),
        "psf" => (POUND_FORCE / (FOOT * FOOT), pressure),
        "kt" | "kn" | "knots" => (1852.0 / 3600.0, speed),
        "mph" => (5280.0 * FOOT / 3600.0, speed),
        "1" => (1.0, [0; 5]),
        _ => return None,
    })
}

/// Factor to SI and exponents of a product of units such as `kg/m^3`; the name that failed otherwise.
fn product(text: &str) -> Result<(f64, Exponents), String> {
    let mut factor = 1.0;
    let mut exponents = [0_i8; 5];
    let mut sign = 1_i8;
    for piece in text.split_inclusive(['*', '/', ' ']) {
        let operator = piece.chars().last().filter(|c| matches!(c, '*' | '/' | ' '));
        let token = piece.trim_end_matches(['*', '/', ' ']);
        if !token.is_empty() {
            let (name, power) = match token.split_once('^') {
                Some((name, power)) => (name, power.parse::<i8>().map_err(|_| token.to_owned())?),
                // `m2`, `ft3`, `s-2`: the exponent without a caret, as tables print it.
                None => match token.find(|c: char| c.is_ascii_digit() || c == '-') {
                    Some(at) if at > 0 => (&token[..at], token[at..].parse::<i8>().map_err(|_| token.to_owned())?),
                    _ => (token, 1),
                },
            };
            let name = match name {
                "²" | "³" => return Err(token.to_owned()),
                _ => name,
            };
            let (unit, own) = named(name).ok_or_else(|| token.to_owned())?;
            let power = power.checked_mul(sign).ok_or_else(|| token.to_owned())?;
            factor *= unit.powi(i32::from(power));
            for (e, o) in exponents.iter_mut().zip(own) {
                *e = o
                    .checked_mul(power)
                    .and_then(|p| e.checked_add(p))
                    .ok_or_else(|| token.to_owned())?;
            }
        }
        match operator {
            Some('/') => sign = -1,
            Some('*') => sign = 1,
            _ => {}
        }
    }
    Ok((factor, exponents))
}

/// Reads a quantity of one kind to SI.
///
/// # Errors
/// A missing or unknown unit, or one of another kind.
pub fn parse<K: Kind>(text: &str) -> Result<f64, UnitError> {
    let normal: Cow<'_, str> = if text.contains(['²', '³', '·', '°']) {
        text.replace('²', "^2")
            .replace('³', "^3")
            .replace('·', "*")
            .replace('°', " deg")
            .into()
    } else {
        text.into()
    };
    let trimmed = normal.trim();
    // The number is the longest start of the text that reads as one: "1e-3 m", "2.5m", "-.5 deg".
    let ends = trimmed.char_indices().map(|(i, c)| i + c.len_utf8());
    let split = ends
        .take_while(|&end| {
            trimmed[..end]
                .chars()
                .all(|c| c.is_ascii_digit() || matches!(c, '.' | 'e' | 'E' | '+' | '-'))
        })
        .filter(|&end| trimmed[..end].parse::<f64>().is_ok())
        .last();
    let Some(split) = split else {
        return Err(UnitError::Number {
            text: text.to_owned(),
            kind: K::NAME,
            example: K::EXAMPLE,
        });
    };
    let (number, unit) = trimmed.split_at(split);
    let value: f64 = number.parse().map_err(|_| UnitError::Number {
        text: text.to_owned(),
        kind: K::NAME,
        example: K::EXAMPLE,
    })?;
    let unit = unit.trim();
    if unit.is_empty() {
        if K::EXPONENTS == [0; 5] {
            return Ok(value);
        }
        return Err(UnitError::Missing {
            text: text.to_owned(),
            example: K::EXAMPLE,
        });
    }
    let (factor, exponents) = product(unit).map_err(|unit| UnitError::Unknown {
        unit,
        text: text.to_owned(),
        kind: K::NAME,
        example: K::EXAMPLE,
    })?;
    if exponents != K::EXPONENTS {
        return Err(UnitError::Kind {
            text: text.to_owned(),
            kind: K::NAME,
            example: K::EXAMPLE,
        });
    }
    Ok(value * factor)
}

struct QuantityVisitor<K>(std::marker::PhantomData<K>);

impl<K: Kind> Visitor<'_> for QuantityVisitor<K> {
    type Value = f64;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} such as \"{}\" (a plain number is SI)", K::NAME, K::EXAMPLE)
    }

    fn visit_f64<E: de::Error>(self, v: f64) -> Result<f64, E> {
        Ok(v)
    }

    fn visit_i64<E: de::Error>(self, v: i64) -> Result<f64, E> {
        Ok(v as f64)
    }

    fn visit_u64<E: de::Error>(self, v: u64) -> Result<f64, E> {
        Ok(v as f64)
    }

    fn visit_str<E: de::Error>(self, v: &str) -> Result<f64, E> {
        parse::<K>(v).map_err(E::custom)
    }
}

/// Reads a quantity from a number (SI) or a string with a unit, and refuses what is not finite.
fn deserialize<'de, K: Kind, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    let value = deserializer.deserialize_any(QuantityVisitor::<K>(std::marker::PhantomData))?;
    if value.is_finite() {
        Ok(value)
    } else {
        Err(de::Error::custom(format_args!(
            "{value} is not a finite number: needed {}",
            K::NAME
        )))
    }
}

macro_rules! quantity {
    ($($(#[$doc:meta])* $name:ident, $unit:literal, $exponents:expr, $words:literal, $example:literal;)*) => {$(
        $(#[$doc])*
        #[doc = concat!("\n\nHeld in ", $unit, ".")]
        #[derive(Debug, Clone, Copy, PartialEq, PartialOrd, serde::Serialize)]
        pub struct $name(pub f64);

        impl Kind for $name {
            const EXPONENTS: Exponents = $exponents;
            const NAME: &'static str = $words;
            const EXAMPLE: &'static str = $example;
        }

        impl<'de> Deserialize<'de> for $name {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                deserialize::<Self, D>(deserializer).map(Self)
            }
        }

        impl schemars::JsonSchema for $name {
            fn schema_name() -> Cow<'static, str> {
                stringify!($name).into()
            }

            fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
                schemars::json_schema!({
                    "description": concat!($words, " with its unit, or a plain number in ", $unit),
                    "anyOf": [{ "type": "number" }, { "type": "string" }],
                    "examples": [$example]
                })
            }
        }
    )*};
}

quantity! {
    /// A length.
    Length, "m", [1, 0, 0, 0, 0], "a length", "0.5587 m";
    /// An area.
    Area, "m^2", [2, 0, 0, 0, 0], "an area", "0.3532 m^2";
    /// A volume.
    Volume, "m^3", [3, 0, 0, 0, 0], "a volume", "0.1301 m^3";
    /// A mass.
    Mass, "kg", [0, 1, 0, 0, 0], "a mass", "1.8627 kg";
    /// A moment of inertia.
    Inertia, "kg m^2", [2, 1, 0, 0, 0], "a moment of inertia", "0.01 kg*m^2";
    /// A mass density.
    Density, "kg/m^3", [-3, 1, 0, 0, 0], "a density", "0.2082 kg/m^3";
    /// A speed.
    Speed, "m/s", [1, 0, -1, 0, 0], "a speed", "289 m/s";
    /// An angular frequency; text may give Hz.
    Frequency, "rad/s", [0, 0, -1, 0, 1], "a frequency", "17.98 Hz";
    /// A plane angle.
    Angle, "rad", [0, 0, 0, 0, 1], "an angle", "1 deg";
    /// A pressure or an elastic modulus.
    Pressure, "Pa", [-1, 1, -2, 0, 0], "a pressure or modulus", "3.1511 GPa";
    /// A translational stiffness.
    Stiffness, "N/m", [0, 1, -2, 0, 0], "a stiffness", "1e5 N/m";
    /// A rotational stiffness.
    RotationalStiffness, "N m/rad", [2, 1, -2, 0, -1], "a rotational stiffness", "1e3 N*m/rad";
    /// A time.
    Time, "s", [0, 0, 1, 0, 0], "a time", "0.5 s";
    /// An absolute temperature.
    Temperature, "K", [0, 0, 0, 1, 0], "a temperature", "288.15 K";
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: f64, b: f64) {
        assert!((a - b).abs() <= 1e-12 * b.abs(), "{a} is not {b}");
    }

    #[test]
    fn reads_products_and_powers() {
        close(
            parse::<Density>("0.000404 slug/ft^3").unwrap(),
            0.000404 * 515.378_818_393_195_4,
        );
        close(
            parse::<Density>("1.145e-7 lbf*s^2/in^4").unwrap(),
            1.145e-7 * 4.448_221_615_260_5 / 0.0254_f64.powi(4),
        );
        close(parse::<Speed>("759.1 ft/s").unwrap(), 231.373_68);
        close(parse::<Frequency>("1 Hz").unwrap(), 2.0 * PI);
        close(parse::<Frequency>("60 rpm").unwrap(), 2.0 * PI);
        close(parse::<Angle>("-1.5deg").unwrap(), -1.5 * PI / 180.0);
        close(parse::<Angle>("1°").unwrap(), PI / 180.0);
        close(parse::<Pressure>("3.1511 GPa").unwrap(), 3.1511e9);
        close(parse::<Density>("1 kg m^-3").unwrap(), 1.0);
        close(parse::<Density>("1 kg/m3").unwrap(), 1.0);
        close(parse::<Density>("1 kg/m³").unwrap(), 1.0);
        close(parse::<RotationalStiffness>("2 kN*m/rad").unwrap(), 2000.0);
        close(parse::<Length>("1e-3 km").unwrap(), 1.0);
    }

    #[test]
    fn refuses_what_is_not_of_the_kind() {
        assert!(matches!(parse::<Speed>("289"), Err(UnitError::Missing { .. })));
        assert!(matches!(parse::<Speed>("289 m"), Err(UnitError::Kind { .. })));
        assert!(matches!(
            parse::<Speed>("289 furlong/s"),
            Err(UnitError::Unknown { .. })
        ));
        assert!(matches!(parse::<Speed>("fast"), Err(UnitError::Number { .. })));
        // Degrees a second are no Hz, and 1/s says not whether radians or turns.
        assert!(matches!(parse::<Frequency>("3 1/s"), Err(UnitError::Kind { .. })));
    }

    #[test]
    fn never_panics_on_odd_text() {
        for text in [
            "",
            " ",
            "/",
            "1 m^",
            "1 m^999",
            "e",
            "1e",
            "--",
            "1 ^2",
            "1 m^-",
            "µ",
            "1 µm",
            "1 m^127*m^127",
        ] {
            let _ = parse::<Length>(text);
        }
    }
}
