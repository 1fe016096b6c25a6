//! The messages of a bag, in any storage format.

use crate::error::BagError;
use mcap::io::MessageReader;
use mcap::sans_io::linear_reader::LinearReaderOptions;
use rusqlite::{Connection, OpenFlags};
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// A message as it was recorded.
pub(crate) struct Recorded<'a> {
    pub topic: &'a str,
    /// Its type, such as `sensor_msgs/msg/JointState`.
    pub kind: &'a str,
    /// By the recorder's clock, s.
    pub logged: f64,
    pub bytes: &'a [u8],
}

const MCAP: &str = "mcap";
const SQLITE: &str = "db3";
/// What `ros2 bag record` appends to the names of files that it compresses.
const PACKED: &str = "zstd";
/// How zstd's frames begin (RFC 8878, 3.1.1); a message in CDR begins with 0.
const ZSTD: [u8; 4] = [0x28, 0xB5, 0x2F, 0xFD];

/// Largest message, bytes; a wrong length could otherwise allocate all memory.
const LARGEST_RECORD: usize = 1 << 28;

/// Whether a name is that of a bag: a file of `ros2 bag record`, or a folder that holds such files.
pub fn is_bag(name: &str) -> bool {
    let path = Path::new(name);
    if path.is_dir() {
        return parts(path).is_ok_and(|parts| !parts.is_empty());
    }
    of_bag(path)
}

/// `mcap` or `db3`.
fn extension(path: &Path) -> Option<&'static str> {
    let own = path.extension()?.to_str()?;
    [MCAP, SQLITE].into_iter().find(|known| known.eq_ignore_ascii_case(own))
}

/// Whether a file's name is that of a part of a bag, compressed or not.
fn of_bag(path: &Path) -> bool {
    let packed = path.extension().is_some_and(|own| own == PACKED);
    extension(if packed { Path::new(path.file_stem().unwrap_or_default()) } else { path }).is_some()
}

fn parts(folder: &Path) -> std::io::Result<Vec<PathBuf>> {
    let files = std::fs::read_dir(folder)?.map(|entry| entry.map(|entry| entry.path()));
    let mut files = files.collect::<std::io::Result<Vec<_>>>()?;
    files.retain(|file| of_bag(file));
    // `ros2 bag` numbers the files of a recording: run_2 comes before run_10.
    files.sort_by_key(|file| (file.as_os_str().len(), file.clone()));
    Ok(files)
}

/// The files that a bag's messages are kept in, in the order of the recording.
///
/// # Errors
/// A folder that cannot be looked into, or holds none.
pub fn files(name: &str) -> Result<Vec<PathBuf>, BagError> {
    let path = Path::new(name);
    let cannot_open = |error: std::io::Error| BagError::Open { file: name.into(), what: error.to_string() };
    let files = if path.is_dir() { parts(path).map_err(cannot_open)? } else { vec![path.to_owned()] };
    if files.is_empty() { Err(BagError::NoBag { folder: name.into() }) } else { Ok(files) }
}

/// Gives every message of a bag to `each`, in the order of the recording's files. In memory are one chunk of MCAP or one message.
///
/// # Errors
/// Files that cannot be opened or are no bag; what `each` finds.
pub(crate) fn messages(name: &str, each: &mut dyn FnMut(Recorded<'_>) -> Result<(), BagError>) -> Result<(), BagError> {
    let cannot_open = |error: std::io::Error| BagError::Open { file: name.into(), what: error.to_string() };
    let files = files(name)?;
    for file in files {
        let shown = file.display().to_string();
        match extension(&file) {
            Some(MCAP) => of_mcap(&shown, std::fs::File::open(&file).map_err(cannot_open)?, each)?,
            Some(_) => {
                // SQLite would make a file that is not there.
                std::fs::File::open(&file).map_err(cannot_open)?;
                of_sqlite(&shown, &file, each)?;
            }
            None => return Err(BagError::Compressed { file: shown }),
        }
    }
    Ok(())
}

fn of_mcap(
    file: &str,
    source: std::fs::File,
    each: &mut dyn FnMut(Recorded<'_>) -> Result<(), BagError>,
) -> Result<(), BagError> {
    let broken = |error: mcap::McapError| BagError::Broken { file: file.into(), what: error.to_string() };
    let options =
        LinearReaderOptions::default().with_validate_chunk_crcs(true).with_record_length_limit(LARGEST_RECORD);
    for message in MessageReader::new_with_options(std::io::BufReader::new(source), options) {
        let message = message.map_err(broken)?;
        let Some(schema) = &message.channel.schema else { continue };
        not_packed(file, &message.data)?;
        each(Recorded {
            topic: &message.channel.topic,
            kind: &schema.name,
            logged: seconds(i128::from(message.log_time)),
            bytes: &message.data,
        })?;
    }
    Ok(())
}

fn of_sqlite(
    file: &str,
    path: &Path,
    each: &mut dyn FnMut(Recorded<'_>) -> Result<(), BagError>,
) -> Result<(), BagError> {
    let broken = |error: rusqlite::Error| BagError::Broken { file: file.into(), what: error.to_string() };
    let opened = Connection::open_with_flags(path, OpenFlags::SQLITE_OPEN_READ_ONLY).map_err(broken)?;
    let mut topics: HashMap<i64, (String, String)> = HashMap::new();
    let mut query = opened.prepare("SELECT id, name, type FROM topics").map_err(broken)?;
    let mut rows = query.query([]).map_err(broken)?;
    while let Some(row) = rows.next().map_err(broken)? {
        let text = |column: usize| row.get::<_, String>(column).map_err(broken);
        topics.insert(row.get(0).map_err(broken)?, (text(1)?, text(2)?));
    }
    // No join: SQLite would sort the messages themselves where it begins with the topics.
    let mut query =
        opened.prepare("SELECT topic_id, timestamp, data FROM messages ORDER BY timestamp, id").map_err(broken)?;
    let mut rows = query.query([]).map_err(broken)?;
    while let Some(row) = rows.next().map_err(broken)? {
        let id = row.get::<_, i64>(0).map_err(broken)?;
        let Some((topic, kind)) = topics.get(&id) else {
            return Err(BagError::Broken {
                file: file.into(),
                what: format!("a message of topic {id}, which is not listed"),
            });
        };
        let logged = seconds(i128::from(row.get::<_, i64>(1).map_err(broken)?));
        let blob = row.get_ref(2).map_err(broken)?;
        let bytes = blob.as_blob().map_err(|error| broken(error.into()))?;
        not_packed(file, bytes)?;
        each(Recorded { topic, kind, logged, bytes })?;
    }
    Ok(())
}

fn not_packed(file: &str, bytes: &[u8]) -> Result<(), BagError> {
    if bytes.starts_with(&ZSTD) { Err(BagError::CompressedMessages { file: file.into() }) } else { Ok(()) }
}

/// Nanoseconds since 1970 as seconds; a double resolves 0.2 µs there.
fn seconds(nanoseconds: i128) -> f64 {
    nanoseconds as f64 * 1e-9
}
