//! Exact checks: closed-form solutions, patch tests, measured orders, symmetry, equilibrium.

mod support;

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use dip_modal::{
    AverageElement, BarSection, DirectTerm, Dof, DofSet, Elasticity, Equation, GeneralElement, GeneralMatrix, MassForm,
    Material, MaterialAxis, Model, ModelError, Modes, ModesRequest, Node, NodeDof, NodeMass, Normalization, Ordinates,
    Planform, PlateWing, RigidElement, RootClamp, ScalarElement, ShellNodes, ShellSection, ShellThickness,
    ThicknessRule, WingError,
};
use nalgebra::{DMatrix, Matrix3, Matrix6, Rotation3, Vector3};
use support::{Cells, nodes_where, rectangle, simply_support, straight_bar};

fn modes(model: &Model, count: usize) -> Modes {
    model.assemble().unwrap().modes(&ModesRequest::lowest(count)).unwrap()
}

fn relative(a: f64, b: f64) -> f64 {
    (a / b - 1.0).abs()
}

fn distort(x: f64, y: f64) -> Vector3<f64> {
    // Moves inner nodes of the unit square only; elements become general quadrilaterals.
    let bump = (PI * x).sin() * (PI * y).sin();
    Vector3::new(
        x + 0.08 * bump * (5.0 * y).cos(),
        y + 0.07 * bump * (1.0 + 4.0 * x).sin(),
        0.0,
    )
}

// ---------------------------------------------------------------- bars

fn steel_bar() -> BarSection {
    BarSection::plain(1, 2.1e11, 8.0e10, 7850.0, 1e-4, 2.0e-9, 5.0e-10, 1.5e-9)
}

#[test]
fn cantilever_beam_frequencies_converge_with_fourth_order_to_euler_bernoulli() {
    // Roots of cos x cosh x = -1.
    let exact = [3.516_015_269, 22.034_491_56, 61.697_214_41];
    let (l, s) = (1.5, steel_bar());
    let error = |n: usize| {
        let mut model = straight_bar(l, n, s.clone());
        model.settings.mass = MassForm::Consistent;
        // Bending in plane 1 only.
        model.supports = vec![(1, DofSet::ALL)];
        model
            .supports
            .extend((2..=n as u32 + 1).map(|i| (i, DofSet::parse("1345").unwrap())));
        let modes = modes(&model, 3);
        let scale = (s.young * s.i1 / (s.density * s.area)).sqrt() / (l * l);
        (
            modes.omega_rad_s[2] / scale / exact[2] - 1.0,
            modes.omega_rad_s[0] / scale / exact[0] - 1.0,
        )
    };
    let (coarse, fine) = (error(8), error(16));
    // The cubic element with its consistent mass is high by (beta h)^4 / 1440, beta L = 7.8548 in mode 3.
    assert!(
        relative(fine.0, (7.854_757 / 16.0_f64).powi(4) / 1440.0) < 0.05,
        "{fine:?}"
    );
    let order = (coarse.0 / fine.0).log2();
    assert!((3.8..4.3).contains(&order), "order {order}");
}

#[test]
fn axial_and_torsional_bar_modes_converge_with_fourth_order() {
    // omega = (i - 1/2) pi c / L; the mean of lumped and linear mass cancels the second-order error.
    let mut s = steel_bar();
    s.polar_inertia = 7850.0 * 2.5e-9;
    let error = |n: usize, keep: u32, speed: f64| {
        let mut model = straight_bar(2.0, n, s.clone());
        model.settings.mass = MassForm::Consistent;
        let others: String = (1..=6).filter(|c| *c != keep).map(|c| c.to_string()).collect();
        model.supports = vec![(1, DofSet::ALL)];
        model
            .supports
            .extend((2..=n as u32 + 1).map(|i| (i, DofSet::parse(&others).unwrap())));
        relative(modes(&model, 2).omega_rad_s[1], 1.5 * PI * speed / 2.0)
    };
    for (keep, speed) in [
        (1, (s.young / s.density).sqrt()),
        (4, (s.shear * s.j / s.polar_inertia).sqrt()),
    ] {
        let (coarse, fine) = (error(8, keep, speed), error(16, keep, speed));
        assert!(fine < 1e-4, "{fine:e}");
        assert!(
            (3.7..4.3).contains(&(coarse / fine).log2()),
            "order {}",
            (coarse / fine).log2()
        );
    }
}

#[test]
fn timoshenko_tip_deflection_is_exact() {
    // P L^3 / (3 E I) + P L / (k G A), with one element or several.
    let mut s = steel_bar();
    s.k1 = Some(0.8);
    s.i1 = 1e-6;
    let (l, p) = (0.3_f64, 1000.0);
    let exact = p * l.powi(3) / (3.0 * s.young * s.i1) + p * l / (0.8 * s.shear * s.area);
    for n in [1, 3] {
        let mut model = straight_bar(l, n, s.clone());
        model.supports = vec![(1, DofSet::ALL)];
        let tip = n as u32 + 1;
        let u = model
            .assemble()
            .unwrap()
            .displacements(&[(NodeDof::new(tip, Dof::T2), p)])
            .unwrap();
        assert!(relative(u[n][1], exact) < 1e-10, "{} {exact}", u[n][1]);
    }
}

#[test]
fn unsymmetrical_bending_follows_the_inertia_tensor() {
    // M = E I kappa with I = [[I1, I12], [I12, I2]]: tip deflection (v, w) = L^3/(3E) I^-1 P.
    let mut s = steel_bar();
    s.i12 = 0.6e-9;
    let l = 1.0;
    let mut model = straight_bar(l, 2, s.clone());
    model.supports = vec![(1, DofSet::ALL)];
    let loads = [(NodeDof::new(3, Dof::T2), 3.0), (NodeDof::new(3, Dof::T3), -5.0)];
    let u = model.assemble().unwrap().displacements(&loads).unwrap();
    let inertia = nalgebra::Matrix2::new(s.i1, s.i12, s.i12, s.i2);
    let exact = inertia.try_inverse().unwrap() * nalgebra::Vector2::new(3.0, -5.0) * (l.powi(3) / (3.0 * s.young));
    assert!(relative(u[2][1], exact.x) < 1e-9 && relative(u[2][2], exact.y) < 1e-9);
}

#[test]
fn offsets_and_pins_of_a_bar_keep_equilibrium() {
    let s = steel_bar();
    // The elastic axis lies 0.2 above the nodes: an axial force at the nodes bends by F e L^2 / (2 E I).
    let mut model = straight_bar(1.0, 4, s.clone());
    for bar in &mut model.bars {
        bar.offsets = [Vector3::new(0.0, 0.2, 0.0); 2];
    }
    model.supports = vec![(1, DofSet::ALL)];
    let system = model.assemble().unwrap();
    assert!(system.rigid_check().imbalance.iter().all(|i| *i < 1e-14));
    let u = system.displacements(&[(NodeDof::new(5, Dof::T1), 7.0)]).unwrap();
    let moment = 7.0 * 0.2;
    assert!(relative(u[4][1], moment / (2.0 * s.young * s.i1)) < 1e-9, "{}", u[4][1]);
    // A pin at the far end of a clamped-clamped bar carries no moment: 3EI/L^3 instead of 12EI/L^3.
    let mut model = straight_bar(1.0, 1, s.clone());
    model.bars[0].pins[1] = DofSet::parse("56").unwrap();
    model.supports = vec![(1, DofSet::ALL), (2, DofSet::parse("13456").unwrap())];
    let u = model
        .assemble()
        .unwrap()
        .displacements(&[(NodeDof::new(2, Dof::T2), 1.0)])
        .unwrap();
    assert!(relative(u[1][1], 1.0 / (3.0 * s.young * s.i1)) < 1e-9);
}

// ---------------------------------------------------------------- plates: patch tests

/// Supports the outline with the exact field and returns the largest error inside.
fn patch_error(cells: Cells, thickness: f64, sheared: bool) -> f64 {
    let material = Material::isotropic(7.0e10, 0.3, 2700.0);
    let section = if sheared {
        ShellSection::plate(1, material, thickness)
    } else {
        ShellSection::thin_plate(1, material, thickness)
    };
    let mut model = rectangle((1.0, 1.0), (4, 4), cells, section, distort);
    // w = (x^2 + x y + 2 y^2)/2, constant curvatures, zero shear: theta_x = w,y, theta_y = -w,x.
    let field = |p: &Vector3<f64>| {
        [
            0.5 * (p.x * p.x + p.x * p.y + 2.0 * p.y * p.y),
            0.5 * (p.x + 4.0 * p.y),
            -0.5 * (2.0 * p.x + p.y),
        ]
    };
    // Values are imposed by equations: u - u_ref * 1 = 0 with one extra scalar point held by a spring of 1
    // under the force 1.
    model.nodes.push(Node::scalar(1000));
    let one = NodeDof::new(1000, Dof::T1);
    model.springs.push(ScalarElement {
        id: 1,
        value: 1.0,
        a: one,
        b: None,
    });
    for node in model.nodes.clone().iter().filter(|n| !n.scalar) {
        let p = node.position;
        let edge = p.x < 1e-9 || p.x > 1.0 - 1e-9 || p.y < 1e-9 || p.y > 1.0 - 1e-9;
        if edge {
            for (dof, value) in [Dof::T3, Dof::R1, Dof::R2].into_iter().zip(field(&p)) {
                let terms = vec![(NodeDof::new(node.id, dof), 1.0), (one, -value)];
                model.equations.push(Equation { id: 1, terms });
            }
        }
    }
    let system = model.assemble().unwrap();
    let k = 1.0 + 2.0 * system.strain_energy(&exact_motion(&model, &field)) - 1.0;
    // The force on the scalar point is its spring's and the plate's: any value scales the same field.
    let u = system.displacements(&[(one, k)]).unwrap();
    let scale = u[model.nodes.len() - 1][0];
    model
        .nodes
        .iter()
        .zip(&u)
        .filter(|(n, _)| !n.scalar)
        .map(|(n, u)| {
            let e = field(&n.position);
            [u[2] / scale - e[0], u[3] / scale - e[1], u[4] / scale - e[2]]
                .iter()
                .fold(0.0_f64, |m, v| m.max(v.abs()))
        })
        .fold(0.0, f64::max)
}

fn exact_motion(model: &Model, field: &dyn Fn(&Vector3<f64>) -> [f64; 3]) -> Vec<[f64; 6]> {
    model
        .nodes
        .iter()
        .map(|n| {
            let e = field(&n.position);
            if n.scalar {
                [1.0, 0.0, 0.0, 0.0, 0.0, 0.0]
            } else {
                [0.0, 0.0, e[0], e[1], e[2], 0.0]
            }
        })
        .collect()
}

#[test]
fn constant_bending_patch_test_on_distorted_quadrilaterals_and_triangles() {
    for cells in [Cells::Quads, Cells::Triangles] {
        for (thickness, sheared) in [(0.001, false), (0.001, true), (0.1, true), (1.0, true)] {
            let error = patch_error(cells, thickness, sheared);
            assert!(error < 1e-9, "thickness {thickness}: {error:e}");
        }
    }
}

#[test]
fn constant_curvature_has_the_exact_strain_energy() {
    // 1/2 kappa^T D kappa x area with kappa = -(1, 2, 1): beta = -grad w.
    for cells in [Cells::Quads, Cells::Triangles] {
        let material = Material::orthotropic(3.0e9, 0.4e9, 0.31, 0.44e9, 380.0);
        let model = rectangle(
            (1.0, 1.0),
            (3, 3),
            cells,
            ShellSection::thin_plate(1, material.clone(), 0.02),
            distort,
        );
        let field = |p: &Vector3<f64>| {
            [
                0.5 * (p.x * p.x + p.x * p.y + 2.0 * p.y * p.y),
                0.5 * (p.x + 4.0 * p.y),
                -0.5 * (2.0 * p.x + p.y),
            ]
        };
        let energy = model.assemble().unwrap().strain_energy(&exact_motion(&model, &field));
        let kappa = Vector3::new(1.0, 2.0, 1.0);
        let exact = 0.5 * kappa.dot(&(material.plane_stress() * kappa)) * 0.02_f64.powi(3) / 12.0;
        assert!(relative(energy, exact) < 1e-10, "{energy:e} {exact:e}");
    }
}

#[test]
fn constant_membrane_strain_has_the_exact_energy_and_no_residual_force() {
    for cells in [Cells::Quads, Cells::Triangles] {
        let material = Material::isotropic(7.0e10, 0.3, 2700.0);
        let mut model = rectangle(
            (1.0, 1.0),
            (3, 3),
            cells,
            ShellSection::shell(1, material.clone(), 0.01),
            distort,
        );
        // u = (2 x + y, 3 x - y): e = (2, -1, 4), rotation (v,x - u,y)/2 = 1 about z.
        let motion: Vec<[f64; 6]> = model
            .nodes
            .iter()
            .map(|n| {
                [
                    2.0 * n.position.x + n.position.y,
                    3.0 * n.position.x - n.position.y,
                    0.0,
                    0.0,
                    0.0,
                    1.0,
                ]
            })
            .collect();
        let strain = Vector3::new(2.0, -1.0, 4.0);
        let exact = 0.5 * strain.dot(&(material.plane_stress() * strain)) * 0.01;
        let energy = model.assemble().unwrap().strain_energy(&motion);
        assert!(relative(energy, exact) < 1e-10, "{energy:e} {exact:e}");
        // Least energy: any change of the inner nodes costs energy to second order only.
        for (n, node) in model.nodes.clone().iter().enumerate() {
            let p = node.position;
            if p.x > 1e-9 && p.x < 1.0 - 1e-9 && p.y > 1e-9 && p.y < 1.0 - 1e-9 {
                let system = model.assemble().unwrap();
                for axis in 0..2 {
                    let energy_at = |step: f64| {
                        let mut moved = motion.clone();
                        moved[n][axis] += step;
                        system.strain_energy(&moved)
                    };
                    let slope = (energy_at(1.0) - energy_at(-1.0)) / 2.0;
                    assert!(slope.abs() < 1e-9 * exact, "node {} {slope:e}", node.id);
                }
            }
        }
        model.shells.truncate(1);
    }
}

#[test]
fn in_plane_bending_of_rectangular_shells_is_exact() {
    // A strip under pure in-plane moment: the incompatible modes hold its exact quadratic field.
    let (l, h, t, e) = (1.0, 0.1, 0.01, 7.0e10);
    let mut section = ShellSection::shell(1, Material::isotropic(e, 0.3, 2700.0), t);
    section.id = 7;
    let mut model = rectangle((l, h), (10, 1), Cells::Quads, section, |x, y| Vector3::new(x, y, 0.0));
    model.settings.drilling = 0.0;
    for n in nodes_where(&model, |p| p.x < 1e-9) {
        model.supports.push((n, DofSet::parse("13456").unwrap()));
    }
    model.supports.push((1, DofSet::parse("2").unwrap()));
    let moment = 10.0;
    let tips = nodes_where(&model, |p| p.x > l - 1e-9);
    let loads = [
        (NodeDof::new(tips[0], Dof::T1), -moment / h),
        (NodeDof::new(tips[1], Dof::T1), moment / h),
    ];
    let u = model.assemble().unwrap().displacements(&loads).unwrap();
    let inertia = t * h.powi(3) / 12.0;
    let exact = -moment * l * l / (2.0 * e * inertia);
    let tip = u[tips[0] as usize - 1][1];
    assert!(relative(tip, exact) < 1e-9, "{tip:e} {exact:e}");
}

// ---------------------------------------------------------------- plates: frequencies

/// lambda = omega a^2 sqrt(rho h / D) of a square cantilever plate.
fn cantilever_square(n: usize, cells: Cells, form: MassForm) -> Vec<f64> {
    let (e, nu, rho, t) = (7.0e10, 0.3, 2700.0, 1e-3);
    let section = ShellSection::thin_plate(1, Material::isotropic(e, nu, rho), t);
    let mut model = rectangle((1.0, 1.0), (n, n), cells, section, |x, y| Vector3::new(x, y, 0.0));
    model.settings.mass = form;
    model.supports = nodes_where(&model, |p| p.x < 1e-9)
        .into_iter()
        .map(|n| (n, DofSet::ALL))
        .collect();
    let d = e * t.powi(3) / (12.0 * (1.0 - nu * nu));
    modes(&model, 5)
        .omega_rad_s
        .iter()
        .map(|w| w * (rho * t / d).sqrt())
        .collect()
}

#[test]
fn kirchhoff_plate_converges_with_second_order_for_quadrilaterals_and_triangles() {
    // Simply supported square: omega = pi^2 (m^2 + n^2) sqrt(D / (rho h)) / a^2 exactly.
    let (e, nu, rho, t) = (7.0e10, 0.3, 2700.0, 2e-3_f64);
    let d = e * t.powi(3) / (12.0 * (1.0 - nu * nu));
    for cells in [Cells::Quads, Cells::Triangles] {
        let error = |n: usize| {
            let section = ShellSection::thin_plate(1, Material::isotropic(e, nu, rho), t);
            let mut model = rectangle((1.0, 1.0), (n, n), cells, section, |x, y| Vector3::new(x, y, 0.0));
            model.settings.mass = MassForm::Consistent;
            simply_support(&mut model, (1.0, 1.0));
            let w = modes(&model, 4).omega_rad_s;
            let exact = |s: f64| PI * PI * s * (d / (rho * t)).sqrt();
            // Modes (1,2) and (2,1) have one frequency: both must be there.
            assert!(relative(w[1], w[2]) < 1e-2, "{w:?}");
            (relative(w[0], exact(2.0)), relative(w[3], exact(8.0)))
        };
        let (coarse, fine) = (error(12), error(24));
        assert!(fine.0 < 3e-3 && fine.1 < 1e-2, "{fine:?}");
        let order = (coarse.1 / fine.1).log2();
        assert!((1.8..2.3).contains(&order), "order {order}");
    }
}

#[test]
fn shear_flexible_elements_do_not_lock_when_thin() {
    // The relative difference to the Kirchhoff limit falls with (t/L)^2, down to t/L = 1e-5.
    let ratio = |t: f64, cells: Cells| {
        let material = Material::isotropic(7.0e10, 0.3, 2700.0);
        let run = |section: ShellSection| {
            let mut model = rectangle((1.0, 1.0), (6, 6), cells, section, distort);
            simply_support(&mut model, (1.0, 1.0));
            modes(&model, 1).omega_rad_s[0]
        };
        run(ShellSection::plate(1, material.clone(), t)) / run(ShellSection::thin_plate(1, material, t)) - 1.0
    };
    for cells in [Cells::Quads, Cells::Triangles] {
        assert!(ratio(1e-5, cells).abs() < 1e-7, "{:e}", ratio(1e-5, cells));
        let order = (ratio(2e-2, cells) / ratio(1e-2, cells)).log2();
        assert!((1.8..2.2).contains(&order), "order {order}");
    }
}

/// Exact lowest frequency of a simply supported Mindlin plate with rotary inertia, mode (m, n): with
/// w = W sin sin, beta_x = X cos sin, beta_y = Y sin cos the equations of motion are a 3 x 3 eigenproblem
/// (Mindlin, J. Appl. Mech. 18 (1951), p. 31).
fn mindlin(e: f64, nu: f64, rho: f64, t: f64, kappa: f64, kx: f64, ky: f64) -> f64 {
    let d = e * t.powi(3) / (12.0 * (1.0 - nu * nu));
    let s = kappa * e / (2.0 * (1.0 + nu)) * t;
    let k = Matrix3::new(
        s * (kx * kx + ky * ky),
        s * kx,
        s * ky,
        s * kx,
        d * (kx * kx + 0.5 * (1.0 - nu) * ky * ky) + s,
        0.5 * d * (1.0 + nu) * kx * ky,
        s * ky,
        0.5 * d * (1.0 + nu) * kx * ky,
        d * (ky * ky + 0.5 * (1.0 - nu) * kx * kx) + s,
    );
    let root = Vector3::new(rho * t, rho * t.powi(3) / 12.0, rho * t.powi(3) / 12.0).map(|m: f64| m.sqrt().recip());
    let scaled = Matrix3::from_fn(|i, j| k[(i, j)] * root[i] * root[j]);
    scaled.symmetric_eigenvalues().min().sqrt()
}

#[test]
fn thick_plate_converges_to_the_exact_mindlin_frequencies() {
    let (e, nu, rho, t) = (7.0e10, 0.3, 2700.0, 0.2);
    for cells in [Cells::Quads, Cells::Triangles] {
        let error = |n: usize| {
            let section = ShellSection::plate(1, Material::isotropic(e, nu, rho), t);
            let mut model = rectangle((1.0, 1.0), (n, n), cells, section, |x, y| Vector3::new(x, y, 0.0));
            model.settings.mass = MassForm::Consistent;
            model.settings.rotary_inertia = true;
            simply_support(&mut model, (1.0, 1.0));
            let w = modes(&model, 4).omega_rad_s;
            w[3] / mindlin(e, nu, rho, t, 5.0 / 6.0, 2.0 * PI, 2.0 * PI) - 1.0
        };
        let (coarse, fine) = (error(12), error(24));
        // The limit that the two meshes point to.
        let limit = (4.0 * fine - coarse) / 3.0;
        assert!(limit.abs() < 3e-4, "{coarse:e} {fine:e} {limit:e}");
        let order = (coarse / fine).log2();
        assert!((1.8..2.3).contains(&order), "order {order}");
    }
    // Shear matters here: the thin value is more than a tenth higher.
    let thin = PI * PI * 8.0 * (e * t * t / (12.0 * (1.0 - nu * nu) * rho)).sqrt();
    assert!(thin > 1.3 * mindlin(e, nu, rho, t, 5.0 / 6.0, 2.0 * PI, 2.0 * PI));
}

#[test]
fn corner_integration_and_uniform_thickness_agree_when_the_thickness_is_constant() {
    let reference = cantilever_square(8, Cells::Quads, MassForm::Lumped);
    let section = ShellSection::thin_plate(1, Material::isotropic(7.0e10, 0.3, 2700.0), 0.0);
    for thickness in [
        ShellThickness::Uniform(1e-3),
        ShellThickness::Corner([1e-3; 4]),
        ShellThickness::Integration([1e-3; 4]),
    ] {
        let mut model = rectangle((1.0, 1.0), (8, 8), Cells::Quads, section.clone(), |x, y| {
            Vector3::new(x, y, 0.0)
        });
        for s in &mut model.shells {
            s.thickness = thickness;
        }
        model.supports = nodes_where(&model, |p| p.x < 1e-9)
            .into_iter()
            .map(|n| (n, DofSet::ALL))
            .collect();
        let d: f64 = 7.0e10 * 1e-9 / (12.0 * 0.91);
        for (w, r) in modes(&model, 5).omega_rad_s.iter().zip(&reference) {
            assert!(relative(w * (2700.0 * 1e-3 / d).sqrt(), *r) < 1e-9);
        }
    }
}

#[test]
fn a_laminate_of_one_material_is_the_homogeneous_shell() {
    let material = Material {
        elasticity: Elasticity::Orthotropic {
            young_1: 3.0e9,
            young_2: 0.4e9,
            poisson_12: 0.31,
            shear_12: 0.44e9,
            shear_1z: Some(0.3e9),
            shear_2z: Some(0.2e9),
        },
        density: 380.0,
    };
    let ply = |thickness, angle_rad| dip_modal::Ply {
        material: material.clone(),
        thickness,
        angle_rad,
    };
    let laminate = |plies| ShellSection {
        id: 1,
        thickness: 0.0,
        nonstructural_mass: 0.0,
        layup: dip_modal::Layup::Plies { plies, bottom: None },
    };
    let one = laminate(vec![ply(0.004, 0.0), ply(0.006, 0.0)]).stiffness(0.0);
    let solid = ShellSection::shell(1, material.clone(), 0.01).stiffness(0.01);
    assert!((one.bending - solid.bending).abs().max() < 1e-12 * solid.bending.max());
    assert!((one.membrane - solid.membrane).abs().max() < 1e-12 * solid.membrane.max());
    assert!(one.coupling.abs().max() < 1e-12 * solid.membrane.max() * 0.01);
    // A symmetric lay-up has no coupling, an unsymmetric one has.
    let unsymmetric = laminate(vec![ply(0.005, 0.0), ply(0.005, FRAC_PI_2)]).stiffness(0.0);
    let q = material.plane_stress();
    // B11 = (Q22 - Q11) t^2 / 8 for (0/90), Jones (4.95).
    assert!(relative(unsymmetric.coupling[(0, 0)], (q[(1, 1)] - q[(0, 0)]) * 1e-4 / 8.0) < 1e-12);
}

// ---------------------------------------------------------------- invariance, free structures

/// A free, slightly warped shell with all kinds of stiffness.
fn free_shell(turn: &Rotation3<f64>, node_frames: bool) -> Model {
    let section = ShellSection::shell(1, Material::isotropic(7.0e10, 0.3, 2700.0), 0.01);
    let place = |x: f64, y: f64| turn * Vector3::new(x, y, 0.05 * x * y + 0.1 * x * x);
    let mut model = rectangle((1.0, 0.6), (7, 5), Cells::Quads, section, place);
    let first = model.shells[0].axis;
    assert_eq!(first, MaterialAxis::Along(Vector3::x()));
    for s in &mut model.shells {
        s.axis = MaterialAxis::Angle(0.3);
        s.offset = 0.003;
    }
    if node_frames {
        for (i, n) in model.nodes.iter_mut().enumerate() {
            let k = i as f64;
            n.frame = *Rotation3::from_euler_angles(0.3 * k, (1.7 * k).sin(), 0.9 * k).matrix();
        }
    }
    model.masses.push(NodeMass::Point {
        id: 1,
        node: 9,
        mass: 3.0,
        offset: Vector3::new(0.02, 0.0, -0.1),
        inertia: Matrix3::from_diagonal(&Vector3::new(0.01, 0.02, 0.03)),
        axes: *turn.matrix(),
    });
    model
}

#[test]
fn a_free_structure_has_six_rigid_modes_and_does_not_feel_its_orientation() {
    let reference = modes(&free_shell(&Rotation3::identity(), false), 12);
    assert!(
        reference.omega_rad_s[..6].iter().all(|w| *w == 0.0),
        "{:?}",
        reference.omega_rad_s
    );
    assert!(reference.omega_rad_s[6] > 1.0);
    let turn = Rotation3::from_euler_angles(0.4, -1.1, 2.3);
    for node_frames in [false, true] {
        let model = free_shell(&turn, node_frames);
        let system = model.assemble().unwrap();
        let check = system.rigid_check();
        assert!(check.imbalance.iter().all(|i| *i < 1e-13), "{check:?}");
        let turned = system.modes(&ModesRequest::lowest(12)).unwrap();
        assert!(
            turned.omega_rad_s[..6].iter().all(|w| *w == 0.0),
            "{:?}",
            turned.omega_rad_s
        );
        for (a, b) in turned.omega_rad_s[6..].iter().zip(&reference.omega_rad_s[6..]) {
            assert!(relative(*a, *b) < 1e-7, "{a} {b}");
        }
    }
}

#[test]
fn mass_properties_of_a_plate_with_an_offset_mass_are_exact() {
    let t = 0.01;
    let section = ShellSection::shell(1, Material::isotropic(7.0e10, 0.3, 1000.0), t);
    let mut model = rectangle((2.0, 1.0), (4, 4), Cells::Quads, section, |x, y| {
        Vector3::new(x, y, 0.5)
    });
    model.settings.mass = MassForm::Consistent;
    let properties = model.assemble().unwrap().mass_properties();
    assert!(relative(properties.mass, 20.0) < 1e-12);
    assert!((properties.centre - Vector3::new(1.0, 0.5, 0.5)).norm() < 1e-12);
    assert!(relative(properties.inertia[(0, 0)], 20.0 / 12.0) < 1e-12);
    assert!(relative(properties.inertia[(1, 1)], 20.0 * 4.0 / 12.0) < 1e-12);
    assert!(relative(properties.inertia[(2, 2)], 20.0 * 5.0 / 12.0) < 1e-12);
    let inertia = Matrix3::new(0.3, -0.05, 0.0, -0.05, 0.4, 0.01, 0.0, 0.01, 0.5);
    model = Model {
        masses: Vec::new(),
        ..Model::default()
    };
    model
        .nodes
        .push(Node::grid(1, 1.0, 2.0, 3.0).with_frame(*Rotation3::from_euler_angles(1.0, 2.0, 3.0).matrix()));
    model.masses.push(NodeMass::Point {
        id: 1,
        node: 1,
        mass: 4.0,
        offset: Vector3::new(0.1, -0.2, 0.3),
        inertia,
        axes: Matrix3::identity(),
    });
    model.springs.push(ScalarElement {
        id: 1,
        value: 1.0,
        a: NodeDof::new(1, Dof::T1),
        b: None,
    });
    let properties = model.assemble().unwrap().mass_properties();
    assert!(relative(properties.mass, 4.0) < 1e-12);
    assert!((properties.centre - Vector3::new(1.1, 1.8, 3.3)).norm() < 1e-12);
    assert!((properties.inertia - inertia).abs().max() < 1e-11);
}

#[test]
fn an_inclined_plate_without_membrane_is_supported_in_its_plane_and_keeps_its_frequencies() {
    let run = |turn: &Rotation3<f64>| {
        let section = ShellSection::thin_plate(1, Material::isotropic(7.0e10, 0.3, 2700.0), 1e-3);
        let place = |x: f64, y: f64| turn * Vector3::new(x, y, 0.0);
        let mut model = rectangle((1.0, 1.0), (6, 6), Cells::Quads, section, place);
        for s in &mut model.shells {
            s.axis = MaterialAxis::Angle(0.0);
        }
        model.supports = (1..=43).step_by(7).map(|n| (n, DofSet::ALL)).collect();
        let system = model.assemble().unwrap();
        assert_eq!(system.auto_supports.len(), 3 * 42);
        system.modes(&ModesRequest::lowest(4)).unwrap().omega_rad_s
    };
    let flat = run(&Rotation3::identity());
    let inclined = run(&Rotation3::from_euler_angles(0.6, 0.5, 0.4));
    for (a, b) in flat.iter().zip(&inclined) {
        assert!(relative(*a, *b) < 1e-8, "{flat:?} {inclined:?}");
    }
}

// ---------------------------------------------------------------- eigenvalues

/// Chain of equal masses and springs, one end fixed: omega = 2 sqrt(k/m) sin((2i - 1) pi / (4 n + 2)).
fn chain(n: u32) -> Model {
    let mut model = Model::default();
    for i in 1..=n {
        model.nodes.push(Node::scalar(i));
        let here = NodeDof::new(i, Dof::T1);
        let before = (i > 1).then(|| NodeDof::new(i - 1, Dof::T1));
        model.springs.push(ScalarElement {
            id: i,
            value: 40.0,
            a: here,
            b: before,
        });
        model.scalar_masses.push(ScalarElement {
            id: i,
            value: 0.1,
            a: here,
            b: None,
        });
    }
    model
}

#[test]
fn a_chain_has_its_exact_frequencies_dense_and_sparse() {
    for n in [5_u32, 150, 3000] {
        let found = modes(&chain(n), 12);
        assert_eq!(found.count(), 12.min(n as usize));
        for (i, w) in found.omega_rad_s.iter().enumerate() {
            let exact = 2.0 * 20.0 * ((2 * i + 1) as f64 * PI / f64::from(4 * n + 2)).sin();
            assert!(relative(*w, exact) < 1e-8, "n {n} mode {} {w} {exact}", i + 1);
        }
    }
}

#[test]
fn multiple_roots_are_all_found_and_orthonormal_in_the_mass() {
    // Six equal chains side by side: every root six times.
    let n = 100;
    let mut model = Model::default();
    for copy in 0..6 {
        let mut one = chain(n);
        let shift = copy * n;
        one.nodes.iter_mut().for_each(|x| x.id += shift);
        for e in one.springs.iter_mut().chain(&mut one.scalar_masses) {
            e.a.node += shift;
            if let Some(b) = &mut e.b {
                b.node += shift;
            }
        }
        model.nodes.extend(one.nodes);
        model.springs.extend(one.springs);
        model.scalar_masses.extend(one.scalar_masses);
    }
    let found = modes(&model, 18);
    for (i, w) in found.omega_rad_s.iter().enumerate() {
        let exact = 40.0 * ((2 * (i / 6) + 1) as f64 * PI / f64::from(4 * n + 2)).sin();
        assert!(relative(*w, exact) < 1e-8, "mode {} {w} {exact}", i + 1);
    }
    for a in 0..18 {
        for b in 0..=a {
            let product: f64 = found.shapes[a]
                .iter()
                .zip(&found.shapes[b])
                .map(|(x, y)| 0.1 * x[0] * y[0])
                .sum();
            let expected = if a == b { 1.0 } else { 0.0 };
            assert!((product - expected).abs() < 1e-9, "{a} {b} {product}");
        }
    }
}

#[test]
fn massless_degrees_of_freedom_do_not_disturb_the_modes() {
    // Every second mass of the chain left out: static condensation by hand gives springs in series.
    for n in [40_u32, 600] {
        let mut model = chain(n);
        model.scalar_masses.retain(|m| m.id % 2 == 0);
        let found = modes(&model, 6);
        for (i, w) in found.omega_rad_s.iter().enumerate() {
            let exact = 2.0 * (20.0_f64 / 0.1).sqrt() * ((2 * i + 1) as f64 * PI / f64::from(2 * n + 2)).sin();
            assert!(relative(*w, exact) < 1e-8, "n {n} mode {} {w} {exact}", i + 1);
        }
    }
    // Fewer masses than modes: as many modes as there are.
    let mut model = chain(400);
    model.scalar_masses.truncate(3);
    assert_eq!(modes(&model, usize::MAX).count(), 3);
    let found = modes(&model, 10);
    assert_eq!(found.count(), 3);
}

#[test]
fn residuals_are_small_and_normalizations_do_what_they_say() {
    let section = ShellSection::thin_plate(1, Material::isotropic(7.0e10, 0.3, 2700.0), 1e-3);
    let mut model = rectangle((1.0, 0.7), (20, 14), Cells::Quads, section, |x, y| {
        Vector3::new(x, y, 0.0)
    });
    model.supports = nodes_where(&model, |p| p.x < 1e-9)
        .into_iter()
        .map(|n| (n, DofSet::ALL))
        .collect();
    let system = model.assemble().unwrap();
    let found = system.modes(&ModesRequest::lowest(15)).unwrap();
    assert!(found.residual.iter().all(|r| *r < 1e-8), "{:?}", found.residual);
    assert!(found.generalized_mass.iter().all(|m| (m - 1.0).abs() < 1e-9));
    let maximum = ModesRequest {
        normalization: Normalization::Maximum,
        ..ModesRequest::lowest(15)
    };
    let scaled = system.modes(&maximum).unwrap();
    for mode in 0..15 {
        let peak = scaled.shapes[mode]
            .iter()
            .flatten()
            .fold(0.0_f64, |m, v| m.max(v.abs()));
        assert!((peak - 1.0).abs() < 1e-12);
        // Strain energy is half of the generalized stiffness.
        let energy = system.strain_energy(&scaled.shapes[mode]);
        assert!(relative(2.0 * energy, scaled.generalized_stiffness(mode)) < 1e-7);
    }
    let corner = NodeDof::new(21, Dof::T3);
    let point = ModesRequest {
        normalization: Normalization::Point(corner),
        ..ModesRequest::lowest(3)
    };
    let at_point = system.modes(&point).unwrap();
    assert!((0..3).all(|m| (at_point.shapes[m][20][2] - 1.0).abs() < 1e-12));
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let model = free_shell(&Rotation3::from_euler_angles(0.4, -1.1, 2.3), true);
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| modes(&model, 9))
    };
    assert_eq!(run(1), run(3));
}

// ---------------------------------------------------------------- constraints, reduction, special elements

#[test]
fn a_rigid_link_moves_a_mass_as_an_offset_does() {
    let with_offset = |how: usize| {
        let mut model = straight_bar(1.0, 5, steel_bar());
        model.settings.mass = MassForm::Consistent;
        model.supports = vec![(1, DofSet::ALL)];
        let arm = Vector3::new(0.1, 0.05, -0.2);
        let mut mass = |node, offset| {
            model.masses.push(NodeMass::Point {
                id: 1,
                node,
                mass: 2.0,
                offset,
                inertia: Matrix3::from_diagonal(&Vector3::new(0.01, 0.02, 0.03)),
                axes: Matrix3::identity(),
            });
        };
        if how == 0 {
            mass(6, arm);
        } else {
            mass(7, Vector3::zeros());
            let frame = *Rotation3::from_euler_angles(0.5, 0.6, 0.7).matrix();
            model
                .nodes
                .push(Node::grid(7, 1.0 + arm.x, arm.y, arm.z).with_frame(frame));
        }
        match how {
            1 => model.rigid.push(RigidElement::rbe2(1, 6, DofSet::ALL, &[7])),
            // A rigid bar whose independent motion is shared between its ends.
            2 => model.rigid.push(RigidElement {
                id: 1,
                independent: vec![(6, DofSet::parse("123").unwrap()), (7, DofSet::parse("456").unwrap())],
                dependent: vec![(7, DofSet::parse("123").unwrap()), (6, DofSet::parse("456").unwrap())],
            }),
            _ => {}
        }
        modes(&model, 6).omega_rad_s
    };
    let reference = with_offset(0);
    for how in [1, 2] {
        for (a, b) in with_offset(how).iter().zip(&reference) {
            assert!(relative(*a, *b) < 1e-8, "{how}: {a} {b}");
        }
    }
}

#[test]
fn an_average_spreads_a_force_without_stiffening() {
    // Four nodes on springs, a reference off their centre: equilibrium of force and moment, and rigid
    // motion of the four moves the reference rigidly.
    let mut model = Model::default();
    let places = [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (0.0, 1.0)];
    for (i, (x, y)) in places.into_iter().enumerate() {
        let id = 1 + i as u32;
        model.nodes.push(Node::grid(id, x, y, 0.0));
        for dof in [Dof::T1, Dof::T2, Dof::T3] {
            model.springs.push(ScalarElement {
                id,
                value: 1e3 * (1.0 + i as f64),
                a: NodeDof::new(id, dof),
                b: None,
            });
        }
        model.supports.push((id, DofSet::ROTATIONS));
    }
    model.nodes.push(Node::grid(9, 1.3, 0.2, 0.4));
    model.averages.push(AverageElement {
        id: 1,
        reference: (9, DofSet::ALL),
        terms: vec![
            (1.0, DofSet::TRANSLATIONS, vec![1, 2]),
            (2.0, DofSet::TRANSLATIONS, vec![3, 4]),
        ],
        dependent: Vec::new(),
    });
    let (force, moment) = (Vector3::new(3.0, -2.0, 5.0), Vector3::new(0.5, 1.5, -0.7));
    let mut loads = Vec::new();
    for axis in 0..3 {
        loads.push((NodeDof::new(9, Dof::from_index(axis).unwrap()), force[axis]));
        loads.push((NodeDof::new(9, Dof::from_index(axis + 3).unwrap()), moment[axis]));
    }
    let u = model.assemble().unwrap().displacements(&loads).unwrap();
    // Spring forces are stiffness times motion.
    let (mut sum, mut turning) = (Vector3::zeros(), Vector3::zeros());
    for (i, (x, y)) in places.into_iter().enumerate() {
        let f = Vector3::new(u[i][0], u[i][1], u[i][2]) * (1e3 * (1.0 + i as f64));
        sum += f;
        turning += (Vector3::new(x, y, 0.0) - Vector3::new(1.3, 0.2, 0.4)).cross(&f);
    }
    assert!(
        (sum - force).norm() < 1e-9 && (turning - moment).norm() < 1e-9,
        "{sum} {turning}"
    );
    // A row of nodes cannot tell a turn about itself.
    model.averages[0].terms = vec![(1.0, DofSet::TRANSLATIONS, vec![1, 2])];
    model.averages[0].reference.1 = DofSet::parse("4").unwrap();
    assert!(matches!(model.assemble(), Err(ModelError::BadConstraint { .. })));
}

#[test]
fn general_elements_reproduce_a_bar() {
    // Flexibility of a cantilever's tip (v, theta_z) and the rigid motion of its root make the element
    // that the bar is; so does its stiffness.
    let s = steel_bar();
    let l = 0.8_f64;
    let ei = s.young * s.i1;
    let z = DMatrix::from_row_slice(2, 2, &[l.powi(3) / 3.0, l * l / 2.0, l * l / 2.0, l]) / ei;
    let tip = [NodeDof::new(2, Dof::T2), NodeDof::new(2, Dof::R3)];
    let root = [NodeDof::new(1, Dof::T2), NodeDof::new(1, Dof::R3)];
    let general = |matrix| GeneralElement {
        id: 1,
        dofs: tip.to_vec(),
        rigid_dofs: root.to_vec(),
        matrix,
        s: Some(DMatrix::from_row_slice(2, 2, &[1.0, l, 0.0, 1.0])),
    };
    let energy = |model: &Model, motion: &[[f64; 6]]| model.assemble().unwrap().strain_energy(motion);
    let bar = straight_bar(l, 1, s.clone());
    let motion = [[0.0, 0.3, 0.0, 0.0, 0.0, -0.2], [0.0, -0.4, 0.0, 0.0, 0.0, 0.9]];
    let exact = energy(&bar, &motion);
    for matrix in [
        GeneralMatrix::Flexibility(z.clone()),
        GeneralMatrix::Stiffness(z.clone().try_inverse().unwrap()),
    ] {
        let mut model = Model {
            nodes: bar.nodes.clone(),
            general: vec![general(matrix)],
            ..Model::default()
        };
        assert!(relative(energy(&model, &motion), exact) < 1e-9);
        model.general[0].s = None;
        assert!(matches!(model.assemble(), Err(ModelError::BadValue { .. })));
    }
    let singular = GeneralMatrix::Flexibility(DMatrix::from_row_slice(2, 2, &[1.0, 2.0, 2.0, 4.0]));
    let model = Model {
        nodes: bar.nodes.clone(),
        general: vec![general(singular)],
        ..Model::default()
    };
    assert!(matches!(model.assemble(), Err(ModelError::BadValue { .. })));
}

#[test]
fn static_reduction_is_exact_when_only_the_analysis_set_has_mass() {
    let section = ShellSection::thin_plate(1, Material::isotropic(7.0e10, 0.3, 0.0), 2e-3);
    let mut model = rectangle((1.0, 1.0), (6, 6), Cells::Quads, section, |x, y| {
        Vector3::new(x, y, 0.0)
    });
    model.supports = nodes_where(&model, |p| p.x < 1e-9)
        .into_iter()
        .map(|n| (n, DofSet::ALL))
        .collect();
    let heavy = [12_u32, 28, 49, 45];
    for node in heavy {
        let mut mass = Matrix6::zeros();
        mass[(2, 2)] = 0.5 + f64::from(node) / 50.0;
        model.masses.push(NodeMass::Matrix {
            id: node,
            node,
            mass,
            axes: Matrix3::identity(),
        });
    }
    let full = modes(&model, 4);
    model.analysis_set = heavy.iter().map(|&n| (n, DofSet::from(Dof::T3))).collect();
    let system = model.assemble().unwrap();
    assert_eq!(system.analysis_size(), 4);
    let reduced = system.modes(&ModesRequest::lowest(4)).unwrap();
    for m in 0..4 {
        assert!(relative(reduced.omega_rad_s[m], full.omega_rad_s[m]) < 1e-8);
        // The omitted motion follows statically.
        for (a, b) in reduced.shapes[m].iter().flatten().zip(full.shapes[m].iter().flatten()) {
            assert!((a - b).abs() < 1e-6 * full.shapes[m][48][2].abs().max(1.0));
        }
    }
}

#[test]
fn static_reduction_of_mass_bounds_frequencies_from_above() {
    let mut model = straight_bar(1.0, 12, steel_bar());
    model.settings.mass = MassForm::Consistent;
    model.supports = vec![(1, DofSet::ALL)];
    let full = modes(&model, 3).omega_rad_s;
    model.analysis_set = [4, 7, 10, 13]
        .iter()
        .map(|&n| (n, DofSet::parse("23").unwrap()))
        .collect();
    let reduced = modes(&model, 3).omega_rad_s;
    for (r, f) in reduced.iter().zip(&full) {
        assert!(*r >= f * (1.0 - 1e-9) && relative(*r, *f) < 1e-2, "{r} {f}");
    }
}

#[test]
fn direct_terms_and_wtmass_scale_as_they_should() {
    let mut model = chain(1);
    model.settings.mass_scale = 4.0;
    assert!(relative(modes(&model, 1).omega_rad_s[0], 10.0) < 1e-12);
    let here = NodeDof::new(1, Dof::T1);
    model.direct_stiffness.push(DirectTerm {
        row: here,
        column: here,
        value: 120.0,
    });
    assert!(relative(modes(&model, 1).omega_rad_s[0], 20.0) < 1e-12);
    // Direct mass is not scaled.
    model.direct_mass.push(DirectTerm {
        row: here,
        column: here,
        value: 1.2,
    });
    assert!(relative(modes(&model, 1).omega_rad_s[0], 10.0) < 1e-12);
}

// ---------------------------------------------------------------- what is wrong is said

#[test]
fn a_mechanism_is_named() {
    // Two bars joined by a pin at node 2 that nothing holds: the joint turns freely about z.
    let mut model = straight_bar(2.0, 2, steel_bar());
    model.bars[0].pins[1] = DofSet::parse("6").unwrap();
    model.supports = vec![(1, DofSet::ALL)];
    let error = model
        .assemble()
        .unwrap()
        .displacements(&[(NodeDof::new(3, Dof::T2), 1.0)])
        .unwrap_err();
    assert!(matches!(error, ModelError::Mechanism { node: 2 | 3, .. }), "{error}");
    // Without mass it is a mechanism for the modes too.
    model.bar_sections[0].density = 0.0;
    model.scalar_masses.push(ScalarElement {
        id: 1,
        value: 1.0,
        a: NodeDof::new(1, Dof::T1),
        b: None,
    });
    model.supports = vec![(1, DofSet::parse("23456").unwrap())];
    assert!(model.assemble().unwrap().modes(&ModesRequest::lowest(1)).is_err());
}

#[test]
fn wrong_constraints_name_node_and_degree_of_freedom() {
    let base = straight_bar(1.0, 3, steel_bar());
    let with = |change: &dyn Fn(&mut Model)| {
        let mut model = base.clone();
        change(&mut model);
        model.assemble().unwrap_err().to_string()
    };
    let text = with(&|m| {
        m.rigid.push(RigidElement::rbe2(5, 1, DofSet::ALL, &[2]));
        m.rigid.push(RigidElement::rbe2(6, 3, DofSet::ALL, &[2]));
    });
    assert!(
        text.contains("node 2 T1") && text.contains("rigid element 5") && text.contains("rigid element 6"),
        "{text}"
    );
    let text = with(&|m| {
        m.rigid.push(RigidElement::rbe2(5, 1, DofSet::ALL, &[2]));
        m.rigid.push(RigidElement::rbe2(6, 2, DofSet::ALL, &[1]));
    });
    assert!(text.contains("leads back to itself"), "{text}");
    let text = with(&|m| {
        m.rigid.push(RigidElement::rbe2(5, 1, DofSet::ALL, &[2]));
        m.supports.push((2, DofSet::from(Dof::R2)));
    });
    assert!(text.contains("node 2 R2") && text.contains("rigid element 5"), "{text}");
    let text = with(&|m| m.bars[1].nodes[0] = 77);
    assert!(text.contains("bar 2") && text.contains("node 77"), "{text}");
    let text = with(&|m| m.nodes[1].id = 1);
    assert!(text.contains("node 1") && text.contains("twice"), "{text}");
}

#[test]
fn bad_elements_are_refused_by_number() {
    let section = ShellSection::shell(1, Material::isotropic(7.0e10, 0.3, 2700.0), 0.01);
    let base = rectangle((1.0, 1.0), (2, 2), Cells::Quads, section, |x, y| {
        Vector3::new(x, y, 0.0)
    });
    let with = |change: &dyn Fn(&mut Model)| {
        let mut model = base.clone();
        change(&mut model);
        model.assemble().unwrap_err().to_string()
    };
    let crossed = with(&|m| m.shells[2].nodes = ShellNodes::Quad([4, 8, 5, 7]));
    assert!(crossed.contains("shell 3"), "{crossed}");
    let flat = with(&|m| m.nodes.iter_mut().for_each(|n| n.position.y = 0.0));
    assert!(flat.contains("shell 1") && flat.contains("no area"), "{flat}");
    let warped = with(&|m| m.nodes[8].position.z = 1.0);
    assert!(warped.contains("shell 4") && warped.contains("warped"), "{warped}");
    let negative = with(&|m| m.shells[1].thickness = ShellThickness::Uniform(-1.0));
    assert!(negative.contains("shell 2"), "{negative}");
    // A reversed element is sound by itself; the quality report tells it from its neighbours.
    let mut model = base.clone();
    model.shells[0].nodes = ShellNodes::Quad([1, 4, 5, 2]);
    let quality = model.shell_quality().unwrap();
    assert!(quality[0].flipped && quality[1].flipped && !quality[3].flipped);
    assert!(
        base.shell_quality()
            .unwrap()
            .iter()
            .all(|q| !q.flipped && (q.aspect - 1.0).abs() < 1e-12)
    );
}

#[test]
fn a_scalar_point_has_one_degree_of_freedom_and_no_place() {
    let mut model = chain(2);
    model.springs[1].a.dof = Dof::T3;
    assert!(matches!(model.assemble(), Err(ModelError::ScalarPoint { node: 2, .. })));
    let mut model = straight_bar(1.0, 2, steel_bar());
    model.nodes.push(Node::scalar(9));
    model.bars[0].nodes[1] = 9;
    assert!(matches!(model.assemble(), Err(ModelError::ScalarPoint { node: 9, .. })));
}

#[test]
fn an_average_can_make_others_dependent() {
    // UM: the reference stays free and carries a spring; a node of the average follows instead.
    let build = |dependent: Vec<(u32, DofSet)>| {
        let mut model = Model::default();
        for (id, x) in [(1, 0.0), (2, 1.0), (3, 0.4)] {
            model.nodes.push(Node::grid(id, x, 0.0, 0.0));
            let at = NodeDof::new(id, Dof::T3);
            model.springs.push(ScalarElement {
                id,
                value: 10.0 * f64::from(id),
                a: at,
                b: None,
            });
            model.supports.push((id, DofSet::parse("12456").unwrap()));
        }
        model.averages.push(AverageElement {
            id: 1,
            reference: (3, DofSet::from(Dof::T3)),
            terms: vec![
                (1.0, DofSet::from(Dof::T3), vec![1]),
                (3.0, DofSet::from(Dof::T3), vec![2]),
            ],
            dependent,
        });
        model
            .assemble()
            .unwrap()
            .displacements(&[(NodeDof::new(3, Dof::T3), 7.0)])
            .unwrap()
    };
    let (usual, turned) = (build(Vec::new()), build(vec![(2, DofSet::from(Dof::T3))]));
    for (a, b) in usual.iter().zip(&turned) {
        assert!((a[2] - b[2]).abs() < 1e-12, "{usual:?} {turned:?}");
    }
    // The heave of a rigid rod through both nodes at the reference: 0.6 u1 + 0.4 u2.
    assert!((usual[2][2] - 0.6 * usual[0][2] - 0.4 * usual[1][2]).abs() < 1e-12);
}

#[test]
fn a_plate_wing_has_the_volume_of_its_section_and_only_the_clamps_asked_for() {
    let half = [[0.0, 0.0], [0.3, 0.06], [1.0, 0.0]];
    let mut wing = PlateWing {
        planform: Planform {
            root_leading: Vector3::zeros(),
            root_trailing: Vector3::new(1.0, 0.0, 0.0),
            tip_leading: Vector3::new(0.8, 2.0, 0.0),
            tip_trailing: Vector3::new(1.2, 2.0, 0.0),
        },
        chordwise_nodes: 11,
        spanwise_nodes: 5,
        section: Ordinates::symmetric(&half).unwrap(),
        rule: ThicknessRule::ExactSection,
        material: Material::isotropic(1e9, 0.3, 100.0),
        axis: Vector3::y(),
        root: RootClamp::Nodes(vec![3, 4, 5]),
    };
    let model = wing.model().unwrap();
    assert_eq!(model.supports.iter().map(|s| s.0).collect::<Vec<_>>(), [3, 4, 5]);
    // Area of the section 0.06 chord^2; integral of chord^2 along the span 2 (1 + 0.4 + 0.16) / 3. The kink of the
    // section is a node, so two points a side integrate exactly.
    let volume = 0.06 * 2.0 * (1.0 + 0.4 + 0.16) / 3.0;
    assert!(relative(model.assemble().unwrap().mass_properties().mass, 100.0 * volume) < 1e-12);
    wing.root = RootClamp::Nodes(vec![12]);
    assert!(matches!(wing.model(), Err(WingError::RootNode { node: 12, last: 11 })));
    wing.spanwise_nodes = 1;
    assert!(matches!(wing.model(), Err(WingError::TooFewNodes { .. })));
    assert!(matches!(
        Ordinates::symmetric(&[[0.0, 0.1], [0.5, 0.1], [0.5, 0.1]]),
        Err(WingError::Ordinates { point: 3, .. })
    ));
}

#[test]
fn frequencies_in_hertz_are_radians_over_two_pi() {
    let found = modes(&chain(1), 1);
    assert!(relative(found.freq_hz(0) * TAU, 20.0) < 1e-12);
}
