// A calibration's report on the page: errors of each stage, effects and how sure they are, what was tried, error curves.

import { h, number, svg } from "./dom";
import type { Calibrated } from "./engine";

export interface Effect {
    kind: string;
    joint?: string;
    where?: string;
    covariate?: string;
    driven_by?: string;
    delta_bic: number;
    probability: number;
    found_again: number;
    parameters: Record<string, { value: number; std: number; unit: string }>;
    ambiguous_with: { kind: string; joint: string; probability: number }[];
}

export interface Report {
    columns: { column: string; taken_for: string }[];
    stages: { name: string; train: Record<string, number>; test?: Record<string, number> }[];
    /** Sure enough to be named. */
    effects: Effect[];
    /** Corrected for, although another may act in their stead. */
    one_of?: Effect[];
    curves?: { joint: string; unit: string; rms: number; table: { at: number; value: number; std: number }[] }[];
    unexplained: { structured: boolean; p_value: number; where: { joint?: string; covariate?: string; share: number }[] };
    samples: { train: number; test: number };
}

export const plain = (kind: string) => kind.replaceAll("_", " ");

/** A probability that is nearly 1 is not written as if it were. */
const percent = (share: number) => (share > 0.995 ? "over 99 %" : `${Math.round(100 * share)} %`);

const place = (effect: Effect) =>
    `${plain(effect.kind)} at ${effect.joint ?? effect.where ?? ""}${effect.driven_by ? `, driven by ${effect.driven_by}` : ""}${effect.covariate ? `, with ${effect.covariate}` : ""}`;

const figures = (effect: Effect) =>
    Object.entries(effect.parameters).map(([word, it]) => `${word} ${it.value.toPrecision(4)} ± ${it.std.toPrecision(2)} ${it.unit === "1" ? "" : it.unit}`.trim()).join(", ");

/** Named effects, those that are one of several, and structure that has no name: each kind looks its own way. */
export function effects(report: Report, searched: boolean): HTMLElement {
    const open = report.one_of ?? [];
    const left = report.unexplained;
    const meter = (share: number) => h("meter", { min: 0, max: 1, value: share, "aria-label": `probability ${percent(share)}` });
    const named = report.effects.map((effect) => h("li", { class: "named" },
        h("b", {}, place(effect)), h("br", {}), figures(effect), h("br", {}),
        meter(effect.probability), ` probability ${percent(effect.probability)}, found again in ${Math.round(100 * effect.found_again)} % of resampled runs`,
        effect.ambiguous_with.length === 0 ? null : h("div", { class: "rivals" },
            `less likely in its stead: ${effect.ambiguous_with.map((rival) => `${plain(rival.kind)} at ${rival.joint} (${percent(rival.probability)})`).join(", ")}`)));
    const unsure = open.map((effect) => {
        const all = [{ words: place(effect), probability: effect.probability }, ...effect.ambiguous_with.map((rival) => ({ words: `${plain(rival.kind)} at ${rival.joint}`, probability: rival.probability }))];
        return h("li", { class: "open" }, h("i", {}, all.length > 1 ? "One of" : "Perhaps"),
            h("ul", {}, ...all.map((it) => h("li", {}, `${it.words} `, meter(it.probability), ` ${percent(it.probability)}`))),
            h("div", { class: "rivals" }, `corrected for as the first, not named: found again in ${Math.round(100 * effect.found_again)} % of resampled runs; ${figures(effect)}`));
    });
    const structure = left.structured ? h("li", { class: "unnamed", id: "unnamed" }, h("i", {}, "Structure without a name"), ` (p ${left.p_value.toPrecision(2)})`,
        h("div", { class: "rivals" }, `What remains follows ${left.where.map((it) => `${it.joint ?? it.covariate ?? "run order"} (${Math.round(100 * it.share)} %)`).join(", ")}; no effect of the catalogue explains it.`)) : null;
    const all = [...named, ...unsure, ...(structure ? [structure] : [])];
    return h("div", { id: "effects" }, h("h3", {}, "Effects"),
        named.length === 0 ? h("p", { id: "no-effects" }, !searched ? "Not searched for." : open.length > 0 ? "No effect is sure enough to be named." : "The data ask for no effect.") : null,
        all.length > 0 ? h("ul", { id: "effects-found", class: "effects" }, ...all) : null,
        left.structured ? null : h("p", {}, `What remains has no structure (p ${left.p_value.toPrecision(2)}).`));
}

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
    return h("div", { class: "scroll" }, h("table", { class: "heat", id: "tried" }, h("caption", {}, "By how much the best candidate of each kind at each place lowers the information criterion (ΔBIC)"),
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
