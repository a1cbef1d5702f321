// The command that writes a picture of a program as a file. It needs the program `geotrace`, but no language server.

import { execFile } from "node:child_process";
import { basename, dirname, extname } from "node:path";
import * as vscode from "vscode";
import { askForPicture } from "./panel";

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
    const file = target ?? (await askForPicture(document.uri, `${basename(uri.path, extname(uri.path))}.png`));
    if (file === undefined) {
        return;
    }
    const { problem, notes } = await render(program, document, file.fsPath);
    if (problem !== undefined) {
        void vscode.window.showErrorMessage(`The picture was not written: ${problem}`);
        return;
    }
    const open = "Open";
    const message = [`The picture was written to ${file.fsPath}.`, ...notes].join(" ");
    // Not awaited: the command is done.
    void vscode.window.showInformationMessage(message, open).then((choice) => {
        if (choice === open) {
            return vscode.commands.executeCommand("vscode.open", file);
        }
        return undefined;
    });
}

/** What went wrong, if anything did, and what the picture lacks, as sentences. */
interface Rendered {
    problem: string | undefined;
    notes: string[];
}

/** Draws a document, as it is in the editor, into a file. */
function render(program: string, document: vscode.TextDocument, target: string): Promise<Rendered> {
    const language = document.languageId === "crt" ? "crt" : "geotrace";
    const given = ["render", "-", "--language", language, "-o", target, "--size", "1600x1200"];
    // Images lie beside the program.
    const where = document.uri.scheme === "file" ? { cwd: dirname(document.uri.fsPath) } : {};
    return new Promise((resolve) => {
        const child = execFile(program, given, where, (error, _out, said) => {
            const notes = [...said.matchAll(/^note: (.*)$/gm)].map(([, note]) => `Note: ${note}.`);
            resolve({ problem: error === null ? undefined : said.trim() || error.message, notes });
        });
        // A program that ends early closes its input: the callback above says why.
        child.stdin?.on("error", () => undefined);
        child.stdin?.end(document.getText());
    });
}
