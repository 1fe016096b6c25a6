// Named postures of an SRDF: values of joints by their names, rad and m.

export interface Posture {
    name: string;
    group: string;
    values: Map<string, number>;
}

/** Every `group_state` of an SRDF; joints with several values, such as floating ones, are left out. */
export function postures(file: string, text: string): Posture[] {
    const document = new DOMParser().parseFromString(text, "application/xml");
    const broken = document.querySelector("parsererror");
    if (broken) throw new Error(`${file}: not well-formed XML, so its postures cannot be read`);
    return [...document.querySelectorAll("robot > group_state")].map((state) => {
        const values = new Map<string, number>();
        for (const joint of state.querySelectorAll("joint")) {
            const written = (joint.getAttribute("value") ?? "").trim();
            const value = written === "" ? Number.NaN : Number(written);
            if (Number.isFinite(value)) values.set(joint.getAttribute("name") ?? "", value);
        }
        return { name: state.getAttribute("name") ?? "", group: state.getAttribute("group") ?? "", values };
    });
}
