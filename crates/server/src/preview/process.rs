//! The process of a window: the threads that write to it and read from it, and its end.
//!
//! ```text
//! mailbox ──writer──▶ standard input        the only thread that a window which does not read can stop
//! outputs ◀──reader── standard output       events; then how it ended
//! outputs ◀──logger── standard error        lines for the log
//! ```

use std::collections::VecDeque;
use std::io::{BufRead, BufReader, Read};
use std::process::{Child, ChildStderr, ChildStdin, ChildStdout, Stdio};
use std::sync::mpsc as sync;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use protocol::line::{self, ReadError, WriteError};
use protocol::mailbox::Mailbox;
use protocol::{Command, Event};
use tokio::sync::{Notify, mpsc, watch};

use super::WindowProgram;
use crate::platform;

/// The maximum number of waiting outputs: beyond it an event waits, and a line for the log is dropped.
const MOST_WAITING: usize = 64;
/// The maximum number of log lines that are taken from one window.
const MOST_LINES: usize = 1000;
/// The maximum length of such a line, in bytes.
const LONGEST_LINE: u64 = 4096;
/// The number of last lines that are kept, to find the reason of the end in them.
const LAST_LINES: usize = 20;
/// The maximum time that a process may continue after it has closed its standard output.
const SILENCE_LIMIT: Duration = Duration::from_secs(2);
/// The maximum time for the last lines of the standard error after the process has ended.
const LINES_TIMEOUT: Duration = Duration::from_millis(200);

/// An output of a window.
#[derive(Debug)]
pub(crate) enum WindowOutput {
    /// A message of the window.
    Event(Event),
    /// A line for the log: from its standard error, or one that is not a message.
    Line(String),
    /// A sentence for the user: a message could not be sent to it.
    NotSent(String),
    /// It has ended. This is its last output.
    Gone(Gone),
}

/// The end of a window.
#[derive(Clone, Debug, Eq, PartialEq)]
pub(crate) struct Gone {
    /// True if its exit status is 0.
    pub(crate) clean: bool,
    /// The exit status or the signal, in words.
    pub(crate) status: String,
    /// Its own reason, from the last lines of its standard error.
    pub(crate) reason: Option<String>,
}

/// A window's process.
#[derive(Debug)]
pub(crate) struct Process {
    child: Mutex<Child>,
    mailbox: Mailbox,
    /// Notified when it is to close.
    closing: Notify,
    /// Notified when all messages have been sent.
    all_written: watch::Sender<bool>,
}

impl Process {
    /// Starts a window without sending it anything.
    ///
    /// # Errors
    /// If the system does not start the program or a thread.
    pub(crate) fn start(
        program: &WindowProgram,
    ) -> std::io::Result<(Arc<Self>, mpsc::Receiver<WindowOutput>)> {
        let mut command = std::process::Command::new(&program.program);
        command
            .args(&program.arguments)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped());
        platform::set_apart(&mut command);
        let mut child = command.spawn()?;
        let (input, output, error) = (child.stdin.take(), child.stdout.take(), child.stderr.take());
        let process = Arc::new(Self {
            child: Mutex::new(child),
            mailbox: Mailbox::new(),
            closing: Notify::new(),
            all_written: watch::Sender::new(false),
        });
        let (outputs, receiver) = mpsc::channel(MOST_WAITING);
        let started = process.clone().start_threads(input, output, error, outputs);
        if let Err(error) = started {
            process.kill();
            // Reaps the process, which would otherwise stay in the system's table.
            let _ = process.child().wait();
            return Err(error);
        }
        Ok((process, receiver))
    }

    /// Sends a message to the window, without waiting; returns the versions of the text that it has overtaken.
    pub(crate) fn send(&self, command: Command) -> Vec<i32> {
        self.mailbox.put(command)
    }

    /// Returns the approximate length in a message of the edits that the window has not read yet, in bytes.
    pub(crate) fn waiting_edits(&self) -> usize {
        self.mailbox.waiting_edits()
    }

    /// Sends the command to close.
    pub(crate) fn close(&self) {
        self.mailbox.put(Command::Close);
        self.closing.notify_one();
    }

    /// Waits until the window is to close.
    pub(crate) async fn closing(&self) {
        self.closing.notified().await;
    }

    /// Waits until all messages have been sent.
    pub(crate) async fn all_written(&self) {
        // The sender lives as long as this process does.
        let _ = self
            .all_written
            .subscribe()
            .wait_for(|written| *written)
            .await;
    }

    /// Returns true if all messages have been sent.
    pub(crate) fn is_all_written(&self) -> bool {
        *self.all_written.borrow()
    }

    /// Returns true if the process has ended, even if its end has not been reported yet.
    pub(crate) fn has_ended(&self) -> bool {
        !matches!(self.child().try_wait(), Ok(None))
    }

    /// Kills the process.
    pub(crate) fn kill(&self) {
        self.mailbox.close();
        // A process that has already ended cannot be killed, which is fine.
        let _ = self.child().kill();
    }

    fn child(&self) -> MutexGuard<'_, Child> {
        self.child.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn start_threads(
        self: Arc<Self>,
        input: Option<ChildStdin>,
        output: Option<ChildStdout>,
        error: Option<ChildStderr>,
        outputs: mpsc::Sender<WindowOutput>,
    ) -> std::io::Result<()> {
        let (Some(input), Some(output), Some(error)) = (input, output, error) else {
            return Err(std::io::Error::other("the window has no standard streams"));
        };
        let thread = |name: &str| std::thread::Builder::new().name(format!("window's {name}"));
        let last = Arc::new(Mutex::new(VecDeque::new()));
        let (recorded, all_recorded) = sync::channel::<()>();
        thread("logger").spawn({
            let (last, outputs) = (last.clone(), outputs.clone());
            move || {
                record(error, &last, &outputs);
                // The channel's end is the message.
                drop(recorded);
            }
        })?;
        thread("writer").spawn({
            let (process, outputs) = (self.clone(), outputs.clone());
            move || process.write_all(input, &outputs)
        })?;
        thread("reader").spawn(move || {
            listen(output, &outputs);
            let status = self.wait();
            self.mailbox.close();
            let _ = all_recorded.recv_timeout(LINES_TIMEOUT);
            let lines = last.lock().unwrap_or_else(PoisonError::into_inner);
            let gone = Gone {
                clean: status.is_some_and(|status| status.success()),
                status: status.map_or_else(|| "unknown".to_owned(), |status| status.to_string()),
                reason: reason(lines.iter()),
            };
            drop(lines);
            let _ = outputs.blocking_send(WindowOutput::Gone(gone));
        })?;
        Ok(())
    }

    /// Writes messages until the mailbox is closed, or the window does not read any more.
    fn write_all(&self, mut input: ChildStdin, outputs: &mpsc::Sender<WindowOutput>) {
        while let Some(command) = self.mailbox.take() {
            match line::write(&mut input, &command) {
                Ok(()) => {}
                Err(error @ WriteError::TooLong { .. }) => {
                    let message = format!("the text is not shown in the preview: {error}");
                    let _ = outputs.blocking_send(WindowOutput::NotSent(message));
                }
                Err(WriteError::Stream(_)) => {
                    // It has ended: the reader reports that.
                    self.mailbox.close();
                    break;
                }
            }
        }
        drop(input);
        self.all_written.send_replace(true);
    }

    /// Waits for the end of a process that has closed its standard output.
    fn wait(&self) -> Option<std::process::ExitStatus> {
        const STEP: Duration = Duration::from_millis(10);
        for _ in 0..SILENCE_LIMIT.as_millis() / STEP.as_millis() {
            // The lock is not held while this thread sleeps.
            let status = self.child().try_wait();
            match status {
                Ok(None) => std::thread::sleep(STEP),
                Ok(status) => return status,
                Err(_) => return None,
            }
        }
        let mut child = self.child();
        let _ = child.kill();
        child.wait().ok()
    }
}

fn listen(output: ChildStdout, outputs: &mpsc::Sender<WindowOutput>) {
    let mut reader = line::Reader::<_, Event>::new(BufReader::new(output));
    let mut lines = 0;
    loop {
        match reader.read() {
            Ok(Some(event)) => {
                if outputs.blocking_send(WindowOutput::Event(event)).is_err() {
                    return;
                }
            }
            Ok(None) | Err(ReadError::Stream(_)) => return,
            Err(error) => {
                lines += 1;
                if lines <= MOST_LINES {
                    let _ = outputs.try_send(WindowOutput::Line(error.to_string()));
                }
            }
        }
    }
}

fn record(
    error: ChildStderr,
    last: &Mutex<VecDeque<String>>,
    outputs: &mpsc::Sender<WindowOutput>,
) {
    let mut reader = BufReader::new(error);
    let mut count = 0;
    let mut bytes = Vec::new();
    loop {
        bytes.clear();
        // A longer line arrives in pieces.
        match (&mut reader)
            .take(LONGEST_LINE)
            .read_until(b'\n', &mut bytes)
        {
            Ok(1..) => {}
            Ok(0) | Err(_) => return,
        }
        let line = String::from_utf8_lossy(&bytes).trim_end().to_owned();
        if line.is_empty() {
            continue;
        }
        let mut last = last.lock().unwrap_or_else(PoisonError::into_inner);
        last.push_back(line.clone());
        if last.len() > LAST_LINES {
            last.pop_front();
        }
        drop(last);
        count += 1;
        if count <= MOST_LINES {
            let _ = outputs.try_send(WindowOutput::Line(line));
        }
    }
}

/// Returns the reason of the end among the last lines: a panic's message, or an error, or else the last line.
fn reason<'l>(lines: impl DoubleEndedIterator<Item = &'l String> + Clone) -> Option<String> {
    let error =
        |line: &&String| line.starts_with("error: ") || line.starts_with("internal error: ");
    let mut behind = lines
        .clone()
        .skip_while(|line| !line.contains("panicked at"));
    if let Some(place) = behind.next() {
        let message = behind.next().map_or("", |line| line);
        return Some(format!("{place} {message}").trim_end().to_owned());
    }
    if let Some(error) = lines.clone().rfind(error) {
        return Some(error.clone());
    }
    lines.last().cloned()
}

#[cfg(test)]
mod tests {
    use super::reason;

    #[test]
    fn the_reason_of_an_end_is_the_sentence_that_states_it() {
        let reason = |lines: &[&str]| {
            let lines: Vec<String> = lines.iter().map(|line| (*line).to_owned()).collect();
            reason(lines.iter())
        };
        assert_eq!(reason(&[]), None);
        assert_eq!(reason(&["a", "b"]).as_deref(), Some("b"));
        let found = reason(&[
            "MESA: warning",
            "error: there is no display",
            "  help: use render",
        ]);
        assert_eq!(found.as_deref(), Some("error: there is no display"));
        let found = reason(&[
            "thread 'main' panicked at a.rs:1:2:",
            "no such thing",
            "note: run with …",
        ]);
        let wanted = "thread 'main' panicked at a.rs:1:2: no such thing";
        assert_eq!(found.as_deref(), Some(wanted));
    }
}
