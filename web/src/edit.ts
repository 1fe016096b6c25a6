// Edit: an operation on the robot's URDF, its proof or why it is refused, the robot before and after, the new text.

import type { App, Panel, Robot } from "./app";
import { question } from "./app";
import { fill, h, save, select, stem } from "./dom";
import type { RobotText } from "./engine";

interface Possible {
    name: string;
    usage: string;
    purpose: string;
}

/** One argument of an operation: a name of the robot's, one of a list, a robot's file, or typed. `all`: none need be given. */
type Field = { words: string; id: string } & ({ of: "joint" | "fixed" | "link" | "either"; all?: string } | { one: [value: string, words: string][] } | { file: true } | { typed: string; optional?: true });

const LINK = { words: "Link", id: "link", of: "link" } as const;
const JOINT = { words: "Joint", id: "joint", of: "joint" } as const;
const POSE = "x,y,z,roll,pitch,yaw: 0,0,10mm,0,0,90deg";

/** The fields of an operation, and how their values are words of the command line, where they are not the words themselves. */
const OPERATIONS: Record<string, { fields: Field[]; words?: (values: string[]) => string[] }> = {
    flip: { fields: [JOINT] },
    zero: { fields: [JOINT, { words: "Its new zero", id: "value", typed: "90deg" }], words: ([joint, value]) => [`${joint}=${value}`] },
    reroot: { fields: [LINK] },
    rename: { fields: [{ words: "Name", id: "old", of: "either" }, { words: "New name", id: "new", typed: "new name" }], words: ([old, name]) => [`${old}=${name}`] },
    prefix: { fields: [{ words: "Prefix", id: "prefix", typed: "left_" }] },
    merge: { fields: [{ words: "Fixed joint", id: "joint", of: "fixed", all: "all" }, { words: "Keep", id: "keep", of: "link", all: "no frame" }], words: ([joint, keep]) => [...said(joint), ...option("keep", keep)] },
    attach: { fields: [{ words: "Robot", id: "other", file: true }, { ...LINK, words: "On link" }, { words: "At", id: "pose", typed: POSE, optional: true }, { words: "Prefix of its names", id: "prefix", typed: "gripper_", optional: true }], words: ([file, link, pose, prefix]) => [file ?? "", ...option("at", link), ...option("pose", pose), ...option("prefix", prefix)] },
    extract: { fields: [LINK] },
    cut: { fields: [LINK] },
    mirror: { fields: [{ words: "Plane", id: "plane", one: [["xz", "xz"], ["yz", "yz"], ["xy", "xy"]] }, { words: "Parts of names swapped", id: "names", typed: "left=right", optional: true }], words: ([plane, names]) => [plane ?? "", ...option("names", names)] },
    origin: { fields: [LINK, { words: "To", id: "to", typed: POSE }], words: ([link, to]) => [link ?? "", ...option("to", to)] },
    recentre: { fields: [{ ...LINK, all: "all" }], words: ([link]) => said(link) },
    scale: { fields: [{ words: "Factor", id: "factor", typed: "2" }] },
    units: { fields: [{ words: "Its lengths are in", id: "unit", one: [["mm", "mm"], ["cm", "cm"], ["in", "inches"], ["m", "m"]] }] },
};

const said = (word: string | undefined): string[] => (word ? [word] : []);
const option = (name: string, value: string | undefined): string[] => (value ? [`--${name}`, value] : []);

type Seen = "before" | "after" | "both";

export class Edit implements Panel {
    readonly name = "Edit";
    readonly element = h("section", { class: "panel", "aria-label": "Edit" });
    private readonly fields = h("div", { class: "row" });
    private readonly purpose = h("p", { id: "purpose" });
    private readonly outcome = h("div", { id: "edited" });
    private possible: Possible[] = [];
    private chosen = "zero";
    private robot: Robot | undefined;
    private second: RobotText | undefined;

    constructor(private readonly app: App) {}

    async show(): Promise<void> {
        const { robot } = this.app;
        if (!robot) return;
        await this.app.trying(async () => {
            if (this.possible.length === 0) this.possible = (await this.app.engine.ask("edits", {})).operations;
            if (robot !== this.robot) this.outcome.replaceChildren();
            this.robot = robot;
            fill(this.element,
                h("h2", {}, "Edit the URDF"),
                h("div", { class: "row" }, select("Operation", this.possible.map(({ name }) => [name, name]), this.chosen, (name) => this.choose(name, robot), "operation")),
                this.purpose, this.fields,
                h("div", { class: "row" }, h("button", { id: "edit", class: "main", click: () => void this.edit(robot) }, "Edit")),
                this.outcome,
                h("p", { class: "fine" }, "The command line has more: set-calibration, simplify-collision, meshes; see denavit edit --help."));
            this.choose(this.chosen, robot);
        });
    }

    private choose(name: string, robot: Robot): void {
        this.chosen = name;
        this.second = undefined;
        const about = this.possible.find((it) => it.name === name);
        this.purpose.textContent = about ? `${about.purpose.charAt(0).toUpperCase()}${about.purpose.slice(1)}.` : "";
        fill(this.fields, ...(OPERATIONS[name]?.fields ?? []).map((field) => this.field(field, robot)));
    }

    private field(field: Field, robot: Robot): HTMLElement {
        const id = `edit-${field.id}`;
        if ("typed" in field) return h("label", { class: "choice" }, h("span", {}, field.words), h("input", { id, class: "word", type: "text", autocomplete: "off", spellcheck: "false", placeholder: field.typed, "data-optional": field.optional ?? null, size: Math.max(12, field.typed.length) }));
        if ("file" in field) {
            const name = h("span", {}, "choose a URDF");
            const input = h("input", { id, type: "file", "aria-label": field.words, change: () => void this.app.trying(async () => {
                const file = input.files?.[0];
                if (!file) return;
                this.second = { file: file.name, text: await file.text(), files: {}, names: [], exact: robot.exact };
                name.textContent = file.name;
            }) });
            return h("span", { class: "choice" }, h("span", {}, field.words), h("label", { class: "button" }, name, input));
        }
        if ("one" in field) return select(field.words, field.one, "", () => {}, id);
        const { joints, links } = robot.opened.scene;
        const kinds = { joint: (kind: string) => kind !== "fixed", fixed: (kind: string) => kind === "fixed", either: () => true, link: () => false };
        const names = [...joints.filter((joint) => kinds[field.of](joint.kind)).map((joint) => joint.name), ...(field.of === "link" || field.of === "either" ? links.map((link) => link.name) : [])];
        return select(field.words, [...(field.all ? [["", field.all] as [string, string]] : []), ...[...new Set(names)].map((name): [string, string] => [name, name])], "", () => {}, id);
    }

    private words(): string[] {
        const inputs = [...this.fields.querySelectorAll<HTMLInputElement | HTMLSelectElement>("input, select")];
        const values = inputs.map((input) => {
            const value = input.type === "file" ? (this.second?.file ?? "") : input.value.trim();
            if (value === "" && input.tagName === "INPUT" && !("optional" in input.dataset)) throw new Error(`${this.chosen}: write ${this.possible.find((it) => it.name === this.chosen)?.usage ?? ""}`);
            return value;
        });
        return [this.chosen, ...(OPERATIONS[this.chosen]?.words?.(values) ?? values)];
    }

    private async edit(robot: Robot): Promise<void> {
        this.hide();
        this.robot = robot;
        this.outcome.replaceChildren();
        try {
            const { text, said, notes, diff } = await this.app.engine.ask("edit", { source: question(robot), words: this.words(), other: this.second ?? null });
            // Beside the robot's own file, where its meshes are found.
            const folder = robot.file.slice(0, robot.file.lastIndexOf("/") + 1);
            const name = `${stem(robot.file).replace(/_edited$/, "")}_edited.urdf`;
            const asked = { ...question(robot), file: `${folder}${name}`, text };
            // Base and tip may have other names.
            delete asked.base;
            delete asked.tip;
            const opened = await this.app.engine.ask("open", asked);
            if (robot !== this.app.robot) return;
            this.app.other = { ...robot, ...asked, written: text, opened };
            const buttons = (["before", "after", "both"] as Seen[]).map((seen) => h("button", { id: `seen-${seen}`, click: () => this.see(seen) }, `${seen.charAt(0).toUpperCase()}${seen.slice(1)}`));
            fill(this.outcome,
                h("h3", {}, "Done, and proved"),
                h("ul", { id: "proof" }, ...said.flatMap((line) => line.split("; ")).map((line) => h("li", {}, line))),
                notes.length > 0 ? h("ul", { class: "notes" }, ...notes.map((line) => h("li", {}, line))) : null,
                h("div", { class: "row", role: "group", "aria-label": "Robot in the view" }, ...buttons),
                h("div", { class: "row" },
                    h("button", { id: "download-edited", class: "main", click: () => save(name, text, "application/xml") }, "Download URDF"),
                    h("button", { id: "go-on", click: () => void this.app.trying(() => this.app.open({ ...asked, names: robot.names }, robot.meshes, robot.packages)) }, "Continue to edit this robot")),
                h("details", {}, h("summary", {}, "Changed lines"), h("pre", { class: "code", id: "diff" }, ...diff.split("\n").map((line) => h("span", { class: /^[+-](?![+-]{2} )/.test(line) ? "here" : "near" }, `${line}\n`)))));
            this.see("after");
            this.app.view.fit();
        } catch (error) {
            this.outcome.replaceChildren(h("p", { class: "said wrong", id: "refused" }, `Refused: ${error instanceof Error ? error.message : String(error)}`));
        }
    }

    private see(seen: Seen): void {
        const { other, view } = this.app;
        if (!other) return;
        view.see(0, seen !== "after");
        // Drawn together the two are distinguished by colours; alone the new one has its own.
        view.show(1, seen === "before" ? null : other.opened.scene, other.meshes, `/${other.file}`, other.packages, seen === "after");
        this.app.move();
        for (const which of ["before", "after", "both"]) this.outcome.querySelector(`#seen-${which}`)?.setAttribute("aria-pressed", String(which === seen));
    }

    hide(): void {
        this.app.view.show(1, null);
        this.app.view.see(0, true);
        // The edited robot is kept for a comparison, but not for this page.
        this.robot = undefined;
    }
}
