// How fast the page is, in a real browser:
//
//   node web/tests/page/bench.mjs [EXAMPLE…]
//
// It prints the time from an empty profile to the first picture, the time from a key in the editor to both pictures at
// 400 × 400 pixels, and for each example the pictures a second while one walks in the geodesic view (turns in the 3D view,
// where there is no other). Pictures are counted with the frame that shows them. As from a reader's second visit on, threads draw
// where the machine has more than two cores.
import { readFileSync, readdirSync } from "node:fs";
import { join } from "node:path";
import { deflateRawSync } from "node:zlib";
import { launch, settled } from "./browser.mjs";
import { serve } from "./serve.mjs";

const SECONDS = 2;
const folder = join(import.meta.dirname, "../../../examples");
const link = (name, text) => `#1.${deflateRawSync(Buffer.from(JSON.stringify({ name, text }))).toString("base64url")}`;
const median = (list) => [...list].sort((a, b) => a - b)[Math.floor(list.length / 2)];
const server = await serve(join(import.meta.dirname, "../../dist"), {}, { isolated: true });
const browser = await launch();

/** Opens a program; the panes have 400 × 400 pixels each. */
async function open(hash) {
    const context = await browser.newContext({ viewport: { width: 1440, height: 900 }, serviceWorkers: "block" });
    const page = await context.newPage();
    await page.addInitScript(() => {
        window.pictures = [];
        addEventListener("picture", ({ detail: { view, version } }) => requestAnimationFrame(() => window.pictures.push({ view, version, at: performance.now() })), true);
        addEventListener("DOMContentLoaded", () => {
            const style = document.createElement("style");
            style.textContent = ".grid { display: flex !important; flex-wrap: wrap } .view { width: 402px; height: 402px; flex: none; border-width: 1px !important }";
            document.head.append(style);
        });
    });
    await page.goto(server.url + hash);
    await settled(page);
    return page;
}

const torus = readFileSync(join(folder, "torus.gtr"), "utf8");
const loads = [];
for (let k = 0; k < 5; k += 1) {
    const page = await open(link("torus.gtr", torus));
    loads.push(await page.evaluate(() => window.pictures[0].at));
    await page.context().close();
}
console.log(`load, cold, to the first picture: ${median(loads).toFixed(0)} ms (${loads.map((it) => it.toFixed(0)).join(", ")})`);

const page = await open(link("torus.gtr", torus));
console.log(`threads: ${await page.evaluate(() => document.documentElement.dataset.threads)}`);
await page.locator(".cm-line").nth(1).click();
await page.keyboard.press("Home");
for (let k = 0; k < "param r : [0.4".length; k += 1) {
    await page.keyboard.press("ArrowRight");
}
const keys = [];
for (let k = 0; k < 12; k += 1) {
    await page.waitForTimeout(400);
    await settled(page);
    await page.evaluate(() => {
        window.pictures = [];
        addEventListener("keydown", (event) => (window.pressed = event.timeStamp), { capture: true, once: true });
    });
    await page.keyboard.press(k % 2 === 0 ? "5" : "Backspace");
    await page.waitForFunction(() => new Set(window.pictures.map((it) => it.view)).size === 2);
    keys.push(
        await page.evaluate(() => {
            const last = Math.max(...window.pictures.map((it) => it.version));
            const first = (view) => window.pictures.find((it) => it.view === view && it.version === last).at;
            return Math.max(first("3d"), first("geodesic:s")) - window.pressed;
        }),
    );
}
console.log(`key to both pictures, 400 × 400: ${median(keys).toFixed(1)} ms (${keys.map((it) => it.toFixed(0)).join(", ")})`);
await page.context().close();

const wanted = process.argv.slice(2);
for (const file of readdirSync(folder).sort()) {
    if (wanted.length > 0 && !wanted.some((name) => file.startsWith(name))) {
        continue;
    }
    const page = await open(link(file, readFileSync(join(folder, file), "utf8")));
    const inside = page.locator('.view[data-view^="geodesic:"] canvas').first();
    const canvas = (await inside.count()) > 0 ? inside : page.locator(".view canvas").first();
    await canvas.focus();
    await page.evaluate(() => (window.pictures = []));
    const [key, what] = (await inside.count()) > 0 ? ["w", "walks"] : ["ArrowLeft", "turns"];
    await page.keyboard.down(key);
    await page.waitForTimeout(SECONDS * 1000);
    await page.keyboard.up(key);
    const view = await canvas.evaluate((element) => element.parentElement.dataset.view);
    const times = await page.evaluate((id) => window.pictures.filter((it) => it.view === id).map((it) => it.at), view);
    const rate = times.length < 2 ? 0 : (1000 * (times.length - 1)) / (times.at(-1) - times[0]);
    console.log(`${file}: ${rate.toFixed(0)} pictures a second while it ${what} in ${view}`);
    await page.context().close();
}
await browser.close();
await server.close();
