//! Files for other programs.
//!
//! ```text
//! Scene + ParamValues + Request ──mesh.rs──▶ OBJ, PLY, STL, glTF ─┐
//! PictureRequest ──command_line.rs──▶ the command that draws it again
//! pictures, one after the other ──animation.rs──▶ GIF, APNG ───┴─▶ io::Write ──whole_file.rs──▶ a file that is whole, or none
//! ```

pub mod animation;
pub mod command_line;
pub mod mesh;
pub mod whole_file;
