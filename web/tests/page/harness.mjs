// What the tests of the page have in common: the built page on a server of this machine, a browser, and what is seen.
import assert from "node:assert/strict";
import { createHash } from "node:crypto";
import { existsSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { after, before } from "node:test";
import { deflateRawSync } from "node:zlib";
import { launch, settled } from "./browser.mjs";
import { serve } from "./serve.mjs";

const web = join(import.meta.dirname, "../..");
export const dist = join(web, "dist");
export const example = (file) => readFileSync(join(web, "../examples", file), "utf8");

/** A sphere with a slider: small, so that its pictures take no time. */
export const SPHERE = `param r = 1 : [0.5, 2];
surface s(u, v) = (r sin(v) cos(u), r sin(v) sin(u), r cos(v)), u : [0, 2pi], v : [0, pi];
`;

/** The link of a program, written by another program than the page's own. */
export function link(text, settings, name = "test.gtr") {
    const bytes = deflateRawSync(Buffer.from(JSON.stringify({ name, text, settings })));
    return `#1.${bytes.toString("base64url")}`;
}

/** Sets up the server and the browser of a file of tests; `open` opens the page in a profile of its own. */
export function setup() {
    const state = {};
    const contexts = [];
    before(async () => {
        assert.ok(existsSync(join(dist, "index.html")), "the page is not built: bash web/build");
        state.server = await serve(dist);
        state.browser = await launch();
    });
    after(async () => {
        await state.browser?.close();
        await state.server?.close();
    });
    /** Opens the page; what it asks of other places, and its failures, are an error of the test. */
    state.open = async (hash = "", { isPhone = false, width = 1000, height = 640, init, ...options } = {}) => {
        const context = await state.browser.newContext({
            viewport: isPhone ? { width: 360, height: 740 } : { width, height },
            hasTouch: isPhone,
            isMobile: isPhone,
            colorScheme: "light",
            ...options,
        });
        contexts.push(context);
        const page = await context.newPage();
        if (init !== undefined) {
            await page.addInitScript(init);
        }
        page.foreign = [];
        page.failures = [];
        context.on("request", (request) => {
            if (!/^(blob:|data:)/.test(request.url()) && !request.url().startsWith(state.server.url)) {
                page.foreign.push(request.url());
            }
        });
        page.on("pageerror", (error) => page.failures.push(error.message));
        page.on("console", (message) => message.type() === "error" && page.failures.push(message.text()));
        await page.goto(state.server.url + hash);
        await settled(page);
        return page;
    };
    /** Closes a page that was opened, after nothing was asked of other places. */
    state.close = async (page) => {
        assert.deepEqual(page.foreign, [], "the page asked another place");
        assert.deepEqual(page.failures, [], "the page had a failure");
        await page.context().close();
    };
    return state;
}

/** The pixels of a view's canvas: their size, a digest, and the number of different colours. */
export async function picture(page, view = "3d") {
    const [width, height, base64] = await page.evaluate((id) => {
        const canvas = document.querySelector(`[data-view="${id}"] canvas`);
        const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
        let binary = "";
        for (let at = 0; at < data.length; at += 0x8000) {
            binary += String.fromCharCode(...data.subarray(at, at + 0x8000));
        }
        return [canvas.width, canvas.height, btoa(binary)];
    }, view);
    const pixels = Buffer.from(base64, "base64");
    const colours = new Set();
    for (let at = 0; at < pixels.length; at += 4) {
        colours.add(pixels.readUInt32LE(at));
    }
    return { width, height, pixels, digest: createHash("sha256").update(pixels).digest("hex"), colours: colours.size };
}

/** Waits until a view's picture is another one than `before`, and nothing moves; returns it. */
export async function changed(page, before, view = "3d") {
    const deadline = Date.now() + 15_000;
    for (;;) {
        await settled(page);
        const now = await picture(page, view);
        if (now.digest !== before.digest && now.width === before.width) {
            return now;
        }
        assert.ok(Date.now() < deadline, `the picture of ${view} stays as it is`);
        await page.waitForTimeout(50);
    }
}

/** Fails unless two pictures are of the same things from the same place. The core keeps the units in which it draws while a
 * param moves, so some pixels differ in their last bits. */
export function assertAlike(one, other) {
    const far = one.pixels.filter((value, at) => Math.abs(value - other.pixels[at]) > 16).length;
    assert.ok(far < one.pixels.length / 10_000, `${far} of ${one.pixels.length} channels differ`);
}

/** Hides the geodesic cameras: their arrows in space are as long as the scene was when it was drawn first. */
export async function hideCameras(page) {
    await page.getByRole("tab", { name: "Views" }).click();
    await page.getByLabel("Cameras").uncheck();
    await page.getByRole("tab", { name: "Params" }).click();
}

/** Waits until a view's picture is `wanted`, to the last pixel. */
export async function becomes(page, wanted, view = "3d") {
    const deadline = Date.now() + 15_000;
    for (;;) {
        await settled(page);
        if ((await picture(page, view)).digest === wanted.digest) {
            return wanted;
        }
        assert.ok(Date.now() < deadline, `the picture of ${view} is another one`);
        await page.waitForTimeout(50);
    }
}

/** Waits until a view's picture stays as it is for a while; returns it. */
export async function rest(page, view = "3d") {
    for (let [last, since] = [undefined, Date.now()]; ; ) {
        await settled(page);
        const now = await picture(page, view);
        if (now.digest !== last?.digest) {
            [last, since] = [now, Date.now()];
        } else if (Date.now() - since > 600) {
            return now;
        }
        await page.waitForTimeout(50);
    }
}

/** The middle of a view on the screen. */
export async function middle(page, view = "3d") {
    const box = await page.locator(`[data-view="${view}"] canvas`).boundingBox();
    return { x: box.x + box.width / 2, y: box.y + box.height / 2, ...{ width: box.width, height: box.height } };
}

/** Drops Geotrace's icon, as a file icon.png, on a place of the screen. */
export function dropImage(page, x, y) {
    const image = readFileSync(join(web, "../docs/images/icon.png")).toString("base64");
    return page.evaluate(
        async ([base64, clientX, clientY]) => {
            const bytes = Uint8Array.from(atob(base64), (character) => character.charCodeAt(0));
            const transfer = new DataTransfer();
            transfer.items.add(new File([bytes], "icon.png", { type: "image/png" }));
            const target = document.elementFromPoint(clientX, clientY);
            for (const name of ["dragenter", "dragover", "drop"]) {
                target.dispatchEvent(new DragEvent(name, { bubbles: true, cancelable: true, dataTransfer: transfer, clientX, clientY }));
            }
        },
        [image, x, y],
    );
}

/** Replaces the text of the editor as a reader does. */
export async function write(page, text) {
    await page.locator(".cm-content").click();
    await page.keyboard.press("ControlOrMeta+a");
    await page.keyboard.insertText(text);
}

/** The text of the editor, line by line. */
export function text(page) {
    return page.evaluate(() => document.querySelector(".cm-content").cmTile?.view?.state.doc.toString() ?? [...document.querySelectorAll(".cm-line")].map((line) => line.textContent).join("\n"));
}
