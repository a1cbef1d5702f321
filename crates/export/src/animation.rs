//! Animations: scripts of the changes from frame to frame (`script.rs`), and files that hold many pictures.
//!
//! ```text
//! Course + number ──▶ share
//! Script + PictureRequest + share ──▶ PictureRequest ──(drawn by the caller)──▶ picture ──Recorder──▶ GIF, APNG
//! ```
//!
//! A recorder keeps one picture at a time, whatever their number.

mod palette;
mod script;

use std::fmt;
use std::io::{self, Write};
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use gif::Repeat;
use image::RgbaImage;

pub use script::{Course, ParamChange, Script, ScriptError};

/// The default number of pictures of an animation.
pub const FRAMES: u32 = 60;
/// The maximum number of pictures of an animation.
pub const MOST_FRAMES: u32 = 100_000;
/// The default number of pictures per second.
pub const RATE: f64 = 25.0;
/// The numbers of pictures per second that an animation may have.
pub const RATES: RangeInclusive<f64> = 0.01..=1000.0;

/// Returns the file of one frame in a sequence of `frames` pictures: `OUT-0001.png` for frame 0 of `OUT.png`, with as
/// many digits as the last number needs, and at least four.
pub fn numbered(path: &Path, frame: u32, frames: u32) -> PathBuf {
    let digits = frames.to_string().len().max(4);
    let number = frame + 1;
    let mut name = path.file_stem().unwrap_or_default().to_owned();
    name.push(format!("-{number:0digits$}.png"));
    path.with_file_name(name)
}

/// A file format that holds many pictures.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub enum AnimationFormat {
    /// GIF: 255 colours for each picture, dithered; a pixel is opaque or transparent.
    Gif,
    /// Animated PNG: all colours, with partial transparency.
    Apng,
}

impl AnimationFormat {
    /// Returns the format for a file name's extension, without its dot, in any case of letters.
    pub fn of_extension(extension: &str) -> Option<Self> {
        match extension.to_lowercase().as_str() {
            "gif" => Some(Self::Gif),
            "apng" => Some(Self::Apng),
            _ => None,
        }
    }

    /// Returns the number of units per second in which a file counts the durations of this many pictures per second: the
    /// duration of a picture is a number of 16 bits.
    fn parts(self, rate: f64) -> u32 {
        match self {
            Self::Apng if 1000.0 / rate < f64::from(u16::MAX) => 1000,
            Self::Apng | Self::Gif => 100,
        }
    }
}

/// The length and the size of an animation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clip {
    /// The number of pictures, at least one.
    pub frames: u32,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Pictures per second, positive.
    pub rate: f64,
}

/// The reason why an animation could not be written.
#[derive(Debug)]
pub enum RecordError {
    /// The writer failed.
    Write(io::Error),
    /// The format cannot hold this animation, or the pictures differ in size or number from the clip; the encoder's
    /// sentence.
    Format(String),
}

/// Writes an animation picture by picture, with the crates `gif` and `png`. The animation repeats endlessly.
pub struct Recorder<W: Write> {
    clip: Clip,
    added: u32,
    encoder: Encoder<W>,
}

enum Encoder<W: Write> {
    Gif(Box<gif::Encoder<W>>),
    Apng(Box<png::Writer<W>>),
}

impl<W: Write> Recorder<W> {
    /// Begins a file.
    ///
    /// # Errors
    /// See [`RecordError`].
    pub fn new(format: AnimationFormat, clip: Clip, out: W) -> Result<Self, RecordError> {
        if !(clip.rate > 0.0 && clip.rate.is_finite()) {
            let message = "the frame rate must be positive";
            return Err(RecordError::Format(message.to_owned()));
        }
        let [width, height] = clip.size;
        let encoder = match format {
            AnimationFormat::Gif => {
                let side = |side: u32| {
                    let fits = u16::try_from(side);
                    fits.map_err(|_| {
                        RecordError::Format(format!("a GIF cannot have {side} pixels on a side"))
                    })
                };
                let mut encoder = gif::Encoder::new(out, side(width)?, side(height)?, &[])?;
                encoder.set_repeat(Repeat::Infinite)?;
                Encoder::Gif(Box::new(encoder))
            }
            AnimationFormat::Apng => {
                let mut encoder = png::Encoder::new(out, width, height);
                encoder.set_color(png::ColorType::Rgba);
                encoder.set_depth(png::BitDepth::Eight);
                encoder.set_animated(clip.frames, 0)?;
                encoder.validate_sequence(true);
                Encoder::Apng(Box::new(encoder.write_header()?))
            }
        };
        Ok(Self {
            clip,
            added: 0,
            encoder,
        })
    }

    /// Adds the next picture.
    ///
    /// # Errors
    /// See [`RecordError`].
    pub fn add(&mut self, image: &RgbaImage) -> Result<(), RecordError> {
        if <[u32; 2]>::from(image.dimensions()) != self.clip.size {
            let message = "a frame has another size than the animation";
            return Err(RecordError::Format(message.to_owned()));
        }
        match &mut self.encoder {
            Encoder::Gif(encoder) => {
                let delay = self
                    .clip
                    .ticks(self.added, AnimationFormat::Gif.parts(self.clip.rate));
                encoder.write_frame(&palette::frame(image, delay))?;
            }
            Encoder::Apng(encoder) => {
                let parts = AnimationFormat::Apng.parts(self.clip.rate);
                encoder.set_frame_delay(self.clip.ticks(self.added, parts), parts as u16)?;
                encoder.write_image_data(image.as_raw())?;
            }
        }
        self.added += 1;
        Ok(())
    }

    /// Ends the file.
    ///
    /// # Errors
    /// See [`RecordError`]; missing pictures are such an error.
    pub fn finish(self) -> Result<(), RecordError> {
        if self.added != self.clip.frames {
            let message = format!(
                "only {} of {} frames were written",
                self.added, self.clip.frames
            );
            return Err(RecordError::Format(message));
        }
        self.end()
    }

    /// Ends a GIF with the pictures that it has so far.
    ///
    /// # Errors
    /// See [`RecordError`]; an APNG states its number of pictures at its start.
    pub(crate) fn finish_early(self) -> Result<(), RecordError> {
        match self.encoder {
            Encoder::Gif(_) => self.end(),
            Encoder::Apng(_) => self.finish(),
        }
    }

    fn end(self) -> Result<(), RecordError> {
        match self.encoder {
            // The end is written when the encoder returns its writer.
            Encoder::Gif(encoder) => encoder.into_inner()?.flush()?,
            Encoder::Apng(encoder) => encoder.finish()?,
        }
        Ok(())
    }
}

impl Clip {
    /// Returns the duration of an animation in seconds, as its file states it.
    pub fn seconds(&self, format: AnimationFormat) -> f64 {
        let parts = format.parts(self.rate);
        let ticks = (0..self.frames).map(|frame| u64::from(self.ticks(frame, parts)));
        ticks.sum::<u64>() as f64 / f64::from(parts)
    }

    /// Returns the duration of a picture in units of 1/`parts` second, rounded so that errors do not accumulate.
    fn ticks(&self, frame: u32, parts: u32) -> u16 {
        let until = |frames: u32| (f64::from(frames) * f64::from(parts) / self.rate).round();
        let ticks = until(frame + 1) - until(frame);
        ticks.clamp(1.0, f64::from(u16::MAX)) as u16
    }
}

impl<W: Write> fmt::Debug for Recorder<W> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Recorder")
            .field("clip", &self.clip)
            .field("added", &self.added)
            .finish_non_exhaustive()
    }
}

impl fmt::Display for RecordError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Write(error) => write!(f, "{error}"),
            Self::Format(message) => write!(f, "the animation cannot be written: {message}"),
        }
    }
}

impl std::error::Error for RecordError {}

impl From<io::Error> for RecordError {
    fn from(error: io::Error) -> Self {
        Self::Write(error)
    }
}

impl From<gif::EncodingError> for RecordError {
    fn from(error: gif::EncodingError) -> Self {
        match error {
            gif::EncodingError::Io(error) => Self::Write(error),
            other => Self::Format(other.to_string()),
        }
    }
}

impl From<png::EncodingError> for RecordError {
    fn from(error: png::EncodingError) -> Self {
        match error {
            png::EncodingError::IoError(error) => Self::Write(error),
            other => Self::Format(other.to_string()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::numbered;
    use std::path::Path;

    #[test]
    fn numbered_files_stand_beside_the_name_and_sort() {
        let name = |path: &str, frame, frames| numbered(Path::new(path), frame, frames);
        assert_eq!(name("a/out.png", 6, 60), Path::new("a/out-0007.png"));
        assert_eq!(name("out", 12_344, 99_999), Path::new("out-12345.png"));
        #[cfg(unix)]
        {
            use std::ffi::OsStr;
            use std::os::unix::ffi::OsStrExt;

            // Names of other bytes than UTF-8 stay apart.
            let [a, b] =
                [&b"\xfe.png"[..], b"\xff.png"].map(|bytes| Path::new(OsStr::from_bytes(bytes)));
            assert_ne!(numbered(a, 0, 2), numbered(b, 0, 2));
        }
    }
}
