//! One entrance for all methods.

use rayon::prelude::*;

use crate::error::{FlutterError, Result};
use crate::k_method::{default_reduced_frequencies, solve_k};
use crate::problem::{FlutterProblem, Settings, Sweep};
use crate::solution::{FlutterSolution, Method};

/// Solves a problem by a method over a sweep.
///
/// K and KE take a speed sweep only: they run over reduced frequencies chosen to cover it (for a list of one's own see
/// [`crate::solve_k`]), and crossings outside the speeds are left out.
///
/// # Errors
/// Bad inputs, forces that fail or are not finite, an eigenvalue solution that fails, reduced frequencies outside the
/// data when the settings refuse them, a sweep the method cannot make.
pub fn solve(
    problem: &FlutterProblem<'_>,
    method: Method,
    sweep: &Sweep<'_>,
    settings: &Settings,
) -> Result<FlutterSolution> {
    problem.check()?;
    settings.check()?;
    sweep.check(problem.mach)?;
    if method.is_p_method() {
        return crate::p_method::solve(problem, method, sweep, settings);
    }
    let Sweep::Speed {
        density_kg_m3,
        speeds_m_s,
    } = *sweep
    else {
        return Err(FlutterError::Unsupported {
            method: method.name().into(),
            request: format!("sweep {}", sweep.parameter_name()),
            advice: "speed is a result of this method: use a speed sweep, or PK or g".into(),
        });
    };
    let ks = default_reduced_frequencies(problem, speeds_m_s);
    let mut solution = solve_k(problem, method, density_kg_m3, &ks, settings)?;
    let (first, last) = (speeds_m_s[0], speeds_m_s[speeds_m_s.len() - 1]);
    if speeds_m_s.len() > 1 {
        solution.crossings.retain(|c| (first..=last).contains(&c.speed_m_s));
        solution.humps.retain(|h| (first..=last).contains(&h.speed_m_s));
    }
    Ok(solution)
}

/// One case of a boundary: a problem (one Mach number) with its sweep.
#[derive(Clone, Copy)]
pub struct BoundaryCase<'a> {
    /// Structure and aerodynamics at one Mach number.
    pub problem: FlutterProblem<'a>,
    /// Sweep at this Mach number.
    pub sweep: Sweep<'a>,
}

/// Solves several Mach numbers, in parallel. Results are in the order of the cases and do not depend on the threads.
///
/// # Errors
/// The first error in the order of the cases.
pub fn solve_boundary(cases: &[BoundaryCase<'_>], method: Method, settings: &Settings) -> Result<Vec<FlutterSolution>> {
    let solutions: Vec<_> = cases
        .par_iter()
        .map(|case| solve(&case.problem, method, &case.sweep, settings))
        .collect();
    solutions.into_iter().collect()
}
