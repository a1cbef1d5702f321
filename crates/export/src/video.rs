//! Videos. In: pictures, one after the other. Out: a file, written by `ffmpeg`, which receives the pictures through a
//! pipe.
//!
//! The caller passes the path of a temporary file and renames it when the video is complete. If its [`Video`] is
//! dropped, or `end_all` is called, a running process is killed: nothing writes to the file afterwards.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::fmt;
use std::io::{self, Read, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, Command, ExitStatus, Stdio};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

use image::RgbaImage;

use crate::animation::Clip;

/// The program that makes videos.
pub const PROGRAM: &str = "ffmpeg";

/// The maximum length of a message of `ffmpeg` that is shown, in characters.
const MOST_SHOWN: usize = 500;

/// A format of videos.
#[derive(Clone, Copy, Debug, Eq, PartialEq)]
pub enum VideoFormat {
    /// MP4 with H.264, which every player and presentation program supports.
    Mp4,
    /// WebM with VP9, for the web.
    Webm,
}

/// The reason why there is no video.
#[derive(Debug)]
pub enum VideoError {
    /// `ffmpeg` is not installed.
    NoProgram,
    /// `ffmpeg` cannot be started.
    Start(io::Error),
    /// `ffmpeg` has ended with an error; its message.
    Refused(String),
    /// A picture differs in size from the video.
    OtherSize,
}

/// A video that is being written.
#[derive(Debug)]
pub struct Video {
    clip: Clip,
    id: u32,
    pictures: Option<ChildStdin>,
    messages: Option<JoinHandle<String>>,
}

/// The running processes, by number.
static RUNNING: Mutex<BTreeMap<u32, Child>> = Mutex::new(BTreeMap::new());

fn running() -> MutexGuard<'static, BTreeMap<u32, Child>> {
    RUNNING.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Kills the processes of all videos.
pub(crate) fn end_all() {
    for (_, mut process) in std::mem::take(&mut *running()) {
        // A process that has already ended cannot be killed.
        let _ = process.kill();
        let _ = process.wait();
    }
}

impl VideoFormat {
    /// All formats.
    pub const ALL: [Self; 2] = [Self::Mp4, Self::Webm];

    /// Returns the extension of its files.
    pub const fn extension(self) -> &'static str {
        match self {
            Self::Mp4 => "mp4",
            Self::Webm => "webm",
        }
    }

    /// Returns the format for a file's extension.
    pub fn of_extension(extension: &str) -> Option<Self> {
        let mut all = Self::ALL.into_iter();
        all.find(|format| extension.eq_ignore_ascii_case(format.extension()))
    }

    /// Returns the options of `ffmpeg` for its codec.
    fn codec(self) -> &'static [&'static str] {
        match self {
            // With the index at the front, a page can start to play a file before it is fully loaded.
            Self::Mp4 => &["-c:v", "libx264", "-crf", "18", "-movflags", "+faststart"],
            Self::Webm => &["-c:v", "libvpx-vp9", "-crf", "24", "-b:v", "0"],
        }
    }
}

/// Pads to even sides, which the codecs require, and sets the colours of high-definition video.
const FILTER: &str = "pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709:out_range=tv";

/// Returns the arguments of `ffmpeg` for a video from raw pictures on standard input.
fn arguments(format: VideoFormat, clip: Clip, path: &Path) -> Vec<OsString> {
    let [width, height] = clip.size;
    let (size, rate) = (format!("{width}x{height}"), clip.rate.to_string());
    let pictures = [
        "-f",
        "rawvideo",
        "-pixel_format",
        "rgb24",
        "-video_size",
        &size,
        "-framerate",
        &rate,
        "-i",
        "-",
    ];
    let colours = [
        "-pix_fmt",
        "yuv420p",
        "-colorspace",
        "bt709",
        "-color_primaries",
        "bt709",
        "-color_trc",
        "iec61966-2-1",
        "-color_range",
        "tv",
    ];
    let quiet = ["-hide_banner", "-loglevel", "error"];
    let file = ["-f", format.extension(), "-y"];
    let words = [
        &quiet[..],
        &pictures,
        &["-an", "-vf", FILTER],
        format.codec(),
        &colours,
        &file,
    ];
    let words = words.concat().into_iter().map(OsString::from);
    // Ensures that a path never looks like an option or a protocol.
    let mut target = OsString::from("file:");
    target.push(path);
    words.chain([target]).collect()
}

impl Video {
    /// Starts `ffmpeg`, which replaces the file at `path`.
    ///
    /// # Errors
    /// [`VideoError::NoProgram`], [`VideoError::Start`].
    pub fn start(format: VideoFormat, clip: Clip, path: &Path) -> Result<Self, VideoError> {
        let mut running = running();
        let mut process = Command::new(PROGRAM)
            .args(arguments(format, clip, path))
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .map_err(|error| match error.kind() {
                io::ErrorKind::NotFound => VideoError::NoProgram,
                _ => VideoError::Start(error),
            })?;
        let pictures = process.stdin.take();
        let messages = process.stderr.take().map(|mut stream| {
            std::thread::spawn(move || {
                let mut bytes = Vec::new();
                // A partial message is enough for a sentence.
                let _ = stream.read_to_end(&mut bytes);
                String::from_utf8_lossy(&bytes).into_owned()
            })
        });
        let id = process.id();
        running.insert(id, process);
        Ok(Self {
            clip,
            id,
            pictures,
            messages,
        })
    }

    /// Adds the next picture. Transparency becomes white.
    ///
    /// # Errors
    /// See [`VideoError`].
    pub fn add(&mut self, image: &RgbaImage) -> Result<(), VideoError> {
        if <[u32; 2]>::from(image.dimensions()) != self.clip.size {
            return Err(VideoError::OtherSize);
        }
        let over_white = |pixel: &image::Rgba<u8>| {
            let [r, g, b, alpha] = pixel.0.map(u32::from);
            [r, g, b].map(|part| ((part * alpha + 255 * (255 - alpha) + 127) / 255) as u8)
        };
        let bytes: Vec<u8> = image.pixels().flat_map(over_white).collect();
        let written = self.pictures.as_mut().map(|pipe| pipe.write_all(&bytes));
        match written {
            Some(Ok(())) => Ok(()),
            // It has ended, and its message says why.
            _ => Err(self.refusal()),
        }
    }

    /// Waits until `ffmpeg` has written the file.
    ///
    /// # Errors
    /// [`VideoError::Refused`].
    pub fn finish(mut self) -> Result<(), VideoError> {
        // Closing the pipe ends the pictures.
        self.pictures = None;
        match self.wait() {
            Some(status) if status.success() => Ok(()),
            _ => Err(self.refusal()),
        }
    }

    /// Waits for the end of the process, which [`end_all`] can end meanwhile; `None` if it did.
    fn wait(&self) -> Option<ExitStatus> {
        const STEP: Duration = Duration::from_millis(10);
        loop {
            // The lock is not held while this thread sleeps.
            let ended = running().get_mut(&self.id)?.try_wait();
            match ended {
                Ok(None) => std::thread::sleep(STEP),
                Ok(status) => return status,
                Err(_) => return None,
            }
        }
    }

    fn refusal(&mut self) -> VideoError {
        self.end();
        let messages = self.messages.take().and_then(|thread| thread.join().ok());
        let messages = messages.unwrap_or_default();
        let last = messages.lines().rev().find(|line| !line.trim().is_empty());
        let last = last.unwrap_or("it reported no reason").trim();
        let shown = last.chars().filter(|letter| !letter.is_control());
        VideoError::Refused(shown.take(MOST_SHOWN).collect())
    }

    fn end(&mut self) {
        self.pictures = None;
        if let Some(mut process) = running().remove(&self.id) {
            let _ = process.kill();
            let _ = process.wait();
        }
    }
}

impl Drop for Video {
    fn drop(&mut self) {
        self.end();
    }
}

impl fmt::Display for VideoError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoProgram => write!(
                f,
                "a video is made by `{PROGRAM}`, which is not installed here"
            ),
            Self::Start(error) => write!(f, "`{PROGRAM}` cannot be started: {error}"),
            Self::Refused(words) => write!(f, "`{PROGRAM}` could not make the video: {words}"),
            Self::OtherSize => write!(f, "a frame has another size than the video"),
        }
    }
}

impl std::error::Error for VideoError {}
