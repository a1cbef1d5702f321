// The editor: mistakes, words, names and layout come from the core.
import assert from "node:assert/strict";
import { test } from "node:test";
import { settled } from "./browser.mjs";
import { changed, link, picture, setup, SPHERE, text, write } from "./harness.mjs";

const state = setup();

test("a mistake is shown with its place and sentence, and the picture stays", async () => {
    const page = await state.open(link(SPHERE));
    const before = await picture(page);
    await page.locator(".cm-content").click();
    await page.keyboard.press("ControlOrMeta+End");
    await page.keyboard.type("point p = (q, 0, 0);");
    const problem = page.locator(".problems li").first();
    await problem.waitFor();
    assert.match(await problem.textContent(), /q.*3:12/s);
    assert.equal(await problem.getAttribute("class"), "error");
    assert.equal(await page.locator(".cm-lintRange-error").first().textContent(), "q");
    assert.equal(await page.locator(".status .bad").textContent(), "1 error");
    await settled(page);
    assert.equal((await picture(page)).colours > 20, true, "the sphere is still there");
    assert.equal((await picture(page)).width, before.width);
    // A click on it leads there.
    await page.keyboard.press("ControlOrMeta+Home");
    await problem.locator("button").first().click();
    await page.keyboard.type("r");
    await page.locator(".problems").waitFor({ state: "hidden" });
    assert.match(await text(page), /point p = \(r, 0, 0\);/);
    await state.close(page);
});

test("all mistakes are counted, in lines and characters", async () => {
    const page = await state.open(link(SPHERE));
    await write(page, `${"define a = b;\n".repeat(249)}define 𝛼 = b;`);
    await page.locator(".status .bad", { hasText: "of them listed" }).waitFor();
    const said = await page.locator(".status .bad").textContent();
    assert.match(said, /^\d+ errors, 200 of them listed$/);
    assert.ok(Number.parseInt(said, 10) >= 250, said);
    await write(page, "define a = 𝛼 + b;");
    await page.locator(".problems .place", { hasText: "1:16" }).waitFor();
    await state.close(page);
});

test("mistakes wait for a pause, and go at once", async () => {
    const page = await state.open(link(SPHERE));
    await page.locator(".cm-content").click();
    await page.keyboard.press("ControlOrMeta+End");
    const start = Date.now();
    await page.keyboard.type("x");
    await page.locator(".problems li").first().waitFor();
    assert.ok(Date.now() - start >= 450, "it is shown while one types");
    await page.keyboard.press("Backspace");
    const removed = Date.now();
    await page.locator(".problems").waitFor({ state: "hidden" });
    assert.ok(Date.now() - removed < 450, "it stays after it is mended");
    await state.close(page);
});

test("colours come from the core, also of words that it splits", async () => {
    const page = await state.open(link("param r : [0, 1];\ndefine a = pir;\n# a comment\npoint p = (a, r, 0);\n"));
    await page.locator(".t-keyword").first().waitFor();
    assert.equal(await page.locator(".t-keyword").first().textContent(), "param");
    assert.equal(await page.locator(".t-comment").textContent(), "# a comment");
    // `pir` is two names.
    const parts = await page.locator(".cm-line").nth(1).locator("span[class*=t-]").allTextContents();
    assert.ok(parts.includes("pi") && parts.includes("r"), parts.join("|"));
    await state.close(page);
});

test("completion lists what fits, and Tab takes it", async () => {
    const page = await state.open(link(SPHERE));
    await page.locator(".cm-content").click();
    await page.keyboard.press("ControlOrMeta+End");
    await page.keyboard.type("surf");
    await page.locator(".cm-tooltip-autocomplete li").first().waitFor();
    assert.match(await page.locator(".cm-tooltip-autocomplete").textContent(), /surface/);
    await page.keyboard.press("Tab");
    assert.match(await text(page), /\nsurface /);
    await page.keyboard.press("Escape");
    await state.close(page);
});

test("hover describes the word under the pointer", async () => {
    const page = await state.open(link(SPHERE));
    await page.locator(".t-keyword").first().waitFor();
    await page.locator(".cm-line").nth(1).locator("span", { hasText: /^s$/ }).first().hover();
    const tip = page.locator(".cm-tooltip-hover");
    await tip.waitFor();
    assert.match(await tip.textContent(), /surface s\(u, v\)/);
    await state.close(page);
});

test("the signature is shown while arguments are written", async () => {
    const page = await state.open(link("function f(x, y) = x + y;\n"));
    await page.locator(".cm-content").click();
    await page.keyboard.press("ControlOrMeta+End");
    await page.keyboard.type("define b = f(1, ");
    await page.locator(".tip strong.active", { hasText: "y" }).waitFor();
    await state.close(page);
});

test("rename changes every place, format lays out, comment and undo", async () => {
    const page = await state.open(link("param r:[0.5,2];\npoint p = (r,0,r);\n"));
    await page.locator(".cm-content").click();
    await page.keyboard.press("ControlOrMeta+Home");
    for (let k = 0; k < 6; k += 1) {
        await page.keyboard.press("ArrowRight");
    }
    await page.keyboard.press("F2");
    await page.locator("#asked").fill("radius");
    await page.keyboard.press("Enter");
    await page.waitForFunction(() => document.querySelector(".cm-content").textContent.includes("(radius,0,radius)"));
    await page.keyboard.press("Shift+Alt+f");
    await page.waitForFunction(() => document.querySelector(".cm-content").textContent.includes("param radius : [0.5, 2];"));
    await page.keyboard.press("ControlOrMeta+/");
    assert.match(await text(page), /^# param/);
    await page.keyboard.press("ControlOrMeta+z");
    assert.match(await text(page), /^param radius :/);
    await state.close(page);
});

test("a fix is offered and applied", async () => {
    const page = await state.open(link("point p = (1, 2, sqr(2));\n"));
    const fix = page.locator(".problems li > .button").first();
    await fix.waitFor();
    await fix.click();
    await page.locator(".problems").waitFor({ state: "hidden" });
    await state.close(page);
});

test("a fix of a text that has changed meanwhile is refused", async () => {
    const page = await state.open(link("point p = (1, 2, sqr(2));\n"));
    const fix = await page.locator(".problems li > .button").first().elementHandle();
    await write(page, "p");
    // As before the new text's mistakes are shown.
    await fix.evaluate((button) => button.click());
    await page.locator(".toast", { hasText: "The text has changed meanwhile: the fix is not done." }).waitFor();
    assert.equal(await text(page), "p");
    await state.close(page);
});

test("the picture follows the text", async () => {
    const page = await state.open(link(SPHERE));
    const before = await picture(page);
    await write(page, SPHERE.replace("r cos(v))", "2r cos(v))"));
    await changed(page, before);
    await state.close(page);
});

test("keys that are typed move no camera", async () => {
    const page = await state.open(link(SPHERE));
    const before = await picture(page);
    await page.locator(".cm-content").click();
    await page.keyboard.press("ControlOrMeta+End");
    await page.keyboard.type("# wasd qe zx f t r 1 3 7 5");
    await page.waitForTimeout(300);
    await settled(page);
    const after = await picture(page);
    assert.equal(after.digest, before.digest);
    await state.close(page);
});

test("a script is read as the other language", async () => {
    const script = "ball = Sphere {\n    center -> vec3(0, 0, 0)\n    radius -> 1\n}\nball\n-- a comment\n";
    const page = await state.open(link(script, undefined, "test.crt"));
    await page.locator(".t-comment").waitFor();
    assert.equal(await page.locator(".t-comment").textContent(), "-- a comment");
    await state.close(page);
});
