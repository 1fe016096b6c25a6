// Names in the 3-D view: each stands beside its point where there is room, the important ones first; where there is none it
// waits until its frame or its row is chosen.

import type { Camera, Vector3 } from "three";
import { Vector3 as Point } from "three";
import { h, svg } from "./dom";

export interface Label {
    at: Vector3;
    words: string;
    /** Additional to `tag`, for its style. */
    kind?: string;
    /** Always shown, before all others. */
    first?: boolean;
}

interface Placed extends Label {
    element: HTMLElement;
    width: number;
    height: number;
}

type Box = [left: number, top: number, right: number, bottom: number];

/** Space between a name and its point, and between names, in pixels. */
const GAP = 6;
const BETWEEN = 2;

export class Labels {
    readonly element = h("div", { class: "labels", "aria-hidden": "true" });
    private readonly layers = new Map<string, Placed[]>();

    /** Replaces the names of the layer. */
    set(layer: string, labels: Label[]): void {
        for (const { element } of this.layers.get(layer) ?? []) element.remove();
        const made = labels.map((label) => {
            const element = h("span", { class: `tag ${label.kind ?? ""}`.trim() }, label.words);
            return { ...label, element, width: 0, height: 0 };
        });
        this.layers.set(layer, made);
        this.element.append(...made.map(({ element }) => element));
    }

    /** Paints the names that are seen onto a picture of the view. */
    paint(ink: CanvasRenderingContext2D, view: HTMLElement): void {
        const from = view.getBoundingClientRect();
        for (const { element, words } of [...this.layers.values()].flat()) {
            if (element.hidden) continue;
            const [box, style] = [element.getBoundingClientRect(), getComputedStyle(element)];
            const [x, y] = [box.left - from.left, box.top - from.top];
            ink.fillStyle = style.backgroundColor;
            ink.fillRect(x, y, box.width, box.height);
            ink.fillStyle = style.color;
            ink.font = `${style.fontWeight} ${style.fontSize} ${style.fontFamily}`;
            ink.textBaseline = "middle";
            ink.fillText(words, x + Number.parseFloat(style.paddingLeft || "0"), y + box.height / 2);
        }
    }

    /** The names that are seen, as text of an SVG. */
    drawn(view: HTMLElement): SVGElement[] {
        const from = view.getBoundingClientRect();
        return [...this.layers.values()].flat().flatMap(({ element, words }) => {
            if (element.hidden) return [];
            const [box, style] = [element.getBoundingClientRect(), getComputedStyle(element)];
            const [x, y] = [box.left - from.left, box.top - from.top];
            return [
                svg("rect", { x, y, width: box.width, height: box.height, rx: 3, fill: style.backgroundColor }),
                svg("text", { x: x + Number.parseFloat(style.paddingLeft || "0"), y: y + box.height / 2, "dominant-baseline": "central", "font-family": "sans-serif", "font-size": style.fontSize, "font-weight": style.fontWeight, fill: style.color }, words),
            ];
        });
    }

    /** Puts every name where its point is seen and no other name is. */
    place(camera: Camera, width: number, height: number): void {
        const all = [...this.layers.values()].flat().sort((a, b) => Number(b.first ?? false) - Number(a.first ?? false));
        // Measured once, all together: reading a size between two changes lays the page out anew.
        for (const label of all) {
            if (label.width > 0) continue;
            label.element.hidden = false;
            [label.width, label.height] = [label.element.offsetWidth, label.element.offsetHeight];
        }
        const taken: Box[] = [];
        for (const label of all) {
            const seen = new Point().copy(label.at).project(camera);
            const [x, y] = [((seen.x + 1) / 2) * width, ((1 - seen.y) / 2) * height];
            const inSight = seen.z > -1 && seen.z < 1 && x > 0 && x < width && y > 0 && y < height;
            const places = inSight ? around(x, y, label.width, label.height) : [];
            const free = places.find((box) => inside(box, width, height) && !taken.some((other) => overlap(box, other)));
            const box = free ?? (label.first ? places[0] : undefined);
            label.element.hidden = box === undefined;
            if (!box) continue;
            taken.push(box);
            label.element.style.transform = `translate(${Math.round(box[0])}px, ${Math.round(box[1])}px)`;
        }
    }
}

/** Where a name can stand beside its point, the best first. */
function around(x: number, y: number, width: number, height: number): Box[] {
    const boxes: Box[] = [];
    for (const gap of [GAP, GAP * 3]) {
        const [right, left, below, above] = [x + gap, x - gap - width, y + gap, y - gap - height];
        const [middle, level] = [x - width / 2, y - height / 2];
        for (const [at, top] of [[right, below], [right, above], [left, below], [left, above], [right, level], [left, level], [middle, below], [middle, above]] as const) {
            boxes.push([at, top, at + width, top + height]);
        }
    }
    return boxes;
}

function inside([left, top, right, bottom]: Box, width: number, height: number): boolean {
    return left >= 0 && top >= 0 && right <= width && bottom <= height;
}

function overlap(a: Box, b: Box): boolean {
    return a[0] < b[2] + BETWEEN && b[0] < a[2] + BETWEEN && a[1] < b[3] + BETWEEN && b[1] < a[3] + BETWEEN;
}
