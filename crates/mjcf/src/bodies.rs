//! The bodies of a model with everything that they carry, their classes, angles and masses resolved.

mod settings;
mod shape;

use crate::Files;
use crate::document::{Document, Item};
use crate::known::{self, KEPT_ASSETS, KEPT_OF_BODY, KEPT_SECTIONS, MAKE_BODIES, OF_DEFAULT, SECTIONS};
use crate::mass::{LEAST, Mass, is_possible};
use crate::place::{self, fixed, from_to, number, numbers, vector};
use denavit_model::formats::{FormatError, Kept, Loss};
use denavit_model::nalgebra::{Matrix3, Vector3};
use denavit_model::notes::Place;
use denavit_model::problems::nearest_name;
use denavit_model::se3::Pose;
use denavit_model::write::{escape, escaped};
use settings::{FromGeoms, Settings};
use shape::Meshes;
pub use shape::Shape;
use std::collections::HashMap;
use std::f64::consts::TAU;

/// No hinge turns farther than this in rad, two turns: a larger round number is in degrees.
const LEAST_DEGREES: f64 = 15.0;

/// A control range that goes beyond the joint's by less than this part of it is rounding, or compensates gravity.
const BEYOND: f64 = 0.1;

/// A line of a file, by its index.
pub type At = (usize, usize);

/// How a joint moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    Hinge,
    Slide,
    Ball,
    Free,
}

/// A joint of a body.
#[derive(Debug, Clone)]
pub struct Joint {
    pub name: String,
    pub kind: Kind,
    /// In the body's frame: a point of the axis, and its direction.
    pub pos: Vector3<f64>,
    pub axis: Vector3<f64>,
    /// The joint's value at which the body stands as it is written, rad or m.
    pub zero: f64,
    pub range: Option<(f64, f64)>,
    pub damping: f64,
    pub friction: f64,
    pub effort: Option<f64>,
    pub velocity: Option<f64>,
    /// Driver, multiplier, offset.
    pub mimic: Option<(String, f64, f64)>,
    pub at: At,
}

/// A frame without mass.
#[derive(Debug, Clone)]
pub struct Site {
    pub name: String,
    pub pose: Pose,
    pub at: At,
}

/// A body.
#[derive(Debug, Clone)]
pub struct Body {
    pub name: String,
    pub parent: Option<usize>,
    /// parent_from_body at the joints' zeros.
    pub pose: Pose,
    pub mass: Option<(Mass, At)>,
    pub shapes: Vec<Shape>,
    pub joints: Vec<Joint>,
    pub sites: Vec<Site>,
    pub at: At,
}

/// A model.
#[derive(Debug)]
pub struct Model {
    pub name: String,
    pub bodies: Vec<Body>,
    pub kept: Vec<Kept>,
    pub notes: Vec<(Place, String)>,
    /// Notes of a rule of `check`.
    pub findings: Vec<(String, Place, String)>,
    pub understood: usize,
}

/// Reads the bodies.
pub fn model(document: &Document, files: &mut Files) -> Result<Model, FormatError> {
    let mut reader = Reader {
        document,
        settings: Settings::default(),
        meshes: Meshes::default(),
        kept: Vec::new(),
        notes: Vec::new(),
        findings: Vec::new(),
        hinges: Vec::new(),
        problems: Vec::new(),
        understood: 0,
        bodies: Vec::new(),
        unnamed: HashMap::new(),
    };
    reader.model(files);
    let Reader { mut kept, notes, findings, problems, understood, bodies, .. } = reader;
    if !problems.is_empty() {
        return Err(FormatError { problems });
    }
    let file = |kept: &Kept| document.files.iter().position(|file| *file == kept.loss.place.file);
    kept.sort_by_cached_key(|kept| (file(kept), kept.loss.place.line));
    let name = document.root.get("model").unwrap_or_default().to_owned();
    Ok(Model { name, bodies, kept, notes, findings, understood })
}

struct Reader<'a> {
    document: &'a Document<'a>,
    settings: Settings,
    meshes: Meshes,
    kept: Vec<Kept>,
    notes: Vec<(Place, String)>,
    findings: Vec<(String, Place, String)>,
    /// Ranges of hinges as they are written, with their places.
    hinges: Vec<(f64, f64, Place)>,
    problems: Vec<(Place, String)>,
    understood: usize,
    bodies: Vec<Body>,
    unnamed: HashMap<String, usize>,
}

/// What an actuator states about a joint: its name, effort, velocity.
type Bounds = (String, Option<f64>, Option<f64>);

/// The position of a walk: the body, the frame inside it, the class of its children.
#[derive(Clone)]
struct Stand {
    body: usize,
    body_from_here: Pose,
    childclass: Option<String>,
}

impl<'a> Reader<'a> {
    fn model(&mut self, files: &mut Files) {
        let document = self.document;
        self.account(&document.root);
        for section in &document.root.children {
            let tag = section.tag;
            if KEPT_SECTIONS.contains(&tag) {
                continue;
            }
            if !SECTIONS.contains(&tag) {
                self.unknown(section, KEPT_SECTIONS.iter().chain(SECTIONS).copied());
            }
        }
        for compiler in document.sections("compiler") {
            self.account(compiler);
            match self.settings.read(compiler) {
                Ok(()) => {}
                Err(what) => self.problem(compiler, what),
            }
        }
        for section in document.sections("default") {
            self.default(section);
        }
        for section in document.sections("asset") {
            for asset in &section.children {
                match asset.tag {
                    "mesh" => self.mesh(asset),
                    tag if KEPT_ASSETS.contains(&tag) => {
                        if tag == "material" {
                            self.material(asset);
                        }
                        self.keep(
                            asset,
                            "URDF has no such asset; it affects only how the robot and its surroundings look",
                        );
                    }
                    _ => self.unknown(asset, KEPT_ASSETS.iter().copied().chain(["mesh"])),
                }
            }
        }
        self.bodies.push(Body {
            name: "world".into(),
            parent: None,
            pose: Pose::identity(),
            mass: None,
            shapes: Vec::new(),
            joints: Vec::new(),
            sites: Vec::new(),
            at: document.sections("worldbody").next().map_or(document.root.at, |world| world.at),
        });
        for world in document.sections("worldbody") {
            self.account(world);
            let stand = Stand { body: 0, body_from_here: Pose::identity(), childclass: None };
            self.inside(world, &stand, files);
        }
        if self.problems.is_empty() && self.bodies.len() == 1 && self.bodies[0].shapes.is_empty() {
            self.problem(&document.root, "has no <body> in its <worldbody>; name the file that holds the robot");
        }
        self.totals();
        self.others();
        self.angle_unit();
        self.unique_names();
    }

    // What the reader says.

    fn problem(&mut self, item: &Item, what: impl Into<String>) {
        self.problems.push((self.document.place(item), what.into()));
    }

    fn note(&mut self, item: &Item, what: impl Into<String>) {
        self.notes.push((self.document.place(item), what.into()));
    }

    fn finding(&mut self, rule: &str, place: Place, what: impl Into<String>) {
        self.findings.push((rule.to_owned(), place, what.into()));
    }

    /// Reports models in degrees whose hinges all turn no farther than in rad, and models in rad whose hinges turn much farther.
    fn angle_unit(&mut self) {
        let farthest = |(lower, upper, _): &(f64, f64, Place)| lower.abs().max(upper.abs());
        let in_degrees = self.settings.angles.unit != 1.0;
        let hinges = std::mem::take(&mut self.hinges);
        if in_degrees {
            let turns = hinges.iter().map(farthest).fold(0.0, f64::max);
            if let (true, Some((lower, upper, place))) = (turns > 0.0 && turns <= TAU + 0.1, hinges.first()) {
                let many = if hinges.len() > 1 { format!(" ({} hinges alike)", hinges.len()) } else { String::new() };
                let what = format!(
                    "its range {lower} … {upper} counts in degrees{many}, which looks like radians; write <compiler angle=\"radian\"/>"
                );
                self.finding("angle-unit", place.clone(), what);
            }
            return;
        }
        for (lower, upper, place) in &hinges {
            let is_round = |bound: f64| bound.abs() >= LEAST_DEGREES && (2.0 * bound).fract() == 0.0;
            if is_round(*lower) || is_round(*upper) {
                let what = format!(
                    "its range {lower} … {upper} counts in radians, which looks like degrees; write radians, or <compiler angle=\"degree\"/>"
                );
                self.finding("angle-unit", place.clone(), what);
            }
        }
    }

    /// The value; `None` where it is wrong, which is then reported.
    fn good<T>(&mut self, item: &Item, value: Result<T, String>) -> Option<T> {
        match value {
            Ok(value) => Some(value),
            Err(what) => {
                self.problem(item, what);
                None
            }
        }
    }

    fn keep(&mut self, item: &Item, why: &str) {
        self.keep_as(item, item.xml(), why);
    }

    fn keep_as(&mut self, item: &Item, text: String, why: &str) {
        let what = format!("<{}>", item.tag);
        let loss = Loss { place: self.document.place(item), what, why: why.to_owned() };
        self.kept.push(Kept { loss, text, understood: true });
    }

    fn unknown<'n>(&mut self, item: &Item, names: impl Iterator<Item = &'n str>) {
        let advice = match nearest_name(item.tag, names) {
            Some(near) => format!("did you mean <{near}>?"),
            None => "remove it, or correct its name".into(),
        };
        let why = format!("is not understood and changes nothing here; {advice}");
        let loss = Loss { place: self.document.place(item), what: format!("<{}>", item.tag), why };
        self.kept.push(Kept { loss, text: item.xml(), understood: false });
    }

    /// Counts what is understood of an element that is translated, keeps what is known, reports what is not.
    fn account(&mut self, item: &Item) {
        self.account_as(item, item.tag, item.get("name"));
    }

    fn account_as(&mut self, item: &Item, tag: &str, name: Option<&str>) {
        self.understood += 1;
        let Some(known) = known::known(tag) else { return };
        for (attribute, value) in &item.attributes {
            if known.read.contains(attribute) {
                self.understood += 1;
                continue;
            }
            let is_known = known.kept.contains(attribute);
            let why = if is_known {
                "URDF has no such attribute; it changes no pose, mass or limit".to_owned()
            } else {
                let names = known.read.iter().chain(known.kept).copied();
                let advice = match nearest_name(attribute, names) {
                    Some(near) => format!("did you mean {near}?"),
                    None => "remove it, or correct its name".into(),
                };
                format!("is not understood and changes nothing here; {advice}")
            };
            let mut text = String::with_capacity(64);
            text.extend(["<", tag]);
            if let Some(name) = name {
                text.push_str(" name=\"");
                escape(&mut text, name);
                text.push('"');
            }
            text.extend([" ", attribute, "=\""]);
            escape(&mut text, value);
            text.push_str("\"/>");
            let what = format!("attribute {attribute}=\"{value}\" of <{tag}>");
            let loss = Loss { place: self.document.place(item), what, why };
            self.kept.push(Kept { loss, text, understood: is_known });
        }
        if !item.text.is_empty() {
            let what = format!("text \"{}\" in <{tag}>", item.text);
            let why = "is not understood and changes nothing here; remove it".to_owned();
            let loss = Loss { place: self.document.place(item), what, why };
            self.kept.push(Kept { loss, text: item.text.clone(), understood: false });
        }
    }

    /// Defaults are read with their elements; this finds only what no element reads.
    fn default(&mut self, item: &Item) {
        self.understood += 1;
        for (attribute, _) in item.attributes.iter().filter(|(name, _)| *name != "class") {
            let what = format!("attribute {attribute} of <default>");
            let why = "is not understood and changes nothing here; it takes only the attribute class".to_owned();
            let loss = Loss { place: self.document.place(item), what, why };
            self.kept.push(Kept { loss, text: String::new(), understood: false });
        }
        for child in &item.children {
            match child.tag {
                "default" => self.default(child),
                tag if !OF_DEFAULT.contains(&tag) => self.unknown(child, OF_DEFAULT.iter().copied()),
                tag => {
                    if let Some(known) = known::known(tag) {
                        let words = known.read.iter().chain(known.kept);
                        let unknown =
                            child.attributes.iter().filter(|(name, _)| words.clone().all(|word| word != name));
                        for (attribute, value) in unknown {
                            let what = format!("attribute {attribute}=\"{value}\" of <{tag}>");
                            let why =
                                "is not understood and changes nothing here; remove it, or correct its name".into();
                            let loss = Loss { place: self.document.place(child), what, why };
                            self.kept.push(Kept { loss, text: String::new(), understood: false });
                        }
                    }
                    self.understood += 1;
                    for inner in &child.children {
                        self.unknown(inner, std::iter::empty());
                    }
                }
            }
        }
    }

    // Bodies.

    fn inside(&mut self, parent: &Item<'a>, stand: &Stand, files: &mut Files) {
        for item in &parent.children {
            match item.tag {
                "body" => self.body(item, stand, files),
                "frame" => {
                    self.account(item);
                    let Some(pose) = self.pose(item) else { continue };
                    let childclass = item.get("childclass").map(str::to_owned).or_else(|| stand.childclass.clone());
                    let inner = Stand { body_from_here: stand.body_from_here * pose, childclass, ..*stand };
                    self.inside(item, &inner, files);
                }
                "inertial" => self.inertial(item, stand),
                "joint" | "freejoint" => self.joint(item, stand),
                "geom" => self.geom(item, stand, files),
                "site" => self.site(item, stand),
                tag if MAKE_BODIES.contains(&tag) => self.problem(
                    item,
                    format!("<{tag}> generates bodies, which is not supported here; have MuJoCo write the whole model (mj_saveLastXML) and read that"),
                ),
                tag if KEPT_OF_BODY.contains(&tag) => {
                    let resolved = self.resolved(item, stand);
                    let body = self.bodies[stand.body].name.clone();
                    if let Some(resolved) = resolved {
                        let text = format!("<body name=\"{}\">{}</body>", escaped(&body), resolved.xml());
                        self.keep_as(item, text, "URDF has no such part of a body; it changes no pose, mass or limit");
                    }
                }
                _ => {
                    let known = ["body", "frame", "inertial", "joint", "freejoint", "geom", "site"];
                    self.unknown(item, known.into_iter().chain(KEPT_OF_BODY.iter().copied()));
                }
            }
        }
    }

    fn pose(&mut self, item: &Item) -> Option<Pose> {
        let pose = place::pose(item, &self.settings.angles);
        self.good(item, pose)
    }

    fn resolved(&mut self, item: &Item<'a>, stand: &Stand) -> Option<Item<'a>> {
        match self.document.resolved(item, stand.childclass.as_deref()) {
            Ok(resolved) => Some(resolved),
            Err(error) => {
                self.problems.extend(error.problems);
                None
            }
        }
    }

    /// A name for an unnamed element: the n-th of its kind.
    fn numbered(&mut self, kind: &str) -> String {
        let count = self.unnamed.entry(kind.to_owned()).or_insert(0);
        *count += 1;
        format!("{kind}_{count}")
    }

    fn body(&mut self, item: &Item<'a>, stand: &Stand, files: &mut Files) {
        let name = match item.get("name") {
            Some(name) => name.to_owned(),
            None => self.numbered("body"),
        };
        self.account_as(item, "body", Some(&name));
        let Some(pose) = self.pose(item) else { return };
        let childclass = item.get("childclass").map(str::to_owned).or_else(|| stand.childclass.clone());
        let body = self.bodies.len();
        self.bodies.push(Body {
            name,
            parent: Some(stand.body),
            pose: stand.body_from_here * pose,
            mass: None,
            shapes: Vec::new(),
            joints: Vec::new(),
            sites: Vec::new(),
            at: item.at,
        });
        let inner = Stand { body, body_from_here: Pose::identity(), childclass };
        let stated = item.children.iter().filter(|child| child.tag == "inertial").count();
        if stated > 1 {
            self.problem(item, format!("has {stated} <inertial>; keep one"));
        }
        self.inside(item, &inner, files);
        self.mass_of(item, body);
    }

    fn inertial(&mut self, item: &Item, stand: &Stand) {
        self.account(item);
        let read = || -> Result<Mass, String> {
            let mass = number(item, "mass")?.ok_or("has no mass; write mass=\"…\" in kg")?;
            if mass < 0.0 {
                return Err(format!("mass=\"{mass}\" is negative; write 0 or more"));
            }
            let pose = place::pose(item, &self.settings.angles)?;
            let tensor = match (vector(item, "diaginertia")?, fixed::<6>(item, "fullinertia")?) {
                (Some(_), Some(_)) => return Err("states diaginertia and fullinertia; keep one of them".into()),
                // The values that the writer gives to a moving body without inertia.
                (Some(diagonal), None) if diagonal.iter().all(|moment| *moment == LEAST) => Matrix3::zeros(),
                (Some(diagonal), None) => Matrix3::from_diagonal(&diagonal),
                (None, Some(m)) => {
                    let turned =
                        ["quat", "axisangle", "euler", "xyaxes", "zaxis"].iter().any(|name| item.get(name).is_some());
                    if turned {
                        return Err(
                            "states fullinertia and an orientation, which MuJoCo refuses; keep one of them".into()
                        );
                    }
                    Matrix3::new(m[0], m[3], m[4], m[3], m[1], m[5], m[4], m[5], m[2])
                }
                (None, None) => Matrix3::zeros(),
            };
            let mass = if mass == LEAST && tensor == Matrix3::zeros() { 0.0 } else { mass };
            Ok(Mass { mass, centre: Vector3::zeros(), tensor }.placed(&pose))
        };
        let read = read();
        if let Some(mass) = self.good(item, read) {
            if stand.body == 0 {
                self.problem(item, "is in <worldbody>, which has no mass; put it into a <body>");
                return;
            }
            let is_none = mass.mass == 0.0 && mass.tensor == Matrix3::zeros();
            if number(item, "mass") == Ok(Some(LEAST)) {
                let what = format!("denavit writes {LEAST:e} kg and kg·m² for a body without mass; read as no mass");
                self.note(item, what);
            }
            let mass = (mass.placed(&stand.body_from_here), item.at);
            self.bodies[stand.body].mass =
                Some(mass).filter(|_| !is_none || self.settings.from_geoms != FromGeoms::Never);
        }
    }

    /// The mass of a body by the compiler's settings: stated, or that of its geoms.
    fn mass_of(&mut self, item: &Item, body: usize) {
        let stated = self.bodies[body].mass;
        let from_geoms = match self.settings.from_geoms {
            FromGeoms::Never => false,
            FromGeoms::Always => true,
            FromGeoms::WhereNoneIsStated => stated.is_none(),
        };
        if from_geoms {
            let parts: Vec<Mass> = self.bodies[body].shapes.iter().filter_map(|shape| shape.mass).collect();
            let whole = Mass::together(&parts);
            if stated.is_some() {
                self.note(item, "the stated <inertial> is replaced by that of the geoms, as inertiafromgeom requires");
            }
            self.bodies[body].mass = whole.map(|mass| (mass, item.at));
        }
        let Some((mut mass, at)) = self.bodies[body].mass else { return };
        if let Some([a, b, c]) = self.settings.balance.then(|| mass.moments()).filter(|moments| !is_possible(*moments))
        {
            let mean = (a + b + c) / 3.0;
            mass.tensor = Matrix3::identity() * mean;
            self.note(
                item,
                format!(
                    "its moments of inertia {a:e}, {b:e}, {c:e} kg·m² become their mean, as balanceinertia requires"
                ),
            );
        }
        if mass.mass < self.settings.least_mass {
            self.note(
                item,
                format!(
                    "its mass of {} kg is raised to {}, as boundmass requires",
                    mass.mass, self.settings.least_mass
                ),
            );
            mass.mass = self.settings.least_mass;
        }
        if self.settings.least_inertia > 0.0 && mass.moments()[0] < self.settings.least_inertia {
            let eigen = mass.tensor.symmetric_eigen();
            let raised = eigen.eigenvalues.map(|value| value.max(self.settings.least_inertia));
            mass.tensor = eigen.eigenvectors * Matrix3::from_diagonal(&raised) * eigen.eigenvectors.transpose();
            self.note(item, "a moment of inertia is raised, as boundinertia requires");
        }
        self.bodies[body].mass = Some((mass, at));
    }

    /// Scales every mass if the compiler sets a total.
    fn totals(&mut self) {
        let Some(total) = self.settings.total_mass else { return };
        let sum: f64 = self.bodies.iter().filter_map(|body| Some(body.mass?.0.mass)).sum();
        if sum <= 0.0 {
            return;
        }
        let root = self.document.root.clone();
        self.note(&root, format!("every mass is scaled by {}, as settotalmass requires", total / sum));
        for (mass, _) in self.bodies.iter_mut().filter_map(|body| body.mass.as_mut()) {
            mass.mass *= total / sum;
            mass.tensor *= total / sum;
        }
    }

    fn joint(&mut self, item: &Item<'a>, stand: &Stand) {
        let resolved = if item.tag == "joint" { self.resolved(item, stand) } else { Some(item.clone()) };
        let Some(resolved) = resolved else { return };
        if stand.body == 0 {
            self.problem(item, "is in <worldbody>, which does not move; put it into a <body>");
            return;
        }
        let read = self.joint_of(&resolved, stand);
        let Some(mut joint) = self.good(item, read) else { return };
        if let (Kind::Hinge | Kind::Slide, Ok(Some(range))) = (joint.kind, fixed::<2>(&resolved, "range")) {
            let (place, [lower, upper]) = (self.document.place(item), [range[0], range[1]]);
            if joint.range.is_none() && lower < upper {
                let fix = if resolved.get("limited") == Some("false") {
                    "remove limited=\"false\""
                } else {
                    "write limited=\"true\""
                };
                let what = format!("its range {lower} … {upper} has no effect; {fix}, or remove the range");
                self.finding("range-without-effect", place, what);
            } else if joint.kind == Kind::Hinge && lower < upper {
                self.hinges.push((lower, upper, place));
            }
        }
        if joint.name.is_empty() {
            let owner = self.bodies[stand.body].name.clone();
            let word = match joint.kind {
                Kind::Hinge => "hinge",
                Kind::Slide => "slide",
                Kind::Ball => "ball",
                Kind::Free => "free",
            };
            let count = self.bodies[stand.body].joints.len();
            let number = if count == 0 { String::new() } else { format!("_{}", count + 1) };
            joint.name = format!("{owner}_{word}{number}");
        }
        if joint.kind == Kind::Free
            && (self.bodies[stand.body].parent != Some(0) || !self.bodies[stand.body].joints.is_empty())
        {
            self.problem(item, "a free joint must be the only joint of a body in <worldbody>; move it there");
        }
        // Angles in kept elements are in rad, like everything that is written here.
        let mut in_rad = resolved;
        if matches!(joint.kind, Kind::Hinge | Kind::Ball) {
            for (name, value) in &mut in_rad.attributes {
                if *name == "springref"
                    && let Ok(angle) = value.trim().parse::<f64>()
                {
                    *value = (angle * self.settings.angles.unit).to_string().into();
                }
            }
        }
        let name = joint.name.clone();
        self.account_as(&in_rad, item.tag, Some(&name));
        self.bodies[stand.body].joints.push(joint);
    }

    fn joint_of(&self, item: &Item, stand: &Stand) -> Result<Joint, String> {
        let kind = match (item.tag, item.get("type")) {
            ("freejoint", _) | (_, Some("free")) => Kind::Free,
            (_, None | Some("hinge")) => Kind::Hinge,
            (_, Some("slide")) => Kind::Slide,
            (_, Some("ball")) => Kind::Ball,
            (_, Some(word)) => {
                return Err(format!("type=\"{word}\" is not a joint type; write hinge, slide, ball or free"));
            }
        };
        let pos = vector(item, "pos")?.unwrap_or_default();
        let axis = vector(item, "axis")?.unwrap_or_else(Vector3::z);
        if axis.norm() < 1e-14 && matches!(kind, Kind::Hinge | Kind::Slide) {
            return Err("its axis has length 0; write a direction such as 0 0 1".into());
        }
        let scale = if kind == Kind::Slide { 1.0 } else { self.settings.angles.unit };
        let range = fixed::<2>(item, "range")?.map(|range| (range[0] * scale, range[1] * scale));
        let limited = self.settings.limited(item, "limited", range.is_some_and(|(lower, upper)| lower < upper))?;
        if limited && range.is_none() {
            return Err("is limited and has no range; write range=\"LOWER UPPER\"".into());
        }
        if let (true, Some((lower, upper))) = (limited, range)
            && lower >= upper
            && kind != Kind::Ball
        {
            return Err(format!("its range ends at {upper} before it starts at {lower}; write the lower bound first"));
        }
        let force = fixed::<2>(item, "actuatorfrcrange")?.map(|range| range[0].abs().max(range[1].abs()));
        let has_force = self.settings.limited(item, "actuatorfrclimited", force.is_some_and(|force| force > 0.0))?;
        let here = &stand.body_from_here;
        Ok(Joint {
            name: item.get("name").unwrap_or_default().to_owned(),
            kind,
            pos: here.rotation * pos + here.translation.vector,
            axis: here.rotation * axis,
            zero: number(item, "ref")?.unwrap_or(0.0) * scale,
            range: range.filter(|_| limited && kind != Kind::Ball),
            damping: number(item, "damping")
                .or_else(|_| numbers(item, "damping", 1..=3).map(|d| d.map(|d| d[0])))?
                .unwrap_or(0.0),
            friction: number(item, "frictionloss")?.unwrap_or(0.0),
            effort: force.filter(|_| has_force),
            velocity: None,
            mimic: None,
            at: item.at,
        })
    }

    fn site(&mut self, item: &Item<'a>, stand: &Stand) {
        let Some(resolved) = self.resolved(item, stand) else { return };
        let along = from_to(&resolved);
        let Some(along) = self.good(item, along) else { return };
        let pose = match along {
            Some((pose, _)) => Some(pose),
            None => self.pose(&resolved),
        };
        let (Some(pose), Some(name)) = (pose, resolved.get("name")) else {
            self.keep(item, "an unnamed site cannot be used as a frame");
            return;
        };
        self.account(&resolved);
        let site = Site { name: name.to_owned(), pose: stand.body_from_here * pose, at: item.at };
        self.bodies[stand.body].sites.push(site);
    }

    // What acts on the bodies.

    fn others(&mut self) {
        let document = self.document;
        for section in document.sections("equality") {
            for item in &section.children {
                self.equality(item);
            }
        }
        for section in document.root.children.iter().filter(|section| KEPT_SECTIONS.contains(&section.tag)) {
            let tag = section.tag;
            let nowhere = Stand { body: 0, body_from_here: Pose::identity(), childclass: None };
            if ["option", "size", "visual", "statistic"].contains(&tag) {
                self.keep(section, "URDF has no simulator settings");
                continue;
            }
            for item in &section.children {
                let Some(resolved) = self.resolved(item, &nowhere) else { continue };
                if tag == "actuator" {
                    self.actuator(&resolved);
                }
                let why = match tag {
                    "tendon" => "URDF has no tendons; what they couple moves freely",
                    "actuator" => "URDF has no actuators; force and speed become the joint's limits where possible",
                    "sensor" => "URDF has no sensors of joints and sites",
                    "keyframe" => "URDF has no named states",
                    "contact" => "URDF has no list of contacts; an SRDF has",
                    _ => "URDF has no such element; it changes no pose, mass or limit",
                };
                let text = format!("<{tag}>{}</{tag}>", resolved.xml());
                self.keep_as(item, text, why);
            }
        }
    }

    fn joint_named(&mut self, name: &str) -> Option<&mut Joint> {
        self.bodies.iter_mut().flat_map(|body| &mut body.joints).find(|joint| joint.name == name)
    }

    fn equality(&mut self, item: &Item<'a>) {
        let nowhere = Stand { body: 0, body_from_here: Pose::identity(), childclass: None };
        let Some(resolved) = self.resolved(item, &nowhere) else { return };
        let known = ["connect", "weld", "joint", "tendon", "flex", "flexvert", "flexstrain"];
        if !known.contains(&item.tag) {
            self.unknown(item, known.into_iter());
            return;
        }
        let why = match self.coupled(&resolved) {
            Ok(true) => {
                self.understood += 1;
                let physics = ["solref", "solimp", "name"].iter().any(|name| resolved.get(name).is_some());
                if !physics {
                    return;
                }
                "the coupling is translated without its softness and its name, which URDF cannot state"
            }
            Ok(false) => match item.tag {
                "joint" => "URDF couples joints only by a factor and an offset; both move freely",
                "connect" | "weld" => "URDF is a tree without loops; every joint moves freely",
                _ => "URDF has no such constraint; what it couples moves freely",
            },
            Err(what) => {
                self.problem(item, what);
                return;
            }
        };
        let text = format!("<equality>{}</equality>", resolved.xml());
        self.keep_as(item, text, why);
    }

    /// Whether an equality couples a joint to another by a line, which is then the joint's mimic.
    fn coupled(&mut self, item: &Item) -> Result<bool, String> {
        if item.tag != "joint" || item.get("active") == Some("false") {
            return Ok(false);
        }
        let first = item.get("joint1").ok_or("has no joint1; name the joint that follows")?.to_owned();
        let Some(second) = item.get("joint2").map(str::to_owned) else { return Ok(false) };
        let p = numbers(item, "polycoef", 1..=5)?.unwrap_or_else(|| vec![0.0, 1.0, 0.0, 0.0, 0.0]);
        let mut coefficients = [0.0, 1.0, 0.0, 0.0, 0.0];
        coefficients[..p.len()].copy_from_slice(&p);
        for (attribute, name) in [("joint1", &first), ("joint2", &second)] {
            if self.joint_named(name).is_none() {
                let names: Vec<&str> =
                    self.bodies.iter().flat_map(|body| &body.joints).map(|joint| joint.name.as_str()).collect();
                let near = nearest_name(name, names);
                let advice =
                    near.map_or("name a joint of this model".into(), |near| format!("did you mean \"{near}\"?"));
                return Err(format!("{attribute} \"{name}\" does not exist; {advice}"));
            }
        }
        if coefficients[2..].iter().any(|c| *c != 0.0) || first == second {
            return Ok(false);
        }
        // The joint that joint2 finally follows must not be joint1.
        let mut at = second.clone();
        for _ in 0..self.bodies.len() {
            match self.joint_named(&at).and_then(|joint| joint.mimic.clone()) {
                Some((next, ..)) if next == first => return Ok(false),
                Some((next, ..)) => at = next,
                None => break,
            }
        }
        let driver_zero = self.joint_named(&second).map_or(0.0, |joint| joint.zero);
        let one_valued = |kind: Kind| matches!(kind, Kind::Hinge | Kind::Slide);
        if !self.joint_named(&second).is_some_and(|joint| one_valued(joint.kind)) {
            return Ok(false);
        }
        let Some(joint) = self.joint_named(&first) else { return Ok(false) };
        if joint.mimic.is_some() || !one_valued(joint.kind) {
            return Ok(false);
        }
        // y - y0 = c0 + c1 (x - x0)
        let offset = coefficients[0] + joint.zero - coefficients[1] * driver_zero;
        joint.mimic = Some((second, coefficients[1], offset));
        Ok(true)
    }

    /// An actuator's bounds, where they bound a joint.
    fn actuator(&mut self, item: &Item) {
        let read = || -> Result<Option<Bounds>, String> {
            let Some(joint) = item.get("joint").or_else(|| item.get("jointinparent")) else { return Ok(None) };
            let gear = numbers(item, "gear", 1..=6)?.map_or(1.0, |gear| gear[0].abs());
            let bound = |range: &str, limited: &str| -> Result<Option<f64>, String> {
                let found = fixed::<2>(item, range)?.filter(|range| range[0] < range[1]);
                let found = found.map(|range| range[0].abs().max(range[1].abs()));
                let holds = self.settings.limited(item, limited, found.is_some())?;
                Ok(found.filter(|_| holds))
            };
            let force = bound("forcerange", "forcelimited")?;
            let control = bound("ctrlrange", "ctrllimited")?;
            let effort = match (force, item.tag) {
                (Some(force), _) => Some(force * gear),
                (None, "motor") => control.map(|control| control * gear),
                _ => None,
            };
            let velocity =
                if item.tag == "velocity" && gear > 0.0 { control.map(|control| control / gear) } else { None };
            Ok(Some((joint.to_owned(), effort, velocity)))
        };
        let read = read();
        let Some(Some((name, effort, velocity))) = self.good(item, read) else { return };
        let Some(joint) = self.joint_named(&name) else {
            self.problem(item, format!("acts on joint \"{name}\", which does not exist; name a joint of this model"));
            return;
        };
        joint.effort = joint.effort.or(effort);
        joint.velocity = joint.velocity.or(velocity);
        let range = joint.range;
        self.servo(item, range);
    }

    /// Reports position servos whose command may exceed their joint's range.
    fn servo(&mut self, item: &Item, range: Option<(f64, f64)>) {
        let control = fixed::<2>(item, "ctrlrange").ok().flatten().filter(|control| control[0] < control[1]);
        let (Some(control), Some((lower, upper)), "position") = (control, range, item.tag) else { return };
        let room = BEYOND * (upper - lower);
        if control[0] < lower - room || control[1] > upper + room {
            let what = format!(
                "its ctrlrange {} … {} exceeds the joint's range, {lower:.4} … {upper:.4}; write that, or inheritrange=\"1\"",
                control[0], control[1]
            );
            let place = self.document.place(item);
            self.finding("control-beyond-range", place, what);
        }
    }

    /// Bodies and sites share the namespace of URDF's link names.
    fn unique_names(&mut self) {
        let mut seen: HashMap<String, At> = HashMap::new();
        let mut problems = Vec::new();
        for body in self.bodies.iter().skip(1) {
            if let Some((_, line)) = seen.insert(body.name.clone(), body.at) {
                let place = self.document.place_of(body.at, format!("body \"{}\"", body.name));
                problems.push((place, format!("the name is already taken in line {line}; rename one of the two")));
            }
        }
        self.problems.extend(problems);
        seen.insert("world".into(), (0, 0));
        for body in &mut self.bodies {
            for site in &mut body.sites {
                let own = site.name.clone();
                let mut number = 1;
                while seen.contains_key(&site.name) {
                    site.name = if number == 1 { format!("{own}_site") } else { format!("{own}_site_{number}") };
                    number += 1;
                }
                seen.insert(site.name.clone(), site.at);
            }
        }
    }
}
