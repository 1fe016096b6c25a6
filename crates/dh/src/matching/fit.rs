//! robot(u) = B · vendor(sense u + zero) · E as a least squares problem over B, E, the zeros and the table's numbers.

use super::axes::Axis;
use super::vendor::{DhNumber, VendorRow, VendorTable};
use crate::conventions::{Convention, RowLabel};
use crate::table::{DhRow, HayatiRow, Motion};
use denavit_model::nalgebra::{DMatrix, DVector, Vector3, Vector6};
use denavit_model::se3::{self, Pose, adjoint_times};

/// The vendor's table as the product of its elementary motions, whatever its convention.
#[derive(Debug, Clone)]
pub(crate) struct Product {
    elements: Vec<Element>,
    /// Which number of which row, in the order of the product.
    pub places: Vec<(RowLabel, DhNumber)>,
    pub motions: Vec<Motion>,
}

#[derive(Debug, Clone, Copy)]
enum Element {
    Number(usize),
    Motion(usize),
}

/// What a fit finds.
#[derive(Debug, Clone)]
pub(crate) struct State {
    pub base: Pose,
    pub tool: Pose,
    pub zeros: Vec<f64>,
    pub numbers: Vec<f64>,
}

/// What a fit may change.
#[derive(Debug, Clone)]
pub(crate) struct Free {
    pub base: bool,
    pub tool: bool,
    pub zeros: Vec<bool>,
    pub numbers: Vec<bool>,
}

/// A configuration of the robot, and where its tip is then.
pub(crate) struct Sample {
    pub values: Vec<f64>,
    pub tip: Pose,
}

/// The problem, apart from the free parameters.
pub(crate) struct Fit<'a> {
    pub product: &'a Product,
    pub senses: &'a [f64],
    pub samples: &'a [Sample],
    /// The robot's size, m.
    pub size: f64,
    /// Least damping, relative to the diagonal: how well determined a direction must be to be followed.
    pub damping: f64,
    /// The least share that the sum of squares must fall by in a step: [`AT_ITS_LEAST`] or [`GOES_NOWHERE`].
    pub falls: f64,
}

/// A rotation error of 1 rad weighs as this many times the robot's size.
const ROTATION_WEIGHT: f64 = 0.25;

/// Residuals below this many times the robot's size are rounding; following them would only change what is not determined.
const ROUNDING: f64 = 3e-14;

/// Steps of a fit at most.
const STEPS: usize = 40;

/// A sum of squares that falls by less than this fraction in a step is at its minimum.
pub(crate) const AT_ITS_LEAST: f64 = 1e-5;

/// A sum of squares that falls by less than this fraction in a step will not reach 0, which is enough to choose by.
pub(crate) const GOES_NOWHERE: f64 = 0.02;

impl Product {
    /// The product and its numbers.
    pub fn of(table: &VendorTable) -> (Self, Vec<f64>) {
        let mut product = Self { elements: Vec::new(), places: Vec::new(), motions: Vec::new() };
        let mut numbers = Vec::new();
        if let Some(row) = &table.base {
            product.row(RowLabel::Base, row, table.convention, &mut numbers);
        }
        for (index, joint) in table.joints.iter().enumerate() {
            product.motions.push(joint.motion);
            product.row(RowLabel::Joint(index), &joint.row, table.convention, &mut numbers);
        }
        if let Some(row) = &table.tool {
            product.row(RowLabel::Tool, row, table.convention, &mut numbers);
        }
        (product, numbers)
    }

    fn row(&mut self, label: RowLabel, row: &VendorRow, convention: Convention, numbers: &mut Vec<f64>) {
        use DhNumber::{A, Alpha, Beta, D, Theta};
        let motion = match label {
            RowLabel::Joint(index) => Some(Element::Motion(index)),
            _ => None,
        };
        let order: [&[DhNumber]; 2] = match convention {
            Convention::Proximal => [&[Alpha, A], &[Theta, D]],
            // Four numbers where d is 0, else five.
            _ if row.beta.is_some() && row.d.as_ref().is_none_or(|d| d.value == 0.0) => [&[], &[Theta, A, Alpha, Beta]],
            _ if row.beta.is_some() => [&[], &[Theta, D, A, Alpha, Beta]],
            _ => [&[], &[Theta, D, Alpha, A]],
        };
        for (part, which) in order.iter().enumerate() {
            if part == 1 {
                self.elements.extend(motion);
            }
            for number in *which {
                if let Some(value) = row.number(*number) {
                    self.elements.push(Element::Number(self.places.len()));
                    self.places.push((label, *number));
                    numbers.push(value.value);
                }
            }
        }
    }

    /// The joints' axes at joint values `zeros`, in the table's own base frame.
    pub fn axes(&self, numbers: &[f64], zeros: &[f64]) -> Vec<Axis> {
        let mut axes = Vec::new();
        self.walk(&self.steps(numbers), zeros, Pose::identity(), |element, reached| {
            if let Element::Motion(index) = element {
                axes.push(Axis {
                    direction: reached.rotation.matrix().column(2).into_owned(),
                    point: reached.translation.vector,
                    turns: !matches!(self.motions[index], Motion::Prismatic),
                });
            }
        });
        axes
    }

    /// The product at the joint values `values`.
    pub fn pose(&self, numbers: &[f64], values: &[f64]) -> Pose {
        self.walk(&self.steps(numbers), values, Pose::identity(), |_, _| {})
    }

    /// The motion that each number stands for; they are the same in every configuration.
    fn steps(&self, numbers: &[f64]) -> Vec<Pose> {
        self.places.iter().zip(numbers).map(|((_, number), value)| elementary(*number, *value)).collect()
    }

    fn walk(&self, steps: &[Pose], values: &[f64], start: Pose, mut at: impl FnMut(Element, &Pose)) -> Pose {
        let mut reached = start;
        for element in &self.elements {
            at(*element, &reached);
            reached *= match *element {
                Element::Number(index) => steps[index],
                Element::Motion(index) => self.motions[index].pose(values[index]),
            };
        }
        reached
    }

    /// The constant motions between the joints: one more than joints.
    fn links(&self, numbers: &[f64]) -> Vec<Pose> {
        let mut links = vec![Pose::identity()];
        for element in &self.elements {
            match *element {
                Element::Number(index) => {
                    if let Some(link) = links.last_mut() {
                        *link *= elementary(self.places[index].1, numbers[index]);
                    }
                }
                Element::Motion(_) => links.push(Pose::identity()),
            }
        }
        links
    }
}

fn elementary(number: DhNumber, value: f64) -> Pose {
    let none = DhRow::default();
    match number {
        DhNumber::Theta => DhRow { theta: value, ..none }.pose(),
        DhNumber::D => se3::translation(Vector3::z() * value),
        DhNumber::Alpha => DhRow { alpha: value, ..none }.pose(),
        DhNumber::A => se3::translation(Vector3::x() * value),
        DhNumber::Beta => HayatiRow { beta: value, ..HayatiRow::default() }.pose(),
    }
}

fn direction(number: DhNumber) -> Vector6<f64> {
    let index = match number {
        DhNumber::Theta => 2,
        DhNumber::D => 5,
        DhNumber::Alpha => 0,
        DhNumber::A => 3,
        DhNumber::Beta => 1,
    };
    let mut twist = Vector6::zeros();
    twist[index] = 1.0;
    twist
}

fn direction_of(motion: Motion) -> Vector6<f64> {
    match motion {
        Motion::Prismatic => direction(DhNumber::D),
        _ => direction(DhNumber::Theta) + direction(DhNumber::D) * motion.pitch(),
    }
}

impl Free {
    fn count(&self) -> usize {
        let flags = self.zeros.iter().chain(&self.numbers).filter(|free| **free).count();
        flags + 6 * (usize::from(self.base) + usize::from(self.tool))
    }
}

impl Fit<'_> {
    fn values(&self, state: &State, sample: &Sample) -> Vec<f64> {
        let joints = self.senses.iter().zip(&sample.values).zip(&state.zeros);
        joints.map(|((sense, value), zero)| sense * value + zero).collect()
    }

    /// base_from_tip of the state at every sample.
    fn poses<'s>(&'s self, state: &'s State, samples: &'s [Sample]) -> impl Iterator<Item = (&'s Sample, Pose)> {
        let mut links = self.product.links(&state.numbers);
        links[0] = state.base * links[0];
        samples.iter().map(move |sample| {
            let mut reached = links[0];
            for (joint, link) in links[1..].iter().enumerate() {
                let value = self.senses[joint] * sample.values[joint] + state.zeros[joint];
                reached *= self.product.motions[joint].pose(value) * link;
            }
            (sample, reached * state.tool)
        })
    }

    /// Largest position (m) and rotation (rad) error over samples.
    pub fn errors(&self, state: &State, samples: &[Sample]) -> (f64, f64) {
        let mut worst = (0.0f64, 0.0f64);
        for (sample, found) in self.poses(state, samples) {
            let (turned, moved) = se3::difference(&sample.tip, &found);
            worst = (worst.0.max(moved), worst.1.max(turned));
        }
        worst
    }

    /// Robot minus table: rotation vector (weighed, m) and tip position (m), in the base frame.
    fn residual(&self, sample: &Sample, found: &Pose) -> Vector6<f64> {
        let turned = se3::rotation_vector(&(sample.tip.rotation * found.rotation.inverse()));
        let turned = turned * (ROTATION_WEIGHT * self.size);
        let moved = sample.tip.translation.vector - found.translation.vector;
        Vector6::new(turned.x, turned.y, turned.z, moved.x, moved.y, moved.z)
    }

    fn sum_of_squares(&self, state: &State) -> f64 {
        self.poses(state, self.samples).map(|(sample, found)| self.residual(sample, &found).norm_squared()).sum()
    }

    /// The least-squares state near `start`: Levenberg-Marquardt, columns in closed form.
    pub fn solve(&self, start: State, free: &Free) -> State {
        let count = free.count();
        let enough = self.samples.len() as f64 * (ROUNDING * self.size).powi(2);
        let mut state = start;
        let mut sum = self.sum_of_squares(&state);
        let mut damping = 1e-4f64.max(self.damping);
        for _ in 0..STEPS {
            if sum <= enough || count == 0 {
                break;
            }
            let (normal, right) = self.normal_equations(&state, free);
            let mut falls = 0.0;
            while damping < 1e8 {
                let mut damped = normal.clone();
                for k in 0..count {
                    damped[(k, k)] += damping * normal[(k, k)] + f64::MIN_POSITIVE;
                }
                let trial = damped.cholesky().map(|factor| self.stepped(&state, free, &factor.solve(&right)));
                if let Some(trial) = trial {
                    let next = self.sum_of_squares(&trial);
                    if next < sum {
                        falls = (sum - next) / sum;
                        (state, sum) = (trial, next);
                        damping = (damping * 0.03).max(self.damping);
                        break;
                    }
                }
                damping *= 10.0;
            }
            if falls < self.falls {
                break;
            }
        }
        state
    }

    fn normal_equations(&self, state: &State, free: &Free) -> (DMatrix<f64>, DVector<f64>) {
        let count = free.count();
        let mut normal = DMatrix::zeros(count, count);
        let mut right = DVector::zeros(count);
        let mut columns: Vec<Vector6<f64>> = Vec::with_capacity(count);
        let steps = self.product.steps(&state.numbers);
        for sample in self.samples {
            columns.clear();
            let found = self.columns(state, &steps, free, sample, &mut columns);
            let residual = self.residual(sample, &found);
            let tip = found.translation.vector;
            for column in &mut columns {
                let omega = column.fixed_rows::<3>(0).into_owned();
                let moved = column.fixed_rows::<3>(3) + omega.cross(&tip);
                column.fixed_rows_mut::<3>(0).copy_from(&(omega * (ROTATION_WEIGHT * self.size)));
                column.fixed_rows_mut::<3>(3).copy_from(&moved);
            }
            for (i, column) in columns.iter().enumerate() {
                right[i] += column.dot(&residual);
                for (j, other) in columns[..=i].iter().enumerate() {
                    normal[(i, j)] += column.dot(other);
                }
            }
        }
        for i in 0..count {
            for j in 0..i {
                normal[(j, i)] = normal[(i, j)];
            }
        }
        (normal, right)
    }

    /// Space twists of what is free: base, zeros and numbers in the order of the product, tool.
    fn columns(
        &self,
        state: &State,
        steps: &[Pose],
        free: &Free,
        sample: &Sample,
        columns: &mut Vec<Vector6<f64>>,
    ) -> Pose {
        let unit = |index: usize| Vector6::from_fn(|row, _| f64::from(u8::from(row == index)));
        if free.base {
            columns.extend((0..6).map(unit));
        }
        let values = self.values(state, sample);
        let reached = self.product.walk(steps, &values, state.base, |element, reached| match element {
            Element::Number(index) if free.numbers[index] => {
                columns.push(adjoint_times(reached, &direction(self.product.places[index].1)));
            }
            Element::Motion(index) if free.zeros[index] => {
                columns.push(adjoint_times(reached, &direction_of(self.product.motions[index])));
            }
            _ => {}
        });
        if free.tool {
            columns.extend((0..6).map(|index| adjoint_times(&reached, &unit(index))));
        }
        reached * state.tool
    }

    fn stepped(&self, state: &State, free: &Free, step: &DVector<f64>) -> State {
        let mut next = state.clone();
        let mut at = 0;
        let mut take = |count: usize| {
            at += count;
            at - count
        };
        let six = |from: usize| Vector6::from_fn(|row, _| step[from + row]);
        let moved = |twist: Vector6<f64>, pose: &Pose| {
            let moved = se3::exp(&twist) * pose;
            se3::pose(se3::orthonormalised(&moved.rotation), moved.translation.vector)
        };
        if free.base {
            next.base = moved(six(take(6)), &state.base);
        }
        for element in &self.product.elements {
            match *element {
                Element::Number(index) if free.numbers[index] => next.numbers[index] += step[take(1)],
                Element::Motion(index) if free.zeros[index] => next.zeros[index] += step[take(1)],
                _ => {}
            }
        }
        if free.tool {
            next.tool = moved(six(take(6)), &state.tool);
        }
        next
    }
}
