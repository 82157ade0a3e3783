//! Whole runs with prescribed motion: exact restart, threads, counting of what did not converge.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};

use dip_grid::generate::BoxGrid;
use dip_grid::{Condition, MultiBlock, split};
use dip_pmb::FlowError;
use dip_pmb::dual_time::{DualTimeSettings, TimeScheme};
use dip_pmb::forced::{ForcedObserver, ForcedResult, ForcedSettings, ForcedStep, ForcedStop, run};
use dip_pmb::motion::{Coordinate, Harmonic, Law, Motion, Shape};
use dip_pmb::moving::Nodes;
use dip_pmb::observer::{Observer, Progress};
use dip_pmb::settings::SteadySettings;

const STEPS: usize = 24;

/// A box with a bump on its floor in two blocks, and a motion of both kinds: the whole turns while the bump grows.
fn case() -> (MultiBlock, Motion) {
    use Condition::{FarField, Symmetry, Wall};
    let mut grid = BoxGrid::new([-1.0, 0.0, 0.0], [2.0, 1.0, 1.5], [12, 4, 6])
        .conditions([FarField, FarField, Symmetry, Symmetry, Wall, FarField])
        .make();
    split::split_into(&mut grid, 2);
    let rest = Nodes::of(&grid);
    let mut shape = rest.clone();
    for block in &mut shape.blocks {
        let [x, y, z] = block;
        for n in 0..x.len() {
            let s = x[n].clamp(0.0, 1.0);
            z[n] = (std::f64::consts::PI * s).sin().powi(4) * (1.0 - z[n] / 1.5);
            (x[n], y[n]) = (0.0, 0.0);
        }
    }
    let harmonic = |mean: f64, amplitude: f64, phase: f64| Law::Harmonic {
        mean,
        terms: vec![Harmonic {
            amplitude,
            omega: 1.0,
            phase,
        }],
    };
    let coordinates = vec![
        Coordinate {
            name: "bump".into(),
            shape: Shape::Field(shape),
            law: harmonic(0.05, 0.03, 0.3),
            blocks: None,
        },
        Coordinate {
            name: "turn".into(),
            shape: Shape::Rotation {
                point: [0.3, 0.0, 0.0],
                axis: [0.0, 1.0, 0.0],
            },
            law: harmonic(0.0, 0.02, 0.0),
            blocks: None,
        },
    ];
    (grid, Motion { rest, coordinates })
}

fn settings(restart: Option<PathBuf>) -> ForcedSettings {
    let mut steady = SteadySettings::default();
    steady.flow.mach = 0.6;
    steady.solver.orders = 5.0;
    ForcedSettings {
        steady,
        time: DualTimeSettings {
            dt: std::f64::consts::TAU / 12.0,
            ..DualTimeSettings::default()
        },
        steps_per_cycle: 12,
        steps: STEPS,
        cycle_tolerance: 0.0,
        resume: restart.is_some(),
        restart,
        checkpoint_steps: 0,
    }
}

/// Writes down every step; stops the run after some.
#[derive(Default)]
struct Notes<'a> {
    numbers: Vec<usize>,
    /// All numbers of a step: motion, force, moment, pressures, as bits.
    bits: Vec<Vec<u64>>,
    resumed: Option<usize>,
    messages: Vec<String>,
    stop_after: Option<(usize, &'a AtomicBool)>,
    fail_at: Option<usize>,
}

impl Observer for Notes<'_> {
    fn progress(&mut self, _: &Progress) {}
    fn message(&mut self, text: &str) {
        self.messages.push(text.to_owned());
    }
}

impl ForcedObserver for Notes<'_> {
    fn step(&mut self, step: &ForcedStep<'_>) -> Result<(), String> {
        self.numbers.push(step.number);
        let loads = step.loads.total.force.into_iter().chain(step.loads.total.moment);
        let walls = step.walls.iter().flat_map(|w| {
            let centres = w.centre.iter().flatten().copied();
            w.cp.iter().copied().chain(centres)
        });
        let numbers = step.motion.iter().flatten().copied().chain(loads).chain(walls);
        self.bits.push(numbers.map(f64::to_bits).collect());
        if let Some((number, cancel)) = self.stop_after
            && step.number >= number
        {
            cancel.store(true, Ordering::Relaxed);
        }
        if self.fail_at == Some(step.number) {
            return Err("the disk is full".into());
        }
        Ok(())
    }
    fn resumed(&mut self, number: usize) -> Result<(), String> {
        self.resumed = Some(number);
        Ok(())
    }
}

fn whole(settings: &ForcedSettings) -> (ForcedResult, Vec<Vec<u64>>) {
    let (grid, motion) = case();
    let mut notes = Notes::default();
    let result = run(settings, &grid, &motion, &mut notes, &AtomicBool::new(false)).expect("a run");
    (result, notes.bits)
}

fn history_bits(result: &ForcedResult) -> Vec<[u64; 3]> {
    result.history.iter().map(|h| h.map(f64::to_bits)).collect()
}

#[test]
fn a_resumed_unsteady_run_has_the_bits_of_one_that_never_stopped() {
    for scheme in [TimeScheme::Bdf2, TimeScheme::Bdf2Opt] {
        resumed_has_the_bits_of_whole(scheme);
    }
}

fn resumed_has_the_bits_of_whole(scheme: TimeScheme) {
    let with_scheme = |restart| {
        let mut s = settings(restart);
        s.time.scheme = scheme;
        s
    };
    let (reference, bits) = whole(&with_scheme(None));
    assert_eq!(reference.stop, ForcedStop::AllSteps);
    assert_eq!((reference.steps, reference.not_converged), (STEPS, 0));
    let (grid, motion) = case();
    let folder = tempfile::tempdir().expect("a folder");
    let s = with_scheme(Some(folder.path().join("case.restart")));
    // Stopped after the first step (of first order in time), then at steps without pattern.
    let mut all = Vec::new();
    for (after, from) in [
        (1, None),
        (2, Some(1)),
        (7, Some(2)),
        (16, Some(7)),
        (STEPS + 1, Some(16)),
    ] {
        let cancel = AtomicBool::new(false);
        let mut notes = Notes {
            stop_after: Some((after, &cancel)),
            ..Notes::default()
        };
        let result = run(&s, &grid, &motion, &mut notes, &cancel).expect("a run");
        assert_eq!(notes.resumed, from);
        all.extend(notes.bits);
        if after > STEPS {
            assert_eq!(result.stop, ForcedStop::AllSteps);
            assert_eq!(history_bits(&result), history_bits(&reference));
            assert_eq!(
                (result.iterations, result.products, result.builds),
                (reference.iterations, reference.products, reference.builds)
            );
        } else {
            assert_eq!((result.stop, result.steps), (ForcedStop::Interrupted, after));
        }
    }
    assert_eq!(all.len(), bits.len());
    for (step, (a, b)) in all.iter().zip(&bits).enumerate() {
        assert_eq!(a, b, "step {step}");
    }
}

#[test]
fn unsteady_runs_have_the_same_bits_for_any_number_of_threads() {
    let mut s = settings(None);
    s.steps = 8;
    let run_with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("a thread pool");
        pool.install(|| whole(&s).1)
    };
    let one = run_with(1);
    for threads in [2, 5] {
        assert_eq!(one, run_with(threads), "{threads} threads");
    }
}

#[test]
fn steps_that_do_not_converge_are_counted_and_told() {
    let (grid, motion) = case();
    let mut s = settings(None);
    s.steps = 5;
    s.time.orders = 8.0;
    s.time.max_iterations = 1;
    let mut notes = Notes::default();
    let result = run(&s, &grid, &motion, &mut notes, &AtomicBool::new(false)).expect("a run");
    assert_eq!((result.steps, result.not_converged), (5, 5));
    let told: Vec<_> = notes
        .messages
        .iter()
        .filter(|m| m.contains("8.00 were asked for"))
        .collect();
    assert_eq!(told.len(), 5, "{:?}", notes.messages);
    // The steps are in the record all the same.
    assert_eq!(notes.numbers, [0, 1, 2, 3, 4, 5]);
}

#[test]
fn a_run_ends_when_two_cycles_agree() {
    let mut s = settings(None);
    s.steps = 20 * 12;
    s.cycle_tolerance = 0.01;
    let (result, _) = whole(&s);
    assert_eq!(result.stop, ForcedStop::Periodic);
    assert!(result.steps.is_multiple_of(12) && result.steps >= 24 && result.steps < s.steps);
    assert!(result.cycle_change < 0.01);
}

#[test]
fn a_run_whose_listener_fails_can_go_on_later() {
    let (grid, motion) = case();
    let folder = tempfile::tempdir().expect("a folder");
    let mut s = settings(Some(folder.path().join("case.restart")));
    s.steps = 6;
    s.checkpoint_steps = 3;
    let mut notes = Notes {
        fail_at: Some(4),
        ..Notes::default()
    };
    let error = run(&s, &grid, &motion, &mut notes, &AtomicBool::new(false)).expect_err("a full disk");
    assert!(
        matches!(&error, FlowError::Observer { what } if what == "the disk is full"),
        "{error}"
    );
    let mut rest = Notes::default();
    let result = run(&s, &grid, &motion, &mut rest, &AtomicBool::new(false)).expect("a run");
    // What the listener kept need not reach step 4: the run goes on from the restart file before it.
    assert_eq!((rest.resumed, result.steps), (Some(3), 6));
    assert_eq!(rest.numbers, [4, 5, 6]);
    // Another motion is refused by name.
    let mut other = motion.clone();
    other.coordinates[0].name = "dent".into();
    let error = run(&s, &grid, &other, &mut rest, &AtomicBool::new(false)).expect_err("another motion");
    assert!(error.to_string().contains("dent"), "{error}");
}

#[test]
fn motion_that_folds_the_grid_ends_the_run_with_block_and_cell() {
    let (grid, mut motion) = case();
    motion.coordinates[0].law = Law::Ramp {
        from: 0.0,
        to: 4.0,
        duration: 1.0,
    };
    let s = settings(None);
    let error = run(&s, &grid, &motion, &mut Notes::default(), &AtomicBool::new(false)).expect_err("a folded grid");
    assert!(
        matches!(&error, FlowError::Volume { block, .. } if grid.blocks.iter().any(|b| b.name == *block)),
        "{error}"
    );
}

#[test]
fn a_flow_that_has_come_to_rest_costs_nothing_and_counts_as_converged() {
    let (grid, mut motion) = case();
    motion.coordinates.truncate(1);
    motion.coordinates[0].law = Law::Ramp {
        from: 0.02,
        to: 0.05,
        duration: 5.0,
    };
    let mut s = settings(None);
    // The box is some lengths long: forty steps of 20 lengths wash everything out.
    s.time.dt = 20.0;
    s.steps_per_cycle = 0;
    s.steps = 40;
    let mut last = Vec::new();
    struct Last<'a>(&'a mut Vec<(bool, usize)>);
    impl Observer for Last<'_> {
        fn progress(&mut self, _: &Progress) {}
        fn message(&mut self, _: &str) {}
    }
    impl ForcedObserver for Last<'_> {
        fn step(&mut self, step: &ForcedStep<'_>) -> Result<(), String> {
            self.0.push((step.outcome.converged, step.outcome.iterations));
            Ok(())
        }
        fn resumed(&mut self, _: usize) -> Result<(), String> {
            Ok(())
        }
    }
    let result = run(&s, &grid, &motion, &mut Last(&mut last), &AtomicBool::new(false)).expect("a run");
    assert_eq!(result.not_converged, 0, "{last:?}");
    assert!(
        last[1].1 > 0 && last[STEPS..].iter().rev().take(10).all(|l| *l == (true, 0)),
        "{last:?}"
    );
}
