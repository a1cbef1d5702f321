// The extension on an operating system: the language server is a program, which opens windows and draws pictures.

import * as vscode from "vscode";
import { LanguageClient } from "vscode-languageclient/node";
import { exportPicture } from "./picture";
import { findServer } from "./server";
import { type Api, end, start } from "./session";

export function activate(context: vscode.ExtensionContext): Promise<Api> {
    /** The path of the program, once it has been found. */
    let program: string | undefined;
    context.subscriptions.push(
        vscode.commands.registerCommand("geotrace.exportPicture", (source?: vscode.Uri, target?: unknown) =>
            program === undefined
                ? undefined
                : // From a menu, the second argument is the selection.
                  exportPicture(program, source, target instanceof vscode.Uri ? target : undefined),
        ),
    );
    void vscode.commands.executeCommand("setContext", "geotrace.hasProgram", true);
    return start(context, {
        hasWindows: true,
        async connect(options, output) {
            const setting = vscode.workspace.getConfiguration("geotrace").get("server.path", "");
            const wanted = String(context.extension.packageJSON.version);
            const server = await findServer(setting, context.extensionPath, wanted);
            program = server.path;
            output.info(`${server.path} (from ${server.from}), version ${server.version}`);
            const client = new LanguageClient("geotrace", "Geotrace", { command: server.path, args: ["lsp"] }, options);
            return { client, version: server.version };
        },
    });
}

/** VS Code waits for this before it ends: the server says goodbye to its windows. */
export function deactivate(): Promise<void> {
    return end();
}
