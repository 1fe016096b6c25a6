//! Mass, centre and inertia tensor: of solids, of parts together, and changed by a model's compiler settings.

use denavit_model::nalgebra::{Matrix3, Vector3};
use denavit_model::se3::Pose;
use std::f64::consts::PI;

/// Mass (kg) and moments of inertia (kg·m²) that mean none in a moving body: MuJoCo refuses less than 1e-15.
pub const LEAST: f64 = 1e-12;

/// The exponent of Thomsen's formula for the area of an ellipsoid, which is then right to 1.1 %.
const THOMSEN: f64 = 1.6075;

/// The thickness of an ellipsoid's surface, m, as MuJoCo takes it (`mjCGeom::SetInertia`).
const LAYER: f64 = 1e-6;

/// Mass properties in some frame.
#[expect(clippy::struct_field_names, reason = "the mass of a mass is what its field is called everywhere")]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mass {
    /// kg.
    pub mass: f64,
    /// Centre of mass, m.
    pub centre: Vector3<f64>,
    /// About the centre, along the frame's axes, kg·m².
    pub tensor: Matrix3<f64>,
}

/// A solid's volume (m³), or a shell's area (m²), and its inertia tensor about its centre for a density of 1 kg/m³ or 1 kg/m².
#[derive(Debug, Clone, Copy)]
pub struct Solid {
    pub volume: f64,
    pub centre: Vector3<f64>,
    pub tensor: Matrix3<f64>,
}

impl Solid {
    fn new(volume: f64, diagonal: [f64; 3]) -> Self {
        let tensor = Matrix3::from_diagonal(&Vector3::from(diagonal));
        Self { volume, centre: Vector3::zeros(), tensor }
    }

    /// Half-axes a, b, c (m).
    pub fn ellipsoid([a, b, c]: [f64; 3]) -> Self {
        let volume = 4.0 / 3.0 * PI * a * b * c;
        let k = volume / 5.0;
        Self::new(volume, [k * (b * b + c * c), k * (a * a + c * c), k * (a * a + b * b)])
    }

    /// The surface of an ellipsoid of half-axes a, b, c (m), which has no closed form, as MuJoCo approximates it: its area by
    /// Thomsen's formula, its tensor that of the layer below an ellipsoid with half-axes longer by [`LAYER`].
    pub fn ellipsoid_shell(half: [f64; 3]) -> Self {
        let [a, b, c] = half.map(|axis| axis.powf(THOMSEN));
        let area = 4.0 * PI * ((a * b + a * c + b * c) / 3.0).powf(1.0 / THOMSEN);
        let (inner, outer) = (Self::ellipsoid(half), Self::ellipsoid(half.map(|axis| axis + LAYER)));
        let tensor = (outer.tensor - inner.tensor) * (area / (outer.volume - inner.volume));
        Self { volume: area, centre: Vector3::zeros(), tensor }
    }

    /// Half-edges a, b, c (m).
    pub fn cuboid([a, b, c]: [f64; 3]) -> Self {
        let volume = 8.0 * a * b * c;
        let k = volume / 3.0;
        Self::new(volume, [k * (b * b + c * c), k * (a * a + c * c), k * (a * a + b * b)])
    }

    /// Radius and half-length along z (m).
    pub fn cylinder(radius: f64, half: f64) -> Self {
        let volume = PI * radius * radius * 2.0 * half;
        let across = volume * (radius * radius / 4.0 + half * half / 3.0);
        Self::new(volume, [across, across, volume * radius * radius / 2.0])
    }

    /// Radius and half-length along z without the caps (m).
    pub fn capsule(radius: f64, half: f64) -> Self {
        let middle = Self::cylinder(radius, half);
        let ball = 4.0 / 3.0 * PI * radius.powi(3);
        // A half ball's centre is 3/8 of the radius from its flat side; both halves are `half` from the middle.
        let own = ball * 2.0 / 5.0 * radius * radius;
        let across = own + ball * (half * half + 0.75 * half * radius);
        let [x, z] = [middle.tensor[(0, 0)] + across, middle.tensor[(2, 2)] + own];
        Self::new(middle.volume + ball, [x, x, z])
    }

    /// The surface of a ball of this radius (m).
    pub fn sphere_shell(radius: f64) -> Self {
        let area = 4.0 * PI * radius * radius;
        Self::new(area, [area * radius * radius * 2.0 / 3.0; 3])
    }

    /// The six faces of a box of half-edges a, b, c (m).
    pub fn cuboid_shell(half: [f64; 3]) -> Self {
        // Of both faces across each axis, the mean square along each.
        let area = |axis: usize| 8.0 * half[(axis + 1) % 3] * half[(axis + 2) % 3];
        let square = |face: usize, along: usize| half[along].powi(2) / if face == along { 1.0 } else { 3.0 };
        let second = [0, 1, 2].map(|along| (0..3).map(|face| area(face) * square(face, along)).sum::<f64>());
        let [x, y, z] = second;
        Self::new((0..3).map(area).sum(), [y + z, x + z, x + y])
    }

    /// The side of a cylinder of this radius and half-length along z (m).
    fn tube(radius: f64, half: f64) -> Self {
        let area = 4.0 * PI * radius * half;
        let across = area * (radius * radius / 2.0 + half * half / 3.0);
        Self::new(area, [across, across, area * radius * radius])
    }

    /// Side and ends of a cylinder of this radius and half-length along z (m).
    pub fn cylinder_shell(radius: f64, half: f64) -> Self {
        let tube = Self::tube(radius, half);
        let ends = 2.0 * PI * radius * radius;
        let across = tube.tensor[(0, 0)] + ends * (radius * radius / 4.0 + half * half);
        Self::new(tube.volume + ends, [across, across, tube.tensor[(2, 2)] + ends * radius * radius / 2.0])
    }

    /// The surface of a capsule of this radius and half-length along z without the caps (m).
    pub fn capsule_shell(radius: f64, half: f64) -> Self {
        let (tube, ball) = (Self::tube(radius, half), Self::sphere_shell(radius));
        // A half sphere's centre is half the radius from its flat side.
        let across = tube.tensor[(0, 0)] + ball.tensor[(0, 0)] + ball.volume * half * (half + radius);
        Self::new(tube.volume + ball.volume, [across, across, tube.tensor[(2, 2)] + ball.tensor[(2, 2)]])
    }

    /// The solid with this mass (kg), placed.
    pub fn of_mass(&self, mass: f64, pose: &Pose) -> Mass {
        let scale = if self.volume > 0.0 { mass / self.volume } else { 0.0 };
        Mass { mass, centre: self.centre, tensor: self.tensor * scale }.placed(pose)
    }
}

impl Mass {
    /// The same in the frame that `pose` places this one in.
    pub fn placed(&self, pose: &Pose) -> Self {
        let r = pose.rotation.matrix();
        let centre = pose.rotation * self.centre + pose.translation.vector;
        Self { mass: self.mass, centre, tensor: r * self.tensor * r.transpose() }
    }

    /// Parts as one body; `None` where they have no mass.
    pub fn together(parts: &[Self]) -> Option<Self> {
        let mass: f64 = parts.iter().map(|part| part.mass).sum();
        if mass <= 0.0 {
            return None;
        }
        let centre = parts.iter().map(|part| part.centre * part.mass).sum::<Vector3<f64>>() / mass;
        let tensor = parts.iter().map(|part| {
            let d = part.centre - centre;
            part.tensor + (Matrix3::identity() * d.dot(&d) - d * d.transpose()) * part.mass
        });
        Some(Self { mass, centre, tensor: tensor.sum() })
    }

    /// The principal moments, ascending, kg·m².
    pub fn moments(&self) -> [f64; 3] {
        let mut moments: Vec<f64> = self.tensor.symmetric_eigenvalues().iter().copied().collect();
        moments.sort_by(f64::total_cmp);
        [moments[0], moments[1], moments[2]]
    }
}

/// Whether a body can have these principal moments (ascending): A + B ≥ C, but for the digits that were written.
pub fn is_possible([a, b, c]: [f64; 3]) -> bool {
    // MuJoCo's own slack is 1e-6 of the largest.
    a >= 0.0 && a + b >= c * (1.0 - 1e-6)
}
