//! Work on all slabs of an [`Order`] by several threads, each slab after those that it needs.
//!
//! Every thread takes the next slab of the queue and waits until those that it needs are finished. They stand before it in the
//! queue: threads are at work on them, so that the wait ends. What is computed depends on the order alone.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

use crate::order::{Order, Slab};

/// What finished slabs hold, by number; nothing of those that are still to be worked on, or are being worked on.
pub(crate) type Parts<'a, T> = [OnceLock<&'a [T]>];

/// Place in the queue of a slab that nobody reaches.
const NOWHERE: usize = usize::MAX;

impl Order {
    /// Does `work` for every slab: in the order, or in the opposite one. `values` are cut into a part a slab; `width` is
    /// their number a cell.
    ///
    /// # Errors
    /// Of several errors the first in the queue, whatever the number of threads: all slabs before it are worked on.
    pub(crate) fn run<T: Send + Sync, E: Send>(
        &self,
        backward: bool,
        width: usize,
        mut values: &mut [T],
        work: impl Fn(&Slab, &mut [T], &Parts<'_, T>) -> Result<(), E> + Sync,
    ) -> Result<(), E> {
        // Handing work to another thread takes as long as some tens of cells.
        const PARALLEL_FROM: usize = 300;
        let todo: Vec<Mutex<Option<&mut [T]>>> = self
            .slabs
            .iter()
            .map(|slab| {
                let (head, tail) = std::mem::take(&mut values).split_at_mut(slab.cell_count() * width);
                values = tail;
                Mutex::new(Some(head))
            })
            .collect();
        let done: Vec<OnceLock<&[T]>> = self.slabs.iter().map(|_| OnceLock::new()).collect();
        let taken = AtomicUsize::new(0);
        // First place in the queue where an error was met: those behind it are given up, those before it are not.
        let end = AtomicUsize::new(NOWHERE);
        let error: Mutex<Option<(usize, E)>> = Mutex::new(None);
        let worker = || {
            let _guard = EndOnPanic(&end);
            loop {
                let at = taken.fetch_add(1, Ordering::Relaxed);
                if at >= self.queue.len() || end.load(Ordering::Relaxed) < at {
                    return;
                }
                let n = self.queue[if backward { self.queue.len() - 1 - at } else { at }];
                let slab = &self.slabs[n];
                let needs = &slab.needs[usize::from(backward)];
                if !needs.iter().all(|m| wait(&done[*m], at, &end)) {
                    return;
                }
                let Some(mine) = lock(&todo[n]).take() else { return };
                match work(slab, mine, &done) {
                    Ok(()) => {
                        let _: Result<(), _> = done[n].set(mine);
                    }
                    Err(e) => {
                        let mut first = lock(&error);
                        if first.as_ref().is_none_or(|(before, _)| at < *before) {
                            *first = Some((at, e));
                        }
                        end.fetch_min(at, Ordering::Relaxed);
                        return;
                    }
                }
            }
        };
        let threads = if self.cell_count < PARALLEL_FROM {
            1
        } else {
            rayon::current_num_threads().min(self.breadth)
        };
        rayon::scope(|scope| {
            for _ in 1..threads {
                scope.spawn(|_| worker());
            }
            worker();
        });
        match error.into_inner().unwrap_or_else(PoisonError::into_inner) {
            Some((_, e)) => Err(e),
            None => Ok(()),
        }
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Keeps the other threads from waiting for a slab that will never be finished.
struct EndOnPanic<'a>(&'a AtomicUsize);

impl Drop for EndOnPanic<'_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.0.store(0, Ordering::Relaxed);
        }
    }
}

/// Waits for a slab on behalf of the one at place `at` of the queue; false if the work ends before that place.
fn wait<T>(part: &OnceLock<T>, at: usize, end: &AtomicUsize) -> bool {
    // A slab takes some microseconds: going to sleep would take longer.
    const SPINS: usize = 500;
    let mut spins = 0;
    while part.get().is_none() {
        if end.load(Ordering::Relaxed) < at {
            return false;
        }
        spins += 1;
        if spins < SPINS {
            std::hint::spin_loop();
        } else {
            std::thread::yield_now();
        }
    }
    true
}
