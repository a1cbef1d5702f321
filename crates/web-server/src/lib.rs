//! The language server for JavaScript: an editor's messages as JSON, in a Worker of a browser.
//!
//! It is a separate crate so that the page, which has its own editor, does not load it.
#![cfg(target_arch = "wasm32")]
#![allow(
    unsafe_code,
    reason = "the macros of wasm-bindgen write the functions that JavaScript calls"
)]

use server::ServerByTurns;
use wasm_bindgen::prelude::wasm_bindgen;

#[wasm_bindgen]
unsafe extern "C" {
    #[wasm_bindgen(js_namespace = console, js_name = error)]
    fn log_error(message: &str);
}

/// The server of one editor.
#[wasm_bindgen]
#[derive(Debug)]
pub struct LanguageServer(ServerByTurns);

#[wasm_bindgen]
#[allow(clippy::new_without_default, reason = "only JavaScript makes a server")]
impl LanguageServer {
    /// Returns a server. A panic is reported on the console before it ends the Worker.
    #[wasm_bindgen(constructor)]
    pub fn new() -> Self {
        std::panic::set_hook(Box::new(|panic| log_error(&panic.to_string())));
        Self(ServerByTurns::new(ide::Languages::standard()))
    }

    /// Receives a message of the editor.
    #[wasm_bindgen(js_name = hear)]
    pub fn receive(&self, message: &str) {
        self.0.receive(message);
    }

    /// Does the work that has waited longest. Returns false if none waits.
    pub fn turn(&self) -> bool {
        self.0.turn()
    }

    /// Returns the messages to the editor since the last call.
    #[wasm_bindgen(js_name = takeSaid)]
    pub fn take_outgoing(&self) -> Vec<String> {
        self.0.take_outgoing()
    }
}
