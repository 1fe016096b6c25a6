//! Joint values from robot programs: ABB RAPID `jointtarget`, KUKA KRL `AXIS` and `E6AXIS`, UR script `movej`.
//!
//! A statement is on one line, as the makers' own editors write it.
//!
//! # Sources
//! ABB, Technical reference manual, RAPID Instructions, Functions and Data types, 3HAC050917: `jointtarget` is
//! `[robax, extax]`, robax six numbers in degrees. Universal Robots, The URScript Programming Language, motion module: joint
//! positions are lists of six numbers in rad, poses `p[…]`. KUKA does not publish its KRL reference; aggregates such as
//! `{A1 0, A2 -90, …}`, in degrees, are as its programs show them.

use thiserror::Error;

/// Joint values in rad with the line of each.
#[derive(Debug, Clone, PartialEq)]
pub struct JointList {
    /// The program.
    pub file: String,
    /// The recognised form of the file.
    pub taken_for: &'static str,
    /// Line and values.
    pub rows: Vec<(usize, Vec<f64>)>,
}

/// A program without joint values.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error(
    "{file}: no joint values were found; ABB jointtarget, KUKA AXIS or E6AXIS and UR movej([…]) are read{}",
    if *poses > 0 { format!(", but this file holds {poses} pose(s), which say where the tool was sent, not its joints") } else { String::new() }
)]
pub struct ProgramError {
    /// The file.
    pub file: String,
    /// Cartesian poses in it.
    pub poses: usize,
}

/// The numbers of a list in brackets that `text` begins with, after any blanks.
fn bracketed(text: &str) -> Option<Vec<f64>> {
    let inside = text.trim_start().strip_prefix('[')?.split_once(']')?.0;
    inside.split(',').map(|cell| cell.trim().parse::<f64>().ok()).collect()
}

/// The robot's own axes of an aggregate `{A1 0, A2 -90, …, E1 0}`, in its order.
fn axes(code: &str) -> Option<Vec<f64>> {
    let inside = code.split_once('{')?.1.split_once('}')?.0;
    let mut words = inside.split(',').map(str::split_whitespace);
    let of =
        |mut words: std::str::SplitWhitespace| Some((words.next()?.to_owned(), words.next()?.parse::<f64>().ok()?));
    let own = words.by_ref().map(of).collect::<Option<Vec<(String, f64)>>>()?;
    let own: Vec<f64> =
        own.into_iter().filter(|(name, _)| name.starts_with(['A', 'a'])).map(|(_, value)| value).collect();
    (!own.is_empty()).then_some(own)
}

/// Reads a robot program's joint values.
///
/// # Errors
/// No joint values.
pub fn joints(file: &str, text: &str) -> Result<JointList, ProgramError> {
    let mut rows: Vec<(usize, Vec<f64>)> = Vec::new();
    let (mut taken_for, mut poses) = ("", 0);
    for (index, line) in text.lines().enumerate() {
        let code = line.split(['!', ';', '#']).next().unwrap_or(line);
        let small = code.to_lowercase();
        let rapid = || code.split_once("[[").and_then(|(_, rest)| bracketed(&format!("[{rest}")));
        let found = if small.contains("jointtarget") || small.contains("moveabsj") {
            rapid().map(|degrees| ("ABB RAPID joint targets, degrees", true, degrees))
        } else if let Some(degrees) = axes(code) {
            Some(("KUKA KRL axes, degrees", true, degrees))
        } else if let Some((_, rest)) = small.split_once("movej(") {
            bracketed(rest).map(|radians| ("UR script joint positions, rad", false, radians))
        } else {
            None
        };
        let Some((what, degrees, values)) = found else {
            poses += usize::from(["robtarget", "e6pos", "{x ", "p["].iter().any(|word| small.contains(word)));
            continue;
        };
        taken_for = what;
        let values = if degrees { values.into_iter().map(f64::to_radians).collect() } else { values };
        rows.push((index + 1, values));
    }
    if rows.is_empty() {
        return Err(ProgramError { file: file.into(), poses });
    }
    Ok(JointList { file: file.into(), taken_for, rows })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joint_values_are_read_from_three_languages() {
        let rapid = "MODULE M\n  ! made by hand\n  CONST jointtarget p10:=[[10,-20.5,30,0,90,1E1],[9E9,9E9,9E9,9E9,9E9,9E9]];\n\
                     MoveAbsJ [[0,0,0,0,30,0],[9E9,9E9,9E9,9E9,9E9,9E9]],v100,fine,tool0;\nENDMODULE\n";
        let read = joints("m.mod", rapid).unwrap();
        assert_eq!(read.rows.iter().map(|row| row.0).collect::<Vec<_>>(), [3, 4]);
        let degrees: Vec<f64> = read.rows[0].1.iter().map(|value| value.to_degrees().round()).collect();
        assert_eq!(degrees, [10.0, -21.0, 30.0, 0.0, 90.0, 10.0]);
        let kuka = "DECL E6AXIS XP1={A1 5.0,A2 -90.0,A3 90.0,A4 0.0,A5 10.0,A6 0.0,E1 0.0,E2 0.0}\nPTP {A1 0, A2 -90, A3 90, A4 0, A5 0, A6 180}\n";
        let read = joints("m.dat", kuka).unwrap();
        assert_eq!(read.rows.iter().map(|row| row.1.len()).collect::<Vec<_>>(), [6, 6]);
        assert!((read.rows[1].1[5] - std::f64::consts::PI).abs() < 1e-15);
        let ur = "def cal():\n  movej([0.1, -1.57, 1.2, -0.5, 1.5, 0], a=1.4, v=1.05)\n  movej(p[0.3, 0.1, 0.2, 0, 3.14, 0])\nend\n";
        assert_eq!(joints("m.script", ur).unwrap().rows, [(2, vec![0.1, -1.57, 1.2, -0.5, 1.5, 0.0])]);
        let poses =
            joints("m.mod", "CONST robtarget p1:=[[500,0,300],[0,1,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]];\n");
        assert!(poses.unwrap_err().to_string().contains("1 pose(s), which say where the tool was sent"));
    }
}
