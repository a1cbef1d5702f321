//! The overlays of a geodesic picture: declared geodesics and trails are drawn while it is coloured, everything else
//! that a request selects is drawn when the picture is complete.
//!
//! A camera and what it sees flow in, a picture with lines and a key flows out.

use geodesic::trace::Status;
use image::RgbaImage;

use super::measured::MeasuredEnds;
use super::{
    TextLabel, curves, cut_locus, ink::Inks, labels, legend, lines, trail_words, wave_words,
};
use crate::counters::PixelCounters;
use crate::geodesic_view::{Layer, PlacedCamera, RayEnds, UNSEEN};
use crate::point::PixelPoint;
use crate::request::PictureRequest;
use crate::trail::Trail;

/// The annotations of a geodesic picture: the key and the names of its lines, and what is measured of the ends.
pub(super) struct Annotations<'a> {
    pub(super) request: &'a PictureRequest,
    /// The colours and names of the geodesics; of further colours of one geodesic, the name is empty.
    pub(super) geodesics: Vec<([u8; 3], String)>,
    pub(super) trails: Vec<&'a Trail>,
    pub(super) notes: Vec<String>,
}

/// The overlays of the geodesic picture of a surface or a metric.
pub(crate) struct GeodesicOverlay<'a> {
    annotations: Annotations<'a>,
    camera: &'a PlacedCamera,
    counters: &'a PixelCounters,
    lines: Option<curves::Lines<'a>>,
}

impl<'a> GeodesicOverlay<'a> {
    pub(crate) fn new(
        request: &'a PictureRequest,
        camera: &'a PlacedCamera,
        counters: &'a PixelCounters,
    ) -> Self {
        let mut curve = curves::lines(request, camera);
        let geodesics = curve.iter().map(|line| (line.colour, line.name.clone()));
        let geodesics = geodesics.collect();
        let notes = curve.iter().flat_map(|line| line.notes.clone()).collect();
        let trails: Vec<&Trail> = request.trails_on(camera.surface).collect();
        curve.extend(
            trails
                .iter()
                .map(|trail| curves::trail(trail, camera, request.theme)),
        );
        Self {
            camera,
            counters,
            lines: curves::Lines::new(
                &curve,
                camera,
                request.scale,
                request.overlays.labels || trails.iter().any(|trail| trail.mark.is_some()),
                counters,
            ),
            annotations: Annotations {
                request,
                geodesics,
                trails,
                notes,
            },
        }
    }

    /// Returns the layer that is blended over the pixels.
    pub(crate) fn layer(&self) -> Option<&dyn Layer> {
        self.lines.as_ref().map(|lines| lines as &dyn Layer)
    }

    /// Draws all of it over a picture that was coloured elsewhere. Gives what a reader should know, and the names of what was
    /// drawn.
    pub(crate) fn draw(
        self,
        image: &mut RgbaImage,
        seen: &RayEnds,
    ) -> (Vec<String>, Vec<&'static str>) {
        let Annotations {
            request,
            geodesics,
            trails,
            ..
        } = &self.annotations;
        if !request.overlays.any() && geodesics.is_empty() && trails.is_empty() {
            return (Vec::new(), Vec::new());
        }
        if let Some(layer) = self.layer() {
            seen.lay(image, layer, self.counters);
        }
        self.finish(image, seen, None)
    }

    /// Draws the rest over a picture with its lines; `status` holds why the pixels' geodesics end, where that is known.
    /// Returns notes for a reader, and the names of what was drawn.
    pub(crate) fn finish(
        self,
        image: &mut RgbaImage,
        seen: &RayEnds,
        status: Option<&[Status]>,
    ) -> (Vec<String>, Vec<&'static str>) {
        let overlays = &self.annotations.request.overlays;
        let (camera, counters) = (self.camera, self.counters);
        let measured = overlays
            .any()
            .then(|| MeasuredEnds::in_chart(overlays, camera, seen, status, counters));
        let places = self.lines.as_ref().map(curves::Lines::name_places);
        let places = places.unwrap_or_default();
        self.annotations.draw(image, measured.as_ref(), &places)
    }
}

impl Annotations<'_> {
    /// Draws all of it over a picture with its lines, whose names may be at `places`. `measured` is given where any overlay is
    /// selected. Returns notes for a reader, and the names of what was drawn.
    pub(super) fn draw(
        self,
        image: &mut RgbaImage,
        measured: Option<&MeasuredEnds>,
        places: &[Option<PixelPoint>],
    ) -> (Vec<String>, Vec<&'static str>) {
        let mut drawn = Vec::new();
        let mut key = legend::Legend::new(self.request.theme);
        if !self.geodesics.is_empty() {
            drawn.push("geodesics");
            for (colour, name) in self.geodesics.iter().filter(|(_, name)| !name.is_empty()) {
                key.line(*colour, &format!("geodesic {name}"));
            }
        }
        let mut notes = Vec::new();
        if let Some(measured) = measured {
            let names;
            (notes, names) = self.measured(image, measured, &mut key);
            drawn.extend(names);
        }
        if !self.request.overlays.legend {
            // A trail is drawn with its length.
            key = legend::Legend::new(self.request.theme);
        }
        for trail in &self.trails {
            drawn.push(trail.kind.name());
            if trail.kind.has_key() {
                let colour = Inks::of(self.request.theme).trail(&trail.kind);
                key.line(colour, &trail_words(trail));
            }
        }
        let width = self.request.size[0] as usize;
        let status = measured.map_or(&[][..], |measured| &measured.status);
        let is_covered = |[x, y]: [u32; 2]| {
            let status = status.get(y as usize * width + x as usize);
            status.is_some_and(|status| *status == Status::Complete)
        };
        let unit = legend::unit(self.request);
        let place = key.place(self.request.size, unit, is_covered);
        key.draw(image, unit, place);
        if self.request.overlays.labels {
            drawn.push("labels");
        }
        labels::write(image, &self.labels(places), self.request, place);
        ([self.notes, notes].concat(), drawn)
    }

    /// Returns the words at places of the picture: the letters of figures, and with labels the names of geodesics and that of the
    /// observer.
    fn labels(&self, places: &[Option<PixelPoint>]) -> Vec<TextLabel> {
        let (geodesics, trails) = places.split_at(self.geodesics.len().min(places.len()));
        let letters = self.trails.iter().zip(trails).filter_map(|(trail, place)| {
            let letter = trail.mark?.letter;
            Some(TextLabel::beside((*place)?, letter))
        });
        let mut all: Vec<TextLabel> = letters.collect();
        if self.request.overlays.labels {
            let middle = self.request.size.map(|side| 0.5 * f64::from(side));
            all.push(TextLabel::beside(PixelPoint(middle), labels::HERE));
            let names = self.geodesics.iter().zip(geodesics);
            let names = names.filter(|((_, name), _)| !name.is_empty());
            all.extend(names.filter_map(|((_, name), place)| {
                Some(TextLabel::beside((*place)?, name.as_str()))
            }));
        }
        all
    }

    /// Draws the requested overlays that follow from the pixels' ends themselves. Returns notes for a reader, and the
    /// names of what was drawn.
    fn measured(
        &self,
        image: &mut RgbaImage,
        measured: &MeasuredEnds,
        key: &mut legend::Legend,
    ) -> (Vec<String>, Vec<&'static str>) {
        let request = self.request;
        let overlays = &request.overlays;
        let inks = Inks::of(request.theme);
        let MeasuredEnds {
            object,
            zoom,
            status,
            errors,
            excess,
            degeneracy,
        } = measured;
        let (mut notes, mut drawn) = (Vec::new(), Vec::new());
        if overlays.error {
            drawn.push("error");
            match errors {
                Some(errors) => {
                    lines::error(image, errors);
                    key.error();
                }
                None => notes.push("the error is painted only for the fan's pictures".to_owned()),
            }
        }
        if let Some(spacing) = overlays.wavefronts {
            let distance = spacing.distance(*zoom);
            let ink = (inks.wave, request.scale);
            if lines::wavefronts(image, status, *zoom, distance, ink) {
                drawn.push("wavefronts");
                key.line(inks.wave, &wave_words(distance));
            } else {
                notes.push(format!(
                    "{} are less than 3 pixels apart here: none is drawn",
                    wave_words(distance)
                ));
            }
        }
        if overlays.cut_locus {
            drawn.push("cut locus");
            let share = cut_locus::draw(image, status, excess, (inks.cut, request.scale));
            notes.push(format!(
                "{:.2} % of the pixels lie beyond the cut locus",
                100.0 * share
            ));
            if share > 0.0 {
                key.line(inks.cut, "cut locus");
            }
        }
        if overlays.conjugate_points {
            drawn.push("conjugate points");
            let ink = (inks.conjugate, request.scale);
            if lines::conjugate_points(image, degeneracy, ink) {
                key.line(inks.conjugate, "conjugate points");
            }
        }
        if overlays.legend {
            drawn.push("legend");
            if let Some(scale) = request.texture(*object).curvature_scale() {
                let surface = request.scene.get(*object);
                let name = surface.map_or("", |object| object.name.as_str());
                key.curvature(name, scale);
            }
            for unseen in UNSEEN {
                if status.contains(&unseen) {
                    key.hatching(unseen);
                }
            }
        }
        (notes, drawn)
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use scene::{ObjectId, ParamValues};

    use super::*;
    use crate::geodesic_view::Paint;
    use crate::request::ViewOptions;
    use crate::texture::{Proportions, Texture};
    use crate::viewpoint::GeodesicCamera;

    /// Overlays do not depend on the options of a view.
    #[derive(Clone, Debug, PartialEq)]
    struct AnyView;

    impl ViewOptions for AnyView {
        fn view(&self) -> &'static str {
            "any"
        }
    }

    /// The picture, its lines laid over each band of rows while it was coloured, or over the whole.
    fn drawn(source: &str, size: [u32; 2], banded: bool) -> RgbaImage {
        let scene = scene::geotrace::compile(source).scene.expect("no errors");
        let params = ParamValues::initial(&scene);
        let camera = GeodesicCamera::new(ObjectId::new(0));
        let placed = PlacedCamera::new(&scene, &params, &camera, size).expect("a camera");
        let request = PictureRequest::new(scene, params, AnyView, size);
        let texture: Arc<Texture> = Texture::orientation(Proportions::Even, false);
        let paint = Paint {
            texture: &texture,
            colour: [1.0; 3],
            domain: placed.domain(),
            sides: placed.sides(),
            mark_centre: true,
            coarse: false,
        };
        let seen = placed.ends(&|_| {});
        assert!(matches!(seen, RayEnds::Piecewise { .. }));
        let counters = PixelCounters::default();
        let over = GeodesicOverlay::new(&request, &placed, &counters);
        let layer = over.layer().expect("lines");
        if banded {
            return seen.resolve_under(&paint, Some(layer), &counters).0;
        }
        let (mut image, _) = seen.resolve(&paint);
        seen.lay(&mut image, layer, &counters);
        image
    }

    #[test]
    fn lines_laid_while_a_picture_is_coloured_are_those_laid_over_the_whole() {
        // Through the centre, where the ring is, and out of the edges, beyond which there are hatchings.
        let lines = "grid k : [0, 3, 7];
            geodesic g(t) : s = (cos k, sin k) @ (1, 0.5), t : [-3, 3];";
        let plane = "surface s(u,v) = (u, v, 0), u : [0, 2], v : [0, 1];";
        let dome = "surface s(u,v) = (u, v, 0.4 sin(3u) cos v), u : [0, 2], v : [0, 1];";
        for surface in [plane, dome] {
            for size in [[120, 90], [77, 101]] {
                let source = format!("{surface} {lines}");
                let [banded, whole] = [true, false].map(|banded| drawn(&source, size, banded));
                assert!(banded == whole, "{source} in {size:?}");
            }
        }
    }
}
