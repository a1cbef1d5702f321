// The pictures: keys, pointer and wheel move the cameras, clicks find what is seen, sliders and looks change them.
import assert from "node:assert/strict";
import { test } from "node:test";
import { settled } from "./browser.mjs";
import { becomes, changed, dropImage, link, middle, picture, rest, setup, SPHERE } from "./harness.mjs";

const state = setup();
const INSIDE = "geodesic:s";

test("both pictures appear and show the sphere", async () => {
    const page = await state.open(link(SPHERE));
    for (const view of ["3d", INSIDE]) {
        const { width, height, colours } = await picture(page, view);
        const box = await middle(page, view);
        assert.ok(colours > 50, `${view} has ${colours} colours`);
        assert.deepEqual([width, height], [box.width, box.height].map(Math.round), "it is as large as its pane");
    }
    await state.close(page);
});

test("a drag turns about the target, and the sphere stays in the middle", async () => {
    const page = await state.open(link(SPHERE));
    const before = await picture(page);
    const { x, y } = await middle(page);
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + 60, y + 20, { steps: 6 });
    await page.mouse.up();
    const after = await changed(page, before);
    // The corner is the background before and after.
    assert.deepEqual(after.pixels.subarray(0, 4), before.pixels.subarray(0, 4));
    await state.close(page);
});

test("a drag with Shift or the right button moves sideways, the wheel zooms", async () => {
    const page = await state.open(link(SPHERE));
    let before = await picture(page);
    const { x, y } = await middle(page);
    await page.mouse.move(x, y);
    await page.mouse.down({ button: "right" });
    await page.mouse.move(x + 80, y, { steps: 4 });
    await page.mouse.up({ button: "right" });
    before = await changed(page, before);
    await page.mouse.wheel(0, 240);
    before = await changed(page, before);
    await page.keyboard.down("Shift");
    await page.mouse.down();
    await page.mouse.move(x, y + 40, { steps: 4 });
    await page.mouse.up();
    await page.keyboard.up("Shift");
    await changed(page, before);
    await state.close(page);
});

test("keys move the camera of the picture that has the focus", async () => {
    const page = await state.open(link(SPHERE));
    let [space, inside] = [await picture(page), await picture(page, INSIDE)];
    await page.locator('[data-view="3d"] canvas').focus();
    for (const key of ["w", "ArrowLeft", "7", "5", "-"]) {
        await page.keyboard.down(key);
        await page.waitForTimeout(120);
        await page.keyboard.up(key);
        space = await changed(page, space);
    }
    assert.equal((await picture(page, INSIDE)).digest, inside.digest, "the other camera stays");
    await page.keyboard.press("F6");
    for (const key of ["w", "q", "x"]) {
        await page.keyboard.down(key);
        await page.waitForTimeout(120);
        await page.keyboard.up(key);
        inside = await changed(page, inside, INSIDE);
    }
    await state.close(page);
});

test("a key that is held moves the camera until it is released, wherever the focus is then", async () => {
    const page = await state.open(link(SPHERE));
    let space = await picture(page);
    const leave = [
        () => page.locator(".cm-content").focus(),
        () => page.evaluate(() => window.dispatchEvent(new Event("blur"))),
    ];
    for (const go of leave) {
        await page.evaluate(() => document.activeElement.blur());
        await page.keyboard.down("a");
        await page.waitForTimeout(120);
        await go();
        if (go === leave[0]) {
            await page.keyboard.up("a");
        }
        space = await changed(page, space);
        assert.equal((await rest(page)).digest, space.digest);
    }
    await state.close(page);
});

test("R puts the camera back, to the last pixel", async () => {
    const page = await state.open(link(SPHERE));
    const first = await picture(page, INSIDE);
    await page.locator(`[data-view="${INSIDE}"] canvas`).focus();
    await page.keyboard.down("d");
    await page.waitForTimeout(150);
    await page.keyboard.up("d");
    const walked = await changed(page, first, INSIDE);
    await page.keyboard.press("r");
    await becomes(page, first, INSIDE);
    await state.close(page);
});

test("a click puts the geodesic camera there, a double click shows the declaration", async () => {
    const page = await state.open(link(SPHERE));
    const before = await picture(page, INSIDE);
    const { x, y } = await middle(page);
    await page.mouse.click(x + 30, y - 20);
    await changed(page, before, INSIDE);
    await page.mouse.dblclick(x, y);
    await page.waitForFunction(() => document.activeElement?.classList.contains("cm-content"));
    const selected = await page.evaluate(() => String(getSelection()));
    assert.match(selected, /s/);
    await state.close(page);
});

test("the status line says what is under the pointer", async () => {
    const page = await state.open(link(SPHERE));
    const { x, y } = await middle(page);
    await page.mouse.move(x, y);
    await page.mouse.move(x + 2, y + 2);
    await page.waitForFunction(() => /^s at \(u, v\).*K = 1, \d\S* from the geodesic camera$/.test(document.querySelector(".pointed").textContent));
    const inside = await middle(page, INSIDE);
    await page.mouse.move(inside.x + 40, inside.y);
    await page.waitForTimeout(100);
    await page.mouse.move(inside.x + 42, inside.y);
    await page.waitForFunction(() => /, 0\.\d+ from the geodesic camera$/.test(document.querySelector(".pointed").textContent));
    await state.close(page);
});

test("a slider changes both pictures, and its value can be written into the text", async () => {
    const page = await state.open(link(SPHERE));
    const before = await picture(page, INSIDE);
    const slider = page.getByRole("slider", { name: "r" });
    await slider.focus();
    for (let k = 0; k < 10; k += 1) {
        await page.keyboard.press("ArrowRight");
    }
    await changed(page, before, INSIDE);
    await page.getByRole("textbox", { name: "Value of r" }).fill("1.5");
    await page.keyboard.press("Enter");
    await page.getByRole("button", { name: "Write r into the program" }).click();
    await page.waitForFunction(() => document.querySelector(".cm-content").textContent.includes("param r = 1.5"));
    await state.close(page);
});

test("quick keys on a slider all count, and those of one press are one step", async () => {
    const page = await state.open(link(SPHERE));
    const slider = page.getByRole("slider", { name: "r" });
    const is = (value) => page.waitForFunction((wanted) => Math.abs(document.querySelector("input[type=range]").valueAsNumber - wanted) < 1e-9, value);
    await slider.focus();
    for (let k = 0; k < 20; k += 1) {
        await page.keyboard.press("ArrowRight");
        await page.waitForTimeout(k % 5);
    }
    assert.equal((await slider.evaluate((it) => it.valueAsNumber)).toFixed(4), "1.3000");
    await settled(page);
    await page.waitForTimeout(300);
    await is(1.3);
    // Held down, it is a step.
    for (let k = 0; k < 3; k += 1) {
        await page.keyboard.down("ArrowLeft");
    }
    await page.keyboard.up("ArrowLeft");
    await is(1.255);
    await page.locator('[data-view="3d"] canvas').focus();
    await page.keyboard.press("ControlOrMeta+z");
    await is(1.3);
    await page.keyboard.press("ControlOrMeta+z");
    await is(1.285);
    await state.close(page);
});

test("the settings are reset, and put back unless another program is open", async () => {
    const page = await state.open(link(SPHERE));
    const value = page.getByRole("textbox", { name: "Value of r" });
    const reset = async () => {
        await page.getByRole("tab", { name: "Params" }).click();
        await value.fill("1.7");
        await value.press("Enter");
        await page.getByRole("tab", { name: "Views" }).click();
        await page.getByRole("button", { name: "Reset all settings" }).click();
        await page.getByRole("tab", { name: "Params" }).click();
        await page.waitForFunction(() => document.querySelector('[aria-label="Value of r"]').value === "1");
        const undo = page.locator(".toast", { hasText: "were reset" }).getByRole("button", { name: "Undo" });
        return undo.elementHandle();
    };
    const press = (undo) => undo.evaluate((button) => button.click());
    await press(await reset());
    await page.waitForFunction(() => document.querySelector('[aria-label="Value of r"]').value === "1.7");
    const undo = await reset();
    await page.evaluate((hash) => (location.hash = hash), link(SPHERE.replace("r = 1", "r = 0.8"), undefined, "other.gtr"));
    await page.waitForFunction(() => document.querySelector('[aria-label="Value of r"]').value === "0.8");
    await press(undo);
    await page.waitForTimeout(500);
    assert.equal(await value.inputValue(), "0.8");
    await state.close(page);
});

test("a param is animated and stopped", async () => {
    const page = await state.open(link(SPHERE));
    const value = () => page.getByRole("slider", { name: "r" }).inputValue();
    const first = await value();
    await page.getByRole("button", { name: "Animate r" }).click();
    await page.waitForFunction((old) => document.querySelector("input[type=range]").value !== old, first);
    await page.getByRole("button", { name: "Stop r" }).click();
    await settled(page);
    await page.waitForTimeout(200);
    const stopped = await value();
    await page.waitForTimeout(200);
    assert.equal(await value(), stopped);
    await state.close(page);
});

test("objects are hidden, coloured and textured; undo takes it back", async () => {
    const page = await state.open(link(SPHERE));
    const first = await picture(page);
    await page.getByRole("tab", { name: "Objects" }).click();
    await page.getByRole("button", { name: "Hide s" }).click();
    const hidden = await changed(page, first);
    assert.ok(hidden.colours < first.colours);
    await page.getByRole("button", { name: "Show s" }).click();
    await becomes(page, first);
    await page.getByLabel("Texture of s").selectOption("plain");
    const plain = await changed(page, first);
    await page.getByLabel("Colour of s").fill("#ff0000");
    const red = await changed(page, plain);
    await page.locator('[data-view="3d"] canvas').focus();
    await page.keyboard.press("ControlOrMeta+z");
    await becomes(page, plain);
    await page.keyboard.press("ControlOrMeta+z");
    await becomes(page, first);
    await state.close(page);
});

test("the letters of commands are those written on the keys", async () => {
    const page = await state.open(link(SPHERE));
    /** Presses a key in the 3D view; returns whether the page has taken it. */
    const press = (code, key, ctrlKey = false) =>
        page.evaluate(
            ([init]) => {
                const canvas = document.querySelector('[data-view="3d"] canvas');
                const event = new KeyboardEvent("keydown", { bubbles: true, cancelable: true, ...init });
                canvas.dispatchEvent(event);
                canvas.dispatchEvent(new KeyboardEvent("keyup", { bubbles: true, ...init }));
                return event.defaultPrevented;
            },
            [{ code, key, ctrlKey }],
        );
    await page.getByRole("tab", { name: "Objects" }).click();
    await page.getByRole("button", { name: "Hide s" }).click();
    // German, Russian.
    for (const [undo, redo] of [["KeyY z", "KeyZ y"], ["KeyZ я", "KeyY н"]]) {
        assert.ok(await press(...undo.split(" "), true));
        await page.getByRole("button", { name: "Hide s" }).waitFor();
        assert.ok(await press(...redo.split(" "), true));
        await page.getByRole("button", { name: "Show s" }).waitFor();
    }
    // French M; Colemak R, whose place is that of S, and Ctrl+R, which is the browser's.
    assert.ok(await press("Semicolon", "m"));
    await page.getByRole("region", { name: "Measure" }).waitFor();
    assert.ok(await press("KeyS", "r"));
    assert.ok(!(await press("KeyS", "r", true)));
    await state.close(page);
});

test("overlays are drawn over the pictures", async () => {
    const page = await state.open(link(SPHERE));
    const before = await picture(page, INSIDE);
    await page.getByRole("tab", { name: "Views" }).click();
    await page.getByLabel("Wavefronts").check();
    const fronts = await changed(page, before, INSIDE);
    await page.getByLabel("Wavefronts").uncheck();
    await becomes(page, before, INSIDE);
    await state.close(page);
});

test("T shows the traced view, and once more the 3D view", async () => {
    const solid = "solid ball(x, y, z) = x^2 + y^2 + z^2 - 1, mirror : 0.5;\nlight l = @ (2, -2, 4), power : 2;\n";
    const page = await state.open(link(solid));
    const before = await picture(page);
    await page.locator('[data-view="3d"] canvas').focus();
    await page.keyboard.press("t");
    const traced = await changed(page, before);
    await page.keyboard.press("t");
    await becomes(page, before);
    await state.close(page);
});

test("a view is closed and opened again", async () => {
    const page = await state.open(link(SPHERE));
    await page.getByRole("button", { name: "Close Geodesic view of s" }).click();
    assert.equal(await page.locator(".view").count(), 1);
    await page.locator(".chips").getByRole("button", { name: "Geodesic view of s" }).click();
    await page.locator(".view").nth(1).waitFor();
    await settled(page);
    assert.equal(await page.locator(".view").count(), 2);
    await state.close(page);
});

test("an image that is dropped on a surface lies on it", async () => {
    const page = await state.open(link(SPHERE));
    const before = await picture(page);
    const { x, y } = await middle(page);
    await dropImage(page, x, y);
    await changed(page, before);
    await page.getByRole("tab", { name: "Objects" }).click();
    assert.equal(await page.getByLabel("Texture of s").inputValue(), "image icon.png");
    await state.close(page);
});
