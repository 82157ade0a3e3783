//! What a run says on stderr while it goes on, and Ctrl-C.

use crate::progress::check_interrupt;
use dip_pmb::observer::{Observer, Progress};
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Seconds between two lines where stderr is no terminal (with `-v` every step has its line).
const INTERVAL: Duration = Duration::from_secs(5);

/// Shows one progress line on a terminal and a line now and then elsewhere.
#[derive(Debug)]
pub struct Watch {
    bar: ProgressBar,
    /// Set by Ctrl-C; the solver looks at it before every step.
    cancel: Arc<AtomicBool>,
    orders: f64,
    last_line: Option<Instant>,
    /// The newest step, if it has no line yet.
    pending: Option<String>,
}

impl Watch {
    /// `orders` is what the residual is asked to fall by.
    pub fn new(quiet: bool, orders: f64) -> Self {
        let bar = if quiet || !std::io::stderr().is_terminal() {
            ProgressBar::hidden()
        } else {
            let bar = ProgressBar::new(1000);
            if let Ok(style) = ProgressStyle::with_template("{bar:20} {msg}") {
                bar.set_style(style);
            }
            bar
        };
        Self {
            bar,
            cancel: Arc::default(),
            orders,
            last_line: None,
            pending: None,
        }
    }

    /// The flag that ends the run after the current step.
    pub fn cancel(&self) -> Arc<AtomicBool> {
        Arc::clone(&self.cancel)
    }

    /// Takes the line away; says the last step where lines are kept.
    pub fn finish(&mut self) {
        self.bar.finish_and_clear();
        if let Some(line) = self.pending.take() {
            tracing::info!("{line}");
        }
    }

    /// Looks whether the user asked to stop.
    pub fn interrupt(&self) {
        if check_interrupt("").is_err() {
            self.cancel.store(true, Ordering::Relaxed);
        }
    }
}

impl Watch {
    /// True once the user asked to stop.
    pub fn is_interrupted(&self) -> bool {
        self.cancel.load(Ordering::Relaxed)
    }

    /// Shows a line with the part done on a terminal; elsewhere one now and then, and the last.
    pub fn tell(&mut self, part: f64, line: String) {
        if !self.bar.is_hidden() {
            self.bar.set_position((1000.0 * part.clamp(0.0, 1.0)) as u64);
            self.bar.set_message(line);
            return;
        }
        let due = self.last_line.is_none_or(|at| at.elapsed() >= INTERVAL);
        if due {
            tracing::info!("{line}");
            self.last_line = Some(Instant::now());
            self.pending = None;
        } else {
            tracing::debug!("{line}");
            self.pending = (!tracing::enabled!(tracing::Level::DEBUG)).then_some(line);
        }
    }
}

impl Observer for Watch {
    fn progress(&mut self, p: &Progress) {
        self.interrupt();
        // The bar is the residual's way down on the finest level.
        let done = if p.level == 0 { p.orders / self.orders } else { 0.0 };
        self.tell(done, line(p));
    }

    fn message(&mut self, text: &str) {
        self.interrupt();
        self.bar.suspend(|| tracing::info!("{text}"));
    }
}

fn line(p: &Progress) -> String {
    let level = if p.level == 0 {
        String::new()
    } else {
        format!(" (level {} coarser)", p.level)
    };
    let left = if p.seconds_left.is_finite() && p.seconds_left >= 0.0 {
        format!(", {:.0} s left", p.seconds_left)
    } else {
        String::new()
    };
    format!(
        "step {:>4}{level}  CFL {:.1e}  residual {:+.2} orders  CL {:.6}  CD {:.6}  CM {:.6}  {:.1} s{left}",
        p.step, p.cfl, -p.orders, p.cl, p.cd, p.cm, p.seconds
    )
}
