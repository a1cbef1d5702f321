//! The state of the render thread. In: a request. Out: an event.

use std::collections::BTreeMap;
use std::time::{Duration, Instant};

use render::counters::WorkCounters;
use render::gpu::Pixels;
use render::point::PixelPoint;
use render::rendered::RenderedImage;
use render::view::Interrupt;
use render::{PictureRequest, RenderError, Renderer, ViewId};
use session::SpaceCamera;
use session::framing::Framing;
use session::snapping::{MeasuredPlace, SnapTargets, measured_place};

use super::{Purpose, RenderEvent, VersionedRequest};

/// The state of the render thread between two pictures.
pub(super) struct Worker {
    renderer: Renderer,
    /// Determines whether a slow picture is to be abandoned.
    interrupt: Interrupt,
    /// True if the renderer draws on the window's own GPU.
    shares_gpu: bool,
    framing: Framing,
    /// The time that the last picture of each pane took.
    took: BTreeMap<ViewId, Duration>,
    /// The points to which clicks snap.
    targets: Option<SnapTargets>,
}

impl Worker {
    /// Returns a worker that draws with a renderer. If that is on the window's own GPU, pictures stay there.
    pub(super) fn new(renderer: Renderer, interrupt: Interrupt) -> Self {
        Self {
            shares_gpu: renderer.gpu().is_some(),
            renderer: renderer.with_interrupt(interrupt.clone()),
            interrupt,
            framing: Framing::default(),
            took: BTreeMap::new(),
            targets: None,
        }
    }

    /// Switches to another renderer.
    pub(super) fn move_to(&mut self, renderer: Renderer) {
        self.shares_gpu = renderer.gpu().is_some();
        self.renderer = renderer.with_interrupt(self.interrupt.clone());
    }

    /// Switches to the processor, which is never lost.
    pub(super) fn leave_gpu(&mut self) {
        let views = self.renderer.views().clone();
        self.move_to(Renderer::software().with_views(views));
    }

    /// Returns the time that the last picture of a pane took.
    pub(super) fn took(&self, pane: &ViewId) -> Option<Duration> {
        self.took.get(pane).copied()
    }

    /// Returns the renderer's counters.
    pub(super) fn counters(&self) -> WorkCounters {
        self.renderer.counters()
    }

    /// Draws a pane's picture. Returns `None` if it was abandoned for something newer.
    pub(super) fn draw(
        &mut self,
        pane: &ViewId,
        request: &VersionedRequest,
    ) -> Option<RenderEvent> {
        let start = Instant::now();
        let mut drawn = self.picture(&request.picture, start);
        if drawn.is_err() && self.renderer.is_lost() {
            self.leave_gpu();
            drawn = self.picture(&request.picture, start);
        }
        if matches!(drawn, Err(RenderError::Interrupted)) {
            return None;
        }
        self.took.insert(pane.clone(), start.elapsed());
        let (picture, space_camera) = match drawn {
            Ok((picture, camera)) => (Ok(Box::new(picture)), camera),
            Err(error) => (Err(error.to_string()), None),
        };
        Some(RenderEvent::Drawn {
            pane: pane.clone(),
            picture,
            space_camera,
            request: Box::new(request.clone()),
            counters: self.renderer.counters(),
        })
    }

    /// Finds the object at a pixel.
    pub(super) fn pick(
        &mut self,
        request: &PictureRequest,
        at: [f64; 2],
        purpose: Purpose,
    ) -> RenderEvent {
        let at = PixelPoint(at);
        let place = match purpose.snapping() {
            Some(snapping) => {
                let (renderer, targets) = (&mut self.renderer, &mut self.targets);
                measured_place(renderer, targets, request, at, snapping)
            }
            None => MeasuredPlace {
                hit: self.renderer.pick(request, at).ok().flatten(),
                snapped: None,
            },
        };
        RenderEvent::Picked {
            request: Box::new(request.clone()),
            hit: place.hit,
            snapped: place.snapped.map(|at| at.0),
            purpose,
        }
    }

    /// Finds the camera that sees everything; the next pictures are drawn in the bounds of their scene.
    pub(super) fn frame(&mut self, request: &PictureRequest) -> Option<SpaceCamera> {
        let camera = self.framing.of_everything(request)?;
        self.renderer.set_bounds(None);
        Some(camera)
    }

    /// Begins with another program: its pictures are drawn in its own bounds.
    pub(super) fn begin_program(&mut self) {
        self.renderer.set_bounds(None);
    }

    /// Draws a picture. Returns it with the camera that sees everything, if the request specifies none.
    fn picture(
        &mut self,
        request: &PictureRequest,
        start: Instant,
    ) -> Result<(RenderedImage, Option<SpaceCamera>), RenderError> {
        let mut request = request.clone();
        let home = self.framing.fill_in(&mut request)?;
        let mut drawn = self.renderer.draw(&request)?;
        let pixels = match drawn.image {
            Pixels::Texture(canvas) if self.shares_gpu => Pixels::Texture(canvas),
            pixels => Pixels::Image(self.renderer.read(pixels)?),
        };
        drawn.image = pixels;
        drawn.took = start.elapsed();
        Ok((drawn, home))
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use render::request::part::SpaceOptions;
    use scene::ParamValues;
    use session::reader::{Reader, SourceText};

    use super::*;

    /// The bytes of a picture of a program, seen from one place.
    fn drawn(worker: &mut Worker, text: &str) -> Vec<u8> {
        let languages = ide::Languages::standard();
        let read = Reader::default().read(&SourceText {
            language: languages.default_language().as_ref(),
            text,
            changes: None,
        });
        let scene = read.program.scene.expect("a scene");
        let options = SpaceOptions::seen_from([3.0, -4.0, 3.0], [0.0; 3]);
        let params = Arc::new(ParamValues::initial(&scene));
        let request = VersionedRequest {
            picture: PictureRequest::new(&scene, params, options, [160, 120]),
            version: 1,
        };
        let pane = ViewId::of_scene("3d");
        match worker.draw(&pane, &request) {
            Some(RenderEvent::Drawn {
                picture: Ok(picture),
                ..
            }) => match picture.image {
                Pixels::Image(image) => image.into_raw(),
                Pixels::Texture(_) => panic!("in memory"),
            },
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn another_program_is_drawn_in_its_own_bounds() {
        let never = Interrupt::new(|| false);
        let worker = || Worker::new(Renderer::software(), never.clone());
        let (wide, narrow) = (
            "point p = (2, 2, 2); point q = -p;",
            "point p = (1.2, 1.2, 1.2); point q = -p;",
        );
        let mut one = worker();
        drawn(&mut one, wide);
        let edited = drawn(&mut one, narrow);
        one.begin_program();
        let opened = drawn(&mut one, narrow);
        assert!(opened == drawn(&mut worker(), narrow));
        assert!(opened != edited, "an edit keeps the size of a point");
    }
}
