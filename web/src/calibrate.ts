// Calibrate: from measurements to the calibrated robot; and effects to try by hand.

import { Matrix4, Vector3 } from "three";
import type { App, Panel } from "./app";
import { chain, question } from "./app";
import { Columns } from "./columns";
import { fill, h, number, save, select, stem } from "./dom";
import { Engine, type Calibrated, type Possible } from "./engine";
import type { DataFile } from "./files";
import { bars, curve, effects, heat, plain, type Report } from "./report";

export class Calibrate implements Panel {
    readonly name = "Calibrate";
    readonly element = h("section", { class: "panel", "aria-label": "Calibrate" });
    // A separate worker: the page stays responsive, and the work can be stopped.
    private readonly engine = new Engine();
    private data: DataFile | undefined;
    private test: DataFile | undefined;
    private readonly columns = new Columns((map) => this.look(map), () => { this.result = undefined; });
    private looked: { key: string; data: DataFile } | undefined;
    private readonly out = h("div", {});
    private readonly erring = h("p", { id: "erring", class: "fine" });
    private readonly factor = h("span", { class: "factor" });
    private readonly trial = h("div", { class: "trial" });
    private units = "m,rad";
    private search = "auto";
    private held = "";
    private result: Calibrated | undefined;
    private for = "";
    private possible: Possible | undefined;
    private exaggerate = 100;
    private magnify = 300;
    private stage = 0;
    private effect = { kind: "", place: "", strength: 0.3 };
    private acting = false;
    private again = false;

    constructor(private readonly app: App) {}

    take(file: DataFile): void {
        if (this.data && this.result === undefined && this.data.file !== file.file) this.test = file;
        else [this.data, this.test, this.result] = [file, undefined, undefined];
        void this.show();
    }

    async show(): Promise<void> {
        const robot = this.app.robot;
        if (!robot) return;
        const key = `${robot.file}\n${robot.base}\n${robot.tip}\n${robot.exact}\n${robot.text}`;
        if (this.for !== key) [this.for, this.result, this.possible] = [key, undefined, undefined];
        fill(this.element,
            h("h2", {}, "Calibrate from measurements"),
            this.data
                ? h("p", {}, h("b", { id: "data" }, this.data.file), this.test ? ` · test data ${this.test.file}` : "")
                : h("p", {}, "Drop a CSV or an Excel workbook of measurements: a column for each joint, and x, y, z of what a tracker saw. A second one is test data."),
            this.data ? h("div", { class: "row" },
                select("Units", [["m,rad", "m, rad"], ["mm,rad", "mm, rad"], ["m,deg", "m, °"], ["mm,deg", "mm, °"]], this.units, (value) => { this.units = value; void this.app.trying(() => this.columns.judge()); }, "data-units"),
                select("Search for", [["auto", "effects"], ["curves", "error curves"], ["none", "geometry only"]], this.search, (value) => { this.search = value; }, "search"),
                this.test ? null : select("Hold out", [["", "no rows"], ["0.1", "10 % of the rows"], ["0.2", "20 %"], ["0.3", "30 %"]], this.held, (value) => { this.held = value; }, "hold-out"),
                h("button", { id: "calibrate", class: "main", click: () => void this.run() }, "Calibrate"),
                h("button", { id: "stop", click: () => { this.engine.stop(); this.out.replaceChildren(h("p", {}, "stopped")); } }, "Stop")) : null,
            this.data ? this.columns.element : null,
            this.out, this.trial);
        if (!this.result) this.out.replaceChildren();
        if (this.data && (this.looked?.key !== key || this.looked.data !== this.data)) {
            this.looked = { key, data: this.data };
            await this.app.trying(() => this.columns.look());
        }
        await this.app.trying(() => this.offerEffects());
    }

    /** The file read by a map, or by its own names. */
    private look(map: string | null): ReturnType<typeof this.app.engine.ask<"columns">> {
        const { robot } = this.app;
        if (!robot || !this.data) throw new Error("drop a robot and its measurements first");
        return this.app.engine.ask("columns", { source: question(robot), data: this.data, units: this.units, map });
    }

    hide(): void {
        this.app.view.marks([], []);
    }

    moved(): void {
        void this.act();
    }

    private async run(): Promise<void> {
        // A file that is still being read is part of what the user sees as dropped.
        await this.app.taken;
        const { robot } = this.app;
        if (!robot || !this.data) return;
        this.engine.stop();
        const words = h("span", {}, "reading");
        this.out.replaceChildren(h("p", { role: "status", id: "progress" }, h("progress", { "aria-label": "at work" }), " ", words));
        const asked = { source: question(robot), data: this.data, test: this.test ?? null, units: this.units, map: this.columns.map, effects: this.search, hold_out: this.test || this.held === "" ? null : Number(this.held) };
        const before = performance.now();
        const { for: key } = this;
        try {
            const result = await this.engine.ask("calibrate", asked, (said) => { words.textContent = said; });
            if (key !== this.for) return;
            this.result = result;
            this.fill(this.result, (performance.now() - before) / 1000);
        } catch (error) {
            const why = error instanceof Error ? error.message : String(error);
            if (why !== "stopped") this.out.replaceChildren(h("p", { class: "said wrong", id: "failed" }, why));
        }
    }

    private fill(result: Calibrated, seconds: number): void {
        const report = JSON.parse(result.text) as Report;
        const robot = this.app.robot;
        const name = stem(robot?.file ?? "");
        const key = ["position", "distance", "pixel"].map((word) => `${word}_rms_m`).find((it) => report.stages[0]?.train[it] !== undefined);
        fill(this.out,
            h("p", { class: "fine" }, `${report.samples.train} rows fitted, ${report.samples.test} held out, ${number(seconds, 1)} s`),
            h("div", { class: "row" },
                result.urdf ? h("button", { id: "calibrated-urdf", class: "main", click: () => save(`${name}_calibrated.urdf`, result.urdf ?? "", "application/xml") }, "Download calibrated URDF") : null,
                h("button", { id: "report-json", click: () => save(`${name}_calibration.json`, result.text, "application/json") }, "Report (JSON)"),
                h("button", { id: "effects-json", click: () => save(`${name}_effects.json`, result.effects, "application/json") }, "Effects (JSON)")),
            key ? bars(report, key) : null,
            effects(result.said),
            ...(result.tried.length > 0 ? [h("h3", {}, "Tried effects"), heat(result.tried)] : []),
            ...(report.curves?.length ? [h("h3", {}, "Error curves of the joints"), ...report.curves.map(curve)] : []),
            h("h3", {}, "Residuals, on the robot"),
            h("div", { class: "row" },
                select("Stage", result.residuals.map((stage, at) => [String(at), stage.stage]), String(this.stage = result.residuals.length - 1), (value) => { this.stage = Number(value); this.scale(); }, "stage"),
                h("button", { id: "errs", title: "The fitted row with the largest distance between measured and predicted position", click: () => this.worst() }, "Go to the largest error"),
                this.factor),
            this.erring,
            h("details", {}, h("summary", {}, "Meaning of the columns"), h("ul", {}, ...report.columns.map((it) => h("li", {}, `${it.column}: ${it.taken_for}`)))),
            h("details", {}, h("summary", {}, "The whole report"), h("pre", { class: "words", id: "report", "data-json": result.text }, result.words)),
            ...(result.notes.length ? [h("ul", { class: "notes" }, ...result.notes.map((note) => h("li", {}, note)))] : []));
        this.scale();
        this.worst();
    }

    /** Goes to the row with the largest residual of the shown stage. */
    private worst(): void {
        const { robot } = this.app;
        const rows = this.result?.residuals[this.stage]?.rows ?? [];
        const length = (left: number[]) => Math.hypot(...left);
        const [first] = [...rows].sort((a, b) => length(b.left) - length(a.left));
        this.erring.textContent = "";
        if (!first || !robot) return;
        for (const [at, name] of chain(robot).coordinates.entries()) this.app.q.set(name, first.q[at] ?? 0);
        this.app.refresh();
        this.erring.textContent = `Row ${first.row + 1} is shown: the measured position is ${number(length(first.left) * 1000, 3)} mm from the model's.`;
    }

    /** Each stage begins with arrows of a size that is seen; the factor stands beside the slider. */
    private scale(): void {
        const lengths = (this.result?.residuals[this.stage]?.rows ?? []).map(({ left }) => Math.hypot(...left));
        const rms = Math.sqrt(lengths.reduce((sum, length) => sum + length * length, 0) / Math.max(1, lengths.length));
        this.magnify = Math.min(1e6, Math.max(1, (0.08 * this.app.view.size) / Math.max(rms, 1e-12)));
        this.factor.replaceChildren(this.slider("Magnified", this.magnify / 30, this.magnify * 30, this.magnify, (value) => { this.magnify = value; this.arrows(); }, "magnify"));
        this.arrows();
    }

    private slider(words: string, min: number, max: number, value: number, change: (value: number) => void, id: string): HTMLLabelElement {
        const shown = h("output", {}, `× ${Math.round(value)}`);
        // By factors, so that small and large are equally near.
        const input = h("input", { type: "range", id, min: Math.log(min), max: Math.log(max), step: "any", value: Math.log(value), input: () => {
            const factor = Math.exp(Number(input.value));
            shown.textContent = `× ${Math.round(factor)}`;
            change(factor);
        } });
        return h("label", { class: "slider" }, h("span", { class: "name" }, words), input, shown);
    }

    /** The residual of each measured position, where the tip was. */
    private arrows(): void {
        const rows = this.result?.residuals[this.stage]?.rows ?? [];
        const robot = this.app.robot;
        const base = (robot && this.app.view.pose(0, chain(robot).base)) ?? new Matrix4();
        this.app.view.marks([], rows.map(({ at, left }) => ({
            at: new Vector3(...(at as [number, number, number])).applyMatrix4(base),
            by: new Vector3(...(left as [number, number, number])).transformDirection(base).multiplyScalar(Math.hypot(...left) * this.magnify),
            colour: 0xd55e00,
        })));
    }

    private async offerEffects(): Promise<void> {
        const robot = this.app.robot;
        if (!robot) return;
        this.possible ??= await this.app.engine.ask("effects", question(robot));
        const kinds = this.possible.kinds;
        const kind = kinds.find((it) => it.kind === this.effect.kind);
        const places = (kind?.places ?? []).map((place): [string, string] => [place, place]);
        if (kind && !kind.places.includes(this.effect.place)) this.effect.place = kind.places[0] ?? "";
        const strength = h("output", {}, `${number(this.effect.strength, 2)} mm`);
        const input = h("input", { type: "range", id: "strength", min: 0.01, max: 2, step: "any", value: this.effect.strength, input: () => {
            this.effect.strength = Number(input.value);
            strength.textContent = `${number(this.effect.strength, 2)} mm`;
            void this.act();
        } });
        this.trial.replaceChildren(
            h("h2", {}, "Try an effect"),
            h("p", { class: "fine" }, "Adds an effect to the nominal robot, and shows its influence on the tip, exaggerated. The strength is the root mean square motion of the tip over the workspace."),
            h("div", { class: "row" },
                select("Effect", [["", "none"], ...kinds.map((it): [string, string] => [it.kind, plain(it.kind)])], this.effect.kind, (value) => { this.effect.kind = value; void this.offerEffects(); }, "effect"),
                kind ? select("At", places, this.effect.place, (value) => { this.effect.place = value; void this.act(); }, "place") : null),
            ...(kind ? [h("p", { class: "fine" }, `${kind.formula} · ${kind.source}`),
                h("label", { class: "slider" }, h("span", { class: "name" }, "Strength"), input, strength),
                this.slider("Exaggerated", 1, 1000, this.exaggerate, (value) => { this.exaggerate = value; void this.act(); }, "exaggerate"),
                h("p", { id: "acted", class: "tip" })] : []));
        await this.act();
    }

    /** The tip along each joint's range, as drawn and with the effect. */
    private async act(): Promise<void> {
        const robot = this.app.robot;
        const line = this.trial.querySelector<HTMLElement>("#acted");
        if (!robot || !line || !this.effect.kind) return;
        if (this.acting) {
            this.again = true;
            return;
        }
        this.acting = true;
        const names = chain(robot).coordinates;
        const here = names.map((name) => this.app.value(name));
        const swept = Math.max(0, names.indexOf(this.effect.place));
        const joint = robot.opened.scene.joints.find((it) => it.name === names[swept]);
        const [lower, upper] = [joint?.lower ?? -Math.PI, joint?.upper ?? Math.PI];
        const count = 96;
        const q = [here, ...Array.from({ length: count + 1 }, (_, k) => here.map((value, at) => (at === swept ? lower + ((upper - lower) * k) / count : value)))];
        await this.app.trying(async () => {
            const specification = `${this.effect.kind}@${this.effect.place}=${this.effect.strength}mm`;
            const { rows } = await this.app.engine.ask("act", { source: question(robot), effect: specification, q });
            const base = this.app.view.pose(0, chain(robot).base) ?? new Matrix4();
            const point = (pose: number[]) => new Vector3(pose[12], pose[13], pose[14]);
            const shifted = (row: { drawn: number[]; acted: number[] }) => {
                const drawn = point(row.drawn);
                return [drawn.clone(), drawn.clone().lerp(point(row.acted), this.exaggerate)] as const;
            };
            const lines: { from: Vector3; to: Vector3; colour: number }[] = [];
            const path = rows.slice(1).map(shifted).map(([a, b]) => [a.applyMatrix4(base), b.applyMatrix4(base)] as const);
            path.forEach(([drawn, acted], at) => {
                const before = path[at - 1];
                if (!before) return;
                lines.push({ from: before[0], to: drawn, colour: 0x7b8794 }, { from: before[1], to: acted, colour: 0xd55e00 });
            });
            const first = rows[0];
            if (!first) return;
            const [from, to] = shifted(first);
            this.app.view.marks(lines, [{ at: from.clone().applyMatrix4(base), by: to.applyMatrix4(base).sub(from.applyMatrix4(base)), colour: 0xcc3311 }]);
            line.textContent = `here the tip moves by ${number(first.apart_m * 1000, 4)} mm; the lines are its paths while ${names[swept]} moves: grey nominal, orange with the effect`;
            line.dataset["apart"] = String(first.apart_m);
        });
        this.acting = false;
        if (this.again) {
            this.again = false;
            await this.act();
        }
    }
}
