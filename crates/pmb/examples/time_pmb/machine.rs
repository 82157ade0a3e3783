//! What one core of this machine can do, measured beside the kernels: triad bandwidth and multiply-add peak.

use std::hint::black_box;
use std::time::Instant;

use cpu_time::ProcessTime;
use dip_pmb::real::Lanes;

/// Median of several batches, in seconds of CPU time a call: on a machine with other work the clock on the wall would time that too.
/// A batch is long against the ticks at which the CPU time of other threads is counted.
pub fn median(batches: usize, mut work: impl FnMut()) -> f64 {
    const LEAST_SECONDS: f64 = 0.1;
    let start = Instant::now();
    work();
    let calls = (LEAST_SECONDS / start.elapsed().as_secs_f64())
        .ceil()
        .clamp(1.0, 1000.0) as usize;
    let mut seconds: Vec<f64> = (0..batches.max(1))
        .map(|_| {
            let start = ProcessTime::now();
            for _ in 0..calls {
                work();
            }
            start.elapsed().as_secs_f64() / calls as f64
        })
        .collect();
    seconds.sort_by(f64::total_cmp);
    seconds[seconds.len() / 2]
}

/// GB/s of `a = b + c d` on vectors that no cache holds, three transfers an entry.
pub fn triad_gb_s() -> f64 {
    let n = 8_000_000;
    let (mut a, b, c) = (vec![0.0; n], vec![1.0_f64; n], vec![2.0_f64; n]);
    let seconds = median(7, || {
        for ((a, b), c) in a.iter_mut().zip(&b).zip(&c) {
            *a = c.mul_add(3.0, *b);
        }
        black_box(&a);
    });
    24.0 * n as f64 / seconds * 1e-9
}

/// GFLOP/s of independent multiply-adds on numbers in registers, of the width that the kernels are built for.
pub fn peak_gflop_s() -> f64 {
    const CHAINS: usize = 12;
    let rounds = 2_000_000;
    let mut x = [0; CHAINS].map(|_| Lanes::splat(black_box(1.0)));
    let (a, b) = (Lanes::splat(black_box(0.999_999)), Lanes::splat(black_box(1e-6)));
    let seconds = median(5, || {
        // A copy, so that the chains stay in registers.
        let mut y = x;
        for _ in 0..rounds {
            for y in &mut y {
                *y = y.mul_add(a, b);
            }
        }
        x = black_box(y);
    });
    (2 * 4 * CHAINS * rounds) as f64 / seconds * 1e-9
}
