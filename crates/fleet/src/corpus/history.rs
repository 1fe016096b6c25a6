//! A history in git: which commits changed which robots.

use super::files::{CorpusFile, look_at};
use super::{CorpusOptions, in_parallel};
use crate::error::FleetError;
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

/// How a commit changed a robot's file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Became {
    /// It was not there before.
    New,
    /// It is gone.
    Removed,
    /// Its motion changed.
    Motion,
    /// It moves as before, but masses or shapes changed.
    Matter,
    /// Another text of the same robot.
    Same,
    /// One of the two texts is not a robot.
    Unreadable,
}

/// A robot's file in a commit that touched it.
#[derive(Debug, Clone, Serialize)]
pub struct GitChange {
    /// The commit.
    pub commit: String,
    /// Its day.
    pub date: String,
    /// First line of its message.
    pub subject: String,
    /// The file, from the top of the repository.
    pub path: String,
    /// How it changed.
    pub became: Became,
    /// Fingerprint after it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fingerprint: Option<String>,
    /// Why a text is not a robot.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error: Option<String>,
}

/// The URDF files that each commit of a history touched, the newest first; every text is read once. Merges are left out:
/// what they bring is in the commits that they merge.
///
/// # Errors
/// The folder is in no repository, the revision is unknown.
pub fn changes(repository: &Path, revision: &str, options: &CorpusOptions) -> Result<Vec<GitChange>, FleetError> {
    if revision.starts_with('-') {
        return Err(FleetError::Git(format!("{revision}: a revision may not begin with \"-\"")));
    }
    let log = git(
        repository,
        &[
            "log",
            "--raw",
            "--no-abbrev",
            "--no-renames",
            "--no-merges",
            "-z",
            "--format=%x01%H%x02%cs%x02%s%x02",
            "--end-of-options",
            revision,
            "--",
            "*.urdf",
        ],
    )?;
    let log = String::from_utf8_lossy(&log).into_owned();
    let touched = touched(&log);
    let mut texts: BTreeMap<&str, Result<CorpusFile, String>> = BTreeMap::new();
    for touch in &touched {
        for blob in [touch.before, touch.after].into_iter().flatten() {
            texts.entry(blob).or_insert_with(|| Err(String::new()));
        }
    }
    let blobs: Vec<&str> = texts.keys().copied().collect();
    let read = in_parallel(&blobs, options.threads, |blob| {
        let bytes = git(repository, &["cat-file", "blob", blob]).map_err(|error| error.to_string())?;
        let text = String::from_utf8(bytes).map_err(|_| "not UTF-8 text".to_owned())?;
        look_at("robot.urdf", &text, options.same)
    });
    let texts: BTreeMap<&str, Result<CorpusFile, String>> = blobs.into_iter().zip(read).collect();
    Ok(touched.iter().map(|touch| touch.change(&texts)).collect())
}

struct Touched<'a> {
    commit: &'a str,
    date: &'a str,
    subject: &'a str,
    path: &'a str,
    before: Option<&'a str>,
    after: Option<&'a str>,
}

impl Touched<'_> {
    fn change(&self, texts: &BTreeMap<&str, Result<CorpusFile, String>>) -> GitChange {
        let of = |blob: Option<&str>| blob.and_then(|blob| texts.get(blob));
        let (before, after) = (of(self.before), of(self.after));
        let error = |read: Option<&Result<CorpusFile, String>>| read.and_then(|read| read.as_ref().err()).cloned();
        let became = match (before, after) {
            (_, None) => Became::Removed,
            (_, Some(Err(_))) | (Some(Err(_)), _) => Became::Unreadable,
            (None, Some(Ok(_))) => Became::New,
            (Some(Ok(old)), Some(Ok(new))) => {
                let moves = old.motion == new.motion
                    || old.other_motions.contains(&new.motion)
                    || new.other_motions.contains(&old.motion);
                match (moves, old.fingerprint == new.fingerprint) {
                    (false, _) => Became::Motion,
                    (true, false) => Became::Matter,
                    (true, true) => Became::Same,
                }
            }
        };
        GitChange {
            commit: self.commit.to_owned(),
            date: self.date.to_owned(),
            subject: self.subject.to_owned(),
            path: self.path.to_owned(),
            became,
            fingerprint: after.and_then(|read| read.as_ref().ok()).map(|file| file.fingerprint.clone()),
            error: error(after).or_else(|| error(before)),
        }
    }
}

/// Git's `--raw -z` log: a commit's fields end in \x02; then `:MODES OLD NEW STATUS`, \0, PATH, \0 for each file.
fn touched(log: &str) -> Vec<Touched<'_>> {
    let known = |blob: &'_ str| !blob.bytes().all(|byte| byte == b'0');
    let mut found = Vec::new();
    for part in log.split('\u{1}').skip(1) {
        let mut fields = part.splitn(4, '\u{2}');
        let (Some(commit), Some(date), Some(subject), Some(raw)) =
            (fields.next(), fields.next(), fields.next(), fields.next())
        else {
            continue;
        };
        let mut words = raw.split('\0').map(|word| word.trim_start_matches('\n')).filter(|word| !word.is_empty());
        while let (Some(heading), Some(path)) = (words.next(), words.next()) {
            let mut blobs = heading.split(' ').skip(2);
            let (Some(old), Some(new)) = (blobs.next(), blobs.next()) else { continue };
            let (before, after) = (Some(old).filter(|blob| known(blob)), Some(new).filter(|blob| known(blob)));
            found.push(Touched { commit, date, subject, path, before, after });
        }
    }
    found
}

fn git(repository: &Path, arguments: &[&str]) -> Result<Vec<u8>, FleetError> {
    let run = Command::new("git").arg("-C").arg(repository).args(arguments).output();
    let run = run.map_err(|error| FleetError::Git(format!("git could not be run: {error}")))?;
    if run.status.success() {
        return Ok(run.stdout);
    }
    let said = String::from_utf8_lossy(&run.stderr);
    Err(FleetError::Git(format!("{}: git says: {}", repository.display(), said.trim())))
}
