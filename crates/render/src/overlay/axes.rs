//! A box around the scene with ticks at round numbers.
//!
//! The box's edges that lie behind the scene and the ticks are curves in space; the numbers are written over the picture.
//! An axis whose numbers would lie over each other has fewer ticks, and its name stands beyond its numbers.

use std::sync::Arc;

use glam::DVec3;

use super::labels::{self, TextLabel};
use super::space::OverlayObject;
use super::text;
use crate::bounds::flat_axis;
use crate::camera::Camera;
use crate::point::{DrawingPoint, PixelPoint};
use crate::sample::{Painter, PositionSample, Samples};
use crate::style;

/// The greatest number of ticks that an axis has, about.
const TICKS: u32 = 5;
/// The length of a tick, in drawing units.
const TICK: f64 = 0.035;
/// The least distance of numbers from their edge, and of an axis' name, in drawing units.
const NUMBER: f64 = 0.075;
const NAME: f64 = 0.19;
/// The gap between a tick and its number, in heights of the words.
const GAP: f64 = 0.2;
/// The places along an edge at which its axis may have its name, as shares of it, the best one first.
const NAME_SHARES: [f64; 5] = [0.5, 0.35, 0.65, 0.2, 0.8];
/// The steps by which a name leaves its axis' numbers, in heights of the words, and how many of them it takes at most.
const NAME_STEP: f64 = 0.25;
const NAME_STEPS: u32 = 24;
/// Half the width of the lines, of that of curves.
const WIDTH: f32 = 0.45;
/// The least cosine of the angle between the line of sight and a flat box's axis from which on it is seen from above.
const ABOVE: f64 = 0.98;
/// The samples of each edge.
const SAMPLES: u32 = 2;
/// The names of the axes.
const NAMES: [&str; 3] = ["x", "y", "z"];

/// The box with its ticks, as the camera sees them.
pub(crate) struct AxesBox {
    /// The edges and ticks, in drawing units.
    lines: Vec<[DVec3; 2]>,
    /// The numbers, and where they are.
    numbers: Vec<(DVec3, String)>,
    names: Vec<AxisName>,
}

/// The name of an axis.
struct AxisName {
    name: &'static str,
    /// The places at which it may be, each with the place of its axis' edge beside it; the best one first.
    places: [[DVec3; 2]; NAME_SHARES.len()],
}

impl AxesBox {
    /// The box between two corners in drawing units; `names` are the axes of the text that the scene's are. An axis along which
    /// it is flat is not drawn. Words have this [height](labels::axis_height).
    pub(crate) fn new(
        camera: &Camera,
        [low, high]: [[f64; 3]; 2],
        names: [usize; 3],
        height: f32,
    ) -> Self {
        let (low, high) = (DVec3::from(low), DVec3::from(high));
        let middle = 0.5 * (low + high);
        let mut towards = match camera.parallel {
            Some(_) => camera.axes[2],
            None => camera.eye - middle,
        };
        let flat = flat_axis((high - low).to_array());
        // Seen from above, a flat box has its axes at the same sides as one without any thickness.
        if let Some(axis) = flat
            && towards[axis].abs() > ABOVE * towards.length()
        {
            towards = DVec3::AXES[axis] * towards[axis];
        }
        let mut axes = Self {
            lines: Vec::new(),
            numbers: Vec::new(),
            names: Vec::new(),
        };
        let lettering = Lettering { camera, height };
        // The coordinates of the faces behind the scene, and of those before it.
        let pick = |back: bool| {
            let end = |k: usize| {
                if (towards[k] > 0.0) == back {
                    low[k]
                } else {
                    high[k]
                }
            };
            DVec3::new(end(0), end(1), end(2))
        };
        let (behind, before) = (pick(true), pick(false));
        for axis in 0..3 {
            if high[axis] - low[axis] < 1e-6 || flat == Some(axis) {
                continue;
            }
            let [b, c] = [(axis + 1) % 3, (axis + 2) % 3];
            let edge = |at_b: f64, at_c: f64| {
                let mut ends = [low, high];
                for end in &mut ends {
                    end[b] = at_b;
                    end[c] = at_c;
                }
                ends
            };
            axes.lines.push(edge(behind[b], behind[c]));
            // The two edges of the outline, each on one face that lies behind.
            let outline = [edge(before[b], behind[c]), edge(behind[b], before[c])];
            axes.lines.extend(outline);
            let side = [b, c][Self::marked(camera, axis, b, &outline)];
            let ends = outline[usize::from(side == c)];
            let mut away = DVec3::ZERO;
            away[side] = (before[side] - middle[side]).signum();
            axes.mark(&lettering, axis, ends, away, NAMES[names[axis]]);
        }
        axes
    }

    /// Returns which edge of the outline has the ticks: of a level axis that at the foot of the box, of z the left one.
    fn marked(camera: &Camera, axis: usize, b: usize, outline: &[[DVec3; 2]; 2]) -> usize {
        if axis != 2 {
            // The edge that lies on the face behind along z is that where the other coordinate is before.
            return usize::from(b == 2);
        }
        let left = |edge: &[DVec3; 2]| {
            let place = 0.5 * (edge[0] + edge[1]);
            (place - camera.eye).dot(camera.axes[0])
        };
        usize::from(left(&outline[1]) < left(&outline[0]))
    }

    /// Adds the ticks of an axis along an edge, which point `away` from the box, with their numbers and the axis' name.
    fn mark(
        &mut self,
        lettering: &Lettering<'_>,
        axis: usize,
        ends: [DVec3; 2],
        away: DVec3,
        name: &'static str,
    ) {
        let placement = lettering.camera.placement;
        let world = |place: DVec3| placement.centre[axis] + place[axis] * placement.radius;
        let interval = ends.map(world);
        let marked = |count: u32| -> Vec<(DVec3, String)> {
            let place = |tick: Tick| {
                let mut at = ends[0];
                at[axis] = (tick.value - placement.centre[axis]) / placement.radius;
                (at, tick.words)
            };
            ticks(interval, count).into_iter().map(place).collect()
        };
        let numbered = |marks: &[(DVec3, String)]| -> Vec<(DVec3, String)> {
            let number =
                |(at, words): &(DVec3, String)| (lettering.number(*at, away, words), words.clone());
            marks.iter().map(number).collect()
        };
        let mut marks = marked(TICKS);
        let mut numbers = numbered(&marks);
        for count in (1..TICKS).rev() {
            if !lettering.overlap(&numbers) {
                break;
            }
            let fewer = marked(count);
            // No scale can be read off a single number.
            if fewer.len() > 1 {
                numbers = numbered(&fewer);
                marks = fewer;
            }
        }
        let lines = marks.iter().map(|(at, _)| [*at, *at + away * TICK]);
        self.lines.extend(lines);
        let places = NAME_SHARES.map(|share| {
            let at = ends[0].lerp(ends[1], share);
            [lettering.name(at, away, name, &numbers), at]
        });
        self.names.push(AxisName { name, places });
        self.numbers.extend(numbers);
    }

    /// The lines as an object of the picture; `colour` is linear light.
    pub(crate) fn object(&self, colour: [f32; 3]) -> OverlayObject {
        let sample = |place: &DVec3| PositionSample {
            position: place.as_vec3().to_array(),
            defined: 1.0,
        };
        OverlayObject {
            name: "axes",
            painter: Painter::Curves,
            samples: Arc::new(Samples::Curves {
                count: SAMPLES,
                samples: self.lines.iter().flatten().map(sample).collect(),
            }),
            colour,
            line: style::LineStyle {
                width: WIDTH,
                lift: 0.0,
            },
            letter: None,
        }
    }

    /// Returns the places that a camera must see so that it sees all of it, in drawing units: the ends of the lines, and
    /// the corners of the words, which have this height.
    pub(crate) fn extent(&self, camera: &Camera, height: f32) -> Vec<DVec3> {
        let lettering = Lettering { camera, height };
        let numbers = self.numbers.iter();
        let numbers = numbers.map(|(place, words)| (*place, words.as_str()));
        let names = self.names.iter();
        let names = names.map(|it| (it.places[0][0], it.name));
        let corners = |(place, words): (DVec3, &str)| {
            let [x, y] = lettering.size(words).map(|side| 0.5 * side);
            [[x, y], [x, -y], [-x, y], [-x, -y]].map(|by| lettering.shifted(place, by))
        };
        let ends = self.lines.iter().flatten().copied();
        ends.chain(numbers.chain(names).flat_map(corners)).collect()
    }

    /// The names and the numbers in this height, where the camera sees them. A name is moved into the picture where its edge is
    /// in it.
    pub(crate) fn labels(&self, camera: &Camera, height: f32) -> Vec<TextLabel> {
        let lettering = Lettering { camera, height };
        let pixel = |place: DVec3| camera.pixel_of(DrawingPoint(place.to_array()));
        let names = self.names.iter().filter_map(|AxisName { name, places }| {
            let half = lettering.size(name).map(|side| 0.5 * side + 1.0);
            let inside = |place: PixelPoint, margin: [f64; 2]| {
                PixelPoint([0, 1].map(|k| {
                    let side = f64::from(camera.size[k]);
                    let margin = margin[k].min(0.5 * side);
                    place.0[k].clamp(margin, side - margin)
                }))
            };
            let moved = |[place, edge]: &[DVec3; 2]| {
                let edge = pixel(*edge)?;
                let is_seen = inside(edge, [0.0; 2]) == edge;
                if !is_seen {
                    return None;
                }
                Some(inside(pixel(*place)?, half))
            };
            let mut places = places.iter().filter_map(moved);
            let label = TextLabel::centred(places.next()?, (*name).to_owned());
            Some(label.or_at(places.collect()))
        });
        let numbers = self.numbers.iter().filter_map(|(place, words)| {
            let at = pixel(*place)?;
            Some(TextLabel::centred(at, words.clone()))
        });
        names.chain(numbers).collect()
    }
}

/// The words of a picture's axes: how large they are, and where they have room.
struct Lettering<'a> {
    camera: &'a Camera,
    /// The height of the words in pixels.
    height: f32,
}

impl Lettering<'_> {
    /// Returns the width and height of words in pixels.
    fn size(&self, words: &str) -> [f64; 2] {
        [text::width(words, self.height), self.height].map(f64::from)
    }

    /// Returns a place so many pixels to the right and up, as far from the eye.
    fn shifted(&self, place: DVec3, [across, along]: [f64; 2]) -> DVec3 {
        let [right, up, _] = self.camera.axes;
        let pixel = self.depth(place) / f64::from(self.camera.pixels_per_unit());
        place + pixel * (across * right + along * up)
    }

    /// Returns the distance at which a place is seen.
    fn depth(&self, place: DVec3) -> f64 {
        let distance = (self.camera.eye - place).dot(self.camera.axes[2]);
        self.camera.parallel.map_or(distance, |it| it.distance)
    }

    /// Returns the way in the picture, to the right and up in pixels, of a step by one drawing unit from a place.
    fn way(&self, place: DVec3, step: DVec3) -> [f64; 2] {
        let [right, up, back] = self.camera.axes;
        let depth = self.depth(place);
        let nearer = match self.camera.parallel {
            Some(_) => 0.0,
            None => step.dot(back) / depth,
        };
        let scale = f64::from(self.camera.pixels_per_unit()) / depth;
        [right, up].map(|axis| {
            let off = (place - self.camera.eye).dot(axis);
            scale * (step.dot(axis) + off * nearer)
        })
    }

    /// Returns the place of a number beside a place of an edge whose tick points `away`: clear of the tick.
    fn number(&self, at: DVec3, away: DVec3, words: &str) -> DVec3 {
        let end = at + away * TICK;
        let [x, y] = self.way(end, away);
        let length = x.hypot(y);
        // A tick that points to the eye has its number below it.
        let direction = match length > 1e-9 {
            true => [x, y].map(|part| part / length),
            false => [0.0, -1.0],
        };
        // The way from the middle of the words to their border.
        let size = self.size(words);
        let [across, along] = [0, 1].map(|k| 0.5 * size[k] / direction[k].abs());
        let least = across.min(along) + GAP * f64::from(self.height);
        match (NUMBER - TICK) * length >= least {
            true => at + away * NUMBER,
            false => self.shifted(end, direction.map(|part| part * least)),
        }
    }

    /// Returns the place of an axis' name beside a place of its edge, beyond its numbers.
    fn name(&self, at: DVec3, away: DVec3, name: &str, numbers: &[(DVec3, String)]) -> DVec3 {
        let [x, y] = self.way(at, away);
        let length = x.hypot(y).max(1e-9);
        let step = [x, y].map(|part| part / length * NAME_STEP * f64::from(self.height));
        let taken: Vec<[f32; 4]> = numbers
            .iter()
            .filter_map(|(place, words)| self.room(*place, words))
            .collect();
        let nearest = at + away * NAME;
        let steps = (0..NAME_STEPS).map(|k| {
            let by = step.map(|part| part * f64::from(k));
            self.shifted(nearest, by)
        });
        let is_free = |place: &DVec3| {
            let room = self.room(*place, name);
            room.is_some_and(|room| !taken.iter().any(|other| labels::overlap(&room, other)))
        };
        steps.clone().find(is_free).unwrap_or(nearest)
    }

    /// Returns whether any of an axis' numbers lies over the next one.
    fn overlap(&self, numbers: &[(DVec3, String)]) -> bool {
        numbers.windows(2).any(|pair| {
            let [a, b] = [0, 1].map(|k| self.room(pair[k].0, &pair[k].1));
            a.zip(b).is_some_and(|(a, b)| labels::overlap(&a, &b))
        })
    }

    /// Returns the part of the picture that words at a place take, with a gap beside them.
    fn room(&self, place: DVec3, words: &str) -> Option<[f32; 4]> {
        let PixelPoint([x, y]) = self.camera.pixel_of(DrawingPoint(place.to_array()))?;
        let [x, y] = [x, y].map(|part| part as f32);
        let half = [0.5 * text::width(words, self.height), 0.5 * self.height];
        let corners = [x - half[0], y - half[1], x + half[0], y + half[1]];
        Some(labels::with_gap(corners, self.height))
    }
}

/// A tick of an axis.
#[derive(Clone, Debug, PartialEq)]
struct Tick {
    value: f64,
    words: String,
}

/// The round numbers in an interval, about so many of them, equally far apart, with as many digits as tell them apart.
fn ticks([low, high]: [f64; 2], count: u32) -> Vec<Tick> {
    let rough = (high - low) / f64::from(count);
    if !(rough > 0.0 && rough.is_finite()) {
        return Vec::new();
    }
    let unit = 10_f64.powf(rough.log10().floor());
    let round = [1.0, 2.0, 5.0, 10.0].map(|n| n * unit);
    let nearest = |a: &&f64, b: &&f64| (*a / rough).ln().abs().total_cmp(&(*b / rough).ln().abs());
    let step = *round.iter().min_by(nearest).unwrap_or(&unit);
    // Numbers that doubles cannot tell apart have no ticks.
    let most = low.abs().max(high.abs());
    if step < 1e-12 * most {
        return Vec::new();
    }
    let slack = 1e-9 * step;
    let first = ((low - slack) / step).ceil();
    let steps = ((high + slack) / step - first).floor().max(0.0);
    let decimals = (-step.log10()).ceil().max(0.0);
    let is_long = !(1e-4..1e6).contains(&most);
    // The digits between the first one of the greatest number and that of a step.
    let place = |x: f64| (x.log10() + 1e-9).floor();
    let digits = (place(most) - place(step)).max(1.0) as usize;
    // All numbers have the exponent of the greatest one.
    let exponent = place(most);
    let unit_of_words = 10_f64.powf(exponent);
    (0..=steps as u32)
        .map(|k| {
            let value = (first + f64::from(k)) * step;
            let words = match (value == 0.0, is_long) {
                (true, _) => "0".to_owned(),
                (false, true) => format!("{:.digits$}e{exponent}", value / unit_of_words),
                (false, false) => format!("{value:.0$}", decimals as usize),
            };
            Tick {
                value,
                words: words.replace('-', "\u{2212}"),
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use scene::ParamValues;

    use super::super::labels::{axis_height, overlap, placed};
    use super::{AxesBox, NAMES, TICKS, ticks};
    use crate::bounds::Bounds;
    use crate::camera::Camera;
    use crate::framing::first_camera;
    use crate::request::{PictureRequest, part::SpaceOptions};
    use crate::view::space;
    use crate::viewpoint::Viewpoint;

    const TORUS: &str =
        "surface s(u, v) = ((1 + 0.4 cos v) cos u, (1 + 0.4 cos v) sin u, 0.4 sin v),
        u : [0, 2 pi], v : [0, 2 pi];";
    const HELICOID: &str = "surface s(u, v) = (v cos u, v sin u, u), u : [-3, 3], v : [-2, 2];";

    fn words(interval: [f64; 2]) -> Vec<String> {
        ticks(interval, TICKS)
            .into_iter()
            .map(|tick| tick.words)
            .collect()
    }

    #[test]
    fn ticks_are_round_numbers_with_as_many_digits_as_they_need() {
        assert_eq!(words([-1.0, 1.0]), ["−1.0", "−0.5", "0", "0.5", "1.0"]);
        assert_eq!(words([0.0, 10.0]), ["0", "2", "4", "6", "8", "10"]);
        assert_eq!(
            words([0.03, 0.071]),
            ["0.03", "0.04", "0.05", "0.06", "0.07"]
        );
        assert_eq!(
            words([2e7, 6e7]),
            ["2.0e7", "3.0e7", "4.0e7", "5.0e7", "6.0e7"]
        );
        assert_eq!(
            words([1e6, 1e6 + 10.0])[..3],
            ["1.000000e6", "1.000002e6", "1.000004e6"]
        );
        assert_eq!(words([0.0, 2e-5])[..2], ["0", "0.5e−5"]);
        let near = words([999_999.5, 1e6]);
        assert_eq!(near[near.len() - 2..], ["0.9999999e6", "1.0000000e6"]);
        assert_eq!(words([3.0, 3.0]), [""; 0]);
        assert_eq!(
            words([1e20, 1e20 + 1e5]),
            [""; 0],
            "doubles do not tell these apart"
        );
        assert_eq!(words([f64::NAN, 1.0]), [""; 0]);
    }

    /// The words of the axes in a picture of a size, each with its left, top, right and bottom end.
    fn lettered(text: &str, size: [u32; 2], eye: Option<[f64; 3]>) -> Vec<(String, [f32; 4])> {
        let scene = scene::geotrace::compile(text).scene.expect("no errors");
        let params = ParamValues::initial(&scene);
        let mut request = PictureRequest::new(scene, params, SpaceOptions::default(), size);
        request.overlays.axes = true;
        let viewpoint = match eye {
            Some(eye) => Viewpoint::new(eye, [0.0; 3]),
            None => Viewpoint::default(),
        };
        let bounds = space::bounds(&request);
        let camera = first_camera(&bounds, &viewpoint, &request).expect("a camera");
        let corners = [bounds.half.map(|half| -half), bounds.half];
        let height = axis_height(&request);
        let axes = AxesBox::new(&camera, corners, [0, 1, 2], height);
        let labels = axes.labels(&camera, height);
        let words = placed(&labels, &request, None).into_iter().map(|it| {
            let [left, top] = it.corner;
            (it.words, [left, top, left + it.width, top + it.height])
        });
        words.collect()
    }

    #[test]
    fn axes_have_names_and_numbers_apart_from_each_other_in_small_pictures() {
        let far = [None, Some([14.0, 8.0, 6.0])];
        for (text, eye) in [TORUS, HELICOID]
            .into_iter()
            .flat_map(|text| far.map(|eye| (text, eye)))
        {
            for size in [[200, 150], [300, 600], [640, 480], [120, 90]] {
                let words = lettered(text, size, eye);
                let case = format!("{text} in {size:?} from {eye:?}: {words:?}");
                for name in ["x", "y", "z"] {
                    assert!(
                        words.iter().any(|(word, _)| word == name),
                        "{name} of {case}"
                    );
                }
                assert!(words.len() > 3, "no number of {case}");
                for (k, (_, place)) in words.iter().enumerate() {
                    let [left, top, right, bottom] = *place;
                    assert!(left >= 0.0 && top >= 0.0, "{case}");
                    assert!(
                        right <= size[0] as f32 && bottom <= size[1] as f32,
                        "{case}"
                    );
                    // Two pixels between words tell them apart.
                    let wider = [left - 2.0, top, right + 2.0, bottom];
                    let others = &words[k + 1..];
                    assert!(
                        !others.iter().any(|(_, other)| overlap(&wider, other)),
                        "{case}"
                    );
                }
            }
        }
    }

    #[test]
    fn a_figure_that_is_nearly_flat_has_two_axes_and_is_seen_from_above() {
        let plane = "surface s(u, v) = (u, v, 0), u : [0, 4], v : [0, 3];";
        let above = "curve c(t) = (t, 1, 0.01), t : [0, 4];";
        let names = |text: &str| {
            let words = lettered(text, [400, 300], None).into_iter();
            let names = words.filter(|(word, _)| NAMES.contains(&&**word));
            names.map(|(word, _)| word).collect::<Vec<_>>()
        };
        assert_eq!(names(&format!("{plane} {above}")), ["x", "y"]);
        let thick = above.replace("0.01", "0.1");
        assert_eq!(names(&format!("{plane} {thick}")).len(), 3);
        let scene = scene::geotrace::compile(&format!("{plane} {above}"))
            .scene
            .expect("no errors");
        let bounds = Bounds::of(&scene, &ParamValues::initial(&scene));
        let camera = Camera::new(&bounds, &Viewpoint::default(), [400, 300]).expect("a camera");
        assert_eq!(camera.axes[2], DVec3::Z);
    }

    #[test]
    fn a_name_is_moved_into_the_picture_that_its_edge_is_in() {
        // The foot of the box is in the picture, and the places beyond its numbers are not.
        let words = lettered(TORUS, [300, 200], Some([3.6, 1.44, 0.72]));
        for name in ["x", "y"] {
            assert!(
                words.iter().any(|(word, _)| word == name),
                "{name} of {words:?}"
            );
        }
    }
}
