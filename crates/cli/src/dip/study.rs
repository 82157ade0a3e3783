//! A study, read and checked, and the points of its curves.

use crate::exit::Stop;
use crate::frequency::{self, FlutterCase, FlutterRow};
use crate::stamp::Fingerprint;
use crate::traces::{MachCurves, ModeShapes};
use dip_case::Document;
use dip_case::file::{CurveTable, Method, StudyFile};
use dip_flutter::SpeedIndexReference;
use serde::{Deserialize, Serialize};
use std::path::{Path, PathBuf};

/// A study.
#[derive(Debug)]
pub struct Study {
    /// The file.
    pub document: Document,
    /// Its content.
    pub file: StudyFile,
    /// Reference quantities of the speed index, one set for all curves.
    pub reference: SpeedIndexReference,
    /// Curves to compute.
    pub curves: Vec<Curve>,
    /// The measured points.
    pub experiment: Vec<Point>,
    /// Curves of others.
    pub published: Vec<PublishedCurve>,
    /// Everything that the report depends on.
    pub fingerprint: Fingerprint,
}

/// A curve to compute.
#[derive(Debug)]
pub struct Curve {
    /// Its table in the study.
    pub table: CurveTable,
    /// The case, at the study's Mach numbers.
    pub case: FlutterCase,
    /// The method that gives the boundary.
    pub method: Method,
}

impl Curve {
    /// Name of its folder and files.
    pub fn slug(&self) -> String {
        slug(&self.table.name)
    }
}

/// Letters, digits and dashes of a name.
pub fn slug(name: &str) -> String {
    let mut out = String::new();
    for c in name.chars() {
        if c.is_ascii_alphanumeric() {
            out.push(c.to_ascii_lowercase());
        } else if c != '\'' && !out.ends_with('-') && !out.is_empty() {
            out.push('-');
        }
    }
    out.trim_end_matches('-').to_owned()
}

/// One point of a boundary, from any source.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Point {
    /// Mach number.
    pub mach: f64,
    /// Density, kg/m^3, where the source gives it.
    pub density_kg_m3: Option<f64>,
    /// Speed, m/s, where the source gives it.
    pub speed_m_s: Option<f64>,
    /// Frequency, Hz, where the source gives it.
    pub frequency_hz: Option<f64>,
    /// Flutter speed index on the study's reference quantities.
    pub flutter_speed_index: Option<f64>,
    /// omega / omega_alpha.
    pub frequency_ratio: Option<f64>,
}

/// A published curve.
#[derive(Debug)]
pub struct PublishedCurve {
    /// Name in figures and tables.
    pub name: String,
    /// Where it comes from.
    pub source: String,
    /// Its points.
    pub points: Vec<Point>,
}

/// A finished curve.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct CurveResult {
    /// Name in figures and tables.
    pub name: String,
    /// Stamp of the case it was computed from.
    pub stamp: crate::stamp::Stamp,
    /// Points of the boundary, one for each Mach number.
    pub boundary: Vec<FlutterRow>,
    /// Points of all methods.
    pub rows: Vec<FlutterRow>,
    /// Natural frequencies, Hz.
    pub natural_frequencies_hz: Vec<f64>,
    /// Mass of the structural model, kg, where it is known.
    pub structure_mass_kg: Option<f64>,
    /// Number of boxes.
    pub boxes: usize,
    /// V-g and V-f curves of the boundary's method.
    pub curves: Vec<MachCurves>,
    /// Mode shapes for the pictures.
    pub shapes: ModeShapes,
    /// What to look at.
    pub warnings: Vec<String>,
    /// Seconds for each stage.
    pub stages: Vec<(String, crate::progress::Seconds)>,
}

impl Study {
    /// Reads and checks a study and everything that it names.
    ///
    /// # Errors
    /// What is wrong in the files.
    pub fn read(path: &Path, overrides: &[String]) -> Result<Self, Stop> {
        let document = Document::read(path, overrides)?;
        let file: StudyFile = document.load()?;
        if file.mach.is_empty() {
            return Err(document.error("mach", "no Mach number", "give one or more").into());
        }
        if file.curve.is_empty() {
            return Err(document
                .error("curve", "no curve", "add a [[curve]] with name, kind and case")
                .into());
        }
        let reference = frequency::reference(&document, &file.reference, None)?;
        let mut fingerprint = Fingerprint::new();
        fingerprint.document(&document);
        let mut curves: Vec<Curve> = Vec::new();
        for (i, table) in file.curve.iter().enumerate() {
            if slug(&table.name).is_empty() || curves.iter().any(|c| c.slug() == slug(&table.name)) {
                let message = format!("the name \"{}\" is empty or too like another curve's", table.name);
                return Err(document
                    .error(&format!("curve.{i}.name"), message, "curves need different names")
                    .into());
            }
            let case = FlutterCase::read(Document::read(
                &document.path(&table.case),
                &at_machs(&document, table, &file, i)?,
            )?)?;
            let methods = case
                .file
                .flutter
                .as_ref()
                .map(|f| f.methods.clone())
                .unwrap_or_default();
            let method = match (table.method, methods.first()) {
                (Some(method), _) if methods.contains(&method) => method,
                (Some(_), _) => {
                    let message = "the case does not solve by this method";
                    let help = format!("add it to flutter.methods of {}", table.case.display());
                    return Err(document.error(&format!("curve.{i}.method"), message, help).into());
                }
                (None, Some(&first)) => first,
                (None, None) => {
                    let message = "the case has no [flutter] table";
                    return Err(document
                        .error(&format!("curve.{i}.case"), message, "add [flutter] to it")
                        .into());
                }
            };
            fingerprint.text(&case.fingerprint.stamp().fingerprint);
            curves.push(Curve {
                table: table.clone(),
                case,
                method,
            });
        }
        let mut named: Vec<PathBuf> = Vec::new();
        let experiment = match &file.experiment {
            Some(path) => {
                named.push(document.path(path));
                super::published::points(&document.path(path), &reference)?
            }
            None => Vec::new(),
        };
        let mut published = Vec::new();
        for table in &file.published {
            let path = document.path(&table.file);
            let points = super::published::points(&path, &reference)?;
            published.push(PublishedCurve {
                name: table.name.clone(),
                source: table.source.clone(),
                points,
            });
            named.push(path);
        }
        for path in named {
            fingerprint.file(path);
        }
        Ok(Self {
            document,
            file,
            reference,
            curves,
            experiment,
            published,
            fingerprint,
        })
    }
}

/// Overrides that put a case at the study's Mach numbers, taking the densities that the case has for them.
fn at_machs(document: &Document, table: &CurveTable, study: &StudyFile, i: usize) -> Result<Vec<String>, Stop> {
    let case = Document::read(&document.path(&table.case), &[])?;
    let file: dip_case::file::FlutterFile = case.load()?;
    let mut densities = Vec::new();
    for (j, &mach) in study.mach.iter().enumerate() {
        let Some(at) = file.lattice.mach.iter().position(|m| (m - mach).abs() < 1e-9) else {
            let message = format!("Mach {mach} is not among lattice.mach of {}", table.case.display());
            return Err(document
                .error(&format!("mach.{j}"), message, format!("curve {} needs it there", i + 1))
                .into());
        };
        if let Some(list) = file.flutter.as_ref().and_then(|f| f.densities.as_ref()) {
            match list.get(at) {
                Some(rho) => densities.push(rho.0),
                // The case's own check says what is wrong.
                None => return Ok(Vec::new()),
            }
        }
    }
    let list = |values: &[f64]| values.iter().map(|v| format!("{v:?}")).collect::<Vec<_>>().join(", ");
    let mut overrides = vec![format!("lattice.mach=[{}]", list(&study.mach))];
    if !densities.is_empty() {
        overrides.push(format!("flutter.densities=[{}]", list(&densities)));
    }
    Ok(overrides)
}
