//! Pressure along the chord at the stations of `[cuts]`, and what was measured there.

use crate::exit::Stop;
use dip_case::Document;
use dip_case::file::SteadyFile;
use dip_case::table::Table;
use dip_grid::MultiBlock;
use dip_pmb::cut;
use dip_pmb::loads::WallPatch;

/// A station asked for.
#[derive(Debug, Clone)]
pub struct Station {
    /// Span station.
    pub y_m: f64,
    /// As a fraction of the semispan, where that is known.
    pub eta: Option<f64>,
}

/// A pressure distribution. Points are `[x in m, z in m, x over the local chord, Cp]`, by x.
#[derive(Debug, Clone)]
pub struct Cut {
    /// Name in figures.
    pub label: String,
    /// Where; none on a two-dimensional grid.
    pub station: Option<Station>,
    /// Upper side.
    pub upper: Vec<[f64; 4]>,
    /// Lower side.
    pub lower: Vec<[f64; 4]>,
}

/// A measured point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// Station; none where the table has no column for it.
    pub eta: Option<f64>,
    /// Over the local chord, from the leading edge.
    pub x_over_c: f64,
    /// Pressure coefficient.
    pub cp: f64,
}

/// The stations of `[cuts]` in order of y.
///
/// # Errors
/// Fractions without a semispan or outside of 0 to 1.
pub fn stations(document: &Document, file: &SteadyFile) -> Result<Vec<Station>, Stop> {
    let semispan = file.reference.as_ref().and_then(|r| r.semispan).map(|s| s.0);
    if let Some(s) = semispan.filter(|s| *s <= 0.0) {
        let message = format!("semispan {s} m: needed a positive length");
        return Err(document
            .error("reference.semispan", message, "the distance from root to tip")
            .into());
    }
    let mut stations = Vec::new();
    for (n, eta) in file.cuts.eta.iter().enumerate() {
        let key = format!("cuts.eta.{n}");
        let Some(semispan) = semispan else {
            let help = "add semispan to [reference], or give the stations as lengths: y = [\"0.5 m\"]";
            return Err(document
                .error(&key, "eta is a fraction of a semispan that is not given", help)
                .into());
        };
        if !(0.0..=1.0).contains(eta) {
            let message = format!("eta {eta}: needed 0 to 1");
            return Err(document.error(&key, message, "0 is the root, 1 the tip").into());
        }
        stations.push(Station {
            y_m: eta * semispan,
            eta: Some(*eta),
        });
    }
    for y in &file.cuts.y {
        stations.push(Station {
            y_m: y.0,
            eta: semispan.map(|s| y.0 / s),
        });
    }
    stations.sort_by(|a, b| a.y_m.total_cmp(&b.y_m));
    Ok(stations)
}

/// The table of `cuts.measured`.
///
/// # Errors
/// What is wrong in it.
pub fn measured(document: &Document, file: &SteadyFile) -> Result<Vec<Measured>, Stop> {
    let Some(path) = &file.cuts.measured else {
        return Ok(Vec::new());
    };
    let table = Table::read(&document.path(path))?;
    let etas = if table.has("eta") {
        Some(table.numbers("eta")?)
    } else {
        None
    };
    let (xs, cps) = (table.numbers("x_over_c")?, table.numbers("cp")?);
    Ok(xs
        .into_iter()
        .zip(cps)
        .enumerate()
        .map(|(n, (x_over_c, cp))| Measured {
            eta: etas.as_ref().and_then(|e| e.get(n).copied()),
            x_over_c,
            cp,
        })
        .collect())
}

/// Cuts the walls at the stations; on a two-dimensional grid there is one cut.
pub fn make(stations: &[Station], grid: &MultiBlock, walls: &[WallPatch]) -> Vec<Cut> {
    if walls.is_empty() {
        return Vec::new();
    }
    if grid.is_two_dimensional() {
        return vec![one("section".to_owned(), None, grid, walls)];
    }
    stations
        .iter()
        .map(|station| {
            let label = match station.eta {
                Some(eta) => format!("η = {eta:.3}, y = {:.4} m", station.y_m),
                None => format!("y = {:.4} m", station.y_m),
            };
            one(label, Some(station.clone()), grid, walls)
        })
        .collect()
}

fn one(label: String, station: Option<Station>, grid: &MultiBlock, walls: &[WallPatch]) -> Cut {
    let y = station.as_ref().map(|s| s.y_m);
    let cut = cut::cut(walls, y.unwrap_or(0.0), grid.is_two_dimensional());
    let [nose, tail] = chord(grid, y);
    let points = |side: &[[f64; 3]]| -> Vec<[f64; 4]> {
        side.iter()
            .map(|&[x, z, cp]| [x, z, (x - nose) / (tail - nose), cp])
            .collect()
    };
    Cut {
        label,
        upper: points(&cut.upper),
        lower: points(&cut.lower),
        station,
    }
}

/// Least and largest x of the walls' grid lines at a station; of all wall nodes where there is none.
fn chord(grid: &MultiBlock, y: Option<f64>) -> [f64; 2] {
    let mut range = [f64::INFINITY, f64::NEG_INFINITY];
    let mut put = |x: f64| range = [range[0].min(x), range[1].max(x)];
    for patch in grid.topology.patches.iter().filter(|p| p.condition.is_wall()) {
        let Some(block) = grid.blocks.get(patch.block) else {
            continue;
        };
        let (lo, hi) = (patch.window.lo, patch.window.hi);
        for q in lo[1]..=hi[1] {
            for p in lo[0]..=hi[0] {
                let node = |p: usize, q: usize| block.point_at(block.node_behind(patch.face, p, q, 0));
                let here = node(p, q);
                let Some(y) = y else {
                    put(here[0]);
                    continue;
                };
                for (inside, p, q) in [(p < hi[0], p + 1, q), (q < hi[1], p, q + 1)] {
                    if !inside {
                        continue;
                    }
                    let there = node(p, q);
                    if (here[1] - y) * (there[1] - y) <= 0.0 && here[1] != there[1] {
                        put(here[0] + (y - here[1]) / (there[1] - here[1]) * (there[0] - here[0]));
                    }
                }
            }
        }
    }
    range
}

/// The measured points of a cut: all for a section, those within 0.02 of its eta for a wing.
pub fn of_cut<'a>(measured: &'a [Measured], cut: &'a Cut) -> impl Iterator<Item = &'a Measured> {
    let eta = cut.station.as_ref().and_then(|s| s.eta);
    measured.iter().filter(move |m| match (m.eta, eta) {
        (Some(at), Some(eta)) => (at - eta).abs() <= 0.02,
        (Some(_), None) => false,
        (None, _) => true,
    })
}
