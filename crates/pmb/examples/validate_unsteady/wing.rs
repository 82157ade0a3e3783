//! A half wing that pitches as a rigid body: first harmonics cycle by cycle, and what a cycle costs.

use std::error::Error;
use std::f64::consts::TAU;
use std::sync::atomic::AtomicBool;

use cpu_time::ProcessTime;
use dip_grid::MultiBlock;
use dip_pmb::cut::cut;
use dip_pmb::dual_time::{DualTime, DualTimeSettings, TimeScheme};
use dip_pmb::loads::{WallGeometry, WallPatch, integrate};
use dip_pmb::motion::{Coordinate, Harmonic, Law, Motion, Shape};
use dip_pmb::moving::Nodes;
use dip_pmb::observer::Silent;
use dip_pmb::settings::{Reference, SteadySettings};
use dip_pmb::solver::{Equations, Solver};
use dip_pmb::steady;
use nalgebra::Complex;

/// Stream, wing and motion. Lengths in m.
#[derive(Clone, Copy, Debug)]
pub struct Wing {
    /// Mach number.
    pub mach: f64,
    /// Mean incidence, degrees.
    pub alpha_deg: f64,
    /// Reduced frequency omega c/(2U) with the root chord.
    pub k: f64,
    /// Amplitude, degrees.
    pub amplitude_deg: f64,
    /// Root chord, which is the reference chord too.
    pub chord: f64,
    /// Area of the half wing.
    pub area: f64,
    /// Axis, root chords from the root's leading edge; moments are about it.
    pub axis: f64,
}

/// The steady flow that runs start from.
pub struct Start<'a> {
    grid: &'a MultiBlock,
    wing: Wing,
    settings: SteadySettings,
    equations: Equations,
    /// Orders that the steady residual fell, in words.
    pub stop: String,
    /// CPU seconds it took.
    pub cpu_s: f64,
}

/// First harmonics of one cycle per radian, Re(A e^(i omega t)) of a motion Re(e^(i omega t)), and its cost.
#[derive(Clone, Debug)]
pub struct WingCycle {
    /// Lift and moment.
    pub harmonics: [Complex<f64>; 2],
    /// Real and imaginary part of Cp on the walls where they are at the mean angle.
    pub cp: [Vec<WallPatch>; 2],
    /// CPU seconds of all threads.
    pub cpu_s: f64,
    /// Newton steps.
    pub iterations: usize,
    /// Products with the operator.
    pub products: usize,
    /// Steps that did not converge.
    pub not_converged: usize,
}

/// What came of a motion.
pub struct Lift {
    /// Time, angle, lift coefficient after every step.
    pub history: Vec<[f64; 3]>,
    /// CPU seconds.
    pub cpu_s: f64,
}

impl Lift {
    /// Lift per radian at a frequency: ratio of the transforms of lift and angle over the last `steps` steps.
    pub fn per_radian(&self, omega: f64, steps: usize) -> Complex<f64> {
        let zero = Complex::new(0.0, 0.0);
        let last = &self.history[self.history.len().saturating_sub(steps)..];
        let [angle, lift] = last.iter().fold([zero; 2], |[angle, lift], [time, a, cl]| {
            let wave = Complex::new(0.0, -omega * time).exp();
            [angle + wave * a, lift + wave * cl]
        });
        lift / angle
    }
}

impl<'a> Start<'a> {
    /// Solves the steady flow at the mean incidence.
    pub fn new(wing: Wing, grid: &'a MultiBlock) -> Result<Self, Box<dyn Error>> {
        let mut settings = SteadySettings::default();
        settings.flow.mach = wing.mach;
        settings.flow.alpha_deg = wing.alpha_deg;
        settings.reference = Reference {
            area: wing.area,
            chord: wing.chord,
            moment_point: [wing.axis * wing.chord, 0.0, 0.0],
        };
        settings.solver.orders = 6.0;
        let begin = ProcessTime::now();
        let result = steady::run(&settings, grid, &mut Silent, &AtomicBool::new(false))?;
        Ok(Self {
            grid,
            wing,
            settings,
            equations: result.solver.equations,
            stop: format!("{:?}", result.stop),
            cpu_s: begin.elapsed().as_secs_f64(),
        })
    }

    /// Pitch about the wing's axis.
    fn motion(&self, law: Law) -> Motion {
        Motion {
            rest: Nodes::of(self.grid),
            coordinates: vec![Coordinate {
                name: "pitch".into(),
                shape: Shape::Rotation {
                    point: [self.wing.axis * self.wing.chord, 0.0, 0.0],
                    axis: [0.0, 1.0, 0.0],
                },
                law,
                blocks: None,
            }],
        }
    }

    /// Angle and lift after every step of any motion, and the CPU seconds it took.
    pub fn lift(&self, law: &Law, dt: f64, steps: usize, orders: f64) -> Result<Lift, Box<dyn Error>> {
        let begin = ProcessTime::now();
        let motion = self.motion(law.clone());
        let level = &self.equations.level;
        let mut walls = WallGeometry::merged(self.grid, level, &self.equations.boundaries, level);
        let settings = DualTimeSettings {
            dt,
            orders,
            ..DualTimeSettings::default()
        };
        let mut flow = DualTime::new(Solver::new(self.equations.clone()), self.grid, settings);
        let mut history = Vec::with_capacity(steps);
        for step in 1..=steps {
            let time = step as f64 * dt;
            flow.advance(|nodes| motion.place(time, nodes))?;
            let e = &flow.solver.equations;
            walls.follow(&e.level, &flow.grid.now);
            let now = walls.pressures(&e.level, &e.sides, &self.settings.flow);
            let loads = integrate(&now, &self.settings.flow, &self.settings.reference).total;
            history.push([time, law.at(time)[0], loads.cl]);
        }
        Ok(Lift {
            history,
            cpu_s: begin.elapsed().as_secs_f64(),
        })
    }

    /// Runs some cycles of `steps` each, every step by `orders`.
    pub fn run(
        &self,
        scheme: TimeScheme,
        steps: usize,
        orders: f64,
        cycles: usize,
    ) -> Result<Vec<WingCycle>, Box<dyn Error>> {
        let wing = &self.wing;
        let omega = 2.0 * wing.k / wing.chord;
        let dt = TAU / omega / steps as f64;
        let amplitude = wing.amplitude_deg.to_radians();
        let motion = self.motion(Law::Harmonic {
            mean: 0.0,
            terms: vec![Harmonic {
                amplitude,
                omega,
                phase: 0.0,
            }],
        });
        let level = &self.equations.level;
        let mut walls = WallGeometry::merged(self.grid, level, &self.equations.boundaries, level);
        let at_rest = walls.pressures(level, &self.equations.sides, &self.settings.flow);
        let settings = DualTimeSettings {
            scheme,
            dt,
            orders,
            ..DualTimeSettings::default()
        };
        let mut flow = DualTime::new(Solver::new(self.equations.clone()), self.grid, settings);
        let mut out = Vec::new();
        for _ in 0..cycles {
            let begin = ProcessTime::now();
            let mut cycle = WingCycle {
                harmonics: [Complex::new(0.0, 0.0); 2],
                cp: [at_rest.clone(), at_rest.clone()],
                cpu_s: 0.0,
                iterations: 0,
                products: 0,
                not_converged: 0,
            };
            for cp in cycle.cp.iter_mut().flatten().flat_map(|w| &mut w.cp) {
                *cp = 0.0;
            }
            for _ in 0..steps {
                let time = (flow.step + 1) as f64 * dt;
                let outcome = flow.advance(|nodes| motion.place(time, nodes))?;
                cycle.iterations += outcome.iterations;
                cycle.products += outcome.products;
                cycle.not_converged += usize::from(!outcome.converged);
                let e = &flow.solver.equations;
                walls.follow(&e.level, &flow.grid.now);
                let now = walls.pressures(&e.level, &e.sides, &self.settings.flow);
                let loads = integrate(&now, &self.settings.flow, &self.settings.reference).total;
                // sin is Re(-i e^(i omega t)): the part along it is in phase, the part along cos a quarter ahead.
                let (sin, cos) = (omega * time).sin_cos();
                let part = Complex::new(sin, cos) * (2.0 / (steps as f64 * amplitude));
                for (sum, value) in cycle.harmonics.iter_mut().zip([loads.cl, loads.cm]) {
                    *sum += part * value;
                }
                for (sums, part) in cycle.cp.iter_mut().zip([part.re, part.im]) {
                    let faces = sums.iter_mut().flat_map(|w| &mut w.cp);
                    for (sum, cp) in faces.zip(now.iter().flat_map(|w| &w.cp)) {
                        *sum += part * cp;
                    }
                }
            }
            cycle.cpu_s = begin.elapsed().as_secs_f64();
            out.push(cycle);
        }
        Ok(out)
    }
}

impl WingCycle {
    /// Real and imaginary part of Cp over x/c at `y`: upper side, lower side.
    pub fn section(&self, y: f64) -> [[Vec<(f64, f64)>; 2]; 2] {
        [0, 1].map(|part| {
            let cut = cut(&self.cp[part], y, false);
            let all = || cut.upper.iter().chain(&cut.lower).map(|p| p[0]);
            let (nose, tail) = (all().fold(f64::MAX, f64::min), all().fold(f64::MIN, f64::max));
            [&cut.upper, &cut.lower].map(|side| side.iter().map(|p| ((p[0] - nose) / (tail - nose), p[2])).collect())
        })
    }
}
