//! The window without a display: keys, pointer and files flow in through egui's own test harness, and what a user or
//! a screen reader would find is compared with what must be there. No driver is needed but for the pictures of
//! `snapshots.rs`.

mod access;
mod attached;
mod cameras;
mod editing;
mod faults;
mod figures;
mod hand;
mod keyboard;
mod lesson;
mod live;
mod measuring;
mod navigation;
mod pointer;
mod program;
mod programs;
mod recording;
mod remembered;
mod scripts;
mod settings;
mod snapshots;
mod solids;
mod traced;
mod trail;
