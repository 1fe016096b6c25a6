//! Label placement: beside what a label names, clear of lines and of other labels.

use super::strokes::Stroke;
use super::view::{Frame, Place};
use denavit_model::nalgebra::Point3;
use serde::Serialize;

/// Size of the letters, px.
const SIZE: f64 = 14.5;
pub(crate) const HEIGHT: f64 = 16.0;
/// A label farther than this from what it names gets a leader line, px.
const LEADER: f64 = 14.0;
/// Cell size of the grid that records the amount of drawing, px.
const CELL: f64 = 3.0;
/// Free space from the edge of the sheet, px.
const EDGE: f64 = 4.0;
const DIRECTIONS: u32 = 32;
const DISTANCES: [f64; 10] = [3.0, 7.0, 12.0, 19.0, 28.0, 40.0, 56.0, 76.0, 100.0, 130.0];

/// What a label names; this determines how far away it may be placed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Kind {
    Axis,
    Length,
    Angle,
}

/// A word and the point that it names.
pub(crate) struct Ask {
    pub text: String,
    pub at: Point3<f64>,
    pub class: &'static str,
    pub kind: Kind,
}

/// A label on the sheet: its centre, and a leader line if it is not next to what it names.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Label {
    pub text: String,
    pub x: f64,
    pub y: f64,
    pub class: &'static str,
    pub leader: Option<[f64; 4]>,
    #[serde(skip)]
    pub half_width: f64,
}

#[derive(Clone, Copy)]
struct Area {
    x: f64,
    y: f64,
    half_width: f64,
    half_height: f64,
}

impl Area {
    fn overlap(&self, other: &Self) -> f64 {
        let shared = |distance: f64, sum: f64| (sum - distance.abs()).max(0.0);
        shared(self.x - other.x, self.half_width + other.half_width + 2.0)
            * shared(self.y - other.y, self.half_height + other.half_height)
    }

    /// Whether it hides some of the other.
    fn lies_on(&self, other: &Self) -> bool {
        (self.x - other.x).abs() < self.half_width + other.half_width - 3.0
            && (self.y - other.y).abs() < self.half_height + other.half_height - 5.0
    }

    /// How far it sticks out of the sheet, px.
    fn outside(&self, frame: &Frame) -> f64 {
        let beyond = |at: f64, half: f64, size: f64| (EDGE + half - at).max(0.0) + (at + half + EDGE - size).max(0.0);
        beyond(self.x, self.half_width, frame.width) + beyond(self.y, self.half_height, frame.height)
    }

    /// The point of its border towards a place.
    fn border_towards(&self, place: &Place) -> (f64, f64) {
        let (dx, dy) = (place.x - self.x, place.y - self.y);
        let part = (self.half_width / dx.abs().max(1e-9)).min(self.half_height / dy.abs().max(1e-9)).min(1.0);
        (self.x + dx * part, self.y + dy * part)
    }
}

/// The amount of drawing in any rectangle: a summed-area table of cells.
struct Ink {
    columns: usize,
    rows: usize,
    sums: Vec<f64>,
}

impl Ink {
    fn of(strokes: &[Stroke], frame: &Frame) -> Self {
        let columns = (frame.width / CELL).ceil() as usize + 1;
        let rows = (frame.height / CELL).ceil() as usize + 1;
        let mut cells = vec![0.0; columns * rows];
        let mut mark = |x: f64, y: f64, weight: f64| {
            if x >= 0.0 && y >= 0.0 && x < frame.width && y < frame.height {
                let cell: &mut f64 = &mut cells[(y / CELL) as usize * columns + (x / CELL) as usize];
                *cell = cell.max(weight);
            }
        };
        for stroke in strokes {
            let weight = match stroke.class {
                "ground" => 0.3,
                "reference" => 0.5,
                "x" | "z" | "x-head" | "z-head" | "x-mark" | "z-mark" => 1.6,
                _ => 1.0,
            };
            for pair in stroke.places.windows(2) {
                let count = (pair[0].distance(&pair[1]) / CELL).ceil().min(2000.0) as u32 + 1;
                for k in 0..=count {
                    let part = f64::from(k) / f64::from(count);
                    mark(
                        pair[0].x + (pair[1].x - pair[0].x) * part,
                        pair[0].y + (pair[1].y - pair[0].y) * part,
                        weight,
                    );
                }
            }
        }
        let mut sums = vec![0.0; (columns + 1) * (rows + 1)];
        for row in 0..rows {
            let mut along = 0.0;
            for column in 0..columns {
                along += cells[row * columns + column];
                sums[(row + 1) * (columns + 1) + column + 1] = sums[row * (columns + 1) + column + 1] + along;
            }
        }
        Self { columns, rows, sums }
    }

    /// How much drawing a label in this area would cover, with a small margin.
    fn under(&self, area: &Area) -> f64 {
        let cell = |at: f64, most: usize| ((at / CELL).max(0.0) as usize).min(most);
        let (wide, high) = (area.half_width + CELL, area.half_height);
        let (left, right) = (cell(area.x - wide, self.columns), cell(area.x + wide + CELL, self.columns));
        let (top, bottom) = (cell(area.y - high, self.rows), cell(area.y + high + CELL, self.rows));
        let sum = |row: usize, column: usize| self.sums[row * (self.columns + 1) + column];
        sum(bottom, right) - sum(top, right) - sum(bottom, left) + sum(top, left)
    }
}

/// Width of a text, px, by the usual widths of a sans serif.
fn width(text: &str) -> f64 {
    let em = |letter: char| match letter {
        ' ' | '.' | ',' | 'l' | 'i' => 0.32,
        '₀'..='₉' | 'ₜ' => 0.4,
        'm' | 'w' | '=' | '+' | '−' => 0.86,
        _ => 0.62,
    };
    text.chars().map(em).sum::<f64>() * SIZE
}

/// The labels placed so far, by the band of the sheet that contains their centres.
struct Bands {
    words: Vec<Vec<(usize, Area)>>,
    areas: Vec<Option<Area>>,
}

impl Bands {
    fn of(count: usize, frame: &Frame) -> Self {
        let bands = (frame.height / HEIGHT).ceil() as usize + 1;
        Self { words: vec![Vec::new(); bands], areas: vec![None; count] }
    }

    fn band(&self, y: f64) -> usize {
        ((y / HEIGHT).max(0.0) as usize).min(self.words.len() - 1)
    }

    fn put(&mut self, index: usize, area: Area) {
        let band = self.band(area.y);
        self.words[band].push((index, area));
        self.areas[index] = Some(area);
    }

    fn take(&mut self, index: usize) {
        if let Some(area) = self.areas[index].take() {
            let band = self.band(area.y);
            self.words[band].retain(|(other, _)| *other != index);
        }
    }

    /// The words that come near rows from `top` to `bottom`: a word is no higher than a band.
    fn near(&self, top: f64, bottom: f64) -> impl Iterator<Item = &Area> {
        let bands = self.band(top - HEIGHT)..=self.band(bottom + HEIGHT);
        self.words[bands].iter().flatten().map(|(_, area)| area)
    }

    fn overlap(&self, area: &Area) -> f64 {
        self.near(area.y, area.y).map(|other| area.overlap(other)).sum()
    }
}

/// Places every label: axes first, then lengths, then angles; then each once more with all others in place. Labels that
/// would still overlap another one are omitted.
pub(crate) fn placed(asks: &[Ask], strokes: &[Stroke], frame: &Frame) -> Vec<Label> {
    let ink = Ink::of(strokes, frame);
    let inside = |ask: &&Ask| {
        let place = frame.place(&ask.at);
        (0.0..frame.width).contains(&place.x) && (0.0..frame.height).contains(&place.y)
    };
    let mut order: Vec<&Ask> = asks.iter().filter(inside).collect();
    order.sort_by_key(|ask| ask.kind);
    let mut bands = Bands::of(order.len(), frame);
    for _ in 0..3 {
        for (index, ask) in order.iter().enumerate() {
            bands.take(index);
            bands.put(index, best(ask, &bands, &ink, frame));
        }
    }
    let mut kept = Bands::of(order.len(), frame);
    for (index, area) in bands.areas.iter().enumerate() {
        let free = |area: &&Area| kept.near(area.y, area.y).all(|other| !area.lies_on(other));
        if let Some(area) = area.as_ref().filter(free) {
            kept.put(index, *area);
        }
    }
    let areas = kept.areas;
    let label = |(ask, area): (&&Ask, Option<Area>)| {
        let area = area?;
        let anchor = frame.place(&ask.at);
        let (x, y) = area.border_towards(&anchor);
        let far = (x - anchor.x).hypot(y - anchor.y) > LEADER;
        let tenth = |v: f64| (v * 10.0).round() / 10.0;
        Some(Label {
            text: ask.text.clone(),
            x: tenth(area.x),
            y: tenth(area.y),
            class: ask.class,
            half_width: area.half_width,
            leader: far.then(|| [x, y, anchor.x, anchor.y].map(tenth)),
        })
    };
    order.iter().zip(areas).filter_map(label).collect()
}

fn best(ask: &Ask, others: &Bands, ink: &Ink, frame: &Frame) -> Area {
    let anchor = frame.place(&ask.at);
    let (half_width, half_height) = (width(&ask.text) / 2.0 + 1.5, HEIGHT / 2.0);
    let stray = match ask.kind {
        Kind::Axis => 0.9,
        Kind::Length | Kind::Angle => 0.4,
    };
    let mut chosen = (f64::INFINITY, Area { x: anchor.x, y: anchor.y, half_width, half_height });
    // An axis is labelled at its tip, which is already clear of the arrow.
    let start = if ask.kind == Kind::Axis { -(0.7 * half_height) } else { 0.0 };
    for distance in DISTANCES {
        let leader = if distance > LEADER { 5.0 } else { 0.0 };
        if stray * distance + leader >= chosen.0 {
            break;
        }
        for k in 0..DIRECTIONS {
            let (s, c) = (f64::from(k) * std::f64::consts::TAU / f64::from(DIRECTIONS)).sin_cos();
            let reach = distance + start + c.abs() * half_width + s.abs() * half_height;
            let area = Area { x: anchor.x + c * reach, y: anchor.y + s * reach, half_width, half_height };
            let mut cost = leader + stray * distance + 40.0 * area.outside(frame) + 4.5 * ink.under(&area);
            if cost >= chosen.0 {
                continue;
            }
            cost += 1.2 * others.overlap(&area);
            if leader > 0.0 && cost < chosen.0 {
                cost += 25.0 * crossings(area.border_towards(&anchor), (anchor.x, anchor.y), others);
            }
            if cost < chosen.0 {
                chosen = (cost, area);
            }
        }
    }
    chosen.1
}

/// Number of labels that a leader line would cross.
fn crossings(from: (f64, f64), to: (f64, f64), others: &Bands) -> f64 {
    let runs_through = |area: &&Area| {
        (1..20).any(|k| {
            let part = f64::from(k) / 20.0;
            let (x, y) = (from.0 + (to.0 - from.0) * part, from.1 + (to.1 - from.1) * part);
            (x - area.x).abs() < area.half_width && (y - area.y).abs() < area.half_height
        })
    };
    others.near(from.1.min(to.1), from.1.max(to.1)).filter(runs_through).count() as f64
}
