//! Threads in a browser: Workers that share the core's memory, as the threads of rayon's pool.
//!
//! ```text
//! web/src/threads.ts ──run_thread──▶ a Worker waits for a thread to be ─┐
//!                    ──begin_threads──▶ the pool hands out its threads ─┘
//! ```
//!
//! The Worker that calls `begin_threads` is one of the pool's threads itself. The others must be waiting by then: a Worker
//! starts only while the one that has made it does nothing.
#![allow(
    unsafe_code,
    unreachable_pub,
    reason = "the macros of wasm-bindgen write the functions that JavaScript calls, which must be public"
)]

use std::sync::{Condvar, Mutex, PoisonError};

use rayon::ThreadBuilder;
use wasm_bindgen::prelude::wasm_bindgen;

/// The threads of the pool that no Worker has become yet.
static WAITING: Mutex<Vec<ThreadBuilder>> = Mutex::new(Vec::new());
/// Tells that there is one.
static ADDED: Condvar = Condvar::new();

/// Makes the pool, of so many threads: the calling Worker, and others that have called [`run_thread`].
///
/// # Errors
/// A sentence, if there is a pool already.
#[wasm_bindgen(js_name = beginThreads)]
pub fn begin_threads(count: usize) -> Result<(), String> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(count)
        .use_current_thread()
        .spawn_handler(|thread| {
            let mut waiting = WAITING.lock().unwrap_or_else(PoisonError::into_inner);
            waiting.push(thread);
            ADDED.notify_one();
            Ok(())
        })
        .build_global()
        .map_err(|error| error.to_string())
}

/// Becomes a thread of the pool, as soon as there is one to be. It does not return.
#[wasm_bindgen(js_name = runThread)]
pub fn run_thread() {
    let mut waiting = WAITING.lock().unwrap_or_else(PoisonError::into_inner);
    let thread = loop {
        if let Some(thread) = waiting.pop() {
            break thread;
        }
        waiting = ADDED.wait(waiting).unwrap_or_else(PoisonError::into_inner);
    };
    drop(waiting);
    thread.run();
}
