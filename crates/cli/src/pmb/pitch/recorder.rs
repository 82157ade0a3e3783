//! Listens to a run with prescribed motion: recording, progress, and what the figures need.

use crate::pmb::steady::watch::Watch;
use dip_pmb::forced::{ForcedObserver, ForcedStep};
use dip_pmb::loads::WallPatch;
use dip_pmb::observer::{Observer, Progress};
use dip_record::{Convergence, Loads, MotionValue, Setup, Step, SurfaceGrid, Writer, WriterOptions};
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// One line of the history.
#[derive(Debug, Clone, Copy)]
pub struct Line {
    /// Instant, s.
    pub time_s: f64,
    /// Value of the coordinate, SI.
    pub value: f64,
    /// Lift, drag and moment coefficient.
    pub loads: [f64; 3],
    /// Orders, pseudo steps and products of the step.
    pub solved: (f64, usize, usize),
}

/// From the first flow's walls to the recorded surface and the shape of the coordinate on it, `[patch][node]`.
type MakeSurface = Box<dyn Fn(&[WallPatch]) -> (SurfaceGrid, Vec<Vec<[f64; 3]>>)>;

/// Writes the recording and keeps the last cycle's pressures.
pub struct Recorder {
    /// Progress and Ctrl-C.
    pub watch: Watch,
    path: PathBuf,
    /// Everything but the surface, which is made from the first flow's walls.
    setup: Setup,
    surface: MakeSurface,
    writer: Option<Writer>,
    /// Last step of an earlier run.
    resumed: Option<u32>,
    force_n: f64,
    moment_n_m: f64,
    /// Number of walls kept: a cycle.
    keep: usize,
    /// Walls of the last cycle, oldest first.
    pub walls: Vec<Vec<WallPatch>>,
    /// Every step of this run.
    pub lines: Vec<Line>,
    steps: usize,
    last_line: Option<Instant>,
}

impl std::fmt::Debug for Recorder {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Recorder")
            .field("path", &self.path)
            .finish_non_exhaustive()
    }
}

impl Recorder {
    /// `surface` makes the recorded surface, and the shape of the coordinate on it, from the walls.
    pub fn new(
        watch: Watch,
        path: PathBuf,
        setup: Setup,
        surface: impl Fn(&[WallPatch]) -> (SurfaceGrid, Vec<Vec<[f64; 3]>>) + 'static,
        keep: usize,
        steps: usize,
    ) -> Self {
        let q = setup.references.dynamic_pressure_pa();
        let area = setup.references.reference_area_m2;
        Self {
            watch,
            path,
            force_n: q * area,
            moment_n_m: q * area * setup.references.reference_chord_m,
            setup,
            surface: Box::new(surface),
            writer: None,
            resumed: None,
            keep,
            walls: Vec::new(),
            lines: Vec::new(),
            steps,
            last_line: None,
        }
    }

    /// Ends the recording.
    ///
    /// # Errors
    /// If the rest cannot be written.
    pub fn finish(&mut self, reason: &str) -> Result<(), String> {
        match self.writer.take() {
            Some(writer) => writer.finish(reason).map_err(|e| e.to_string()),
            None => Ok(()),
        }
    }

    fn open(&mut self, walls: &[WallPatch]) -> Result<(), String> {
        if self.writer.is_some() {
            return Ok(());
        }
        let (surface, shape) = (self.surface)(walls);
        self.setup.surface = surface;
        if let Some(coordinate) = self.setup.motion.first_mut() {
            coordinate.shape_m = shape;
        }
        let setup = self.setup.clone();
        let writer = match self.resumed {
            Some(last) => Writer::resume(&self.path, setup, WriterOptions::default(), last),
            None => Writer::create(&self.path, setup, WriterOptions::default()),
        };
        self.writer = Some(writer.map_err(|e| e.to_string())?);
        Ok(())
    }

    fn say(&mut self, step: &ForcedStep<'_>) {
        let change = if step.cycle_change.is_finite() {
            format!(", cycle to cycle {:.2} %", 100.0 * step.cycle_change)
        } else {
            String::new()
        };
        let c = &step.loads.total;
        let line = format!(
            "time step {:>4} of {}  {:.2} orders in {} ({} products)  CL {:.6}  CM {:.6}{change}  {:.1} s, {:.0} s left",
            step.number,
            self.steps,
            step.outcome.orders,
            step.outcome.iterations,
            step.outcome.products,
            c.cl,
            c.cm,
            step.seconds,
            step.seconds_left
        );
        let part = step.number as f64 / self.steps.max(1) as f64;
        if self.watch.show(part, &line) {
            return;
        }
        const INTERVAL: Duration = Duration::from_secs(5);
        if self.last_line.is_none_or(|at| at.elapsed() >= INTERVAL) {
            tracing::info!("{line}");
            self.last_line = Some(Instant::now());
        } else {
            tracing::debug!("{line}");
        }
    }
}

impl Observer for Recorder {
    fn progress(&mut self, progress: &Progress) {
        self.watch.progress(progress);
    }

    fn message(&mut self, text: &str) {
        self.watch.message(text);
    }
}

impl ForcedObserver for Recorder {
    fn step(&mut self, step: &ForcedStep<'_>) -> Result<(), String> {
        self.watch.interrupt();
        self.open(step.walls)?;
        let speed = self.setup.references.speed_m_s;
        let c = &step.loads.total;
        let time_s = step.time / speed;
        let motion: Vec<MotionValue> = step
            .motion
            .iter()
            .map(|[value, rate]| MotionValue {
                value: *value,
                // Rates of the solver are per metre of stream.
                rate: rate * speed,
            })
            .collect();
        self.lines.push(Line {
            time_s,
            value: motion.first().map_or(0.0, |m| m.value),
            loads: [c.cl, c.cd, c.cm],
            solved: (step.outcome.orders, step.outcome.iterations, step.outcome.products),
        });
        let record = Step {
            number: u32::try_from(step.number).map_err(|e| e.to_string())?,
            time_s,
            motion,
            pressures: step.walls.iter().map(|w| w.cp.clone()).collect(),
            loads: Loads {
                cl: c.cl,
                cd: c.cd,
                cm: c.cm,
                force_n: c.force.map(|f| f * self.force_n),
                moment_n_m: c.moment.map(|m| m * self.moment_n_m),
            },
            modal: None,
            convergence: Convergence {
                orders: step.outcome.orders,
                iterations: u32::try_from(step.outcome.iterations).unwrap_or(u32::MAX),
                converged: step.outcome.converged,
            },
            shape_m: None,
        };
        if let Some(writer) = &mut self.writer {
            writer.step(&record).map_err(|e| e.to_string())?;
        }
        if self.keep > 0 {
            if self.walls.len() == self.keep {
                self.walls.remove(0);
            }
            self.walls.push(step.walls.to_vec());
        }
        self.say(step);
        Ok(())
    }

    fn resumed(&mut self, number: usize) -> Result<(), String> {
        self.resumed = Some(u32::try_from(number).map_err(|e| e.to_string())?);
        self.watch.message(&format!("going on after time step {number}"));
        Ok(())
    }
}
