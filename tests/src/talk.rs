//! What most conversations with the language server begin with, and how they name places of their one document.

use serde_json::{Value, json};

use crate::editor::{Editor, Place};

/// The document that is talked about.
pub const URI: &str = "file:///a%20folder/a.gtr";

/// What an editor such as VS Code offers, with these encodings of positions.
pub fn capabilities(encodings: &[&str]) -> Value {
    json!({
        "general": { "positionEncodings": encodings },
        "workspace": {
            "configuration": true,
            "workspaceEdit": { "documentChanges": true },
            "inlayHint": { "refreshSupport": true },
            "codeLens": { "refreshSupport": true },
        },
        "window": { "workDoneProgress": true },
        "textDocument": {
            "hover": { "contentFormat": ["markdown", "plaintext"] },
            "completion": { "completionItem": { "snippetSupport": true, "documentationFormat": ["markdown"] } },
            "documentSymbol": { "hierarchicalDocumentSymbolSupport": true },
            "publishDiagnostics": { "relatedInformation": true, "versionSupport": true },
        },
    })
}

/// The document, as requests name it.
pub fn document() -> Value {
    json!({ "uri": URI })
}

/// A place in it, as requests name it: line and column from 0.
pub fn at(line: u32, character: u32) -> Value {
    json!({ "textDocument": document(), "position": { "line": line, "character": character } })
}

/// A range, from a line and a column to others.
pub fn range(start: [u32; 2], end: [u32; 2]) -> Value {
    json!({
        "start": { "line": start[0], "character": start[1] },
        "end": { "line": end[0], "character": end[1] },
    })
}

/// An editor that has shaken hands and counts columns in UTF-16.
pub async fn started(place: Place, name: &str) -> Editor {
    let mut editor = Editor::start(place, name);
    editor.initialize(capabilities(&["utf-16"])).await;
    editor
}
