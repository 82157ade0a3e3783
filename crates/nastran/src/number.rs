//! Numbers as Nastran writes them: `7.175-2`, `1.D+3`, `.5`, `3.`, `-2`.

/// What a field holds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Number {
    /// An integer: digits with an optional sign.
    Integer(i64),
    /// A real: it has a decimal point or an exponent.
    Real(f64),
}

/// Reads a field as a number.
///
/// Nastran's reals may leave out the exponent's letter (`1.145-7`), may write it `D`, and need a decimal point or an
/// exponent; a bare run of digits is an integer. None for text, for embedded blanks and for values that overflow.
pub fn number(text: &str) -> Option<Number> {
    let text = text.trim();
    let bytes = text.as_bytes();
    let (&first, rest) = bytes.split_first()?;
    let unsigned = if first == b'+' || first == b'-' { rest } else { bytes };
    if unsigned.is_empty() {
        return None;
    }
    if unsigned.iter().all(u8::is_ascii_digit) {
        return text.strip_prefix('+').unwrap_or(text).parse().ok().map(Number::Integer);
    }
    // The mantissa ends at an exponent letter or at a sign that is not the first character.
    let start = bytes.len() - unsigned.len();
    let split = unsigned
        .iter()
        .position(|b| !(b.is_ascii_digit() || *b == b'.'))
        .map_or(bytes.len(), |i| i + start);
    let (mantissa, exponent) = (text.get(..split)?, text.get(split..)?);
    let digits = mantissa.bytes().filter(u8::is_ascii_digit).count();
    let points = mantissa.bytes().filter(|b| *b == b'.').count();
    if digits == 0 || points > 1 {
        return None;
    }
    let exponent = exponent.strip_prefix(['e', 'E', 'd', 'D']).unwrap_or(exponent);
    let exponent = if exponent.is_empty() {
        // `1.E` has lost its exponent; `1.` never had one.
        if split < bytes.len() {
            return None;
        }
        0
    } else {
        let unsigned = exponent.strip_prefix(['+', '-']).unwrap_or(exponent);
        if unsigned.is_empty() || !unsigned.bytes().all(|b| b.is_ascii_digit()) {
            return None;
        }
        exponent.strip_prefix('+').unwrap_or(exponent).parse::<i32>().ok()?
    };
    let value: f64 = format!("{mantissa}e{exponent}").parse().ok()?;
    value.is_finite().then_some(Number::Real(value))
}

/// Reads a field as a real number, an integer included.
pub fn real(text: &str) -> Option<f64> {
    match number(text)? {
        Number::Integer(i) => Some(i as f64),
        Number::Real(x) => Some(x),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nastran_reals_are_read_as_nastran_reads_them() {
        for (text, value) in [
            ("1.145-7", 1.145e-7),
            ("1.D+3", 1000.0),
            ("1.d3", 1000.0),
            (".5", 0.5),
            ("3.", 3.0),
            ("-.5+2", -50.0),
            ("+7.0E-1", 0.7),
            ("7+1", 70.0),
            ("7E1", 70.0),
        ] {
            assert_eq!(number(text), Some(Number::Real(value)), "{text}");
        }
        assert_eq!(number("-12"), Some(Number::Integer(-12)));
        assert_eq!(number("+12"), Some(Number::Integer(12)));
    }

    #[test]
    fn text_that_is_no_number_is_none() {
        for text in [
            "",
            "+",
            "-",
            ".",
            "1.E",
            "1.-",
            "1..2",
            "THRU",
            "1.0 2",
            "1.0E+",
            "e5",
            "1,0",
            "99999999999999999999",
            "1.0+999",
            "nan",
            "inf",
            "0x10",
            "1.0e1.0",
        ] {
            assert_eq!(number(text), None, "{text}");
        }
    }
}
