//! Colours: series that the colour-blind can tell apart, and maps for fields.

/// Colours of series in order: Okabe and Ito, "Color Universal Design" (2008), without the yellow (too light for lines
/// on white) and with black kept for experiments.
pub const SERIES: [&str; 6] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"];

/// Experiments are black in every figure.
pub const EXPERIMENT: &str = "#000000";

/// Warnings and worst places.
pub const ALERT: &str = "#c1121f";

/// A colour of the form `#rrggbb` as it stands, anything else as black: colours go into the picture unescaped.
pub(crate) fn checked(color: &str) -> String {
    let good = color.len() == 7 && color.starts_with('#') && color[1..].bytes().all(|b| b.is_ascii_hexdigit());
    if good { color.to_owned() } else { EXPERIMENT.to_owned() }
}

/// What a colour map is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColorMap {
    /// From least to most: viridis (van der Walt and Smith), nine of its colours.
    Sequential,
    /// About zero, blue below and red above: ColorBrewer's RdBu.
    Diverging,
}

const VIRIDIS: [u32; 9] = [
    0x440154, 0x472d7b, 0x3b528b, 0x2c728e, 0x21918c, 0x28ae80, 0x5ec962, 0xaddc30, 0xfde725,
];
const BLUE_RED: [u32; 9] = [
    0x2166ac, 0x4393c3, 0x92c5de, 0xd1e5f0, 0xf7f7f7, 0xfddbc7, 0xf4a582, 0xd6604d, 0xb2182b,
];

impl ColorMap {
    /// Colour at `t` in 0..=1 as `#rrggbb`; grey where `t` is not a number.
    #[must_use]
    pub fn at(self, t: f64) -> String {
        if !t.is_finite() {
            return "#bdbdbd".to_owned();
        }
        let stops = match self {
            Self::Sequential => VIRIDIS,
            Self::Diverging => BLUE_RED,
        };
        let place = t.clamp(0.0, 1.0) * (stops.len() - 1) as f64;
        let below = (place.floor() as usize).min(stops.len() - 2);
        let part = place - below as f64;
        let mix = |shift: u32| {
            let a = f64::from((stops[below] >> shift) & 0xff);
            let b = f64::from((stops[below + 1] >> shift) & 0xff);
            (a + part * (b - a)).round() as u8
        };
        format!("#{:02x}{:02x}{:02x}", mix(16), mix(8), mix(0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_reach_both_ends_and_forgive_what_lies_outside() {
        assert_eq!(ColorMap::Sequential.at(0.0), "#440154");
        assert_eq!(ColorMap::Sequential.at(1.0), "#fde725");
        assert_eq!(ColorMap::Diverging.at(0.5), "#f7f7f7");
        assert_eq!(ColorMap::Diverging.at(7.0), ColorMap::Diverging.at(1.0));
        assert_eq!(ColorMap::Diverging.at(f64::NAN), "#bdbdbd");
    }
}
