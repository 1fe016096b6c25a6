//! What each column of a measurement file is.

use super::MeasurementKind;
use super::near_miss::{OF_JOINTS, near_miss, orientation_left_out};
use super::problem::Problem;
use denavit_model::{Coordinate, Quantity};

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    /// Reading of this coordinate.
    Joint(usize),
    /// Component 0-2 of this target's position.
    Position(usize, usize),
    /// Component of the quaternion: x, y, z, w.
    Quaternion(usize),
    /// Distance from the anchor.
    Distance,
    /// Whether the row only places targets.
    Locate,
    /// Something else: a number or a text.
    Other,
}

/// The columns of a file.
#[derive(Debug, Clone)]
pub(super) struct Header {
    pub names: Vec<String>,
    pub roles: Vec<Role>,
    pub kind: MeasurementKind,
    pub targets: Vec<String>,
}

const COMPONENTS: [&str; 3] = ["x", "y", "z"];
const QUATERNION: [&str; 4] = ["qx", "qy", "qz", "qw"];

impl Header {
    /// Reads the header row.
    pub fn read(names: Vec<String>, coordinates: &[Coordinate]) -> Result<Self, Vec<Problem>> {
        let mut problems = naming(&names)?;
        let targets = targets(&names, &mut problems);
        let roles = roles(&names, coordinates, &targets);
        for (index, coordinate) in coordinates.iter().enumerate() {
            if !roles.contains(&Role::Joint(index)) {
                problems.push(missing_joint(coordinate, &names, &roles, coordinates));
            }
        }
        let kind = kind(&names, &roles, &targets, &mut problems);
        for (name, role) in names.iter().zip(&roles) {
            if *role == Role::Other {
                let suggested = problems.iter().any(
                    |problem| matches!(problem, Problem::NothingMeasured { suggestion: Some(other) } if other == name),
                );
                let near = || near_miss(name, &names, coordinates).filter(|_| !suggested);
                problems.extend(unknown_joint(name, coordinates).or_else(near));
            }
        }
        problems.extend(orientation_left_out(&names, &roles));
        if !problems.is_empty() {
            return Err(problems);
        }
        let targets = if kind == MeasurementKind::Distance { vec![String::new()] } else { targets };
        Ok(Self { names, roles, kind, targets })
    }
}

/// What is wrong with the names as such.
///
/// # Errors
/// The columns are separated by something else than commas: nothing else can be said then.
pub(super) fn naming(names: &[String]) -> Result<Vec<Problem>, Vec<Problem>> {
    if let [only] = names {
        for (separator, word) in [(';', "semicolons"), ('\t', "tabs"), (' ', "spaces")] {
            if only.contains(separator) {
                return Err(vec![Problem::Separator { found: only.clone(), separator: word }]);
            }
        }
    }
    let mut problems = Vec::new();
    for (index, name) in names.iter().enumerate() {
        if name.is_empty() {
            problems.push(Problem::NamelessColumn(index + 1));
        } else if names[..index].contains(name) {
            problems.push(Problem::DuplicateColumn(name.clone()));
        }
    }
    Ok(problems)
}

/// Names of the targets: what follows x, y, z; digits alone.
fn targets(names: &[String], problems: &mut Vec<Problem>) -> Vec<String> {
    let mut targets: Vec<String> = Vec::new();
    for name in names {
        let Some(suffix) = name.strip_prefix(['x', 'y', 'z']) else { continue };
        if suffix.chars().all(|c| c.is_ascii_digit()) && !targets.iter().any(|target| target == suffix) {
            targets.push(suffix.into());
        }
    }
    for target in &targets {
        let columns = COMPONENTS.map(|component| format!("{component}{target}"));
        let present = columns.iter().find(|column| names.contains(column)).cloned().unwrap_or_default();
        for missing in columns.iter().filter(|column| !names.contains(column)) {
            let group = columns.join(", ");
            problems.push(Problem::Incomplete { missing: missing.clone(), present: present.clone(), group });
        }
    }
    targets
}

fn roles(names: &[String], coordinates: &[Coordinate], targets: &[String]) -> Vec<Role> {
    let role = |name: &String| {
        if let Some(index) = coordinates.iter().position(|coordinate| coordinate.name == *name) {
            return Role::Joint(index);
        }
        if let Some(component) = QUATERNION.iter().position(|q| q == name) {
            return Role::Quaternion(component);
        }
        for (target, suffix) in targets.iter().enumerate() {
            for (component, letter) in COMPONENTS.iter().enumerate() {
                if name.strip_prefix(letter) == Some(suffix) {
                    return Role::Position(target, component);
                }
            }
        }
        match name.as_str() {
            "distance" => Role::Distance,
            "locate" => Role::Locate,
            _ => Role::Other,
        }
    };
    names.iter().map(role).collect()
}

fn kind(names: &[String], roles: &[Role], targets: &[String], problems: &mut Vec<Problem>) -> MeasurementKind {
    let quaternion = QUATERNION.iter().filter(|q| names.iter().any(|name| name == *q)).count();
    let distance = roles.contains(&Role::Distance);
    if distance && !targets.is_empty() {
        problems.push(Problem::TwoKinds(format!("x{}", targets[0]), "distance".into()));
    }
    if !distance && targets.is_empty() {
        let other = |wanted: &str| {
            names.iter().zip(roles).find(|(name, role)| {
                **role == Role::Other && (name.eq_ignore_ascii_case(wanted) || nearly(name, wanted))
            })
        };
        let suggestion = ["distance", "x", "x1"].iter().find_map(|wanted| other(wanted)).map(|(name, _)| name.clone());
        problems.push(Problem::NothingMeasured { suggestion });
    }
    if quaternion > 0 {
        for missing in QUATERNION.iter().filter(|q| !names.iter().any(|name| name == *q)) {
            problems.push(Problem::Incomplete {
                missing: (*missing).into(),
                present: QUATERNION
                    .iter()
                    .find(|q| names.iter().any(|name| name == *q))
                    .copied()
                    .unwrap_or("qx")
                    .into(),
                group: "qx, qy, qz, qw".into(),
            });
        }
        if targets.len() > 1 {
            problems.push(Problem::QuaternionOfSeveral(targets.len()));
        }
        if distance {
            problems.push(Problem::TwoKinds("qx".into(), "distance".into()));
        }
    }
    match (distance, quaternion > 0) {
        (true, _) => MeasurementKind::Distance,
        (false, true) => MeasurementKind::Pose,
        (false, false) => MeasurementKind::Position,
    }
}

fn missing_joint(coordinate: &Coordinate, names: &[String], roles: &[Role], coordinates: &[Coordinate]) -> Problem {
    let free = names.iter().zip(roles).filter(|(_, role)| **role == Role::Other).map(|(name, _)| name.as_str());
    no_column(coordinate, free, coordinates)
}

/// A joint without a column; `free`: columns that are nothing else.
pub(super) fn no_column<'a>(
    coordinate: &Coordinate,
    free: impl Iterator<Item = &'a str>,
    coordinates: &[Coordinate],
) -> Problem {
    Problem::MissingJoint {
        joint: coordinate.name.clone(),
        suggestion: nearest(&coordinate.name, free),
        joints: coordinates.iter().map(|c| c.name.as_str()).collect::<Vec<_>>().join(", "),
    }
}

fn unknown_joint(column: &str, coordinates: &[Coordinate]) -> Option<Problem> {
    let (joint, quantity) = column.rsplit_once('.')?;
    let known = OF_JOINTS.contains(&quantity);
    if !known || coordinates.iter().any(|coordinate| coordinate.name == joint) {
        return None;
    }
    let suggestion = nearest(joint, coordinates.iter().map(|coordinate| coordinate.name.as_str()));
    Some(Problem::ColumnOfUnknownJoint { column: column.into(), joint: joint.into(), suggestion })
}

/// The candidate that is most like a name, if one is like it at all.
fn nearest<'a>(name: &str, candidates: impl Iterator<Item = &'a str>) -> Option<String> {
    candidates
        .map(|candidate| (strsim::jaro_winkler(&name.to_lowercase(), &candidate.to_lowercase()), candidate))
        .filter(|(likeness, candidate)| *likeness > 0.88 || candidate.eq_ignore_ascii_case(name))
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| candidate.into())
}

fn nearly(name: &str, wanted: &str) -> bool {
    wanted.len() > 3 && strsim::damerau_levenshtein(&name.to_lowercase(), wanted) <= 2
}

/// Whether a covariate's values count angles or lengths of a joint, so that units apply: `<joint>.velocity`.
pub(super) fn quantity_of(column: &str, coordinates: &[Coordinate]) -> Option<Quantity> {
    let (joint, word) = column.rsplit_once('.')?;
    (word == "velocity").then(|| coordinates.iter().find(|c| c.name == joint).map(|c| c.quantity)).flatten()
}
