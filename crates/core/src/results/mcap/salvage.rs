//! Repairs an interrupted MCAP file: restores its end and its index.
//!
//! The file is read in order up to its last complete record; a chunk is complete if its check sum is right. The
//! records are written to a new file, which replaces the old one only when it is complete.

use std::fs::File;
use std::io::{self, BufReader, BufWriter, Read};
use std::path::{Path, PathBuf};

use ::mcap::records::{Header, Record, op};
use ::mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};
use ::mcap::{Attachment, MAGIC, McapError, McapResult, Writer, parse_record};
use miette::Diagnostic;

use super::super::lock::lock;
use super::super::output::{LOCK, OutputError};
use super::resuming::Until;
use super::{into_io, options};
use crate::error::IoError;
use crate::files::{self, NewFile};

/// Errors of repairing a file.
#[derive(Debug, thiserror::Error, Diagnostic)]
pub enum SalvageError {
    /// A file that cannot be read or written.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Io(#[from] IoError),
    /// The file does not begin as an MCAP file.
    #[error("{}: no MCAP file: it does not begin like one", .0.display())]
    #[diagnostic(help(
        "name the run.mcap in the folder of a run; if this is one, it was cut within its first bytes \
         and holds nothing"
    ))]
    NotMcap(PathBuf),
    /// The run that writes the file is in progress, or another run is using its folder.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Locked(#[from] OutputError),
}

/// Result of a repair.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Salvaged {
    /// Messages in the file.
    pub messages: u64,
    /// Attachments in the file.
    pub attachments: u64,
    /// Number of bytes after the last complete record, which are dropped.
    pub lost_bytes: u64,
    /// Whether the file was complete and is unchanged.
    pub was_whole: bool,
}

/// Reads `file` up to its last complete record and writes a complete file in its place, or to `out`. A complete file
/// is unchanged unless `out` is given. The file of a run in progress is not replaced, because the run would continue
/// to write to the old one.
///
/// # Errors
/// `file` cannot be read or is not an MCAP file; it would be replaced although a run has locked its folder; or the
/// new file cannot be written. `file` is unchanged then.
pub fn salvage(file: &Path, out: Option<&Path>) -> Result<Salvaged, SalvageError> {
    let at = |path: &Path| {
        let path = path.to_owned();
        move |why| IoError { path, why }
    };
    let target = out.unwrap_or(file);
    let replaces = files::replaced(target, &[file.to_owned()]).is_some();
    let _lock = if replaces { lock_of_run(file)? } else { None };
    let mut source = Source::open(file).map_err(at(file))?;
    let Some(header) = source.begin().map_err(at(file))? else {
        return Err(SalvageError::NotMcap(file.to_owned()));
    };
    let new = NewFile::create(target).map_err(at(target))?;
    let outcome = rewrite(source, &header, &new).and_then(|found| {
        if !found.was_whole || out.is_some() {
            new.keep()?;
        }
        Ok(found)
    });
    Ok(outcome.map_err(at(target))?)
}

/// Takes the lock of the run in whose folder the file lies, if there is one.
fn lock_of_run(file: &Path) -> Result<Option<File>, OutputError> {
    let folder = file.parent().unwrap_or(Path::new(""));
    let is_run = folder.join(LOCK).symlink_metadata().is_ok();
    is_run.then(|| lock(folder)).transpose()
}

fn rewrite(mut source: Source, header: &Header, new: &NewFile) -> io::Result<Salvaged> {
    let mut writer = options(&header.profile, &header.library)
        .create(BufWriter::new(new.file()?))
        .map_err(into_io)?;
    let found = copy(&mut source, &mut writer, None)?;
    writer.finish().map_err(into_io)?;
    let file = writer.into_inner().into_inner();
    file.map_err(io::IntoInnerError::into_error)?.sync_all()?;
    Ok(found)
}

/// Writer of an MCAP file.
pub(super) type Out = Writer<BufWriter<File>>;

/// Copies the complete records that pass the filter and leaves the new file open; `None` if the file is not an MCAP
/// file.
pub(super) fn copy_until(
    file: &Path,
    new: BufWriter<File>,
    until: &mut Until,
) -> io::Result<Option<(Out, Salvaged)>> {
    let mut source = Source::open(file)?;
    let Some(header) = source.begin()? else {
        return Ok(None);
    };
    until.begin(&header);
    let mut writer = options(&header.profile, &header.library)
        .create(new)
        .map_err(into_io)?;
    let found = copy(&mut source, &mut writer, Some(until))?;
    Ok(Some((writer, found)))
}

/// Copies complete records that pass the filter, up to the end of the data or the first damage.
fn copy(
    source: &mut Source,
    writer: &mut Out,
    mut until: Option<&mut Until>,
) -> io::Result<Salvaged> {
    let mut found = Salvaged::default();
    let mut room = LEAST_BYTES.saturating_add(source.length.saturating_mul(MOST_PACKED));
    loop {
        let kept = source.read;
        let record = source.record()?;
        let taken = match &record {
            Some((op::DATA_END, _)) => {
                found.was_whole = source.ends_well()?;
                return Ok(found);
            }
            Some((op::CHUNK, body)) => match records_of_chunk(body, &mut room) {
                Ok(records) => {
                    let taken = take_all(&records, writer, until.as_deref_mut(), &mut found)?;
                    // Keeps the division into chunks.
                    writer.flush().map_err(into_io)?;
                    taken
                }
                Err(_) => false,
            },
            Some((opcode, body)) => take(*opcode, body, writer, until.as_deref_mut(), &mut found)?,
            None => false,
        };
        if !taken {
            found.lost_bytes = source.length - kept;
            return Ok(found);
        }
    }
}

fn take_all(
    records: &[(u8, Vec<u8>)],
    out: &mut Out,
    mut until: Option<&mut Until>,
    found: &mut Salvaged,
) -> io::Result<bool> {
    for (opcode, body) in records {
        if !take(*opcode, body, out, until.as_deref_mut(), found)? {
            return Ok(false);
        }
    }
    Ok(true)
}

/// Writes a record and returns false if it is invalid. Indices are rebuilt.
fn take(
    opcode: u8,
    body: &[u8],
    writer: &mut Out,
    until: Option<&mut Until>,
    found: &mut Salvaged,
) -> io::Result<bool> {
    // The parser assumes that an attachment has its check sum.
    if opcode == 0 || (opcode == op::ATTACHMENT && body.len() < LEAST_ATTACHMENT) {
        return Ok(false);
    }
    let Ok(record) = parse_record(opcode, body) else {
        return Ok(false);
    };
    if until.is_some_and(|until| !until.keeps(&record)) {
        return Ok(true);
    }
    let written = match record {
        Record::Schema { header, data } => writer
            .add_schema_with_id(header.id, &header.name, &header.encoding, &data)
            .map(drop),
        Record::Channel(c) => writer
            .add_channel_with_id(
                c.id,
                c.schema_id,
                &c.topic,
                &c.message_encoding,
                &c.metadata,
            )
            .map(drop),
        Record::Message { header, data } => {
            found.messages += 1;
            writer.write_to_known_channel(&header, &data)
        }
        Record::Attachment { header, data, .. } => {
            found.attachments += 1;
            writer.attach(&Attachment {
                log_time: header.log_time,
                create_time: header.create_time,
                name: header.name,
                media_type: header.media_type,
                data,
            })
        }
        Record::Metadata(metadata) => writer.write_metadata(&metadata),
        Record::MessageIndex(_) | Record::Unknown { .. } => Ok(()),
        // No other record may precede the end of the data.
        _ => return Ok(false),
    };
    match written {
        Ok(()) => Ok(true),
        // A record that contradicts earlier ones is damaged.
        Err(
            McapError::ConflictingChannels(_)
            | McapError::ConflictingSchemas(_)
            | McapError::InvalidSchemaId
            | McapError::UnknownChannel(..)
            | McapError::UnknownSchema(..),
        ) => Ok(false),
        Err(error) => Err(into_io(error)),
    }
}

/// Length of the footer before the check sum of the summary, which covers it [byte].
const FOOTER_SUMMED: usize = 16;

/// Least size: two times, lengths of two texts and of the data, and the check sum [byte].
const LEAST_ATTACHMENT: usize = 8 + 8 + 4 + 4 + 8 + 4;

/// Bounds against damaged or hostile lengths [byte]: size of a chunk; total size of all chunks per byte of the file
/// (JSON compresses to about a tenth); and total size allowed for any file.
const MOST_BYTES: u64 = 1 << 28;
const MOST_PACKED: u64 = 256;
const LEAST_BYTES: u64 = 1 << 26;

/// Records of a chunk with a valid check sum. Their size is subtracted from `room`, the bytes still allowed.
fn records_of_chunk(body: &[u8], room: &mut u64) -> McapResult<Vec<(u8, Vec<u8>)>> {
    let Record::Chunk { header, data } = parse_record(op::CHUNK, body)? else {
        return Err(McapError::UnexpectedEoc);
    };
    // In an uncompressed chunk nothing may follow the records.
    if header.compression.is_empty()
        && (data.len() as u64 != header.uncompressed_size || !body.ends_with(&data))
    {
        return Err(McapError::UnexpectedEoc);
    }
    let size = header.uncompressed_size;
    if size > MOST_BYTES || size > *room {
        return Err(McapError::ChunkTooLarge(size));
    }
    *room -= size;
    drop(data);
    let limit = (size as usize).max(body.len());
    let mut reader = LinearReader::new_with_options(
        LinearReaderOptions::default()
            .with_skip_start_magic(true)
            .with_skip_end_magic(true)
            .with_prevalidate_chunk_crcs(true)
            .with_record_length_limit(limit),
    );
    let mut bytes = Vec::with_capacity(9 + body.len());
    bytes.push(op::CHUNK);
    bytes.extend((body.len() as u64).to_le_bytes());
    bytes.extend_from_slice(body);
    let mut bytes = bytes.as_slice();
    let mut records = Vec::new();
    while let Some(event) = reader.next_event() {
        match event? {
            LinearReadEvent::ReadRequest(wanted) => {
                let wanted = wanted.min(bytes.len());
                let read = bytes.read(reader.insert(wanted))?;
                reader.notify_read(read);
            }
            LinearReadEvent::Record { opcode, data } => records.push((opcode, data.to_vec())),
        }
    }
    Ok(records)
}

/// An MCAP file, read record by record.
struct Source {
    file: BufReader<File>,
    /// Length of the file [byte].
    length: u64,
    /// Number of bytes read, up to the end of a record.
    read: u64,
}

impl Source {
    fn open(path: &Path) -> io::Result<Self> {
        let file = files::open(path)?;
        Ok(Self {
            length: file.metadata()?.len(),
            file: BufReader::new(file),
            read: 0,
        })
    }

    /// The header; `None` if the file is not an MCAP file.
    fn begin(&mut self) -> io::Result<Option<Header>> {
        if self.bytes(MAGIC.len() as u64)?.as_deref() != Some(MAGIC) {
            return Ok(None);
        }
        let record = self.record()?;
        let Some((op::HEADER, body)) = &record else {
            return Ok(None);
        };
        match parse_record(op::HEADER, body) {
            Ok(Record::Header(header)) => Ok(Some(header)),
            _ => Ok(None),
        }
    }

    /// The next record; `None` if it is incomplete.
    fn record(&mut self) -> io::Result<Option<(u8, Vec<u8>)>> {
        let Some(head) = self.bytes(9)? else {
            return Ok(None);
        };
        let Some((&opcode, length)) = head.split_first() else {
            return Ok(None);
        };
        let length = length.iter().rev().fold(0, |n, b| (n << 8) | u64::from(*b));
        Ok(self.bytes(length)?.map(|body| (opcode, body)))
    }

    /// Whether the file ends, after the data, with a summary with a valid check sum, a footer and the magic bytes.
    fn ends_well(&mut self) -> io::Result<bool> {
        let mut sum = crc32fast::Hasher::new();
        loop {
            let Some((opcode, body)) = self.record()? else {
                return Ok(false);
            };
            sum.update(&[opcode]);
            sum.update(&(body.len() as u64).to_le_bytes());
            let (summed, stored) = if opcode == op::FOOTER {
                body.split_at(body.len().min(FOOTER_SUMMED))
            } else {
                (&body[..], &[][..])
            };
            sum.update(summed);
            if opcode == op::FOOTER {
                let magic = self.bytes(MAGIC.len() as u64)?;
                let closed = magic.as_deref() == Some(MAGIC) && self.read == self.length;
                return Ok(closed && stored == sum.finalize().to_le_bytes());
            }
        }
    }

    /// The next bytes; `None` if there are fewer.
    fn bytes(&mut self, count: u64) -> io::Result<Option<Vec<u8>>> {
        if count > self.length.saturating_sub(self.read) {
            return Ok(None);
        }
        let mut bytes = Vec::new();
        (&mut self.file).take(count).read_to_end(&mut bytes)?;
        self.read += bytes.len() as u64;
        Ok((bytes.len() as u64 == count).then_some(bytes))
    }
}
