//! A march as its case file has it: grid, structure, steady flow and settings, read and checked once for all runs.

use super::inspect::{Inspection, inspect};
use super::parameter::Parameter;
use super::{INPUTS, steps};
use crate::assemble::{deformation, flow, grid, modes};
use crate::exit::Stop;
use crate::options::Common;
use crate::output::RunFolder;
use crate::pmb::steady::watch::Watch;
use crate::progress::{Seconds, Timer};
use crate::stamp::{Fingerprint, Stamp};
use dip_case::Document;
use dip_case::file::{MarchFile, SteadyFile};
use dip_flutter::search::SearchSettings;
use dip_modal::ModalEquations;
use dip_pmb::march::mean::{self, MeanFlow};
use dip_pmb::march::{MarchSettings, Wing};
use std::path::Path;

/// A case, read and checked, with all that is the same at every stream.
pub struct March<'a> {
    /// The case.
    pub document: &'a Document,
    /// Its content.
    pub file: MarchFile,
    /// Where results go.
    pub folder: RunFolder,
    /// Options of the command.
    pub common: &'a Common,
    /// The grid at rest.
    pub grid: dip_grid::MultiBlock,
    /// Hash of the grid.
    pub mesh_hash: String,
    /// What the results depend on.
    pub stamp: Stamp,
    /// The structure on the grid.
    pub wing: Wing,
    /// How it is marched.
    pub settings: MarchSettings,
    /// What is varied.
    pub parameter: Parameter,
    /// How it is varied; its first value is that of a single run.
    pub search: SearchSettings,
    /// What was found when transfer and deformation were inspected.
    pub inspection: Inspection,
    /// The steady flow about the rigid structure.
    pub mean: MeanFlow,
    /// Whether what is in the folder is gone on with.
    pub resume: bool,
}

/// The steady part of a case.
fn steady_file(file: &MarchFile) -> SteadyFile {
    SteadyFile {
        flow: file.flow.clone(),
        mesh: file.mesh.clone(),
        reference: Some(file.reference.clone()),
        steady: file.steady.clone(),
        patch: file.patch.clone(),
        cuts: dip_case::file::CutsTable::default(),
    }
}

/// The stamp of a case on a grid.
pub fn stamp(document: &Document, file: &MarchFile, mesh_hash: &str) -> Stamp {
    let mut fingerprint = Fingerprint::new();
    fingerprint.document(document).text(mesh_hash);
    modes::fingerprint(document, &file.modes, &mut fingerprint);
    fingerprint.stamp()
}

impl<'a> March<'a> {
    /// Reads a case and solves its steady flow; what that took goes to `stages`.
    ///
    /// # Errors
    /// What is wrong in the case, or what the flow solver fails with.
    pub fn read(
        document: &'a Document,
        path: &Path,
        resume: bool,
        common: &'a Common,
        stages: &mut Vec<(String, Seconds)>,
    ) -> Result<Self, Stop> {
        let file: MarchFile = document.load()?;
        let steady = steady_file(&file);
        let mut flow_settings = flow::settings(document, &steady)?;
        let table = file.search.clone().unwrap_or_default();
        let stream = (file.flow.speed.map(|v| v.0), file.flow.density.map(|d| d.0));
        let (parameter, search) = Parameter::of_case(document, &table, file.flow.mach, stream)?;
        let timer = Timer::start();
        let mesh = grid::from_case(document, &file.mesh)?;
        flow::on_grid(&mut flow_settings, document, &steady, &mesh.grid)?;
        flow_settings.solver.orders = file.steady.orders.unwrap_or(6.0);
        stages.push(("mesh".to_owned(), timer.seconds()));

        let timer = Timer::start();
        let structure = modes::from_table(document, &file.modes)?.modes;
        let count = structure.count();
        let refuse = |e: &dyn std::fmt::Display| -> Stop {
            document
                .error("modes", e.to_string(), "see docs/march.md for the keys")
                .into()
        };
        let mut equations = ModalEquations::from_modes(&structure, count, 0.0).map_err(|e| refuse(&e))?;
        let damping = steps::damping(document, &file, count)?;
        equations =
            ModalEquations::new(equations.omega_rad_s, damping, equations.generalized_mass).map_err(|e| refuse(&e))?;
        let placed = deformation::on_grid(&mesh.grid, &structure, count, file.march.displacement)?;
        let wing = Wing::new(equations, &placed.modes, &mesh.grid).map_err(|e| flow::explain(document, e))?;
        stages.push(("transfer and deformation".to_owned(), timer.seconds()));

        let stamp = stamp(document, &file, &mesh.hash);
        let folder = RunFolder::open(path, &stamp, common.force || resume)?;
        // What is there is gone on with only if it was made from the same inputs.
        let resume = resume && std::fs::read_to_string(path.join(INPUTS)).is_ok_and(|f| f == stamp.fingerprint);
        folder.write(INPUTS, stamp.fingerprint.as_bytes())?;
        let settings = steps::settings(document, &file, flow_settings, &wing)?;

        let timer = Timer::start();
        let displacement = 0.01 * settings.steady.reference.chord;
        let inspection = inspect(&folder, &mesh.grid, &placed, &structure, displacement)?;
        tracing::info!("{}", inspection.words());
        for warning in inspection.warnings() {
            tracing::warn!("{warning}");
        }
        stages.push(("inspection of the transfer".to_owned(), timer.seconds()));

        let timer = Timer::start();
        let kept = folder.path().join("mean.pmb");
        let mean = match MeanFlow::read(&kept, &mesh.grid) {
            Ok(mean) if resume => mean,
            _ => {
                let mut watch = Watch::new(common.quiet, settings.steady.solver.orders);
                let cancel = watch.cancel();
                let mean = mean::rigid(&settings.steady, &mesh.grid, count, &mut watch, &cancel);
                watch.finish();
                let Some(mean) = mean.map_err(|e| flow::explain(document, e))? else {
                    return Err(Stop::Interrupted(
                        "the steady flow was not finished; --resume starts it anew".to_owned(),
                    ));
                };
                mean.write(&kept).map_err(|e| flow::explain(document, e))?;
                mean
            }
        };
        stages.push(("steady flow".to_owned(), timer.seconds()));
        Ok(Self {
            document,
            file,
            folder,
            common,
            grid: mesh.grid,
            mesh_hash: mesh.hash,
            stamp,
            wing,
            settings,
            parameter,
            search,
            inspection,
            mean,
            resume,
        })
    }
}
