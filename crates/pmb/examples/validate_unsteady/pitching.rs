//! A section in harmonic motion, run until two cycles agree, and its first harmonics.

use std::error::Error;
use std::f64::consts::TAU;
use std::sync::atomic::AtomicBool;

use dip_grid::MultiBlock;
use dip_pmb::dual_time::DualTimeSettings;
use dip_pmb::forced::{ForcedObserver, ForcedSettings, ForcedStep, run};
use dip_pmb::motion::{Coordinate, Harmonic, Law, Motion, Shape};
use dip_pmb::moving::Nodes;
use dip_pmb::observer::{Observer, Progress};
use dip_pmb::settings::{Reference, SteadySettings};
use nalgebra::Complex;

/// One run. Chord 1, moments about the quarter chord.
#[derive(Clone, Copy, Debug)]
pub struct Pitching {
    /// Mach number.
    pub mach: f64,
    /// Reduced frequency, omega c/(2U).
    pub k: f64,
    /// Mean angle, degrees.
    pub mean_deg: f64,
    /// Amplitude, degrees; or chords, when plunging.
    pub amplitude: f64,
    /// Axis, chords from the leading edge; none for plunging.
    pub axis: Option<f64>,
    /// Steps in a cycle.
    pub steps: usize,
    /// Orders of magnitude in a step.
    pub orders: f64,
}

/// What came of it. Harmonics are per unit of motion, Re(A e^(i omega t)) of a motion Re(e^(i omega t)).
#[derive(Debug)]
pub struct Cycle {
    /// Lift and moment.
    pub harmonics: [Complex<f64>; 2],
    /// Means of lift and moment.
    pub means: [f64; 2],
    /// Angle in degrees (or rise), lift, moment over the last cycle and its first point again.
    pub loop_points: Vec<[f64; 3]>,
    /// x/c, whether the face is an upper one, and pressure coefficients of the last cycle, from phase 0 on.
    pub faces: Vec<(f64, bool, Vec<f64>)>,
    /// Cycles taken.
    pub cycles: usize,
    /// Change from the last cycle but one to the last.
    pub change: f64,
    /// Steps that did not converge.
    pub not_converged: usize,
    /// Pseudo steps a step.
    pub iterations: f64,
    /// Products with the operator a step.
    pub products: f64,
}

#[derive(Default)]
struct Pressures {
    steps: Vec<Vec<f64>>,
    faces: Vec<([f64; 3], bool)>,
}

impl Observer for Pressures {
    fn progress(&mut self, _: &Progress) {}
    fn message(&mut self, _: &str) {}
}

impl ForcedObserver for Pressures {
    fn step(&mut self, step: &ForcedStep<'_>) -> Result<(), String> {
        if step.number == 0 {
            for w in step.walls {
                self.faces
                    .extend(w.centre.iter().zip(&w.area).map(|(c, a)| (*c, a[2] < 0.0)));
            }
        }
        self.steps
            .push(step.walls.iter().flat_map(|w| w.cp.iter().copied()).collect());
        Ok(())
    }
    fn resumed(&mut self, _: usize) -> Result<(), String> {
        Ok(())
    }
}

impl Pitching {
    /// Runs it on `grid` until lift and moment of two cycles differ by less than 0.2 %, ten cycles at most.
    pub fn run(&self, grid: &MultiBlock) -> Result<Cycle, Box<dyn Error>> {
        let omega = 2.0 * self.k;
        let dt = TAU / omega / self.steps as f64;
        let mut steady = SteadySettings {
            reference: Reference {
                area: 1.0,
                chord: 1.0,
                moment_point: [0.25, 0.0, 0.0],
            },
            ..SteadySettings::default()
        };
        steady.flow.mach = self.mach;
        steady.solver.orders = 6.0;
        let settings = ForcedSettings {
            steady,
            time: DualTimeSettings {
                dt,
                orders: self.orders,
                ..DualTimeSettings::default()
            },
            steps_per_cycle: self.steps,
            steps: 10 * self.steps,
            cycle_tolerance: 2e-3,
            restart: None,
            resume: false,
            checkpoint_steps: 0,
        };
        let (shape, unit) = match self.axis {
            Some(axis) => (
                Shape::Rotation {
                    point: [axis, 0.0, 0.0],
                    axis: [0.0, 1.0, 0.0],
                },
                1.0_f64.to_radians(),
            ),
            None => (
                Shape::Translation {
                    direction: [0.0, 0.0, 1.0],
                },
                1.0,
            ),
        };
        let law = Law::Harmonic {
            mean: self.mean_deg * unit,
            terms: vec![Harmonic {
                amplitude: self.amplitude * unit,
                omega,
                phase: 0.0,
            }],
        };
        let motion = Motion {
            rest: Nodes::of(grid),
            coordinates: vec![Coordinate {
                name: "motion".into(),
                shape,
                law: law.clone(),
                blocks: None,
            }],
        };
        let mut seen = Pressures::default();
        let result = run(&settings, grid, &motion, &mut seen, &AtomicBool::new(false))?;
        let n = self.steps;
        let last = result.steps + 1 - n..result.steps + 1;
        // sin is Re(-i e^(i omega t)): the part along it is in phase, the part along cos a quarter ahead.
        let harmonic = |c: usize| {
            let mut sum = Complex::new(0.0, 0.0);
            for step in last.clone() {
                let (sin, cos) = (TAU * step as f64 / n as f64).sin_cos();
                sum += Complex::new(sin, cos) * result.history[step][c];
            }
            sum * (2.0 / (n as f64 * self.amplitude * unit))
        };
        let mean = |c: usize| result.history[last.clone()].iter().map(|h| h[c]).sum::<f64>() / n as f64;
        let first = result.steps - n;
        let loop_points = (first..=result.steps)
            .map(|step| {
                let [cl, _, cm] = result.history[step];
                [law.at(step as f64 * dt)[0] / unit, cl, cm]
            })
            .collect();
        let (sin, cos) = (self.mean_deg.to_radians()).sin_cos();
        let axis = self.axis.unwrap_or(0.0);
        let faces = seen
            .faces
            .iter()
            .enumerate()
            .map(|(f, (centre, upper))| {
                let x = axis + (centre[0] - axis) * cos - centre[2] * sin;
                let cp = (first..result.steps).map(|step| seen.steps[step][f]).collect();
                (x, *upper, cp)
            })
            .collect();
        Ok(Cycle {
            harmonics: [harmonic(0), harmonic(2)],
            means: [mean(0), mean(2)],
            loop_points,
            faces,
            cycles: result.steps / n,
            change: result.cycle_change,
            not_converged: result.not_converged,
            iterations: result.iterations as f64 / result.steps as f64,
            products: result.products as f64 / result.steps as f64,
        })
    }
}

impl Cycle {
    /// Value at a phase (radians) of a quantity given at the steps of the cycle from phase 0 on.
    pub fn at_phase(values: &[f64], phase: f64) -> f64 {
        let n = values.len();
        let s = phase.rem_euclid(TAU) / TAU * n as f64;
        let i = s.floor() as usize % n;
        let t = s - s.floor();
        values[i] * (1.0 - t) + values[(i + 1) % n] * t
    }

    /// x/c and a pressure of every face of one side, in order of x.
    pub fn side(&self, upper: bool, value: impl Fn(&[f64]) -> f64) -> Vec<(f64, f64)> {
        let mut points: Vec<_> = self
            .faces
            .iter()
            .filter(|f| f.1 == upper)
            .map(|(x, _, cp)| (*x, value(cp)))
            .collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        points
    }
}
