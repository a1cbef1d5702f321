// What a user sees of the language server, through the editor's own API: whether it is a program or WebAssembly.
const assert = require("node:assert");
const vscode = require("vscode");
const { ask, edit, eventually, found, open } = require("./workspace");

exports["the extension starts the server, and its status says so"] = async () => {
    const document = await open("define a = 1;");
    assert.strictEqual(document.languageId, "geotrace");
    const extension = vscode.extensions.getExtension("geotrace.geotrace");
    assert.ok(extension, "the extension is there");
    const api = await extension.activate();
    await eventually("the server", () => /running, version \d/.test(api.status()));
};

exports["a mistake stands at its place, once"] = async () => {
    const document = await open("# 𝛼 beyond the first plane\ndefine b = 1 + sinn 2; # é");
    await eventually("a diagnostic", () => found(document).length > 0);
    await new Promise((resolve) => setTimeout(resolve, 500));
    const list = found(document);
    assert.strictEqual(list.length, 1, JSON.stringify(list));
    const { range, code, source, message } = list[0];
    assert.deepStrictEqual([range.start.line, range.start.character], [1, 18]);
    assert.strictEqual(code?.value ?? code, "undefined-name");
    assert.strictEqual(source, "geotrace");
    assert.match(message, /did you mean `sin`/);
};

exports["a related place points at the definition"] = async () => {
    const document = await open("define a = 1;\ndefine a = 2;");
    const list = await eventually("a diagnostic", () => found(document).length > 0 && found(document));
    const related = list[0].relatedInformation[0];
    assert.deepStrictEqual([related.location.range.start.line, related.location.range.start.character], [0, 7]);
};

exports["edits change the diagnostics, columns beyond the first plane too"] = async () => {
    const document = await open("define a = 1; # 𝛼\ndefine b = a;");
    await edit(document, new vscode.Range(0, 0, 0, 0), "# 𝛼𝛼\n");
    await edit(document, new vscode.Range(1, 7, 1, 8), "c");
    await eventually("the loss of a", () => {
        const list = found(document);
        return list.length === 1 && list[0].range.start.line === 2 && list[0].range.start.character === 11;
    });
    await edit(document, new vscode.Range(1, 7, 1, 8), "a");
    await eventually("all well again", () => found(document).length === 0);
};

exports["colours are by meaning"] = async () => {
    const document = await open("param r : [1,2];\nsurface s(u,v) = (r cosu, v, 0), u : [0,1], v : [0,1];");
    const legend = await ask("vscode.provideDocumentSemanticTokensLegend", document.uri);
    const tokens = await ask("vscode.provideDocumentSemanticTokens", document.uri);
    const shown = [];
    let [line, column] = [0, 0];
    for (let k = 0; k < tokens.data.length; k += 5) {
        const [lines, columns, length, type, modifiers] = tokens.data.slice(k, k + 5);
        [line, column] = lines > 0 ? [line + lines, columns] : [line, column + columns];
        const names = legend.tokenModifiers.filter((_, bit) => modifiers & (1 << bit));
        const word = document.getText(new vscode.Range(line, column, line, column + length));
        shown.push([word, legend.tokenTypes[type], ...names].join(" "));
    }
    for (const wanted of [
        "param keyword",
        "r variable declaration param",
        "s function declaration surface",
        "cos function defaultLibrary",
        "u parameter",
    ]) {
        assert.ok(shown.includes(wanted), `${wanted} in ${shown.join("; ")}`);
    }
};

exports["hover, signature, completion and definition answer"] = async () => {
    const document = await open("define tau = 2pi;\nfunction f(x,y) = x y;\ndefine b = f(tau, 1);");
    const at = new vscode.Position(2, 14);
    const [hover] = await ask("vscode.executeHoverProvider", document.uri, at);
    assert.match(hover.contents.map((content) => content.value).join(), /= 6\.2832/);
    const help = await ask("vscode.executeSignatureHelpProvider", document.uri, new vscode.Position(2, 18), ",");
    assert.strictEqual(help.signatures[0].label, "f(x, y)");
    assert.strictEqual(help.activeParameter, 1);
    const list = await ask("vscode.executeCompletionItemProvider", document.uri, at);
    const labels = list.items.map((item) => item.label);
    assert.ok(labels.includes("tau"), labels.join());
    const [definition] = await ask("vscode.executeDefinitionProvider", document.uri, at);
    assert.strictEqual((definition.range ?? definition.targetRange).start.line, 0);
};

exports["renaming writes words apart where they would be read otherwise"] = async () => {
    const document = await open("define c = 2;\nfunction f(s) = cs;");
    const change = await ask("vscode.executeDocumentRenameProvider", document.uri, new vscode.Position(0, 7), "ab");
    assert.ok(await vscode.workspace.applyEdit(change));
    assert.strictEqual(document.getText(), "define ab = 2;\nfunction f(s) = ab s;");
    await assert.rejects(
        async () => ask("vscode.executeDocumentRenameProvider", document.uri, new vscode.Position(0, 7), "sin"),
        /name of a builtin/,
    );
};

exports["solids are coloured, completed and described, and colours are picked"] = async () => {
    const text = [
        "solid ball(x,y,z) = x^2 + y^2 + z^2 - 1, color : (1, 0.5, 0);",
        "solid die = ball @ scale 2, ;",
        "camera eye = (0,1,0) @ (0,-4,0), bokeh : ;",
    ];
    const document = await open(text.join("\n"));
    const at = (line, needle) => new vscode.Position(line, text[line].indexOf(needle) + needle.length);
    const labels = async (place) => {
        const list = await ask("vscode.executeCompletionItemProvider", document.uri, place);
        return list.items.map((item) => item.label);
    };
    const attributes = await labels(at(1, "2, "));
    for (const wanted of ["mirror", "glass", "ior"]) {
        assert.ok(attributes.includes(wanted), `${wanted} in ${attributes.join()}`);
    }
    assert.ok((await labels(at(2, "bokeh : "))).includes("star"));
    assert.ok((await labels(at(1, "@ "))).includes("scale"));
    const [hover] = await ask("vscode.executeHoverProvider", document.uri, at(0, "solid b"));
    assert.match(hover.contents.map((content) => content.value).join(), /quadric/);
    const [color] = await ask("vscode.executeDocumentColorProvider", document.uri);
    assert.deepStrictEqual([color.color.red, color.color.green, color.color.blue], [1, 0.5, 0]);
    const place = { uri: document.uri, range: color.range };
    const [first] = await ask("vscode.executeColorPresentationProvider", new vscode.Color(0, 0.25, 1, 1), place);
    await edit(document, first.textEdit.range, first.textEdit.newText);
    assert.match(document.lineAt(0).text, /color : \(0, 0\.25, 1\);$/);
};

exports["a script is coloured, described, completed, renamed and laid out"] = async () => {
    const text = [
        "ball = Sphere { center -> vec3(0, 0.5, 0)  radius -> 0.5  material -> Material { color -> rgb(1, 0.5, 0) } }",
        "n = 6 * 3",
        "row = Macro (step) { ball <translate vec3(step * n, 0, 0)> }",
        "Scene { row(1.5) }",
    ];
    const document = await open(text.join("\n"), "crt");
    assert.strictEqual(document.languageId, "crt");
    const legend = await ask("vscode.provideDocumentSemanticTokensLegend", document.uri);
    const tokens = await ask("vscode.provideDocumentSemanticTokens", document.uri);
    assert.strictEqual(legend.tokenTypes[tokens.data[3]], "variable");
    assert.deepStrictEqual(found(document), []);
    const described = async (line, column) => {
        const place = new vscode.Position(line, column);
        const hovers = await ask("vscode.executeHoverProvider", document.uri, place);
        return hovers.flatMap((hover) => hover.contents.map((content) => content.value)).join();
    };
    assert.match(await described(1, 0), /`18`, an Integer/);
    assert.match(await described(0, 44), /Required/);
    const symbols = await ask("vscode.executeDocumentSymbolProvider", document.uri);
    assert.deepStrictEqual(
        symbols.map((symbol) => symbol.name),
        ["ball", "row", "Scene"],
    );
    const inside = new vscode.Position(0, text[0].indexOf("radius"));
    const list = await ask("vscode.executeCompletionItemProvider", document.uri, inside);
    assert.ok(list.items.length > 0);
    const [color] = await ask("vscode.executeDocumentColorProvider", document.uri);
    assert.deepStrictEqual([color.color.red, color.color.green, color.color.blue], [1, 0.5, 0]);
    const step = new vscode.Position(2, text[2].indexOf("step"));
    const change = await ask("vscode.executeDocumentRenameProvider", document.uri, step, "distance");
    assert.ok(await vscode.workspace.applyEdit(change));
    assert.match(document.lineAt(2).text, /^row = Macro \(distance\) \{ ball <translate vec3\(distance \* n, 0, 0\)> \}$/);
    const edits = await ask("vscode.executeFormatDocumentProvider", document.uri, { tabSize: 4, insertSpaces: true });
    const layout = new vscode.WorkspaceEdit();
    layout.set(document.uri, edits);
    assert.ok(await vscode.workspace.applyEdit(layout));
    assert.match(document.getText(), /^ball = Sphere \{\n    center -> vec3\(0, 0\.5, 0\)\n    radius -> 0\.5\n/);
};

exports["the mistakes of a script come with their places, and a certificate has none"] = async () => {
    const document = await open("ball = Spere { radius -> 1 }\nScene { ball }\n", "crt");
    const list = await eventually("a diagnostic", () => found(document).length > 0 && found(document));
    assert.strictEqual(list[0].code?.value ?? list[0].code, "unknown-object");
    assert.deepStrictEqual([list[0].range.start.line, list[0].range.start.character], [0, 7]);
    await edit(document, new vscode.Range(0, 7, 0, 12), "Sphere");
    await eventually("another one", () => found(document)[0]?.message.includes("center"));
    const certificate = await open("-----BEGIN CERTIFICATE-----\nMIIB==\n", "crt");
    await new Promise((resolve) => setTimeout(resolve, 300));
    assert.deepStrictEqual(found(certificate), []);
};

exports["a script becomes a program"] = async () => {
    const document = await open(
        "Scene { Sphere { center -> vec3(0, 0, 5) radius -> 1 } }\n",
        "crt",
    );
    const range = new vscode.Range(0, 0, 0, 0);
    const actions = await ask("vscode.executeCodeActionProvider", document.uri, range, "source.convert");
    assert.strictEqual(actions.length, 1, actions.map((action) => action.title).join());
    const { command, arguments: given } = actions[0].command;
    await ask(command, ...given);
    const path = document.uri.path.replace(/\.crt$/, ".gtr");
    const program = await eventually("the program", () =>
        vscode.workspace.textDocuments.find((other) => other.uri.path === path && other.lineCount > 3),
    );
    assert.match(program.getText(), /^# geotrace render [^]*\nsolid /);
};

exports["formatting lays the text out"] = async () => {
    const document = await open("define   a=1 ;define b = a+1;");
    const edits = await ask("vscode.executeFormatDocumentProvider", document.uri, { tabSize: 4, insertSpaces: true });
    const change = new vscode.WorkspaceEdit();
    change.set(document.uri, edits);
    assert.ok(await vscode.workspace.applyEdit(change));
    assert.strictEqual(document.getText(), "define a = 1;\ndefine b = a + 1;\n");
};

exports["the lines of a declaration are indented once, by Enter and by Reindent Lines"] = async () => {
    const document = await open("");
    const lines = [
        "surface s(u, v) = (u, v, u v),",
        "    u : [-1, 1],",
        "    v : [-1, 1];",
        "solid b(x, y, z) = x^2 + y^2 + z^2 - 1,",
        "    mirror : 0.5;",
        "point p = (1, 2, 3);",
    ];
    for (const [at, line] of lines.entries()) {
        // VS Code indents a line where it has read the ones above, which it does after a key.
        await new Promise((resolve) => setTimeout(resolve, 50));
        await ask("type", { text: at === 0 ? "" : "\n" });
        await ask("type", { text: line.trim() });
    }
    assert.strictEqual(document.getText().replaceAll("\r", ""), lines.join("\n"));
    const flat = new vscode.Range(0, 0, document.lineCount, 0);
    await edit(document, flat, lines.map((line) => line.trim()).join("\n"));
    await ask("editor.action.reindentlines");
    assert.strictEqual(document.getText().replaceAll("\r", ""), lines.join("\n"));
};

exports["a quick fix mends a mistake"] = async () => {
    const document = await open("define b = sinn 2;");
    await eventually("a diagnostic", () => found(document).length > 0);
    const range = found(document)[0].range;
    const actions = await ask("vscode.executeCodeActionProvider", document.uri, range, "quickfix");
    const fix = actions.find((action) => action.title === "Change to `sin`");
    assert.ok(fix, actions.map((action) => action.title).join());
    assert.ok(await vscode.workspace.applyEdit(fix.edit));
    assert.strictEqual(document.getText(), "define b = sin 2;");
};

exports["symbols, folds, hints and lenses are there"] = async () => {
    const document = await open("surface s(u,v) = (u,\n  v, uv), u : [0,1], v : [0,1];");
    const symbols = await ask("vscode.executeDocumentSymbolProvider", document.uri);
    assert.strictEqual(symbols[0].name, "s");
    const folds = await ask("vscode.executeFoldingRangeProvider", document.uri);
    assert.deepStrictEqual([folds[0].start, folds[0].end], [0, 1]);
    const hints = await ask("vscode.executeInlayHintProvider", document.uri, new vscode.Range(0, 0, 2, 0));
    assert.strictEqual(hints[0].label, "·");
    const lenses = await ask("vscode.executeCodeLensProvider", document.uri);
    assert.deepStrictEqual(lenses.map((lens) => lens.command.title).sort(), ["3D", "geodesic view"]);
};

exports["an example is opened as a new program"] = async () => {
    await ask("geotrace.newFromExample", "ellipsoid");
    const { document } = vscode.window.activeTextEditor;
    assert.ok(document.isUntitled);
    assert.strictEqual(document.languageId, "geotrace");
    assert.match(document.getText(), /^# An ellipsoid/);
    assert.deepStrictEqual(found(document), []);
};

exports["settings reach the server"] = async () => {
    const document = await open("surface s(u,v) = (u,v,uv), u : [0,1], v : [0,1];");
    const settings = vscode.workspace.getConfiguration("geotrace");
    const lenses = async () => (await ask("vscode.executeCodeLensProvider", document.uri)).length;
    assert.strictEqual(await lenses(), 2);
    await settings.update("codeLens", false, vscode.ConfigurationTarget.Global);
    await eventually("no lens", async () => (await lenses()) === 0);
    await settings.update("codeLens", undefined, vscode.ConfigurationTarget.Global);
    await eventually("the lenses again", async () => (await lenses()) === 2);
};

exports["the server can be restarted"] = async () => {
    const document = await open("define b = sinn 2;");
    await eventually("a diagnostic", () => found(document).length === 1);
    await ask("geotrace.restart");
    const api = vscode.extensions.getExtension("geotrace.geotrace").exports;
    await eventually("the server", () => /running/.test(api.status()));
    await eventually("a diagnostic again", () => found(document).length === 1);
};
