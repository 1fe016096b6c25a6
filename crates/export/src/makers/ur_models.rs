//! The ideal arms of Universal Robots, and which of them a chain is.

use denavit_dh::{Convention, ConventionRow, Motion, RowLabel, Table, TableJoint};
use denavit_model::chain::{Chain, Coordinate, Quantity};
use denavit_model::nalgebra::Vector3;
use std::f64::consts::FRAC_PI_2;

/// A model: what `ur_type` calls it, and its lengths, m.
pub(crate) struct Model {
    pub name: &'static str,
    /// d1, d4, d5, d6.
    pub d: [f64; 4],
    /// a2, a3.
    pub a: [f64; 2],
}

/// Link twists of every model, rad.
pub(crate) const ALPHA: [f64; 6] = [FRAC_PI_2, 0.0, 0.0, FRAC_PI_2, -FRAC_PI_2, 0.0];

/// Source: Universal Robots, "DH Parameters for calculations of kinematics and dynamics".
pub(crate) const MODELS: &[Model] = &[
    Model { name: "ur3", d: [0.1519, 0.11235, 0.08535, 0.0819], a: [-0.24365, -0.21325] },
    Model { name: "ur5", d: [0.089_159, 0.10915, 0.09465, 0.0823], a: [-0.425, -0.39225] },
    Model { name: "ur10", d: [0.1273, 0.163_941, 0.1157, 0.0922], a: [-0.612, -0.5723] },
    Model { name: "ur3e", d: [0.15185, 0.13105, 0.08535, 0.0921], a: [-0.24355, -0.2132] },
    Model { name: "ur5e", d: [0.1625, 0.1333, 0.0997, 0.0996], a: [-0.425, -0.3922] },
    Model { name: "ur7e", d: [0.1625, 0.1333, 0.0997, 0.0996], a: [-0.425, -0.3922] },
    Model { name: "ur10e", d: [0.1807, 0.17415, 0.11985, 0.11655], a: [-0.6127, -0.57155] },
    Model { name: "ur12e", d: [0.1807, 0.17415, 0.11985, 0.11655], a: [-0.6127, -0.57155] },
    Model { name: "ur16e", d: [0.1807, 0.17415, 0.11985, 0.11655], a: [-0.4784, -0.36] },
    Model { name: "ur20", d: [0.2363, 0.2010, 0.1593, 0.1543], a: [-0.8620, -0.7287] },
    Model { name: "ur30", d: [0.2363, 0.2010, 0.1593, 0.1543], a: [-0.6370, -0.5037] },
];

pub(crate) fn names() -> String {
    MODELS.iter().map(|model| model.name).collect::<Vec<_>>().join(", ")
}

impl Model {
    pub fn named(name: &str) -> Option<&'static Self> {
        MODELS.iter().find(|model| model.name == name.to_lowercase())
    }

    /// d, a of all six rows.
    pub fn rows(&self) -> [(f64, f64); 6] {
        let ([d1, d4, d5, d6], [a2, a3]) = (self.d, self.a);
        [(d1, 0.0), (0.0, a2), (0.0, a3), (d4, 0.0), (d5, 0.0), (d6, 0.0)]
    }

    /// Its table with the corrections of one arm to theta, d, alpha, a of each row.
    pub fn table(&self, robot: &str, added: &[[f64; 4]; 6]) -> Result<Table, denavit_dh::conventions::RowsError> {
        let nothing = |label| ConventionRow { label, theta: None, d: None, alpha: None, a: None, beta: None };
        let mut rows = vec![nothing(RowLabel::Base)];
        for (index, ((d, a), [dt, dd, dalpha, da])) in self.rows().into_iter().zip(added).enumerate() {
            rows.push(ConventionRow {
                label: RowLabel::Joint(index),
                theta: Some(*dt),
                d: Some(d + dd),
                alpha: Some(ALPHA[index] + dalpha),
                a: Some(a + da),
                beta: None,
            });
        }
        rows.push(nothing(RowLabel::Tool));
        let names = crate::kinematics_yaml::NAMES.map(|(_, joint)| joint);
        let coordinates = names.iter().map(|name| Coordinate::unlimited(*name, Quantity::Angle)).collect();
        let joint = |(coordinate, name): (usize, &&str)| TableJoint {
            name: (*name).to_owned(),
            motion: Motion::Revolute,
            coordinate,
            scale: 1.0,
        };
        let joints = names.iter().enumerate().map(joint).collect();
        Table::from_convention_rows((robot, "base", "tool0"), coordinates, joints, Convention::Distal, &rows)
    }
}

/// Allowed deviation of an arm's axes from a model's, far above any factory calibration, rad and m.
const ANGLE: f64 = 0.03;
const LENGTH: f64 = 0.012;

/// How the axes of a chain lie to each other at zero: u·v, and the distance of parallel lines or the moment of others.
fn relations(chain: &Chain) -> Option<Vec<(f64, f64)>> {
    let lines: Vec<_> = chain.joints().iter().map(|joint| joint.screw.line()).collect::<Option<_>>()?;
    let mut found = Vec::new();
    for (i, one) in lines.iter().enumerate() {
        for other in &lines[i + 1..] {
            let (u, v) = (one.direction.into_inner(), other.direction.into_inner());
            let between: Vector3<f64> = other.point - one.point;
            let cosine = u.dot(&v);
            let apart =
                if cosine.abs() > 0.9 { (between - u * between.dot(&u)).norm() } else { between.dot(&u.cross(&v)) };
            found.push((cosine, apart));
        }
    }
    Some(found)
}

/// The model of this arm, up to the size of a calibration: the nearest one, of identical ones the first.
pub(crate) fn model_of(chain: &Chain) -> Option<&'static str> {
    let own = relations(chain)?;
    let mut nearest: Option<(f64, &'static str)> = None;
    for model in MODELS {
        let ideal = relations(&model.table("", &[[0.0; 4]; 6]).ok()?.chain().ok()?)?;
        let near = |(a, b): (&(f64, f64), &(f64, f64))| (a.0 - b.0).abs() <= ANGLE && (a.1 - b.1).abs() <= LENGTH;
        if own.len() != ideal.len() || !own.iter().zip(&ideal).all(near) {
            continue;
        }
        let off = |(a, b): (&(f64, f64), &(f64, f64))| ((a.0 - b.0) / ANGLE).powi(2) + ((a.1 - b.1) / LENGTH).powi(2);
        let miss: f64 = own.iter().zip(&ideal).map(off).sum();
        if nearest.is_none_or(|(least, _)| miss < least) {
            nearest = Some((miss, model.name));
        }
    }
    nearest.map(|(_, name)| name)
}
