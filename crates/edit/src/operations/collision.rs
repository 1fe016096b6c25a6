//! Simple shapes for collision meshes: each contains every vertex of the mesh that it replaces.
//!
//! A mesh of a `<collision>` becomes a box, a cylinder, a sphere or its convex hull, in the frame of the mesh. Numbers are
//! rounded outwards, and the proof checks every vertex of the mesh against the shape read back from the new text.

use crate::claim::{Claim, Compared, Enclosed, Shapes};
use crate::error::{self, EditError, refused_at_link};
use crate::solids::{self, Cloud, Placed, Triangle};
use crate::tally::Tally;
use crate::values::child;
use crate::{Change, Text};
use denavit_export::urdf::text::{Edits, Nodes, Numbers, joint_origin, parse, three, word};
use denavit_model::hull::Hull;
use denavit_model::nalgebra::Vector3;
use denavit_model::robot::{Geometry, Robot, SourceText};
use roxmltree::Node;
use std::collections::BTreeMap;

/// What a mesh becomes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Simple {
    /// The smallest box of those tried.
    Box,
    /// The smallest cylinder of those tried.
    Cylinder,
    /// The smallest sphere.
    Sphere,
    /// The smallest of these three.
    Smallest,
    /// The convex hull, in a new mesh file.
    Hull,
}

impl Simple {
    /// The shape of this name.
    pub fn of(word: &str) -> Option<Self> {
        let known = [Self::Box, Self::Cylinder, Self::Sphere, Self::Smallest, Self::Hull];
        known.into_iter().find(|shape| shape.name() == word)
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Box => "box",
            Self::Cylinder => "cylinder",
            Self::Sphere => "sphere",
            Self::Smallest => "smallest",
            Self::Hull => "hull",
        }
    }
}

/// The meshes of a robot, by the names that its text has for them: triangles in the mesh's own frame, m, or why there are none.
pub type Meshes = BTreeMap<String, Result<Vec<Triangle>, String>>;

/// The request.
#[derive(Debug, Clone, PartialEq)]
pub struct Simplified {
    /// The shape.
    pub shape: Simple,
    /// Links; all if empty.
    pub links: Vec<String>,
    /// What the robot's mesh files hold.
    pub meshes: Meshes,
    /// The prefix of the names of hulls in the text, such as `package://arm/meshes/`.
    pub folder: Option<String>,
}

/// What replaces a mesh.
struct Simpler {
    placed: Option<Placed>,
    hull: Option<Hull>,
    /// m³, of the mesh and of what replaces it; the mesh's is `None` where its surface is open.
    volumes: (Option<f64>, f64),
    /// Of the hull, m³; `None` where the mesh is flat.
    hull_volume: Option<f64>,
}

/// # Errors
/// There is no collision mesh, a mesh is missing or flat, or a hull has no folder.
pub(crate) fn simplify(robot: &Robot, srdf: Option<&SourceText>, asked: &Simplified) -> Result<Change, EditError> {
    let document = parse(robot)?;
    let nodes = Nodes::of(robot, &document)?;
    let links = chosen(robot, &asked.links)?;
    let mut edits = Edits::default();
    let (mut tally, mut notes) = (Tally::default(), Vec::new());
    let mut claim = Claim { shapes: Shapes::CollisionsChange, compared: Compared::No, ..Claim::same(robot) };
    let mut hulls: BTreeMap<String, (String, Text)> = BTreeMap::new();
    let mut sums = (0.0, 0.0);
    for link in links {
        let Some(node) = nodes.link(link) else { continue };
        let elements = node.children().filter(|part| part.is_element() && part.tag_name().name() == "collision");
        for (index, (element, shape)) in elements.zip(&robot.links[link].collisions).enumerate() {
            let Geometry::Mesh { filename, scale } = &shape.geometry else { continue };
            let refused = |why: String| refused_at_link(robot, link, format!("mesh \"{filename}\": {why}"));
            let triangles = match asked.meshes.get(filename) {
                Some(Ok(triangles)) if !triangles.is_empty() => triangles,
                Some(Err(why)) => return Err(refused(why.clone())),
                _ => return Err(refused("its file was not read".into())),
            };
            let simpler = simpler(asked.shape, triangles, *scale).map_err(refused)?;
            let origin = shape.origin.pose();
            let factors = Vector3::from(*scale);
            let corners = triangles.iter().flatten();
            let points =
                corners.map(|corner| origin * denavit_model::nalgebra::Point3::from(corner.component_mul(&factors)));
            let name = &robot.links[link].name;
            let mut enclosed = Enclosed { link: name.clone(), index, points: points.collect(), hull: None };
            if let Some(hull) = &simpler.hull {
                let uri = hull_name(&hulls, asked, filename).map_err(refused)?;
                let text = solids::obj(hull);
                enclosed.hull = solids::of_obj(&text);
                hulls.insert(filename.clone(), (uri.clone(), Text { file: uri.clone(), text }));
                if let Some(mesh) = child(element, "geometry").and_then(|geometry| child(geometry, "mesh")) {
                    edits.attribute(&robot.source, mesh, "filename", &uri);
                }
            }
            if let Some(placed) = &simpler.placed {
                write(robot, &mut edits, element, placed, &origin);
            }
            let what = simpler.placed.as_ref().map_or_else(|| "hull".into(), |placed| written(&placed.geometry).1);
            notes.push(format!("link \"{name}\": {what} for {filename}: {}", added(&simpler)));
            sums.0 += simpler.volumes.0.or(simpler.hull_volume).unwrap_or_default();
            sums.1 += simpler.volumes.1;
            tally.count("mesh", "meshes", "replaced");
            claim.enclosed.push(enclosed);
        }
    }
    if claim.enclosed.is_empty() {
        let place = robot.source.place(robot.links[robot.root].at, "the robot");
        let what = "these links have no collision mesh, so there is nothing to replace".into();
        return Err(EditError::Refused { place, what });
    }
    let corners: usize = claim.enclosed.iter().map(|of| of.points.len()).sum();
    tally.say(format!("all {corners} triangle vertices are inside"));
    tally.say(format!("{} m³ more, on {} m³", rounded(sums.1 - sums.0), rounded(sums.0)));
    let urdf = edits.apply(&robot.source)?;
    let files = hulls.into_values().map(|(_, text)| text).collect();
    Ok(Change { files, ..Change::of(urdf, srdf, claim, tally, notes) })
}

fn chosen(robot: &Robot, names: &[String]) -> Result<Vec<usize>, EditError> {
    if names.is_empty() {
        return Ok((0..robot.links.len()).collect());
    }
    names.iter().map(|name| error::link(robot, name)).collect()
}

fn simpler(shape: Simple, triangles: &[Triangle], scale: [f64; 3]) -> Result<Simpler, String> {
    let factors = Vector3::from(scale);
    let scaled = |corner: &Vector3<f64>| corner.component_mul(&factors);
    let corners: Vec<Vector3<f64>> = triangles.iter().flatten().copied().collect();
    let mut points = solids::in_no_order(&corners);
    let size: Vec<Triangle> = triangles.iter().map(|corners| corners.each_ref().map(scaled)).collect();
    let own = solids::volume(&size);
    if shape == Simple::Hull {
        // In the mesh's own numbers: the scale stays where it is.
        let hull = Hull::of(&points).ok_or("its points lie in a plane, so they have no hull")?;
        let volume = hull.volume() * factors.product().abs();
        return Ok(Simpler { placed: None, hull: Some(hull), volumes: (own, volume), hull_volume: Some(volume) });
    }
    for point in &mut points {
        *point = scaled(point);
    }
    // What is flat has no hull, and is put into a thin shape all the same.
    let hull = Hull::of(&points);
    let cloud = Cloud::of(&points, hull.as_ref());
    let placed = match shape {
        Simple::Box => cloud.boxed(),
        Simple::Cylinder => cloud.cylinder(),
        Simple::Sphere => cloud.sphere(),
        Simple::Smallest | Simple::Hull => {
            let all = [cloud.boxed(), cloud.cylinder(), cloud.sphere()];
            let smallest = all.into_iter().min_by(|a, b| a.volume().total_cmp(&b.volume()));
            smallest.ok_or("nothing was tried")?
        }
    };
    let volume = placed.volume();
    Ok(Simpler {
        placed: Some(placed),
        hull: None,
        volumes: (own, volume),
        hull_volume: hull.map(|hull| hull.volume()),
    })
}

/// The name of the hull's file in the text: that of the mesh with `_hull`, numbered where another mesh has it.
fn hull_name(known: &BTreeMap<String, (String, Text)>, asked: &Simplified, mesh: &str) -> Result<String, String> {
    if let Some((uri, _)) = known.get(mesh) {
        return Ok(uri.clone());
    }
    let Some(folder) = &asked.folder else {
        return Err("a hull needs its own file; name a folder for it".into());
    };
    let name = mesh.rsplit(['/', '\\']).next().unwrap_or(mesh);
    let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
    let free = |uri: &String| known.values().all(|(taken, _)| taken != uri);
    let names =
        (1..).map(|count| if count == 1 { format!("{stem}_hull.obj") } else { format!("{stem}_hull_{count}.obj") });
    names.map(|name| format!("{folder}{name}")).find(free).ok_or_else(|| "no name is free".into())
}

/// The element of a shape, and the shape in words.
fn written(geometry: &Geometry) -> (String, String) {
    match geometry {
        Geometry::Box(size) => (format!("<box size=\"{}\"/>", three(*size)), format!("box {}", three(*size))),
        Geometry::Cylinder { radius, length } => {
            let (radius, length) = (word(*radius), word(*length));
            let words = format!("cylinder of radius {radius} and length {length}");
            (format!("<cylinder radius=\"{radius}\" length=\"{length}\"/>"), words)
        }
        Geometry::Sphere(radius) => {
            let radius = word(*radius);
            (format!("<sphere radius=\"{radius}\"/>"), format!("sphere of radius {radius}"))
        }
        _ => (String::new(), String::new()),
    }
}

fn write(robot: &Robot, edits: &mut Edits, element: Node, placed: &Placed, origin: &denavit_model::se3::Pose) {
    let pose = origin * placed.pose;
    let scale = origin.translation.vector.amax() + placed.pose.translation.vector.amax();
    joint_origin(&robot.source, edits, element, &Numbers::of(&pose, scale));
    if let Some(mesh) = child(element, "geometry").and_then(|geometry| child(geometry, "mesh")) {
        edits.replace(mesh.range(), written(&placed.geometry).0);
    }
}

/// The excess volume of a shape over its mesh.
fn added(simpler: &Simpler) -> String {
    let (own, volume) = simpler.volumes;
    let (of, over) = match (own, simpler.hull_volume) {
        (Some(own), _) => (own, "the mesh's volume"),
        (None, Some(hull)) => (hull, "the volume of its hull (the surface is open, so it has no volume)"),
        (None, None) => return format!("{} m³ around a flat surface", rounded(volume)),
    };
    format!("{} m³ more, {:.0} % of {over}", rounded(volume - of), 100.0 * (volume - of) / of)
}

fn rounded(value: f64) -> String {
    format!("{value:.2e}")
}
