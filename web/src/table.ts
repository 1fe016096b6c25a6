// A D-H table as the JSON of `denavit table` gives it, and the poses of its frames. Lengths in m, angles in rad.

import { Matrix4 } from "three";

export interface TableFile {
    robot: string;
    base: string;
    tip: string;
    convention: string;
    gauge: string;
    coordinates: { name: string; quantity: "angle" | "length"; continuous: boolean; limits: { lower: number; upper: number } | null }[];
    joints: { name: string; kind: string; coordinate: string; pitch: number; scale: number }[];
    rows: Row[];
    tip_moves_at_most: number;
    notes: { message?: string; kind?: string }[];
}

export interface Row {
    row: string;
    theta?: number;
    d?: number;
    alpha?: number;
    a?: number;
    beta?: number;
}

type Part = "theta" | "d" | "alpha" | "a" | "beta";

/** One elementary motion of a row: before it, after it, and by how much. */
export interface Step {
    part: Part;
    amount: number;
    from: Matrix4;
    to: Matrix4;
}

export interface PlacedRow {
    label: string;
    /** Where the row begins and ends, in the base link's frame. */
    from: Matrix4;
    to: Matrix4;
    steps: Step[];
}

function elementary(part: Part, amount: number): Matrix4 {
    const matrix = new Matrix4();
    switch (part) {
        case "theta": return matrix.makeRotationZ(amount);
        case "alpha": return matrix.makeRotationX(amount);
        case "beta": return matrix.makeRotationY(amount);
        case "d": return matrix.makeTranslation(0, 0, amount);
        case "a": return matrix.makeTranslation(amount, 0, 0);
    }
}

/** The order in which the numbers of a row act. */
function order(convention: string, row: Row): Part[] {
    if (row.beta !== undefined) return ["theta", "a", "alpha", "beta"];
    return convention === "proximal" ? ["alpha", "a", "theta", "d"] : ["theta", "d", "alpha", "a"];
}

/** Every row where it stands with joint values `q`, by name of the coordinate. */
export function placed(table: TableFile, q: (coordinate: string) => number): PlacedRow[] {
    let at = new Matrix4();
    let joint = 0;
    return table.rows.map((row) => {
        const from = at.clone();
        const value: Partial<Record<Part, number>> = { theta: row.theta ?? 0, d: row.d ?? 0, alpha: row.alpha ?? 0, a: row.a ?? 0, beta: row.beta ?? 0 };
        const mover = row.row === "base" || row.row === "tool" ? undefined : table.joints[joint++];
        if (mover) {
            const moved = mover.scale * q(mover.coordinate);
            if (mover.kind === "prismatic") value.d = (value.d ?? 0) + moved;
            else value.theta = (value.theta ?? 0) + moved;
            if (mover.kind === "helical") value.d = (value.d ?? 0) + mover.pitch * moved;
        }
        const steps = order(table.convention, row).map((part) => {
            const amount = value[part] ?? 0;
            const to = at.clone().multiply(elementary(part, amount));
            const step = { part, amount, from: at, to };
            at = to;
            return step;
        });
        // A sliding joint in Hayati's form slides along the axis that the row starts from.
        return { label: row.row, from, to: at, steps };
    });
}
