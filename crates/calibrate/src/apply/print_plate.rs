//! Files to make a [`Plate`]: a solid to print (STL) and a drawing at its true size (SVG), which on paper serves for a pen.
//!
//! Every hole is a cone of 90°, so that a ball or a point sits in its middle. A corner cut off marks hole A1.

use denavit_export::numbers::decimal;
use denavit_measurements::plate::Plate;
use denavit_model::hull::Triangle;
use denavit_model::nalgebra::{Vector2, Vector3};
use std::fmt::Write as _;
use thiserror::Error;

/// A hole's mouth by the ball's diameter: a cone of 90° touches a ball at 0.71 of it, and a printed edge is not sharp.
const MOUTH: f64 = 0.85;
/// What is left between two holes and below a hole, m: several lines and layers of a usual nozzle of 0.4 mm.
const WALL: f64 = 2e-3;
/// Straight pieces of a cell's side; four times as many of a hole's circle.
const PIECES: usize = 8;
/// Length of the line by which a print on paper is checked, m.
const CHECKED: f64 = 0.05;

/// A plate that cannot be made.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
#[error(
    "holes for a ball of {ball_mm} mm are {mouth_mm:.1} mm wide, and a spacing of {pitch_mm} mm leaves no wall of {wall_mm} mm; choose a smaller ball or a larger spacing"
)]
pub struct PrintPlateError {
    /// Diameter of the ball, mm.
    pub ball_mm: f64,
    /// Diameter of a hole, mm.
    pub mouth_mm: f64,
    /// From hole to hole, mm.
    pub pitch_mm: f64,
    /// Least wall, mm.
    pub wall_mm: f64,
}

/// A plate as a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PrintPlate {
    plate: Plate,
    ball: f64,
}

impl PrintPlate {
    /// A plate for a ball of this diameter, m.
    ///
    /// # Errors
    /// Holes that leave no wall between them, or a diameter that is no positive number.
    pub fn new(plate: Plate, ball: f64) -> Result<Self, PrintPlateError> {
        let made = Self { plate, ball };
        if ball > 0.0 && made.mouth() + WALL <= plate.pitch {
            return Ok(made);
        }
        let [ball_mm, mouth_mm, pitch_mm, wall_mm] = [ball, made.mouth(), plate.pitch, WALL].map(|value| value * 1e3);
        Err(PrintPlateError { ball_mm, mouth_mm, pitch_mm, wall_mm })
    }

    /// Diameter of a hole, m.
    pub fn mouth(&self) -> f64 {
        MOUTH * self.ball
    }

    /// Depth of a hole, m.
    pub fn depth(&self) -> f64 {
        self.mouth() / 2.0
    }

    /// Thickness of the plate, m.
    pub fn thickness(&self) -> f64 {
        self.depth() + WALL
    }

    /// Height of the ball's centre above the plate, m.
    pub fn ball_height(&self) -> f64 {
        self.ball / std::f64::consts::SQRT_2 - self.depth()
    }

    /// Size of the plate, m: along x and y.
    pub fn size(&self) -> [f64; 2] {
        [self.plate.columns, self.plate.rows].map(|count| count as f64 * self.plate.pitch)
    }

    /// A solid as ASCII STL, mm: hole A1 is at the origin, the plate's upper face at z = 0.
    pub fn stl(&self) -> String {
        let mut text = String::from("solid plate\n");
        for corners in self.triangles() {
            let normal = (corners[1] - corners[0]).cross(&(corners[2] - corners[0])).normalize();
            let _ = writeln!(text, "facet normal {:.6} {:.6} {:.6}\n outer loop", normal.x, normal.y, normal.z);
            for corner in corners.map(|corner| corner * 1e3) {
                let _ = writeln!(text, "  vertex {:.6} {:.6} {:.6}", corner.x, corner.y, corner.z);
            }
            text.push_str(" endloop\nendfacet\n");
        }
        text + "endsolid plate\n"
    }

    /// A point of the grid that cells share: `PIECES` to a cell; the corner at A1 is cut off.
    fn grid(&self, across: usize, up: usize) -> Vector3<f64> {
        let place = |index: usize| (index as f64 / PIECES as f64 - 0.5) * self.plate.pitch;
        let cut = if (across, up) == (0, 0) { 0.5 * self.plate.pitch / PIECES as f64 } else { 0.0 };
        Vector3::new(place(across) + cut, place(up) + cut, 0.0)
    }

    /// The edge of a block of cells (columns, rows), counter-clockwise from above, from its lower left corner.
    fn edge(&self, [left, low]: [usize; 2], [columns, rows]: [usize; 2]) -> Vec<Vector3<f64>> {
        let [width, height] = [columns * PIECES, rows * PIECES];
        let [x, y] = [left * PIECES, low * PIECES];
        let below = (0..width).map(|at| (x + at, y));
        let right = (0..height).map(|at| (x + width, y + at));
        let above = (0..width).map(|at| (x + width - at, y + height));
        let back = (0..height).map(|at| (x, y + height - at));
        below.chain(right).chain(above).chain(back).map(|(across, up)| self.grid(across, up)).collect()
    }

    /// The surface, each triangle counter-clockwise from outside, m.
    fn triangles(&self) -> Vec<Triangle> {
        let mut found = Vec::new();
        for row in 0..self.plate.rows {
            for column in 0..self.plate.columns {
                let middle = Vector3::new(column as f64, row as f64, 0.0) * self.plate.pitch;
                let edge = self.edge([column, row], [1, 1]);
                let rim: Vec<Vector3<f64>> =
                    edge.iter().map(|point| middle + (point - middle).normalize() * (self.mouth() / 2.0)).collect();
                let bottom = middle - Vector3::z() * self.depth();
                for at in 0..edge.len() {
                    let next = (at + 1) % edge.len();
                    found.push([edge[at], edge[next], rim[next]]);
                    found.push([edge[at], rim[next], rim[at]]);
                    found.push([rim[at], rim[next], bottom]);
                }
            }
        }
        let down = Vector3::z() * self.thickness();
        let edge = self.edge([0, 0], [self.plate.columns, self.plate.rows]);
        let middle = edge.iter().sum::<Vector3<f64>>() / edge.len() as f64 - down;
        for at in 0..edge.len() {
            let [here, next] = [edge[at], edge[(at + 1) % edge.len()]];
            found.push([here - down, next - down, next]);
            found.push([here - down, next, here]);
            found.push([next - down, here - down, middle]);
        }
        found
    }

    /// A drawing at its true size as SVG, seen from above.
    pub fn drawing(&self) -> String {
        const MARGIN: f64 = 12.0;
        let [width, height] = self.size().map(|size| size * 1e3);
        let pitch = self.plate.pitch * 1e3;
        let place = |at: Vector2<f64>| [at.x * 1e3 + pitch / 2.0 + MARGIN, MARGIN + height - pitch / 2.0 - at.y * 1e3];
        let mm = |value: f64| decimal(value, 6);
        let [page_width, page_height] = [width + 2.0 * MARGIN, height + 3.0 * MARGIN];
        let mut text = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}mm\" height=\"{h}mm\" viewBox=\"0 0 {w} {h}\" font-family=\"sans-serif\" font-size=\"4\" stroke-width=\"0.2\">\n",
            w = mm(page_width),
            h = mm(page_height)
        );
        let outline: Vec<String> = self
            .edge([0, 0], [self.plate.columns, self.plate.rows])
            .iter()
            .map(|point| place(Vector2::new(point.x, point.y)).map(mm).join(","))
            .collect();
        let _ = writeln!(text, "<polygon points=\"{}\" fill=\"none\" stroke=\"black\"/>", outline.join(" "));
        let radius = self.mouth() * 500.0;
        for (name, at) in self.plate.holes() {
            let [x, y] = place(at);
            let (left, right, above, below) = (x - radius, x + radius, y - radius, y + radius);
            let _ = writeln!(
                text,
                "<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"none\" stroke=\"black\"/><path d=\"M{} {}H{}M{} {}V{}\" stroke=\"black\"/><text x=\"{}\" y=\"{}\">{name}</text>",
                mm(x),
                mm(y),
                mm(radius),
                mm(left),
                mm(y),
                mm(right),
                mm(x),
                mm(above),
                mm(below),
                mm(right + 1.0),
                mm(above)
            );
        }
        let foot = height + 2.0 * MARGIN;
        let _ = writeln!(
            text,
            "<path d=\"M{MARGIN} {foot}h{length}m0 -2v4m-{length} 0v-4\" fill=\"none\" stroke=\"black\"/><text x=\"{MARGIN}\" y=\"{below}\">{length} mm: measure this line. {plate}; ball {ball} mm.</text>\n</svg>",
            foot = mm(foot),
            length = mm(CHECKED * 1e3),
            below = mm(foot + 6.0),
            plate = self.plate,
            ball = mm(self.ball * 1e3),
        );
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use denavit_model::hull::signed_volume;
    use std::collections::BTreeMap;

    fn plate() -> PrintPlate {
        PrintPlate::new("4x3:40mm".parse().unwrap(), 0.01).unwrap()
    }

    #[test]
    fn the_solid_is_closed_and_has_the_volume_of_a_plate_less_its_cones() {
        let made = plate();
        let mut edges: BTreeMap<[String; 2], i32> = BTreeMap::new();
        let volume = signed_volume(made.triangles());
        for corners in made.triangles() {
            let names = corners.map(|corner| {
                format!("{:.9} {:.9} {:.9}", corner.x, corner.y, corner.z).replace("-0.000000000", "0.000000000")
            });
            for at in 0..3 {
                let [from, to] = [&names[at], &names[(at + 1) % 3]];
                assert_ne!(from, to);
                // Each edge is gone along once in either sense.
                let (key, sense) = if from < to { ([from, to], 1) } else { ([to, from], -1) };
                *edges.entry(key.map(Clone::clone)).or_default() += sense;
            }
        }
        assert!(edges.values().all(|sum| *sum == 0));
        let cut = (0.04 / PIECES as f64).powi(2) / 2.0;
        let whole = (0.16 * 0.12 - cut) * made.thickness();
        let cones = 12.0 * std::f64::consts::PI * (made.mouth() / 2.0).powi(2) * made.depth() / 3.0;
        // The circles are polygons of 32 corners.
        assert!((volume - (whole - cones)).abs() < 0.02 * cones, "{volume} {whole} {cones}");
    }

    #[test]
    fn a_ball_touches_its_cone_within_the_mouth() {
        let made = plate();
        // A ball in a cone of 90 degrees touches it at half its diameter times cos 45° from the axis.
        assert!(0.01 / std::f64::consts::SQRT_2 < made.mouth());
        assert!(made.ball_height() > 0.0 && made.ball_height() < 0.005);
    }

    #[test]
    fn holes_that_meet_are_refused() {
        assert!(PrintPlate::new("4x3:10mm".parse().unwrap(), 0.01).is_err());
        assert!(PrintPlate::new("4x3:10mm".parse().unwrap(), f64::NAN).is_err());
    }

    #[test]
    fn the_drawing_names_every_hole() {
        let text = plate().drawing();
        assert!(text.starts_with("<svg") && text.contains(">C4<") && text.contains("width=\"184mm\""), "{text}");
    }
}
