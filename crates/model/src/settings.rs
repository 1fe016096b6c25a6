//! The caller's settings, as messages of the libraries name them.
//!
//! A library does not know its caller: `--units` on the command line is `units=` in Python and a word in a
//! document. Its messages mark each setting, such as `say ‹units› deg`, and the code that shows
//! them puts in its own form by [`shown`]. Only names in [`SETTINGS`] count as settings.

use std::borrow::Cow;

/// Before the name of a setting.
const OPEN: char = '‹';
/// After it.
const CLOSE: char = '›';

/// Who shows a message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Shown {
    /// The command line: `--hold-out`.
    CommandLine,
    /// Python: `hold_out=`.
    Python,
    /// A document, a store, a page: `hold-out`.
    Plain,
}

/// Every setting that a message names, in alphabetical order.
pub const SETTINGS: &[&str] = &[
    "allow",
    "allow-any-file",
    "base",
    "board",
    "box",
    "camera",
    "columns",
    "convention",
    "count-names",
    "data",
    "deny",
    "distance",
    "effects",
    "effects-out",
    "euler",
    "exact",
    "fix",
    "fix-inertia",
    "format",
    "gear-ratio",
    "given",
    "hold-out",
    "hold-out-setups",
    "joint-topic",
    "json",
    "keep-link-frames",
    "mass",
    "max-effects",
    "offsets-out",
    "only",
    "out-for",
    "package-path",
    "pitches",
    "plate",
    "prior",
    "quaternion",
    "rotation-vector",
    "rules",
    "scales",
    "set",
    "socket",
    "table-convention",
    "table-units",
    "target-topic",
    "tell-apart",
    "tip",
    "tolerance",
    "units",
    "up-to-zeros",
    "urdf",
    "write-baseline",
    "zeros",
];

/// The settings that a message names, in the order in which they stand in it.
pub fn named(message: &str) -> impl Iterator<Item = &'static str> {
    parts(message).filter_map(|(_, setting)| setting)
}

/// A message with its settings in the form of who shows it.
pub fn shown(message: &str, by: Shown) -> Cow<'_, str> {
    if !message.contains(OPEN) {
        return Cow::Borrowed(message);
    }
    let mut out = String::with_capacity(message.len());
    for (text, setting) in parts(message) {
        out.push_str(text);
        let Some(setting) = setting else { continue };
        match by {
            Shown::CommandLine => out.extend(["--", setting]),
            Shown::Python => out.extend([setting.replace('-', "_").as_str(), "="]),
            Shown::Plain => out.push_str(setting),
        }
    }
    Cow::Owned(out)
}

/// A message as a document has it.
pub fn plain(message: impl std::fmt::Display) -> String {
    let message = message.to_string();
    shown(&message, Shown::Plain).into_owned()
}

/// Texts, each with the setting that follows it.
fn parts(message: &str) -> impl Iterator<Item = (&str, Option<&'static str>)> {
    let mut rest = Some(message);
    std::iter::from_fn(move || {
        let text = rest?;
        let mut from = 0;
        while let Some(open) = text[from..].find(OPEN).map(|at| from + at) {
            let name = &text[open + OPEN.len_utf8()..];
            let name = name.find(CLOSE).map(|end| &name[..end]);
            let known = name.and_then(|name| Some(SETTINGS[SETTINGS.binary_search(&name).ok()?]));
            from = open + OPEN.len_utf8();
            if let Some(known) = known {
                rest = Some(&text[from + known.len() + CLOSE.len_utf8()..]);
                return Some((&text[..open], Some(known)));
            }
        }
        rest = None;
        Some((text, None))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_caller_reads_its_own_form() {
        let message = "measure some, or say ‹hold-out› 0.3; choose ‹base› and ‹tip›";
        let as_shown = |by| shown(message, by).into_owned();
        assert_eq!(as_shown(Shown::CommandLine), "measure some, or say --hold-out 0.3; choose --base and --tip");
        assert_eq!(as_shown(Shown::Python), "measure some, or say hold_out= 0.3; choose base= and tip=");
        assert_eq!(as_shown(Shown::Plain), "measure some, or say hold-out 0.3; choose base and tip");
        assert_eq!(named(message).collect::<Vec<_>>(), ["hold-out", "base", "tip"]);
        assert!(SETTINGS.is_sorted());
    }

    #[test]
    fn what_names_no_setting_stays_as_it_is() {
        for text in ["", "‹", "›", "‹elsewhere›", "a ‹b ‹", "‹‹›", "joint \"‹›\"", "é‹ü›"] {
            assert_eq!(shown(text, Shown::CommandLine), text);
        }
        assert_eq!(shown("‹‹tip›", Shown::CommandLine), "‹--tip");
        assert_eq!(shown("‹a‹tip››", Shown::Plain), "‹atip›");
    }
}
