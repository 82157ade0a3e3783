//! Flow and structure together: energy, order in time, static position, restart, threads.

use std::path::Path;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};

use dip_grid::MultiBlock;
use dip_modal::{GridModes, Integrator, ModalEquations, ModalState, MovingWall, StepScheme};
use dip_pmb::FlowError;
use dip_pmb::couple::{Coupled, Coupling, Stream, Structure};
use dip_pmb::dual_time::DualTimeSettings;
use dip_pmb::march::mean::{DeflectionSettings, MeanFlow, deflected, rigid};
use dip_pmb::march::{MarchObserver, MarchResult, MarchSettings, MarchStep, MarchStop, Verdict, Wing, run};
use dip_pmb::moving::Nodes;
use dip_pmb::observer::{Observer, Progress, Silent};
use dip_pmb::settings::{Reference, SteadySettings};
use dip_pmb::steady;
use nalgebra::Vector3;

const SEMISPAN: f64 = 0.762;
const OMEGA: [f64; 2] = [60.0, 240.0];

fn grid() -> &'static MultiBlock {
    static GRID: OnceLock<MultiBlock> = OnceLock::new();
    GRID.get_or_init(|| {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../meshes/agard445_oo_coarsest.toml");
        dip_grid::recipe::make(&path).expect("the grid")
    })
}

/// A wing that bends (mode 1) and twists (mode 2), 1 m and 10 rad at the tip for a unit, 0.3 kg and 0.5 kg.
fn wing() -> Wing {
    let wall = MovingWall::new(grid(), |p| p.condition.is_wall()).expect("a wall");
    let at = |shape: &dyn Fn(Vector3<f64>) -> Vector3<f64>| wall.points().into_iter().map(shape).collect::<Vec<_>>();
    let bend = at(&|p| {
        let s = p.y / SEMISPAN;
        Vector3::new(0.0, -2.0 * s / SEMISPAN * p.z, s * s)
    });
    let twist = at(&|p| {
        let s = p.y / SEMISPAN;
        Vector3::new(10.0 * s * p.z, 0.0, -10.0 * s * (p.x - 0.28 - 0.71 * s))
    });
    let modes = GridModes::new(grid(), &wall, &[bend, twist], None).expect("shapes");
    let equations = ModalEquations::new(OMEGA.to_vec(), vec![0.0; 2], vec![0.3, 0.5]).expect("equations");
    Wing::new(equations, &modes, grid()).expect("a wing")
}

fn flow(alpha_deg: f64) -> SteadySettings {
    let mut s = SteadySettings::default();
    s.flow.mach = 0.7;
    s.flow.alpha_deg = alpha_deg;
    s.solver.orders = 8.0;
    s.reference = Reference {
        area: 0.35315,
        chord: 0.5587,
        moment_point: [0.0; 3],
    };
    s
}

fn stream() -> Stream {
    Stream {
        speed_m_s: 230.0,
        density_kg_m3: 0.1,
        length_m: 1.0,
    }
}

fn settings(steps: usize) -> MarchSettings {
    MarchSettings {
        steady: flow(0.0),
        time: DualTimeSettings::default(),
        step_s: 2.0e-3,
        steps,
        scheme: StepScheme::default(),
        coupling: Coupling::Tight,
        exchange_tolerance: 1e-6,
        start_rate_1_s: vec![0.1, 0.0],
        largest_displacement: 0.5,
        restart: None,
        resume: false,
        checkpoint_steps: 0,
    }
}

fn still() -> &'static MeanFlow {
    static STILL: OnceLock<MeanFlow> = OnceLock::new();
    STILL.get_or_init(|| {
        rigid(&flow(0.0), grid(), 2, &mut Silent, &AtomicBool::new(false))
            .expect("a flow")
            .expect("not interrupted")
    })
}

/// Asks to stop after `last` steps, through the flag that Ctrl-C sets.
struct Until<'a> {
    last: usize,
    cancel: &'a AtomicBool,
    resumed: Option<usize>,
}

impl Observer for Until<'_> {
    fn progress(&mut self, _: &Progress) {}
    fn message(&mut self, _: &str) {}
}

impl MarchObserver for Until<'_> {
    fn step(&mut self, step: &MarchStep<'_>) -> Result<Verdict, String> {
        if step.number == self.last {
            self.cancel.store(true, Ordering::Relaxed);
        }
        Ok(Verdict::GoOn)
    }
    fn resumed(&mut self, number: usize, states: &[ModalState]) -> Result<(), String> {
        assert_eq!(states.len(), number + 1);
        self.resumed = Some(number);
        Ok(())
    }
}

fn march(settings: &MarchSettings, mean: &MeanFlow, last: usize) -> MarchResult {
    let cancel = AtomicBool::new(false);
    let mut until = Until {
        last,
        cancel: &cancel,
        resumed: None,
    };
    run(settings, grid(), &wing(), stream(), mean, &mut until, &cancel).expect("a march")
}

#[test]
fn the_work_of_the_pressure_is_the_change_of_the_structures_energy() {
    let energy = |s: &ModalState| wing().equations.energy_j(&s.q, &s.q_dot);
    let miss = |scheme, step_s, steps| {
        let result = march(
            &MarchSettings {
                scheme,
                step_s,
                ..settings(steps)
            },
            still(),
            usize::MAX,
        );
        let change = energy(&result.states[steps]) - energy(&result.states[0]);
        assert!(change.abs() > 1e-2 * energy(&result.states[0]));
        (change - result.work_j).abs() / change.abs()
    };
    // The trapezoidal rule has the energy of the mean force exactly.
    let exact = miss(StepScheme::Newmark, 2e-3, 15);
    assert!(exact < 1e-9, "{exact}");
    let order = (miss(StepScheme::StateTransition, 2e-3, 12) / miss(StepScheme::StateTransition, 1e-3, 24)).log2();
    assert!(order > 1.8, "{order}");
}

/// Coordinates 24 ms after the release of the wing from a bent position, whose flow is steady: a start without a jump of
/// the wall's speed, which no step resolves.
fn released(coupling: Coupling, steps: usize) -> Vec<f64> {
    let wing = wing();
    let q = vec![0.03, 0.002];
    let placed = wing.placed(grid(), &q);
    let mut settings = flow(0.0);
    settings.solver.orders = 10.0;
    let result = steady::run(&settings, &placed, &mut Silent, &AtomicBool::new(false)).expect("a flow");
    let step_s = 0.024 / steps as f64;
    let state = |f: Vec<f64>| ModalState {
        q: q.clone(),
        f,
        ..ModalState::rest(2)
    };
    let new = |f| Integrator::new(wing.equations.clone(), StepScheme::default(), step_s, state(f)).expect("a start");
    let mut coupled = Coupled::new(
        result.solver,
        &placed,
        Nodes::of(grid()),
        Structure {
            integrator: new(vec![0.0; 2]),
            shapes: wing.shapes.clone(),
        },
        stream(),
        coupling,
        DualTimeSettings {
            dt: stream().time(step_s),
            orders: 7.0,
            max_iterations: 30,
            ..DualTimeSettings::default()
        },
        settings.flow,
        settings.reference,
    )
    .expect("coupled");
    coupled.exchange_tolerance = 1e-9;
    coupled.structure.integrator = new(coupled.forces());
    for _ in 0..steps {
        coupled.advance().expect("a step");
    }
    coupled.structure.integrator.state().q.clone()
}

#[test]
fn coupling_at_the_same_time_level_is_of_second_order_and_loose_coupling_of_first() {
    let order = |coupling, steps: usize| {
        let [a, b, c] = [steps, 2 * steps, 4 * steps].map(|n| released(coupling, n)[0]);
        ((a - b) / (b - c)).abs().log2()
    };
    let tight = order(Coupling::Tight, 16);
    assert!((tight - 2.0).abs() < 0.2, "tight: {tight}");
    let loose = order(Coupling::Loose, 16);
    assert!((loose - 1.0).abs() < 0.25, "loose: {loose}");
}

#[test]
fn the_static_position_holds_the_load_and_a_march_stays_there() {
    let (never, wing) = (AtomicBool::new(false), wing());
    let settings = MarchSettings {
        steady: flow(1.5),
        start_rate_1_s: vec![1e-9, 0.0],
        ..settings(8)
    };
    let still = rigid(&settings.steady, grid(), 2, &mut Silent, &never)
        .expect("a flow")
        .expect("not interrupted");
    let at = |stream: &Stream| {
        let found = DeflectionSettings::default();
        deflected(&settings.steady, &found, grid(), &wing, stream, &still, &never)
            .expect("a position")
            .expect("not interrupted")
    };
    let mean = at(&stream());
    assert!(
        mean.settled && mean.exchanges > 1 && mean.exchanges < 15,
        "{} exchanges",
        mean.exchanges
    );
    let tip = wing.displacement(&mean.q);
    assert!(tip > 5e-3, "{tip}");
    // Nearly proportional to the dynamic pressure when that is small.
    let weak = |density_kg_m3| {
        wing.displacement(
            &at(&Stream {
                density_kg_m3,
                ..stream()
            })
            .q,
        )
    };
    let ratio = weak(0.002) / weak(0.001);
    assert!((ratio - 2.0).abs() < 0.02, "{ratio}");
    let result = march(&settings, &mean, usize::MAX);
    let moved: Vec<f64> = result.states[8].q.iter().zip(&mean.q).map(|(a, b)| a - b).collect();
    assert!(wing.displacement(&moved) < 1e-4 * tip, "{moved:?}");
}

#[test]
fn a_wing_without_load_stays_where_it_is() {
    let found = DeflectionSettings::default();
    let mean = deflected(
        &flow(0.0),
        &found,
        grid(),
        &wing(),
        &stream(),
        still(),
        &AtomicBool::new(false),
    )
    .expect("a position")
    .expect("not interrupted");
    assert!(mean.settled);
    assert_eq!(mean.exchanges, 0);
    assert_eq!(mean.q, vec![0.0; 2]);
}

#[test]
fn a_march_that_stops_and_goes_on_gives_the_same_bits() {
    let folder = tempfile::tempdir().expect("a folder");
    let whole = march(&settings(12), still(), usize::MAX);
    assert_eq!(whole.stop, MarchStop::AllSteps);
    let with_file = |resume| MarchSettings {
        restart: Some(folder.path().join("march.pmb")),
        resume,
        ..settings(12)
    };
    let first = march(&with_file(false), still(), 5);
    assert_eq!((first.stop, first.states.len()), (MarchStop::Interrupted, 6));
    let cancel = AtomicBool::new(false);
    let mut until = Until {
        last: usize::MAX,
        cancel: &cancel,
        resumed: None,
    };
    // The mean flow too comes from a file.
    let path = folder.path().join("mean.pmb");
    still().write(&path).expect("written");
    let mean = MeanFlow::read(&path, grid()).expect("read");
    assert_eq!(&mean, still());
    let rest = run(&with_file(true), grid(), &wing(), stream(), &mean, &mut until, &cancel).expect("a march");
    assert_eq!(until.resumed, Some(5));
    assert_eq!(rest.states, whole.states);
    assert_eq!(
        (rest.products, rest.builds, rest.work_j),
        (whole.products, whole.builds, whole.work_j)
    );
    let other = MarchSettings {
        step_s: 1.9e-3,
        ..with_file(true)
    };
    let error = run(&other, grid(), &wing(), stream(), &mean, &mut until, &cancel);
    assert!(matches!(error, Err(FlowError::Restart { .. })), "{error:?}");
}

#[test]
fn the_number_of_threads_changes_no_bit() {
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("threads");
        pool.install(|| march(&settings(5), still(), usize::MAX).states)
    };
    assert_eq!(on(1), on(3));
}

#[test]
fn the_parts_of_the_time_do_not_overlap() {
    let s = march(&settings(6), still(), usize::MAX).seconds;
    let work = [
        s.residual,
        s.jacobian,
        s.factorization,
        s.gcg,
        s.deformation,
        s.transfer,
    ];
    assert!(work.iter().all(|part| *part > 0.0), "{s:?}");
    // Counted twice, the parts would come to more than the whole.
    assert!(s.rest > 0.0, "{s:?}");
}

#[test]
fn what_cannot_be_marched_is_refused() {
    let refused = |change: &dyn Fn(&mut MarchSettings)| {
        let mut wrong = settings(3);
        change(&mut wrong);
        let cancel = AtomicBool::new(false);
        let mut until = Until {
            last: usize::MAX,
            cancel: &cancel,
            resumed: None,
        };
        let error = run(&wrong, grid(), &wing(), stream(), still(), &mut until, &cancel);
        assert!(matches!(error, Err(FlowError::Setting { .. })), "{error:?}");
    };
    refused(&|s| s.start_rate_1_s = vec![0.1]);
    refused(&|s| s.start_rate_1_s = vec![0.0; 2]);
    refused(&|s| s.steps = 0);
    refused(&|s| s.step_s = f64::NAN);
}

#[test]
fn a_motion_that_grows_without_bound_says_so() {
    // Far beyond divergence and flutter.
    let wild = Stream {
        density_kg_m3: 30.0,
        ..stream()
    };
    let cancel = AtomicBool::new(false);
    let mut until = Until {
        last: usize::MAX,
        cancel: &cancel,
        resumed: None,
    };
    let result = run(&settings(60), grid(), &wing(), wild, still(), &mut until, &cancel).expect("a march");
    assert!(matches!(result.stop, MarchStop::RanAway(_)), "{:?}", result.stop);
}
