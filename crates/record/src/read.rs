//! Reading a recording: all of it, or what can be saved.

use std::collections::BTreeMap;
use std::path::Path;

use crate::check;
use crate::container::{self, Container, FileChannel, RawMessage};
use crate::error::RecordError;
use crate::finding::{Finding, FindingKind};
use crate::message::{self, Part};
use crate::metadata;
use crate::recording::Recording;
use crate::schema::{self, CHANNELS, Channel, FORMAT, PROFILE};
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
    /// [`RecordError::Setup`], [`RecordError::MissingChannel`], [`RecordError::WrongChannel`]: nothing can be saved.
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
        foreign(&container.channels, &mut findings);
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
        let topic = m.channel.topic.as_str();
        if topic == schema::VIEWER.topic || !CHANNELS.iter().any(|c| is(m.channel, c)) {
            return;
        }
        let unreadable = || {
            Finding::new(
                FindingKind::Corrupt,
                format!("an unreadable message on `{topic}` at {} ns", m.log_time_ns),
            )
        };
        if topic == schema::SURFACE_GRID.topic {
            match message::read_grid(m.data) {
                Some(patch) => self.patches.push(patch),
                None => self.findings.push(unreadable()),
            }
        } else if topic == schema::SURFACE_MODE.topic {
            match message::read_mode(m.data) {
                Some(shape) => self.shapes.push(shape),
                None => self.findings.push(unreadable()),
            }
        } else {
            match message::read_part(topic, m.data) {
                Some((number, time_s, part)) => self.part(m, number, time_s, part),
                None => self.findings.push(unreadable()),
            }
        }
    }

    fn part(&mut self, m: &RawMessage<'_>, number: u32, time_s: f64, part: Part) {
        // A log time is rounded to whole nanoseconds; others cut it off, or leave the sequence at zero.
        if log_time_ns(time_s).abs_diff(m.log_time_ns) > 1 || (number != m.sequence && m.sequence != 0) {
            self.findings.push(Finding::new(
                FindingKind::Timing,
                format!(
                    "`{}`: a message says step {number} at {time_s} s, the log has it as {} at {} ns",
                    m.channel.topic, m.sequence, m.log_time_ns
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
                    m.channel.topic, step.time_s
                ),
            ));
            return;
        }
        step.parts.push(part);
    }
}

/// True if a channel of a file is the one that `needed` describes.
fn is(channel: &FileChannel, needed: &Channel) -> bool {
    channel.topic == needed.topic && channel.encoding == "protobuf" && channel.schema.as_deref() == Some(needed.schema)
}

/// What a channel carries, in words.
fn content(channel: &FileChannel) -> String {
    let schema = channel
        .schema
        .as_ref()
        .map_or("no schema".to_owned(), |s| format!("schema `{s}`"));
    format!("messages of encoding `{}` and {schema}", channel.encoding)
}

/// Channels with a topic of ours and another content, where a recording can do without them.
fn foreign(channels: &BTreeMap<u16, FileChannel>, findings: &mut Vec<Finding>) {
    for needed in CHANNELS.iter().filter(|c| !c.required) {
        for channel in channels.values().filter(|c| c.topic == needed.topic && !is(c, needed)) {
            findings.push(Finding::new(
                FindingKind::Foreign,
                format!(
                    "channel `{}` carries {}, not `{}` in protobuf: it is left out",
                    needed.topic,
                    content(channel),
                    needed.schema
                ),
            ));
        }
    }
}

/// The setup, or the reason why the file is of no use.
fn setup(container: &Container, messages: &mut Messages, path: &str) -> Result<Setup, RecordError> {
    let wrong = |what: String| RecordError::Setup {
        path: path.to_owned(),
        what,
    };
    let file = container.metadata.get(metadata::FILE);
    match &container.profile {
        None => return Err(wrong("the header of the file is missing or unreadable".to_owned())),
        // Tools that pack a file anew leave the profile out.
        Some(profile) if profile != PROFILE && file.is_none() => {
            return Err(RecordError::Foreign {
                path: path.to_owned(),
                needed: PROFILE,
                got: profile.clone(),
            });
        }
        Some(_) => {}
    }
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
    let (references, mut motion, provenance) =
        metadata::decode(&container.metadata, container.findings.is_empty()).map_err(wrong)?;
    if container.channels.is_empty() {
        return Err(wrong(
            "it has no channel: the first chunk, with the channels and the surface, is missing or damaged".to_owned(),
        ));
    }
    for channel in CHANNELS.iter().filter(|c| c.required) {
        if container.channels.values().any(|c| is(c, channel)) {
            continue;
        }
        let (path, topic, schema) = (path.to_owned(), channel.topic, channel.schema);
        return Err(match container.channels.values().find(|c| c.topic == topic) {
            Some(other) => RecordError::WrongChannel {
                path,
                topic,
                schema,
                got: content(other),
            },
            None => RecordError::MissingChannel { path, topic, schema },
        });
    }
    let mut patches: Vec<SurfacePatch> = Vec::new();
    for patch in messages.patches.drain(..) {
        // Two that differ are refused with the setup.
        if !patches.contains(&patch) {
            patches.push(patch);
        }
    }
    for coordinate in &mut motion {
        for patch in &patches {
            let mut alike = messages
                .shapes
                .iter()
                .filter(|(of, on, _)| *of == coordinate.name && *on == patch.name);
            if let Some((.., shape)) = alike.next() {
                if alike.any(|(.., other)| other != shape) {
                    return Err(wrong(format!(
                        "two shapes of `{}` on patch `{}`",
                        coordinate.name, patch.name
                    )));
                }
                coordinate.shape_m.push(shape.clone());
            }
        }
    }
    for (of, on, _) in messages.shapes.drain(..) {
        if !motion.iter().any(|c| c.name == of) || !patches.iter().any(|p| p.name == on) {
            return Err(wrong(format!(
                "a shape of the wall for `{of}` on `{on}`: no such motion coordinate or patch"
            )));
        }
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
    let (mut twice, mut first_twice) = (0, None);
    for (number, partial) in partial {
        let step = assemble(setup, number, partial).and_then(|(step, again)| {
            if again > 0 {
                twice += again;
                first_twice.get_or_insert(number);
            }
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
    if let Some(first) = first_twice {
        findings.push(Finding::new(
            FindingKind::Twice,
            format!(
                "from step {first} on, {twice} messages stand in the file twice and are alike: one of each is taken"
            ),
        ));
    }
    steps
}

/// Puts a value in its place; true if the same one is there already.
///
/// # Errors
/// If another one is there.
fn put<T: PartialEq>(place: &mut Option<T>, value: T) -> Result<bool, ()> {
    match place {
        Some(there) if *there == value => Ok(true),
        Some(_) => Err(()),
        None => {
            *place = Some(value);
            Ok(false)
        }
    }
}

/// A step, and how many of its messages stand in the file again.
fn assemble(setup: &Setup, number: u32, partial: Partial) -> Result<(Step, usize), Finding> {
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
    let mut again = 0;
    for part in partial.parts {
        let there = match part {
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
                put(&mut motion, values.into_iter().map(|(_, now)| now).collect())
            }
            Part::Pressure(patch, cp) => put(&mut pressures[index(&patch)?], cp),
            Part::Shape(patch, nodes) => put(&mut shapes[index(&patch)?], nodes),
            Part::Loads(l) => put(&mut loads, l),
            Part::Modal(m) => put(&mut modal, m),
            Part::Convergence(c) => put(&mut convergence, c),
        };
        match there {
            Ok(same) => again += usize::from(same),
            Err(()) => {
                return Err(incomplete(
                    "two messages for the same thing contradict each other".to_owned(),
                ));
            }
        }
    }
    let missing = |channel: Channel| incomplete(format!("`{}` is missing", channel.topic));
    let shape_m = if shapes.iter().all(Option::is_none) {
        None
    } else {
        let all: Option<Vec<_>> = shapes.into_iter().collect();
        Some(all.ok_or_else(|| missing(schema::SURFACE_SHAPE))?)
    };
    let step = Step {
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
    };
    Ok((step, again))
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
