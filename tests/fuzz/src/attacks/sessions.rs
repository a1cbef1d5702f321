//! Conversations with the language server.

use std::time::Duration;

use serde_json::json;
use testing::editor::Place;
use testing::random_edits::session;
use testing::talk::{URI, at, started};

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
        wait_for(async {
            let mut editor = started(Place::Binary, "unread").await;
            let names = 0..DECLARATIONS;
            let text: String = names.map(|k| format!("define a{k} = 2pi;\n")).collect();
            editor.open(URI, &text).await;
            editor.read_late(LATE).await;
            let mut asked = Vec::new();
            for k in 0..UNREAD {
                let method = ["hover", "documentSymbol", "completion"][(k + number) as usize % 3];
                let place = at(7, 8);
                let id = editor.post(&format!("textDocument/{method}"), place).await;
                asked.push((id, method));
            }
            for (id, method) in asked {
                let answer = editor.answer(id).await;
                let is_whole = answer.as_ref().is_ok_and(|answer| match method {
                    "hover" => answer["contents"].is_object(),
                    "documentSymbol" => answer.as_array().map(Vec::len) == Some(DECLARATIONS),
                    // There is nothing to complete within a name that is declared.
                    _ => true,
                });
                assert!(is_whole, "{method}: {answer:?}");
            }
            let peak = editor.peak();
            assert_eq!(editor.quit().await, 0);
            peak
        })
    })
}

/// Programs without line ends, or with all of their text in one declaration: a beginning, what is repeated, an end.
const LONG: [[&str; 3]; 6] = [
    ["define a = 1", " + 2pi", ";"],
    ["define a = 1", "pi", ";"],
    ["define b = 1;\ndefine a = 1", "\n+b", ";"],
    ["function f(u) = u;\nfunction g(u) = u", "+f_u(u)", ";"],
    ["function f(u) = u;\nfunction g(u) = f", "_u", "(u);"],
    [
        "solid s(x, y, z) = x^2 + y^2 + z^2 - 1;\nsolid t = s",
        " | s",
        ";",
    ],
];
/// How often it is repeated.
const LENGTH: usize = 40_000;

/// Requests about programs that are one expression, or one line: the work of each grows with the text, and not with its square.
pub(super) fn long(_seed: u64, count: u64) -> Report {
    let whole = json!({ "start": { "line": 0, "character": 0 }, "end": { "line": 1 << 20, "character": 0 } });
    let document = json!({ "uri": URI });
    let name = json!({ "line": 0, "character": 8 });
    let requests = [
        ("hover", json!({ "position": name })),
        ("documentHighlight", json!({ "position": name })),
        (
            "references",
            json!({ "position": name, "context": { "includeDeclaration": true } }),
        ),
        ("rename", json!({ "position": name, "newName": "zz" })),
        ("selectionRange", json!({ "positions": [name] })),
        ("semanticTokens/full", json!({})),
        ("inlayHint", json!({ "range": whole })),
        ("documentSymbol", json!({})),
        ("foldingRange", json!({})),
        (
            "formatting",
            json!({ "options": { "tabSize": 2, "insertSpaces": true } }),
        ),
    ];
    many(count, requests.len() as u64, |number| {
        let [first, middle, last] = LONG[number as usize % LONG.len()];
        wait_for(async {
            let mut editor = started(Place::Binary, "long").await;
            let text = format!("{first}{}{last}\n", middle.repeat(LENGTH));
            editor.open(URI, &text).await;
            for (method, params) in &requests {
                let mut params = params.clone();
                params["textDocument"] = document.clone();
                // A builtin has no new name; what else is refused is a fault.
                let id = editor.post(&format!("textDocument/{method}"), params).await;
                let answer = editor.answer(id).await;
                assert!(
                    answer.is_ok() || *method == "rename",
                    "{method}: {answer:?}"
                );
            }
            let peak = editor.peak();
            assert_eq!(editor.quit().await, 0);
            peak
        })
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

fn wait_for<T>(conversation: impl Future<Output = T>) -> T {
    let runtime = tokio::runtime::Builder::new_current_thread()
        .enable_all()
        .build();
    runtime.expect("a runtime").block_on(conversation)
}
