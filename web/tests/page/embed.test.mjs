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
    const set = (name, value) => page.evaluate((all) => document.getElementById("space").setAttribute(...all), [name, value]);
    const says = (pattern) =>
        page.waitForFunction((it) => new RegExp(it).test(document.getElementById("space").shadowRoot.querySelector(".message").textContent), pattern);
    await set("view", "geodesic:none");
    await says("^There is no view geodesic:none");
    await set("view", "3d");
    await says("^$");
    await set("theme", "dark");
    await page.waitForFunction(() => document.getElementById("space").dataset.theme === "dark");
    await set("theme", "light");
    await page.waitForFunction(() => document.getElementById("space").dataset.theme === "light");
    const workers = page.workers().length;
    await page.evaluate(() => document.getElementById("space").remove());
    await page.waitForTimeout(300);
    assert.equal(page.workers().length, workers - 1);
    await page.close();
});

/** Holds the program slow.gtr back; returns what waits until it is asked for. */
const slow = (page) => new Promise((asked) => void page.route("**/slow.gtr", asked));
/** Answers with a program that has a mistake, and waits until it would be seen. */
const answer = async (page, route) => {
    await route.fulfill({ body: "point p = (q, 0, 0);" });
    await page.waitForTimeout(1000);
};

test("of two programs that are fetched the one that was asked for last is shown", async () => {
    const page = await browser.newPage();
    const asked = slow(page);
    await page.goto(`${lecture.url}lecture.html`);
    await page.waitForFunction(() => document.getElementById("space").shadowRoot?.querySelector(".view[data-exact=true]"));
    const set = (src) => page.evaluate((value) => document.getElementById("space").setAttribute("src", value), src);
    await set("slow.gtr");
    const route = await asked;
    await set("torus.gtr?again");
    await page.waitForFunction(() => document.getElementById("space").shadowRoot.querySelector(".view").dataset.version !== "1");
    await answer(page, route);
    const message = await page.evaluate(() => document.getElementById("space").shadowRoot.querySelector(".message").textContent);
    assert.equal(message, "");
    await page.close();
});

test("an element that is removed while its program is fetched starts no other Worker", async () => {
    const page = await browser.newPage();
    const asked = slow(page);
    await page.goto(`${lecture.url}lecture.html`);
    for (const id of ["wrong", "none"]) {
        await page.waitForFunction((name) => document.getElementById(name).shadowRoot?.querySelector(".message").textContent, id);
    }
    const workers = page.workers().length;
    await page.evaluate(() => {
        const element = document.createElement("geotrace-view");
        element.id = "late";
        element.setAttribute("src", "slow.gtr");
        document.body.prepend(element);
    });
    const route = await asked;
    await page.evaluate(() => document.getElementById("late").remove());
    await answer(page, route);
    assert.equal(page.workers().length, workers);
    await page.close();
});
