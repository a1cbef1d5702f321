//! Animations of `geotrace render`: params and the geodesic camera that move, and the files that hold many pictures.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError, Sender};
use std::thread;
use std::time::Duration;

use clap::Args;
use export::animation::{self, AnimationFormat, Clip, Course, ParamChange, Script, ScriptError};
use export::animation_file::{AnimationError, AnimationFile};
use export::mesh::MeshFormat;
use export::print::PrintFormat;
use export::video::VideoError;
use render::{Note, PictureRequest};
use scene::{FailedRun, ParamValues};

use super::render::{Picture, failure as render_failure};
use crate::argument::{self, Animated, Assignment, Quantity};
use crate::failure::Failure;
use crate::interruption;
use crate::output::{self, Inputs, OutputTarget};
use crate::program::LoadedProgram;
use crate::progress::Progress;

/// The highest rate of a GIF that viewers show: GIF counts hundredths of a second, and viewers take one of them for ten.
const FASTEST_GIF: f64 = 50.0;
/// The maximum number of notes on an animation that are printed.
const MOST_NOTES: usize = 16;
/// The time after which an interruption is looked for again.
const INTERRUPTION_POLL: Duration = Duration::from_millis(20);

/// The options of animations.
#[derive(Args, Debug)]
#[command(next_help_heading = "Animation")]
#[group(skip)]
pub(super) struct Arguments {
    /// Animate a param or a grid from one value to another, both included; may be given several times
    #[arg(long, value_name = "NAME=FROM:TO", value_parser = argument::animated, allow_hyphen_values = true)]
    animate: Vec<Animated>,
    /// The distance that the geodesic camera walks along its X axis (backwards if negative), by parallel transport;
    /// in the 3D view with --show-camera. A single picture shows the end of the walk
    #[arg(long, value_name = "LENGTH", value_parser = argument::quantity, allow_hyphen_values = true)]
    walk: Option<Quantity>,
    /// Draw the path that has been walked, and its length
    #[arg(long, requires = "walk")]
    trail: bool,
    /// Turn the camera of the 3D view once about the vertical line through its target
    #[arg(long)]
    turntable: bool,
    /// The course of the animation: `once`, to the end; `loop`: the frame after the last is the first;
    /// `back-and-forth` [default: once, loop with --turntable]
    #[arg(long, value_name = "COURSE", value_parser = course)]
    course: Option<Course>,
    /// The number of frames [default: 60]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(2..=i64::from(animation::MOST_FRAMES)), allow_hyphen_values = true)]
    frames: Option<u32>,
    /// Frames per second [default: 25]
    #[arg(long, value_name = "RATE", value_parser = argument::rate, allow_hyphen_values = true)]
    fps: Option<f64>,
}

/// An animation that is to be written.
#[derive(Debug)]
pub(super) struct Animation {
    output: PathBuf,
    file: AnimationFile,
    frames: u32,
    rate: f64,
    course: Course,
}

/// The course of a name, whose words a hyphen joins.
fn course(name: &str) -> Result<Course, String> {
    let mut all = Course::ALL.into_iter();
    let found = all.find(|(_, words)| words.replace(' ', "-") == name);
    let missing = || "it is `once`, `loop` or `back-and-forth`".to_owned();
    found.map(|(course, _)| course).ok_or_else(missing)
}

/// A picture of an animation.
#[derive(Debug)]
struct DrawnPicture {
    image: image::RgbaImage,
    notes: Vec<Note>,
    /// The description of the first one.
    description: Option<String>,
}

/// The notes of the frames: each sentence once, with the number of frames that have it. Those about costs are those of the
/// first frame.
#[derive(Debug, Default)]
struct FrameNotes {
    frames: usize,
    sentences: Vec<(Note, usize)>,
}

impl FrameNotes {
    /// Adds the notes of the next frame.
    fn add(&mut self, notes: Vec<Note>) {
        for note in notes {
            let mut known = self.sentences.iter_mut();
            match known.find(|(other, _)| *other == note) {
                Some((_, count)) => *count += 1,
                None if self.frames > 0 && matches!(note, Note::Cost(_)) => {}
                None => self.sentences.push((note, 1)),
            }
        }
        self.frames += 1;
    }

    /// The lines for standard error.
    fn text(&self) -> String {
        let frames = self.frames;
        let shown = self.sentences.iter().take(MOST_NOTES);
        let lines = shown.map(|(note, count)| match note {
            Note::Remark(text) if *count < frames => {
                format!("note: in {count} of {frames} frames: {text}\n")
            }
            note => format!("note: {note}\n"),
        });
        let mut text: String = lines.collect();
        if let Some(more @ 1..) = self.sentences.len().checked_sub(MOST_NOTES) {
            text.push_str(&format!("note: and {more} more notes\n"));
        }
        text
    }
}

/// Draws the picture at a share of the animation, and reports its progress to the second argument.
type Draw<'a> = dyn Fn(f64, &(dyn Fn(f32) + Sync)) -> Result<Picture, Failure> + 'a;

impl Arguments {
    /// Sets the params to their values in the first frame, if the program is run for each frame.
    ///
    /// # Errors
    /// [`Failure::Usage`].
    pub(super) fn begin(
        &self,
        program: &LoadedProgram,
        params: &mut ParamValues,
    ) -> Result<(), Failure> {
        let scene = program.scene();
        let animated = self.animate.iter().filter(|_| scene.rerun.is_some());
        for Animated { name, from, .. } in animated {
            let option = format!("--animate {name}");
            let number = |quantity| program.number(&option, quantity, params);
            let from: Result<Vec<f64>, Failure> = from.iter().map(number).collect();
            let set = params.set(scene, name, &from?);
            set.map_err(|error| failure(ScriptError::Set(error), program))?;
        }
        Ok(())
    }

    /// Returns notes on params that are set although the animation gives them their values.
    pub(super) fn idle_values(&self, set: &[Assignment]) -> Vec<String> {
        let animated = |name: &str| self.animate.iter().any(|it| it.name == name);
        let idle = set.iter().filter(|it| animated(&it.name));
        idle.map(|Assignment { name, .. }| {
            format!("--set {name} has no effect: `--animate {name}` gives the value in each frame")
        })
        .collect()
    }

    /// Builds the script from the options, and checks the values at both ends and that the picture has the cameras that
    /// move.
    ///
    /// # Errors
    /// [`Failure::Usage`].
    pub(super) fn script(
        &self,
        program: &LoadedProgram,
        request: &PictureRequest,
    ) -> Result<Script, Failure> {
        let params: &ParamValues = &request.params;
        let scene = program.scene();
        let mut script = Script {
            trail: self.trail,
            turntable: self.turntable,
            ..Script::default()
        };
        for Animated { name, from, to } in &self.animate {
            let option = format!("--animate {name}");
            if script.changes.iter().any(|change| change.name == *name) {
                return Err(Failure::usage(format!(
                    "{option}: it is given twice, and `{name}` runs from one value to another once"
                )));
            }
            let values = |quantities: &[Quantity]| -> Result<Vec<f64>, Failure> {
                let number = |q| program.number(&option, q, params);
                quantities.iter().map(number).collect()
            };
            let change = ParamChange {
                name: name.clone(),
                from: values(from)?,
                to: values(to)?,
            };
            for end in [&change.from, &change.to] {
                let set = params.clone().set(scene, name, end);
                set.map_err(|error| failure(ScriptError::Set(error), program))?;
            }
            script.changes.push(change);
        }
        if self.turntable && request.view.space().is_none() {
            return Err(Failure::Usage {
                message: "--turntable turns the camera of the 3D view, but this is a geodesic view"
                    .into(),
                hint: Some("leave `--view` out, or add `--view 3d`".into()),
            });
        }
        if let Some(walk) = &self.walk {
            if request.view.shown_camera().is_none() {
                return Err(Failure::Usage {
                    message: "--walk moves a geodesic camera, but the picture has none".into(),
                    hint: Some("add `--view geodesic` or `--show-camera SURFACE`".into()),
                });
            }
            script.walk = Some(program.number("--walk", walk, params)?);
        }
        let shown = request.view.shown_camera();
        if self.trail && shown.is_some_and(|camera| scene.is_solid(camera.surface)) {
            return Err(Failure::usage(
                "--trail draws the path of a camera on a surface, but this camera is on a solid",
            ));
        }
        Ok(script)
    }

    /// The animation that the options and the file's name ask for; `None` for a single picture.
    ///
    /// # Errors
    /// [`Failure::Usage`] if the file's name and the options contradict each other.
    pub(super) fn animation(&self, output: &Path) -> Result<Option<Animation>, Failure> {
        let name = output.display();
        let wrong = |message: String, hint: String| Failure::Usage {
            message,
            hint: Some(hint),
        };
        let extension = output
            .extension()
            .map(|extension| extension.to_string_lossy().to_lowercase())
            .unwrap_or_default();
        let known = AnimationFile::of_path(output);
        let file = known.filter(|file| *file != AnimationFile::Series);
        let is_for_print = PrintFormat::of_extension(&extension).is_some();
        if known.is_none() && !is_for_print && !extension.is_empty() {
            let hint = match MeshFormat::from_extension(&extension) {
                Some(_) => "`geotrace export` writes meshes".to_owned(),
                None => format!("write to `{}`", output.with_extension("png").display()),
            };
            return Err(wrong(
                format!(
                    "`{name}` would not be a .{extension} file: pictures are written as PNG, SVG or PDF, animations as GIF, APNG, MP4 or WebM"
                ),
                hint,
            ));
        }
        let still = self.animate.is_empty() && self.walk.is_none() && !self.turntable;
        if still && (file.is_some() || self.frames.is_some() || self.fps.is_some()) {
            return Err(wrong(
                format!("`{name}` is an animation, but nothing moves"),
                "`--animate NAME=FROM:TO` moves a param, `--walk LENGTH` the geodesic camera, `--turntable` the one in space"
                    .into(),
            ));
        }
        if file.is_none() && (self.frames.is_none() || is_for_print) {
            let many = self.fps.is_some() || self.frames.is_some() || self.course.is_some();
            if !self.animate.is_empty() || self.turntable || many {
                return Err(wrong(
                    format!("`{name}` is a single picture, but an animation has many"),
                    format!(
                        "write to `{}`, or {}",
                        output.with_extension("gif").display(),
                        match is_for_print {
                            true => format!(
                                "with `--frames N` to `{}`",
                                output.with_extension("png").display()
                            ),
                            false => "give `--frames N` for one picture per frame".to_owned(),
                        }
                    ),
                ));
            }
            return Ok(None);
        }
        if output.as_os_str() == "-" {
            return Err(Failure::usage("an animation needs a file: `-o OUT.gif`"));
        }
        Ok(Some(Animation {
            output: output.to_owned(),
            file: file.unwrap_or(AnimationFile::Series),
            frames: self.frames.unwrap_or(animation::FRAMES),
            rate: self.fps.unwrap_or(animation::RATE),
            course: self.course.unwrap_or(if self.turntable {
                Course::Loop
            } else {
                Course::Once
            }),
        }))
    }
}

impl Animation {
    /// Refuses a format that cannot end before its last picture.
    ///
    /// # Errors
    /// [`Failure::Usage`].
    pub(super) fn check_partial(&self) -> Result<(), Failure> {
        match self.file {
            AnimationFile::Film(AnimationFormat::Gif) | AnimationFile::Series => Ok(()),
            AnimationFile::Film(AnimationFormat::Apng) | AnimationFile::Video(_) => {
                Err(Failure::Usage {
                    message: "--partial cannot keep a part of this format".to_owned(),
                    hint: Some(
                        "write to a GIF, or give `--frames N` and a PNG for one picture per frame"
                            .to_owned(),
                    ),
                })
            }
        }
    }

    /// Draws all pictures, one after the other, and writes them, over none of the `inputs`; then prints their notes, and what
    /// `describe` returns for the first picture and the file's name. Once an end has been asked for, which a command hears only
    /// if it keeps what is done, the picture that is being drawn is not waited for: the program ends when those before it are
    /// written.
    ///
    /// # Errors
    /// Those of drawing and writing; no file is left then.
    pub(super) fn write(
        &self,
        inputs: &Inputs,
        size: [u32; 2],
        draw: &Draw<'_>,
        describe: impl Fn(&Picture, &str) -> String,
    ) -> Result<(), Failure> {
        // Checked before anything is drawn.
        for path in self.paths() {
            OutputTarget::apart_from(&path, inputs)?;
        }
        let progress = Progress::start("drawing");
        let (ask, asked) = mpsc::channel();
        let (sender, pictures) = mpsc::channel();
        thread::scope(|scope| {
            let write = || -> Result<String, Failure> {
                let is_over = interruption::is_interrupted;
                let text = self.write_pictures(size, ask, pictures, is_over)?;
                if is_over() {
                    progress.clear();
                    output::print_error(&text);
                    interruption::end_now();
                }
                Ok(text)
            };
            let writing = thread::Builder::new().spawn_scoped(scope, write);
            let writing = writing.map_err(|error| Failure::Internal {
                message: format!("no thread can be started: {}", output::reason(&error)),
            })?;
            // Gone if drawing panics, so that the other thread ends.
            let sender = sender;
            for number in asked {
                let done =
                    |share: f32| progress.reach((number as f32 + share) / self.frames as f32);
                let drawn = draw(self.course.share(number, self.frames), &done);
                let drawn = drawn.map(|picture| DrawnPicture {
                    description: (number == 0).then(|| describe(&picture, &self.name())),
                    notes: picture.notes,
                    image: picture.image,
                });
                // Nobody receives it if the thread that writes has panicked.
                let _ = sender.send(drawn);
            }
            let written = writing.join();
            let text = written.unwrap_or_else(|panic| std::panic::resume_unwind(panic))?;
            progress.clear();
            output::print_error(&text);
            Ok(())
        })
    }

    /// Asks for the pictures by number and writes those that are received, until `is_over` once there is one. Returns
    /// what is to be told about them.
    fn write_pictures(
        &self,
        size: [u32; 2],
        ask: Sender<u32>,
        pictures: Receiver<Result<DrawnPicture, Failure>>,
        is_over: impl Fn() -> bool,
    ) -> Result<String, Failure> {
        let clip = Clip {
            frames: self.frames,
            size,
            rate: self.rate,
        };
        let mut description = String::new();
        let mut notes = FrameNotes::default();
        let mut drawn = 0;
        let mut next = |number: u32| -> Result<Option<image::RgbaImage>, Failure> {
            // If nobody draws, there is no picture.
            let _ = ask.send(number);
            let picture = loop {
                match pictures.recv_timeout(INTERRUPTION_POLL) {
                    // What was being drawn then is none, or coarser than those before it.
                    _ if number > 0 && is_over() => return Ok(None),
                    Ok(picture) => break picture?,
                    Err(RecvTimeoutError::Timeout) => {}
                    Err(RecvTimeoutError::Disconnected) => {
                        let message = "the pictures were not drawn".to_owned();
                        return Err(Failure::Internal { message });
                    }
                }
            };
            drawn += 1;
            description.extend(picture.description);
            notes.add(picture.notes);
            Ok(Some(picture.image))
        };
        let written = self.file.write(&self.output, clip, &mut next);
        written.map_err(|error| self.failure(error))?;
        let frames = drawn;
        let mut text = notes.text();
        text.push_str(description.trim_end());
        text.push_str(&match self.file.seconds(Clip { frames, ..clip }) {
            Some(seconds) => format!("; {frames} frames, {seconds:.2} s long\n"),
            None => format!("; the first of {frames}\n"),
        });
        if self.file == AnimationFile::Film(AnimationFormat::Gif) && self.rate > FASTEST_GIF {
            text.push_str(
                "note: most viewers play a GIF of more than 50 frames per second slowly\n",
            );
        }
        if frames < self.frames {
            let wanted = self.frames;
            text.push_str(&format!("note: interrupted: {frames} of {wanted} frames\n"));
        }
        Ok(text)
    }

    /// The name of the file, or of the first one.
    fn name(&self) -> String {
        let first = self.paths().next();
        first.unwrap_or_default().display().to_string()
    }

    /// The files that are written.
    fn paths(&self) -> impl Iterator<Item = PathBuf> {
        let files = match self.file {
            AnimationFile::Film(_) | AnimationFile::Video(_) => 1,
            AnimationFile::Series => self.frames,
        };
        (0..files).map(move |number| match self.file {
            AnimationFile::Film(_) | AnimationFile::Video(_) => self.output.clone(),
            AnimationFile::Series => animation::numbered(&self.output, number, self.frames),
        })
    }

    fn failure(&self, error: AnimationError<Failure>) -> Failure {
        let hint = match &error {
            AnimationError::Video(VideoError::NoProgram) => Some(
                "`ffmpeg` is free: https://ffmpeg.org, or your system's packages; .gif and .apng do not need it"
                    .to_owned(),
            ),
            _ => None,
        };
        let message = match error {
            AnimationError::Picture(failure) => return failure,
            AnimationError::Unwritable { file, error } => {
                return output::unwritable(file.as_deref().unwrap_or(&self.output), &error);
            }
            AnimationError::Encoding(error) => {
                return Failure::Internal {
                    message: format!("the picture could not be encoded: {error}"),
                };
            }
            AnimationError::Format(error) => error.to_string(),
            AnimationError::Video(error) => error.to_string(),
        };
        Failure::Input { message, hint }
    }
}

/// Converts the error of a script into a failure of the command. Those of a run of the program are printed.
pub(super) fn failure(error: ScriptError, program: &LoadedProgram) -> Failure {
    match error {
        ScriptError::Run(FailedRun(diagnostics)) => program.failed_run(&diagnostics),
        ScriptError::Set(error) => Failure::usage(format!("--animate: {error}")),
        ScriptError::Camera(error) => render_failure(error),
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;
    use std::sync::mpsc;

    use super::{Animation, AnimationFile, AnimationFormat, Course, DrawnPicture};

    #[test]
    fn a_picture_that_is_never_done_is_not_waited_for() {
        let folder = tempfile::tempdir().expect("a folder");
        for (name, file) in [
            ("a.gif", AnimationFile::Film(AnimationFormat::Gif)),
            ("a.png", AnimationFile::Series),
        ] {
            let animation = Animation {
                output: folder.path().join(name),
                file,
                frames: 10,
                rate: 25.0,
                course: Course::Once,
            };
            let (ask, asked) = mpsc::channel();
            let (sender, pictures) = mpsc::channel();
            let picture = DrawnPicture {
                image: image::RgbaImage::new(2, 2),
                notes: Vec::new(),
                description: Some("a picture\n".to_owned()),
            };
            sender.send(Ok(picture)).expect("it is received");
            let polls = Cell::new(0);
            let is_over = || polls.replace(polls.get() + 1) == 3;
            let text = animation
                .write_pictures([2, 2], ask, pictures, is_over)
                .expect("written");
            assert!(text.starts_with("a picture; "), "{text}");
            assert!(text.ends_with("interrupted: 1 of 10 frames\n"), "{text}");
            assert_eq!(asked.iter().collect::<Vec<_>>(), [0, 1]);
            // The second is never sent.
            drop(sender);
        }
        assert!(folder.path().join("a.gif").exists());
        assert!(folder.path().join("a-0001.png").exists());
        assert!(!folder.path().join("a-0002.png").exists());
    }
}
