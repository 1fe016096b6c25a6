// Meshes of a robot among the dropped files: which one a name means, and what is in it (STL, COLLADA, OBJ).

import { BufferGeometry, Color, Group, LoadingManager, Mesh, MeshStandardMaterial, Object3D } from "three";
import { ColladaLoader } from "three/addons/loaders/ColladaLoader.js";
import { OBJLoader } from "three/addons/loaders/OBJLoader.js";
import { STLLoader } from "three/addons/loaders/STLLoader.js";
import { dispose } from "./drawn";
import type { Dropped } from "./files";

/** Mesh files that stand in a page in base64, by what the robot calls them. */
export function unpacked(packed: Record<string, string>): Dropped {
    const decoded = (text: string) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
    return new Map(Object.entries(packed).map(([uri, text]) => [uri, decoded(text)]));
}

/** The dropped file that a mesh's URI means: beside the robot, or in a package by its folder's name. */
export function found(uri: string, meshes: Dropped, from: string): string | undefined {
    // What the command line brings has the robot's own name for it.
    if (meshes.has(uri)) return uri;
    const scheme = /^(package|model|file):\/\/(.*)$/.exec(uri);
    const path = decodeURIComponent((scheme?.[2] ?? uri).replace(/%(?![0-9a-f]{2})/gi, "%25")).replaceAll("\\", "/");
    if (!scheme) {
        const parts = from.split("/").slice(0, -1);
        for (const part of path.split("/")) {
            if (part === "..") parts.pop();
            else if (part !== ".") parts.push(part);
        }
        const beside = parts.join("/");
        if (meshes.has(beside)) return beside;
    }
    const names = [...meshes.keys()];
    const plain = path.replace(/^(\.\.?\/)+/, "").replace(/^\//, "");
    // With the package's folder, or without it where the package itself was dropped.
    const inside = plain.split("/").slice(1).join("/");
    for (const wanted of scheme ? [plain, inside] : [plain]) {
        const end = `/${wanted}`;
        const hit = wanted && names.find((name) => name.endsWith(end));
        if (hit) return hit;
    }
    return undefined;
}

const PIXEL = "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mP8/5+hHgAHggJ/PchI7wAAAABJRU5ErkJggg==";

/**
 * The shapes in a file; `made` gives each its material. Undefined where the file is none of the three kinds, or holds nothing.
 * A damaged file throws.
 */
export function parsed(name: string, bytes: Uint8Array, made: (form: BufferGeometry) => Mesh): Object3D | undefined {
    const end = name.split(".").pop()?.toLowerCase();
    const buffer = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength) as ArrayBuffer;
    if (end === "stl") return made(new STLLoader().parse(buffer));
    // What a file refers to is not fetched: this page asks the network for nothing.
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
