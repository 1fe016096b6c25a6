//! What the reader knows about each SDF element: what it understands, what it keeps, and what it does not know.

use denavit_model::problems::nearest_name;
use roxmltree::Node;

/// An element that the reader understands.
pub(crate) struct Known {
    /// Its tag.
    pub tag: &'static str,
    /// Attributes that it reads, or that name things and do nothing else.
    pub attributes: &'static [&'static str],
    /// Elements in it that it understands.
    pub children: &'static [&'static Known],
    /// Elements in it that it keeps whole: they do not affect how the robot moves.
    pub carried: &'static [&'static str],
    /// Whether its text is a value.
    pub value: bool,
    /// Whether only the first of several counts.
    pub once: bool,
}

const fn node(
    tag: &'static str,
    attributes: &'static [&'static str],
    children: &'static [&'static Known],
    carried: &'static [&'static str],
) -> Known {
    Known { tag, attributes, children, carried, value: false, once: true }
}

const fn value(tag: &'static str) -> Known {
    Known { value: true, ..node(tag, &[], &[], &[]) }
}

const fn many(mut known: Known) -> Known {
    known.once = false;
    known
}

static POSE: Known = Known { attributes: &["relative_to", "frame", "degrees", "rotation_format"], ..value("pose") };
static MASS: Known = value("mass");
static DENSITY: Known = value("density");
static INERTIA: Known = node("inertia", &[], &[&IXX, &IXY, &IXZ, &IYY, &IYZ, &IZZ], &[]);
static IXX: Known = value("ixx");
static IXY: Known = value("ixy");
static IXZ: Known = value("ixz");
static IYY: Known = value("iyy");
static IYZ: Known = value("iyz");
static IZZ: Known = value("izz");
static INERTIAL: Known =
    node("inertial", &["auto"], &[&POSE, &MASS, &INERTIA, &DENSITY], &["fluid_added_mass", "auto_inertia_params"]);

static SIZE: Known = value("size");
static RADIUS: Known = value("radius");
static LENGTH: Known = value("length");
static URI: Known = value("uri");
static SCALE: Known = value("scale");
static BOX: Known = node("box", &[], &[&SIZE], &[]);
static SPHERE: Known = node("sphere", &[], &[&RADIUS], &[]);
static CYLINDER: Known = node("cylinder", &[], &[&RADIUS, &LENGTH], &[]);
static CAPSULE: Known = node("capsule", &[], &[&RADIUS, &LENGTH], &[]);
static MESH: Known =
    node("mesh", &["optimization"], &[&URI, &SCALE], &["submesh", "convex_decomposition", "drake:declare_convex"]);
/// Shapes that URDF does not have are kept with the whole visual or collision.
static GEOMETRY: Known = node(
    "geometry",
    &[],
    &[&BOX, &SPHERE, &CYLINDER, &CAPSULE, &MESH],
    &["empty", "ellipsoid", "cone", "plane", "heightmap", "image", "polyline", "drake:capsule", "drake:ellipsoid"],
);
pub(crate) static VISUAL: Known = many(node(
    "visual",
    &["name"],
    &[&POSE, &GEOMETRY],
    &["material", "cast_shadows", "laser_retro", "transparency", "visibility_flags", "meta", "plugin"],
));
pub(crate) static COLLISION: Known = many(node(
    "collision",
    &["name"],
    &[&POSE, &GEOMETRY],
    &[
        "surface",
        "laser_retro",
        "max_contacts",
        "density",
        "auto_inertia_params",
        "drake:proximity_properties",
        "category_bitmask",
    ],
));
pub(crate) static LINK: Known = many(node(
    "link",
    &["name"],
    &[&POSE, &INERTIAL, &VISUAL, &COLLISION],
    &[
        "gravity",
        "enable_wind",
        "self_collide",
        "kinematic",
        "must_be_base_link",
        "velocity_decay",
        "sensor",
        "projector",
        "audio_sink",
        "audio_source",
        "battery",
        "light",
        "particle_emitter",
        "plugin",
        "damping",
    ],
));

static XYZ: Known = Known { attributes: &["expressed_in"], ..value("xyz") };
static LOWER: Known = value("lower");
static UPPER: Known = value("upper");
static EFFORT: Known = value("effort");
static VELOCITY: Known = value("velocity");
static LIMIT: Known =
    node("limit", &[], &[&LOWER, &UPPER, &EFFORT, &VELOCITY], &["stiffness", "dissipation", "drake:acceleration"]);
static DAMPING: Known = value("damping");
static FRICTION: Known = value("friction");
static SPRING_REFERENCE: Known = value("spring_reference");
static SPRING_STIFFNESS: Known = value("spring_stiffness");
static DYNAMICS: Known = node("dynamics", &[], &[&DAMPING, &FRICTION, &SPRING_REFERENCE, &SPRING_STIFFNESS], &[]);
static MULTIPLIER: Known = value("multiplier");
static OFFSET: Known = value("offset");
static REFERENCE: Known = value("reference");
static MIMIC: Known = node("mimic", &["joint", "axis"], &[&MULTIPLIER, &OFFSET, &REFERENCE], &[]);
static DRAKE_MIMIC: Known = node("drake:mimic", &["joint", "multiplier", "offset"], &[], &[]);
static IN_MODEL: Known = value("use_parent_model_frame");
static AXIS: Known = node("axis", &[], &[&XYZ, &LIMIT, &DYNAMICS, &MIMIC, &IN_MODEL], &["initial_position"]);
static AXIS2: Known = node("axis2", &[], &[&XYZ, &LIMIT, &DYNAMICS, &MIMIC, &IN_MODEL], &["initial_position"]);
static PARENT: Known = value("parent");
static CHILD: Known = value("child");
static THREAD_PITCH: Known = value("thread_pitch");
static SCREW_THREAD_PITCH: Known = value("screw_thread_pitch");
static RATIO: Known = value("gearbox_ratio");
static BODY: Known = value("gearbox_reference_body");
pub(crate) static JOINT: Known = many(node(
    "joint",
    &["name", "type"],
    &[&POSE, &PARENT, &CHILD, &AXIS, &AXIS2, &THREAD_PITCH, &SCREW_THREAD_PITCH, &RATIO, &BODY, &DRAKE_MIMIC],
    &["physics", "sensor", "plugin", "drake:rotor_inertia", "drake:gear_ratio", "drake:controller_gains"],
));
static FRAME: Known = many(node("frame", &["name", "attached_to"], &[&POSE], &[]));
static STATIC: Known = value("static");
static NAME: Known = value("name");
static PLACEMENT: Known = value("placement_frame");
pub(crate) static INCLUDE: Known =
    many(node("include", &["merge"], &[&URI, &NAME, &STATIC, &POSE, &PLACEMENT], &["plugin", "experimental:params"]));
pub(crate) static MODEL: Known = Known {
    tag: "model",
    attributes: &["name", "canonical_link", "placement_frame"],
    // A model in a model is walked by itself.
    children: &[&POSE, &STATIC, &LINK, &JOINT, &FRAME, &INCLUDE],
    carried: &[
        "self_collide",
        "allow_auto_disable",
        "enable_wind",
        "plugin",
        "gripper",
        "model",
        "drake:joint",
        "drake:linear_bushing_rpy",
        "drake:collision_filter_group",
        "drake:ball_constraint",
        "drake:distance_constraint",
    ],
    value: false,
    once: false,
};

/// Something in the file that the reader does not understand.
pub(crate) struct Unknown<'a> {
    /// Where it stands.
    pub node: Node<'a, 'a>,
    /// Byte offset in the text.
    pub at: usize,
    /// What it is, with its value.
    pub what: String,
    /// What is done with it, and what the user can do.
    pub advice: String,
}

/// The tag with its prefix, as it is in the text.
pub(crate) fn tag_of<'a>(node: Node<'a, '_>, text: &'a str) -> &'a str {
    let open = text.get(node.range().start + 1..).unwrap_or_default();
    let end = open.find(|c: char| c.is_whitespace() || c == '>' || c == '/').unwrap_or(open.len());
    &open[..end]
}

impl Known {
    /// What is known of a child.
    pub fn child(&self, tag: &str) -> Option<&'static Known> {
        self.children.iter().copied().find(|known| known.tag == tag)
    }

    /// Whether something in the element is neither understood nor empty: it is then kept in addition to what is understood.
    pub fn leaves_something(&self, node: Node, text: &str, placed: &[&str]) -> bool {
        node.children().filter(Node::is_element).any(|child| {
            let tag = tag_of(child, text);
            !placed.contains(&tag) && self.child(tag).is_none_or(|known| known.leaves_something(child, text, &[]))
        })
    }

    /// Walks through an element; counts what is understood and calls `report` for everything that is not.
    pub fn walk<'a>(&'static self, root: Node<'a, 'a>, text: &str, report: &mut dyn FnMut(Unknown<'a>)) -> usize {
        let mut understood = 0;
        let mut open = vec![(root, self)];
        while let Some((node, known)) = open.pop() {
            understood += 1;
            for attribute in node.attributes() {
                let name = attribute.name();
                if known.attributes.contains(&name) && attribute.namespace().is_none() {
                    understood += 1;
                    continue;
                }
                let advice = match nearest_name(name, known.attributes.iter().copied()) {
                    Some(near) => format!("is not understood and is left out; did you mean {near}?"),
                    None => "is not understood and is left out; remove it, or correct its name".to_owned(),
                };
                let what = format!("attribute {name}=\"{}\" of <{}>", cut(attribute.value()), known.tag);
                report(Unknown { node, at: attribute.range().start, what, advice });
            }
            let first = open.len();
            for child in node.children() {
                if child.is_text() && !known.value && child.text().is_some_and(|text| !text.trim().is_empty()) {
                    let what = format!("text \"{}\" in <{}>", cut(child.text().unwrap_or_default().trim()), known.tag);
                    let advice = "is not understood and is left out; write an element or a comment".to_owned();
                    report(Unknown { node, at: child.range().start, what, advice });
                }
                if !child.is_element() {
                    continue;
                }
                let tag = tag_of(child, text);
                if let Some(next) = known.child(tag) {
                    if next.once && open[first..].iter().any(|(_, other)| other.tag == tag) {
                        let what = format!("a second <{tag}> in <{}>", known.tag);
                        let advice = "is ignored; remove one of the two".to_owned();
                        report(Unknown { node: child, at: child.range().start, what, advice });
                    } else {
                        open.push((child, next));
                    }
                } else if !known.carried.contains(&tag) {
                    let near = nearest_name(tag, known.children.iter().map(|known| known.tag));
                    let near = near.map_or_else(
                        || "if it says where something is or how it moves, that is missing here".to_owned(),
                        |near| format!("did you mean <{near}>?"),
                    );
                    let what = format!("<{tag}> in <{}>", known.tag);
                    let advice = format!("is not understood: it is kept unchanged and has no effect here; {near}");
                    report(Unknown { node: child, at: child.range().start, what, advice });
                }
            }
            open[first..].reverse();
        }
        understood
    }
}

/// Longer values are cut in messages.
const SHOWN: usize = 120;

fn cut(value: &str) -> String {
    match value.char_indices().nth(SHOWN) {
        Some((end, _)) => format!("{}…", &value[..end]),
        None => value.to_owned(),
    }
}
