// What the tests have in common: documents in the workspace, and waiting.
const vscode = require("vscode");

let files = 0;

/** Opens a new document of the workspace with this text, of the language with this extension. */
exports.open = async (text, extension = "gtr") => {
    files += 1;
    return exports.openAs(`${files}.${extension}`, text);
};

/** Opens a new document of the workspace with this name. */
exports.openAs = async (name, text) => {
    const uri = vscode.Uri.joinPath(vscode.workspace.workspaceFolders[0].uri, name);
    await vscode.workspace.fs.writeFile(uri, new TextEncoder().encode(text));
    const document = await vscode.workspace.openTextDocument(uri);
    await vscode.window.showTextDocument(document, vscode.ViewColumn.One);
    return document;
};

/** Waits until the condition gives a value: the first frame of a window may take a software driver long. `what` may be a function. */
exports.eventually = async (what, condition) => {
    const start = Date.now();
    while (Date.now() - start < 60_000) {
        const value = await condition();
        if (value) {
            return value;
        }
        await new Promise((resolve) => setTimeout(resolve, 20));
    }
    throw new Error(`never came: ${typeof what === "string" ? what : what()}`);
};

exports.found = (document) => vscode.languages.getDiagnostics(document.uri);
exports.ask = (command, ...rest) => vscode.commands.executeCommand(command, ...rest);

exports.edit = async (document, range, text) => {
    const change = new vscode.WorkspaceEdit();
    change.replace(document.uri, range, text);
    if (!(await vscode.workspace.applyEdit(change))) {
        throw new Error("the edit was refused");
    }
};
