//! The solid that a mesh file bounds: STL, binary or text, OBJ, and MuJoCo's own MSH.

use crate::mass::Solid;
use denavit_model::hull::{Hull, Triangle, in_no_order};
use denavit_model::nalgebra::{Matrix3, Vector3};

/// Corners of each triangle, m.
pub type Triangles = Vec<Triangle>;

/// More triangles are refused.
const MOST: usize = 5_000_000;

/// The triangles of a mesh file, by its content and its name's ending: STL, binary or text, and OBJ; in the file's numbers.
///
/// # Errors
/// Another kind of file, or one that does not hold what it should; a sentence.
pub fn triangles(name: &str, bytes: &[u8]) -> Result<Triangles, String> {
    let ending = name.rsplit('.').next().unwrap_or_default().to_ascii_lowercase();
    let found = match ending.as_str() {
        "stl" => stl(bytes),
        "obj" => obj(bytes),
        "msh" => msh(bytes),
        _ => return Err(format!("a .{ending} file cannot be used for a volume; give the body an <inertial>")),
    }?;
    if found.is_empty() {
        return Err("it has no triangles".into());
    }
    Ok(found)
}

fn stl(bytes: &[u8]) -> Result<Triangles, String> {
    let count = bytes.get(80..84).map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize);
    if let Some(count) = count.filter(|count| *count <= MOST && bytes.len() == 84 + count * 50) {
        let number =
            |at: usize| f64::from(f32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]));
        let corner = |at: usize| Vector3::new(number(at), number(at + 4), number(at + 8));
        return Ok((0..count)
            .map(|index| 84 + index * 50 + 12)
            .map(|at| [corner(at), corner(at + 12), corner(at + 24)])
            .collect());
    }
    let text = std::str::from_utf8(bytes)
        .map_err(|_| "it is not a valid STL file: its length does not match its count".to_owned())?;
    let mut corners = Vec::new();
    for line in text.lines().map(str::trim).filter(|line| line.starts_with("vertex")) {
        corners.push(point(line.split_whitespace().skip(1))?);
    }
    Ok(corners.chunks_exact(3).map(|three| [three[0], three[1], three[2]]).collect())
}

/// Four counts, of vertices, normals, texture coordinates and faces; then these, numbers of 32 bits.
fn msh(bytes: &[u8]) -> Result<Triangles, String> {
    let word = |index: usize| bytes.get(4 * index..4 * index + 4).map(|b| [b[0], b[1], b[2], b[3]]);
    let count = |index: usize| {
        let count = word(index).map(i32::from_le_bytes).and_then(|count| usize::try_from(count).ok());
        count.filter(|count| *count <= MOST)
    };
    let wrong = "it is not a valid MuJoCo MSH file: its length does not match its counts";
    let [Some(points), Some(normals), Some(coordinates), Some(faces)] = [0, 1, 2, 3].map(count) else {
        return Err(wrong.into());
    };
    let first = 4 + 3 * points + 3 * normals + 2 * coordinates;
    if bytes.len() != 4 * (first + 3 * faces) {
        return Err(wrong.into());
    }
    let point = |index: usize| {
        let numbers = [0, 1, 2].map(|k| word(4 + 3 * index + k).map(f32::from_le_bytes).map(f64::from));
        let [Some(x), Some(y), Some(z)] = numbers else { return None };
        [x, y, z].iter().all(|number| number.is_finite()).then(|| Vector3::new(x, y, z))
    };
    let corner = |at: usize| {
        let index = word(at).map(i32::from_le_bytes).and_then(|index| usize::try_from(index).ok());
        index
            .filter(|index| *index < points)
            .and_then(point)
            .ok_or("a face names a vertex that is not there".to_owned())
    };
    let face = |index: usize| {
        let at = first + 3 * index;
        Ok([corner(at)?, corner(at + 1)?, corner(at + 2)?])
    };
    (0..faces).map(face).collect()
}

fn point<'a>(words: impl Iterator<Item = &'a str>) -> Result<Vector3<f64>, String> {
    let found: Vec<f64> = words.take(3).filter_map(|word| word.parse().ok()).filter(|x: &f64| x.is_finite()).collect();
    match found[..] {
        [x, y, z] => Ok(Vector3::new(x, y, z)),
        _ => Err("a vertex does not have three numbers".into()),
    }
}

fn obj(bytes: &[u8]) -> Result<Triangles, String> {
    let text = String::from_utf8_lossy(bytes);
    let (mut points, mut found) = (Vec::new(), Triangles::new());
    for line in text.lines() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => points.push(point(words)?),
            Some("f") => {
                let mut corners = Vec::new();
                for word in words {
                    let index = word.split('/').next().and_then(|index| index.parse::<i64>().ok());
                    let at = index.and_then(|index| {
                        let count = i64::try_from(points.len()).ok()?;
                        usize::try_from(if index < 0 { count + index } else { index - 1 }).ok()
                    });
                    let corner = at.and_then(|at| points.get(at)).ok_or("a face names a vertex that is not there")?;
                    corners.push(*corner);
                }
                for index in 1..corners.len().saturating_sub(1) {
                    found.push([corners[0], corners[index], corners[index + 1]]);
                }
            }
            _ => {}
        }
        if found.len() > MOST {
            return Err("it has too many triangles".into());
        }
    }
    Ok(found)
}

/// How a mesh bounds its solid.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Inside {
    /// Each triangle's tetrahedron counts as positive: MuJoCo's `legacy`, right for what is star-shaped.
    Absolute,
    /// Signed: MuJoCo's `exact`, right for every closed surface.
    Signed,
    /// The convex hull: MuJoCo's `convex`.
    Hull,
    /// Nothing: the surface has the mass, MuJoCo's `shell`.
    Nothing,
}

/// The solid of a density of 1 kg/m³ inside a mesh, or its surface of 1 kg/m².
pub fn solid(triangles: &Triangles, inside: Inside) -> Result<Solid, String> {
    if inside == Inside::Hull {
        let hull = Hull::of(&in_no_order(triangles.as_flattened()));
        let hull = hull.ok_or("its points lie in a plane, so they have no hull")?;
        return solid(&hull.triangles().collect(), Inside::Signed);
    }
    // From the centre of the surface, as MuJoCo does.
    let mut area = 0.0;
    let mut middle = Vector3::zeros();
    for [a, b, c] in triangles {
        let own = (b - a).cross(&(c - a)).norm() / 2.0;
        area += own;
        middle += (a + b + c) * (own / 3.0);
    }
    if area <= 0.0 {
        return Err("its triangles have no area".into());
    }
    middle /= area;
    if inside == Inside::Nothing {
        let mut second = Matrix3::zeros();
        for corners in triangles {
            let own = (corners[1] - corners[0]).cross(&(corners[2] - corners[0])).norm() / 2.0;
            let [a, b, c] = corners.map(|corner| corner - middle);
            let sum = a + b + c;
            let squares = a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose();
            second += squares * (own / 12.0);
        }
        return Ok(Solid { volume: area, centre: middle, tensor: Matrix3::identity() * second.trace() - second });
    }
    let volume_of = |[a, b, c]: [Vector3<f64>; 3]| {
        let signed = a.dot(&b.cross(&c)) / 6.0;
        if inside == Inside::Absolute { signed.abs() } else { signed }
    };
    let (mut volume, mut centre) = (0.0, Vector3::zeros());
    for corners in triangles {
        let [a, b, c] = corners.map(|corner| corner - middle);
        let own = volume_of([a, b, c]);
        volume += own;
        centre += (a + b + c) * (own / 4.0);
    }
    if volume <= 1e-18 {
        return Err("it bounds no volume".into());
    }
    let centre = middle + centre / volume;
    let mut second = Matrix3::zeros();
    for corners in triangles {
        let [a, b, c] = corners.map(|corner| corner - centre);
        let own = volume_of([a, b, c]);
        let sum = a + b + c;
        second += (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose()) * (own / 20.0);
    }
    Ok(Solid { volume, centre, tensor: Matrix3::identity() * second.trace() - second })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cuboid's twelve triangles, outward.
    fn cuboid(at: Vector3<f64>, half: [f64; 3]) -> Triangles {
        let corner = |sx: f64, sy: f64, sz: f64| at + Vector3::new(sx * half[0], sy * half[1], sz * half[2]);
        let mut found = Vec::new();
        for axis in 0..3 {
            for sign in [-1.0, 1.0] {
                let turn = |u: f64, v: f64| {
                    let mut s = [0.0; 3];
                    (s[axis], s[(axis + 1) % 3], s[(axis + 2) % 3]) = (sign, u * sign, v);
                    corner(s[0], s[1], s[2])
                };
                let [a, b, c, d] = [turn(-1.0, -1.0), turn(1.0, -1.0), turn(1.0, 1.0), turn(-1.0, 1.0)];
                found.extend([[a, b, c], [a, c, d]]);
            }
        }
        found
    }

    #[test]
    fn a_cuboid_of_triangles_is_the_cuboid() {
        let (at, half) = (Vector3::new(0.3, -0.2, 0.7), [0.1, 0.2, 0.3]);
        for inside in [Inside::Absolute, Inside::Signed] {
            let found = solid(&cuboid(at, half), inside).unwrap();
            let whole = Solid::cuboid(half);
            assert!((found.volume - whole.volume).abs() < 1e-15 && (found.centre - at).norm() < 1e-15);
            assert!((found.tensor - whole.tensor).norm() < 1e-15, "{} {}", found.tensor, whole.tensor);
        }
    }

    #[test]
    fn both_kinds_of_file_are_read() {
        let obj = b"v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1/1 2/2 4/3\nf -4 -1 -2\nf 2 3 4\n";
        let found = solid(&triangles("a.OBJ", obj).unwrap(), Inside::Signed).unwrap();
        assert!((found.volume - 1.0 / 6.0).abs() < 1e-15);
        let text = "solid\n vertex 0 0 0\n vertex 1 0 0\n vertex 0 1 0\nendsolid";
        assert_eq!(triangles("a.stl", text.as_bytes()).unwrap().len(), 1);
        assert!(triangles("a.stl", b"").is_err() && triangles("a.dae", b"x").is_err());
    }
}
