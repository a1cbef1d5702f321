//! From declarations to a [`Scene`]: what is drawn, what it depends on, and every mistake on the way.
//!
//! A scene is data: expressions in one graph, and handles into it. It knows no view and no GPU.

pub mod scene;
pub mod values;
