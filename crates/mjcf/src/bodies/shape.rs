//! Geoms: visuals, collisions, and their mass.

use super::{At, Reader, Stand};
use crate::Files;
use crate::document::Item;
use crate::mass::{Mass, Solid};
use crate::mesh::{self, Inside, Triangles};
use crate::place::{fixed, from_to, number, numbers, vector};
use denavit_model::nalgebra::{Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3};
use denavit_model::problems::nearest_name;
use denavit_model::robot::Geometry;
use denavit_model::se3::{self, Pose};
use std::collections::HashMap;
use std::rc::Rc;

/// kg/m³, where a geom states neither density nor mass.
const WATER: f64 = 1000.0;

/// Geoms of higher groups are hidden by default.
const LAST_SHOWN_GROUP: f64 = 2.0;

/// A geom.
#[derive(Debug, Clone)]
pub struct Shape {
    pub name: Option<String>,
    /// In the body's frame.
    pub pose: Pose,
    /// The URDF shape; `None` where URDF has none.
    pub geometry: Option<Geometry>,
    pub seen: bool,
    pub collides: bool,
    pub rgba: Option<[f64; 4]>,
    /// In the body's frame.
    pub mass: Option<Mass>,
    pub at: At,
}

/// A mesh asset.
#[derive(Debug, Clone)]
struct Mesh {
    /// Its file from the model's folder; `None` where the model holds the mesh itself.
    file: Option<String>,
    scale: [f64; 3],
    /// geom_from_file, the scale's turn not counted.
    refpos: Vector3<f64>,
    refquat: Rotation3<f64>,
    inside: Inside,
    /// The mesh data in the model itself.
    own: Option<Triangles>,
}

/// Meshes and colours by name, and solids that were read.
#[derive(Debug, Default)]
pub struct Meshes {
    assets: HashMap<String, Rc<Mesh>>,
    colours: HashMap<String, [f64; 4]>,
    solids: HashMap<String, Result<Solid, String>>,
}

impl<'a> Reader<'a> {
    pub(super) fn material(&mut self, item: &Item) {
        let rgba = fixed::<4>(item, "rgba");
        let Some(rgba) = self.good(item, rgba) else { return };
        if let (Some(name), Some(c)) = (item.get("name"), rgba) {
            self.meshes.colours.insert(name.to_owned(), [c[0], c[1], c[2], c[3]]);
        }
    }

    pub(super) fn mesh(&mut self, item: &Item<'a>) {
        let nowhere = Stand { body: 0, body_from_here: Pose::identity(), childclass: None };
        let Some(resolved) = self.resolved(item, &nowhere) else { return };
        let file = resolved.get("file").map(|file| self.settings.mesh_path(file));
        let stem = |file: &str| {
            let last = file.rsplit(['/', '\\']).next().unwrap_or(file);
            last.rsplit_once('.').map_or(last, |(stem, _)| stem).to_owned()
        };
        let name = match (resolved.get("name"), &file) {
            (Some(name), _) => name.to_owned(),
            (None, Some(file)) => stem(file),
            (None, None) => {
                self.problem(item, "has neither name nor file; name the mesh's file");
                return;
            }
        };
        self.account_as(&resolved, "mesh", Some(&name));
        for inner in &item.children {
            self.keep(inner, "URDF has no such part of a mesh");
        }
        let read = || -> Result<Mesh, String> {
            let scale = vector(&resolved, "scale")?.map_or([1.0; 3], Into::into);
            let refpos = vector(&resolved, "refpos")?.unwrap_or_default();
            let refquat = match fixed::<4>(&resolved, "refquat")? {
                None => Rotation3::identity(),
                Some(q) => UnitQuaternion::try_new(Quaternion::new(q[0], q[1], q[2], q[3]), 1e-14)
                    .ok_or("refquat has length 0; write w x y z of a rotation")?
                    .to_rotation_matrix(),
            };
            let inside = match resolved.get("inertia") {
                None | Some("legacy") => Inside::Absolute,
                Some("exact") => Inside::Signed,
                Some("convex") => Inside::Hull,
                Some("shell") => Inside::Nothing,
                Some(word) => {
                    return Err(format!(
                        "inertia=\"{word}\" is not a valid value; write convex, exact, legacy or shell"
                    ));
                }
            };
            Ok(Mesh { file, scale, refpos, refquat, inside, own: own_triangles(&resolved)? })
        };
        let read = read();
        if let Some(mesh) = self.good(item, read) {
            self.meshes.assets.insert(name, Rc::new(mesh));
        }
    }

    pub(super) fn geom(&mut self, item: &Item<'a>, stand: &Stand, files: &mut Files) {
        let Some(resolved) = self.resolved(item, stand) else { return };
        let owner = self.bodies[stand.body].name.clone();
        let name = resolved.get("name").map(str::to_owned);
        self.account_as(&resolved, "geom", name.as_deref());
        let read = self.geom_of(&resolved, &owner, files);
        let Some(mut shape) = self.good(item, read) else { return };
        shape.pose = stand.body_from_here * shape.pose;
        shape.mass = shape.mass.map(|mass| mass.placed(&stand.body_from_here));
        if shape.geometry.is_none() {
            let text = format!("<body name=\"{}\">{}</body>", denavit_model::write::escaped(&owner), resolved.xml());
            self.keep_as(item, text, "URDF has no such shape; it is neither drawn nor collides");
        }
        self.bodies[stand.body].shapes.push(shape);
    }

    fn geom_of(&mut self, item: &Item, owner: &str, files: &mut Files) -> Result<Shape, String> {
        let word = item.get("type").unwrap_or(if item.get("mesh").is_some() { "mesh" } else { "sphere" });
        let size = numbers(item, "size", 1..=3)?.unwrap_or_default();
        let shell = item.get("shellinertia") == Some("true");
        let along = if ["capsule", "cylinder", "box", "ellipsoid"].contains(&word) { from_to(item)? } else { None };
        let mut pose = match along {
            Some((pose, _)) => pose,
            None => crate::place::pose(item, &self.settings.angles)?,
        };
        let needed = |count: usize| -> Result<Vec<f64>, String> {
            let mut size = size.clone();
            if let Some((_, half)) = along {
                let radius = size.first().copied().unwrap_or(0.0);
                size = if count == 2 {
                    vec![radius, half]
                } else {
                    vec![radius, size.get(1).copied().unwrap_or(radius), half]
                };
            }
            if size.len() < count || size[..count].iter().any(|length| *length <= 0.0) {
                return Err(format!("a {word} needs {count} positive size(s), m; write size=\"…\""));
            }
            Ok(size)
        };
        let (geometry, solid): (Option<Geometry>, Option<Solid>) = match word {
            // A geom that is fitted to a mesh has no size before the mesh is read.
            "sphere" | "capsule" | "ellipsoid" | "cylinder" | "box" if item.get("mesh").is_some() => (None, None),
            "sphere" => {
                let size = needed(1)?;
                let solid = if shell { Solid::sphere_shell(size[0]) } else { Solid::ellipsoid([size[0]; 3]) };
                (Some(Geometry::Sphere(size[0])), Some(solid))
            }
            "capsule" => {
                let size = needed(2)?;
                let geometry = Geometry::Capsule { radius: size[0], length: 2.0 * size[1] };
                let solid = if shell { Solid::capsule_shell } else { Solid::capsule };
                (Some(geometry), Some(solid(size[0], size[1])))
            }
            "cylinder" => {
                let size = needed(2)?;
                let geometry = Geometry::Cylinder { radius: size[0], length: 2.0 * size[1] };
                let solid = if shell { Solid::cylinder_shell } else { Solid::cylinder };
                (Some(geometry), Some(solid(size[0], size[1])))
            }
            "box" => {
                let size = needed(3)?;
                let geometry = Geometry::Box([2.0 * size[0], 2.0 * size[1], 2.0 * size[2]]);
                let solid = if shell { Solid::cuboid_shell } else { Solid::cuboid };
                (Some(geometry), Some(solid([size[0], size[1], size[2]])))
            }
            "ellipsoid" => {
                let size = needed(3)?;
                let solid = if shell { Solid::ellipsoid_shell } else { Solid::ellipsoid };
                (None, Some(solid([size[0], size[1], size[2]])))
            }
            "mesh" => {
                let name = item.get("mesh").ok_or("is of type mesh but names no mesh; write mesh=\"…\"")?;
                let Some(found) = self.meshes.assets.get(name).cloned() else {
                    let near = nearest_name(name, self.meshes.assets.keys().map(String::as_str));
                    let advice = near.map_or("define it in <asset>".into(), |near| format!("did you mean \"{near}\"?"));
                    return Err(format!("there is no mesh \"{name}\"; {advice}"));
                };
                return self.mesh_shape(item, owner, name, &found, &mut pose, files);
            }
            "plane" | "hfield" | "sdf" => (None, None),
            _ => {
                return Err(format!(
                    "type=\"{word}\" is not a shape; write sphere, capsule, ellipsoid, cylinder, box, mesh or plane"
                ));
            }
        };
        let mass = match solid {
            Some(solid) => self.mass_by(item, &pose, || Ok(solid))?,
            None => None,
        };
        self.shape(item, pose, geometry, mass)
    }

    fn mesh_shape(
        &mut self,
        item: &Item,
        owner: &str,
        name: &str,
        found: &Mesh,
        pose: &mut Pose,
        files: &mut Files,
    ) -> Result<Shape, String> {
        let needs_volume = match number(item, "mass")? {
            Some(mass) => mass > 0.0,
            None => number(item, "density")?.is_none_or(|density| density > 0.0),
        };
        let body_needs = match self.settings.from_geoms {
            super::FromGeoms::Never => false,
            super::FromGeoms::Always => true,
            super::FromGeoms::WhereNoneIsStated => {
                let body = self.bodies.iter().rfind(|body| body.name == owner);
                // A stated inertial may also stand behind the geom.
                body.is_some_and(|body| body.mass.is_none()) && !self.states_inertial(owner)
            }
        };
        let mut mass = None;
        if needs_volume && body_needs && owner != "world" {
            if !self.meshes.solids.contains_key(name) {
                let solid = solid_of(found, files);
                self.meshes.solids.insert(name.to_owned(), solid);
            }
            match self.meshes.solids.get(name) {
                Some(Ok(solid)) => {
                    let solid = *solid;
                    mass = self.mass_by(item, pose, || Ok(solid))?;
                }
                Some(Err(why)) => {
                    let what = format!(
                        "its mass is not known here: mesh \"{name}\" {why}; add the file, or give the body an <inertial>"
                    );
                    self.note(item, what);
                }
                None => {}
            }
        }
        // URDF: T · scale · v. Here: T · scale · Rᵀ (v - p), with p and R those of refpos and refquat.
        let scale = Matrix3::from_diagonal(&Vector3::from(found.scale));
        let back = found.refquat.inverse();
        let turned = se3::rotation_angle(&back) > 0.0;
        let even = found.scale[0] == found.scale[1] && found.scale[1] == found.scale[2];
        let shift = -(scale * (back * found.refpos));
        let geometry = match &found.file {
            Some(file) if !turned || even => {
                *pose *= se3::pose(back, shift);
                Some(Geometry::Mesh { filename: file.clone(), scale: found.scale })
            }
            _ => None,
        };
        self.shape(item, *pose, geometry, mass)
    }

    fn states_inertial(&self, body: &str) -> bool {
        let mut open: Vec<&Item> = self.document.sections("worldbody").collect();
        while let Some(item) = open.pop() {
            if item.tag == "body" && item.get("name") == Some(body) {
                return item.children.iter().any(|child| child.tag == "inertial");
            }
            open.extend(item.children.iter().filter(|child| child.tag == "body" || child.tag == "frame"));
        }
        false
    }

    /// The mass of a geom in its body's frame; `None` where its group or its own numbers give it none.
    fn mass_by(
        &self,
        item: &Item,
        pose: &Pose,
        solid: impl FnOnce() -> Result<Solid, String>,
    ) -> Result<Option<Mass>, String> {
        let group = number(item, "group")?.unwrap_or(0.0);
        let (lower, upper) = self.settings.groups;
        if group < lower as f64 || group > upper as f64 {
            return Ok(None);
        }
        let solid = solid()?;
        let mass = match (number(item, "mass")?, number(item, "density")?) {
            (Some(mass), _) => mass,
            (None, density) => density.unwrap_or(WATER) * solid.volume,
        };
        if mass < 0.0 {
            return Err("its mass is negative; write 0 or more".into());
        }
        Ok((mass > 0.0).then(|| solid.of_mass(mass, pose)))
    }

    fn shape(&self, item: &Item, pose: Pose, geometry: Option<Geometry>, mass: Option<Mass>) -> Result<Shape, String> {
        let whole = |attribute: &str, otherwise: f64| number(item, attribute).map(|found| found.unwrap_or(otherwise));
        let collides = whole("contype", 1.0)? != 0.0 || whole("conaffinity", 1.0)? != 0.0;
        let seen = whole("group", 0.0)? <= LAST_SHOWN_GROUP || !collides;
        let rgba = fixed::<4>(item, "rgba")?.map(|c| [c[0], c[1], c[2], c[3]]);
        let of_material = || self.meshes.colours.get(item.get("material")?).copied();
        let rgba = rgba.or_else(of_material);
        let name = item.get("name").map(str::to_owned);
        Ok(Shape { name, pose, geometry, seen, collides, rgba, mass, at: item.at })
    }
}

/// The triangles in a model itself.
fn own_triangles(item: &Item) -> Result<Option<Triangles>, String> {
    let Some(vertices) = numbers(item, "vertex", 12..=usize::MAX)? else { return Ok(None) };
    let Some(faces) = numbers(item, "face", 3..=usize::MAX)? else { return Ok(None) };
    let corner = |index: f64| {
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "an index out of range is refused below"
        )]
        let at = index as usize * 3;
        let found = vertices.get(at..at + 3).map(|v| Vector3::new(v[0], v[1], v[2]));
        found.ok_or_else(|| format!("face names vertex {index}, which does not exist; count from 0"))
    };
    let triangles = faces.chunks_exact(3).map(|f| Ok([corner(f[0])?, corner(f[1])?, corner(f[2])?]));
    Ok(Some(triangles.collect::<Result<_, String>>()?))
}

/// The solid inside a mesh, as its asset turns and scales it.
fn solid_of(found: &Mesh, files: &mut Files) -> Result<Solid, String> {
    let mut triangles = match (&found.own, &found.file) {
        (Some(own), _) => own.clone(),
        (None, Some(file)) => {
            let bytes = files(file).map_err(|why| format!("cannot be read: {why}"))?;
            mesh::triangles(file, &bytes).map_err(|why| format!("cannot be read: {file}: {why}"))?
        }
        (None, None) => return Err("has no faces of its own".into()),
    };
    let scale = Vector3::from(found.scale);
    let mirrored = scale.x * scale.y * scale.z < 0.0;
    for corners in &mut triangles {
        *corners = corners.map(|v| (found.refquat.inverse() * (v - found.refpos)).component_mul(&scale));
        if mirrored {
            corners.swap(1, 2);
        }
    }
    mesh::solid(&triangles, found.inside).map_err(|why| format!("has no usable volume: {why}"))
}
