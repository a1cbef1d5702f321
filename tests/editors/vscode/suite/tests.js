// What a user of VS Code sees where there are programs.
const assert = require("node:assert");
const { existsSync, mkdtempSync, readFileSync, rmSync } = require("node:fs");
const { tmpdir } = require("node:os");
const { join } = require("node:path");
const vscode = require("vscode");
const { ask, eventually, open } = require("./workspace");

Object.assign(exports, require("./features"));

exports["before the server answers, words are coloured where they stand"] = async () => {
    const modules = join(vscode.env.appRoot, "node_modules");
    const textmate = require(join(modules, "vscode-textmate"));
    const oniguruma = require(join(modules, "vscode-oniguruma"));
    await oniguruma.loadWASM(readFileSync(join(modules, "vscode-oniguruma", "release", "onig.wasm")).buffer);
    const { extensionPath } = vscode.extensions.getExtension("geotrace.geotrace");
    const path = join(extensionPath, "syntaxes", "geotrace.tmLanguage.json");
    const grammar = await new textmate.Registry({
        onigLib: Promise.resolve({
            createOnigScanner: (patterns) => new oniguruma.OnigScanner(patterns),
            createOnigString: (string) => new oniguruma.OnigString(string),
        }),
        loadGrammar: async () => textmate.parseRawGrammar(readFileSync(path, "utf8"), path),
    }).loadGrammar("source.geotrace");
    let state = textmate.INITIAL;
    /** The words and set operators of the next line that have a colour, each with its scope. */
    const colored = (line) => {
        const { tokens, ruleStack } = grammar.tokenizeLine(line, state);
        state = ruleStack;
        const named = tokens.map((token) => [line.slice(token.startIndex, token.endIndex).trim(), token.scopes[1]]);
        const wanted = named.filter(([word, scope]) => scope && /^([a-zA-Z]+|[\\|&])$/.test(word));
        return wanted.map(([word, scope]) => `${word} ${scope.replace(".geotrace", "")}`);
    };
    assert.deepStrictEqual(colored("solid die = cube \\ ball @ scale 2 @ rotate (0,0,k), glass : 0.95;"), [
        "solid keyword.declaration",
        "die entity.name.function",
        "\\ keyword.operator",
        "scale support.function",
        "rotate support.function",
        "glass variable.other.property",
    ]);
    assert.deepStrictEqual(colored("light lamp = @ (2,-2,4), falloff : 5; camera eye = (0,4,-1) @ a & b | c,"), [
        "light keyword.declaration",
        "lamp variable.other.constant",
        "falloff variable.other.property",
        "camera keyword.declaration",
        "eye variable.other.constant",
        "& keyword.operator",
        "| keyword.operator",
    ]);
    assert.deepStrictEqual(colored("  aperture : 0.05, bokeh : star;"), [
        "aperture variable.other.property",
        "bokeh variable.other.property",
    ]);
    // The same words as names.
    assert.deepStrictEqual(colored("param light : [0,1]; define scale = light; curve color(radius) = (solid radius,"), [
        "param keyword.declaration",
        "light variable.other.constant",
        "define keyword.declaration",
        "scale variable.other.constant",
        "curve keyword.declaration",
        "color entity.name.function",
    ]);
    assert.deepStrictEqual(colored("  light, scale, solid), radius : [0,1];"), []);
};

exports["the preview's command runs from the palette and from a lens"] = async () => {
    const document = await open("surface s(u,v) = (u,v,0), u : [0,1], v : [0,1];");
    await ask("geotrace.preview");
    await ask("geotrace.preview", document.uri.toString(), { view: "geodesic", surface: "s" });
};

exports["a picture is exported with edits that are not saved"] = async () => {
    const document = await open("surface s(u,v) = (u,v,u v), u : [0,1], v : [0,1];");
    const folder = mkdtempSync(join(tmpdir(), "geotrace-picture-"));
    const target = join(folder, "picture.png");
    await ask("geotrace.exportPicture", document.uri, vscode.Uri.file(target));
    const bytes = readFileSync(target);
    assert.strictEqual(bytes.toString("latin1", 1, 4), "PNG");
    assert.deepStrictEqual([bytes.readUInt32BE(16), bytes.readUInt32BE(20)], [1600, 1200]);
    rmSync(folder, { recursive: true });
};

exports["a picture of a script is exported, and one has the images beside its program"] = async () => {
    const folder = mkdtempSync(join(tmpdir(), "geotrace-picture-"));
    const target = vscode.Uri.file(join(folder, "picture.png"));
    const exported = async (document) => {
        await ask("geotrace.exportPicture", document.uri, target);
        return readFileSync(target.fsPath);
    };
    const script = await open("Scene {\n    Sphere {\n        center -> vec3(0, 0, 0)\n        radius -> 1\n    }\n}\n", "crt");
    assert.strictEqual((await exported(script)).toString("latin1", 1, 4), "PNG");
    const image = vscode.Uri.joinPath(vscode.workspace.workspaceFolders[0].uri, "beside.png");
    const surface = (attribute) => open(`surface s(u,v) = (u,v,u v), u : [0,1], v : [0,1]${attribute};`);
    const { extensionPath } = vscode.extensions.getExtension("geotrace.geotrace");
    await vscode.workspace.fs.copy(vscode.Uri.file(join(extensionPath, "icon.png")), image);
    const [plain, laid] = [await exported(await surface("")), await exported(await surface(", image : beside"))];
    await vscode.workspace.fs.delete(image);
    const gone = await exported(await surface(", image : beside"));
    assert.ok(!laid.equals(plain) && !laid.equals(gone), "the image is not in the picture");
    rmSync(folder, { recursive: true });
};

exports["the manifest has what the marketplace shows, and no address that was not given"] = () => {
    const { packageJSON: manifest, extensionPath } = vscode.extensions.getExtension("geotrace.geotrace");
    assert.ok(existsSync(join(extensionPath, manifest.icon)));
    assert.ok(existsSync(join(extensionPath, manifest.contributes.languages[0].icon.light)));
    for (const { media } of manifest.contributes.walkthroughs[0].steps) {
        assert.ok(existsSync(join(extensionPath, media.markdown)), media.markdown);
    }
    assert.deepStrictEqual([manifest.repository, manifest.bugs, manifest.homepage], [undefined, undefined, undefined]);
    assert.ok(!readFileSync(join(extensionPath, "readme.md"), "utf8").includes("!["));
};

exports["a program that is not there is told of, and nothing hangs"] = async () => {
    const api = vscode.extensions.getExtension("geotrace.geotrace").exports;
    const settings = vscode.workspace.getConfiguration("geotrace");
    const before = settings.get("server.path");
    await settings.update("server.path", "/no/such/geotrace", vscode.ConfigurationTarget.Global);
    await eventually("the sentence", () => /not running/.test(api.status()));
    // The commands are there, and say why they do nothing.
    await open("point p = (1, 2, 3);");
    await ask("geotrace.preview");
    await ask("geotrace.exportPicture");
    await settings.update("server.path", before, vscode.ConfigurationTarget.Global);
    await eventually("the server", () => /running, version/.test(api.status()));
};
