// See: the D-H table next to the picture, findings next to the XML, everything to copy and download.

import type { App, Panel, Robot } from "./app";
import { chain, chains, question, withMeshes } from "./app";
import { h, save, select, stem } from "./dom";
import type { TableAnswer } from "./engine";
import type { TableFile } from "./table";

const CONVENTIONS: [string, string][] = [
    ["", "as the file has it"], ["distal", "distal (standard)"], ["proximal", "proximal (modified, Craig)"], ["paper", "the paper's"], ["hayati", "Hayati"],
];
const UNITS: [string, string][] = [["m,deg", "m, °"], ["mm,deg", "mm, °"], ["m,rad", "m, rad"], ["mm,rad", "mm, rad"]];
const FORMATS: [format: string, words: string, extension: string][] = [
    ["md", "Markdown", "md"], ["tex", "LaTeX", "tex"], ["csv", "CSV", "csv"], ["json", "JSON", "json"], ["text", "Text", "txt"],
    ["rtb", "Python (roboticstoolbox)", "py"], ["matlab", "MATLAB", "m"], ["ur", "UR kinematics (yaml)", "yaml"],
];

interface Finding {
    rule: string;
    level: string;
    line: number;
    element: string;
    message: string;
    fixable: boolean;
}

export class See implements Panel {
    readonly name = "See";
    readonly element = h("section", { class: "panel", "aria-label": "See" });
    private readonly tableBox = h("div", { class: "scroll" });
    private readonly formula = h("p", { class: "fine" });
    private readonly notes = h("ul", { class: "notes" });
    private readonly noted = h("details", { class: "noted" }, h("summary", {}), this.notes);
    private readonly findings = h("div", {});
    private readonly tree = h("ul", { class: "tree" });
    private rows: HTMLTableRowElement[] = [];
    private turn = 0;

    constructor(private readonly app: App) {
        app.view.onrow = (row) => this.choose(row);
    }

    async show(): Promise<void> {
        const robot = this.app.robot;
        if (!robot) return;
        // Nothing of the previous robot remains under the name of this one.
        this.rows = [];
        this.tableBox.replaceChildren(h("p", { role: "status" }, "reading …"));
        this.formula.replaceChildren();
        this.findings.replaceChildren();
        this.note(robot.opened.notes);
        const listing = chains(robot);
        const taken = chain(robot);
        const chosen = String(listing.findIndex((it) => it.base === taken.base && it.tip === taken.tip));
        const pick = select("Chain", listing.map((it, at) => [String(at), `${it.base} → ${it.tip}  (${it.coordinates.length})`]), chosen, (value) => {
            const picked = listing[Number(value)];
            if (picked) {
                robot.base = picked.base;
                robot.tip = picked.tip;
                this.app.changed();
            }
        }, "chain");
        const exact = h("input", { type: "checkbox", id: "exact", change: () => {
            robot.exact = exact.checked;
            this.app.changed();
        } });
        exact.checked = robot.exact;
        const format = h("select", { id: "format", "aria-label": "Format to copy" }, ...FORMATS.map(([value, words]) => h("option", { value }, words)));
        this.element.replaceChildren(
            h("div", { class: "row" },
                h("button", { id: "canonical", class: "main", click: () => void this.canonical(robot) }, "Download canonical URDF"),
                format,
                h("button", { id: "copy", click: () => void this.copy(format.value) }, "Copy table"),
                h("button", { id: "download-table", click: () => void this.download(format.value) }, "Download table")),
            h("div", { class: "row" }, pick,
                select("Convention", CONVENTIONS, this.app.convention, (value) => this.set(() => { this.app.convention = value; }), "convention"),
                select("Units", UNITS, this.app.units, (value) => this.set(() => { this.app.units = value; }), "units"),
                h("label", { class: "check", title: "Read every digit as written; otherwise 1.5708 is read as a quarter turn" }, exact, "exact digits")),
            this.formula,
            this.tableBox,
            h("p", { class: "legend" },
                h("span", { class: "key a" }, "a"), " along x  ", h("span", { class: "key d" }, "d"), " along z  ",
                h("span", { class: "key theta" }, "θ"), " about z  ", h("span", { class: "key alpha" }, "α"), " about x  · axes: ",
                h("span", { class: "key x" }, "x"), " ", h("span", { class: "key y" }, "y"), " ", h("span", { class: "key z" }, "z")),
            h("h2", {}, "Findings"), this.findings,
            this.noted,
            h("details", {}, h("summary", {}, `Links and joints (${robot.opened.scene.links.length})`), this.tree),
        );
        this.fillTree(robot);
        await this.fill();
        await this.app.trying(() => this.check());
    }

    private set(change: () => void): void {
        change();
        void this.fill();
    }

    /** Notes on the robot and its meshes. */
    private note(words: string[]): void {
        const { missing } = this.app.view;
        const of = missing.length > 0
            ? [`${missing.length} ${missing.length === 1 ? "mesh is" : "meshes are"} not shown; drop the folder that holds ${missing.length === 1 ? "it" : "them"} with the robot (${missing.slice(0, 2).join(", ")}${missing.length > 2 ? ", …" : ""})`]
            : [];
        const all = [...of, ...words];
        this.notes.replaceChildren(...all.map((text) => h("li", {}, text)));
        (this.noted.firstChild as HTMLElement).textContent = `Notes (${all.length})`;
        this.noted.hidden = all.length === 0;
        // A missing part of the picture is reported without a click.
        if (of.length > 0) this.noted.open = true;
    }

    private async table(format: string): Promise<TableAnswer> {
        const robot = this.app.robot;
        if (!robot) throw new Error("drop a robot first");
        return this.app.engine.ask("table", { source: question(robot), convention: this.app.convention || null, gauge: null, units: this.app.units, format });
    }

    private async fill(): Promise<void> {
        const turn = ++this.turn;
        this.app.table = undefined;
        const { robot } = this.app;
        let answer: TableAnswer;
        try {
            answer = await this.table("json");
        } catch (error) {
            if (turn !== this.turn || robot !== this.app.robot) return;
            // Rows and frames are those of this robot, or none.
            const why = error instanceof Error ? error.message : String(error);
            this.rows = [];
            this.formula.replaceChildren();
            this.tableBox.replaceChildren(h("p", { class: "said wrong", id: "no-table" }, `This chain has no table: ${why}`));
            this.app.view.frames([], "", null);
            this.app.move();
            return;
        }
        if (turn !== this.turn || robot !== this.app.robot) return;
        this.app.table = JSON.parse(answer.text) as TableFile;
        this.app.chosenRow = null;
        this.formula.textContent = `${answer.convention}: ${answer.formula}`;
        const head = h("tr", {}, h("th", { scope: "col" }, "row"), h("th", { scope: "col" }, "joint"),
            ...answer.columns.map((name) => h("th", { scope: "col", class: "number" }, ({ theta: "θ", alpha: "α", beta: "β" } as Record<string, string>)[name] ?? name)),
            h("th", { scope: "col" }, "limits"));
        this.rows = answer.rows.map((row, at) => h("tr", {
            tabindex: 0, "data-row": row.label, pointerenter: () => this.choose(at), pointerleave: () => this.choose(null),
            focus: () => this.choose(at), blur: () => this.choose(null),
        }, h("th", { scope: "row" }, row.label), h("td", { title: row.kind }, row.joint), ...row.numbers.map((text) => h("td", { class: "number" }, text)), h("td", { class: "fine" }, row.limits)));
        this.tableBox.replaceChildren(h("table", { id: "dh" }, h("thead", {}, head), h("tbody", {}, ...this.rows)));
        this.note([...(this.app.robot?.opened.notes ?? []), ...answer.notes]);
        this.app.move();
    }

    /** Highlights a row and its frame together. */
    choose(row: number | null): void {
        if (this.app.chosenRow === row) return;
        this.app.chosenRow = row;
        for (const [at, element] of this.rows.entries()) element.classList.toggle("chosen", at === row);
        this.app.drawFrames();
    }

    hide(): void {
        this.app.chosenRow = null;
    }

    private async copy(format: string): Promise<void> {
        const words = FORMATS.find(([name]) => name === format)?.[1] ?? format;
        await this.app.trying(async () => this.app.copied((await this.table(format)).text, `Table as ${words}`));
    }

    private async download(format: string): Promise<void> {
        await this.app.trying(async () => {
            const extension = FORMATS.find(([name]) => name === format)?.[2] ?? "txt";
            save(`${stem(this.app.robot?.file ?? "")}_dh.${extension}`, (await this.table(format)).text);
        });
    }

    private async canonical(robot: Robot): Promise<void> {
        await this.app.trying(async () => {
            const { text, notes } = await this.app.engine.ask("canonical", question(robot));
            const name = `${stem(robot.file)}_canonical.urdf`;
            save(name, text, "application/xml");
            this.app.say([`${name} downloaded: its link frames are the D-H frames`, ...notes].join(". "));
        });
    }

    private async check(): Promise<void> {
        const robot = this.app.robot;
        if (!robot) return;
        const answer = await this.app.engine.ask("check", withMeshes(robot));
        if (robot !== this.app.robot) return;
        const { findings } = JSON.parse(answer.text) as { findings: Finding[] };
        const lines = answer.urdf.split("\n");
        if (findings.length === 0) {
            this.findings.replaceChildren(h("p", { id: "clean" }, "The rules find nothing."));
            return;
        }
        const fixableCount = findings.filter((finding) => finding.fixable).length;
        const fixable = answer.is_source && robot.text === robot.written;
        const fix = (only: number | null) => async () => {
            await this.app.trying(async () => {
                const { text, made } = await this.app.engine.ask("fix", { source: withMeshes(robot), only });
                await this.app.open({ ...question(robot), text }, robot.meshes, robot.packages);
                this.app.say(`${made} edits made in the copy on this page; download it to keep it`);
            });
        };
        const items = findings.map((finding, at) => {
            const near = [-1, 0, 1].map((step) => finding.line + step).filter((line) => line >= 1 && line <= lines.length);
            const code = h("pre", { class: "code" });
            for (const line of near) {
                const text = (lines[line - 1] ?? "").slice(0, 400);
                code.append(h("span", { class: line === finding.line ? "here" : "near" }, `${String(line).padStart(4)}  ${text}\n`));
            }
            return h("details", { class: `finding ${finding.level}` },
                h("summary", {}, h("b", {}, finding.rule), ` ${finding.element}, line ${finding.line}: ${finding.message}`),
                code,
                finding.fixable && fixable ? h("button", { "data-fix": at, click: () => void fix(at)() }, "Fix") : null);
        });
        this.findings.replaceChildren(
            h("p", {}, `${findings.length} found${fixableCount ? `, ${fixableCount} can be fixed with a click` : ""}.`,
                ...(fixableCount && fixable ? [" ", h("button", { id: "fix-all", click: () => void fix(null)() }, "Fix all")] : []),
                " ", h("button", { id: "download-urdf", click: () => save(`${stem(robot.file)}.urdf`, answer.urdf, "application/xml") }, "Download URDF")),
            ...items);
    }

    /** Links and joints, one below the other; a line is indented where the tree branches. */
    private fillTree(robot: Robot): void {
        const { links, joints, root } = robot.opened.scene;
        const carried = new Map<number, typeof joints>();
        for (const joint of joints) carried.set(joint.parent, [...(carried.get(joint.parent) ?? []), joint]);
        const lines: HTMLLIElement[] = [];
        const line = (depth: number, ...words: (Node | string)[]) => lines.push(h("li", { style: `padding-left:${Math.min(depth, 24) * 14}px` }, ...words));
        line(0, links[root]?.name ?? "");
        const open = (carried.get(root) ?? []).map((joint) => ({ joint, depth: 1 })).reverse();
        const seen = new Set([root]);
        for (let next = open.pop(); next; next = open.pop()) {
            const { joint, depth } = next;
            if (seen.has(joint.child)) continue;
            seen.add(joint.child);
            line(depth, links[joint.child]?.name ?? "", " ", h("span", { class: "joint" }, `by ${joint.name} · ${joint.kind}`));
            const inner = carried.get(joint.child) ?? [];
            // A chain stays in its column, so that a long arm does not run out of the panel.
            open.push(...inner.map((it) => ({ joint: it, depth: inner.length > 1 ? depth + 1 : depth })).reverse());
        }
        this.tree.replaceChildren(...lines);
    }
}
