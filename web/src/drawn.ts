// Elementary things of the 3-D view: rods, lines, frames, the motions of a D-H row; and freeing what is no longer shown.

import {
    BufferGeometry, CylinderGeometry, Float32BufferAttribute, Group, Line, LineBasicMaterial, LineSegments, Matrix4, Mesh, MeshStandardMaterial,
    Object3D, Vector3,
} from "three";

/** Colours that people with any colour vision can distinguish (Okabe and Ito). */
export const COLOURS = { x: 0xd55e00, y: 0x009e73, z: 0x0072b2, a: 0xe69f00, d: 0x56b4e9, theta: 0x0072b2, alpha: 0xcc79a7, other: 0xd55e00 };

export function segment(from: Vector3, to: Vector3, colour: number, opacity: number): Line {
    const material = new LineBasicMaterial({ color: colour, transparent: opacity < 1, opacity });
    return new Line(new BufferGeometry().setFromPoints([from, to]), material);
}

export function rod(from: Vector3, to: Vector3, radius: number, colour: number, opacity = 1): Mesh {
    const along = to.clone().sub(from);
    const form = new CylinderGeometry(radius, radius, along.length(), 16);
    const mesh = new Mesh(form, new MeshStandardMaterial({ color: colour, roughness: 0.8, transparent: opacity < 1, opacity }));
    mesh.position.copy(from).addScaledVector(along, 0.5);
    mesh.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), along.normalize());
    mesh.userData["opacity"] = opacity;
    return mesh;
}

/** Axes of a frame; z is the longest, y the shortest. */
export function triad(at: Matrix4, length: number, opacity: number): Group {
    const group = new Group();
    const origin = new Vector3().setFromMatrixPosition(at);
    const [x, y, z] = [new Vector3(), new Vector3(), new Vector3()];
    at.extractBasis(x, y, z);
    for (const [axis, colour, factor] of [[x, COLOURS.x, 1], [y, COLOURS.y, 0.6], [z, COLOURS.z, 1.2]] as const) {
        const made = rod(origin, origin.clone().addScaledVector(axis, length * factor), length * 0.045, colour, opacity);
        (made.material as MeshStandardMaterial).depthTest = false;
        made.renderOrder = 2;
        group.add(made);
    }
    return group;
}

/** The drawing of an elementary motion: d and a as rods, the angles of a chosen row as arcs. */
export function drawnStep(part: string, amount: number, from: Matrix4, to: Matrix4, size: number, stands: boolean, chosen: boolean): Object3D[] {
    const [start, end] = [new Vector3().setFromMatrixPosition(from), new Vector3().setFromMatrixPosition(to)];
    const opacity = stands ? 1 : 0.2;
    if (part === "d" || part === "a") {
        if (Math.abs(amount) < size * 1e-6) return [];
        const made = rod(start, end, size * (chosen ? 0.009 : 0.005), part === "d" ? COLOURS.d : COLOURS.a, opacity);
        (made.material as MeshStandardMaterial).depthTest = false;
        made.renderOrder = 1;
        return [made];
    }
    if (!chosen || Math.abs(amount) < 1e-9) return [];
    const radius = size * 0.1;
    const points: number[] = [];
    const steps = Math.max(6, Math.ceil(Math.abs(amount) / 0.1));
    for (let k = 0; k <= steps; k++) {
        const turned = (amount * k) / steps;
        const point = part === "theta" ? new Vector3(Math.cos(turned), Math.sin(turned), 0)
            : part === "alpha" ? new Vector3(0, -Math.sin(turned), Math.cos(turned)) : new Vector3(Math.sin(turned), 0, Math.cos(turned));
        point.multiplyScalar(radius).applyMatrix4(from);
        points.push(point.x, point.y, point.z);
    }
    const form = new BufferGeometry().setAttribute("position", new Float32BufferAttribute(points, 3));
    const arc = new Line(form, new LineBasicMaterial({ color: part === "theta" ? COLOURS.theta : COLOURS.alpha, depthTest: false }));
    arc.renderOrder = 3;
    return [arc];
}

export function clear(group: Group): void {
    for (const child of [...group.children]) {
        group.remove(child);
        dispose(child);
    }
}

export function dispose(object: Object3D): void {
    object.traverse((part) => {
        if (part instanceof Mesh || part instanceof Line || part instanceof LineSegments) {
            (part.geometry as BufferGeometry).dispose();
            for (const material of Array.isArray(part.material) ? part.material : [part.material]) material.dispose();
        }
    });
}
