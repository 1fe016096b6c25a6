// The toolkit, compiled to WebAssembly, in a worker: questions and answers as in crates/web.

import type { Said } from "./report";
import EngineWorker from "./engine.worker?worker&inline";

export interface RobotText {
    file: string;
    text: string;
    files: Record<string, string>;
    names: string[];
    base?: string;
    tip?: string;
    exact: boolean;
}

export interface Shape {
    origin: number[];
    geometry:
        | { box: [number, number, number] }
        | { cylinder: [number, number] }
        | { capsule: [number, number] }
        | { sphere: number }
        | { mesh: string; scale: [number, number, number] }
        | null;
    colour: [number, number, number, number] | null;
}

/** Mass properties of a link: kg, where (principal axes, column by column), and the edges of the solid box of its inertia, m. */
export interface Matter {
    mass: number;
    centre: number[];
    box: [number, number, number] | null;
}

export interface SceneJoint {
    name: string;
    kind: string;
    parent: number;
    child: number;
    origin: number[];
    axis: [number, number, number];
    pitch: number | null;
    lower: number | null;
    upper: number | null;
    driver: number | null;
    scale: number;
    offset: number;
    line: number;
}

export interface Scene {
    root: number;
    links: { name: string; visuals: Shape[]; collisions: Shape[]; inertial?: Matter | null }[];
    joints: SceneJoint[];
}

export interface Opened {
    robot: string;
    chains: string;
    urdf: string;
    urdf_file: string;
    /** Whether no other file was read for it. */
    is_alone: boolean;
    notes: string[];
    scene: Scene;
}

export interface TableAnswer {
    text: string;
    columns: string[];
    rows: { label: string; joint: string; kind: string; numbers: string[]; limits: string }[];
    formula: string;
    convention: string;
    notes: string[];
}

export interface Rows {
    stage: string;
    rows: { row: number; at: number[]; left: number[]; q: number[] }[];
}

export interface Calibrated {
    text: string;
    words: string;
    said: Said | null;
    urdf: string | null;
    effects: string;
    notes: string[];
    residuals: Rows[];
    /** null: no value, where none can be determined. */
    tried: { kind: string; place: string; delta_bic: number | null }[];
}

export interface Possible {
    kinds: { kind: string; formula: string; units: string; source: string; places: string[] }[];
}

export interface Acted {
    rows: { drawn: number[]; acted: number[]; apart_m: number }[];
    effects: string;
}

export interface TwistAnswer {
    name: string;
    kind: string;
    pitch: number;
    /** Unit twists (ω, v) in the base frame. */
    before: number[];
    after: number[];
    /** Whether a small turn about, a small move along x, y, z changes the axis. */
    changes: boolean[];
    /** Frame of the six motions, its z along the axis, in the base frame: 16 numbers, column by column. */
    frame: number[];
    tables: [TableAnswer, TableAnswer];
}

export interface ColumnsAnswer {
    columns: {
        name: string;
        unit: string | null;
        first: string[];
        meaning: string | null;
        /** Its own name states it; else it is a guess. */
        sure: boolean;
        /** One of three angles or four numbers whose order its name does not state. */
        orientation: boolean;
    }[];
    joints: string[];
    /** Why the file cannot be read so; null where it can. */
    problem: string | null;
    rows: number | null;
    taken: { column: string; taken_for: string }[];
}

export interface IkAnswer {
    /** How the solutions were found. */
    method: string;
    /** If not, the one solution is the nearest that was found. */
    reached: boolean;
    /** Nearest first, those outside of limits last; joint values rad and m, in the chain's order. */
    solutions: { joints: number[]; branch: string | null; within_limits: boolean; position_error_m: number; orientation_error_rad: number }[];
}

interface Answers {
    open: Opened;
    table: TableAnswer;
    poe: { text: string };
    twist: TwistAnswer;
    fk: { text: string };
    ik: IkAnswer;
    check: { text: string; file: string; urdf: string; is_source: boolean };
    fix: { file: string; text: string; made: number };
    canonical: { text: string; notes: string[] };
    diff: { text: string; words: string };
    edits: { operations: { name: string; usage: string; purpose: string }[] };
    edit: { text: string; said: string[]; notes: string[]; diff: string };
    columns: ColumnsAnswer;
    calibrate: Calibrated;
    effects: Possible;
    act: Acted;
}

export type Ask = keyof Answers;

interface Waiting {
    resolve(answer: string): void;
    reject(error: Error): void;
    progress: ((words: string) => void) | undefined;
}

let compiling: Promise<WebAssembly.Module> | undefined;

/** The engine's bytes are in the page, packed. */
async function compiled(): Promise<WebAssembly.Module> {
    const element = document.getElementById("engine");
    if (!element?.textContent) throw new Error("this page was built without its engine; run web/build");
    const letters = atob(element.textContent);
    element.remove();
    // A loop: `Uint8Array.from` takes 0.3 s for these three million.
    const packed = new Uint8Array(letters.length);
    for (let at = 0; at < packed.length; at++) packed[at] = letters.charCodeAt(at);
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
    return WebAssembly.compile(await new Response(stream).arrayBuffer());
}

export class Engine {
    private worker: Worker | undefined;
    private waiting = new Map<number, Waiting>();
    private next = 1;

    /** Milliseconds that the last answer took in the worker. */
    took = 0;
    /** Bytes of memory that the engine holds. */
    memory = 0;

    async ask<A extends Ask>(ask: A, question: object, progress?: (words: string) => void): Promise<Answers[A]> {
        const worker = await this.started();
        const id = this.next++;
        const text = await new Promise<string>((resolve, reject) => {
            this.waiting.set(id, { resolve, reject, progress });
            worker.postMessage({ id, question: JSON.stringify({ ask, ...question }) });
        });
        const answer = JSON.parse(text) as Answers[A] & { error?: string };
        if (answer.error !== undefined) throw new Error(answer.error);
        return answer;
    }

    /** Stops the current work; the next question starts a new engine. */
    stop(): void {
        this.worker?.terminate();
        this.worker = undefined;
        for (const { reject } of this.waiting.values()) reject(new Error("stopped"));
        this.waiting.clear();
    }

    private async started(): Promise<Worker> {
        compiling ??= compiled();
        const module = await compiling;
        if (this.worker) return this.worker;
        const worker = new EngineWorker();
        worker.onmessage = ({ data }: MessageEvent<{ id: number; answer?: string; progress?: string; took?: number; memory?: number }>) => {
            const waiting = this.waiting.get(data.id);
            if (data.progress !== undefined) waiting?.progress?.(data.progress);
            if (data.answer === undefined) return;
            this.waiting.delete(data.id);
            this.took = data.took ?? 0;
            this.memory = data.memory ?? 0;
            waiting?.resolve(data.answer);
        };
        worker.postMessage({ module });
        this.worker = worker;
        return worker;
    }
}
