//! Searches of the neutral point, as the programs make them, with what they cost.

use std::error::Error;
use std::sync::atomic::AtomicBool;

use dip_flutter::decay::{Reading, Watch, WatchSettings};
use dip_flutter::search::{Neutral, Search, SearchSettings, SearchStep, Stability, Trial};
use dip_grid::MultiBlock;
use dip_modal::{ModalState, StepScheme};
use dip_pmb::couple::{Coupling, Stream};
use dip_pmb::dual_time::DualTimeSettings;
use dip_pmb::march::mean::{DeflectionSettings, MeanFlow, deflected, rigid};
use dip_pmb::march::{MarchObserver, MarchSettings, MarchStep, MarchStop, Verdict, Wing, run};
use dip_pmb::observer::{Observer, Progress, Silent};
use dip_pmb::settings::SteadySettings;

/// Anything that goes wrong ends the program.
pub type Outcome<T> = Result<T, Box<dyn Error>>;

/// Processor time of the process, seconds (fields 14 and 15 of /proc/self/stat, in ticks of 10 ms).
pub fn cpu_s() -> f64 {
    let text = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let after = text.rsplit(')').next().unwrap_or_default();
    let ticks = after.split_whitespace().skip(11).take(2);
    ticks.filter_map(|t| t.parse::<f64>().ok()).sum::<f64>() / 100.0
}

/// A structure on a grid in a stream, and how it is marched.
#[derive(Clone, Debug)]
pub struct Case {
    /// The grid at rest.
    pub grid: MultiBlock,
    /// The structure.
    pub wing: Wing,
    /// The flow.
    pub steady: SteadySettings,
    /// A step is this frequency's period over `steps_per_cycle`, Hz.
    pub freq_hz: f64,
    /// Steps in that period.
    pub steps_per_cycle: f64,
    /// Orders by which the residual of a step falls.
    pub orders: f64,
    /// Amplitude of the wall that the initial velocity would give mode by mode in vacuum, in the grid's unit, `[mode]`.
    pub start: Vec<f64>,
    /// Whether the wing takes its position under load first.
    pub deflects: bool,
    /// Exchange within a step.
    pub coupling: Coupling,
    /// Cycles of `freq_hz` at most.
    pub cycles: f64,
    /// Go on to the last cycle though the damping is known.
    pub whole: bool,
}

/// A march at one value of the parameter.
#[derive(Clone, Debug)]
pub struct Row {
    /// Damping of the least stable mode.
    pub g: f64,
    /// Its standard error.
    pub g_error: f64,
    /// Its frequency, Hz.
    pub freq_hz: f64,
    /// What the search makes of it.
    pub stability: Stability,
    /// Steps taken.
    pub steps: usize,
    /// Products with the flow's operator.
    pub products: usize,
    /// Why it ended.
    pub stop: MarchStop,
    /// Time and generalized coordinates of every step.
    pub states: Vec<ModalState>,
    /// Parts of its wall-clock time that grid and structure took.
    pub coupling: [f64; 2],
    /// Processor seconds.
    pub cpu_s: f64,
}

/// Damping of the least stable mode as read at a moment of a march.
#[derive(Clone, Copy, Debug)]
pub struct ReadDamping {
    /// Samples so far.
    pub samples: usize,
    /// Damping.
    pub g: f64,
    /// Its standard error.
    pub g_error: f64,
    /// A search would stop here.
    pub known: bool,
}

/// A finished search.
#[derive(Debug)]
pub struct Found {
    /// How it ended.
    pub end: SearchStep,
    /// Its marches in order.
    pub rows: Vec<Row>,
    /// Processor seconds, without the rigid steady flow.
    pub cpu_s: f64,
}

impl Found {
    /// The neutral point, if one was found.
    pub fn neutral(&self) -> Option<Neutral> {
        match &self.end {
            SearchStep::Found(n) | SearchStep::OutOfRuns(Some(n)) => Some(*n),
            _ => None,
        }
    }
}

struct Reader {
    watch: Watch,
    mean: Vec<f64>,
    whole: bool,
}

impl Observer for Reader {
    fn progress(&mut self, _: &Progress) {}
    fn message(&mut self, text: &str) {
        println!("    {text}");
    }
}

impl MarchObserver for Reader {
    fn step(&mut self, step: &MarchStep<'_>) -> Result<Verdict, String> {
        let q: Vec<f64> = step.state.q.iter().zip(&self.mean).map(|(q, m)| q - m).collect();
        Ok(match self.watch.push(&q) {
            Some(reading) if reading.known && !self.whole => Verdict::Enough,
            _ => Verdict::GoOn,
        })
    }
    fn resumed(&mut self, _: usize, _: &[ModalState]) -> Result<(), String> {
        Ok(())
    }
}

impl Case {
    /// The steady flow about the rigid structure, and its processor seconds.
    pub fn still(&self) -> Outcome<(MeanFlow, f64)> {
        let begin = cpu_s();
        let modes = self.wing.equations.count();
        let mean =
            rigid(&self.steady, &self.grid, modes, &mut Silent, &AtomicBool::new(false))?.ok_or("interrupted")?;
        Ok((mean, cpu_s() - begin))
    }

    /// Position under load at a stream.
    pub fn position(&self, still: &MeanFlow, stream: &Stream) -> Outcome<MeanFlow> {
        let never = AtomicBool::new(false);
        let how = DeflectionSettings::default();
        let mean = deflected(&self.steady, &how, &self.grid, &self.wing, stream, still, &never)?;
        Ok(mean.ok_or("interrupted")?)
    }

    fn watch_settings(&self) -> WatchSettings {
        let equations = &self.wing.equations;
        let mut watch = WatchSettings::new(
            1.0 / self.freq_hz / self.steps_per_cycle,
            equations.omega_rad_s.clone(),
            equations.generalized_mass.clone(),
        );
        watch.every = (self.steps_per_cycle / 8.0).round().max(1.0) as usize;
        watch.skip = (self.steps_per_cycle / 10.0).round() as usize;
        watch
    }

    /// What a search would have read of the least stable mode while a march about the undeformed wing went on.
    pub fn readings(&self, states: &[ModalState]) -> Outcome<Vec<ReadDamping>> {
        let mut watch = Watch::new(self.watch_settings())?;
        let mut readings = Vec::new();
        for state in states {
            if let Some(reading) = watch.push(&state.q)
                && let Some(mode) = reading.modes.first()
            {
                readings.push(ReadDamping {
                    samples: reading.samples,
                    g: mode.g,
                    g_error: mode.g_error,
                    known: reading.known,
                });
            }
        }
        Ok(readings)
    }

    /// One march; `accuracy` of its damping, if the usual one is too coarse.
    pub fn march(&self, still: &MeanFlow, at: f64, stream: Stream, accuracy: Option<f64>) -> Outcome<Row> {
        let begin = cpu_s();
        let equations = &self.wing.equations;
        let mean = if self.deflects {
            self.position(still, &stream)?
        } else {
            still.clone()
        };
        let step_s = 1.0 / self.freq_hz / self.steps_per_cycle;
        let rates = self.start.iter().enumerate();
        let settings = MarchSettings {
            steady: self.steady.clone(),
            time: DualTimeSettings {
                orders: self.orders,
                ..DualTimeSettings::default()
            },
            step_s,
            steps: (self.cycles * self.steps_per_cycle) as usize,
            scheme: StepScheme::default(),
            coupling: self.coupling,
            exchange_tolerance: 1e-6,
            start_rate_1_s: rates
                .map(|(m, d)| d * equations.omega_rad_s[m] / self.wing.largest[m])
                .collect(),
            largest_displacement: 0.3,
            restart: None,
            resume: false,
            checkpoint_steps: 0,
        };
        let mut watch = self.watch_settings();
        watch.accuracy = accuracy.map_or(watch.accuracy, |a| a.min(watch.accuracy));
        let mut reader = Reader {
            watch: Watch::new(watch)?,
            mean: mean.q.clone(),
            whole: self.whole,
        };
        let never = AtomicBool::new(false);
        let result = run(&settings, &self.grid, &self.wing, stream, &mean, &mut reader, &never)?;
        let mode = reader.watch.reading().and_then(|r| r.modes.first().cloned());
        let (g, g_error, freq_hz) = mode
            .as_ref()
            .map_or((f64::NAN, f64::NAN, f64::NAN), |m| (m.g, m.g_error, m.freq_hz));
        let stability = reader.watch.reading().and_then(Reading::stability);
        let row = Row {
            g,
            g_error,
            freq_hz,
            stability: stability.unwrap_or(Stability::Divergence(None)),
            steps: result.states.len() - 1,
            products: result.products,
            stop: result.stop,
            coupling: [result.seconds.deformation, result.seconds.transfer].map(|s| s / result.seconds.all),
            states: result.states,
            cpu_s: cpu_s() - begin,
        };
        if let Some(rate) = row.stability.rate() {
            println!(
                "  {at:.5}: {:+.3} +- {:.3} 1/s without oscillation",
                rate.rate_1_s, rate.rate_error_1_s
            );
        }
        println!(
            "  {at:.5}: {:?} after {} steps, {} products, {:.2} Hz, g {:+.4} +- {:.4}, {:.1} s",
            row.stop, row.steps, row.products, row.freq_hz, row.g, row.g_error, row.cpu_s
        );
        Ok(row)
    }

    /// Searches the value at which the least stable mode is neutral.
    pub fn search(&self, still: &MeanFlow, settings: SearchSettings, stream: impl Fn(f64) -> Stream) -> Outcome<Found> {
        let begin = cpu_s();
        let mut search = Search::new(settings, Vec::new())?;
        let mut rows = Vec::new();
        let end = loop {
            let at = match search.next() {
                SearchStep::Run(at) => at,
                end => break end,
            };
            let row = self.march(still, at, stream(at), search.damping_accuracy())?;
            let stability = row.stability;
            search.add(Trial { at, stability })?;
            rows.push(row);
        };
        println!("  {end:?}");
        Ok(Found {
            end,
            rows,
            cpu_s: cpu_s() - begin,
        })
    }
}
