// The meaning of a measurement file's columns: by their names, guessed, or chosen by the user.

import { fill, h, save, select } from "./dom";
import type { ColumnsAnswer } from "./engine";

const LEFT_OUT = "";
const OWN = "own name";
const VALUES = ["x", "y", "z", "qx", "qy", "qz", "qw", "distance", "time", "temperature", "payload"];
const ANGLES = ["first angle", "second angle", "third angle"];
const UNITS: [string, string][] = [["", "as stated"], ["m", "m"], ["mm", "mm"], ["um", "µm"], ["in", "in"], ["rad", "rad"], ["deg", "°"]];
/** Orders of three angles: capitals about the axes as they turn along, small letters about fixed ones. */
const ORDERS: [string, string][] = [
    ["xyz", "roll, pitch, yaw (xyz, fixed axes)"], ["ZYX", "A, B, C of a KUKA (ZYX)"], ["vector", "axis times angle (UR)"],
    ...["XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZXZ", "ZYZ"].map((order): [string, string] => [order, `${order}, turned axes`]),
];

interface Choice {
    use: string;
    unit: string;
}

export class Columns {
    readonly element = h("details", { class: "columns", id: "columns" });
    private choices: Choice[] = [];
    private answer: ColumnsAnswer | undefined;
    private order = "xyz";
    private told = false;
    /** The user has chosen something. */
    private said = false;
    private readonly verdict = h("p", { id: "columns-verdict", role: "status" });

    /** `ask` reads the file with a map, or by its names; `changed` is called when the user has chosen something. */
    constructor(private readonly ask: (map: string | null) => Promise<ColumnsAnswer>, private readonly changed: () => void) {}

    /** The map as `denavit calibrate --columns` takes it; null where the file's own names are enough. */
    get map(): string | null {
        if (!this.told || !this.answer) return null;
        // A text of JSON is a text of TOML.
        const quoted = (text: string) => JSON.stringify(text);
        const column = (at: number) => quoted((this.answer?.columns[at]?.name ?? "") + (this.choices[at]?.unit ? ` [${this.choices[at]?.unit}]` : ""));
        const lines = this.choices.flatMap(({ use }, at) => {
            if (use === LEFT_OUT || ANGLES.includes(use)) return [];
            return [`${quoted(use === OWN ? this.answer?.columns[at]?.name ?? "" : use)} = ${column(at)}`];
        });
        const angles = ANGLES.map((name) => this.choices.findIndex(({ use }) => use === name));
        if (angles.every((at) => at >= 0)) {
            const listed = `[${angles.map(column).join(", ")}]`;
            lines.push(this.order === "vector" ? `rotation_vector = ${listed}` : `euler = { order = "${this.order}", columns = ${listed} }`);
        }
        return `${lines.join("\n")}\n`;
    }

    /** Reads the file again, and asks about what is not clear. */
    async look(): Promise<void> {
        const answer = await this.ask(null);
        this.answer = answer;
        const unclear = answer.problem !== null || answer.columns.some((it) => it.orientation || (!it.sure && it.meaning !== null));
        const orientations = answer.columns.flatMap((it, at) => (it.orientation ? [at] : []));
        this.choices = answer.columns.map((it, at) => {
            const turn = orientations.indexOf(at);
            if (turn >= 0) return { use: orientations.length === 3 ? ANGLES[turn] ?? "" : ["qx", "qy", "qz", "qw"][turn] ?? "", unit: "" };
            return { use: it.meaning ?? (it.first.some((cell) => cell !== "") ? OWN : LEFT_OUT), unit: "" };
        });
        [this.told, this.said] = [unclear, false];
        this.element.open = unclear;
        this.fill();
        await this.judge();
    }

    private fill(): void {
        const { answer } = this;
        if (!answer) return;
        const rows = answer.columns.map((it, at) => {
            const choice = this.choices[at] as Choice;
            const uses: [string, string][] = [
                [LEFT_OUT, "left out"], [OWN, "recorded under its own name"],
                ...answer.joints.map((joint): [string, string] => [joint, joint]), ...[...VALUES, ...ANGLES].map((name): [string, string] => [name, name]),
            ];
            // Of a joint: velocity, approach and the like keep the name that they have.
            if (it.meaning !== null && !uses.some(([value]) => value === it.meaning)) uses.push([it.meaning, it.meaning]);
            return h("tr", { class: it.sure ? "" : "guess" }, h("th", { scope: "row" }, it.name, it.unit && !/[)\]]$/.test(it.name) ? ` [${it.unit}]` : ""),
                h("td", {}, select("", uses, choice.use, (use) => this.say(() => { choice.use = use; }), `column-${at}`, `what ${it.name} is`)),
                h("td", {}, select("", UNITS, choice.unit, (unit) => this.say(() => { choice.unit = unit; }), `unit-${at}`, `unit of ${it.name}`)),
                h("td", { class: "fine" }, it.first.map(short).join(", ")));
        });
        const turning = this.choices.some(({ use }) => ANGLES.includes(use));
        fill(this.element, h("summary", {}, this.told ? "Columns: please check their meaning" : "Columns: their names state their meaning"),
            h("div", { class: "scroll" }, h("table", { id: "columns-table" },
                h("thead", {}, h("tr", {}, ...["column", "is", "unit", "first values"].map((words) => h("th", { scope: "col" }, words)))),
                h("tbody", {}, ...rows))),
            turning ? select("Angles", ORDERS, this.order, (order) => this.say(() => { this.order = order; }), "angles-order") : null,
            this.verdict,
            this.told ? h("div", { class: "row" },
                h("button", { id: "columns-file", click: () => save("columns.toml", this.map ?? "") }, "Download as columns.toml"),
                h("button", { id: "columns-again", click: () => void this.look() }, "Start again")) : null);
    }

    private say(change: () => void): void {
        change();
        [this.told, this.said] = [true, true];
        this.fill();
        this.changed();
        void this.judge();
    }

    /** The message where no heading is a joint of the robot, nor q1, q2, …: most likely another robot's measurement. */
    private stranger(answer: ColumnsAnswer): string | undefined {
        const { columns, joints } = answer;
        if (answer.problem === null || joints.length === 0 || columns.some((it) => it.sure && it.meaning !== null && joints.includes(it.meaning))) return undefined;
        const some = (names: string[]) => (names.length > 4 ? `${names.slice(0, 3).join(", ")}, … ${names.at(-1)}` : names.join(", "));
        return `This does not look like a measurement of this robot: none of its columns (${some(columns.map(({ name }) => name))}) is named like one of the robot's joints (${some(joints)}). `
            + "Drop the robot that was measured, or choose in the table which column is which joint.";
    }

    /** Reads the file with the chosen meaning, and shows the result. */
    async judge(): Promise<void> {
        const answer = await this.ask(this.map);
        const strange = this.stranger(answer);
        if (strange && !this.said) {
            this.verdict.classList.add("wrong");
            this.verdict.textContent = strange;
            this.element.open = true;
            return;
        }
        this.verdict.classList.toggle("wrong", answer.problem !== null);
        this.verdict.textContent = answer.problem ?? `${answer.rows} rows are read: ${together(answer.taken)}`;
        if (answer.problem !== null) this.element.open = true;
    }
}

/** A cell, in so few letters that a row of them fits. */
function short(cell: string): string {
    const value = Number(cell);
    if (cell.trim() !== "" && Number.isFinite(value) && cell.length > 9) return String(Number(value.toPrecision(5)));
    return cell.length > 14 ? `${cell.slice(0, 13)}…` : cell;
}

/** Columns of one use together. */
function together(taken: ColumnsAnswer["taken"]): string {
    const uses = new Map<string, string[]>();
    for (const { column, taken_for } of taken) uses.set(taken_for, [...(uses.get(taken_for) ?? []), column]);
    return [...uses].map(([use, columns]) => `${columns.length > 3 ? `${columns[0]} … ${columns.at(-1)}` : columns.join(", ")} (${use})`).join("; ");
}
