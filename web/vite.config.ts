import { defineConfig } from "vite";

// One script and one style sheet, which assemble.mjs puts into the page together with the engine.
export default defineConfig({
    base: "./",
    build: {
        outDir: "dist/parts",
        target: "es2022",
        assetsInlineLimit: 1 << 20,
        modulePreload: false,
        chunkSizeWarningLimit: 2000,
        cssCodeSplit: false,
    },
    worker: { format: "iife" },
});
