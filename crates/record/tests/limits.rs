//! Limits: what a recording may cost, and what a kill may take.

mod synthetic;

use std::io::{BufRead as _, BufReader, Write as _};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use cpu_time::ProcessTime;
use dip_record::{FindingKind, Recording, Setup, Step, SurfaceGrid, Writer, WriterOptions};

/// Numbers without a pattern (a 64-bit linear congruential generator, constants of Knuth's MMIX).
struct Noise(u64);

impl Noise {
    /// Between 0 and 1.
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// A step with noise in the pressures, as a solver that converges by some orders leaves it: it cannot be packed.
fn noisy(setup: &Setup, number: u32, noise: &mut Noise) -> Step {
    let mut step = synthetic::step(setup, number);
    for cp in step.pressures.iter_mut().flatten() {
        *cp += 1e-3 * noise.next();
    }
    step.shape_m = None;
    step
}

/// Two sides with 5,000 faces together.
fn wing() -> Setup {
    let mut setup = synthetic::setup([50, 50]);
    setup.surface = SurfaceGrid {
        patches: synthetic::surface([50, 50]).patches[..2].to_vec(),
    };
    // Warped, so that the coordinates cannot be packed as those of a plate.
    let mut noise = Noise(7);
    for patch in &mut setup.surface.patches {
        for node in patch.nodes_m.iter_mut().flatten() {
            *node += 1e-4 * noise.next();
        }
        *patch = dip_record::SurfacePatch::new(patch.name.clone(), patch.nodes_m.clone(), patch.faces.clone());
    }
    setup.motion.truncate(1);
    setup
}

fn noisy_step(setup: &Setup, number: u32, noise: &mut Noise) -> Step {
    let mut step = noisy(setup, number, noise);
    step.motion.truncate(1);
    step.modal = None;
    step
}

/// 5,000 faces x 40 steps x 3 cycles under 6 MB; at most 2 % of a step of 4.5 s / 40, the time that a cycle on the
/// reference grid may take.
#[test]
fn three_cycles_of_5000_faces_are_small_and_cheap() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("a.mcap");
    let setup = wing();
    assert_eq!(setup.surface.face_count(), 5000);
    let mut noise = Noise(1);
    let steps: Vec<Step> = (0..=120).map(|n| noisy_step(&setup, n, &mut noise)).collect();
    let start = ProcessTime::now();
    let mut writer = Writer::create(&path, setup, WriterOptions::default()).unwrap();
    for step in &steps {
        writer.step(step).unwrap();
    }
    writer.finish("done").unwrap();
    let seconds_per_step = start.elapsed().as_secs_f64() / 121.0;
    let bytes = std::fs::metadata(&path).unwrap().len();
    println!("{bytes} bytes, {:.3} ms of CPU time per step", 1e3 * seconds_per_step);
    assert!(bytes < 6_000_000, "{bytes} bytes");
    assert!(seconds_per_step < 0.02 * 4.5 / 40.0, "{seconds_per_step} s per step");
    assert_eq!(Recording::read(&path).unwrap().steps.len(), 121);
}

/// Name of the environment variable that makes this binary the program that is killed.
const PATH: &str = "DIP_RECORD_KILLED";

fn small() -> Setup {
    let mut setup = synthetic::setup([40, 20]);
    setup.motion.truncate(1);
    setup
}

/// The child of the next test: records until it is killed and says every step that it has recorded.
#[test]
#[ignore = "runs until it is killed; the test `a_killed_run_reads_to_within_ten_steps` starts it"]
fn recorder() {
    let Some(path) = std::env::var_os(PATH) else { return };
    let setup = small();
    let mut noise = Noise(3);
    let mut writer = Writer::create(Path::new(&path), setup.clone(), WriterOptions::default()).unwrap();
    // Some minutes at most, should nobody kill it.
    for n in 0..100_000 {
        writer.step(&noisy_step(&setup, n, &mut noise)).unwrap();
        let mut out = std::io::stdout().lock();
        writeln!(out, "\nstep {n}").unwrap();
        out.flush().unwrap();
        std::thread::sleep(Duration::from_micros(200));
    }
}

/// Kill -9 at random moments, fifty times: the file reads up to at most ten steps before the kill.
#[test]
fn a_killed_run_reads_to_within_ten_steps() {
    let dir = tempfile::tempdir().unwrap();
    let setup = small();
    let mut when = Noise(11);
    let mut most_lost = 0;
    for round in 0..50 {
        let path = dir.path().join(format!("{round}.mcap"));
        let mut child = Command::new(std::env::current_exe().unwrap())
            .args(["--ignored", "--exact", "recorder", "--nocapture"])
            .env(PATH, &path)
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
        // Wait for a random step, then for a random part of a few steps.
        let wait_for = (60.0 * when.next()) as u32;
        let mut reported = None;
        let mut number = |line: &str| {
            if let Some(n) = line.strip_prefix("step ").and_then(|n| n.parse::<u32>().ok()) {
                reported = Some(n);
            }
            reported
        };
        for line in lines.by_ref() {
            if number(&line.unwrap()) >= Some(wait_for) {
                break;
            }
        }
        std::thread::sleep(Duration::from_secs_f64(3e-3 * when.next()));
        // On Unix this is signal 9.
        child.kill().unwrap();
        child.wait().unwrap();
        let mut last = number("");
        for line in lines.map_while(Result::ok) {
            last = number(&line);
        }
        let last = last.expect("the child recorded at least one step");

        let salvage = Recording::read_salvage(&path).unwrap();
        let steps = &salvage.recording.steps;
        assert_eq!(salvage.recording.setup, setup);
        let kinds: Vec<FindingKind> = salvage.findings.iter().map(|f| f.kind).collect();
        assert_eq!(
            kinds,
            [FindingKind::Unfinished],
            "round {round}: {:?}",
            salvage.findings
        );
        let lost = (last + 1).saturating_sub(steps.len() as u32);
        assert!(lost <= 10, "round {round}: {lost} of {} steps lost", last + 1);
        most_lost = most_lost.max(lost);
        let mut noise = Noise(3);
        for (n, step) in steps.iter().enumerate() {
            let mut exact = noisy_step(&setup, n as u32, &mut noise);
            for cp in exact.pressures.iter_mut().flatten() {
                *cp = f64::from(*cp as f32);
            }
            assert_eq!(*step, exact, "round {round}");
        }
        if round % 10 == 0
            && let Some(last) = steps.last()
        {
            // What is left can be gone on with.
            let mut writer = Writer::resume(&path, setup.clone(), WriterOptions::default(), last.number).unwrap();
            writer.step(&noisy_step(&setup, last.number + 1, &mut noise)).unwrap();
            writer.finish("done").unwrap();
            assert_eq!(Recording::read(&path).unwrap().steps.len(), steps.len() + 1);
        }
    }
    println!("at most {most_lost} steps were lost");
    assert!(
        most_lost > 0,
        "a kill between two chunks takes something: the test kills too late"
    );
}
