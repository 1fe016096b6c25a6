// Sliders for the joints, and where the tip is.

import type { App, ChainListing } from "./app";
import { chain, question } from "./app";
import { h, number } from "./dom";

export class Joints {
    readonly element = h("section", { class: "joints", "aria-label": "Joints" });
    private readonly tip = h("p", { id: "tip", class: "tip", "aria-live": "off" });
    private asked = false;
    private again = false;

    constructor(private readonly app: App, private readonly moved: () => void) {}

    /** Makes the sliders of a robot, those of the chosen chain first. */
    fill(): void {
        const robot = this.app.robot;
        if (!robot) return;
        const listing = chain(robot);
        const drivers = robot.opened.scene.joints.filter((joint, at) => joint.driver === at);
        const mine = drivers.filter((joint) => listing.coordinates.includes(joint.name));
        const rest = drivers.filter((joint) => !mine.includes(joint));
        const slider = (joint: (typeof drivers)[number]) => {
            const turns = joint.kind !== "prismatic";
            const [lower, upper] = [joint.lower ?? (turns ? -Math.PI : -1), joint.upper ?? (turns ? Math.PI : 1)];
            const value = this.app.value(joint.name);
            const shown = h("output", {});
            const say = (q: number) => {
                shown.textContent = turns ? `${number((q * 180) / Math.PI, 1)}°` : `${number(q * 1000, 1)} mm`;
                // The slider itself counts rad and m.
                input.setAttribute("aria-valuetext", shown.textContent);
            };
            const input = h("input", {
                type: "range", min: Math.min(lower, upper), max: Math.max(lower, upper), step: "any", value, "data-joint": joint.name, "aria-label": joint.name,
                input: () => {
                    this.app.q.set(joint.name, Number(input.value));
                    say(Number(input.value));
                    this.update();
                },
            });
            say(value);
            return h("label", { class: "slider" }, h("span", { class: "name", title: joint.name }, joint.name), input, shown);
        };
        this.element.replaceChildren(
            h("div", { class: "row" }, this.tip, h("button", { id: "home", click: () => {
                this.app.q.clear();
                this.fill();
                this.update();
            } }, "All to 0"), h("button", { id: "fit", click: () => { this.app.view.fit(); this.app.view.draw(); } }, "Fit view")),
            h("div", { class: "sliders" }, ...mine.map(slider)),
            ...(rest.length === 0 ? [] : [h("details", {}, h("summary", {}, `Joints outside of this chain (${rest.length})`), h("div", { class: "sliders" }, ...rest.map(slider)))]),
        );
        this.update();
    }

    /** Moves the robot, and asks where its tip is. */
    update(): void {
        this.app.move();
        this.moved();
        void this.tell();
    }

    private async tell(): Promise<void> {
        if (this.asked) {
            this.again = true;
            return;
        }
        this.asked = true;
        const robot = this.app.robot;
        try {
            if (robot) {
                const listing: ChainListing = chain(robot);
                const q = Object.fromEntries(listing.coordinates.map((name) => [name, this.app.value(name)]));
                const { text } = await this.app.engine.ask("fk", { source: question(robot), q });
                const fk = JSON.parse(text) as { tip: string; xyz: number[]; rpy: number[]; pose: number[][] };
                const millimetres = fk.xyz.map((value) => number(value * 1000, 2)).join(", ");
                const degrees = fk.rpy.map((value) => number((value * 180) / Math.PI, 2)).join(", ");
                this.tip.textContent = `${fk.tip}: x y z ${millimetres} mm, roll pitch yaw ${degrees}°`;
                this.tip.dataset["pose"] = JSON.stringify(fk.pose);
                this.tip.dataset["q"] = JSON.stringify(q);
            }
        } catch (error) {
            this.tip.textContent = error instanceof Error ? error.message : String(error);
        }
        this.asked = false;
        if (this.again) {
            this.again = false;
            void this.tell();
        }
    }
}
