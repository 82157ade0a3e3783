//! Keeping the threads of the pool awake through work of many short parallel loops.
//!
//! An idle thread of the pool goes to sleep after some twenty microseconds, and waking it takes as long as a loop over a
//! thousand cells. Implicit steps are thousands of loops of a fraction of a millisecond with short serial parts between
//! them: there a thread that looks for the next loop without sleeping is worth its processor.

use std::sync::atomic::{AtomicBool, Ordering};

/// Does `work` on a thread of the pool while the others look for parts of it without falling asleep.
///
/// Threads that find nothing for a millisecond may sleep all the same, so that serial work is not paid for twice. What is
/// computed does not depend on it.
pub fn awake<R: Send>(work: impl FnOnce() -> R + Send) -> R {
    let over = &AtomicBool::new(false);
    rayon::scope(|scope| {
        let owner = rayon::current_thread_index();
        for _ in 1..rayon::current_num_threads() {
            scope.spawn(move |_| attend(owner, over));
        }
        let _end = SetWhenDropped(over);
        work()
    })
}

/// Takes part in what other threads offer until all is over.
fn attend(owner: Option<usize>, over: &AtomicBool) {
    // About a millisecond of looking.
    const PATIENCE: usize = 10_000;
    const PAUSES: usize = 16;
    // A processor that others need as well is given up now and then: they may be what is waited for.
    const YIELD_EVERY: usize = 64;
    if rayon::current_thread_index() == owner {
        return;
    }
    let mut idle = 0;
    while idle < PATIENCE && !over.load(Ordering::Relaxed) {
        if rayon::yield_now() == Some(rayon::Yield::Executed) {
            idle = 0;
        } else {
            idle += 1;
            for _ in 0..PAUSES {
                std::hint::spin_loop();
            }
            if idle % YIELD_EVERY == 0 {
                std::thread::yield_now();
            }
        }
    }
}

struct SetWhenDropped<'a>(&'a AtomicBool);

impl Drop for SetWhenDropped<'_> {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}
