//! An editor without a window: speaks the language server protocol to a server in this process or to the binary.
//!
//! Every message is recorded. Where `GEOTRACE_TRANSCRIPTS` names a folder, each conversation is left there as
//! JSON lines for `tests/protocol/validate.mjs`, which checks it against the protocol's own types.

use std::collections::VecDeque;
use std::path::PathBuf;
use std::process::Stdio;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use ide::Languages;
use serde_json::{Value, json};
use server::WindowProgram;
use tokio::io::{AsyncRead, AsyncReadExt, AsyncWrite, AsyncWriteExt};
use tokio::process::{Child, Command};
use tokio::sync::{Mutex, mpsc};
use tokio::task::JoinHandle;
use tokio::time::{sleep, timeout};

use crate::binary::high_water_mark;

/// No answer takes longer, whatever else the machine does.
const PATIENCE: Duration = Duration::from_secs(60);
/// Bytes on the way to a server in this process.
const BUFFER: usize = 1 << 16;

/// Where the server runs.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum Place {
    /// In this process, over a pair of streams.
    Here,
    /// The binary, over its standard input and output.
    Binary,
}

/// Both places.
pub const PLACES: [Place; 2] = [Place::Here, Place::Binary];

/// An editor and its server.
pub struct Editor {
    name: String,
    writer: Option<Box<dyn AsyncWrite + Unpin + Send>>,
    incoming: mpsc::UnboundedReceiver<Value>,
    /// Locked while nothing is to be read.
    may_read: Arc<Mutex<()>>,
    server: Server,
    next: i64,
    /// Messages that were not asked for yet: notifications, and answers to other requests.
    waiting: VecDeque<Value>,
    transcript: Vec<Value>,
    /// What the server has asked for.
    requests: VecDeque<Value>,
    /// What the editor answers when it is asked for its settings.
    pub settings: Value,
    /// What the editor answers when it is asked to apply an edit.
    pub applied: Value,
}

enum Server {
    Here(JoinHandle<bool>),
    Binary(Child),
}

impl Editor {
    /// Starts a server; `name` is the conversation's, and should be unique. It has no preview window.
    pub fn start(place: Place, name: &str) -> Self {
        Self::start_with(place, name, None)
    }

    /// Starts a server that starts this program for a preview; the binary starts its own if there is none.
    pub fn start_with(place: Place, name: &str, window: Option<&WindowProgram>) -> Self {
        Self::start_for(place, name, Languages::standard(), window)
    }

    /// Starts a server for documents in these languages; the binary has its own.
    pub fn start_for(
        place: Place,
        name: &str,
        languages: Languages,
        window: Option<&WindowProgram>,
    ) -> Self {
        let (reader, writer, server): (
            Box<dyn AsyncRead + Unpin + Send>,
            Box<dyn AsyncWrite + Unpin + Send>,
            Server,
        ) = match place {
            Place::Here => {
                let (writer, input) = tokio::io::duplex(BUFFER);
                let (output, reader) = tokio::io::duplex(BUFFER);
                let task = tokio::spawn(server::serve(input, output, languages, window.cloned()));
                (Box::new(reader), Box::new(writer), Server::Here(task))
            }
            Place::Binary => {
                let mut command = Command::new(crate::binary::binary());
                command.arg("lsp");
                if let Some(window) = window {
                    command.arg("--window").arg(&window.program);
                    command.args(&window.arguments);
                }
                let mut child = command
                    .stdin(Stdio::piped())
                    .stdout(Stdio::piped())
                    .stderr(Stdio::inherit())
                    .kill_on_drop(true)
                    .spawn()
                    .expect("the binary starts");
                let reader = child.stdout.take().expect("a pipe");
                let writer = child.stdin.take().expect("a pipe");
                (Box::new(reader), Box::new(writer), Server::Binary(child))
            }
        };
        let (sender, incoming) = mpsc::unbounded_channel();
        let may_read = Arc::new(Mutex::new(()));
        tokio::spawn(read(reader, may_read.clone(), sender));
        Self {
            name: format!("{name}-{place:?}"),
            writer: Some(writer),
            incoming,
            may_read,
            server,
            next: 0,
            waiting: VecDeque::new(),
            transcript: Vec::new(),
            requests: VecDeque::new(),
            settings: Value::Null,
            applied: json!({ "applied": true }),
        }
    }

    /// Shakes hands with these capabilities; the server's answer.
    pub async fn initialize(&mut self, capabilities: Value) -> Value {
        let params = json!({ "processId": null, "rootUri": null, "capabilities": capabilities });
        self.initialize_with(params).await
    }

    /// Shakes hands with these params; the server's answer.
    pub async fn initialize_with(&mut self, params: Value) -> Value {
        let answer = self.ask("initialize", params).await;
        self.notify("initialized", json!({})).await;
        answer
    }

    /// Reads nothing from the server for this time, at most the rest of a message that is under way; what is sent is written
    /// meanwhile.
    pub async fn read_late(&self, time: Duration) {
        let held = self.may_read.clone().lock_owned().await;
        tokio::spawn(async move {
            sleep(time).await;
            drop(held);
        });
    }

    /// Sends bytes as they are.
    pub async fn send_raw(&mut self, bytes: &[u8]) {
        if let Some(writer) = &mut self.writer {
            // A server that has ended reads nothing more: that shows in what comes back.
            let _ = writer.write_all(bytes).await;
            let _ = writer.flush().await;
        }
    }

    async fn send(&mut self, message: Value) {
        self.transcript
            .push(json!({ "from": "client", "message": message }));
        self.send_raw(framed(&message.to_string()).as_bytes()).await;
    }

    /// Sends a notification.
    pub async fn notify(&mut self, method: &str, params: Value) {
        self.send(json!({ "jsonrpc": "2.0", "method": method, "params": params }))
            .await;
    }

    /// Sends a request without waiting; its identifier.
    pub async fn post(&mut self, method: &str, params: Value) -> i64 {
        self.next += 1;
        let id = self.next;
        let mut message = json!({ "jsonrpc": "2.0", "id": id, "method": method });
        if !params.is_null() {
            message["params"] = params;
        }
        self.send(message).await;
        id
    }

    /// The answer to a request: its result, or its error.
    pub async fn answer(&mut self, id: i64) -> Result<Value, Value> {
        let message = self
            .wait(&format!("the answer to {id}"), |m| {
                m.get("method").is_none() && m["id"] == id
            })
            .await;
        match message.get("error") {
            Some(error) => Err(error.clone()),
            None => Ok(message["result"].clone()),
        }
    }

    /// Sends a request and waits for its result.
    pub async fn ask(&mut self, method: &str, params: Value) -> Value {
        let id = self.post(method, params).await;
        match self.answer(id).await {
            Ok(result) => result,
            Err(error) => panic!("{method}: {error}"),
        }
    }

    /// Sends a request that must fail; its error.
    pub async fn fail(&mut self, method: &str, params: Value) -> Value {
        let id = self.post(method, params).await;
        match self.answer(id).await {
            Ok(result) => panic!("{method} should fail, but gave {result}"),
            Err(error) => error,
        }
    }

    /// The error of a message that the server could not read: it has no identifier.
    pub async fn answer_to_nothing(&mut self) -> Value {
        let is_one = |m: &Value| m.get("method").is_none() && m["id"].is_null();
        let message = self.wait("an error", is_one).await;
        message["error"].clone()
    }

    /// The next notification of a method that fits.
    pub async fn notified(&mut self, method: &str, fits: impl Fn(&Value) -> bool) -> Value {
        let what = format!("a notification {method}");
        let message = self
            .wait(&what, |m| m["method"] == method && fits(&m["params"]))
            .await;
        message["params"].clone()
    }

    /// The next thing of a method that the server asks for: its params.
    pub async fn asked(&mut self, method: &str) -> Value {
        loop {
            let known = self.requests.iter().position(|r| r["method"] == method);
            if let Some(request) = known.and_then(|k| self.requests.remove(k)) {
                return request["params"].clone();
            }
            match self.step().await {
                Some(Some(message)) => self.waiting.push_back(message),
                Some(None) => {}
                None => panic!(
                    "{}: the server ended before it asked for {method}",
                    self.name
                ),
            }
        }
    }

    /// What is wrong with a version of a document, as the server sends it unasked.
    pub async fn diagnostics(&mut self, uri: &str, version: i64) -> Vec<Value> {
        let params = self
            .notified("textDocument/publishDiagnostics", |p| {
                p["uri"] == uri && p["version"] == version
            })
            .await;
        params["diagnostics"].as_array().expect("a list").clone()
    }

    /// Opens a document, at version 1.
    pub async fn open(&mut self, uri: &str, text: &str) {
        let document = json!({ "uri": uri, "languageId": "geotrace", "version": 1, "text": text });
        self.notify("textDocument/didOpen", json!({ "textDocument": document }))
            .await;
    }

    /// Changes a document: each change is a range (or null) and a text.
    pub async fn change(&mut self, uri: &str, version: i64, changes: Value) {
        let params = json!({
            "textDocument": { "uri": uri, "version": version },
            "contentChanges": changes,
        });
        self.notify("textDocument/didChange", params).await;
    }

    async fn wait(&mut self, what: &str, fits: impl Fn(&Value) -> bool) -> Value {
        if let Some(k) = self.waiting.iter().position(&fits) {
            return self.waiting.remove(k).expect("it is there");
        }
        loop {
            let message = match self.next_message().await {
                Some(message) => message,
                None => panic!("{}: the server ended before {what} came", self.name),
            };
            if fits(&message) {
                return message;
            }
            self.waiting.push_back(message);
        }
    }

    /// The next message, the server's requests apart: those are answered.
    pub async fn next_message(&mut self) -> Option<Value> {
        loop {
            if let Some(message) = self.step().await? {
                return Some(message);
            }
        }
    }

    /// Takes the next message: an outer `None` at the end, an inner one for a request, which is answered.
    async fn step(&mut self) -> Option<Option<Value>> {
        let received = timeout(PATIENCE, self.incoming.recv()).await;
        let message = received
            .unwrap_or_else(|_| panic!("{}: the server says nothing any more", self.name))?;
        self.transcript
            .push(json!({ "from": "server", "message": message }));
        if message.get("method").is_none() || message.get("id").is_none() {
            return Some(Some(message));
        }
        let result = match message["method"].as_str() {
            Some("workspace/configuration") => json!([self.settings]),
            Some("workspace/applyEdit") => self.applied.clone(),
            Some("window/showDocument") => json!({ "success": true }),
            _ => Value::Null,
        };
        let answer = json!({ "jsonrpc": "2.0", "id": message["id"], "result": result });
        self.requests.push_back(message);
        self.send(answer).await;
        Some(None)
    }

    /// Says goodbye as the protocol has it; the exit status.
    pub async fn quit(mut self) -> i32 {
        let id = self.post("shutdown", Value::Null).await;
        assert_eq!(self.answer(id).await, Ok(Value::Null));
        self.send(json!({ "jsonrpc": "2.0", "method": "exit" }))
            .await;
        self.end().await
    }

    /// Closes the server's input; its exit status when it has ended.
    pub async fn hang_up(mut self) -> i32 {
        self.writer = None;
        self.end().await
    }

    /// The exit status when the server has ended by itself; its input stays open.
    pub async fn end(mut self) -> i32 {
        let status = match &mut self.server {
            Server::Here(task) => {
                let clean = timeout(PATIENCE, task).await.expect("the server ends");
                i32::from(!clean.expect("no panic"))
            }
            Server::Binary(child) => {
                let status = timeout(PATIENCE, child.wait())
                    .await
                    .expect("the server ends");
                status.expect("a status").code().expect("no signal")
            }
        };
        // The last messages.
        while let Ok(Some(message)) = timeout(Duration::from_secs(5), self.incoming.recv()).await {
            self.transcript
                .push(json!({ "from": "server", "message": message }));
        }
        self.leave_transcript();
        status
    }

    fn leave_transcript(&self) {
        // Tests that have the same name, in one program or in two, each leave a file.
        static COUNT: AtomicUsize = AtomicUsize::new(0);
        let Some(folder) = std::env::var_os("GEOTRACE_TRANSCRIPTS").map(PathBuf::from) else {
            return;
        };
        std::fs::create_dir_all(&folder).expect("a folder");
        let lines: String = self.transcript.iter().map(|m| format!("{m}\n")).collect();
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        let name = format!("{}-{}-{count}.jsonl", self.name, std::process::id());
        std::fs::write(folder.join(name), lines).expect("a file");
    }

    /// Returns the messages of the server so far.
    pub fn received(&self) -> impl Iterator<Item = &Value> {
        let server = self
            .transcript
            .iter()
            .filter(|entry| entry["from"] == "server");
        server.map(|entry| &entry["message"])
    }

    /// The server's process, if it is one.
    pub fn process(&self) -> Option<u32> {
        match &self.server {
            Server::Here(_) => None,
            Server::Binary(child) => child.id(),
        }
    }

    /// The largest resident memory of the server's process until now, in bytes: of Linux only, elsewhere it is 0.
    ///
    /// # Panics
    /// If the server has no process of its own.
    pub fn peak(&self) -> u64 {
        let process = self.process().expect("a process");
        let status = std::fs::read_to_string(format!("/proc/{process}/status"));
        status.map_or(0, |status| high_water_mark(&status))
    }
}

/// Takes messages from a stream until it ends. What is no message of the protocol is a fault of the server.
async fn read(
    mut stream: Box<dyn AsyncRead + Unpin + Send>,
    may_read: Arc<Mutex<()>>,
    sender: mpsc::UnboundedSender<Value>,
) {
    let mut bytes: Vec<u8> = Vec::new();
    loop {
        while let Some((message, used)) = frame(&bytes) {
            bytes.drain(..used);
            if sender.send(message).is_err() {
                return;
            }
        }
        drop(may_read.lock().await);
        if !matches!(stream.read_buf(&mut bytes).await, Ok(1..)) {
            assert!(bytes.is_empty(), "the server ended within a message");
            return;
        }
    }
}

/// The text of a message as it is sent.
pub fn framed(body: &str) -> String {
    format!("Content-Length: {}\r\n\r\n{body}", body.len())
}

/// The first message in what a server has sent, and how many bytes it takes; `None` if it is not there as a whole.
///
/// # Panics
/// If what stands there is no message.
pub fn frame(bytes: &[u8]) -> Option<(Value, usize)> {
    let header = bytes.windows(4).position(|w| w == b"\r\n\r\n")?;
    let text = std::str::from_utf8(&bytes[..header]).expect("an ASCII header");
    let length: usize = text
        .strip_prefix("Content-Length: ")
        .expect("a length")
        .parse()
        .expect("a number");
    let body = bytes.get(header + 4..header + 4 + length)?;
    let message = serde_json::from_slice(body).expect("JSON");
    Some((message, header + 4 + length))
}
