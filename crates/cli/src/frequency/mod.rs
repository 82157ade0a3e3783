//! The frequency-domain chain of one case: modes, splines, lattice, generalized forces, flutter.
//!
//! `dlm flutter` runs it for a case, `dip` for every curve of a study.

mod check;

pub use check::reference;

use crate::assemble::{lattice as make_lattice, modes as make_modes};
use crate::exit::Stop;
use crate::progress::{Seconds, Timer, check_interrupt};
use crate::stamp::Fingerprint;
use dip_case::file::{FlutterFile, FlutterTable, Method, Points, Search};
use dip_case::wing::Wing;
use dip_case::{Document, atmosphere};
use dip_dlm::aic::Aerodynamics;
use dip_dlm::gaf::{self, PointRule};
use dip_dlm::lattice::{Finding, Severity};
use dip_dlm::motion::BoxMotion;
use dip_dlm::store::StoredAic;
use dip_flutter as fl;
use dip_modal::Modes;
use faer::Mat;
use serde::{Deserialize, Serialize};

/// A case, read and checked.
#[derive(Debug)]
pub struct FlutterCase {
    /// The file.
    pub document: Document,
    /// Its content.
    pub file: FlutterFile,
    /// The wing that it names.
    pub wing: Wing,
    /// Reference quantities of the speed index.
    pub reference: fl::SpeedIndexReference,
    /// Everything that the results depend on.
    pub fingerprint: Fingerprint,
}

/// One flutter point, or the statement that there is none in the range.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FlutterRow {
    /// Mach number.
    pub mach: f64,
    /// Density, kg/m^3.
    pub density_kg_m3: f64,
    /// Method.
    pub method: Method,
    /// Flutter speed, m/s; none where the range has no flutter.
    pub flutter_speed_m_s: Option<f64>,
    /// Flutter frequency, Hz.
    pub flutter_frequency_hz: Option<f64>,
    /// U / (b omega_alpha sqrt(mu)).
    pub flutter_speed_index: Option<f64>,
    /// omega / omega_alpha.
    pub frequency_ratio: Option<f64>,
    /// Reduced frequency omega b / U at flutter.
    pub reduced_frequency: Option<f64>,
    /// Mode that flutters, from 1.
    pub mode: Option<usize>,
    /// Speed of divergence, m/s, where the range has one.
    pub divergence_speed_m_s: Option<f64>,
    /// Altitude of a matched point, m.
    #[serde(skip_serializing_if = "Option::is_none", default)]
    pub altitude_m: Option<f64>,
    /// omega_alpha of the index, rad/s.
    pub omega_alpha_rad_s: f64,
    /// Mass of the mass ratio, kg.
    pub mass_kg: f64,
    /// Wall seconds of this Mach number (generalized forces) and method (flutter solution).
    pub time_s: f64,
    /// CPU seconds of the same.
    pub cpu_s: f64,
    /// What to look at.
    pub warnings: Vec<String>,
}

/// The curves of one method at one Mach number, and its flutter point.
#[derive(Debug, Clone)]
pub struct MachSolution {
    /// The point.
    pub row: FlutterRow,
    /// The solution.
    pub solution: fl::FlutterSolution,
}

/// All that a case gives.
#[derive(Debug)]
pub struct FrequencyResults {
    /// Modes of the structure.
    pub modes: Modes,
    /// Elements of the structure, for pictures.
    pub elements: Vec<Vec<usize>>,
    /// Mass of the structural model, kg, where it is known.
    pub structure_mass_kg: Option<f64>,
    /// Aerodynamics with its lattice.
    pub aerodynamics: Aerodynamics,
    /// Solutions `[Mach number x method]`.
    pub solutions: Vec<MachSolution>,
    /// Findings about the lattice.
    pub findings: Vec<Finding>,
    /// Seconds for each stage.
    pub stages: Vec<(String, Seconds)>,
}

impl FlutterCase {
    /// Reads and checks a case and the wing that it names.
    ///
    /// # Errors
    /// What is wrong in the files.
    pub fn read(document: Document) -> Result<Self, Stop> {
        let file: FlutterFile = document.load()?;
        let wing_document = Document::read(&document.path(&file.wing), &[])?;
        let wing = Wing::read(&wing_document)?;
        make_lattice::check(&document, &file.lattice)?;
        let reference = reference(&document, &file.reference, Some(&wing))?;
        if let Some(table) = &file.flutter {
            check::flutter(&document, table, file.lattice.mach.len())?;
        }
        let mut fingerprint = Fingerprint::new();
        fingerprint.document(&document).document(&wing_document);
        for surface in &file.lattice.surface {
            fingerprint.file(document.path(&surface.wing));
        }
        if let Some(modes) = &file.modes {
            make_modes::fingerprint(&document, modes, &mut fingerprint);
        }
        Ok(Self {
            document,
            file,
            wing,
            reference,
            fingerprint,
        })
    }

    /// The lattice with its kernel.
    ///
    /// # Errors
    /// What the lattice refuses.
    pub fn aerodynamics(&self) -> Result<Aerodynamics, Stop> {
        let lattice = make_lattice::lattice(&self.document, &self.wing, &self.file.lattice)?;
        let kernel = make_lattice::kernel(&self.file.lattice);
        Aerodynamics::new(lattice, kernel, self.reference.semichord_m).map_err(|e| {
            self.document
                .error("lattice", e.to_string(), "check the wing file and [lattice]")
                .into()
        })
    }

    /// Findings about the lattice at the case's highest Mach number and reduced frequency.
    ///
    /// # Errors
    /// A finding that makes the equations singular.
    pub fn findings(&self, aerodynamics: &Aerodynamics) -> Result<Vec<Finding>, Stop> {
        let table = &self.file.lattice;
        let k_max = table.reduced_frequencies.iter().copied().fold(0.0, f64::max);
        let mach = table.mach.iter().copied().fold(0.0, f64::max);
        let findings = aerodynamics
            .lattice()
            .check(aerodynamics.kernel(), mach, k_max, self.reference.semichord_m);
        match findings.iter().find(|f| f.severity == Severity::Error) {
            Some(f) => Err(self
                .document
                .error("lattice", f.message.clone(), "change the wing file or the boxes")
                .into()),
            None => Ok(findings),
        }
    }

    /// Reduced frequencies in rising order.
    pub fn reduced_frequencies(&self) -> Vec<f64> {
        let mut k = self.file.lattice.reduced_frequencies.clone();
        k.sort_by(f64::total_cmp);
        k
    }

    /// Generalized forces at one Mach number, from stored influence coefficients where there are some.
    fn forces(
        &self,
        aerodynamics: &Aerodynamics,
        motion: &BoxMotion,
        mach: f64,
        stored: Option<&StoredAic>,
    ) -> Result<gaf::GeneralizedForceTable, Stop> {
        let k = self.reduced_frequencies();
        let failed = |e: &dyn std::fmt::Display| {
            Stop::failed(format!("generalized forces at Mach {mach}: {e}"), "check the lattice")
        };
        let Some(stored) = stored else {
            return gaf::generalized_forces(aerodynamics, motion, &[mach], &k).map_err(|e| failed(&e));
        };
        let mut q = Vec::with_capacity(k.len());
        for &k in &k {
            let aic = stored
                .get(mach, k)
                .map_err(|e| Stop::input(e.to_string(), "make the file anew by `dlm aic --store`"))?;
            let pressures = aic.times(&motion.downwash(k / aerodynamics.semichord()));
            q.push(gaf::generalized_force(aerodynamics, motion, &pressures).map_err(|e| failed(&e))?);
        }
        Ok(gaf::GeneralizedForceTable {
            mach: vec![mach],
            k,
            semichord: aerodynamics.semichord(),
            geometry_hash: aerodynamics.lattice().geometry_hash(),
            kernel: aerodynamics.kernel(),
            q: vec![q],
        })
    }

    /// Runs the chain. `begin` is told what starts; `stored` are influence coefficients to use again.
    ///
    /// # Errors
    /// What is wrong in the files, what a solver refuses, an interrupt.
    pub fn solve(&self, stored: Option<&StoredAic>, mut begin: impl FnMut(&str)) -> Result<FrequencyResults, Stop> {
        let Some(flutter) = &self.file.flutter else {
            return Err(self
                .document
                .error(
                    "",
                    "missing table [flutter]",
                    "add [flutter] with methods and densities",
                )
                .into());
        };
        let mut stages = Vec::new();
        begin("modes");
        let timer = Timer::start();
        let structure = make_modes::modes(&self.document, &self.file)?;
        stages.push(("modes".to_owned(), timer.seconds()));
        check_interrupt("nothing yet")?;

        begin("lattice and splines");
        let timer = Timer::start();
        let aerodynamics = self.aerodynamics()?;
        let findings = self.findings(&aerodynamics)?;
        if let Some(stored) = stored {
            stored.check(&aerodynamics).map_err(|e| {
                Stop::input(
                    e.to_string(),
                    "the stored coefficients are of another lattice: make them anew by `dlm aic --store`",
                )
            })?;
        }
        let (motion, generalized) = self.motion(&aerodynamics, &structure)?;
        stages.push(("lattice and splines".to_owned(), timer.seconds()));

        let k = self.reduced_frequencies();
        let damped = self.structure(flutter, &generalized)?;
        let mut solutions = Vec::new();
        for (i, &mach) in self.file.lattice.mach.iter().enumerate() {
            check_interrupt("nothing yet: the frequency domain is quick to do again")?;
            begin(&format!("generalized forces, Mach {mach}"));
            let timer = Timer::start();
            let table = self.forces(&aerodynamics, &motion, mach, stored)?;
            let aero = timer.seconds();
            stages.push((format!("generalized forces, Mach {mach}"), aero));
            begin(&format!("flutter, Mach {mach}"));
            let timer = Timer::start();
            let q: Vec<Mat<faer::c64>> = table.q[0].iter().map(|m| m.view().to_owned()).collect();
            let tabulated = fl::TabulatedForces::new(&k, &q, fl::Interpolation::EvenCubicSpline).map_err(|e| {
                self.document
                    .error("lattice.reduced_frequencies", e.to_string(), "give more of them")
            })?;
            for &method in &flutter.methods {
                let timer = Timer::start();
                let solution = self.flutter(flutter, method, i, &damped, &tabulated)?;
                let own = timer.seconds();
                let mut row = self.row(flutter, method, i, &solution);
                row.time_s = aero.wall_s + own.wall_s;
                row.cpu_s = aero.cpu_s + own.cpu_s;
                solutions.push(MachSolution { row, solution });
            }
            stages.push((format!("flutter, Mach {mach}"), timer.seconds()));
        }
        Ok(FrequencyResults {
            modes: structure.modes,
            structure_mass_kg: structure.mass_kg,
            elements: structure.elements,
            aerodynamics,
            solutions,
            findings,
            stages,
        })
    }

    /// The rule for slopes and displacements of boxes.
    pub(crate) fn point_rule(&self) -> PointRule {
        match self.file.spline.points {
            Points::Own => PointRule::ControlPoint,
            Points::Nastran => PointRule::MidChord,
        }
    }

    /// Motion of the boxes in every generalized coordinate, structural modes first, then control surfaces that have
    /// inertia; and generalized masses and frequencies.
    pub fn motion(
        &self,
        aerodynamics: &Aerodynamics,
        structure: &make_modes::Structure,
    ) -> Result<(BoxMotion, Generalized), Stop> {
        let lattice = aerodynamics.lattice();
        let rule = self.point_rule();
        let mut motion = make_modes::box_motion(&self.document, &self.file.spline, lattice, rule, &structure.modes)?;
        let mut generalized = Generalized {
            mass: structure.modes.generalized_mass.clone(),
            omega_rad_s: structure.modes.omega_rad_s.clone(),
        };
        for (control, table) in lattice.controls().iter().zip(&self.file.lattice.control_surface) {
            if let (Some(frequency), Some(inertia)) = (table.frequency, table.inertia) {
                motion.push_control(lattice, rule, control);
                generalized.mass.push(inertia.0);
                generalized.omega_rad_s.push(frequency.0);
            }
        }
        Ok((motion, generalized))
    }

    pub(crate) fn structure(&self, table: &FlutterTable, generalized: &Generalized) -> Result<fl::Structure, Stop> {
        let n = generalized.mass.len();
        let diagonal = |f: &dyn Fn(usize) -> f64| Mat::from_fn(n, n, |i, j| if i == j { f(i) } else { 0.0 });
        let mass = diagonal(&|i| generalized.mass[i]);
        let stiffness = diagonal(&|i| generalized.mass[i] * generalized.omega_rad_s[i].powi(2));
        let damping = if let Some(g) = &table.structural_damping_modes {
            fl::StructuralDamping::PerMode(g.clone())
        } else if let Some(pairs) = &table.structural_damping_table {
            fl::StructuralDamping::Table {
                freq_hz: pairs.iter().map(|p| p.0.0 / std::f64::consts::TAU).collect(),
                g: pairs.iter().map(|p| p.1).collect(),
            }
        } else if table.structural_damping == 0.0 {
            fl::StructuralDamping::None
        } else {
            fl::StructuralDamping::Uniform(table.structural_damping)
        };
        fl::Structure::new(mass, stiffness)
            .and_then(|s| s.with_structural_damping(damping, fl::DampingForm::ComplexStiffness))
            .map_err(|e| {
                self.document
                    .error("flutter", e.to_string(), "check modes and structural damping")
                    .into()
            })
    }

    pub(crate) fn flutter(
        &self,
        table: &FlutterTable,
        method: Method,
        i: usize,
        structure: &fl::Structure,
        forces: &fl::TabulatedForces,
    ) -> Result<fl::FlutterSolution, Stop> {
        let mach = self.file.lattice.mach[i];
        let problem = fl::FlutterProblem {
            structure,
            forces,
            semichord_m: self.reference.semichord_m,
            mach,
        };
        let settings = fl::Settings::default();
        let speeds = speeds(table);
        let standard = |h: f64| {
            // The list of altitudes stays inside the standard's range; refinement only goes between its values.
            let air = atmosphere::standard(h).unwrap_or(atmosphere::Air {
                temperature_k: f64::NAN,
                pressure_pa: f64::NAN,
                density_kg_m3: f64::NAN,
                speed_of_sound_m_s: f64::NAN,
            });
            fl::AirState {
                density_kg_m3: air.density_kg_m3,
                sound_speed_m_s: air.speed_of_sound_m_s,
            }
        };
        let altitudes: Vec<f64> = (0..=80).map(|j| 80_000.0 - 1_050.0 * f64::from(j)).collect();
        let sweep = match table.search {
            Search::Speed => fl::Sweep::Speed {
                density_kg_m3: density(table, i, mach)?,
                speeds_m_s: &speeds,
            },
            Search::MatchedPoint => fl::Sweep::Altitude {
                atmosphere: &standard,
                altitudes_m: &altitudes,
            },
        };
        let method = solver(method);
        fl::solve(&problem, method, &sweep, &settings).map_err(|e| {
            Stop::failed(
                format!("{} at Mach {mach}: {e}", method.name()),
                "check the modes, the range of speeds and the reduced frequencies",
            )
        })
    }

    pub(crate) fn row(
        &self,
        table: &FlutterTable,
        method: Method,
        i: usize,
        solution: &fl::FlutterSolution,
    ) -> FlutterRow {
        let mach = self.file.lattice.mach[i];
        let flutter = solution.flutter();
        let mut warnings = Vec::new();
        if let Some(c) = flutter {
            if c.k_range != fl::KRange::Inside {
                warnings.push(format!(
                    "the flutter point's reduced frequency {:.4} lies outside of lattice.reduced_frequencies: add some around it",
                    c.k
                ));
            }
            if c.confidence < 0.5 {
                warnings.push(format!(
                    "the mode that flutters is uncertain (confidence {:.2}): look at the V-g curves",
                    c.confidence
                ));
            }
        }
        for warning in &solution.warnings {
            if let fl::Warning::UnstableAtStart { mode } = warning {
                warnings.push(format!(
                    "mode {mode} is unstable at the lowest speed: lower flutter.speed_min"
                ));
            }
        }
        let rho = flutter
            .map(|c| c.density_kg_m3)
            .or_else(|| density(table, i, mach).ok())
            .unwrap_or(f64::NAN);
        FlutterRow {
            mach,
            density_kg_m3: rho,
            method,
            flutter_speed_m_s: flutter.map(|c| c.speed_m_s),
            flutter_frequency_hz: flutter.map(|c| c.freq_hz),
            flutter_speed_index: flutter.map(|c| self.reference.speed_index(c.speed_m_s, c.density_kg_m3)),
            frequency_ratio: flutter.map(|c| self.reference.frequency_ratio(c.freq_hz)),
            reduced_frequency: flutter.map(|c| c.k),
            mode: flutter.map(|c| c.mode),
            divergence_speed_m_s: solution.divergence().map(|c| c.speed_m_s),
            altitude_m: flutter
                .filter(|_| table.search == Search::MatchedPoint)
                .map(|c| c.parameter),
            omega_alpha_rad_s: self.reference.omega_alpha_rad_s,
            mass_kg: self.reference.mass_kg,
            time_s: 0.0,
            cpu_s: 0.0,
            warnings,
        }
    }
}

/// Generalized masses and frequencies.
#[derive(Debug, Clone)]
pub struct Generalized {
    mass: Vec<f64>,
    omega_rad_s: Vec<f64>,
}

/// The solver's method of a case's.
pub(crate) fn solver(method: Method) -> fl::Method {
    match method {
        Method::K => fl::Method::K,
        Method::Ke => fl::Method::Ke,
        Method::Pk => fl::Method::Pk,
        Method::PkBritish => fl::Method::PkHassig,
        Method::G => fl::Method::G,
    }
}

/// Speeds of the sweep, rising.
fn speeds(table: &FlutterTable) -> Vec<f64> {
    let max = table.speed_max.map_or(680.0, |v| v.0);
    let min = table.speed_min.map_or(max / 40.0, |v| v.0);
    let n = table.speed_count.unwrap_or(60);
    (0..n).map(|i| min + (max - min) * i as f64 / (n - 1) as f64).collect()
}

/// Density at the `i`-th Mach number.
fn density(table: &FlutterTable, i: usize, mach: f64) -> Result<f64, Stop> {
    if let Some(rho) = table.densities.as_ref().and_then(|d| d.get(i)) {
        return Ok(rho.0);
    }
    if let Some(h) = table.altitudes.as_ref().and_then(|h| h.get(i)) {
        return atmosphere::standard(h.0)
            .map(|air| air.density_kg_m3)
            .map_err(|e| Stop::input(format!("flutter.altitudes, Mach {mach}: {e}"), "give another altitude"));
    }
    Err(Stop::input(
        format!("no density for Mach {mach}"),
        "give flutter.densities, one for each Mach number",
    ))
}
