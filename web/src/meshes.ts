// Meshes of a robot among the dropped files: which one a name means, and what is in it (STL, COLLADA, OBJ).

import { BufferGeometry, Color, Group, LoadingManager, Mesh, MeshStandardMaterial, Object3D } from "three";
import { ColladaLoader } from "three/addons/loaders/ColladaLoader.js";
import { OBJLoader } from "three/addons/loaders/OBJLoader.js";
import { STLLoader } from "three/addons/loaders/STLLoader.js";
import { dispose } from "./drawn";
import type { Dropped, Packages } from "./files";

/** Mesh files that stand in a page in base64, by what the robot calls them. */
export function unpacked(packed: Record<string, string>): Dropped {
    const decoded = (text: string) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
    return new Map(Object.entries(packed).map(([uri, text]) => [uri, decoded(text)]));
}

/**
 * The dropped file that a mesh's URI means; undefined where none does, or several do alike.
 *
 * A name from the robot's own file is looked for beside it. `package://NAME/PATH` is looked for in the package whose package.xml says
 * NAME, and nowhere else where that package was dropped. Else it is the file whose path ends as the URI does for the most parts;
 * files of packages with other names do not count.
 */
export function found(uri: string, meshes: Dropped, from: string, packages: Packages = new Map()): string | undefined {
    // What the command line brings has the robot's own name for it.
    if (meshes.has(uri)) return uri;
    const scheme = /^(package|model|file):\/\/(.*)$/.exec(uri);
    const path = decoded(scheme?.[2] ?? uri).replaceAll("\\", "/");
    if (!scheme) {
        const beside = resolved(from.slice(0, from.lastIndexOf("/")), path);
        if (meshes.has(beside)) return beside;
    }
    const wanted = parts(path);
    const [owner, ...inside] = wanted;
    if (scheme && scheme[1] !== "file" && owner !== undefined) {
        const own = [...packages].filter(([, name]) => name === owner).map(([folder]) => folder);
        for (const folder of own) {
            const name = resolved(folder, inside.join("/"));
            if (meshes.has(name)) return name;
        }
        if (own.length > 0) return undefined;
    }
    const foreign = (name: string) => {
        const home = [...packages.keys()].filter((folder) => name.startsWith(`${folder}/`)).sort((a, b) => b.length - a.length)[0];
        return scheme?.[1] === "package" && home !== undefined && packages.get(home) !== owner;
    };
    const near = [...meshes.keys()].filter((name) => !foreign(name)).map((name) => ({ name, shared: suffix(parts(name), wanted) }));
    const most = Math.max(1, ...near.map(({ shared }) => shared));
    const best = near.filter(({ shared }) => shared === most).map(({ name }) => name);
    if (best.length <= 1 || best.every((name) => alike(meshes.get(name), meshes.get(best[0] ?? "")))) return best[0];
    // Several files of one name: the one nearest to the robot's file, where one is.
    const shares = (name: string) => prefix(parts(name), parts(from));
    const closest = Math.max(...best.map(shares));
    const nearest = best.filter((name) => shares(name) === closest);
    return nearest.length === 1 ? nearest[0] : undefined;
}

/** Where the rules search for a mesh of this URI, from the top; files found elsewhere get this name. */
export function looked(uri: string, from: string): string {
    const scheme = /^\w+:\/\/(.*)$/.exec(uri);
    return scheme ? resolved("", decoded(scheme[1] ?? "")) : resolved(from.slice(0, from.lastIndexOf("/")), uri);
}

function decoded(text: string): string {
    try {
        return decodeURIComponent(text.replace(/%(?![0-9a-f]{2})/gi, "%25"));
    } catch {
        return text;
    }
}

function parts(path: string): string[] {
    return path.split("/").filter((part) => part !== "" && part !== "." && part !== "..");
}

function resolved(folder: string, path: string): string {
    const out = parts(folder);
    for (const part of path.split("/")) {
        if (part === "..") out.pop();
        else if (part !== "." && part !== "") out.push(part);
    }
    return `/${out.join("/")}`;
}

/** How many parts two paths share at their ends. */
function suffix(a: string[], b: string[]): number {
    let count = 0;
    while (count < Math.min(a.length, b.length) && a.at(-1 - count) === b.at(-1 - count)) count++;
    return count;
}

/** How many folders two paths share at their beginning. */
function prefix(a: string[], b: string[]): number {
    let count = 0;
    while (count < Math.min(a.length, b.length) - 1 && a[count] === b[count]) count++;
    return count;
}

function alike(a: Uint8Array | undefined, b: Uint8Array | undefined): boolean {
    return a !== undefined && b !== undefined && a.length === b.length && a.every((byte, at) => byte === b[at]);
}

const PIXEL = "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mP8/5+hHgAHggJ/PchI7wAAAABJRU5ErkJggg==";

/**
 * The shapes in a file; `made` gives each its material. Undefined where the file is not one of the three kinds, or holds nothing.
 * A damaged file throws.
 */
export function parsed(name: string, bytes: Uint8Array, made: (form: BufferGeometry) => Mesh): Object3D | undefined {
    const end = name.split(".").pop()?.toLowerCase();
    const buffer = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength) as ArrayBuffer;
    if (end === "stl") return made(new STLLoader().parse(buffer));
    // What a file refers to is not fetched: this page does not use the network.
    const manager = new LoadingManager();
    manager.setURLModifier(() => PIXEL);
    const text = new TextDecoder().decode(bytes);
    let object: Object3D | undefined;
    if (end === "obj") object = new OBJLoader(manager).parse(text);
    if (end === "dae") object = new ColladaLoader(manager).parse(text, "")?.scene;
    if (!object) return undefined;
    // The loader turns what is z-up to three's y-up; robots' meshes stand in their link's frame as they are.
    object.rotation.set(0, 0, 0);
    const out = new Group();
    object.updateMatrixWorld(true);
    object.traverse((part) => {
        if (!(part instanceof Mesh)) return;
        const mesh = made((part.geometry as BufferGeometry).clone().applyMatrix4(part.matrixWorld));
        const own = (Array.isArray(part.material) ? part.material[0] : part.material) as { color?: Color } | undefined;
        if (end === "dae" && own?.color && mesh.userData["opacity"] === 1) (mesh.material as MeshStandardMaterial).color.copy(own.color);
        out.add(mesh);
    });
    dispose(object);
    return out.children.length > 0 ? out : undefined;
}
