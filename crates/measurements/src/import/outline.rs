//! The columns of a file, to ask the user what each one is.

use super::{ANGLE_COLUMNS, ImportProblem, QUATERNIONS, Work, bracketed, grid, map, names_a_joint, plain};
use crate::Units;
use denavit_model::Chain;
use serde::Serialize;

/// Number of values shown with a column's name.
const SHOWN: usize = 3;

/// A column of a file, and its likely meaning.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct FileColumn {
    /// Its name in the header row, or `column 2` where there is none.
    pub name: String,
    /// Its unit, where the file states it.
    pub unit: Option<String>,
    /// Its first values, as written.
    pub first: Vec<String>,
    /// The contract's name for it, such as a joint's, `x` or `temperature`; none where nothing suggests one.
    pub meaning: Option<String>,
    /// Whether its own name says so; otherwise it is a guess to confirm.
    pub sure: bool,
    /// Whether it is one of three angles or of four numbers of a quaternion whose order its name does not give.
    pub orientation: bool,
}

/// The columns of a file, in its order.
///
/// # Errors
/// A file without rows, or a workbook that cannot be read; the message does not name the file.
pub fn outline(bytes: &[u8], chain: &Chain) -> Result<Vec<FileColumn>, ImportProblem> {
    let cells = grid::read(bytes, &|name| names_a_joint(name, chain)).map_err(|fault| fault.problem)?;
    let work = Work { grid: &cells, chain, units: Units::default(), taken: Vec::new(), ignored: Vec::new() };
    let (joints, places) = (map::joint_columns(&cells, chain), map::place_columns(&cells));
    let said: Vec<Option<String>> = cells.names.iter().map(|name| work.meaning(name)).collect();
    let guess = |name: &String| {
        let joint = joints.iter().position(|column| *column == Some(name));
        let place = || places.iter().position(|column| *column == Some(name));
        let joint = joint.map(|k| chain.coordinates()[k].name.clone());
        // A meaning that another column's name states is not guessed for this one.
        joint
            .or_else(|| place().map(|k| ["x", "y", "z"][k].to_owned()))
            .filter(|guess| !said.contains(&Some(guess.clone())))
    };
    let letters = |name: &String| plain(name).replace(['_', '.'], "");
    let all: Vec<String> = cells.names.iter().map(letters).collect();
    let together = |group: &[&str]| group.iter().all(|name| all.iter().any(|own| own == name));
    let groups = || {
        let angles = ANGLE_COLUMNS.iter().map(|(group, _)| &group[..]);
        angles.chain(QUATERNIONS.iter().map(|group| &group[..])).filter(|group| together(group))
    };
    let columns = cells.names.iter().enumerate().map(|(k, name)| {
        let turning = said[k].is_none() && groups().any(|group| group.contains(&all[k].as_str()));
        let unit = cells.units[k].clone().or_else(|| bracketed(name).map(|(_, unit)| unit.to_owned()));
        FileColumn {
            name: name.clone(),
            unit,
            first: cells.rows.iter().take(SHOWN).map(|(_, row)| row.get(k).cloned().unwrap_or_default()).collect(),
            meaning: said[k].clone().or_else(|| guess(name).filter(|_| !turning)),
            sure: said[k].is_some(),
            orientation: turning,
        }
    });
    Ok(columns.collect())
}
