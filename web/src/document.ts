// The explorer's 3-D view in a page of `denavit doc`: laid over the page's own drawing of lines, and moved by its sliders.

import viewStyle from "./view.css?inline";
import { Vector3 } from "three";
import { h } from "./dom";
import type { Scene } from "./engine";
import { unpacked } from "./meshes";
import { placed, type TableFile } from "./table";
import { View } from "./view";

interface Solid {
    scene: Scene;
    chains: { coordinates: string[]; base: string; table: TableFile | null }[];
    meshes: Record<string, string>;
}

interface Posture {
    chain: number;
    q: Record<string, number>;
}

const SIDES: Record<string, Vector3> = {
    isometric: new Vector3(1, -1, 1), front: new Vector3(1, 0, 0), side: new Vector3(0, -1, 0), top: new Vector3(0, -1e-3, 1),
};

function begin(canvas: HTMLCanvasElement, solid: Solid): void {
    const view = new View();
    document.head.append(h("style", {}, viewStyle));
    canvas.before(view.element);
    view.element.setAttribute("aria-label", canvas.getAttribute("aria-label")?.replace("skeleton", "shape") ?? "3-D view");
    view.show(0, solid.scene, unpacked(solid.meshes));
    if (!view.works) {
        view.element.remove();
        return;
    }
    view.fit(SIDES["isometric"]);
    const names = solid.scene.joints.map((joint) => joint.name);
    const frames = document.getElementById("frames") as HTMLInputElement | null;
    const move = () => {
        const { chain, q } = JSON.parse(canvas.dataset["posture"] ?? "{}") as Posture;
        const value = (name: string) => q[name] ?? 0;
        view.move(0, (joint) => value(names[joint] ?? ""));
        const shown = solid.chains[chain];
        const rows = shown?.table && frames?.checked !== false ? placed(shown.table, value) : [];
        view.frames(rows, shown?.base ?? "", null);
    };
    const shapes = h("input", { type: "checkbox", id: "shapes", checked: true, change: () => choose() });
    const choose = () => {
        canvas.hidden = shapes.checked;
        view.element.hidden = !shapes.checked;
        if (shapes.checked) move();
    };
    document.getElementById("buttons")?.append(h("label", { class: "check" }, shapes, " shapes"));
    document.getElementById("buttons")?.addEventListener("click", (event) => {
        const side = SIDES[(event.target as HTMLElement).dataset["view"] ?? ""];
        if (side) view.fit(side);
    });
    frames?.addEventListener("change", move);
    canvas.addEventListener("posture", move);
    choose();
    Object.assign(window, { denavit: { view } });
}

const canvas = document.getElementById("view");
const text = document.getElementById("solid")?.textContent;
if (canvas instanceof HTMLCanvasElement && text) begin(canvas, JSON.parse(text) as Solid);
