//! A box around the scene with ticks at round numbers.
//!
//! The box's edges that lie behind the scene and the ticks are curves in space; the numbers are written over the picture.

use std::sync::Arc;

use glam::DVec3;

use super::labels::{self, TextLabel};
use super::space::OverlayObject;
use super::text;
use crate::camera::Camera;
use crate::point::DrawingPoint;
use crate::sample::{Painter, PositionSample, Samples};
use crate::style;

/// The number of ticks that an axis has, about.
const TICKS: f64 = 5.0;
/// The length of a tick, in drawing units.
const TICK: f64 = 0.035;
/// The distance of numbers from their edge, and of an axis' name, in drawing units.
const NUMBER: f64 = 0.075;
const NAME: f64 = 0.19;
/// Half the width of the lines, of that of curves.
const WIDTH: f32 = 0.45;
/// The samples of each edge.
const SAMPLES: u32 = 2;
/// The names of the axes.
const NAMES: [&str; 3] = ["x", "y", "z"];

/// The box with its ticks, as the camera sees them.
pub(crate) struct AxesBox {
    /// The edges and ticks, in drawing units.
    lines: Vec<[DVec3; 2]>,
    /// The numbers and the names of the axes, and where they are.
    words: Vec<(DVec3, String)>,
}

impl AxesBox {
    /// The box between two corners in drawing units; `names` are the axes of the text that the scene's are. An axis along which
    /// it has no extent has no ticks.
    pub(crate) fn new(camera: &Camera, [low, high]: [[f64; 3]; 2], names: [usize; 3]) -> Self {
        let (low, high) = (DVec3::from(low), DVec3::from(high));
        let middle = 0.5 * (low + high);
        let towards = match camera.parallel {
            Some(_) => camera.axes[2],
            None => camera.eye - middle,
        };
        let mut axes = Self {
            lines: Vec::new(),
            words: Vec::new(),
        };
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
            if high[axis] - low[axis] < 1e-6 {
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
            let outwards = (before[side] - middle[side]).signum();
            let away = axes.mark(camera, axis, ends, side, outwards);
            let at = 0.5 * (ends[0] + ends[1]) + away * NAME;
            axes.words.push((at, NAMES[names[axis]].to_owned()));
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

    /// Adds the ticks of an axis along an edge, with their numbers; returns the direction in which they point.
    fn mark(
        &mut self,
        camera: &Camera,
        axis: usize,
        ends: [DVec3; 2],
        side: usize,
        outwards: f64,
    ) -> DVec3 {
        let placement = camera.placement;
        let world = |place: f64| placement.centre[axis] + place * placement.radius;
        let mut away = DVec3::ZERO;
        away[side] = outwards;
        for tick in ticks([world(ends[0][axis]), world(ends[1][axis])]) {
            let mut at = ends[0];
            at[axis] = (tick.value - placement.centre[axis]) / placement.radius;
            self.lines.push([at, at + away * TICK]);
            self.words.push((at + away * NUMBER, tick.words));
        }
        away
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
    /// the corners of the words, which are `scale` times as large as usual.
    pub(crate) fn extent(&self, camera: &Camera, scale: f32) -> Vec<DVec3> {
        let height = labels::axis_height(camera.size, scale);
        let [right, up, back] = camera.axes;
        let corners = |(place, words): &(DVec3, String)| {
            let distance = (camera.eye - *place).dot(back);
            let distance = camera.parallel.map_or(distance, |it| it.distance);
            let pixel = distance / f64::from(camera.pixels_per_unit());
            let across = right * (0.5 * pixel * f64::from(text::width(words, height)));
            let along = up * (0.5 * pixel * f64::from(height));
            [
                across + along,
                across - along,
                along - across,
                -across - along,
            ]
            .map(|by| *place + by)
        };
        let ends = self.lines.iter().flatten().copied();
        ends.chain(self.words.iter().flat_map(corners)).collect()
    }

    /// The numbers and names, where the camera sees them.
    pub(crate) fn labels(&self, camera: &Camera) -> Vec<TextLabel> {
        let words = self.words.iter().filter_map(|(place, words)| {
            let at = camera.pixel_of(DrawingPoint(place.to_array()))?;
            Some(TextLabel::centred(at, words.clone()))
        });
        words.collect()
    }
}

/// A tick of an axis.
#[derive(Clone, Debug, PartialEq)]
struct Tick {
    value: f64,
    words: String,
}

/// The round numbers in an interval, about [`TICKS`] of them, equally far apart, with as many digits as tell them apart.
fn ticks([low, high]: [f64; 2]) -> Vec<Tick> {
    let rough = (high - low) / TICKS;
    if !(rough > 0.0 && rough.is_finite()) {
        return Vec::new();
    }
    let unit = 10_f64.powf(rough.log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0].map(|n| n * unit);
    let nearest = |a: &&f64, b: &&f64| (*a / rough).ln().abs().total_cmp(&(*b / rough).ln().abs());
    let step = *steps.iter().min_by(nearest).unwrap_or(&unit);
    // Numbers that doubles cannot tell apart have no ticks.
    let most = low.abs().max(high.abs());
    if step < 1e-12 * most {
        return Vec::new();
    }
    let slack = 1e-9 * step;
    let first = ((low - slack) / step).ceil();
    let count = ((high + slack) / step - first).floor().max(0.0);
    let decimals = (-step.log10()).ceil().max(0.0);
    let is_long = !(1e-4..1e6).contains(&most);
    (0..=count as u32)
        .map(|k| {
            let value = (first + f64::from(k)) * step;
            let words = match (value == 0.0, is_long) {
                (true, _) => "0".to_owned(),
                (false, true) => format!("{value:.1e}"),
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
    use super::ticks;

    fn words(interval: [f64; 2]) -> Vec<String> {
        ticks(interval).into_iter().map(|tick| tick.words).collect()
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
        assert_eq!(words([3.0, 3.0]), [""; 0]);
        assert_eq!(
            words([1e20, 1e20 + 1e5]),
            [""; 0],
            "doubles do not tell these apart"
        );
        assert_eq!(words([f64::NAN, 1.0]), [""; 0]);
    }
}
