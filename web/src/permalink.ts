// The shown state as the fragment of an address, which is never sent.

import { type App, question } from "./app";
import type { RobotText } from "./engine";

/** Longer addresses do not survive mail and chat. */
const MOST = 60_000;

export interface Linked {
    tab: string;
    q: Record<string, number>;
    convention: string;
    units: string;
    robots: RobotText[];
}

async function through(bytes: Uint8Array<ArrayBuffer>, stream: GenericTransformStream): Promise<Uint8Array<ArrayBuffer>> {
    return new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(stream as ReadableWritablePair<Uint8Array<ArrayBuffer>, Uint8Array<ArrayBuffer>>)).arrayBuffer());
}

export async function written(app: App, tab: string): Promise<string> {
    const robots = [app.robot, app.other].filter((robot) => robot !== undefined).map((robot) => ({ ...question(robot), names: [] }));
    const state: Linked = { tab, q: Object.fromEntries(app.q), convention: app.convention, units: app.units, robots };
    const packed = await through(new TextEncoder().encode(JSON.stringify(state)), new CompressionStream("deflate-raw"));
    let binary = "";
    for (const byte of packed) binary += String.fromCharCode(byte);
    const text = btoa(binary).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
    if (text.length > MOST) throw new Error("this robot is too large for a link; send its file");
    return `#v1=${text}`;
}

/** The robot of the page that `#robot=FILE` names. */
export function chosenRobot(hash: string): string | undefined {
    const named = /^#robot=(.+)$/.exec(hash)?.[1];
    return named === undefined ? undefined : decodeURIComponent(named);
}

export async function read(hash: string): Promise<Linked | undefined> {
    const text = /^#v1=([\w-]+)$/.exec(hash)?.[1];
    if (text === undefined) return undefined;
    try {
        const packed = Uint8Array.from(atob(text.replaceAll("-", "+").replaceAll("_", "/")), (letter) => letter.charCodeAt(0));
        const state = JSON.parse(new TextDecoder().decode(await through(packed, new DecompressionStream("deflate-raw")))) as Partial<Linked>;
        const robots = (Array.isArray(state.robots) ? state.robots : []).filter((robot) => typeof robot?.text === "string" && typeof robot.file === "string");
        return {
            tab: String(state.tab ?? ""), q: state.q ?? {}, convention: String(state.convention ?? ""), units: String(state.units ?? "m,deg"),
            robots: robots.map((robot) => ({ file: robot.file, text: robot.text, files: {}, names: [], exact: robot.exact === true, ...(robot.base ? { base: String(robot.base) } : {}), ...(robot.tip ? { tip: String(robot.tip) } : {}) })),
        };
    } catch {
        throw new Error("the link is damaged; get a new one");
    }
}
