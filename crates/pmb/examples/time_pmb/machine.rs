//! What one core of this machine can do, measured beside the kernels: triad bandwidth and multiply-add peak.

use std::hint::black_box;

use cpu_time::ProcessTime;
use dip_pmb::real::Lanes;

/// Best of several, in seconds of CPU time: on a machine with other work the clock on the wall would time that too.
pub fn best(repetitions: usize, mut work: impl FnMut()) -> f64 {
    let mut least = f64::INFINITY;
    for _ in 0..repetitions {
        let start = ProcessTime::now();
        work();
        least = least.min(start.elapsed().as_secs_f64());
    }
    least
}

/// GB/s of `a = b + c d` on vectors that no cache holds, three transfers an entry.
pub fn triad_gb_s() -> f64 {
    let n = 8_000_000;
    let (mut a, b, c) = (vec![0.0; n], vec![1.0_f64; n], vec![2.0_f64; n]);
    let seconds = best(7, || {
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
    let seconds = best(5, || {
        for _ in 0..rounds {
            for x in &mut x {
                *x = x.mul_add(a, b);
            }
        }
        black_box(&x);
    });
    (2 * 4 * CHAINS * rounds) as f64 / seconds * 1e-9
}
