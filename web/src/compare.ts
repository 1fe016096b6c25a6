// Compare: two robots over each other, what differs in words, the tip where it is apart the most.

import { Vector3 } from "three";
import type { App, Panel } from "./app";
import { chain, question } from "./app";
import { h, number, save } from "./dom";

interface Difference {
    verdict: string;
    tips: { tip: string; sampled_m: number; bound_m: number | null; at: { joint: string; value: number }[] }[];
}

export class Compare implements Panel {
    readonly name = "Compare";
    readonly element = h("section", { class: "panel", "aria-label": "Compare" });
    private found: Difference | undefined;

    constructor(private readonly app: App) {}

    async show(): Promise<void> {
        const { robot, other } = this.app;
        if (!robot) return;
        if (!other) {
            this.element.replaceChildren(h("h2", {}, "Drop the other robot"),
                h("p", {}, `Drop or open a second file here: an older revision, an export, the vendor's table. It is compared with ${robot.opened.robot || robot.file}.`));
            return;
        }
        this.element.replaceChildren(h("p", { role: "status" }, "comparing …"));
        this.found = undefined;
        await this.app.trying(async () => {
            const answer = await this.app.engine.ask("diff", { a: question(robot), b: question(other) });
            this.found = JSON.parse(answer.text) as Difference;
            const worst = [...this.found.tips].sort((a, b) => b.sampled_m - a.sampled_m)[0];
            this.element.replaceChildren(
                h("h2", { id: "verdict", class: this.found.verdict }, this.found.verdict === "different" ? "Different robots" : "The same robot"),
                h("p", {}, h("span", { class: "key mine" }, robot.file), " and ", h("span", { class: "key other" }, other.file)),
                h("div", { class: "row" },
                    worst && worst.sampled_m > 0
                        ? h("button", { id: "worst", class: "main", click: () => this.go(worst.at) }, `Go where ${worst.tip} is apart the most: ${number(worst.sampled_m * 1000, 3)} mm`)
                        : null,
                    h("button", { id: "swap", click: () => void this.swap() }, "Swap"),
                    h("button", { click: () => save("diff.json", answer.text, "application/json") }, "Download JSON")),
                h("p", { id: "apart", class: "tip" }),
                h("pre", { id: "words", class: "words", "data-json": answer.text }, answer.words));
            this.app.view.show(1, other.opened.scene, other.meshes, `/${other.file}`, other.packages);
            this.app.view.fit();
            this.app.move();
            this.moved();
        });
    }

    private go(at: { joint: string; value: number }[]): void {
        for (const { joint, value } of at) this.app.q.set(joint, value);
        this.app.changed();
        // The posture may lie outside of what was seen.
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
        line.textContent = `at this posture the tips are ${number(apart * 1000, 3)} mm apart, their roots laid on each other`;
        view.marks([{ from, to, colour: 0xcc3311 }], []);
    }

    hide(): void {
        this.app.view.show(1, null);
        this.app.view.marks([], []);
    }
}
