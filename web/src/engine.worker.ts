// Runs the engine beside the page: one question after the other.

interface Exports {
    memory: WebAssembly.Memory;
    allocate(length: number): number;
    release(at: number, length: number): void;
    ask(at: number, length: number): bigint;
}

type Incoming = { module: WebAssembly.Module } | { id: number; question: string };

let compiled: WebAssembly.Module | undefined;
let engine: Exports | undefined;
let complaint = "";
let asked = 0;

function started(): Exports {
    if (engine) return engine;
    if (!compiled) throw new Error("the engine has not arrived");
    const hear = (kind: number, at: number, length: number) => {
        const words = new TextDecoder().decode(new Uint8Array(made.memory.buffer, at, length));
        if (kind === 0) complaint = words;
        else postMessage({ id: asked, progress: words });
    };
    const made = new WebAssembly.Instance(compiled, { ...strangers(compiled), page: { hear } }).exports as unknown as Exports;
    engine = made;
    return made;
}

/** The reader of workbooks includes a writer of archives that could request random numbers; nothing here does, and none are provided. */
function strangers(module: WebAssembly.Module): WebAssembly.Imports {
    const all: WebAssembly.Imports = {};
    for (const { module: from, name, kind } of WebAssembly.Module.imports(module)) {
        if (from === "page" || kind !== "function") continue;
        (all[from] ??= {})[name] = () => { throw new Error(`the engine called ${name}`); };
    }
    return all;
}

function ask(question: string): string {
    const { memory, allocate, release, ask } = started();
    const bytes = new TextEncoder().encode(question);
    const at = allocate(bytes.length);
    new Uint8Array(memory.buffer, at, bytes.length).set(bytes);
    const answer = BigInt.asUintN(64, ask(at, bytes.length));
    const [from, length] = [Number(answer >> 32n), Number(answer & 0xffffffffn)];
    const text = new TextDecoder().decode(new Uint8Array(memory.buffer, from, length));
    release(from, length);
    return text;
}

onmessage = ({ data }: MessageEvent<Incoming>) => {
    if ("module" in data) {
        compiled = data.module;
        return;
    }
    asked = data.id;
    try {
        const before = performance.now();
        const answer = ask(data.question);
        const pages = engine ? engine.memory.buffer.byteLength : 0;
        postMessage({ id: data.id, answer, took: performance.now() - before, memory: pages });
        // Memory of one large question is released.
        if (pages > 256 << 20) engine = undefined;
    } catch (error) {
        // After a trap the state of its memory is unknown: the next question gets a new engine.
        engine = undefined;
        const why = complaint || (error instanceof RangeError ? "the file is nested too deeply" : String(error));
        complaint = "";
        postMessage({ id: data.id, answer: JSON.stringify({ error: `the engine stopped: ${why}` }), took: 0, memory: 0 });
    }
};
