// A calibration's report on the page: errors of each stage, effects and their certainty, tried effects, error curves.

import { h, number, svg } from "./dom";
import type { Calibrated } from "./engine";

/** What was found, in the engine's words. */
export interface Said {
    heading: string;
    effects: { said: { title: string; named: boolean; numbers: string[]; why: string; rivals: string | null }; probability: number }[];
    structured: boolean;
    ending: string;
}

export interface Report {
    columns: { column: string; taken_for: string }[];
    stages: { name: string; train: Record<string, number>; test?: Record<string, number> }[];
    curves?: { joint: string; unit: string; rms: number; table: { at: number; value: number; std: number }[] }[];
    samples: { train: number; test: number };
}

export const plain = (kind: string) => kind.replaceAll("_", " ");

/** Named effects, those that are one of several, and unexplained structure: each kind has its own style. */
export function effects(found: Said | null): HTMLElement {
    const heading = h("h3", {}, "Effects");
    if (!found) return h("div", { id: "effects" }, heading, h("p", {}, "Not searched."));
    const list = found.effects.map(({ said, probability }) => h("li", { class: said.named ? "named" : "open" },
        h("b", {}, said.title), ...said.numbers.flatMap((words) => [h("br", {}), words]), h("br", {}),
        h("meter", { min: 0, max: 1, value: probability, "aria-label": "probability" }), h("div", { class: "rivals" }, said.rivals === null ? said.why : `${said.why}; ${said.rivals}`)));
    if (found.structured) list.push(h("li", { class: "unnamed", id: "unnamed" }, found.ending));
    return h("div", { id: "effects" }, heading, h("p", { id: "effects-heading" }, sentence(found.heading)),
        list.length > 0 ? h("ul", { id: "effects-found", class: "effects" }, ...list) : null,
        found.structured ? null : h("p", {}, sentence(found.ending)));
}

const sentence = (words: string) => `${words.charAt(0).toUpperCase()}${words.slice(1)}`;

/** Errors after each stage, of the rows fitted and of those held out. */
export function bars(report: Report, key: string): HTMLElement {
    const most = Math.max(...report.stages.flatMap((stage) => [stage.train[key] ?? 0, stage.test?.[key] ?? 0]), 1e-12);
    const bar = (value: number | undefined, kind: string) => value === undefined ? null
        : h("span", { class: `bar ${kind}` }, h("span", { class: "fill", style: `width:${(100 * value) / most}%` }), h("span", { class: "figure" }, `${number(value * 1000, 4)} mm`));
    return h("div", { class: "bars", id: "stages" }, h("h3", {}, "Error after each stage, rms"),
        ...report.stages.map((stage) => h("div", { class: "stage" }, h("span", { class: "name" }, stage.name), bar(stage.train[key], "train"), bar(stage.test?.[key], "test"))),
        h("p", { class: "fine" }, h("span", { class: "key train" }, "rows fitted"), report.samples.test > 0 ? h("span", { class: "key test" }, "rows held out") : null));
}

/** The first pass of the search: kinds by places. */
export function heat(all: Calibrated["tried"]): HTMLElement {
    const tried = all.flatMap(({ kind, place, delta_bic }) => (delta_bic === null ? [] : [{ kind, place, delta_bic }]));
    const kinds = [...new Set(tried.map((cell) => cell.kind))];
    const places = [...new Set(tried.map((cell) => cell.place))];
    const most = Math.max(...tried.map((cell) => cell.delta_bic), 1);
    const cellOf = (kind: string, place: string) => {
        const cell = tried.find((it) => it.kind === kind && it.place === place);
        if (!cell) return h("td", {});
        const share = Math.round(Math.max(0, cell.delta_bic / most) * 100);
        return h("td", { class: share > 55 ? "hot number" : "number", style: `background:color-mix(in srgb, var(--heat) ${share}%, transparent)`, title: `${plain(kind)} at ${place}: ΔBIC ${number(cell.delta_bic, 1)}` }, String(Math.round(cell.delta_bic)));
    };
    return h("div", { class: "scroll" }, h("table", { class: "heat", id: "tried" }, h("caption", {}, "Decrease of the information criterion (ΔBIC) by the best candidate of each kind at each place"),
        h("thead", {}, h("tr", {}, h("td", {}), ...places.map((place) => h("th", { scope: "col" }, h("span", {}, place))))),
        h("tbody", {}, ...kinds.map((kind) => h("tr", {}, h("th", { scope: "row" }, plain(kind)), ...places.map((place) => cellOf(kind, place)))))));
}

export function curve(entry: NonNullable<Report["curves"]>[number]): HTMLElement {
    const [width, height] = [320, 90];
    const at = entry.table.map((point) => point.at);
    const [low, high] = [Math.min(...at), Math.max(...at)];
    const most = Math.max(...entry.table.map((point) => Math.abs(point.value) + point.std), 1e-12);
    const x = (value: number) => number(((value - low) / Math.max(1e-12, high - low)) * width, 2);
    const y = (value: number) => number(height / 2 - (value / most) * (height / 2 - 4), 2);
    const line = entry.table.map((point) => `${x(point.at)},${y(point.value)}`).join(" ");
    const band = [...entry.table.map((point) => `${x(point.at)},${y(point.value + point.std)}`), ...[...entry.table].reverse().map((point) => `${x(point.at)},${y(point.value - point.std)}`)].join(" ");
    const words = `${entry.joint}: ${entry.unit === "m" ? `${number(entry.rms * 1e3, 4)} mm` : `${number(entry.rms * 1e3, 3)} mrad`} rms`;
    return h("figure", {}, svg("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": words, class: "curve" },
        svg("line", { x1: 0, x2: width, y1: height / 2, y2: height / 2, class: "axis" }),
        svg("polygon", { points: band, class: "band" }), svg("polyline", { points: line, class: "line" })) as unknown as Node, h("figcaption", {}, words));
}
