// What may go wrong: no network, another screen, a program that is too much, a Worker that dies.
import assert from "node:assert/strict";
import { cpSync, mkdtempSync, readdirSync, readFileSync, rmSync, statSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { test } from "node:test";
import { brotliCompressSync, gzipSync } from "node:zlib";
import { settled } from "./browser.mjs";
import { serve } from "./serve.mjs";
import { assertAlike, changed, dist, dropImage, hideCameras, link, middle, picture, rest, setup, SPHERE, text, write } from "./harness.mjs";

const state = setup();
const files = (folder) =>
    readdirSync(folder).flatMap((name) => {
        const path = join(folder, name);
        return statSync(path).isDirectory() ? files(path) : [path];
    });

test("the whole page is at most two megabytes, compressed with brotli", (context) => {
    // A browser loads the core with threads or the one without.
    const all = files(dist);
    for (const [kind, left] of [["with threads", /core_bg/], ["without threads", /thread/]]) {
        const loaded = all.filter((file) => !left.test(file));
        assert.ok(loaded.length < all.length);
        atMostTwoMegabytes(context, kind, loaded);
    }
});

function atMostTwoMegabytes(context, kind, files) {
    // An image is not sent in a form that is longer than itself.
    const sum = (compressed) =>
        files
            .map((file) => readFileSync(file))
            .reduce((total, content) => total + Math.min(content.length, compressed(content).length), 0);
    const [brotli, gzip] = [sum((content) => brotliCompressSync(content)), sum((content) => gzipSync(content, { level: 9 }))];
    context.diagnostic(`${kind}: ${brotli} bytes with brotli, ${gzip} with gzip`);
    assert.ok(brotli <= 2 << 20, `${kind}: ${brotli} bytes`);
}

test("the page works without a network once it was loaded", async () => {
    const page = await state.open(link(SPHERE));
    const before = await picture(page);
    await page.evaluate(async () => {
        const { active } = await navigator.serviceWorker.ready;
        while (active.state !== "activated") {
            await new Promise((resolve) => setTimeout(resolve, 50));
        }
    });
    await page.context().setOffline(true);
    await page.reload();
    await settled(page);
    assert.equal((await picture(page)).digest, before.digest);
    await page.getByRole("button", { name: "Examples" }).first().click();
    await page.locator(".card").nth(12).scrollIntoViewIfNeeded();
    await page.waitForFunction(() => document.querySelectorAll(".card img")[12].naturalWidth > 0);
    await page.context().setOffline(false);
    await state.close(page);
});

test("a new version is offered, and takes the place of the old one", async () => {
    const folder = mkdtempSync(join(tmpdir(), "geotrace-page-"));
    cpSync(dist, folder, { recursive: true });
    const server = await serve(folder);
    const context = await state.browser.newContext();
    const page = await context.newPage();
    await page.goto(server.url);
    await settled(page);
    await page.evaluate(() => navigator.serviceWorker.ready);
    await page.reload();
    const script = join(folder, "sw.js");
    writeFileSync(script, readFileSync(script, "utf8").replace(/VERSION = "\w+"/, 'VERSION = "next"'));
    writeFileSync(join(folder, "index.html"), readFileSync(join(folder, "index.html"), "utf8").replace("<title>", "<title>Next "));
    await page.reload();
    assert.doesNotMatch(await page.content(), /Next/, "the old version stays until the reader says so");
    await page.locator(".toast", { hasText: "newer version" }).getByRole("button", { name: "Reload" }).click();
    await page.waitForFunction(async () => (await caches.keys()).join() === "geotrace-/-next");
    await settled(page);
    assert.match(await (await fetch(server.url)).text(), /Next/);
    const shown = await page.evaluate(async () => (await fetch("./")).text());
    assert.match(shown, /Next/);
    await context.close();
    await server.close();
    rmSync(folder, { recursive: true });
});

test("notices are heard and closed, also where a dialog is open", async () => {
    const page = await state.open(link(SPHERE));
    // Screen readers pass over a place for notices that comes with its first notice.
    assert.equal(await page.locator("[role=status].notices").count(), 1);
    await page.getByRole("button", { name: "Help" }).click();
    await page.evaluate(() => (location.hash = "#hello"));
    const notice = page.locator(".toast", { hasText: "does not contain" });
    await notice.getByRole("button", { name: "Close" }).click({ timeout: 5000 });
    await notice.waitFor({ state: "detached" });
    await page.evaluate(() => (location.hash = "#again"));
    await page.keyboard.press("Escape");
    await notice.getByRole("button", { name: "Close" }).click({ timeout: 5000 });
    await state.close(page);
});

test("a key that is held saves once, and opens one dialog", async () => {
    const page = await state.open(link(SPHERE));
    let downloads = 0;
    page.on("download", () => (downloads += 1));
    await page.keyboard.down("Control");
    for (let k = 0; k < 4; k += 1) {
        await page.keyboard.down("s");
    }
    await page.keyboard.up("s");
    await page.keyboard.up("Control");
    await page.keyboard.press("F1");
    await page.keyboard.press("F1");
    assert.equal(await page.locator("dialog[open]").count(), 1);
    await page.keyboard.press("Escape");
    await page.waitForTimeout(500);
    assert.equal(downloads, 1);
    await state.close(page);
});

test("on a Mac, menus and the help name its keys", async () => {
    const init = () => Object.defineProperty(Navigator.prototype, "platform", { get: () => "MacIntel" });
    const page = await state.open(link(SPHERE), { init });
    await page.getByRole("button", { name: "Edit", exact: true }).click();
    assert.deepEqual(await page.locator(".menu kbd:visible").allTextContents(), ["⌘+F", "F2", "Shift+⌥+F", "⌘+/", "⌘+."]);
    await page.keyboard.press("Escape");
    await page.keyboard.press("F1");
    const help = await page.locator("dialog[open]").textContent();
    assert.ok(help.includes("Ctrl+Space") && help.includes("⌘+Z"));
    await state.close(page);
});

test("copies of the page in two folders work without a network, and other pages there go as they came", async () => {
    const folder = mkdtempSync(join(tmpdir(), "geotrace-page-"));
    for (const name of ["one", "two"]) {
        cpSync(dist, join(folder, name), { recursive: true });
    }
    const script = join(folder, "two", "sw.js");
    writeFileSync(script, readFileSync(script, "utf8").replace(/VERSION = "\w+"/, 'VERSION = "next"'));
    writeFileSync(join(folder, "one", "lecture.html"), "<!doctype html><title>A lecture</title>");
    const server = await serve(folder);
    const context = await state.browser.newContext();
    const page = await context.newPage();
    for (const name of ["one/", "two/"]) {
        await page.goto(server.url + name + link(SPHERE));
        await settled(page);
        await page.evaluate(async () => {
            const { active } = await navigator.serviceWorker.ready;
            while (active.state !== "activated") {
                await new Promise((resolve) => setTimeout(resolve, 50));
            }
        });
    }
    const isolated = async (path) => {
        await page.goto(server.url + path);
        return page.evaluate(() => crossOriginIsolated);
    };
    assert.deepEqual([await isolated("one/"), await isolated("one/lecture.html")], [true, false]);
    await context.setOffline(true);
    for (const name of ["one/", "two/"]) {
        await page.goto(server.url + name + link(SPHERE));
        await settled(page);
    }
    await context.close();
    await server.close();
    rmSync(folder, { recursive: true });
});

test("everything has a name for those who do not see it, and is reached by keys", async () => {
    const page = await state.open(link(SPHERE));
    for (const tab of ["Params", "Objects", "Views"]) {
        await page.getByRole("tab", { name: tab }).click();
        const nameless = await page.evaluate(() => {
            const named = (element) =>
                element.getAttribute("aria-label") ?? (element.labels?.length ? element.labels[0].textContent : element.textContent);
            const all = document.querySelectorAll("button, input, select, canvas, [role=textbox], [role=separator]");
            return [...all].filter((element) => element.checkVisibility() && !named(element)?.trim()).map((element) => element.outerHTML);
        });
        assert.deepEqual(nameless, []);
    }
    await page.locator('[data-view="3d"] canvas').focus();
    const seen = new Set();
    for (let k = 0; k < 60; k += 1) {
        // Tab belongs to the text until Escape.
        if (await page.evaluate(() => document.activeElement.classList.contains("cm-content"))) {
            await page.keyboard.press("Escape");
        }
        await page.keyboard.press("Tab");
        seen.add(await page.evaluate(() => document.activeElement.getAttribute("aria-label") ?? document.activeElement.textContent.slice(0, 30)));
    }
    for (const name of ["Copy link", "Examples", "Width of the program"]) {
        assert.ok(seen.has(name), `Tab does not reach ${name}: ${[...seen].join(" | ")}`);
    }
    await state.close(page);
});

test("a button that is pressed keeps the focus, and a view that is closed leaves it to its button", async () => {
    const page = await state.open(link(SPHERE));
    const focused = () => page.evaluate(() => document.activeElement.getAttribute("aria-label") ?? document.activeElement.textContent);
    for (const [tab, name, after = name] of [
        ["Params", "Animate r", "Stop r"],
        ["Params", "Stop r", "Animate r"],
        ["Params", "Traced"],
        ["Params", "Geodesic view of s"],
        ["Params", "Close 3D view", "3D view"],
        ["Views", "Reset all settings"],
    ]) {
        await page.getByRole("tab", { name: tab }).click();
        await page.getByRole("button", { name, exact: true }).press("Enter");
        await page.waitForTimeout(300);
        assert.equal(await focused(), after);
    }
    await state.close(page);
});

test("with the system's colours what is on, chosen or has the focus looks different", async () => {
    const page = await state.open(link(SPHERE), { forcedColors: "active" });
    const styles = (locator) =>
        locator.evaluate((element) => {
            const { backgroundColor, outlineStyle } = getComputedStyle(element);
            return `${backgroundColor} ${outlineStyle}`;
        });
    const chip = page.getByRole("button", { name: "Geodesic view of s", exact: true });
    const open = await styles(chip);
    await chip.click();
    await page.mouse.move(0, 0);
    assert.notEqual(await styles(chip), open);
    assert.notEqual(await styles(page.getByRole("tab", { name: "Params" })), await styles(page.getByRole("tab", { name: "Objects" })));
    const splitter = page.getByRole("separator", { name: "Width of the program" });
    const before = await styles(splitter);
    const old = Number(await splitter.getAttribute("aria-valuenow"));
    await page.locator(".head .name").focus();
    await splitter.focus();
    await page.keyboard.press("ArrowRight");
    await page.keyboard.press("ArrowRight");
    assert.notEqual(await styles(splitter), before);
    await page.waitForFunction((value) => document.querySelector("[role=separator][aria-orientation=vertical]").ariaValueNow > value, old);
    await state.close(page);
});

test("on a phone the panes are tabs, and everything is large enough for a finger", async () => {
    const page = await state.open(link(SPHERE), { isPhone: true });
    const sizes = () =>
        page.evaluate(() => {
            const small = [];
            for (const element of document.querySelectorAll("button, input, select, .cm-content")) {
                const { width, height } = element.getBoundingClientRect();
                const isShown = element.checkVisibility() && width > 0;
                // A label makes a box as large as itself.
                const label = element.closest("label");
                const tall = label === null ? height : Math.max(height, label.getBoundingClientRect().height);
                if (isShown && (tall < 40 || (width < 40 && label === null))) {
                    small.push(`${element.className || element.id} ${width}×${tall}`);
                }
            }
            return { small, wide: document.documentElement.scrollWidth };
        });
    for (const tab of ["Pictures", "Program", "Settings"]) {
        await page.locator(".bottom").getByRole("tab", { name: tab }).tap();
        const { small, wide } = await sizes();
        assert.deepEqual(small, [], `${tab} has controls that are too small`);
        assert.equal(wide, 360, `${tab} is wider than the screen`);
    }
    assert.equal(await page.locator(".views").isVisible(), false);
    await page.locator(".bottom").getByRole("tab", { name: "Pictures" }).tap();
    assert.ok(await page.getByRole("slider", { name: "r" }).isVisible(), "the slider stands below the pictures");
    await state.close(page);
});

test("one finger turns, two zoom", async () => {
    const page = await state.open(link(SPHERE), { isPhone: true });
    let before = await picture(page);
    const { x, y } = await middle(page);
    const client = await page.context().newCDPSession(page);
    const touch = (type, ...points) =>
        client.send("Input.dispatchTouchEvent", { type, touchPoints: points.map(([px, py], id) => ({ x: px, y: py, id })) });
    await touch("touchStart", [x, y]);
    for (let k = 1; k <= 6; k += 1) {
        await touch("touchMove", [x + 10 * k, y + 4 * k]);
    }
    await touch("touchEnd");
    before = await changed(page, before);
    const covered = ({ pixels }) => {
        const corner = pixels.readUInt32LE(0);
        let count = 0;
        for (let at = 0; at < pixels.length; at += 4) {
            count += pixels.readUInt32LE(at) === corner ? 0 : 1;
        }
        return count;
    };
    await touch("touchStart", [x - 60, y], [x + 60, y]);
    for (let k = 1; k <= 5; k += 1) {
        await touch("touchMove", [x - 60 + 7 * k, y], [x + 60 - 7 * k, y]);
    }
    await touch("touchEnd");
    const after = await changed(page, before);
    assert.ok(covered(after) < 0.6 * covered(before), "the sphere is not smaller");
    await state.close(page);
});

test("a Worker that dies is started again, with text and settings", async () => {
    const init = () => {
        window.workers = [];
        window.Worker = class extends Worker {
            constructor(...all) {
                super(...all);
                window.workers.push(this);
            }
        };
    };
    const page = await state.open(link(SPHERE), { init });
    await hideCameras(page);
    const opened = await rest(page);
    await page.getByRole("textbox", { name: "Value of r" }).fill("1.7");
    await page.keyboard.press("Enter");
    await changed(page, opened);
    const before = await rest(page);
    await page.evaluate(() => {
        window.drawnAgain = new Promise((resolve) => {
            document.querySelector('[data-view="3d"]').addEventListener("picture", resolve, { once: true });
        });
        // A message that no page sends: the Worker's script fails.
        window.workers.at(-1).postMessage(null);
    });
    await page.locator(".toast.bad", { hasText: "was restarted" }).waitFor();
    await page.evaluate(() => window.drawnAgain.then(() => {}));
    assertAlike(before, await rest(page));
    assert.equal(await page.getByRole("textbox", { name: "Value of r" }).inputValue(), "1.7");
    await write(page, SPHERE.replace("r cos(v))", "2r cos(v))"));
    await changed(page, before);
    await state.close(page);
});

/** If `window.fails` is "crash", the Workers that start fail by a message that no page sends. If it is "silence", none gets
 * messages, and the time that they are waited for passes in half a second. */
const failing = () => {
    window.workers = [];
    window.Worker = class extends Worker {
        constructor(...all) {
            super(...all);
            window.workers.push(this);
            if (window.fails === "crash") {
                super.postMessage(null);
            }
        }
        postMessage(...all) {
            if (window.fails !== "silence") {
                super.postMessage(...all);
            }
        }
    };
    const [after, now] = [window.setTimeout, Date.now];
    let skipped = 0;
    Date.now = () => now() + skipped;
    window.setTimeout = (action, delay, ...all) => {
        if (window.fails !== "silence" || delay !== 45_000) {
            return after(action, delay, ...all);
        }
        return after(() => {
            skipped += delay - 500;
            action();
        }, 500);
    };
};

for (const fails of ["crash", "silence"]) {
    test(`a Worker that fails at once after another one, by ${fails}, is the last one until the program is changed`, async () => {
        const page = await state.open(link(SPHERE), { init: failing });
        const before = await rest(page);
        const start = await page.evaluate(() => window.workers.length);
        await page.evaluate((how) => (window.fails = how), fails);
        if (fails === "crash") {
            await page.evaluate(() => window.workers.at(-1).postMessage(null));
        } else {
            await write(page, `${SPHERE}# a comment\n`);
        }
        await page.locator(".toast.bad", { hasText: "keeps failing" }).waitFor();
        await page.waitForTimeout(1500);
        assert.equal(await page.evaluate(() => window.workers.length), start + 1);
        await page.evaluate(() => (window.fails = undefined));
        await write(page, SPHERE.replace("r cos(v))", "2r cos(v))"));
        await changed(page, before);
        assert.equal(await page.evaluate(() => window.workers.length), start + 2);
        await state.close(page);
    });
}

test("a program that is opened after one that kept failing has its light and its images", async () => {
    const page = await state.open(link(SPHERE), { init: failing });
    await hideCameras(page);
    const plain = await rest(page);
    const { x, y } = await middle(page);
    await dropImage(page, x, y);
    await changed(page, plain);
    const before = await rest(page);
    await page.evaluate(() => {
        window.fails = "crash";
        window.workers.at(-1).postMessage(null);
    });
    await page.locator(".toast.bad", { hasText: "keeps failing" }).waitFor();
    await page.evaluate(() => (window.fails = undefined));
    const drawn = page.evaluate(
        () => new Promise((resolve) => document.querySelector('[data-view="3d"]').addEventListener("picture", () => resolve(), { once: true })),
    );
    const settings = { preferences: { marks: { cameras: false } }, textures: ["icon.png"], looks: { s: { texture: { image: "icon.png" } } } };
    await page.evaluate((hash) => (location.hash = hash), link(SPHERE, settings));
    await drawn;
    assertAlike(before, await rest(page));
    await state.close(page);
});

test("a program of a megabyte leaves the editor usable", async () => {
    const page = await state.open(link(SPHERE));
    const name = (k) => `x${k.toString(26).replaceAll(/\d/g, (digit) => "qrstuvwxyz"[digit])}`;
    const lines = Array.from({ length: 20_000 }, (_, k) => `define ${name(k)} = sin(${k}) + cos(${k}) + 1/2 + 3^2 + sqrt(${k});`);
    const big = `${lines.join("\n")}\n`;
    assert.ok(big.length > 1e6, `${big.length}`);
    await page.getByRole("button", { name: "Open" }).click();
    const [chooser] = await Promise.all([
        page.waitForEvent("filechooser"),
        page.getByRole("menuitem", { name: "Open a file" }).click(),
    ]);
    await chooser.setFiles({ name: "big.gtr", mimeType: "", buffer: Buffer.from(big) });
    await page.waitForFunction(() => document.querySelector(".head .name").value === "big.gtr");
    await page.locator(".cm-content").click();
    const start = Date.now();
    await page.keyboard.type("# hello");
    const typed = Date.now() - start;
    assert.match(await page.locator(".cm-content").textContent(), /# hello/);
    assert.ok(typed < 2000, `seven keys took ${typed} ms`);
    await write(page, SPHERE);
    await settled(page);
    assert.equal(await text(page), SPHERE);
    await state.close(page);
});
