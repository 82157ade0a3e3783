//! Stated standard errors of damping against the scatter of many records with known damping.

use std::f64::consts::TAU;

use dip_flutter::decay::{DecaySettings, identify};
use dip_flutter::search::{Search, SearchSettings, SearchStep, Stability, Trial};

/// Normal numbers, the same in every run (xorshift and Box-Muller).
struct Normal(u64);

impl Normal {
    fn uniform(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        ((self.0 >> 11) as f64 + 0.5) / (1u64 << 53) as f64
    }

    fn next(&mut self) -> f64 {
        (-2.0 * self.uniform().ln()).sqrt() * (TAU * self.uniform()).cos()
    }
}

/// Records of modes with known damping under noise that is correlated in time and between channels.
#[derive(Debug)]
struct Kind {
    /// Modes, and as many channels.
    modes: usize,
    /// Cycles of the first mode.
    cycles: f64,
    /// Correlation of the noise from one sample to the next (40 in a cycle).
    correlation: f64,
    /// Part of the noise's variance that all channels share.
    shared: f64,
}

const SAMPLES_A_CYCLE: f64 = 40.0;
/// Frequency, Hz, and damping of each mode.
const MODES: [(f64, f64); 4] = [(14.0, -0.03), (38.0, -0.06), (48.0, -0.04), (90.0, -0.05)];
/// Of the first channel's noise, over the amplitude of the first mode.
const NOISE: f64 = 0.005;

impl Kind {
    fn record(&self, random: &mut Normal) -> Vec<Vec<f64>> {
        let phases: Vec<f64> = (0..self.modes * self.modes).map(|_| TAU * random.uniform()).collect();
        // One source of noise for each channel and one for all.
        let mut sources: Vec<f64> = (0..=self.modes).map(|_| random.next()).collect();
        let fresh = (1.0 - self.correlation.powi(2)).sqrt();
        let mut record = vec![Vec::new(); self.modes];
        for n in 0..(SAMPLES_A_CYCLE * self.cycles) as usize {
            let t = n as f64 / SAMPLES_A_CYCLE / MODES[0].0;
            for s in &mut sources {
                *s = self.correlation * *s + fresh * random.next();
            }
            for (c, history) in record.iter_mut().enumerate() {
                let motion: f64 = (0..self.modes)
                    .map(|m| {
                        let (freq_hz, g) = MODES[m];
                        let size = if m == c { 1.0 } else { 0.3 } / (1.0 + m as f64);
                        let angle = TAU * freq_hz * t;
                        size * (0.5 * g * angle).exp() * (angle + phases[m * self.modes + c]).sin()
                    })
                    .sum();
                let noise = self.shared.sqrt() * sources[self.modes] + (1.0 - self.shared).sqrt() * sources[c];
                history.push(motion + NOISE * noise / (1.0 + c as f64));
            }
        }
        record
    }

    /// Parts of `runs` records whose first mode's damping is off by less than one, and by less than two stated errors.
    fn coverage(&self, runs: usize) -> [f64; 2] {
        let mut random = Normal(0x2545_f491_4f6c_dd1d);
        let dt = 1.0 / SAMPLES_A_CYCLE / MODES[0].0;
        let mut inside = [0.0; 2];
        for _ in 0..runs {
            let fit = identify(&self.record(&mut random), dt, &DecaySettings::default()).unwrap();
            let far = |f: f64| (f - MODES[0].0).abs();
            let nearest = fit
                .modes
                .iter()
                .min_by(|a, b| far(a.freq_hz).total_cmp(&far(b.freq_hz)));
            let mode = nearest.unwrap();
            let error = 2.0 * mode.sigma_error_rad_s / mode.p_rad_s.im;
            let miss = (mode.g - MODES[0].1).abs() / error;
            for (sum, bound) in inside.iter_mut().zip([1.0, 2.0]) {
                *sum += if miss < bound { 1.0 / runs as f64 } else { 0.0 };
            }
        }
        inside
    }
}

#[test]
fn one_standard_error_of_damping_holds_two_thirds_of_the_records_whatever_the_colour_of_the_noise() {
    let mut mean = 0.0;
    let kinds = [
        (1, 3.0, 0.0, 0.0),
        (1, 3.0, 0.9, 0.0),
        (2, 1.5, 0.5, 0.9),
        (2, 3.0, 0.9, 0.9),
        (4, 1.5, 0.5, 0.0),
        (4, 3.0, 0.5, 0.9),
        (4, 3.0, 0.9, 0.0),
    ];
    for (modes, cycles, correlation, shared) in kinds {
        let kind = Kind {
            modes,
            cycles,
            correlation,
            shared,
        };
        let [one, two] = kind.coverage(200);
        println!("{kind:?}: {one:.2} within one standard error, {two:.2} within two");
        // 200 records know a part of 0.68 to 0.033.
        assert!((0.6..0.82).contains(&one), "{kind:?}: {one}");
        assert!(two > 0.9, "{kind:?}: {two}");
        mean += one / kinds.len() as f64;
    }
    assert!((0.66..0.75).contains(&mean), "{mean}");
}

#[test]
fn the_error_of_a_neutral_point_holds_two_thirds_of_the_searches() {
    // Dampings of a wing's march (neutral at 0.2), each off by a normal error of the size that the search is told.
    let g = |rho: f64| -0.3 * rho / 0.2 * (1.0 - (rho / 0.2).powi(3));
    for first in [0.12, 0.17, 0.25] {
        let mut random = Normal(0x9e37_79b9_7f4a_7c15);
        let (runs, mut inside) = (400, 0);
        for _ in 0..runs {
            let settings = SearchSettings {
                range: [0.02, 1.0],
                first,
                tolerance: 0.01,
                most_runs: 12,
            };
            let mut search = Search::new(settings, Vec::new()).unwrap();
            let found = loop {
                match search.next() {
                    SearchStep::Run(at) => {
                        // As a march is read: known to 0.002 or a tenth, or as well as the search asks.
                        let asked = search.damping_accuracy().unwrap_or(f64::INFINITY);
                        let g_error = f64::max(0.002, 0.1 * g(at).abs()).min(asked);
                        let stability = Stability::Oscillation {
                            g: g(at) + g_error * random.next(),
                            g_error,
                            freq_hz: 15.0,
                        };
                        search.add(Trial { at, stability }).unwrap();
                    }
                    SearchStep::Found(found) | SearchStep::OutOfRuns(Some(found)) => break found,
                    end => panic!("{first}: {end:?}"),
                }
            };
            inside += usize::from((found.at - 0.2).abs() < found.error);
        }
        let part = inside as f64 / f64::from(runs);
        println!("from {first}: {part:.2} within one standard error");
        assert!(part > 0.62, "{first}: {part}");
    }
}
