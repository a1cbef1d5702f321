// Measuring on the page: places are clicked on, and what is found agrees with closed forms.
import assert from "node:assert/strict";
import { test } from "node:test";
import { settled } from "./browser.mjs";
import { becomes, changed, link, middle, rest, setup, SPHERE } from "./harness.mjs";

const state = setup();

const row = (page, name) =>
    page.evaluate((wanted) => [...document.querySelectorAll(".measuring dl div")].find((it) => it.querySelector("dt").textContent === wanted)?.querySelector("dd").textContent, name);
const shown = (page, name) =>
    page.waitForFunction((wanted) => [...document.querySelectorAll(".measuring dt")].some((it) => it.textContent === wanted), name);

/** The place of a sphere of radius 1 from its longitude and colatitude. */
const onSphere = ([u, v]) => [Math.sin(v) * Math.cos(u), Math.sin(v) * Math.sin(u), Math.cos(v)];
const arc = (a, b) => Math.acos(onSphere(a).reduce((sum, x, k) => sum + x * onSphere(b)[k], 0));

test("a distance on a sphere is that of the great circle, follows a slider, and goes with the tool", async () => {
    const page = await state.open(link(SPHERE));
    const plain = await rest(page);
    await page.getByRole("button", { name: "Measure", exact: true }).click();
    await page.getByRole("button", { name: "Place", exact: true }).click();
    await settled(page);
    // Above the rows, which lie over the foot of the picture.
    const { x, y } = await middle(page);
    const clicks = [[x - 40, y - 30], [x + 50, y + 20]];
    const places = [];
    for (const [at, over] of clicks) {
        const before = await row(page, "(u, v)");
        await page.mouse.click(at, over);
        await page.waitForFunction((old) => ![old, undefined].includes(document.querySelector(".measuring dd")?.textContent), before);
        places.push(JSON.parse((await row(page, "(u, v)")).replace("(", "[").replace(")", "]")));
    }
    assert.notDeepEqual(places[0], places[1]);
    await page.getByRole("button", { name: "Distance", exact: true }).click();
    assert.equal(await row(page, "(u, v)"), undefined, "the figure before is gone");
    for (const [at, over] of clicks) {
        await page.mouse.click(at, over);
    }
    await shown(page, "distance");
    const distance = Number(await row(page, "distance"));
    assert.ok(Math.abs(distance - arc(...places)) < 1e-6, `${distance} for ${arc(...places)}`);
    await page.getByRole("button", { name: "Close measuring" }).click();
    assert.equal(await page.locator(".measuring").isVisible(), false);
    await becomes(page, plain);
    await page.getByRole("button", { name: "Measure", exact: true }).click();
    for (const [at, over] of clicks) {
        await page.mouse.click(at, over);
    }
    await shown(page, "distance");
    await page.getByRole("textbox", { name: "Value of r" }).fill("2");
    await page.keyboard.press("Enter");
    await page.waitForFunction(
        (before) => Math.abs(Number(document.querySelector(".measuring dd")?.textContent) - 2 * before) < 1e-5,
        distance,
    );
    await state.close(page);
});

test("a slider that moves while the measures are awaited is followed", async () => {
    const init = () => {
        window.measures = 0;
        window.Worker = class extends Worker {
            asked = new Set();
            postMessage(message, ...rest) {
                if (message.call === "measure") {
                    this.asked.add(message.id);
                    window.measures += 1;
                }
                super.postMessage(message, ...rest);
            }
            addEventListener(type, listener) {
                // As of a surface whose measures take long.
                super.addEventListener(type, (event) => setTimeout(() => listener(event), this.asked.has(event.data?.answer) ? 400 : 0));
            }
        };
    };
    const page = await state.open(link(SPHERE), { init });
    await page.getByRole("button", { name: "Measure", exact: true }).click();
    await settled(page);
    const { x, y } = await middle(page);
    await page.mouse.click(x - 40, y - 30);
    await page.mouse.click(x + 50, y + 20);
    await shown(page, "distance");
    const distance = Number(await row(page, "distance"));
    await page.waitForTimeout(1000);
    const measures = await page.evaluate(() => window.measures);
    const value = page.getByRole("textbox", { name: "Value of r" });
    await value.fill("1.5");
    await value.press("Enter");
    await page.waitForFunction((before) => window.measures > before, measures);
    await value.fill("2");
    await value.press("Enter");
    await page.waitForFunction(
        (before) => Math.abs(Number(document.querySelector(".measuring dd")?.textContent) - 2 * before) < 1e-5,
        distance,
    );
    await state.close(page);
});

test("a triangle on a sphere has the excess of its area, and M opens the tool", async () => {
    const page = await state.open(link(SPHERE));
    const before = await rest(page);
    await page.locator('[data-view="3d"] canvas').focus();
    await page.keyboard.press("m");
    await page.getByRole("button", { name: "Triangle", exact: true }).click();
    await settled(page);
    const { x, y } = await middle(page);
    for (const [dx, dy] of [[-40, 30], [50, 20], [0, -50]]) {
        await page.mouse.click(x + dx, y + dy);
        await page.waitForTimeout(100);
    }
    await shown(page, "angle excess");
    const [excess, area] = [parseFloat(await row(page, "angle excess")), parseFloat(await row(page, "area"))];
    assert.ok(excess > 0.01 && Math.abs(excess - area) < 1e-6, `${excess} for ${area}`);
    await changed(page, before);
    await page.mouse.click(5 + (await middle(page)).x - (await middle(page)).width / 2, y);
    await page.waitForFunction(() => /not a point of a surface/.test(document.querySelector(".measuring p").textContent));
    await state.close(page);
});

test("a walk has its length, and where the way back has closed it, its holonomy", async () => {
    const page = await state.open(link(SPHERE));
    await rest(page);
    await page.getByRole("button", { name: "Measure", exact: true }).click();
    await page.getByRole("button", { name: "Walk", exact: true }).click();
    await settled(page);
    const canvas = page.locator('[data-view="geodesic:s"] canvas');
    const { x, y, width, height } = await canvas.boundingBox();
    // Above the rows, which lie over the foot of the picture.
    const from = [x + width / 2, y + height / 3];
    for (const [dx, dy] of [[60, 0], [0, 40]]) {
        await page.mouse.move(...from);
        await page.mouse.down();
        await page.mouse.move(from[0] + dx, from[1] + dy, { steps: 4 });
        await page.mouse.up();
        await settled(page);
    }
    await shown(page, "to the start");
    const open = parseFloat(await row(page, "length"));
    assert.ok(open > 0.1, `${open}`);
    const side = parseFloat(await row(page, "to the start"));
    await page.getByRole("button", { name: "Close the walk", exact: true }).click();
    await shown(page, "holonomy");
    const [length, holonomy] = [parseFloat(await row(page, "length")), parseFloat(await row(page, "holonomy"))];
    assert.ok(Math.abs(length - open - side) < 1e-5, `${length} for ${open} + ${side}`);
    assert.ok(Math.abs(holonomy) > 1e-3, `${holonomy}`);
    await page.getByRole("button", { name: "Distance", exact: true }).click();
    assert.equal(await page.getByRole("button", { name: "Close the walk", exact: true }).isVisible(), false);
    await state.close(page);
});
