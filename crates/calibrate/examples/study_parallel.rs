//! Parallel axes: the POE form and the D-H form fitted to the same poses, residual by iteration. Prints a table.
//!
//! The D-H form is the textbook's: base frame, a row per joint (proximal), tool frame, Levenberg-Marquardt from the
//! nominal table with derivatives by central differences. The damping fixes its redundant numbers.

#![allow(clippy::print_stdout)] // A study prints its table.

use denavit_calibrate::{IdentifyOptions, Measurements};
use denavit_identify::identify;
use denavit_identify::parameters::NoEffects;
use denavit_identify::simulate::{SimulationOptions, simulate};
use denavit_measurements::kinds::ObservationKind;
use denavit_model::nalgebra::{DMatrix, DVector, Point3, Unit, Vector3, Vector6};
use denavit_model::{AxisLine, Chain, ChainJoint, Coordinate, Pose, Quantity, Screw, examples, se3};

/// The UR5 from its published table.
fn ur5() -> Option<Chain> {
    let axes = [
        ([0., 0., 1.], [0., 0., 0.]),
        ([0., -1., 0.], [0., 0., 0.089_159]),
        ([0., -1., 0.], [-0.425, 0., 0.089_159]),
        ([0., -1., 0.], [-0.817_25, 0., 0.089_159]),
        ([0., 0., -1.], [-0.817_25, -0.109_15, 0.089_159]),
        ([0., -1., 0.], [-0.817_25, -0.109_15, -0.005_491]),
    ];
    let joints = axes.iter().enumerate().map(|(index, (direction, point))| ChainJoint {
        name: format!("joint_{}", index + 1),
        screw: Screw::Revolute(AxisLine {
            direction: Unit::new_normalize(Vector3::from(*direction)),
            point: Point3::from(*point),
        }),
        coordinate: index,
        scale: 1.0,
        offset: 0.0,
    });
    let coordinates = (1..=6).map(|k| Coordinate::unlimited(format!("joint_{k}"), Quantity::Angle));
    let home = se3::pose(se3::rotation_from_rpy([1.5, 0., 0.]), Vector3::new(-0.817_25, -0.191_45, -0.005_491));
    Chain::new(("ur5", "base", "tool0"), coordinates.collect(), joints.collect(), home).ok()
}

/// base · Π Rx(α) Tx(a) Rz(θ + q) Tz(d) · tool, or with Tz(q) for a slide.
#[derive(Clone)]
struct DhArm {
    base: Pose,
    rows: Vec<[f64; 4]>,
    tool: Pose,
}

fn about(axis: usize, angle: f64) -> Pose {
    let mut twist = Vector6::zeros();
    twist[axis] = angle;
    se3::exp(&twist)
}

fn row_pose([alpha, a, theta, d]: [f64; 4]) -> Pose {
    about(0, alpha)
        * se3::translation(Vector3::new(a, 0., 0.))
        * about(2, theta)
        * se3::translation(Vector3::new(0., 0., d))
}

impl DhArm {
    /// The nominal table, common normals of parallel axes drawn through the frame before.
    fn of(chain: &Chain) -> Self {
        let mut frame = Pose::identity();
        let mut rows = Vec::new();
        for joint in chain.joints() {
            let (z, x0) = (frame.rotation * Vector3::z(), frame.rotation * Vector3::x());
            let u = joint.screw.direction().into_inner();
            let origin = frame.translation.vector;
            let point = joint.screw.line().map_or(origin, |line| line.nearest_to(&Point3::from(origin)).coords);
            let cross = z.cross(&u);
            let between = point - origin;
            let level = between - z * z.dot(&between);
            let x = if cross.norm() > 1e-9 { cross.normalize() } else { level.try_normalize(1e-9).unwrap_or(x0) };
            let alpha = x.dot(&z.cross(&u)).atan2(z.dot(&u));
            let turn = z.dot(&x0.cross(&x)).atan2(x0.dot(&x));
            let a = between.dot(&x);
            // θ and d of the row before bring its frame to the common normal.
            let along = if cross.norm() > 1e-9 {
                between.cross(&u).dot(&cross) / cross.norm_squared()
            } else {
                z.dot(&between)
            };
            if let Some(last) = rows.last_mut() {
                let last: &mut [f64; 4] = last;
                last[2] += turn;
                last[3] += along;
            } else {
                frame *= about(2, turn) * se3::translation(Vector3::new(0., 0., along));
                rows.push([alpha, a, 0.0, 0.0]);
                frame *= row_pose([alpha, a, 0.0, 0.0]);
                continue;
            }
            frame *= about(2, turn) * se3::translation(Vector3::new(0., 0., along)) * row_pose([alpha, a, 0., 0.]);
            rows.push([alpha, a, 0.0, 0.0]);
        }
        Self { base: Pose::identity(), rows, tool: frame.inverse() * chain.home() }
    }

    fn fk(&self, chain: &Chain, q: &[f64]) -> Pose {
        let mut reached = self.base;
        for (joint, [alpha, a, theta, d]) in chain.joints().iter().zip(&self.rows) {
            let value = joint.value(q);
            let (turn, slide) = match joint.screw {
                Screw::Prismatic(_) => (0.0, value),
                _ => (value, value * joint.screw.pitch().unwrap_or(0.0)),
            };
            reached *= row_pose([*alpha, *a, theta + turn, d + slide]);
        }
        reached * self.tool
    }

    fn stepped(&self, step: &[f64]) -> Self {
        let twist = |part: &[f64]| se3::exp(&Vector6::from_row_slice(part));
        let n = self.rows.len();
        let mut next = self.clone();
        next.base = self.base * twist(&step[..6]);
        for (row, part) in next.rows.iter_mut().zip(step[6..6 + 4 * n].chunks(4)) {
            for (value, delta) in row.iter_mut().zip(part) {
                *value += delta;
            }
        }
        next.tool = self.tool * twist(&step[6 + 4 * n..]);
        next
    }

    fn residual(&self, chain: &Chain, data: &Measurements) -> DVector<f64> {
        let mut all = Vec::with_capacity(6 * data.len());
        for row in 0..data.len() {
            let reached = self.fk(chain, data.reading(row));
            let measured = pose_read(data, row);
            all.extend_from_slice((measured.translation.vector - reached.translation.vector).as_slice());
            all.extend_from_slice(se3::rotation_vector(&(measured.rotation * reached.rotation.inverse())).as_slice());
        }
        DVector::from_vec(all)
    }
}

/// The pose that was measured in a row.
fn pose_read(data: &Measurements, row: usize) -> Pose {
    let values = data.observed.values(row);
    let rotation = ObservationKind::Pose.orientation(values).unwrap_or_default();
    se3::pose(rotation, ObservationKind::Pose.position(values).unwrap_or_default())
}

fn position_rms(residual: &DVector<f64>) -> f64 {
    let sum: f64 = residual.as_slice().chunks(6).map(|part| part[..3].iter().map(|x| x * x).sum::<f64>()).sum();
    (sum / (residual.len() as f64 / 6.0)).sqrt()
}

/// Position rms after each iteration, m.
fn fit_dh(chain: &Chain, data: &Measurements, start: DhArm, iterations: usize) -> (Vec<f64>, DhArm) {
    let count = 12 + 4 * start.rows.len();
    let mut arm = start;
    let mut residual = arm.residual(chain, data);
    let mut damping = 1e-6;
    let mut history = vec![position_rms(&residual)];
    for _ in 0..iterations {
        let mut jacobian = DMatrix::zeros(residual.len(), count);
        for column in 0..count {
            let mut step = vec![0.0; count];
            step[column] = 1e-6;
            let plus = arm.stepped(&step).residual(chain, data);
            step[column] = -1e-6;
            let minus = arm.stepped(&step).residual(chain, data);
            jacobian.set_column(column, &((plus - minus) / 2e-6));
        }
        let normal = jacobian.transpose() * &jacobian;
        let gradient = -jacobian.transpose() * &residual;
        for _ in 0..12 {
            let mut damped = normal.clone();
            for k in 0..count {
                damped[(k, k)] += damping * (normal[(k, k)] + 1e-12);
            }
            let Some(factor) = damped.cholesky() else {
                damping *= 10.0;
                continue;
            };
            let trial = arm.stepped(factor.solve(&gradient).as_slice());
            let now = trial.residual(chain, data);
            if now.norm() < residual.norm() {
                arm = trial;
                residual = now;
                damping = (damping * 0.1).max(1e-12);
                break;
            }
            damping *= 10.0;
        }
        history.push(position_rms(&residual));
    }
    (history, arm)
}

fn main() {
    let Some(ur5) = ur5() else { return };
    for chain in [ur5, examples::scara_helical(), examples::puma_like()] {
        let options = SimulationOptions {
            kind: ObservationKind::Pose,
            rows: 40,
            turn: 2e-3,
            shift: 2e-3,
            noise_position: 0.0,
            noise_orientation: 0.0,
            ..Default::default()
        };
        let mut run = simulate(&chain, &options, &NoEffects);
        // Both forms start from the same poses of instrument and target: the true ones.
        let (instrument, target) = (run.arm.instruments[0], run.arm.targets[0]);
        for row in 0..run.data.len() {
            let measured = pose_read(&run.data, row);
            let in_base = instrument.inverse() * measured * target.inverse();
            let values = run.data.observed.values_mut(row);
            values[..3].copy_from_slice(in_base.translation.vector.as_slice());
            values[3..].copy_from_slice(in_base.rotation.matrix().as_slice());
        }
        let (dh, arm) = fit_dh(&chain, &run.data, DhArm::of(&chain), 100);
        println!("{}: position rms by iteration, mm", chain.name());
        for (iteration, dh) in dh.iter().enumerate().take(7) {
            let mut limited = IdentifyOptions::axes(&chain);
            limited.fit.most_iterations = iteration;
            let found = identify(&chain, &run.data, &limited);
            let squares = if iteration == 0 { found.nominal.squares } else { found.geometric.squares };
            let rms = (squares.iter().map(|s| s[0]).sum::<f64>() / squares.len() as f64).sqrt();
            println!("  {iteration:3}  POE {:10.2e}   D-H {:10.2e}", rms * 1e3, dh * 1e3);
        }
        for iteration in [10, 20, 50, 100] {
            println!("  {iteration:3}                    D-H {:10.2e}", dh[iteration] * 1e3);
        }
        let largest = arm.rows.iter().map(|row| row[3].abs()).fold(0.0, f64::max);
        println!("  largest |d| that D-H arrived at: {largest:.3} m");
    }
}
