//! Values of what is under the cursor.

use crate::analysis::Analysis;
use crate::features::commands;
use crate::features::definition::{file_of, is_part_of_tree, target};
use crate::markup::Spot as Place;
use crate::names::Kind;
use crate::session::Session;
use denavit_export::numbers::decimal;
use denavit_model::{Joint, JointKind, Quantity, Reading, Robot, Screw, intended};
use gen_lsp_types::{Hover, MarkupContent, MarkupKind};
use std::fmt::Write as _;
use std::ops::Range;
use std::path::Path;
use std::rc::Rc;

/// Maximum number of robots or values of an expression shown; the others are counted.
const MOST: usize = 3;

pub(crate) fn hover(session: &Session, path: &Path, at: usize) -> Option<Hover> {
    let text = session.files.text(path)?;
    let (range, words) = expression(session, path, at)
        .or_else(|| named(session, path, at))
        .or_else(|| number(session, path, at))
        .or_else(|| element(session, path, at))?;
    let contents = MarkupContent { kind: MarkupKind::Markdown, value: words };
    Some(Hover { contents: contents.into(), range: Some(text.range(&range)) })
}

/// The value of an expression for the arguments in force.
fn expression(session: &Session, path: &Path, at: usize) -> Option<(Range<usize>, String)> {
    let text = session.files.text(path)?;
    let robots = session.robots_of(path);
    for analysis in &robots {
        let Some((range, values)) = analysis.trace.as_ref().and_then(|trace| trace.evaluated(path, at)) else {
            continue;
        };
        let shown: Vec<String> = values.iter().take(MOST).map(|value| format!("`{}`", read(value))).collect();
        let mut words = format!("`{}` = {}", &text.text[range.clone()], shown.join(", "));
        if values.len() > MOST {
            let _ = write!(words, " and {} other values", values.len() - MOST);
        }
        if values.len() > 1 {
            words.push_str("\n\none value for each call of the macro");
        }
        let arguments = session.settings.options(&analysis.file).arguments;
        if !arguments.is_empty() {
            let words_of = |(name, value): &(String, String)| format!("{name}:={value}");
            let _ = write!(words, "\n\nwith {}", arguments.iter().map(words_of).collect::<Vec<_>>().join(" "));
        }
        return Some((range, words));
    }
    None
}

/// A value on one line, not too long.
fn read(value: &str) -> String {
    const LONGEST: usize = 200;
    let line = value.split_whitespace().collect::<Vec<_>>().join(" ");
    if line.chars().count() <= LONGEST { line } else { line.chars().take(LONGEST).chain(['…']).collect() }
}

fn named(session: &Session, path: &Path, at: usize) -> Option<(Range<usize>, String)> {
    let target = target(session, path, at)?;
    let range = target.occurrence.range.clone();
    let words = match target.occurrence.kind {
        kind if is_part_of_tree(kind) => {
            let robots: Vec<Rc<Analysis>> =
                session.robots_of(path).into_iter().chain(session.robots_of_srdf(path)).collect();
            let found = target.names.iter().take(MOST).filter_map(|name| {
                robots.iter().filter_map(|analysis| analysis.robot.as_ref()).find_map(|robot| match kind {
                    Kind::Joint => joint(session, robot, name),
                    Kind::Link => link(robot, name),
                    _ => link(robot, name).or_else(|| joint(session, robot, name)),
                })
            });
            let mut words = found.collect::<Vec<_>>().join("\n\n---\n\n");
            if target.names.len() > MOST {
                let _ = write!(words, "\n\nand {} others", target.names.len() - MOST);
            }
            words
        }
        Kind::Mesh | Kind::Include => file(session, path, &target.occurrence)?,
        Kind::Package => match crate::features::definition::packages(session, path).find(&target.occurrence.name) {
            Ok(folder) => format!("package `{}`: {}", target.occurrence.name, folder.display()),
            Err(error) => error.to_string(),
        },
        Kind::Argument => {
            let robots = session.robots_of(path);
            let trace = robots.iter().find_map(|analysis| analysis.trace.as_ref());
            let value = trace.and_then(|trace| {
                let is_use = |value: &&denavit_xacro::Evaluated| {
                    let file = &trace.files[value.span.file];
                    let text = session.files.text(file);
                    text.is_some_and(|text| {
                        text.text
                            .get(value.span.range.clone())
                            .and_then(|words| words.trim().strip_prefix("arg "))
                            .map(str::trim)
                            == Some(&target.occurrence.name)
                    })
                };
                trace.trace.values.iter().find(is_use).map(|value| value.value.clone())
            });
            value.map(|value| format!("argument `{}` = `{}`", target.occurrence.name, read(&value)))?
        }
        _ => return None,
    };
    (!words.is_empty()).then_some((range, words))
}

fn file(session: &Session, path: &Path, name: &crate::names::Occurrence) -> Option<String> {
    let found = file_of(session, path, name)?;
    Some(match std::fs::metadata(&found) {
        Ok(of) if of.is_file() => format!("{}, {}", bytes(of.len()), found.display()),
        _ => format!("there is no file {}", found.display()),
    })
}

fn bytes(count: u64) -> String {
    match count {
        0..1000 => format!("{count} bytes"),
        1000..1_000_000 => format!("{} kB", decimal(count as f64 / 1e3, 1)),
        _ => format!("{} MB", decimal(count as f64 / 1e6, 1)),
    }
}

/// A number of at most six places for people.
fn short(value: f64) -> String {
    decimal(value, 6)
}

fn angle(value: f64) -> String {
    format!("{}°", decimal(value.to_degrees(), 4))
}

fn length(value: f64) -> String {
    format!("{} mm", decimal(value * 1e3, 4))
}

fn joint(session: &Session, robot: &Robot, name: &str) -> Option<String> {
    let index = robot.joint_index(name)?;
    let joint = &robot.joints[index];
    let (parent, child) = (&robot.links[joint.parent].name, &robot.links[joint.child].name);
    let mut words = format!("**joint `{name}`**, {}: `{parent}` → `{child}`", joint.kind.word());
    if let Ok(chain) = robot.chain(None, Some(child), Reading::Intended)
        && let Some(moved) = chain.value.joints().iter().find(|moved| moved.name == name)
    {
        let three = |values: [f64; 3]| values.map(short).join(" ");
        let direction = moved.screw.direction();
        let _ = write!(
            words,
            "\n\naxis in `{}`: direction {}",
            chain.value.base(),
            three([direction.x, direction.y, direction.z])
        );
        if let Screw::Revolute(axis) | Screw::Helical { axis, .. } = &moved.screw {
            let _ = write!(words, " through {} m", three([axis.point.x, axis.point.y, axis.point.z]));
        }
    }
    if let Some(row) = row(session, robot, joint) {
        let _ = write!(words, "\n\n{row}");
    }
    let _ = write!(words, "\n\n{}", limits(joint));
    let below = below(robot, joint.child);
    let _ = write!(
        words,
        "\n\nmoves {}",
        listed(&below.iter().map(|link| robot.links[*link].name.as_str()).collect::<Vec<_>>(), "link")
    );
    if let Some(mimic) = &joint.mimic {
        let _ = write!(
            words,
            "\n\nfollows `{}`: {} × its value + {}",
            mimic.joint,
            short(mimic.multiplier),
            short(mimic.offset)
        );
    }
    let followers: Vec<&str> = robot
        .joints
        .iter()
        .filter(|other| other.mimic.as_ref().is_some_and(|mimic| mimic.joint == name))
        .map(|other| other.name.as_str())
        .collect();
    if !followers.is_empty() {
        let _ = write!(words, "\n\n{} with it", listed(&followers, "joint"));
    }
    Some(words)
}

/// `3 links: a, b, c`
fn listed(names: &[&str], word: &str) -> String {
    const NAMED: usize = 6;
    let shown: Vec<String> = names.iter().take(NAMED).map(|name| format!("`{name}`")).collect();
    let more = if names.len() > NAMED { ", …" } else { "" };
    let many = if names.len() == 1 { "" } else { "s" };
    format!("{} {word}{many}: {}{more}", names.len(), shown.join(", "))
}

/// The links that a joint moves, the nearest first.
fn below(robot: &Robot, link: usize) -> Vec<usize> {
    let carried = robot.carried();
    let (mut found, mut next) = (vec![link], 0);
    while next < found.len() {
        found.extend(carried[found[next]].iter().map(|joint| robot.joints[*joint].child));
        next += 1;
    }
    found
}

/// The row of a joint in the table of the longest chain, or of the chain to the first leaf below the joint.
fn row(session: &Session, robot: &Robot, joint: &Joint) -> Option<String> {
    if !joint.kind.moves() {
        return None;
    }
    let last = below(robot, joint.child).last().map(|link| robot.links[*link].name.clone());
    let tables = [None, last.as_deref()].into_iter().filter_map(|tip| commands::table(session, robot, tip).ok());
    for made in tables {
        let sheet = commands::sheet(&made, "");
        let rows = sheet.text_rows(|coordinate| format!("q{coordinate}"));
        let Some(row) = rows.iter().find(|row| row.joint == joint.name) else { continue };
        let symbol = |column: &str| match column {
            "theta" => "θ",
            "alpha" => "α",
            "beta" => "β",
            "d" => "d",
            _ => "a",
        };
        let numbers: Vec<String> = sheet
            .number_columns()
            .iter()
            .zip(&row.numbers)
            .map(|(column, number)| {
                let unit = if ["theta", "alpha", "beta"].contains(column) { "°" } else { " m" };
                // A variable has its unit of its own.
                let unit =
                    if number.ends_with(|c: char| c.is_ascii_digit()) && !ends_in_variable(number) { unit } else { "" };
                format!("{} = {number}{unit}", symbol(column))
            })
            .collect();
        return Some(format!("D-H row {} ({}): {}", row.label, sheet.convention_words(), numbers.join(", ")));
    }
    None
}

fn ends_in_variable(cell: &str) -> bool {
    cell.rsplit([' ', '-']).next().is_some_and(|last| last.starts_with('q'))
}

fn limits(joint: &Joint) -> String {
    let quantity = if joint.kind == JointKind::Prismatic { Quantity::Length } else { Quantity::Angle };
    let shown = |value: f64| if quantity == Quantity::Angle { angle(value) } else { length(value) };
    let limits = joint.limits_in_force();
    let range = match (limits.range, &joint.kind) {
        (Some((lower, upper)), _) => format!("limits {} … {}", shown(lower), shown(upper)),
        (None, JointKind::Continuous) => "turns without limits".to_owned(),
        (None, JointKind::Fixed) => return "does not move".to_owned(),
        (None, _) => "no limits stated".to_owned(),
    };
    let speed = limits.velocity.map_or_else(String::new, |speed| format!(", at most {}/s", shown(speed)));
    let unit = if quantity == Quantity::Angle { "N·m" } else { "N" };
    let effort = limits.effort.map_or_else(String::new, |effort| format!(", at most {} {unit}", short(effort)));
    format!("{range}{speed}{effort}")
}

fn link(robot: &Robot, name: &str) -> Option<String> {
    let index = robot.link_index(name)?;
    let link = &robot.links[index];
    let mut words = format!("**link `{name}`**");
    match &link.inertial {
        Some(inertial) => {
            let _ = write!(words, ", {} kg", short(inertial.mass));
        }
        None => words.push_str(", no mass stated"),
    }
    match robot.joint_to(index) {
        Some(joint) => {
            let joint = &robot.joints[joint];
            let _ = write!(words, "\n\ncarried by joint `{}` ({})", joint.name, joint.kind.word());
        }
        None => words.push_str("\n\nthe root"),
    }
    let below = below(robot, index);
    let carried: Vec<&str> = below.iter().skip(1).map(|link| robot.links[*link].name.as_str()).collect();
    if carried.is_empty() {
        words.push_str("\n\ncarries nothing");
    } else {
        let mass: f64 = below.iter().skip(1).filter_map(|link| Some(robot.links[*link].inertial.as_ref()?.mass)).sum();
        let _ = write!(words, "\n\ncarries {}, {} kg", listed(&carried, "link"), short(mass));
    }
    let joints: Vec<&str> = robot.joints_from(index).map(|joint| robot.joints[joint].name.as_str()).collect();
    if !joints.is_empty() {
        let _ = write!(words, "\n\n{} on it", listed(&joints, "joint"));
    }
    Some(words)
}

/// A link or joint where the cursor is on the name of its element.
fn element(session: &Session, path: &Path, at: usize) -> Option<(Range<usize>, String)> {
    let (text, markup) = (session.files.text(path)?, session.files.markup(path)?);
    let Place::Name(tag) = markup.spot(at) else { return None };
    let own = markup.tags[tag].attributes.iter().find(|attribute| &text.text[attribute.name.clone()] == "name")?;
    let (_, words) = named(session, path, own.value.start)?;
    Some((markup.tags[tag].name.clone(), words))
}

/// What a number of an attribute is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Measure {
    Angle,
    Length,
    /// An angle or a length, by the joint around it, and per second or not.
    Joint(&'static str),
    Mass,
    Inertia,
    None,
}

fn measure(tag: &str, attribute: &str, index: usize) -> Measure {
    match (tag, attribute) {
        ("origin" | "frame", "rpy") => Measure::Angle,
        ("origin" | "frame", "xyz") | ("box", "size") | ("sphere" | "cylinder" | "capsule", "radius" | "length") => {
            Measure::Length
        }
        ("limit", "lower" | "upper") | ("safety_controller", "soft_lower_limit" | "soft_upper_limit") => {
            Measure::Joint("")
        }
        ("limit", "velocity") => Measure::Joint("/s"),
        ("mass", "value") => Measure::Mass,
        ("inertia", _) => Measure::Inertia,
        ("pose", "") => {
            if index < 3 {
                Measure::Length
            } else {
                Measure::Angle
            }
        }
        ("mimic", "offset") | ("joint", "value") => Measure::Joint(""),
        ("body" | "geom" | "site", "pos") => Measure::Length,
        _ => Measure::None,
    }
}

fn number(session: &Session, path: &Path, at: usize) -> Option<(Range<usize>, String)> {
    let (text, markup) = (session.files.text(path)?, session.files.markup(path)?);
    let (tag, attribute, value) = match markup.spot(at) {
        Place::Value(tag, attribute) => {
            let attribute = &markup.tags[tag].attributes[attribute];
            (tag, &text.text[attribute.name.clone()], attribute.value.clone())
        }
        Place::Text(tag) => (tag, "", markup.tags[tag].inside()?),
        _ => return None,
    };
    let written = &text.text[value.clone()];
    let start = written.as_ptr() as usize;
    let separators = |c: char| c.is_whitespace() || c == ',';
    let (index, word) = written.split(separators).filter(|word| !word.is_empty()).enumerate().find(|(_, word)| {
        let from = value.start + (word.as_ptr() as usize - start);
        from <= at && at <= from + word.len()
    })?;
    let from = value.start + (word.as_ptr() as usize - start);
    let number: f64 = word.parse().ok().filter(|number: &f64| number.is_finite())?;
    let local = markup.local(&text.text, tag);
    let around = markup.around(tag).find(|tag| markup.local(&text.text, *tag) == "joint");
    let slides = around.and_then(|joint| markup.tags[joint].attribute(&text.text, "type")) == Some("prismatic");
    let words = match measure(local, attribute, index) {
        Measure::Angle => angle_words(word, number),
        Measure::Length => length(number),
        Measure::Joint(per) if slides => format!("{}{per}", length(number)),
        Measure::Joint("") => angle_words(word, number),
        Measure::Joint(per) => format!("{}{per}", angle(number)),
        Measure::Mass => format!("{} kg, {} g", short(number), short(number * 1e3)),
        Measure::Inertia => format!("{word} kg·m²"),
        Measure::None => return None,
    };
    Some((from..from + word.len(), words))
}

fn angle_words(word: &str, number: f64) -> String {
    match intended::read_as(word) {
        Some(read) => format!("{}; read as {} = {}", angle(number), read.read_as, angle(read.angle)),
        None => angle(number),
    }
}
