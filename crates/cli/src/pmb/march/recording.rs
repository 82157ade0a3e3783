//! What a recording of a march says before its first step.

use super::case::March;
use crate::assemble::references::{Unsteady, references};
use crate::assemble::surface;
use dip_pmb::couple::Stream;
use dip_record::{CoordinateKind, Law, MotionCoordinate, Provenance, Setup, StructuralMode};

impl March<'_> {
    /// The setup of a recording at a stream.
    pub(super) fn setup(&self, stream: &Stream) -> Setup {
        let s = &self.settings;
        let motion = self
            .wing
            .shapes
            .iter()
            .enumerate()
            .map(|(m, shape)| MotionCoordinate {
                name: format!("mode {}", m + 1),
                kind: CoordinateKind::Mode,
                law: Law::Free,
                shape_m: surface::at_walls(&self.grid, shape),
                mode: Some(StructuralMode {
                    number: u32::try_from(m + 1).unwrap_or(u32::MAX),
                    omega_rad_s: self.wing.equations.omega_rad_s[m],
                    generalized_mass_kg: self.wing.equations.generalized_mass[m],
                    damping_ratio: self.wing.equations.damping_ratio[m],
                }),
            })
            .collect();
        Setup {
            references: references(
                &self.file.reference,
                &self.grid,
                &s.steady,
                &Unsteady {
                    speed_m_s: stream.speed_m_s,
                    density_kg_m3: stream.density_kg_m3,
                    step_s: s.step_s,
                    steps_per_cycle: None,
                    cycles: None,
                    orders: s.time.orders,
                },
            ),
            motion,
            surface: surface::patches(&self.grid),
            provenance: Provenance {
                program: "pmb march".to_owned(),
                version: format!("{} ({})", self.stamp.version, self.stamp.commit),
                case_name: self.document.file().display().to_string(),
                case_text: self.document.text().to_owned(),
                mesh_sha256: self.mesh_hash.clone(),
            },
        }
    }
}
