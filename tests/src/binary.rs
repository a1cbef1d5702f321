//! Runs the binary `geotrace` itself: arguments and bytes in, status, output and peak memory out.
//!
//! The binary is `$GEOTRACE_BIN` if that is set (`tests/run` sets it), else `src/bin/command-line.rs`.

use std::ffi::{OsStr, OsString};
use std::io::{Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::OnceLock;
use std::thread;
use std::time::{Duration, Instant};

/// What a run gave.
#[derive(Clone, Debug)]
pub struct Run {
    /// The exit status; none where a signal ended it.
    pub status: Option<i32>,
    /// Standard output, as text.
    pub stdout: String,
    /// Standard error, as text.
    pub stderr: String,
    /// The largest resident memory seen, in bytes.
    pub peak: u64,
    /// What was run, for messages.
    pub what: String,
}

impl Run {
    /// Panics unless the run ended with this status, and without a panic of its own.
    #[track_caller]
    pub fn expect_status(&self, status: i32) -> &Self {
        assert!(
            self.status == Some(status),
            "{}: status {:?}, not {status}\nstdout: {}\nstderr: {}",
            self.what,
            self.status,
            clip(&self.stdout),
            clip(&self.stderr)
        );
        assert!(
            !self.stderr.contains("panicked") && !self.stdout.contains("panicked"),
            "{}: panicked: {}",
            self.what,
            clip(&self.stderr)
        );
        self
    }

    /// Panics unless one of the outputs holds the fragment.
    #[track_caller]
    pub fn expect_text(&self, fragment: &str) -> &Self {
        assert!(
            self.stdout.contains(fragment) || self.stderr.contains(fragment),
            "{}: no `{fragment}` in\nstdout: {}\nstderr: {}",
            self.what,
            clip(&self.stdout),
            clip(&self.stderr)
        );
        self
    }

    /// Standard output as one JSON document.
    #[track_caller]
    pub fn json(&self) -> serde_json::Value {
        serde_json::from_str(&self.stdout).unwrap_or_else(|error| {
            panic!(
                "{}: no JSON ({error}): {}\nstderr: {}",
                self.what,
                clip(&self.stdout),
                clip(&self.stderr)
            )
        })
    }
}

fn clip(text: &str) -> String {
    const MOST: usize = 3000;
    match text.char_indices().nth(MOST) {
        Some((end, _)) => format!("{}… ({} bytes)", &text[..end], text.len()),
        None => text.to_owned(),
    }
}

/// A run to be made.
#[derive(Debug)]
pub struct Geotrace {
    arguments: Vec<OsString>,
    input: Vec<u8>,
    memory: u64,
    largest_file: Option<u64>,
    folder: Option<PathBuf>,
    environment: Vec<(String, String)>,
    patience: Duration,
}

/// Runs `geotrace` with these arguments, nothing on standard input and up to 4 GiB of address space.
pub fn geotrace<S: AsRef<OsStr>>(arguments: impl IntoIterator<Item = S>) -> Geotrace {
    Geotrace {
        arguments: arguments
            .into_iter()
            .map(|argument| argument.as_ref().to_owned())
            .collect(),
        input: Vec::new(),
        memory: 4 << 30,
        largest_file: None,
        folder: None,
        environment: Vec::new(),
        patience: Duration::from_secs(300),
    }
}

impl Geotrace {
    /// One more argument.
    pub fn argument(mut self, argument: impl AsRef<OsStr>) -> Self {
        self.arguments.push(argument.as_ref().to_owned());
        self
    }

    /// More arguments.
    pub fn arguments<S: AsRef<OsStr>>(mut self, arguments: &[S]) -> Self {
        let more = arguments
            .iter()
            .map(|argument| argument.as_ref().to_owned());
        self.arguments.extend(more);
        self
    }

    /// Bytes for standard input.
    pub fn input(mut self, bytes: impl Into<Vec<u8>>) -> Self {
        self.input = bytes.into();
        self
    }

    /// The most address space, in bytes: beyond it, allocation fails and the run aborts.
    pub fn memory(mut self, bytes: u64) -> Self {
        self.memory = bytes;
        self
    }

    /// The most bytes of a file, in steps of 512: what is written beyond them fails, as on a full disk.
    pub fn largest_file(mut self, bytes: u64) -> Self {
        self.largest_file = Some(bytes);
        self
    }

    /// The longest time that it may take; five minutes if it is not given.
    pub fn within(mut self, patience: Duration) -> Self {
        self.patience = patience;
        self
    }

    /// The working folder.
    pub fn folder(mut self, folder: &Path) -> Self {
        self.folder = Some(folder.to_owned());
        self
    }

    /// An environment variable.
    pub fn environment(mut self, name: &str, value: &str) -> Self {
        self.environment.push((name.to_owned(), value.to_owned()));
        self
    }

    /// Runs it.
    ///
    /// # Panics
    /// When it cannot be started, or hangs (a guard against waiting for ever, not a measurement).
    #[track_caller]
    pub fn run(self) -> Run {
        let what = format!("geotrace {:?}", self.arguments);
        let mut limits = format!("ulimit -v {}", self.memory >> 10);
        if let Some(bytes) = self.largest_file {
            // Without the signal, which would end the program, a write returns an error.
            limits.push_str(&format!(" && trap '' XFSZ && ulimit -f {}", bytes / 512));
        }
        let mut command = Command::new("sh");
        command
            .arg("-c")
            .arg(format!("{limits} && exec \"$0\" \"$@\""))
            .arg(binary())
            .args(&self.arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .env("RUST_BACKTRACE", "0");
        for (name, value) in &self.environment {
            command.env(name, value);
        }
        if let Some(folder) = &self.folder {
            command.current_dir(folder);
        }
        let mut child = command.spawn().expect("sh starts");
        let input = self.input;
        let stdin = child.stdin.take();
        let writer = thread::spawn(move || {
            if let Some(mut stdin) = stdin {
                // A run may end without reading its input.
                let _ = stdin.write_all(&input);
            }
        });
        let stdout = child.stdout.take().map(read_all);
        let stderr = child.stderr.take().map(read_all);
        let (status, peak) = wait(&mut child, self.patience, &what);
        let _ = writer.join();
        let text = |reader: Option<thread::JoinHandle<Vec<u8>>>| {
            let bytes = reader.and_then(|reader| reader.join().ok());
            String::from_utf8_lossy(&bytes.unwrap_or_default()).into_owned()
        };
        Run {
            status,
            stdout: text(stdout),
            stderr: text(stderr),
            peak,
            what,
        }
    }
}

fn read_all(mut stream: impl Read + Send + 'static) -> thread::JoinHandle<Vec<u8>> {
    thread::spawn(move || {
        let mut bytes = Vec::new();
        let _ = stream.read_to_end(&mut bytes);
        bytes
    })
}

/// Waits for the end, and watches the peak of the resident memory, which the kernel keeps.
fn wait(child: &mut Child, patience: Duration, what: &str) -> (Option<i32>, u64) {
    let start = Instant::now();
    let status = format!("/proc/{}/status", child.id());
    let mut peak = 0;
    loop {
        if let Ok(text) = std::fs::read_to_string(&status) {
            peak = peak.max(high_water_mark(&text));
        }
        if let Some(status) = child.try_wait().expect("the run can be waited for") {
            return (status.code(), peak);
        }
        if start.elapsed() > patience {
            let _ = child.kill();
            let _ = child.wait();
            panic!("{what}: did not end within {patience:?}");
        }
        thread::sleep(Duration::from_millis(2));
    }
}

/// `VmHWM` of a process' status file, in bytes.
pub fn high_water_mark(status: &str) -> u64 {
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kilobytes = line.and_then(|line| line.split_whitespace().next()?.parse::<u64>().ok());
    kilobytes.unwrap_or(0) * 1024
}

static BINARY: OnceLock<PathBuf> = OnceLock::new();

/// Runs this program as `geotrace` from now on, unless `$GEOTRACE_BIN` names one or one has been run.
pub fn use_binary(path: PathBuf) {
    if std::env::var_os("GEOTRACE_BIN").is_none() {
        BINARY.get_or_init(|| path);
    }
}

/// Returns the binary's path.
///
/// # Panics
/// If it does not exist.
pub fn binary() -> &'static Path {
    BINARY.get_or_init(|| {
        let given = std::env::var_os("GEOTRACE_BIN").map(PathBuf::from);
        let path = given.unwrap_or_else(built_with_the_tests);
        assert!(path.is_file(), "{} is no file", path.display());
        path
    })
}

/// Returns the path of `command-line`, which cargo builds with the tests of this package: it is never a stale one, and
/// no other features are selected for it.
fn built_with_the_tests() -> PathBuf {
    let test = std::env::current_exe().expect("the path of the test");
    let folder = test.ancestors().nth(2).expect("the folder above `deps`");
    folder.join(format!("command-line{}", std::env::consts::EXE_SUFFIX))
}
