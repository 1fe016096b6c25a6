// Dropped or chosen files, folders and zip archives, within bounds, with names that cannot leave the archive.

import { Unzip, UnzipInflate } from "fflate";

/** Larger files do not belong to a robot. */
const MOST_BYTES = 512 * 1024 * 1024;
const MOST_FILES = 20_000;
const MOST_TEXT = 32 * 1024 * 1024;
const MOST_WORKBOOK = 128 * 1024 * 1024;

export type Dropped = Map<string, Uint8Array>;

/** A name from the top, such as /arm/meshes/base.stl; null where it would lead out of the archive. */
export function plain(name: string): string | null {
    if (name.includes("\0") || /^[a-z]:/i.test(name)) return null;
    const parts: string[] = [];
    for (const part of name.replaceAll("\\", "/").split("/")) {
        if (part === "" || part === ".") continue;
        if (part === "..") return null;
        parts.push(part);
    }
    return parts.length === 0 ? null : `/${parts.join("/")}`;
}

class Bounds {
    bytes = 0;
    files = 0;

    constructor(private readonly most = MOST_BYTES, private readonly fix = "drop the robot's own folder only") {}

    add(bytes: number): void {
        this.bytes += bytes;
        if (this.bytes > this.most) throw new Error(`more than ${this.most >> 20} MB in all; ${this.fix}`);
    }

    file(): void {
        if (++this.files > MOST_FILES) throw new Error(`more than ${MOST_FILES} files; drop the robot's own folder only`);
    }
}

/** Unpacks while reading, so that an archive cannot state a wrong size. */
export function unzipped(name: string, bytes: Uint8Array, bounds = new Bounds()): Dropped {
    const out: Dropped = new Map();
    let failed: Error | undefined;
    let open = 0;
    const unzip = new Unzip((file) => {
        if (file.name.endsWith("/")) return;
        const path = plain(file.name);
        if (path === null) throw new Error(`${name}: "${file.name}" leads out of the archive; pack it again with plain names`);
        bounds.file();
        open++;
        const pieces: Uint8Array[] = [];
        file.ondata = (error, piece, final) => {
            if (error) {
                failed ??= error;
                return;
            }
            bounds.add(piece.length);
            pieces.push(piece);
            if (!final) return;
            open--;
            out.set(path, joined(pieces));
        };
        file.start();
    });
    unzip.register(UnzipInflate);
    try {
        // In pieces, so that a bomb is noticed early.
        const step = 1 << 16;
        for (let at = 0; at < bytes.length; at += step) unzip.push(bytes.subarray(at, at + step), at + step >= bytes.length);
    } catch (error) {
        failed ??= error as Error;
    }
    if (failed) throw failed.message.startsWith(name) ? failed : new Error(`${name}: ${failed.message || "the archive is damaged"}`);
    if (open > 0 || !isWhole(bytes)) throw new Error(`${name}: the archive is cut off or damaged; pack it again`);
    if (out.size === 0) throw new Error(`${name}: the archive holds no file, or is damaged`);
    return out;
}

/** Whether the list of contents, at the end, exists. */
function isWhole(bytes: Uint8Array): boolean {
    for (let at = bytes.length - 22; at >= Math.max(0, bytes.length - 22 - 0xffff); at--) {
        if (bytes[at] === 0x50 && bytes[at + 1] === 0x4b && bytes[at + 2] === 5 && bytes[at + 3] === 6) return true;
    }
    return false;
}

function joined(pieces: Uint8Array[]): Uint8Array {
    if (pieces.length === 1 && pieces[0]) return pieces[0];
    const all = new Uint8Array(pieces.reduce((sum, piece) => sum + piece.length, 0));
    let at = 0;
    for (const piece of pieces) {
        all.set(piece, at);
        at += piece.length;
    }
    return all;
}

/** Whether the page is in a sandboxed frame, as in a notebook. */
export const sandboxed = self.origin === "null" && location.protocol !== "file:";

/** Whether exactly one folder was dropped. */
export function isFolder(transfer: DataTransfer): boolean {
    const entries = [...transfer.items].filter((item) => item.kind === "file").map((item) => item.webkitGetAsEntry?.());
    return entries.length === 1 && entries[0]?.isDirectory === true;
}

/** A dropped item, as far as the browser gives access to it. */
interface Held {
    file: File | null;
    entry: FileSystemEntry | null;
    folder: Promise<FileSystemDirectoryHandle | undefined> | undefined;
}

/** What a browser can do with a dropped item beyond the standard types. */
type Asked = DataTransferItem & { getAsFileSystemHandle?(): Promise<FileSystemHandle | null> };

/**
 * Everything that was dropped, folders walked through and archives unpacked. To be called in the event's handler: items are gone
 * afterwards, so each is asked for before anything is waited for.
 *
 * A page from disk, or in a sandboxed frame, has an origin of its own, where `FileSystemEntry.file` and `readEntries` fail
 * ("A URI supplied to the API was malformed"). `getAsFile` works in both; `getAsFileSystemHandle` works on a page from disk, and in a
 * sandboxed frame it ends the whole page (Chromium 156): there an unseen input for folders takes them, which the browser itself fills.
 */
export function fromDrop(transfer: DataTransfer): Promise<Dropped> {
    const held = ([...transfer.items] as Asked[]).filter((item) => item.kind === "file").map((item): Held => {
        const entry = item.webkitGetAsEntry?.() ?? null;
        if (!entry?.isDirectory) return { file: item.getAsFile(), entry, folder: undefined };
        const asked = sandboxed ? undefined : item.getAsFileSystemHandle?.();
        const folder = asked?.then((handle) => (handle?.kind === "directory" ? (handle as FileSystemDirectoryHandle) : undefined), () => undefined);
        return { file: null, entry, folder };
    });
    return held.length === 0 ? fromFiles([...transfer.files]) : all(held);
}

async function all(held: Held[]): Promise<Dropped> {
    const bounds = new Bounds();
    const out: Dropped = new Map();
    for (const { file, entry, folder } of held) {
        const handle = await folder;
        if (file) await take(file, file.name, out, bounds);
        else if (handle) await through(handle, `/${handle.name}`, out, bounds);
        else if (entry) await walk(entry, out, bounds).catch((error: unknown) => refused(entry.name, error));
    }
    return out;
}

function refused(name: string, error: unknown): never {
    if (!(error instanceof DOMException)) throw error;
    throw new Error(`this browser does not let a page of this kind read the dropped folder "${name}"; ${sandboxed ? "drop one folder alone, " : ""}use Open folder, or drop a zip archive`);
}

/** Folders without robot files. */
const isHidden = (name: string) => name.startsWith(".git");

async function through(folder: FileSystemDirectoryHandle, path: string, out: Dropped, bounds: Bounds): Promise<void> {
    for await (const inner of folder.values()) {
        if (isHidden(inner.name)) continue;
        if (inner.kind === "directory") await through(inner as FileSystemDirectoryHandle, `${path}/${inner.name}`, out, bounds);
        else await take(await (inner as FileSystemFileHandle).getFile(), `${path}/${inner.name}`, out, bounds);
    }
}

/** Files of a file dialog; of a folder's the names hold the folder. */
export async function fromFiles(files: File[]): Promise<Dropped> {
    const bounds = new Bounds();
    const out: Dropped = new Map();
    for (const file of files) await take(file, file.webkitRelativePath || file.name, out, bounds);
    return out;
}

async function walk(entry: FileSystemEntry, out: Dropped, bounds: Bounds): Promise<void> {
    if (entry.isFile) {
        const file = await new Promise<File>((resolve, reject) => (entry as FileSystemFileEntry).file(resolve, reject));
        return take(file, entry.fullPath, out, bounds);
    }
    const reader = (entry as FileSystemDirectoryEntry).createReader();
    for (;;) {
        const some = await new Promise<FileSystemEntry[]>((resolve, reject) => reader.readEntries(resolve, reject));
        if (some.length === 0) return;
        for (const inner of some) if (!isHidden(inner.name)) await walk(inner, out, bounds);
    }
}

async function take(file: File, name: string, out: Dropped, bounds: Bounds): Promise<void> {
    const path = plain(name);
    if (path === null) throw new Error(`"${name}" is not a plain file name`);
    bounds.file();
    if (file.size > MOST_BYTES) throw new Error(`${file.name} has more than ${MOST_BYTES >> 20} MB; drop the robot's own files only`);
    const bytes = new Uint8Array(await file.arrayBuffer());
    if (/\.zip$/i.test(path)) {
        for (const [inner, content] of unzipped(file.name, bytes, bounds)) out.set(inner, content);
    } else {
        bounds.add(bytes.length);
        out.set(path, bytes);
    }
}

const MESH = /\.(stl|dae|obj)$/i;
const WORKBOOK = /\.xls[xm]$/i;
const TEXT = /\.(urdf|xacro|xml|yaml|yml|csv|tsv|json|md|txt|toml|mjcf|sdf|srdf|world|config)$/i;

/** A file of data, as the engine takes it. */
export type DataFile = { file: string } & ({ text: string } | { workbook: string });

/** A workbook in base64; it is an archive, which is unpacked within bounds before the engine unpacks it again. */
function workbook(name: string, bytes: Uint8Array): DataFile {
    const file = name.slice(1);
    unzipped(file, bytes, new Bounds(MOST_WORKBOOK, "save the sheet with the measurements as CSV"));
    let binary = "";
    for (let at = 0; at < bytes.length; at += 1 << 15) binary += String.fromCharCode(...bytes.subarray(at, at + (1 << 15)));
    return { file, workbook: btoa(binary) };
}

export function isMesh(name: string): boolean {
    return MESH.test(name);
}

/** Text of a file, or what is wrong with it. Measurements come from programs that write other encodings than UTF-8, too. */
export function textOf(name: string, bytes: Uint8Array): string {
    if (bytes.length > MOST_TEXT) throw new Error(`${name.slice(1)} has more than ${MOST_TEXT >> 20} MB of text; this is not a robot description`);
    try {
        return new TextDecoder("utf-8", { fatal: true }).decode(bytes);
    } catch {
        if (/\.(csv|tsv|txt)$/i.test(name)) {
            const marks: Record<string, string> = { "255,254": "utf-16le", "254,255": "utf-16be" };
            return new TextDecoder(marks[bytes.slice(0, 2).join()] ?? "windows-1252").decode(bytes);
        }
        throw new Error(`${name.slice(1)}: not UTF-8 text; save the file as UTF-8`);
    }
}

export interface Sorted {
    /** Files that may be a robot, the likeliest first. */
    robots: string[];
    /** Files of measurements. */
    data: DataFile[];
    /** Texts, all of them: xacro may include them. */
    texts: Record<string, string>;
    /** Every name. */
    names: string[];
    /** SRDF files. */
    semantics: string[];
    /** Folders of ROS packages, each with the name in its package.xml. */
    packages: Packages;
}

/** Names of packages by their folders, such as /ws/src/arm. */
export type Packages = Map<string, string>;

/** The packages among dropped texts. */
function packages(texts: Record<string, string>): Packages {
    const found: Packages = new Map();
    for (const [name, text] of Object.entries(texts)) {
        if (!/\/package\.xml$/i.test(name)) continue;
        const own = new DOMParser().parseFromString(text, "application/xml").querySelector("package > name")?.textContent?.trim();
        if (own) found.set(name.slice(0, name.lastIndexOf("/")), own);
    }
    return found;
}

/** Which files are robots, which are measurements; where measurements are expected, any list counts as measurements. */
export function sorted(dropped: Dropped, wanted: "robots" | "measurements"): Sorted {
    const texts: Record<string, string> = {};
    const [robots, data, semantics]: [string[], DataFile[], string[]] = [[], [], []];
    for (const [name, bytes] of dropped) {
        if (WORKBOOK.test(name)) data.push(workbook(name, bytes));
        if (!TEXT.test(name)) continue;
        let text: string;
        try {
            text = textOf(name, bytes);
        } catch (error) {
            if (dropped.size === 1) throw error;
            continue;
        }
        texts[name] = text;
        if (/\/package\.xml$/i.test(name)) continue;
        if (/\.srdf$/i.test(name)) semantics.push(name);
        else if (/\.(urdf|xacro|xml|mjcf|sdf|world)$/i.test(name) && /<((\w+:)?robot|mujoco|sdf)[\s>]/.test(text)) robots.push(name);
        else if (/\.(csv|tsv|txt)$/i.test(name) && (wanted === "measurements" || holdsMeasurements(text))) data.push({ file: name.slice(1), text });
        else if (/\.(csv|tsv|json|md|yaml|yml)$/i.test(name) && dropped.size <= 8) robots.push(name);
    }
    // A robot that others include is a part; the top one has a robot's name, is high in the tree, and is not only a macro.
    const rank = (name: string) => {
        const text = texts[name] ?? "";
        const macros = /\.xacro$/i.test(name) && !/<xacro:\w+(?<!macro|property|include|arg|if|unless)[\s/>]/.test(text) && !/<link[\s>]/.test(text) ? 100 : 0;
        const part = /<mujoco[\s>]/.test(text) && !/<(worldbody|include)[\s>]/.test(text) ? 100 : 0;
        return macros + part + (/\.urdf$/i.test(name) ? 0 : 10) + name.split("/").length + (/macro|inc|common|gazebo|ros2_control/i.test(name) ? 20 : 0)
            + (/canonical|calibrated|expanded|simplified|fixed|test|demo|example|backup|old/i.test(basename(name)) ? 5 : 0);
    };
    // Without their endings, so that arm.urdf stands before arm_with_gripper.urdf.
    const bare = (name: string) => name.replace(/(\.urdf)?\.\w+$/i, "");
    robots.sort((a, b) => rank(a) - rank(b) || bare(a).localeCompare(bare(b)) || a.localeCompare(b));
    return { robots, data, texts, names: [...dropped.keys()], packages: packages(texts), semantics };
}

/** Whether one of two files includes the other. */
export function areOne(a: string, b: string, texts: Record<string, string>): boolean {
    const includes = (from: string, other: string) => [...(texts[from] ?? "").matchAll(/<(?:\w+:)?include\s[^>]*>/g)].some(([element]) => element.includes(basename(other)));
    return includes(a, b) || includes(b, a);
}

/** The last part of a name with folders. */
export const basename = (name: string): string => name.split("/").pop() || name;

/** A table's headings in small letters and without units, where they stand, and the units of a line `# units: mm,deg`. */
export function headings(text: string): { names: string[]; separator: string; lines: string[]; first: number; units: { length: string; angle: string } } {
    const lines = text.replace(/^\uFEFF/, "").split(/\r?\n/);
    const first = lines.findIndex((line) => line.trim() !== "" && !line.startsWith("#"));
    const header = lines[first] ?? "";
    const separator = [";", "\t"].find((it) => header.includes(it)) ?? ",";
    const said = lines.slice(0, Math.max(0, first)).map((line) => /^#\s*units:\s*(\w+)\s*,\s*(\w+)/i.exec(line)).find((it) => it);
    const names = header.toLowerCase().split(separator).map((cell) => cell.trim().replace(/\s*[[(].*[\])]$/, ""));
    return { names, separator, lines, first, units: { length: said?.[1] ?? "m", angle: said?.[2] ?? "rad" } };
}

/** Whether headings are those of measurements: a place, a distance or the like. */
export function measures(names: string[]): boolean {
    const has = (name: string) => names.includes(name);
    if (has("theta") || has("alpha") || has("wx") || has("d")) return false;
    return (has("x") && has("y") && has("z")) || has("x1") || has("distance") || has("socket") || has("plane") || has("u");
}

/** A header with a place, a distance or the like, or more rows than an arm has joints. */
function holdsMeasurements(text: string): boolean {
    const { names, lines } = headings(text);
    if (names.some((name) => ["theta", "alpha", "wx", "d"].includes(name))) return false;
    return measures(names) || lines.filter((line) => line.trim() !== "" && !line.startsWith("#")).length > 40;
}
