//! Headings of columns as manuals print them: `Alpha [deg]`, `a (mm)`, `alpha_i-1`, `θ`, `$\theta_i$`, `d_mm`.

use super::units::Unit;

/// What a heading says.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Heading {
    /// As it is written.
    pub written: String,
    /// `theta`, `d`, `alpha`, `a`, `beta`, `offset` (of theta), `row`, `joint`, `kind`, …; else the words in lower case.
    pub name: String,
    /// The unit that it states.
    pub unit: Option<Unit>,
    /// Its numbers belong to the link before (`alpha_i-1`): the table is a proximal one.
    pub of_link_before: bool,
}

/// What messages list as headings that are understood.
pub(super) const ACCEPTED: &str = "theta (θ, q), d, alpha (α), a, each with its unit if you like (\"alpha [deg]\", \
                                   \"a (mm)\", \"d_mm\", \"alpha_i-1\"), in any order; or wx, wy, wz, vx, vy, vz for screw axes";

impl Heading {
    pub fn of(written: &str) -> Self {
        let mut text: String = written.to_lowercase().chars().filter(|c| !"$\\{}*`\"".contains(*c)).collect();
        text = plain(text.trim());
        let mut unit = None;
        for (open, close) in [('[', ']'), ('(', ')')] {
            while let Some(start) = text.find(open) {
                let end = text[start..].find(close).map_or(text.len(), |end| start + end);
                let inside = text[start + 1..end].trim().to_owned();
                let kept = if inside.ends_with("-1") { inside.clone() } else { String::new() };
                unit = unit.or_else(|| Unit::of(&inside));
                let behind = text.get(end + 1..).unwrap_or_default();
                text = format!("{}{kept}{behind}", &text[..start]);
            }
        }
        let words = text.trim();
        let (words, unit) = match (unit, words.rsplit_once([' ', '_', '/', ','])) {
            (None, Some((name, word))) if !name.trim().is_empty() && Unit::of(word).is_some() => {
                (name.trim().trim_end_matches([',', '/']).trim_end_matches(" in"), Unit::of(word))
            }
            (unit, _) => (words, unit),
        };
        let words = words.trim();
        let squeezed: String = words.chars().filter(|c| !" _.,".contains(*c)).collect();
        let (stem, of_link_before) =
            match ["i-1", "j-1", "n-1", "k-1"].iter().find_map(|end| squeezed.strip_suffix(end)) {
                Some(stem) if !stem.is_empty() => (stem.to_owned(), true),
                _ => (squeezed, false),
            };
        let name = meaning(&stem)
            .or_else(|| meaning(stem.strip_suffix(['i', 'j', 'n', 'k']).unwrap_or_default()))
            .map_or_else(|| words.to_owned(), str::to_owned);
        Self { written: written.to_owned(), name, unit, of_link_before }
    }
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
            '₋' | '−' | '–' | '—' => out.push('-'),
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
        "offset" | "thetaoffset" | "theta0" | "qoffset" | "q0" | "jointoffset" => "offset",
        "row" | "i" | "j" | "n" | "#" | "no" | "nr" | "link" | "axis" | "frame" => "row",
        "joint" | "name" | "jointname" => "joint",
        "kind" | "type" | "jointtype" => "kind",
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
            ("joint_type", "kind", None, false),
            ("wx", "wx", None, false),
            ("pitch", "pitch", None, false),
        ] {
            let found = Heading::of(written);
            assert_eq!((found.name.as_str(), found.unit, found.of_link_before), (name, unit, before), "{written}");
        }
    }
}
