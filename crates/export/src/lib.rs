//! Files for other programs.
//!
//! ```text
//! Scene + ParamValues + Request ──mesh.rs──▶ OBJ, PLY, STL, glTF ─┐
//! PictureRequest ──command_line.rs──▶ the command that draws it again
//! a picture in layers ──print.rs──▶ SVG, PDF
//! pictures, one after the other ──animation.rs──▶ GIF, APNG ───┴─▶ io::Write ──whole_file.rs──▶ a complete file, or none
//! pictures, one after the other ──video.rs──▶ ffmpeg ──▶ MP4, WebM
//! ```
//!
//! `animation_file.rs` writes an animation as any of the last two, or as one PNG per picture.

pub mod animation;
pub mod animation_file;
pub mod command_line;

pub mod mesh;
pub mod print;
pub mod video;
pub mod whole_file;
