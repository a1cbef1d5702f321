// Starts the language server for Geotrace documents, keeps its status in view, and hands the preview's command on.

import { join } from "node:path";
import * as vscode from "vscode";
import {
    type ClientCapabilities,
    type ExecuteCommandSignature,
    type FeatureState,
    LanguageClient,
    type LanguageClientOptions,
    type ServerOptions,
    State,
    type StaticFeature,
} from "vscode-languageclient/node";
import { exportPicture, newFromExample } from "./commands";
import { Panels } from "./panel";
import { findServer, ServerMissing } from "./server";

/** The languages that the server knows. */
const LANGUAGES = [{ language: "geotrace" }, { language: "crt" }];

/** The command that the server executes: its arguments are a document's URI and, perhaps, a view. */
const PREVIEW = "geotrace.preview";

/** The notification of where the cursor stands: the preview highlights what is declared there. */
const CURSOR = "geotrace/cursor";
/** How long the cursor may have moved before that is told, in milliseconds. */
const CURSOR_DELAY = 30;

/** What the server tells of each picture of a preview, by the notification geotrace/shown. */
export interface Shown {
    uri: string;
    version: number;
    /** Whether the text compiled; else the last good picture stays. */
    ok: boolean;
    milliseconds: number;
}

/** What the tests of the extension look at. */
export interface Api {
    /** The pictures that have been shown so far, by document; the last of each. */
    shown(): ReadonlyMap<string, Shown>;
    /** The client, once it runs. */
    client(): LanguageClient | undefined;
    /** What the status item says. */
    status(): string;
    /** The previews inside VS Code. */
    panels(): Panels;
}

/** The session of this run of the extension. */
let session: Session | undefined;

export async function activate(context: vscode.ExtensionContext): Promise<Api> {
    const started = new Session(context);
    session = started;
    context.subscriptions.push(started);
    await started.start();
    return {
        client: () => started.client,
        status: () => started.status.text,
        shown: () => started.shown,
        panels: () => started.panels,
    };
}

/** VS Code waits for this before it ends: the server says goodbye to its windows. */
export async function deactivate(): Promise<void> {
    await session?.end();
}

/** One run of the server after the other. */
class Session implements vscode.Disposable {
    client: LanguageClient | undefined;
    readonly status = vscode.languages.createLanguageStatusItem("geotrace.status", LANGUAGES);
    readonly shown = new Map<string, Shown>();
    readonly panels: Panels;
    private cursor: NodeJS.Timeout | undefined;
    /** The path of the program, once it has been found. */
    private program: string | undefined;
    private readonly output = vscode.window.createOutputChannel("Geotrace", { log: true });
    private readonly context: vscode.ExtensionContext;
    private readonly disposables: vscode.Disposable[];
    /** Starts and stops come one after the other. */
    private turn: Promise<void> = Promise.resolve();

    constructor(context: vscode.ExtensionContext) {
        this.context = context;
        this.status.name = "Geotrace";
        this.panels = new Panels(context.extensionUri);
        this.disposables = [
            this.panels,
            this.status,
            this.output,
            vscode.commands.registerCommand("geotrace.restart", () => this.restart()),
            vscode.commands.registerCommand("geotrace.previewToSide", (uri?: vscode.Uri) => this.openPanel(uri)),
            vscode.workspace.onDidOpenTextDocument((document) => this.opened(document)),
            vscode.commands.registerCommand("geotrace.showLog", () => this.output.show()),
            vscode.commands.registerCommand("geotrace.newFromExample", (name?: string) =>
                newFromExample(join(context.extensionPath, "examples"), name),
            ),
            vscode.commands.registerCommand("geotrace.exportPicture", (source?: vscode.Uri, target?: unknown) =>
                this.program === undefined
                    ? undefined
                    : // From a menu, the second argument is the selection.
                      exportPicture(this.program, source, target instanceof vscode.Uri ? target : undefined),
            ),
            vscode.workspace.onDidChangeConfiguration(async (change) => {
                if (change.affectsConfiguration("geotrace.server")) {
                    await this.restart();
                }
            }),
            vscode.window.onDidChangeTextEditorSelection((change) => this.cursorMoved(change.textEditor)),
        ];
    }

    start(): Promise<void> {
        this.turn = this.turn.then(() => this.run());
        return this.turn;
    }

    restart(): Promise<void> {
        this.turn = this.turn.then(() => this.stop()).then(() => this.run());
        return this.turn;
    }

    /** Stops for good. */
    end(): Promise<void> {
        clearTimeout(this.cursor);
        this.turn = this.turn.then(() => this.stop());
        return this.turn;
    }

    dispose(): void {
        void this.end();
        for (const disposable of this.disposables) {
            disposable.dispose();
        }
    }

    private async run(): Promise<void> {
        this.show("starting", true);
        const setting = vscode.workspace.getConfiguration("geotrace").get("server.path", "");
        const wanted = String(this.context.extension.packageJSON.version);
        try {
            const server = await findServer(setting, this.context.extensionPath, wanted);
            this.program = server.path;
            this.output.info(`${server.path} (from ${server.from}), version ${server.version}`);
            const options: ServerOptions = { command: server.path, args: ["lsp"] };
            const client = new LanguageClient("geotrace", "Geotrace", options, this.clientOptions());
            client.onDidChangeState(({ newState }) => this.changed(newState, server.version));
            client.registerFeature(new WantsShown());
            client.onNotification("geotrace/shown", (shown: Shown) => {
                this.shown.set(shown.uri, shown);
            });
            this.client = client;
            await client.start();
        } catch (error) {
            const message = error instanceof Error ? error.message : String(error);
            this.show("not running", false, message);
            this.output.error(message);
            const settings = "Open Settings";
            const buttons = error instanceof ServerMissing ? [settings] : [];
            // Not awaited: activation must not hang on a message.
            void vscode.window.showErrorMessage(message, ...buttons).then((choice) => {
                if (choice === settings) {
                    return vscode.commands.executeCommand("workbench.action.openSettings", "geotrace.server.path");
                }
                return undefined;
            });
        }
    }

    private async stop(): Promise<void> {
        const client = this.client;
        this.client = undefined;
        try {
            await client?.dispose();
        } catch (error) {
            this.output.warn(String(error));
        }
    }

    private clientOptions(): LanguageClientOptions {
        return {
            documentSelector: LANGUAGES,
            outputChannel: this.output,
            synchronize: { configurationSection: "geotrace" },
            middleware: {
                executeCommand: async (command: string, given: unknown[], next: ExecuteCommandSignature) => {
                    if (command !== PREVIEW) {
                        return next(command, given);
                    }
                    if (isInPanel()) {
                        const [wanted] = given;
                        const uri = typeof wanted === "string" ? vscode.Uri.parse(wanted) : wanted;
                        return this.openPanel(uri instanceof vscode.Uri ? uri : undefined);
                    }
                    if (given[0] instanceof vscode.Uri) {
                        // From the explorer the file may not be open, and the server knows open documents only.
                        await vscode.window.showTextDocument(given[0]);
                    }
                    // It may not have moved since the document was opened.
                    this.tellCursor(vscode.window.activeTextEditor);
                    return next(command, this.previewArguments(given));
                },
            },
        };
    }

    /** Opens the preview inside VS Code: of a document, or of the active editor's. */
    private async openPanel(uri = vscode.window.activeTextEditor?.document.uri): Promise<void> {
        if (uri !== undefined) {
            const document = await vscode.workspace.openTextDocument(uri);
            if (!vscode.window.visibleTextEditors.some((editor) => editor.document === document)) {
                await vscode.window.showTextDocument(document);
            }
            this.panels.show(document);
        }
    }

    /** Opens the preview with a document, if that is wanted. The server does it where the preview is a window. */
    private opened(document: vscode.TextDocument): void {
        const when = vscode.workspace.getConfiguration("geotrace").get("preview.open");
        const isOurs = LANGUAGES.some(({ language }) => language === document.languageId);
        if (isInPanel() && when === "onOpen" && isOurs) {
            void this.openPanel(document.uri);
        }
    }

    /** From the palette, a key or the title bar the command comes without what the server needs: a document. */
    private previewArguments(given: unknown[]): unknown[] {
        if (typeof given[0] === "string") {
            return given;
        }
        const named = given[0] instanceof vscode.Uri ? given[0] : undefined;
        const uri = named ?? vscode.window.activeTextEditor?.document.uri;
        return uri === undefined ? [] : [this.client?.code2ProtocolConverter.asUri(uri) ?? uri.toString()];
    }

    /** Tells where the cursor stands, some moves at once. */
    private cursorMoved(editor: vscode.TextEditor): void {
        if (editor.document.languageId === "geotrace") {
            clearTimeout(this.cursor);
            this.cursor = setTimeout(() => this.tellCursor(editor), CURSOR_DELAY);
        }
    }

    private tellCursor(editor: vscode.TextEditor | undefined): void {
        const client = this.client;
        if (editor?.document.languageId !== "geotrace" || client?.state !== State.Running) {
            return;
        }
        const { code2ProtocolConverter: converter } = client;
        void client.sendNotification(CURSOR, {
            textDocument: converter.asTextDocumentIdentifier(editor.document),
            position: converter.asPosition(editor.selection.active),
        });
    }

    private changed(state: State, version: string): void {
        void vscode.commands.executeCommand("setContext", "geotrace.running", state === State.Running);
        if (state === State.Running) {
            this.show(`running, version ${version}`, false);
        } else if (state === State.Starting) {
            this.show("starting", true);
        } else {
            this.show("stopped", false, "The language server has stopped.");
        }
    }

    private show(state: string, busy: boolean, problem?: string): void {
        this.status.text = `Geotrace: ${state}`;
        this.status.busy = busy;
        this.status.detail = problem ?? "language server";
        this.status.severity =
            problem === undefined ? vscode.LanguageStatusSeverity.Information : vscode.LanguageStatusSeverity.Error;
        this.status.command =
            problem === undefined
                ? { title: "Restart", command: "geotrace.restart" }
                : { title: "Show output", command: "geotrace.showLog" };
    }
}

/** Whether the preview is a panel of VS Code, and not a window. */
function isInPanel(): boolean {
    return vscode.workspace.getConfiguration("geotrace").get("preview.in") === "panel";
}

/** Says that this editor wants to hear of each picture of a preview. */
class WantsShown implements StaticFeature {
    fillClientCapabilities(capabilities: ClientCapabilities): void {
        capabilities.experimental = { ...capabilities.experimental, geotrace: { shown: true } };
    }

    initialize(): void {}

    getState(): FeatureState {
        return { kind: "static" };
    }

    clear(): void {}
}
