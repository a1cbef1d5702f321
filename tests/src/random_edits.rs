//! Random edits through the language server: after each one, its answers are those for the text alone.

use ide::geotrace::GeotraceAnalysis;
use ide::geotrace::semantic::semantic_tokens;
use ide::semantic::TokenType;
use serde_json::{Value, json};
use syntax::diagnostic::{Diagnostic, Severity};
use syntax::span::Span;

use crate::editor::{Editor, Place};

/// After so many edits the tokens' deltas are applied and compared.
const TOKENS: usize = 10;
/// After so many edits every kind of request is asked.
const ROUND: usize = 60;
/// A text that has grown so long is replaced.
const LONGEST: usize = 900;

const START: &str = "\
# A torus 𝛼é and what it needs.
param r : [0.4, 0.9];
grid k : [0, 1, 3];
define tau = 2pi;
function f(x, y) = x y + tau;
surface s(u, v) = ((1 + r cosv)cosu, (1 + r cosv)sinu, r sinv),
    u : [0, tau], v : [0, tau];
point p = s(1, 2);
vector w = s_u(1, 2) @ p;
geodesic g(t) : s = (1, 0) @ (1, 2), t : [0, 1];
";

/// Pieces that change how much of a text is read, and what is around them.
const PIECES: &[&str] = &[
    "",
    "",
    " ",
    ";",
    "#",
    "\n",
    "\r\n",
    "\r",
    "# 𝛼é\n",
    "é",
    "𝛼",
    "\u{FEFF}",
    "a",
    "u",
    "tau",
    "2pi",
    "piv",
    "sin",
    "sinn 2",
    "_u",
    "'",
    "(",
    ")",
    "[0, 1]",
    "}",
    "@",
    ",",
    "^",
    "*",
    "1e9",
    "define ",
    "define a = 1;\n",
    "define ta = 3;",
    "function h(a, b) = a tau + b;\n",
    "param q : [0, 1], [2, 3];",
    "param q = (0.5, a) : [0, 1], [2, 3];",
    "grid n : [1, 2, 4];",
    "curve c(t) = (cost, sint, 0), t : [0, tau];",
    "metric m(x, y) = (1, 0, 1)/y^2, x : [-2, 2], y : [1, 4];",
];

struct Random(u64);

impl Random {
    fn below(&mut self, limit: usize) -> usize {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % limit
    }

    fn piece(&mut self) -> &'static str {
        PIECES[self.below(PIECES.len())]
    }
}

/// A document as the editor has it.
struct Mirror {
    uri: &'static str,
    encoding: &'static str,
    text: String,
    version: i64,
    /// The tokens as the deltas give them, and the name of their state.
    tokens: Vec<i64>,
    state: Value,
}

impl Mirror {
    fn units(&self, text: &str) -> usize {
        match self.encoding {
            "utf-8" => text.len(),
            "utf-16" => text.encode_utf16().count(),
            _ => text.chars().count(),
        }
    }

    /// The start of each line: what ends one is `\n`, `\r\n` or `\r`.
    fn lines(&self) -> Vec<usize> {
        let bytes = self.text.as_bytes();
        let mut starts = vec![0];
        for (k, byte) in bytes.iter().enumerate() {
            if *byte == b'\n' || *byte == b'\r' && bytes.get(k + 1) != Some(&b'\n') {
                starts.push(k + 1);
            }
        }
        starts
    }

    fn position(&self, offset: usize) -> Value {
        self.position_among(&self.lines(), offset)
    }

    fn position_among(&self, starts: &[usize], offset: usize) -> Value {
        let line = starts.iter().rposition(|start| *start <= offset);
        let line = line.expect("the first line starts at 0");
        let column = self.units(&self.text[starts[line]..offset]);
        json!({ "line": line, "character": column })
    }

    fn range(&self, span: Span) -> Value {
        let starts = self.lines();
        json!({
            "start": self.position_among(&starts, span.start as usize),
            "end": self.position_among(&starts, span.end as usize),
        })
    }

    fn offset(&self, position: &Value) -> usize {
        let line = position["line"].as_u64().expect("a line") as usize;
        let column = position["character"].as_u64().expect("a column") as usize;
        let start = self.lines()[line];
        let rest = &self.text[start..];
        let mut all = rest.char_indices().map(|(k, _)| k).chain([rest.len()]);
        let found = all.find(|&k| self.units(&rest[..k]) >= column);
        let found = found.expect("the column is one of the text");
        assert_eq!(self.units(&rest[..found]), column, "within a character");
        start + found
    }

    fn document(&self) -> Value {
        json!({ "uri": self.uri })
    }

    /// A place of the text, not within `\r\n`, which no editor can name.
    fn place(&self, random: &mut Random) -> usize {
        loop {
            let offset = random.below(self.text.len() + 1);
            let between = self.text.as_bytes()[..offset].last() == Some(&b'\r')
                && self.text.as_bytes().get(offset) == Some(&b'\n');
            if self.text.is_char_boundary(offset) && !between {
                return offset;
            }
        }
    }

    /// One edit, as the protocol has it; the text follows it.
    fn edit(&mut self, random: &mut Random) -> Value {
        if self.text.len() > LONGEST || random.below(150) == 0 {
            self.text = START.replace('\n', ["\n", "\r\n"][random.below(2)]);
            return json!({ "text": self.text });
        }
        let start = self.place(random);
        let mut end = start;
        for _ in 0..[0, 0, 1, 3, 12][random.below(5)] {
            end += self.text[end..].chars().next().map_or(0, char::len_utf8);
        }
        if self.text[start..end].ends_with('\r') && self.text[end..].starts_with('\n') {
            end += 1;
        }
        let new = random.piece();
        let range = self.range(Span::new(start as u32, end as u32));
        self.text.replace_range(start..end, new);
        json!({ "range": range, "text": new })
    }

    /// A diagnostic as the server must send it.
    fn diagnostic(&self, found: &Diagnostic) -> Value {
        let message = match &found.hint {
            Some(hint) => format!("{}\n{hint}", found.message),
            None => found.message.clone(),
        };
        let severity = match found.severity {
            Severity::Error => 1,
            Severity::Warning => 2,
            Severity::Hint => 4,
        };
        let mut value = json!({
            "range": self.range(found.span),
            "severity": severity,
            "code": found.code.0,
            "source": "geotrace",
            "message": message,
        });
        if !found.related.is_empty() {
            let related = found.related.iter().map(|related| {
                let location = json!({ "uri": self.uri, "range": self.range(related.span) });
                json!({ "location": location, "message": related.message })
            });
            value["relatedInformation"] = related.collect();
        }
        value
    }

    /// What is wrong with the text, from the text alone.
    fn diagnostics(&self) -> Value {
        let found = scene::geotrace::compile(&self.text).diagnostics;
        found.iter().map(|d| self.diagnostic(d)).collect()
    }

    /// The tokens of a part of the text, from the text alone.
    fn encoded(&self, span: Span) -> Vec<i64> {
        let (mut line, mut column) = (0, 0);
        let starts = self.lines();
        let mut data = Vec::new();
        for token in semantic_tokens(&GeotraceAnalysis::new(self.text.as_str()), span) {
            let place = self.position_among(&starts, token.span.start as usize);
            let next = ["line", "character"].map(|key| place[key].as_i64().expect("a number"));
            let down = next[0] - line;
            let right = if down == 0 { next[1] - column } else { next[1] };
            [line, column] = next;
            let kind = TokenType::ALL.iter().position(|t| *t == token.token_type);
            data.extend([
                down,
                right,
                self.units(token.span.text(&self.text)) as i64,
                kind.expect("a type") as i64,
                i64::from(token.modifiers.0),
            ]);
        }
        data
    }

    /// The text after edits as the protocol has them.
    fn edited(&self, edits: &Value) -> String {
        let edits = edits.as_array().expect("edits").iter();
        let edits = edits.map(|edit| {
            let [start, end] = ["start", "end"].map(|key| self.offset(&edit["range"][key]) as u32);
            let text = edit["newText"].as_str().expect("a text");
            ide::edit::Edit::replace(Span::new(start, end), text)
        });
        ide::edit::apply(&self.text, &edits.collect::<Vec<_>>())
    }
}

fn numbers(value: &Value) -> Vec<i64> {
    let numbers = value.as_array().expect("numbers").iter();
    numbers.map(|n| n.as_i64().expect("a number")).collect()
}

fn without_blanks(text: &str) -> String {
    text.split_whitespace().collect()
}

fn errors(text: &str) -> Vec<&'static str> {
    let found = scene::geotrace::compile(text).diagnostics.into_iter();
    let errors = found.filter(|d| d.severity == Severity::Error);
    errors.map(|d| d.code.0).collect()
}

/// The tokens as deltas give them are those of the text.
async fn check_tokens(editor: &mut Editor, mirror: &mut Mirror) {
    let params = json!({ "textDocument": mirror.document(), "previousResultId": mirror.state });
    let delta = editor
        .ask("textDocument/semanticTokens/full/delta", params)
        .await;
    match delta.get("edits").and_then(Value::as_array) {
        Some(edits) => {
            for edit in edits.iter().rev() {
                let start = edit["start"].as_u64().expect("a start") as usize;
                let gone = edit["deleteCount"].as_u64().expect("a count") as usize;
                let come = edit.get("data").map(numbers).unwrap_or_default();
                mirror.tokens.splice(start..start + gone, come);
            }
        }
        None => mirror.tokens = numbers(&delta["data"]),
    }
    mirror.state = delta["resultId"].clone();
    let all = Span::new(0, mirror.text.len() as u32);
    assert_eq!(mirror.tokens, mirror.encoded(all), "{:?}", mirror.text);
}

/// Every other kind of request answers, at a place of the text and in a range around it.
async fn check_requests(editor: &mut Editor, mirror: &Mirror, random: &mut Random) {
    let offset = mirror.place(random);
    let mut ends = [offset, mirror.place(random)];
    ends.sort_unstable();
    let span = Span::new(ends[0] as u32, ends[1] as u32);
    let place = format!("{:?} at {offset}", mirror.text);
    let document = json!({ "textDocument": mirror.document() });
    let with = |value: &Value, more: Value| -> Value {
        let mut value = value.clone();
        for (key, part) in more.as_object().expect("members") {
            value[key] = part.clone();
        }
        value
    };
    let at = with(&document, json!({ "position": mirror.position(offset) }));
    let within = with(&document, json!({ "range": mirror.range(span) }));
    let options = json!({ "options": { "tabSize": 4, "insertSpaces": true } });

    for method in ["hover", "signatureHelp", "definition", "documentHighlight"] {
        editor
            .ask(&format!("textDocument/{method}"), at.clone())
            .await;
    }
    for method in ["documentSymbol", "foldingRange", "codeLens"] {
        editor
            .ask(&format!("textDocument/{method}"), document.clone())
            .await;
    }
    editor.ask("textDocument/inlayHint", within.clone()).await;
    editor
        .ask("workspace/symbol", json!({ "query": "a" }))
        .await;

    let context = json!({ "context": { "includeDeclaration": true } });
    let references = editor
        .ask("textDocument/references", with(&at, context))
        .await;
    for reference in references.as_array().into_iter().flatten() {
        mirror.offset(&reference["range"]["end"]);
    }
    let positions = json!({ "positions": [mirror.position(offset)] });
    let chain = editor
        .ask("textDocument/selectionRange", with(&document, positions))
        .await;
    let mut link = &chain[0];
    let mut inner = Span::new(offset as u32, offset as u32);
    while link.is_object() {
        let [start, end] = ["start", "end"].map(|key| mirror.offset(&link["range"][key]) as u32);
        assert!(start <= inner.start && inner.end <= end, "{place}: {chain}");
        inner = Span::new(start, end);
        link = &link["parent"];
    }
    assert_eq!(inner, Span::new(0, mirror.text.len() as u32), "{place}");

    let items = editor.ask("textDocument/completion", at.clone()).await;
    if let Some(item) = items.as_array().and_then(|items| items.last()) {
        mirror.edited(&json!([item["textEdit"]]));
        editor.ask("completionItem/resolve", item.clone()).await;
    }
    let context = json!({ "context": { "diagnostics": [] } });
    let actions = editor
        .ask("textDocument/codeAction", with(&within, context))
        .await;
    for action in actions.as_array().into_iter().flatten() {
        let changed = mirror.edited(&action["edit"]["documentChanges"][0]["edits"]);
        assert_ne!(changed, mirror.text, "{place}: {action}");
    }

    let part = editor
        .ask("textDocument/semanticTokens/range", within.clone())
        .await;
    assert_eq!(numbers(&part["data"]), mirror.encoded(span), "{place}");

    let rename = with(&at, json!({ "newName": "zq9" }));
    let prepared = editor.post("textDocument/prepareRename", at.clone()).await;
    let prepared = editor.answer(prepared).await;
    let renamed = editor.post("textDocument/rename", rename).await;
    match editor.answer(renamed).await {
        Ok(edit) => {
            assert!(prepared.is_ok(), "{place}");
            let changed = mirror.edited(&edit["documentChanges"][0]["edits"]);
            assert_eq!(
                errors(&changed),
                errors(&mirror.text),
                "{place}: {changed:?}"
            );
        }
        Err(error) => assert_eq!(error["code"], -32803, "{place}: {error}"),
    }

    for (method, params) in [
        ("formatting", with(&document, options.clone())),
        ("rangeFormatting", with(&within, options.clone())),
        (
            "onTypeFormatting",
            with(&with(&at, options), json!({ "ch": ";" })),
        ),
    ] {
        let edits = editor.ask(&format!("textDocument/{method}"), params).await;
        let laid_out = if edits.is_null() {
            mirror.text.clone()
        } else {
            mirror.edited(&edits)
        };
        assert_eq!(
            without_blanks(&laid_out),
            without_blanks(&mirror.text),
            "{method} {place}"
        );
        assert_eq!(errors(&laid_out), errors(&mirror.text), "{method} {place}");
    }
}

/// Makes random edits of two documents, whose positions an editor counts in this encoding. With `pulls` the editor asks for
/// diagnostics, else it receives them unasked. An equal seed and count give equal edits; more edits are other edits.
///
/// # Panics
/// The differences between the answers of the server and those for the text alone.
pub async fn session(encoding: &'static str, pulls: bool, seed: u64, edits: usize) {
    let mut editor = Editor::start(Place::Here, &format!("random-{encoding}-{pulls}"));
    let answer = editor
        .initialize(json!({
            "general": { "positionEncodings": [encoding] },
            "workspace": { "workspaceEdit": { "documentChanges": true } },
            "textDocument": {
                "documentSymbol": { "hierarchicalDocumentSymbolSupport": true },
                "publishDiagnostics": { "relatedInformation": true, "versionSupport": true },
            },
        }))
        .await;
    assert_eq!(answer["capabilities"]["positionEncoding"], encoding);
    let mut random = Random(seed + edits as u64);
    // Two documents are open: neither is changed by the edits of the other.
    let mut mirrors = ["file:///a.gtr", "untitled:b%20%C3%A9"].map(|uri| Mirror {
        uri,
        encoding,
        text: START.to_owned(),
        version: 1,
        tokens: Vec::new(),
        state: json!("none"),
    });
    for mirror in &mut mirrors {
        editor.open(mirror.uri, &mirror.text).await;
    }
    for count in 0..edits {
        let mirror = &mut mirrors[random.below(2)];
        let changes: Vec<Value> = (0..1 + random.below(8) / 7 * 2)
            .map(|_| mirror.edit(&mut random))
            .collect();
        mirror.version += 1;
        editor
            .change(mirror.uri, mirror.version, json!(changes))
            .await;
        let found = if pulls {
            let params = json!({ "textDocument": mirror.document() });
            editor.ask("textDocument/diagnostic", params).await["items"].clone()
        } else {
            Value::Array(editor.diagnostics(mirror.uri, mirror.version).await)
        };
        assert_eq!(found, mirror.diagnostics(), "{:?}", mirror.text);
        if count % TOKENS == 0 {
            check_tokens(&mut editor, mirror).await;
        }
        if count % ROUND == 0 {
            check_requests(&mut editor, mirror, &mut random).await;
        }
    }
    assert_eq!(editor.quit().await, 0);
}
