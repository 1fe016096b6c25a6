//! Lists of records as rows of cells: JSON lines, a JSON array, a YAML list or stream, such as `ros2 topic echo` and
//! robot_calibration write.
//!
//! ```text
//! {joints: {lift: 0.1, elbow: 0.2}, pose: {position: {x: …}, orientation: {x: …}}}   ─►  lift, elbow, x, …, qx, …
//! {name: [lift, elbow], position: [0.1, 0.2]}                                        ─►  lift, elbow
//! {actual_q: [0.1, 0.2]}                                                             ─►  actual_q.0, actual_q.1
//! ```

use super::problem::{Fault, ImportProblem};
use saphyr_parser::{Event, Parser};

/// Keys of lists of joint names, and of lists of their values.
const NAMES: [&str; 3] = ["name", "joint_names", "joints"];
const VALUES: [&str; 2] = ["position", "positions"];
/// Keys next to them that are not columns of a measurement.
const BESIDE: [&str; 3] = ["velocity", "effort", "velocities"];

/// A value and its line.
#[derive(Debug, Clone, PartialEq)]
enum Node {
    Scalar(String, usize),
    List(Vec<Self>, usize),
    Map(Vec<(String, Self)>, usize),
}

impl Node {
    fn line(&self) -> usize {
        match self {
            Self::Scalar(_, line) | Self::List(_, line) | Self::Map(_, line) => *line,
        }
    }

    /// A list of scalars.
    fn scalars(&self) -> Option<Vec<&str>> {
        let Self::List(items, _) = self else { return None };
        items.iter().map(|item| if let Self::Scalar(text, _) = item { Some(text.as_str()) } else { None }).collect()
    }
}

/// Whether a text is a list of records and not a table, by its start.
fn is_records(text: &str) -> bool {
    let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'));
    let Some(first) = lines.next() else { return false };
    let after = lines.next().unwrap_or_default();
    let starts = |line: &str| line.starts_with("- ") || line == "-";
    // "[deg]" may be a unit above a table.
    let json = first.starts_with('{') || first == "[" || first.starts_with("[{") || first.starts_with("[[");
    let keyed = |line: &str| line.split_once(':').is_some_and(|(key, _)| !key.contains([',', ';', '\t', ' ']));
    json || starts(first)
        || first == "---" && keyed(after)
        || first.ends_with(':') && keyed(first) && (starts(after) || keyed(after))
}

/// The header and the rows, each with its line.
type Rows = Vec<(usize, Vec<String>)>;

/// A header and rows; `None` for a text that is not a list of records.
///
/// # Errors
/// The text starts like records but does not parse, or has no records.
pub(super) fn rows(text: &str) -> Result<Option<Rows>, Fault> {
    if !is_records(text) {
        return Ok(None);
    }
    let records = records(documents(text)?);
    let mut names: Vec<String> = Vec::new();
    let mut cells: Vec<(usize, Vec<(String, String)>)> = Vec::new();
    for record in &records {
        let mut own = Vec::new();
        flatten("", record, &mut own);
        for (name, _) in &own {
            if !names.contains(name) {
                names.push(name.clone());
            }
        }
        cells.push((record.line(), own));
    }
    let row = |(line, own): &(usize, Vec<(String, String)>)| {
        let cell = |name: &String| own.iter().find(|(known, _)| known == name).map_or("", |(_, text)| text).to_owned();
        (*line, names.iter().map(cell).collect())
    };
    let header = cells.first().map_or(1, |(line, _)| *line);
    let all = std::iter::once((header, short(&names))).chain(cells.iter().map(row)).collect();
    Ok(Some(all))
}

/// The documents of a text; JSON lines are a document each.
fn documents(text: &str) -> Result<Vec<Node>, Fault> {
    let filled = || text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
    let is_object = |line: &str| line.trim().starts_with('{') && line.trim().ends_with('}');
    if filled().all(|(_, line)| is_object(line)) {
        // A missing part of a line is noticed after its end.
        let own = |at: usize| move |fault: Fault| Fault { line: at + 1, ..fault };
        let each = filled().map(|(at, line)| parsed(line, at).map_err(own(at))).collect::<Result<Vec<_>, _>>()?;
        return Ok(each.into_iter().flatten().collect());
    }
    parsed(text, 0)
}

/// `above`: lines before this text.
fn parsed(text: &str, above: usize) -> Result<Vec<Node>, Fault> {
    let mut documents = Vec::new();
    let mut open: Vec<(Node, Option<String>)> = Vec::new();
    for event in Parser::new_from_str(text) {
        let (event, span) = event.map_err(|error| Fault {
            line: above + error.marker().line(),
            problem: ImportProblem::Option(format!("the records do not parse as JSON or YAML: {}", error.info())),
        })?;
        let line = above + span.start.line();
        let done = match event {
            Event::MappingStart(..) => {
                open.push((Node::Map(Vec::new(), line), None));
                continue;
            }
            Event::SequenceStart(..) => {
                open.push((Node::List(Vec::new(), line), None));
                continue;
            }
            Event::MappingEnd | Event::SequenceEnd => match open.pop() {
                Some((node, _)) => node,
                None => continue,
            },
            Event::Scalar(value, ..) => Node::Scalar(value.into_owned(), line),
            _ => continue,
        };
        match open.last_mut() {
            // A stream ends with an empty document.
            None if matches!(done, Node::Scalar(..)) => {}
            None => documents.push(done),
            Some((Node::List(items, _), _)) => items.push(done),
            Some((Node::Map(entries, _), key)) => match (key.take(), done) {
                (Some(key), value) => entries.push((key, value)),
                (None, Node::Scalar(name, _)) => *key = Some(name),
                (None, _) => {}
            },
            Some((Node::Scalar(..), _)) => {}
        }
    }
    Ok(documents)
}

/// The records: documents, items of the one list, or the rows of columns that are lists.
fn records(mut documents: Vec<Node>) -> Vec<Node> {
    if documents.len() != 1 {
        return documents;
    }
    match documents.remove(0) {
        Node::List(items, _) => items,
        Node::Map(mut entries, line) => {
            let of_records = |node: &Node| matches!(node, Node::List(items, _) if items.iter().any(|item| !matches!(item, Node::Scalar(..))));
            let lists: Vec<usize> = (0..entries.len()).filter(|&k| of_records(&entries[k].1)).collect();
            if let [only] = lists[..]
                && let Node::List(items, _) = entries.swap_remove(only).1
            {
                return items;
            }
            let columns: Option<Vec<(String, Vec<&str>)>> =
                entries.iter().map(|(name, node)| Some((name.clone(), node.scalars()?))).collect();
            match columns {
                Some(columns) if columns.iter().all(|(_, cells)| cells.len() == columns[0].1.len()) => {
                    let cell = |row: usize, (name, cells): &(String, Vec<&str>)| {
                        (name.clone(), Node::Scalar(cells[row].to_owned(), line))
                    };
                    let count = columns.first().map_or(0, |(_, cells)| cells.len());
                    let row = |row| Node::Map(columns.iter().map(|column| cell(row, column)).collect(), line);
                    (0..count).map(row).collect()
                }
                _ => vec![Node::Map(entries, line)],
            }
        }
        scalar @ Node::Scalar(..) => vec![scalar],
    }
}

/// Names and texts of a record, keys joined by dots.
fn flatten(above: &str, node: &Node, out: &mut Vec<(String, String)>) {
    let below = |key: &str| if above.is_empty() { key.to_owned() } else { format!("{above}.{key}") };
    match node {
        Node::Scalar(text, _) => out.push((above.to_owned(), text.clone())),
        Node::List(items, _) => {
            items.iter().enumerate().for_each(|(k, item)| flatten(&below(&k.to_string()), item, out));
        }
        Node::Map(entries, _) => {
            let list = |keys: &[&str]| {
                entries
                    .iter()
                    .find_map(|(key, node)| Some((key, node.scalars().filter(|_| keys.contains(&key.as_str()))?)))
            };
            let named = match (list(&NAMES), list(&VALUES)) {
                (Some((names, joints)), Some((values, cells))) if joints.len() == cells.len() => {
                    let each = joints.iter().zip(cells);
                    out.extend(each.map(|(joint, cell)| ((*joint).to_owned(), cell.to_owned())));
                    vec![names, values]
                }
                _ => Vec::new(),
            };
            for (key, node) in entries {
                let beside = !named.is_empty() && BESIDE.contains(&key.as_str());
                if !named.contains(&key) && !beside {
                    flatten(&below(key), node, out);
                }
            }
        }
    }
}

/// Names without the keys above them, where the ending is unique; position and orientation of a pose under the contract's names.
fn short(names: &[String]) -> Vec<String> {
    let end = |name: &String| -> String {
        let parts: Vec<&str> = name.split('.').collect();
        match parts[..] {
            [.., "position" | "translation", axis @ ("x" | "y" | "z")] => axis.to_owned(),
            [.., "orientation" | "rotation" | "quaternion", axis @ ("x" | "y" | "z" | "w")] => format!("q{axis}"),
            [.., last] if last.parse::<usize>().is_err() => last.to_owned(),
            _ => name.clone(),
        }
    };
    let ends: Vec<String> = names.iter().map(end).collect();
    let alone = |own: &String| ends.iter().filter(|other| *other == own).count() == 1;
    names.iter().zip(&ends).map(|(name, end)| if alone(end) { end.clone() } else { name.clone() }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table(text: &str) -> Vec<String> {
        let rows = rows(text).unwrap().expect("these are records");
        rows.into_iter().map(|(line, cells)| format!("{line}: {}", cells.join(","))).collect()
    }

    #[test]
    fn json_lines_are_rows() {
        let text = "{\"joints\": {\"lift\": 0.1, \"elbow\": -2}, \"x\": 1.5}\n\n{\"joints\": {\"elbow\": 3, \"lift\": 4}, \"x\": 2}\n";
        assert_eq!(table(text), ["1: lift,elbow,x", "1: 0.1,-2,1.5", "3: 4,3,2"]);
        assert_eq!(table("[\n{\"a\": 1, \"b\": 2},\n{\"a\": 3}]"), ["2: a,b", "2: 1,2", "3: 3,"]);
        assert_eq!(table("{\"a\": [1, 2], \"b\": [3, 4]}"), ["1: a,b", "1: 1,3", "1: 2,4"]);
    }

    #[test]
    fn what_ros_echoes_has_joints_by_name_and_poses_by_the_contract() {
        let text = "header:\n  frame_id: base\nname:\n- lift\n- elbow\nposition:\n- 0.1\n- 0.2\nvelocity:\n- 9\n- 9\n---\n\
                    header:\n  frame_id: base\nname: [elbow, lift]\nposition: [3, 4]\n---\n";
        assert_eq!(table(text), ["1: lift,elbow,frame_id", "1: 0.1,0.2,base", "13: 4,3,base"]);
        let text = "- pose: {position: {x: 1, y: 2, z: 3}, orientation: {x: 0, y: 0, z: 0, w: 1}}\n";
        assert_eq!(table(text)[0], "1: x,y,z,qx,qy,qz,qw");
    }

    #[test]
    fn lists_of_yaml_are_rows() {
        // robot_calibration's poses.
        let text = "- features: []\n  joints: [lift, elbow]\n  positions: [0.1, 0.2]\n- features: []\n  joints: [lift, elbow]\n  positions: [3, 4]\n";
        assert_eq!(table(text), ["1: lift,elbow", "1: 0.1,0.2", "4: 3,4"]);
        assert_eq!(table("poses:\n  - q: [1, 2]\n  - q: [3, 4]\n"), ["2: q.0,q.1", "2: 1,2", "3: 3,4"]);
    }

    #[test]
    fn tables_are_no_records_and_faults_have_a_line() {
        for text in
            ["a,b,c\n1,2,3\n", "-0.5,1,2\n", "# note\n- 1\t2\n".trim_start_matches("# note\n- "), "x: y\n1 2 3\n", ""]
        {
            assert_eq!(rows(text).unwrap(), None, "{text}");
        }
        let fault = rows("{\"a\": 1, \"b\": 2}\n{\"a\": [1, \"b\": }\n").unwrap_err();
        assert_eq!(fault.line, 2);
    }
}
