//! The panes' pictures: which one is drawn next, its level of detail, and the drawing itself.
//!
//! While something moves, a picture is as coarse as necessary to take only a moment; at rest it is exact. A traced
//! picture at rest is refined, sample by sample. A pane gets its next picture only after the page has shown the last
//! one.

use std::collections::BTreeMap;

use render::rendered::RenderedImage;
use render::{PictureRequest, ViewId};
use session::camera_input::{CameraKind, geodesic, space};
use session::framing::put_camera;
use session::refinement::{self, PictureDetail, PictureProgress};
use session::request::{PaneRequest, picture_request};

use super::Core;
use super::motion::FRAME;
use crate::message::{CoreEvent, Pane, PictureInfo};

/// The duration from which a picture is announced to the page, in seconds.
const LONG: f64 = 0.3;
/// The valid sides of a pane, in pixels.
const SIDES: std::ops::RangeInclusive<u32> = 16..=4096;

/// The panes on the page.
#[derive(Debug, Default)]
pub(super) struct PanePictures {
    panes: BTreeMap<ViewId, PaneState>,
    /// The surface whose camera the views in space show.
    surface: Option<String>,
    /// The number of pictures so far.
    drawn: u64,
}

/// A pane, with its last picture.
#[derive(Debug, Default)]
struct PaneState {
    room: [u32; 2],
    /// The request that was drawn last.
    request: Option<PictureRequest>,
    /// True if the page has not shown that picture yet.
    is_awaited: bool,
    /// The cost of the picture that is shown; `None` before the first.
    shown: Option<PictureDetail>,
    /// The reason why there is no picture.
    message: Option<String>,
    /// True if the page has been informed that the next picture takes long.
    is_announced: bool,
    /// The number of its last picture.
    drawn: u64,
}

/// A picture that has been drawn.
#[derive(Debug)]
pub struct DrawnPicture {
    /// Its description.
    pub info: PictureInfo,
    /// RGBA, top row first.
    pub pixels: Vec<u8>,
}

/// The result of a step.
#[derive(Debug)]
pub struct StepOutcome {
    /// The picture that it has drawn.
    pub drawn: Option<DrawnPicture>,
    /// The seconds until the next step: zero if there is more work now; `None` if only a message can change anything.
    pub next: Option<f64>,
}

impl PanePictures {
    /// Notes that the page has shown a picture.
    pub(super) fn note_shown(&mut self, id: &ViewId) {
        if let Some(pane) = self.panes.get_mut(id) {
            pane.is_awaited = false;
        }
    }

    /// Makes the views in space show the camera of another surface; `None` changes nothing.
    pub(super) fn focus(&mut self, surface: Option<String>) {
        self.surface = surface.or(self.surface.take());
    }

    /// Returns the surface whose camera the views in space show by the last [`PanePictures::focus`].
    pub(super) fn surface(&self) -> Option<String> {
        self.surface.clone()
    }

    /// Restores the value that [`PanePictures::surface`] has returned.
    pub(super) fn put_surface(&mut self, surface: Option<String>) {
        self.surface = surface;
    }

    /// Returns whether a view of an object is on the page.
    pub(super) fn has_view_of(&self, object: &str) -> bool {
        let mut views = self.panes.keys();
        views.any(|id| id.object.as_deref() == Some(object))
    }

    /// Drops all pictures, since they are of another program.
    pub(super) fn forget(&mut self) {
        self.surface = None;
        for pane in self.panes.values_mut() {
            *pane = PaneState {
                room: pane.room,
                ..PaneState::default()
            };
        }
    }

    /// Returns the request that was drawn last.
    pub(super) fn sent(&self, id: &ViewId) -> Option<&PictureRequest> {
        self.panes.get(id)?.request.as_ref()
    }

    /// Returns the shorter side of a pane in pixels; 1 if there is no pane.
    pub(super) fn side(&self, id: &ViewId) -> f64 {
        let pane = self.panes.get(id);
        pane.map_or(1.0, |pane| f64::from(pane.room[0].min(pane.room[1])))
    }

    /// Returns the position of a point in a pane relative to its centre.
    pub(super) fn way_from_middle(&self, id: &ViewId, at: [f64; 2]) -> [f64; 2] {
        let room = self.panes.get(id).map_or([0; 2], |pane| pane.room);
        [0, 1].map(|k| at[k] - 0.5 * f64::from(room[k]))
    }

    /// Returns the pixel of the last picture at a point of its pane.
    pub(super) fn pixel(&self, id: &ViewId, at: [f64; 2]) -> Option<(&PictureRequest, [f64; 2])> {
        let pane = self.panes.get(id)?;
        let request = pane.request.as_ref()?;
        let room = pane.room.map(f64::from);
        Some((
            request,
            session::camera_input::pixel(request.size, room, at),
        ))
    }
}

impl Core {
    pub(super) fn set_panes(&mut self, panes: Vec<Pane>) {
        let mut before = std::mem::take(&mut self.pictures.panes);
        // A camera that was opened with its program stays as it is in the first panes.
        let are_first = before.is_empty();
        let mut is_resized = false;
        for pane in panes {
            let id = ViewId::from(&*pane.view);
            let mut state = before.remove(&id).unwrap_or_default();
            let side = |side: u32| side.clamp(1, *SIDES.end());
            let room = [pane.width, pane.height].map(side);
            is_resized |= std::mem::replace(&mut state.room, room) != room
                && self.camera_kind(&id) == CameraKind::Space;
            self.pictures.panes.insert(id, state);
        }
        if is_resized && !are_first {
            // A camera that the reader has not moved sees everything in a pane of another shape too.
            self.model.reframe();
        }
    }

    /// Does the next piece of work: compiles a text, advances motions, draws a picture.
    pub fn step(&mut self, now: f64) -> StepOutcome {
        self.now = now;
        self.read();
        self.advance();
        self.rerun();
        let next_end = self.let_end();
        let drawn = self.draw_next();
        self.send_changes();
        let wait = |until: f64| (until - now).max(0.001);
        let has_more = match &drawn {
            Next::Drawn(_) | Next::Announced => Some(0.0),
            Next::Nothing => {
                let rest = self.moving_until().map(wait);
                let motion = self.moves_by_itself().then_some(FRAME);
                // Pictures that the page has not shown yet need no timer: a message will arrive.
                let all = [rest, motion, next_end.map(wait)];
                all.into_iter().flatten().reduce(f64::min)
            }
        };
        StepOutcome {
            drawn: match drawn {
                Next::Drawn(drawn) => Some(*drawn),
                Next::Announced | Next::Nothing => None,
            },
            next: has_more,
        }
    }

    /// Draws the pane whose picture is the oldest of those to be drawn.
    fn draw_next(&mut self) -> Next {
        let panes = self.pictures.panes.iter();
        let free = panes.filter(|(_, pane)| !pane.is_awaited);
        let mut free: Vec<(u64, ViewId)> =
            free.map(|(id, pane)| (pane.drawn, id.clone())).collect();
        free.sort();
        for (_, id) in free {
            let Some(request) = self.wanted(&id) else {
                continue;
            };
            let request = match request {
                Ok(request) => request,
                Err(message) => {
                    self.note_trouble(&id, message);
                    continue;
                }
            };
            if self.announce(&id, &request) {
                return Next::Announced;
            }
            match self.draw(&id, request) {
                Some(drawn) => return Next::Drawn(Box::new(drawn)),
                None => continue,
            }
        }
        Next::Nothing
    }

    /// Returns the next request for a pane's picture, or a sentence if there is nothing to see: see
    /// [`PictureProgress::next`].
    fn wanted(&mut self, id: &ViewId) -> Option<Result<PictureRequest, String>> {
        let Some(request) = self.request(id, self.size(id)?) else {
            return Some(Err(self.nothing(id)));
        };
        let pane = self.pictures.panes.get(id)?;
        // One thread draws all panes, so each picture effectively takes the time of all of them.
        let panes = self.pictures.panes.len() as f64;
        let progress = PictureProgress {
            sent: pane.request.as_ref(),
            shown: pane.shown.map(|shown| PictureDetail {
                rate: panes * shown.rate,
                ..shown
            }),
            is_answered: pane.message.is_none(),
            moving: self.is_moving(),
        };
        let most = self.model.choices.preferences.samples;
        progress.next(request, most).map(Ok)
    }

    /// Returns the size of a pane's picture at rest.
    pub(super) fn size(&self, id: &ViewId) -> Option<[u32; 2]> {
        let pane = self.pictures.panes.get(id)?;
        let preferences = &self.model.choices.preferences;
        Some(refinement::size_at_rest(preferences, id, pane.room))
    }

    /// Returns the request for a picture of a view at rest.
    pub(super) fn request(&mut self, id: &ViewId, size: [u32; 2]) -> Option<PictureRequest> {
        let surface = self.active_surface();
        let pane = PaneRequest {
            id,
            size,
            active: surface.as_deref(),
        };
        picture_request(&mut self.model, &mut self.library, &self.views, pane)
    }

    /// Returns the surface whose camera the views in space show: that of the last geodesic view with the focus, or else
    /// of the first.
    fn active_surface(&self) -> Option<String> {
        let panes = &self.pictures.panes;
        let mut seen = panes.keys().filter_map(|id| id.object.as_ref());
        let last = self.pictures.surface.as_ref();
        let last = last.filter(|last| seen.clone().any(|seen| seen == *last));
        last.or_else(|| seen.next()).cloned()
    }

    fn nothing(&self, id: &ViewId) -> String {
        match self.views.get(&id.kind) {
            Some(view) => view.nothing().to_owned(),
            None => format!("there is no view `{}`", id.kind),
        }
    }

    fn note_trouble(&mut self, id: &ViewId, message: String) {
        let Some(pane) = self.pictures.panes.get_mut(id) else {
            return;
        };
        if pane.message.as_ref() != Some(&message) {
            pane.message = Some(message.clone());
            let view = id.to_string();
            self.events.push(CoreEvent::NoPicture { view, message });
        }
    }

    /// Announces a slow picture to the page, once. Returns whether it had not been announced.
    fn announce(&mut self, id: &ViewId, request: &PictureRequest) -> bool {
        let Some(pane) = self.pictures.panes.get_mut(id) else {
            return false;
        };
        let [width, height] = request.size.map(f64::from);
        let shown = pane.shown;
        let is_long = shown.is_some_and(|shown| shown.rate * width * height > LONG);
        if is_long && !pane.is_announced {
            pane.is_announced = true;
            let view = Some(id.to_string());
            self.events.push(CoreEvent::Busy {
                view,
                is_busy: true,
            });
            return true;
        }
        false
    }

    /// Draws a picture. Returns `None` if it cannot be drawn, which is reported to the page.
    fn draw(&mut self, id: &ViewId, mut request: PictureRequest) -> Option<DrawnPicture> {
        let start = web_time::Instant::now();
        let at_rest = self.size(id)?;
        let drawn = self.drawn(&mut request, at_rest);
        let took = start.elapsed().as_secs_f64();
        self.pictures.drawn += 1;
        let number = self.pictures.drawn;
        let was_announced = {
            let pane = self.pictures.panes.get_mut(id)?;
            pane.drawn = number;
            std::mem::take(&mut pane.is_announced)
        };
        if was_announced {
            let view = Some(id.to_string());
            self.events.push(CoreEvent::Busy {
                view,
                is_busy: false,
            });
        }
        let (image, pixels) = match drawn {
            Ok(drawn) => drawn,
            Err(message) => {
                self.pictures.panes.get_mut(id)?.request = Some(request);
                self.note_trouble(id, message);
                return None;
            }
        };
        let [width, height] = request.size;
        let pane = self.pictures.panes.get_mut(id)?;
        pane.message = None;
        pane.is_awaited = true;
        pane.shown = Some(PictureDetail::new(request.size, took, image.samples));
        pane.request = Some(request);
        let wanted = self.model.choices.preferences.samples;
        let info = PictureInfo {
            view: id.to_string(),
            width,
            height,
            exact: pane.request.as_ref().is_some_and(|it| !it.moving),
            version: self.model.program.version,
            samples: image.samples.map(|[done, _]| [done, wanted]),
            notes: image.remarks().map(str::to_owned).collect(),
            place: self.place(id),
            took: 1e3 * took,
        };
        Some(DrawnPicture { info, pixels })
    }

    /// Draws a picture, and takes over the camera that sees everything, determined for the size `at_rest`, since the
    /// sides of a coarse picture are rounded. The request gets that camera, if the picture would be the same with it.
    fn drawn(
        &mut self,
        request: &mut PictureRequest,
        at_rest: [u32; 2],
    ) -> Result<(RenderedImage, Vec<u8>), String> {
        let sentence = |error: render::RenderError| error.to_string();
        let mut whole = request.clone();
        (whole.size, whole.magnification) = (at_rest, 1.0);
        let home = self.framing.fill_in(&mut whole).map_err(sentence)?;
        (whole.size, whole.magnification) = (request.size, request.magnification);
        let mut image = self.renderer.draw(&whole).map_err(sentence)?;
        let empty = render::gpu::Pixels::Image(image::RgbaImage::default());
        let pixels = std::mem::replace(&mut image.image, empty);
        let pixels = self.renderer.read(pixels).map_err(sentence)?.into_raw();
        if let Some(home) = home {
            // With a declared camera each picture determines it again: it may depend on params.
            if !self.model.follows_declared_camera() {
                put_camera(request, &home);
            }
            self.model.take_first_camera(home);
        }
        Ok((image, pixels))
    }

    /// Returns the position of a view's camera in words.
    fn place(&self, id: &ViewId) -> Option<String> {
        let words = match self.camera_kind(id) {
            CameraKind::Space => space::place(&self.model),
            CameraKind::Geodesic => geodesic::place(&self.model, id.object.as_deref()?),
            CameraKind::Fixed => None,
        };
        Some(words?.trim_start_matches([',', ' ']).to_owned())
    }
}

/// The result of searching for a picture to draw.
enum Next {
    Drawn(Box<DrawnPicture>),
    /// The page is informed first that a picture takes long.
    Announced,
    Nothing,
}
