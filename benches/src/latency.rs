//! The language server as an editor meets it: the binary, over its standard streams.
//!
//! A time is that from the moment before an edit is written to the moment after its diagnostics have been read, in
//! real time: pipes and threads are part of it, and so is whatever else the machine does meanwhile.

use std::io::{BufReader, Read, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::{Duration, Instant};

use testing::binary::{binary, high_water_mark};

use crate::measure::megabytes;

/// Edits of each kind.
const EDITS: usize = 1_000;
/// Hovers, each behind an edit.
const HOVERS: usize = 100;
/// For at most how long.
const ENOUGH: Duration = Duration::from_secs(5);
pub(crate) const URI: &str = "file:///bench.gtr";
/// A document in the second language.
pub(crate) const SCRIPT_URI: &str = "file:///bench.crt";

/// The server and the editor's ends of its streams.
pub(crate) struct Session {
    child: Child,
    input: ChildStdin,
    output: BufReader<ChildStdout>,
    /// The document that is edited.
    uri: &'static str,
    version: u32,
    request: u32,
}

impl Session {
    /// Starts the server and shakes hands; also how long that took.
    fn start() -> std::io::Result<(Self, Duration)> {
        Self::start_as("{}")
    }

    /// Starts the server for an editor of these capabilities.
    pub(crate) fn start_as(capabilities: &str) -> std::io::Result<(Self, Duration)> {
        let start = Instant::now();
        let mut child = Command::new(binary())
            .arg("lsp")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()?;
        let (Some(input), Some(output)) = (child.stdin.take(), child.stdout.take()) else {
            return Err(std::io::Error::other("the server has no streams"));
        };
        let mut session = Self {
            child,
            input,
            output: BufReader::new(output),
            uri: URI,
            version: 0,
            request: 0,
        };
        session.ask(
            "initialize",
            &format!(r#"{{"processId":null,"rootUri":null,"capabilities":{capabilities}}}"#),
        )?;
        let time = start.elapsed();
        session.notify("initialized", "{}")?;
        Ok((session, time))
    }

    fn send(&mut self, body: &str) -> std::io::Result<()> {
        write!(self.input, "Content-Length: {}\r\n\r\n{body}", body.len())?;
        self.input.flush()
    }

    pub(crate) fn notify(&mut self, method: &str, params: &str) -> std::io::Result<()> {
        self.send(&format!(
            r#"{{"jsonrpc":"2.0","method":"{method}","params":{params}}}"#
        ))
    }

    /// The body of the answer.
    pub(crate) fn ask(&mut self, method: &str, params: &str) -> std::io::Result<String> {
        self.request += 1;
        let id = self.request;
        self.send(&format!(
            r#"{{"jsonrpc":"2.0","id":{id},"method":"{method}","params":{params}}}"#
        ))?;
        self.wait(&[&format!("\"id\":{id}")])
    }

    /// The next message that holds all of these.
    pub(crate) fn wait(&mut self, parts: &[&str]) -> std::io::Result<String> {
        loop {
            let mut header = Vec::new();
            while !header.ends_with(b"\r\n\r\n") {
                let mut byte = [0];
                self.output.read_exact(&mut byte)?;
                header.push(byte[0]);
            }
            let header = String::from_utf8_lossy(&header);
            let length = header.trim().rsplit(' ').next();
            let length = length.and_then(|length| length.parse().ok());
            let mut body = vec![0; length.ok_or_else(|| std::io::Error::other("no length"))?];
            self.output.read_exact(&mut body)?;
            let body = String::from_utf8_lossy(&body).into_owned();
            if parts.iter().all(|part| body.contains(part)) {
                return Ok(body);
            }
        }
    }

    /// Waits for the diagnostics of the current version.
    fn diagnosed(&mut self) -> std::io::Result<String> {
        let version = format!("\"version\":{}", self.version);
        self.wait(&["publishDiagnostics", &version])
    }

    pub(crate) fn open(&mut self, text: &str) -> std::io::Result<String> {
        self.open_as(URI, text)
    }

    /// Opens the document that is edited from now on.
    pub(crate) fn open_as(&mut self, uri: &'static str, text: &str) -> std::io::Result<String> {
        self.uri = uri;
        self.version += 1;
        let text = text.replace('\\', "\\\\").replace('"', "\\\"");
        let text = text.replace('\n', "\\n");
        let language = match uri {
            SCRIPT_URI => "crt",
            _ => "geotrace",
        };
        let document = format!(
            r#"{{"uri":"{uri}","languageId":"{language}","version":{},"text":"{text}"}}"#,
            self.version
        );
        self.notify(
            "textDocument/didOpen",
            &format!(r#"{{"textDocument":{document}}}"#),
        )?;
        self.diagnosed()
    }

    /// Replaces columns of a line.
    pub(crate) fn change(
        &mut self,
        line: usize,
        columns: [usize; 2],
        text: &str,
    ) -> std::io::Result<()> {
        self.version += 1;
        let [start, end] =
            columns.map(|column| format!(r#"{{"line":{line},"character":{column}}}"#));
        let change = format!(r#"{{"range":{{"start":{start},"end":{end}}},"text":"{text}"}}"#);
        let uri = self.uri;
        let document = format!(r#"{{"uri":"{uri}","version":{}}}"#, self.version);
        self.notify(
            "textDocument/didChange",
            &format!(r#"{{"textDocument":{document},"contentChanges":[{change}]}}"#),
        )
    }

    /// Inserts a text and takes it out again, in turn: how long until the diagnostics are there.
    fn toggle(&mut self, at: [usize; 2], inserted: &str, k: usize) -> std::io::Result<Duration> {
        let [line, column] = at;
        let start = Instant::now();
        if k.is_multiple_of(2) {
            self.change(line, [column, column], inserted)?;
        } else {
            self.change(line, [column, column + inserted.len()], "")?;
        }
        self.diagnosed()?;
        Ok(start.elapsed())
    }

    /// `VmRSS` and the highest it has been, in bytes.
    fn memory(&self) -> [u64; 2] {
        memory_of(self.child.id())
    }

    /// The processes that the server has started.
    pub(crate) fn children(&self) -> Vec<u32> {
        let threads = std::fs::read_dir(format!("/proc/{}/task", self.child.id()));
        let threads = threads.into_iter().flatten().flatten();
        let lists = threads.map(|thread| std::fs::read_to_string(thread.path().join("children")));
        let all: Vec<String> = lists.flatten().collect();
        let all = all.iter().flat_map(|list| list.split_whitespace());
        all.filter_map(|child| child.parse().ok()).collect()
    }

    /// The version of the text that was sent last.
    pub(crate) fn version(&self) -> u32 {
        self.version
    }

    /// Time on processors so far, in hundredths of a second.
    fn ticks(&self) -> u64 {
        let stat = std::fs::read_to_string(format!("/proc/{}/stat", self.child.id()));
        let stat = stat.unwrap_or_default();
        let fields = stat.rsplit(')').next().unwrap_or_default();
        let fields = fields.split_whitespace().skip(11).take(2);
        fields.filter_map(|field| field.parse::<u64>().ok()).sum()
    }

    pub(crate) fn quit(mut self) -> std::io::Result<()> {
        self.ask("shutdown", "null")?;
        self.notify("exit", "null")?;
        self.child.wait().map(|_| ())
    }
}

/// A process's `VmRSS` and the highest it has been, in bytes.
pub(crate) fn memory_of(process: u32) -> [u64; 2] {
    let status = std::fs::read_to_string(format!("/proc/{process}/status"));
    let status = status.unwrap_or_default();
    let now = status
        .replace("VmHWM:", "VmOld:")
        .replace("VmRSS:", "VmHWM:");
    [high_water_mark(&now), high_water_mark(&status)]
}

/// Prints the median and the 99th of a hundred, of as many as there is time for.
pub(crate) fn print(
    what: &str,
    count: usize,
    time: impl FnMut(usize) -> std::io::Result<Duration>,
) {
    print_within(ENOUGH, what, count, time);
}

/// As [`print()`], with another time.
pub(crate) fn print_within(
    enough: Duration,
    what: &str,
    count: usize,
    mut time: impl FnMut(usize) -> std::io::Result<Duration>,
) {
    let mut times = Vec::new();
    // The first find nothing in the processor's caches.
    for k in 0..20 {
        if let Err(error) = time(k) {
            println!("    {what:<44} the server has ended: {error}");
            return;
        }
    }
    let start = Instant::now();
    while times.len() < count && start.elapsed() < enough {
        match time(times.len()) {
            Ok(time) => times.push(time),
            Err(error) => {
                println!("    {what:<44} the server has ended: {error}");
                return;
            }
        }
    }
    times.sort_unstable();
    let at = |share: f64| {
        let index = (times.len() as f64 * share) as usize;
        times.get(index).copied().unwrap_or_default().as_secs_f64() * 1e3
    };
    println!(
        "    {what:<44} p50 {:>9.3} ms   p99 {:>9.3} ms",
        at(0.5),
        at(0.99)
    );
}

/// A program of so many declarations that is drawn with few samples, so that it keeps to the limits.
fn sparse(declarations: usize) -> String {
    let text = crate::front::program(declarations);
    let text = text.replace("2pi, 200]", "2pi, 9]");
    text.replace("[-1, 1]", "[-1, 1, 5]")
}

/// The line and the column behind a piece of the text, which is ASCII.
pub(crate) fn behind(text: &str, piece: &str) -> [usize; 2] {
    let at = text.find(piece).map_or(0, |at| at + piece.len());
    let before = &text[..at];
    let start = before.rfind('\n').map_or(0, |at| at + 1);
    [before.matches('\n').count(), at - start]
}

fn lengths() -> std::io::Result<()> {
    for declarations in [100, 1_000, 10_000, 100_000] {
        let text = sparse(declarations);
        let (mut session, _) = Session::start()?;
        let start = Instant::now();
        let first = session.open(&text)?;
        println!(
            "  {declarations} declarations, {:.2} MB: opened in {:.1} ms",
            text.len() as f64 / 1e6,
            1e3 * start.elapsed().as_secs_f64()
        );
        if !first.contains("\"diagnostics\":[]") {
            println!("    it has diagnostics: {}", &first[..first.len().min(300)]);
        }
        let [opened, _] = session.memory();
        let near = |k: usize| k / 10 * 10 + 2;
        for (place, k) in [
            ("top", 2),
            ("middle", near(declarations / 2)),
            ("end", near(declarations - 10)),
        ] {
            let at = behind(&text, &format!("function f{k}(x, y) = "));
            print(&format!("a number, {place}"), EDITS, |k| {
                session.toggle(at, "1", k)
            });
        }
        let at = behind(&text, "# declaration 9 is");
        print("a comment, top", EDITS, |k| session.toggle(at, " é", k));
        let [line, column] = behind(&text, &format!("function f{}", near(declarations / 2)));
        print("a name that is used below, middle", EDITS, |k| {
            session.toggle([line, column], "0", k)
        });
        let [edited, _] = session.memory();
        let at = behind(
            &text,
            &format!("function f{}(x, y) = ", near(declarations / 2)),
        );
        let place = |line: usize, column: usize| {
            format!(
                r#"{{"textDocument":{{"uri":"{URI}"}},"position":{{"line":{line},"character":{column}}}}}"#
            )
        };
        let [last, body] = behind(
            &text,
            &format!("function f{}(x, y) = ", near(declarations - 10)),
        );
        for (what, method, params) in [
            (
                "a hover behind an edit",
                "textDocument/hover",
                place(line, column),
            ),
            (
                "completion at the end behind an edit",
                "textDocument/completion",
                place(last, body),
            ),
            (
                "the outline behind an edit",
                "textDocument/documentSymbol",
                format!(r#"{{"textDocument":{{"uri":"{URI}"}}}}"#),
            ),
            (
                "all tokens behind an edit",
                "textDocument/semanticTokens/full",
                format!(r#"{{"textDocument":{{"uri":"{URI}"}}}}"#),
            ),
        ] {
            print(what, HOVERS, |k| {
                session.toggle(at, "1", k)?;
                let start = Instant::now();
                session.ask(method, &params)?;
                Ok(start.elapsed())
            });
        }
        let [after_features, highest] = session.memory();
        println!(
            "    resident memory {:.1} MB after opening, {:.1} MB after the edits, {:.1} MB at the end, at most {:.1} MB",
            megabytes(opened),
            megabytes(edited),
            megabytes(after_features),
            megabytes(highest)
        );
        session.quit()?;
    }
    Ok(())
}

fn beginning() -> std::io::Result<()> {
    let mut times = Vec::new();
    for _ in 0..21 {
        let (session, time) = Session::start()?;
        times.push(time);
        session.quit()?;
    }
    println!(
        "  from starting the program to its answer to `initialize`: {}",
        crate::measure::Times::new(times)
    );
    let (mut session, _) = Session::start()?;
    session.open(&sparse(1_000))?;
    let before = session.ticks();
    std::thread::sleep(Duration::from_secs(2));
    println!(
        "  idle for two seconds: {} ms of processor time",
        10 * (session.ticks() - before)
    );
    session.quit()
}

/// Prints the table.
pub(crate) fn run() {
    println!(
        "The language server, from an edit that is sent to its diagnostics that have been read"
    );
    if let Err(error) = beginning().and_then(|()| lengths()) {
        println!("  the server has ended: {error}");
    }
}
