//! Animations: scripts of what changes from frame to frame, and files that hold many pictures.
//!
//! ```text
//! Script + PictureRequest + share ──▶ PictureRequest ──(drawn by the caller)──▶ picture ──Recorder──▶ GIF, APNG
//! ```
//!
//! A recorder keeps one picture at a time, however many there are.

mod palette;

use std::fmt;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use gif::Repeat;
use image::RgbaImage;
use render::bounds::Bounds;
use render::geodesic_view::PlacedCamera;
use render::point::DrawingPoint;
use render::trail::Trail;
use render::view::space;
use render::viewpoint::Viewpoint;
use render::{PictureRequest, RenderError};
use scene::SetError;

/// The changes of an animation.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Script {
    /// Params and grids that change from one value to another.
    pub changes: Vec<ParamChange>,
    /// The distance that the geodesic camera moves along its X axis; negative is backwards. The camera is that of a
    /// geodesic view, or the one that a 3D view shows.
    pub walk: Option<f64>,
    /// Draws the path of the camera.
    pub trail: bool,
}

/// The default number of pictures of an animation.
pub const FRAMES: u32 = 60;
/// The default number of pictures a second.
pub const RATE: f64 = 25.0;

/// The number of frames whose bounds place a fixed camera.
const LOOKS: u32 = 9;

/// A param or grid that changes from one value to another.
#[derive(Clone, Debug, PartialEq)]
pub struct ParamChange {
    /// Its name.
    pub name: String,
    /// The first value: one number per component.
    pub from: Vec<f64>,
    /// The last value.
    pub to: Vec<f64>,
}

/// The reason for which a frame cannot be drawn.
#[derive(Clone, Debug, PartialEq)]
pub enum ScriptError {
    /// A param or grid cannot have that value.
    Set(SetError),
    /// The camera cannot be placed there, or cannot move there.
    Camera(RenderError),
}

impl Script {
    /// Returns the request of a frame. `share` is the part of the animation that has passed: 0 at its start, 1 at its
    /// end. The script leaves the rest of `request` as it is.
    ///
    /// # Errors
    /// See [`ScriptError`].
    pub fn frame_at(
        &self,
        request: &PictureRequest,
        share: f64,
    ) -> Result<PictureRequest, ScriptError> {
        let mut request = request.clone();
        for ParamChange { name, from, to } in &self.changes {
            let between = |(from, to): (&f64, &f64)| {
                // Rounding must not change the values at both ends.
                if share <= 0.0 {
                    *from
                } else if share >= 1.0 {
                    *to
                } else {
                    from + share * (to - from)
                }
            };
            let values: Vec<f64> = from.iter().zip(to).map(between).collect();
            Arc::make_mut(&mut request.params)
                .set(&request.scene, name, &values)
                .map_err(ScriptError::Set)?;
        }
        if let Some(length) = self.walk {
            self.move_camera(&mut request, share * length)
                .map_err(ScriptError::Camera)?;
        }
        Ok(request)
    }

    /// Fixes a camera in space: where the request does not place it, it is placed so that it sees every frame of the
    /// animation. Other requests stay as they are.
    ///
    /// # Errors
    /// See [`ScriptError`].
    pub fn steady(&self, request: &PictureRequest) -> Result<PictureRequest, ScriptError> {
        let mut request = request.clone();
        let Some(camera) = request.view.space().map(|space| space.camera) else {
            return Ok(request);
        };
        if camera.eye.is_some() && camera.target.is_some() || self.changes.is_empty() {
            return Ok(request);
        }
        let params = Self {
            walk: None,
            ..self.clone()
        };
        let plain = PictureRequest {
            trails: Vec::new(),
            ..request.clone()
        };
        let (mut cloud, mut facing) = (Vec::new(), None);
        for step in 0..LOOKS {
            let bounds = space::bounds(&params.frame_at(&plain, Self::share(step, LOOKS))?);
            facing = facing.or(bounds.facing);
            let places = bounds.cloud.iter();
            cloud.extend(places.map(|&place| bounds.placement.world(DrawingPoint(place)).0));
        }
        let bounds = Bounds {
            facing,
            ..Bounds::around(cloud)
        };
        let projection = camera.projection;
        let camera =
            space::first_camera(&bounds, &camera, &request).map_err(ScriptError::Camera)?;
        let distance = camera.parallel.map_or(1.0, |parallel| parallel.distance);
        let ahead = camera.eye - camera.axes[2] * distance;
        let [eye, target] =
            [camera.eye, ahead].map(|place| bounds.placement.world(DrawingPoint(place.to_array())));
        if let Some(space) = request.view.space_mut() {
            space.camera = Viewpoint {
                projection,
                ..Viewpoint::new(eye, target)
            };
        }
        Ok(request)
    }

    /// The share of the animation at frame `frame` of `frames`, counted from 0.
    pub fn share(frame: u32, frames: u32) -> f64 {
        f64::from(frame) / f64::from(frames.saturating_sub(1).max(1))
    }

    fn move_camera(&self, request: &mut PictureRequest, length: f64) -> Result<(), RenderError> {
        let Some(camera) = request.view.shown_camera().copied() else {
            return Ok(());
        };
        camera.check(&request.scene)?;
        let placed = PlacedCamera::new(&request.scene, &request.params, &camera, request.size)?;
        let start = placed.frame;
        let mut trail = Trail::new(camera.surface, start.uv.0);
        let (moved, _) = trail
            .walk(placed.manifold(), &start, [length / placed.zoom, 0.0])
            .map_err(|error| {
                RenderError::Camera(format!("the camera cannot walk there: {error}"))
            })?;
        request.view.show_camera(camera.with_frame(moved));
        if self.trail {
            request.trails.push(trail.into());
        }
        Ok(())
    }
}

/// The file of one frame in a sequence of `frames` pictures: `OUT-0001.png` for frame 0 of `OUT.png`, with as many
/// digits as the last number needs, and at least four.
pub fn numbered(path: &Path, frame: u32, frames: u32) -> PathBuf {
    let digits = frames.to_string().len().max(4);
    let stem = path.file_stem().unwrap_or_default();
    let number = frame + 1;
    let name = format!("{}-{number:0digits$}.png", stem.to_string_lossy());
    path.with_file_name(name)
}

/// A file format that holds many pictures.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub enum AnimationFormat {
    /// GIF: 256 colours for each picture, dithered; a pixel is opaque or transparent.
    Gif,
    /// Animated PNG: all colours, partly transparent pixels.
    Apng,
}

impl AnimationFormat {
    /// The format of a file name's extension, without its dot, in any case of letters.
    pub fn of_extension(extension: &str) -> Option<Self> {
        match extension.to_lowercase().as_str() {
            "gif" => Some(Self::Gif),
            "apng" => Some(Self::Apng),
            _ => None,
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
    /// Pictures a second, positive.
    pub rate: f64,
}

/// The reason for which an animation could not be written.
#[derive(Debug)]
pub enum RecordError {
    /// The writer failed.
    Write(io::Error),
    /// The format cannot hold such an animation, or the pictures differ in size or number from the clip; the encoder's
    /// sentence.
    Format(String),
}

/// Writes an animation picture by picture, with the crates `gif` and `png`. The animation repeats without end.
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
            let message = "the number of pictures a second must be positive";
            return Err(RecordError::Format(message.to_owned()));
        }
        let [width, height] = clip.size;
        let encoder = match format {
            AnimationFormat::Gif => {
                let side = |side: u32| {
                    let fits = u16::try_from(side);
                    fits.map_err(|_| {
                        RecordError::Format(format!("a GIF has no {side} pixels a side"))
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
            let message = "a picture is of another size than the animation";
            return Err(RecordError::Format(message.to_owned()));
        }
        match &mut self.encoder {
            Encoder::Gif(encoder) => {
                let delay = self.clip.ticks(self.added, 100);
                encoder.write_frame(&palette::frame(image, delay))?;
            }
            Encoder::Apng(encoder) => {
                encoder.set_frame_delay(self.clip.ticks(self.added, 1000), 1000)?;
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
            let message = format!("{} of {} pictures are there", self.added, self.clip.frames);
            return Err(RecordError::Format(message));
        }
        match self.encoder {
            // The end is written when the encoder gives its writer back.
            Encoder::Gif(encoder) => encoder.into_inner()?.flush()?,
            Encoder::Apng(encoder) => encoder.finish()?,
        }
        Ok(())
    }
}

impl Clip {
    /// The duration of a picture in units of 1/`parts` second, rounded so that the errors do not add up.
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

impl fmt::Display for ScriptError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Set(error) => write!(f, "{error}"),
            Self::Camera(error) => write!(f, "{error}"),
        }
    }
}

impl std::error::Error for ScriptError {}

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
    }
}
