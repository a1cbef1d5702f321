//! Conversations with the language server.

use std::collections::HashSet;
use std::io::{Read, Write};
use std::process::{Command, Stdio};
use std::thread;
use std::time::Duration;

use serde_json::json;
use testing::binary::{binary, high_water_mark};
use testing::editor::{frame, framed};
use testing::random_edits::session;
use testing::talk::{URI, at};

use crate::run::Report;

/// The edits of a session.
const EDITS: u64 = 1_000;
/// The requests that wait at once.
const UNREAD: u64 = 2_000;
/// How long the editor waits before it reads.
const LATE: Duration = Duration::from_millis(200);
/// The declarations that they are about.
const DECLARATIONS: usize = 300;

pub(super) fn utf_8(seed: u64, count: u64) -> Report {
    sessions("utf-8", seed, count)
}

pub(super) fn utf_16(seed: u64, count: u64) -> Report {
    sessions("utf-16", seed, count)
}

pub(super) fn utf_32(seed: u64, count: u64) -> Report {
    sessions("utf-32", seed, count)
}

fn sessions(encoding: &'static str, seed: u64, count: u64) -> Report {
    many(count, EDITS, |number| {
        // Some editors ask for diagnostics, the others are told them.
        let pulls = number % 4 == 3;
        wait_for(session(
            encoding,
            pulls,
            seed.wrapping_mul(1 << 20) + number,
            EDITS as usize,
        ));
        0
    })
}

/// Writes requests, and reads nothing until the server takes no more of them or all are written.
pub(super) fn unread(_seed: u64, count: u64) -> Report {
    many(count, UNREAD, |number| {
        let names = 0..DECLARATIONS;
        let text: String = names.map(|k| format!("define a{k} = 2pi;\n")).collect();
        let document = json!({ "uri": URI, "languageId": "geotrace", "version": 1, "text": text });
        let methods = ["hover", "documentSymbol", "completion"];
        let method = move |k: u64| methods[(k + number) as usize % 3];
        let mut messages = vec![
            json!({ "jsonrpc": "2.0", "method": "initialized", "params": {} }),
            json!({ "jsonrpc": "2.0", "method": "textDocument/didOpen", "params": { "textDocument": document } }),
        ];
        messages.extend((1..=UNREAD).map(|k| {
            let method = format!("textDocument/{}", method(k));
            json!({ "jsonrpc": "2.0", "id": k, "method": method, "params": at(7, 8) })
        }));

        let mut server = Command::new(binary())
            .arg("lsp")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .expect("the server starts");
        let mut input = server.stdin.take().expect("a pipe");
        let mut output = server.stdout.take().expect("a pipe");
        let mut bytes = Vec::new();
        let mut next_answer = || loop {
            if let Some((message, used)) = frame(&bytes) {
                bytes.drain(..used);
                if message.get("method").is_none() {
                    return message;
                }
                continue;
            }
            let mut more = [0; 1 << 16];
            let length = output.read(&mut more).expect("a message");
            assert!(length > 0, "the server ended before it had answered all");
            bytes.extend_from_slice(&more[..length]);
        };
        let first = json!({ "jsonrpc": "2.0", "id": 0, "method": "initialize", "params": { "capabilities": {} } });
        input.write_all(&framed(&first)).expect("it is read");
        assert!(next_answer()["result"]["capabilities"].is_object());

        let writer = thread::spawn(move || {
            for message in messages {
                input.write_all(&framed(&message)).expect("it is read");
            }
            input
        });
        thread::sleep(LATE);
        let mut answered = HashSet::new();
        while answered.len() < UNREAD as usize {
            let message = next_answer();
            let id = message["id"]
                .as_u64()
                .expect("a number that was asked with");
            let answer = &message["result"];
            let is_whole = match method(id) {
                "hover" => answer["contents"].is_object(),
                "documentSymbol" => answer.as_array().map(Vec::len) == Some(DECLARATIONS),
                // There is nothing to complete within a name that is declared.
                _ => message.get("error").is_none(),
            };
            assert!(is_whole && answered.insert(id), "{message}");
        }
        let status = std::fs::read_to_string(format!("/proc/{}/status", server.id()));
        // The end of its input ends the server.
        drop(writer.join().expect("all is written"));
        server.wait().expect("its end");
        status.map_or(0, |status| high_water_mark(&status))
    })
}

/// Sessions of equal length, counted by what happens in them; `one` returns the largest resident memory of what it has started.
fn many(count: u64, each: u64, one: impl Fn(u64) -> u64) -> Report {
    let mut report = Report::default();
    for number in 0..count.div_ceil(each) {
        if report.is_hopeless() {
            break;
        }
        let input = format!("session {number}");
        report.attempt(input.as_bytes(), || one(number));
    }
    report.inputs *= each;
    report
}

fn wait_for(conversation: impl Future<Output = ()>) {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build();
    runtime.expect("a runtime").block_on(conversation);
}
