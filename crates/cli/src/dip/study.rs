//! A study, read and checked, and the points of its curves.

use crate::exit::Stop;
use crate::frequency::{self, FlutterCase};
use crate::stamp::Fingerprint;
use dip_case::Document;
use dip_case::file::{CurveKind, CurveTable, Method, StudyFile};
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
    /// How, from what.
    pub work: Work,
    /// What it is computed from.
    pub fingerprint: Fingerprint,
}

/// How a curve is computed.
#[derive(Debug)]
pub enum Work {
    /// The lattice as it is: the case at the study's Mach numbers, and the method that gives the boundary.
    Dlm(Box<FlutterCase>, Method),
    /// The lattice corrected by recordings.
    Corrected(Box<CorrectedCurve>),
    /// Flow and structure marched together.
    March(MarchCurve),
}

/// What a marched curve is computed from.
#[derive(Debug)]
pub struct MarchCurve {
    /// The case.
    pub case: PathBuf,
    /// Its text, overrides included.
    text: String,
    /// Overrides of it.
    overrides: Vec<String>,
    /// Mach number, speed and first density of every point: those of the experiment.
    pub points: Vec<[f64; 3]>,
}

impl MarchCurve {
    /// The case of a point.
    ///
    /// # Errors
    /// As [`Document::read`].
    pub fn document(&self, [mach, speed, density]: [f64; 3]) -> Result<Document, Stop> {
        let mut overrides = self.overrides.clone();
        overrides.extend([
            format!("flow.mach={mach:?}"),
            format!("flow.speed={speed:?}"),
            format!("flow.density={density:?}"),
        ]);
        Ok(Document::read(&self.case, &overrides)?)
    }
}

/// What a corrected curve is computed from.
#[derive(Debug)]
pub struct CorrectedCurve {
    /// The flutter case, with its corrections, at the curve's Mach numbers.
    pub case: FlutterCase,
    /// Its file.
    file: PathBuf,
    /// Overrides that put it at these Mach numbers.
    overrides: Vec<String>,
    /// The flutter method that gives the boundary.
    pub method: Method,
    /// Name of the correction that gives the boundary.
    pub correction: &'static str,
    /// The case of prescribed motion.
    pub pitch: PathBuf,
    /// Overrides of it.
    pub pitch_overrides: Vec<String>,
    /// Multiples of the uncorrected flutter frequency at which recordings are made.
    pub around: Vec<f64>,
}

impl CorrectedCurve {
    /// The flutter case's document anew.
    ///
    /// # Errors
    /// As [`Document::read`].
    pub fn document(&self) -> Result<Document, Stop> {
        Ok(Document::read(&self.file, &self.overrides)?)
    }
}

impl Curve {
    /// Name of its folder and files.
    pub fn slug(&self) -> String {
        slug(&self.table.name)
    }

    /// Text of the case file that it names, overrides included.
    pub fn case_text(&self) -> String {
        match &self.work {
            Work::Dlm(case, _) => case.document.text().to_owned(),
            Work::Corrected(c) => c.case.document.text().to_owned(),
            Work::March(m) => m.text.clone(),
        }
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

impl Study {
    /// Reads and checks a study and everything that it names; with `medium` the flow cases are those of `--fidelity medium`.
    ///
    /// # Errors
    /// What is wrong in the files.
    pub fn read(path: &Path, overrides: &[String], medium: bool) -> Result<Self, Stop> {
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
            let curve = curve(&document, &file, table, i, medium)?;
            fingerprint.text(&curve.fingerprint.stamp().fingerprint);
            curves.push(curve);
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

/// Reads one curve's cases.
fn curve(document: &Document, study: &StudyFile, table: &CurveTable, i: usize, medium: bool) -> Result<Curve, Stop> {
    let machs = table.mach.as_ref().unwrap_or(&study.mach);
    if let Some(m) = machs
        .iter()
        .find(|m| !study.mach.iter().any(|s| (s - **m).abs() < 1e-9))
    {
        let message = format!("Mach {m} is not among the study's");
        return Err(document
            .error(&format!("curve.{i}.mach"), message, "add it to the study's mach")
            .into());
    }
    let mut fingerprint = Fingerprint::new();
    fingerprint.text(&format!("{table:?} {medium}"));
    let path = document.path(&table.case);
    if table.kind == CurveKind::March {
        return march(document, study, table, i, medium, fingerprint);
    }
    let overrides = at_machs(document, table, machs, i)?;
    let case = FlutterCase::read(Document::read(&path, &overrides)?)?;
    fingerprint.text(&case.fingerprint.stamp().fingerprint);
    let method = method(document, table, &case, i)?;
    let work = match table.kind {
        CurveKind::Dlm | CurveKind::March => Work::Dlm(Box::new(case), method),
        CurveKind::Corrected => {
            let Some(pitch) = &table.pitch else {
                let help = "pitch = \"pitch.toml\", the case of prescribed motion";
                return Err(document
                    .error(&format!("curve.{i}"), "a corrected curve needs `pitch`", help)
                    .into());
            };
            let pitch = document.path(pitch);
            let pitch_overrides = flow_overrides(table, medium);
            let flow = Document::read(&pitch, &pitch_overrides)?;
            let content: dip_case::file::PitchFile = flow.load()?;
            fingerprint.document(&flow);
            for named in content.mesh.recipe.iter().chain(&content.mesh.file) {
                fingerprint.file(flow.path(named));
            }
            let corrections = case.file.correct.clone().unwrap_or_default().methods;
            let correction = match (table.correction, corrections.first()) {
                (Some(c), _) if corrections.contains(&c) => c,
                (None, Some(&first)) => first,
                _ => {
                    let message = "the case has no such correction";
                    let help = format!("add it to correct.methods of {}", table.case.display());
                    return Err(document.error(&format!("curve.{i}.correction"), message, help).into());
                }
            };
            let around = table.around.clone().unwrap_or_else(|| vec![0.75, 1.15]);
            if around.is_empty() || around.iter().any(|f| !(*f > 0.0 && *f < 10.0)) {
                let message = format!("{around:?}: needed one or more multiples above 0 and below 10");
                return Err(document
                    .error(&format!("curve.{i}.around"), message, "around = [0.75, 1.15]")
                    .into());
            }
            Work::Corrected(Box::new(CorrectedCurve {
                case,
                file: path,
                overrides,
                method,
                correction: crate::correction::method(correction).name(),
                pitch,
                pitch_overrides,
                around,
            }))
        }
    };
    Ok(Curve {
        table: table.clone(),
        work,
        fingerprint,
    })
}

/// A marched curve: at every Mach number the experiment's speed, the search beginning at its density.
fn march(
    document: &Document,
    study: &StudyFile,
    table: &CurveTable,
    i: usize,
    medium: bool,
    mut fingerprint: Fingerprint,
) -> Result<Curve, Stop> {
    let case = document.path(&table.case);
    let overrides = flow_overrides(table, medium);
    let flow = Document::read(&case, &overrides)?;
    let content: dip_case::file::MarchFile = flow.load()?;
    fingerprint.document(&flow);
    for named in content.mesh.recipe.iter().chain(&content.mesh.file) {
        fingerprint.file(flow.path(named));
    }
    crate::assemble::modes::fingerprint(&flow, &content.modes, &mut fingerprint);
    let Some(experiment) = &study.experiment else {
        let help = "a march holds the experiment's speed and searches the density: add experiment = \"experiment.csv\"";
        return Err(document.error("", "a marched curve needs the experiment", help).into());
    };
    let measured = dip_case::table::Table::read(&document.path(experiment))?;
    let columns = ["mach", "speed_m_s", "density_kg_m3"];
    let [machs, speeds, densities] = {
        let mut read = Vec::new();
        for name in columns {
            read.push(measured.numbers(name)?);
        }
        [read[0].clone(), read[1].clone(), read[2].clone()]
    };
    let mut points = Vec::new();
    for mach in table.mach.as_ref().unwrap_or(&study.mach) {
        let at = machs.iter().position(|m| (m - mach).abs() < 1e-6);
        let Some(at) = at else {
            let message = format!("the experiment has no point at Mach {mach}");
            let help = "leave it out of this curve's mach";
            return Err(document.error(&format!("curve.{i}.mach"), message, help).into());
        };
        points.push([*mach, speeds[at], densities[at]]);
    }
    Ok(Curve {
        table: table.clone(),
        work: Work::March(MarchCurve {
            case,
            text: flow.text().to_owned(),
            overrides,
            points,
        }),
        fingerprint,
    })
}

/// Overrides of a curve's flow case.
fn flow_overrides(table: &CurveTable, medium: bool) -> Vec<String> {
    let more = if medium { table.medium.as_slice() } else { &[] };
    table.set.iter().chain(more).cloned().collect()
}

/// The method that gives a curve's boundary.
fn method(document: &Document, table: &CurveTable, case: &FlutterCase, i: usize) -> Result<Method, Stop> {
    let methods = case
        .file
        .flutter
        .as_ref()
        .map(|f| f.methods.clone())
        .unwrap_or_default();
    match (table.method, methods.first()) {
        (Some(method), _) if methods.contains(&method) => Ok(method),
        (Some(_), _) => {
            let message = "the case does not solve by this method";
            let help = format!("add it to flutter.methods of {}", table.case.display());
            Err(document.error(&format!("curve.{i}.method"), message, help).into())
        }
        (None, Some(&first)) => Ok(first),
        (None, None) => {
            let message = "the case has no [flutter] table";
            Err(document
                .error(&format!("curve.{i}.case"), message, "add [flutter] to it")
                .into())
        }
    }
}

/// Overrides that put a case at the study's Mach numbers, taking the densities that the case has for them.
fn at_machs(document: &Document, table: &CurveTable, machs: &[f64], i: usize) -> Result<Vec<String>, Stop> {
    let case = Document::read(&document.path(&table.case), &[])?;
    let file: dip_case::file::FlutterFile = case.load()?;
    let mut densities = Vec::new();
    for (j, &mach) in machs.iter().enumerate() {
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
    let mut overrides = vec![format!("lattice.mach=[{}]", list(machs))];
    if !densities.is_empty() {
        overrides.push(format!("flutter.densities=[{}]", list(&densities)));
    }
    Ok(overrides)
}
