// The commands that need no language server: a new program from an example, and a picture of a program as a file.

import { execFile } from "node:child_process";
import { readdir, readFile } from "node:fs/promises";
import { basename, extname, join } from "node:path";
import * as vscode from "vscode";

/** An example in the list that the user chooses from. */
interface Example extends vscode.QuickPickItem {
    text: string;
}

/** Reads the examples of a folder. The first comment line of each says what it is. */
async function readExamples(folder: string): Promise<Example[]> {
    const names = (await readdir(folder)).filter((name) => extname(name) === ".gtr").sort();
    return Promise.all(
        names.map(async (name) => {
            const text = await readFile(join(folder, name), "utf8");
            const [first = ""] = text.split("\n");
            return { label: basename(name, ".gtr"), detail: first.replace(/^#\s*/, ""), text };
        }),
    );
}

/** Opens an example as a new, unsaved document. Without a name, the user chooses one. */
export async function newFromExample(folder: string, name?: string): Promise<void> {
    const examples = await readExamples(folder);
    const example =
        name === undefined
            ? await vscode.window.showQuickPick(examples, { title: "New Geotrace program", matchOnDetail: true })
            : examples.find((it) => it.label === name);
    if (example !== undefined) {
        const document = await vscode.workspace.openTextDocument({ language: "geotrace", content: example.text });
        await vscode.window.showTextDocument(document);
    }
}

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
