//! The language server and its preview windows, which the tests play. The window itself is tested where it is made, and
//! with real editors.

mod lives;
mod messages;
mod requests;

use serde_json::{Value, json};
use testing::editor::{Editor, Place};
use testing::window::{Window, Windows};

const FAKE: &str = env!("CARGO_BIN_EXE_fake-window");
const URI: &str = "file:///a%20folder/a.gtr";
const OTHER: &str = "file:///other/b.gtr";
const PROGRAM: &str = "# 𝛼\nparam r : [0, 1];\nsurface s(u,v) = (u,v,r), u : [0,1], v : [0,1];\n";

/// What VS Code offers, as far as previews use it.
fn capabilities() -> Value {
    json!({
        "workspace": {
            "applyEdit": true,
            "configuration": true,
            "workspaceEdit": { "documentChanges": true },
            "inlayHint": { "refreshSupport": true },
        },
        "window": { "showDocument": { "support": true } },
        "experimental": { "geotrace": { "shown": true } },
    })
}

fn at(uri: &str, line: u32, character: u32) -> Value {
    json!({ "textDocument": { "uri": uri }, "position": { "line": line, "character": character } })
}

fn insert(line: u32, character: u32, text: &str) -> Value {
    let place = json!({ "line": line, "character": character });
    json!([{ "range": { "start": place, "end": place }, "text": text }])
}

async fn started(place: Place, name: &str, windows: &Windows) -> Editor {
    let mut editor = Editor::start_with(place, name, Some(&windows.program));
    editor.initialize(capabilities()).await;
    editor
}

async fn command(editor: &mut Editor, uri: &str, view: Value) {
    let arguments = match view {
        Value::Null => json!([uri]),
        view => json!([uri, view]),
    };
    let params = json!({ "command": "geotrace.preview", "arguments": arguments });
    let answer = editor.ask("workspace/executeCommand", params).await;
    assert_eq!(answer, Value::Null);
}

async fn close(editor: &mut Editor, uri: &str) {
    let params = json!({ "textDocument": { "uri": uri } });
    editor.notify("textDocument/didClose", params).await;
}

/// Opens a document and its preview, which has shaken hands and read the text.
async fn previewed(editor: &mut Editor, windows: &Windows, uri: &str, text: &str) -> Window {
    editor.open(uri, text).await;
    command(editor, uri, Value::Null).await;
    let mut window = windows.next().await;
    window.greet().await;
    let received = window.receive_of("text").await;
    assert_eq!(
        (&received["uri"], &received["text"]),
        (&json!(uri), &json!(text))
    );
    window
}

async fn message(editor: &mut Editor, part: &str) -> String {
    let has = |p: &Value| p["message"].as_str().is_some_and(|m| m.contains(part));
    let received = editor.notified("window/showMessage", has).await;
    received["message"].as_str().expect("a sentence").to_owned()
}

fn messages(editor: &Editor) -> Vec<&Value> {
    let shown = editor
        .received()
        .filter(|m| m["method"] == "window/showMessage");
    shown.map(|m| &m["params"]["message"]).collect()
}

/// What a window says of a text that is on its screen.
fn shown(version: i64) -> Value {
    json!({ "type": "shown", "version": version, "ok": true, "milliseconds": 1.5, "painting": 2.5 })
}
