//! What to know of corrected flutter points: Mach numbers left out, points beyond the recordings, weights from unsteady runs alone.

use super::MachCorrection;
use dip_correct::weight::schedule::Place;
use dip_flutter as fl;

/// Notes in words; `asked` are the case's Mach numbers, `by` the flutter method whose points are spoken of.
pub fn notes(asked: &[f64], by: fl::Method, machs: &[MachCorrection]) -> Vec<String> {
    let of_recordings = machs
        .iter()
        .flat_map(|m| m.notes.iter().map(|note| format!("Mach {}, {note}", m.mach)));
    let mut notes: Vec<String> = of_recordings.collect();
    let missing: Vec<String> = asked
        .iter()
        .filter(|m| !machs.iter().any(|c: &MachCorrection| c.mach == **m))
        .map(ToString::to_string)
        .collect();
    if !missing.is_empty() {
        notes.push(format!("no recordings at Mach {}: left out", missing.join(", ")));
    }
    for s in machs
        .iter()
        .flat_map(|m| &m.solutions)
        .filter(|s| s.solution.method == by)
    {
        let r = &s.row;
        let (Some(place @ (Place::Below | Place::Blended)), Some(k)) = (r.rests_on, r.row.reduced_frequency) else {
            continue;
        };
        let words = match place {
            Place::Below => "below the lowest recorded one, whose weights are held".to_owned(),
            _ => format!(
                "beyond the highest recorded one: {:.0} % of the correction is left",
                100.0 * r.correction_strength.unwrap_or(0.0)
            ),
        };
        notes.push(format!(
            "Mach {}, {}: k = {k:.4} at flutter is {words}",
            r.row.mach, r.correction
        ));
    }
    for m in machs {
        for c in &m.correction.methods {
            if let Some(k) = c.steady_from_k.filter(|k| *k > 0.0) {
                notes.push(format!(
                    "Mach {}, {}: no steady slope recorded; weights are the real parts of those at k = {k:.4}",
                    m.mach,
                    c.method.name()
                ));
            }
        }
    }
    notes
}
