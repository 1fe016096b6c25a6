import { defineConfig } from "vite";

// The 3-D view alone, as one script for pages of `denavit doc`.
export default defineConfig({
    build: {
        outDir: "dist/view",
        target: "es2022",
        chunkSizeWarningLimit: 2000,
        lib: { entry: "src/document.ts", formats: ["iife"], name: "denavitView", fileName: () => "view.js" },
    },
});
