//! The caller fetches the files of `<include>` elements: this crate opens no files.

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

/// The file that a model's `model.config` names: the one of the newest version that is known here.
///
/// # Examples
/// ```
/// let config = r#"<model><sdf version="1.4">old.sdf</sdf><sdf version="1.6">arm.sdf</sdf></model>"#;
/// assert_eq!(denavit_sdf::includes::model_file(config).as_deref(), Some("arm.sdf"));
/// ```
pub fn model_file(config: &str) -> Option<String> {
    let document = roxmltree::Document::parse(config).ok()?;
    let named = document.descendants().filter(|node| node.has_tag_name("sdf"));
    let versions = named.filter_map(|node| {
        let mut numbers = node.attribute("version").unwrap_or("1.0").trim().split('.').map(str::parse::<u32>);
        let version = (numbers.next()?.ok()?, numbers.next().unwrap_or(Ok(0)).ok()?);
        (version <= crate::model::NEWEST).then(|| (version, node.text().unwrap_or_default().trim().to_owned()))
    });
    versions.filter(|(_, name)| !name.is_empty()).max().map(|(_, name)| name)
}
