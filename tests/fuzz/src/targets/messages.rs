//! Messages: those of an editor to the language server, and those of the server to a window.

use std::io::Cursor;
use std::time::Duration;

use ide::Languages;
use protocol::changes::Changes;
use protocol::line::{ReadError, Reader};
use protocol::{Command, Event};
use testing::editor::{frame, framed};
use tokio::io::{AsyncReadExt, AsyncWriteExt};

/// Pieces of messages.
pub(crate) const WORDS: &[&str] = &[
    "Content-Length: ",
    "\r\n",
    "\r\n\r\n",
    "{",
    "}",
    "[",
    "]",
    "\"",
    ":",
    ",",
    "null",
    "-1",
    "4294967296",
    "1e999",
    "\"method\"",
    "\"id\"",
    "\"params\"",
    "\"jsonrpc\":\"2.0\"",
    "\"initialize\"",
    "\"textDocument/hover\"",
    "\"textDocument/didChange\"",
    "\"shutdown\"",
    "\"exit\"",
    "\"position\"",
    "\"line\"",
    "\"character\"",
    "\"text\"",
    "\"type\"",
    "\"edit\"",
    "\"version\"",
    "\"base\"",
    "\\ud800",
    "\n",
];

/// The time that the server has for an input, far more than it needs.
const PATIENCE: Duration = Duration::from_secs(60);

/// Conversations with the language server.
pub(crate) fn conversations() -> Vec<Vec<u8>> {
    let at = r#""textDocument":{"uri":"file:///a.gtr"},"position":{"line":0,"character":8}"#;
    let initialize = r#"{"jsonrpc":"2.0","id":1,"method":"initialize","params":{"processId":null,"rootUri":null,"capabilities":{"general":{"positionEncodings":["utf-8"]}}}}"#;
    let open = r#"{"jsonrpc":"2.0","method":"textDocument/didOpen","params":{"textDocument":{"uri":"file:///a.gtr","languageId":"geotrace","version":1,"text":"define a = 2pi;\nfunction f(x) = a x;\n"}}}"#;
    let change = r#"{"jsonrpc":"2.0","method":"textDocument/didChange","params":{"textDocument":{"uri":"file:///a.gtr","version":2},"contentChanges":[{"range":{"start":{"line":0,"character":11},"end":{"line":0,"character":14}},"text":"e"}]}}"#;
    let request = |method: &str, more: &str| {
        format!(
            r#"{{"jsonrpc":"2.0","id":2,"method":"textDocument/{method}","params":{{{at}{more}}}}}"#
        )
    };
    let asked = [
        "hover",
        "completion",
        "definition",
        "references",
        "rename",
        "formatting",
    ];
    let more = [
        "",
        "",
        "",
        r#","context":{"includeDeclaration":true}"#,
        r#","newName":"b""#,
        r#","options":{"tabSize":4,"insertSpaces":true}"#,
    ];
    let end = [
        r#"{"jsonrpc":"2.0","id":9,"method":"shutdown"}"#,
        r#"{"jsonrpc":"2.0","method":"exit"}"#,
    ];
    let conversation = |(method, more): (&str, &str)| {
        let request = request(method, more);
        let begin = [
            initialize,
            r#"{"jsonrpc":"2.0","method":"initialized","params":{}}"#,
            open,
            change,
            &request,
        ];
        let all = begin.into_iter().chain(end).map(framed);
        all.collect::<String>().into_bytes()
    };
    asked.into_iter().zip(more).map(conversation).collect()
}

/// Gives bytes to a language server and closes the stream: it ends, and all that it says is framed JSON.
pub(crate) fn server(input: &[u8]) {
    responses(input);
}

/// All messages of a language server to an editor that says this.
pub(super) fn responses(input: &[u8]) -> Vec<serde_json::Value> {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build()
        .expect("a runtime");
    let output = runtime.block_on(async {
        let (mut to_server, from_editor) = tokio::io::duplex(1 << 16);
        let (to_editor, mut from_server) = tokio::io::duplex(1 << 16);
        let serving = server::serve(from_editor, to_editor, Languages::standard(), None);
        let serving = tokio::spawn(serving);
        let input = input.to_vec();
        let writing = tokio::spawn(async move {
            // The server may have ended at the first byte that is none of the protocol.
            let _ = to_server.write_all(&input).await;
        });
        let mut output = Vec::new();
        let read = tokio::time::timeout(PATIENCE, from_server.read_to_end(&mut output)).await;
        read.expect("the server ends with its input")
            .expect("a stream");
        let _ = writing.await;
        serving.await.expect("the server does not panic");
        output
    });
    let mut rest = &output[..];
    let mut messages = Vec::new();
    while let Some((message, length)) = frame(rest) {
        messages.push(message);
        rest = &rest[length..];
    }
    assert!(rest.is_empty(), "the server ended within a message");
    messages
}

/// Lines of the server to a window, and back.
pub(crate) fn lines() -> Vec<Vec<u8>> {
    [
        r#"{"type":"hello","protocol":3,"program":"0.1.0"}"#,
        r#"{"type":"text","uri":"file:///a.gtr","path":"/a.gtr","version":1,"text":"define a = 1;"}"#,
        r#"{"type":"edit","version":2,"base":1,"changes":[{"range":[0,1],"text":"é"},{"range":[4,4],"text":"xy"}]}"#,
        r#"{"type":"show","view":{"view":"geodesic","surface":"s"}}"#,
        r#"{"type":"cursor","version":2,"offset":3}"#,
        r#"{"type":"close"}"#,
    ]
    .map(|line| format!("{line}\n").into_bytes())
    .to_vec()
}

/// Reads lines of both kinds. Edits that follow each other are composed, and have the effect of both.
pub(crate) fn protocol(input: &[u8]) {
    let mut events = Reader::<_, Event>::new(Cursor::new(input));
    while !matches!(events.read(), Ok(None) | Err(ReadError::Stream(_))) {}
    let mut commands = Reader::<_, Command>::new(Cursor::new(input));
    let mut text = "𝛼 param r : [0, 1];\npoint p = (1, 2, 3);\n".to_owned();
    let mut before: Option<(String, Changes)> = None;
    loop {
        match commands.read() {
            Ok(None) | Err(ReadError::Stream(_)) => break,
            Ok(Some(Command::Text { text: whole, .. })) => {
                text = whole.to_string();
                before = None;
            }
            Ok(Some(Command::Edit { changes, .. })) => {
                let Some(edited) = changes.apply(&text) else {
                    continue;
                };
                if let Some((first, earlier)) = before.take() {
                    let both = earlier.then(&changes);
                    assert_eq!(both.apply(&first).as_ref(), Some(&edited), "composed edits");
                }
                before = Some((std::mem::replace(&mut text, edited), changes));
            }
            Ok(Some(_)) | Err(_) => {}
        }
    }
}
