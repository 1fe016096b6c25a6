// Writes dist/site: a folder for any static host, or a disk, with the page, the robots of robots/ in it, and a gallery of links to them.
import { createHash } from "node:crypto";
import { mkdirSync, readFileSync, readdirSync, writeFileSync } from "node:fs";

const robots = new URL("../robots/", import.meta.url);
const site = new URL("./dist/site/", import.meta.url);
const folders = readdirSync(robots, { withFileTypes: true }).filter((it) => it.isDirectory()).map(({ name }) => name).sort();
const all = folders.flatMap((maker) => readdirSync(new URL(`${maker}/`, robots)).filter((name) => name.endsWith(".urdf")).sort().map((name) => {
    const text = readFileSync(new URL(`${maker}/${name}`, robots), "utf8");
    return { maker, file: `${maker}/${name}`, text, robot: /<robot[^>]*\sname="([^"]*)"/.exec(text)?.[1] ?? name, moving: [...text.matchAll(/<joint\s[^>]*type="(\w+)"/g)].filter(([, kind]) => kind !== "fixed").length };
}));

const page = readFileSync(new URL("./dist/explorer.html", import.meta.url), "utf8");
const place = '<script type="application/json" id="robots">[]</script>';
if (!page.includes(place)) throw new Error("dist/explorer.html has no place for robots; run web/build");
// No text of a robot can end the element that holds it.
const embedded = JSON.stringify(all.map(({ file, text }) => ({ file, text }))).replaceAll("<", "\\u003c");
mkdirSync(site, { recursive: true });
writeFileSync(new URL("explorer.html", site), page.replace(place, () => place.replace("[]", () => embedded)));

const text = (words) => words.replaceAll("&", "&amp;").replaceAll("<", "&lt;").replaceAll('"', "&quot;");
const style = `:root{color-scheme:light dark;font:16px/1.5 system-ui,sans-serif}body{max-width:60rem;margin:2rem auto;padding:0 1rem}
ul{list-style:none;padding:0;display:grid;grid-template-columns:repeat(auto-fill,minmax(15rem,1fr));gap:.75rem}
a{display:block;padding:.75rem 1rem;border:1px solid color-mix(in srgb,currentColor 25%,transparent);border-radius:8px;color:inherit;text-decoration:none;overflow-wrap:anywhere}
p a{display:inline;border:0;padding:0;text-decoration:underline}a:hover,a:focus-visible{border-color:LinkText;color:LinkText}small{display:block;opacity:.75}`;
const policy = `default-src 'none'; style-src 'sha256-${createHash("sha256").update(style).digest("base64")}'; base-uri 'none'; form-action 'none'`;
const item = ({ file, robot, maker, moving }) => `<li><a href="explorer.html#robot=${encodeURIComponent(file)}"><b>${text(robot)}</b><small>${text(maker.replaceAll("_", " "))}, ${moving} moving joints</small></a></li>`;
writeFileSync(new URL("index.html", site), `<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta http-equiv="Content-Security-Policy" content="${policy}">
<meta name="referrer" content="no-referrer">
<title>Robots in denavit</title>
<style>${style}</style>
</head>
<body>
<h1>Robots</h1>
<p>Tables, frames, comparison and calibration of each in the explorer; nothing is sent anywhere. <a href="explorer.html#open">Open a robot of your own</a></p>
<ul>
${all.map(item).join("\n")}
</ul>
</body>
</html>
`);
console.log(`dist/site: ${all.length} robots`);
