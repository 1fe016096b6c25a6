// A robot in the 3-D view: its links with their shapes, and joints that move them.

import { Box3, BoxGeometry, BufferGeometry, CapsuleGeometry, Color, CylinderGeometry, DoubleSide, Group, Matrix4, Mesh, MeshStandardMaterial, Object3D, Sphere, SphereGeometry, Vector3 } from "three";
import { COLOURS, rod, segment, triad } from "./drawn";
import type { Scene, SceneJoint, Shape } from "./engine";
import type { Dropped, Packages } from "./files";
import { found, parsed } from "./meshes";

/** What can be shown of a robot: its visual shapes, and what is drawn on demand. */
export type Layer = "visual" | "collision" | "inertia" | "mass" | "axes" | "frames";

/** Opacity of a phantom. */
export const FAINT = 0.13;
/** Poses whose numbers differ by less look the same. */
const SAME = 1e-4;

/** A robot in another posture, transparent; it shares the robot's shapes. */
export interface Phantom {
    group: Group;
    material: MeshStandardMaterial;
    move(value: (joint: number) => number): void;
}

export class Body {
    readonly group = new Group();
    /** Distance of the farthest link from the root with all joints at 0, m. */
    readonly size: number;
    /** Meshes that are not among the dropped files, or cannot be read. */
    readonly missing: string[] = [];
    private readonly shapes: Object3D[] = [];
    /** Replacement for links without shapes. */
    private readonly bones: Object3D[] = [];
    private readonly layers = new Map<Layer, Object3D[]>();
    /** Side by side in the group, each at its place in the root's frame: a tree of 4000 joints would be walked by recursion. */
    private readonly links: Group[];
    /** Joints from the root outwards. */
    private readonly outwards: number[];

    /** `other`: the second robot of a comparison, in a colour of its own and see-through. */
    constructor(readonly scene: Scene, private readonly meshes: Dropped, private readonly from: string, private readonly packages: Packages, private readonly other: boolean) {
        this.outwards = outwards(scene);
        const reached = new Set([scene.root, ...this.outwards.map((at) => scene.joints[at]?.child)]);
        this.links = scene.links.map((link, at) => {
            const made = new Group();
            made.userData["link"] = link.name;
            made.matrixAutoUpdate = false;
            if (reached.has(at)) this.group.add(made);
            return made;
        });
        this.place(() => null);
        const points = this.places();
        const root = points[scene.root] ?? new Vector3();
        const reach = points.reduce((most, point) => Math.max(most, point.distanceTo(root)), 0);
        const seenLinks = new Set<number>();
        for (const [index, link] of scene.links.entries()) {
            const seen = link.visuals.length > 0 ? link.visuals : link.collisions;
            for (const shape of seen) {
                const made = this.shape(shape);
                if (made) {
                    this.shapes.push(made);
                    this.links[index]?.add(made);
                    seenLinks.add(index);
                }
            }
        }
        // A robot with all links at one place has the size of its shapes; one without any still wants a size.
        this.group.updateMatrixWorld(true);
        const extent = seenLinks.size > 0 ? new Box3().setFromObject(this.group).getSize(new Vector3()).length() / 2 : 0;
        this.size = reach > 1e-6 ? reach : extent > 1e-6 ? extent : 0.5;
        this.skeleton(seenLinks);
        this.move(() => 0);
    }

    /** A ball around everything that is drawn, where the joints are; a shape far larger than the robot, such as a floor, does not count. */
    ball(): Sphere {
        const box = new Box3();
        for (const place of this.places()) box.expandByPoint(place);
        for (const link of this.links) {
            for (const part of link.children) {
                const own = new Box3().setFromObject(part);
                if (!own.isEmpty() && own.getSize(new Vector3()).length() < this.size * 6) box.union(own);
            }
        }
        return box.getBoundingSphere(new Sphere());
    }

    /** Where the links are, in the root's frame. */
    places(): Vector3[] {
        return this.links.map((link) => new Vector3().setFromMatrixPosition(link.matrixWorld));
    }

    /** root_from_link of a link by name. */
    pose(link: string): Matrix4 | undefined {
        return this.links[this.scene.links.findIndex((it) => it.name === link)]?.matrixWorld;
    }

    /** How many triangles are shown. */
    get triangles(): number {
        let count = 0;
        this.group.traverseVisible((object) => {
            if (!(object instanceof Mesh)) return;
            const form = object.geometry as BufferGeometry;
            count += (form.index?.count ?? form.getAttribute("position").count) / 3;
        });
        return count;
    }

    /** Lights up the shapes of a link, and of no other; null: of none. */
    light(link: string | null): void {
        for (const group of this.links) {
            const lit = group.userData["link"] === link;
            group.traverse((part) => {
                if (!(part instanceof Mesh && part.material instanceof MeshStandardMaterial)) return;
                const own = (part.userData["own"] ??= part.material.color.getHex()) as number;
                part.material.color.setHex(lit ? COLOURS.a : own);
            });
        }
    }

    /** Moves the joints; `value` gives the value of a driving joint, rad or m. */
    move(value: (joint: number) => number): void {
        this.stand(value, this.links, this.group);
    }

    /** The robot in another posture, see-through; the shapes are shared, and links that stand where the robot's own do are left out. */
    phantom(value: (joint: number) => number): Phantom {
        const material = new MeshStandardMaterial({ color: COLOURS.alpha, roughness: 0.9, transparent: true, opacity: FAINT, depthWrite: false, side: DoubleSide });
        const group = new Group();
        const drawn = new Set([...this.shapes, ...this.bones]);
        const links = this.links.map((link) => {
            const made = new Group();
            made.matrixAutoUpdate = false;
            for (const part of link.children) {
                if (!drawn.has(part)) continue;
                const copy = part.clone();
                copy.visible = true;
                made.add(copy);
            }
            if (link.parent) group.add(made);
            return made;
        });
        group.traverse((part) => {
            if (part instanceof Mesh) part.material = material;
        });
        const move = (value: (joint: number) => number) => {
            this.stand(value, links, group);
            for (const [at, link] of links.entries()) link.visible = this.apart(link.matrix, this.links[at]?.matrix) > SAME;
        };
        move(value);
        return { group, material, move };
    }

    /** The largest difference of two poses' numbers, lengths as shares of the robot's size. */
    private apart(one: Matrix4, other: Matrix4 = new Matrix4()): number {
        return Math.max(...one.elements.map((value, at) => Math.abs(value - (other.elements[at] ?? 0)) / (at < 12 ? 1 : this.size)));
    }

    private stand(value: (joint: number) => number, links: Group[], group: Group): void {
        this.place((joint) => {
            const q = joint.driver === null ? joint.offset : joint.scale * value(joint.driver) + joint.offset;
            const axis = new Vector3(...joint.axis);
            const motion = new Matrix4();
            if (joint.kind === "prismatic") motion.makeTranslation(axis.clone().multiplyScalar(q));
            else if (joint.kind === "revolute" || joint.kind === "continuous" || joint.pitch !== null) {
                motion.makeRotationAxis(axis, q);
                if (joint.pitch !== null) motion.setPosition(axis.clone().multiplyScalar(q * joint.pitch));
            }
            return motion;
        }, links, group);
    }

    /** Places every link; `motion` is what a joint adds to its origin. */
    private place(motion: (joint: SceneJoint) => Matrix4 | null, links = this.links, group = this.group): void {
        for (const at of this.outwards) {
            const joint = this.scene.joints[at];
            const [parent, child] = [links[joint?.parent ?? -1], links[joint?.child ?? -1]];
            if (!joint || !parent || !child) continue;
            child.matrix.multiplyMatrices(parent.matrix, new Matrix4().fromArray(joint.origin));
            const moved = motion(joint);
            if (moved) child.matrix.multiply(moved);
        }
        group.updateMatrixWorld(true);
    }

    /** Shows or hides what is drawn on demand beside the shapes; made when it is first asked for. */
    layer(name: Layer, shown: boolean): void {
        if (name === "visual") {
            for (const part of this.shapes) part.visible = shown;
            return;
        }
        let parts = this.layers.get(name);
        if (!parts) {
            if (!shown) return;
            parts = this.scene.links.flatMap((_, at) => this.drawn(name, at).map((part) => {
                this.links[at]?.add(part);
                return part;
            }));
            this.layers.set(name, parts);
            this.group.updateMatrixWorld(true);
        }
        for (const part of parts) part.visible = shown;
    }

    /** What a layer draws in a link's frame. */
    private drawn(name: Exclude<Layer, "visual">, at: number): Object3D[] {
        const link = this.scene.links[at];
        if (!link) return [];
        const { size } = this;
        if (name === "collision") {
            return link.collisions.flatMap((shape) => {
                const made = this.shape({ ...shape, colour: [0.9, 0.35, 0.1, 0.45] });
                return made ? [made] : [];
            });
        }
        if (name === "frames") return [triad(new Matrix4(), size * 0.07, 1)];
        if (name === "axes") {
            return this.scene.joints.filter((joint) => joint.child === at && joint.kind !== "fixed" && joint.kind !== "floating").map((joint) => {
                const axis = new Vector3(...joint.axis).multiplyScalar(size * 0.14);
                const made = rod(axis.clone().multiplyScalar(-0.4), axis, size * 0.006, joint.kind === "prismatic" ? COLOURS.a : COLOURS.z);
                (made.material as MeshStandardMaterial).depthTest = false;
                made.renderOrder = 2;
                return made;
            });
        }
        const matter = link.inertial;
        if (!matter || !(matter.mass > 0)) return [];
        const holder = new Group();
        holder.matrixAutoUpdate = false;
        holder.matrix.fromArray(matter.centre);
        const form = name === "mass" ? new SphereGeometry(size * 0.014, 24, 12) : matter.box && new BoxGeometry(...matter.box.map((edge) => Math.max(edge, size * 1e-4)) as [number, number, number]);
        if (!form) return [];
        const opacity = name === "mass" ? 1 : 0.35;
        const mesh = new Mesh(form, new MeshStandardMaterial({ color: name === "mass" ? COLOURS.alpha : COLOURS.y, roughness: 0.8, transparent: opacity < 1, opacity, depthTest: name !== "mass" }));
        mesh.userData["opacity"] = opacity;
        mesh.renderOrder = name === "mass" ? 2 : 0;
        holder.add(mesh);
        return [holder];
    }

    /** Makes the shapes see-through, so that what lies inside is seen. */
    ghost(opacity: number): void {
        this.group.traverse((object) => {
            if (!(object instanceof Mesh)) return;
            const material = object.material as MeshStandardMaterial;
            const own = (object.userData["opacity"] as number | undefined) ?? 1;
            material.opacity = own * opacity;
            material.transparent = material.opacity < 1;
            material.depthWrite = material.opacity > 0.5;
        });
    }

    /** Axes as rods and lines between them: a robot without shapes, or with some missing, is also visible. */
    private skeleton(seenLinks: Set<number>): void {
        const { size } = this;
        const bare = (link: number) => !seenLinks.has(link) && (seenLinks.size === 0 || this.missing.length > 0);
        const colour = this.other ? COLOURS.other : 0x7b8794;
        const bone = (link: Group | undefined, made: Mesh) => {
            link?.add(made);
            this.bones.push(made);
        };
        for (const joint of this.scene.joints) {
            const parent = this.links[joint.parent];
            const to = new Vector3().setFromMatrixPosition(new Matrix4().fromArray(joint.origin));
            if (to.length() > size * 1e-4) {
                if (bare(joint.parent)) bone(parent, rod(new Vector3(), to, size * 0.012, colour));
                else parent?.add(segment(new Vector3(), to, colour, 0.7));
            }
            if (bare(joint.child) && joint.kind !== "fixed") {
                const axis = new Vector3(...joint.axis).multiplyScalar(size * 0.045);
                bone(this.links[joint.child], rod(axis.clone().negate(), axis, size * 0.026, this.other ? COLOURS.other : 0x5b7fa6));
            }
        }
    }

    private shape(shape: Shape): Object3D | undefined {
        const geometry = shape.geometry;
        if (!geometry) return undefined;
        const [r, g, b, own] = shape.colour ?? [0.62, 0.67, 0.73, 1];
        const colour = this.other ? new Color(COLOURS.other) : new Color().setRGB(r, g, b);
        const opacity = this.other ? 0.45 : own;
        const made = (form: BufferGeometry) => {
            const material = new MeshStandardMaterial({ color: colour, roughness: 0.75, metalness: 0.05, side: DoubleSide, opacity, transparent: opacity < 1 });
            const mesh = new Mesh(form, material);
            mesh.userData["opacity"] = opacity;
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
            const object = this.mesh(geometry.mesh, made);
            if (!object) return undefined;
            object.scale.multiply(new Vector3(...geometry.scale));
            holder.add(object);
        }
        return holder;
    }

    private mesh(uri: string, made: (form: BufferGeometry) => Mesh): Object3D | undefined {
        const name = found(uri, this.meshes, this.from, this.packages);
        const bytes = name === undefined ? undefined : this.meshes.get(name);
        let object: Object3D | undefined;
        try {
            if (name !== undefined && bytes) object = parsed(name, bytes, made);
        } catch {
            // A damaged mesh counts as missing.
        }
        if (!object && !this.missing.includes(uri)) this.missing.push(uri);
        return object;
    }
}

/** The joints of a tree, each after the one that carries it. */
function outwards(scene: Scene): number[] {
    const at = new Map<number, number[]>();
    for (const [index, joint] of scene.joints.entries()) at.set(joint.parent, [...(at.get(joint.parent) ?? []), index]);
    const order: number[] = [];
    const open = [scene.root];
    const seen = new Set(open);
    for (let link = open.pop(); link !== undefined; link = open.pop()) {
        for (const index of at.get(link) ?? []) {
            const child = scene.joints[index]?.child;
            if (child === undefined || seen.has(child)) continue;
            seen.add(child);
            order.push(index);
            open.push(child);
        }
    }
    return order;
}
