//! The visible files: those on disk, or others instead of them, such as those in a browser's memory or of a
//! revision in git.
//!
//! While files are [held](with), this thread and the expansions that it starts see them instead of the whole disk, or
//! instead of the contents of a folder on disk.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fmt;
use std::io::{Error, ErrorKind, Result};
use std::path::{Component, Path, PathBuf};
use std::sync::Arc;

/// Files that replace those on disk.
///
/// They have absolute names, such as `/arm_description/urdf/arm.xacro`.
#[derive(Debug, Default)]
pub struct FileOverlay {
    files: BTreeMap<PathBuf, Content>,
    links: BTreeMap<PathBuf, Content>,
    refused: BTreeMap<PathBuf, String>,
    seen: Seen,
}

/// What is visible of the disk in addition to held files.
#[derive(Debug, Default)]
enum Seen {
    #[default]
    Nothing,
    /// What is not below this folder.
    Outside(PathBuf),
    /// Every file that is not held.
    Rest,
}

enum Content {
    Bytes(Vec<u8>),
    Later(Box<dyn Fn() -> Result<Vec<u8>> + Send + Sync>),
}

impl fmt::Debug for Content {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Bytes(bytes) => write!(f, "{} bytes", bytes.len()),
            Self::Later(_) => f.write_str("to be read"),
        }
    }
}

impl Content {
    fn bytes(&self) -> Result<Vec<u8>> {
        match self {
            Self::Bytes(bytes) => Ok(bytes.clone()),
            Self::Later(read) => read(),
        }
    }
}

impl FileOverlay {
    /// No files, instead of the contents of a folder on disk; elsewhere the disk is visible.
    pub fn below(folder: impl Into<PathBuf>) -> Self {
        Self { seen: Seen::Outside(folder.into()), ..Self::default() }
    }

    /// No files, over those of the disk: a file that is added hides the one of its name, as an editor's unsaved text does.
    pub fn over_the_disk() -> Self {
        Self { seen: Seen::Rest, ..Self::default() }
    }

    /// Adds a file.
    pub fn add(&mut self, name: &Path, bytes: Vec<u8>) {
        self.files.insert(lexical(name), Content::Bytes(bytes));
    }

    /// Adds a file that is read on first use.
    pub fn add_later(&mut self, name: &Path, read: impl Fn() -> Result<Vec<u8>> + Send + Sync + 'static) {
        self.files.insert(lexical(name), Content::Later(Box::new(read)));
    }

    /// Adds a link; what is read is the name that it leads to.
    pub fn add_link(&mut self, name: &Path, read: impl Fn() -> Result<Vec<u8>> + Send + Sync + 'static) {
        self.links.insert(lexical(name), Content::Later(Box::new(read)));
    }

    /// Adds a folder whose files cannot be given, and why.
    pub fn refuse(&mut self, folder: &Path, why: impl Into<String>) {
        self.refused.insert(lexical(folder), why.into());
    }

    fn missing(&self, path: &Path) -> Error {
        match path.ancestors().find_map(|above| self.refused.get(above)) {
            Some(why) => Error::other(why.clone()),
            None => Error::from(ErrorKind::NotFound),
        }
    }

    fn holds_folder(&self, folder: &Path) -> bool {
        let first = |names: &BTreeMap<PathBuf, Content>| {
            let mut from_here =
                names.range(folder.to_path_buf()..).map(|(name, _)| name).filter(|name| *name != folder);
            from_here.next().is_some_and(|name| name.starts_with(folder))
        };
        first(&self.files) || first(&self.links)
    }

    /// The held file that a path leads to, by its name or by the links of the disk.
    fn hiding(&self, path: &Path) -> Option<PathBuf> {
        let named = lexical(&std::path::absolute(path).ok()?);
        if self.files.contains_key(&named) {
            return Some(named);
        }
        // Few files are held: a link is followed only where the last name is one of theirs.
        let last = named.file_name()?;
        self.files.keys().any(|held| held.file_name() == Some(last)).then_some(())?;
        path.canonicalize().ok().filter(|real| self.files.contains_key(real))
    }

    fn bytes(&self, path: &Path) -> Result<Vec<u8>> {
        self.files.get(path).ok_or_else(|| self.missing(path))?.bytes()
    }

    /// The name with the links in it followed; `None` where they lead in a circle, or cannot be read.
    fn resolved(&self, path: &Path) -> Option<PathBuf> {
        const MOST_LINKS: usize = 40;
        let mut path = path.to_path_buf();
        for _ in 0..MOST_LINKS {
            let Some(link) = path.ancestors().find(|above| self.links.contains_key(*above)) else { return Some(path) };
            let target = String::from_utf8(self.links.get(link)?.bytes().ok()?).ok()?;
            let rest = path.strip_prefix(link).ok()?;
            path = lexical(&link.parent()?.join(target).join(rest));
        }
        None
    }
}

thread_local! {
    static HELD: RefCell<Option<Arc<FileOverlay>>> = const { RefCell::new(None) };
}

/// Runs `work` with held files; with `None` on the disk.
pub fn with<T>(held: Option<Arc<FileOverlay>>, work: impl FnOnce() -> T) -> T {
    /// Puts back what was held before, also where `work` panics.
    struct Before(Option<Arc<FileOverlay>>);
    impl Drop for Before {
        fn drop(&mut self) {
            HELD.set(self.0.take());
        }
    }
    let _before = Before(HELD.replace(held));
    work()
}

/// The files that this thread holds, for another thread.
pub(crate) fn held() -> Option<Arc<FileOverlay>> {
    HELD.with_borrow(Clone::clone)
}

/// Whether files are held in place of the whole disk.
pub fn are_held() -> bool {
    HELD.with_borrow(|held| held.as_ref().is_some_and(|held| matches!(held.seen, Seen::Nothing)))
}

/// The content of a file.
///
/// # Errors
/// There is no such file, or it cannot be read.
pub fn read(path: &Path) -> Result<Vec<u8>> {
    look_up(path, FileOverlay::bytes, |path| std::fs::read(path))
}

/// Whether there is such a file.
pub fn is_file(path: &Path) -> bool {
    look_up(path, |held, path| held.files.contains_key(path), Path::is_file)
}

/// Whether there is such a folder.
pub fn is_folder(path: &Path) -> bool {
    look_up(path, FileOverlay::holds_folder, Path::is_dir)
}

/// Whether there is such a file or folder.
pub fn exists(path: &Path) -> bool {
    let is_held = |held: &FileOverlay, path: &Path| held.files.contains_key(path) || held.holds_folder(path);
    look_up(path, is_held, Path::exists)
}

/// The absolute name of what is there, links resolved.
///
/// # Errors
/// There is nothing.
pub fn canonical(path: &Path) -> Result<PathBuf> {
    let name = |held: &FileOverlay, path: &Path| {
        let is_there = held.files.contains_key(path) || held.holds_folder(path);
        if is_there { Ok(path.to_path_buf()) } else { Err(held.missing(path)) }
    };
    look_up(path, name, Path::canonicalize)
}

/// The absolute form of a name; nothing need be there.
///
/// # Errors
/// The working directory is unknown.
pub fn absolute(path: &Path) -> Result<PathBuf> {
    if are_held() { Ok(lexical(path)) } else { std::path::absolute(path) }
}

/// The number of bytes of a file; `None` for a folder.
///
/// # Errors
/// There is nothing.
pub fn size(path: &Path) -> Result<Option<u64>> {
    let held = |held: &FileOverlay, path: &Path| match held.files.get(path) {
        Some(content) => content.bytes().map(|bytes| Some(bytes.len() as u64)),
        None if held.holds_folder(path) => Ok(None),
        None => Err(held.missing(path)),
    };
    look_up(path, held, |path| std::fs::metadata(path).map(|found| found.is_file().then_some(found.len())))
}

/// The files and folders in a folder, in no order; none where there is no such folder.
pub(crate) fn entries(folder: &Path) -> Vec<PathBuf> {
    let held = |held: &FileOverlay, inside: &Path| {
        let below = |names: &BTreeMap<PathBuf, Content>| -> Vec<PathBuf> {
            let names = names.range(inside.to_path_buf()..).map(|(name, _)| name);
            let names = names.take_while(|name| name.starts_with(inside));
            names.filter_map(|name| Some(folder.join(name.strip_prefix(inside).ok()?.components().next()?))).collect()
        };
        let mut names = below(&held.files);
        names.extend(below(&held.links));
        names.sort();
        names.dedup();
        names
    };
    look_up(folder, held, |folder| {
        std::fs::read_dir(folder)
            .map_or_else(|_| Vec::new(), |found| found.flatten().map(|entry| entry.path()).collect())
    })
}

/// Looks among the held files where they stand in place of the disk, and on the disk elsewhere.
fn look_up<T>(path: &Path, held: impl FnOnce(&FileOverlay, &Path) -> T, disk: impl FnOnce(&Path) -> T) -> T {
    let Some(files) = self::held() else { return disk(path) };
    let root = match &files.seen {
        Seen::Nothing => {
            let path = lexical(path);
            let resolved = files.resolved(&path).unwrap_or(path);
            return held(&files, &resolved);
        }
        Seen::Rest => return if let Some(name) = files.hiding(path) { held(&files, &name) } else { disk(path) },
        Seen::Outside(root) => root,
    };
    let Some(inside) = inside(path, root) else { return disk(path) };
    match files.resolved(&inside) {
        Some(resolved) if resolved.starts_with(root) => held(&files, &resolved),
        // A link may lead out of the folder.
        Some(resolved) => disk(&resolved),
        None => held(&files, &inside),
    }
}

/// The absolute name of `path` if it is below `root`, by its name or by the links of the disk that lead there.
fn inside(path: &Path, root: &Path) -> Option<PathBuf> {
    let path = lexical(&std::path::absolute(path).ok()?);
    if path.starts_with(root) {
        return Some(path);
    }
    let real = path.ancestors().find_map(|above| {
        let real = above.canonicalize().ok()?;
        Some(real.join(path.strip_prefix(above).ok()?))
    })?;
    real.starts_with(root).then_some(real)
}

/// The name from `/` on, without `.` and `..`; nothing is above `/`.
fn lexical(path: &Path) -> PathBuf {
    let mut out = PathBuf::from("/");
    for component in path.components() {
        match component {
            Component::Normal(name) => out.push(name),
            Component::ParentDir => {
                out.pop();
            }
            // A drive of Windows.
            Component::Prefix(prefix) => {
                out = PathBuf::from(prefix.as_os_str());
                out.push(std::path::MAIN_SEPARATOR_STR);
            }
            _ => {}
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Options, PackagePath, Source, expand};

    /// Runs `work` with these files in place of the disk; relative names begin at `/`.
    fn with_held<T>(files: impl IntoIterator<Item = (PathBuf, Vec<u8>)>, work: impl FnOnce() -> T) -> T {
        let mut held = FileOverlay::default();
        for (name, bytes) in files {
            held.add(&name, bytes);
        }
        with(Some(Arc::new(held)), work)
    }

    fn text(name: &str, text: &str) -> (PathBuf, Vec<u8>) {
        (name.into(), text.as_bytes().to_vec())
    }

    #[test]
    fn a_xacro_file_and_its_packages_expand_from_memory() {
        let arm = r#"<robot name="arm" xmlns:xacro="http://ros.org/wiki/xacro">
            <xacro:include filename="$(find tools)/gripper.xacro"/><xacro:include filename="parts/*.xacro"/></robot>"#;
        let part =
            |link: &str| format!("<robot xmlns:xacro=\"http://ros.org/wiki/xacro\"><link name=\"{link}\"/></robot>");
        let files = [
            text("/ros/arm/package.xml", "<package><name>arm</name></package>"),
            text("/ros/arm/arm.xacro", arm),
            text("/ros/arm/parts/one.xacro", &part("one")),
            text("/ros/hand/package.xml", "<package><name>tools</name></package>"),
            text("/ros/hand/gripper.xacro", &part("finger")),
        ];
        let expanded = with_held(files, || expand(&Source::path("/ros/arm/arm.xacro"), &[], &Options::default()));
        let urdf = expanded.unwrap().urdf;
        assert!(urdf.contains("\"finger\"") && urdf.contains("\"one\""), "{urdf}");
        assert!(!are_held());
    }

    #[test]
    fn nothing_of_the_disk_and_nothing_above_the_top_is_seen_while_files_are_held() {
        with_held([text("a/../../b.txt", "b")], || {
            assert_eq!(read(Path::new("/b.txt")).unwrap(), b"b");
            assert!(!exists(Path::new(env!("CARGO_MANIFEST_DIR"))));
            assert!(PackagePath::default().packages().is_empty());
        });
        assert!(exists(Path::new(env!("CARGO_MANIFEST_DIR"))));
    }

    #[test]
    fn an_unsaved_text_hides_the_file_of_its_name_and_nothing_else() {
        let top = Path::new(env!("CARGO_MANIFEST_DIR")).canonicalize().unwrap();
        let mut held = FileOverlay::over_the_disk();
        held.add(&top.join("Cargo.toml"), b"unsaved".to_vec());
        held.add(&top.join("not/saved.xacro"), b"new".to_vec());
        with(Some(Arc::new(held)), || {
            assert!(!are_held());
            assert_eq!(read(&top.join("src/../Cargo.toml")).unwrap(), b"unsaved");
            assert_eq!(read(&top.join("not/saved.xacro")).unwrap(), b"new");
            assert!(is_file(&top.join("src/lib.rs")) && !exists(&top.join("not/other.xacro")));
            assert_eq!(canonical(&top.join("Cargo.toml")).unwrap(), top.join("Cargo.toml"));
            assert!(entries(&top).contains(&top.join("src")));
        });
        assert_ne!(read(&top.join("Cargo.toml")).unwrap(), b"unsaved");
    }

    #[test]
    fn below_a_folder_held_files_stand_in_place_of_the_disk_and_links_are_followed() {
        let top = Path::new(env!("CARGO_MANIFEST_DIR")).canonicalize().unwrap();
        let mut held = FileOverlay::below(&top);
        held.add(&top.join("src/old.txt"), b"old".to_vec());
        held.add_link(&top.join("link"), || Ok(b"src".to_vec()));
        held.add_link(&top.join("circle"), || Ok(b"circle".to_vec()));
        held.refuse(&top.join("part"), "part is a submodule");
        with(Some(Arc::new(held)), || {
            assert!(!are_held());
            assert_eq!(read(&top.join("src/../link/old.txt")).unwrap(), b"old");
            assert_eq!(canonical(&top.join("link/old.txt")).unwrap(), top.join("src/old.txt"));
            assert!(is_folder(&top.join("link")) && !exists(&top.join("src/files.rs")) && !exists(&top.join("circle")));
            assert_eq!(read(&top.join("part/a.txt")).unwrap_err().to_string(), "part is a submodule");
            assert!(is_file(&top.join("../../Cargo.toml")), "elsewhere the disk is seen");
            assert_eq!(entries(&top), ["circle", "link", "src"].map(|name| top.join(name)));
        });
        assert!(exists(&top.join("src/files.rs")));
    }
}
