//! Compares two robots: everything that changed, and how far this displaces the tips.

mod alignment;
mod bound;
mod elements;
mod features;
mod joints;
mod matter;
mod options;
mod sampling;
mod steps;

pub use options::{Options, Range, Scope};

use crate::across;
use crate::comparison::{Change, Comparison, JointDifference, JointValue, Side, TipDifference, Verdict};
use crate::mechanism::Mechanism;
use crate::subject::Subject;
use alignment::Alignment;
use denavit_model::Note;
use denavit_model::se3::Pose;
use denavit_model::tree::TreeError;
use joints::{Names, Reparametrised};
use matter::{Matter, TipPair};
use steps::{Space, TipPath};

/// Compares `b` with the reference `a`.
///
/// Joints are paired by name, and by geometry where renamed. Movement is compared independent of link frames:
/// axes relative to the link that carries them, masses and shapes relative to the joint that carries them. The root
/// link's frame represents the floor and counts, unless [`Options::up_to_base`].
///
/// Where one side is a bare chain and the other a tree, the tree's default chain is compared.
///
/// # Errors
/// One side is a bare chain and the other a tree that has no chain.
///
/// # Examples
/// ```
/// use denavit_compare::{Options, Subject, Verdict, compare};
/// use denavit_model::urdf;
/// let text = r#"<robot name="r"> <link name="base"/> <link name="tip"/>
///   <joint name="j" type="continuous"> <axis xyz="0 0 1"/> <parent link="base"/> <child link="tip"/> </joint> </robot>"#;
/// let (a, b) = (urdf::read("a.urdf", text)?, urdf::read("b.urdf", &text.replace("0 0 1", "0 0.01 1"))?);
/// let found = compare(&Subject::Robot(&a), &Subject::Robot(&b), &Options::default())?;
/// assert_eq!(found.verdict, Verdict::Different);
/// assert_eq!(found.joints[0].changes[0].what.to_string(), "axis turned by 10 mrad (0.5729°)");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn compare(a: &Subject, b: &Subject, options: &Options) -> Result<Comparison, TreeError> {
    let (mut in_a, mut in_b) = match (a, b) {
        (Subject::Robot(robot), Subject::Chain { .. }) => {
            let chain = robot.chain(None, None, options.reading)?.value;
            (Mechanism::of_chain(&chain), b.mechanism(options.reading))
        }
        (Subject::Chain { .. }, Subject::Robot(robot)) => {
            let chain = robot.chain(None, None, options.reading)?.value;
            (a.mechanism(options.reading), Mechanism::of_chain(&chain))
        }
        _ => (a.mechanism(options.reading), b.mechanism(options.reading)),
    };
    let only_one = match (a, b) {
        (Subject::Robot(one), Subject::Robot(other)) => {
            across::level((one, &mut in_a), (other, &mut in_b), options.through)
        }
        _ => Vec::new(),
    };
    if in_a.has_screws() != in_b.has_screws() {
        in_a.join_screws();
        in_b.join_screws();
    }
    let found = Found::best(&in_a, &in_b, options);
    let mut comparison = found.comparison((a, &in_a), (b, &in_b), options);
    comparison.notes.extend(only_one);
    Ok(comparison)
}

/// Parts of either file that are compared only as text: what is not understood, closed loops.
fn not_understood(a: &Subject, b: &Subject) -> Vec<String> {
    let of = |subject: &Subject| -> Vec<(String, String)> {
        let Subject::Robot(robot) = subject else { return Vec::new() };
        let notes = robot.notes.iter().filter_map(|note| match note {
            Note::NotUnderstood { place, what } => Some((place.to_string(), format!("{}: {what}", place.element))),
            _ => None,
        });
        notes.map(|(place, said)| (said.clone(), format!("{place}{}", &said[said.find(": ").unwrap_or(0)..]))).collect()
    };
    let (in_a, in_b) = (of(a), of(b));
    let only = |own: &[(String, String)], other: &[(String, String)]| -> Vec<String> {
        let own = own.iter().filter(|(said, _)| !other.iter().any(|(known, _)| known == said));
        own.map(|(_, placed)| placed.clone()).collect()
    };
    let both = in_a.iter().filter(|(said, _)| in_b.iter().any(|(known, _)| known == said));
    let both: Vec<String> = both.map(|(said, _)| format!("both: {said}")).collect();
    [both, only(&in_a, &in_b), only(&in_b, &in_a)].concat()
}

/// An alignment and the remaining differences.
struct Found {
    at: Alignment,
    joints: Vec<Vec<Change>>,
    runs: Vec<Reparametrised>,
    matter: Matter,
}

impl Found {
    /// With the given base, or with the base that gives the fewest differences.
    fn best(a: &Mechanism, b: &Mechanism, options: &Options) -> Self {
        let first = Self::under(a, b, Pose::identity(), options);
        if !options.up_to_base {
            return first;
        }
        let others =
            alignment::bases(a, b, &first.at, options).into_iter().map(|base| Self::under(a, b, base, options));
        others.fold(first, |best, other| if other.differences() < best.differences() { other } else { best })
    }

    fn under(a: &Mechanism, b: &Mechanism, base: Pose, options: &Options) -> Self {
        let at = Alignment::new(a, b, base, options);
        let names = Names::of(a, b);
        let runs: Vec<Reparametrised> =
            (0..a.joints.len()).map(|joint| joints::run(a, b, &at, joint, options)).collect();
        let joints =
            (0..a.joints.len()).map(|joint| joints::changes(a, b, &at, &names, &runs, joint, options)).collect();
        let matter = matter::compare(a, b, &at, options);
        Self { at, joints, runs, matter }
    }

    fn differences(&self) -> usize {
        let joints = self.joints.iter().flatten().filter(|change| change.counts).count();
        joints + self.matter.parts.iter().filter(|part| part.counts).count()
    }

    fn comparison(
        self,
        (a, in_a): (&Subject, &Mechanism),
        (b, in_b): (&Subject, &Mechanism),
        options: &Options,
    ) -> Comparison {
        let tips = self.tips(in_a, in_b, options);
        let Self { at, joints, mut matter, .. } = self;
        let lines = b.lines();
        let mut found: Vec<JointDifference> = Vec::new();
        for (index, changes) in joints.into_iter().enumerate().filter(|(_, changes)| !changes.is_empty()) {
            let joint = in_a.joints[index].name.clone();
            let other = at.joint_b[index].map(|other| in_b.joints[other].name.clone());
            let line = lines.joint(other.as_ref().unwrap_or(&joint));
            found.push(JointDifference { renamed: other.filter(|other| *other != joint), joint, line, changes });
        }
        let fixed = Names::of(in_a, in_b);
        for (index, joint) in in_b.joints.iter().enumerate().filter(|(index, _)| at.joint_a[*index].is_none()) {
            let changes = vec![Change::counted(joints::new_in_b(in_b, &fixed, index))];
            found.push(JointDifference {
                joint: joint.name.clone(),
                renamed: None,
                line: lines.joint(&joint.name),
                changes,
            });
        }
        let renamed = at.joint_b.iter().enumerate().filter_map(|(index, other)| {
            let (name, other) = (&in_a.joints[index].name, &in_b.joints[(*other)?].name);
            (name != other).then(|| (name.clone(), other.clone()))
        });
        let renamed: Vec<(String, String)> = renamed.collect();
        if options.scope == Scope::Everything && !in_a.bare && !in_b.bare {
            let all = renamed.iter().chain(&matter.renamed).map(|(one, other)| (one.as_str(), other.as_str()));
            matter.parts.extend(elements::compare(in_a, in_b, &at, options, &all.collect(), &|at| b.line(at)));
        }
        let names = matter.name_notes(&renamed);
        let names_count = options.count_names && !names.is_empty();
        for part in &mut matter.parts {
            part.line = part.line.or_else(|| part.link.as_ref().and_then(|link| lines.link(link)));
        }
        let counted = found.iter().flat_map(|joint| &joint.changes).any(|change| change.counts)
            || matter.parts.iter().any(|part| part.counts);
        let side = |subject: &Subject, mechanism: &Mechanism| Side {
            file: subject.file().to_owned(),
            robot: mechanism.name.clone(),
            joints: mechanism.joints.len(),
        };
        Comparison {
            verdict: if counted || names_count { Verdict::Different } else { Verdict::Same },
            a: side(a, in_a),
            b: side(b, in_b),
            tolerance_m: options.tolerance_m,
            tolerance_rad: options.tolerance_rad,
            joints: found,
            tips,
            parts: matter.parts,
            notes: names.into_iter().chain(matter.notes).chain(not_understood(a, b)).collect(),
        }
    }

    fn tips(&self, a: &Mechanism, b: &Mechanism, options: &Options) -> Vec<TipDifference> {
        let space = Space::new(a, b, &self.at, &self.runs, options);
        let mut result: Vec<TipDifference> = Vec::new();
        for TipPair { link, body, points } in &self.matter.tips {
            let Some(way) = TipPath::new(a, b, &self.at, &space, *body, *points) else { continue };
            let still = way.steps.iter().all(|step| step.still);
            let samples = if still { 0 } else { options.samples };
            let largest = sampling::largest(&way, &space.intervals, samples, options.seed);
            let bound = bound::upper(&way, &space.intervals);
            let at = way.coordinates().into_iter().map(|coordinate| JointValue {
                joint: space.intervals[coordinate].name.clone(),
                value: largest.q[coordinate],
            });
            result.push(TipDifference {
                tip: link.clone(),
                sampled_m: largest.displacement,
                at: at.collect(),
                bound_m: bound,
            });
        }
        result.sort_by(|x, y| y.sampled_m.total_cmp(&x.sampled_m));
        result
    }
}
