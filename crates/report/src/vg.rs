//! V-g and V-f: damping and frequency of every mode against speed, one above the other.

use crate::chart::{Chart, Legend, Marker, Series, Style};
use crate::error::ReportError;
use crate::figure::Figure;

/// One mode followed through speed.
#[derive(Debug, Clone, PartialEq)]
pub struct VgMode {
    /// Name in the legend.
    pub label: String,
    /// Speed `[point]`, m/s.
    pub speed_m_s: Vec<f64>,
    /// Structural damping g that keeps the oscillation going `[point]`: positive is unstable.
    pub damping_g: Vec<f64>,
    /// Frequency `[point]`, Hz.
    pub freq_hz: Vec<f64>,
}

/// What happens at a crossing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CrossingKind {
    /// Damping is lost at a frequency above zero.
    Flutter,
    /// Damping is lost at zero frequency.
    Divergence,
}

/// A crossing of g = 0 (or of the damping at hand).
#[derive(Debug, Clone, PartialEq)]
pub struct VgCrossing {
    /// Flutter or divergence.
    pub kind: CrossingKind,
    /// Speed, m/s.
    pub speed_m_s: f64,
    /// Frequency, Hz (0 for divergence).
    pub freq_hz: f64,
    /// Damping at which the crossing was sought, usually 0.
    pub damping_g: f64,
}

/// Curves of more than this are roots that run away (K and KE at low reduced frequency): they are cut off.
const DAMPING_SHOWN: f64 = 1.0;

/// V-g over V-f with a common axis of speed, crossings marked in both. Damping beyond +-1 is cut off at the frame.
///
/// # Errors
/// [`ReportError::Shape`] if a mode's arrays differ in length.
pub fn vg(title: impl Into<String>, modes: &[VgMode], crossings: &[VgCrossing]) -> Result<Figure, ReportError> {
    let title = title.into();
    let mut damping = Chart::new("", "Speed, m/s", "Damping g").hline(0.0, "");
    let mut frequency = Chart::new("", "Speed, m/s", "Frequency, Hz").legend(Legend::Hidden);
    let (mut least, mut most) = (0.0_f64, 0.0_f64);
    for (i, mode) in modes.iter().enumerate() {
        for (what, got) in [("damping", mode.damping_g.len()), ("frequency", mode.freq_hz.len())] {
            if got != mode.speed_m_s.len() {
                return Err(ReportError::Shape {
                    figure: title,
                    what: format!("{what} of \"{}\"", mode.label),
                    needed: mode.speed_m_s.len(),
                    got,
                });
            }
        }
        let pair = |values: &[f64]| mode.speed_m_s.iter().copied().zip(values.iter().copied()).collect();
        // Six colours, then the same six with other markers and dashes.
        let marker = Marker::ALL[i % Marker::ALL.len()];
        let style = if i < 6 {
            Style::LineMarkers(marker)
        } else {
            Style::DashedMarkers(marker)
        };
        damping = damping.series(Series::new(&mode.label, pair(&mode.damping_g), style));
        frequency = frequency.series(Series::new(&mode.label, pair(&mode.freq_hz), style));
        for g in mode.damping_g.iter().filter(|g| g.is_finite()) {
            least = least.min(*g);
            most = most.max(*g);
        }
    }
    if least < -DAMPING_SHOWN || most > DAMPING_SHOWN {
        let (lo, hi) = (least.max(-DAMPING_SHOWN), most.min(DAMPING_SHOWN));
        let room = 0.05 * (hi - lo);
        damping = damping.y_range(lo - room, hi + room);
    }
    for c in crossings {
        let (name, detail) = match c.kind {
            CrossingKind::Flutter => ("flutter", format!("{:.4} Hz", Short(c.freq_hz))),
            CrossingKind::Divergence => ("divergence", "0 Hz".to_owned()),
        };
        damping = damping.mark(
            c.speed_m_s,
            c.damping_g,
            format!("{name} {:.4} m/s", Short(c.speed_m_s)),
        );
        frequency = frequency.mark(c.speed_m_s, c.freq_hz, detail);
        damping = damping.vline(c.speed_m_s, "");
        frequency = frequency.vline(c.speed_m_s, "");
    }
    Ok(Figure::new(title).row(vec![damping]).row(vec![frequency]).share_x())
}

/// A number with the precision's significant digits.
struct Short(f64);

impl std::fmt::Display for Short {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let digits = f.precision().unwrap_or(4);
        f.write_str(&crate::number::write_number(
            self.0,
            crate::number::NumberFormat::Significant(digits),
        ))
    }
}
