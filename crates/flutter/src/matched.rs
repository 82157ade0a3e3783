//! Matched points: flutter where Mach number, speed and air belong together.
//!
//! Three searches lead there. [`crate::Sweep::Altitude`] varies altitude at the Mach number of one set of forces: every
//! point is matched. [`matched_mach`] keeps the altitude and varies the Mach number until the flutter speed is M a. And
//! [`solve_points`] solves single conditions, each with forces of its own (Nastran's PKNL).

use crate::error::{Result, check_value};
use crate::problem::{FlutterProblem, Settings, Sweep};
use crate::solution::{Crossing, Method, ModePoint};

/// A matched flutter point.
#[derive(Debug, Clone, PartialEq)]
pub struct MatchedPoint {
    /// Mach number.
    pub mach: f64,
    /// The crossing at this Mach number.
    pub crossing: Crossing,
    /// What is left of U / (M a) - 1.
    pub mismatch: f64,
}

/// Mach number at which the flutter speed equals M a, in `mach_low` to `mach_high`, by bisection and secants.
///
/// `flutter_at` gives the flutter crossing at a Mach number for the density of the altitude, `None` where there is no
/// flutter (taken as: above M a). Returns `None` when U - M a does not change sign.
///
/// # Errors
/// Those of `flutter_at`, and a bracket or speed of sound that makes no sense.
pub fn matched_mach(
    flutter_at: &dyn Fn(f64) -> Result<Option<Crossing>>,
    sound_speed_m_s: f64,
    (mach_low, mach_high): (f64, f64),
    tolerance: f64,
) -> Result<Option<MatchedPoint>> {
    check_value(
        "speed of sound, m/s",
        sound_speed_m_s,
        "above zero",
        sound_speed_m_s > 0.0,
    )?;
    check_value("least Mach number", mach_low, "above zero", mach_low > 0.0)?;
    check_value(
        "greatest Mach number",
        mach_high,
        "above the least",
        mach_high > mach_low,
    )?;
    check_value("tolerance", tolerance, "above zero", tolerance > 0.0)?;
    let evaluate = |mach: f64| -> Result<(f64, Option<Crossing>)> {
        let crossing = flutter_at(mach)?;
        let excess = crossing
            .as_ref()
            .map_or(1.0, |c| c.speed_m_s / (mach * sound_speed_m_s) - 1.0);
        Ok((excess, crossing))
    };
    let (mut low, mut high) = (mach_low, mach_high);
    let (mut f_low, c_low) = evaluate(low)?;
    let (mut f_high, c_high) = evaluate(high)?;
    for (mach, excess, crossing) in [(low, f_low, c_low), (high, f_high, c_high)] {
        if let Some(crossing) = crossing
            && excess.abs() <= tolerance
        {
            return Ok(Some(MatchedPoint {
                mach,
                crossing,
                mismatch: excess,
            }));
        }
    }
    if f_low * f_high > 0.0 {
        return Ok(None);
    }
    let mut last_side = 0;
    for iteration in 0..60 {
        let s = if iteration % 4 == 3 {
            0.5
        } else {
            (f_low / (f_low - f_high)).clamp(0.01, 0.99)
        };
        let mach = low + s * (high - low);
        let (excess, crossing) = evaluate(mach)?;
        if let Some(crossing) = crossing
            && (excess.abs() <= tolerance || high - low <= 1e-12)
        {
            return Ok(Some(MatchedPoint {
                mach,
                crossing,
                mismatch: excess,
            }));
        }
        // Illinois: the value at an end that stays twice is halved.
        let side = if excess * f_high > 0.0 { 1 } else { -1 };
        if side > 0 {
            f_low *= if last_side == side { 0.5 } else { 1.0 };
            (high, f_high) = (mach, excess);
        } else {
            f_high *= if last_side == side { 0.5 } else { 1.0 };
            (low, f_low) = (mach, excess);
        }
        last_side = side;
    }
    Ok(None)
}

/// One condition with its own forces: Mach number (in the problem), density and speed (Nastran's PKNL).
#[derive(Debug, Clone, Copy)]
pub struct FlightPoint<'a> {
    /// Structure and forces at this point's Mach number.
    pub problem: FlutterProblem<'a>,
    /// Density, kg/m3.
    pub density_kg_m3: f64,
    /// Speed, m/s.
    pub speed_m_s: f64,
}

/// Roots of each point on its own, `[point][mode]`: no looping over combinations, and no point depends on another. Modes are
/// named at every point by raising the density from zero.
///
/// # Errors
/// As [`crate::solve`]; a K method.
pub fn solve_points(points: &[FlightPoint<'_>], method: Method, settings: &Settings) -> Result<Vec<Vec<ModePoint>>> {
    if !method.is_p_method() {
        return Err(crate::FlutterError::Unsupported {
            method: method.name().into(),
            request: "solve at given speeds".into(),
            advice: "use PK or g".into(),
        });
    }
    let settings = Settings {
        audit: false,
        ..settings.clone()
    };
    points
        .iter()
        .map(|point| {
            let speeds = [point.speed_m_s];
            let sweep = Sweep::Speed {
                density_kg_m3: point.density_kg_m3,
                speeds_m_s: &speeds,
            };
            let solution = crate::solve(&point.problem, method, &sweep, &settings)?;
            Ok(solution
                .modes
                .into_iter()
                .filter_map(|m| m.points.into_iter().next())
                .collect())
        })
        .collect()
}
