// Starts the language server for Geotrace documents, keeps its status in view, and hands the preview's command on. What it
// is, a program or WebAssembly, its host says.

import * as vscode from "vscode";
import {
    type BaseLanguageClient,
    type ClientCapabilities,
    ExecuteCommandRequest,
    type FeatureState,
    type LanguageClientOptions,
    type ServerCapabilities,
    State,
    type StaticFeature,
} from "vscode-languageclient";
import { newFromExample } from "./examples";
import { LANGUAGES, Panels, type View, isProgram } from "./panel";

/** What VS Code runs in: an operating system with programs, or a browser. */
export interface Host {
    /** Makes a client of the server. It throws a `ServerMissing` with a sentence for the user. */
    connect(options: LanguageClientOptions, output: vscode.LogOutputChannel): Promise<Connected>;
    /** Whether the server can open windows. Else the preview is always a panel. */
    hasWindows: boolean;
}

/** A client that has not been started. */
export interface Connected {
    client: BaseLanguageClient;
    version: string;
}

/** Why there is no server; the message is a sentence for the user, who can mend it in the settings. */
export class ServerMissing extends Error {}

/** The documents that the server knows. */
const SELECTOR = LANGUAGES.map((language) => ({ language }));

/** The command, which the session hands to the server where the preview is a window: its arguments are a document's URI and, perhaps, a view. */
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
    client(): BaseLanguageClient | undefined;
    /** What the status item says. */
    status(): string;
    /** The previews inside VS Code. */
    panels(): Panels;
}

/** The session of this run of the extension. */
let session: Session | undefined;

export async function start(context: vscode.ExtensionContext, host: Host): Promise<Api> {
    const started = new Session(context, host);
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
export async function end(): Promise<void> {
    await session?.end();
}

/** One run of the server after the other. */
class Session implements vscode.Disposable {
    client: BaseLanguageClient | undefined;
    readonly status = vscode.languages.createLanguageStatusItem("geotrace.status", SELECTOR);
    readonly shown = new Map<string, Shown>();
    readonly panels: Panels;
    /** The documents that an editor has shown. */
    private readonly seen = new WeakSet<vscode.TextDocument>();
    private cursor: ReturnType<typeof setTimeout> | undefined;
    private readonly output = vscode.window.createOutputChannel("Geotrace", { log: true });
    private readonly disposables: vscode.Disposable[];
    /** Starts and stops come one after the other. */
    private turn: Promise<void> = Promise.resolve();

    constructor(
        context: vscode.ExtensionContext,
        private readonly host: Host,
    ) {
        this.status.name = "Geotrace";
        this.panels = new Panels(context.extensionUri);
        this.disposables = [
            this.panels,
            this.status,
            this.output,
            vscode.commands.registerCommand("geotrace.restart", () => this.restart()),
            vscode.commands.registerCommand(PREVIEW, (wanted?: unknown, view?: unknown) => this.preview(wanted, view)),
            vscode.commands.registerCommand("geotrace.previewToSide", (uri?: vscode.Uri) => this.openPanel(uri)),
            vscode.window.onDidChangeVisibleTextEditors((editors) => this.saw(editors)),
            // Another language makes a new document of one that an editor shows.
            vscode.workspace.onDidOpenTextDocument(() => this.saw(vscode.window.visibleTextEditors)),
            vscode.commands.registerCommand("geotrace.showLog", () => this.output.show()),
            vscode.commands.registerCommand("geotrace.newFromExample", (name?: string) =>
                newFromExample(vscode.Uri.joinPath(context.extensionUri, "examples.json"), name),
            ),
            vscode.workspace.onDidChangeConfiguration(async (change) => {
                if (change.affectsConfiguration("geotrace.server")) {
                    await this.restart();
                }
            }),
            vscode.window.onDidChangeTextEditorSelection((change) => this.cursorMoved(change.textEditor)),
        ];
        // The first document is open before the extension runs.
        this.saw(vscode.window.visibleTextEditors);
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
        try {
            const { client, version } = await this.host.connect(this.clientOptions(), this.output);
            client.onDidChangeState(({ newState }) => this.changed(newState, version));
            client.registerFeature(new PreviewFeature());
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
            documentSelector: SELECTOR,
            outputChannel: this.output,
            synchronize: { configurationSection: "geotrace" },
            middleware: {
                workspace: {
                    didChangeConfiguration: async (sections, next) => {
                        await (this.host.hasWindows ? next(sections) : this.tellSettings());
                    },
                },
            },
        };
    }

    /** Tells the settings of a host without windows: the server must not open one with each document. */
    private async tellSettings(): Promise<void> {
        const { preview, ...settings } = JSON.parse(JSON.stringify(vscode.workspace.getConfiguration().get("geotrace")));
        const geotrace = { ...settings, preview: { ...preview, in: "panel" } };
        await this.client?.sendNotification("workspace/didChangeConfiguration", { settings: { geotrace } });
    }

    /**
     * Opens the preview of a document, or of the active editor's. A lens gives the address as a text and a view, a menu gives a
     * `Uri` and what else it has, the palette and a key give nothing.
     */
    private async preview(wanted: unknown, view: unknown): Promise<void> {
        const named = typeof wanted === "string" ? vscode.Uri.parse(wanted) : wanted instanceof vscode.Uri ? wanted : undefined;
        const uri = named ?? vscode.window.activeTextEditor?.document.uri;
        if (uri === undefined) {
            return;
        }
        const views = isView(view) ? [view] : [];
        if (this.isInPanel()) {
            return this.openPanel(uri, ...views);
        }
        await this.turn;
        const { client } = this;
        if (client === undefined || client.needsStart()) {
            this.offerPanel(uri, ...views);
            return;
        }
        if (wanted instanceof vscode.Uri) {
            // From the explorer the file may not be open, and the server knows open documents only.
            await vscode.window.showTextDocument(wanted);
        }
        // It may not have moved since the document was opened.
        this.tellCursor(vscode.window.activeTextEditor);
        const document = client.code2ProtocolConverter.asUri(uri);
        await client.sendRequest(ExecuteCommandRequest.type, { command: PREVIEW, arguments: [document, ...views] });
    }

    /** Says why no window can be opened; the panel needs no server. */
    private offerPanel(uri: vscode.Uri, view?: View): void {
        const panel = "Open in a Panel";
        // Not awaited: the command is done.
        void vscode.window.showErrorMessage(this.status.detail ?? "", panel).then((choice) => {
            return choice === panel ? this.openPanel(uri, view) : undefined;
        });
    }

    /** Whether the preview is a panel of VS Code, and not a window. */
    private isInPanel(): boolean {
        return !this.host.hasWindows || vscode.workspace.getConfiguration("geotrace").get("preview.in") === "panel";
    }

    /** Opens the preview inside VS Code: of a document, or of the active editor's, with a view if one is named. */
    private async openPanel(uri = vscode.window.activeTextEditor?.document.uri, view?: View): Promise<void> {
        if (uri !== undefined) {
            const document = await vscode.workspace.openTextDocument(uri);
            if (!vscode.window.visibleTextEditors.some((editor) => editor.document === document)) {
                await vscode.window.showTextDocument(document);
            }
            await this.panels.show(document, view);
        }
    }

    /**
     * Opens the preview with each document that an editor shows for the first time, if that is wanted. The server does it where
     * the preview is a window. Documents that a search or another extension opens in the background are not shown.
     */
    private saw(editors: readonly vscode.TextEditor[]): void {
        const when = vscode.workspace.getConfiguration("geotrace").get("preview.open");
        for (const { document } of editors) {
            // An old version, beside which the new one is compared, is none that anybody works on.
            const isOurs = isProgram(document) && document.uri.scheme !== "git";
            if (!isOurs || this.seen.has(document)) {
                continue;
            }
            this.seen.add(document);
            if (this.isInPanel() && when === "onOpen") {
                void this.openPanel(document.uri);
            }
        }
    }

    /** Tells where the cursor stands, some moves at once. */
    private cursorMoved(editor: vscode.TextEditor): void {
        if (isProgram(editor.document)) {
            clearTimeout(this.cursor);
            this.cursor = setTimeout(() => this.tellCursor(editor), CURSOR_DELAY);
        }
    }

    private tellCursor(editor: vscode.TextEditor | undefined): void {
        const client = this.client;
        if (editor === undefined || !isProgram(editor.document) || client?.state !== State.Running) {
            return;
        }
        const { code2ProtocolConverter: converter } = client;
        void client.sendNotification(CURSOR, {
            textDocument: converter.asTextDocumentIdentifier(editor.document),
            position: converter.asPosition(editor.selection.active),
        });
    }

    private changed(state: State, version: string): void {
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

/** Returns whether an argument of the command is a view: a menu gives others. */
function isView(given: unknown): given is View {
    return typeof given === "object" && given !== null && "view" in given && typeof given.view === "string";
}

/** Says that this editor wants to hear of each picture of a preview, and leaves the preview's command to the session. */
class PreviewFeature implements StaticFeature {
    fillClientCapabilities(capabilities: ClientCapabilities): void {
        capabilities.experimental = { ...capabilities.experimental, geotrace: { shown: true } };
    }

    preInitialize({ executeCommandProvider: provider }: ServerCapabilities): void {
        if (provider !== undefined) {
            provider.commands = provider.commands.filter((command) => command !== PREVIEW);
        }
    }

    initialize(): void {}

    getState(): FeatureState {
        return { kind: "static" };
    }

    clear(): void {}
}
