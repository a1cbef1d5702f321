// Threads: where the browser lets Workers share memory, several of them draw, and the pictures are the same.
import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { after, test } from "node:test";
import { settled } from "./browser.mjs";
import { serve } from "./serve.mjs";
import { changed, dist, example, link, picture, rest, setup, SPHERE, write } from "./harness.mjs";

const state = setup();
/** The page's scripts, which find four cores on any machine. */
const scripts = Object.fromEntries(
    readdirSync(join(dist, "assets"))
        .filter((name) => name.endsWith(".js"))
        .map((name) => [`/assets/${name}`, readFileSync(join(dist, "assets", name), "utf8")])
        .filter(([, text]) => text.includes("navigator.hardwareConcurrency"))
        .map(([path, text]) => [path, text.replaceAll("navigator.hardwareConcurrency", "4")]),
);
const opened = [];
after(() => Promise.all(opened.map((it) => it.close())));

async function host(pages, isolated) {
    const server = await serve(dist, pages, { isolated });
    opened.push(server);
    return server;
}

async function open(url, options = {}) {
    const context = await state.browser.newContext({ viewport: { width: 1000, height: 640 }, colorScheme: "light", ...options });
    opened.push(context);
    const page = await context.newPage();
    page.failures = [];
    page.on("pageerror", (error) => page.failures.push(error.message));
    page.on("console", (message) => message.type() === "error" && page.failures.push(message.text()));
    await page.addInitScript(() => {
        window.channels = [];
        window.BroadcastChannel = class extends BroadcastChannel {
            constructor(name) {
                super(name);
                window.channels.push(name);
            }
        };
    });
    await page.goto(url);
    await settled(page);
    return page;
}

const threads = (page) => page.evaluate(() => Number(document.documentElement.dataset.threads));

async function digests(page) {
    await rest(page);
    const views = await page.locator(".view canvas").evaluateAll((all) => all.map((canvas) => canvas.closest(".view").dataset.view));
    return Promise.all(views.map(async (view) => `${view} ${(await picture(page, view)).digest}`));
}

test("from the second visit on threads draw the same pictures, without a network too", async () => {
    const server = await host(scripts, false);
    for (const file of ["torus.gtr", "trefoil.gtr", "cushion.gtr"]) {
        const page = await open(server.url + link(example(file), undefined, file));
        assert.equal(await threads(page), 1, "no host sends the headers of its own accord");
        const alone = await digests(page);
        await page.evaluate(async () => {
            const { active } = await navigator.serviceWorker.ready;
            while (active.state !== "activated") {
                await new Promise((resolve) => setTimeout(resolve, 50));
            }
        });
        for (const isOffline of [false, true]) {
            await page.context().setOffline(isOffline);
            await page.reload();
            await settled(page);
            assert.equal(await threads(page), 3, "a core is left to the browser");
            assert.deepEqual(await digests(page), alone, file);
        }
        assert.deepEqual(page.failures, []);
    }
});

test("a host that sends the headers gives threads at the first visit", async () => {
    const server = await host(scripts, true);
    const page = await open(server.url + link(SPHERE), { serviceWorkers: "block" });
    assert.equal(await threads(page), 3);
    assert.deepEqual(server.asked.filter((path) => path.includes("core_bg")), [], "the core without threads is not asked for");
    const before = await picture(page);
    await write(page, SPHERE.replace("r cos(v))", "2r cos(v))"));
    await changed(page, before);
});

test("a thread that fails takes the Worker with it, and another one is started", async () => {
    const server = await host(scripts, true);
    const page = await open(server.url + link(SPHERE), { serviceWorkers: "block" });
    const before = await rest(page);
    const [first] = await page.evaluate(() => window.channels);
    await page.evaluate((name) => new BroadcastChannel(name).postMessage("unreachable"), first);
    await page.locator(".toast.bad", { hasText: "was restarted" }).waitFor();
    await page.waitForFunction((name) => window.channels.some((other) => other !== name), first);
    assert.equal((await rest(page)).digest, before.digest);
});

test("threads that do not start are done without", async () => {
    const [script] = readdirSync(join(dist, "assets")).filter((name) => /^thread-.*\.js$/.test(name));
    const failing = { ...scripts, [`/assets/${script}`]: "throw new Error('no');" };
    const server = await host(failing, true);
    const page = await open(server.url + link(SPHERE), { serviceWorkers: "block" });
    assert.equal(await threads(page), 1);
});
