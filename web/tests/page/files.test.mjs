// What leaves the page and comes back: links, files, pictures, meshes, what the browser keeps.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { inflateSync } from "node:zlib";
import { settled } from "./browser.mjs";
import { assertAlike, changed, example, hideCameras, link, middle, picture, rest, setup, SPHERE, text, write } from "./harness.mjs";

const state = setup();

/** The text that the page has put on the clipboard. */
const copied = async (page) => {
    await page.getByRole("button", { name: "Copy link" }).click();
    await page.locator(".toast", { hasText: "is copied" }).waitFor();
    return page.evaluate(() => navigator.clipboard.readText());
};

const download = async (page, press) => {
    const [file] = await Promise.all([page.waitForEvent("download"), press()]);
    return { name: file.suggestedFilename(), bytes: readFileSync(await file.path()) };
};

/** The size of a PNG file, whose pixels are there. */
function png(bytes) {
    assert.equal(bytes.subarray(1, 4).toString(), "PNG");
    const data = [];
    for (let at = 8; at < bytes.length; at += 12 + bytes.readUInt32BE(at)) {
        if (bytes.subarray(at + 4, at + 8).toString() === "IDAT") {
            data.push(bytes.subarray(at + 8, at + 8 + bytes.readUInt32BE(at)));
        }
    }
    const [width, height] = [bytes.readUInt32BE(16), bytes.readUInt32BE(20)];
    const channels = { 2: 3, 6: 4 }[bytes[25]];
    assert.equal(inflateSync(Buffer.concat(data)).length, height * (1 + width * channels));
    return { width, height };
}

test("a link brings program, cameras and looks to a fresh profile, to the last pixel", async () => {
    const page = await state.open(link(SPHERE), { permissions: ["clipboard-read", "clipboard-write"] });
    const before = await picture(page);
    const { x, y } = await middle(page);
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + 70, y + 30, { steps: 5 });
    await page.mouse.up();
    const turned = await changed(page, before);
    await page.locator('[data-view="geodesic:s"] canvas').focus();
    const inside = await picture(page, "geodesic:s");
    await page.keyboard.down("w");
    await page.waitForTimeout(150);
    await page.keyboard.up("w");
    await changed(page, inside, "geodesic:s");
    await page.getByRole("tab", { name: "Objects" }).click();
    await page.getByLabel("Colour of s").fill("#ffcc88");
    await changed(page, turned);
    const [space, walked] = [await rest(page), await rest(page, "geodesic:s")];
    const url = await copied(page);
    const other = await state.open(url.slice(url.indexOf("#")));
    assert.equal(await text(other), await text(page));
    assert.equal((await picture(other)).digest, space.digest);
    assert.equal((await picture(other, "geodesic:s")).digest, walked.digest);
    await state.close(other);
    await state.close(page);
});

test("a link brings the params, and the camera stays where it was", async () => {
    const page = await state.open(link(SPHERE), { permissions: ["clipboard-read", "clipboard-write"] });
    const before = await picture(page);
    await hideCameras(page);
    await page.getByRole("textbox", { name: "Value of r" }).fill("1.4");
    await page.keyboard.press("Enter");
    await changed(page, before);
    const now = await rest(page);
    const url = await copied(page);
    const other = await state.open(url.slice(url.indexOf("#")));
    assert.equal(await other.getByRole("textbox", { name: "Value of r" }).inputValue(), "1.4");
    assertAlike(now, await picture(other));
    await state.close(other);
    await state.close(page);
});

test("a broken link gives a sentence, and the page works", async () => {
    for (const [hash, sentence] of [
        ["#1.AAAA", /damaged/],
        ["#hello", /does not contain a Geotrace program/],
        [`${link(SPHERE).slice(0, 60)}`, /damaged/],
        ["#9.abc", /newer version/],
    ]) {
        const page = await state.open(hash);
        assert.match(await page.locator(".toast.bad").textContent(), sentence);
        assert.ok((await picture(page)).colours > 50);
        await state.close(page);
    }
});

test("a link cannot name a file of another kind", async () => {
    for (const [name, seen] of [["setup.bat", "setup.bat.gtr"], ["a\u202erth.gtr.exe", "a-rth.gtr.exe.gtr"], ["a/b.GTR", "a-b.gtr"]]) {
        const page = await state.open(link(SPHERE, undefined, name));
        assert.equal((await download(page, () => page.keyboard.press("ControlOrMeta+s"))).name, seen);
        assert.equal(await page.locator(".head .name").inputValue(), seen);
        await state.close(page);
    }
});

test("what was typed is there after a reload, and a link does not take it away", async () => {
    const page = await state.open();
    await write(page, SPHERE.replace("0.5, 2", "0.25, 2"));
    await page.waitForTimeout(600);
    await page.reload();
    await settled(page);
    assert.match(await text(page), /0\.25, 2/);
    await page.goto(`${state.server.url}${link(SPHERE, undefined, "linked.gtr")}`);
    await page.waitForFunction(() => document.querySelector(".head .name").value === "linked.gtr");
    await page.getByRole("button", { name: "Open" }).click();
    await page.getByRole("menuitem", { name: /first\.gtr/ }).click();
    await page.waitForFunction(() => document.querySelector(".cm-content").textContent.includes("0.25, 2"));
    await state.close(page);
});

test("what was chosen for a program from a link is there after a reload, and not in another tab", async () => {
    const page = await state.open(link(SPHERE));
    const context = page.context();
    await page.getByRole("textbox", { name: "Value of r" }).fill("1.4");
    await page.keyboard.press("Enter");
    await page.locator(".head .name").fill("mine.gtr");
    await page.keyboard.press("Enter");
    await page.reload();
    await settled(page);
    assert.equal(await page.getByRole("textbox", { name: "Value of r" }).inputValue(), "1.4");
    assert.equal(await page.locator(".head .name").inputValue(), "mine.gtr");
    const other = await context.newPage();
    await other.goto(state.server.url + link(SPHERE));
    await settled(other);
    assert.equal(await other.getByRole("textbox", { name: "Value of r" }).inputValue(), "1");
    await state.close(page);
});

/** The programs that were open before, as the browser has them. */
const recent = (page) => page.evaluate(() => JSON.parse(localStorage["geotrace.recent"] ?? "[]").map((it) => it.text));

test("a link or a program in another tab takes nothing away of what was typed", async () => {
    const first = await state.open();
    const context = first.context();
    await write(first, "point p = (1, 2, 3);");
    await first.close({ runBeforeUnload: true });
    const linked = await context.newPage();
    await linked.goto(state.server.url + link(SPHERE, undefined, "linked.gtr"));
    await settled(linked);
    assert.deepEqual(await recent(linked), ["point p = (1, 2, 3);"]);
    // Two tabs in turn leave their last texts, and none of those before.
    const other = await context.newPage();
    await other.goto(state.server.url);
    await settled(other);
    for (const number of [4, 5, 6]) {
        for (const [page, axis] of [[linked, "x"], [other, "y"]]) {
            await page.bringToFront();
            await write(page, `define ${axis} = ${number};`);
            await page.waitForTimeout(600);
        }
    }
    await other.close({ runBeforeUnload: true });
    await linked.close({ runBeforeUnload: true });
    const last = await context.newPage();
    await last.goto(state.server.url);
    await last.waitForFunction(() => document.querySelector(".cm-content").textContent.startsWith("define"));
    const kept = [await text(last), ...(await recent(last))].filter((it) => it.startsWith("define"));
    assert.ok(kept.includes("define x = 6;") && kept.includes("define y = 6;"), kept.join());
    assert.ok(kept.length <= 3, kept.join());
    await context.close();
});

test("a long program is kept where another one takes its place, one without room can be saved", async () => {
    const long = `${`# ${"a comment ".repeat(10)}\n`.repeat(3000)}${SPHERE}`;
    const init = `localStorage["geotrace.program"] ??= ${JSON.stringify(JSON.stringify({ name: "long.gtr", text: long }))};`;
    const page = await state.open("", { init });
    const choose = async (item) => {
        await page.getByRole("button", { name: "New" }).click();
        await page.getByRole("menuitem", { name: item }).click();
    };
    await choose("Curve");
    assert.deepEqual(await recent(page), [long]);
    await write(page, "point p = (1, 2, 3);");
    await page.evaluate(() => {
        Storage.prototype.setItem = () => {
            throw new Error("no room");
        };
    });
    await choose("Surface");
    const notice = page.locator(".toast", { hasText: "no room to keep" });
    const { bytes } = await download(page, () => notice.getByRole("button", { name: "Save it" }).click());
    assert.equal(bytes.toString(), "point p = (1, 2, 3);");
    await state.close(page);
});

test("settings that cannot be read are left out, once and for all", async () => {
    for (const settings of [{ closed: 5 }, { textures: 5 }, { params: { r: "a" } }, { preferences: { marks: 5 } }, { looks: 5 }]) {
        const page = await state.open(link(SPHERE, settings));
        assert.match(await page.locator(".toast.bad").textContent(), /settings .* cannot be read/, JSON.stringify(settings));
        const before = await picture(page);
        await write(page, SPHERE.replace("r cos(v))", "2r cos(v))"));
        await changed(page, before);
        await page.reload();
        await settled(page);
        assert.equal(await page.locator(".toast").count(), 0);
        await state.close(page);
    }
});

test("another name keeps what can be undone, and remembers nothing under it", async () => {
    const page = await state.open(link("ball = 1;", undefined, "test.gtr"));
    await page.locator(".cm-content").click();
    await page.keyboard.press("ControlOrMeta+End");
    await page.keyboard.type(" # more");
    const name = page.locator(".head .name");
    await name.fill("test.crt");
    await name.press("Enter");
    await page.waitForFunction(() => document.title.startsWith("test.crt"));
    await page.locator(".cm-content").click();
    await page.keyboard.press("ControlOrMeta+z");
    await page.waitForFunction(() => document.querySelector(".cm-content").textContent === "ball = 1;");
    assert.deepEqual(await recent(page), []);
    await state.close(page);
});

test("on a phone a program that was open before takes the place of a link", async () => {
    const page = await state.open("", { isPhone: true });
    await page.locator(".bottom").getByRole("tab", { name: "Program" }).tap();
    await write(page, "point p = (1, 2, 3);");
    await page.goto(`${state.server.url}${link(SPHERE, undefined, "linked.gtr")}`);
    await page.waitForFunction(() => document.querySelector(".head .name").value === "linked.gtr");
    await page.getByRole("button", { name: "Menu" }).tap();
    await page.getByRole("menuitem", { name: "Open first.gtr again" }).tap();
    await page.waitForFunction(() => document.querySelector(".head .name").value === "first.gtr");
    assert.equal(await text(page), "point p = (1, 2, 3);");
    assert.equal(await page.evaluate(() => location.hash), "");
    await state.close(page);
});

test("a reload before the pause loses nothing", async () => {
    const page = await state.open();
    await write(page, "point p = (1, 2, 3);");
    await page.reload();
    await settled(page);
    assert.equal(await text(page), "point p = (1, 2, 3);");
    await state.close(page);
});

test("a picture is saved in its size", async () => {
    const page = await state.open(link(SPHERE));
    for (const [view, title] of [["3d", "3D view"], ["geodesic-s", "Geodesic view of s"]]) {
        await page.getByRole("button", { name: `Save a picture of ${title}` }).click();
        await page.getByLabel("Width in pixels").fill("");
        await page.getByRole("button", { name: "Save", exact: true }).click();
        await page.getByLabel("Width in pixels").fill("320");
        await page.getByLabel("Height in pixels").fill("200");
        const { name, bytes } = await download(page, () => page.getByRole("button", { name: "Save", exact: true }).click());
        assert.equal(name, `test-${view}.png`);
        assert.deepEqual(png(bytes), { width: 320, height: 200 });
        await page.locator("dialog").waitFor({ state: "detached" });
    }
    await state.close(page);
});

test("a picture takes as long as it needs, and drawing it can be cancelled", async () => {
    // The time that a call is waited for passes in half a second while a picture is drawn.
    const init = () => {
        const after = window.setTimeout;
        const isHurried = () => document.querySelector("dialog[open]") !== null;
        window.setTimeout = (action, delay, ...all) => after(action, delay === 45_000 && isHurried() ? 500 : delay, ...all);
    };
    const page = await state.open(link(example("dice.gtr"), { preferences: { traced: true, samples: 1 } }), { init });
    const save = async (width, height) => {
        await page.getByRole("button", { name: /^Save a picture of/ }).first().click();
        await page.getByLabel("Width in pixels").fill(String(width));
        await page.getByLabel("Height in pixels").fill(String(height));
        await page.getByRole("button", { name: "Save", exact: true }).click();
    };
    const { bytes } = await download(page, () => save(1200, 900));
    assert.deepEqual(png(bytes), { width: 1200, height: 900 });
    await page.locator("dialog").waitFor({ state: "detached" });
    await save(4096, 4096);
    await page.getByText("Drawing…").waitFor();
    await page.waitForTimeout(1000);
    await page.getByRole("button", { name: "Cancel" }).click();
    await page.locator("dialog").waitFor({ state: "detached" });
    await page.waitForTimeout(300);
    assert.equal(await page.locator(".toast").count(), 0);
    await write(page, SPHERE);
    await page.locator('[data-view="geodesic:s"][data-exact=true]').waitFor();
    await state.close(page);
});

test("meshes are saved in every format", async () => {
    const page = await state.open(link(SPHERE));
    const checks = {
        obj: (bytes) => assert.match(bytes.toString(), /^v .*^f /ms),
        ply: (bytes) => assert.equal(bytes.subarray(0, 4).toString(), "ply\n"),
        stl: (bytes) => assert.equal(bytes.length, 84 + 50 * bytes.readUInt32LE(80)),
        glb: (bytes) => assert.equal(bytes.readUInt32LE(8), bytes.length),
    };
    for (const [format, check] of Object.entries(checks)) {
        await page.getByRole("button", { name: "Export" }).click();
        const item = page.getByRole("menuitem", { name: `.${format}` });
        const { name, bytes } = await download(page, () => item.click());
        assert.equal(name, `test.${format}`);
        check(bytes);
    }
    await state.close(page);
});

test("a program is saved and opened as a file", async () => {
    const page = await state.open(link(SPHERE));
    const saved = await download(page, () => page.keyboard.press("ControlOrMeta+s"));
    assert.deepEqual([saved.name, saved.bytes.toString()], ["test.gtr", SPHERE]);
    await page.getByRole("button", { name: "Open" }).click();
    const [chooser] = await Promise.all([
        page.waitForEvent("filechooser"),
        page.getByRole("menuitem", { name: "Open a file" }).click(),
    ]);
    await chooser.setFiles({ name: "other.gtr", mimeType: "", buffer: Buffer.from("point p = (1, 1, 1);\r\npoint q = (2, 1, 1);\r\n") });
    await page.waitForFunction(() => document.querySelector(".head .name").value === "other.gtr");
    assert.equal(await text(page), "point p = (1, 1, 1);\npoint q = (2, 1, 1);\n");
    await page.getByRole("button", { name: "Open" }).click();
    const [again] = await Promise.all([
        page.waitForEvent("filechooser"),
        page.getByRole("menuitem", { name: "Open a file" }).click(),
    ]);
    await again.setFiles({ name: "x.gtr", mimeType: "", buffer: Buffer.from([0xff, 0xfe, 0x00]) });
    await page.locator(".toast.bad", { hasText: "not UTF-8 text" }).waitFor();
    await state.close(page);
});

test("the gallery has every example with its picture, and opens it", async () => {
    const page = await state.open();
    await page.getByRole("button", { name: "Examples" }).first().click();
    const cards = page.locator(".card");
    const { readdirSync } = await import("node:fs");
    const names = readdirSync(new URL("../../../examples", import.meta.url)).filter((file) => /\.(gtr|crt)$/.test(file));
    assert.equal(await cards.count(), names.length);
    for (let at = 0; at < names.length; at += 1) {
        await cards.nth(at).scrollIntoViewIfNeeded();
    }
    await page.waitForFunction(() => [...document.querySelectorAll(".card img")].every((image) => image.complete));
    const broken = await page.evaluate(() => [...document.querySelectorAll(".card img")].filter((image) => image.naturalWidth === 0).length);
    assert.equal(broken, 0);
    await page.locator(".card", { hasText: "torus" }).first().click();
    await settled(page);
    await page.waitForFunction(() => /\.gtr$/.test(document.querySelector(".head .name").value));
    await state.close(page);
});

test("the first program is taught once", async () => {
    const page = await state.open();
    await page.locator(".welcome").waitFor();
    await page.getByRole("button", { name: "Close the first steps" }).click();
    await page.locator(".welcome").waitFor({ state: "hidden" });
    await page.reload();
    await settled(page);
    assert.equal(await page.locator(".welcome").isVisible(), false);
    assert.ok(example("torus.gtr").length > 0);
    await state.close(page);
});
