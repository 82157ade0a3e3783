//! Writing a recording while the run goes on.
//!
//! The file is the same to the bit for the same run: it holds no dates, compression uses one thread, and chunks end by
//! the number of the step. After every chunk everything is with the operating system, so that a killed run loses at most
//! the steps of the chunk under way.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::BufWriter;
use std::path::{Path, PathBuf};

use mcap::records::{MessageHeader, Metadata};
use mcap::write::NoSeek;
use mcap::{McapError, WriteOptions};

use crate::check;
use crate::error::RecordError;
use crate::message::{self, Precision};
use crate::metadata;
use crate::read::Salvage;
use crate::recording::Recording;
use crate::schema::{self, CHANNELS, Channel, PROFILE};
use crate::setup::Setup;
use crate::step::Step;

/// How a recording is written. A run that is gone on with must use the same options to give the same file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WriterOptions {
    /// Steps in a chunk: what a killed run can lose. A chunk ends with every step whose number is a multiple, so a restart
    /// file that is written after such a step finds all steps before it in the recording.
    pub steps_per_chunk: u32,
    /// The channel for viewers has a frame at every step whose number is a multiple; 0 leaves it out.
    pub viewer_every: u32,
    /// How pressure coefficients are stored.
    pub precision: Precision,
}

impl Default for WriterOptions {
    /// Five steps a chunk, every fourth step for viewers, single precision: 5,000 faces x 120 steps take under 6 MB.
    fn default() -> Self {
        Self {
            steps_per_chunk: 5,
            viewer_every: 4,
            precision: Precision::Single,
        }
    }
}

/// Writes a recording. Call [`Writer::finish`] at the end: a file that is dropped before counts as one of a killed run.
pub struct Writer {
    path: PathBuf,
    setup: Setup,
    options: WriterOptions,
    /// None only while being dropped or finished.
    out: Option<Out>,
    /// The same file, to force it to the disk.
    file: File,
    /// Number and instant of the last step.
    last: Option<(u32, f64)>,
    /// Number of the last step that is in a chunk that was handed to the system.
    flushed: Option<u32>,
    /// While a run that was gone on with has not yet handed the kept steps to the system: the new file, which then takes
    /// the old one's place. A kill before that leaves the old one.
    part: Option<PathBuf>,
}

/// The container and its channels.
struct Out {
    inner: mcap::Writer<NoSeek<BufWriter<File>>>,
    /// Identifiers of the channels, in the order of [`CHANNELS`].
    ids: Vec<u16>,
}

impl Out {
    fn put(&mut self, channel: Channel, sequence: u32, time_ns: u64, data: &[u8]) -> Result<(), McapError> {
        let index = CHANNELS.iter().position(|c| *c == channel).unwrap_or(usize::MAX);
        // No channel has the number 0: the container refuses what is not in the list.
        let channel_id = self.ids.get(index).copied().unwrap_or(0);
        self.inner.write_to_known_channel(
            &MessageHeader {
                channel_id,
                sequence,
                log_time: time_ns,
                publish_time: time_ns,
            },
            data,
        )
    }

    /// Metadata, then one chunk with channels, surface and shapes.
    fn preamble(&mut self, setup: &Setup) -> Result<(), McapError> {
        for (name, metadata) in metadata::encode(setup) {
            self.inner.write_metadata(&Metadata { name, metadata })?;
        }
        for channel in CHANNELS {
            let schema = self.inner.add_schema(channel.schema, "protobuf", channel.descriptor)?;
            let id = self
                .inner
                .add_channel(schema, channel.topic, "protobuf", &BTreeMap::new())?;
            self.ids.push(id);
        }
        for patch in &setup.surface.patches {
            self.put(schema::SURFACE_GRID, 0, 0, &message::grid(patch))?;
        }
        for coordinate in &setup.motion {
            for (patch, shape) in setup.surface.patches.iter().zip(&coordinate.shape_m) {
                let bytes = message::mode(&coordinate.name, &patch.name, shape);
                self.put(schema::SURFACE_MODE, 0, 0, &bytes)?;
            }
        }
        self.inner.flush()
    }

    fn step(&mut self, setup: &Setup, step: &Step, options: WriterOptions) -> Result<(), McapError> {
        let (number, time_ns) = (step.number, log_time_ns(step.time_s));
        self.put(schema::MOTION, number, time_ns, &message::motion(setup, step))?;
        for (patch, cp) in setup.surface.patches.iter().zip(&step.pressures) {
            let bytes = message::pressure(step, &patch.name, cp, options.precision);
            self.put(schema::PRESSURE, number, time_ns, &bytes)?;
        }
        if let Some(shape) = &step.shape_m {
            for (patch, nodes) in setup.surface.patches.iter().zip(shape) {
                let bytes = message::shape(step, &patch.name, nodes);
                self.put(schema::SURFACE_SHAPE, number, time_ns, &bytes)?;
            }
        }
        self.put(schema::LOADS, number, time_ns, &message::loads(step))?;
        if let Some(modal) = &step.modal {
            self.put(schema::MODAL, number, time_ns, &message::modal(step, modal))?;
        }
        if options.viewer_every > 0 && number.is_multiple_of(options.viewer_every) {
            let bytes = message::viewer(setup, step, time_ns);
            self.put(schema::VIEWER, number, time_ns, &bytes)?;
        }
        self.put(schema::CONVERGENCE, number, time_ns, &message::convergence(step))
    }

    fn finish(mut self, reason: &str) -> Result<(), McapError> {
        self.inner.write_metadata(&Metadata {
            name: metadata::END.to_owned(),
            metadata: BTreeMap::from([("reason".to_owned(), reason.to_owned())]),
        })?;
        self.inner.finish()?;
        // `finish` leaves the last bytes in the buffer.
        let file = self.inner.into_inner().into_inner().into_inner();
        file.map_err(std::io::IntoInnerError::into_error)?.sync_all()?;
        Ok(())
    }
}

impl std::fmt::Debug for Writer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Writer")
            .field("path", &self.path)
            .field("options", &self.options)
            .field("last", &self.last)
            .finish_non_exhaustive()
    }
}

/// Log time of an instant, ns.
pub(crate) fn log_time_ns(time_s: f64) -> u64 {
    (time_s * 1e9).round() as u64
}

impl Writer {
    /// Begins a recording; a file of that name is replaced.
    ///
    /// # Errors
    /// [`RecordError::Input`] if the setup contradicts itself, [`RecordError::Io`] or [`RecordError::Container`] if it
    /// cannot be written.
    pub fn create(path: &Path, setup: Setup, options: WriterOptions) -> Result<Self, RecordError> {
        Self::begin(path, path, setup, options)
    }

    /// Goes on with the recording of a run that was stopped or killed: keeps its steps up to and including `last_step`
    /// and waits for the next one. The steps are copied to a new file that takes the old one's place once all of them are
    /// with the system, so that a second kill finds one or the other; the result is the same to the bit as that of a run
    /// that was never stopped.
    ///
    /// # Errors
    /// [`RecordError::Resume`] if the old file does not reach `last_step` or records another flow, motion or surface; the
    /// errors of [`Recording::read_salvage`] and [`Writer::create`].
    pub fn resume(path: &Path, setup: Setup, options: WriterOptions, last_step: u32) -> Result<Self, RecordError> {
        let name = path.display().to_string();
        let wrong = |what: String| RecordError::Resume {
            path: name.clone(),
            what,
        };
        let Salvage { recording: mut old, .. } = Recording::read_salvage(path)?;
        // A run may be gone on with for more cycles than were asked for at first.
        old.setup.references.cycles_asked = setup.references.cycles_asked;
        for (what, same) in [
            ("the reference quantities", old.setup.references == setup.references),
            ("the motion", old.setup.motion == setup.motion),
            ("the surface", old.setup.surface == setup.surface),
        ] {
            if !same {
                return Err(wrong(format!(
                    "{what} in it differ from those of the run; give the run another folder or start it anew"
                )));
            }
        }
        let reaches = old.steps.last().map(|s| s.number);
        if reaches.is_none_or(|n| n < last_step) {
            return Err(wrong(format!(
                "the run goes on after step {last_step}, the recording reaches {}; go on from an earlier restart or \
                 start the run anew",
                reaches.map_or("no step".to_owned(), |n| format!("step {n}"))
            )));
        }
        let mut part = path.file_name().unwrap_or_default().to_owned();
        part.push(".part");
        let part = path.with_file_name(part);
        let mut writer = Self::begin(&part, path, setup, options)?;
        for step in old.steps.iter().take_while(|s| s.number <= last_step) {
            writer.step(step)?;
        }
        writer.part = Some(part);
        if writer.flushed == Some(last_step) {
            writer.take_place()?;
        }
        Ok(writer)
    }

    /// Puts the new file in the place of the one that was gone on from.
    fn take_place(&mut self) -> Result<(), RecordError> {
        let Some(part) = self.part.take() else { return Ok(()) };
        fs::rename(&part, &self.path).map_err(|source| RecordError::Io {
            path: self.path.display().to_string(),
            source,
        })
    }

    fn begin(file: &Path, path: &Path, setup: Setup, options: WriterOptions) -> Result<Self, RecordError> {
        let name = path.display().to_string();
        check::setup(&setup).map_err(|what| RecordError::Input {
            path: name.clone(),
            what,
        })?;
        if options.steps_per_chunk == 0 {
            return Err(RecordError::Input {
                path: name,
                what: "0 steps per chunk: at least 1 is needed".to_owned(),
            });
        }
        let io = |source| RecordError::Io {
            path: name.clone(),
            source,
        };
        let handle = File::create(file).map_err(io)?;
        let twin = handle.try_clone().map_err(io)?;
        let inner = WriteOptions::new()
            .profile(PROFILE)
            .library(concat!("dip-record/", env!("CARGO_PKG_VERSION")))
            // A chunk is made in memory and written at once: nothing half-done stands in the file between two chunks.
            .disable_seeking(true)
            .chunk_size(None)
            .compression_threads(0)
            .create(NoSeek::new(BufWriter::new(handle)))
            .map_err(|e| container(path, e))?;
        let mut out = Out { inner, ids: Vec::new() };
        out.preamble(&setup).map_err(|e| container(path, e))?;
        Ok(Self {
            path: path.to_owned(),
            setup,
            options,
            out: Some(out),
            file: twin,
            last: None,
            flushed: None,
            part: None,
        })
    }

    /// Records a step. The first may have any number, each other one is the next.
    ///
    /// # Errors
    /// [`RecordError::Input`] if the step does not fit the setup or its predecessor, or holds a number that is not finite
    /// (the file then stays as it was); [`RecordError::Io`] or [`RecordError::Container`] if it cannot be written.
    pub fn step(&mut self, step: &Step) -> Result<(), RecordError> {
        self.accept(step).map_err(|what| RecordError::Input {
            path: self.path.display().to_string(),
            what,
        })?;
        let Some(out) = &mut self.out else { return Ok(()) };
        out.step(&self.setup, step, self.options)
            .map_err(|e| container(&self.path, e))?;
        self.last = Some((step.number, step.time_s));
        if step.number.is_multiple_of(self.options.steps_per_chunk) {
            out.inner.flush().map_err(|e| container(&self.path, e))?;
            self.flushed = Some(step.number);
            self.take_place()?;
        }
        Ok(())
    }

    fn accept(&self, step: &Step) -> Result<(), String> {
        check::step(&self.setup, step).map_err(|f| f.what)?;
        if step.number == u32::MAX {
            return Err("more steps than a recording can number".to_owned());
        }
        if let Some((number, time_s)) = self.last {
            if step.number != number + 1 {
                return Err(format!("step {} after step {number}: the next is needed", step.number));
            }
            if log_time_ns(step.time_s) <= log_time_ns(time_s) {
                return Err(format!(
                    "step {} at {} s after step {number} at {time_s} s: it must be later by at least 1 ns",
                    step.number, step.time_s
                ));
            }
        }
        if self.options.precision == Precision::Single {
            for (cp, patch) in step.pressures.iter().zip(&self.setup.surface.patches) {
                if let Some(face) = cp.iter().position(|v| !(*v as f32).is_finite()) {
                    return Err(format!(
                        "step {}: Cp = {} on face {face} of patch `{}`, too large for single precision",
                        step.number, cp[face], patch.name
                    ));
                }
            }
        }
        Ok(())
    }

    /// Number of the last step that a kill can no longer take away. A restart file should be written just after a step
    /// that is safe, so that the recording reaches it.
    #[must_use]
    pub fn safe_step(&self) -> Option<u32> {
        self.flushed
    }

    /// Hands the chunk under way to the system and forces all of it to the disk, so that neither a kill nor a power failure
    /// takes a step. A chunk that is cut short by this makes a file of other bytes; where only whole chunks are under way
    /// (after a step whose number is a multiple of [`WriterOptions::steps_per_chunk`]) it changes nothing.
    ///
    /// # Errors
    /// [`RecordError::Io`] or [`RecordError::Container`].
    pub fn sync(&mut self) -> Result<(), RecordError> {
        if let (Some(out), Some((last, _))) = (&mut self.out, self.last)
            && self.flushed != Some(last)
        {
            out.inner.flush().map_err(|e| container(&self.path, e))?;
            self.flushed = Some(last);
            self.take_place()?;
        }
        self.file.sync_data().map_err(|source| RecordError::Io {
            path: self.path.display().to_string(),
            source,
        })
    }

    /// Ends the file: last chunk, the reason why the run ended, index, checksums; and forces it to the disk.
    ///
    /// # Errors
    /// [`RecordError::Io`] or [`RecordError::Container`].
    pub fn finish(mut self, reason: &str) -> Result<(), RecordError> {
        let Some(out) = self.out.take() else { return Ok(()) };
        out.finish(reason).map_err(|e| container(&self.path, e))?;
        self.take_place()
    }
}

impl Drop for Writer {
    /// Leaves the file as a kill would: without an end, so that nobody takes it for a finished run.
    fn drop(&mut self) {
        if let Some(out) = self.out.take() {
            // Without this the container would write its index now.
            drop(out.inner.into_inner());
        }
    }
}

fn container(path: &Path, error: McapError) -> RecordError {
    let path = path.display().to_string();
    match error {
        McapError::Io(source) => RecordError::Io { path, source },
        other => RecordError::Container {
            path,
            what: other.to_string(),
        },
    }
}
