// A robot in the 3-D view: its links with their shapes, and joints that move them.

import { Box3, BoxGeometry, BufferGeometry, CapsuleGeometry, Color, CylinderGeometry, DoubleSide, Group, Matrix4, Mesh, MeshStandardMaterial, Object3D, Sphere, SphereGeometry, Vector3 } from "three";
import { COLOURS, rod, segment } from "./drawn";
import type { Scene, Shape } from "./engine";
import type { Dropped } from "./files";
import { found, parsed } from "./meshes";

export class Body {
    readonly group = new Group();
    /** Distance of the farthest link from the root with all joints at 0, m. */
    readonly size: number;
    /** Meshes that are not among the dropped files, or cannot be read. */
    readonly missing: string[] = [];
    private readonly links: Group[];
    private readonly joints: Group[];

    /** `other`: the second robot of a comparison, in a colour of its own and see-through. */
    constructor(readonly scene: Scene, private readonly meshes: Dropped, private readonly from: string, private readonly other: boolean) {
        this.links = scene.links.map((link) => {
            const made = new Group();
            made.userData["link"] = link.name;
            return made;
        });
        this.joints = scene.joints.map((joint) => {
            const made = new Group();
            made.userData["joint"] = joint.name;
            made.matrixAutoUpdate = false;
            made.matrix.fromArray(joint.origin);
            const [parent, child] = [this.links[joint.parent], this.links[joint.child]];
            if (parent && child) {
                parent.add(made);
                made.add(child);
            }
            return made;
        });
        const root = this.links[scene.root];
        if (root) this.group.add(root);
        this.group.updateMatrixWorld(true);
        const points = this.places();
        const reach = Math.max(0, ...points.map((point) => point.distanceTo(points[scene.root] ?? new Vector3())));
        const seenLinks = new Set<number>();
        for (const [index, link] of scene.links.entries()) {
            const seen = link.visuals.length > 0 ? link.visuals : link.collisions;
            for (const shape of seen) {
                const made = this.shape(shape);
                if (made) {
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
                if (part.userData["joint"] !== undefined) continue;
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

    /** Moves the joints; `value` gives the value of a driving joint, rad or m. */
    move(value: (joint: number) => number): void {
        for (const [at, joint] of this.scene.joints.entries()) {
            const group = this.joints[at];
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
        this.group.updateMatrixWorld(true);
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

    /** Axes as rods and lines between them: a robot without shapes, or with those of some links missing, is seen, too. */
    private skeleton(seenLinks: Set<number>): void {
        const { size } = this;
        const bare = (link: number) => !seenLinks.has(link) && (seenLinks.size === 0 || this.missing.length > 0);
        const colour = this.other ? COLOURS.other : 0x7b8794;
        for (const [index, joint] of this.scene.joints.entries()) {
            const parent = this.links[joint.parent];
            const to = new Vector3().setFromMatrixPosition(new Matrix4().fromArray(joint.origin));
            if (to.length() > size * 1e-4) {
                if (bare(joint.parent)) parent?.add(rod(new Vector3(), to, size * 0.012, colour));
                else parent?.add(segment(new Vector3(), to, colour, 0.7));
            }
            if (bare(joint.child) && joint.kind !== "fixed") {
                const axis = new Vector3(...joint.axis).multiplyScalar(size * 0.045);
                this.joints[index]?.add(rod(axis.clone().negate(), axis, size * 0.026, this.other ? COLOURS.other : 0x5b7fa6));
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
        const name = found(uri, this.meshes, this.from);
        const bytes = name === undefined ? undefined : this.meshes.get(name);
        let object: Object3D | undefined;
        try {
            if (name !== undefined && bytes) object = parsed(name, bytes, made);
        } catch {
            // A damaged mesh is as good as none; it is named with those that are not there.
        }
        if (!object && !this.missing.includes(uri)) this.missing.push(uri);
        return object;
    }
}
