// The extension on an operating system: the language server is a program, which opens windows and draws pictures.

import * as vscode from "vscode";
import { LanguageClient } from "vscode-languageclient/node";
import { exportPicture } from "./picture";
import { findServer } from "./server";
import { type Api, end, start } from "./session";

export function activate(context: vscode.ExtensionContext): Promise<Api> {
    const find = () => {
        const setting = vscode.workspace.getConfiguration("geotrace").get("server.path", "");
        return findServer(setting, context.extensionPath, String(context.extension.packageJSON.version));
    };
    context.subscriptions.push(
        vscode.commands.registerCommand("geotrace.exportPicture", async (source?: vscode.Uri, target?: unknown) => {
            try {
                const { path } = await find();
                // From a menu, the second argument is the selection.
                await exportPicture(path, source, target instanceof vscode.Uri ? target : undefined);
            } catch (error) {
                // Not awaited: the command is done.
                void vscode.window.showErrorMessage(error instanceof Error ? error.message : String(error));
            }
        }),
    );
    return start(context, {
        // The program runs on a host that may be another machine.
        hasWindows: process.platform !== "linux" || Boolean(process.env.DISPLAY || process.env.WAYLAND_DISPLAY),
        async connect(options, output) {
            const server = await find();
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
