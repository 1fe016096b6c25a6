// The 3-D view: robots by their links and joints, D-H frames with a, α, d, θ, arrows of residuals.

import {
    AmbientLight, ArrowHelper, DirectionalLight, GridHelper, Group, HemisphereLight, Light, LineBasicMaterial, Matrix4, Mesh, MeshBasicMaterial, Object3D,
    PerspectiveCamera, Raycaster, Scene as ThreeScene, SphereGeometry, Vector2, Vector3, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import type { TransformControls } from "three/addons/controls/TransformControls.js";
import { SVGRenderer } from "three/addons/renderers/SVGRenderer.js";
import { Body, FAINT, type Layer, type Phantom } from "./body";
import { h, number, svg } from "./dom";
import { clear, COLOURS, dispose, drawnStep, rod, segment, triad } from "./drawn";
import type { Scene } from "./engine";
import type { Dropped, Packages } from "./files";
import { type Label, Labels } from "./labels";
import type { PlacedRow } from "./table";

const LETTERS = { theta: "θ", d: "d", alpha: "α", a: "a", beta: "β" };

/** Programs cannot open an SVG with more triangles. */
const MOST_TRIANGLES = 60_000;
/** Fraction of the lights' strength at which an SVG has the colours of the view. */
const INK = 0.3;
/** A pointer that goes farther between down and up has turned the view, pixels. */
const STILL = 5;
/** The origin of a frame is picked within this, pixels. */
const NEAR = 10;

/** A point of the robot that was clicked: on a link, in its frame, or the origin of a row's frame. */
export interface Picked {
    words: string;
    link: string;
    row: number | null;
    local: Vector3;
}

/** The robot in another posture, and its name. */
export interface Ghost {
    words: string;
    value: (joint: number) => number;
}

export class View {
    readonly element: HTMLElement;
    private readonly labels = new Labels();
    private renderer: WebGLRenderer | undefined;
    private readonly scene = new ThreeScene();
    private readonly camera = new PerspectiveCamera(40, 1, 0.001, 1000);
    private controls: OrbitControls | undefined;
    private readonly overlay = new Group();
    private readonly arrows = new Group();
    private readonly pointed = new Group();
    private readonly ruled = new Group();
    private down = new Vector2();
    /** Called with the clicked part of the robot, while it is set. */
    onpick: ((picked: Picked) => void) | undefined;
    private grip: TransformControls | undefined;
    /** Set by the user of a handle: creates it. */
    grips: ((camera: PerspectiveCamera, canvas: HTMLCanvasElement) => TransformControls) | undefined;
    /** The object that the handle moves. */
    private readonly held = new Object3D();
    private phantoms: (Phantom & { words: string })[] = [];
    /** Called when the handle is dragged, and when it is released. */
    onhandle: ((pose: Matrix4) => void) | undefined;
    /** Called with the clicked ghost. */
    onghost: ((index: number) => void) | undefined;
    private readonly bodies: (Body | undefined)[] = [undefined, undefined];
    private readonly pointer = h("span", { class: "tag pointer", hidden: true });
    private readonly layers = new Map<Layer, boolean>();
    private rowNames: string[] = [];
    /** Origins of the rows' frames, in the root's frame. */
    private rowPlaces: Vector3[] = [];
    private grid: GridHelper | undefined;
    private started = false;
    private drawn = false;
    private hovered = "";
    /** Called with the row whose frame is under the pointer; null: none. */
    onrow: (row: number | null) => void = () => {};

    constructor() {
        this.element = h("div", { class: "view", role: "img", "aria-label": "3-D view of the robot", tabindex: 0 });
        this.camera.up.set(0, 0, 1);
    }

    /** How many geometries the graphics card holds, for tests. */
    get geometries(): number {
        return this.renderer?.info.memory.geometries ?? 0;
    }

    /** Meshes of the robot that are not shown. */
    get missing(): string[] {
        return this.bodies[0]?.missing ?? [];
    }

    /** Whether there is a picture: false if the browser has no WebGL. */
    get works(): boolean {
        return this.renderer !== undefined;
    }

    get size(): number {
        return this.bodies[0]?.size ?? 1;
    }

    /** Shows a robot in place `index`: 0 as itself, 1 as the other one of a comparison, seen through unless it is `alone`; null takes it away. */
    show(index: 0 | 1, scene: Scene | null, meshes: Dropped = new Map(), from = "/", packages: Packages = new Map(), alone = false): void {
        this.start();
        if (index === 0) {
            // Frames and marks of the previous robot do not apply to this one.
            clear(this.pointed);
            this.frames([], "", null);
            this.marks([], []);
            this.ghosts([]);
            this.handle(null);
        }
        const old = this.bodies[index];
        if (old) {
            this.scene.remove(old.group);
            dispose(old.group);
            this.bodies[index] = undefined;
        }
        if (scene) {
            const body = new Body(scene, meshes, from, packages, index === 1 && !alone);
            this.bodies[index] = body;
            for (const [name, shown] of this.layers) body.layer(name, shown);
            this.scene.add(body.group);
            if (index === 0) this.fit();
        }
        this.draw();
    }

    /** Shows or hides a robot. */
    see(index: 0 | 1, shown: boolean): void {
        const body = this.bodies[index];
        if (body) body.group.visible = shown;
        this.draw();
    }

    /** Lights up a link of the robot and draws its frame; null: none. */
    lightUp(link: string | null): void {
        this.bodies[0]?.light(link);
        this.point(link);
    }

    /** Moves a robot; `value` gives the value of a driving joint, rad or m. */
    move(index: 0 | 1, value: (joint: number) => number): void {
        this.bodies[index]?.move(value);
        this.draw();
    }

    /** root_from_link of a link of a robot, by name. */
    pose(index: 0 | 1, link: string): Matrix4 | undefined {
        return this.bodies[index]?.pose(link);
    }

    /** Shows or hides a layer of the robots, and of those that follow. */
    layer(name: Layer, shown: boolean): void {
        this.layers.set(name, shown);
        for (const body of this.bodies) body?.layer(name, shown);
        this.draw();
    }

    /** Draws something without the handle. */
    private without<T>(pen: () => T): T {
        const grip = this.grip?.getHelper();
        const shown = grip?.visible ?? false;
        if (grip) grip.visible = false;
        const drawn = pen();
        if (grip) grip.visible = shown;
        return drawn;
    }

    /** The picture as it stands, PNG at twice the view's size at least; undefined where there is none. */
    async picture(): Promise<Blob | undefined> {
        const { renderer } = this;
        if (!renderer) return undefined;
        const { clientWidth: width, clientHeight: height } = this.element;
        const before = renderer.getPixelRatio();
        renderer.setPixelRatio(Math.max(2, before));
        renderer.setSize(width, height, false);
        this.without(() => renderer.render(this.scene, this.camera));
        this.labels.place(this.camera, width, height);
        const ratio = renderer.getPixelRatio();
        const paper = document.createElement("canvas");
        [paper.width, paper.height] = [Math.round(width * ratio), Math.round(height * ratio)];
        const ink = paper.getContext("2d");
        if (ink) {
            ink.fillStyle = getComputedStyle(this.element).backgroundColor;
            ink.fillRect(0, 0, paper.width, paper.height);
            ink.drawImage(renderer.domElement, 0, 0, paper.width, paper.height);
            ink.scale(ratio, ratio);
            this.labels.paint(ink, this.element);
        }
        renderer.setPixelRatio(before);
        renderer.setSize(width, height, false);
        this.draw();
        return new Promise((resolve) => paper.toBlob((blob) => resolve(blob ?? undefined), "image/png"));
    }

    /** The picture as it stands, as an SVG of triangles, lines and names. */
    svg(): string {
        const triangles = this.bodies.reduce((sum, body) => sum + (body?.triangles ?? 0), 0);
        if (triangles > MOST_TRIANGLES) throw new Error(`the shapes have ${triangles} triangles, an SVG holds ${MOST_TRIANGLES}; hide the shapes, or use the PNG`);
        const { clientWidth: width, clientHeight: height } = this.element;
        const pen = new SVGRenderer();
        pen.setSize(width, height);
        pen.setPrecision(2);
        // This renderer computes light differently from the graphics card.
        this.light(INK);
        this.without(() => pen.render(this.scene, this.camera));
        this.light(1 / INK);
        this.labels.place(this.camera, width, height);
        const drawing = pen.domElement as unknown as SVGElement;
        const paper = svg("rect", { x: -width / 2, y: -height / 2, width, height, fill: getComputedStyle(this.element).backgroundColor });
        drawing.prepend(paper);
        drawing.append(svg("g", { transform: `translate(${number(-width / 2)} ${number(-height / 2)})` }, ...this.labels.drawn(this.element)));
        return new XMLSerializer().serializeToString(drawing);
    }

    /** A handle that is dragged, at a pose in the root's frame; null takes it away. */
    handle(pose: Matrix4 | null): void {
        if (!pose) {
            this.grip?.detach();
            this.labels.set("handle", []);
            this.draw();
            return;
        }
        const grip = (this.grip ??= this.made());
        if (!grip || grip.dragging) return;
        pose.decompose(this.held.position, this.held.quaternion, this.held.scale);
        this.held.updateMatrixWorld(true);
        if (!grip.object) grip.attach(this.held);
        this.draw();
    }

    /** Whether the handle is being dragged. */
    get dragging(): boolean {
        return this.grip?.dragging ?? false;
    }

    /** Whether the handle turns what it holds, or moves it. */
    turns(on: boolean): void {
        this.grip?.setMode(on ? "rotate" : "translate");
        this.draw();
    }

    /** Text next to the handle; empty: none. */
    warn(words: string): void {
        this.labels.set("handle", words ? [{ at: this.held.position.clone(), words, kind: "pointer", first: true }] : []);
        this.draw();
    }

    /** The robot in other postures, see-through. */
    ghosts(shown: Ghost[]): void {
        const body = this.bodies[0];
        for (const { group, material } of this.phantoms.splice(body ? shown.length : 0)) {
            this.scene.remove(group);
            material.dispose();
        }
        for (const [at, { words, value }] of shown.entries()) {
            const old = this.phantoms[at];
            if (old) {
                old.words = words;
                old.move(value);
            } else if (body) {
                const made = body.phantom(value);
                this.scene.add(made.group);
                this.phantoms.push({ ...made, words });
            }
        }
        this.draw();
    }

    /** The ghost under the pointer, where nothing of the robot is before it. */
    private ghostUnder(ray: Raycaster): number | undefined {
        const [body] = this.bodies;
        if (this.phantoms.length === 0 || !body || this.grip?.axis) return undefined;
        const nearest = (group: Group) => ray.intersectObject(group, true).find((hit) => seen(hit.object) && hit.object instanceof Mesh)?.distance ?? Infinity;
        const apart = this.phantoms.map(({ group }) => nearest(group));
        const least = Math.min(...apart);
        return least < nearest(body.group) ? apart.indexOf(least) : undefined;
    }

    private light(factor: number): void {
        for (const object of this.scene.children) if (object instanceof Light) object.intensity *= factor;
    }

    /** A line between points of the root's frame, with its ends. */
    rule(points: Vector3[]): void {
        clear(this.ruled);
        for (const point of points) {
            const end = new Mesh(new SphereGeometry(this.size * 0.012, 16, 8), new MeshBasicMaterial({ color: 0xcc3311, depthTest: false }));
            end.position.copy(point);
            end.renderOrder = 4;
            this.ruled.add(end);
        }
        const [from, to] = points;
        if (from && to) {
            const line = segment(from, to, 0xcc3311, 1);
            (line.material as LineBasicMaterial).depthTest = false;
            line.renderOrder = 4;
            this.ruled.add(line);
        }
        const words = from && to ? [{ at: from.clone().lerp(to, 0.5), words: `${number(from.distanceTo(to) * 1000, 2)} mm`, kind: "chosen", first: true }] : [];
        this.labels.set("rule", words);
        this.draw();
    }

    /** Makes the robot's shapes see-through, so that what lies inside is seen. */
    ghost(index: 0 | 1, opacity: number): void {
        this.bodies[index]?.ghost(opacity);
        this.draw();
    }

    /** Draws the rows of a table in the frame of a link; one of them may stand out. */
    frames(rows: PlacedRow[], base: string, chosen: number | null): void {
        clear(this.overlay);
        const from = this.pose(0, base) ?? new Matrix4();
        this.overlay.matrixAutoUpdate = false;
        this.overlay.matrix.copy(from);
        this.overlay.matrixWorldNeedsUpdate = true;
        this.rowNames = rows.map((row) => row.label);
        this.rowPlaces = rows.map((row) => new Vector3().setFromMatrixPosition(row.to).applyMatrix4(from));
        const size = this.scale(rows);
        const labels: Label[] = [];
        for (const [index, row] of rows.entries()) {
            const [own, stands] = [chosen === index, chosen === null || chosen === index];
            const frame = triad(row.to, size * (own ? 0.14 : 0.085), stands ? 1 : 0.25);
            frame.userData["row"] = index;
            this.overlay.add(frame);
            labels.push({ at: new Vector3().setFromMatrixPosition(row.to).applyMatrix4(from), words: row.label, kind: own ? "chosen" : "", first: own });
            for (const { part, amount, from: before, to } of row.steps) {
                for (const drawn of drawnStep(part, amount, before, to, size, stands, own)) this.overlay.add(drawn);
                if (!own || Math.abs(amount) < 1e-9) continue;
                const middle = new Vector3().setFromMatrixPosition(before).add(new Vector3().setFromMatrixPosition(to)).multiplyScalar(0.5);
                if (part === "theta" || part === "alpha") {
                    const out = part === "theta" ? new Vector3(size * 0.13, 0, 0) : new Vector3(0, 0, size * 0.13);
                    const half = part === "theta" ? new Matrix4().makeRotationZ(amount / 2) : new Matrix4().makeRotationX(amount / 2);
                    middle.copy(out).applyMatrix4(half).applyMatrix4(before);
                }
                labels.push({ at: middle.applyMatrix4(from), words: LETTERS[part], kind: part, first: true });
            }
        }
        this.labels.set("rows", labels);
        this.draw();
    }

    /**
     * The length that frames are drawn by: the robot's size where its frames stand apart; less where they stand close to each other, as
     * those of a finger do.
     */
    private scale(rows: PlacedRow[]): number {
        const step = ({ from, to }: PlacedRow) => new Vector3().setFromMatrixPosition(from).distanceTo(new Vector3().setFromMatrixPosition(to));
        const steps = rows.map(step).filter((length) => length > this.size * 1e-4).sort((a, b) => a - b);
        const middle = steps[Math.floor(steps.length / 2)] ?? this.size;
        return Math.min(this.size, Math.max(7 * middle, this.size * 0.01));
    }

    /** Replaces lines, arrows and names in the root frame. */
    marks(lines: { from: Vector3; to: Vector3; colour: number; thick?: boolean }[], arrows: { at: Vector3; by: Vector3; colour: number }[], names: { at: Vector3; words: string }[] = []): void {
        clear(this.arrows);
        for (const { from, to, colour, thick } of lines) {
            this.arrows.add(thick && from.distanceTo(to) > 0 ? rod(from, to, this.size * 0.004, colour) : segment(from, to, colour, 1));
        }
        for (const { at, by, colour } of arrows) {
            const length = by.length();
            if (length < 1e-12) continue;
            const arrow = new ArrowHelper(by.clone().normalize(), at, length, colour, Math.min(length * 0.3, this.size * 0.03), Math.min(length * 0.2, this.size * 0.015));
            this.arrows.add(arrow);
        }
        this.labels.set("marks", names.map(({ at, words }) => ({ at, words, kind: "chosen" })));
        this.draw();
    }

    /** Moves the camera to show the whole robot from this side. */
    fit(side = new Vector3(1, -1.25, 0.75)): void {
        const body = this.bodies[0];
        if (!body || !this.controls) return;
        const seen = body.ball();
        if (this.bodies[1]) seen.union(this.bodies[1].ball());
        const { center: centre } = seen;
        const reach = Math.max(body.size * 0.35, seen.radius);
        this.controls.target.copy(centre);
        const aspect = Math.min(1, this.element.clientWidth / Math.max(1, this.element.clientHeight));
        // A ball of this size fills the view at 1 / sin(fov / 2); frames and names stand around it.
        this.camera.position.copy(centre).addScaledVector(side.clone().normalize(), (reach * 3.1) / Math.max(0.5, aspect));
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
        this.draw();
    }

    draw(): void {
        if (this.drawn || !this.renderer) return;
        this.drawn = true;
        requestAnimationFrame(() => {
            this.drawn = false;
            this.renderer?.render(this.scene, this.camera);
            this.labels.place(this.camera, this.element.clientWidth, this.element.clientHeight);
        });
    }

    /** Graphics start with the first robot: a page without one is painted at once. */
    private start(): void {
        if (this.started) return;
        this.started = true;
        const canvas = h("canvas", {});
        try {
            this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
        } catch {
            this.element.append(h("p", { class: "notice" }, "This browser shows no 3-D view (WebGL is off); tables and everything else work."));
            return;
        }
        this.element.append(canvas, this.labels.element, this.pointer);
        this.controls = new OrbitControls(this.camera, canvas);
        this.controls.addEventListener("change", () => this.draw());
        const sun = new DirectionalLight(0xffffff, 1.6);
        sun.position.set(2, -3, 4);
        this.scene.add(new AmbientLight(0xffffff, 0.6), new HemisphereLight(0xffffff, 0x8899aa, 1.4), sun, this.overlay, this.arrows, this.pointed, this.ruled);
        new ResizeObserver(() => this.resize()).observe(this.element);
        canvas.addEventListener("pointermove", (event) => {
            if (event.buttons === 0) this.hover(event);
        });
        // A finger does not hover: it taps.
        canvas.addEventListener("click", (event) => {
            this.hover(event);
            this.pick(event);
            this.take(event);
        });
        canvas.addEventListener("pointerdown", (event) => this.down.set(event.clientX, event.clientY));
        canvas.addEventListener("pointerleave", (event) => {
            if (event.pointerType === "mouse") this.unhover();
        });
        this.element.addEventListener("keydown", (event) => this.turn(event));
        this.resize();
    }

    /** The handle, not yet shown; while it is dragged the view does not turn. */
    private made(): TransformControls | undefined {
        const grip = this.renderer && this.grips?.(this.camera, this.renderer.domElement);
        if (!grip) return undefined;
        grip.setSpace("local");
        grip.setSize(1.1);
        grip.setColors(COLOURS.x, COLOURS.y, COLOURS.z, COLOURS.a);
        grip.addEventListener("change", () => this.draw());
        grip.addEventListener("dragging-changed", ({ value }) => {
            if (this.controls) this.controls.enabled = value !== true;
            if (value === true) this.unhover();
            else this.tellHandle();
        });
        grip.addEventListener("objectChange", () => this.tellHandle());
        this.scene.add(this.held, grip.getHelper());
        return grip;
    }

    private tellHandle(): void {
        this.held.updateMatrixWorld(true);
        this.onhandle?.(this.held.matrixWorld.clone());
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

    private ray(event: MouseEvent): Raycaster {
        const box = this.element.getBoundingClientRect();
        const at = new Vector2(((event.clientX - box.left) / box.width) * 2 - 1, 1 - ((event.clientY - box.top) / box.height) * 2);
        const ray = new Raycaster();
        ray.setFromCamera(at, this.camera);
        ray.params.Line = { threshold: this.size * 0.012 };
        return ray;
    }

    /** Tells which point of the robot is clicked: a frame stands before the shapes around it. */
    private pick(event: MouseEvent): void {
        if (!this.onpick || this.down.distanceTo(new Vector2(event.clientX, event.clientY)) > STILL) return;
        const ray = this.ray(event);
        const row = this.rowUnder(event) ?? (ray.intersectObjects(this.overlay.children, true).map((hit) => owner(hit.object, "row")).find((found) => found !== undefined) as number | undefined);
        if (row !== undefined) {
            this.onpick({ words: `frame ${this.rowNames[row] ?? row}`, link: "", row, local: new Vector3() });
            return;
        }
        const hit = this.bodies[0] && ray.intersectObject(this.bodies[0].group, true).find((found) => seen(found.object) && owner(found.object, "link") !== undefined);
        const link = hit && String(owner(hit.object, "link"));
        const pose = link === undefined ? undefined : this.pose(0, link);
        if (hit && link !== undefined && pose) this.onpick({ words: link, link, row: null, local: hit.point.clone().applyMatrix4(pose.clone().invert()) });
    }

    /** A click on a ghost. */
    private take(event: MouseEvent): void {
        if (this.onpick || this.down.distanceTo(new Vector2(event.clientX, event.clientY)) > STILL) return;
        const ghost = this.ghostUnder(this.ray(event));
        if (ghost !== undefined) this.onghost?.(ghost);
    }

    /** The row whose frame has its origin next to the pointer. */
    private rowUnder(event: MouseEvent): number | undefined {
        const box = this.element.getBoundingClientRect();
        const apart = this.rowPlaces.map((place) => {
            const seen = place.clone().project(this.camera);
            return Math.hypot(box.left + ((seen.x + 1) / 2) * box.width - event.clientX, box.top + ((1 - seen.y) / 2) * box.height - event.clientY);
        });
        const least = Math.min(...apart);
        return least <= NEAR ? apart.indexOf(least) : undefined;
    }

    /** What is under the pointer: a frame and its row, or a link. */
    private hover(event: MouseEvent): void {
        const box = this.element.getBoundingClientRect();
        const ray = this.ray(event);
        const rows = ray.intersectObjects(this.overlay.children, true);
        const row = rows.map((hit) => owner(hit.object, "row")).find((found) => found !== undefined) as number | undefined;
        const body = this.bodies[0];
        const link = body && ray.intersectObject(body.group, true).map((hit) => owner(hit.object, "link")).find((found) => found !== undefined);
        const ghost = row === undefined ? this.ghostUnder(ray) : undefined;
        for (const [at, { material }] of this.phantoms.entries()) {
            const opacity = at === ghost ? 3 * FAINT : FAINT;
            if (material.opacity === opacity) continue;
            material.opacity = opacity;
            this.draw();
        }
        const words = row !== undefined ? `frame ${this.rowNames[row] ?? row}` : ghost !== undefined ? (this.phantoms[ghost]?.words ?? "") : typeof link === "string" ? link : "";
        if (words !== this.hovered) {
            this.hovered = words;
            this.onrow(row ?? null);
            this.point(row === undefined && ghost === undefined && typeof link === "string" ? link : null);
        }
        this.pointer.textContent = words;
        this.pointer.hidden = words === "";
        // Beside the pointer, and inside of the view.
        const [x, y] = [event.clientX - box.left, event.clientY - box.top];
        const left = Math.max(0, Math.min(x + 14, box.width - this.pointer.offsetWidth - 2));
        const top = y + 14 + this.pointer.offsetHeight > box.height ? y - 14 - this.pointer.offsetHeight : y + 14;
        this.pointer.style.transform = `translate(${Math.round(left)}px, ${Math.round(top)}px)`;
    }

    /** Draws the frame of the link under the pointer, as the URDF has it. */
    private point(link: string | null): void {
        clear(this.pointed);
        const pose = link === null ? undefined : this.pose(0, link);
        if (pose) this.pointed.add(triad(pose, this.size * 0.14, 1));
        this.draw();
    }

    private unhover(): void {
        this.pointer.hidden = true;
        if (this.hovered) {
            this.onrow(null);
            this.point(null);
        }
        this.hovered = "";
        for (const { material } of this.phantoms) material.opacity = FAINT;
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
}

/** Whether an object and all that carry it are shown. */
function seen(object: Object3D | null): boolean {
    for (let at = object; at; at = at.parent) if (!at.visible) return false;
    return true;
}

function owner(object: Object3D | null, key: string): unknown {
    for (let at = object; at; at = at.parent) if (at.userData[key] !== undefined) return at.userData[key];
    return undefined;
}
