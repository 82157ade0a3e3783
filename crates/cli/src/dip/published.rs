//! Boundaries from CSV files: experiments and the results of others.

use super::study::Point;
use dip_case::CaseError;
use dip_case::table::Table;
use dip_flutter::SpeedIndexReference;
use std::path::Path;

/// Points of a CSV file with columns `mach`, and `density_kg_m3`, `speed_m_s`, `frequency_hz` or `flutter_speed_index`,
/// `frequency_ratio`. Indices from speeds are on the study's reference quantities; printed ones stand as they are.
///
/// # Errors
/// A file that can't be read, missing columns, cells that are no numbers.
pub fn points(path: &Path, reference: &SpeedIndexReference) -> Result<Vec<Point>, CaseError> {
    let table = Table::read(path)?;
    let mach = table.numbers("mach")?;
    let column = |name: &str| -> Result<Vec<Option<f64>>, CaseError> {
        if table.has(name) {
            table.optional_numbers(name)
        } else {
            Ok(vec![None; mach.len()])
        }
    };
    if !table.has("flutter_speed_index") {
        table.numbers("density_kg_m3")?;
        table.numbers("speed_m_s")?;
    }
    let (density, speed, frequency) = (column("density_kg_m3")?, column("speed_m_s")?, column("frequency_hz")?);
    let (index, ratio) = (column("flutter_speed_index")?, column("frequency_ratio")?);
    let point = |i: usize| {
        let computed = density[i].zip(speed[i]).map(|(rho, u)| reference.speed_index(u, rho));
        Point {
            mach: mach[i],
            density_kg_m3: density[i],
            speed_m_s: speed[i],
            frequency_hz: frequency[i],
            flutter_speed_index: index[i].or(computed),
            frequency_ratio: ratio[i].or(frequency[i].map(|f| reference.frequency_ratio(f))),
        }
    };
    Ok((0..mach.len()).map(point).collect())
}
