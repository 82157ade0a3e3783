//! Reduced frequency and the flutter speed index: the one place that defines them.

/// Reduced frequency `k = omega b / U`, with `b` the ROOT SEMICHORD (half the root chord).
///
/// With time scaled by the root chord, `omega t = 2 k tau`.
pub fn reduced_frequency(omega_rad_s: f64, semichord_m: f64, speed_m_s: f64) -> f64 {
    omega_rad_s * semichord_m / speed_m_s
}

/// What makes a flutter point non-dimensional. One set serves all curves of a comparison.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reference {
    /// Root semichord b, m.
    pub semichord_m: f64,
    /// Mass m of the wing (one panel), kg.
    pub mass_kg: f64,
    /// Volume V of the conical frustum about the panel, m^3.
    pub volume_m3: f64,
    /// Frequency of the first torsion mode, rad/s.
    pub omega_alpha_rad_s: f64,
}

impl Reference {
    /// Mass ratio `mu = m / (rho V)`.
    pub fn mass_ratio(&self, density_kg_m3: f64) -> f64 {
        self.mass_kg / (density_kg_m3 * self.volume_m3)
    }

    /// Flutter speed index `FSI = U / (b omega_alpha sqrt(mu))`; Yates, AGARD R-765.
    pub fn flutter_speed_index(&self, speed_m_s: f64, density_kg_m3: f64) -> f64 {
        speed_m_s / (self.semichord_m * self.omega_alpha_rad_s * self.mass_ratio(density_kg_m3).sqrt())
    }

    /// Flutter frequency over the frequency of the first torsion mode.
    pub fn frequency_ratio(&self, omega_rad_s: f64) -> f64 {
        omega_rad_s / self.omega_alpha_rad_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// AGARD R-765, weakened model 3 in air: mass ratio and index from speed and density.
    #[test]
    fn gives_the_published_indices() {
        let reference = Reference {
            semichord_m: 0.279_35,
            mass_kg: 1.8627,
            volume_m3: 0.1301,
            omega_alpha_rad_s: 239.3,
        };
        for (rho, u, mu, fsi) in [
            (0.427_76, 172.46, 33.465, 0.4459),
            (0.208_21, 231.37, 68.753, 0.4174),
            (0.099_47, 296.69, 143.92, 0.3700),
        ] {
            assert!((reference.mass_ratio(rho) / mu - 1.0).abs() < 2e-3);
            assert!((reference.flutter_speed_index(u, rho) - fsi).abs() < 4e-4);
        }
    }

    #[test]
    fn reduced_frequency_uses_the_semichord() {
        let k = reduced_frequency(2.0 * std::f64::consts::PI * 17.98, 0.279_35, 231.37);
        assert!((k - 0.136).abs() < 5e-4, "{k}");
    }
}
