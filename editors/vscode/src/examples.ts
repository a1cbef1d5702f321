// The command that begins a new program with an example.

import * as vscode from "vscode";

/** An example in the list that the user chooses from. */
interface Example extends vscode.QuickPickItem {
    text: string;
}

/** Reads the examples: an object of their texts by their names. The first comment line of each says what it is. */
async function readExamples(file: vscode.Uri): Promise<Example[]> {
    const json = new TextDecoder().decode(await vscode.workspace.fs.readFile(file));
    return Object.entries(JSON.parse(json) as Record<string, string>).map(([label, text]) => {
        const [first = ""] = text.split("\n");
        return { label, detail: first.replace(/^#\s*/, ""), text };
    });
}

/** Opens an example of a file as a new, unsaved document. Without a name, the user chooses one. */
export async function newFromExample(file: vscode.Uri, name?: string): Promise<void> {
    const examples = await readExamples(file);
    const example =
        name === undefined
            ? await vscode.window.showQuickPick(examples, { title: "New Geotrace program", matchOnDetail: true })
            : examples.find((it) => it.label === name);
    if (example !== undefined) {
        const document = await vscode.workspace.openTextDocument({ language: "geotrace", content: example.text });
        await vscode.window.showTextDocument(document);
    }
}
