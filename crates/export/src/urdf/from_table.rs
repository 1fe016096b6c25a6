//! A URDF of a Denavit-Hartenberg table, with cylinders along its lengths.

use super::ExportError;
use super::edit::escaped;
use super::written::{Numbers, three, word};
use denavit_dh::conventions::Convention;
use denavit_dh::table::{DhRow, Motion, Row, Table, TableJoint};
use denavit_model::chain::{Coordinate, Limits};
use denavit_model::nalgebra::Vector3;
use denavit_model::robot::Robot;
use denavit_model::se3;
use std::f64::consts::FRAC_PI_2;
use std::fmt::Write;

/// Radius of the cylinders, relative to the robot's size.
const THICKNESS: f64 = 0.015;

/// The URDF of a table: joint origins are the table's rows, so that [`super::read_off`] returns them.
///
/// The convention is only named in a comment and changes nothing else. A helical
/// joint is a revolute joint and a prismatic joint that mimics it, with the pitch as multiplier. A joint that turns
/// against its coordinate (scale -1) has axis 0 0 -1. What URDF requires and a table does not state gets a default: effort and
/// velocity 0, and ±1 m for a slide without limits.
///
/// # Errors
/// A joint's scale is neither 1 nor -1 where no other joint drives it.
///
/// # Examples
/// ```
/// use denavit_dh::{Convention, convert};
/// use denavit_export::urdf::{from_table, read_off};
/// use denavit_model::Reading;
/// let table = convert::table(&denavit_model::examples::puma_like(), &convert::Options::default())?.value;
/// let text = from_table(&table, Convention::Distal)?;
/// let robot = denavit_model::urdf::read("puma.urdf", &text)?;
/// assert_eq!(read_off(&robot, None, None, Reading::Intended).map(|read| read.rows), Some(table.rows));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn from_table(table: &Table, convention: Convention) -> Result<String, ExportError> {
    table.chain().map_err(|source| ExportError::Chain { file: table.name.clone(), source })?;
    let writer = Writer::new(table);
    let mut text = format!(
        "<?xml version=\"1.0\"?>\n<!-- {MADE_FROM}{} Denavit-Hartenberg table; each joint's origin is \
         rpy=\"alpha 0 theta\" xyz=\"a·cos(theta) a·sin(theta) d\". -->\n<robot name=\"{}\">\n",
        convention.word(),
        escaped(&table.name)
    );
    for (name, colour) in COLOURS {
        let _ = writeln!(text, "  <material name=\"{name}\"><color rgba=\"{colour}\"/></material>");
    }
    let mut parent = table.base.clone();
    text.push_str(&writer.link(&parent, None, Some(&table.row(0))));
    for (index, joint) in table.joints.iter().enumerate() {
        let origin = numbers(&table.row(index));
        parent = writer.joint(&mut text, index, joint, &parent, origin)?;
        text.push_str(&writer.link(&parent, Some(joint.motion), Some(&table.row(index + 1))));
    }
    let last = numbers(&table.row(table.joints.len()));
    let tool = Numbers { xyz: [0.0, 0.0, table.tool.d + 0.0], rpy: [0.0, 0.0, table.tool.theta + 0.0] };
    if tool == Numbers::default() {
        fixed(&mut text, &format!("{}_joint", table.tip), &parent, &table.tip, &last);
    } else {
        let frame = writer.free(&format!("{}_row", table.tip));
        fixed(&mut text, &format!("{frame}_joint"), &parent, &frame, &last);
        text.push_str(&writer.link(&frame, None, Some(&Row::Dh(DhRow { d: table.tool.d, ..DhRow::default() }))));
        fixed(&mut text, &format!("{}_joint", table.tip), &frame, &table.tip, &tool);
    }
    text.push_str(&writer.tip());
    text.push_str("</robot>\n");
    Ok(text)
}

/// Start of the comment that names the table in the file.
const MADE_FROM: &str = "Made from the ";

/// Whether a file states that it was made from a table, so that its last row and tool part are those of the table.
pub(super) fn is_made_from_table(robot: &Robot) -> bool {
    let before = robot.source.text.split("<robot").next().unwrap_or_default();
    before.contains(MADE_FROM) && before.contains("Denavit-Hartenberg table")
}

const COLOURS: [(&str, &str); 5] = [
    ("arm", "0.75 0.77 0.8 1"),
    ("axis", "0.25 0.3 0.35 1"),
    ("x", "0.85 0.2 0.2 1"),
    ("y", "0.2 0.65 0.25 1"),
    ("z", "0.2 0.35 0.85 1"),
];

/// A row as an origin, every digit kept.
fn numbers(row: &Row) -> Numbers {
    match row {
        Row::Dh(row) => {
            let (sine, cosine) = se3::sin_cos_of_written(row.theta);
            let xyz = [row.a * cosine + 0.0, row.a * sine + 0.0, row.d + 0.0];
            Numbers { xyz, rpy: [row.alpha + 0.0, 0.0, row.theta + 0.0] }
        }
        Row::Hayati(_) => Numbers::of(&row.pose(), 0.0),
    }
}

fn fixed(text: &mut String, name: &str, parent: &str, child: &str, origin: &Numbers) {
    joint(text, name, "fixed", (parent, child), &[origin.element()]);
}

fn joint(text: &mut String, name: &str, kind: &str, (parent, child): (&str, &str), parts: &[String]) {
    let _ = writeln!(text, "  <joint name=\"{}\" type=\"{kind}\">", escaped(name));
    let _ = writeln!(text, "    <parent link=\"{}\"/>\n    <child link=\"{}\"/>", escaped(parent), escaped(child));
    for part in parts {
        let _ = writeln!(text, "    {part}");
    }
    text.push_str("  </joint>\n");
}

struct Writer<'a> {
    table: &'a Table,
    radius: f64,
}

impl<'a> Writer<'a> {
    fn new(table: &'a Table) -> Self {
        let lengths: f64 = table.rows.iter().map(|row| row.a().abs() + row.d().unwrap_or(0.0).abs()).sum();
        let size = lengths + table.tool.d.abs();
        Self { table, radius: THICKNESS * if size > 0.0 { size } else { 1.0 } }
    }

    /// `name`, with trailing strokes if base or tip have this name.
    fn free(&self, name: &str) -> String {
        let mut name = name.to_owned();
        while name == self.table.base || name == self.table.tip {
            name.push('_');
        }
        name
    }

    /// Writes a joint, or the two of a helical one; returns its child link.
    fn joint(
        &self,
        text: &mut String,
        index: usize,
        of: &TableJoint,
        parent: &str,
        origin: Numbers,
    ) -> Result<String, ExportError> {
        let coordinate = &self.table.coordinates[of.coordinate];
        let driver = self.driver(of.coordinate);
        let drives = driver.name == of.name;
        if drives && of.scale.abs() != 1.0 {
            let what =
                format!("its value is {} times its coordinate, which URDF cannot express; give it scale 1", of.scale);
            return Err(ExportError::NotInUrdf { joint: of.name.clone(), what });
        }
        let axis = if drives && of.scale < 0.0 { "<axis xyz=\"0 0 -1\"/>" } else { "<axis xyz=\"0 0 1\"/>" };
        // The driver's value is the coordinate: its own sense is in its axis.
        let multiplier = if drives { 1.0 } else { of.scale };
        let mimic = |joint: &str, multiplier: f64| {
            format!("<mimic joint=\"{}\" multiplier=\"{}\"/>", escaped(joint), word(multiplier))
        };
        let child = self.free(&format!("link_{}", index + 1));
        let endless = coordinate.continuous || coordinate.limits.range.is_none();
        let kind = match of.motion {
            Motion::Prismatic => "prismatic",
            _ if endless => "continuous",
            _ => "revolute",
        };
        let mut parts = vec![origin.element(), axis.to_owned()];
        if kind != "continuous" {
            parts.push(limit(coordinate, multiplier));
        }
        if !drives {
            parts.push(mimic(&driver.name, multiplier));
        }
        let Motion::Helical(pitch) = of.motion else {
            joint(text, &of.name, kind, (parent, &child), &parts);
            return Ok(child);
        };
        let turned = self.free(&format!("link_{}_turn", index + 1));
        joint(text, &of.name, kind, (parent, &turned), &parts);
        let _ = writeln!(text, "  <link name=\"{}\"/>", escaped(&turned));
        let slide = pitch.metres_per_radian() * multiplier;
        let parts = [axis.to_owned(), limit(coordinate, slide), mimic(&driver.name, slide)];
        joint(text, &format!("{}_slide", of.name), "prismatic", (&turned, &child), &parts);
        Ok(child)
    }

    /// The joint whose value is the coordinate: the one with its name, otherwise the first that it moves.
    fn driver(&self, coordinate: usize) -> &TableJoint {
        let moved = || self.table.joints.iter().filter(|joint| joint.coordinate == coordinate);
        let name = &self.table.coordinates[coordinate].name;
        moved().find(|joint| joint.name == *name).or_else(|| moved().next()).expect("the coordinate moves a joint")
    }

    /// A link with a shape for its joint, and cylinders along d and a of the next row.
    fn link(&self, name: &str, motion: Option<Motion>, row: Option<&Row>) -> String {
        let mut parts = Vec::new();
        let thin = self.radius;
        match motion {
            None => {}
            Some(Motion::Prismatic) => {
                let edges = three([3.0 * thin, 3.0 * thin, 5.0 * thin]);
                parts.push(visual(&Numbers::default(), &format!("<box size=\"{edges}\"/>"), "axis"));
            }
            Some(_) => parts.push(visual(&Numbers::default(), &cylinder(1.8 * thin, 5.0 * thin), "axis")),
        }
        if let Some(row) = row {
            let d = row.d().unwrap_or(0.0);
            let (sine, cosine) = se3::sin_cos_of_written(row.theta());
            if d != 0.0 {
                let middle = Numbers { xyz: [0.0, 0.0, 0.5 * d], rpy: [0.0; 3] };
                parts.push(visual(&middle, &cylinder(thin, d.abs()), "arm"));
            }
            if row.a() != 0.0 {
                let half = Vector3::new(0.5 * row.a() * cosine, 0.5 * row.a() * sine, d);
                let middle = Numbers { xyz: half.into(), rpy: [0.0, FRAC_PI_2, row.theta()] };
                parts.push(visual(&middle, &cylinder(thin, row.a().abs()), "arm"));
            }
        }
        if parts.is_empty() {
            return format!("  <link name=\"{}\"/>\n", escaped(name));
        }
        format!("  <link name=\"{}\">\n{}  </link>\n", escaped(name), parts.concat())
    }

    /// The tip, shown by its axes.
    fn tip(&self) -> String {
        let (length, thin) = (6.0 * self.radius, 0.4 * self.radius);
        let half = 0.5 * length;
        let axes = [
            ("x", [half, 0.0, 0.0], [0.0, FRAC_PI_2, 0.0]),
            ("y", [0.0, half, 0.0], [-FRAC_PI_2, 0.0, 0.0]),
            ("z", [0.0, 0.0, half], [0.0; 3]),
        ];
        let axes = axes.map(|(colour, xyz, rpy)| visual(&Numbers { xyz, rpy }, &cylinder(thin, length), colour));
        format!("  <link name=\"{}\">\n{}  </link>\n", escaped(&self.table.tip), axes.concat())
    }
}

fn visual(origin: &Numbers, shape: &str, material: &str) -> String {
    let origin = origin.element();
    format!("    <visual>{origin}<geometry>{shape}</geometry><material name=\"{material}\"/></visual>\n")
}

fn cylinder(radius: f64, length: f64) -> String {
    format!("<cylinder radius=\"{}\" length=\"{}\"/>", word(radius), word(length))
}

/// The limits of a joint whose value is `multiplier` times the coordinate.
fn limit(coordinate: &Coordinate, multiplier: f64) -> String {
    let Limits { range, velocity, effort } = coordinate.limits;
    let (lower, upper) = range.unwrap_or_else(|| coordinate.range());
    let (lower, upper) = if multiplier < 0.0 {
        (upper * multiplier, lower * multiplier)
    } else {
        (lower * multiplier, upper * multiplier)
    };
    format!(
        "<limit lower=\"{}\" upper=\"{}\" effort=\"{}\" velocity=\"{}\"/>",
        word(lower),
        word(upper),
        word(effort.unwrap_or(0.0)),
        word(velocity.unwrap_or(0.0) * multiplier.abs())
    )
}
