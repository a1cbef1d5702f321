// The element for other pages, on the same host and on another one.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { launch } from "./browser.mjs";
import { dist, example } from "./harness.mjs";
import { serve } from "./serve.mjs";

let browser;
let host;
let lecture;

const pageOf = (script) => `<!doctype html><title>A lecture</title>
<script type="module" src="${script}"></script>
<style>geotrace-view { width: 300px; height: 220px; }</style>
<geotrace-view id="space" src="torus.gtr"></geotrace-view>
<geotrace-view id="inside" src="torus.gtr" view="geodesic:s" controls></geotrace-view>
<geotrace-view id="text">
    surface s(u, v) = (u, v, u v), u : [-1, 1], v : [-1, 1];
</geotrace-view>
<geotrace-view id="wrong">surface s(u, v) = (u, v, q), u : [-1, 1], v : [-1, 1];</geotrace-view>
<geotrace-view id="none" src="none.gtr"></geotrace-view>`;

before(async () => {
    host = await serve(dist, {}, { cors: true });
    lecture = await serve("/nowhere", {
        "/lecture.html": pageOf(`${host.url}geotrace-view.js`),
        "/torus.gtr": example("torus.gtr"),
    });
    browser = await launch();
});
after(async () => {
    await browser?.close();
    await host?.close();
    await lecture?.close();
});

const colours = (page, id) =>
    page.evaluate((name) => {
        const canvas = document.getElementById(name).shadowRoot.querySelector("canvas");
        if (canvas === null) {
            return 0;
        }
        const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
        return new Set(new Uint32Array(data.buffer)).size;
    }, id);

test("elements on a page of another host show their programs, and share the code", async () => {
    const page = await browser.newPage();
    const failures = [];
    page.on("pageerror", (error) => failures.push(error.message));
    await page.goto(`${lecture.url}lecture.html`);
    for (const id of ["space", "inside", "text"]) {
        await page.waitForFunction((name) => document.getElementById(name).shadowRoot?.querySelector(".view[data-exact=true]"), id);
        assert.ok((await colours(page, id)) > 20, id);
    }
    const message = (id) => page.evaluate((name) => document.getElementById(name).shadowRoot.querySelector(".message").textContent, id);
    await page.waitForFunction(() => document.getElementById("wrong").shadowRoot.querySelector(".message").textContent !== "");
    assert.match(await message("wrong"), /q/);
    await page.waitForFunction(() => document.getElementById("none").shadowRoot.querySelector(".message").textContent !== "");
    assert.match(await message("none"), /none\.gtr was not found/);
    // The sliders are there where they are asked for.
    const sliders = (id) => page.evaluate((name) => document.getElementById(name).shadowRoot.querySelectorAll("input[type=range]").length, id);
    assert.deepEqual([await sliders("space"), await sliders("inside")], [0, 1]);
    assert.equal(host.asked.filter((path) => path.endsWith("geotrace-view.js")).length, 1);
    assert.deepEqual(failures, []);
    await page.close();
});

test("an element that is removed ends its Worker, and its view can be changed", async () => {
    const page = await browser.newPage();
    await page.goto(`${lecture.url}lecture.html`);
    await page.waitForFunction(() => document.getElementById("space").shadowRoot?.querySelector(".view[data-exact=true]"));
    await page.evaluate(() => document.getElementById("space").setAttribute("view", "geodesic:s"));
    await page.waitForFunction(() =>
        document.getElementById("space").shadowRoot.querySelector('.view[data-view="geodesic:s"][data-exact=true]'),
    );
    const workers = page.workers().length;
    await page.evaluate(() => document.getElementById("space").remove());
    await page.waitForTimeout(300);
    assert.equal(page.workers().length, workers - 1);
    await page.close();
});
