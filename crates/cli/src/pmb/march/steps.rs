//! Steps, start and schemes of a march.

use crate::exit::Stop;
use crate::pmb::logbook;
use dip_case::Document;
use dip_case::file::{CouplingKind, MarchFile, ModalDamping, StartMode, StartWord, StructureScheme, TimeSchemeKind};
use dip_modal::StepScheme;
use dip_pmb::couple::Coupling;
use dip_pmb::dual_time::{DualTimeSettings, TimeScheme};
use dip_pmb::march::{MarchSettings, Wing};

/// Viscous damping of each of `count` modes.
///
/// # Errors
/// A list of another length.
pub fn damping(document: &Document, file: &MarchFile, count: usize) -> Result<Vec<f64>, Stop> {
    match &file.march.damping {
        None => Ok(vec![0.0; count]),
        Some(ModalDamping::Same(value)) => Ok(vec![*value; count]),
        Some(ModalDamping::Each(list)) if list.len() == count => Ok(list.clone()),
        Some(ModalDamping::Each(list)) => {
            let message = format!("{} values for {count} modes", list.len());
            let help = "give one for each mode, or one number for all";
            Err(document.error("march.damping", message, help).into())
        }
    }
}

/// Rates at the start, 1/s: a free mode that starts with its rate comes to `displacement` (m, at the wall) after a quarter of
/// its period. With `start` none, a pulse: that energy in the lowest mode, and as much in every other. Rigid body modes count as
/// of `least` rad/s.
fn start_rates(wing: &Wing, start: Option<usize>, displacement: f64, least: f64) -> Vec<f64> {
    let e = &wing.equations;
    // A mode that does not move the wall is not started; if there is no other, the march refuses.
    let rate = |m: usize| {
        if wing.largest[m] > 0.0 {
            displacement * e.omega_rad_s[m].max(least) / wing.largest[m]
        } else {
            0.0
        }
    };
    let mut rates = vec![0.0; e.count()];
    match start {
        Some(number) => rates[number - 1] = rate(number - 1),
        None => {
            let lowest = (0..e.count()).min_by(|a, b| e.omega_rad_s[*a].total_cmp(&e.omega_rad_s[*b]));
            if let Some(lowest) = lowest {
                let momentum = rate(lowest) * e.generalized_mass[lowest].sqrt();
                for (r, m) in rates.iter_mut().zip(&e.generalized_mass) {
                    *r = momentum / m.sqrt();
                }
            }
        }
    }
    rates
}

/// Steps, start and schemes of a case.
///
/// # Errors
/// The first value that has no meaning, with its line.
pub fn settings(
    document: &Document,
    file: &MarchFile,
    steady: dip_pmb::settings::SteadySettings,
    wing: &Wing,
) -> Result<MarchSettings, Stop> {
    let t = &file.march;
    let omega = &wing.equations.omega_rad_s;
    let wrong = |key: &str, message: String, help: &str| -> Result<MarchSettings, Stop> {
        Err(document.error(key, message, help).into())
    };
    let lowest = omega.iter().copied().filter(|w| *w > 0.0).fold(f64::INFINITY, f64::min);
    let frequency = t.frequency.map_or(1.5 * lowest, |f| f.0);
    if !frequency.is_finite() || frequency <= 0.0 {
        return wrong(
            "march.frequency",
            format!("{frequency} rad/s: needed a positive value"),
            "frequency = \"14 Hz\", about that of flutter",
        );
    }
    let (per_cycle, cycles) = (t.steps_per_cycle.unwrap_or(40), t.cycles.unwrap_or(8));
    if !(8..=100_000).contains(&per_cycle) || !(1..=100_000).contains(&cycles) {
        return wrong(
            "march",
            format!("{per_cycle} steps per cycle and {cycles} cycles: needed 8 to 100000 and 1 to 100000"),
            "leave them out for 40 and 8",
        );
    }
    let start = match &t.start_mode {
        None => Some(1),
        Some(StartMode::One(mode)) => Some(*mode),
        Some(StartMode::Word(StartWord::All)) => None,
    };
    if let Some(start) = start
        && (start == 0 || start > omega.len())
    {
        let message = format!("mode {start}: there are {}", omega.len());
        return wrong(
            "march.start_mode",
            message,
            "modes count from 1; \"all\" gives a pulse to all of them",
        );
    }
    let semispan = file.reference.semispan.map_or(2.0 * file.reference.chord.0, |s| s.0);
    let displacement = t.start_displacement.map_or(1e-3 * semispan, |d| d.0);
    if displacement == 0.0 || !displacement.is_finite() {
        let message = format!("{displacement} m: needed a length other than zero");
        return wrong(
            "march.start_displacement",
            message,
            "leave it out for a thousandth of the semispan",
        );
    }
    let start_rate_1_s = start_rates(wing, start, displacement, 0.1 * frequency);
    let defaults = DualTimeSettings::default();
    Ok(MarchSettings {
        steady,
        time: DualTimeSettings {
            scheme: match file.time.scheme {
                TimeSchemeKind::Bdf2 => TimeScheme::Bdf2,
                TimeSchemeKind::Bdf2Opt => TimeScheme::Bdf2Opt,
                TimeSchemeKind::Bdf1 => TimeScheme::Bdf1,
            },
            // 1.5 orders move flutter points by less than the search's tolerance.
            orders: file.time.orders.unwrap_or(1.5),
            max_iterations: file.time.iterations.unwrap_or(defaults.max_iterations),
            ..defaults
        },
        step_s: std::f64::consts::TAU / frequency / per_cycle as f64,
        steps: per_cycle * cycles,
        scheme: match t.scheme {
            StructureScheme::StateTransition => StepScheme::StateTransition,
            StructureScheme::RungeKutta => StepScheme::RungeKutta2,
            StructureScheme::Newmark => StepScheme::Newmark,
            StructureScheme::GeneralizedAlpha => StepScheme::GeneralizedAlpha { rho_infinity: 0.8 },
        },
        coupling: match t.coupling {
            CouplingKind::Tight => Coupling::Tight,
            CouplingKind::Loose => Coupling::Loose,
        },
        exchange_tolerance: 1e-6,
        start_rate_1_s,
        largest_displacement: 0.2,
        restart: None,
        resume: false,
        checkpoint_steps: file
            .time
            .checkpoint
            .unwrap_or(20)
            .next_multiple_of(logbook::safe_steps()),
    })
}
