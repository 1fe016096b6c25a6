//! The robot as other Rust programs hold it: `urdf_rs::Robot` in and out (feature `urdf-rs`, on by default).
//!
//! `urdf-rs` knows links, joints and materials. What it does not know - transmissions, simulators' settings, screw
//! joints - is missing in robots from it and is lost in robots for it.

use crate::element::{Element, ElementNode};
use crate::problems::UrdfError;
use crate::robot::{Geometry, Inertial, Joint, JointKind, Link, Origin, Robot, Shape};
use crate::{urdf, write};
use nalgebra::Matrix3;
use thiserror::Error;
use urdf_rs::{JointType, Pose, Vec3};

/// Why a robot cannot be converted from or to `urdf-rs`.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ExchangeError {
    /// It could not be written as text.
    #[error("urdf-rs cannot write the robot: {0}")]
    Write(#[from] Box<urdf_rs::UrdfError>),
    /// It is no tree, or has names twice.
    #[error(transparent)]
    Robot(#[from] UrdfError),
    /// A joint of a kind that `urdf-rs` does not have.
    #[error("joint \"{joint}\": urdf-rs has no {kind} joint")]
    Kind {
        /// The joint.
        joint: String,
        /// Its kind.
        kind: String,
    },
    /// A shape of a kind that `urdf-rs` does not have.
    #[error("link \"{link}\": urdf-rs has no shape <{shape}>")]
    Shape {
        /// The link.
        link: String,
        /// The shape's element.
        shape: String,
    },
}

impl Robot {
    /// A robot that another program has read with `urdf-rs`.
    ///
    /// `urdf-rs` gives a link without `inertial` a mass and tensor of 0, and a joint without `limit` limits of 0: these
    /// are read as not stated.
    ///
    /// # Errors
    /// It is no tree, or has names twice: `urdf-rs` does not look.
    ///
    /// # Examples
    /// ```
    /// use denavit_model::{Reading, Robot};
    /// let theirs = urdf_rs::read_from_string(r#"<robot name="r"><link name="a"/><link name="b"/>
    ///   <joint name="j" type="revolute"><parent link="a"/><child link="b"/>
    ///   <limit lower="-1" upper="1" effort="5" velocity="2"/></joint></robot>"#)?;
    /// let chain = Robot::from_urdf_rs(&theirs)?.chain(None, None, Reading::Intended)?.value;
    /// assert_eq!(chain.coordinates()[0].limits.effort, Some(5.0));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn from_urdf_rs(robot: &urdf_rs::Robot) -> Result<Self, ExchangeError> {
        let mut read = read_back(robot)?;
        for link in &mut read.links {
            let stated = |it: &Inertial| it.mass != 0.0 || it.tensor != Matrix3::zeros() || it.origin.xyz != [0.0; 3];
            link.inertial = link.inertial.take().filter(stated);
        }
        for joint in &mut read.joints {
            let limits = &mut joint.limits;
            if (limits.range, limits.velocity, limits.effort) == (Some((0.0, 0.0)), Some(0.0), Some(0.0)) {
                *limits = crate::Limits::default();
            }
        }
        Ok(read)
    }

    /// The robot for programs that use `urdf-rs`.
    ///
    /// # Errors
    /// It has a joint or a shape that `urdf-rs` does not know.
    ///
    /// # Examples
    /// ```
    /// let text = r#"<robot name="r"><link name="a"/></robot>"#;
    /// let theirs = denavit_model::urdf::read("r.urdf", text)?.to_urdf_rs()?;
    /// assert_eq!(theirs.links[0].name, "a");
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn to_urdf_rs(&self) -> Result<urdf_rs::Robot, ExchangeError> {
        let materials = self.elements.iter().filter(|element| element.tag() == "material").map(material);
        Ok(urdf_rs::Robot {
            name: self.name.clone(),
            version: None,
            links: self.links.iter().map(link).collect::<Result<_, _>>()?,
            joints: self.joints.iter().map(|it| joint(self, it)).collect::<Result<_, _>>()?,
            materials: materials.collect(),
        })
    }
}

/// Their robot by way of its text. `urdf-rs` cannot write a texture that it has read, so these go around the text.
fn read_back(robot: &urdf_rs::Robot) -> Result<Robot, ExchangeError> {
    let mut plain = robot.clone();
    let of_links = plain.links.iter_mut().flat_map(|link| &mut link.visual).filter_map(|it| it.material.as_mut());
    let textures: Vec<_> = plain.materials.iter_mut().chain(of_links).map(|it| it.texture.take()).collect();
    let text = urdf_rs::write_to_string(&plain).map_err(Box::new)?;
    let mut read = urdf::read(&robot.name, &text)?;
    if textures.iter().all(Option::is_none) {
        return Ok(read);
    }
    let of_links = read.links.iter_mut().flat_map(|link| &mut link.visuals).flat_map(|it| &mut it.elements);
    let materials = read.elements.iter_mut().chain(of_links).filter(|element| element.tag() == "material");
    for (material, texture) in materials.zip(textures) {
        let Some(texture) = texture else { continue };
        let attributes = vec![("filename".to_owned(), texture.filename)];
        material.nodes.push(ElementNode { depth: 1, tag: "texture".into(), attributes, text: String::new() });
    }
    Ok(urdf::read(&robot.name, &write::urdf(&read))?)
}

fn pose(origin: &Origin) -> Pose {
    Pose { xyz: Vec3(origin.xyz), rpy: Vec3(origin.rpy) }
}

fn link(link: &Link) -> Result<urdf_rs::Link, ExchangeError> {
    let inertial = link.inertial.as_ref().map_or_else(urdf_rs::Inertial::default, |it| {
        let t = &it.tensor;
        urdf_rs::Inertial {
            origin: pose(&it.origin),
            mass: urdf_rs::Mass { value: it.mass },
            inertia: urdf_rs::Inertia {
                ixx: t[(0, 0)],
                ixy: t[(0, 1)],
                ixz: t[(0, 2)],
                iyy: t[(1, 1)],
                iyz: t[(1, 2)],
                izz: t[(2, 2)],
            },
        }
    });
    let visual = link.visuals.iter().map(|shape| {
        Ok(urdf_rs::Visual {
            name: shape.name.clone(),
            origin: pose(&shape.origin),
            geometry: geometry(link, shape)?,
            material: shape.elements.iter().find(|element| element.tag() == "material").map(material),
        })
    });
    let collision = link.collisions.iter().map(|shape| {
        let (origin, geometry) = (pose(&shape.origin), geometry(link, shape)?);
        Ok(urdf_rs::Collision { name: shape.name.clone(), origin, geometry })
    });
    let visual = visual.collect::<Result<_, ExchangeError>>()?;
    let collision = collision.collect::<Result<_, ExchangeError>>()?;
    Ok(urdf_rs::Link { name: link.name.clone(), inertial, visual, collision })
}

fn geometry(link: &Link, shape: &Shape) -> Result<urdf_rs::Geometry, ExchangeError> {
    Ok(match &shape.geometry {
        Geometry::Box(edges) => urdf_rs::Geometry::Box { size: Vec3(*edges) },
        Geometry::Cylinder { radius, length } => urdf_rs::Geometry::Cylinder { radius: *radius, length: *length },
        Geometry::Capsule { radius, length } => urdf_rs::Geometry::Capsule { radius: *radius, length: *length },
        Geometry::Sphere(radius) => urdf_rs::Geometry::Sphere { radius: *radius },
        Geometry::Mesh { filename, scale } => {
            let scale = (*scale != [1.0; 3]).then_some(Vec3(*scale));
            urdf_rs::Geometry::Mesh { filename: filename.clone(), scale }
        }
        Geometry::Other(shape) => {
            return Err(ExchangeError::Shape { link: link.name.clone(), shape: shape.clone() });
        }
    })
}

fn material(element: &Element) -> urdf_rs::Material {
    let of = |tag: &str, attribute: &str| {
        element.nodes.iter().find(|node| node.tag == tag).and_then(|node| node.attribute(attribute)).map(str::to_owned)
    };
    let color = of("color", "rgba").and_then(|rgba| {
        let numbers: Vec<f64> = rgba.split_whitespace().filter_map(|word| word.parse().ok()).collect();
        Some(urdf_rs::Color { rgba: urdf_rs::Vec4(numbers.try_into().ok()?) })
    });
    let texture = of("texture", "filename").map(|filename| urdf_rs::Texture { filename });
    urdf_rs::Material { name: element.attribute("name").unwrap_or_default().to_owned(), color, texture }
}

fn joint(robot: &Robot, joint: &Joint) -> Result<urdf_rs::Joint, ExchangeError> {
    let joint_type = match &joint.kind {
        JointKind::Fixed => JointType::Fixed,
        JointKind::Revolute => JointType::Revolute,
        JointKind::Continuous => JointType::Continuous,
        JointKind::Prismatic => JointType::Prismatic,
        JointKind::Planar => JointType::Planar,
        JointKind::Floating => JointType::Floating,
        JointKind::Unknown(word) if word == "spherical" => JointType::Spherical,
        kind => {
            return Err(ExchangeError::Kind { joint: joint.name.clone(), kind: kind.word().to_owned() });
        }
    };
    let name = |index: usize| robot.links.get(index).map_or_else(String::new, |link| link.name.clone());
    let further = |tag: &str| joint.elements.iter().find(|element| element.tag() == tag);
    let further_limit = |name: &str| further("limit").and_then(|limit| limit.number(name));
    let (lower, upper) = joint.limits.range.unwrap_or_default();
    let acceleration = further_limit("acceleration").unwrap_or(f64::INFINITY);
    let soft = joint.soft_limits().map(|soft| {
        let (lower, upper) = soft.range.unwrap_or_default();
        urdf_rs::SafetyController {
            soft_lower_limit: lower,
            soft_upper_limit: upper,
            k_position: soft.k_position,
            k_velocity: soft.k_velocity,
        }
    });
    Ok(urdf_rs::Joint {
        name: joint.name.clone(),
        joint_type,
        origin: pose(&joint.origin),
        parent: urdf_rs::LinkName { link: name(joint.parent) },
        child: urdf_rs::LinkName { link: name(joint.child) },
        axis: joint.axis_written.map_or_else(urdf_rs::Axis::default, |axis| urdf_rs::Axis { xyz: Vec3(axis) }),
        limit: urdf_rs::JointLimit {
            lower,
            upper,
            effort: joint.limits.effort.unwrap_or(0.0),
            velocity: joint.limits.velocity.unwrap_or(0.0),
            acceleration,
            deceleration: further_limit("deceleration").unwrap_or(acceleration),
            jerk: further_limit("jerk").unwrap_or(f64::INFINITY),
        },
        calibration: further("calibration").map(|calibration| urdf_rs::Calibration {
            rising: calibration.number("rising"),
            falling: calibration.number("falling"),
        }),
        dynamics: further("dynamics").map(|_| {
            let dynamics = joint.dynamics();
            urdf_rs::Dynamics { damping: dynamics.damping, friction: dynamics.friction }
        }),
        mimic: joint.mimic.as_ref().map(|mimic| urdf_rs::Mimic {
            joint: mimic.joint.clone(),
            multiplier: Some(mimic.multiplier),
            offset: Some(mimic.offset),
        }),
        safety_controller: soft,
    })
}
