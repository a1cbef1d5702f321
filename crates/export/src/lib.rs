//! Files for other programs.
//!
//! ```text
//! Scene + ParamValues + Request ──mesh.rs──▶ OBJ, PLY, STL, glTF ─┐
//! pictures, one after the other ──animation.rs──▶ GIF, APNG ───┴─▶ io::Write ──whole_file.rs──▶ a file that is whole, or none
//! ```

pub mod animation;
pub mod mesh;
pub mod whole_file;
