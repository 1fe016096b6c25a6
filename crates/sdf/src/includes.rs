//! What an `<include>` names is fetched by the caller: this crate opens no files.

/// Gives the text that a URI (`model://pr2`, `package://…`, a relative path) stands for in a file of this name: the name that
/// messages call it by, and its text; or why there is none.
pub type Fetch<'a> = dyn FnMut(&str, &str) -> Result<(String, String), String> + 'a;

/// A [`Fetch`] for texts that include nothing.
///
/// # Errors
/// Always: no file can be looked up.
pub fn nothing(_uri: &str, _from: &str) -> Result<(String, String), String> {
    Err("no files are read here".to_owned())
}
