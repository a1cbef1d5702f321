// The command that writes a picture of a program as a file. It needs the program `geotrace`, but no language server.

import { execFile } from "node:child_process";
import { basename, extname, join } from "node:path";
import * as vscode from "vscode";

/**
 * Writes the 3D view of a program as a PNG file, with edits that are not saved. Without a document it is the active
 * editor's; without a target, the user chooses one.
 */
export async function exportPicture(program: string, source?: vscode.Uri, target?: vscode.Uri): Promise<void> {
    const uri = source ?? vscode.window.activeTextEditor?.document.uri;
    if (uri === undefined) {
        return;
    }
    const document = await vscode.workspace.openTextDocument(uri);
    const file = target ?? (await askForTarget(document.uri));
    if (file === undefined) {
        return;
    }
    const problem = await render(program, document.getText(), file.fsPath);
    if (problem !== undefined) {
        void vscode.window.showErrorMessage(`The picture was not written: ${problem}`);
        return;
    }
    const open = "Open";
    const message = `The picture was written to ${file.fsPath}.`;
    // Not awaited: the command is done.
    void vscode.window.showInformationMessage(message, open).then((choice) => {
        if (choice === open) {
            return vscode.commands.executeCommand("vscode.open", file);
        }
        return undefined;
    });
}

function askForTarget(document: vscode.Uri): Thenable<vscode.Uri | undefined> {
    const name = `${basename(document.path, extname(document.path))}.png`;
    const defaultUri =
        document.scheme === "file" ? vscode.Uri.joinPath(document, "..", name) : vscode.Uri.file(join("/", name));
    return vscode.window.showSaveDialog({ defaultUri, filters: { PNG: ["png"] } });
}

/** Draws a program's text into a file. Returns what went wrong, if anything did. */
function render(program: string, text: string, target: string): Promise<string | undefined> {
    return new Promise((resolve) => {
        const child = execFile(program, ["render", "-", "-o", target, "--size", "1600x1200"], (error, _out, said) =>
            resolve(error === null ? undefined : said.trim() || error.message),
        );
        // A program that ends early closes its input: the callback above says why.
        child.stdin?.on("error", () => undefined);
        child.stdin?.end(text);
    });
}
