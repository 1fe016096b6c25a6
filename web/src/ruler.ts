// A ruler between two points of the robot: they stay on their links when joints move.

import { Vector3 } from "three";
import type { App } from "./app";
import { fill, h, number } from "./dom";
import { placed } from "./table";
import type { Picked } from "./view";

export class Ruler {
    readonly element = h("p", { id: "measured", class: "tip", role: "status", hidden: true });
    readonly button = h("button", { id: "measure", "aria-pressed": "false", title: "Distance between two points of the robot or origins of its frames", click: () => this.turn(!this.on) }, "Measure");
    private on = false;
    private points: Picked[] = [];

    constructor(private readonly app: App) {
        addEventListener("keydown", (event) => {
            if (event.key === "Escape" && this.on) this.turn(false);
        });
    }

    turn(on: boolean): void {
        this.on = on;
        this.points = [];
        this.button.setAttribute("aria-pressed", String(on));
        this.element.hidden = !on;
        this.app.view.onpick = on ? (picked) => this.pick(picked) : undefined;
        this.moved();
    }

    private pick(picked: Picked): void {
        this.points = this.points.length === 2 ? [picked] : [...this.points, picked];
        this.moved();
    }

    /** Where a point is now, in the root's frame. */
    private at({ link, row, local }: Picked): Vector3 | undefined {
        const { view, table } = this.app;
        if (row !== null) {
            const base = table && view.pose(0, table.base);
            const frame = table && placed(table, (name) => this.app.value(name))[row];
            return base && frame ? new Vector3().setFromMatrixPosition(frame.to).applyMatrix4(base) : undefined;
        }
        const pose = view.pose(0, link);
        return pose && local.clone().applyMatrix4(pose);
    }

    moved(): void {
        const [first, second] = this.points;
        const [from, to] = [first && this.at(first), second && this.at(second)];
        delete this.element.dataset["metres"];
        if (!first || !from) fill(this.element, "Click two points: on a shape, or on a frame for its origin.");
        else if (!second || !to) fill(this.element, `From ${first.words}; click the second point.`);
        else {
            const [apart, by] = [from.distanceTo(to), to.clone().sub(from)];
            const along = by.toArray().map((value) => number(value * 1000, 2)).join(", ");
            fill(this.element, h("b", {}, `${number(apart * 1000, 2)} mm`), ` from ${first.words} to ${second.words}; along x, y, z of the root ${along} mm`);
            this.element.dataset["metres"] = String(apart);
        }
        this.app.view.rule([from, to].filter((point) => point !== undefined));
    }
}
