// The tip dragged by hand: joints follow by inverse kinematics, and the other postures that reach the same pose are shown as ghosts.

import { Euler, Matrix4, Vector3 } from "three";
import { TransformControls } from "three/addons/controls/TransformControls.js";
import type { App } from "./app";
import { chain, question } from "./app";
import { fill, h, number } from "./dom";
import type { IkAnswer, SceneJoint } from "./engine";

/** Joint values that differ by less are the same posture, rad and m. */
const SAME = 1e-4;
const DEGREE = 180 / Math.PI;
/** Place in mm, then roll, pitch, yaw in degrees: R = Rz(yaw) Ry(pitch) Rx(roll), as `denavit ik` takes them. */
const FIELDS: [unit: string, ...names: string[]][] = [["mm", "x", "y", "z"], ["°", "roll", "pitch", "yaw"]];
const NAMES = FIELDS.flatMap(([, ...names]) => names);

type Solution = IkAnswer["solutions"][number];

export class Reach {
    readonly element = h("section", { id: "reach", "aria-label": "Tip", hidden: true });
    readonly button = h("button", { id: "drag", "aria-pressed": "false", title: "Drag the tip: the joints follow by inverse kinematics", click: () => this.turn(!this.on) }, "Drag tip");
    private readonly words = h("p", { id: "reached", class: "tip", role: "status" });
    private readonly branch = h("select", { id: "branch", "aria-label": "Posture", change: () => this.choose(Number(this.branch.value)) });
    private readonly moving = h("button", { id: "moving", title: "Arrows move the tip", click: () => this.mode(false) }, "Move");
    private readonly turning = h("button", { id: "turning", title: "Rings turn the tip; also while Shift is held", click: () => this.mode(true) }, "Turn");
    private readonly typed = new Map<string, HTMLInputElement>();
    private on = false;
    private turns = false;
    /** The next target of the tip, base_from_tip; null: the current pose. */
    private next: { pose: Matrix4 | null } | undefined;
    private asking = false;
    /** Set while this tool changes the joint values. */
    private mine = false;
    /** Postures within limits, the present one first. */
    private postures: Solution[] = [];

    constructor(private readonly app: App) {
        const { view } = app;
        view.grips = (camera, canvas) => new TransformControls(camera, canvas);
        view.onhandle = (pose) => {
            const base = this.base();
            if (!this.on || !base) return;
            this.want(base.clone().invert().multiply(pose));
        };
        view.onghost = (index) => this.choose(index + 1);
        const shift = (event: KeyboardEvent) => {
            if (event.key === "Escape" && this.on && event.type === "keydown") this.turn(false);
            if (event.key === "Shift" && this.on && !view.dragging) view.turns(this.turns !== (event.type === "keydown"));
        };
        addEventListener("keydown", shift);
        addEventListener("keyup", shift);
        const field = (name: string, unit: string) => {
            const input: HTMLInputElement = h("input", { type: "text", inputmode: "decimal", class: "typed", "data-pose": name, "aria-label": `${name} of the tip, ${unit === "mm" ? "mm" : "degrees"}`, autocomplete: "off", focus: () => input.select(), change: () => this.type() });
            this.typed.set(name, input);
            return h("label", { class: "choice" }, h("span", {}, name), input);
        };
        this.element.append(
            h("div", { class: "row" }, this.moving, this.turning, h("label", { class: "choice" }, h("span", {}, "Posture"), this.branch)),
            h("div", { class: "row pose" }, ...FIELDS.map(([unit, ...names]) => h("span", { class: "row" }, ...names.map((name) => field(name, unit)), h("span", { class: "unit" }, unit)))),
            this.words);
    }

    turn(on: boolean): void {
        this.on = on && this.app.robot !== undefined;
        this.button.setAttribute("aria-pressed", String(this.on));
        this.element.hidden = !this.on;
        this.postures = [];
        this.next = undefined;
        if (this.on) {
            this.moved();
            this.mode(false);
        } else {
            this.app.view.handle(null);
            this.app.view.ghosts([]);
        }
    }

    /** Whether no question is pending, for tests. */
    get settled(): boolean {
        return !this.asking && this.next === undefined;
    }

    /** Joint values have changed: the handle goes where the tip is, the ghosts are those of its pose. */
    moved(): void {
        if (!this.on || this.mine) return;
        this.rest();
        this.want(null);
    }

    private mode(turns: boolean): void {
        this.turns = turns;
        this.moving.setAttribute("aria-pressed", String(!turns));
        this.turning.setAttribute("aria-pressed", String(turns));
        this.app.view.turns(turns);
    }

    private base(): Matrix4 | undefined {
        const { robot, view } = this.app;
        return robot && view.pose(0, chain(robot).base);
    }

    /** base_from_tip at the joint values that are shown. */
    private tip(): Matrix4 | undefined {
        const { robot, view } = this.app;
        const [base, tip] = [this.base(), robot && view.pose(0, chain(robot).tip)];
        return base && tip && base.clone().invert().multiply(tip);
    }

    /** Moves the handle and the numbers to the tip's pose. */
    private rest(): void {
        const { robot, view } = this.app;
        const [pose, tip] = [robot && view.pose(0, chain(robot).tip), this.tip()];
        if (!pose || !tip) return;
        view.handle(pose);
        view.warn("");
        this.say(tip);
    }

    private say(tip: Matrix4): void {
        const place = new Vector3().setFromMatrixPosition(tip).multiplyScalar(1000);
        const { x, y, z } = new Euler().setFromRotationMatrix(tip, "ZYX");
        for (const [at, value] of [place.x, place.y, place.z, x * DEGREE, y * DEGREE, z * DEGREE].entries()) {
            const input = this.typed.get(NAMES[at] ?? "");
            if (!input) continue;
            input.value = number(value, 2);
            input.dataset["exact"] = String(value);
            input.classList.remove("wrong");
        }
    }

    /** A pose typed; unchanged numbers keep all their digits. */
    private type(): void {
        const values: number[] = [];
        for (const name of NAMES) {
            const input = this.typed.get(name);
            const text = input?.value.trim().replace(",", ".") ?? "";
            const exact = Number(input?.dataset["exact"]);
            const value = text === number(exact, 2) ? exact : text === "" ? Number.NaN : Number(text);
            input?.classList.toggle("wrong", !Number.isFinite(value));
            if (!Number.isFinite(value)) return fill(this.words, `${name} takes a number`);
            values.push(value);
        }
        const [x = 0, y = 0, z = 0, roll = 0, pitch = 0, yaw = 0] = values;
        const pose = new Matrix4().makeRotationFromEuler(new Euler(roll / DEGREE, pitch / DEGREE, yaw / DEGREE, "ZYX"));
        this.want(pose.setPosition(x / 1000, y / 1000, z / 1000));
    }

    private want(pose: Matrix4 | null): void {
        this.next = { pose };
        if (!this.asking) void this.ask();
    }

    private async ask(): Promise<void> {
        this.asking = true;
        while (this.on && this.next) {
            const { pose } = this.next;
            this.next = undefined;
            const { robot } = this.app;
            const wanted = pose ?? this.tip();
            if (!robot || !wanted) break;
            const names = chain(robot).coordinates;
            const near = names.map((name) => this.app.value(name));
            try {
                const answer = await this.app.engine.ask("ik", { source: question(robot), pose: wanted.toArray(), near });
                if (this.on && robot === this.app.robot) this.show(answer, wanted, names, pose !== null);
            } catch (error) {
                this.postures = [];
                this.list([]);
                fill(this.words, error instanceof Error ? error.message : String(error));
            }
        }
        this.asking = false;
        if (this.on && !this.app.view.dragging && this.element.dataset["state"] === "reached") this.rest();
    }

    /** The posture next to the present one is taken, where somebody has asked for a pose; the others are shown. */
    private show(answer: IkAnswer, wanted: Matrix4, names: string[], asked: boolean): void {
        const { view } = this.app;
        const within = answer.reached ? answer.solutions.filter((it) => it.within_limits) : [];
        const [best] = within;
        const [first] = answer.solutions;
        // Where the arm has too few joints for any pose, the nearest that it can do is what a hand expects.
        const follows = names.length < 6 && first?.within_limits === true;
        if (asked && best) this.take(best, names);
        else if (asked && first && !answer.reached && follows) this.take(first, names);
        const left = this.postures[0]?.branch;
        const now = names.map((name) => this.app.value(name));
        const is = ({ joints }: Solution) => joints.every((value, at) => Math.abs(value - (now[at] ?? 0)) < SAME);
        const present = within.find(is) ?? (asked ? best : undefined);
        this.postures = [...(present ? [present] : [{ joints: now, branch: null, within_limits: true, position_error_m: 0, orientation_error_rad: 0 }]), ...within.filter((it) => it !== present)];
        this.list(names);
        const state = best || !asked ? "reached" : answer.reached ? "limits" : "out of reach";
        // An unreachable pose is shown at its target.
        const base = this.base();
        if (base && state !== "reached") view.handle(base.clone().multiply(wanted));
        this.element.dataset["state"] = state;
        this.element.dataset["took"] = String(this.app.engine.took);
        this.element.dataset["wanted"] = JSON.stringify(wanted.toArray());
        const others = this.postures.length - 1;
        const outside = answer.reached ? answer.solutions.length - within.length : 0;
        const more = outside > 0 ? `; ${outside} more outside of limits` : "";
        if (state === "reached") {
            const changed = asked && left && present?.branch && left !== present.branch;
            const ghosts = others > 0 ? `${others} other ${others === 1 ? "posture reaches" : "postures reach"} this pose: click a ghost to take it` : "No other posture was found for this pose";
            fill(this.words, changed ? h("b", {}, "Another branch now: ") : null, `${present?.branch ? `${present.branch}. ` : ""}${ghosts}${more}.`);
            view.warn("");
        } else if (state === "limits" && first) {
            const over = names.filter((name, at) => beyond(this.joint(name), first.joints[at] ?? 0));
            fill(this.words, h("b", {}, "Only outside of limits"), `: a posture reaches this pose, but not within the limits of ${over.join(", ")}.`);
            view.warn("outside of limits");
        } else if (first) {
            const [moved, turned] = [number(first.position_error_m * 1000, 1), number(first.orientation_error_rad * DEGREE, 1)];
            fill(this.words, h("b", {}, "Out of reach"), `: no posture was found for this pose; the nearest is ${moved} mm and ${turned}° away.`);
            view.warn(names.length < 6 ? "" : "out of reach");
        }
    }

    private joint(name: string): SceneJoint | undefined {
        return this.app.robot?.opened.scene.joints.find((joint) => joint.name === name);
    }

    /** Gives the robot the joint values of a posture. */
    private take({ joints }: Solution, names: string[]): void {
        for (const [at, name] of names.entries()) this.app.q.set(name, plain(this.joint(name), joints[at] ?? 0));
        this.mine = true;
        this.app.refresh();
        this.mine = false;
        const tip = this.tip();
        if (tip) this.say(tip);
    }

    /** The box with all postures, and the ghosts of those that are not taken. */
    private list(names: string[]): void {
        const { robot, view } = this.app;
        const called = this.postures.map(({ branch }, at) => branch ?? (at === 0 ? "as shown" : `posture ${at + 1}`));
        const told = called.map((words, at) => (called.indexOf(words) === at ? words : `${words} (${called.slice(0, at + 1).filter((it) => it === words).length})`));
        fill(this.branch, ...told.map((words, at) => h("option", { value: at, selected: at === 0 }, words)));
        this.branch.title = told[0] ?? "";
        const joints = robot?.opened.scene.joints ?? [];
        view.ghosts(this.postures.slice(1).map((posture, at) => ({
            words: told[at + 1] ?? "",
            value: (joint) => {
                const name = joints[joint]?.name ?? "";
                const own = names.indexOf(name);
                return own < 0 ? this.app.value(name) : (posture.joints[own] ?? 0);
            },
        })));
    }

    /** Takes another posture for the same pose. */
    private choose(index: number): void {
        const { robot } = this.app;
        const posture = this.postures[index];
        if (!robot || !posture || index === 0) return;
        this.take(posture, chain(robot).coordinates);
        this.moved();
    }
}

/** An angle without limits is shown within half a turn, like its slider. */
function plain(joint: SceneJoint | undefined, q: number): number {
    if (!joint || joint.lower !== null || joint.kind === "prismatic" || joint.pitch !== null) return q;
    return q - 2 * Math.PI * Math.round(q / (2 * Math.PI));
}

function beyond(joint: SceneJoint | undefined, q: number): boolean {
    return joint !== undefined && ((joint.lower !== null && q < joint.lower - SAME) || (joint.upper !== null && q > joint.upper + SAME));
}
