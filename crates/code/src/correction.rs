//! Effects written out: the tip's pose with them, and the step to the joint values that bring it to a target.
//!
//! ```text
//! steady(q) ─► twists      bend(q, twists) ─► twists, until they stand still      reach(q, twists) ─► pose
//! ```
//! Where nothing depends on the arm's deflection under gravity, `steady` is a part of `reach` and `bend` is left out.

use crate::effects::{Action, Averaged, Bump, Curve, Driver, Effects, Input, Model, Term};
use crate::geometry::{Frame, Triple, Twist, is_zero, number, triple, zeros};
use crate::program::{Function, Sheet, Statement, Value};
use crate::spread::{Table, factor};
use denavit_model::nalgebra::{Point3, Vector3};
use denavit_model::{AxisLine, Screw};
use std::collections::BTreeSet;
use std::f64::consts::PI;

/// Passes after which the deflection of an arm under its weight counts as converged.
pub const MOST_PASSES: usize = 6;
/// A change between two passes of this size (rad, m) moves no instrument.
pub const STILL: f64 = 1e-7;
/// Orientation is weighted with this lever (fraction of the robot's size) where a pose is out of reach.
const LEVER: f64 = 0.1;
/// The same for fewer than six coordinates, which cannot correct both: position has priority.
const LEVER_OF_FEW: f64 = 0.01;

/// A function of assignments.
#[derive(Debug)]
pub struct Part {
    pub statements: Vec<Statement>,
    pub outputs: Vec<Value>,
}

/// Effects as functions.
#[derive(Debug)]
pub struct Correction {
    /// The twists that do not depend on the deflection; `None` where `reach` computes them itself.
    pub steady: Option<Part>,
    /// The twists of an arm that has deflected by `t`.
    pub bend: Option<Part>,
    /// How many passes of `bend` there are at most.
    pub passes: usize,
    /// The pose, row by row, by `q`, `given`, and where the arm bends `t` (the twists) and `at` (those by which it stood).
    pub reach: Part,
    /// How many twists' components there are.
    pub twists: usize,
    /// Tables of the functions.
    pub tables: Vec<Table>,
    /// Length of the rows of z.
    pub numbers: usize,
    /// A step of the joint values by `jacobian`, `pose` and `target`; last how far the tip is off, m.
    pub step: Part,
}

/// The state of an arm in one posture.
struct Standing {
    before: Vec<Frame>,
    after: Vec<Frame>,
    /// Before the home pose.
    end: Frame,
    tip: Frame,
}

/// Gravity on each joint.
struct Loads {
    force: Vec<Vector3<f64>>,
    moment: Vec<Triple>,
    along: Vec<Triple>,
    lever: Vec<Triple>,
}

fn line(screw: &Screw) -> Option<&AxisLine> {
    match screw {
        Screw::Prismatic(_) => None,
        Screw::Revolute(line) | Screw::Helical { axis: line, .. } => Some(line),
    }
}

impl Driver {
    /// Whether its values depend on the deflection.
    fn feels_gravity(&self) -> bool {
        matches!(
            self,
            Self::Torque(_)
                | Self::TorqueTerms(..)
                | Self::SprungTorque(_)
                | Self::HardeningTorque(..)
                | Self::MomentAcross(..)
                | Self::Cantilever { .. }
                | Self::EndMoment(..)
                | Self::Overturning(_)
        )
    }

    /// Whether they depend on the deflection.
    fn needs_posture(&self) -> bool {
        self.feels_gravity() || matches!(self, Self::GravitySide(_) | Self::FrictionSide(..) | Self::LoadedSide(..))
    }
}

/// Writes a model out.
struct Lowering<'a> {
    model: &'a Model,
    tiny: f64,
    sheet: Sheet,
}

impl<'a> Lowering<'a> {
    fn new(model: &'a Model, tiny: f64) -> Self {
        Self { model, tiny, sheet: Sheet::default() }
    }

    fn part(self, outputs: Vec<Value>) -> Part {
        Part { statements: self.sheet.statements, outputs }
    }

    fn nothing(&self) -> Vec<Twist> {
        let zero = || [0; 6].map(|_| Value::ZERO);
        (0..=self.model.joints.len()).map(|_| zero()).collect()
    }

    /// The twists whose components have these places, by name.
    fn named(&self, array: &str, places: &[(usize, usize)]) -> Vec<Twist> {
        let mut twists = self.nothing();
        for (index, (slot, row)) in places.iter().enumerate() {
            twists[*slot][*row] = Value::named(format!("{array}[{index}]"));
        }
        twists
    }

    /// The arm with these twists.
    fn standing(&mut self, twists: &[Twist]) -> Standing {
        let (mut reached, mut before, mut after) = (Frame::identity(), Vec::new(), Vec::new());
        for (joint, twist) in self.model.joints.iter().zip(twists) {
            if !is_zero(twist) {
                let given_way = self.sheet.exp(twist, self.tiny);
                reached = self.sheet.compose(&reached, &given_way);
            }
            before.push(reached.clone());
            let value = self.sheet.joint_value(joint);
            let motion = self.sheet.motion(&joint.screw, &value);
            reached = self.sheet.compose(&reached, &motion);
            after.push(reached.clone());
        }
        let last = &twists[self.model.joints.len()];
        if !is_zero(last) {
            let given_way = self.sheet.exp(last, self.tiny);
            reached = self.sheet.compose(&reached, &given_way);
        }
        let tip = self.sheet.compose(&reached, &Frame::of(&self.model.home));
        Standing { before, after, end: reached, tip }
    }

    fn loads(&mut self, standing: &Standing) -> Loads {
        let masses = &self.model.masses;
        let count = self.model.joints.len();
        let gravity = triple(&masses.gravity);
        let (mut force, mut moment) = (vec![Vector3::zeros(); count], vec![zeros(); count]);
        for joint in 0..count {
            // Those on one link act as one.
            let own: Vec<_> = masses.points.iter().filter(|(carrier, ..)| *carrier == joint).collect();
            let mass: f64 = own.iter().map(|(_, mass, _)| mass).sum();
            if mass != 0.0 {
                let centre = own.iter().map(|(_, mass, centre)| centre * *mass).sum::<Vector3<f64>>() / mass;
                let at = self.sheet.point(&standing.after[joint], &triple(&centre));
                self.hang(&at, mass, &gravity, (&mut force[joint], &mut moment[joint]));
            }
        }
        let (payload, hangs) = masses.payload;
        if payload != 0.0 && count > 0 {
            let at = self.sheet.point(&standing.end, &triple(&hangs));
            self.hang(&at, payload, &gravity, (&mut force[count - 1], &mut moment[count - 1]));
        }
        for joint in (1..count).rev() {
            force[joint - 1] = force[joint - 1] + force[joint];
            moment[joint - 1] = self.sheet.add(&moment[joint - 1].clone(), &moment[joint].clone());
        }
        let (mut along, mut lever) = (Vec::new(), Vec::new());
        for (joint, of) in self.model.joints.iter().enumerate() {
            let before = &standing.before[joint];
            let start = masses.starts[joint];
            let at = self.sheet.point(before, &triple(&start));
            let less = self.sheet.cross(&at, &triple(&force[joint]));
            moment[joint] = self.sheet.subtract(&moment[joint].clone(), &less);
            let start = Point3::from(start);
            let from_axis = line(&of.screw).map_or_else(Vector3::zeros, |line| start - line.nearest_to(&start));
            along.push(self.sheet.turned(before, &triple(&of.screw.direction().into_inner())));
            lever.push(self.sheet.turned(before, &triple(&from_axis)));
        }
        Loads { force, moment, along, lever }
    }

    fn hang(&mut self, at: &Triple, mass: f64, gravity: &Triple, (force, moment): (&mut Vector3<f64>, &mut Triple)) {
        *force += self.model.masses.gravity * mass;
        let weight = self.sheet.scale(gravity, &number(mass));
        let own = self.sheet.cross(at, &weight);
        *moment = self.sheet.add(&moment.clone(), &own);
    }

    /// Gravity's moment about where a joint's axis stands.
    fn moment(&mut self, loads: &Loads, joint: usize) -> Triple {
        let lever = self.sheet.cross(&loads.lever[joint], &triple(&loads.force[joint]));
        self.sheet.add(&loads.moment[joint], &lever)
    }

    fn torque(&mut self, loads: &Loads, joint: usize) -> Value {
        let force = triple(&loads.force[joint]);
        match &self.model.joints_read(joint).screw {
            Screw::Prismatic(_) => self.sheet.dot(&loads.along[joint], &force),
            Screw::Revolute(_) => {
                let moment = self.moment(loads, joint);
                self.sheet.dot(&loads.along[joint], &moment)
            }
            Screw::Helical { pitch, .. } => {
                let moment = self.moment(loads, joint);
                let turning = self.sheet.dot(&loads.along[joint], &moment);
                let force = self.sheet.dot(&loads.along[joint], &force);
                self.sheet.sum(&[(&turning, &Value::ONE), (&force, &number(pitch.metres_per_radian()))])
            }
        }
    }

    fn read_input(input: Input) -> Value {
        match input {
            Input::Known(known) => number(known),
            Input::Argument(index) => Value::named(format!("given[{index}]")),
        }
    }

    fn choice(&mut self, a: &Value, b: &Value, below: f64, otherwise: f64) -> Value {
        self.sheet.call(Function::Choice, &[a, b, &number(below), &number(otherwise)])
    }

    fn read(&mut self, joint: usize) -> Value {
        self.sheet.joint_value(&self.model.read[joint])
    }

    /// The values of a driver; how the arm stands is known where it is asked for.
    fn values(&mut self, driver: &Driver, standing: Option<&(Standing, Loads)>) -> Vec<Value> {
        match driver {
            Driver::Constant(values) => values.iter().map(|value| number(*value)).collect(),
            Driver::Reading(joint) => vec![self.read(*joint)],
            Driver::Harmonic { joint, order } => {
                let value = self.read(*joint);
                let angle = self.sheet.times(&value, &number(*order));
                vec![self.sheet.call(Function::Sine, &[&angle]), self.sheet.call(Function::Cosine, &[&angle])]
            }
            Driver::Bump { joint, at, width, shape } => {
                let value = self.read(*joint);
                let u = self.sheet.sum(&[(&value, &number(1.0 / width)), (&number(-at / width), &Value::ONE)]);
                vec![self.bump(&u, *shape)]
            }
            Driver::Told(inputs) => inputs
                .iter()
                .map(|(scale, input)| self.sheet.times(&number(*scale), &Self::read_input(*input)))
                .collect(),
            Driver::Decay { of, from, constant } => {
                let late = self.sheet.minus(&Self::read_input(*of), &number(*from));
                let late = self.sheet.call(Function::Most, &[&late, &Value::ZERO]);
                let power = self.sheet.times(&late, &number(-1.0 / constant));
                let left = self.sheet.call(Function::Exponential, &[&power]);
                vec![self.sheet.minus(&Value::ONE, &left)]
            }
            Driver::Steps(input, places) => {
                let value = Self::read_input(*input);
                places.iter().map(|place| self.choice(&value, &number(*place), 0.0, 1.0)).collect()
            }
            Driver::Smooth(input, knots) => self.hats(&Self::read_input(*input), knots),
            _ => {
                let (standing, loads) = standing.expect("who asks for gravity stands the arm first");
                self.values_of_gravity(driver, standing, loads)
            }
        }
    }

    fn bump(&mut self, u: &Value, shape: Bump) -> Value {
        match shape {
            Bump::Bell => {
                let power = self.sheet.times(u, u);
                let power = self.sheet.times(&power, &number(-0.5));
                self.sheet.call(Function::Exponential, &[&power])
            }
            Bump::Tent => {
                let size = self.sheet.call(Function::Size, &[u]);
                let height = self.sheet.sum(&[(&Value::ONE, &Value::ONE), (&size, &number(-0.5))]);
                self.sheet.call(Function::Most, &[&height, &Value::ZERO])
            }
            Bump::Wave => {
                let size = self.sheet.call(Function::Size, &[u]);
                let angle = self.sheet.times(u, &number(PI / 2.5));
                let cosine = self.sheet.call(Function::Cosine, &[&angle]);
                let height = self.sheet.sum(&[(&number(0.5), &Value::ONE), (&cosine, &number(0.5))]);
                self.sheet.call(Function::Choice, &[&number(2.5), &size, &Value::ZERO, &height])
            }
        }
    }

    fn hats(&mut self, value: &Value, knots: &[f64]) -> Vec<Value> {
        let (Some(first), Some(last)) = (knots.first(), knots.last()) else { return Vec::new() };
        let value = self.sheet.call(Function::Most, &[value, &number(*first)]);
        let value = self.sheet.call(Function::Least, &[&value, &number(*last)]);
        let mut hats = Vec::new();
        for k in 1..knots.len() {
            let slope = 1.0 / (knots[k] - knots[k - 1]);
            let up = self.sheet.sum(&[(&value, &number(slope)), (&number(-knots[k - 1] * slope), &Value::ONE)]);
            let up = self.sheet.call(Function::Most, &[&up, &Value::ZERO]);
            let down = knots.get(k + 1).map_or(Value::ONE, |next| {
                let slope = 1.0 / (next - knots[k]);
                let down = self.sheet.sum(&[(&value, &number(-slope)), (&number(next * slope), &Value::ONE)]);
                self.sheet.call(Function::Most, &[&down, &Value::ZERO])
            });
            hats.push(self.sheet.call(Function::Choice, &[&number(knots[k]), &value, &down, &up]));
        }
        hats
    }

    fn values_of_gravity(&mut self, driver: &Driver, standing: &Standing, loads: &Loads) -> Vec<Value> {
        match driver {
            Driver::Torque(joint) => vec![self.torque(loads, *joint)],
            Driver::TorqueTerms(joint, links) => {
                let gravity = triple(&self.model.masses.gravity);
                let lever = self.sheet.cross(&gravity, &loads.along[*joint]);
                let mut values = Vec::new();
                for (link, across) in links {
                    for direction in across {
                        let direction = self.sheet.turned(&standing.after[*link], &triple(direction));
                        values.push(self.sheet.dot(&lever, &direction));
                    }
                }
                values
            }
            Driver::SprungTorque(joint) => {
                let value = self.read(*joint);
                let (sine, cosine) =
                    (self.sheet.call(Function::Sine, &[&value]), self.sheet.call(Function::Cosine, &[&value]));
                vec![self.torque(loads, *joint), sine, cosine]
            }
            Driver::HardeningTorque(joint, knee) => {
                let torque = self.torque(loads, *joint);
                let size = self.sheet.call(Function::Size, &[&torque]);
                let below = self.sheet.sum(&[(&Value::ONE, &Value::ONE), (&size, &number(1.0 / knee))]);
                let level = self.sheet.over(&torque, &below);
                vec![torque, level]
            }
            Driver::MomentAcross(joint, across) => {
                let moment = self.moment(loads, *joint);
                let along = &loads.along[*joint];
                let part = self.sheet.dot(along, &moment).negated();
                let rest = self.sheet.add_scaled(&moment, along, &part);
                let seen = self.sheet.turned_back(&standing.before[*joint], &rest);
                across.iter().map(|direction| self.sheet.dot(&seen, &triple(direction))).collect()
            }
            Driver::Cantilever { joint, next, reach, twist_to_bend } => self.cantilever(
                &standing.after[*joint],
                next.map(|next| (&loads.force[next], &loads.moment[next])),
                reach,
                *twist_to_bend,
            ),
            Driver::EndMoment(joint, next) => {
                let Some(next) = next else { return zeros().to_vec() };
                self.sheet.turned_back(&standing.after[*joint], &loads.moment[*next]).to_vec()
            }
            Driver::Overturning(along) => {
                let Some(start) = self.model.masses.starts.first().filter(|_| !loads.force.is_empty()) else {
                    return along.iter().map(|_| Value::ZERO).collect();
                };
                let lever = start.cross(&loads.force[0]);
                let moment = self.sheet.add(&loads.moment[0], &triple(&lever));
                along.iter().map(|direction| self.sheet.dot(&moment, &triple(direction))).collect()
            }
            Driver::GravitySide(joint) => {
                let torque = self.torque(loads, *joint);
                vec![self.choice(&torque, &Value::ZERO, -1.0, 1.0)]
            }
            Driver::FrictionSide(joint, side, friction) => {
                let torque = self.torque(loads, *joint);
                let left = self.sheet.sum(&[(&torque, &Value::ONE), (&number(-friction), &Self::read_input(*side))]);
                vec![self.choice(&left, &Value::ZERO, -1.0, 1.0)]
            }
            Driver::LoadedSide(joint, side) => {
                let torque = self.torque(loads, *joint);
                let size = self.sheet.call(Function::Size, &[&torque]);
                vec![self.sheet.times(&Self::read_input(*side), &size)]
            }
            _ => unreachable!("what needs no posture has its values before"),
        }
    }

    fn cantilever(
        &mut self,
        after: &Frame,
        load: Option<(&Vector3<f64>, &Triple)>,
        reach: &Vector3<f64>,
        twist_to_bend: f64,
    ) -> Vec<Value> {
        let length = reach.norm();
        let Some((force, moment)) = load.filter(|_| length > 0.0) else { return vec![Value::ZERO; 6] };
        let force = self.sheet.turned_back(after, &triple(force));
        let torque = self.sheet.turned_back(after, moment);
        let (along, reach) = (triple(&(reach / length)), triple(reach));
        let part = self.sheet.dot(&along, &torque);
        let twist = self.sheet.scale(&along, &part);
        let bend = self.sheet.subtract(&torque, &twist);
        let both = self.sheet.add_scaled(&bend, &twist, &number(twist_to_bend));
        let both = self.sheet.scale(&both, &number(length));
        let lever = self.sheet.cross(&reach, &force);
        let turn = self.sheet.add_scaled(&both, &lever, &number(0.5 * length));
        let part = self.sheet.dot(&along, &force).negated();
        let across = self.sheet.add_scaled(&force, &along, &part);
        let sunk = self.sheet.scale(&across, &number(length.powi(3) / 3.0));
        let leant = self.sheet.cross(&bend, &reach);
        let shift = self.sheet.add_scaled(&sunk, &leant, &number(0.5 * length));
        turn.into_iter().chain(shift).collect()
    }

    /// Adds the contributions of a set of effects to `twists`.
    fn act(&mut self, twists: &mut [Twist], standing: Option<&(Standing, Loads)>, which: impl Fn(&Driver) -> bool) {
        let model = self.model;
        // Of each component all that adds to it.
        let mut sums: Vec<[Vec<(Value, Value)>; 6]> = twists.iter().map(|_| Default::default()).collect();
        for term in model.terms.iter().filter(|term| which(&term.driver)) {
            let values = self.values(&term.driver, standing);
            for moved in &term.moves {
                if let Action::Twist { slot, twist } = &moved.action {
                    let amount = term.coefficients[moved.coefficient];
                    for row in 0..6 {
                        sums[*slot][row].push((number(amount * twist[row]), values[moved.value].clone()));
                    }
                }
            }
        }
        for (twist, sums) in twists.iter_mut().zip(sums) {
            for (value, parts) in twist.iter_mut().zip(sums) {
                let own = (value.clone(), Value::ONE);
                let parts: Vec<_> = gathered(parts).into_iter().chain([own]).collect();
                *value = self.sheet.sum(&parts.iter().map(|(a, b)| (a, b)).collect::<Vec<_>>());
            }
        }
    }

    /// What curves do; their waves are kept under the names of [`waves`].
    fn curve(&mut self, index: usize, twists: &mut [Twist], table: usize) {
        let curve = &self.model.curves[index];
        let wave = self.waves(index);
        let name = format!("curve{index}");
        self.sheet.statements.push(wave);
        let (array, count) = (waves(index), curve.weights.len());
        self.sheet.statements.push(Statement::Weighted { name: name.clone(), array, count, table });
        let (value, unit) = (Value::named(name), self.model.joints[curve.joint].screw.twist());
        for row in 0..6 {
            let own = twists[curve.joint][row].clone();
            twists[curve.joint][row] = self.sheet.sum(&[(&own, &Value::ONE), (&value, &number(unit[row]))]);
        }
    }

    fn waves(&mut self, index: usize) -> Statement {
        let curve = &self.model.curves[index];
        let reading = self.read(curve.joint);
        let inside = self.inside(curve);
        let angle = match curve.interval {
            Some((low, width)) => {
                self.sheet.sum(&[(&reading, &number(PI / width)), (&number(-low * (PI / width)), &Value::ONE)])
            }
            None => reading,
        };
        Statement::Waves {
            array: waves(index),
            count: curve.weights.len(),
            angle,
            inside,
            turns: curve.interval.is_none(),
        }
    }

    /// 1 where a curve has waves, else 0.
    fn inside(&mut self, curve: &Curve) -> Value {
        let reading = self.read(curve.joint);
        let Some((low, width)) = curve.interval else { return Value::ONE };
        self.between(&reading, low, low + width)
    }

    fn between(&mut self, value: &Value, low: f64, high: f64) -> Value {
        let above = self.choice(value, &number(low), 0.0, 1.0);
        let below = self.choice(&number(high), value, 0.0, 1.0);
        self.sheet.times(&above, &below)
    }
}

impl Model {
    fn joints_read(&self, joint: usize) -> &denavit_model::ChainJoint {
        &self.read[joint]
    }
}

fn waves(curve: usize) -> String {
    format!("w{curve}")
}

/// The same sum with one part for each value.
fn gathered(parts: Vec<(Value, Value)>) -> Vec<(Value, Value)> {
    let mut together: Vec<(f64, Value)> = Vec::new();
    for (amount, value) in parts {
        let Value::Number(amount) = amount else { continue };
        match together.iter_mut().find(|(_, known)| *known == value) {
            Some((sum, _)) => *sum += amount,
            None => together.push((amount, value)),
        }
    }
    together.into_iter().map(|(amount, value)| (number(amount), value)).collect()
}

impl Correction {
    /// Of effects. `tiny`: what keeps the square of an angle of 0 off 0; `damping`: a share of the largest square of a step.
    pub fn of(effects: &Effects, tiny: f64, damping: f64) -> Self {
        let model = &effects.model;
        let bends = model.terms.iter().any(|term| term.driver.needs_posture());
        let feels = model.terms.iter().any(|term| term.driver.feels_gravity());
        let mut tables: Vec<Table> =
            model.curves.iter().enumerate().map(|(index, curve)| Table::weights(index, &curve.weights)).collect();
        let (mut steady, mut bend, mut places) = (None, None, Vec::new());
        if bends {
            let mut lowering = Lowering::new(model, tiny);
            let mut twists = lowering.nothing();
            lowering.steady(&mut twists);
            places = acted_on(&twists, model);
            steady = Some(lowering.part(places.iter().map(|(slot, row)| twists[*slot][*row].clone()).collect()));
            let mut lowering = Lowering::new(model, tiny);
            let given = lowering.named("t", &places);
            let standing = lowering.standing(&given);
            let loads = lowering.loads(&standing);
            let mut twists = lowering.named("steady", &places);
            // Where only effects of the posture act, the steady part is 0.
            lowering.act(&mut twists, Some(&(standing, loads)), Driver::needs_posture);
            bend = Some(lowering.part(places.iter().map(|(slot, row)| twists[*slot][*row].clone()).collect()));
        }
        let mut lowering = Lowering::new(model, tiny);
        let twists = if bends {
            lowering.named("t", &places)
        } else {
            let mut twists = lowering.nothing();
            lowering.steady(&mut twists);
            twists
        };
        let (frame, numbers) = match &effects.averaged {
            None => {
                let frame = lowering.standing(&twists).tip;
                (frame, 0)
            }
            Some(averaged) => {
                let at = lowering.named("at", &places);
                lowering.blend(effects, averaged, &twists, &at, &mut tables)
            }
        };
        let outputs = (0..3).flat_map(|row| frame.row(row).into_iter().chain([frame.origin[row].clone()])).collect();
        let reach = lowering.part(outputs);
        let passes = if feels { MOST_PASSES } else { 0 };
        Self { steady, bend, passes, reach, twists: places.len(), tables, numbers, step: step(effects, tiny, damping) }
    }
}

/// The components of twists that some effect changes.
fn acted_on(steady: &[Twist], model: &Model) -> Vec<(usize, usize)> {
    let mut places = BTreeSet::new();
    for (slot, twist) in steady.iter().enumerate() {
        places.extend((0..6).filter(|row| !is_zero(&twist[*row..=*row])).map(|row| (slot, row)));
    }
    for term in model.terms.iter().filter(|term| term.driver.needs_posture()) {
        for moved in &term.moves {
            if let Action::Twist { slot, twist } = &moved.action {
                let amount = term.coefficients[moved.coefficient];
                places.extend((0..6).filter(|row| amount * twist[*row] != 0.0).map(|row| (*slot, row)));
            }
        }
    }
    places.into_iter().collect()
}

impl Lowering<'_> {
    fn steady(&mut self, twists: &mut [Twist]) {
        self.act(twists, None, |driver| !driver.needs_posture());
        for index in 0..self.model.curves.len() {
            self.curve(index, twists, index);
        }
    }

    /// The blend of an averaged prediction with plain geometry and the drawing, and how many numbers z has.
    fn blend(
        &mut self,
        effects: &Effects,
        averaged: &Averaged,
        twists: &[Twist],
        at: &[Twist],
        tables: &mut Vec<Table>,
    ) -> (Frame, usize) {
        let model = self.model;
        let bends = model.terms.iter().any(|term| term.driver.needs_posture());
        let stood = bends.then(|| {
            let standing = self.standing(at);
            let loads = self.loads(&standing);
            (standing, loads)
        });
        let values: Vec<Vec<Value>> =
            model.terms.iter().map(|term| self.values(&term.driver, stood.as_ref())).collect();
        let robot = self.standing(twists);
        let target = triple(&averaged.target);
        let tip = Frame::of(&averaged.placed[1]);
        let on_tip = (averaged.placed[1] * Point3::from(averaged.target)).coords;
        let p = self.sheet.point(&robot.tip, &triple(&on_tip));
        let numbers = self.numbers(averaged, &values, &robot, &p);
        let unsure = self.unsure(averaged, &numbers, &robot, &p, tables);
        // From the tip of the geometric robot.
        let plain = self.chain(&averaged.geometric, &averaged.home);
        let from_plain = self.sheet.inverse(&plain);
        let base = Frame::of(&averaged.placed[0]);
        let seen = self.sheet.compose(&from_plain, &base);
        let placed = self.sheet.compose(&robot.tip, &tip);
        let to_averaged = self.sheet.compose(&seen, &placed);
        let read = self.read_of_target(averaged, &values, &robot, &p);
        let apart = self.sheet.point(&seen, &read);
        let apart = self.sheet.subtract(&apart, &target);
        let drawn = self.chain(&model.joints, &model.home);
        let drawn = self.sheet.compose(&Frame::of(&averaged.drawn[0]), &drawn);
        let drawn = self.sheet.compose(&drawn, &Frame::of(&averaged.drawn[1]));
        let to_drawn = self.sheet.compose(&from_plain, &drawn);
        let shares = self.shares(averaged, &unsure, &apart);
        let (first, second) = (self.sheet.log(&to_averaged, self.tiny), self.sheet.log(&to_drawn, self.tiny));
        let mut step = self.nothing()[0].clone();
        for row in 0..6 {
            step[row] = self.sheet.sum(&[(&first[row], &shares[0]), (&second[row], &shares[1])]);
        }
        let step = self.sheet.exp(&step, self.tiny);
        let reached = self.chain(effects.chain.joints(), &averaged.home);
        let reached = self.sheet.compose(&reached, &step);
        let rest = averaged.home.inverse() * effects.chain.home();
        (self.sheet.compose(&reached, &Frame::of(&rest)), unsure.length)
    }

    fn chain(&mut self, joints: &[denavit_model::ChainJoint], home: &denavit_model::Pose) -> Frame {
        let mut reached = Frame::identity();
        for joint in joints {
            let value = self.sheet.joint_value(joint);
            let motion = self.sheet.motion(&joint.screw, &value);
            reached = self.sheet.compose(&reached, &motion);
        }
        self.sheet.compose(&reached, &Frame::of(home))
    }

    /// Shares of the averaged robot and of the drawn one.
    fn shares(&mut self, averaged: &Averaged, unsure: &Unsure, apart: &Triple) -> [Value; 2] {
        let sheet = &mut self.sheet;
        let [of_geometry, among_rows] = averaged.of_geometry.map(number);
        let third = number(1.0 / 3.0);
        let more = sheet.minus(&unsure.of_geometry, &among_rows);
        let more = sheet.call(Function::Most, &[&more, &Value::ZERO]);
        let whole = sheet.plus(&of_geometry, &more);
        let below = sheet.sum(&[(&of_geometry, &Value::ONE), (&unsure.of_all, &number(1.0 / averaged.across))]);
        let share = sheet.over(&of_geometry, &below);
        let share = sheet.call(Function::Choice, &[&Value::ZERO, &unsure.of_all, &share, &Value::ZERO]);
        let square = sheet.dot(apart, apart);
        let square = sheet.times(&square, &third);
        let variance = mixed(sheet, &share, [&unsure.of_all, &whole], &square);
        let of_drawing = sheet.plus(&number(averaged.of_drawing), &unsure.of_placement);
        let ratio = sheet.over(&of_drawing, &variance);
        let ratio = sheet.times(&ratio, &number(averaged.far_more.powi(2)));
        let below = sheet.sum(&[(&ratio, &ratio), (&Value::ONE, &Value::ONE)]);
        let drawn = sheet.over(&Value::ONE, &below);
        let mut inside = Value::ONE;
        for (index, (low, high)) in averaged.ranges.iter().enumerate() {
            let own = self.between(&Value::named(format!("q[{index}]")), *low, *high);
            inside = self.sheet.times(&inside, &own);
        }
        let outside = self.sheet.minus(&Value::ONE, &inside);
        let drawn = self.sheet.times(&drawn, &outside);
        let rest = self.sheet.minus(&Value::ONE, &drawn);
        let drawn = self.sheet.call(Function::Choice, &[&Value::ZERO, &unsure.of_all, &drawn, &Value::ZERO]);
        [self.sheet.times(&share, &rest), drawn]
    }

    /// The reading error of a target at `p`, by an instrument's scale and along its line of sight.
    fn by_instrument(
        &mut self,
        averaged: &Averaged,
        p: &Triple,
        tip: &Frame,
        scale: &Value,
        sight: &(Triple, Value),
    ) -> Triple {
        let Some(instrument) = &averaged.instrument else { return zeros() };
        let there = self.sheet.point(&Frame::of(instrument), p);
        let back = Frame::of(&instrument.inverse());
        let seen = self.sheet.turned(&back, &there);
        let mut beyond = self.sheet.scale(&seen, scale);
        if !(is_zero(&sight.0) && is_zero(std::slice::from_ref(&sight.1))) {
            let square = self.sheet.dot(&there, &there);
            let length = self.sheet.call(Function::Root, &[&square]);
            let inverse = self.sheet.call(Function::Inverse, &[&length]);
            let along = self.sheet.scale(&seen, &inverse);
            let turning = self.sheet.turned(tip, &sight.0);
            let part = self.sheet.dot(&turning, &along);
            let part = self.sheet.plus(&part, &sight.1);
            beyond = self.sheet.add_scaled(&beyond, &along, &part);
        }
        beyond
    }

    /// The reading of the target, base frame of the averaged robot.
    fn read_of_target(&mut self, averaged: &Averaged, values: &[Vec<Value>], robot: &Standing, p: &Triple) -> Triple {
        let (mut target, mut scale, mut turning, mut steady) = (zeros(), Value::ZERO, zeros(), Value::ZERO);
        for (term, values) in self.model.terms.iter().zip(values) {
            for moved in &term.moves {
                let amount = number(term.coefficients[moved.coefficient]);
                let amount = self.sheet.times(&values[moved.value], &amount);
                match &moved.action {
                    Action::Twist { .. } => {}
                    Action::Target(shift) => target = self.sheet.add_scaled(&target, &triple(shift), &amount),
                    Action::Scale => scale = self.sheet.plus(&scale, &amount),
                    Action::Sight(turns, stays) => {
                        turning = self.sheet.add_scaled(&turning, &triple(turns), &amount);
                        steady = self.sheet.sum(&[(&steady, &Value::ONE), (&number(*stays), &amount)]);
                    }
                }
            }
        }
        let shift = self.sheet.turned(&robot.tip, &target);
        let read = self.sheet.add(p, &shift);
        let beyond = self.by_instrument(averaged, p, &robot.tip, &scale, &(turning, steady));
        self.sheet.add(&read, &beyond)
    }

    /// Derivative of the target's reading by each coefficient.
    fn numbers(&mut self, averaged: &Averaged, values: &[Vec<Value>], robot: &Standing, p: &Triple) -> Vec<Triple> {
        let model = self.model;
        let mut numbers = Vec::new();
        let frames: Vec<Frame> = robot.before.iter().chain(robot.after.last()).cloned().collect();
        let local: Vec<Triple> = frames
            .iter()
            .map(|frame| {
                let away = self.sheet.subtract(p, &frame.origin);
                self.sheet.turned_back(frame, &away)
            })
            .collect();
        for (Term { coefficients, moves, .. }, values) in model.terms.iter().zip(values) {
            for coefficient in 0..coefficients.len() {
                let mut reads = zeros();
                for moved in moves.iter().filter(|moved| moved.coefficient == coefficient) {
                    let value = &values[moved.value];
                    let by = match &moved.action {
                        Action::Twist { slot, twist } => self.sheet.moved(&frames[*slot], &local[*slot], twist),
                        Action::Target(shift) => self.sheet.turned(&robot.tip, &triple(shift)),
                        Action::Scale => {
                            self.by_instrument(averaged, p, &robot.tip, &Value::ONE, &(zeros(), Value::ZERO))
                        }
                        Action::Sight(turns, stays) => {
                            let sight = (triple(turns), number(*stays));
                            self.by_instrument(averaged, p, &robot.tip, &Value::ZERO, &sight)
                        }
                    };
                    reads = self.sheet.add_scaled(&reads, &by, value);
                }
                numbers.push(reads);
            }
        }
        numbers
    }

    /// v(q) of everything, of geometry alone, and of the places of instrument and target in that.
    fn unsure(
        &mut self,
        averaged: &Averaged,
        numbers: &[Triple],
        robot: &Standing,
        p: &Triple,
        tables: &mut Vec<Table>,
    ) -> Unsure {
        let model = self.model;
        let [all, geometry] = &averaged.spreads;
        let of_curves: usize = model.curves.iter().map(|curve| curve.weights.len()).sum();
        // Waves first, then what only the first knows, then what both do: geometry's are the last ones.
        let kept = |number: &usize| all.kept.contains(number) && !geometry.kept.contains(number);
        let mut order: Vec<usize> = (numbers.len()..numbers.len() + of_curves).collect();
        order.extend((0..numbers.len()).filter(kept));
        let first = order.len();
        order.extend(&geometry.kept);
        let beside = all.covariance.nrows() - all.kept.len();
        let length = order.len() + beside;
        let mut place = 0;
        let mut beyond = Value::ZERO;
        for (index, curve) in model.curves.iter().enumerate() {
            let before = &robot.before[curve.joint];
            let away = self.sheet.subtract(p, &before.origin);
            let local = self.sheet.turned_back(before, &away);
            let by = self.sheet.moved(before, &local, &model.joints[curve.joint].screw.twist());
            if self.sheet.statements.iter().all(|statement| !statement.assigns().contains(&waves(index).as_str())) {
                let wave = self.waves(index);
                self.sheet.statements.push(wave);
            }
            for (axis, by) in by.iter().enumerate() {
                let (array, count, by) = (waves(index), curve.weights.len(), by.clone());
                self.sheet.statements.push(Statement::Scatter { axis, first: place, array, count, by });
            }
            place += curve.weights.len();
            let inside = self.inside(curve);
            let outside = self.sheet.minus(&Value::ONE, &inside);
            let square = self.sheet.dot(&by, &by);
            beyond = self.sheet.sum(&[(&beyond, &Value::ONE), (&outside, &square)]);
        }
        let beyond = self.sheet.times(&beyond, &number(averaged.of_curves / 3.0));
        let mut columns: Vec<Triple> = order[place..].iter().map(|number| numbers[*number].clone()).collect();
        if averaged.instrument.is_some() {
            let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
            for axis in axes {
                columns.push(self.sheet.cross(&triple(&axis), p));
            }
            columns.extend(axes.iter().map(triple));
        }
        columns.extend(robot.tip.columns.clone());
        for (column, values) in columns.into_iter().enumerate() {
            for (axis, value) in values.into_iter().enumerate() {
                self.sheet.statements.push(Statement::Store { axis, index: place + column, value });
            }
        }
        let mut squares = |spread: &crate::effects::Spread, first: usize, numbers: &[usize]| {
            let table = factor(tables.len(), spread, numbers, beside);
            if table.values.iter().all(|value| *value == 0.0) {
                return Value::ZERO;
            }
            let name = format!("v{}", tables.len());
            tables.push(table);
            self.sheet.statements.push(Statement::Squares { name: name.clone(), first, table: tables.len() - 1 });
            Value::named(name)
        };
        let of_all = squares(all, 0, &order);
        let of_geometry = squares(geometry, first, &order[first..]);
        let of_placement = squares(geometry, order.len(), &[]);
        let of_all = self.sheet.plus(&of_all, &beyond);
        Unsure { of_all, of_geometry, of_placement, length }
    }
}

struct Unsure {
    of_all: Value,
    of_geometry: Value,
    of_placement: Value,
    /// How many numbers there are.
    length: usize,
}

/// Σ wᵢ vᵢ + w₁ w₂ apart.
fn mixed(sheet: &mut Sheet, share: &Value, [first, second]: [&Value; 2], apart: &Value) -> Value {
    let rest = sheet.minus(&Value::ONE, share);
    let both = sheet.times(share, &rest);
    sheet.sum(&[(share, first), (&rest, second), (&both, apart)])
}

/// The least-squares step, and the error of the tip.
fn step(effects: &Effects, tiny: f64, damping: f64) -> Part {
    let mut sheet = Sheet::default();
    let n = effects.chain.coordinates().len();
    let lever = number(effects.chain.size() * if n < 6 { LEVER_OF_FEW } else { LEVER });
    let frame = |name: &str| {
        let cell = |row: usize, column: usize| Value::named(format!("{name}[{row}][{column}]"));
        let column = |column: usize| [0, 1, 2].map(|row| cell(row, column));
        Frame { columns: [0, 1, 2].map(column), origin: column(3) }
    };
    let (target, pose) = (frame("target"), frame("pose"));
    // Rotation of the target in that of the pose, base frame: R Pᵀ.
    let back = Frame { columns: [0, 1, 2].map(|row| pose.row(row)), origin: zeros() };
    let between =
        Frame { columns: [0, 1, 2].map(|column: usize| sheet.turned(&target, &back.columns[column])), origin: zeros() };
    let turn = sheet.rotation_vector(&between, tiny);
    let turn = sheet.scale(&turn, &lever);
    let shift = sheet.subtract(&target.origin, &pose.origin);
    let left: Vec<Value> = turn.into_iter().chain(shift).collect();
    let rows: Vec<Vec<Value>> = (0..6)
        .map(|row| {
            let weight = if row < 3 { lever.clone() } else { Value::ONE };
            (0..n).map(|column| sheet.times(&Value::named(format!("jacobian[{row}][{column}]")), &weight)).collect()
        })
        .collect();
    let columns: Vec<Vec<Value>> = (0..n).map(|column| rows.iter().map(|row| row[column].clone()).collect()).collect();
    // JᵀJ x = Jᵀ e, or of more joints J Jᵀ y = e and x = Jᵀ y.
    let vectors = if n > 6 { &rows } else { &columns };
    let product = |sheet: &mut Sheet, a: &[Value], b: &[Value]| sheet.sum(&a.iter().zip(b).collect::<Vec<_>>());
    let wanted: Vec<Value> =
        if n > 6 { left.clone() } else { columns.iter().map(|column| product(&mut sheet, column, &left)).collect() };
    let size = vectors.len();
    let mut matrix: Vec<Vec<Value>> =
        (0..size).map(|i| (0..=i).map(|k| product(&mut sheet, &vectors[i], &vectors[k])).collect()).collect();
    let trace = matrix.iter().enumerate().map(|(i, row)| (row[i].clone(), number(damping))).collect::<Vec<_>>();
    let trace = sheet.sum(&trace.iter().map(|(a, b)| (a, b)).collect::<Vec<_>>());
    for (i, row) in matrix.iter_mut().enumerate() {
        row[i] = sheet.plus(&row[i], &trace);
    }
    let solved = solved(&mut sheet, &matrix, &wanted);
    let steps: Vec<Value> =
        if n > 6 { columns.iter().map(|column| product(&mut sheet, column, &solved)).collect() } else { solved };
    let square = product(&mut sheet, &left, &left);
    let off = sheet.call(Function::Root, &[&square]);
    Part { statements: sheet.statements, outputs: steps.into_iter().chain([off]).collect() }
}

/// A x = b by L D Lᵀ; of A the lower triangle.
fn solved(sheet: &mut Sheet, matrix: &[Vec<Value>], wanted: &[Value]) -> Vec<Value> {
    let n = matrix.len();
    // M = L D; of L the lower triangle.
    let (mut l, mut m, mut inverse) = (vec![Vec::<Value>::new(); n], vec![Vec::<Value>::new(); n], Vec::new());
    for i in 0..n {
        for k in 0..=i {
            let less: Vec<(Value, Value)> = (0..k)
                .map(|j| (m[i][j].clone().negated(), if k == i { l[i][j].clone() } else { l[k][j].clone() }))
                .collect();
            let parts: Vec<(&Value, &Value)> =
                std::iter::once((&matrix[i][k], &Value::ONE)).chain(less.iter().map(|(a, b)| (a, b))).collect();
            let value = sheet.sum(&parts);
            if k == i {
                inverse.push(sheet.call(Function::Inverse, &[&value]));
            } else {
                let own: Value = sheet.times(&value, &inverse[k]);
                m[i].push(value);
                l[i].push(own);
            }
        }
    }
    let mut forward: Vec<Value> = Vec::new();
    for i in 0..n {
        let less: Vec<(Value, Value)> = (0..i).map(|k| (l[i][k].clone().negated(), forward[k].clone())).collect();
        let parts: Vec<(&Value, &Value)> =
            std::iter::once((&wanted[i], &Value::ONE)).chain(less.iter().map(|(a, b)| (a, b))).collect();
        forward.push(sheet.sum(&parts));
    }
    let mut back: Vec<Value> = vec![Value::ZERO; n];
    for i in (0..n).rev() {
        let own = sheet.times(&forward[i], &inverse[i]);
        let less: Vec<(Value, Value)> = (i + 1..n).map(|k| (l[k][i].clone().negated(), back[k].clone())).collect();
        let parts: Vec<(&Value, &Value)> =
            std::iter::once((&own, &Value::ONE)).chain(less.iter().map(|(a, b)| (a, b))).collect();
        back[i] = sheet.sum(&parts);
    }
    back
}
