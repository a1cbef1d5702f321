// The preview inside VS Code: the pictures and settings of the page (`web/src/panel.ts`) in a panel beside the editor. It
// needs no program: the core is WebAssembly.
//
// The panel has the text by its edits, and says which range to select and which edits to apply. Its offsets are those of
// the text with `\n` as its line ends, which VS Code's are not in a document with CRLF.

import * as vscode from "vscode";

/** The languages that have a preview. */
export const LANGUAGES = ["geotrace", "crt"];

/** Returns whether a document is a program in one of the languages. */
export function isProgram(document: vscode.TextDocument): boolean {
    return LANGUAGES.includes(document.languageId);
}

interface TextEdit {
    from: number;
    to: number;
    insert: string;
}

/** A view as the lenses of the server name it: of a surface, or through a camera. */
export interface View {
    view: string;
    surface?: string;
}

/** What the panel says; see `web/src/panel.ts`. */
type Said =
    | { said: "ready" }
    | { said: "select"; range: { from: number; to: number }; version: number }
    | { said: "apply"; edits: TextEdit[]; version: number }
    | { said: "save"; name: string; base64: string }
    | { said: "shown"; version: number };

/** The panels that are open, by their documents. */
export class Panels implements vscode.Disposable {
    private readonly open = new Map<string, Panel>();
    private readonly disposables: vscode.Disposable[];

    /** `folder` is that of the extension. */
    constructor(private readonly folder: vscode.Uri) {
        this.disposables = [
            vscode.workspace.onDidChangeTextDocument((change) => this.of(change.document)?.changed(change)),
            vscode.workspace.onDidCloseTextDocument((document) => this.of(document)?.dispose()),
            vscode.window.onDidChangeTextEditorSelection(({ textEditor }) => this.of(textEditor.document)?.cursor(textEditor)),
        ];
    }

    /** Whether the extension was packed with the page. */
    private async isThere(): Promise<boolean> {
        try {
            await vscode.workspace.fs.stat(vscode.Uri.joinPath(this.folder, "preview", "panel.js"));
            return true;
        } catch {
            return false;
        }
    }

    /** Opens the panel of a document, or shows it if it is open, with a view if one is named. */
    async show(document: vscode.TextDocument, view?: View): Promise<void> {
        if (!isProgram(document)) {
            void vscode.window.showErrorMessage(`${nameOf(document.uri)} is not a Geotrace program, so it has no preview.`);
            return;
        }
        if (!(await this.isThere())) {
            void vscode.window.showErrorMessage("This extension was packed without the preview inside VS Code: open the window instead.");
            return;
        }
        const key = document.uri.toString();
        let panel = this.open.get(key);
        if (panel === undefined) {
            panel = new Panel(this.folder, document, () => this.open.delete(key));
            this.open.set(key, panel);
        } else {
            panel.reveal();
        }
        if (view !== undefined) {
            panel.see(view);
        }
    }

    /** The number of the last text that a document's panel has shown; `undefined` where it has none. */
    shown(uri: string): number | undefined {
        return this.open.get(uri)?.shown;
    }

    /** Hands a panel what it would hear of its webview. */
    say(uri: string, said: unknown): Promise<void> | undefined {
        return this.open.get(uri)?.hear(said as Said);
    }

    dispose(): void {
        for (const panel of [...this.open.values()]) {
            panel.dispose();
        }
        for (const disposable of this.disposables) {
            disposable.dispose();
        }
    }

    private of(document: vscode.TextDocument): Panel | undefined {
        return this.open.get(document.uri.toString());
    }
}

/** The panel of one document. */
class Panel {
    /** The number of the text that was shown last. */
    shown: number | undefined;
    private readonly panel: vscode.WebviewPanel;
    private version = 0;
    /** The panel has asked for the text. */
    private isReady = false;
    /** The view that is wanted once it has. */
    private view: View | undefined;

    constructor(
        folder: vscode.Uri,
        private readonly document: vscode.TextDocument,
        ended: () => void,
    ) {
        const root = vscode.Uri.joinPath(folder, "preview");
        const title = `Preview ${nameOf(document.uri)}`;
        const where = { viewColumn: vscode.ViewColumn.Beside, preserveFocus: true };
        this.panel = vscode.window.createWebviewPanel("geotrace.panel", title, where, {
            enableScripts: true,
            // A camera that was moved is not lost behind another tab.
            retainContextWhenHidden: true,
            localResourceRoots: [root],
        });
        this.panel.iconPath = vscode.Uri.joinPath(folder, "icon.svg");
        this.panel.webview.onDidReceiveMessage((said: Said) => this.hear(said));
        this.panel.onDidDispose(ended);
        this.panel.webview.html = html(this.panel.webview, root);
    }

    reveal(): void {
        this.panel.reveal(undefined, true);
    }

    see(view: View): void {
        if (this.isReady) {
            this.tell({ told: "view", ...view });
        } else {
            this.view = view;
        }
    }

    dispose(): void {
        this.panel.dispose();
    }

    changed({ contentChanges }: vscode.TextDocumentChangeEvent): void {
        if (!this.isReady || contentChanges.length === 0) {
            return;
        }
        this.version += 1;
        if (this.document.eol === vscode.EndOfLine.CRLF) {
            this.tellText();
            return;
        }
        const changes = contentChanges.map(({ rangeOffset, rangeLength, text }) => ({
            from: rangeOffset,
            to: rangeOffset + rangeLength,
            insert: text.replaceAll("\r\n", "\n"),
        }));
        // All ranges are of the text before, and VS Code names the last one first.
        changes.sort((a, b) => a.from - b.from);
        this.tell({ told: "edit", version: this.version, changes });
    }

    cursor(editor: vscode.TextEditor): void {
        this.tell({ told: "cursor", at: this.offset(editor.selection.active) });
    }

    async hear(said: Said): Promise<void> {
        switch (said.said) {
            case "ready":
                this.isReady = true;
                this.version += 1;
                this.tellText();
                if (this.view !== undefined) {
                    this.see(this.view);
                    this.view = undefined;
                }
                return;
            case "shown":
                this.shown = said.version;
                return;
            case "select":
                if (said.version === this.version) {
                    const selection = this.range(said.range);
                    const viewColumn = this.column();
                    await vscode.window.showTextDocument(this.document, viewColumn === undefined ? { selection } : { selection, viewColumn });
                }
                return;
            case "apply":
                if (said.version === this.version) {
                    const edit = new vscode.WorkspaceEdit();
                    for (const part of said.edits) {
                        edit.replace(this.document.uri, this.range(part), part.insert);
                    }
                    await vscode.workspace.applyEdit(edit);
                } else {
                    void vscode.window.showWarningMessage("The text has changed meanwhile. Try again.");
                }
                return;
            case "save":
                await this.save(said.name, said.base64);
        }
    }

    private async save(name: string, base64: string): Promise<void> {
        const target = await askForPicture(this.document.uri, name.replaceAll(/.*[\\/]/g, ""));
        if (target === undefined) {
            return;
        }
        try {
            await vscode.workspace.fs.writeFile(target, Uint8Array.from(atob(base64), (byte) => byte.charCodeAt(0)));
        } catch (error) {
            const reason = error instanceof Error ? error.message : String(error);
            void vscode.window.showErrorMessage(`The picture was not written: ${reason}`);
        }
    }

    private tell(told: unknown): void {
        void this.panel.webview.postMessage(told);
    }

    private tellText(): void {
        const name = nameOf(this.document.uri);
        const isNamed = /\.(gtr|crt)$/.test(name);
        const extension = this.document.languageId === "crt" ? "crt" : "gtr";
        this.tell({
            told: "open",
            name: isNamed ? name : `${name}.${extension}`,
            text: this.document.getText().replaceAll("\r\n", "\n"),
            version: this.version,
        });
    }

    /** The column of the editor that shows the document. */
    private column(): vscode.ViewColumn | undefined {
        const editors = vscode.window.visibleTextEditors;
        return editors.find((editor) => editor.document === this.document)?.viewColumn ?? vscode.ViewColumn.One;
    }

    private range({ from, to }: { from: number; to: number }): vscode.Range {
        return new vscode.Range(this.position(from), this.position(to));
    }

    private position(offset: number): vscode.Position {
        if (this.document.eol === vscode.EndOfLine.LF) {
            return this.document.positionAt(offset);
        }
        const before = this.document.getText().replaceAll("\r\n", "\n").slice(0, offset);
        const line = before.split("\n").length - 1;
        return new vscode.Position(line, before.length - before.lastIndexOf("\n") - 1);
    }

    private offset(position: vscode.Position): number {
        const offset = this.document.offsetAt(position);
        return this.document.eol === vscode.EndOfLine.LF ? offset : offset - position.line;
    }
}

/** Asks where to save a picture of a document: beside it, or in the folder that is open where nothing can be written there. */
export function askForPicture(document: vscode.Uri, name: string): Thenable<vscode.Uri | undefined> {
    const isWritable = vscode.workspace.fs.isWritableFileSystem(document.scheme);
    const folder = isWritable ? vscode.Uri.joinPath(document, "..") : vscode.workspace.workspaceFolders?.[0]?.uri;
    const place = folder === undefined ? {} : { defaultUri: vscode.Uri.joinPath(folder, name) };
    return vscode.window.showSaveDialog({ ...place, filters: { PNG: ["png"] } });
}

/** The last part of a document's path. */
function nameOf(uri: vscode.Uri): string {
    return uri.path.replace(/.*\//, "");
}

/** The page of a panel: it loads the scripts of its folder, and nothing else. */
function html(webview: vscode.Webview, root: vscode.Uri): string {
    const script = webview.asWebviewUri(vscode.Uri.joinPath(root, "panel.js")).toString();
    const policy = [
        "default-src 'none'",
        `script-src ${webview.cspSource} 'wasm-unsafe-eval'`,
        `style-src ${webview.cspSource} 'unsafe-inline'`,
        `connect-src ${webview.cspSource} blob:`,
        `img-src ${webview.cspSource} blob: data:`,
        "worker-src blob:",
    ].join("; ");
    return `<!doctype html>
<html lang="en">
    <head>
        <meta charset="utf-8" />
        <meta http-equiv="Content-Security-Policy" content="${policy}" />
        <meta name="viewport" content="width=device-width, initial-scale=1" />
        <title>Geotrace</title>
        <script type="module" src="${script}"></script>
    </head>
    <body></body>
</html>`;
}
