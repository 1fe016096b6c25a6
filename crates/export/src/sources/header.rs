//! Headings of columns as manuals print them: `Alpha [deg]`, `a (mm)`, `alpha_i-1`, `θ`, `$\theta_i$`, `d_mm`, `d ["]`.

use denavit_model::chain::Quantity;
use denavit_model::units::Unit;

/// A parsed heading.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Heading {
    /// As it is written.
    pub written: String,
    /// `theta`, `d`, `alpha`, `a`, `beta`, `offset` (of theta), `row`, `joint`, `kind`, …; else the words in lower case.
    pub name: String,
    /// The unit that it states.
    pub unit: Option<Unit>,
    /// What is in its brackets and is neither a unit nor another word for the column.
    pub unknown: Option<String>,
    /// Its numbers belong to the previous link (`alpha_i-1`): the table is proximal.
    pub of_link_before: bool,
    /// It is only "offset": that of the joint's variable, which may be theta or d.
    pub plain_offset: bool,
}

/// What messages list as headings that are understood.
pub(super) const ACCEPTED: &str = "theta (θ, q), d, alpha (α), a, each with its unit if you like (\"alpha [deg]\", \
                                   \"a (mm)\", \"d_mm\", \"alpha_i-1\"), in any order; or wx, wy, wz, vx, vy, vz for screw axes";

/// Columns with a meaning; others are reported.
pub(super) const KNOWN: [&str; 23] = [
    "theta",
    "d",
    "alpha",
    "a",
    "r",
    "beta",
    "offset",
    "row",
    "joint",
    "kind",
    "pitch",
    "scale",
    "convention",
    "limits",
    "lower",
    "upper",
    "wx",
    "wy",
    "wz",
    "vx",
    "vy",
    "vz",
    "",
];

/// The quantity of a column, if it has one.
pub(super) fn quantity_of(name: &str) -> Option<Quantity> {
    match name {
        "theta" | "offset" | "alpha" | "beta" => Some(Quantity::Angle),
        "d" | "a" | "r" | "vx" | "vy" | "vz" => Some(Quantity::Length),
        _ => None,
    }
}

impl Heading {
    pub fn of(written: &str) -> Self {
        let mut text: String = written.to_lowercase().chars().filter(|c| !"$\\{}*`".contains(*c)).collect();
        text = plain(text.trim());
        let mut inside = Vec::new();
        for (open, close) in [('[', ']'), ('(', ')')] {
            while let Some(start) = text.find(open) {
                let end = text[start..].find(close).map_or(text.len(), |end| start + end);
                let within = text[start + open.len_utf8()..end].trim().to_owned();
                let kept = if within.ends_with("-1") { within.clone() } else { String::new() };
                if kept.is_empty() {
                    inside.extend(within.split([',', ';']).map(|part| part.trim().to_owned()));
                }
                let behind = text.get(end + close.len_utf8()..).unwrap_or_default();
                text = format!("{}{kept}{behind}", &text[..start]);
            }
        }
        let words = text.trim();
        let (words, mut unit) = match words.rsplit_once([' ', '_', '/', ',']) {
            Some((name, word)) if inside.is_empty() => {
                let name = name.trim().trim_end_matches([',', '/']).trim_end_matches(" in").trim();
                let unit = quantity_of(&named(name).0).and_then(|quantity| Unit::of(word, quantity));
                if unit.is_some() { (name, unit) } else { (words, None) }
            }
            _ => (words, None),
        };
        let (name, of_link_before) = named(words);
        let mut unknown = None;
        for part in inside.into_iter().filter(|part| !part.is_empty() && !is_index(part)) {
            let of_part = quantity_of(&name).and_then(|quantity| Unit::of(&part, quantity));
            if let (Some(found), true) = (of_part, unit.is_none() || unit == of_part) {
                unit = Some(found);
            } else if !says_the_same(&part, &name) {
                unknown = unknown.or(Some(part));
            }
        }
        let plain_offset = name == "offset" && !words.contains("th");
        Self { written: written.to_owned(), name, unit, unknown, of_link_before, plain_offset }
    }
}

/// The name of a column, and whether its numbers belong to the link before.
fn named(words: &str) -> (String, bool) {
    let words = words.trim().trim_matches('"').trim();
    let squeezed: String = words.chars().filter(|c| !" _.,\"".contains(*c)).collect();
    let (stem, of_link_before) = match ["i-1", "j-1", "n-1", "k-1"].iter().find_map(|end| squeezed.strip_suffix(end)) {
        Some(stem) if !stem.is_empty() => (stem.to_owned(), true),
        _ => (squeezed, false),
    };
    let name = meaning(&stem)
        .or_else(|| meaning(stem.strip_suffix(['i', 'j', 'n', 'k']).unwrap_or_default()))
        .map_or_else(|| words.to_owned(), str::to_owned);
    (name, of_link_before)
}

fn is_index(word: &str) -> bool {
    ["i", "j", "n", "k"].contains(&word)
}

/// `d (link offset)`, `θ (joint angle)`: a heading with its meaning repeated; for other columns such words are ignored.
fn says_the_same(part: &str, name: &str) -> bool {
    quantity_of(name).is_none() && name != "pitch" && name != "scale"
        || named(part).0 == name
        || (name == "theta" && ["variable", "joint variable", "joint"].contains(&part))
}

/// Greek letters as words, subscripts as plain letters.
pub(super) fn plain(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        match c {
            'θ' | 'ϑ' | 'Θ' => out.push_str("theta"),
            'α' | '⍺' | 'Α' => out.push_str("alpha"),
            'β' => out.push_str("beta"),
            '₀'..='₉' => out.extend(char::from_digit(u32::from(c) - u32::from('₀'), 10)),
            'ᵢ' => out.push('i'),
            'ⱼ' => out.push('j'),
            'ₙ' => out.push('n'),
            'ₖ' => out.push('k'),
            '₋' | '−' | '–' | '—' | '⁻' => out.push('-'),
            '⁺' => out.push('+'),
            c => out.push(c),
        }
    }
    out
}

fn meaning(word: &str) -> Option<&'static str> {
    Some(match word {
        "theta" | "th" | "q" | "angle" | "jointangle" => "theta",
        "d" | "linkoffset" => "d",
        "alpha" | "twist" | "linktwist" | "twistangle" => "alpha",
        "a" | "length" | "linklength" => "a",
        "r" => "r",
        "beta" => "beta",
        "offset" | "thetaoffset" | "offsettheta" | "theta0" | "qoffset" | "q0" | "jointoffset" => "offset",
        "row" | "i" | "j" | "n" | "#" | "no" | "nr" | "link" | "axis" | "frame" => "row",
        "joint" | "name" | "jointname" => "joint",
        "kind" | "type" | "jointtype" => "kind",
        "limits" | "limit" | "jointlimits" | "jointlimit" | "qlim" | "range" | "jointrange" => "limits",
        "q-" | "qmin" | "min" | "lower" | "lowerlimit" | "minimum" => "lower",
        "q+" | "qmax" | "max" | "upper" | "upperlimit" | "maximum" => "upper",
        "pitch" => "pitch",
        "scale" => "scale",
        "convention" => "convention",
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headings_as_manuals_print_them() {
        for (written, name, unit, before) in [
            ("Alpha [deg]", "alpha", Some(Unit::Degree), false),
            ("a (mm)", "a", Some(Unit::Millimetre), false),
            ("alpha_i-1", "alpha", None, true),
            ("α(i-1) [rad]", "alpha", Some(Unit::Radian), true),
            ("$\\alpha_{i-1}$ (°)", "alpha", Some(Unit::Degree), true),
            ("aᵢ₋₁", "a", None, true),
            ("θ", "theta", None, false),
            ("**θᵢ**", "theta", None, false),
            ("theta_offset_rad", "offset", Some(Unit::Radian), false),
            ("d_mm", "d", Some(Unit::Millimetre), false),
            ("d_m", "d", Some(Unit::Metre), false),
            ("Link length, mm", "a", Some(Unit::Millimetre), false),
            ("d in mm", "d", Some(Unit::Millimetre), false),
            ("a / m", "a", Some(Unit::Metre), false),
            ("⍺ⱼ", "alpha", None, false),
            ("Joint", "joint", None, false),
            ("Joint (name)", "joint", None, false),
            ("joint_type", "kind", None, false),
            ("wx", "wx", None, false),
            ("pitch", "pitch", None, false),
            ("d [in]", "d", Some(Unit::Inch), false),
            ("d [\"]", "d", Some(Unit::Inch), false),
            ("d \"", "d", Some(Unit::Inch), false),
            ("\"d\"", "d", None, false),
            ("alpha [\"]", "alpha", Some(Unit::Arcsecond), false),
            ("α [']", "alpha", Some(Unit::Arcminute), false),
            ("d (link offset, mils)", "d", Some(Unit::Mil), false),
            ("theta (joint angle) [grad]", "theta", Some(Unit::Gradian), false),
            ("a_ft", "a", Some(Unit::Foot), false),
            ("q⁻", "lower", None, false),
            ("q⁺", "upper", None, false),
        ] {
            let found = Heading::of(written);
            assert_eq!((found.name.as_str(), found.unit, found.of_link_before), (name, unit, before), "{written}");
            assert_eq!(found.unknown, None, "{written}");
        }
    }

    #[test]
    fn what_stands_in_brackets_and_is_no_unit_of_the_column() {
        for (written, unknown) in [
            ("d [furlong]", "furlong"),
            ("d [deg]", "deg"),
            ("alpha (mm)", "mm"),
            ("a (mm, in)", "in"),
            ("alpha [min]", "min"),
            ("offset [cubits]", "cubits"),
            ("a [mm/s]", "mm/s"),
        ] {
            assert_eq!(Heading::of(written).unknown.as_deref(), Some(unknown), "{written}");
        }
    }
}
