//! Reading a recording: all of it, or what can be saved.

use std::collections::BTreeMap;
use std::path::Path;

use crate::check;
use crate::container::{self, Container, RawMessage};
use crate::error::RecordError;
use crate::finding::{Finding, FindingKind};
use crate::message::{self, Part};
use crate::metadata;
use crate::recording::Recording;
use crate::schema::{self, CHANNELS, FORMAT, PROFILE};
use crate::setup::Setup;
use crate::step::Step;
use crate::surface::{SurfaceGrid, SurfacePatch};
use crate::write::log_time_ns;

/// What could be read, and what is wrong.
#[derive(Clone, Debug, PartialEq)]
pub struct Salvage {
    /// The longest run of steps without a gap (the first of equals).
    pub recording: Recording,
    /// What is wrong; empty for a whole file.
    pub findings: Vec<Finding>,
    /// Numbers of the good steps, as runs from the first to the last without gaps.
    pub runs: Vec<[u32; 2]>,
}

impl Recording {
    /// Reads a recording that must be whole: every checksum right, no step missing, every number finite.
    ///
    /// # Errors
    /// [`RecordError::Damaged`] with all findings if something is lost; the errors of [`Recording::read_salvage`].
    pub fn read(path: &Path) -> Result<Self, RecordError> {
        let salvage = Self::read_salvage(path)?;
        let (damage, _): (Vec<_>, Vec<_>) = salvage.findings.into_iter().partition(|f| f.kind.is_damage());
        if damage.is_empty() {
            Ok(salvage.recording)
        } else {
            Err(RecordError::Damaged {
                path: path.display().to_string(),
                findings: damage,
            })
        }
    }

    /// Reads what can be read and says what is wrong: for recordings of runs that were killed or that still go on, and
    /// for damaged files.
    ///
    /// # Errors
    /// [`RecordError::Io`], [`RecordError::NotMcap`], [`RecordError::Foreign`], [`RecordError::Format`],
    /// [`RecordError::Setup`], [`RecordError::MissingChannel`]: nothing can be saved.
    pub fn read_salvage(path: &Path) -> Result<Salvage, RecordError> {
        let name = path.display().to_string();
        let bytes = std::fs::read(path).map_err(|source| RecordError::Io {
            path: name.clone(),
            source,
        })?;
        Self::from_bytes(&bytes, &name)
    }

    /// [`Recording::read_salvage`] of a file in memory; `name` stands in errors.
    ///
    /// # Errors
    /// Those of [`Recording::read_salvage`].
    pub fn from_bytes(bytes: &[u8], name: &str) -> Result<Salvage, RecordError> {
        if !container::has_magic(bytes) {
            return Err(RecordError::NotMcap {
                path: name.to_owned(),
                got: beginning(bytes),
            });
        }
        let mut messages = Messages::default();
        let container = container::read(bytes, |m| messages.take(m));
        let setup = setup(&container, &mut messages, name)?;
        let mut findings = container.findings;
        findings.append(&mut messages.findings);
        let steps = steps(&setup, messages.steps, &mut findings);
        motion(&setup, &steps, &mut findings);

        let runs: Vec<&[Step]> = steps.chunk_by(|a, b| b.number == a.number + 1).collect();
        for pair in runs.windows(2) {
            if let (Some(before), Some(after)) = (pair[0].last(), pair[1].first()) {
                findings.push(Finding::new(
                    FindingKind::Gap,
                    format!("steps {} to {} are missing", before.number + 1, after.number - 1),
                ));
            }
        }
        let spans = runs
            .iter()
            .filter_map(|run| Some([run.first()?.number, run.last()?.number]))
            .collect();
        // `max_by_key` takes the last of equals.
        let longest = runs.iter().rev().max_by_key(|run| run.len());
        let end = container.metadata.get(metadata::END).and_then(|m| m.get("reason"));
        Ok(Salvage {
            recording: Self {
                setup,
                steps: longest.map(|run| run.to_vec()).unwrap_or_default(),
                end: end.cloned(),
            },
            findings,
            runs: spans,
        })
    }
}

/// What a file that is none of ours begins with.
fn beginning(bytes: &[u8]) -> String {
    match bytes {
        [] => "it is empty".to_owned(),
        _ => format!("it begins with `{}`", bytes[..bytes.len().min(8)].escape_ascii()),
    }
}

/// A step under way: its messages may come in any order.
#[derive(Default)]
struct Partial {
    time_s: f64,
    parts: Vec<Part>,
}

/// What the messages of a file hold.
#[derive(Default)]
struct Messages {
    patches: Vec<SurfacePatch>,
    /// Coordinate, patch, displacements.
    shapes: Vec<(String, String, Vec<[f64; 3]>)>,
    steps: BTreeMap<u32, Partial>,
    findings: Vec<Finding>,
}

impl Messages {
    fn take(&mut self, m: &RawMessage<'_>) {
        if m.topic == schema::VIEWER.topic || !CHANNELS.iter().any(|c| c.topic == m.topic) {
            return;
        }
        let unreadable = || {
            Finding::new(
                FindingKind::Corrupt,
                format!("an unreadable message on `{}` at {} ns", m.topic, m.log_time_ns),
            )
        };
        if m.topic == schema::SURFACE_GRID.topic {
            match message::read_grid(m.data) {
                Some(patch) => self.patches.push(patch),
                None => self.findings.push(unreadable()),
            }
        } else if m.topic == schema::SURFACE_MODE.topic {
            match message::read_mode(m.data) {
                Some(shape) => self.shapes.push(shape),
                None => self.findings.push(unreadable()),
            }
        } else {
            match message::read_part(m.topic, m.data) {
                Some((number, time_s, part)) => self.part(m, number, time_s, part),
                None => self.findings.push(unreadable()),
            }
        }
    }

    fn part(&mut self, m: &RawMessage<'_>, number: u32, time_s: f64, part: Part) {
        // A log time is rounded to whole nanoseconds.
        if log_time_ns(time_s) != m.log_time_ns || number != m.sequence {
            self.findings.push(Finding::new(
                FindingKind::Timing,
                format!(
                    "`{}`: a message says step {number} at {time_s} s, the log has it as {} at {} ns",
                    m.topic, m.sequence, m.log_time_ns
                ),
            ));
            return;
        }
        let step = self.steps.entry(number).or_insert_with(|| Partial {
            time_s,
            parts: Vec::new(),
        });
        if step.time_s.to_bits() != time_s.to_bits() {
            self.findings.push(Finding::new(
                FindingKind::Timing,
                format!(
                    "step {number}: `{}` belongs to {time_s} s, the messages before it to {} s",
                    m.topic, step.time_s
                ),
            ));
            return;
        }
        step.parts.push(part);
    }
}

/// The setup, or the reason why the file is of no use.
fn setup(container: &Container, messages: &mut Messages, path: &str) -> Result<Setup, RecordError> {
    let wrong = |what: String| RecordError::Setup {
        path: path.to_owned(),
        what,
    };
    match &container.profile {
        None => return Err(wrong("the header of the file is missing or unreadable".to_owned())),
        Some(profile) if profile != PROFILE => {
            return Err(RecordError::Foreign {
                path: path.to_owned(),
                needed: PROFILE,
                got: profile.clone(),
            });
        }
        Some(_) => {}
    }
    let file = container.metadata.get(metadata::FILE);
    if let Some(format) = file.and_then(|m| m.get("format"))
        && format != FORMAT
    {
        return Err(RecordError::Format {
            path: path.to_owned(),
            needed: FORMAT,
            got: format.clone(),
            version: file.and_then(|m| m.get("version")).cloned().unwrap_or_default(),
        });
    }
    let (references, mut motion, provenance) = metadata::decode(&container.metadata).map_err(wrong)?;
    if container.channels.is_empty() {
        return Err(wrong(
            "the first chunk, with the channels and the surface, is missing or damaged".to_owned(),
        ));
    }
    for channel in CHANNELS.iter().filter(|c| c.required) {
        if !container.channels.values().any(|topic| topic == channel.topic) {
            return Err(RecordError::MissingChannel {
                path: path.to_owned(),
                topic: channel.topic,
                schema: channel.schema,
            });
        }
    }
    let patches = std::mem::take(&mut messages.patches);
    for (coordinate, patch, shape) in messages.shapes.drain(..) {
        let coordinate = motion.iter_mut().find(|c| c.name == coordinate).ok_or_else(|| {
            wrong(format!(
                "a shape of the wall for `{coordinate}`, which is no motion coordinate"
            ))
        })?;
        // The shapes of a coordinate come in the order of the patches.
        if patches.get(coordinate.shape_m.len()).is_none_or(|p| p.name != patch) {
            return Err(wrong(format!(
                "the shape of `{}` on patch `{patch}` is out of its order",
                coordinate.name
            )));
        }
        coordinate.shape_m.push(shape);
    }
    let setup = Setup {
        references,
        motion,
        surface: SurfaceGrid { patches },
        provenance,
    };
    check::setup(&setup).map_err(wrong)?;
    Ok(setup)
}

/// Good steps in the order of their numbers.
fn steps(setup: &Setup, partial: BTreeMap<u32, Partial>, findings: &mut Vec<Finding>) -> Vec<Step> {
    let mut steps: Vec<Step> = Vec::with_capacity(partial.len());
    for (number, partial) in partial {
        let step = assemble(setup, number, partial).and_then(|step| {
            check::step(setup, &step)?;
            Ok(step)
        });
        match step {
            Ok(step) if steps.last().is_some_and(|before| before.time_s >= step.time_s) => {
                findings.push(Finding::new(
                    FindingKind::Timing,
                    format!("step {number} at {} s is not later than the one before it", step.time_s),
                ));
            }
            Ok(step) => steps.push(step),
            Err(finding) => findings.push(finding),
        }
    }
    steps
}

fn assemble(setup: &Setup, number: u32, partial: Partial) -> Result<Step, Finding> {
    let incomplete = |what: String| Finding::new(FindingKind::Incomplete, format!("step {number}: {what}"));
    let patches = &setup.surface.patches;
    let index = |name: &str| {
        patches
            .iter()
            .position(|p| p.name == name)
            .ok_or_else(|| incomplete(format!("a message for patch `{name}`, which the surface does not have")))
    };
    let mut motion = None;
    let mut pressures: Vec<Option<Vec<f64>>> = vec![None; patches.len()];
    let mut shapes: Vec<Option<Vec<[f64; 3]>>> = vec![None; patches.len()];
    let (mut loads, mut modal, mut convergence) = (None, None, None);
    for part in partial.parts {
        let twice = match part {
            Part::Motion(values) => {
                let known = values
                    .iter()
                    .map(|(name, _)| name)
                    .eq(setup.motion.iter().map(|c| &c.name));
                if !known {
                    return Err(incomplete(
                        "its motion coordinates are not those of the metadata".to_owned(),
                    ));
                }
                motion
                    .replace(values.into_iter().map(|(_, now)| now).collect())
                    .is_some()
            }
            Part::Pressure(patch, cp) => pressures[index(&patch)?].replace(cp).is_some(),
            Part::Shape(patch, nodes) => shapes[index(&patch)?].replace(nodes).is_some(),
            Part::Loads(l) => loads.replace(l).is_some(),
            Part::Modal(m) => modal.replace(m).is_some(),
            Part::Convergence(c) => convergence.replace(c).is_some(),
        };
        if twice {
            return Err(incomplete("a message stands in the file twice".to_owned()));
        }
    }
    let missing = |channel: schema::Channel| incomplete(format!("`{}` is missing", channel.topic));
    let shape_m = if shapes.iter().all(Option::is_none) {
        None
    } else {
        let all: Option<Vec<_>> = shapes.into_iter().collect();
        Some(all.ok_or_else(|| missing(schema::SURFACE_SHAPE))?)
    };
    Ok(Step {
        number,
        time_s: partial.time_s,
        motion: motion.ok_or_else(|| missing(schema::MOTION))?,
        pressures: pressures
            .into_iter()
            .collect::<Option<_>>()
            .ok_or_else(|| missing(schema::PRESSURE))?,
        loads: loads.ok_or_else(|| missing(schema::LOADS))?,
        modal,
        convergence: convergence.ok_or_else(|| missing(schema::CONVERGENCE))?,
        shape_m,
    })
}

/// Compares the recorded motion with the law in the metadata; says the worst step of each coordinate.
fn motion(setup: &Setup, steps: &[Step], findings: &mut Vec<Finding>) {
    /// Part of the amplitude that may be lost to rounding of time and angle.
    const TOLERANCE: f64 = 1e-9;
    for (n, coordinate) in setup.motion.iter().enumerate() {
        let crate::motion::Law::Harmonic {
            mean,
            phase_origin_s,
            harmonics,
        } = &coordinate.law
        else {
            continue;
        };
        let scale = mean.abs() + harmonics.iter().map(|h| h.amplitude.abs()).sum::<f64>();
        let worst = steps
            .iter()
            .filter(|s| s.time_s > *phase_origin_s)
            .filter_map(|s| {
                let law = coordinate.law.at(s.time_s)?.value;
                let now = s.motion.get(n)?.value;
                Some((s, now, law, (now - law).abs()))
            })
            .max_by(|a, b| a.3.total_cmp(&b.3));
        if let Some((step, now, law, difference)) = worst
            && difference > TOLERANCE * scale
        {
            findings.push(Finding::new(
                FindingKind::Motion,
                format!(
                    "`{}` is {now} {} at step {} ({} s), its law in the metadata gives {law}: instants, phase origin or \
                     units do not belong together",
                    coordinate.name,
                    coordinate.kind.unit(),
                    step.number,
                    step.time_s
                ),
            ));
        }
    }
}
