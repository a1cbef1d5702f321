//! Threads in a browser: Workers that share the core's memory, as the threads of rayon's pool.
//!
//! ```text
//! web/src/threads.ts ──run_thread──▶ a Worker waits for a thread to run ─┐
//!                    ──begin_threads──▶ the pool provides its threads ───┘
//! ```
//!
//! The Worker that calls `begin_threads` is itself one of the pool's threads. The others must already be waiting: a
//! Worker starts only while its creator is idle.
#![allow(
    unsafe_code,
    unreachable_pub,
    reason = "the macros of wasm-bindgen write the functions that JavaScript calls, which must be public"
)]

use std::sync::{Condvar, Mutex, PoisonError};

use rayon::ThreadBuilder;
use wasm_bindgen::prelude::wasm_bindgen;

/// The threads of the pool that no Worker runs yet.
static WAITING: Mutex<Vec<ThreadBuilder>> = Mutex::new(Vec::new());
/// Signals that a thread has been added.
static ADDED: Condvar = Condvar::new();

/// Creates the pool with `count` threads: the calling Worker, and others that have called [`run_thread`].
///
/// # Errors
/// A sentence, if there is already a pool.
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

/// Becomes a thread of the pool, as soon as one is available. It does not return.
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
