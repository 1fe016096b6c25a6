//! From bodies and lines in space to strokes on the sheet, painted from far to near.
//!
//! Lines are cut into short pieces, each with its own depth. A piece that passes in front of another lies in a gap of it,
//! as in drawings by hand; bodies cover what is behind them.

use super::scene::{EndOn, Line, Scene};
use super::solids::Solid;
use super::view::{Frame, Place};
use serde::Serialize;
use std::f64::consts::FRAC_PI_8;
use std::fmt::Write as _;

/// Length of a piece, px.
const PIECE: f64 = 12.0;
/// Overlap of consecutive pieces, which hides the seam, px.
const SEAM: f64 = 0.4;
/// Lines are cut off beyond this, because a huge length would give a million pieces, px.
const LONGEST: f64 = 4000.0;
/// Corners of a curve in a piece of it.
const LEGS: usize = 3;
const ARROW_HEAD: f64 = 11.0;
const ARC_HEAD: f64 = 8.0;

/// Something that is painted with one class.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Stroke {
    /// SVG path data.
    pub path: String,
    pub class: &'static str,
    /// Whether it leaves a gap in what is behind it.
    pub gap: bool,
    #[serde(skip)]
    pub near: f64,
    /// Places along it, for the labels.
    #[serde(skip)]
    pub places: Vec<Place>,
}

/// Every stroke of a scene, far ones first.
pub(crate) fn painted(scene: &Scene, frame: &Frame) -> Vec<Stroke> {
    let mut strokes = Vec::new();
    for solid in &scene.solids {
        body(solid, frame, &mut strokes);
    }
    let mut neighbours = Neighbours::on(frame);
    for stroke in &strokes {
        neighbours.claim(MANY, &stroke.places);
    }
    let mut lines = Vec::new();
    for (owner, line) in scene.lines.iter().enumerate() {
        let mut places: Vec<Place> = line.points.iter().map(|point| frame.place(point)).collect();
        neighbours.claim(owner, &places);
        if line.arrow {
            head(&mut places, line.class, &mut strokes);
        }
        lines.push(places);
    }
    for (owner, (line, places)) in scene.lines.iter().zip(&lines).enumerate() {
        strokes.extend(pieces(line, places, |place| neighbours.only(owner, place)));
    }
    strokes.sort_by(|a, b| a.near.total_cmp(&b.near));
    for mark in &scene.end_on {
        end_on(mark, frame, &mut strokes);
    }
    strokes
}

fn path(places: &[Place], closed: bool) -> String {
    let mut data = String::new();
    for (index, place) in places.iter().enumerate() {
        let letter = if index == 0 { 'M' } else { 'L' };
        let _ = write!(data, "{letter}{:.1} {:.1}", place.x, place.y);
    }
    if closed {
        data.push('Z');
    }
    data
}

fn between(a: &Place, b: &Place, part: f64) -> Place {
    Place { x: a.x + (b.x - a.x) * part, y: a.y + (b.y - a.y) * part, near: a.near + (b.near - a.near) * part }
}

/// An axis along a link lies on it.
fn lift(class: &str) -> f64 {
    if class == "link" { 0.0 } else { 3.0 }
}

/// A line cut into pieces; pieces with nothing nearby form one stroke.
fn pieces(line: &Line, places: &[Place], alone: impl Fn(&Place) -> bool) -> Vec<Stroke> {
    if line.class == "reference" {
        let near = places.iter().map(|place| place.near).fold(f64::INFINITY, f64::min);
        return vec![stroke(places.to_vec(), line.class, near, false)];
    }
    let cut = cuts(places);
    let last = cut.len() - 1;
    let mut strokes: Vec<Stroke> = Vec::new();
    let mut last_was_alone = false;
    for (index, piece) in cut.into_iter().enumerate() {
        let is_alone = piece.iter().all(&alone);
        if let Some(before) = strokes.last_mut().filter(|_| is_alone && last_was_alone) {
            before.places.extend(&piece[1..]);
            continue;
        }
        last_was_alone = is_alone;
        let near = piece.iter().map(|place| place.near).sum::<f64>() / piece.len() as f64 + lift(line.class);
        strokes.push(stroke(piece, line.class, near, index > 0 && index < last && !is_alone));
    }
    for stroke in &mut strokes {
        let ends = [stroke.places[0], stroke.places[stroke.places.len() - 1]];
        stroke.path = path(if places.len() == 2 { &ends } else { &stroke.places }, false);
    }
    strokes
}

/// A straight line every few px, each piece reaching a little into the next; a curve every few corners.
fn cuts(places: &[Place]) -> Vec<Vec<Place>> {
    let [from, to] = places else {
        let starts = (0..places.len() - 1).step_by(LEGS);
        return starts.map(|start| places[start..=(start + LEGS).min(places.len() - 1)].to_vec()).collect();
    };
    let length = from.distance(to).min(LONGEST);
    let count = (length / PIECE).ceil().max(1.0);
    let seam = SEAM / length.max(SEAM);
    let part = |k: f64| (k / count).clamp(0.0, 1.0);
    let piece = |k: u32| {
        let start = between(from, to, (part(f64::from(k)) - seam).max(0.0));
        let end = between(from, to, (part(f64::from(k) + 1.0) + seam).min(1.0));
        vec![start, between(&start, &end, 0.5), end]
    };
    (0..count as u32).map(piece).collect()
}

fn stroke(places: Vec<Place>, class: &'static str, near: f64, gap: bool) -> Stroke {
    Stroke { path: path(&places, false), class, gap, near, places }
}

/// Which strokes are near which part of the sheet.
struct Neighbours {
    columns: usize,
    rows: usize,
    owners: Vec<Option<usize>>,
}

/// Owner of cells near several lines or a body.
const MANY: usize = usize::MAX;
const CELL: f64 = 7.0;

impl Neighbours {
    fn on(frame: &Frame) -> Self {
        let (columns, rows) = ((frame.width / CELL) as usize + 1, (frame.height / CELL) as usize + 1);
        Self { columns, rows, owners: vec![None; columns * rows] }
    }

    /// The cell of a place and those around it.
    fn around(&self, place: &Place) -> impl Iterator<Item = usize> + use<> {
        let (columns, rows) = (self.columns, self.rows);
        let near = [-1.0, 0.0, 1.0];
        let (column, row) = ((place.x / CELL).floor(), (place.y / CELL).floor());
        let cells = near.into_iter().flat_map(move |dy| near.map(|dx| (column + dx, row + dy)));
        cells
            .filter(move |(column, row)| (0.0..columns as f64).contains(column) && (0.0..rows as f64).contains(row))
            .map(move |(column, row)| row as usize * columns + column as usize)
    }

    fn claim(&mut self, owner: usize, places: &[Place]) {
        for pair in places.windows(2) {
            let count = (pair[0].distance(&pair[1]).min(LONGEST) / CELL).ceil().max(1.0) as u32;
            for k in 0..=count {
                for cell in self.around(&between(&pair[0], &pair[1], f64::from(k) / f64::from(count))) {
                    let claimed = &mut self.owners[cell];
                    *claimed = Some(if claimed.is_none_or(|known| known == owner) { owner } else { MANY });
                }
            }
        }
    }

    fn only(&self, owner: usize, place: &Place) -> bool {
        self.around(place).all(|cell| self.owners[cell].is_none_or(|known| known == owner))
    }
}

/// An arrow head at the end of `places`, which are shortened to its middle.
fn head(places: &mut [Place], class: &'static str, strokes: &mut Vec<Stroke>) {
    let count = places.len();
    let tip = places[count - 1];
    let full = if count == 2 { ARROW_HEAD } else { ARC_HEAD };
    let mut back = count - 2;
    while back > 0 && places[back].distance(&tip) < full {
        back -= 1;
    }
    let reach = places[back].distance(&tip);
    if reach < 1e-6 {
        return;
    }
    let length = full.min(0.6 * reach);
    let (dx, dy) = ((tip.x - places[back].x) / reach, (tip.y - places[back].y) / reach);
    let at = |along: f64, across: f64| Place {
        x: tip.x - dx * along - dy * across,
        y: tip.y - dy * along + dx * across,
        near: tip.near,
    };
    let corners = [tip, at(length, 0.36 * length), at(0.8 * length, 0.0), at(length, -0.36 * length)];
    let near = tip.near + lift(class) + 0.5;
    for place in places.iter_mut().skip(1) {
        if place.distance(&tip) < 0.7 * length {
            *place = at(0.7 * length, 0.0);
        }
    }
    let class = match class {
        "x" => "x-head",
        "z" => "z-head",
        "theta" => "theta-head",
        _ => "alpha-head",
    };
    strokes.push(Stroke { path: path(&corners, true), class, gap: false, near, places: corners.to_vec() });
}

fn body(solid: &Solid, frame: &Frame, strokes: &mut Vec<Stroke>) {
    let base = frame.place(&solid.middle).near;
    let mut seen: Vec<_> = solid.faces.iter().filter(|face| frame.towards_reader(&face.normal) > 1e-6).collect();
    seen.sort_by(|a, b| frame.towards_reader(&a.normal).total_cmp(&frame.towards_reader(&b.normal)));
    let outline: Vec<Place> =
        hull(seen.iter().flat_map(|face| face.corners.iter().map(|corner| frame.place(corner))).collect());
    let push = |strokes: &mut Vec<Stroke>, places: Vec<Place>, class, order: f64, closed| {
        let near = base + 1e-3 * order;
        strokes.push(Stroke { path: path(&places, closed), class, gap: false, near, places });
    };
    push(strokes, outline, solid.class, 0.0, true);
    for face in seen.iter().filter(|face| face.outlined) {
        let corners = face.corners.iter().map(|corner| frame.place(corner)).collect();
        push(strokes, corners, if solid.class == "ground" { "ground" } else { "face" }, 1.0, true);
    }
    let visible: Vec<Place> = solid.thread.iter().map(|point| frame.place(point)).collect();
    for run in visible.split(|place| place.near < base).filter(|run| run.len() > 1) {
        push(strokes, run.to_vec(), "thread", 2.0, false);
    }
}

/// The convex hull, in order around it (Andrew's monotone chain).
fn hull(mut places: Vec<Place>) -> Vec<Place> {
    places.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let turn = |a: &Place, b: &Place, c: &Place| (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
    let half = |places: &mut dyn Iterator<Item = Place>| {
        let mut side: Vec<Place> = Vec::new();
        for place in places {
            while side.len() > 1 && turn(&side[side.len() - 2], &side[side.len() - 1], &place) <= 0.0 {
                side.pop();
            }
            side.push(place);
        }
        side.pop();
        side
    };
    let mut around = half(&mut places.iter().copied());
    around.extend(half(&mut places.iter().rev().copied()));
    around
}

/// ⊙ points at the reader, ⊗ away.
fn end_on(mark: &EndOn, frame: &Frame, strokes: &mut Vec<Stroke>) {
    let middle = frame.place(&mark.at);
    let radius = if mark.class == "z" { 7.0 } else { 5.0 };
    let ring = |radius: f64| -> Vec<Place> {
        let at = |k: i32| (f64::from(k) * FRAC_PI_8).sin_cos();
        (0..16).map(at).map(|(s, c)| Place { x: middle.x + radius * c, y: middle.y + radius * s, ..middle }).collect()
    };
    let class = if mark.class == "z" { "z-mark" } else { "x-mark" };
    let outline = ring(radius);
    strokes.push(Stroke { path: path(&outline, true), class, gap: false, near: middle.near, places: outline });
    let inner = if mark.towards {
        path(&ring(1.8), true)
    } else {
        let r = 0.66 * radius;
        let (x, y) = (middle.x, middle.y);
        format!(
            "M{:.1} {:.1}L{:.1} {:.1}M{:.1} {:.1}L{:.1} {:.1}",
            x - r,
            y - r,
            x + r,
            y + r,
            x - r,
            y + r,
            x + r,
            y - r
        )
    };
    strokes.push(Stroke { path: inner, class, gap: false, near: middle.near, places: Vec::new() });
}
