//! The functions that JavaScript calls: messages as JSON, bytes as they are, times in milliseconds.
#![allow(
    unsafe_code,
    reason = "the macros of wasm-bindgen write the functions that JavaScript calls"
)]

use serde_json::json;
use wasm_bindgen::prelude::wasm_bindgen;

use crate::message::read_message;
use crate::source::Utf16Range;
use crate::{Saved, StepOutcome};

#[wasm_bindgen]
unsafe extern "C" {
    #[wasm_bindgen(js_namespace = console, js_name = error)]
    fn log_error(message: &str);
}

/// The core, for JavaScript.
#[wasm_bindgen]
#[derive(Debug, Default)]
pub struct Core(crate::Core);

/// A file: its bytes, and `{ type, notes }` as JSON.
#[wasm_bindgen]
#[derive(Debug)]
pub struct SavedFile(Saved);

/// The outcome of a step: `{ next, picture }` as JSON, and the picture's pixels.
#[wasm_bindgen]
#[derive(Debug)]
pub struct StepResult {
    text: String,
    pixels: Vec<u8>,
}

#[wasm_bindgen]
impl Core {
    /// Returns a core with an empty program. A panic is reported on the console before it ends the Worker.
    #[wasm_bindgen(constructor)]
    pub fn new() -> Self {
        std::panic::set_hook(Box::new(|panic| log_error(&panic.to_string())));
        Self::default()
    }

    /// Answers a call by its name; its params and the answer are JSON.
    ///
    /// # Errors
    /// A sentence: the params cannot be read, or the call fails.
    pub fn call(&mut self, name: &str, params: &str, now: f64) -> Result<String, String> {
        let answer = self.0.call(read_message(name, params)?, 1e-3 * now)?;
        Ok(answer.to_string())
    }

    /// Handles a notice by its name; its params are JSON.
    ///
    /// # Errors
    /// A sentence: the params cannot be read.
    pub fn notice(&mut self, name: &str, params: &str, now: f64) -> Result<(), String> {
        self.0.notice(read_message(name, params)?, 1e-3 * now);
        Ok(())
    }

    /// Returns the events since the last call, a JSON list.
    pub fn events(&mut self) -> String {
        json!(self.0.take_events()).to_string()
    }

    /// Does the next piece of work.
    pub fn step(&mut self, now: f64) -> StepResult {
        let StepOutcome { drawn, next } = self.0.step(1e-3 * now);
        let (info, pixels) = drawn.map(|drawn| (drawn.info, drawn.pixels)).unzip();
        StepResult {
            text: json!({ "next": next.map(|next| 1e3 * next), "picture": info }).to_string(),
            pixels: pixels.unwrap_or_default(),
        }
    }

    /// Returns the tokens of a range, four numbers each.
    pub fn tokens(&self, from: u32, to: u32) -> Vec<u32> {
        self.0.editing().tokens(Utf16Range { from, to })
    }

    /// Adds an image. Returns its size as JSON.
    ///
    /// # Errors
    /// A sentence: the bytes are no image that can be read.
    pub fn texture(&mut self, name: &str, bytes: &[u8]) -> Result<String, String> {
        Ok(self.0.texture(name, bytes)?.to_string())
    }

    /// Returns the picture of a view at rest, as a PNG file.
    ///
    /// # Errors
    /// A sentence: there is no such view, or it cannot be drawn.
    #[wasm_bindgen(js_name = savePicture)]
    pub fn save_picture(
        &mut self,
        view: &str,
        width: u32,
        height: u32,
    ) -> Result<SavedFile, String> {
        self.0.save_picture(view, [width, height]).map(SavedFile)
    }

    /// Returns the objects that are not hidden, as a file of a format.
    ///
    /// # Errors
    /// A sentence: there is no such format, or nothing that it can hold.
    #[wasm_bindgen(js_name = saveMesh)]
    pub fn save_mesh(&mut self, format: &str) -> Result<SavedFile, String> {
        self.0.save_mesh(format).map(SavedFile)
    }
}

#[wasm_bindgen]
impl SavedFile {
    /// Returns the bytes.
    pub fn bytes(&self) -> Vec<u8> {
        self.0.bytes.clone()
    }

    /// Returns the type and the notes.
    pub fn text(&self) -> String {
        json!({ "type": self.0.media_type, "notes": self.0.notes }).to_string()
    }
}

#[wasm_bindgen]
impl StepResult {
    /// Returns the description.
    pub fn text(&self) -> String {
        self.text.clone()
    }

    /// Returns the pixels, and removes them.
    pub fn pixels(&mut self) -> Vec<u8> {
        std::mem::take(&mut self.pixels)
    }
}
