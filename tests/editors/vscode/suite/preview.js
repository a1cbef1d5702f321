// The preview as a user of VS Code meets it: the real window on a display of the test's own, driven by xdotool, and looked
// at by screenshots. GEOTRACE_REPORT is where the window leaves its counters, GEOTRACE_SCRATCH a folder for screenshots.
const assert = require("node:assert");
const { execFileSync, spawnSync } = require("node:child_process");
const { existsSync, mkdtempSync, readFileSync, writeFileSync } = require("node:fs");
const { tmpdir } = require("node:os");
const { join } = require("node:path");
const vscode = require("vscode");
const { eventually } = require("./workspace");

const { GEOTRACE_REPORT: reportFile, GEOTRACE_SCRATCH: scratch } = process.env;
const run = (program, ...rest) => execFileSync(program, rest, { encoding: "utf8" }).trim();

/** The window's counters as it left them last. */
function report() {
    let last;
    try {
        for (const line of readFileSync(reportFile, "utf8").split("\n")) {
            try {
                last = JSON.parse(line);
            } catch {
                // The line is not written to its end yet.
            }
        }
    } catch {
        // The window has not begun.
    }
    return last;
}

let api;
let document;

/** Waits for the picture of the document as it is now. */
function picture() {
    const shown = () => api.shown().get(document.uri.toString());
    const what = () => `the picture of version ${document.version}; last was ${JSON.stringify(shown())}`;
    return eventually(what, () => shown()?.version === document.version && shown());
}

async function screenshot(name) {
    // All views have been drawn when the window draws itself no more.
    let frames;
    await eventually("rest", async () => {
        const before = frames;
        await new Promise((resolve) => setTimeout(resolve, 500));
        frames = report().frames;
        return frames === before;
    });
    const path = join(scratch, `vscode-${name}.png`);
    run("import", "-window", "root", path);
    return path;
}

/** How many pixels differ. */
function difference(one, other) {
    const { stderr } = spawnSync("compare", ["-metric", "AE", one, other, "null:"], { encoding: "utf8" });
    return Number.parseFloat(stderr);
}

async function replace(line, from, to, text) {
    const change = new vscode.WorkspaceEdit();
    change.replace(document.uri, new vscode.Range(line, from, line, to), text);
    assert.ok(await vscode.workspace.applyEdit(change));
}

/** The window's process: the server has the same words in its command line, but not first. */
const processes = () =>
    spawnSync("pgrep", ["-f", "--", `^[^ ]+ preview --attached --report ${reportFile}`], { encoding: "utf8" })
        .stdout.split("\n")
        .filter(Boolean);

let first;

exports["the command opens the window with the program's picture"] = async () => {
    const path = join(mkdtempSync(join(tmpdir(), "geotrace-preview-")), "vscode.gtr");
    writeFileSync(
        path,
        "# seen from VS Code\nparam vscode : [0.3, 0.9];\n" +
            "surface q(u,v) = (u, v, vscode sin(3u) cos(3v)), u : [-1, 1], v : [-1, 1];\n",
    );
    document = await vscode.workspace.openTextDocument(path);
    await vscode.window.showTextDocument(document);
    api = await vscode.extensions.getExtension("geotrace.geotrace").activate();
    await eventually("the server", () => /running, version \d/.test(api.status()));
    await vscode.commands.executeCommand("geotrace.preview");
    assert.ok((await picture()).ok);
    await eventually("its params", () => report()?.params.vscode);
    first = await screenshot("first");
};

exports["what is typed changes the picture"] = async () => {
    await replace(2, 35, 36, "1");
    assert.ok((await picture()).ok);
    assert.ok(difference(first, await screenshot("typed")) > 1000, "the picture is the same");
    await replace(2, 35, 36, "3");
    assert.ok((await picture()).ok);
};

exports["a mistake keeps the picture and marks it"] = async () => {
    const before = await screenshot("before-mistake");
    await replace(2, 35, 36, "nothing ");
    assert.ok(!(await picture()).ok);
    await eventually("the badge", () => report().stale);
    assert.ok(difference(before, await screenshot("mistake")) > 100, "nothing tells of the mistake");
    await replace(2, 35, 43, "3");
    assert.ok((await picture()).ok);
    await eventually("no badge", () => !report().stale);
};

exports["a double click on an object jumps to its declaration"] = async () => {
    const editor = vscode.window.activeTextEditor;
    editor.selection = new vscode.Selection(0, 0, 0, 0);
    const [window] = run("xdotool", "search", "--onlyvisible", "--class", "geotrace").split("\n");
    const [, [left, top, width, height]] = Object.entries(report().panes).sort()[0];
    for (const down of [0.5, 0.6, 0.4]) {
        const place = [left + width / 2, top + height * down].map((x) => String(Math.floor(x)));
        run("xdotool", "mousemove", "--window", window, ...place);
        run("xdotool", "click", "--repeat", "2", "--delay", "60", "1");
        const start = Date.now();
        while (Date.now() - start < 3000) {
            const { active } = vscode.window.activeTextEditor.selection;
            if (active.line === 2) {
                assert.strictEqual(vscode.window.activeTextEditor.selection.start.character, 8);
                return;
            }
            await new Promise((resolve) => setTimeout(resolve, 20));
        }
    }
    await screenshot("no-jump");
    throw new Error(`the cursor stays: ${JSON.stringify(report().panes)}`);
};

exports["a window that is killed does not take the server with it, and the command opens it anew"] = async () => {
    const [process] = processes();
    run("kill", "-9", process);
    // Until the server has noticed: before that, the process is on the way to its end.
    await eventually("its end", () => !existsSync(`/proc/${process}`));
    await replace(0, 0, 0, "#");
    const [hover] = await vscode.commands.executeCommand(
        "vscode.executeHoverProvider",
        document.uri,
        new vscode.Position(2, 8),
    );
    assert.ok(hover, "the server answers");
    await vscode.commands.executeCommand("geotrace.preview");
    assert.ok((await picture()).ok);
};

exports["the window closes when the server is stopped"] = async () => {
    await vscode.extensions.getExtension("geotrace.geotrace").exports.client().stop();
    await eventually("the end of the window", () => processes().length === 0);
};

// What becomes of this one is looked at when VS Code has ended: see `run.mjs`.
exports["a server that is started again has a window again"] = async () => {
    await vscode.commands.executeCommand("geotrace.restart");
    await eventually("the server", () => /running, version \d/.test(api.status()));
    api.shown().clear();
    await vscode.commands.executeCommand("geotrace.preview");
    assert.ok((await picture()).ok);
    assert.strictEqual(processes().length, 1);
};
