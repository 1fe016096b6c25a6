//! From XML to links, joints and frames: names are resolved, nothing is placed yet.

use crate::error::{SdfProblem, SdfProblemKind as Kind};
use crate::frames::{FrameId, Frames, WORLD};
use crate::known::{INCLUDE, Known, MODEL, Unknown};
use crate::pose::{self, Step};
use crate::sources::{Sources, element_of};
use denavit_model::Place;
use denavit_model::formats::{Kept, Loss};
use denavit_model::problems::nearest_name;
use roxmltree::{Document, Node};

/// An element and the file that it is in.
#[derive(Clone, Copy)]
pub(crate) struct Part<'a> {
    pub node: Node<'a, 'a>,
    pub file: usize,
}

impl<'a> Part<'a> {
    pub fn children(self, tag: &'static str) -> impl Iterator<Item = Part<'a>> {
        let found = self.node.children().filter(move |child| child.is_element() && child.tag_name().name() == tag);
        found.filter(|child| child.tag_name().namespace().is_none()).map(move |node| Part { node, file: self.file })
    }

    pub fn child(self, tag: &'static str) -> Option<Part<'a>> {
        self.children(tag).next()
    }

    pub fn at(self) -> (usize, usize) {
        (self.file, self.node.range().start)
    }

    pub fn name(self) -> &'a str {
        self.node.attribute("name").unwrap_or_default()
    }
}

/// SDF's version, major and minor.
pub(crate) type Version = (u32, u32);

/// The newest version that is known.
pub(crate) const NEWEST: Version = (1, 12);

pub(crate) struct Link<'a> {
    pub part: Part<'a>,
    pub frame: FrameId,
    pub scope: usize,
}

pub(crate) struct Joint<'a> {
    pub name: String,
    pub part: Part<'a>,
    pub frame: FrameId,
    /// As named: links, frames or joints.
    pub parent: FrameId,
    pub child: FrameId,
    pub scope: usize,
}

/// A `<frame>`.
pub(crate) struct Explicit<'a> {
    pub part: Part<'a>,
    pub frame: FrameId,
    pub attached_to: FrameId,
    pub has_pose: bool,
}

/// What a name means inside a model.
#[derive(Clone)]
pub(crate) struct Scope {
    /// Put before names.
    pub prefix: String,
    pub model: FrameId,
    pub version: Version,
}

/// Everything that the models of a file hold.
pub(crate) struct Model<'a> {
    pub name: String,
    pub part: Part<'a>,
    pub is_static: bool,
    pub frames: Frames,
    pub scopes: Vec<Scope>,
    pub links: Vec<Link<'a>>,
    pub joints: Vec<Joint<'a>>,
    pub explicit: Vec<Explicit<'a>>,
    /// Models and includes, which may contain more than is understood.
    pub parts: Vec<(Part<'a>, &'static Known)>,
    pub canonical: FrameId,
}

/// A model in a model.
struct Nested<'a, 'n> {
    part: Part<'a>,
    /// The element that states its pose: the model itself, or the include.
    posed: Part<'a>,
    name: &'n str,
    version: Version,
    /// Its links and joints become those of the outer model.
    merge: bool,
}

/// A name of a frame, before all frames are known.
struct Wanted<'a> {
    part: Part<'a>,
    what: &'static str,
    name: String,
    scope: usize,
    set: Set,
}

enum Set {
    Base(FrameId),
    Attached(usize),
    Parent(usize),
    Child(usize),
    Places(FrameId),
    Canonical(FrameId),
}

/// Reads, and records what is wrong and what is not understood.
pub(crate) struct Reader<'a> {
    pub sources: &'a Sources,
    pub documents: &'a [Option<Document<'a>>],
    pub problems: Vec<SdfProblem>,
    pub notes: Vec<(Place, String)>,
    /// What is not understood.
    pub kept: Vec<Kept>,
    pub understood: usize,
    /// Links without `<inertial>`.
    pub defaults: Vec<Part<'a>>,
    /// Notes of a rule of `check`.
    pub findings: Vec<(String, denavit_model::Place, String)>,
    wanted: Vec<Wanted<'a>>,
    /// Prefixes of included models that were not found, with their URI and the reason.
    missing: Vec<(String, String, String)>,
    /// Joints that end in such a model, with its index.
    into_missing: Vec<(usize, bool, usize)>,
}

impl<'a> Reader<'a> {
    pub fn new(sources: &'a Sources, documents: &'a [Option<Document<'a>>]) -> Self {
        Self {
            sources,
            documents,
            problems: sources.problems.clone(),
            notes: sources.notes.clone(),
            kept: Vec::new(),
            understood: 0,
            defaults: Vec::new(),
            findings: Vec::new(),
            wanted: Vec::new(),
            missing: Vec::new(),
            into_missing: Vec::new(),
        }
    }

    pub fn place(&self, part: Part) -> Place {
        self.sources.place(part.file, part.node.range().start, element_of(part.node))
    }

    /// The place of something in a link or joint, named after that link or joint.
    pub fn place_in(&self, part: Part) -> Place {
        let owner =
            part.node.ancestors().find(|above| ["link", "joint", "frame", "model"].contains(&above.tag_name().name()));
        self.sources.place(part.file, part.node.range().start, element_of(owner.unwrap_or(part.node)))
    }

    pub fn problem(&mut self, part: Part, kind: Kind) {
        let place = self.place_in(part);
        self.problems.push(SdfProblem { place, kind });
    }

    /// A note of a rule of `check`.
    pub fn finding(&mut self, rule: &str, part: Part, what: impl Into<String>) {
        let place = self.place_in(part);
        self.findings.push((rule.to_owned(), place, what.into()));
    }

    pub fn note(&mut self, part: Part, what: impl Into<String>) {
        let place = self.place_in(part);
        self.notes.push((place, what.into()));
    }

    /// A value that may be wrong, in which case that is recorded.
    pub fn take<T>(&mut self, part: Part, value: Result<T, Kind>) -> Option<T> {
        value.map_err(|kind| self.problem(part, kind)).ok()
    }

    /// Records everything in an element that is not understood.
    pub fn account(&mut self, part: Part<'a>, known: &'static Known) {
        let sources = self.sources;
        let text = &sources.files[part.file].text;
        let mut unknown: Vec<Unknown<'a>> = Vec::new();
        self.understood += known.walk(part.node, text, &mut |found| unknown.push(found));
        for Unknown { node, at, what, advice } in unknown {
            let owned = self.place_in(Part { node, file: part.file });
            self.unknown(Place { line: sources.files[part.file].line(at), ..owned }, what, advice);
        }
    }

    /// Records something that is not understood.
    pub fn unknown(&mut self, place: Place, what: String, why: impl Into<String>) {
        let loss = Loss { place, what, why: why.into() };
        self.kept.push(Kept { loss, text: String::new(), understood: false });
    }

    /// The one model of the file.
    pub fn model(&mut self) -> Option<Model<'a>> {
        let root = Part { node: self.documents.first()?.as_ref()?.root_element(), file: 0 };
        let (part, version) = self.the_model(root, true)?;
        let name = part.name().to_owned();
        if name.is_empty() {
            self.problem(part, Kind::MissingName);
        }
        let mut model = Model {
            name,
            part,
            is_static: false,
            frames: Frames::new(),
            scopes: Vec::new(),
            links: Vec::new(),
            joints: Vec::new(),
            explicit: Vec::new(),
            parts: Vec::new(),
            canonical: WORLD,
        };
        let frame = model.frames.add("__model__".to_owned());
        self.collect(&mut model, part, Scope { prefix: String::new(), model: frame, version }, WORLD);
        self.connect(&mut model);
        if model.links.is_empty() && self.problems.is_empty() {
            self.problem(part, Kind::NoLinks);
        }
        Some(model)
    }

    /// The model of a document and the version that it is written in.
    fn the_model(&mut self, root: Part<'a>, is_main: bool) -> Option<(Part<'a>, Version)> {
        let tag = root.node.tag_name().name();
        if !["sdf", "gazebo", "model"].contains(&tag) {
            self.problem(root, Kind::NoSdf(tag.to_owned()));
            return None;
        }
        let version = self.version(root);
        if tag == "model" {
            return Some((root, version));
        }
        let mut models: Vec<Part<'a>> = root.children("model").collect();
        let world = root.child("world");
        if let (Some(world), true) = (world, models.is_empty()) {
            models = self.of_world(world);
        }
        let further = root.node.children().filter(Node::is_element);
        let further: Vec<Part> = further
            .filter(|child| !["model", "world"].contains(&child.tag_name().name()))
            .map(|node| Part { node, file: root.file })
            .collect();
        for part in further {
            self.left_out(part, "the file");
        }
        let moving =
            |model: &&Part<'a>| !model.child("static").is_some_and(|part| pose::boolean(part.node) == Ok(true));
        let moving: Vec<&Part<'a>> = models.iter().filter(moving).collect();
        match (&models[..], &moving[..]) {
            ([], _) => {
                self.problem(root, Kind::NoModel);
                None
            }
            ([one], _) => Some((*one, version)),
            (several, [one]) if is_main => {
                let others: Vec<Part> = several.iter().filter(|other| other.node != one.node).copied().collect();
                for other in others {
                    self.left_out(other, "the file");
                }
                Some((**one, version))
            }
            (several, _) => {
                let names: Vec<String> = several.iter().map(|model| format!("\"{}\"", model.name())).collect();
                self.problem(several[1], Kind::SeveralModels { count: several.len(), names: names.join(", ") });
                None
            }
        }
    }

    /// The models of a world, those that it includes too.
    fn of_world(&mut self, world: Part<'a>) -> Vec<Part<'a>> {
        let mut models = Vec::new();
        for node in world.node.children().filter(Node::is_element) {
            let part = Part { node, file: world.file };
            match node.tag_name().name() {
                "model" => models.push(part),
                _ => self.left_out(part, "the world"),
            }
        }
        models
    }

    fn left_out(&mut self, part: Part<'a>, of: &str) {
        let tag = part.node.tag_name().name();
        let name = part.node.attribute("name").map_or_else(String::new, |name| format!(" \"{name}\""));
        let place = self.place(part);
        self.unknown(place, format!("<{tag}> of {of}{name}"), "is not part of the robot and is left out");
    }

    fn version(&mut self, root: Part) -> Version {
        let written = root.node.attribute("version").map(str::trim);
        let parsed = written.and_then(|written| {
            let mut numbers = written.split('.').map(str::parse::<u32>);
            Some((numbers.next()?.ok()?, numbers.next().unwrap_or(Ok(0)).ok()?))
        });
        let (major, minor) = NEWEST;
        match (written, parsed) {
            (_, Some(version)) if version <= NEWEST => {
                self.understood += 1;
                version
            }
            (Some(written), _) => {
                let what = format!("version \"{written}\" is not known here; it is read as SDF {major}.{minor}");
                self.note(root, what);
                NEWEST
            }
            (None, _) => {
                self.note(root, format!("the attribute `version` is missing; it is read as SDF {major}.{minor}"));
                NEWEST
            }
        }
    }

    /// The frame of a part that has a name and a pose, given in `base` unless its pose says otherwise.
    fn frame(&mut self, model: &mut Model<'a>, part: Part<'a>, scope: usize, name: String, base: FrameId) -> FrameId {
        let id = model.frames.add(name);
        model.frames.all[id].base = base;
        let Some(found) = part.child("pose") else { return id };
        let step = pose::step(found.node);
        model.frames.all[id].step = self.take(found, step).unwrap_or_else(Step::identity);
        if let Some(relative_to) = found.node.attribute("relative_to").or(found.node.attribute("frame"))
            && !relative_to.is_empty()
        {
            let name = relative_to.to_owned();
            self.wanted.push(Wanted { part: found, what: "relative_to", name, scope, set: Set::Base(id) });
        }
        id
    }

    fn named(&mut self, part: Part<'a>) -> Option<&'a str> {
        let name = part.node.attribute("name").filter(|name| !name.is_empty());
        if name.is_none() {
            self.problem(part, Kind::MissingName);
        }
        name
    }

    /// Everything in a model. `parent`: the frame that its pose is given in.
    fn collect(&mut self, model: &mut Model<'a>, part: Part<'a>, scope: Scope, parent: FrameId) {
        self.account(part, &MODEL);
        model.parts.push((part, &MODEL));
        let own = scope.model;
        model.frames.all[own].base = parent;
        let index = model.scopes.len();
        let prefix = scope.prefix.clone();
        model.scopes.push(scope);
        if parent == WORLD
            && let Some(found) = part.child("pose")
        {
            let step = pose::step(found.node);
            model.frames.all[own].step = self.take(found, step).unwrap_or_else(Step::identity);
        }
        if let Some(found) = part.child("static") {
            let is_static = pose::boolean(found.node);
            model.is_static |= self.take(found, is_static).unwrap_or(false);
        }
        if let Some(name) = part.node.attribute("placement_frame").filter(|name| !name.is_empty()) {
            let (name, what) = (name.to_owned(), "placement_frame");
            self.wanted.push(Wanted { part, what, name, scope: index, set: Set::Places(own) });
        }
        let first_link = model.links.len();
        for node in part.node.children().filter(Node::is_element) {
            let child = Part { node, file: part.file };
            if node.tag_name().namespace().is_some() {
                continue;
            }
            match node.tag_name().name() {
                "link" => {
                    let Some(name) = self.named(child) else { continue };
                    let frame = self.frame(model, child, index, format!("{prefix}{name}"), own);
                    model.links.push(Link { part: child, frame, scope: index });
                }
                "joint" => self.joint(model, child, index, &prefix),
                "frame" => {
                    let Some(name) = self.named(child) else { continue };
                    let frame = self.frame(model, child, index, format!("{prefix}{name}"), own);
                    let has_pose = child.child("pose").is_some();
                    model.explicit.push(Explicit { part: child, frame, attached_to: own, has_pose });
                    model.frames.all[frame].body = own;
                    if let Some(name) = node.attribute("attached_to").filter(|name| !name.is_empty()) {
                        let set = Set::Attached(model.explicit.len() - 1);
                        let (name, what) = (name.to_owned(), "attached_to");
                        self.wanted.push(Wanted { part: child, what, name, scope: index, set });
                    }
                }
                "model" => {
                    let Some(name) = self.named(child) else { continue };
                    let version = model.scopes[index].version;
                    self.nested(model, &Nested { part: child, posed: child, name, version, merge: false }, index);
                }
                "include" => self.include(model, child, index),
                _ => {}
            }
        }
        // The model's frame is fixed to its canonical link: the first one where none is named.
        if let Some(name) = part.node.attribute("canonical_link").filter(|name| !name.is_empty()) {
            let (name, what) = (name.to_owned(), "canonical_link");
            self.wanted.push(Wanted { part, what, name, scope: index, set: Set::Canonical(own) });
        } else {
            let direct = model.links[first_link..].iter().find(|link| link.scope == index);
            if let Some(link) = direct.or(model.links.get(first_link)) {
                model.frames.all[own].body = link.frame;
            }
        }
    }

    /// A model in a model.
    fn nested(&mut self, model: &mut Model<'a>, nested: &Nested<'a, '_>, scope: usize) {
        let Scope { prefix, model: parent, .. } = model.scopes[scope].clone();
        let Nested { part, posed, name, version, merge } = *nested;
        let prefix = if merge { prefix } else { format!("{prefix}{name}::") };
        let own_name = if merge { format!("{prefix}__{name}__model__") } else { format!("{prefix}__model__") };
        let at = if posed.child("pose").is_some() { posed } else { part };
        let frame = self.frame(model, at, scope, own_name, parent);
        if !merge {
            model.frames.alias(prefix[..prefix.len() - 2].to_owned(), frame);
        }
        self.collect(model, part, Scope { prefix, model: frame, version }, parent);
    }

    fn include(&mut self, model: &mut Model<'a>, part: Part<'a>, scope: usize) {
        model.parts.push((part, &INCLUDE));
        let Some(uri) = part.child("uri").map(|uri| pose::text_of(uri.node)).filter(|uri| !uri.is_empty()) else {
            self.problem(part, Kind::MissingElement("uri"));
            return;
        };
        let found = self.sources.includes.get(&part.at()).cloned();
        let found = found.unwrap_or_else(|| Err("it could not be looked up".to_owned()));
        let named = part.child("name").map(|name| pose::text_of(name.node));
        let prefix = model.scopes[scope].prefix.clone();
        let included = match found {
            Ok(file) => {
                let Some(document) = &self.documents[file] else { return };
                let root = Part { node: document.root_element(), file };
                self.the_model(root, false)
            }
            Err(reason) => {
                let last = uri.trim_end_matches('/').rsplit('/').next().unwrap_or(uri);
                let name = named.unwrap_or(last);
                self.note(part, format!("the model {uri} was not found ({reason}), so its links are missing here"));
                self.missing.push((format!("{prefix}{name}::"), uri.to_owned(), reason));
                return;
            }
        };
        let Some((included, version)) = included else { return };
        let merge = part.node.attribute("merge").is_some_and(|merge| ["true", "1"].contains(&merge.trim()));
        let name = named.unwrap_or(included.name()).to_owned();
        self.nested(model, &Nested { part: included, posed: part, name: &name, version, merge }, scope);
        if let Some(placed) = part.child("placement_frame") {
            let nested = model.scopes.iter().position(|other| other.prefix == format!("{prefix}{name}::"));
            if let Some(nested) = nested {
                let set = Set::Places(model.scopes[nested].model);
                let name = pose::text_of(placed.node).to_owned();
                self.wanted.push(Wanted { part: placed, what: "placement_frame", name, scope: nested, set });
            }
        }
    }

    fn joint(&mut self, model: &mut Model<'a>, part: Part<'a>, scope: usize, prefix: &str) {
        let Some(name) = self.named(part) else { return };
        let mut ends = Vec::new();
        for tag in ["parent", "child"] {
            // 1.12 names ends by attributes, too.
            let text = part.child(tag).map(|end| pose::text_of(end.node)).filter(|text| !text.is_empty());
            match text {
                None => self.problem(part, Kind::MissingElement(if tag == "parent" { "parent" } else { "child" })),
                Some("world") if tag == "child" => self.problem(part, Kind::WorldAsChild),
                Some(text) => ends.push(text.to_owned()),
            }
        }
        let [parent, child] = &ends[..] else { return };
        let frame = self.frame(model, part, scope, format!("{prefix}{name}"), WORLD);
        let index = model.joints.len();
        let name = format!("{prefix}{name}");
        model.joints.push(Joint { name, part, frame, parent: WORLD, child: WORLD, scope });
        let (parent, child) = (parent.clone(), child.clone());
        if parent != "world" {
            self.wanted.push(Wanted { part, what: "parent link", name: parent, scope, set: Set::Parent(index) });
        }
        self.wanted.push(Wanted { part, what: "child link", name: child, scope, set: Set::Child(index) });
    }

    /// Gives every name its frame.
    fn connect(&mut self, model: &mut Model<'a>) {
        let wanted = std::mem::take(&mut self.wanted);
        let mut given: Vec<bool> = vec![false; model.frames.all.len()];
        for Wanted { part, what, name, scope, set } in wanted {
            let Scope { prefix, model: own, .. } = &model.scopes[scope];
            let full = format!("{prefix}{name}");
            let found =
                if name == "__model__" { Some(*own) } else { model.frames.find(&full).filter(|id| *id != WORLD) };
            let Some(id) = found else {
                if let Some(missing) = self.missing.iter().position(|(prefix, ..)| full.starts_with(prefix.as_str()))
                    && let Set::Parent(joint) | Set::Child(joint) = set
                {
                    self.into_missing.push((joint, matches!(set, Set::Parent(_)), missing));
                    continue;
                }
                let near = nearest_name(&name, model.frames.names_in(prefix)).map(str::to_owned);
                self.problem(part, Kind::UnknownFrame { what, name, near });
                continue;
            };
            match set {
                Set::Base(frame) => {
                    model.frames.all[frame].base = id;
                    given[frame] = true;
                }
                Set::Canonical(frame) => model.frames.all[frame].body = id,
                Set::Attached(index) => {
                    let explicit = &mut model.explicit[index];
                    explicit.attached_to = id;
                    model.frames.all[explicit.frame].body = id;
                    if !given[explicit.frame] {
                        model.frames.all[explicit.frame].base = id;
                    }
                }
                Set::Parent(joint) => model.joints[joint].parent = id,
                Set::Child(joint) => {
                    let joint = &mut model.joints[joint];
                    joint.child = id;
                    model.frames.all[joint.frame].body = id;
                    if !given[joint.frame] {
                        model.frames.all[joint.frame].base = id;
                    }
                }
                Set::Places(frame) => model.frames.all[frame].places = Some(id),
            }
        }
        self.drop_joints_into_missing(model);
        if let Err(crate::frames::Cycle(frame, names)) = model.frames.resolve() {
            let links = model.links.iter().map(|link| (link.frame, link.part));
            let joints = model.joints.iter().map(|joint| (joint.frame, joint.part));
            let explicit = model.explicit.iter().map(|explicit| (explicit.frame, explicit.part));
            let part =
                links.chain(joints).chain(explicit).find(|(id, _)| *id == frame).map_or(model.part, |(_, part)| part);
            self.problem(part, Kind::FrameCycle(names));
            return;
        }
        model.canonical = model.frames.all[model.scopes[0].model].body;
    }

    /// A joint to a model that was not found is left out where the rest of the robot is not attached to it.
    fn drop_joints_into_missing(&mut self, model: &mut Model<'a>) {
        let into_missing = std::mem::take(&mut self.into_missing);
        let mut left_out: Vec<usize> = Vec::new();
        for (joint, is_parent, missing) in into_missing {
            let (_, uri, reason) = self.missing[missing].clone();
            let part = model.joints[joint].part;
            let child = model.joints[joint].child;
            let carried = model.joints.iter().enumerate().any(|(other, joint)| {
                other != model.joints.len() && joint.child == child && joint.part.node != part.node
            });
            if is_parent && child != WORLD && !carried {
                self.problem(part, Kind::MissingInclude { uri, reason });
                continue;
            }
            self.note(part, format!("it joins the model {uri}, which was not found; the joint is left out"));
            left_out.push(joint);
        }
        let mut index = 0;
        model.joints.retain(|_| {
            index += 1;
            !left_out.contains(&(index - 1))
        });
    }
}
