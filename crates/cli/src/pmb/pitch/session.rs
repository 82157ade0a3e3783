//! Runs of one case: with the amplitude asked for and, to see how linear the answer is, with half of it.

use super::recorder::Recorder;
use crate::assemble::flow;
use crate::assemble::motion::Prescribed;
use crate::exit::Stop;
use crate::load_harmonics::{self, LoadHarmonics};
use crate::options::Common;
use crate::output::RunFolder;
use crate::pmb::logbook::Logbook;
use crate::pmb::steady::watch::Watch;
use dip_case::Document;
use dip_case::file::{MotionLaw, PitchFile};
use dip_correct::reading::{self, Reading, ReadingSettings};
use dip_pmb::forced::{self, ForcedResult, ForcedSettings, ForcedStop};
use dip_record::{Recording, Setup};

/// What the runs with whole and with half the amplitude have in common.
pub struct Session<'a> {
    pub document: &'a Document,
    pub folder: &'a RunFolder,
    pub grid: &'a dip_grid::MultiBlock,
    pub common: &'a Common,
}

impl Session<'_> {
    /// Runs the motion; the recording is read back, so that all results are those of the file and hold the steps of an
    /// earlier run that was gone on with.
    ///
    /// # Errors
    /// What the solver, the recording or the disk says.
    pub fn march(
        &self,
        name: &str,
        settings: &ForcedSettings,
        prescribed: &Prescribed,
        setup: Setup,
    ) -> Result<(ForcedResult, Recording), Stop> {
        let watch = Watch::new(self.common.quiet, settings.steady.solver.orders);
        let cancel = watch.cancel();
        let path = self.folder.path().join(name);
        let nothing = Recording {
            setup: setup.clone(),
            steps: Vec::new(),
            end: None,
        };
        let mut recorder = Recorder {
            watch,
            log: Logbook::new(path.clone(), setup, settings.checkpoint_steps),
            steps: settings.steps,
        };
        let result = forced::run(settings, self.grid, &prescribed.motion, &mut recorder, &cancel);
        recorder.watch.finish();
        let reason = match &result {
            Ok(r) => serde_json::to_value(r.stop)
                .ok()
                .and_then(|v| v.as_str().map(str::to_owned))
                .unwrap_or_default(),
            Err(e) => format!("failed: {e}"),
        };
        let closed = recorder.log.finish(&reason);
        let result = result.map_err(|e| flow::explain(self.document, e))?;
        closed.map_err(|e| Stop::failed(e, "check the disk's space; --resume goes on from the restart file"))?;
        if result.history.is_empty() {
            return Ok((result, nothing));
        }
        let recording = Recording::read(&path)
            .map_err(|e| Stop::failed(e.to_string(), "`dip doctor` says what is wrong with the recording"))?;
        Ok((result, recording))
    }

    /// First harmonics of the loads with half the amplitude.
    ///
    /// # Errors
    /// Those of [`Session::march`]; an interrupted run.
    pub fn halved(
        &self,
        settings: &ForcedSettings,
        file: &PitchFile,
        mut half: Prescribed,
        mut setup: Setup,
    ) -> Result<Option<LoadHarmonics>, Stop> {
        for coordinate in &mut half.motion.coordinates {
            if let dip_pmb::motion::Law::Harmonic { terms, .. } = &mut coordinate.law {
                terms.iter_mut().for_each(|t| t.amplitude *= 0.5);
            }
        }
        if let dip_record::Law::Harmonic { harmonics, .. } = &mut half.coordinate.law {
            harmonics.iter_mut().for_each(|h| h.amplitude *= 0.5);
        }
        setup.motion = vec![half.recorded(self.grid)];
        let settings = ForcedSettings {
            restart: None,
            resume: false,
            ..settings.clone()
        };
        tracing::info!("once more with half the amplitude");
        let (result, recording) = self.march("pitch_half.mcap", &settings, &half, setup)?;
        if result.stop == ForcedStop::Interrupted {
            return Err(Stop::Interrupted(format!(
                "the run with the full amplitude is in {}; --resume goes on with half of it",
                self.folder.path().join(super::RECORDING).display()
            )));
        }
        first_loads(&recording, &readings(&recording, file)?)
    }
}

/// First harmonics over the last whole cycle, as `dip export --harmonics` gives them; none where the motion has no cycle
/// or the run was shorter than one.
///
/// # Errors
/// What the analysis says.
pub fn readings(recording: &Recording, file: &PitchFile) -> Result<Vec<Reading>, Stop> {
    let cycle = file.motion.steps_per_cycle;
    if file.motion.law != MotionLaw::Harmonic || recording.steps.len() <= cycle {
        return Ok(Vec::new());
    }
    reading::read(recording, super::RECORDING, &ReadingSettings::default()).map_err(|e| no_harmonics(&e))
}

/// Those of the loads.
///
/// # Errors
/// What the analysis says.
pub fn first_loads(recording: &Recording, readings: &[Reading]) -> Result<Option<LoadHarmonics>, Stop> {
    match readings.first() {
        Some(first) => load_harmonics::of(recording, first, readings).map_err(|e| no_harmonics(&e)),
        None => Ok(None),
    }
}

fn no_harmonics(error: &dyn std::fmt::Display) -> Stop {
    Stop::failed(
        format!("no first harmonics: {error}"),
        "the recording is whole; `dip export --csv` gives its history",
    )
}
