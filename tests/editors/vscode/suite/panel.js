// The preview inside VS Code, in a real webview: the extension was packed with the page.
const assert = require("node:assert");
const vscode = require("vscode");
const { eventually, openAs } = require("./workspace");

const SPHERE = `param r = 1 : [0.5, 2];
surface s(u, v) = (r sin(v) cos(u), r sin(v) sin(u), r cos(v)), u : [0, 2pi], v : [0, pi];
`;

/** Opens a document with its panel, and waits for its first picture. */
async function open(name, text) {
    const document = await openAs(name, text);
    const api = await vscode.extensions.getExtension("geotrace.geotrace").activate();
    await vscode.commands.executeCommand("geotrace.previewToSide");
    const panels = api.panels();
    const uri = document.uri.toString();
    await eventually("the first picture", () => panels.shown(uri) !== undefined);
    return { document, panels, uri };
}

const tabs = () => vscode.window.tabGroups.all.flatMap((group) => group.tabs).map((tab) => tab.label);

exports["the panel opens beside the text, and follows what is typed"] = async () => {
    const { document, panels, uri } = await open("one.gtr", SPHERE);
    assert.ok(tabs().includes("Preview one.gtr"), tabs().join());
    const before = panels.shown(uri);
    const change = new vscode.WorkspaceEdit();
    // Two places at once: VS Code names the last one first.
    change.insert(document.uri, new vscode.Position(1, SPHERE.split("\n")[1].indexOf("r cos(v)),")), "2");
    change.insert(document.uri, new vscode.Position(0, 0), "# é𝛼\n");
    assert.ok(await vscode.workspace.applyEdit(change));
    await eventually("the picture of the edit", () => panels.shown(uri) > before);
    await vscode.commands.executeCommand("geotrace.previewToSide");
    assert.strictEqual(tabs().filter((label) => label === "Preview one.gtr").length, 1, "it is opened once");
};

exports["a range that the panel names is selected, also in a text with CRLF"] = async () => {
    for (const [name, text] of [
        ["two.gtr", SPHERE],
        ["three.gtr", SPHERE.replaceAll("\n", "\r\n")],
    ]) {
        const { document, panels, uri } = await open(name, text);
        const from = SPHERE.indexOf("surface");
        const version = panels.shown(uri);
        await panels.say(uri, { said: "select", range: { from, to: from + 9 }, version });
        const editor = vscode.window.activeTextEditor;
        assert.strictEqual(editor.document, document);
        assert.strictEqual(document.getText(editor.selection), "surface s");
        const at = SPHERE.indexOf("1 :");
        await panels.say(uri, { said: "apply", edits: [{ from: at, to: at + 1, insert: "1.5" }], version });
        assert.match(document.getText(), /^param r = 1\.5 : \[0\.5, 2\];/);
        await eventually("the picture of the edit", () => panels.shown(uri) > version);
    }
};

exports["a document that is opened in the background opens no panel, one in an editor does"] = async () => {
    const settings = vscode.workspace.getConfiguration("geotrace");
    await settings.update("preview.in", "panel", vscode.ConfigurationTarget.Workspace);
    await settings.update("preview.open", "onOpen", vscode.ConfigurationTarget.Workspace);
    const uri = vscode.Uri.joinPath(vscode.workspace.workspaceFolders[0].uri, "behind.gtr");
    await vscode.workspace.fs.writeFile(uri, new TextEncoder().encode(SPHERE));
    const document = await vscode.workspace.openTextDocument(uri);
    await new Promise((resolve) => setTimeout(resolve, 1000));
    assert.ok(!tabs().some((label) => label.includes("behind.gtr")), tabs().join());
    await vscode.window.showTextDocument(document, vscode.ViewColumn.One);
    await eventually("the panel", () => tabs().includes("Preview behind.gtr"));
    await settings.update("preview.in", undefined, vscode.ConfigurationTarget.Workspace);
    await settings.update("preview.open", undefined, vscode.ConfigurationTarget.Workspace);
};

exports["the command opens the panel where the setting says so, and it closes with its tab"] = async () => {
    const settings = vscode.workspace.getConfiguration("geotrace");
    await settings.update("preview.in", "panel", vscode.ConfigurationTarget.Workspace);
    const document = await openAs("four.gtr", SPHERE);
    const api = await vscode.extensions.getExtension("geotrace.geotrace").activate();
    await eventually("the server", () => /running/.test(api.status()));
    await vscode.commands.executeCommand("geotrace.preview");
    const uri = document.uri.toString();
    await eventually("the first picture", () => api.panels().shown(uri) !== undefined);
    await vscode.commands.executeCommand("geotrace.preview", uri, { view: "geodesic", surface: "s" });
    const tab = vscode.window.tabGroups.all.flatMap((group) => group.tabs).find((it) => it.label === "Preview four.gtr");
    await vscode.window.tabGroups.close(tab);
    await eventually("its end", () => api.panels().shown(uri) === undefined);
    await settings.update("preview.in", undefined, vscode.ConfigurationTarget.Workspace);
};

exports["where there is no display the preview is a panel"] = async () => {
    // In a browser there is no process.
    const { DISPLAY, WAYLAND_DISPLAY } = globalThis.process?.env ?? {};
    if (DISPLAY || WAYLAND_DISPLAY) {
        return;
    }
    const settings = vscode.workspace.getConfiguration("geotrace");
    await settings.update("preview.open", "onOpen", vscode.ConfigurationTarget.Workspace);
    const first = await openAs("five.gtr", SPHERE);
    const api = await vscode.extensions.getExtension("geotrace.geotrace").activate();
    await eventually("the first picture", () => api.panels().shown(first.uri.toString()) !== undefined);
    await settings.update("preview.open", undefined, vscode.ConfigurationTarget.Workspace);
    const second = await openAs("six.gtr", SPHERE);
    await vscode.commands.executeCommand("geotrace.preview");
    await eventually("the first picture", () => api.panels().shown(second.uri.toString()) !== undefined);
};
