//! The U.S. Standard Atmosphere 1976 up to 86 km of geometric altitude.
//!
//! Source: NOAA, NASA, USAF: U.S. Standard Atmosphere, 1976, NOAA-S/T 76-1562: table 4 (layers), equations (19), (33a),
//! (33b), (42), (50).

/// Gas constant of air, J/(kg K): 8314.32 J/(kmol K) over 28.9644 kg/kmol (the standard's own figures).
pub const GAS_CONSTANT_J_KG_K: f64 = 8314.32 / 28.9644;
/// Ratio of specific heats of air.
pub const GAMMA: f64 = 1.4;
/// Standard gravity, m/s^2.
const G0: f64 = 9.806_65;
/// Earth's effective radius of the standard, m.
const EARTH_RADIUS_M: f64 = 6_356_766.0;

/// Base geopotential altitude (m) and temperature gradient (K/m) of each layer.
const LAYERS: [(f64, f64); 7] = [
    (0.0, -0.0065),
    (11_000.0, 0.0),
    (20_000.0, 0.001),
    (32_000.0, 0.0028),
    (47_000.0, 0.0),
    (51_000.0, -0.0028),
    (71_000.0, -0.002),
];

/// Air at one altitude.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Air {
    /// Temperature, K.
    pub temperature_k: f64,
    /// Pressure, Pa.
    pub pressure_pa: f64,
    /// Density, kg/m^3.
    pub density_kg_m3: f64,
    /// Speed of sound, m/s.
    pub speed_of_sound_m_s: f64,
}

/// An altitude outside of the tables.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("altitude {0} m is outside of the standard atmosphere: needed -5000 m to 86000 m")]
pub struct AltitudeError(pub f64);

/// Standard air at a geometric altitude in metres.
///
/// # Errors
/// Altitudes below -5 km or above 86 km, and NaN.
pub fn standard(altitude_m: f64) -> Result<Air, AltitudeError> {
    if !(-5_000.0..=86_000.0).contains(&altitude_m) {
        return Err(AltitudeError(altitude_m));
    }
    let h = EARTH_RADIUS_M * altitude_m / (EARTH_RADIUS_M + altitude_m);
    let mut temperature = 288.15;
    let mut pressure = 101_325.0;
    for (i, &(base, gradient)) in LAYERS.iter().enumerate() {
        let top = LAYERS.get(i + 1).map_or(f64::INFINITY, |l| l.0);
        let dh = h.min(top) - base;
        let next = temperature + gradient * dh;
        pressure *= if gradient == 0.0 {
            (-G0 * dh / (GAS_CONSTANT_J_KG_K * temperature)).exp()
        } else {
            (temperature / next).powf(G0 / (GAS_CONSTANT_J_KG_K * gradient))
        };
        temperature = next;
        if h <= top {
            break;
        }
    }
    Ok(Air {
        temperature_k: temperature,
        pressure_pa: pressure,
        density_kg_m3: pressure / (GAS_CONSTANT_J_KG_K * temperature),
        speed_of_sound_m_s: (GAMMA * GAS_CONSTANT_J_KG_K * temperature).sqrt(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// U.S. Standard Atmosphere 1976, table I (geometric altitude): temperature, pressure, density, speed of sound.
    #[test]
    fn equals_the_published_table() {
        for (z, t, p, rho, a) in [
            (0.0, 288.150, 101_325.0, 1.2250, 340.29),
            (5_000.0, 255.676, 54_048.0, 0.736_43, 320.55),
            (11_000.0, 216.774, 22_700.0, 0.364_80, 295.15),
            (20_000.0, 216.650, 5_529.3, 0.088_910, 295.07),
            (30_000.0, 226.509, 1_197.0, 0.018_410, 301.71),
            (50_000.0, 270.650, 79.779, 0.001_026_9, 329.80),
        ] {
            let air = standard(z).unwrap();
            assert!((air.temperature_k - t).abs() < 1e-3, "{z} m: {air:?}");
            assert!((air.pressure_pa / p - 1.0).abs() < 1e-4, "{z} m: {air:?}");
            assert!((air.density_kg_m3 / rho - 1.0).abs() < 1e-4, "{z} m: {air:?}");
            assert!((air.speed_of_sound_m_s - a).abs() < 0.01, "{z} m: {air:?}");
        }
    }

    #[test]
    fn refuses_altitudes_it_does_not_know() {
        assert!(standard(100_000.0).is_err());
        assert!(standard(f64::NAN).is_err());
    }
}
