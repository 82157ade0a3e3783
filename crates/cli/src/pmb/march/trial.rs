//! One run at one stream: the mean position, the march, what it has shown.

use super::case::March;
use super::files;
use super::listen::Listener;
use super::motion::{LimitCycleRow, Motion, motion, named};
use super::summary::{Cost, DriftRow, TrialRow};
use crate::assemble::flow;
use crate::exit::Stop;
use crate::pmb::logbook::Logbook;
use crate::pmb::steady::watch::Watch;
use crate::progress::Timer;
use dip_flutter::decay::{self, WatchSettings};
use dip_flutter::search::Stability;
use dip_pmb::error::FlowError;
use dip_pmb::march::mean::{self, DeflectionSettings};
use dip_pmb::march::{MarchResult, MarchSettings, MarchStop};

/// A run, finished or failed, and who listened to it.
struct Attempt<'a> {
    result: Result<MarchResult, FlowError>,
    listener: Listener<'a>,
}

impl Attempt<'_> {
    /// Why the run could not be gone on with from its files: one that is damaged or was cut short. The run can be done anew.
    fn cannot_go_on(&self) -> Option<String> {
        match &self.result {
            Err(e @ FlowError::Restart { .. }) => Some(e.to_string()),
            Err(e) if !self.listener.log.has_begun() => Some(e.to_string()),
            _ => None,
        }
    }
}

impl March<'_> {
    /// A run at a value of the parameter, until its damping is known to `accuracy` where the usual one would not do.
    ///
    /// # Errors
    /// What the flow solver or the file system says; [`Stop::Interrupted`] when the user stops it.
    pub fn trial(&self, at: f64, number: usize, accuracy: Option<f64>) -> Result<TrialRow, Stop> {
        let timer = Timer::start();
        let name = format!("march_{number}");
        let label = self.parameter.words(at);
        let stream = self.parameter.stream(at);
        let explain = |e| flow::explain(self.document, e);
        let watch = Watch::new(self.common.quiet, self.settings.time.orders);
        let cancel = watch.cancel();
        let stopped = |what: &str| {
            Stop::Interrupted(format!(
                "{what}; finished runs are in {}, --resume goes on",
                self.folder.path().display()
            ))
        };
        let mean = mean::deflected(
            &self.settings.steady,
            &DeflectionSettings::default(),
            &self.grid,
            &self.wing,
            &stream,
            &self.mean,
            &cancel,
        )
        .map_err(explain)?
        .ok_or_else(|| stopped("the mean position was not finished"))?;
        let mean_position_s = timer.seconds().wall_s;
        if mean.exchanges > 0 {
            tracing::info!(
                "{label}: static deflection {:.3} mm after {} exchanges, CL {:.5}{}",
                1e3 * self.wing.displacement(&mean.q),
                mean.exchanges,
                mean.loads.total.cl,
                if mean.settled { "" } else { "; it does not settle" }
            );
        }
        let restart = self.folder.path().join(format!("{name}.pmb"));
        let going_on = self.resume && restart.exists();
        let attempt = |going_on: bool, watch: Watch| -> Result<Attempt<'_>, Stop> {
            let cancel = watch.cancel();
            let settings = MarchSettings {
                restart: Some(restart.clone()),
                resume: going_on,
                ..self.settings.clone()
            };
            let equations = &self.wing.equations;
            let mut reading = WatchSettings::new(
                settings.step_s,
                equations.omega_rad_s.clone(),
                equations.generalized_mass.clone(),
            );
            reading.accuracy = accuracy.map_or(reading.accuracy, |a| a.min(reading.accuracy));
            let damping =
                decay::Watch::new(reading).map_err(|e| Stop::failed(e.to_string(), "change march.steps_per_cycle"))?;
            let recording = self.folder.path().join(format!("{name}.mcap"));
            let mut listener = Listener {
                watch,
                damping,
                mean: mean.q.clone(),
                all_cycles: self.file.march.all_cycles,
                steps: settings.steps,
                label: label.clone(),
                reading_s: 0.0,
                grid: &self.grid,
                log: Logbook::new(recording, self.setup(&stream), settings.checkpoint_steps),
            };
            let result = dip_pmb::march::run(&settings, &self.grid, &self.wing, stream, &mean, &mut listener, &cancel);
            listener.watch.finish();
            Ok(Attempt { result, listener })
        };
        let mut run = attempt(going_on, watch)?;
        if let Some(why) = run.cannot_go_on().filter(|_| going_on) {
            tracing::warn!("{label}: this run is done anew: {why}");
            run = attempt(false, Watch::new(self.common.quiet, self.settings.time.orders))?;
        }
        let Attempt { result, mut listener } = run;
        let reason = match &result {
            Ok(r) => format!("{:?}", r.stop),
            Err(e) => format!("failed: {e}"),
        };
        let closed = listener.log.finish(&reason);
        let result = result.map_err(explain)?;
        closed.map_err(|e| Stop::failed(e, "check the disk's space; `dip doctor` says what can be saved"))?;
        let title = format!("Mach {}, {label}", self.file.flow.mach);
        files::modes(&self.folder, &name, &title, &result.states)?;
        if result.stop == MarchStop::Interrupted {
            return Err(stopped(&format!(
                "{} time steps were taken at {label}",
                result.states.len() - 1
            )));
        }
        let reading = listener.damping.reading();
        let motion = motion(reading, &listener.damping.record(), self.settings.step_s, mean.settled);
        let stability = motion.stability();
        let (g, g_error, frequency_hz) = match stability {
            Stability::Oscillation { g, g_error, freq_hz } => (Some(g), Some(g_error), Some(freq_hz)),
            Stability::Divergence(_) | Stability::Subsidence(_) => (None, None, None),
        };
        let diverges = matches!(stability, Stability::Divergence(_));
        let rate = stability.rate();
        let cost = Cost::new(&result.seconds, mean_position_s, listener.reading_s);
        tracing::info!("{label}: {}", motion.words());
        tracing::info!("{label}: {}", cost.words());
        Ok(TrialRow {
            at,
            density_kg_m3: stream.density_kg_m3,
            speed_m_s: stream.speed_m_s,
            altitude_m: self.parameter.altitude_m(at),
            motion: motion.words(),
            g,
            g_error,
            frequency_hz,
            modes: reading.map_or_else(Vec::new, |r| named(&r.modes, &self.wing.equations)),
            diverges,
            settled: mean.settled,
            rate_1_s: rate.map(|r| r.rate_1_s),
            rate_error_1_s: rate.map(|r| r.rate_error_1_s),
            drift: reading
                .and_then(|r| r.drift)
                .filter(|d| !d.dies() && !diverges)
                .map(|d| DriftRow {
                    rate_1_s: d.rate_1_s,
                    rate_error_1_s: Some(d.rate_error_1_s).filter(|e| e.is_finite()),
                    share: d.share,
                }),
            limit_cycle: if let Motion::LimitCycle(c) = motion {
                Some(LimitCycleRow {
                    frequency_hz: c.freq_hz,
                    wall_amplitude_m: self.wing.displacement(&c.amplitude),
                    amplitude: c.amplitude,
                    g_early: c.g_early,
                    g_late: c.g_late,
                })
            } else {
                None
            },
            stop: result.stop,
            steps: result.states.len() - 1,
            not_converged: result.not_converged,
            iterations: result.iterations,
            products: result.products,
            work_j: result.work_j,
            mean_cl: mean.loads.total.cl,
            mean_displacement_m: self.wing.displacement(&mean.q),
            name,
            seconds: timer.seconds(),
            cost,
        })
    }
}
