// Learn: derivation of the table for the current robot, step by step; from screw axes to D-H numbers and back.

import { Matrix4, Vector3 } from "three";
import type { App, Panel } from "./app";
import { chain, question } from "./app";
import { axis, commonNormal, type Line, type Normal } from "./axes";
import { h, number } from "./dom";
import { placed, type TableFile } from "./table";
import { TwistStep } from "./twist";

interface Poe {
    joints: { name: string; kind: string; twist: number[]; pitch: number }[];
}

export class Learn implements Panel {
    readonly name = "Learn";
    readonly element = h("section", { class: "panel", "aria-label": "Learn" });
    private steps: { title: string; words: () => (Node | string)[]; draw: () => void }[] = [];
    private at = 0;

    constructor(private readonly app: App) {}

    async show(): Promise<void> {
        const { app } = this;
        const robot = app.robot;
        if (!robot) return;
        // Nothing of the previous robot remains if this one's derivation fails.
        this.steps = [];
        this.element.replaceChildren(h("p", { role: "status" }, "deriving …"));
        const answered = await app.trying(async () => {
            const poe = JSON.parse((await app.engine.ask("poe", question(robot))).text) as Poe;
            const answer = await app.engine.ask("table", { source: question(robot), convention: "distal", gauge: null, units: app.units, format: "json" });
            const table = JSON.parse(answer.text) as TableFile;
            app.table = undefined;
            app.view.ghost(0, 0.25);
            // The derivation uses every joint at 0, where the screw axes are defined.
            app.q.clear();
            app.refill();
            this.make(poe, table, answer.rows.map((row) => row.numbers), answer.columns);
            this.go(Math.min(this.at, this.steps.length - 1));
            return true;
        });
        if (!answered) this.element.replaceChildren(h("p", { class: "notice" }, "This chain has no derivation; the reason is above."));
    }

    hide(): void {
        this.app.view.ghost(0, 1);
        this.app.view.frames([], "", null);
        this.app.view.marks([], []);
        this.at = 0;
    }

    moved(): void {
        this.steps[this.at]?.draw();
    }

    private make(poe: Poe, table: TableFile, cells: string[][], columns: string[]): void {
        const { app } = this;
        const robot = app.robot;
        if (!robot) return;
        const base = chain(robot).base;
        const root = app.view.pose(0, base)?.clone() ?? new Matrix4();
        // Each axis is drawn where its joint is.
        const inBase = root.clone().invert();
        const place = (name: string) => {
            const joint = robot.opened.scene.joints.find((it) => it.name === name);
            const link = joint && robot.opened.scene.links[joint.child];
            const pose = link && app.view.pose(0, link.name);
            return pose ? new Vector3().setFromMatrixPosition(pose).applyMatrix4(inBase) : new Vector3();
        };
        const lines = poe.joints.map((joint) => axis(joint.name, joint.kind, joint.twist, joint.pitch, place(joint.name)));
        const size = app.view.size;
        const inRoot = (point: Vector3) => point.clone().applyMatrix4(root);
        const drawAxes = (upTo: number, normal?: Normal) => {
            app.view.frames([], base, null);
            const shown = lines.slice(0, upTo);
            app.view.marks([
                ...shown.map((line) => ({ from: inRoot(line.point.clone().addScaledVector(line.direction, -size * 0.5)), to: inRoot(line.point.clone().addScaledVector(line.direction, size * 0.5)), colour: 0x0072b2, thick: true })),
                ...(normal ? [{ from: inRoot(normal.feet[0]), to: inRoot(normal.feet[1]), colour: 0xe69f00, thick: true }] : []),
            ], [], shown.map((line, at) => ({ at: inRoot(line.point.clone().addScaledVector(line.direction, size * 0.5)), words: `${at + 1}` })));
        };
        const vector = (it: Vector3) => `(${number(it.x)}, ${number(it.y)}, ${number(it.z)})`;
        const degrees = (angle: number) => `${number((angle * 180) / Math.PI, 3)}°`;
        const millimetres = (length: number) => `${number(length * 1000, 3)} mm`;
        const drawRows = (chosen: number | null) => {
            app.view.marks([], []);
            app.view.frames(placed(table, (name) => app.value(name)), base, chosen);
        };
        this.steps = [{
            title: "The screw axes",
            words: () => [h("p", {}, "Every joint turns about a line in space, or slides along one. These lines and the tip's pose with all joints at 0 determine the whole motion: the product of exponentials. It does not use link frames."),
                h("ol", {}, ...lines.map((line) => h("li", {}, `${line.name} (${line.kind}): along ${vector(line.direction)}${line.kind === "prismatic" ? "" : ` through ${vector(line.point)} m`}`)))],
            draw: () => drawAxes(lines.length),
        }];
        lines.slice(1).forEach((next, index) => {
            const line = lines[index] as Line;
            const slides = line.kind === "prismatic" || next.kind === "prismatic";
            const normal = commonNormal(line, next);
            const row = table.rows[index + 1];
            this.steps.push({
                title: `From axis ${index + 1} to axis ${index + 2}`,
                words: () => [
                    h("p", {}, normal.parallel ? `The two axes are parallel: any line across both is a common normal. ` : normal.length < 1e-9 ? "The two axes meet: their common normal is a point, and x is perpendicular to both. " : "One line meets both axes at right angles: the common normal. ",
                        slides ? "A prismatic joint has a direction but no position; its axis is put where the table has the fewest numbers." : `Its length is ${millimetres(normal.length)}, and the angle between the axes is ${degrees(normal.angle)}.`),
                    h("p", {}, `Row ${index + 1} of the table: a = ${millimetres(row?.a ?? 0)}, α = ${degrees(row?.alpha ?? 0)}.`,
                        slides ? "" : ` |a| and |α| are this length and angle${Math.abs(Math.abs(row?.a ?? 0) - normal.length) < 1e-6 * Math.max(1, size) && angleApart(row?.alpha ?? 0, normal.angle) < 1e-5 ? " ✓" : "; here the table uses another choice of signs or gauge"}.`),
                ],
                draw: () => drawAxes(lines.length, slides ? undefined : normal),
            });
        });
        this.steps.push({
            title: "The frames",
            words: () => [h("p", {}, "Each frame has its z along the joint's axis and its x along the common normal to the next one. What geometry does not determine (the sign of x, the origin of d along parallel axes) is chosen so that most numbers are zero.")],
            draw: () => drawRows(null),
        });
        table.rows.forEach((row, at) => {
            if (row.row === "base" && (cells[at] ?? []).every((cell) => cell === "0" || cell === "")) return;
            this.steps.push({
                title: row.row === "base" ? "From the base link to the first axis" : row.row === "tool" ? "From the last frame to the tip" : `Row ${row.row}`,
                words: () => [
                    h("p", {}, "Rotate about z by θ, move along z by d, rotate about x by α, move along x by a."),
                    h("table", {}, h("tbody", {}, ...columns.map((name, column) => h("tr", {}, h("th", { scope: "row" }, ({ theta: "θ", alpha: "α" } as Record<string, string>)[name] ?? name), h("td", { class: "number" }, cells[at]?.[column] ?? ""))))),
                    h("p", { class: "fine" }, "Move the joint's slider: it changes θ of a revolute joint, d of a prismatic one.")],
                draw: () => drawRows(at),
            });
        });
        const twist = new TwistStep(app, robot, lines, root);
        if (lines.length > 0) this.steps.push({ title: "One twist, alive", words: () => twist.words(), draw: () => twist.draw() });
        this.steps.push({
            title: "And back",
            words: () => {
                const rows = placed(table, (name) => app.value(name));
                const end = rows[rows.length - 1]?.to ?? new Matrix4();
                const tip = document.getElementById("tip")?.dataset["pose"];
                const pose = tip ? (JSON.parse(tip) as number[][]) : undefined;
                const apart = pose ? Math.hypot(...[0, 1, 2].map((k) => (pose[k]?.[3] ?? 0) - (end.elements[12 + k] ?? 0))) : undefined;
                return [h("p", {}, "The product of the rows gives the same pose of the tip: at the joint values of the sliders the two results are ", h("b", { id: "roundtrip", "data-apart": apart ?? "" }, apart === undefined ? "…" : `${apart.toExponential(1)} m`), " apart."),
                    h("p", {}, "The other conventions group the same numbers differently: choose one under See.")];
            },
            draw: () => drawRows(null),
        });
    }

    private go(step: number): void {
        this.at = step;
        const it = this.steps[step];
        if (!it) return;
        const last = this.steps.length - 1;
        this.element.replaceChildren(
            h("h2", {}, `${step + 1}. ${it.title}`),
            h("div", { class: "row" },
                h("button", { id: "back", disabled: step === 0, click: () => this.go(step - 1) }, "Back"),
                h("button", { id: "next", class: "main", disabled: step === last, click: () => this.go(step + 1) }, "Next"),
                h("span", { class: "fine" }, `step ${step + 1} of ${last + 1}`)),
            ...it.words(),
            h("ol", { class: "steps" }, ...this.steps.map((other, at) => h("li", {}, h("button", { class: at === step ? "link here" : "link", "aria-current": at === step ? "step" : null, click: () => this.go(at) }, other.title)))));
        it.draw();
    }
}

function angleApart(a: number, b: number): number {
    const turned = Math.abs(a) % (2 * Math.PI);
    const plain = turned > Math.PI ? 2 * Math.PI - turned : turned;
    return Math.min(Math.abs(plain - b), Math.abs(Math.PI - plain - b));
}
