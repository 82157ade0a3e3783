//! Numbers as text.

/// How the numbers of a column are written (CSV always gets all digits).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum NumberFormat {
    /// This many decimals: `Fixed(3)` gives 0.308.
    Fixed(usize),
    /// This many significant digits, with an exponent where the plain form would be long.
    Significant(usize),
    /// Mantissa with this many decimals and an exponent: `Scientific(2)` gives 3.08e-1.
    Scientific(usize),
    /// Per cent of a ratio with its sign, this many decimals: `Percent(1)` gives +1.4 % for 0.014.
    Percent(usize),
}

/// A number in the given format; zero never carries a minus, and what is not finite is named.
#[must_use]
pub fn write_number(number: f64, format: NumberFormat) -> String {
    if number.is_nan() {
        return "NaN".to_owned();
    }
    if number.is_infinite() {
        return if number > 0.0 { "inf" } else { "-inf" }.to_owned();
    }
    let text = match format {
        NumberFormat::Fixed(decimals) => format!("{number:.decimals$}"),
        NumberFormat::Scientific(decimals) => format!("{number:.decimals$e}"),
        NumberFormat::Percent(decimals) => format!("{:+.decimals$} %", 100.0 * number),
        NumberFormat::Significant(digits) => significant(number, digits.max(1)),
    };
    // "-0.00" is a zero that was rounded; its sign says nothing.
    match text.strip_prefix('-') {
        Some(rest) if !rest.contains(|c: char| ('1'..='9').contains(&c)) => rest.to_owned(),
        _ => text,
    }
}

fn significant(number: f64, digits: usize) -> String {
    // The exponent after rounding: 9.9996 with four digits is 10.00.
    let scientific = format!("{number:.*e}", digits - 1);
    let exponent: i32 = scientific
        .split_once('e')
        .and_then(|(_, e)| e.parse().ok())
        .unwrap_or(0);
    if number != 0.0 && !(-4..=6).contains(&exponent) {
        return scientific;
    }
    let decimals = (digits as i32 - 1 - exponent).max(0) as usize;
    format!("{number:.decimals$}")
}

/// The shortest text that reads back as the same number.
pub(crate) fn all_digits(number: f64) -> String {
    let size = number.abs();
    if number == 0.0 || !number.is_finite() || (1e-4..1e15).contains(&size) {
        format!("{number}")
    } else {
        format!("{number:e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_as_asked() {
        assert_eq!(write_number(0.30756, NumberFormat::Fixed(3)), "0.308");
        assert_eq!(write_number(-0.0001, NumberFormat::Fixed(2)), "0.00");
        assert_eq!(write_number(9.99996, NumberFormat::Significant(4)), "10.00");
        assert_eq!(write_number(123456.0, NumberFormat::Significant(3)), "123456");
        assert_eq!(write_number(1.5e-9, NumberFormat::Significant(3)), "1.50e-9");
        assert_eq!(write_number(0.0, NumberFormat::Significant(3)), "0.00");
        assert_eq!(write_number(0.0142, NumberFormat::Percent(1)), "+1.4 %");
        assert_eq!(write_number(f64::NAN, NumberFormat::Fixed(2)), "NaN");
    }

    #[test]
    fn csv_numbers_read_back() {
        for v in [0.1, 1.0 / 3.0, 1e-300, -2.5e17, 5e-324, 12345.678] {
            assert_eq!(all_digits(v).parse::<f64>().unwrap(), v);
        }
    }
}
