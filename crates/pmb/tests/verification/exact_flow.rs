//! Exact steady flows, the grids on which the order of accuracy is measured with them, and the error on a grid.
//!
//! Used by the tests and by the page of the validation, which shows the same numbers on finer grids.

use dip_grid::{Block, Condition, Face, MultiBlock, Patch, Topology, Window};
use dip_krylov::GcgSettings;
use dip_pmb::boundary::Boundary;
use dip_pmb::gas::State;
use dip_pmb::level::Level;
use dip_pmb::reconstruct::Reconstruction;
use dip_pmb::scheme::Scheme;
use dip_pmb::solver::{Equations, Solver};

/// One cell across between symmetry planes; i along the first, j along the second parameter.
pub fn planar(cells: [usize; 2], conditions: [Condition; 4], at: impl Fn(f64, f64) -> [f64; 2]) -> MultiBlock {
    let [ni, nj] = cells;
    let block = Block::from_fn("plane", [ni, nj, 1], |i, j, k| {
        let [x, z] = at(i as f64 / ni as f64, j as f64 / nj as f64);
        // y to starboard: i, j, k right-handed needs k towards -y when j is up, so k = 0 lies at y = 1.
        [x, 1.0 - k as f64, z]
    });
    let faces = [Face::IMin, Face::IMax, Face::JMin, Face::JMax, Face::KMin, Face::KMax];
    let patches = faces
        .into_iter()
        .enumerate()
        .map(|(n, face)| Patch {
            name: face.name().to_owned(),
            block: 0,
            face,
            window: Window::full(block.face_cells(face)),
            condition: if n < 4 { conditions[n] } else { Condition::Symmetry },
        })
        .collect();
    MultiBlock {
        blocks: vec![block],
        topology: Topology {
            interfaces: Vec::new(),
            patches,
        },
    }
}

/// Mean over a cell of a function of (x, z): two-point Gauss rule in each direction on the bilinear cell.
pub fn cell_mean(block: &Block, i: usize, j: usize, f: &impl Fn([f64; 2]) -> State<f64>) -> State<f64> {
    let g = 0.5 / 3.0_f64.sqrt();
    let corner = |a: usize, b: usize| {
        let p = block.point(i + a, j + b, 0);
        [p[0], p[2]]
    };
    let (p00, p10, p01, p11) = (corner(0, 0), corner(1, 0), corner(0, 1), corner(1, 1));
    let mut mean = [0.0; 5];
    let mut weight = 0.0;
    for s in [0.5 - g, 0.5 + g] {
        for t in [0.5 - g, 0.5 + g] {
            let point = [0, 1].map(|d| {
                (1.0 - s) * (1.0 - t) * p00[d] + s * (1.0 - t) * p10[d] + (1.0 - s) * t * p01[d] + s * t * p11[d]
            });
            let ds = [0, 1].map(|d| (1.0 - t) * (p10[d] - p00[d]) + t * (p11[d] - p01[d]));
            let dt = [0, 1].map(|d| (1.0 - s) * (p01[d] - p00[d]) + s * (p11[d] - p10[d]));
            let area = (ds[0] * dt[1] - ds[1] * dt[0]).abs();
            weight += area;
            for (m, v) in mean.iter_mut().zip(f(point)) {
                *m += area * v;
            }
        }
    }
    mean.map(|m| m / weight)
}

/// Exact states at the mid-points of the faces of a side.
pub fn face_states(block: &Block, face: Face, f: &impl Fn([f64; 2]) -> State<f64>) -> Vec<State<f64>> {
    let n = block.face_cells(face)[0];
    (0..n)
        .map(|p| {
            let a = block.point_at(block.node_behind(face, p, 0, 0));
            let b = block.point_at(block.node_behind(face, p + 1, 0, 0));
            f([0.5 * (a[0] + b[0]), 0.5 * (a[2] + b[2])])
        })
        .collect()
}

/// Solves the steady flow in `grid` with the exact flow on all sides that are not walls, and returns the L2 error of the
/// density's cell means. The residual falls by seven orders from that of the exact flow, which is the truncation error, or to
/// its round-off (at 384 cells six orders below): what is left changes the sixth digit.
pub fn error(grid: &MultiBlock, reconstruction: Reconstruction, exact: impl Fn([f64; 2]) -> State<f64>) -> f64 {
    let block = &grid.blocks[0];
    let level = Level::new(grid).expect("a good grid");
    let boundaries = level
        .patches
        .iter()
        .map(|p| match p.condition {
            Condition::Wall => Boundary::Wall,
            Condition::Symmetry => Boundary::Symmetry,
            _ => Boundary::Fixed(face_states(block, p.face, &exact)),
        })
        .collect();
    let scheme = Scheme::new(1.4, reconstruction, 1.0, level.cell_count, level.planar, 1.0);
    let start = exact([0.0, 0.0]);
    let mut solver = Solver::new(Equations::new(level, scheme, boundaries, &start).expect("boundaries"));
    let mut means = Vec::new();
    for j in 0..block.nj {
        for i in 0..block.ni {
            means.extend_from_slice(&cell_mean(block, i, j, &exact));
        }
    }
    solver.set(&means);
    let first = solver.norm();
    let mut steps = 0;
    while solver.norm() > (1e-7 * first).max(5.0 * solver.round_off()) {
        // Newton steps from the exact solution, which is close.
        let cfl = if steps < 2 { 50.0 } else { 1e6 };
        solver.set_time_step(cfl);
        solver.build().expect("regular blocks");
        let settings = GcgSettings {
            tolerance: 1e-3,
            max_iterations: 150,
            patience: usize::MAX,
            directions: 60,
        };
        solver.solve(&settings).expect("no breakdown");
        let part = solver.admissible(0.3);
        solver.advance(part);
        steps += 1;
        assert!(
            steps < 40,
            "{reconstruction:?}: residual {:e} of {first:e} after {steps} steps",
            solver.norm()
        );
    }
    let volume = &solver.equations.level.blocks[0].volume;
    let (mut sum, mut total) = (0.0, 0.0);
    for (n, v) in volume.iter().enumerate() {
        sum += v * (solver.unknowns[5 * n] - means[5 * n]).powi(2);
        total += v;
    }
    (sum / total).sqrt()
}

/// A steady isentropic vortex between two radii, M = 0.9 to 0.45 (tangential speed ~ 1/r, total enthalpy constant).
pub fn vortex([x, z]: [f64; 2]) -> State<f64> {
    let r2 = x * x + z * z;
    // u = K/r; a^2 = a0^2 - 0.2 K^2/r^2 with a0 = 1.
    let k = 0.8;
    let a2 = 1.0 - 0.2 * k * k / r2;
    let rho = a2.powf(2.5);
    [rho, k * z / r2, 0.0, -k * x / r2, rho * a2 / 1.4]
}

/// Ringleb's flow at the stream function parameter `k` and the speed `q` (both in units of the stagnation speed of
/// sound): position and state. Masatsuka, I do like CFD, section 7.13.6.
pub fn ringleb_point(k: f64, q: f64) -> ([f64; 2], State<f64>) {
    let c = (1.0 - 0.2 * q * q).sqrt();
    let rho = c.powi(5);
    let p = c.powi(7) / 1.4;
    let j = 1.0 / c + 1.0 / (3.0 * c.powi(3)) + 1.0 / (5.0 * c.powi(5)) - 0.5 * ((1.0 + c) / (1.0 - c)).ln();
    let x = (2.0 / (k * k) - 1.0 / (q * q)) / (2.0 * rho) - 0.5 * j;
    let sine = q / k;
    let y = (1.0 - sine * sine).max(0.0).sqrt() / (k * rho * q);
    // Streamline angle: sin(theta) = q/k.
    let cosine = (1.0 - sine * sine).max(0.0).sqrt();
    ([x, y], [rho, q * cosine, 0.0, -q * sine, p])
}

/// State at (x, y) with y > 0, by Newton's method for (k, q) as functions of position: the circle of constant speed
/// gives q, then k.
pub fn ringleb([x, y]: [f64; 2]) -> State<f64> {
    // Points of equal speed lie on (x + J/2)^2 + y^2 = 1/(4 rho^2 q^4).
    let gap = |q: f64| {
        let c = (1.0_f64 - 0.2 * q * q).sqrt();
        let rho = c.powi(5);
        let j = 1.0 / c + 1.0 / (3.0 * c.powi(3)) + 1.0 / (5.0 * c.powi(5)) - 0.5 * ((1.0 + c) / (1.0 - c)).ln();
        ((x + 0.5 * j).powi(2) + y * y).sqrt() - 1.0 / (2.0 * rho * q * q)
    };
    let (mut lo, mut hi) = (0.2, 1.4);
    for _ in 0..80 {
        let mid = 0.5 * (lo + hi);
        if gap(mid) > 0.0 {
            hi = mid;
        } else {
            lo = mid;
        }
    }
    let q = 0.5 * (lo + hi);
    let c = (1.0_f64 - 0.2 * q * q).sqrt();
    let rho = c.powi(5);
    let j = 1.0 / c + 1.0 / (3.0 * c.powi(3)) + 1.0 / (5.0 * c.powi(5)) - 0.5 * ((1.0 + c) / (1.0 - c)).ln();
    let k = (2.0 / (2.0 * rho * (x + 0.5 * j) + 1.0 / (q * q))).sqrt();
    ringleb_point(k, q.min(k)).1
}

/// Part of the vortex between the radii 1 and `outer`, as much of the angle as of the quarter's radii, smoothly deformed by
/// `deformation` of its size. The same map on every grid: cells stay as skewed and as uneven as they are, however many.
pub fn vortex_grid(n: usize, outer: f64, deformation: f64, conditions: [Condition; 4]) -> MultiBlock {
    let pi = std::f64::consts::PI;
    let size = outer - 1.0;
    planar([n, n], conditions, |s, t| {
        let bump = deformation * (pi * s).sin() * (pi * t).sin();
        let r = 1.0 + size * (t + bump);
        let angle = 0.25 * pi + 0.5 * pi * size * (s - 0.5 + bump);
        [-r * angle.cos(), r * angle.sin()]
    })
}

/// Ringleb's flow between the streamlines k = 0.7 and 1.1, from q = 0.45 to q = 0.9 k (transonic near the inner one), or the
/// `part` in the middle of it; walls along the streamlines.
pub fn ringleb_grid(n: usize, part: f64) -> MultiBlock {
    use Condition::{FarField, Wall};
    planar([n, n], [FarField, FarField, Wall, Wall], |s, t| {
        let k = 0.9 + 0.4 * part * (0.5 - t);
        let (slow, fast) = (0.45, 0.9 * k);
        let q = 0.5 * (slow + fast) + part * (fast - slow) * (s - 0.5);
        ringleb_point(k, q).0
    })
}
