// Sliders for the joints, and the tip's pose.

import type { App, ChainListing } from "./app";
import { chain, question } from "./app";
import type { Layer } from "./body";
import { h, number, save, select, stem } from "./dom";

const LAYERS: [layer: Layer, words: string, title: string][] = [
    ["visual", "shapes", "Visual shapes"], ["collision", "collision", "Collision shapes"],
    ["inertia", "inertia", "For each link the solid box that has its mass and inertia"], ["mass", "centres of mass", "Centres of mass of the links"],
    ["axes", "joint axes", "Axes of the moving joints"], ["frames", "link frames", "Frames of the links, as in the URDF"],
];

export class Joints {
    readonly element = h("section", { class: "joints", "aria-label": "Joints" });
    private readonly tip = h("p", { id: "tip", class: "tip", "aria-live": "off" });
    private readonly shown = new Map<Layer, boolean>();
    /** Shows a value in the slider and the field of a joint. */
    private readonly shows = new Map<string, (q: number) => void>();
    private asked = false;
    private again = false;

    /** `tools`: buttons beside those of the view, and what they open. */
    constructor(private readonly app: App, private readonly moved: () => void, private readonly tools: { buttons: HTMLElement[]; below: HTMLElement[] }) {}

    /** Shows the joint values without creating new sliders. */
    refresh(): void {
        for (const [name, show] of this.shows) show(this.app.value(name));
        this.update();
    }

    /** Makes the sliders of a robot, those of the chosen chain first. */
    fill(): void {
        const robot = this.app.robot;
        if (!robot) return;
        const listing = chain(robot);
        const drivers = robot.opened.scene.joints.filter((joint, at) => joint.driver === at);
        const mine = drivers.filter((joint) => listing.coordinates.includes(joint.name));
        const rest = drivers.filter((joint) => !mine.includes(joint));
        this.shows.clear();
        const slider = (joint: (typeof drivers)[number]) => {
            const turns = joint.kind !== "prismatic";
            const [lower, upper] = [joint.lower ?? (turns ? -Math.PI : -1), joint.upper ?? (turns ? Math.PI : 1)];
            const value = this.app.value(joint.name);
            const [unit, per] = turns ? ["°", 180 / Math.PI] : ["mm", 1000];
            const typed = h("input", {
                type: "text", inputmode: "decimal", class: "typed", "data-typed": joint.name, "aria-label": `${joint.name}, ${turns ? "degrees" : "mm"}`, autocomplete: "off",
                focus: () => typed.select(),
                change: () => {
                    const wanted = Number(typed.value.replace(",", ".").replace(/\s*(°|deg|mm)\s*$/, "").trim() || Number.NaN);
                    const [low, high] = [Number(input.min), Number(input.max)];
                    const within = Number.isFinite(wanted) && wanted / per >= low - 1e-9 && wanted / per <= high + 1e-9;
                    typed.classList.toggle("wrong", !within);
                    if (!within) {
                        this.app.say(`${joint.name} takes a number from ${number(low * per, 2)} to ${number(high * per, 2)} ${unit}`, true);
                        return;
                    }
                    this.app.say("");
                    this.app.q.set(joint.name, Math.min(high, Math.max(low, wanted / per)));
                    input.value = String(this.app.value(joint.name));
                    say(this.app.value(joint.name));
                    this.update();
                },
            });
            const say = (q: number) => {
                typed.value = number(q * per, 2);
                typed.classList.remove("wrong");
                // The slider itself counts rad and m.
                input.setAttribute("aria-valuetext", unit === "°" ? `${typed.value}°` : `${typed.value} ${unit}`);
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
            this.shows.set(joint.name, (q) => {
                input.value = String(q);
                say(q);
            });
            return h("div", { class: "slider" }, h("span", { class: "name", title: joint.name }, joint.name), input, h("span", { class: "value" }, typed, h("span", { class: "unit" }, unit)));
        };
        this.element.replaceChildren(
            h("div", { class: "row" }, this.tip, h("button", { id: "home", click: () => {
                this.app.q.clear();
                this.fill();
                this.update();
            } }, "All to 0"), h("button", { id: "fit", click: () => { this.app.view.fit(); this.app.view.draw(); } }, "Fit view"),
                h("button", { id: "picture", title: "The view as a PNG file", click: () => void this.picture() }, "PNG"),
                h("button", { id: "drawing", title: "The view as an SVG file, for print", click: () => void this.drawing() }, "SVG"),
                ...this.tools.buttons, this.named()),
            ...this.tools.below,
            h("div", { class: "row layers", role: "group", "aria-label": "Shown in the view" }, ...LAYERS.map(([name, words, title]) => {
                const box = h("input", { type: "checkbox", "data-layer": name, change: () => {
                    this.shown.set(name, box.checked);
                    this.app.view.layer(name, box.checked);
                } });
                box.checked = this.shown.get(name) ?? name === "visual";
                return h("label", { class: "check", title }, box, words);
            })),
            h("div", { class: "sliders" }, ...mine.map(slider)),
            ...(rest.length === 0 ? [] : [h("details", {}, h("summary", {}, `Joints outside this chain (${rest.length})`), h("div", { class: "sliders" }, ...rest.map(slider)))]),
        );
        this.update();
    }

    /** A box with the named postures of the SRDF. */
    private named(): HTMLElement | null {
        const { postures, robot } = this.app;
        if (postures.length === 0 || !robot) return null;
        const known = new Set(robot.opened.scene.joints.map((joint) => joint.name));
        const box = select("Posture", [["", "named …"], ...postures.map(({ name, group }, at): [string, string] => [String(at), group ? `${name} (${group})` : name])], "", (value) => {
            const posture = postures[Number(value)];
            if (value === "" || !posture) return;
            for (const [joint, q] of posture.values) if (known.has(joint)) this.app.q.set(joint, q);
            const strange = [...posture.values.keys()].filter((joint) => !known.has(joint));
            this.app.say(strange.length === 0 ? "" : `posture "${posture.name}" also sets ${strange.join(", ")}, which this robot does not have`);
            this.refresh();
        }, "posture");
        return box;
    }

    private async drawing(): Promise<void> {
        await this.app.trying(async () => {
            if (!this.app.view.works) throw new Error("there is no picture: this browser shows no 3-D view");
            save(`${stem(this.app.robot?.file ?? "")}.svg`, this.app.view.svg(), "image/svg+xml");
        });
    }

    private async picture(): Promise<void> {
        await this.app.trying(async () => {
            const picture = await this.app.view.picture();
            if (!picture) throw new Error("there is no picture: this browser shows no 3-D view");
            save(`${stem(this.app.robot?.file ?? "")}.png`, picture, "image/png");
        });
    }

    /** Moves the robot, and requests the tip's pose. */
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
