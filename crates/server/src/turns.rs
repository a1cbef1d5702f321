//! The server where there are no threads: in a Worker of a browser, which hands it each message and gives it turns.
//!
//! Messages come first: work waits for a turn, so that an edit which has come in the meantime is heeded before it begins.

use std::cell::RefCell;
use std::collections::VecDeque;
use std::rc::Rc;
use std::sync::{Arc, Mutex};

use futures::channel::{mpsc, oneshot};
use futures::executor::{LocalPool, LocalSpawner};
use futures::task::LocalSpawnExt;
use futures::{FutureExt, future, sink};
use ide::Languages;

use crate::connection::Connection;
use crate::frames::{self, Frame};
use crate::session::Session;
use crate::tasks::Fault;

type Work = Box<dyn FnOnce()>;

thread_local! {
    static POOL: RefCell<LocalPool> = RefCell::default();
    static SPAWNER: LocalSpawner = POOL.with_borrow(LocalPool::spawner);
    static WORK: RefCell<VecDeque<Work>> = RefCell::default();
}

/// Starts a task.
pub(crate) fn spawn(task: impl Future<Output = ()> + 'static) {
    // It fails only when the thread ends.
    let _ = SPAWNER.with(|spawner| spawner.spawn_local(task));
}

/// Does work in a turn of its own. Work that has not begun when nobody waits for it any more is never begun.
pub(crate) async fn work<T: 'static>(work: impl FnOnce() -> T + 'static) -> Result<T, Fault> {
    let (done, result) = oneshot::channel();
    let work = Box::new(move || {
        if !done.is_canceled() {
            let _ = done.send(work());
        }
    });
    WORK.with_borrow_mut(|waiting| waiting.push_back(work));
    result.await.map_err(|_| Fault)
}

/// A server for one editor, whose messages are JSON texts without a header.
#[derive(Debug)]
pub struct ServerByTurns {
    heard: mpsc::UnboundedSender<Frame>,
    said: Rc<RefCell<Vec<String>>>,
}

impl ServerByTurns {
    /// A server for documents in these languages. It has no windows.
    pub fn new(languages: Languages) -> Self {
        let (heard, frames) = mpsc::unbounded();
        let said = Rc::<RefCell<Vec<String>>>::default();
        let output = sink::unfold(said.clone(), |said, body: Vec<u8>| {
            let text = String::from_utf8_lossy(&body).into_owned();
            said.borrow_mut().push(text);
            future::ready(Ok::<_, Fault>(said))
        });
        let session = Arc::new(Mutex::new(Session::new(languages, None)));
        let Connection { serving, writing } = crate::start(frames, output, Arc::default(), session);
        spawn(future::join(serving, writing).map(|_| ()));
        Self { heard, said }
    }

    /// Takes a message of the editor.
    pub fn hear(&self, message: &str) {
        let frame = frames::message(message.as_bytes()).unwrap_or(Frame::Invalid);
        let _ = self.heard.unbounded_send(frame);
        run();
    }

    /// Does the work that has waited longest; false if none waits.
    pub fn turn(&self) -> bool {
        let Some(work) = WORK.with_borrow_mut(VecDeque::pop_front) else {
            return false;
        };
        work();
        run();
        true
    }

    /// The messages to the editor since the last time.
    pub fn take_said(&self) -> Vec<String> {
        std::mem::take(&mut self.said.borrow_mut())
    }
}

/// Lets the tasks go on until all of them wait.
fn run() {
    POOL.with_borrow_mut(LocalPool::run_until_stalled);
}
