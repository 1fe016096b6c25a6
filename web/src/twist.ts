// Learn: one joint's twist moved by hand. Four of six ways of moving a turning axis change it, two of six a sliding one; the common
// normals to the neighbours and the D-H numbers follow; motions without effect are visible as such.

import { Matrix4, Vector3 } from "three";
import { type App, type Robot, question } from "./app";
import { fill, h, number, select } from "./dom";
import type { TwistAnswer } from "./engine";
import { axis, commonNormal, type Line } from "./axes";
import type { Row, TableFile } from "./table";

const DIRECTIONS = ["turn about x", "turn about y", "turn about z", "move along x", "move along y", "move along z"];
const LETTERS: [keyof Row, string][] = [["theta", "θ"], ["d", "d"], ["alpha", "α"], ["a", "a"]];
const [DRAWN, MOVED, GREY] = [0x0072b2, 0xd55e00, 0x8a94a3];

export class TwistStep {
    private joint = 1;
    private by = [0, 0, 0, 0, 0, 0];
    private readonly out = h("div", { id: "twist-numbers" });
    private readonly sliders = h("div", { class: "sliders" });
    private asking = false;
    private again = false;

    constructor(private readonly app: App, private readonly robot: Robot, private readonly lines: Line[], private readonly root: Matrix4) {
        this.joint = Math.min(1, lines.length - 1);
    }

    words(): (Node | string)[] {
        const { lines } = this;
        const count = (kinds: string[]) => lines.filter((line) => kinds.includes(line.kind)).length;
        const [r, t, s] = [count(["revolute"]), count(["prismatic"]), count(["helical"])];
        this.fillSliders();
        return [
            h("p", {}, "Move one axis. There are six small motions, three rotations and three translations; z is the axis itself. Those that map the axis to itself change neither its twist nor the robot."),
            h("p", { id: "identifiable" }, `So a revolute joint has 4 numbers, a prismatic one 2, a helical one 5 with its pitch. This chain has ${[r ? `4 × ${r}` : "", t ? `2 × ${t}` : "", s ? `5 × ${s}` : ""].filter(Boolean).join(" + ")} for the axes and 6 for the tip at rest: `,
                h("b", {}, String(4 * r + 2 * t + 5 * s + 6)), `. The D-H form has 4 for the base, 4 for each of the ${lines.length} rows and 2 for the tool${t ? ", of which a prismatic joint does not determine some" : ""}; six of them describe base and tool, four before the first axis and two after the last.`),
            select("Joint", lines.map((line, at): [string, string] => [String(at), `${at + 1} ${line.name} (${line.kind})`]), String(this.joint), (value) => {
                this.joint = Number(value);
                this.by = [0, 0, 0, 0, 0, 0];
                this.fillSliders();
                void this.ask();
            }, "twist-joint"),
            this.sliders, this.out,
        ];
    }

    draw(): void {
        void this.ask();
    }

    private fillSliders(): void {
        const most = this.app.view.size * 0.2;
        this.sliders.replaceChildren(...DIRECTIONS.map((words, at) => {
            const turns = at < 3;
            const shown = h("output", {});
            const say = () => {
                const value = this.by[at] ?? 0;
                shown.textContent = turns ? `${number((value * 180) / Math.PI, 1)}°` : `${number(value * 1000, 1)} mm`;
                input.setAttribute("aria-valuetext", shown.textContent);
            };
            const input = h("input", { type: "range", min: turns ? -0.35 : -most, max: turns ? 0.35 : most, step: "any", value: this.by[at] ?? 0, "aria-label": words, "data-twist": at, input: () => {
                this.by[at] = Number(input.value);
                say();
                void this.ask();
            } });
            say();
            return h("label", { class: "slider" }, h("span", { class: "name" }, words), input, shown);
        }));
    }

    private async ask(): Promise<void> {
        if (this.asking) {
            this.again = true;
            return;
        }
        this.asking = true;
        await this.app.trying(async () => {
            const by = [...this.by];
            const answer = await this.app.engine.ask("twist", { source: question(this.robot), joint: this.joint, by, units: this.app.units });
            this.show(answer, by);
        });
        this.asking = false;
        if (this.again) {
            this.again = false;
            await this.ask();
        }
    }

    private show(answer: TwistAnswer, by: number[]): void {
        // Another step may be shown by now.
        if (!this.out.isConnected) return;
        const [before, after] = answer.tables.map((table) => JSON.parse(table.text) as TableFile) as [TableFile, TableFile];
        const moved = axis(answer.name, answer.kind, answer.after, answer.pitch, this.lines[this.joint]?.point);
        this.drawAxes(moved, answer);
        const twist = (label: string, numbers: number[], than?: number[]) => h("tr", {}, h("th", { scope: "row" }, label), ...numbers.map((value, at) =>
            h("td", { class: than && differs(value, than[at] ?? 0) ? "number moved" : "number" }, number(value, 4))));
        const changed: string[] = [];
        const rows = before.rows.map((row, at) => {
            const now = after.rows[at];
            return h("tr", { "data-row": row.row }, h("th", { scope: "row" }, row.row), ...LETTERS.flatMap(([part, letter]) => {
                const [was, is] = [Number(row[part] ?? 0), Number(now?.[part] ?? 0)];
                const other = differs(was, is, part === "theta" || part === "alpha");
                if (other) changed.push(`${letter} of ${row.row}`);
                const turns = part === "theta" || part === "alpha";
                const cell = row[part] === undefined ? "" : turns ? `${number((is * 180) / Math.PI, 3)}°` : `${number(is * 1000, 3)}`;
                return [h("td", { class: other ? "number moved" : "number", title: other ? `was ${turns ? `${number((was * 180) / Math.PI, 3)}°` : `${number(was * 1000, 3)} mm`}` : null }, cell)];
            }));
        });
        const free = DIRECTIONS.filter((_, at) => answer.changes[at]);
        const idle = DIRECTIONS.filter((_, at) => !answer.changes[at]);
        for (const [at, label] of [...this.sliders.children].entries()) label.classList.toggle("idle", !answer.changes[at]);
        const neighbours = [this.joint, this.joint + 1].filter((at) => at > 0 && at < this.lines.length);
        fill(this.out,
            h("p", {}, h("b", { id: "twist-free" }, `${free.length} of 6`), ` change this axis: ${free.join(", ")}. `, idle.length ? `Without effect: ${idle.join(", ")}.` : ""),
            h("table", { id: "twist" }, h("thead", {}, h("tr", {}, ...["twist", "ω x", "ω y", "ω z", "v x", "v y", "v z"].map((words) => h("th", { scope: "col" }, words)))),
                h("tbody", {}, twist("drawn", answer.before), twist("now", answer.after, answer.before))),
            h("p", { id: "twist-changed" }, changed.length === 0 ? "No D-H number changed." : `Changed: ${changed.join(", ")}. The other rows, and so the rest of the robot, are unchanged.`),
            h("table", { id: "twist-dh" }, h("thead", {}, h("tr", {}, ...["row", "θ", "d, mm", "α", "a, mm"].map((words) => h("th", { scope: "col" }, words)))), h("tbody", {}, ...rows)),
            h("p", { class: "fine" }, `Orange: the axis now, and its common normals${neighbours.length ? "" : " (it has no neighbour)"}; grey: as drawn. Axes that meet or are parallel have no unique normal: there a small rotation makes the numbers jump, but not the robot. Here a is not negative, as in the paper.`));
        this.out.dataset["changed"] = JSON.stringify(changed);
        this.out.dataset["by"] = JSON.stringify(by);
    }

    private drawAxes(moved: Line, answer: TwistAnswer): void {
        const { view } = this.app;
        const half = view.size * 0.4;
        const at = (point: Vector3) => point.clone().applyMatrix4(this.root);
        const segment = (line: Line, colour: number) => ({ from: at(line.point.clone().addScaledVector(line.direction, -half)), to: at(line.point.clone().addScaledVector(line.direction, half)), colour });
        const own = this.lines[this.joint] as Line;
        const lines = [segment(own, GREY), segment(moved, MOVED)];
        const names = [{ at: at(moved.point.clone().addScaledVector(moved.direction, half)), words: `${this.joint + 1}` }];
        for (const other of [this.joint - 1, this.joint + 1]) {
            const neighbour = this.lines[other];
            if (!neighbour) continue;
            lines.push(segment(neighbour, DRAWN));
            names.push({ at: at(neighbour.point.clone().addScaledVector(neighbour.direction, half)), words: `${other + 1}` });
            if (neighbour.kind === "prismatic" || own.kind === "prismatic") continue;
            for (const [line, colour] of [[own, GREY], [moved, MOVED]] as const) {
                const { feet } = commonNormal(neighbour, line);
                lines.push({ from: at(feet[0]), to: at(feet[1]), colour });
            }
        }
        view.frames([], answer.name, null);
        view.marks(lines.map((line) => ({ ...line, thick: true })), [], names);
    }
}

/** Whether two numbers differ by more than rounding; angles may differ by whole turns. */
function differs(a: number, b: number, turns = false): boolean {
    const apart = Math.abs(a - b);
    return (turns ? Math.min(apart % (2 * Math.PI), 2 * Math.PI - (apart % (2 * Math.PI))) : apart) > 1e-9;
}
