// Elements from names and texts. Text is always text: a robot's names never become markup.

type Child = Node | string | null | undefined;
type Attributes = Record<string, string | number | boolean | ((event: Event) => void) | null | undefined>;

export function h<K extends keyof HTMLElementTagNameMap>(tag: K, attributes: Attributes = {}, ...children: Child[]): HTMLElementTagNameMap[K] {
    const element = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes)) {
        if (value === null || value === undefined || value === false) continue;
        if (typeof value === "function") element.addEventListener(name, value);
        else element.setAttribute(name, value === true ? "" : String(value));
    }
    for (const child of children) if (child !== null && child !== undefined) element.append(child);
    return element;
}

export function svg(tag: string, attributes: Record<string, string | number>, ...children: (Node | string)[]): SVGElement {
    const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
    for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, String(value));
    element.append(...children);
    return element;
}

export function select(label: string, choices: [value: string, words: string][], chosen: string, change: (value: string) => void, id?: string, name?: string): HTMLLabelElement {
    const options = choices.map(([value, words]) => h("option", { value, selected: value === chosen }, words));
    const element: HTMLSelectElement = h("select", { id, "aria-label": name, change: () => {
        told();
        change(element.value);
    } }, ...options);
    // A box may be narrower than the name in it.
    const told = () => { element.title = element.selectedOptions[0]?.textContent ?? ""; };
    told();
    return h("label", { class: "choice" }, label ? h("span", {}, label) : null, element);
}

export function save(name: string, text: string | Blob, kind = "text/plain"): void {
    const address = URL.createObjectURL(new Blob([text], { type: kind }));
    h("a", { href: address, download: name }).click();
    setTimeout(() => URL.revokeObjectURL(address), 10_000);
}

export async function copy(text: string): Promise<void> {
    try {
        await navigator.clipboard.writeText(text);
    } catch {
        // Pages from disk have no clipboard in some browsers.
        const area = h("textarea", { "aria-hidden": "true" });
        area.value = text;
        document.body.append(area);
        area.select();
        document.execCommand("copy");
        area.remove();
    }
}

export function stem(file: string): string {
    const name = file.split("/").pop() ?? file;
    return name.split(".")[0] || "robot";
}

export const number = (value: number, digits = 4): string => {
    const text = value.toFixed(digits).replace(/\.?0+$/, "");
    return text === "-0" ? "0" : text;
};

/** Replaces the children. */
export function fill(element: HTMLElement, ...children: Child[]): void {
    element.replaceChildren(...children.filter((child) => child !== null && child !== undefined));
}
