//! The actual robot: chain, instrument and targets, and the pose of each in one row.

use denavit_measurements::{Measurements, RecordedRow, Scene};
use denavit_model::compiled::sines_and_cosines;
use denavit_model::nalgebra::{Point3, Unit, Vector3, Vector6};
use denavit_model::{AxisLine, Chain, ChainJoint, Pitch, Pose, Screw, Tips, se3};

/// Chain, instrument and targets: everything that predicts a measured value, apart from effects.
///
/// position = instrument_from_base · base_from_tip(q) · target,   distance = |anchor - base_from_tip(q) · target|.
///
/// The home pose stays nominal: the targets absorb what it could express beyond the axes (and, for poses, the
/// targets' orientation).
#[derive(Debug, Clone, PartialEq)]
pub struct Arm {
    /// The drawn chain; with several tips the joints of all, see [`Chain::joined`].
    pub nominal: Chain,
    /// The links that targets sit on.
    pub tips: Tips,
    /// Moving joints with their actual axes and scales; coordinates and order as in `nominal`.
    pub joints: Vec<ChainJoint>,
    /// instrument_from_base for each setup; identity where no instrument's frame is seen.
    pub instruments: Vec<Pose>,
    /// Positions of the points in the base frame, m.
    pub points: Vec<Vector3<f64>>,
    /// tip_from_target for each target; the rotation is used where it is seen.
    pub targets: Vec<Pose>,
    /// Index of the tip that each target sits on.
    pub sits_on: Vec<usize>,
}

/// Directions in which a joint's axis can change: two across it, and the reference point on it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisBasis {
    /// First direction across the axis, a unit vector.
    pub a: Vector3<f64>,
    /// Second direction: a, b and the axis are right-handed.
    pub b: Vector3<f64>,
    /// Point on the axis near the arm, m.
    pub centre: Point3<f64>,
}

impl AxisBasis {
    /// For a nominal screw: `a` is the base axis most nearly perpendicular to the screw's direction, made perpendicular to it.
    pub fn of(screw: &Screw) -> Self {
        let u = screw.direction().into_inner();
        let least = (0..3).min_by(|&i, &k| u[i].abs().total_cmp(&u[k].abs())).unwrap_or(0);
        // The first of the base axes that are equally perpendicular, so that rounding does not choose.
        let axis = (0..3).find(|&i| u[i].abs() <= u[least].abs() + 1e-6).unwrap_or(least);
        let mut e = Vector3::zeros();
        e[axis] = 1.0;
        let a = (e - u * u.dot(&e)).normalize();
        let centre = screw.line().map_or_else(Point3::origin, |line| line.point);
        Self { a, b: u.cross(&a), centre }
    }

    /// Moved to a slightly different screw by the smallest rotation of the direction.
    #[must_use]
    pub fn carried(&self, nominal: &Screw, actual: &Screw) -> Self {
        let (from, to) = (nominal.direction().into_inner(), actual.direction().into_inner());
        let rotation = se3::least_rotation(&from, &to);
        let centre = actual.line().map_or(self.centre, |line| line.nearest_to(&self.centre));
        Self { a: rotation * self.a, b: rotation * self.b, centre }
    }
}

/// Deviation of a joint's axis from nominal: the numbers that calibration reports.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct AxisChange {
    /// Rotation of the direction about [`AxisBasis::a`] and [`AxisBasis::b`], rad.
    pub turned: [f64; 2],
    /// Shift of the line along a and b at the centre, m; 0 for prismatic joints.
    pub moved: [f64; 2],
    /// Change of the pitch, m/rad.
    pub pitch: f64,
    /// Ratio of the actual to the nominal scale, minus 1.
    pub scale: f64,
    /// Offset added to the reading, rad or m.
    pub zero: f64,
}

impl Arm {
    /// The nominal robot with instruments, points and targets at identity and zero.
    pub fn new(nominal: &Chain, scene: &Scene) -> Self {
        Self {
            nominal: nominal.clone(),
            tips: scene.tips_of(nominal),
            joints: nominal.joints().to_vec(),
            instruments: vec![Pose::identity(); scene.setups.len()],
            points: vec![Vector3::zeros(); scene.points.len()],
            targets: vec![Pose::identity(); scene.targets.len()],
            sits_on: (0..scene.targets.len()).map(|target| scene.tip_of(target)).collect(),
        }
    }

    /// The calibrated chain to one tip: actual axes and scales, nominal home pose.
    pub fn chain_to(&self, tip: usize) -> Chain {
        self.tips[tip].chain(&self.chain()).expect("a small finite change of a chain is a chain")
    }

    /// The chain to one tip as drawn.
    pub fn nominal_to(&self, tip: usize) -> Chain {
        self.tips[tip].chain(&self.nominal).expect("a part of a chain is a chain")
    }

    /// The calibrated joints: actual axes and scales, nominal home pose. Where there are several tips, those of all.
    pub fn chain(&self) -> Chain {
        let names = (self.nominal.name(), self.nominal.base(), self.nominal.tip());
        Chain::new(names, self.nominal.coordinates().to_vec(), self.joints.clone(), *self.nominal.home())
            .expect("a small finite change of a chain is a chain")
    }

    /// Deviation of joint `index` from nominal.
    pub fn change(&self, index: usize) -> AxisChange {
        let (nominal, actual) = (&self.nominal.joints()[index], &self.joints[index]);
        let basis = AxisBasis::of(&nominal.screw);
        let turn = se3::least_rotation_vector(&nominal.screw.direction(), &actual.screw.direction());
        let moved = actual.screw.line().map_or([0.0; 2], |line| {
            let offset = line.nearest_to(&basis.centre) - basis.centre;
            [offset.dot(&basis.a), offset.dot(&basis.b)]
        });
        let pitch = actual.screw.pitch().unwrap_or(0.0) - nominal.screw.pitch().unwrap_or(0.0);
        AxisChange {
            turned: [turn.dot(&basis.a), turn.dot(&basis.b)],
            moved,
            pitch,
            scale: actual.scale / nominal.scale - 1.0,
            zero: (actual.offset - nominal.offset) / nominal.scale,
        }
    }

    /// Adds `by` (rad or m) to every reading of the coordinate that moves joint `index`.
    pub fn shift_zero(&mut self, index: usize, by: f64) {
        let coordinate = self.joints[index].coordinate;
        for (joint, nominal) in self.joints.iter_mut().zip(self.nominal.joints()) {
            if joint.coordinate == coordinate {
                joint.offset += by * nominal.scale;
            }
        }
    }

    /// Turn and move an axis by [`AxisBasis`] coordinates: S ← Ad(exp(B η)) S, the kind kept.
    ///
    /// `turned` rad about a and b, `moved` m along a and b, `pitch` m/rad added.
    pub fn change_axis(&mut self, index: usize, basis: &AxisBasis, turned: [f64; 2], moved: [f64; 2], pitch: f64) {
        let omega = basis.a * turned[0] + basis.b * turned[1];
        let v = basis.a * moved[0] + basis.b * moved[1] + basis.centre.coords.cross(&omega);
        let motion = se3::exp(&Vector6::new(omega.x, omega.y, omega.z, v.x, v.y, v.z));
        let screw = self.joints[index].screw.moved(&motion);
        self.joints[index].screw = with_pitch(&screw.about(&basis.centre), pitch);
    }

    /// Computes the poses of everything on the way to a tip at the coordinates `q`, with or without deviations, into `state`.
    ///
    /// Joints that are not on the way keep the pose of the joint before them.
    pub fn state_into(&self, q: &[f64], tip: usize, perturbation: Option<&Perturbation>, state: &mut RowState) {
        let tip = &self.tips[tip];
        let mut reached = Pose::identity();
        let RowState { before, after, turns: [values, sines, cosines], .. } = state;
        let count = self.joints.len();
        before.resize(count, reached);
        after.resize(count, reached);
        for numbers in [&mut *values, &mut *sines, &mut *cosines] {
            numbers.resize(count, 0.0);
        }
        for (value, joint) in values.iter_mut().zip(&self.joints) {
            *value = joint.value(q);
        }
        sines_and_cosines(values, sines, cosines);
        let turns = values.iter().zip(sines.iter().zip(cosines.iter()));
        let places = before.iter_mut().zip(after.iter_mut());
        for (index, ((joint, (value, turn)), (before, after))) in self.joints.iter().zip(turns).zip(places).enumerate()
        {
            if !tip.joints[index] {
                (*before, *after) = (reached, reached);
                continue;
            }
            if let Some(perturbation) = perturbation {
                reached *= se3::exp(&perturbation.twists[index]);
            }
            *before = reached;
            reached *= joint.screw.motion_by(*value, (*turn.0, *turn.1));
            *after = reached;
        }
        if let Some(perturbation) = perturbation {
            reached *= se3::exp(&perturbation.twists[count]);
        }
        state.tip = reached * tip.home;
    }
}

/// The screw with `added` (m/rad) on its pitch; a revolute joint becomes helical, a prismatic one has no pitch.
fn with_pitch(screw: &Screw, added: f64) -> Screw {
    let Some(line) = screw.line().copied() else { return *screw };
    if added == 0.0 {
        return *screw;
    }
    match Pitch::from_metres_per_radian(screw.pitch().unwrap_or(0.0) + added) {
        Some(pitch) => Screw::Helical { axis: line, pitch },
        None => Screw::Revolute(AxisLine { direction: Unit::new_normalize(*line.direction), point: line.point }),
    }
}

/// The perturbation by effects in one row. All zero: none.
#[derive(Debug, Clone, PartialEq)]
pub struct Perturbation {
    /// n + 1 twists `[omega; v]` (rad, m), base frame at home: twist i acts before joint i's motion and carries joint
    /// i and all after it; the last acts on the tip alone. A twist along joint i's own unit screw is an error of its
    /// value; the first one moves the whole robot relative to the instrument.
    pub twists: Vec<Vector6<f64>>,
    /// Shift of every target, tip frame, m.
    pub target: Vector3<f64>,
    /// Shift of the anchor, base frame, m.
    pub anchor: Vector3<f64>,
    /// The instrument reads lengths (1 + scale) times too long.
    pub scale: f64,
    /// The instrument's reading of a distance is too long by this, m.
    pub reading: f64,
    /// Excess of the instrument's range along its line of sight.
    pub sight: AlongSight,
}

/// Excess of the instrument's range along its line of sight: [`AlongSight::turning`] · u + [`AlongSight::steady`],
/// u being the direction from the instrument to the target in the tip's axes.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct AlongSight {
    /// The part that depends on the target's orientation to the instrument, tip frame, m.
    pub turning: Vector3<f64>,
    /// The constant part, m.
    pub steady: f64,
}

impl AlongSight {
    /// Excess of the reading of a target at `there` in an instrument's frame (m); base frame, m.
    ///
    /// `instrument`: instrument_from_base, `tip`: base_from_tip.
    pub fn beyond(&self, there: &Vector3<f64>, instrument: &Pose, tip: &Pose) -> Vector3<f64> {
        if *self == Self::default() {
            return Vector3::zeros();
        }
        let along = there.try_normalize(0.0).map(|along| instrument.rotation.inverse() * along);
        along.map_or_else(Vector3::zeros, |along| along * (self.steady + (tip.rotation * self.turning).dot(&along)))
    }
}

impl std::ops::Mul<f64> for AlongSight {
    type Output = Self;

    fn mul(self, amount: f64) -> Self {
        Self { turning: self.turning * amount, steady: self.steady * amount }
    }
}

impl std::ops::AddAssign for AlongSight {
    fn add_assign(&mut self, other: Self) {
        self.turning += other.turning;
        self.steady += other.steady;
    }
}

impl Perturbation {
    /// No perturbation, for a chain of `joints` moving joints.
    pub fn none(joints: usize) -> Self {
        Self {
            twists: vec![Vector6::zeros(); joints + 1],
            target: Vector3::zeros(),
            anchor: Vector3::zeros(),
            scale: 0.0,
            reading: 0.0,
            sight: AlongSight::default(),
        }
    }

    /// Both together, to first order.
    pub fn add(&mut self, other: &Self) {
        for (twist, more) in self.twists.iter_mut().zip(&other.twists) {
            *twist += more;
        }
        self.target += other.target;
        self.anchor += other.anchor;
        self.scale += other.scale;
        self.reading += other.reading;
        self.sight += other.sight;
    }

    /// base_from_tip of a chain of one tip with this perturbation at these readings, m.
    ///
    /// # Panics
    /// `chain` has other joints than the perturbation, or `reading` is too short.
    pub fn fk(&self, chain: &Chain, reading: &[f64]) -> Pose {
        let mut reached = Pose::identity();
        for (joint, twist) in chain.joints().iter().zip(&self.twists) {
            reached *= se3::exp(twist) * joint.screw.motion(joint.value(reading));
        }
        reached * se3::exp(&self.twists[chain.joints().len()]) * chain.home()
    }

    /// Back to no perturbation, without allocation.
    pub fn clear(&mut self) {
        self.twists.fill(Vector6::zeros());
        self.target = Vector3::zeros();
        self.anchor = Vector3::zeros();
        self.scale = 0.0;
        self.reading = 0.0;
        self.sight = AlongSight::default();
    }
}

/// The arm's state in one row, base frame.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RowState {
    /// For each joint the motion of its axis from home: Ad(before\[i\]) maps twists at home to twists now.
    pub before: Vec<Pose>,
    /// For each joint the motion of its link from home.
    pub after: Vec<Pose>,
    /// base_from_tip.
    pub tip: Pose,
    /// Joint values, their sines and their cosines.
    turns: [Vec<f64>; 3],
}

/// The arm's state in one row, and the perturbation by its effects.
#[derive(Debug, Clone, Copy)]
pub struct Perturbed<'a> {
    /// Its state.
    pub state: &'a RowState,
    /// The perturbation by effects; all zero where there are none.
    pub by: &'a Perturbation,
}

/// One row of measured data as a driver may see it: without access to the measured values.
#[derive(Debug, Clone, Copy)]
pub struct Row<'a> {
    data: &'a Measurements,
    index: usize,
}

impl<'a> Row<'a> {
    /// Row `index` of `data`.
    pub fn new(data: &'a Measurements, index: usize) -> Self {
        Self { data, index }
    }

    /// Its index in run order.
    pub fn index(&self) -> usize {
        self.index
    }

    /// Joint readings in the chain's coordinate order, rad or m.
    pub fn reading(&self) -> &'a [f64] {
        self.data.reading(self.index)
    }

    /// Index of the tip that it is of.
    pub fn tip(&self) -> usize {
        self.data.tip_of(self.index)
    }

    /// Joint readings of another row of the same run.
    pub fn reading_at(&self, row: usize) -> &'a [f64] {
        self.data.reading(row)
    }

    /// Number of rows in the run.
    pub fn rows(&self) -> usize {
        self.data.len()
    }

    /// Its recorded quantities.
    pub fn recorded(&self) -> RecordedRow<'a> {
        self.data.covariates.row(self.index)
    }
}
