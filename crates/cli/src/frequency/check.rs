//! Numbers of `[reference]` and `[flutter]` that no type can check.

use dip_case::file::{FlutterTable, Method, ReferenceTable, Search};
use dip_case::wing::Wing;
use dip_case::{CaseError, Document};
use dip_flutter::SpeedIndexReference;

/// Reference quantities, checked.
///
/// # Errors
/// A quantity that is not positive.
pub fn reference(
    document: &Document,
    table: &ReferenceTable,
    wing: Option<&Wing>,
) -> Result<SpeedIndexReference, CaseError> {
    let semichord = match (table.semichord, wing) {
        (Some(b), _) => b.0,
        (None, Some(wing)) => wing.root_semichord_m(),
        (None, None) => {
            let help = "add semichord = \"... m\": half the root chord";
            return Err(document.error("reference", "missing key `semichord`", help));
        }
    };
    let values = [
        ("semichord", semichord),
        ("mass", table.mass.0),
        ("volume", table.volume.0),
        ("omega_alpha", table.omega_alpha.0),
    ];
    for (key, value) in values {
        if value.is_nan() || value <= 0.0 {
            let message = format!("{key} = {value}: needed a positive value");
            return Err(document.error(
                &format!("reference.{key}"),
                message,
                "give the value that the speed index uses",
            ));
        }
    }
    SpeedIndexReference::new(semichord, table.omega_alpha.0, table.mass.0, table.volume.0)
        .map_err(|e| document.error("reference", e.to_string(), "check the reference quantities"))
}

/// Checks the numbers of `[flutter]` that no type can.
pub fn flutter(document: &Document, table: &FlutterTable, machs: usize) -> Result<(), CaseError> {
    if table.methods.is_empty() {
        return Err(document.error(
            "flutter.methods",
            "no method",
            "give one or more of k, ke, pk, pk-british, g",
        ));
    }
    let count = |key: &str, n: usize| {
        if n == machs {
            Ok(())
        } else {
            let message = format!("{n} {key} for {machs} Mach numbers");
            Err(document.error(
                &format!("flutter.{key}"),
                message,
                "give one for each Mach number, in their order",
            ))
        }
    };
    if table.search == Search::Speed {
        match (&table.densities, &table.altitudes) {
            (Some(rho), None) => {
                count("densities", rho.len())?;
                if let Some(i) = rho.iter().position(|d| d.0 <= 0.0) {
                    let message = format!("density {} kg/m^3: needed a positive value", rho[i].0);
                    return Err(document.error(
                        &format!("flutter.densities.{i}"),
                        message,
                        "in kg/m^3 or with its unit",
                    ));
                }
            }
            (None, Some(h)) => count("altitudes", h.len())?,
            (Some(_), Some(_)) => {
                return Err(document.error(
                    "flutter.altitudes",
                    "both densities and altitudes",
                    "give only one of them",
                ));
            }
            (None, None) => {
                let help = "add densities = [...], one for each Mach number";
                return Err(document.error("flutter", "neither densities nor altitudes", help));
            }
        }
    } else if table.methods.iter().any(|m| matches!(m, Method::K | Method::Ke)) {
        let message = "K and KE have the speed as a result: they cannot follow the altitude of a matched point";
        return Err(document.error(
            "flutter.methods",
            message,
            "use pk, pk-british or g with search = \"matched-point\"",
        ));
    } else if table.densities.is_some() || table.altitudes.is_some() {
        let help = "search = \"matched-point\" finds the altitude: leave out densities and altitudes";
        return Err(document.error("flutter.search", "densities or altitudes beside a matched point", help));
    }
    let max = table.speed_max.map_or(680.0, |v| v.0);
    let min = table.speed_min.map_or(max / 40.0, |v| v.0);
    if !(min > 0.0 && max > min) {
        let message = format!("speeds from {min} to {max} m/s: needed 0 < speed_min < speed_max");
        return Err(document.error(
            "flutter.speed_min",
            message,
            "leave both out for a range that suits most wings",
        ));
    }
    if let Some(n) = table.speed_count
        && !(5..=10_000).contains(&n)
    {
        return Err(document.error(
            "flutter.speed_count",
            format!("{n} speeds: needed 5 to 10000"),
            "60 suit most cases",
        ));
    }
    let given = [
        table.structural_damping != 0.0,
        table.structural_damping_modes.is_some(),
        table.structural_damping_table.is_some(),
    ];
    if given.iter().filter(|g| **g).count() > 1 {
        let help = "give one of structural_damping, structural_damping_modes, structural_damping_table";
        return Err(document.error("flutter", "structural damping stands in more than one key", help));
    }
    Ok(())
}
