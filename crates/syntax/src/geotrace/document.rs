//! A Geotrace program that is edited.

pub use crate::document::{
    Document, Event, Events, Parameters, Piece, ReadDeclaration, Snapshot, Tokens,
};
