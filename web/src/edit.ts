// Edit: an operation on the robot's URDF, what is proved of it or why it is refused, the robot before and after, the new text.

import type { App, Panel, Robot } from "./app";
import { question } from "./app";
import { h, save, select, stem } from "./dom";

interface Possible {
    name: string;
    usage: string;
    purpose: string;
}

/** What one word of an operation is: a name of the robot's, one of a list, or typed. */
type Field = { of: "joint" | "link" | "either" } | { one: string[] } | { typed: string; optional?: true };

const FIELDS: Record<string, Field[]> = {
    flip: [{ of: "joint" }], zero: [{ of: "joint" }, { typed: "90deg" }], reroot: [{ of: "link" }],
    rename: [{ of: "either" }, { typed: "new name" }], prefix: [{ typed: "left_" }], extract: [{ of: "link" }], cut: [{ of: "link" }],
    mirror: [{ one: ["xz", "yz", "xy"] }, { typed: "left=right", optional: true }],
    origin: [{ of: "link" }, { typed: "0,0,10mm,0,0,90deg" }], scale: [{ typed: "2" }], units: [{ one: ["mm", "cm", "in", "m"] }],
};
/** How the fields' values are words of the command line, where they are not the words themselves. */
const WORDS: Record<string, (values: string[]) => string[]> = {
    zero: ([joint, value]) => [`${joint}=${value}`],
    rename: ([old, name]) => [`${old}=${name}`],
    mirror: ([plane, names]) => [plane ?? "", ...(names ? ["--names", names] : [])],
    origin: ([link, to]) => [link ?? "", "--to", to ?? ""],
};
type Seen = "before" | "after" | "both";

export class Edit implements Panel {
    readonly name = "Edit";
    readonly element = h("section", { class: "panel", "aria-label": "Edit" });
    private readonly fields = h("div", { class: "row" });
    private readonly purpose = h("p", { class: "fine" });
    private readonly outcome = h("div", { id: "edited" });
    private possible: Possible[] = [];
    private chosen = "zero";
    private robot: Robot | undefined;

    constructor(private readonly app: App) {}

    async show(): Promise<void> {
        const { robot } = this.app;
        if (!robot) return;
        await this.app.trying(async () => {
            if (this.possible.length === 0) this.possible = (await this.app.engine.ask("edits", {})).operations;
            if (robot !== this.robot) this.outcome.replaceChildren();
            this.robot = robot;
            this.element.replaceChildren(
                h("div", { class: "row" }, select("Operation", this.possible.map(({ name }) => [name, name]), this.chosen, (name) => this.choose(name, robot), "operation")),
                this.purpose, this.fields,
                h("div", { class: "row" }, h("button", { id: "edit", class: "main", click: () => void this.edit(robot) }, "Edit")),
                this.outcome,
                h("p", { class: "fine" }, "Operations on other files and on meshes (attach, set-calibration, simplify-collision, meshes) are in the program: denavit edit."));
            this.choose(this.chosen, robot);
        });
    }

    private choose(name: string, robot: Robot): void {
        this.chosen = name;
        this.purpose.textContent = this.possible.find((it) => it.name === name)?.purpose ?? "";
        const { joints, links } = robot.opened.scene;
        const inputs = (FIELDS[name] ?? []).map((field) => {
            if ("typed" in field) return h("input", { class: "word", placeholder: field.typed, "aria-label": `such as ${field.typed}`, "data-optional": field.optional ?? null });
            const moving = joints.filter((joint) => joint.kind !== "fixed" || name !== "flip" && name !== "zero").map((joint) => joint.name);
            const names = "one" in field ? field.one : [...(field.of === "link" ? [] : moving), ...(field.of === "joint" ? [] : links.map((link) => link.name))];
            return h("select", { "aria-label": "one" in field ? "which" : field.of }, ...[...new Set(names)].map((it) => h("option", { value: it }, it)));
        });
        this.fields.replaceChildren(...inputs);
    }

    private words(): string[] {
        const values = [...this.fields.children].map((child) => {
            const input = child as HTMLInputElement | HTMLSelectElement;
            if (input.value === "" && !("optional" in input.dataset)) throw new Error(`${this.chosen}: write ${this.possible.find((it) => it.name === this.chosen)?.usage ?? ""}`);
            return input.value;
        });
        return [this.chosen, ...(WORDS[this.chosen]?.(values) ?? values)];
    }

    private async edit(robot: Robot): Promise<void> {
        this.hide();
        this.outcome.replaceChildren();
        try {
            const { text, said, notes } = await this.app.engine.ask("edit", { source: question(robot), words: this.words() });
            const asked = { ...question(robot), file: `${stem(robot.file)}_edited.urdf`, text };
            // Base and tip may have other names.
            delete asked.base;
            delete asked.tip;
            const opened = await this.app.engine.ask("open", asked);
            if (robot !== this.app.robot) return;
            this.app.other = { ...robot, ...asked, written: text, opened };
            this.app.view.show(1, opened.scene, robot.meshes, `/${robot.file}`, robot.packages);
            const pressed = (["before", "after", "both"] as Seen[]).map((seen) => h("button", { id: `seen-${seen}`, click: () => this.see(seen) }, seen));
            this.outcome.replaceChildren(
                h("ul", { id: "proof" }, ...said.map((line) => h("li", {}, line))),
                ...(notes.length > 0 ? [h("ul", { class: "notes" }, ...notes.map((line) => h("li", {}, line)))] : []),
                h("div", { class: "row" }, ...pressed,
                    h("button", { id: "download-edited", class: "main", click: () => save(asked.file, text, "application/xml") }, "Download URDF"),
                    h("button", { id: "go-on", click: () => void this.app.trying(() => this.app.open({ ...asked, names: robot.names }, robot.meshes, robot.packages)) }, "Go on with it")),
                h("p", { class: "fine" }, "Compare shows the two beside each other, with every difference."));
            this.see("after");
            this.app.view.fit();
            this.app.move();
        } catch (error) {
            this.outcome.replaceChildren(h("p", { class: "said wrong", id: "refused" }, `Not done: ${error instanceof Error ? error.message : String(error)}`));
        }
    }

    private see(seen: Seen): void {
        this.app.view.see(0, seen !== "after");
        this.app.view.see(1, seen !== "before");
        for (const which of ["before", "after", "both"]) this.outcome.querySelector(`#seen-${which}`)?.setAttribute("aria-pressed", String(which === seen));
    }

    hide(): void {
        this.app.view.show(1, null);
        this.app.view.see(0, true);
        // The edited robot stays at hand for a comparison, but not for this page.
        this.robot = undefined;
    }
}
