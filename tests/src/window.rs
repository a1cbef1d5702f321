//! Preview windows that a test plays: the server starts `fake-window`, which hands everything on to the test.

use std::time::Duration;

use serde_json::{Value, json};
use server::WindowProgram;
use tokio::io::{AsyncBufReadExt, AsyncWriteExt, BufReader, Lines};
use tokio::net::tcp::{OwnedReadHalf, OwnedWriteHalf};
use tokio::net::{TcpListener, TcpStream};
use tokio::time::timeout;

/// The version of the messages.
pub const VERSION: u32 = 3;
/// Nothing takes longer, whatever else the machine does.
const PATIENCE: Duration = Duration::from_secs(60);

/// Where windows report to when a server starts them.
pub struct Windows {
    listener: TcpListener,
    /// What the server has to start.
    pub program: WindowProgram,
}

/// A window as the server sees it, played by the test.
pub struct Window {
    /// The process.
    pub pid: u32,
    lines: Lines<BufReader<OwnedReadHalf>>,
    writer: OwnedWriteHalf,
    /// The last text, with the edits since then.
    text: Value,
}

impl Windows {
    /// Windows are processes of this program, `fake-window`; deaf ones read nothing of the text until they are ordered to.
    pub async fn new(fake: &str, deaf: bool) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").await.expect("a port");
        let address = listener.local_addr().expect("an address").to_string();
        let deaf = deaf.then(|| "deaf".into());
        let program = WindowProgram {
            program: fake.into(),
            arguments: [address.into()].into_iter().chain(deaf).collect(),
            version_timeout: PATIENCE,
            close_delay: Duration::from_millis(1),
        };
        Self { listener, program }
    }

    /// The next window that a server starts.
    pub async fn next(&self) -> Window {
        let accepted = timeout(PATIENCE, self.listener.accept()).await;
        let (stream, _) = accepted.expect("a window starts").expect("a connection");
        Window::new(stream).await
    }

    /// Whether a window has been started that was not asked for.
    pub async fn is_any(&self) -> bool {
        timeout(Duration::from_millis(300), self.listener.accept())
            .await
            .is_ok()
    }
}

impl Window {
    async fn new(stream: TcpStream) -> Self {
        let (reader, writer) = stream.into_split();
        let mut window = Self {
            pid: 0,
            lines: BufReader::new(reader).lines(),
            writer,
            text: Value::Null,
        };
        let line = window.line().await.expect("it reports its process");
        window.pid = line
            .strip_prefix("pid ")
            .expect("a process")
            .parse()
            .expect("a number");
        window
    }

    async fn line(&mut self) -> Option<String> {
        let line = timeout(PATIENCE, self.lines.next_line()).await;
        line.expect("a line arrives").unwrap_or_default()
    }

    /// Returns the next message of the server; `None` when it sends no more or the process has ended.
    pub async fn receive(&mut self) -> Option<Value> {
        let line = self.line().await?;
        let received: Value = serde_json::from_str(line.strip_prefix("in ")?).expect("JSON");
        match received["type"].as_str() {
            Some("text") => self.text = received.clone(),
            Some("edit") => self.edit(&received),
            _ => {}
        }
        Some(received)
    }

    /// Returns the next message of the server of this type; others are skipped. A text may come as an edit of the one before: it
    /// is returned whole.
    pub async fn receive_of(&mut self, kind: &str) -> Value {
        loop {
            let received = self.receive().await;
            let received =
                received.unwrap_or_else(|| panic!("the server ended before a {kind} came"));
            if kind == "text" && received["type"] == "edit" {
                return self.text.clone();
            }
            if received["type"] == kind {
                return received;
            }
        }
    }

    /// Applies an edit to the text.
    fn edit(&mut self, received: &Value) {
        assert_eq!(
            received["base"], self.text["version"],
            "it applies to the text"
        );
        let mut text = self.text["text"].as_str().expect("a text").to_owned();
        let changes = received["changes"].as_array().expect("changes").iter();
        for change in changes.rev() {
            let [start, end] = [0, 1].map(|k| change["range"][k].as_u64().expect("an offset"));
            let new = change["text"].as_str().expect("a text");
            text.replace_range(start as usize..end as usize, new);
        }
        self.text["version"] = received["version"].clone();
        self.text["text"] = json!(text);
    }

    /// Returns true if it receives nothing for a while.
    pub async fn receives_nothing(&mut self) -> bool {
        timeout(Duration::from_millis(300), self.receive())
            .await
            .is_err()
    }

    /// Waits for the end of its process, or of the messages to it.
    pub async fn ended(&mut self) {
        while self.receive().await.is_some() {}
    }

    async fn order(&mut self, word: &str, rest: &str) {
        let line = format!("{word} {rest}\n");
        self.writer
            .write_all(line.as_bytes())
            .await
            .expect("the process lives");
    }

    /// Writes a line to its standard output.
    pub async fn send_line(&mut self, line: &str) {
        self.order("out", line).await;
    }

    /// Sends an event.
    pub async fn send(&mut self, event: Value) {
        self.send_line(&event.to_string()).await;
    }

    /// Writes a line to its standard error.
    pub async fn complain(&mut self, line: &str) {
        self.order("err", line).await;
    }

    /// Has a deaf one read.
    pub async fn listen(&mut self) {
        self.order("listen", "").await;
    }

    /// Ends by itself.
    pub async fn exit(mut self, status: i32) {
        self.order("exit", &status.to_string()).await;
        self.ended().await;
    }

    /// Is ended by a signal.
    pub async fn kill(mut self) {
        kill(self.pid);
        self.ended().await;
    }

    /// Shakes hands: each side sends its version.
    pub async fn greet(&mut self) {
        self.greet_as(VERSION).await;
        let received = self.receive().await.expect("a greeting");
        assert_eq!(
            (&received["type"], &received["protocol"]),
            (&json!("hello"), &json!(VERSION))
        );
    }

    /// Says a version of the messages.
    pub async fn greet_as(&mut self, version: u32) {
        self.send(json!({ "type": "hello", "protocol": version, "program": "fake" }))
            .await;
    }
}

/// Ends a process by a signal that it cannot catch, and waits until it has ended.
pub fn kill(pid: u32) {
    let mut command = std::process::Command::new("kill");
    let status = command.args(["-9", &pid.to_string()]).status();
    assert!(status.expect("kill is there").success(), "{pid} lives");
    // One that nobody has waited for yet is a zombie (the word behind its name) without other threads.
    let lives = || {
        let stat = std::fs::read_to_string(format!("/proc/{pid}/stat")).unwrap_or_default();
        let state = stat.rsplit(") ").next().unwrap_or_default();
        let threads = std::fs::read_dir(format!("/proc/{pid}/task"));
        !(state.is_empty() || state.starts_with('Z') && threads.is_ok_and(|t| t.count() <= 1))
    };
    while lives() {
        std::thread::sleep(Duration::from_millis(5));
    }
}
