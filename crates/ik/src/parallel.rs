//! Arms whose joints 2, 3 and 4 are parallel: together they make a planar motion.

use crate::arm::{Angle, SixR, rotated, turn_between};
use crate::circles::{Row, on_line, pairs, turned_dot};
use denavit_model::Pose;
use denavit_model::nalgebra::{Vector2, Vector3};

/// Calls `found` with all joint values (rad) at which `arm` reaches `target`, and near misses for Newton's method.
///
/// With u the common direction, E = e2 e3 e4 and D = target · home⁻¹: e1⁻¹ D = E e5 e6. E keeps u and the height along u, so
///
/// ```text
/// u6·(D⁻¹ R1 u)      = u6·(R5⁻¹ u)         (direction of axis 6)
/// u·(e1⁻¹ D p6)      = u·(e5 p6)           (height of a point of axis 6)
/// ```
/// hold joints 1 and 5 alone ([`pairs`]). Joint 6 takes R5⁻¹ u to D⁻¹ R1 u; joints 2, 3 and 4 are a planar arm.
pub(crate) fn solve(arm: &SixR, target: &Pose, slack: f64, mut found: impl FnMut(&[Angle; 6])) {
    let [one, two, three, four, five, six] = &arm.axes;
    let u = two.direction;
    let moved = target * arm.home.inverse();
    let sixth = moved.rotation * six.direction;
    let (a, a0) = turned_dot(&one.direction, &sixth, &u);
    let (b, b0) = turned_dot(&five.direction, &u, &six.direction);
    let direction = Row { a, b: -b, k: b0 - a0 };
    let wanted = moved.rotation * six.point + moved.translation.vector - one.point;
    let (a, a0) = turned_dot(&-one.direction, &u, &wanted);
    let (b, b0) = turned_dot(&five.direction, &u, &(six.point - five.point));
    let height = Row { a, b: -b, k: b0 - a0 + u.dot(&(five.point - one.point)) };
    let back = moved.rotation.inverse();
    let senses = [u.dot(&three.direction), u.dot(&four.direction)];
    let across = |x: Vector3<f64>| x - u * u.dot(&x);
    let upper = across(three.point - two.point);
    let fore = across(four.point - three.point);
    for (v1, v5) in pairs(direction, height, slack).as_slice() {
        let (r1, r5) = (one.rotation(*v1), five.rotation(*v5));
        let start = r5.inverse_transform_vector(&u);
        let end = back * (r1 * u);
        // R6⁻¹ takes start to end.
        let v6 = -turn_between(&six.direction, &start, &end);
        let r6 = six.rotation(v6);
        // E carries p4 to where the rest of the arm wants it, and turns by the sum of the three angles.
        let place = |x: &Vector3<f64>| {
            let x = five.point + r5.inverse_transform_vector(&(x - five.point));
            let x = six.point + r6.inverse_transform_vector(&(x - six.point));
            let x = moved.rotation * x + moved.translation.vector;
            one.point + r1.inverse_transform_vector(&(x - one.point))
        };
        let reach = across(place(&four.point) - two.point);
        // |upper + R3 fore|² = |reach|²
        let (length, rest) = (upper.dot(&fore), reach.norm_squared() - upper.norm_squared() - fore.norm_squared());
        let a = Vector2::new(2.0 * length, 2.0 * upper.dot(&u.cross(&fore)));
        // Joint 5 turns about it.
        let axis = five.direction;
        let turned = r1.inverse_transform_vector(&(moved.rotation * r6.inverse_transform_vector(&axis)));
        let whole = turn_between(&u, &axis, &turned);
        for third in on_line(a, rest, slack).as_slice() {
            let second = turn_between(&u, &(upper + rotated(&u, *third, &fore)), &reach);
            let fourth = whole.plus(-second.plus(*third));
            let sensed = |angle: Angle, sense: f64| if sense < 0.0 { -angle } else { angle };
            found(&[*v1, second, sensed(*third, senses[0]), sensed(fourth, senses[1]), *v5, v6]);
        }
    }
}
