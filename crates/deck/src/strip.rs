//! Strip theory (CAERO4, PAERO4): Theodorsen's section on every strip, no influence between strips.
//!
//! With the strip's semichord b, reduced frequency kappa = omega b / V and its mid-chord motion, displacement h along the
//! normal and nose-up angle alpha = -dh/dx, lift L along the normal and nose-up moment M about mid-chord per span are
//! (Theodorsen, NACA Report 496, with a = 0 and h upward), over the dynamic pressure:
//!
//! ```text
//! L = 2 pi b [ kappa^2 h/b + i kappa alpha ] + 4 pi b C [ -i kappa h/b + alpha (1 + i kappa / 2) ]
//! M = 2 pi b^2 [ -i kappa alpha / 2 + kappa^2 alpha / 8 ] + 2 pi b^2 C [ -i kappa h/b + alpha (1 + i kappa / 2) ]
//! ```
//!
//! C is Theodorsen's function or a sum of exponentials b0 + sum b_n / (1 - i beta_n / kappa) (PAERO4's CIRC; NASTRAN-95's
//! strip theory has the same form). A lift-curve slope other than 2 pi scales the circulatory terms.

use std::f64::consts::{PI, TAU};

use dip_dlm::{
    c64,
    lattice::{Lattice, PlaneSymmetry, Surface},
    motion::BoxMotion,
};
use dip_flutter::theodorsen::theodorsen;
use dip_nastran::{
    Location,
    bulk::Bulk,
    cards::aero::{StripPanel, StripProperty},
};

use crate::{
    aerodynamics::{GeneralizedForces, divisions, edges},
    coordinate::{Frame, Geometry},
    error::{Result, misfit, missing},
};

/// Circulation function of a panel's strips.
#[derive(Debug, Clone)]
enum Circulation {
    /// Theodorsen's own.
    Exact,
    /// One sum for each Mach number.
    Exponentials(Vec<ExponentialSum>),
}

/// Approximation of the circulation function at one Mach number.
#[derive(Debug, Clone)]
struct ExponentialSum {
    mach: f64,
    b0: f64,
    /// (b_n, beta_n)
    pairs: Vec<(f64, f64)>,
}

/// Lift-curve slope over 2 pi.
#[derive(Debug, Clone)]
enum LiftSlope {
    Incompressible,
    /// Mach number and slope of each strip; with the factor of Prandtl and Glauert between Mach numbers or without.
    Listed {
        table: Vec<(f64, Vec<f64>)>,
        prandtl_glauert: bool,
    },
}

#[derive(Debug, Clone)]
struct Panel {
    card: String,
    at: Location,
    circulation: Circulation,
    slope: LiftSlope,
}

/// Strips of all CAERO4 panels; each is one box of a lattice, which serves the splines.
#[derive(Debug, Clone)]
pub struct Strips {
    panels: Vec<Panel>,
}

impl Strips {
    /// The strips and the lattice of one box a strip that carries them.
    ///
    /// # Errors
    /// Cards that name missing ones, swept strips, control surfaces.
    pub fn new(bulk: &Bulk, geometry: &Geometry, frame: &Frame) -> Result<(Lattice, Self)> {
        let mut surfaces = Vec::new();
        let mut panels = Vec::new();
        for panel in bulk.strip_panels.values() {
            let card = format!("CAERO4 {}", panel.id);
            let property = bulk
                .strip_properties
                .get(&panel.property)
                .ok_or_else(|| missing(&panel.at, card.clone(), "PAERO4", panel.property))?;
            let [point_1, point_4] = edges(
                geometry,
                frame,
                panel.coordinate,
                [panel.point_1, panel.point_4],
                &panel.at,
                &card,
            )?;
            let surface = Surface {
                name: card.clone(),
                first_box_id: panel.id,
                leading_edge_1: point_1,
                chord_1: panel.chord_12,
                leading_edge_2: point_4,
                chord_2: panel.chord_43,
                chordwise: dip_dlm::lattice::Divisions::Equal(1),
                spanwise: divisions(bulk, panel.spanwise, &panel.at, &card)?,
                interference_group: 1,
            };
            check_unswept(panel, &surface, &card)?;
            check_no_control(property)?;
            let strips = surface.spanwise.count();
            surfaces.push(surface);
            panels.push(Panel {
                at: panel.at.clone(),
                circulation: circulation(bulk, property)?,
                slope: lift_slope(bulk, property, strips)?,
                card,
            });
        }
        Ok((Lattice::new(surfaces, PlaneSymmetry::None)?, Self { panels }))
    }

    /// Adds the strips' forces at one Mach number and reduced frequency (of semichord `semichord`) to Q.
    ///
    /// # Errors
    /// A Mach number that the lists of the cards do not hold.
    pub fn add_forces(
        &self,
        lattice: &Lattice,
        motion: &BoxMotion,
        into: &mut GeneralizedForces,
        semichord: f64,
    ) -> Result<()> {
        let n = motion.n_boxes;
        for (i, strip) in lattice.boxes().iter().enumerate() {
            let panel = &self.panels[strip.surface];
            let b = 0.5 * strip.chord;
            let kappa = into.k * b / semichord;
            let c = panel.circulation_at(into.mach, kappa)? * panel.slope_at(into.mach, strip.span_index)?;
            // Unit motions: displacement at mid-chord over b, and nose-up angle.
            let ik = c64::new(0.0, kappa);
            let lift = [
                TAU * b * kappa * kappa - 2.0 * TAU * b * c * ik,
                TAU * b * ik + 2.0 * TAU * b * c * (1.0 + 0.5 * ik),
            ];
            let moment = [
                -TAU * b * b * c * ik,
                TAU * b * b * (-0.5 * ik + kappa * kappa / 8.0) + TAU * b * b * c * (1.0 + 0.5 * ik),
            ];
            for column in 0..motion.n_modes {
                let at = column * n + i;
                let alpha = -motion.slope[at];
                // Half-way between the points that the motion is given at (rigid strip).
                let h = 0.5 * (motion.at_force[at] + motion.at_control[at]);
                let l = (lift[0] * (h / b) + lift[1] * alpha) * strip.width;
                let m = (moment[0] * (h / b) + moment[1] * alpha) * strip.width;
                for row in 0..motion.n_modes {
                    let at = row * n + i;
                    let h = 0.5 * (motion.at_force[at] + motion.at_control[at]);
                    into.q[(row, column)] += l * h - m * motion.slope[at];
                }
            }
        }
        Ok(())
    }
}

impl Panel {
    fn circulation_at(&self, mach: f64, kappa: f64) -> Result<c64> {
        match &self.circulation {
            Circulation::Exact => Ok(theodorsen(kappa)),
            Circulation::Exponentials(table) => {
                let sum = table
                    .iter()
                    .find(|s| (s.mach - mach).abs() < 1e-6)
                    .ok_or_else(|| self.no_mach(mach, "LCIRC"))?;
                // At kappa = 0 the terms with beta > 0 vanish.
                Ok(sum.pairs.iter().fold(c64::new(sum.b0, 0.0), |c, (b, beta)| {
                    c + b * kappa / c64::new(kappa, -beta)
                }))
            }
        }
    }

    fn slope_at(&self, mach: f64, strip: usize) -> Result<f64> {
        match &self.slope {
            LiftSlope::Incompressible => Ok(1.0),
            LiftSlope::Listed {
                table,
                prandtl_glauert: false,
            } => table
                .iter()
                .find(|(m, _)| (m - mach).abs() < 1e-6)
                .map(|(_, slopes)| slopes[strip] / TAU)
                .ok_or_else(|| self.no_mach(mach, "LCLA")),
            LiftSlope::Listed { table, .. } => {
                let (m, slopes) = &table[0];
                Ok(slopes[strip] / TAU * ((1.0 - m * m) / (1.0 - mach * mach)).sqrt())
            }
        }
    }

    fn no_mach(&self, mach: f64, field: &str) -> crate::SolveError {
        misfit(
            &self.at,
            self.card.clone(),
            format!("the AEFACT list of {field} on its PAERO4 does not hold Mach {mach}"),
        )
    }
}

/// The two-dimensional section needs a straight quarter-chord line across the flow.
fn check_unswept(panel: &StripPanel, surface: &Surface, card: &str) -> Result<()> {
    let quarter = |edge: [f64; 3], chord: f64| edge[0] + 0.25 * chord;
    let sweep = quarter(surface.leading_edge_2, surface.chord_2) - quarter(surface.leading_edge_1, surface.chord_1);
    if sweep.abs() > 1e-3 * surface.chord_1.max(surface.chord_2) {
        return Err(misfit(
            &panel.at,
            card,
            "strip theory is computed for an unswept quarter-chord line only; use CAERO1",
        ));
    }
    Ok(())
}

fn check_no_control(property: &StripProperty) -> Result<()> {
    if property.control.iter().any(|c| c[1] != 0.0) {
        let card = format!("PAERO4 {}", property.id);
        return Err(misfit(
            &property.at,
            card,
            "control surfaces in strip theory (CAOC) are not supported; use CAERO1",
        ));
    }
    Ok(())
}

fn list<'a>(bulk: &'a Bulk, property: &StripProperty, id: u32) -> Result<&'a [f64]> {
    bulk.real_lists
        .get(&id)
        .map(|l| l.values.as_slice())
        .ok_or_else(|| missing(&property.at, format!("PAERO4 {}", property.id), "AEFACT", id))
}

fn circulation(bulk: &Bulk, property: &StripProperty) -> Result<Circulation> {
    let card = || format!("PAERO4 {}", property.id);
    match usize::try_from(property.circulation_rule) {
        Ok(0) => Ok(Circulation::Exact),
        Ok(n @ 1..=3) => {
            let values = list(bulk, property, property.circulation_list)?;
            let size = 2 + 2 * n;
            if values.is_empty() || !values.len().is_multiple_of(size) {
                return Err(misfit(
                    &property.at,
                    card(),
                    format!(
                        "CIRC = {n} needs {size} values a Mach number in list {}, got {}",
                        property.circulation_list,
                        values.len()
                    ),
                ));
            }
            Ok(Circulation::Exponentials(
                values
                    .chunks_exact(size)
                    .map(|row| ExponentialSum {
                        mach: row[0],
                        b0: row[1],
                        pairs: row[2..].chunks_exact(2).map(|p| (p[0], p[1])).collect(),
                    })
                    .collect(),
            ))
        }
        _ => Err(misfit(&property.at, card(), "CIRC must be 0, 1, 2 or 3")),
    }
}

fn lift_slope(bulk: &Bulk, property: &StripProperty, strips: usize) -> Result<LiftSlope> {
    if property.lift_slope_rule == 0 {
        return Ok(LiftSlope::Incompressible);
    }
    let prandtl_glauert = property.lift_slope_rule < 0;
    let card = || format!("PAERO4 {}", property.id);
    if property.lift_slope_list == 0 {
        // Without a list the incompressible slope is the reference.
        return if prandtl_glauert {
            Ok(LiftSlope::Listed {
                table: vec![(0.0, vec![2.0 * PI; strips])],
                prandtl_glauert,
            })
        } else {
            Err(misfit(
                &property.at,
                card(),
                "CLA = 1 needs a list of lift-curve slopes (LCLA)",
            ))
        };
    }
    let values = list(bulk, property, property.lift_slope_list)?;
    if values.is_empty() || !values.len().is_multiple_of(strips + 1) {
        return Err(misfit(
            &property.at,
            card(),
            format!(
                "list {} needs a Mach number and {strips} slopes, and so on for each Mach number",
                property.lift_slope_list
            ),
        ));
    }
    let table = values
        .chunks_exact(strips + 1)
        .map(|row| (row[0], row[1..].to_vec()))
        .collect();
    Ok(LiftSlope::Listed { table, prandtl_glauert })
}
