// The extension in a browser: the language server is WebAssembly in a Worker, and the preview is a panel.

import * as vscode from "vscode";
import { BrowserMessageReader, BrowserMessageWriter, LanguageClient } from "vscode-languageclient/browser";
import { type Api, end, start } from "./session";

export function activate(context: vscode.ExtensionContext): Promise<Api> {
    const folder = vscode.Uri.joinPath(context.extensionUri, "dist");
    /** The one that runs: a restart, or a failure, puts another in its place. */
    let worker: Worker | undefined;
    context.subscriptions.push({ dispose: () => worker?.terminate() });
    return start(context, {
        hasWindows: false,
        async connect(options) {
            const core = await vscode.workspace.fs.readFile(vscode.Uri.joinPath(folder, "server_bg.wasm"));
            const client = new LanguageClient("geotrace", "Geotrace", () => {
                worker?.terminate();
                worker = new Worker(vscode.Uri.joinPath(folder, "worker.js").toString(true), { name: "geotrace" });
                worker.postMessage(core);
                return Promise.resolve({ reader: new Reader(worker), writer: new BrowserMessageWriter(worker) });
            }, options);
            return { client, version: String(context.extension.packageJSON.version) };
        },
    });
}

export function deactivate(): Promise<void> {
    return end();
}

/** Hears what a Worker says, until it fails: the client then starts another. */
class Reader extends BrowserMessageReader {
    constructor(worker: Worker) {
        super(worker);
        worker.addEventListener("error", () => this.fireClose());
    }
}
