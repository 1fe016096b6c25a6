// Compare: two robots over each other, the differences as text, the largest distance of the tips.

import { Vector3 } from "three";
import type { App, Panel, Robot } from "./app";
import { called, chain, question } from "./app";
import { h, number, save } from "./dom";
import { basename } from "./files";

interface Difference {
    verdict: string;
    tips: { tip: string; sampled_m: number; bound_m: number | null; at: { joint: string; value: number }[] }[];
}

export class Compare implements Panel {
    readonly name = "Compare";
    readonly element = h("section", { class: "panel", "aria-label": "Compare" });
    private found: Difference | undefined;
    /** Set once: the next comparison begins at the largest distance of the tips. */
    begins = false;

    constructor(private readonly app: App) {}

    async show(): Promise<void> {
        const { robot, other } = this.app;
        if (!robot) return;
        if (!other) {
            this.element.replaceChildren(h("h2", {}, "Drop the other robot"),
                h("p", {}, `Drop or open a second file here: an older revision, an export, the vendor's table. It is compared with ${called(robot)}.`));
            return;
        }
        this.element.replaceChildren(h("p", { role: "status" }, "comparing …"));
        this.found = undefined;
        await this.app.trying(async () => {
            const answer = await this.app.engine.ask("diff", { a: question(robot), b: question(other) });
            // Robots of the same name are distinguished by their files.
            const alike = called(robot) === called(other);
            const words = (it: Robot) => (alike ? `${called(it)} (${basename(it.file)})` : called(it));
            this.found = JSON.parse(answer.text) as Difference;
            const worst = [...this.found.tips].sort((a, b) => b.sampled_m - a.sampled_m)[0];
            this.element.replaceChildren(
                h("h2", { id: "verdict", class: this.found.verdict }, this.found.verdict === "different" ? "Different robots" : "The same robot"),
                h("p", {}, h("span", { class: "key mine", title: robot.file }, words(robot)), " and ", h("span", { class: "key other", title: other.file }, words(other))),
                h("div", { class: "row" },
                    worst && worst.sampled_m > 0
                        ? h("button", { id: "worst", class: "main", click: () => this.go(worst.at) }, `Go to the largest distance of ${worst.tip}: ${number(worst.sampled_m * 1000, 3)} mm`)
                        : null,
                    h("button", { id: "swap", click: () => void this.swap() }, "Swap"),
                    h("button", { click: () => save("diff.json", answer.text, "application/json") }, "Download JSON")),
                h("p", { id: "apart", class: "tip" }),
                ...grouped(answer.words),
                h("details", {}, h("summary", {}, "Output of the command line"), h("pre", { id: "words", class: "words", "data-json": answer.text }, answer.words)));
            this.app.view.show(1, other.opened.scene, other.meshes, `/${other.file}`, other.packages);
            this.app.view.fit();
            this.app.move();
            this.moved();
            if (this.begins && worst && worst.sampled_m > 0) this.go(worst.at);
            this.begins = false;
        });
    }

    private go(at: { joint: string; value: number }[]): void {
        for (const { joint, value } of at) this.app.q.set(joint, value);
        this.app.refresh();
        // The posture may be outside the visible area.
        this.app.view.fit();
    }

    private async swap(): Promise<void> {
        const { robot, other, view } = this.app;
        if (!robot || !other) return;
        [this.app.robot, this.app.other] = [other, robot];
        this.app.table = undefined;
        view.show(1, null);
        view.show(0, other.opened.scene, other.meshes, `/${other.file}`, other.packages);
        this.app.changed();
    }

    moved(): void {
        const { robot, other, view } = this.app;
        if (!robot || !other || !this.found) return;
        const one = view.pose(0, chain(robot).tip);
        const two = view.pose(1, chain(other).tip);
        const line = this.element.querySelector("#apart");
        if (!one || !two || !line) return;
        const [from, to] = [new Vector3().setFromMatrixPosition(one), new Vector3().setFromMatrixPosition(two)];
        const apart = from.distanceTo(to);
        line.textContent = `at this posture the tips are ${number(apart * 1000, 3)} mm apart, with their roots aligned`;
        view.marks([{ from, to, colour: 0xcc3311 }], []);
    }

    hide(): void {
        this.app.view.show(1, null);
        this.app.view.marks([], []);
    }
}

/** Differences by what they are of: tips, joints, the rest; names of meshes last, notes closed. `words`: a line each, from the engine. */
function grouped(words: string): HTMLElement[] {
    const [notes, groups]: [string[], Map<string, string[]>] = [[], new Map()];
    // The first line is the verdict.
    for (const line of words.split("\n").slice(1)) {
        if (line.trim() === "") continue;
        const [, subject, message] = /^\s*((?:joint|tip|link|robot|material|<)(?:"[^"]*"|[^":])*): (.*)$/.exec(line) ?? [];
        if (subject === undefined || message === undefined) notes.push(line.trim());
        else {
            const key = /\.(stl|dae|obj)\b/i.test(message) ? `4${subject}` : `${subject.startsWith("tip ") ? 1 : subject.startsWith("joint ") ? 2 : 3}${subject}`;
            groups.set(key, [...(groups.get(key) ?? []), message]);
        }
    }
    const sorted = [...groups].map(([key, messages], at) => ({ key, messages, at })).sort((a, b) => Number(a.key[0]) - Number(b.key[0]) || a.at - b.at);
    const list = (messages: string[]) => h("ul", {}, ...messages.map((message) => h("li", {}, message)));
    return [
        h("div", { id: "differences" }, ...sorted.map(({ key, messages }) => h("section", { class: "difference" }, h("h3", {}, key.slice(1)), list(messages)))),
        ...(notes.length === 0 ? [] : [h("details", { id: "difference-notes" }, h("summary", {}, `Notes (${notes.length})`), list(notes))]),
    ];
}
