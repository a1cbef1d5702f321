// What a user of VS Code sees, through the editor's own API.
const assert = require("node:assert");
const vscode = require("vscode");

exports["without a program the status says so, and nothing hangs"] = async () => {
    const extension = vscode.extensions.getExtension("geotrace.geotrace");
    assert.ok(extension, "the extension is there");
    const api = await extension.activate();
    assert.match(api.status(), /not running/);
};
