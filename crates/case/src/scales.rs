//! Reduced frequency: the one place that defines it for case files. (The speed index is `dip-flutter`'s.)

/// Reduced frequency `k = omega b / U`, with `b` the ROOT SEMICHORD (half the root chord).
///
/// With time scaled by the root chord, `omega t = 2 k tau`.
pub fn reduced_frequency(omega_rad_s: f64, semichord_m: f64, speed_m_s: f64) -> f64 {
    omega_rad_s * semichord_m / speed_m_s
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn reduced_frequency_uses_the_semichord() {
        let k = reduced_frequency(2.0 * std::f64::consts::PI * 17.98, 0.279_35, 231.37);
        assert!((k - 0.136).abs() < 5e-4, "{k}");
    }
}
