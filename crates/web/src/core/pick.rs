//! Clicks on pictures, the object at a point of a picture, and measures.

use std::sync::Arc;

use render::figure::{Figure, FigureKind};
use render::point::PixelPoint;
use render::view::Hit;
use render::{PictureRequest, ViewId};
use serde_json::{Value, json};
use session::camera_controller::Subject;
use session::clicks::ClickedObject;
use session::measuring::{PlacedFigure, Quantity};
use session::motion::Motion;
use session::questions::{MeasureAnswer, MeasureQuestion, NO_WAY_BACK};
use session::snapping::{Snapping, measured_place};
use session::{CameraPath, ChartCamera};

use super::Core;
use crate::message::{AskedFigure, Pick, QuantityRow};
use crate::source::Utf16Range;

/// An object that was picked, with the picture that shows it.
pub(super) struct PickedObject {
    pub(super) pick: Pick,
    request: PictureRequest,
    hit: Hit,
}

impl Core {
    /// Returns the range of the name in an object's declaration.
    pub(super) fn declaration(&self, name: &str) -> Option<Utf16Range> {
        let span = self.model.place_of(name)?;
        Some(self.editing.source().range(span))
    }

    /// Finds the object at a point of a pane. If it `measures`, the surface under a line is picked, and the point snaps
    /// to a declared one nearby.
    ///
    /// # Errors
    /// The sentence that says why it cannot be found.
    pub(super) fn pick(
        &mut self,
        id: &ViewId,
        at: [f64; 2],
        measures: bool,
    ) -> Result<Option<PickedObject>, String> {
        self.read();
        let Some((request, pixel)) = self.pictures.pixel(id, at) else {
            return Ok(None);
        };
        let request = request.clone();
        let pixel = PixelPoint(pixel);
        let hit = if measures {
            let (renderer, targets) = (&mut self.renderer, &mut self.targets);
            measured_place(renderer, targets, &request, pixel, Snapping::On).hit
        } else {
            let hit = self.renderer.pick(&request, pixel);
            hit.map_err(|error| error.to_string())?
        };
        let Some(hit) = hit else {
            return Ok(None);
        };
        let Some(clicked) = ClickedObject::new(&request, &hit) else {
            return Ok(None);
        };
        let object = clicked.object;
        let name = object.name.clone();
        let leaf = clicked.leaf.map(|leaf| leaf.name.as_str());
        let range = leaf.and_then(|leaf| self.declaration(leaf));
        let range = range.or_else(|| self.declaration(&name));
        let dimensions = object.shape.domain().len();
        let (rows, in_short) = self.readout(&clicked);
        let text = match in_short {
            Some(in_short) => format!("{} at {in_short}", clicked.title()),
            None => clicked.words(),
        };
        let pick = Pick {
            kind: object.shape.kind(),
            object: name,
            instance: hit.instance,
            position: hit.position.map(|place| request.scene.stated(place.0)),
            parameters: hit.parameters.into_iter().take(dimensions).collect(),
            polar: hit.polar,
            rows: rows.iter().map(QuantityRow::from).collect(),
            text,
            range,
        };
        Ok(Some(PickedObject { pick, request, hit }))
    }

    /// Returns the quantities at a point on a surface or solid, and a short form of the point.
    fn readout(&mut self, clicked: &ClickedObject<'_>) -> (Vec<Quantity>, Option<String>) {
        let camera = self.model.choices.inside.get(&clicked.object.name);
        let question = MeasureQuestion::pointer(clicked, camera);
        let answer =
            question.and_then(|question| self.measurer.answer(&clicked.subject(), &question));
        match answer {
            Some(MeasureAnswer::Pointer(rows, in_short)) => (rows, Some(in_short)),
            _ => (Vec::new(), None),
        }
    }

    /// Handles a click: places the geodesic camera of the object there, if it can have one.
    ///
    /// # Errors
    /// The sentence that says why no camera can be there.
    pub(super) fn click(&mut self, id: &ViewId, at: [f64; 2]) -> Result<Value, String> {
        let Some(PickedObject { pick, request, hit }) = self.pick(id, at, false)? else {
            return Ok(Value::Null);
        };
        // In a geodesic view a click has no effect: a drag walks there.
        let in_space = request.view.space().is_some();
        let clicked = ClickedObject::new(&request, &hit).filter(|_| in_space);
        let is_inside = |name: &str| self.pictures.has_view_of(name);
        let camera = match clicked {
            Some(clicked) => clicked.camera(&self.model, is_inside),
            None => Ok(None),
        };
        let camera = camera.map_err(|error| error.to_string())?;
        let mut placed = None;
        if let Some(camera) = camera {
            self.clicks.end(&mut self.model);
            let number = self.clicks.begin(Some(self.now), self.pictures.surface());
            self.clicks
                .place(number, &mut self.model, &pick.object, camera);
            self.pictures.focus(Some(pick.object.clone()));
            let view = self.views.iter().find(|view| view.is_of_object());
            placed = view.map(|view| ViewId::of_object(view.name(), &pick.object).to_string());
            self.note_motion();
        }
        Ok(json!({ "pick": pick, "placed": placed }))
    }

    /// Handles a double click, and withdraws its first half. Returns the object there.
    ///
    /// # Errors
    /// The sentence that says why it cannot be found.
    pub(super) fn double_click(&mut self, id: &ViewId, at: [f64; 2]) -> Result<Value, String> {
        if let Some(moved) = self.clicks.withdraw(&mut self.model) {
            self.pictures.put_surface(moved.shown);
            self.note_motion();
        }
        let found = self.pick(id, at, false)?;
        Ok(json!(found.map(|found| found.pick)))
    }

    /// Measures a figure on a surface, and shows its lines until another one, or `None`, is measured.
    ///
    /// # Errors
    /// The sentence that there is no such surface.
    pub(super) fn measure(&mut self, asked: Option<AskedFigure>) -> Result<Value, String> {
        self.read();
        let Some(asked) = asked else {
            self.model.measured = None;
            return Ok(json!({ "rows": [], "note": null, "places": [] }));
        };
        let AskedFigure {
            surface,
            kind,
            mut places,
            radius,
        } = asked;
        let none = || format!("there is no surface `{surface}`");
        let camera = self.model.choices.inside.get(&surface);
        let centre = camera.and_then(|camera| Some(camera.chart()?.at));
        let lacks_centre = kind == FigureKind::Circle && places.len() + 1 == kind.places();
        if lacks_centre && radius.is_none() {
            places.splice(0..0, centre);
        }
        let subject = self.model.subject(&surface).ok_or_else(none)?;
        let question = MeasureQuestion::Figure(PlacedFigure {
            surface: surface.clone(),
            figure: Figure {
                kind,
                places,
                radius,
            },
        });
        match self.measurer.answer(&subject, &question) {
            Some(MeasureAnswer::Figure(placed, measured)) => {
                let rows: Vec<QuantityRow> = measured.rows.iter().map(QuantityRow::from).collect();
                self.model.measured = Some((surface, measured.lines));
                let places = &placed.figure.places;
                Ok(json!({ "rows": rows, "note": measured.note, "places": places }))
            }
            _ => Err(none()),
        }
    }

    /// Measures the walk of the last used geodesic camera.
    pub(super) fn measure_walk(&mut self) -> Value {
        self.read();
        let answer = self.walked().and_then(|(subject, path, camera)| {
            let question = MeasureQuestion::walk(&path, &camera);
            self.measurer.answer(&subject, &question)
        });
        let rows: Vec<QuantityRow> = match &answer {
            Some(MeasureAnswer::Walk(rows)) => rows.iter().map(QuantityRow::from).collect(),
            _ => Vec::new(),
        };
        json!({ "rows": rows, "note": null, "places": [] })
    }

    /// Moves the last used geodesic camera back to the start of its walk, along the shortest geodesic.
    ///
    /// # Errors
    /// The sentence that there is none.
    pub(super) fn walk_back(&mut self) -> Result<Value, String> {
        self.read();
        let (subject, path, camera) = self.walked().ok_or(NO_WAY_BACK)?;
        let question = MeasureQuestion::way_back(&path, &camera);
        match self.measurer.answer(&subject, &question) {
            Some(MeasureAnswer::WayBack {
                surface,
                step: Some(step),
                ..
            }) => {
                self.model.move_camera(&surface, Motion::Walk(step));
                self.model.history.settle();
                self.note_motion();
                Ok(Value::Null)
            }
            _ => Err(NO_WAY_BACK.to_owned()),
        }
    }

    /// Returns the path of the last used geodesic camera, or else of any, with its surface and the current camera.
    fn walked(&mut self) -> Option<(Subject, Arc<CameraPath>, ChartCamera)> {
        let paths = &self.model.paths;
        let last = self.pictures.surface().filter(|it| paths.contains_key(it));
        let surface = last.or_else(|| paths.keys().next().cloned())?;
        let path = paths.get(&surface)?.clone();
        let camera = *self.model.choices.inside.get(&surface)?.chart()?;
        Some((self.model.subject(&surface)?, path, camera))
    }
}
