//! The container: records, chunks and checksums of an MCAP file, read from the front and as far as it goes.
//!
//! Every byte of a finished file of ours is under a checksum: chunks have their own, the data section and the summary one
//! each. Where a record is unreadable the search goes on at the next chunk whose checksum is right. Files that other
//! programs wrote or rewrote may do without chunks, checksums (a zero) and summary, and may be packed by lz4.

use std::collections::BTreeMap;
use std::io::Read as _;

use mcap::records::{Record, op};

use crate::finding::{Finding, FindingKind};

/// Bytes before the content of a record: its kind and its length.
const RECORD_HEAD: usize = 9;

/// Largest chunk that is unpacked: far above anything a run writes, so that a wrong length cannot take all memory.
const CHUNK_LIMIT: u64 = 1 << 30;

/// Metadata records of a file, by name.
pub(crate) type MetadataRecords = BTreeMap<String, BTreeMap<String, String>>;

/// A channel as the file has it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct FileChannel {
    /// Topic.
    pub topic: String,
    /// Encoding of its messages.
    pub encoding: String,
    /// Name of its schema; none where it has none.
    pub schema: Option<String>,
}

/// One message.
pub(crate) struct RawMessage<'a> {
    /// Its channel.
    pub channel: &'a FileChannel,
    /// Step, as the container has it.
    pub sequence: u32,
    /// Log time, ns.
    pub log_time_ns: u64,
    /// Content.
    pub data: &'a [u8],
}

/// What the container says about itself.
#[derive(Debug, Default)]
pub(crate) struct Container {
    /// Profile of the header; none if there is no readable header.
    pub profile: Option<String>,
    /// Metadata records.
    pub metadata: MetadataRecords,
    /// Channels, by their numbers.
    pub channels: BTreeMap<u16, FileChannel>,
    /// What is wrong.
    pub findings: Vec<Finding>,
}

/// True if the bytes begin as an MCAP file does.
pub(crate) fn has_magic(bytes: &[u8]) -> bool {
    bytes.starts_with(mcap::MAGIC)
}

/// Reads all records; every message of every good chunk is handed over in the order of the file.
pub(crate) fn read(bytes: &[u8], mut take: impl FnMut(&RawMessage<'_>)) -> Container {
    let mut walk = Walk {
        bytes,
        schemas: BTreeMap::new(),
        out: Container::default(),
    };
    let mut at = mcap::MAGIC.len();
    let data_end = loop {
        let next = match walk.record(at) {
            Ok((op::DATA_END, body)) => break Some((at, body)),
            Ok((opcode, body)) => match walk.data_record(opcode, body, &mut take) {
                Ok(()) => Some(at + RECORD_HEAD + body.len()),
                Err(what) => {
                    walk.corrupt(format!("at byte {at}: {what}"));
                    let follower = at + RECORD_HEAD + body.len();
                    if walk.is_record(follower) {
                        Some(follower)
                    } else {
                        walk.next_chunk(at + 1)
                    }
                }
            },
            Err(CutShort) => {
                let next = walk.next_chunk(at + 1);
                if next.is_some() || bytes.ends_with(mcap::MAGIC) {
                    walk.corrupt(format!("at byte {at}: a record that is longer than the file"));
                }
                next
            }
        };
        match next {
            Some(next) => at = next,
            None => break None,
        }
    };
    match data_end {
        Some((at, body)) => walk.end(at, body),
        None => walk.out.findings.push(Finding::new(
            FindingKind::Unfinished,
            format!(
                "the file stops at byte {} without an end: the run was killed, goes on, or the file was cut short",
                bytes.len()
            ),
        )),
    }
    walk.out
}

/// The record goes beyond the end of the file.
struct CutShort;

struct Walk<'a> {
    bytes: &'a [u8],
    /// Names of the schemas, by their numbers.
    schemas: BTreeMap<u16, String>,
    out: Container,
}

impl<'a> Walk<'a> {
    fn corrupt(&mut self, what: impl Into<String>) {
        self.out.findings.push(Finding::new(FindingKind::Corrupt, what));
    }

    /// Kind and content of the record at a byte.
    fn record(&self, at: usize) -> Result<(u8, &'a [u8]), CutShort> {
        split_record(self.bytes.get(at..).unwrap_or_default()).map(|(opcode, body, _)| (opcode, body))
    }

    /// True if a record that the format knows can begin at a byte.
    fn is_record(&self, at: usize) -> bool {
        self.record(at)
            .is_ok_and(|(opcode, _)| (op::HEADER..=op::DATA_END).contains(&opcode))
    }

    /// One record of the data section.
    fn data_record(&mut self, opcode: u8, body: &[u8], take: &mut impl FnMut(&RawMessage<'_>)) -> Result<(), String> {
        match opcode {
            op::HEADER => {
                if let Record::Header(header) = parse(opcode, body)? {
                    self.out.profile = Some(header.profile);
                }
                Ok(())
            }
            op::METADATA => {
                if let Record::Metadata(record) = parse(opcode, body)? {
                    self.out.metadata.insert(record.name, record.metadata);
                }
                Ok(())
            }
            op::CHUNK => {
                let content = unpack(body)?;
                self.chunk(&content, take)
            }
            // In a file without chunks; indexes and attachments are not needed.
            _ => self.content(opcode, body, take),
        }
    }

    /// Records of an unpacked chunk. Its checksum was right: what is wrong now was written so.
    fn chunk(&mut self, mut rest: &[u8], take: &mut impl FnMut(&RawMessage<'_>)) -> Result<(), String> {
        while !rest.is_empty() {
            let (opcode, body, after) = split_record(rest).map_err(|CutShort| "a chunk ends within a record")?;
            rest = after;
            self.content(opcode, body, take)?;
        }
        Ok(())
    }

    /// A record that may stand in a chunk.
    fn content(&mut self, opcode: u8, body: &[u8], take: &mut impl FnMut(&RawMessage<'_>)) -> Result<(), String> {
        match opcode {
            op::SCHEMA => {
                if let Record::Schema { header, .. } = parse(opcode, body)? {
                    self.schemas.insert(header.id, header.name);
                }
            }
            op::CHANNEL => {
                if let Record::Channel(channel) = parse(opcode, body)? {
                    let schema = self.schemas.get(&channel.schema_id).cloned();
                    let known = FileChannel {
                        topic: channel.topic,
                        encoding: channel.message_encoding,
                        schema,
                    };
                    self.out.channels.insert(channel.id, known);
                }
            }
            op::MESSAGE => {
                if let Record::Message { header, data } = parse(opcode, body)?
                    && let Some(channel) = self.out.channels.get(&header.channel_id)
                {
                    take(&RawMessage {
                        channel,
                        sequence: header.sequence,
                        log_time_ns: header.log_time,
                        data: &data,
                    });
                }
            }
            _ => {}
        }
        Ok(())
    }

    /// First byte at or after `from` where a chunk with the right checksum begins.
    fn next_chunk(&self, from: usize) -> Option<usize> {
        (from..self.bytes.len()).find(|at| {
            self.bytes[*at] == op::CHUNK
                && self
                    .record(*at)
                    .is_ok_and(|(opcode, body)| opcode == op::CHUNK && unpack(body).is_ok())
        })
    }

    /// From the end of the data section: checksums, footer, end magic.
    fn end(&mut self, at: usize, body: &[u8]) {
        if let Ok(Record::DataEnd(end)) = parse(op::DATA_END, body) {
            let sum = crc32fast::hash(&self.bytes[..at]);
            // A chunk that is wrong makes this sum wrong too; that needs no second word.
            if end.data_section_crc != 0 && end.data_section_crc != sum && self.out.findings.is_empty() {
                self.corrupt(format!(
                    "the checksum of the data section is {sum:08x}, needed {:08x}: something outside the chunks was \
                     changed",
                    end.data_section_crc
                ));
            }
        } else {
            self.corrupt("the record that ends the data section is unreadable");
        }
        let summary_start = at + RECORD_HEAD + body.len();
        let bytes = self.bytes;
        // The footer is the last record: its two offsets and the checksum of all from the summary to itself.
        const FOOTER: usize = 20;
        let tail = FOOTER + mcap::MAGIC.len();
        let footer = bytes
            .len()
            .checked_sub(tail + RECORD_HEAD)
            .filter(|f| *f >= summary_start);
        let whole = footer.is_some() && bytes.ends_with(mcap::MAGIC);
        match footer.and_then(|f| self.record(f).ok().map(|(opcode, body)| (f, opcode, body))) {
            Some((f, op::FOOTER, body)) if whole && body.len() == FOOTER => {
                if let Ok(Record::Footer(footer)) = parse(op::FOOTER, body) {
                    let sum = crc32fast::hash(&bytes[summary_start..f + RECORD_HEAD + 16]);
                    let changed = footer.summary_crc != 0 && footer.summary_crc != sum;
                    // A file may have no summary.
                    let elsewhere = footer.summary_start != 0 && footer.summary_start != summary_start as u64;
                    if changed || elsewhere {
                        self.corrupt(
                            "the checksum of the index at the end of the file is wrong; the steps are not touched",
                        );
                    }
                }
            }
            _ => self.out.findings.push(Finding::new(
                FindingKind::Unfinished,
                "the index at the end of the file is not whole; the steps are not touched",
            )),
        }
    }
}

/// Kind and content of the first record, and what follows it.
fn split_record(bytes: &[u8]) -> Result<(u8, &[u8], &[u8]), CutShort> {
    let (opcode, rest) = bytes.split_first().ok_or(CutShort)?;
    let (length, rest) = rest.split_first_chunk::<8>().ok_or(CutShort)?;
    let length = usize::try_from(u64::from_le_bytes(*length)).map_err(|_| CutShort)?;
    let (body, rest) = rest.split_at_checked(length).ok_or(CutShort)?;
    Ok((*opcode, body, rest))
}

/// One of the kinds of records that this file reads.
fn parse(opcode: u8, body: &[u8]) -> Result<Record<'_>, String> {
    mcap::read::parse_record(opcode, body).map_err(|e| format!("an unreadable record of kind {opcode:#04x} ({e})"))
}

/// Content of a chunk, checked.
fn unpack(body: &[u8]) -> Result<Vec<u8>, String> {
    let Record::Chunk { header, data } = parse(op::CHUNK, body)? else {
        return Err("not a chunk".to_owned());
    };
    if header.uncompressed_size > CHUNK_LIMIT {
        return Err(format!(
            "a chunk of {} bytes, at most {CHUNK_LIMIT} are read",
            header.uncompressed_size
        ));
    }
    let mut content = Vec::new();
    match header.compression.as_str() {
        "" => content.extend_from_slice(&data),
        "zstd" => {
            // One byte more than it should have shows a wrong length without unpacking all.
            let unpacked = zstd::Decoder::new(&*data)
                .and_then(|decoder| decoder.take(header.uncompressed_size + 1).read_to_end(&mut content));
            unpacked.map_err(|e| format!("a chunk that cannot be unpacked ({e})"))?;
        }
        "lz4" => {
            let unpacked = lz4_flex::frame::FrameDecoder::new(&*data)
                .take(header.uncompressed_size + 1)
                .read_to_end(&mut content);
            unpacked.map_err(|e| format!("a chunk that cannot be unpacked ({e})"))?;
        }
        other => return Err(format!("a chunk packed by `{other}`, only zstd and lz4 are read")),
    }
    let sum = crc32fast::hash(&content);
    if content.len() as u64 != header.uncompressed_size {
        return Err(format!(
            "a chunk unpacks to {} bytes, needed {}",
            content.len(),
            header.uncompressed_size
        ));
    }
    // Zero says that there is no checksum.
    if header.uncompressed_crc != 0 && sum != header.uncompressed_crc {
        return Err(format!(
            "the checksum of a chunk is {sum:08x}, needed {:08x}: its content was changed",
            header.uncompressed_crc
        ));
    }
    Ok(content)
}
