//! Known solutions: rings, a thin ellipse, a cone.

use super::*;
use crate::generate::spacing::geometric;
use crate::generate::transfinite::transfinite;

/// Half a ring: circles and rays, with steps that grow from 1e-4 by one ratio.
fn ring(ni: usize, nj: usize) -> Vec<[f64; 2]> {
    let out = geometric(nj, 1e-4, 9.0);
    let at = |i: usize, j: usize| {
        let angle = std::f64::consts::PI * i as f64 / ni as f64;
        [(1.0 + out[j]) * angle.cos(), (1.0 + out[j]) * angle.sin()]
    };
    (0..=nj)
        .flat_map(|j| (0..=ni).map(move |i| at(i, j)))
        .collect::<Vec<_>>()
}

/// Circles and rays solve the equations, and the smoothing finds them from rays bent by 17 degrees and more.
#[test]
fn bent_rays_of_a_ring_become_straight() {
    let (ni, nj) = (32, 40);
    let exact = ring(ni, nj);
    for bend in [0.0, 0.3] {
        let mut nodes = exact.clone();
        for j in 1..nj {
            for i in 1..ni {
                let p = exact[i + (ni + 1) * j];
                let radius = p[0].hypot(p[1]);
                let angle = p[1].atan2(p[0]);
                let turned = angle + bend * (2.0 * angle).sin() * (radius - 1.0) * (10.0 - radius) / 20.25;
                nodes[i + (ni + 1) * j] = [radius * turned.cos(), radius * turned.sin()];
            }
        }
        let first = vec![1e-4; ni + 1];
        let done = Elliptic { sweeps: 4000 }.smooth(&mut nodes, ni, nj, &first);
        assert!(done.change <= ENOUGH, "{done:?}");
        for (p, q) in nodes.iter().zip(&exact) {
            assert!(distance(*p, *q) < 2e-3 * q[0].hypot(q[1]), "{bend} {p:?} {q:?}");
        }
    }
}

/// Round a 4 % ellipse with a first step of 1e-6 of its chord: transfinite lines that lean by 40 degrees and more end up
/// within two degrees of the normal; first steps stay, no cell is folded.
#[test]
fn lines_off_a_thin_ellipse_become_normal_to_it() {
    let (ni, nj) = (96, 64);
    let width = ni + 1;
    let mut nodes = vec![[0.0; 2]; width * (nj + 1)];
    for i in 0..=ni {
        let angle = std::f64::consts::PI * i as f64 / ni as f64;
        let leaning = angle + 0.4 * (2.0 * angle).sin();
        nodes[i] = [0.5 * angle.cos(), 0.02 * angle.sin()];
        nodes[i + width * nj] = [10.0 * leaning.cos(), 10.0 * leaning.sin()];
    }
    for i in [0, ni] {
        let (from, to) = (nodes[i], nodes[i + width * nj]);
        let length = distance(from, to);
        for (j, d) in geometric(nj, 1e-6, length).into_iter().enumerate().skip(1) {
            let share = d / length;
            nodes[i + width * j] = [from[0] + share * (to[0] - from[0]), 0.0];
        }
    }
    transfinite(&mut nodes, ni, nj);
    let worst = |nodes: &[[f64; 2]]| {
        (2..ni - 1)
            .map(|i| {
                let angle = std::f64::consts::PI * i as f64 / ni as f64;
                let normal = [0.02 * angle.cos(), 0.5 * angle.sin()];
                let line = sub(nodes[i + width], nodes[i]);
                let cos = dot(line, normal) / (norm(line) * norm(normal));
                cos.min(1.0).acos().to_degrees()
            })
            .fold(0.0, f64::max)
    };
    assert!(worst(&nodes) > 40.0, "{}", worst(&nodes));
    let first = vec![1e-6; ni + 1];
    Elliptic { sweeps: 1000 }.smooth(&mut nodes, ni, nj, &first);
    assert!(worst(&nodes) < 2.0, "{}", worst(&nodes));
    for i in 0..ni {
        assert!((distance(nodes[i], nodes[i + width]) / 1e-6 - 1.0).abs() < 1e-3);
        for j in 0..nj {
            let at = |di: usize, dj: usize| nodes[i + di + width * (j + dj)];
            let (u, v) = (sub(at(1, 1), at(0, 0)), sub(at(0, 1), at(1, 0)));
            // i runs against the clock, j outward.
            assert!(u[0] * v[1] - u[1] * v[0] < 0.0, "{i} {j}");
        }
    }
}

/// On a cone, which unrolls to a ring, bent rays become straight, and nodes stay on the cone: what is missing falls with the square
/// of the steps.
#[test]
fn bent_rays_of_a_cone_become_straight_on_it() {
    // Half a ring rolled to three quarters of a cone: angles in the ring over its sine are those about the axis.
    let sine = 2.0 / 3.0f64;
    let rolled = |[radius, angle]: [f64; 2]| {
        let about = angle / sine;
        [
            radius * sine * about.cos(),
            radius * sine * about.sin(),
            radius * (1.0 - sine * sine).sqrt(),
        ]
    };
    let worst = |ni: usize, nj: usize| {
        let exact: Vec<[f64; 2]> = ring(ni, nj)
            .iter()
            .map(|p| [p[0].hypot(p[1]), p[1].atan2(p[0])])
            .collect();
        let bent = |n: usize, [radius, angle]: [f64; 2]| {
            let inside = (1..ni).contains(&(n % (ni + 1))) && (1..nj).contains(&(n / (ni + 1)));
            let bend = if inside { 0.3 } else { 0.0 };
            [
                radius,
                angle + bend * (2.0 * angle).sin() * (radius - 1.0) * (10.0 - radius) / 20.25,
            ]
        };
        let mut nodes: Vec<[f64; 3]> = exact.iter().enumerate().map(|(n, &p)| rolled(bent(n, p))).collect();
        let first = vec![1e-4; ni + 1];
        let done = Elliptic { sweeps: 8000 }.smooth(&mut nodes, ni, nj, &first);
        assert!(done.change <= ENOUGH, "{done:?}");
        let off = |(p, q): (&[f64; 3], &[f64; 2])| distance(*p, rolled(*q)) / q[0];
        nodes.iter().zip(&exact).map(off).fold(0.0, f64::max)
    };
    let (coarse, fine) = (worst(24, 30), worst(48, 60));
    assert!(fine < 2e-2 && fine < coarse / 3.0, "{coarse} {fine}");
}
