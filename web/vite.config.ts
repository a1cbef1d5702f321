// How the page is bundled: `npm run bundle` writes `dist`, a folder of static files for any place of any server.
//
// What package.json names, and why:
//   @codemirror/…     the editor: an editor that works with screen readers, on phones and with all keyboards is years of
//                     work. Only the parts that are used are listed; none of them knows a language.
//   vite              the bundler: it follows `new Worker(new URL(…))` and `?url`, splits what the page and the element
//                     for other pages share, and names files by their content.
//   typescript        checks the types; vite only strips them.
//   @types/node       the types of this file and of the tests.
//   playwright-core   drives the tests' browser, which is Debian's.

import { createHash } from "node:crypto";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { defineConfig, type Plugin, transformWithOxc } from "vite";

const here = import.meta.dirname;

/** The files of the core with threads, which are not fetched before they are used. */
const isThreaded = (file: string) => file.startsWith("assets/thread");

/** Writes `sw.js` with the lists of all other files. */
function serviceWorker(): Plugin {
    return {
        name: "geotrace-service-worker",
        apply: "build",
        enforce: "post",
        async generateBundle(_options, bundle) {
            const others = ["geotrace-view.js", "panel.js"];
            const files = Object.keys(bundle).filter((file) => !others.includes(file));
            const fixed = ["manifest.webmanifest", "icon.png"];
            const digest = createHash("sha256");
            for (const file of [...files].sort()) {
                const part = bundle[file]!;
                digest.update(file).update(part.type === "chunk" ? part.code : part.source);
            }
            const source = readFileSync(join(here, "src/sw.ts"), "utf8");
            const { code } = await transformWithOxc(source, "sw.ts");
            const list = (name: string, files: string[]) => `const ${name} = ${JSON.stringify(files.map((file) => `./${file}`))};\n`;
            const first = list("FILES", [...files.filter((file) => !isThreaded(file)), ...fixed]);
            const later = list("LATER", files.filter(isThreaded));
            const version = `const VERSION = "${digest.digest("hex").slice(0, 16)}";\n`;
            this.emitFile({ type: "asset", fileName: "sw.js", source: first + later + version + code });
        },
    };
}

export default defineConfig({
    root: here,
    // Addresses are relative, so that the folder can lie anywhere.
    base: "./",
    plugins: [serviceWorker()],
    worker: { format: "es" },
    server: { fs: { allow: [".."] } },
    build: {
        outDir: "dist",
        // The first with popovers, which the menus are.
        target: ["chrome114", "firefox125", "safari17"],
        assetsInlineLimit: 0,
        modulePreload: { polyfill: false },
        rolldownOptions: {
            input: { page: join(here, "index.html"), "geotrace-view": join(here, "src/embed.ts"), panel: join(here, "src/panel.ts") },
            output: {
                // Others name the scripts of the element and of the preview inside VS Code, so these have no hash.
                entryFileNames: (chunk) => (chunk.name === "page" ? "assets/[name]-[hash].js" : "[name].js"),
            },
        },
    },
});
