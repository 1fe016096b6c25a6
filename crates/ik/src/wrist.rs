//! Arms whose last three axes meet in a point: position by the first three joints, orientation by the last.

use crate::arm::{Angle, Axis, SixR, rotated, turn_between};
use crate::circles::{Line, Row, pairs, turned_dot};
use denavit_model::Pose;
use denavit_model::nalgebra::Vector3;

/// Axes this close to perpendicular, rad, are: what is left is rounding of their directions.
const PERPENDICULAR: f64 = 1e-15;

/// Calls `found` with all joint values (rad) at which `arm` reaches `target`, and near misses for Newton's method.
///
/// With w the wrist's centre and D = target · home⁻¹: e2 e3 w = e1⁻¹ D w. Height along axis 2 and distance from a point on it
/// do not depend on joint 2, so two equations hold joints 1 and 3 alone ([`pairs`]); joint 2 follows. Then
/// R4 R5 R6 = (R1 R2 R3)⁻¹ D, by the angle that axis 6 makes with axis 4.
///
/// Where axis 5 is perpendicular to both, a wrist that is flipped has joints 4 and 6 half a turn away:
/// R4(π) R5(m - h) R6(π) = R5(m + h), with m the value of joint 5 at which axes 4 and 6 are one.
///
/// # Source
/// Pieper 1968; subproblems 1 to 5 of Elias, Wen, "IK-Geo", 2022.
pub(crate) fn solve(arm: &SixR, target: &Pose, slack: f64, mut found: impl FnMut(&[Angle; 6])) {
    let [one, two, three, four, five, six] = &arm.axes;
    let centre = six.point;
    let moved = target * arm.home.inverse();
    let wanted = moved.rotation * centre + moved.translation.vector;
    let (from_one, from_three) = (wanted - one.point, centre - three.point);
    let height = |g: &Vector3<f64>| {
        let (a, a0) = turned_dot(&-one.direction, g, &from_one);
        let (b, b0) = turned_dot(&three.direction, g, &from_three);
        (a, a0, b, b0)
    };
    // u2·(e1⁻¹ D w) = u2·(e3 w)
    let (a, a0, b, b0) = height(&two.direction);
    let first = Row { a, b: -b, k: b0 - a0 + two.direction.dot(&(three.point - one.point)) };
    // |e1⁻¹ D w - p2|² = |e3 w - p2|²
    let (to_one, to_three) = (one.point - two.point, three.point - two.point);
    let (a, a0) = turned_dot(&-one.direction, &to_one, &from_one);
    let (b, b0) = turned_dot(&three.direction, &to_three, &from_three);
    let squares = to_three.norm_squared() + from_three.norm_squared() - to_one.norm_squared() - from_one.norm_squared();
    let second = Row { a: a * 2.0, b: b * -2.0, k: squares + 2.0 * (b0 - a0) };
    let (on_fifth, constant) = turned_dot(&five.direction, &four.direction, &six.direction);
    let fifth_line = Line::of(on_fifth);
    let across = |axis: &Axis| five.direction.dot(&axis.direction).abs() < PERPENDICULAR;
    let flips = across(four) && across(six);
    let (fifth, sixth) = (moved.rotation * five.direction, moved.rotation * six.direction);
    for (v1, v3) in pairs(first, second, slack).as_slice() {
        let (r1, r3) = (one.rotation(*v1), three.rotation(*v3));
        let start = three.point + r3 * from_three - two.point;
        let end = one.point + r1.inverse_transform_vector(&from_one) - two.point;
        let v2 = turn_between(&two.direction, &start, &end);
        // R4 R5 R6 = (R1 R2 R3)⁻¹ D
        let r2 = two.rotation(v2);
        let back = |x| r3.inverse_transform_vector(&r2.inverse_transform_vector(&r1.inverse_transform_vector(x)));
        let (fifth, sixth) = (back(&fifth), back(&sixth));
        let values_of_fifth = fifth_line.at(four.direction.dot(&sixth) - constant, slack);
        let with = |v5: Angle| {
            let r5 = five.rotation(v5);
            let v4 = turn_between(&four.direction, &(r5 * six.direction), &sixth);
            let turned = r5.inverse_transform_vector(&rotated(&four.direction, -v4, &fifth));
            let v6 = turn_between(&six.direction, &five.direction, &turned);
            [*v1, v2, *v3, v4, v5, v6]
        };
        match values_of_fifth.as_slice() {
            [one, other] if flips => {
                let values = with(*one);
                found(&values);
                let [v1, v2, v3, v4, _, v6] = values;
                found(&[v1, v2, v3, v4.opposite(), *other, v6.opposite()]);
            }
            all => all.iter().for_each(|v5| found(&with(*v5))),
        }
    }
}
