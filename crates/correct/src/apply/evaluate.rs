//! Pressures and generalized forces of all methods at one reduced frequency.

use super::weights::{Moved, Weights};
use super::{AtRecording, Corrected, Method};
use crate::CorrectError;
use crate::weight::garner;
use crate::weight::schedule::Place;
use dip_dlm::aic::{AicError, FactoredDownwash};
use dip_dlm::gaf::{Interpolation, KInterpolant, generalized_force};
use dip_dlm::motion::BoxMotion;
use dip_dlm::{ComplexMatrix, c64};

/// Results of all methods at one k.
pub(super) struct AtK {
    pub(super) linear: ComplexMatrix,
    /// Q, and the error of the main reference motion where it was recorded.
    pub(super) methods: Vec<(ComplexMatrix, Option<f64>)>,
}

impl Weights<'_> {
    pub(super) fn check(&self, method: Method, modes: &BoxMotion) -> Result<(), CorrectError> {
        if method == Method::Full {
            let missing: Vec<String> = (0..modes.n_modes)
                .filter(|mode| self.series_of_mode(*mode).is_none())
                .map(|mode| (mode + 1).to_string())
                .collect();
            if !missing.is_empty() {
                return Err(CorrectError::Method {
                    method: method.name(),
                    reason: format!(
                        "recordings of every mode are needed, and mode {} has none: record it (`pmb pitch` with a mode as motion), or leave this method out",
                        missing.join(", ")
                    ),
                });
            }
        }
        Ok(())
    }

    fn series_of_mode(&self, mode: usize) -> Option<&Moved<'_>> {
        self.all
            .iter()
            .find(|m| self.references.mode_of.get(m.coordinate).copied().flatten() == Some(mode))
    }

    pub(super) fn place(&self, method: Method, k: f64) -> Place {
        match method {
            _ if method.is_steady() => Place::Recorded,
            Method::Mode | Method::Full => {
                // The least informed of the recorded motions.
                let rank = |p: Place| match p {
                    Place::Recorded => 0,
                    Place::Below => 1,
                    Place::Blended => 2,
                    Place::Linear => 3,
                };
                let places = self.all.iter().map(|m| m.series.schedule.place(k));
                places.max_by_key(|p| rank(*p)).unwrap_or(Place::Linear)
            }
            _ => self.main.schedule.place(k),
        }
    }

    /// Pressures by every method at one k; `motion` has the modes first and the reference motions behind them.
    pub(super) fn evaluate(
        &self,
        factored: &FactoredDownwash,
        modes: &BoxMotion,
        motion: &BoxMotion,
        methods: &[Method],
    ) -> Result<AtK, AicError> {
        let k = factored.k();
        let wave_number = k / self.aerodynamics.semichord();
        let wash = motion.downwash(wave_number);
        let mut linear = wash.clone();
        factored.solve_in_place(&mut linear)?;
        let reference = wash.column(modes.n_modes + self.references.main).to_vec();
        let share: Vec<c64> = (0..wash.columns())
            .map(|j| self.share(&reference, wash.column(j)))
            .collect();
        let mut results = Vec::with_capacity(methods.len());
        for method in methods {
            let pressures = match method {
                Method::Downwash => self.by_downwash(factored, &wash, &share, |i| {
                    (
                        self.mix(k, 1.0, |r| r.weight.ratio[i]),
                        self.mix(k, 0.0, |r| r.weight.remainder[i]),
                    )
                })?,
                Method::DownwashSteady => self.by_downwash(factored, &wash, &share, |i| {
                    (self.steady_weight.ratio[i], self.steady_weight.remainder[i])
                })?,
                Method::PressureRatio => weighted(&linear, &share, |i| {
                    (
                        self.mix(k, 1.0, |r| r.pressure.ratio[i]),
                        self.mix(k, 0.0, |r| r.pressure.remainder[i]),
                    )
                }),
                Method::Force => weighted(&linear, &share, |i| {
                    (
                        self.mix(k, 1.0, |r| r.force.ratio[i]),
                        self.mix(k, 0.0, |r| r.force.remainder[i]),
                    )
                }),
                Method::ForceSteady => weighted(&linear, &share, |i| {
                    (self.steady_force.ratio[i], self.steady_force.remainder[i])
                }),
                Method::Additive => {
                    let extra = weighted(&wash, &share, |i| {
                        (
                            self.mix(k, 0.0, |r| r.gain.ratio[i]),
                            self.mix(k, 0.0, |r| r.gain.remainder[i]),
                        )
                    });
                    ComplexMatrix::from_fn(linear.rows(), linear.columns(), |i, j| linear[(i, j)] + extra[(i, j)])
                }
                Method::Mode | Method::Full => self.by_modes(k, &wash, &linear, modes.n_modes),
                Method::DauGarner => self.by_garner(wave_number, &linear, &share),
            };
            let q = generalized_force(self.aerodynamics, modes, &part(&pressures, modes.n_modes))?;
            results.push((
                q,
                self.reproduction(*method, k, pressures.column(modes.n_modes + self.references.main)),
            ));
        }
        Ok(AtK {
            linear: generalized_force(self.aerodynamics, modes, &part(&linear, modes.n_modes))?,
            methods: results,
        })
    }

    /// Share of the reference downwash in another one: least squares over the planform.
    fn share(&self, reference: &[c64], wash: &[c64]) -> c64 {
        let mut sums = (c64::new(0.0, 0.0), 0.0);
        for ((r, w), a) in reference.iter().zip(wash).zip(&self.area) {
            sums.0 += r.conj() * w * *a;
            sums.1 += r.norm_sqr() * a;
        }
        if sums.1 > 0.0 { sums.0 / sums.1 } else { sums.0 }
    }

    fn mix(&self, k: f64, base: f64, value: impl Fn(&AtRecording) -> c64) -> c64 {
        self.main
            .schedule
            .mix(k, c64::new(base, 0.0), |record| value(&self.recordings[record]))
    }

    fn by_downwash(
        &self,
        factored: &FactoredDownwash,
        wash: &ComplexMatrix,
        share: &[c64],
        weight: impl Fn(usize) -> (c64, c64),
    ) -> Result<ComplexMatrix, AicError> {
        let mut columns = weighted(wash, share, weight);
        factored.solve_in_place(&mut columns)?;
        Ok(columns)
    }

    /// AIC w + (P_r - AIC W_r) W_r^+ w over all recorded motions. A column that is a recorded motion is taken as that motion.
    fn by_modes(&self, k: f64, wash: &ComplexMatrix, linear: &ComplexMatrix, n_modes: usize) -> ComplexMatrix {
        let n = wash.rows();
        let columns: Vec<&[c64]> = self.all.iter().map(|m| wash.column(n_modes + m.coordinate)).collect();
        let zero = c64::new(0.0, 0.0);
        let away: Vec<Vec<c64>> = self
            .all
            .iter()
            .map(|m| {
                (0..n)
                    .map(|i| m.series.schedule.mix(k, zero, |r| m.away[r][i]))
                    .collect()
            })
            .collect();
        let mut result = linear.clone();
        for j in 0..wash.columns() {
            let own = self.all.iter().position(|m| {
                let c = m.coordinate;
                j == n_modes + c || (j < n_modes && self.references.mode_of.get(c).copied().flatten() == Some(j))
            });
            let parts = match own {
                Some(own) => (0..columns.len())
                    .map(|c| c64::new(f64::from(u8::from(c == own)), 0.0))
                    .collect(),
                None => project(&columns, wash.column(j), &self.area),
            };
            for (part, away) in parts.iter().zip(&away) {
                for (i, a) in away.iter().enumerate() {
                    result[(i, j)] += a * part;
                }
            }
        }
        result
    }

    fn by_garner(&self, wave_number: f64, linear: &ComplexMatrix, share: &[c64]) -> ComplexMatrix {
        let lattice = self.aerodynamics.lattice();
        let n = linear.rows();
        let mut result = linear.clone();
        for (j, share) in share.iter().enumerate() {
            let mut column: Vec<c64> = linear.column(j).to_vec();
            garner::velocity_of(lattice, wave_number, &mut column);
            for (i, u) in column.iter_mut().enumerate() {
                *u = *u * self.steady_pressure.ratio[i] + self.steady_pressure.remainder[i] * share * 0.5;
            }
            garner::pressure_of(lattice, wave_number, &mut column);
            result.data_mut()[j * n..(j + 1) * n].copy_from_slice(&column);
        }
        result
    }

    /// Error of the main reference motion at a recorded k, for methods that promise it.
    fn reproduction(&self, method: Method, k: f64, pressures: &[c64]) -> Option<f64> {
        let at = self
            .recordings
            .iter()
            .position(|r| (r.k - k).abs() <= 1e-12 * r.k.max(1e-300))?;
        let recorded = &self.recordings[at];
        if method.is_steady() && (at != self.steady || recorded.k != 0.0) {
            return None;
        }
        let difference: Vec<c64> = pressures.iter().zip(&recorded.recorded).map(|(a, b)| a - b).collect();
        let norm = |list: &[c64]| list.iter().map(c64::norm_sqr).sum::<f64>().sqrt();
        let loads = |list: &[c64]| {
            let loads = crate::sample::strip_loads_of_boxes(self.aerodynamics.lattice(), list);
            norm(&loads.lift_m2) + norm(&loads.moment_m3) / self.aerodynamics.semichord()
        };
        let size = norm(&recorded.recorded);
        if size == 0.0 {
            return Some(norm(&difference));
        }
        Some(match method {
            Method::Force | Method::ForceSteady => loads(&difference) / loads(&recorded.recorded),
            _ => norm(&difference) / size,
        })
    }

    /// Q from the recordings of every mode alone: splined over the recorded k, blended into the lattice beyond them.
    pub(super) fn full(
        &self,
        modes: &BoxMotion,
        k: &[f64],
        linear: &[ComplexMatrix],
        corrected: &mut Corrected,
    ) -> Result<(), CorrectError> {
        for mode in 0..modes.n_modes {
            let Some(Moved { series, .. }) = self.series_of_mode(mode) else {
                continue;
            };
            let pressures = series
                .records
                .iter()
                .map(|r| ComplexMatrix::from_fn(r.dcp.len(), 1, |i, _| r.dcp[i]));
            let columns = pressures
                .map(|p| generalized_force(self.aerodynamics, modes, &p))
                .collect::<Result<Vec<_>, _>>()?;
            let spline = KInterpolant::new(series.schedule.recorded(), &columns, Interpolation::Spline)?;
            let last = series.schedule.recorded().last().copied().unwrap_or(0.0);
            let at_last = k.iter().position(|k| (k - last).abs() <= 1e-9 * last);
            for (i, &k) in k.iter().enumerate() {
                let strength = series.schedule.strength(k);
                let column = if k <= last * (1.0 + 1e-12) {
                    spline.at(k.min(last))?
                } else {
                    let end = &columns[columns.len() - 1];
                    ComplexMatrix::from_fn(modes.n_modes, 1, |row, _| {
                        let base = at_last.map_or(end[(row, 0)], |at| linear[at][(row, mode)]);
                        linear[i][(row, mode)] + (end[(row, 0)] - base) * strength
                    })
                };
                for row in 0..modes.n_modes {
                    corrected.q[i][(row, mode)] = column[(row, 0)];
                }
            }
        }
        Ok(())
    }
}

/// The first columns of a matrix.
fn part(matrix: &ComplexMatrix, columns: usize) -> ComplexMatrix {
    ComplexMatrix::from_fn(matrix.rows(), columns, |i, j| matrix[(i, j)])
}

/// ratio x value + remainder x share, `weight(box)` giving (ratio, remainder) and `share[column]`.
fn weighted(values: &ComplexMatrix, share: &[c64], weight: impl Fn(usize) -> (c64, c64)) -> ComplexMatrix {
    let weights: Vec<(c64, c64)> = (0..values.rows()).map(weight).collect();
    ComplexMatrix::from_fn(values.rows(), values.columns(), |i, j| {
        values[(i, j)] * weights[i].0 + weights[i].1 * share[j]
    })
}

/// Coordinates of `wash` in `columns` by least squares over the planform (modified Gram-Schmidt). A column that the ones before
/// it hold already gets none.
fn project(columns: &[&[c64]], wash: &[c64], area: &[f64]) -> Vec<c64> {
    let dot = |a: &[c64], b: &[c64]| -> c64 { a.iter().zip(b).zip(area).map(|((x, y), w)| x.conj() * y * *w).sum() };
    let zero = c64::new(0.0, 0.0);
    let mut basis: Vec<Vec<c64>> = Vec::new();
    // R [column][row] of columns = basis R.
    let mut triangle: Vec<Vec<c64>> = Vec::new();
    let mut left = wash.to_vec();
    let mut coordinates = Vec::new();
    for column in columns {
        let size = dot(column, column).re.sqrt();
        let mut v = column.to_vec();
        let mut above = vec![zero; basis.len()];
        for _ in 0..2 {
            for (e, sum) in basis.iter().zip(&mut above) {
                let c = dot(e, &v);
                *sum += c;
                v.iter_mut().zip(e).for_each(|(x, y)| *x -= c * y);
            }
        }
        let norm = dot(&v, &v).re.sqrt();
        if norm > 1e-8 * size {
            v.iter_mut().for_each(|x| *x /= norm);
            above.push(c64::new(norm, 0.0));
        } else {
            v.fill(zero);
            above.push(zero);
        }
        let c = dot(&v, &left);
        left.iter_mut().zip(&v).for_each(|(x, y)| *x -= c * y);
        coordinates.push(c);
        basis.push(v);
        triangle.push(above);
    }
    for j in (0..columns.len()).rev() {
        if triangle[j][j] == zero {
            coordinates[j] = zero;
            continue;
        }
        let x = coordinates[j] / triangle[j][j];
        coordinates[j] = x;
        for (i, r) in triangle[j][..j].iter().enumerate() {
            coordinates[i] -= r * x;
        }
    }
    coordinates
}
