//! Requests of every method to the language server, whose params have random types.

use arbitrary::Unstructured;
use serde_json::{Value, json};
use testing::editor::framed;

use super::messages::responses;

/// The requests that the server knows, and one that it does not.
const METHODS: &[&str] = &[
    "textDocument/hover",
    "textDocument/completion",
    "completionItem/resolve",
    "textDocument/signatureHelp",
    "textDocument/definition",
    "textDocument/references",
    "textDocument/documentHighlight",
    "textDocument/prepareRename",
    "textDocument/rename",
    "textDocument/selectionRange",
    "textDocument/codeAction",
    "textDocument/codeLens",
    "textDocument/documentLink",
    "textDocument/documentColor",
    "textDocument/colorPresentation",
    "textDocument/documentSymbol",
    "textDocument/foldingRange",
    "textDocument/formatting",
    "textDocument/rangeFormatting",
    "textDocument/onTypeFormatting",
    "textDocument/inlayHint",
    "textDocument/diagnostic",
    "textDocument/semanticTokens/full",
    "textDocument/semanticTokens/full/delta",
    "textDocument/semanticTokens/range",
    "workspace/symbol",
    "workspace/executeCommand",
    "geotrace/no-such-method",
];
/// The members that params may have.
const KEYS: &[&str] = &[
    "textDocument",
    "uri",
    "position",
    "line",
    "character",
    "range",
    "start",
    "end",
    "options",
    "tabSize",
    "insertSpaces",
    "context",
    "includeDeclaration",
    "diagnostics",
    "positions",
    "newName",
    "ch",
    "query",
    "command",
    "arguments",
    "previousResultId",
    "color",
    "red",
    "label",
    "data",
];
const TEXT: &str = "\
define a = 2pi;
function f(x) = a x; # 𝛼
surface s(u,v) = (u, v, f(u)), u : [0, 1], v : [0, 1];
";
/// The most requests of an input.
const REQUESTS: usize = 6;

/// Inputs of different lengths.
pub(crate) fn seeds() -> Vec<Vec<u8>> {
    (1..9_u8)
        .map(|k| {
            (0..24 * k)
                .map(|at| at.wrapping_mul(37).wrapping_add(k))
                .collect()
        })
        .collect()
}

/// Asks for things with params that are right but for one part, or wrong altogether: each request has one answer.
pub(crate) fn run(input: &[u8]) {
    let mut choices = Unstructured::new(input);
    let document =
        json!({ "uri": "file:///a.gtr", "languageId": "geotrace", "version": 1, "text": TEXT });
    let mut messages = vec![
        json!({ "jsonrpc": "2.0", "id": 0, "method": "initialize", "params": { "capabilities": {} } }),
        json!({ "jsonrpc": "2.0", "method": "initialized", "params": {} }),
        json!({ "jsonrpc": "2.0", "method": "textDocument/didOpen", "params": { "textDocument": document } }),
    ];
    let mut asked = 0;
    while asked < REQUESTS && !choices.is_empty() {
        asked += 1;
        let method = choices.choose(METHODS).expect("a list");
        let params = params(&mut choices);
        messages.push(json!({ "jsonrpc": "2.0", "id": asked, "method": method, "params": params }));
    }
    messages.push(json!({ "jsonrpc": "2.0", "id": asked + 1, "method": "shutdown" }));
    messages.push(json!({ "jsonrpc": "2.0", "method": "exit" }));
    let bytes: String = messages.iter().map(|it| framed(&it.to_string())).collect();
    let responses = responses(bytes.as_bytes());
    for id in 0..=asked + 1 {
        let is_answer = |it: &&Value| it.get("method").is_none() && it["id"] == id;
        let answers: Vec<&Value> = responses.iter().filter(is_answer).collect();
        assert_eq!(
            answers.len(),
            1,
            "answers to {id} of {messages:?}: {responses:?}"
        );
        let answer = answers[0].as_object().expect("an object");
        let is_valid = answer.contains_key("result") || answer["error"]["message"].is_string();
        assert!(is_valid, "{answer:?}");
    }
}

/// Params that most requests understand, of which one part is something else, or none.
fn params(choices: &mut Unstructured<'_>) -> Value {
    let mut params = json!({
        "textDocument": { "uri": "file:///a.gtr" },
        "position": { "line": 1, "character": 9 },
        "range": { "start": { "line": 0, "character": 0 }, "end": { "line": 1, "character": 3 } },
        "options": { "tabSize": 4, "insertSpaces": true },
        "context": { "includeDeclaration": true, "diagnostics": [] },
        "positions": [{ "line": 1, "character": 9 }],
        "newName": "b",
        "ch": ";",
        "query": "a",
        "command": "geotrace.preview",
        "arguments": ["file:///a.gtr"],
        "previousResultId": "1",
        "color": { "red": 1, "green": 0, "blue": 0, "alpha": 1 },
        "label": "a",
    });
    let something = value(choices, 3);
    match number(choices) % 4 {
        0 => return something,
        1 => params[one(choices, KEYS)] = something,
        2 => {
            let inner = ["textDocument", "position", "range", "options", "context"];
            params[one(choices, &inner)][one(choices, KEYS)] = something;
        }
        _ => {}
    }
    params
}

fn number(choices: &mut Unstructured<'_>) -> u8 {
    choices.arbitrary().unwrap_or(0)
}

/// One of a list, which is not empty.
fn one<'a>(choices: &mut Unstructured<'_>, list: &[&'a str]) -> &'a str {
    choices.choose(list).copied().unwrap_or(list[0])
}

/// Any JSON.
fn value(choices: &mut Unstructured<'_>, depth: u32) -> Value {
    let numbers = [0.0, -1.0, 1e300, 4_294_967_296.0, 0.5];
    let texts = [
        "",
        "file:///a.gtr",
        "file:///none.gtr",
        "not a uri",
        "\0",
        "𝛼",
        "a",
        "define",
    ];
    match number(choices) % if depth == 0 { 6 } else { 8 } {
        0 => Value::Null,
        1 => json!(choices.arbitrary::<bool>().unwrap_or(false)),
        2 => json!(choices.arbitrary::<i64>().unwrap_or(0)),
        3 => json!(number(choices)),
        4 => json!(choices.choose(&numbers).copied().unwrap_or(0.0)),
        5 => json!(one(choices, &texts)),
        6 => (0..number(choices) % 4)
            .map(|_| value(choices, depth - 1))
            .collect(),
        _ => {
            let mut object = json!({});
            for _ in 0..number(choices) % 4 {
                let key = one(choices, KEYS);
                object[key] = value(choices, depth - 1);
            }
            object
        }
    }
}
