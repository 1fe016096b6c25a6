// The 3-D view: robots by their links and joints, D-H frames with a, α, d, θ, arrows of what is left of measurements.

import {
    AmbientLight, ArrowHelper, BoxGeometry, BufferGeometry, CapsuleGeometry, Color, CylinderGeometry, DirectionalLight, DoubleSide,
    Float32BufferAttribute, GridHelper, Group, HemisphereLight, Line, LineBasicMaterial, LineSegments, LoadingManager, Matrix4, Mesh,
    MeshStandardMaterial, Object3D, PerspectiveCamera, Raycaster, Scene as ThreeScene, SphereGeometry, Vector2, Vector3, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { ColladaLoader } from "three/addons/loaders/ColladaLoader.js";
import { OBJLoader } from "three/addons/loaders/OBJLoader.js";
import { STLLoader } from "three/addons/loaders/STLLoader.js";
import { h } from "./dom";
import type { Scene, Shape } from "./engine";
import type { Dropped } from "./files";
import type { PlacedRow } from "./table";

/** Colours that people with any colour vision tell apart (Okabe and Ito). */
export const COLOURS = { x: 0xd55e00, y: 0x009e73, z: 0x0072b2, a: 0xe69f00, d: 0x56b4e9, theta: 0x0072b2, alpha: 0xcc79a7, other: 0xd55e00 };

interface Body {
    group: Group;
    links: Group[];
    joints: Group[];
    scene: Scene;
    size: number;
}

export class View {
    readonly element: HTMLElement;
    private readonly labels = h("div", { class: "labels", "aria-hidden": "true" });
    private readonly renderer: WebGLRenderer | undefined;
    private readonly scene = new ThreeScene();
    private readonly camera = new PerspectiveCamera(40, 1, 0.001, 1000);
    private readonly controls: OrbitControls | undefined;
    private readonly overlay = new Group();
    private readonly arrows = new Group();
    private readonly bodies: (Body | undefined)[] = [undefined, undefined];
    private readonly tags: { at: Vector3; element: HTMLElement }[] = [];
    private grid: GridHelper | undefined;
    private drawn = false;
    private hovered = "";
    /** Told the row whose frame is under the pointer; null: none. */
    onrow: (row: number | null) => void = () => {};
    /** Told the joint values by driver, for tests and for the page. */
    missing: string[] = [];

    constructor() {
        this.element = h("div", { class: "view", role: "img", "aria-label": "3-D view of the robot", tabindex: 0 });
        const canvas = h("canvas", {});
        try {
            this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
        } catch {
            this.element.append(h("p", { class: "notice" }, "This browser shows no 3-D view (WebGL is off); tables and everything else work."));
            return;
        }
        this.element.append(canvas, this.labels);
        this.camera.up.set(0, 0, 1);
        this.controls = new OrbitControls(this.camera, canvas);
        this.controls.addEventListener("change", () => this.draw());
        this.scene.add(new AmbientLight(0xffffff, 0.6), new HemisphereLight(0xffffff, 0x8899aa, 1.4), this.overlay, this.arrows);
        const sun = new DirectionalLight(0xffffff, 1.6);
        sun.position.set(2, -3, 4);
        this.scene.add(sun);
        new ResizeObserver(() => this.resize()).observe(this.element);
        canvas.addEventListener("pointermove", (event) => this.hover(event));
        canvas.addEventListener("pointerleave", () => this.unhover());
        this.element.addEventListener("keydown", (event) => this.turn(event));
    }

    /** How many geometries the graphics card holds, for tests. */
    get geometries(): number {
        return this.renderer?.info.memory.geometries ?? 0;
    }

    /** Shows a robot in place `index`: 0 as itself, 1 as the other one of a comparison; null takes it away. */
    show(index: 0 | 1, scene: Scene | null, meshes: Dropped = new Map(), from = "/"): void {
        const old = this.bodies[index];
        if (old) {
            this.scene.remove(old.group);
            dispose(old.group);
            this.bodies[index] = undefined;
        }
        if (index === 0) this.missing = [];
        if (scene) {
            const body = this.built(scene, meshes, from, index === 1);
            this.bodies[index] = body;
            this.scene.add(body.group);
            this.move(index, () => 0);
            if (index === 0) this.fit();
        }
        this.draw();
    }

    /** Moves a robot; `value` gives the value of a driving joint, rad or m. */
    move(index: 0 | 1, value: (joint: number) => number): void {
        const body = this.bodies[index];
        if (!body) return;
        for (const [at, joint] of body.scene.joints.entries()) {
            const group = body.joints[at];
            if (!group) continue;
            const q = joint.driver === null ? joint.offset : joint.scale * value(joint.driver) + joint.offset;
            const axis = new Vector3(...joint.axis);
            const motion = new Matrix4();
            if (joint.kind === "prismatic") motion.makeTranslation(axis.clone().multiplyScalar(q));
            else if (joint.kind === "revolute" || joint.kind === "continuous" || joint.pitch !== null) {
                motion.makeRotationAxis(axis, q);
                if (joint.pitch !== null) motion.setPosition(axis.clone().multiplyScalar(q * joint.pitch));
            }
            group.matrix.fromArray(joint.origin).multiply(motion);
            group.matrixWorldNeedsUpdate = true;
        }
        body.group.updateMatrixWorld(true);
        this.draw();
    }

    /** root_from_link of a link of a robot, by name. */
    pose(index: 0 | 1, link: string): Matrix4 | undefined {
        const body = this.bodies[index];
        const at = body?.scene.links.findIndex((it) => it.name === link) ?? -1;
        return body?.links[at]?.matrixWorld;
    }

    get size(): number {
        return this.bodies[0]?.size ?? 1;
    }

    /** Makes the robot's shapes see-through, so that what lies inside is seen. */
    ghost(index: 0 | 1, opacity: number): void {
        this.bodies[index]?.group.traverse((object) => {
            if (object instanceof Mesh) {
                const material = object.material as MeshStandardMaterial;
                const own = (object.userData["opacity"] as number | undefined) ?? 1;
                material.opacity = own * opacity;
                material.transparent = material.opacity < 1;
                material.depthWrite = material.opacity > 0.5;
            }
        });
        this.draw();
    }

    /** Draws the rows of a table in the frame of a link; one of them may stand out. */
    frames(rows: PlacedRow[], base: string, chosen: number | null): void {
        clear(this.overlay);
        this.clearTags();
        const from = this.pose(0, base) ?? new Matrix4();
        this.overlay.matrixAutoUpdate = false;
        this.overlay.matrix.copy(from);
        this.overlay.matrixWorldNeedsUpdate = true;
        const size = this.size;
        for (const [index, row] of rows.entries()) {
            const stands = chosen === null || chosen === index;
            const frame = triad(row.to, size * (chosen === index ? 0.14 : 0.085), stands ? 1 : 0.25);
            frame.userData["row"] = index;
            this.overlay.add(frame);
            const tag = h("span", { class: chosen === index ? "tag chosen" : "tag" }, row.label);
            this.tag(new Vector3().setFromMatrixPosition(row.to).applyMatrix4(from), tag);
            for (const step of row.steps) for (const drawn of drawnStep(step.part, step.amount, step.from, step.to, size, stands, chosen === index)) this.overlay.add(drawn);
            if (chosen === index) {
                for (const step of row.steps) {
                    if (Math.abs(step.amount) < 1e-9) continue;
                    const middle = new Vector3().setFromMatrixPosition(step.from).add(new Vector3().setFromMatrixPosition(step.to)).multiplyScalar(0.5);
                    if (step.part === "theta" || step.part === "alpha") {
                        const out = new Vector3(size * 0.13, 0, 0);
                        if (step.part === "alpha") out.set(0, 0, size * 0.13);
                        const half = step.part === "theta" ? new Matrix4().makeRotationZ(step.amount / 2) : new Matrix4().makeRotationX(step.amount / 2);
                        middle.copy(out).applyMatrix4(half).applyMatrix4(step.from);
                    }
                    this.tag(middle.applyMatrix4(from), h("span", { class: `tag ${step.part}` }, { theta: "θ", d: "d", alpha: "α", a: "a", beta: "β" }[step.part]));
                }
            }
        }
        this.draw();
    }

    /** Lines in the root frame: from, to; and arrows. */
    marks(lines: { from: Vector3; to: Vector3; colour: number }[], arrows: { at: Vector3; by: Vector3; colour: number }[], tags: { at: Vector3; words: string }[] = []): void {
        clear(this.arrows);
        for (const { from, to, colour } of lines) this.arrows.add(segment(from, to, colour, 1));
        for (const { at, by, colour } of arrows) {
            const length = by.length();
            if (length < 1e-12) continue;
            const arrow = new ArrowHelper(by.clone().normalize(), at, length, colour, Math.min(length * 0.3, this.size * 0.03), Math.min(length * 0.2, this.size * 0.015));
            this.arrows.add(arrow);
        }
        for (const { at, words } of tags) this.tag(at, h("span", { class: "tag chosen" }, words));
        this.draw();
    }

    clearTags(): void {
        this.tags.length = 0;
        this.labels.replaceChildren();
    }

    /** Looks at the robot from where all of it is seen. */
    fit(): void {
        const body = this.bodies[0];
        if (!body || !this.controls) return;
        body.group.updateMatrixWorld(true);
        const points = body.links.map((link) => new Vector3().setFromMatrixPosition(link.matrixWorld));
        const centre = points.reduce((sum, point) => sum.add(point), new Vector3()).multiplyScalar(1 / Math.max(1, points.length));
        const reach = Math.max(body.size * 0.35, ...points.map((point) => point.distanceTo(centre)));
        this.controls.target.copy(centre);
        const aspect = Math.min(1, this.element.clientWidth / Math.max(1, this.element.clientHeight));
        this.camera.position.copy(centre).addScaledVector(new Vector3(1, -1.25, 0.75).normalize(), (reach * 3.4) / Math.max(0.5, aspect));
        this.camera.near = body.size / 500;
        this.camera.far = body.size * 100;
        this.camera.updateProjectionMatrix();
        this.controls.update();
        if (this.grid) {
            this.scene.remove(this.grid);
            dispose(this.grid);
        }
        const cell = 10 ** Math.round(Math.log10(body.size / 5));
        this.grid = new GridHelper(cell * 20, 20, 0x8a94a3, 0x8a94a3);
        this.grid.rotation.x = Math.PI / 2;
        (this.grid.material as LineBasicMaterial).transparent = true;
        (this.grid.material as LineBasicMaterial).opacity = 0.28;
        this.scene.add(this.grid);
    }

    draw(): void {
        if (this.drawn || !this.renderer) return;
        this.drawn = true;
        requestAnimationFrame(() => {
            this.drawn = false;
            this.renderer?.render(this.scene, this.camera);
            this.place();
        });
    }

    private resize(): void {
        const { clientWidth: width, clientHeight: height } = this.element;
        if (width === 0 || height === 0 || !this.renderer) return;
        this.renderer.setPixelRatio(Math.min(2, devicePixelRatio));
        this.renderer.setSize(width, height, false);
        this.camera.aspect = width / height;
        this.camera.updateProjectionMatrix();
        this.draw();
    }

    private tag(at: Vector3, element: HTMLElement): void {
        this.labels.append(element);
        this.tags.push({ at, element });
    }

    /** Puts names where their points are seen; names that would lie on each other go apart. */
    private place(): void {
        const { clientWidth: width, clientHeight: height } = this.element;
        const taken: [number, number][] = [];
        for (const { at, element } of this.tags) {
            const seen = at.clone().project(this.camera);
            const visible = seen.z > -1 && seen.z < 1;
            element.hidden = !visible;
            if (!visible) continue;
            let [x, y] = [((seen.x + 1) / 2) * width + 6, ((1 - seen.y) / 2) * height + 6];
            for (let tries = 0; tries < 12 && taken.some(([a, b]) => Math.abs(a - x) < 26 && Math.abs(b - y) < 17); tries++) x += 27;
            taken.push([x, y]);
            element.style.transform = `translate(${Math.round(x)}px, ${Math.round(y)}px)`;
        }
    }

    private readonly pointer = h("span", { class: "tag pointer" });

    private hover(event: PointerEvent): void {
        if (event.buttons !== 0) return;
        const box = this.element.getBoundingClientRect();
        const at = new Vector2(((event.clientX - box.left) / box.width) * 2 - 1, 1 - ((event.clientY - box.top) / box.height) * 2);
        const ray = new Raycaster();
        ray.setFromCamera(at, this.camera);
        ray.params.Line = { threshold: this.size * 0.012 };
        const rows = ray.intersectObjects(this.overlay.children, true);
        const row = rows.map((hit) => owner(hit.object, "row")).find((found) => found !== undefined) as number | undefined;
        const body = this.bodies[0];
        const link = body && ray.intersectObject(body.group, true).map((hit) => owner(hit.object, "link")).find((found) => found !== undefined);
        const words = row !== undefined ? `frame ${this.tagWords(row)}` : typeof link === "string" ? link : "";
        if (words !== this.hovered) {
            this.hovered = words;
            this.onrow(row ?? null);
        }
        this.pointer.textContent = words;
        if (words && !this.pointer.isConnected) this.element.append(this.pointer);
        this.pointer.hidden = words === "";
        this.pointer.style.transform = `translate(${Math.round(event.clientX - box.left + 14)}px, ${Math.round(event.clientY - box.top + 14)}px)`;
    }

    private tagWords(row: number): string {
        return this.labels.querySelectorAll(".tag:not(.theta,.d,.alpha,.a,.beta)")[row]?.textContent ?? String(row);
    }

    private unhover(): void {
        this.pointer.hidden = true;
        if (this.hovered) this.onrow(null);
        this.hovered = "";
    }

    /** Arrow keys turn the view, + and - come near and go away. */
    private turn(event: KeyboardEvent): void {
        const turns: Record<string, [number, number, number]> = {
            ArrowLeft: [-0.15, 0, 1], ArrowRight: [0.15, 0, 1], ArrowUp: [0, 0.12, 1], ArrowDown: [0, -0.12, 1], "+": [0, 0, 0.87], "-": [0, 0, 1.15],
        };
        const turn = turns[event.key];
        if (!turn || !this.controls) return;
        event.preventDefault();
        const target = this.controls.target;
        const out = this.camera.position.clone().sub(target);
        out.applyAxisAngle(new Vector3(0, 0, 1), turn[0]);
        const side = new Vector3(0, 0, 1).cross(out).normalize();
        out.applyAxisAngle(side, -turn[1]).multiplyScalar(turn[2]);
        this.camera.position.copy(target).add(out);
        this.controls.update();
        this.draw();
    }

    private built(scene: Scene, meshes: Dropped, from: string, other: boolean): Body {
        const group = new Group();
        const links = scene.links.map((link) => {
            const made = new Group();
            made.userData["link"] = link.name;
            return made;
        });
        const joints = scene.joints.map((joint) => {
            const made = new Group();
            made.matrixAutoUpdate = false;
            made.matrix.fromArray(joint.origin);
            const [parent, child] = [links[joint.parent], links[joint.child]];
            if (parent && child) {
                parent.add(made);
                made.add(child);
            }
            return made;
        });
        const root = links[scene.root];
        if (root) group.add(root);
        group.updateMatrixWorld(true);
        const points = links.map((link) => new Vector3().setFromMatrixPosition(link.matrixWorld));
        let size = 0;
        for (const point of points) size = Math.max(size, point.distanceTo(points[scene.root] ?? new Vector3()));
        // A robot with all links at one place still wants a size.
        size = size > 1e-6 ? size : 0.5;
        let shapes = 0;
        for (const [index, link] of scene.links.entries()) {
            const seen = link.visuals.length > 0 ? link.visuals : link.collisions;
            for (const shape of seen) {
                const made = this.shape(shape, meshes, from, other);
                if (made) {
                    links[index]?.add(made);
                    shapes++;
                }
            }
        }
        this.skeleton(scene, links, joints, size, other, shapes === 0);
        return { group, links, joints, scene, size };
    }

    /** Axes as rods and lines between them: a robot without shapes is seen, too. */
    private skeleton(scene: Scene, links: Group[], joints: Group[], size: number, other: boolean, alone: boolean): void {
        const colour = other ? COLOURS.other : 0x7b8794;
        for (const [index, joint] of scene.joints.entries()) {
            const parent = links[joint.parent];
            const to = new Vector3().setFromMatrixPosition(new Matrix4().fromArray(joint.origin));
            if (to.length() > size * 1e-4) {
                if (alone) parent?.add(rod(new Vector3(), to, size * 0.012, colour));
                else parent?.add(segment(new Vector3(), to, colour, 0.7));
            }
            if (alone && joint.kind !== "fixed") {
                const axis = new Vector3(...joint.axis).multiplyScalar(size * 0.045);
                joints[index]?.add(rod(axis.clone().negate(), axis, size * 0.026, other ? COLOURS.other : 0x5b7fa6));
            }
        }
    }

    private shape(shape: Shape, meshes: Dropped, from: string, other: boolean): Object3D | undefined {
        const geometry = shape.geometry;
        if (!geometry) return undefined;
        const [r, g, b, opacity] = shape.colour ?? [0.62, 0.67, 0.73, 1];
        const colour = other ? new Color(COLOURS.other) : new Color().setRGB(r, g, b);
        const material = () => {
            const made = new MeshStandardMaterial({ color: colour, roughness: 0.75, metalness: 0.05, side: DoubleSide });
            made.opacity = other ? 0.45 : opacity;
            made.transparent = made.opacity < 1;
            return made;
        };
        const made = (form: BufferGeometry) => {
            const mesh = new Mesh(form, material());
            mesh.userData["opacity"] = other ? 0.45 : opacity;
            return mesh;
        };
        const holder = new Group();
        holder.matrixAutoUpdate = false;
        holder.matrix.fromArray(shape.origin);
        // URDF's cylinders and capsules lie along z, three's along y.
        const alongZ = (form: BufferGeometry) => form.rotateX(Math.PI / 2);
        if ("box" in geometry) holder.add(made(new BoxGeometry(...geometry.box)));
        else if ("cylinder" in geometry) holder.add(made(alongZ(new CylinderGeometry(geometry.cylinder[0], geometry.cylinder[0], geometry.cylinder[1], 32))));
        else if ("capsule" in geometry) holder.add(made(alongZ(new CapsuleGeometry(geometry.capsule[0], geometry.capsule[1], 8, 24))));
        else if ("sphere" in geometry) holder.add(made(new SphereGeometry(geometry.sphere, 32, 16)));
        else {
            const object = this.mesh(geometry.mesh, meshes, from, made);
            if (!object) return undefined;
            object.scale.multiply(new Vector3(...geometry.scale));
            holder.add(object);
        }
        return holder;
    }

    private mesh(uri: string, meshes: Dropped, from: string, made: (form: BufferGeometry) => Mesh): Object3D | undefined {
        const name = found(uri, meshes, from);
        const bytes = name === undefined ? undefined : meshes.get(name);
        if (!name || !bytes) {
            if (!this.missing.includes(uri)) this.missing.push(uri);
            return undefined;
        }
        try {
            const buffer = bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength) as ArrayBuffer;
            const end = name.split(".").pop()?.toLowerCase();
            if (end === "stl") return made(new STLLoader().parse(buffer));
            // What a file refers to is not fetched: this page asks the network for nothing.
            const manager = new LoadingManager();
            manager.setURLModifier(() => "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mP8/5+hHgAHggJ/PchI7wAAAABJRU5ErkJggg==");
            const text = new TextDecoder().decode(bytes);
            let object: Object3D | undefined;
            if (end === "obj") object = new OBJLoader(manager).parse(text);
            if (end === "dae") object = new ColladaLoader(manager).parse(text, "")?.scene;
            if (!object) return undefined;
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
            return out;
        } catch {
            if (!this.missing.includes(uri)) this.missing.push(uri);
            return undefined;
        }
    }
}

/** The dropped file that a mesh's URI means: beside the robot, or in a package by its folder's name. */
export function found(uri: string, meshes: Dropped, from: string): string | undefined {
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

function owner(object: Object3D | null, key: string): unknown {
    for (let at = object; at; at = at.parent) if (at.userData[key] !== undefined) return at.userData[key];
    return undefined;
}

function segment(from: Vector3, to: Vector3, colour: number, opacity: number): Line {
    const material = new LineBasicMaterial({ color: colour, transparent: opacity < 1, opacity });
    return new Line(new BufferGeometry().setFromPoints([from, to]), material);
}

function rod(from: Vector3, to: Vector3, radius: number, colour: number, opacity = 1): Mesh {
    const along = to.clone().sub(from);
    const form = new CylinderGeometry(radius, radius, along.length(), 16);
    const mesh = new Mesh(form, new MeshStandardMaterial({ color: colour, roughness: 0.8, transparent: opacity < 1, opacity }));
    mesh.position.copy(from).addScaledVector(along, 0.5);
    mesh.quaternion.setFromUnitVectors(new Vector3(0, 1, 0), along.normalize());
    mesh.userData["opacity"] = opacity;
    return mesh;
}

function triad(at: Matrix4, length: number, opacity: number): Group {
    const group = new Group();
    const origin = new Vector3().setFromMatrixPosition(at);
    const [x, y, z] = [new Vector3(), new Vector3(), new Vector3()];
    at.extractBasis(x, y, z);
    for (const [axis, colour, factor] of [[x, COLOURS.x, 1], [y, COLOURS.y, 0.6], [z, COLOURS.z, 1.2]] as const) {
        const made = rod(origin, origin.clone().addScaledVector(axis, length * factor), length * 0.045, colour, opacity);
        (made.material as MeshStandardMaterial).depthTest = false;
        made.renderOrder = 2;
        group.add(made);
    }
    return group;
}

function drawnStep(part: string, amount: number, from: Matrix4, to: Matrix4, size: number, stands: boolean, chosen: boolean): Object3D[] {
    const [start, end] = [new Vector3().setFromMatrixPosition(from), new Vector3().setFromMatrixPosition(to)];
    const opacity = stands ? 1 : 0.2;
    if (part === "d" || part === "a") {
        if (Math.abs(amount) < size * 1e-6) return [];
        const made = rod(start, end, size * (chosen ? 0.009 : 0.005), part === "d" ? COLOURS.d : COLOURS.a, opacity);
        (made.material as MeshStandardMaterial).depthTest = false;
        made.renderOrder = 1;
        return [made];
    }
    if (!chosen || Math.abs(amount) < 1e-9) return [];
    const radius = size * 0.1;
    const points: number[] = [];
    const steps = Math.max(6, Math.ceil(Math.abs(amount) / 0.1));
    for (let k = 0; k <= steps; k++) {
        const turned = (amount * k) / steps;
        const point = part === "theta" ? new Vector3(Math.cos(turned), Math.sin(turned), 0)
            : part === "alpha" ? new Vector3(0, -Math.sin(turned), Math.cos(turned)) : new Vector3(Math.sin(turned), 0, Math.cos(turned));
        point.multiplyScalar(radius).applyMatrix4(from);
        points.push(point.x, point.y, point.z);
    }
    const form = new BufferGeometry().setAttribute("position", new Float32BufferAttribute(points, 3));
    const arc = new Line(form, new LineBasicMaterial({ color: part === "theta" ? COLOURS.theta : COLOURS.alpha, depthTest: false }));
    arc.renderOrder = 3;
    return [arc];
}

function clear(group: Group): void {
    for (const child of [...group.children]) {
        group.remove(child);
        dispose(child);
    }
}

function dispose(object: Object3D): void {
    object.traverse((part) => {
        if (part instanceof Mesh || part instanceof Line || part instanceof LineSegments) {
            (part.geometry as BufferGeometry).dispose();
            for (const material of Array.isArray(part.material) ? part.material : [part.material]) material.dispose();
        }
    });
}
