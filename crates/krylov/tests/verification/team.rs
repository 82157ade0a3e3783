//! Threads kept awake change nothing, and nobody waits for ever.

use dip_krylov::team::awake;
use rayon::prelude::*;

fn sum(n: u64) -> u64 {
    (0..n).into_par_iter().map(|i| i * i % 7).sum()
}

#[test]
fn work_among_awake_threads_gives_what_it_gives_without() {
    let alone = sum(10_000);
    for threads in [1, 2, 4] {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("a thread pool");
        pool.install(|| assert_eq!(awake(|| awake(|| sum(10_000))), alone));
        // From outside of the pool's threads.
        assert_eq!(awake(|| sum(10_000)), alone);
    }
}

#[test]
fn several_at_once_in_one_pool_all_come_to_their_end() {
    let alone = sum(2_000);
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(3)
        .build()
        .expect("a thread pool");
    let all: Vec<u64> = pool.install(|| {
        (0..200)
            .into_par_iter()
            .map(|_| awake(|| (0..5).map(|_| awake(|| sum(2_000))).max().unwrap_or(0)))
            .collect()
    });
    assert!(all.iter().all(|s| *s == alone));
}

#[test]
fn a_panic_in_the_work_reaches_the_caller() {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(2)
        .build()
        .expect("a thread pool");
    let work = std::panic::AssertUnwindSafe(|| pool.install(|| awake(|| -> u64 { panic!("as asked") })));
    let result = std::panic::catch_unwind(work);
    assert!(result.is_err());
}
