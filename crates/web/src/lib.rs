//! The core of the page: a program, its pictures and its settings, in a Worker of a browser.
//!
//! ```text
//! page ──Call, Notice──▶ web/src/worker.ts ──▶ bindings ──▶ Core ──▶ editing: ide on UTF-16 offsets (source)
//!                                                            │ ├──▶ the state: the choices, the cameras
//!                                                            │ └──▶ pictures: which to draw next, and its detail
//! page ◀──Answer, CoreEvent, pixels── worker.ts ◀── bindings ◀┘
//! ```
//!
//! [`Core`] is plain Rust, and is tested natively; only `bindings` and `threads` depend on JavaScript, and are absent
//! from other builds. This crate has no files or clock of its own: the Worker passes in texts, bytes and the time, and
//! requests pictures. If a browser lets Workers share memory, `threads` uses further Workers as the threads that draw.

#[cfg(target_arch = "wasm32")]
mod bindings;
mod core;
mod editing;
mod images;
mod message;
mod source;
#[cfg(all(target_arch = "wasm32", target_feature = "atomics"))]
mod threads;

pub use core::{Core, DrawnPicture, Saved, StepOutcome};
pub use editing::Editing;
pub use message::{
    AskedFigure, Call, CameraMove, ComponentInfo, CoreEvent, Grip, ImageInfo, KeyInfo, Notice,
    ObjectInfo, PageFinding, Pane, ParamInfo, Pick, PictureInfo, QuantityRow, Related, SceneInfo,
    SettingInfo, ViewInfo, read_message,
};
pub use source::{EditsDoNotFit, Utf16Edit, Utf16Range, Utf16Text};
