//! The thread that compiles: texts flow in, the latest wins; scenes and findings flow out.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::{Duration, Instant};

use scene::Scene;
use syntax::diagnostic::{Diagnostic, Severity};
use syntax::line_index::LineIndex;
use syntax::span::Span;

use crate::mail::{Letter, Mail};
use crate::mend::{Declared, Mender, Read};

/// What a text compiles to.
#[derive(Clone, Debug)]
pub(crate) struct Compiled {
    /// The text's version.
    pub(crate) version: i32,
    /// The text.
    pub(crate) text: Arc<str>,
    /// Whether it has no errors.
    pub(crate) ok: bool,
    /// What was found, sorted by place.
    pub(crate) findings: Vec<Finding>,
    /// The scene. Of a text with errors, what can be shown of it: declarations without errors as they are now, the
    /// others as they last were. None where nothing can.
    pub(crate) scene: Option<Arc<Scene>>,
    /// The objects of the scene that are shown as they last were, and those that read something that is.
    pub(crate) stale: Vec<String>,
    /// Something of the text is not shown at all.
    pub(crate) lacks: bool,
    /// What the text declares, in its order.
    pub(crate) declared: Vec<Declared>,
    /// When the text arrived.
    pub(crate) arrived: Instant,
    /// What compiling took.
    pub(crate) took: Duration,
}

impl Compiled {
    /// Of a text that has been read: one that has just arrived, and took no time.
    pub(crate) fn of(version: i32, text: Arc<str>, read: Read) -> Self {
        let findings = findings(&text, &read.diagnostics);
        Self {
            version,
            ok: findings.iter().all(|it| it.severity != Severity::Error),
            findings,
            scene: read.scene.map(Arc::new),
            stale: read.stale,
            lacks: read.lacks,
            declared: read.declared,
            text,
            arrived: Instant::now(),
            took: Duration::ZERO,
        }
    }
}

/// Something found in a text.
#[derive(Clone, Debug, Eq, PartialEq)]
pub struct Finding {
    /// How grave it is.
    pub severity: Severity,
    /// Where.
    pub span: Span,
    /// Its line, from 1.
    pub line: u32,
    /// Its column in characters, from 1.
    pub column: u32,
    /// One sentence.
    pub message: String,
    /// What to do about it.
    pub hint: Option<String>,
}

/// Hands texts to the thread, which ends with the last of the hands; cheap to clone.
#[derive(Clone, Debug)]
pub(crate) struct Compiler {
    desk: Arc<Shared>,
}

/// What the hands share. The thread has the desk alone, so that it does not keep itself alive.
#[derive(Debug)]
struct Shared(Arc<(Mutex<Desk>, Condvar)>);

#[derive(Debug, Default)]
struct Desk {
    next: Option<Order>,
    closed: bool,
}

#[derive(Debug)]
struct Order {
    version: i32,
    text: Arc<str>,
    arrived: Instant,
}

impl Compiler {
    /// Starts the thread.
    pub(crate) fn start(mail: Mail) -> Self {
        Self::reading_by(mail, Mender::read)
    }

    /// The same, with another way to read.
    fn reading_by(mail: Mail, read: impl Fn(&mut Mender, &str) -> Read + Send + 'static) -> Self {
        let desk = Arc::new((Mutex::new(Desk::default()), Condvar::new()));
        let own = Arc::clone(&desk);
        std::thread::spawn(move || work(&own, &mail, read));
        Self {
            desk: Arc::new(Shared(desk)),
        }
    }

    /// A text to be compiled, in the place of any that has not been begun.
    pub(crate) fn compile(&self, version: i32, text: Arc<str>) {
        let (desk, bell) = &*self.desk.0;
        let mut desk = desk.lock().unwrap_or_else(PoisonError::into_inner);
        // What is overtaken has waited since it arrived, and so has what takes its place.
        let arrived = desk.next.take().map_or_else(Instant::now, |it| it.arrived);
        desk.next = Some(Order {
            version,
            text,
            arrived,
        });
        bell.notify_one();
    }
}

impl Drop for Shared {
    fn drop(&mut self) {
        let (desk, bell) = &*self.0;
        desk.lock().unwrap_or_else(PoisonError::into_inner).closed = true;
        bell.notify_one();
    }
}

fn work(desk: &(Mutex<Desk>, Condvar), mail: &Mail, read: impl Fn(&mut Mender, &str) -> Read) {
    let (desk, bell) = desk;
    let mut mender = Mender::default();
    loop {
        let order = {
            let mut desk = desk.lock().unwrap_or_else(PoisonError::into_inner);
            loop {
                if desk.closed {
                    return;
                }
                if let Some(order) = desk.next.take() {
                    break order;
                }
                desk = bell.wait(desk).unwrap_or_else(PoisonError::into_inner);
            }
        };
        let start = Instant::now();
        // A fault of ours must not take the thread with it: it becomes a sentence, and nothing is kept that it has touched.
        let read = catch_unwind(AssertUnwindSafe(|| read(&mut mender, &order.text)));
        let (read, fault) = match read {
            Ok(read) => (read, None),
            Err(_) => {
                mender = Mender::default();
                (Read::default(), Some(fault()))
            }
        };
        let mut compiled = Compiled::of(order.version, order.text, read);
        if let Some(fault) = fault {
            compiled.ok = false;
            compiled.findings.push(fault);
        }
        compiled.arrived = order.arrived;
        compiled.took = start.elapsed();
        if !mail.send(Letter::Compiled(compiled)) {
            return;
        }
    }
}

/// What is told of a text over which the compiler fell.
fn fault() -> Finding {
    Finding {
        severity: Severity::Error,
        span: Span::default(),
        line: 1,
        column: 1,
        message: "internal error: the program could not be read".to_owned(),
        hint: Some("please report it, with the program".to_owned()),
    }
}

/// Diagnostics with lines and columns.
fn findings(text: &str, diagnostics: &[Diagnostic]) -> Vec<Finding> {
    if diagnostics.is_empty() {
        return Vec::new();
    }
    let index = LineIndex::new(text);
    let finding = |diagnostic: &Diagnostic| {
        let place = index.position(diagnostic.span.start);
        Finding {
            severity: diagnostic.severity,
            span: diagnostic.span,
            line: place.line,
            column: place.column,
            message: diagnostic.message.clone(),
            hint: diagnostic.hint.clone(),
        }
    };
    diagnostics.iter().map(finding).collect()
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::{Receiver, channel};

    use super::{Compiled, Compiler};
    use crate::mail::{Letter, Mail};
    use crate::mend::Mender;

    fn next(letters: &Receiver<Letter>) -> Compiled {
        match letters.recv().expect("the thread lives") {
            Letter::Compiled(compiled) => compiled,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn a_fault_of_the_compiler_is_a_finding_and_the_next_text_is_read() {
        let (mail, letters) = Mail::new(egui::Context::default());
        let compiler = Compiler::reading_by(mail, |mender, text| {
            assert!(!text.contains("fault"), "a fault");
            mender.read(text)
        });
        compiler.compile(1, "point p = (1, 2, 3);".into());
        assert!(next(&letters).ok);
        compiler.compile(2, "point fault = (1, 2, 3);".into());
        let fault = next(&letters);
        assert_eq!((fault.version, fault.ok), (2, false));
        assert!(fault.scene.is_none() && fault.stale.is_empty());
        let [finding] = &fault.findings[..] else {
            panic!("{:?}", fault.findings);
        };
        let wanted = "internal error: the program could not be read";
        assert_eq!((finding.line, finding.message.as_str()), (1, wanted));
        compiler.compile(3, "point q = (1, 2, 3);".into());
        let good = next(&letters);
        assert!(good.ok && good.findings.is_empty());
        assert_eq!(good.scene.expect("a scene").objects[0].name, "q");
    }

    #[test]
    fn of_texts_that_come_while_one_is_read_the_last_is_the_only_one_that_is() {
        let (mail, letters) = Mail::new(egui::Context::default());
        let (begun, begins) = channel();
        let (go_on, may_go_on) = channel();
        let compiler = Compiler::reading_by(mail, move |mender: &mut Mender, text| {
            begun.send(()).expect("the test listens");
            may_go_on.recv().expect("the test lives");
            mender.read(text)
        });
        compiler.compile(1, "".into());
        begins.recv().expect("it begins");
        for version in 2..=200 {
            compiler.compile(version, "".into());
        }
        for version in [1, 200] {
            go_on.send(()).expect("it waits");
            assert_eq!(next(&letters).version, version);
        }
        drop(compiler);
        assert!(letters.recv().is_err(), "no other is read");
    }
}
