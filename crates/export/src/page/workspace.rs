//! Where the tip can go: sampled over the joint ranges, as outlines seen from the side and from above.

use super::coordinate_ascent::CoordinateAscent;
use denavit_model::chain::Chain;
use denavit_model::nalgebra::{Point3, Vector3};
use std::fmt::Write as _;

/// Number of postures tried; fewer for chains whose joint motions would exceed this number in total.
const POSTURES: usize = 40_000;
const FEWEST: usize = 1_000;
const MOTIONS: usize = 4_000_000;
/// Start of the sequence of postures.
pub(super) const SEED: u32 = 1;
/// Cells along the longer side of an outline.
const CELLS: usize = 96;

/// The reachable positions of the tip, and the farthest one.
pub(super) struct Workspace {
    places: Vec<Point3<f64>>,
    /// Postures that were tried.
    pub postures: usize,
    /// Largest distance found of the tip from the base origin, m: a lower bound.
    pub reach: f64,
    /// Smallest and largest coordinates of the tip, m.
    pub bounds: [(f64, f64); 3],
    /// Whether the first joint turns about the base's z axis.
    pub turns_about_z: bool,
}

/// An outline on a plane of the base frame.
pub(super) struct Outline {
    /// SVG path data, m, the second coordinate pointing up.
    pub path: String,
    pub left: f64,
    pub bottom: f64,
    pub wide: f64,
    pub high: f64,
    /// Whether the part left of `left` is a mirror image that is not shown.
    pub half: bool,
}

impl Workspace {
    /// Low-discrepancy postures (additive recurrence with the powers of the generalised golden ratio), every second one
    /// with some joints pushed to a limit: the border of a workspace lies there.
    pub fn of(chain: &Chain) -> Self {
        let ranges: Vec<(f64, f64)> = chain.coordinates().iter().map(denavit_model::Coordinate::range).collect();
        let steps = additive_steps(ranges.len() * 2);
        let mut at: Vec<f64> = steps.iter().map(|step| (step * f64::from(SEED)).fract()).collect();
        let mut q = vec![0.0; ranges.len()];
        let postures = (MOTIONS / chain.joints().len().max(1)).clamp(FEWEST, POSTURES);
        let mut places = Vec::with_capacity(postures);
        let mut farthest = (0.0, q.clone());
        let mut pushed = Vec::new();
        for posture in 0..postures {
            for (value, step) in at.iter_mut().zip(&steps) {
                *value = (*value + step).fract();
            }
            for (k, (lower, upper)) in ranges.iter().enumerate() {
                let part = match at[ranges.len() + k] {
                    push if posture % 2 == 0 && push < 0.3 => at[k].round(),
                    _ => at[k],
                };
                q[k] = lower + (upper - lower) * part;
            }
            let place = Point3::from(chain.fk(&q).translation.vector);
            if posture % PUSHED == 0 {
                pushed.push(q.clone());
            }
            if place.coords.norm() > farthest.0 {
                farthest = (place.coords.norm(), q.clone());
            }
            places.push(place);
        }
        let reach = farther(chain, &ranges, farthest.1, &mut places);
        border(chain, &ranges, &pushed, &mut places);
        let bounds = [0, 1, 2].map(|k| {
            let along = places.iter().map(|place| place[k]);
            (along.clone().fold(f64::INFINITY, f64::min), along.fold(f64::NEG_INFINITY, f64::max))
        });
        let first = chain.joints().first().and_then(|joint| joint.screw.line());
        let turns_about_z = first.is_some_and(|line| {
            let near = line.nearest_to(&Point3::origin());
            line.direction.z.abs() > 1.0 - 1e-6 && near.x.hypot(near.y) < 1e-6 * chain.size()
        });
        Self { places, postures, reach, bounds, turns_about_z }
    }

    /// Height over the distance from the z axis, or where the first joint does not turn about z, over x.
    pub fn beside(&self) -> Outline {
        if !self.turns_about_z {
            return outline(self.places.iter().map(|place| (place.x, place.z)).collect());
        }
        // With its mirror image, to avoid a false border along the z axis.
        let both = self.places.iter().flat_map(|place| {
            let across = place.x.hypot(place.y);
            [(across, place.z), (-across, place.z)]
        });
        let Outline { path, left, bottom, wide, high, .. } = outline(both.collect());
        Outline { path, left: 0.0, bottom, wide: left + wide, high, half: true }
    }

    /// x and y.
    pub fn above(&self) -> Outline {
        outline(self.places.iter().map(|place| (place.x, place.y)).collect())
    }
}

/// One posture in this many is moved towards the border: uniform samples are rare there.
const PUSHED: usize = 32;
/// Values of the first coordinate tried for each of those.
const SWEEP: u32 = 24;

/// Moves postures outwards by a few coordinate steps, each along the line from the centre of all positions (every second
/// one horizontally), and then through the range of the first coordinate; adds the positions reached.
fn border(chain: &Chain, ranges: &[(f64, f64)], postures: &[Vec<f64>], places: &mut Vec<Point3<f64>>) {
    let sum = places.iter().fold(Vector3::zeros(), |sum, place| sum + place.coords);
    let middle = sum / places.len().max(1) as f64;
    for (index, posture) in postures.iter().enumerate() {
        let mut outwards = chain.fk(posture).translation.vector - middle;
        if index % 2 == 0 {
            outwards.z = 0.0;
        }
        let mut ascent = CoordinateAscent::new(chain, ranges, posture.clone());
        for step in [0.15, 0.1, 0.06, 0.04, 0.03, 0.02, 0.015, 0.01, 0.006, 0.004, 0.002, 0.001] {
            ascent.pass(step, |place| place.coords.dot(&outwards), |_| {});
        }
        places.push(ascent.place());
        if let Some((lower, upper)) = ranges.first() {
            let spacing = (upper - lower) / f64::from(SWEEP);
            let offset = (ascent.values()[0] - lower).rem_euclid(spacing.max(f64::MIN_POSITIVE));
            places.extend((0..SWEEP).map(|k| ascent.with_first(lower + offset + spacing * f64::from(k))));
        }
    }
}

/// Steps of the additive recurrence in `count` dimensions: powers of 1/phi, phi^(count + 1) = phi + 1.
fn additive_steps(count: usize) -> Vec<f64> {
    let mut phi: f64 = 2.0;
    for _ in 0..64 {
        phi = (1.0 + phi).powf(1.0 / (count as f64 + 1.0));
    }
    (1..=count).map(|k| phi.powi(-i32::try_from(k).unwrap_or(i32::MAX))).collect()
}

/// Passes of the ascent to the farthest position; arms with few joints need some dozens.
const PASSES: usize = 400;

/// Climbs from the farthest posture, one coordinate at a time, with smaller and smaller steps.
fn farther(chain: &Chain, ranges: &[(f64, f64)], q: Vec<f64>, places: &mut Vec<Point3<f64>>) -> f64 {
    let mut ascent = CoordinateAscent::new(chain, ranges, q);
    let mut step = 0.25;
    for _ in 0..PASSES {
        if step <= 1e-6 {
            break;
        }
        if !ascent.pass(step, |place| place.coords.norm(), |place| places.push(place)) {
            step *= 0.5;
        }
    }
    ascent.place().coords.norm()
}

fn outline(points: Vec<(f64, f64)>) -> Outline {
    let bound = |pick: fn(&(f64, f64)) -> f64| {
        let along = points.iter().map(pick);
        (along.clone().fold(f64::INFINITY, f64::min), along.fold(f64::NEG_INFINITY, f64::max))
    };
    let ((left, right), (bottom, top)) = (bound(|p| p.0), bound(|p| p.1));
    let cell = ((right - left).max(top - bottom) / CELLS as f64).max(1e-9);
    // Two empty cells all around, so that every outline closes.
    let columns = ((right - left) / cell).ceil() as usize + 5;
    let rows = ((top - bottom) / cell).ceil() as usize + 5;
    let mut filled = vec![false; columns * rows];
    for (x, y) in points {
        let (column, row) = (((x - left) / cell + 2.0) as usize, ((y - bottom) / cell + 2.0) as usize);
        filled[row * columns + column] = true;
    }
    let closed = closing(&filled, columns, rows);
    let mut path = String::new();
    for ring in rings(&closed, columns, rows) {
        let corners = ring.iter().map(|(x, y)| (left + (x - 1.5) * cell, bottom + (y - 1.5) * cell));
        for (index, (x, y)) in corners.enumerate() {
            let _ = write!(path, "{}{x:.4} {y:.4}", if index == 0 { 'M' } else { 'L' });
        }
        path.push('Z');
    }
    Outline {
        path,
        left: left - cell,
        bottom: bottom - cell,
        wide: right - left + 2.0 * cell,
        high: top - bottom + 2.0 * cell,
        half: false,
    }
}

/// Fills holes and notches that are only gaps between samples: dilation and erosion by one cell.
fn closing(filled: &[bool], columns: usize, rows: usize) -> Vec<bool> {
    let spread = |cells: &[bool], wanted: bool| -> Vec<bool> {
        (0..cells.len())
            .map(|index| {
                let (row, column) = (index / columns, index % columns);
                let near = |r: usize, c: usize| cells[r * columns + c] == wanted;
                let rows = row.saturating_sub(1)..(row + 2).min(rows);
                let hit =
                    rows.into_iter().any(|r| (column.saturating_sub(1)..(column + 2).min(columns)).any(|c| near(r, c)));
                if hit { wanted } else { !wanted }
            })
            .collect()
    };
    spread(&spread(filled, true), false)
}

/// The borders of the filled cells as closed polygons in units of cells, corners cut (marching squares at the middles).
fn rings(filled: &[bool], columns: usize, rows: usize) -> Vec<Vec<(f64, f64)>> {
    let is = |column: usize, row: usize| filled[row * columns + column];
    // Directed edges between middles of cell sides, the filled side on the left; keyed by where they start.
    let mut next = vec![Vec::new(); 2 * columns * rows];
    let across = |column: usize, row: usize| 2 * (row * columns + column);
    let upright = |column: usize, row: usize| 2 * (row * columns + column) + 1;
    for row in 0..rows - 1 {
        for column in 0..columns - 1 {
            let corners = [is(column, row), is(column + 1, row), is(column + 1, row + 1), is(column, row + 1)];
            // Sides of the square between four cell middles: bottom, right, top, left.
            let sides = [across(column, row), upright(column + 1, row), across(column, row + 1), upright(column, row)];
            for side in 0..4 {
                if !corners[side] || corners[(side + 1) % 4] {
                    continue;
                }
                // Leaves the filled part here; it comes back at the first side, going on, where it begins again.
                let back = (1..4).map(|k| (side + k) % 4).find(|k| !corners[*k] && corners[(*k + 1) % 4]);
                if let Some(back) = back {
                    next[sides[side]].push(sides[back]);
                }
            }
        }
    }
    let place = |edge: usize| {
        let (index, is_upright) = (edge / 2, edge % 2 == 1);
        let (column, row) = ((index % columns) as f64, (index / columns) as f64);
        if is_upright { (column, row + 0.5) } else { (column + 0.5, row) }
    };
    let mut rings = Vec::new();
    for start in 0..next.len() {
        while let Some(mut edge) = next[start].pop() {
            let mut ring = vec![place(start)];
            while edge != start {
                ring.push(place(edge));
                match next[edge].pop() {
                    Some(following) => edge = following,
                    None => break,
                }
            }
            if ring.len() > 6 {
                rings.push(smoothed(&ring));
            }
        }
    }
    rings
}

/// Replaces each point by the mean of five, which smooths the steps of the cells.
fn smoothed(ring: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let count = ring.len();
    let mean = |index: usize| {
        let near = (0..5).map(|k| ring[(index + count + k - 2) % count]);
        let (x, y) = near.fold((0.0, 0.0), |sum, point| (sum.0 + point.0, sum.1 + point.1));
        (x / 5.0, y / 5.0)
    };
    (0..count).map(mean).collect()
}
