//! Progress on stderr, seconds of wall and CPU time, and Ctrl-C.

use crate::exit::Stop;
use cpu_time::ProcessTime;
use indicatif::{ProgressBar, ProgressStyle};
use serde::{Deserialize, Serialize};
use std::io::IsTerminal;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Lets Ctrl-C and SIGTERM stop the work at the next safe place; a second one ends the process at once.
pub fn watch_interrupts() {
    let second = || {
        if INTERRUPTED.swap(true, Ordering::SeqCst) {
            std::process::exit(130);
        }
        eprintln!("\nstopping at the next safe place (once more to stop at once)");
    };
    // Fails only where a handler is set already, which is this one.
    let _ = ctrlc::set_handler(second);
}

/// Stops here if the user asked for it.
///
/// # Errors
/// [`Stop::Interrupted`] with `kept`, what is on disk already.
pub fn check_interrupt(kept: &str) -> Result<(), Stop> {
    if INTERRUPTED.load(Ordering::SeqCst) {
        Err(Stop::Interrupted(kept.to_owned()))
    } else {
        Ok(())
    }
}

/// Wall and CPU seconds of one stage.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Seconds {
    /// Wall clock.
    pub wall_s: f64,
    /// CPU time of all threads.
    pub cpu_s: f64,
}

/// Measures a stage.
#[derive(Debug)]
pub struct Timer {
    wall: Instant,
    cpu: Option<ProcessTime>,
}

impl Timer {
    /// Starts now.
    pub fn start() -> Self {
        Self {
            wall: Instant::now(),
            cpu: ProcessTime::try_now().ok(),
        }
    }

    /// Seconds since the start.
    pub fn seconds(&self) -> Seconds {
        let cpu_s = self
            .cpu
            .and_then(|c| c.try_elapsed().ok())
            .map_or(0.0, |d| d.as_secs_f64());
        Seconds {
            wall_s: self.wall.elapsed().as_secs_f64(),
            cpu_s,
        }
    }
}

/// A progress bar on stderr: steps done, what is under way, time left. Nothing where stderr is no terminal or with `-q`.
pub fn bar(steps: u64, quiet: bool) -> ProgressBar {
    if quiet || !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(steps);
    if let Ok(style) = ProgressStyle::with_template("{bar:30} {pos}/{len} {msg} ({elapsed}, {eta} left)") {
        bar.set_style(style);
    }
    bar
}
