//! What each column of a measurement file is.

use super::known_columns::{MOST_COLUMNS, OF_JOINTS};
use super::measurement_error::MeasurementError;
use super::near_miss::{near_miss, orientation_left_out};
use crate::board::Sight;
use crate::kinds::{KINDS, ObservationKind};
use denavit_model::{Coordinate, Quantity, Tips};
use std::collections::HashSet;

/// What a column holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Role {
    /// Reading of this coordinate.
    Joint(usize),
    /// A number of this group: which group, which of its columns.
    Value(usize, usize),
    /// Standard deviation of the lengths of this group and column, or of all lengths of the row.
    Spread(Option<(usize, usize)>),
    /// The corner of a board that the row sees, or its position on the board.
    Corner,
    /// Whether the row only locates targets.
    Locate,
    /// Something else: a number or a text.
    Other,
}

/// The columns of a file.
#[derive(Debug, Clone)]
pub(super) struct Header {
    pub names: Vec<String>,
    pub roles: Vec<Role>,
    pub groups: Vec<Group>,
    /// The column with the setup of a row.
    pub setup: Option<usize>,
    /// The column with the tip of a row, if there are several.
    pub tip: Option<usize>,
}

/// Columns that make up one observation.
#[derive(Debug, Clone)]
pub(super) struct Group {
    pub kind: ObservationKind,
    pub target: String,
    pub columns: Vec<String>,
    /// The column of its points' labels.
    pub label: Option<usize>,
    /// How the corners of a board are identified, if it is of one.
    pub corner: Option<CornerOf>,
    /// Whether two tips of the robot touch each other, or hold one tool: each row has its own contact position, and the label names the
    /// points of the tips, or the tool.
    pub of_two_tips: bool,
}

/// How a file identifies the corner of a board.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum CornerOf {
    /// By the names of its columns: `u12`, `v12`.
    Named(String),
    /// By a column `corner`.
    Numbered(usize),
    /// By its position on the board, in columns `board_x`, `board_y`.
    Placed([usize; 2]),
}

/// The columns with the touching points of two tips, and with the tool that two tips hold.
pub(super) const OF_TWO_TIPS: [(&str, ObservationKind); 2] =
    [("contact", ObservationKind::Socket), ("grip", ObservationKind::Grip)];

/// The column of the touching points or the held tool, for kinds of two tips.
pub fn word_of_two_tips(kind: ObservationKind) -> Option<&'static str> {
    OF_TWO_TIPS.iter().find(|(_, of)| *of == kind).map(|(word, _)| *word)
}

/// The columns with the position of a corner on the board.
const ON_BOARD: [&str; 2] = ["board_x", "board_y"];

const COMPONENTS: [&str; 3] = ["x", "y", "z"];
const QUATERNION: [&str; 4] = ["qx", "qy", "qz", "qw"];

impl Header {
    /// Reads the header row.
    pub fn read(
        names: Vec<String>,
        coordinates: &[Coordinate],
        sight: Option<&Sight>,
        tips: Option<&Tips>,
    ) -> Result<Self, Vec<MeasurementError>> {
        let mut problems = naming(&names)?;
        let targets = targets(&names, &mut problems);
        let mut groups = groups(&names, &targets);
        problems.extend(
            [ObservationKind::Gravity, ObservationKind::Inclination]
                .into_iter()
                .filter_map(|kind| part_of(kind, &names)),
        );
        for (word, kind) in OF_TWO_TIPS {
            let label = names.iter().position(|name| name == word);
            if label.is_some() && tips.is_some() {
                let target = kind.own_target().unwrap_or("").to_owned();
                groups.push(Group { kind, target, columns: Vec::new(), label, corner: None, of_two_tips: true });
            } else if label.is_some() && groups.is_empty() {
                return Err(vec![MeasurementError::TwoTipsOfOne(word)]);
            }
        }
        match sight {
            Some(sight) => groups.extend(corners(&names, sight, &mut problems)),
            None if groups.is_empty() && targets.is_empty() && !pixels(&names).is_empty() => {
                return Err(vec![MeasurementError::PixelsWithoutCamera]);
            }
            None => {}
        }
        let roles = roles(&names, coordinates, &groups);
        let free: Vec<&str> =
            names.iter().zip(&roles).filter(|(_, role)| **role == Role::Other).map(|(name, _)| name.as_str()).collect();
        let no_joint = !roles.iter().any(|role| matches!(role, Role::Joint(_)));
        let numbered = if no_joint { numbered_joints(&free, coordinates) } else { None };
        problems.extend(numbered.clone());
        for (index, coordinate) in coordinates.iter().enumerate() {
            if !roles.contains(&Role::Joint(index)) && numbered.is_none() {
                problems.push(missing_joint(coordinate, &names, &roles, coordinates));
            }
        }
        measured(&names, &roles, &groups, &targets, &mut problems);
        for (name, role) in names.iter().zip(&roles) {
            if *role == Role::Other {
                let suggested = problems.iter().any(
                    |problem| matches!(problem, MeasurementError::NothingMeasured { suggestion: Some(other) } if other == name),
                );
                let near = || near_miss(name, &names, coordinates).filter(|_| !suggested);
                problems.extend(unknown_joint(name, coordinates).or_else(near));
            }
        }
        let others: Vec<&String> =
            names.iter().zip(&roles).filter(|(_, role)| **role == Role::Other).map(|(name, _)| name).collect();
        problems.extend(orientation_left_out(&others));
        let tip = tips.and_then(|_| names.iter().position(|name| name == "tip"));
        if let (Some(tips), None) = (tips, tip) {
            problems.push(MeasurementError::NoTipColumn { tips: tip_names(tips) });
        }
        if !problems.is_empty() {
            return Err(problems);
        }
        let setup = names.iter().position(|name| name == "setup");
        Ok(Self { names, roles, groups, setup, tip })
    }
}

/// The tips for a message: `left_hand or right_hand`.
pub(super) fn tip_names(tips: &Tips) -> String {
    tips.all().iter().map(|tip| tip.name.as_str()).collect::<Vec<_>>().join(" or ")
}

/// Errors in the names as such.
///
/// # Errors
/// The columns are not separated by commas: no other check is possible then.
pub(super) fn naming(names: &[String]) -> Result<Vec<MeasurementError>, Vec<MeasurementError>> {
    if let [only] = names {
        for (separator, word) in [(';', "semicolons"), ('\t', "tabs"), (' ', "spaces")] {
            if only.contains(separator) {
                return Err(vec![MeasurementError::Separator { found: only.clone(), separator: word }]);
            }
        }
    }
    if names.len() > MOST_COLUMNS {
        return Err(vec![MeasurementError::TooManyColumns { found: names.len(), most: MOST_COLUMNS }]);
    }
    let mut problems = Vec::new();
    let mut known: HashSet<&str> = HashSet::with_capacity(names.len());
    for (index, name) in names.iter().enumerate() {
        if name.is_empty() {
            problems.push(MeasurementError::NamelessColumn(index + 1));
        } else if !known.insert(name) {
            problems.push(MeasurementError::DuplicateColumn(name.clone()));
        }
    }
    Ok(problems)
}

/// Names of the targets: what follows x, y, z; digits alone.
fn targets(names: &[String], problems: &mut Vec<MeasurementError>) -> Vec<String> {
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
            problems.push(MeasurementError::Incomplete { missing: missing.clone(), present: present.clone(), group });
        }
    }
    targets
}

/// Some columns of a kind, and not all.
fn part_of(kind: ObservationKind, names: &[String]) -> Option<MeasurementError> {
    let columns = kind.columns("");
    let present = columns.iter().find(|column| names.contains(column))?.clone();
    let missing = columns.iter().find(|column| !names.contains(column))?.clone();
    Some(MeasurementError::Incomplete { missing, present, group: columns.join(", ") })
}

/// The observations that a row may hold, by kind and target; no column belongs to two.
fn groups(names: &[String], targets: &[String]) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    for kind in KINDS.into_iter().filter(|kind| !kind.of_a_board()) {
        let unnamed = std::iter::once(String::new());
        for target in unnamed.chain(targets.iter().filter(|target| !target.is_empty()).cloned()) {
            let columns = kind.columns(&target);
            let free =
                |column: &String| names.contains(column) && !groups.iter().any(|group| group.columns.contains(column));
            let label = kind.label().and_then(|word| names.iter().position(|name| name == word));
            let known = groups.iter().any(|group| group.kind == kind && columns.is_empty());
            if columns.iter().all(free) && !known && (label.is_some() || !columns.is_empty()) {
                let target = kind.own_target().map_or(target, String::from);
                groups.push(Group { kind, target, columns, label, corner: None, of_two_tips: false });
            }
        }
    }
    groups
}

/// The suffix after u or v in the names of pixels: empty, or the number of a corner.
fn pixels(names: &[String]) -> Vec<String> {
    let mut corners: Vec<String> = Vec::new();
    for name in names {
        let Some(number) = name.strip_prefix(['u', 'v']) else { continue };
        if number.chars().all(|c| c.is_ascii_digit()) && !corners.iter().any(|known| known == number) {
            corners.push(number.into());
        }
    }
    corners
}

/// The corners of a board that a row may hold.
fn corners(names: &[String], sight: &Sight, problems: &mut Vec<MeasurementError>) -> Vec<Group> {
    let at = |wanted: &str| names.iter().position(|name| name == wanted);
    let mut groups = Vec::new();
    for number in pixels(names) {
        let columns = ObservationKind::Pixel.columns(&number);
        if let Some(missing) = columns.iter().find(|column| at(column).is_none()) {
            let present = columns.iter().find(|column| *column != missing).cloned().unwrap_or_default();
            problems.push(MeasurementError::Incomplete {
                missing: missing.clone(),
                present,
                group: columns.join(", "),
            });
            continue;
        }
        let corner = match (ON_BOARD.map(at), at("corner")) {
            _ if !number.is_empty() => CornerOf::Named(number),
            ([Some(x), Some(y)], _) => CornerOf::Placed([x, y]),
            (_, Some(column)) => CornerOf::Numbered(column),
            _ => {
                problems.push(MeasurementError::WhichCorner);
                continue;
            }
        };
        if sight.board.is_none() && !matches!(corner, CornerOf::Placed(_)) {
            problems.push(MeasurementError::NoBoard);
            return Vec::new();
        }
        groups.push(Group {
            kind: ObservationKind::Pixel,
            target: sight.on_tip().into(),
            columns,
            label: None,
            corner: Some(corner),
            of_two_tips: false,
        });
    }
    if groups.is_empty() && problems.is_empty() {
        problems.push(MeasurementError::NoPixels);
    }
    groups
}

fn roles(names: &[String], coordinates: &[Coordinate], groups: &[Group]) -> Vec<Role> {
    let role = |name: &String| {
        if let Some(index) = coordinates.iter().position(|coordinate| coordinate.name == *name) {
            return Role::Joint(index);
        }
        for (group, of) in groups.iter().enumerate() {
            if let Some(column) = of.columns.iter().position(|column| column == name) {
                return Role::Value(group, column);
            }
        }
        let tells_corner = |of: &Group| match of.corner {
            Some(CornerOf::Numbered(column)) => names[column] == *name,
            Some(CornerOf::Placed(columns)) => columns.iter().any(|column| names[*column] == *name),
            _ => false,
        };
        if groups.iter().any(tells_corner) {
            return Role::Corner;
        }
        let spread = |column: &str| {
            let at = |(group, of): (usize, &Group)| {
                let column = of.columns.iter().position(|own| own == column)?;
                (column < of.kind.lengths()).then_some((group, column))
            };
            groups.iter().enumerate().find_map(at)
        };
        match (name.as_str(), name.strip_suffix(".std").and_then(spread)) {
            ("locate", _) => Role::Locate,
            ("std", _) => Role::Spread(None),
            (_, Some(of)) => Role::Spread(Some(of)),
            _ => Role::Other,
        }
    };
    names.iter().map(role).collect()
}

/// Errors in the measured columns.
fn measured(
    names: &[String],
    roles: &[Role],
    groups: &[Group],
    targets: &[String],
    problems: &mut Vec<MeasurementError>,
) {
    let has = |wanted: &str| names.iter().any(|name| name == wanted);
    if groups.is_empty() && targets.is_empty() && pixels(names).is_empty() && problems.is_empty() {
        let other = |wanted: &str| {
            names.iter().zip(roles).find(|(name, role)| {
                **role == Role::Other && (name.eq_ignore_ascii_case(wanted) || nearly(name, wanted))
            })
        };
        let suggestion =
            ["distance", "x", "x1", "hole"].iter().find_map(|wanted| other(wanted)).map(|(name, _)| name.clone());
        problems.push(MeasurementError::NothingMeasured { suggestion });
    }
    let Some(present) = QUATERNION.iter().find(|name| has(name)) else { return };
    for missing in QUATERNION.iter().filter(|name| !has(name)) {
        problems.push(MeasurementError::Incomplete {
            missing: (*missing).into(),
            present: (*present).into(),
            group: "qx, qy, qz, qw".into(),
        });
    }
    if targets.len() > 1 {
        problems.push(MeasurementError::QuaternionOfSeveral(targets.len()));
    }
}

fn missing_joint(
    coordinate: &Coordinate,
    names: &[String],
    roles: &[Role],
    coordinates: &[Coordinate],
) -> MeasurementError {
    let free = names.iter().zip(roles).filter(|(_, role)| **role == Role::Other).map(|(name, _)| name.as_str());
    no_column(coordinate, free, coordinates)
}

/// Where no joint has a column: as many columns as joints that differ only by a number, and the map for them. `free`: columns
/// without another meaning.
pub(super) fn numbered_joints(free: &[&str], coordinates: &[Coordinate]) -> Option<MeasurementError> {
    let split = |name: &str| -> Option<(String, usize)> {
        let end = name.trim_end_matches([']', ')', '}']);
        let digits = end.len() - end.trim_end_matches(|c: char| c.is_ascii_digit()).len();
        let (stem, number) = end.split_at(end.len() - digits);
        Some((stem.to_owned(), number.parse().ok()?)).filter(|(stem, _)| !stem.is_empty())
    };
    let group = |stem: &String| -> Vec<(usize, &str)> {
        let own = free.iter().filter_map(|name| Some((split(name)?, *name))).filter(|((other, _), _)| other == stem);
        let mut all: Vec<(usize, &str)> = own.map(|((_, number), name)| (number, name)).collect();
        all.sort_unstable();
        all
    };
    let whole = |all: &Vec<(usize, &str)>| {
        all.len() == coordinates.len() && all.windows(2).all(|pair| pair[1].0 == pair[0].0 + 1)
    };
    // Positions are preferred to velocities, and actual to commanded values.
    let unlikely = |stem: &String| {
        let small = stem.to_lowercase();
        !["position", "actual_q_", "actual_q.", "actual_q["].iter().any(|word| small.contains(word))
    };
    let mut stems: Vec<String> = free.iter().filter_map(|name| split(name)).map(|(stem, _)| stem).collect();
    stems.dedup();
    stems.sort_by_key(unlikely);
    let columns = stems.iter().map(group).find(whole)?;
    let pair = |((_, column), joint): (&(usize, &str), &Coordinate)| format!("{}={column}", joint.name);
    let map = columns.iter().zip(coordinates).map(pair).collect::<Vec<_>>().join(",");
    let (first, last) = (columns.first()?.1.to_owned(), columns.last()?.1.to_owned());
    Some(MeasurementError::NumberedJoints { first, last, map })
}

/// A joint without a column; `free`: columns without another meaning.
pub(super) fn no_column<'a>(
    coordinate: &Coordinate,
    free: impl Iterator<Item = &'a str>,
    coordinates: &[Coordinate],
) -> MeasurementError {
    MeasurementError::MissingJoint {
        joint: coordinate.name.clone(),
        suggestion: nearest(&coordinate.name, free),
        joints: coordinates.iter().map(|c| c.name.as_str()).collect::<Vec<_>>().join(", "),
    }
}

fn unknown_joint(column: &str, coordinates: &[Coordinate]) -> Option<MeasurementError> {
    let (joint, quantity) = column.rsplit_once('.')?;
    let known = OF_JOINTS.contains(&quantity);
    if !known || coordinates.iter().any(|coordinate| coordinate.name == joint) {
        return None;
    }
    let suggestion = nearest(joint, coordinates.iter().map(|coordinate| coordinate.name.as_str()));
    Some(MeasurementError::ColumnOfUnknownJoint { column: column.into(), joint: joint.into(), suggestion })
}

/// The candidate most similar to a name, if there is a similar one.
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
