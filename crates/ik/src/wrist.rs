//! Arms whose last three axes meet in a point: position by the first three joints, orientation by the last.

use crate::arm::{SixR, rotated, turn_between};
use crate::circles::{Few, Row, on_line, pairs, turned_dot};
use denavit_model::Pose;
use denavit_model::nalgebra::Vector3;

/// All joint values (rad) at which `arm` reaches `target`, and near misses for Newton's method.
///
/// With w the wrist's centre and D = target · home⁻¹: e2 e3 w = e1⁻¹ D w. Height along axis 2 and distance from a point on it
/// do not depend on joint 2, so two equations hold joints 1 and 3 alone ([`pairs`]); joint 2 follows. Then
/// R4 R5 R6 = (R1 R2 R3)⁻¹ D, by the angle that axis 6 makes with axis 4.
///
/// # Source
/// Pieper 1968; subproblems 1 to 5 of Elias, Wen, "IK-Geo", 2022.
pub(crate) fn solve(arm: &SixR, target: &Pose, slack: f64) -> Few<[f64; 6], 8> {
    let mut found = Few::new([0.0; 6]);
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
    for (v1, v3) in pairs(first, second, slack).as_slice() {
        let start = three.turn(*v3, &centre) - two.point;
        let end = one.turn(-v1, &wanted) - two.point;
        let v2 = turn_between(&two.direction, &start, &end);
        let back = |x: Vector3<f64>| {
            let x = rotated(&one.direction, -v1, &x);
            rotated(&three.direction, -v3, &rotated(&two.direction, -v2, &x))
        };
        let sixth = back(moved.rotation * six.direction);
        let (a, constant) = turned_dot(&five.direction, &four.direction, &six.direction);
        for v5 in on_line(a, four.direction.dot(&sixth) - constant, slack).as_slice() {
            let v4 = turn_between(&four.direction, &rotated(&five.direction, *v5, &six.direction), &sixth);
            let fifth = rotated(&four.direction, -v4, &back(moved.rotation * five.direction));
            let v6 = turn_between(&six.direction, &five.direction, &rotated(&five.direction, -v5, &fifth));
            found.push([*v1, v2, *v3, v4, *v5, v6]);
        }
    }
    found
}
