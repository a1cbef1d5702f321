//! The files that hold an animation: one for all pictures, or one per picture.

use std::fmt;
use std::io::{self, Cursor};
use std::path::{Path, PathBuf};

use image::{ImageError, ImageFormat, RgbaImage};

use crate::animation::{AnimationFormat, Clip, RecordError, Recorder, numbered};
use crate::video::{Video, VideoError, VideoFormat};
use crate::whole_file::{FileSeries, write_whole_at, write_whole_with};

/// A kind of file that holds an animation.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum AnimationFile {
    /// One file with all pictures.
    Film(AnimationFormat),
    /// A video file made by `ffmpeg`.
    Video(VideoFormat),
    /// A PNG file for each picture, named by [`numbered`].
    Series,
}

/// The reason why an animation has no file. `E` is the reason why there is no picture.
#[derive(Debug)]
pub enum AnimationError<E> {
    /// There is no picture.
    Picture(E),
    /// A file cannot be written.
    Unwritable {
        /// The file of a series; `None` for the given path.
        file: Option<PathBuf>,
        /// The system's reason.
        error: io::Error,
    },
    /// The format cannot hold the animation.
    Format(RecordError),
    /// The video could not be made.
    Video(VideoError),
    /// A picture cannot be encoded.
    Encoding(ImageError),
}

impl AnimationFile {
    /// All kinds with their names and extensions, in the order of a menu.
    pub const ALL: [(Self, &'static str, &'static str); 5] = [
        (Self::Film(AnimationFormat::Gif), "GIF", "gif"),
        (Self::Film(AnimationFormat::Apng), "APNG", "apng"),
        (Self::Video(VideoFormat::Mp4), "MP4", "mp4"),
        (Self::Video(VideoFormat::Webm), "WebM", "webm"),
        (Self::Series, "PNG sequence", "png"),
    ];

    /// Returns the kind for a path's extension, in any case of letters.
    pub fn of_path(path: &Path) -> Option<Self> {
        let extension = path.extension()?.to_string_lossy().to_lowercase();
        let found = Self::ALL.into_iter().find(|(.., it)| *it == extension);
        found.map(|(kind, ..)| kind)
    }

    /// Returns the duration of the file in seconds; `None` for a series.
    pub fn seconds(self, clip: Clip) -> Option<f64> {
        match self {
            Self::Film(format) => Some(clip.seconds(format)),
            Self::Video(_) => Some(f64::from(clip.frames) / clip.rate),
            Self::Series => None,
        }
    }

    /// Writes an animation. `next` returns the pictures by number; the animation ends early if it returns `None`.
    ///
    /// # Errors
    /// See [`AnimationError`]. No file is left, and existing ones are unchanged, unless a file of a series cannot be
    /// renamed.
    pub fn write<E>(
        self,
        path: &Path,
        clip: Clip,
        next: &mut dyn FnMut(u32) -> Result<Option<RgbaImage>, E>,
    ) -> Result<(), AnimationError<E>> {
        let frames = clip.frames;
        let mut next = |number| next(number).map_err(AnimationError::Picture);
        match self {
            Self::Film(format) => write_whole_with(path, |out| {
                let mut recorder = Recorder::new(format, clip, out)?;
                for number in 0..frames {
                    let Some(image) = next(number)? else {
                        return Ok(recorder.finish_early()?);
                    };
                    recorder.add(&image)?;
                }
                Ok(recorder.finish()?)
            }),
            Self::Video(format) => write_whole_at(path, |path| {
                let mut video = Video::start(format, clip, path)?;
                for number in 0..frames {
                    let Some(image) = next(number)? else {
                        break;
                    };
                    video.add(&image)?;
                }
                Ok(video.finish()?)
            }),
            Self::Series => {
                let unwritable = |file, error| AnimationError::Unwritable {
                    file: Some(file),
                    error,
                };
                let mut series = FileSeries::default();
                for number in 0..frames {
                    let Some(image) = next(number)? else {
                        break;
                    };
                    let mut bytes = Cursor::new(Vec::new());
                    let encoded = image.write_to(&mut bytes, ImageFormat::Png);
                    encoded.map_err(AnimationError::Encoding)?;
                    let file = numbered(path, number, frames);
                    let added = series.add(&file, bytes.get_ref());
                    added.map_err(|error| unwritable(file, error))?;
                }
                let finished = series.finish();
                finished.map_err(|(file, error)| unwritable(file, error))
            }
        }
    }
}

impl<E> From<io::Error> for AnimationError<E> {
    fn from(error: io::Error) -> Self {
        Self::Unwritable { file: None, error }
    }
}

impl<E> From<RecordError> for AnimationError<E> {
    fn from(error: RecordError) -> Self {
        match error {
            RecordError::Write(error) => error.into(),
            error => Self::Format(error),
        }
    }
}

impl<E> From<VideoError> for AnimationError<E> {
    fn from(error: VideoError) -> Self {
        Self::Video(error)
    }
}

impl<E: fmt::Display> fmt::Display for AnimationError<E> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Picture(error) => write!(f, "{error}"),
            Self::Unwritable { file: None, error } => write!(f, "{error}"),
            Self::Unwritable {
                file: Some(file),
                error,
            } => write!(f, "cannot write `{}`: {error}", file.display()),
            Self::Format(error) => write!(f, "{error}"),
            Self::Video(error) => write!(f, "{error}"),
            Self::Encoding(error) => write!(f, "the picture could not be encoded: {error}"),
        }
    }
}

impl<E: fmt::Debug + fmt::Display> std::error::Error for AnimationError<E> {}

#[cfg(test)]
mod tests {
    use std::convert::Infallible;
    use std::path::Path;

    use image::RgbaImage;

    use super::{AnimationError, AnimationFile};
    use crate::animation::{AnimationFormat, Clip};

    const CLIP: Clip = Clip {
        frames: 3,
        size: [2, 2],
        rate: 200.0,
    };

    fn names(folder: &Path) -> Vec<String> {
        let entries = std::fs::read_dir(folder).expect("a folder");
        let name = |entry: std::io::Result<std::fs::DirEntry>| {
            entry.expect("an entry").file_name().into_string()
        };
        let mut names: Vec<_> = entries.map(name).map(|it| it.expect("a name")).collect();
        names.sort();
        names
    }

    #[test]
    fn an_animation_that_ends_early_has_the_pictures_before() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut next =
            |number| -> Result<_, Infallible> { Ok((number < 2).then(|| RgbaImage::new(2, 2))) };
        for (kind, _, extension) in AnimationFile::ALL {
            let path = folder.path().join("a").with_extension(extension);
            assert_eq!(AnimationFile::of_path(&path), Some(kind));
            let written = match kind {
                AnimationFile::Video(_) => continue,
                _ => kind.write(&path, CLIP, &mut next),
            };
            // An APNG says at its beginning how many pictures it has.
            let is_apng = kind == AnimationFile::Film(AnimationFormat::Apng);
            assert_eq!(written.is_err(), is_apng, "{kind:?}");
        }
        let expected = ["a-0001.png", "a-0002.png", "a.gif"];
        assert_eq!(names(folder.path()), expected);
    }

    #[test]
    fn a_picture_that_cannot_be_drawn_leaves_no_file() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut next = |number| match number {
            0 => Ok(Some(RgbaImage::new(2, 2))),
            _ => Err("no picture"),
        };
        for (kind, _, extension) in AnimationFile::ALL {
            if !matches!(kind, AnimationFile::Video(_)) {
                let path = folder.path().join("a").with_extension(extension);
                let written = kind.write(&path, CLIP, &mut next);
                assert!(matches!(
                    written,
                    Err(AnimationError::Picture("no picture"))
                ));
            }
        }
        assert!(names(folder.path()).is_empty());
    }

    #[test]
    fn a_gif_takes_as_long_as_its_file_states() {
        let gif = AnimationFile::Film(AnimationFormat::Gif);
        // Hundredths of a second are the shortest time that a picture of a GIF is shown.
        assert_eq!(gif.seconds(CLIP), Some(0.03));
        assert_eq!(AnimationFile::Series.seconds(CLIP), None);
    }
}
