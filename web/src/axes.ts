// Axes of twists, and their common normals, for drawing.

import { Vector3 } from "three";

export interface Line {
    name: string;
    kind: string;
    direction: Vector3;
    point: Vector3;
}

export interface Normal {
    /** Feet of the common normal on the two axes. */
    feet: [Vector3, Vector3];
    length: number;
    angle: number;
    parallel: boolean;
}

/** Axes nearer to parallel than this have no unique common normal, rad. */
const PARALLEL = 1e-6;

/** The axis of a twist (ω, v): its direction, and its point nearest to where the joint is; a direction alone is drawn there. */
export function axis(name: string, kind: string, twist: number[], pitch: number, near = new Vector3()): Line {
    const [w, v] = [new Vector3(...(twist.slice(0, 3) as [number, number, number])), new Vector3(...(twist.slice(3) as [number, number, number]))];
    if (kind === "prismatic" || w.lengthSq() === 0) return { name, kind, direction: v.clone().normalize(), point: near.clone() };
    const moment = v.clone().addScaledVector(w, -pitch);
    const direction = w.clone().normalize();
    const foot = w.clone().cross(moment).divideScalar(w.lengthSq());
    return { name, kind, direction, point: foot.addScaledVector(direction, near.clone().sub(foot).dot(direction)) };
}

export function commonNormal(a: Line, b: Line): Normal {
    const cross = a.direction.clone().cross(b.direction);
    const angle = Math.atan2(cross.length(), a.direction.dot(b.direction));
    const between = b.point.clone().sub(a.point);
    if (cross.length() < PARALLEL) {
        const foot = b.point.clone().addScaledVector(b.direction, -between.dot(b.direction));
        return { feet: [a.point.clone(), foot], length: foot.distanceTo(a.point), angle, parallel: true };
    }
    const square = cross.lengthSq();
    const s = between.clone().cross(b.direction).dot(cross) / square;
    const t = between.clone().cross(a.direction).dot(cross) / square;
    const feet: [Vector3, Vector3] = [a.point.clone().addScaledVector(a.direction, s), b.point.clone().addScaledVector(b.direction, t)];
    return { feet, length: feet[0].distanceTo(feet[1]), angle, parallel: false };
}
