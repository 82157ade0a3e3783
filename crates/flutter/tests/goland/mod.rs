//! The Goland wing: a uniform cantilever with strip aerodynamics, by assumed modes of bending and torsion.

use std::f64::consts::PI;

use dip_flutter::theodorsen::SectionForces;
use dip_flutter::{GeneralizedForces, KDomain, Structure};
use faer::{Mat, MatMut, c64};

/// Intervals of the composite Simpson rule along the span.
const INTERVALS: usize = 400;

/// Data of the wing.
#[derive(Debug, Clone)]
pub struct Wing {
    pub span_m: f64,
    pub chord_m: f64,
    pub elastic_axis_frac: f64,
    pub cg_frac: f64,
    pub bending_n_m2: f64,
    pub torsion_n_m2: f64,
    pub mass_kg_m: f64,
    pub inertia_kg_m: f64,
    pub density_kg_m3: f64,
}

impl Wing {
    pub fn read(text: &str) -> Self {
        let json: serde_json::Value = serde_json::from_str(text).unwrap();
        let get = |key: &str| json[key].as_f64().unwrap();
        Self {
            span_m: get("span_m"),
            chord_m: get("chord_m"),
            elastic_axis_frac: get("elastic_axis_frac"),
            cg_frac: get("cg_frac"),
            bending_n_m2: get("EI_Nm2"),
            torsion_n_m2: get("GJ_Nm2"),
            mass_kg_m: get("m_kg_m"),
            inertia_kg_m: get("I_ea_kgm"),
            density_kg_m3: get("rho"),
        }
    }

    pub fn semichord_m(&self) -> f64 {
        0.5 * self.chord_m
    }

    /// Structure and forces with `bending` and `torsion` assumed modes; coordinates h/b positive down first, then alpha.
    pub fn model(&self, bending: usize, torsion: usize) -> (Structure, StripForces) {
        let b = self.semichord_m();
        let n = bending + torsion;
        let h = INTERVALS as f64;
        let weights: Vec<f64> = (0..=INTERVALS)
            .map(|j| {
                let simpson = if j == 0 || j == INTERVALS {
                    1.0
                } else if j % 2 == 1 {
                    4.0
                } else {
                    2.0
                };
                simpson * self.span_m / (3.0 * h)
            })
            .collect();
        // shape[mode][station]: value; slope2: what the stiffness needs.
        let mut shapes = Vec::new();
        let mut strains = Vec::new();
        for mode in 0..n {
            let at = |f: &dyn Fn(f64) -> f64| (0..=INTERVALS).map(|j| f(j as f64 / h)).collect::<Vec<f64>>();
            if mode < bending {
                let root = cantilever_root(mode);
                let sigma = (root.sinh() - root.sin()) / (root.cosh() + root.cos());
                shapes.push(at(&|y| {
                    let z = root * y;
                    z.cosh() - z.cos() - sigma * (z.sinh() - z.sin())
                }));
                let scale = (root / self.span_m).powi(2);
                strains.push(at(&|y| {
                    let z = root * y;
                    scale * (z.cosh() + z.cos() - sigma * (z.sinh() + z.sin()))
                }));
            } else {
                let wave = ((mode - bending) as f64 + 0.5) * PI;
                shapes.push(at(&|y| (wave * y).sin()));
                strains.push(at(&|y| wave / self.span_m * (wave * y).cos()));
            }
        }
        let integral = |f: &[Vec<f64>], i: usize, j: usize| -> f64 {
            weights.iter().enumerate().map(|(s, w)| w * f[i][s] * f[j][s]).sum()
        };
        let offset = (self.cg_frac - self.elastic_axis_frac) * self.chord_m;
        let kind = |i: usize| i >= bending;
        let mass = Mat::from_fn(n, n, |i, j| {
            let density = match (kind(i), kind(j)) {
                (false, false) => self.mass_kg_m * b * b,
                (true, true) => self.inertia_kg_m,
                _ => self.mass_kg_m * offset * b,
            };
            density * integral(&shapes, i, j)
        });
        let stiffness = Mat::from_fn(n, n, |i, j| match (kind(i), kind(j)) {
            (false, false) => self.bending_n_m2 * b * b * integral(&strains, i, j),
            (true, true) => self.torsion_n_m2 * integral(&strains, i, j),
            _ => 0.0,
        });
        let overlap = Mat::from_fn(n, n, |i, j| integral(&shapes, i, j));
        let section = SectionForces {
            semichord_m: b,
            a: 2.0 * self.elastic_axis_frac - 1.0,
        };
        (
            Structure::new(mass, stiffness).unwrap(),
            StripForces {
                bending,
                overlap,
                section,
            },
        )
    }
}

/// Root of cos z cosh z = -1.
fn cantilever_root(mode: usize) -> f64 {
    let mut z = if mode == 0 { 1.875 } else { (mode as f64 + 0.5) * PI };
    for _ in 0..20 {
        // cos z + 1 / cosh z keeps its size for large z.
        let (f, slope) = (z.cos() + 1.0 / z.cosh(), -z.sin() - z.tanh() / z.cosh());
        z -= f / slope;
    }
    z
}

/// Theodorsen's section at every station of the span.
pub struct StripForces {
    bending: usize,
    overlap: Mat<f64>,
    section: SectionForces,
}

impl GeneralizedForces for StripForces {
    fn modes(&self) -> usize {
        self.overlap.nrows()
    }

    fn domain(&self) -> KDomain {
        self.section.domain()
    }

    fn q(&self, k: f64, mut q: MatMut<'_, c64>) -> dip_flutter::Result<()> {
        let local = self.section.q_laplace(c64::new(0.0, k));
        for j in 0..self.modes() {
            for i in 0..self.modes() {
                let entry = local[usize::from(i >= self.bending)][usize::from(j >= self.bending)];
                q[(i, j)] = entry * self.overlap[(i, j)];
            }
        }
        Ok(())
    }
}
