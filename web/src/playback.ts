// Playback of a file of joint values: row by row, with its own times if it has any.

import type { App } from "./app";
import { chain } from "./app";
import { fill, h, number } from "./dom";
import { headings, measures } from "./files";

/** Rows a second of a file without times. */
const PACE = 25;
const UNITS: Record<string, number> = { deg: Math.PI / 180, "°": Math.PI / 180, rad: 1, m: 1, mm: 1e-3 };

export interface Recording {
    file: string;
    /** Values by joint, rad and m, a row each. */
    joints: Map<string, number[]>;
    /** Seconds from the first row; null: the file has none. */
    times: number[] | null;
}

/** Cells of a line; a quoted cell may hold separators. */
function cells(line: string, separator: string): string[] {
    const out: string[] = [];
    let [cell, quoted] = ["", false];
    for (const letter of line) {
        if (letter === '"') quoted = !quoted;
        else if (letter === separator && !quoted) {
            out.push(cell.trim());
            cell = "";
        } else cell += letter;
    }
    return [...out, cell.trim()];
}

/** A heading without its unit, and the unit. */
function heading(cell: string): [name: string, unit: string | undefined] {
    const found = /^(.*?)\s*[[(]\s*(\S+?)\s*[\])]$/.exec(cell);
    return found ? [found[1] ?? "", found[2]?.toLowerCase()] : [cell, undefined];
}

/**
 * The joint values of a file whose headings name joints of the robot at hand, or q1, q2, … in the chain's order; undefined where it
 * has none, or where it holds measured places.
 */
export function recording(app: App, file: string, text: string): Recording | undefined {
    const robot = app.robot;
    if (!robot) return undefined;
    const { names, separator, lines, first, units } = headings(text);
    if (measures(names)) return undefined;
    const drivers = new Map(robot.opened.scene.joints.filter((joint, at) => joint.driver === at).map((joint) => [joint.name.toLowerCase(), joint]));
    const numbered = chain(robot).coordinates;
    const columns = cells(lines[first] ?? "", separator).map((cell) => {
        const [name, unit] = heading(cell);
        const order = /^q_?(\d+)$/i.exec(name)?.[1];
        const joint = drivers.get(name.toLowerCase()) ?? (order ? drivers.get((numbered[Number(order) - 1] ?? "").toLowerCase()) : undefined);
        const turns = joint?.kind !== "prismatic";
        const factor = UNITS[unit ?? (turns ? units.angle : units.length)];
        return { name, joint: joint?.name, factor, unit };
    });
    const used = columns.filter((column) => column.joint !== undefined);
    if (used.length === 0) return undefined;
    const joints = new Map(used.map((column) => [column.joint ?? "", [] as number[]]));
    const clock = columns.findIndex(({ name }) => ["t", "time", "stamp", "timestamp"].includes(name.toLowerCase()));
    const times: number[] = [];
    for (const [at, line] of lines.entries()) {
        if (at <= first || line.trim() === "" || line.startsWith("#")) continue;
        const row = cells(line, separator);
        for (const [k, { joint, factor, name, unit }] of columns.entries()) {
            if (joint === undefined) continue;
            if (factor === undefined) throw new Error(`${file}: "${unit}" of column ${name} is not a unit of a joint; write rad, deg, m or mm`);
            const value = row[k] === undefined || row[k] === "" ? Number.NaN : Number(row[k]);
            if (!Number.isFinite(value)) throw new Error(`${file}, line ${at + 1}: column ${name} holds "${row[k] ?? ""}"; each row needs a number`);
            joints.get(joint)?.push(value * factor);
        }
        if (clock >= 0) times.push(Number(row[clock]));
    }
    const count = [...joints.values()][0]?.length ?? 0;
    if (count === 0) throw new Error(`${file} has headings, but no row of joint values`);
    const begin = times[0] ?? 0;
    const sound = times.length === count && times.every((time, k) => Number.isFinite(time) && time >= (times[k - 1] ?? time));
    return { file, joints, times: sound ? times.map((time) => time - begin) : null };
}

export class Playback {
    readonly element = h("section", { class: "playback", "aria-label": "Playback", hidden: true });
    private played: Recording | undefined;
    private row = 0;
    private begun = 0;
    private running = false;
    private readonly button = h("button", { id: "play", click: () => this.run(!this.running) });
    private readonly slider = h("input", { type: "range", id: "row", min: 0, step: 1, "aria-label": "Row", input: () => {
        this.run(false);
        this.go(Number(this.slider.value));
    } });
    private readonly words = h("output", { id: "row-words", class: "fine" });

    /** `moved` is called when the joint values have changed. */
    constructor(private readonly app: App, private readonly moved: () => void) {}

    take(recording: Recording): void {
        this.played = recording;
        this.slider.max = String(this.count - 1);
        fill(this.element, h("div", { class: "row" }, this.button, this.slider, this.words,
            h("button", { id: "play-end", title: "Ends the playback", "aria-label": "End the playback", click: () => this.end() }, "✕")));
        this.element.hidden = false;
        this.run(false);
        this.go(0);
        this.app.say(`${recording.file}: ${this.count} rows of ${recording.joints.size} joints${recording.times ? "" : `, without times: ${PACE} rows a second`}`);
    }

    end(): void {
        this.run(false);
        this.played = undefined;
        this.element.hidden = true;
    }

    private get count(): number {
        return [...(this.played?.joints.values() ?? [])][0]?.length ?? 0;
    }

    /** Seconds from the first row to this one. */
    private time(row: number): number {
        return this.played?.times ? (this.played.times[row] ?? 0) : row / PACE;
    }

    private run(on: boolean): void {
        this.running = on;
        this.button.textContent = on ? "Pause" : "Play";
        if (!on) return;
        if (this.row >= this.count - 1) this.go(0);
        this.begun = performance.now() / 1000 - this.time(this.row);
        requestAnimationFrame(() => this.step());
    }

    private step(): void {
        if (!this.running) return;
        const now = performance.now() / 1000 - this.begun;
        let row = this.row;
        while (row < this.count - 1 && this.time(row + 1) <= now) row++;
        if (row !== this.row) this.go(row);
        if (row >= this.count - 1) this.run(false);
        else requestAnimationFrame(() => this.step());
    }

    private go(row: number): void {
        this.row = row;
        this.slider.value = String(row);
        this.words.textContent = `row ${row + 1} of ${this.count}${this.played?.times ? `, ${number(this.time(row), 2)} s` : ""}`;
        for (const [joint, values] of this.played?.joints ?? []) this.app.q.set(joint, values[row] ?? 0);
        this.moved();
    }
}
