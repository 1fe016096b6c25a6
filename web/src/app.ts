// What the panels share: the robot, its joint values, the view, the engine.

import { copy, h } from "./dom";
import { Engine, type Opened, type RobotText } from "./engine";
import { basename, type Dropped, type Packages } from "./files";
import { found, looked } from "./meshes";
import type { Posture } from "./postures";
import { placed, type TableFile } from "./table";
import { View } from "./view";

export interface Robot extends RobotText {
    opened: Opened;
    meshes: Dropped;
    /** Packages among the dropped files. */
    packages: Packages;
    /** As it was dropped, for the findings and their fixes. */
    written: string;
}

export interface ChainListing {
    base: string;
    tip: string;
    coordinates: string[];
    default: boolean;
}

export interface Panel {
    readonly name: string;
    readonly element: HTMLElement;
    /** Called when the panel is shown, and when the robot has changed. */
    show(): void | Promise<void>;
    /** Joint values have changed. */
    moved?(): void;
    hide?(): void;
}

export class App {
    readonly engine = new Engine();
    readonly view = new View();
    robot: Robot | undefined;
    other: Robot | undefined;
    /** Values by driving joint's name, rad and m. */
    q = new Map<string, number>();
    table: TableFile | undefined;
    /** Named postures of an SRDF that came with the robot. */
    postures: Posture[] = [];
    chosenRow: number | null = null;
    convention = "";
    units = "m,deg";
    readonly said = h("p", { class: "said", role: "status", "aria-live": "polite" });
    /** Ends when everything dropped so far has been read. */
    taken: Promise<unknown> = Promise.resolve();
    /** Set by the page: reads a robot and shows it. */
    open: (robot: RobotText, meshes: Dropped, packages?: Packages) => Promise<void> = async () => {};
    changed: () => void = () => {};
    /** Set by the page: makes the sliders show the joint values, and moves what follows them; the panel does not change. */
    refresh: () => void = () => {};
    /** Set by the page: creates new sliders. */
    refill: () => void = () => {};

    value(name: string): number {
        return this.q.get(name) ?? 0;
    }

    /** Moves both robots to the joint values; the other one by the same names, or in the same order. */
    move(): void {
        const names = this.robot?.opened.scene.joints.map((joint) => joint.name) ?? [];
        this.view.move(0, (joint) => this.value(names[joint] ?? ""));
        if (this.other && this.robot) {
            const others = this.other.opened.scene.joints.map((joint) => joint.name);
            const [mine, theirs] = [chain(this.robot).coordinates, chain(this.other).coordinates];
            const shared = theirs.some((name) => mine.includes(name));
            this.view.move(1, (joint) => {
                const name = others[joint] ?? "";
                const same = shared ? name : (mine[theirs.indexOf(name)] ?? name);
                return this.value(same);
            });
        }
        this.drawFrames();
    }

    drawFrames(): void {
        if (!this.table) return;
        this.view.frames(placed(this.table, (name) => this.value(name)), this.table.base, this.chosenRow);
    }

    /** Shows a message; an error stays until the next message. */
    say(words: string, wrong = false): void {
        this.said.textContent = words;
        this.said.classList.toggle("wrong", wrong);
    }

    /** Runs what may fail, and shows the error. */
    async trying<T>(work: () => Promise<T>): Promise<T | undefined> {
        try {
            return await work();
        } catch (error) {
            const words = error instanceof Error ? error.message : String(error);
            if (words !== "stopped") this.say(words, true);
            return undefined;
        }
    }

    async copied(text: string, what: string): Promise<void> {
        await copy(text);
        this.say(`${what} copied`);
    }
}

/** The display name of a robot: its own name, else that of its file. */
export const called = (robot: Robot): string => robot.opened.robot || basename(robot.file);

export function question(robot: Robot): RobotText {
    const { file, text, names, base, tip, exact } = robot;
    return { file, text, files: {}, names, exact, ...(base ? { base } : {}), ...(tip ? { tip } : {}) };
}

/** The question with every drawn mesh under the name that the rules search for. */
export function withMeshes(robot: Robot): RobotText {
    const asked = question(robot);
    const from = `/${robot.file}`;
    const uris = robot.opened.scene.links.flatMap((link) => [...link.visuals, ...link.collisions]).flatMap(({ geometry }) => (geometry && "mesh" in geometry ? [geometry.mesh] : []));
    const drawn = [...new Set(uris)].filter((uri) => found(uri, robot.meshes, from, robot.packages) !== undefined);
    return { ...asked, names: [...asked.names, ...drawn.map((uri) => looked(uri, from))] };
}

const listed = new WeakMap<Opened, ChainListing[]>();

export function chains(robot: Robot): ChainListing[] {
    const known = listed.get(robot.opened);
    if (known) return known;
    const all = (JSON.parse(robot.opened.chains) as { chains: ChainListing[] }).chains;
    listed.set(robot.opened, all);
    return all;
}

/** The chain that is chosen. */
export function chain(robot: Robot): ChainListing {
    const all = chains(robot);
    const wanted = all.find((it) => it.base === robot.base && it.tip === robot.tip);
    const taken = wanted ?? all.find((it) => it.default) ?? all[0];
    if (!taken) throw new Error("the robot has no chain");
    return taken;
}
