//! The transfer to the wall and the deformation of the grid, looked at before a march begins.

use crate::assemble::deformation::OnGrid;
use crate::exit::Stop;
use crate::figures::drawing;
use crate::output::RunFolder;
use dip_grid::MultiBlock;
use dip_modal::{Modes, volume_change};
use dip_report::{Figure, Mesh, mode_map};
use serde::{Deserialize, Serialize};

/// Amplification from which a wall stands too far off its structure; wings have 1.5 to 2.
const FAR: f64 = 5.0;

/// Errors above this are no rounding.
const ROUNDING: f64 = 1e-9;

/// What was found.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Inspection {
    /// Largest error under a rigid translation of 1 m, m.
    pub translation_error_m: f64,
    /// Largest error under a rigid rotation of 1 rad, over the extent.
    pub rotation_error: f64,
    /// Error of total force and moment that come back to the structure, over the sum of the forces.
    pub balance_error: f64,
    /// Difference of the work on both sides over the work.
    pub virtual_work_error: f64,
    /// Largest sum of the norms of a wall point's matrices: 1 for interpolation, more for overhang.
    pub amplification: f64,
    /// Largest distance of a wall point from the structure's triangles, m.
    pub largest_offset_m: f64,
    /// Structural nodes in no triangle.
    pub nodes_left_out: usize,
    /// Smoothness of each mode on the wall: largest change, rad, of the angle between neighbouring faces at `displacement_m`.
    pub largest_kink_rad: Vec<f64>,
    /// Smallest and largest volume of a cell over that at rest, over all modes at plus and minus `displacement_m`.
    pub volumes: [f64; 2],
    /// Displacement of the wall for the last two, m.
    pub displacement_m: f64,
}

/// Inspects the transfer and the grid, displaced by `displacement_m` in each mode, and draws the modes on the wall
/// (`transfer.svg`).
///
/// # Errors
/// A cell that folds at this displacement, and what the file system says.
pub fn inspect(
    folder: &RunFolder,
    grid: &MultiBlock,
    placed: &OnGrid,
    modes: &Modes,
    displacement_m: f64,
) -> Result<Inspection, Stop> {
    let check = &placed.check;
    let mut volumes = [f64::INFINITY, f64::NEG_INFINITY];
    let mut moved = grid.clone();
    let mut kinks = Vec::new();
    for m in 0..placed.modes.count() {
        let shape = placed.modes.wall_shape(m);
        kinks.push(placed.wall.largest_kink(shape, displacement_m));
        let largest = shape.iter().map(nalgebra::Vector3::norm).fold(0.0, f64::max);
        if largest == 0.0 {
            continue;
        }
        for sign in [1.0, -1.0] {
            let mut q = vec![0.0; placed.modes.count()];
            q[m] = sign * displacement_m / largest;
            let change = placed
                .modes
                .displace(grid, &q, &mut moved)
                .and_then(|()| volume_change(grid, &moved))
                .map_err(|e| {
                    Stop::input(
                        format!("mode {} displaced by {displacement_m:.3e} m: {e}", m + 1),
                        "look at the grid by `pmb mesh check` and at the mode's shape in transfer.svg",
                    )
                })?;
            volumes = [volumes[0].min(change.smallest), volumes[1].max(change.largest)];
        }
    }
    picture(folder, placed, modes)?;
    Ok(Inspection {
        translation_error_m: check.translation_error_m,
        rotation_error: check.rotation_error,
        balance_error: check.balance_error,
        virtual_work_error: check.virtual_work_error,
        amplification: check.amplification,
        largest_offset_m: check.largest_offset_m,
        nodes_left_out: check.nodes_left_out,
        largest_kink_rad: kinks,
        volumes,
        displacement_m,
    })
}

impl Inspection {
    /// One line.
    pub fn words(&self) -> String {
        let kink = self.largest_kink_rad.iter().copied().fold(0.0, f64::max);
        format!(
            "transfer to the wall: rigid motion to {:.0e}, force and moment to {:.0e}, virtual work to {:.0e}, amplification {:.2}; at {:.2} mm: volumes {:.4} to {:.4} of those at rest, largest kink between faces {:.2} deg (transfer.svg)",
            self.translation_error_m.max(self.rotation_error),
            self.balance_error,
            self.virtual_work_error,
            self.amplification,
            1e3 * self.displacement_m,
            self.volumes[0],
            self.volumes[1],
            kink.to_degrees(),
        )
    }

    /// What to look at.
    pub fn warnings(&self) -> Vec<String> {
        let mut list = Vec::new();
        let worst = [
            ("rigid motion", self.translation_error_m.max(self.rotation_error)),
            ("total force and moment", self.balance_error),
            ("virtual work", self.virtual_work_error),
        ];
        for (what, error) in worst {
            if error > ROUNDING {
                list.push(format!("the transfer to the wall keeps {what} only to {error:.1e}"));
            }
        }
        if self.amplification > FAR {
            list.push(format!(
                "the transfer moves a point of the wall up to {:.0} times as far as the structure that carries it, {:.3} m away (transfer.svg): check that the \
                 grid's wing and that of the structure are one",
                self.amplification, self.largest_offset_m
            ));
        }
        if self.nodes_left_out > 0 {
            list.push(format!(
                "{} structural nodes lie in no triangle of the transfer and move nothing",
                self.nodes_left_out
            ));
        }
        list
    }
}

/// The first four modes on the upper side of the wall.
fn picture(folder: &RunFolder, placed: &OnGrid, modes: &Modes) -> Result<(), Stop> {
    let wall = &placed.wall;
    let centre = wall.positions.iter().map(|p| p[2]).sum::<f64>() / wall.positions.len().max(1) as f64;
    let elements: Vec<Vec<usize>> = wall
        .faces
        .iter()
        .filter(|f| f.iter().map(|&n| wall.positions[n][2] - centre).sum::<f64>() >= 0.0)
        .map(|f| f.to_vec())
        .collect();
    if elements.is_empty() {
        return Ok(());
    }
    let mesh = Mesh {
        nodes: wall.positions.clone(),
        elements,
    };
    let mut figure = Figure::new("Modes on the wall, upper side");
    let count = placed.modes.count().min(4);
    for first in (0..count).step_by(2) {
        let mut row = Vec::new();
        for m in first..count.min(first + 2) {
            let heave: Vec<f64> = placed.modes.wall_shape(m).iter().map(|u| u.z).collect();
            let title = format!("Mode {}, {:.2} Hz", m + 1, modes.freq_hz(m));
            row.push(mode_map(title, &mesh, &heave, "z displacement").map_err(|e| drawing(&e))?);
        }
        figure = figure.row(row);
    }
    let height = 40 + 380 * u32::try_from(count.div_ceil(2)).unwrap_or(1);
    let svg = figure.svg(900, height).map_err(|e| drawing(&e))?;
    folder.write("transfer.svg", svg.as_bytes())?;
    Ok(())
}
