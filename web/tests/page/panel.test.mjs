// The preview inside VS Code, with a host of the test's own in VS Code's place: `tests/editors` runs it in the real one.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { launch, settled } from "./browser.mjs";
import { changed, dist, middle, picture, rest, SPHERE } from "./harness.mjs";
import { serve } from "./serve.mjs";

const HOST = `<!doctype html><title>Host</title>
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; script-src 'self' 'unsafe-inline' 'wasm-unsafe-eval'; style-src 'unsafe-inline'; connect-src 'self' blob:; img-src blob: data:; worker-src blob:">
<script>
    const said = [];
    let state;
    const acquireVsCodeApi = () => ({
        postMessage: (message) => said.push(structuredClone(message)),
        getState: () => state,
        setState: (next) => (state = structuredClone(next)),
    });
</script>
<script type="module" src="panel.js"></script>
<body class="vscode-dark"></body>`;

let browser;
let server;
before(async () => {
    server = await serve(dist, { "/host.html": HOST });
    browser = await launch();
});
after(async () => {
    await browser?.close();
    await server?.close();
});

/** Opens the panel with a program. */
async function open(text) {
    const page = await browser.newPage({ viewport: { width: 500, height: 700 } });
    page.failures = [];
    page.on("pageerror", (error) => page.failures.push(error.message));
    page.on("console", (message) => message.type() === "error" && page.failures.push(message.text()));
    await page.goto(`${server.url}host.html`);
    await page.waitForFunction(() => said.some((it) => it.said === "ready"));
    await tell(page, { told: "open", name: "test.gtr", text, version: 1 });
    await settled(page);
    return page;
}

const tell = (page, told) => page.evaluate((message) => window.postMessage(message, "*"), told);
const heard = async (page, what) => {
    await page.waitForFunction((name) => said.some((it) => it.said === name), what);
    return page.evaluate((name) => said.filter((it) => it.said === name).at(-1), what);
};

test("it shows the program and follows its edits", async () => {
    const page = await open(SPHERE);
    const before = await picture(page);
    assert.ok(before.colours > 50);
    const at = SPHERE.indexOf("r cos(v)),");
    await tell(page, { told: "edit", version: 2, changes: [{ from: at, to: at, insert: "2" }] });
    await changed(page, before);
    assert.equal((await heard(page, "shown")).version, 2);
    assert.deepEqual(page.failures, []);
    await page.close();
});

test("a text that is told anew is an edit of the one that is open", async () => {
    const page = await open(SPHERE);
    await page.getByRole("textbox", { name: "Value of r" }).fill("1.25");
    await page.keyboard.press("Enter");
    const before = await rest(page);
    await tell(page, { told: "open", name: "test.gtr", text: `x${SPHERE}`, version: 2 });
    await page.waitForTimeout(1000);
    assert.ok((await picture(page)).colours > 50, "a mistake keeps the picture");
    assert.equal(await page.locator('[data-view="geodesic:s"]').count(), 1);
    assert.equal(await page.getByRole("slider", { name: "r" }).count(), 1);
    await tell(page, { told: "open", name: "test.gtr", text: SPHERE.replace("r cos(v))", "2r cos(v))"), version: 3 });
    await changed(page, before);
    assert.equal(await page.getByRole("textbox", { name: "Value of r" }).inputValue(), "1.25");
    assert.equal((await heard(page, "shown")).version, 3);
    assert.deepEqual(page.failures, []);
    await page.close();
});

test("a double click selects the declaration, a slider's value is written into the text", async () => {
    const page = await open(SPHERE);
    const { x, y } = await middle(page);
    await page.mouse.dblclick(x, y);
    const { range, version } = await heard(page, "select");
    assert.match(SPHERE.slice(range.from, range.to), /s/);
    assert.equal(version, 1);
    await page.getByRole("textbox", { name: "Value of r" }).fill("1.25");
    await page.keyboard.press("Enter");
    await page.getByRole("button", { name: "Write r into the program" }).click();
    const { edits } = await heard(page, "apply");
    const [{ from, to, insert }] = edits;
    assert.match(SPHERE.slice(0, from) + insert + SPHERE.slice(to), /^param r = 1\.25 :/);
    await page.close();
});

test("it opens the views that the lenses of the editor name", async () => {
    const page = await open(`${SPHERE}solid b(x, y, z) = x^2 + y^2 + z^2 - 4;
light l = @ (2, -2, 4);
camera c = (0, 4, -1) @ (0, -4, 1);
camera d = (0, -4, -1) @ (0, 4, 1);
`);
    const isOpen = (view) => page.locator(`[data-view="${view}"][data-exact=true]`);
    assert.equal(await isOpen("geodesic:b").count(), 0);
    await tell(page, { told: "view", view: "geodesic", surface: "b" });
    await isOpen("geodesic:b").waitFor();
    await page.getByRole("button", { name: "Close 3D view" }).click();
    await isOpen("3d").waitFor({ state: "detached" });
    await tell(page, { told: "view", view: "traced", surface: "d" });
    await isOpen("3d").waitFor();
    assert.equal(await page.getByRole("button", { name: "Traced", pressed: true }).count(), 1);
    await page.getByRole("tab", { name: "Views" }).click();
    assert.equal(await page.getByLabel("Look through").inputValue(), "d");
    await tell(page, { told: "view", view: "3d" });
    await page.getByRole("button", { name: "Traced", pressed: false }).waitFor();
    assert.deepEqual(page.failures, []);
    await page.close();
});

test("a picture is handed to the host", async () => {
    const page = await open(SPHERE);
    await page.getByRole("button", { name: "Save a picture of 3D view" }).click();
    await page.getByRole("button", { name: "Save", exact: true }).click();
    const { name, base64 } = await heard(page, "save");
    assert.equal(name, "test-3d.png");
    assert.equal(Buffer.from(base64, "base64").subarray(1, 4).toString(), "PNG");
    await page.close();
});
