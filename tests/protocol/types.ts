// What the server may send, by method, in the protocol's own types. `schema.mjs` makes a JSON Schema of it.
import type * as p from "vscode-languageserver-protocol";

/** The results of requests. */
export interface Results {
    "initialize": p.InitializeResult;
    "shutdown": null;
    "textDocument/hover": p.Hover | null;
    "textDocument/completion": p.CompletionItem[] | p.CompletionList | null;
    "completionItem/resolve": p.CompletionItem;
    "textDocument/signatureHelp": p.SignatureHelp | null;
    "textDocument/definition": p.Location | p.Location[] | p.LocationLink[] | null;
    "textDocument/references": p.Location[] | null;
    "textDocument/documentHighlight": p.DocumentHighlight[] | null;
    "textDocument/prepareRename": p.PrepareRenameResult | null;
    "textDocument/rename": p.WorkspaceEdit | null;
    "textDocument/documentSymbol": p.DocumentSymbol[] | p.SymbolInformation[] | null;
    "workspace/symbol": p.SymbolInformation[] | p.WorkspaceSymbol[] | null;
    "workspaceSymbol/resolve": p.WorkspaceSymbol;
    "textDocument/foldingRange": p.FoldingRange[] | null;
    "textDocument/selectionRange": p.SelectionRange[] | null;
    "textDocument/inlayHint": p.InlayHint[] | null;
    "inlayHint/resolve": p.InlayHint;
    "textDocument/codeAction": (p.Command | p.CodeAction)[] | null;
    "codeAction/resolve": p.CodeAction;
    "textDocument/codeLens": p.CodeLens[] | null;
    "codeLens/resolve": p.CodeLens;
    "textDocument/formatting": p.TextEdit[] | null;
    "textDocument/rangeFormatting": p.TextEdit[] | null;
    "textDocument/onTypeFormatting": p.TextEdit[] | null;
    "textDocument/semanticTokens/full": p.SemanticTokens | null;
    "textDocument/semanticTokens/full/delta": p.SemanticTokens | p.SemanticTokensDelta | null;
    "textDocument/semanticTokens/range": p.SemanticTokens | null;
    "textDocument/documentColor": p.ColorInformation[];
    "textDocument/colorPresentation": p.ColorPresentation[];
    "textDocument/documentLink": p.DocumentLink[] | null;
    "textDocument/diagnostic": p.DocumentDiagnosticReport;
    "workspace/diagnostic": p.WorkspaceDiagnosticReport;
    "workspace/executeCommand": p.LSPAny;
}

/** The params of notifications. */
export interface Notifications {
    "textDocument/publishDiagnostics": p.PublishDiagnosticsParams;
    "window/logMessage": p.LogMessageParams;
    "window/showMessage": p.ShowMessageParams;
    "$/progress": { token: p.ProgressToken; value: p.WorkDoneProgressBegin | p.WorkDoneProgressReport | p.WorkDoneProgressEnd };
    "$/logTrace": p.LogTraceParams;
    /** Of our own; only for an editor that declares `experimental.geotrace.shown`. */
    "geotrace/shown": { uri: p.URI; version: p.integer; ok: boolean; milliseconds: number; painting: number };
}

/** The params of requests to the client. */
export interface Requests {
    "client/registerCapability": p.RegistrationParams;
    "client/unregisterCapability": p.UnregistrationParams;
    "window/workDoneProgress/create": p.WorkDoneProgressCreateParams;
    "window/showDocument": p.ShowDocumentParams;
    "window/showMessageRequest": p.ShowMessageRequestParams;
    "workspace/applyEdit": p.ApplyWorkspaceEditParams;
    "workspace/configuration": p.ConfigurationParams;
    "workspace/semanticTokens/refresh": null | undefined;
    "workspace/inlayHint/refresh": null | undefined;
    "workspace/codeLens/refresh": null | undefined;
    "workspace/diagnostic/refresh": null | undefined;
}

export interface ResponseError {
    code: p.integer;
    message: string;
    data?: p.LSPAny;
}

export interface Messages {
    results: Results;
    notifications: Notifications;
    requests: Requests;
    error: ResponseError;
}
