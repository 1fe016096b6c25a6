//! Vectors, poses and twists of run-time values.

use crate::program::{Function, Sheet, Value};
use denavit_model::nalgebra::{Vector3, Vector6};
use denavit_model::{ChainJoint, Pose, Screw};

/// Three values.
pub type Triple = [Value; 3];

/// Six values `[omega; v]`.
pub type Twist = [Value; 6];

/// A pose: columns of its rotation, and where its origin is.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    pub columns: [Triple; 3],
    pub origin: Triple,
}

pub fn number(number: f64) -> Value {
    Value::Number(number)
}

pub fn triple(of: &Vector3<f64>) -> Triple {
    [0, 1, 2].map(|row: usize| number(of[row]))
}

pub fn zeros() -> Triple {
    [Value::ZERO, Value::ZERO, Value::ZERO]
}

pub fn is_zero(values: &[Value]) -> bool {
    values.iter().all(|value| matches!(value, Value::Number(number) if *number == 0.0))
}

impl Frame {
    pub fn of(pose: &Pose) -> Self {
        let columns = [0, 1, 2].map(|column| triple(&pose.rotation.matrix().column(column).into_owned()));
        Self { columns, origin: triple(&pose.translation.vector) }
    }

    pub fn identity() -> Self {
        Self::of(&Pose::identity())
    }

    pub fn row(&self, row: usize) -> Triple {
        [0, 1, 2].map(|column: usize| self.columns[column][row].clone())
    }
}

/// What a rotation by a vector is made of.
struct Turn {
    /// sin(t)/t, (1 - cos t)/t², (t - sin t)/t³.
    parts: [Value; 3],
    square: Value,
}

impl Sheet {
    pub fn times(&mut self, a: &Value, b: &Value) -> Value {
        self.sum(&[(a, b)])
    }

    pub fn plus(&mut self, a: &Value, b: &Value) -> Value {
        self.sum(&[(a, &Value::ONE), (b, &Value::ONE)])
    }

    pub fn minus(&mut self, a: &Value, b: &Value) -> Value {
        self.sum(&[(a, &Value::ONE), (b, &number(-1.0))])
    }

    pub fn over(&mut self, a: &Value, b: &Value) -> Value {
        let inverse = self.call(Function::Inverse, &[b]);
        self.times(a, &inverse)
    }

    pub fn dot(&mut self, a: &Triple, b: &Triple) -> Value {
        self.sum(&[(&a[0], &b[0]), (&a[1], &b[1]), (&a[2], &b[2])])
    }

    pub fn cross(&mut self, a: &Triple, b: &Triple) -> Triple {
        [0, 1, 2].map(|row| {
            let (next, after) = ((row + 1) % 3, (row + 2) % 3);
            self.sum(&[(&a[next], &b[after]), (&a[after].clone().negated(), &b[next])])
        })
    }

    /// a + b factor.
    pub fn add_scaled(&mut self, a: &Triple, b: &Triple, factor: &Value) -> Triple {
        [0, 1, 2].map(|row: usize| self.sum(&[(&a[row], &Value::ONE), (&b[row], factor)]))
    }

    pub fn add(&mut self, a: &Triple, b: &Triple) -> Triple {
        self.add_scaled(a, b, &Value::ONE)
    }

    pub fn subtract(&mut self, a: &Triple, b: &Triple) -> Triple {
        self.add_scaled(a, b, &number(-1.0))
    }

    pub fn scale(&mut self, a: &Triple, factor: &Value) -> Triple {
        [0, 1, 2].map(|row: usize| self.sum(&[(&a[row], factor)]))
    }

    /// R v.
    pub fn turned(&mut self, frame: &Frame, v: &Triple) -> Triple {
        [0, 1, 2].map(|row| self.dot(&frame.row(row), v))
    }

    /// Rᵀ v.
    pub fn turned_back(&mut self, frame: &Frame, v: &Triple) -> Triple {
        [0, 1, 2].map(|column: usize| self.dot(&frame.columns[column], v))
    }

    /// R p + t.
    pub fn point(&mut self, frame: &Frame, p: &Triple) -> Triple {
        [0, 1, 2].map(|row: usize| {
            let [x, y, z] = frame.row(row);
            self.sum(&[(&x, &p[0]), (&y, &p[1]), (&z, &p[2]), (&frame.origin[row], &Value::ONE)])
        })
    }

    pub fn compose(&mut self, a: &Frame, b: &Frame) -> Frame {
        let columns = [0, 1, 2].map(|column: usize| self.turned(a, &b.columns[column]));
        Frame { columns, origin: self.point(a, &b.origin) }
    }

    pub fn inverse(&mut self, frame: &Frame) -> Frame {
        let columns = [0, 1, 2].map(|row| frame.row(row));
        let back = Frame { columns, origin: zeros() };
        let origin = self.turned(&back, &frame.origin).map(Value::negated);
        Frame { origin, ..back }
    }

    /// The motion of a screw by a value, rad or m.
    pub fn motion(&mut self, screw: &Screw, value: &Value) -> Frame {
        let (line, slide) = match screw {
            Screw::Prismatic(direction) => {
                let origin = self.scale(&triple(direction), value);
                return Frame { origin, ..Frame::identity() };
            }
            Screw::Revolute(line) => (line, Value::ZERO),
            Screw::Helical { axis, pitch } => (axis, self.times(value, &number(pitch.metres_per_radian()))),
        };
        let (sine, cosine) = (self.call(Function::Sine, &[value]), self.call(Function::Cosine, &[value]));
        let u = line.direction.into_inner();
        let (along, point) = (triple(&u), triple(&line.point.coords));
        let columns = [0, 1, 2].map(|column: usize| {
            [0, 1, 2].map(|row: usize| {
                // cos (δ - u uᵀ) + u uᵀ + sin [u].
                let outer = u[row] * u[column];
                let same = f64::from(u8::from(row == column));
                let skew = if row == column {
                    0.0
                } else {
                    let other = 3 - row - column;
                    if (row + 1) % 3 == column { -u[other] } else { u[other] }
                };
                self.sum(&[(&cosine, &number(same - outer)), (&number(outer), &Value::ONE), (&sine, &number(skew))])
            })
        });
        let turned = Frame { columns, origin: zeros() };
        let moved = self.turned(&turned, &point);
        let origin = self.subtract(&point, &moved);
        let origin = self.add_scaled(&origin, &along, &slide);
        Frame { origin, ..turned }
    }

    /// A joint's value at the coordinates q.
    pub fn joint_value(&mut self, joint: &ChainJoint) -> Value {
        let q = Value::named(format!("q[{}]", joint.coordinate));
        self.sum(&[(&q, &number(joint.scale)), (&number(joint.offset), &Value::ONE)])
    }

    fn turn(&mut self, omega: &Triple, tiny: f64) -> Turn {
        let square = self.sum(&[
            (&omega[0], &omega[0]),
            (&omega[1], &omega[1]),
            (&omega[2], &omega[2]),
            (&number(tiny), &Value::ONE),
        ]);
        let angle = self.call(Function::Root, &[&square]);
        let sine = self.call(Function::Sine, &[&angle]);
        let first = self.over(&sine, &angle);
        let half = self.times(&angle, &number(0.5));
        let half = self.call(Function::Sine, &[&half]);
        let twice = self.sum(&[(&half, &half)]);
        let twice = self.times(&twice, &number(2.0));
        let second = self.over(&twice, &square);
        let rest = self.minus(&Value::ONE, &first);
        let third = self.over(&rest, &square);
        Turn { parts: [first, second, third], square }
    }

    /// exp of a twist. `tiny`: what keeps the square of an angle of 0 off 0.
    pub fn exp(&mut self, twist: &Twist, tiny: f64) -> Frame {
        let [a, b, c, x, y, z] = twist.clone();
        let (omega, v) = ([a, b, c], [x, y, z]);
        if is_zero(&omega) {
            return Frame { origin: v, ..Frame::identity() };
        }
        let Turn { parts: [first, second, third], .. } = self.turn(&omega, tiny);
        let weighed = self.scale(&omega, &second);
        let lean = self.scale(&omega, &first);
        let plain = self.dot(&omega, &weighed);
        let columns = [0, 1, 2].map(|column: usize| {
            [0, 1, 2].map(|row: usize| {
                let outer = (&omega[row], &weighed[column]);
                if row == column {
                    return self.sum(&[outer, (&plain, &number(-1.0)), (&Value::ONE, &Value::ONE)]);
                }
                let other = 3 - row - column;
                let sign = number(if (row + 1) % 3 == column { -1.0 } else { 1.0 });
                self.sum(&[outer, (&lean[other], &sign)])
            })
        });
        let across = self.cross(&omega, &v);
        let twice = self.cross(&omega, &across);
        let origin = self.add_scaled(&v, &across, &second);
        let origin = self.add_scaled(&origin, &twice, &third);
        Frame { columns, origin }
    }

    /// The rotation vector of a rotation by less than a half turn.
    pub fn rotation_vector(&mut self, frame: &Frame, tiny: f64) -> Triple {
        let [x, y, z] = &frame.columns;
        let half = number(0.5);
        let mut apart = |a: &Value, b: &Value| self.sum(&[(a, &half), (&b.clone().negated(), &half)]);
        let lean = [apart(&y[2], &z[1]), apart(&z[0], &x[2]), apart(&x[1], &y[0])];
        let cosine = self.sum(&[(&x[0], &half), (&y[1], &half), (&z[2], &half), (&number(-0.5), &Value::ONE)]);
        let square =
            self.sum(&[(&lean[0], &lean[0]), (&lean[1], &lean[1]), (&lean[2], &lean[2]), (&number(tiny), &Value::ONE)]);
        let sine = self.call(Function::Root, &[&square]);
        let angle = self.call(Function::Arctangent, &[&sine, &cosine]);
        let share = self.over(&angle, &sine);
        self.scale(&lean, &share)
    }

    /// log of a pose that turns by less than a half turn.
    pub fn log(&mut self, frame: &Frame, tiny: f64) -> Twist {
        let omega = self.rotation_vector(frame, tiny);
        let Turn { parts: [first, second, _], square } = self.turn(&omega, tiny);
        let ratio = self.over(&first, &second);
        let rest = self.sum(&[(&Value::ONE, &Value::ONE), (&ratio, &number(-0.5))]);
        let factor = self.over(&rest, &square);
        let p = frame.origin.clone();
        let across = self.cross(&omega, &p);
        let twice = self.cross(&omega, &across);
        let v = self.add_scaled(&p, &across, &number(-0.5));
        let v = self.add_scaled(&v, &twice, &factor);
        let ([a, b, c], [x, y, z]) = (omega, v);
        [a, b, c, x, y, z]
    }

    /// How a point of the base frame that a frame sees at `local` moves by a twist at home.
    pub fn moved(&mut self, frame: &Frame, local: &Triple, twist: &Vector6<f64>) -> Triple {
        let omega = triple(&Vector3::new(twist[0], twist[1], twist[2]));
        let v = triple(&Vector3::new(twist[3], twist[4], twist[5]));
        let across = self.cross(&omega, local);
        let seen = self.add(&across, &v);
        self.turned(frame, &seen)
    }
}
