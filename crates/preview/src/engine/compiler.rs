//! The thread that compiles. In: texts and chosen values of params, of which the latest win. Out: scenes and findings.

use std::io;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::time::Instant;

use ide::Language;
use protocol::changes::Changes;
use scene::Scene;
use session::Compiled;
use session::choices::{ChosenParams, chosen_values};
use session::reader::{Read, Reader, SourceText, unreadable};

use crate::channel::{EventSender, start_thread};
use crate::queue::LatestQueue;

/// A result of the thread.
#[derive(Debug)]
pub(crate) enum CompilerEvent {
    /// A text has been compiled.
    Compiled(CompiledText),
    /// The scene of the text of a version has been made for other values of its params.
    Rerun { version: i32, scene: Arc<Scene> },
}

/// A text that the thread has compiled.
#[derive(Debug)]
pub(crate) struct CompiledText {
    pub(crate) compiled: Compiled,
    /// The time at which the text arrived.
    pub(crate) arrived: Instant,
}

/// Sends orders to the thread, which ends with the last clone; cheap to clone.
#[derive(Clone, Debug)]
pub(crate) struct Compiler {
    queue: Arc<Orders>,
}

/// The queue that the clones share. The thread holds the inner queue, so that it does not keep itself alive.
#[derive(Debug)]
struct Orders(LatestQueue<OrderKey, Order>);

/// The kind of an order: the latest one of each kind wins.
#[derive(Clone, Copy, Debug, Eq, Ord, PartialEq, PartialOrd)]
enum OrderKey {
    Text,
    Params,
}

/// An order that waits for the thread.
#[derive(Debug)]
enum Order {
    Text(WaitingText),
    Params(ChosenParams),
}

/// A text that waits to be compiled.
#[derive(Debug)]
struct WaitingText {
    language: Arc<dyn Language>,
    version: i32,
    text: Arc<str>,
    /// The changes that lead from the last compiled text to this one; `None` if they are not known.
    changes: Option<Changes>,
    arrived: Instant,
}

impl Compiler {
    /// Starts the thread.
    ///
    /// # Errors
    /// The system's error.
    pub(crate) fn start(events: EventSender<CompilerEvent>) -> io::Result<Self> {
        Self::reading_by(events, Reader::read)
    }

    /// Starts the thread with another function for reading texts.
    fn reading_by(
        events: EventSender<CompilerEvent>,
        read: impl Fn(&mut Reader, &SourceText<'_>) -> Read + Send + 'static,
    ) -> io::Result<Self> {
        let queue = LatestQueue::default();
        let own = queue.clone();
        start_thread("compile", move || work(&own, &events, read))?;
        Ok(Self {
            queue: Arc::new(Orders(queue)),
        })
    }

    /// Queues a text for compilation, replacing one that has not been started. `changes` lead to it from the text that
    /// was queued before it.
    pub(crate) fn compile(
        &self,
        language: Arc<dyn Language>,
        version: i32,
        text: Arc<str>,
        changes: Option<Changes>,
    ) {
        self.queue.0.update(0, OrderKey::Text, |before| {
            let (arrived, changes) = match before {
                // A superseded text has waited since it arrived, and so has the text that replaces it.
                Some(Order::Text(before)) => {
                    let composed = before.changes.zip(changes);
                    (
                        before.arrived,
                        composed.map(|(first, then)| first.then(&then)),
                    )
                }
                _ => (Instant::now(), changes),
            };
            Order::Text(WaitingText {
                language,
                version,
                // Many small edits are no cheaper than the difference of two texts.
                changes: changes.filter(|changes| changes.weight() <= text.len()),
                text,
                arrived,
            })
        });
    }

    /// Chooses values of params, for which the last compiled scene and later ones are made if they change more than
    /// numbers. They replace those that were chosen before.
    pub(crate) fn choose(&self, params: ChosenParams) {
        let order = Order::Params(params);
        self.queue.0.push(1, OrderKey::Params, order);
    }
}

impl Drop for Orders {
    fn drop(&mut self) {
        self.0.abandon();
    }
}

fn work(
    queue: &LatestQueue<OrderKey, Order>,
    events: &EventSender<CompilerEvent>,
    read: impl Fn(&mut Reader, &SourceText<'_>) -> Read,
) {
    let mut reader = Reader::default();
    let mut chosen = ChosenParams::default();
    // The last scene, with the version of its text.
    let mut last = None;
    while let Some((_, order)) = queue.take() {
        let event = match order {
            Order::Text(text) => {
                let start = Instant::now();
                let arrived = text.arrived;
                let mut compiled = compiled(&mut reader, text, &read);
                // Values that were chosen meanwhile count.
                if let Some(Order::Params(params)) = queue.remove(&OrderKey::Params) {
                    chosen = params;
                }
                if let Some(scene) = &mut compiled.scene {
                    *scene = scene.at(&chosen_values(scene, &chosen));
                    last = Some((compiled.program.version, Arc::clone(scene)));
                }
                compiled.program.took = start.elapsed();
                CompilerEvent::Compiled(CompiledText { compiled, arrived })
            }
            Order::Params(params) => {
                chosen = params;
                let Some((version, scene)) = &mut last else {
                    continue;
                };
                let Some(made) = scene.made_anew(&chosen_values(scene, &chosen)) else {
                    continue;
                };
                scene.clone_from(&made);
                CompilerEvent::Rerun {
                    version: *version,
                    scene: made,
                }
            }
        };
        if !events.send(event) {
            return;
        }
    }
}

/// Compiles a text.
fn compiled(
    reader: &mut Reader,
    order: WaitingText,
    read: impl Fn(&mut Reader, &SourceText<'_>) -> Read,
) -> Compiled {
    // A panic must not end the thread: it becomes a sentence, and the reader's state is dropped. The next text is
    // queued whole beside its changes, and is opened afresh.
    let source = SourceText {
        language: &*order.language,
        text: &order.text,
        changes: order.changes.as_ref(),
    };
    match catch_unwind(AssertUnwindSafe(|| read(reader, &source))) {
        Ok(read) => read.compiled(order.version, order.text),
        Err(_) => {
            *reader = Reader::default();
            unreadable(order.version, order.text)
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::{Receiver, channel};
    use std::sync::{Arc, Mutex};

    use ide::Languages;
    use protocol::changes::Changes;
    use scene::{ProgramScene, Rerun, Scene};
    use session::Compiled;
    use session::reader::{Read, Reader};

    use super::{Compiler, CompilerEvent};
    use crate::channel::EventSender;

    fn next(events: &Receiver<CompilerEvent>) -> Compiled {
        match events.recv().expect("the thread lives") {
            CompilerEvent::Compiled(text) => text.compiled,
            CompilerEvent::Rerun { .. } => panic!("no text"),
        }
    }

    fn compile(compiler: &Compiler, version: i32, text: &str) {
        let languages = Languages::standard();
        let language = Arc::clone(languages.default_language());
        compiler.compile(language, version, text.into(), None);
    }

    #[test]
    fn a_fault_of_the_compiler_is_a_finding_and_the_next_text_is_read() {
        let (sender, events) = EventSender::new(egui::Context::default());
        let compiler = Compiler::reading_by(sender, |reader, source| {
            assert!(!source.text.contains("fault"), "a fault");
            reader.read(source)
        })
        .expect("a thread");
        compile(&compiler, 1, "point p = (1, 2, 3);");
        assert!(next(&events).program.ok);
        compile(&compiler, 2, "point fault = (1, 2, 3);");
        let fault = next(&events);
        assert_eq!((fault.program.version, fault.program.ok), (2, false));
        assert!(fault.scene.is_none() && fault.stale.is_empty());
        let [finding] = &fault.findings[..] else {
            panic!("{:?}", fault.findings);
        };
        let wanted = "internal error: the program could not be read";
        assert_eq!((finding.line, finding.message.as_str()), (1, wanted));
        compile(&compiler, 3, "point q = (1, 2, 3);");
        let good = next(&events);
        assert!(good.program.ok && good.findings.is_empty());
        assert_eq!(good.scene.expect("a scene").objects[0].name, "q");
    }

    #[test]
    fn of_texts_that_come_while_one_is_read_the_last_is_the_only_one_that_is() {
        let (sender, events) = EventSender::new(egui::Context::default());
        let (begun, begins) = channel();
        let (go_on, may_go_on) = channel();
        let compiler = Compiler::reading_by(sender, move |reader: &mut Reader, source| {
            begun.send(()).expect("the test listens");
            may_go_on.recv().expect("the test lives");
            reader.read(source)
        })
        .expect("a thread");
        compile(&compiler, 1, "");
        begins.recv().expect("it begins");
        for version in 2..=200 {
            compile(&compiler, version, "");
        }
        for version in [1, 200] {
            go_on.send(()).expect("it waits");
            assert_eq!(next(&events).program.version, version);
        }
        drop(compiler);
        assert!(events.recv().is_err(), "no other is read");
    }

    #[test]
    fn edits_that_come_while_a_text_is_read_are_composed() {
        let (sender, events) = EventSender::new(egui::Context::default());
        let (begun, begins) = channel();
        let (go_on, may_go_on) = channel();
        let compiler = Compiler::reading_by(sender, move |reader: &mut Reader, source| {
            begun
                .send(source.changes.cloned())
                .expect("the test listens");
            may_go_on.recv().expect("the test lives");
            reader.read(source)
        })
        .expect("a thread");
        let languages = Languages::standard();
        let edit = |version, text: &str, changes| {
            let language = Arc::clone(languages.default_language());
            compiler.compile(language, version, text.into(), changes);
        };
        let texts = [
            "point first = (1, 2, 3);",
            "point first = (1, 2, 3); point q = (0, 0, 0);",
            "point p = (1, 2, 3); point q = (0, 0, 0);",
        ]
        // Changes that are longer than the text give way to the text.
        .map(|text| text.to_owned() + &"\n# more".repeat(40));
        edit(1, &texts[0], None);
        assert_eq!(begins.recv().expect("it begins"), None);
        for version in [1, 2] {
            let changes = Changes::between(&texts[version - 1], &texts[version]);
            edit(version as i32 + 1, &texts[version], Some(changes));
        }
        go_on.send(()).expect("it waits");
        assert_eq!(next(&events).program.version, 1);
        let changes = begins.recv().expect("it begins").expect("changes");
        assert_eq!(changes.apply(&texts[0]).as_ref(), Some(&texts[2]));
        go_on.send(()).expect("it waits");
        let last = next(&events);
        let scene = last.scene.expect("a scene");
        let names: Vec<&str> = scene.objects.iter().map(|it| it.name.as_str()).collect();
        assert_eq!((last.program.version, names), (3, vec!["p", "q"]));
    }

    #[test]
    fn of_values_that_are_chosen_while_a_script_runs_only_the_last_run_it_again() {
        let (sender, events) = EventSender::new(egui::Context::default());
        let (begun, begins) = channel();
        let (go_on, may_go_on) = channel();
        let may_go_on = Mutex::new(may_go_on);
        let declared = scene::geotrace::compile("param t = 0 : [0, 100];").scene;
        let declared = declared.expect("no errors");
        let mut scene = declared.clone();
        scene.rerun = Some(Rerun::new(vec![0.0], move |values| {
            begun.send(values[0]).expect("the test listens");
            let may_go_on = may_go_on.lock().expect("one run at a time");
            may_go_on.recv().expect("the test lives");
            declared.clone()
        }));
        let scene = Arc::new(scene);
        let compiler = Compiler::reading_by(sender, move |_, _| Read {
            program: ProgramScene {
                scene: Some(scene.clone()),
                ..ProgramScene::default()
            },
            ..Read::default()
        })
        .expect("a thread");
        let choose = |value| compiler.choose([("t".to_owned(), vec![Some(value)])].into());
        let made_for = |scene: Arc<Scene>| scene.made_for().expect("a script").uniforms().to_vec();
        let next_rerun = || match events.recv().expect("the thread lives") {
            CompilerEvent::Rerun { version, scene } => (version, made_for(scene)),
            CompilerEvent::Compiled(_) => panic!("a text"),
        };
        compile(&compiler, 1, "");
        assert_eq!(made_for(next(&events).scene.expect("a scene")), [0.0]);
        choose(1.0);
        assert_eq!(begins.recv(), Ok(1.0));
        (2..100).for_each(|value| choose(f64::from(value)));
        for value in [1.0, 99.0] {
            go_on.send(()).expect("it waits");
            assert_eq!(next_rerun(), (1, vec![value]));
        }
        assert_eq!(begins.try_recv(), Ok(99.0), "and no other");
        // A text is not shown for other values first.
        compile(&compiler, 2, "");
        go_on.send(()).expect("it waits");
        assert_eq!(made_for(next(&events).scene.expect("a scene")), [99.0]);
    }
}
