// Puts script, style and engine into one page: dist/explorer.html. The page asks the network for nothing, and its
// Content-Security-Policy allows no script but its own.
import { createHash } from "node:crypto";
import { readFileSync, readdirSync, writeFileSync } from "node:fs";
import { gzipSync } from "node:zlib";

const parts = new URL("./dist/parts/", import.meta.url);
const assets = readdirSync(new URL("assets/", parts));
const asset = (end) => {
    const found = assets.filter((name) => name.endsWith(end));
    if (found.length !== 1) throw new Error(`one ${end} is wanted in dist/parts/assets, found ${found.length}`);
    return readFileSync(new URL(`assets/${found[0]}`, parts), "utf8");
};
// A closing tag in a string would end the element.
const element = (text) => text.replaceAll("</script", "<\\/script").replaceAll("<!--", "<\\!--");
const script = element(asset(".js"));
const style = asset(".css").replaceAll("</style", "<\\/style");
const hash = (text) => `'sha256-${createHash("sha256").update(text).digest("base64")}'`;
const policy = [
    "default-src 'none'",
    `script-src ${hash(script)} 'wasm-unsafe-eval'`,
    `style-src ${hash(style)}`,
    "style-src-attr 'unsafe-inline'",
    "img-src data: blob:",
    "worker-src blob:",
    "base-uri 'none'",
    "form-action 'none'",
].join("; ");
// Time and name stay out of the header, so that the same engine makes the same bytes.
const engine = gzipSync(stripped(readFileSync(process.argv[2])), { level: 9 });
engine.fill(0, 4, 8);
const body = readFileSync(new URL("index.html", parts), "utf8")
    .replace(/<script[^>]*src=[^>]*><\/script>\s*/g, "")
    .replace(/<link[^>]*rel="stylesheet"[^>]*>\s*/g, "")
    .replace("<!-- policy -->", () => `<meta http-equiv="Content-Security-Policy" content="${policy}">`)
    .replace("<!-- style -->", () => `<style>${style}</style>`)
    .replace("<!-- engine -->", () => `<script type="application/octet-stream" id="engine">${engine.toString("base64")}</script>`)
    .replace("<!-- script -->", () => `<script type="module">${script}</script>`);
writeFileSync(new URL("./dist/explorer.html", import.meta.url), body);
const view = element(readFileSync(new URL("./dist/view/view.js", import.meta.url), "utf8"));
writeFileSync(new URL("./dist/view.js", import.meta.url), view);
const kib = (bytes) => `${Math.round(bytes / 1024)} KiB`;
console.log(`engine ${kib(engine.length)} gzipped, script ${kib(gzipSync(script).length)} gzipped, page ${kib(body.length)}, view alone ${kib(view.length)}`);

/** A module without its custom sections: names of functions and the like, which only a debugger reads. */
function stripped(wasm) {
    const kept = [wasm.subarray(0, 8)];
    let at = 8;
    while (at < wasm.length) {
        const from = at;
        const kind = wasm[at++];
        let [size, shift] = [0, 0];
        for (;;) {
            const byte = wasm[at++];
            size += (byte & 0x7f) * 2 ** shift;
            shift += 7;
            if (byte < 0x80) break;
        }
        at += size;
        if (kind !== 0) kept.push(wasm.subarray(from, at));
    }
    return Buffer.concat(kept);
}
