//! Where the fixtures are, and short ways to expand.

use std::path::{Path, PathBuf};

use denavit_xacro::{Environment, Expanded, Limits, Options, PackagePath, Source, XacroError, expand};

/// The folder of the fixtures.
pub fn fixtures() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures")
}

/// Options with the packages below `folder`.
pub fn packages_in(folder: &Path) -> Options {
    let packages = PackagePath::new(&[folder.to_path_buf()], &Environment::default());
    Options { packages, ..Options::default() }
}

/// A robot around `body`, which begins on line 2.
pub fn robot(body: &str) -> String {
    format!("<robot xmlns:xacro=\"http://www.ros.org/wiki/xacro\">\n{body}\n</robot>")
}

/// Expands a robot with this body.
pub fn expand_body(body: &str) -> Result<Expanded, XacroError> {
    expand_with(body, Limits::default())
}

/// Expands a robot with this body within other limits.
pub fn expand_with(body: &str, limits: Limits) -> Result<Expanded, XacroError> {
    let source = Source::Text { name: "robot.xacro".to_owned(), text: robot(body), folder: None };
    expand(&source, &[], &Options { limits, ..Options::default() })
}

/// The text of an error, without the folders of this machine.
pub fn without_folders(text: &str) -> String {
    let folder = fixtures();
    let real = folder.canonicalize().unwrap();
    let mut text = text.to_owned();
    for folder in [folder, real] {
        text = text.replace(&format!("{}/", folder.display()), "");
    }
    text
}
