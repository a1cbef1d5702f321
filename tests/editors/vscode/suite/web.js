// What a user of VS Code sees in a browser, where there is no program: the same as elsewhere. It is bundled for a Worker.
const assert = require("node:assert");
const vscode = require("vscode");
const { runAll } = require("./runner");
const { ask, eventually, found, open } = require("./workspace");

const tests = { ...require("./features"), ...require("./panel") };

tests["what needs a program is not offered, and the preview's command opens the panel"] = async () => {
    const commands = await vscode.commands.getCommands(true);
    assert.ok(!commands.includes("geotrace.exportPicture"), "no program draws pictures");
    const document = await open("surface s(u,v) = (u,v,u v), u : [0,1], v : [0,1];");
    const { packageJSON } = vscode.extensions.getExtension("geotrace.geotrace");
    assert.ok(!JSON.stringify(packageJSON).includes("exportPicture"), "the manifest names the command");
    const { panels } = vscode.extensions.getExtension("geotrace.geotrace").exports;
    await ask("geotrace.preview");
    await eventually("the picture", () => panels().shown(document.uri.toString()) !== undefined);
};

exports.run = () => runAll(tests);
