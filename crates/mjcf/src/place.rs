//! Poses: every form of an orientation.

use crate::document::Item;
use denavit_model::nalgebra::{Matrix3, Quaternion, Rotation3, UnitQuaternion, Vector3};
use denavit_model::se3::{self, Pose};
use std::ops::RangeInclusive;

/// How the model counts angles, and which turns an Euler triple means.
#[derive(Debug, Clone)]
pub struct Angles {
    /// rad for 1 of the model's unit.
    pub unit: f64,
    /// Letters x, y, z; capital: about the fixed axes.
    pub sequence: String,
}

/// The numbers of an attribute, or a sentence on what is wrong.
pub fn numbers(item: &Item, attribute: &str, counts: RangeInclusive<usize>) -> Result<Option<Vec<f64>>, String> {
    let mut found = Vec::new();
    Ok(each_number(item, attribute, counts, |number| found.push(number))?.map(|()| found))
}

/// This many numbers.
pub fn fixed<const N: usize>(item: &Item, attribute: &str) -> Result<Option<[f64; N]>, String> {
    let (mut found, mut count) = ([0.0; N], 0);
    let read = each_number(item, attribute, N..=N, |number| {
        if let Some(slot) = found.get_mut(count) {
            *slot = number;
        }
        count += 1;
    });
    Ok(read?.map(|()| found))
}

fn each_number(
    item: &Item,
    attribute: &str,
    counts: RangeInclusive<usize>,
    mut take: impl FnMut(f64),
) -> Result<Option<()>, String> {
    let Some(written) = item.get(attribute) else { return Ok(None) };
    let mut found = 0;
    for word in written.split_ascii_whitespace() {
        let number = word.parse::<f64>().ok().filter(|number| number.is_finite());
        let Some(number) = number else {
            return Err(format!("{attribute}=\"{written}\": \"{word}\" is not a number; write a finite number"));
        };
        take(number);
        found += 1;
    }
    if !counts.contains(&found) {
        let (least, most) = (counts.start(), counts.end());
        let wanted = if least == most { format!("{least}") } else { format!("{least} to {most}") };
        return Err(format!("{attribute}=\"{written}\" has {found} number(s); write {wanted}"));
    }
    Ok(Some(()))
}

/// One number.
pub fn number(item: &Item, attribute: &str) -> Result<Option<f64>, String> {
    Ok(fixed::<1>(item, attribute)?.map(|[found]| found))
}

/// Three numbers.
pub fn vector(item: &Item, attribute: &str) -> Result<Option<Vector3<f64>>, String> {
    Ok(fixed::<3>(item, attribute)?.map(Vector3::from))
}

fn unit(v: Vector3<f64>, attribute: &str) -> Result<Vector3<f64>, String> {
    let length = v.norm();
    if length < 1e-14 {
        return Err(format!("{attribute} has a direction of length 0; write a non-zero one"));
    }
    Ok(v / length)
}

/// The rotation of an element by `quat`, `axisangle`, `euler`, `xyaxes` or `zaxis`; none of them: no turn.
pub fn rotation(item: &Item, angles: &Angles) -> Result<Rotation3<f64>, String> {
    let named = ["quat", "axisangle", "euler", "xyaxes", "zaxis"].into_iter().filter(|name| item.get(name).is_some());
    if named.clone().nth(1).is_some() {
        let named: Vec<&str> = named.collect();
        return Err(format!("states its orientation as {} at once; keep one of them", named.join(" and ")));
    }
    if let Some(q) = fixed::<4>(item, "quat")? {
        let quaternion = Quaternion::new(q[0], q[1], q[2], q[3]);
        let Some(quaternion) = UnitQuaternion::try_new(quaternion, 1e-14) else {
            return Err("quat has length 0; write w x y z of a rotation, such as 1 0 0 0".into());
        };
        return Ok(quaternion.to_rotation_matrix());
    }
    if let Some(a) = fixed::<4>(item, "axisangle")? {
        let direction = unit(Vector3::new(a[0], a[1], a[2]), "axisangle")?;
        return Ok(se3::rotation_about(&direction, a[3] * angles.unit));
    }
    if let Some(e) = vector(item, "euler")? {
        let mut result = Rotation3::identity();
        for (letter, angle) in angles.sequence.chars().zip(e.iter()) {
            let axis = match letter.to_ascii_lowercase() {
                'x' => Vector3::x(),
                'y' => Vector3::y(),
                _ => Vector3::z(),
            };
            let turn = se3::rotation_about(&axis, angle * angles.unit);
            result = if letter.is_ascii_lowercase() { result * turn } else { turn * result };
        }
        return Ok(result);
    }
    if let Some(v) = fixed::<6>(item, "xyaxes")? {
        let x = unit(Vector3::new(v[0], v[1], v[2]), "xyaxes")?;
        let y = Vector3::new(v[3], v[4], v[5]);
        let y = unit(y - x * x.dot(&y), "xyaxes")?;
        return Ok(Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[x, y, x.cross(&y)])));
    }
    if let Some(z) = vector(item, "zaxis")? {
        return Ok(to_z(&unit(z, "zaxis")?));
    }
    Ok(Rotation3::identity())
}

/// The least rotation that takes z to a unit direction; a half turn about x where that is opposite.
pub fn to_z(direction: &Vector3<f64>) -> Rotation3<f64> {
    if direction.x == 0.0 && direction.y == 0.0 {
        return if direction.z < 0.0 {
            se3::rotation_about(&Vector3::x(), std::f64::consts::PI)
        } else {
            Rotation3::identity()
        };
    }
    se3::least_rotation(&Vector3::z(), direction)
}

/// parent_from_element.
pub fn pose(item: &Item, angles: &Angles) -> Result<Pose, String> {
    Ok(se3::pose(rotation(item, angles)?, vector(item, "pos")?.unwrap_or_default()))
}

/// Where a `fromto` puts an element, and half its length, m.
pub fn from_to(item: &Item) -> Result<Option<(Pose, f64)>, String> {
    let Some(v) = fixed::<6>(item, "fromto")? else { return Ok(None) };
    let (from, to) = (Vector3::new(v[0], v[1], v[2]), Vector3::new(v[3], v[4], v[5]));
    let along = unit(from - to, "fromto")?;
    Ok(Some((se3::pose(to_z(&along), (from + to) / 2.0), (from - to).norm() / 2.0)))
}
