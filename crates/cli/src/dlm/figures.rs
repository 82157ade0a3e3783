//! Pictures that `dlm` puts beside its results.

use crate::exit::Stop;
use crate::figures;
use crate::frequency::FrequencyResults;
use crate::output::RunFolder;
use crate::traces::{MachCurves, ModeShapes};

/// Mode shapes, and V-g and V-f for each Mach number and method.
///
/// # Errors
/// What the file system says.
pub fn write(folder: &RunFolder, solved: &FrequencyResults) -> Result<(), Stop> {
    mode_shapes(folder, &ModeShapes::new(&solved.modes, &solved.elements))?;
    for s in &solved.solutions {
        let svg = figures::vg(&MachCurves::new(&s.solution), figures::SPEED)?
            .svg(760, 760)
            .map_err(|e| figures::drawing(&e))?;
        let method: String = s
            .solution
            .method
            .name()
            .to_lowercase()
            .chars()
            .filter(char::is_ascii_alphanumeric)
            .collect();
        folder.write(&format!("vg_M{:.3}_{method}.svg", s.row.mach), svg.as_bytes())?;
    }
    Ok(())
}

/// The first six mode shapes.
///
/// # Errors
/// What the file system says.
pub fn mode_shapes(folder: &RunFolder, shapes: &ModeShapes) -> Result<(), Stop> {
    if let Some(figure) = figures::mode_maps(shapes, 6)? {
        let height = 380 * u32::try_from(figure.rows.len()).unwrap_or(1) + 40;
        folder.write(
            "modes.svg",
            figure.svg(900, height).map_err(|e| figures::drawing(&e))?.as_bytes(),
        )?;
    }
    Ok(())
}
