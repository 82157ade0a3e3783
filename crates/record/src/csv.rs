//! A recording as tables of comma-separated values. Numbers have the fewest digits that give the same double back.

use std::fmt::Write as _;

use crate::recording::Recording;

/// One row per step: instant, values and rates of the motion, loads, structure, convergence. Names of columns carry units.
#[must_use]
pub fn history(recording: &Recording) -> String {
    let mut out = String::from("step,time_s");
    for c in &recording.setup.motion {
        let (name, unit) = (column(&c.name), c.kind.unit());
        let _ = write!(out, ",{name}_{unit},{name}_rate_{unit}_per_s");
    }
    out.push_str(",cl,cd,cm,force_x_n,force_y_n,force_z_n,moment_x_n_m,moment_y_n_m,moment_z_n_m");
    let modes = recording
        .steps
        .iter()
        .filter_map(|s| s.modal.as_ref())
        .map(|m| m.q.len())
        .max()
        .unwrap_or(0);
    for n in 1..=modes {
        let _ = write!(out, ",q_{n},q_dot_{n}_per_s,generalized_force_{n}_j");
    }
    out.push_str(",orders,iterations,converged\n");
    for step in &recording.steps {
        let _ = write!(out, "{},{:?}", step.number, step.time_s);
        for now in &step.motion {
            let _ = write!(out, ",{:?},{:?}", now.value, now.rate);
        }
        let l = &step.loads;
        for v in [l.cl, l.cd, l.cm].into_iter().chain(l.force_n).chain(l.moment_n_m) {
            let _ = write!(out, ",{v:?}");
        }
        for n in 0..modes {
            let modal = step.modal.as_ref();
            let get = |of: fn(&crate::step::Modal) -> &Vec<f64>| modal.and_then(|m| of(m).get(n));
            for v in [get(|m| &m.q), get(|m| &m.q_dot), get(|m| &m.force_j)] {
                match v {
                    Some(v) => drop(write!(out, ",{v:?}")),
                    None => out.push(','),
                }
            }
        }
        let c = &step.convergence;
        let _ = writeln!(out, ",{:?},{},{}", c.orders, c.iterations, c.converged);
    }
    out
}

/// One row per face: patch, number, centroid, area vector out of the body, side. The order is that of the columns of
/// [`pressure`].
#[must_use]
pub fn surface(recording: &Recording) -> String {
    let mut out = String::from("patch,face,x_m,y_m,z_m,area_x_m2,area_y_m2,area_z_m2,upper\n");
    for patch in &recording.setup.surface.patches {
        for (n, ((c, a), upper)) in patch
            .centroids_m
            .iter()
            .zip(&patch.areas_m2)
            .zip(&patch.upper)
            .enumerate()
        {
            let _ = writeln!(
                out,
                "{},{n},{:?},{:?},{:?},{:?},{:?},{:?},{upper}",
                quoted(&patch.name),
                c[0],
                c[1],
                c[2],
                a[0],
                a[1],
                a[2]
            );
        }
    }
    out
}

/// One row per step: instant, then the pressure coefficient of every face.
#[must_use]
pub fn pressure(recording: &Recording) -> String {
    let mut out = String::from("step,time_s");
    for patch in &recording.setup.surface.patches {
        for n in 0..patch.faces.len() {
            let _ = write!(out, ",{}", quoted(&format!("cp {} {n}", patch.name)));
        }
    }
    out.push('\n');
    for step in &recording.steps {
        let _ = write!(out, "{},{:?}", step.number, step.time_s);
        for cp in step.pressures.iter().flatten() {
            let _ = write!(out, ",{cp:?}");
        }
        out.push('\n');
    }
    out
}

/// A name as part of a column's name.
fn column(name: &str) -> String {
    name.chars()
        .map(|c| if c.is_alphanumeric() { c } else { '_' })
        .collect()
}

/// A text as a field: in quotes where it needs them (RFC 4180).
#[must_use]
pub fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}
