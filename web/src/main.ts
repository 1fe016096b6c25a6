// The page: reads robots, shows the panels.

import "./style.css";
import "./view.css";
import example from "../../robots/universal_robots/ur5e.urdf?raw";
import { App, called, chain, chains, type Panel } from "./app";
import { Calibrate } from "./calibrate";
import { Compare } from "./compare";
import { h } from "./dom";
import { Edit } from "./edit";
import type { RobotText } from "./engine";
import { areOne, basename, fromDrop, fromFiles, isFolder, isMesh, sandboxed, sorted, type Dropped, type Packages } from "./files";
import { Joints } from "./joints";
import { Learn } from "./learn";
import { unpacked } from "./meshes";
import { chosenRobot, read, written } from "./permalink";
import { Playback, recording } from "./playback";
import { postures } from "./postures";
import { Reach } from "./reach";
import { effects } from "./report";
import { Ruler } from "./ruler";
import { See } from "./see";
import { placed } from "./table";

const app = new App();
const panels: Panel[] = [new See(app), new Compare(app), new Calibrate(app), new Edit(app), new Learn(app)];
let current = panels[0] as Panel;
const ruler = new Ruler(app);
const reach = new Reach(app);
const playback = new Playback(app, () => joints.refresh());
const joints = new Joints(app, () => {
    current.moved?.();
    ruler.moved();
    reach.moved();
}, { buttons: [reach.button, ruler.button], below: [reach.element, ruler.element, playback.element] });

const busy = h("p", { class: "busy", hidden: true, role: "status" }, "reading …");
const files = h("input", { type: "file", multiple: true, id: "files", "aria-label": "Files of a robot", change: () => void chosen(files) });
const folder = h("input", { type: "file", webkitdirectory: true, id: "folder", "aria-label": "Folder of a robot", change: () => void chosen(folder) });
// In a notebook's frame no script may read a dropped folder: while something is dragged an unseen input for folders lies over the page,
// and the browser itself puts the folder's files into it, where its events are left alone.
const caught = h("input", { type: "file", webkitdirectory: true, class: "catcher", hidden: true, tabindex: -1, "aria-hidden": "true", "aria-label": "Folder that is dropped", change: () => void chosen(caught) });
const dropping = (going: boolean) => {
    document.body.classList.toggle("dropping", going);
    caught.hidden = !(going && sandboxed);
};
const tabs = panels.map((panel) => h("button", { role: "tab", id: `tab-${panel.name}`, "aria-selected": "false", click: () => void turnTo(panel) }, panel.name));
// Arrow keys go from tab to tab.
const arrow = (event: Event) => {
    const { key } = event as KeyboardEvent;
    const at = panels.indexOf(current);
    const next = { ArrowRight: at + 1, ArrowLeft: at - 1, Home: 0, End: panels.length - 1 }[key];
    if (next === undefined) return;
    event.preventDefault();
    const to = (next + panels.length) % panels.length;
    tabs[to]?.focus();
    const panel = panels[to];
    if (panel) void turnTo(panel);
};
const theme = h("button", { id: "theme", title: "Dark or light", "aria-label": "Dark or light", click: () => {
    const dark = getComputedStyle(document.documentElement).colorScheme === "dark";
    document.documentElement.dataset["theme"] = dark ? "light" : "dark";
} }, "◐");
const title = h("span", { class: "robot", id: "robot" });
const link = h("button", { id: "link", click: () => void permalink(), title: "An address that holds what is shown" }, "Copy link");
const header = h("header", {},
    h("b", { class: "brand" }, "denavit"), title,
    h("nav", { role: "tablist", "aria-label": "What to do", keydown: arrow }, ...tabs),
    h("span", { class: "row tools" },
        h("label", { class: "button" }, "Open files", files),
        h("label", { class: "button" }, "Open folder", folder), link, theme));
const start = h("section", { class: "start" },
    h("h1", {}, "Drop a robot here"),
    h("p", {}, "A URDF, a xacro file with its packages (folder or zip), or a Denavit-Hartenberg table. Two files at once are compared; a CSV file or workbook of measurements starts a calibration."),
    h("p", {},
        h("label", { class: "button main", for: "files" }, "Open files"), " ",
        h("label", { class: "button", for: "folder" }, "Open folder"), " ",
        h("button", { id: "example", click: () => void app.trying(() => app.open(source("ur5e.urdf", example), new Map())) }, "Try a UR5e")),
    h("p", { class: "fine" }, "Nothing is uploaded: this page works without a network, and its security policy forbids requests."));
const left = h("div", { class: "left" }, app.view.element, joints.element);
const right = h("div", { class: "right", role: "tabpanel" });
const work = h("main", { class: "work", hidden: true }, left, right);
document.getElementById("app")?.replaceChildren(header, app.said, busy, start, work, caught);

function source(file: string, text: string, texts: Record<string, string> = {}, names: string[] = []): RobotText {
    return { file, text, files: texts, names, exact: false };
}

async function opened(robot: RobotText, meshes: Dropped, packages: Packages = new Map()) {
    const answer = await app.engine.ask("open", robot);
    // The URDF of an expanded file, or of one that others were read for, stands for it from now on: they need not travel with each question.
    const made = answer.urdf_file.endsWith("(expanded)") || !answer.is_alone;
    return { ...robot, files: {}, text: made ? answer.urdf : robot.text, written: robot.text, meshes, packages, opened: answer };
}

app.open = async (robot, meshes, packages) => {
    busy.hidden = false;
    try {
        const made = await opened(robot, meshes, packages);
        app.robot = made;
        app.other = undefined;
        app.table = undefined;
        app.chosenRow = null;
        app.postures = [];
        ruler.turn(false);
        reach.turn(false);
        playback.end();
        app.say("");
        start.hidden = true;
        work.hidden = false;
        app.view.show(1, null);
        app.view.show(0, made.opened.scene, meshes, `/${made.file}`, made.packages);
        const known = new Set(made.opened.scene.joints.map((joint) => joint.name));
        for (const name of [...app.q.keys()]) if (!known.has(name)) app.q.delete(name);
        for (const joint of made.opened.scene.joints) {
            // Where 0 is outside of the limits, the middle is shown.
            if (joint.lower !== null && joint.upper !== null && !app.q.has(joint.name) && (joint.lower > 0 || joint.upper < 0)) {
                app.q.set(joint.name, (joint.lower + joint.upper) / 2);
            }
        }
        title.textContent = called(made);
        title.title = made.file;
        app.view.element.setAttribute("aria-label", `3-D view of ${called(made)}; arrow keys rotate it, + and - zoom`);
        document.title = `${title.textContent} · denavit explorer`;
        joints.fill();
        if (current.name === "Compare") current = panels[0] as Panel;
        await turnTo(current);
    } finally {
        busy.hidden = true;
    }
};

app.refill = () => joints.fill();
app.refresh = () => joints.refresh();

app.changed = () => {
    joints.fill();
    void current.show();
};

async function turnTo(panel: Panel): Promise<void> {
    if (current !== panel) current.hide?.();
    current = panel;
    for (const [at, tab] of tabs.entries()) tab.setAttribute("aria-selected", String(panels[at] === panel));
    right.setAttribute("aria-labelledby", `tab-${panel.name}`);
    right.replaceChildren(panel.element);
    if (app.robot) await panel.show();
}

async function chosen(input: HTMLInputElement): Promise<void> {
    const list = [...(input.files ?? [])];
    input.value = "";
    await dropped(fromFiles(list));
}

/** Reads dropped files in their order. */
async function dropped(files: Promise<Dropped>): Promise<void> {
    const earlier = app.taken;
    app.taken = app.trying(async () => {
        const all = await files;
        await earlier;
        await take(all);
    });
    await app.taken;
}

/** What was dropped: a robot, two robots to compare, or measurements of the current robot. */
async function take(dropped: Dropped): Promise<void> {
    if (dropped.size === 0) return;
    const { robots, data, texts, names, packages, semantics } = sorted(dropped, app.robot && current.name === "Calibrate" ? "measurements" : "robots");
    const joined = semantics.flatMap((name) => postures(name.slice(1), texts[name] ?? ""));
    // A list of joint values is played; it is neither a robot nor a measurement.
    if (app.robot && dropped.size === 1 && current.name !== "Calibrate") {
        const [name, text] = Object.entries(texts)[0] ?? [];
        const played = name !== undefined && text !== undefined && /\.(csv|tsv|txt)$/i.test(name) ? recording(app, name.slice(1), text) : undefined;
        if (played) return playback.take(played);
    }
    const meshes: Dropped = new Map([...dropped].filter(([name]) => isMesh(name)));
    // Names in messages are as people know them; the files beside are known from the top.
    const of = (name: string) => source(name.slice(1), texts[name] ?? "", texts, names);
    const single = dropped.size - semantics.length <= 2 && meshes.size === 0;
    const [first, second] = robots;
    if (first !== undefined) {
        if (current.name === "Compare" && app.robot && robots.length === 1) await compare(of(first), meshes, packages);
        else {
            await app.open(of(first), meshes, packages);
            if (second !== undefined && single && !areOne(first, second, texts)) await compare(of(second), meshes, packages);
            else if (robots.length > 1) offer(robots, of, meshes, packages, first);
        }
    }
    if (joined.length > 0) {
        if (!app.robot) throw new Error(`${semantics[0]?.slice(1)} holds named postures; drop their robot first, or both at once`);
        app.postures = joined;
        joints.fill();
        if (first === undefined) return app.say(`${joined.length} named postures: choose one under "Posture"`);
    } else if (semantics.length > 0 && first === undefined && data.length === 0) {
        throw new Error(`${semantics[0]?.slice(1)} names no posture: it has no <group_state>`);
    }
    const table = data[0];
    if (table !== undefined) {
        if (!app.robot) throw new Error(`${table.file} holds measurements; drop their robot first, or both at once`);
        const calibrate = panels[2] as Calibrate;
        await turnTo(calibrate);
        calibrate.take(table);
    } else if (first === undefined) {
        throw new Error(`no robot among ${dropped.size === 1 ? `"${[...dropped.keys()][0]?.slice(1)}"` : `${dropped.size} files`}; drop a URDF, a xacro file, or a D-H table in CSV, JSON or Markdown`);
    }
}

/** Several robots in one folder: the likeliest is shown, the others can be chosen. */
function offer(robots: string[], of: (name: string) => RobotText, meshes: Dropped, packages: Packages, shown: string): void {
    const pick = h("select", { id: "which", "aria-label": "Robot of the folder", change: () => void app.trying(async () => {
        const chosen = pick.value;
        await app.open(of(chosen), meshes, packages);
        offer(robots, of, meshes, packages, chosen);
    }) },
        ...robots.map((name) => {
            // The file's own name first: folders are long, and alike.
            const folder = name.slice(1, Math.max(1, name.lastIndexOf("/")));
            return h("option", { value: name, selected: name === shown, title: name.slice(1) }, folder ? `${basename(name)} in ${folder}` : basename(name));
        }));
    pick.title = shown.slice(1);
    title.replaceChildren(pick);
    app.say(`${robots.length} descriptions in this folder: ${basename(shown)} is shown, the others are in the list above`);
}

async function compare(robot: RobotText, meshes: Dropped, packages?: Packages): Promise<void> {
    app.other = await opened(robot, meshes, packages);
    await turnTo(panels[1] as Panel);
}

async function permalink(): Promise<void> {
    await app.trying(async () => {
        const address = await written(app, current.name);
        history.replaceState(null, "", address);
        await app.copied(location.href, "Link");
    });
}

for (const event of ["dragenter", "dragover"] as const) {
    addEventListener(event, (drag) => {
        dropping(true);
        if (drag.target !== caught) drag.preventDefault();
    });
}
addEventListener("dragleave", (drag) => {
    if (drag.relatedTarget === null) dropping(false);
});
addEventListener("drop", (drop) => {
    const transfer = drop.dataTransfer;
    // Removed when the browser has finished the drop.
    setTimeout(() => dropping(false), 0);
    if (transfer && drop.target === caught && isFolder(transfer)) return;
    drop.preventDefault();
    if (transfer) void dropped(fromDrop(transfer));
});

interface Embedded {
    file: string;
    text: string;
    /** In base64, by what the robot calls them. */
    meshes?: Record<string, string>;
}

/** A robot that `denavit explore` brings, and its meshes. */
function taken({ file, text, meshes }: Embedded): { robot: RobotText; meshes: Dropped } {
    const held = unpacked(meshes ?? {});
    // The rule on meshes looks for names from the top.
    const names = [...held.keys()].map((uri) => `/${uri.replace(/^\w+:\/\//, "")}`);
    return { robot: source(file, text, {}, names), meshes: held };
}

async function begin(): Promise<void> {
    await turnTo(current);
    // What `denavit explore` brings is in the page; what a link holds comes before it.
    const linked = await read(location.hash);
    const embedded = JSON.parse(document.getElementById("robots")?.textContent ?? "[]") as Embedded[];
    document.getElementById("robots")?.remove();
    const brought = embedded.map(taken);
    // The gallery's way to a page for a robot of one's own.
    if (location.hash === "#open") return;
    const named = chosenRobot(location.hash);
    if (named !== undefined) {
        const at = embedded.findIndex(({ file }) => file === named);
        if (at < 0) throw new Error(`the link names the robot "${named}", which is not in this page`);
    }
    const [first, second] = linked?.robots.map((robot) => ({ robot, meshes: new Map() as Dropped })) ?? brought;
    const begun = named === undefined ? first : brought[embedded.findIndex(({ file }) => file === named)];
    if (!begun) return;
    if (linked) {
        app.convention = linked.convention;
        app.units = linked.units;
    }
    await app.open(begun.robot, begun.meshes);
    if (linked && app.robot) {
        for (const [name, value] of Object.entries(linked.q)) if (Number.isFinite(value)) app.q.set(name, value);
        joints.fill();
    }
    if (second && named === undefined && (linked || brought.length === 2)) {
        (panels[1] as Compare).begins = !linked;
        await compare(second.robot, second.meshes);
    }
    const panel = panels.find((it) => it.name === linked?.tab);
    if (panel) await turnTo(panel);
    if (brought.length > 2 && !linked) {
        // Robots of a folder may be called alike.
        const names = embedded.map(({ file }, at) => (embedded.findIndex((it) => it.file === file) === at ? file : `${file} (${at + 1})`));
        const pick = h("select", { id: "which", "aria-label": "Robot", change: () => {
            const chosen = brought[names.indexOf(pick.value)];
            if (chosen) {
                void app.trying(async () => {
                    await app.open(chosen.robot, chosen.meshes);
                    title.replaceChildren(pick);
                });
            }
        } }, ...names.map((name, at) => h("option", { value: name, selected: brought[at] === begun }, name)));
        title.replaceChildren(pick);
    }
}

// A link to another robot of the page, chosen while the page is open.
addEventListener("hashchange", () => {
    if (chosenRobot(location.hash) !== undefined) location.reload();
});

// An editor beside the page says which link its cursor is in.
addEventListener("message", ({ data }: MessageEvent<unknown>) => {
    if (typeof data !== "object" || data === null || !("denavit" in data) || data.denavit !== "link" || !("link" in data)) return;
    app.view.lightUp(typeof data.link === "string" ? data.link : null);
});

void app.trying(begin);

// Figures for tests of the page.
Object.assign(window, { denavit: { app, chain, chains, placed, effects, reach } });
