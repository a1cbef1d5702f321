//! Declared geodesics in the geodesic view of their surface: the surface wears them, and all their images are seen.
//!
//! A pixel's distance to a line is measured in the chart and turned into pixels by the derivative of its end, so lines
//! are as wide as other lines wherever they are seen.

use geodesic::map::{Map, bring_back};
use geodesic::surface::Side;
use geodesic::trace::Status;
use image::RgbaImage;
use scene::geodesic::Launcher;
use scene::scene::{ObjectId, Scene, Shape};
use scene::values::Settings;

use super::{Trail, half_width, ink, stroke};
use crate::geodesic_view::Inside;
use crate::geodesics::{MAX_POINTS, Start, along};
use crate::request::Request;

/// Cells of the table along each axis.
const CELLS: usize = 256;
/// The most points of one line.
const MOST_POINTS: f64 = 4096.0;
/// The most cells that a pixel looks into; where a pixel covers more, lines are thinner than can be seen.
const MOST_CELLS: usize = 256;

/// The lines of one declared geodesic.
pub(super) struct Worn {
    pub(super) name: String,
    /// sRGB.
    pub(super) colour: [u8; 3],
    pub(super) notes: Vec<String>,
    /// Straight pieces in the chart.
    pieces: Vec<[[f64; 2]; 2]>,
}

/// All geodesics declared on a surface, of those instances that lie on the one that is seen.
pub(super) fn lines(
    scene: &Scene,
    settings: &Settings,
    request: &Request,
    inside: &Inside,
    seen: ObjectId,
) -> Vec<Worn> {
    let mut all = Vec::new();
    for (index, object) in scene.objects.iter().enumerate() {
        let Shape::Geodesic {
            surface, domain, ..
        } = &object.shape
        else {
            continue;
        };
        if *surface != seen {
            continue;
        }
        let id = ObjectId(index as u32);
        let Some(mut launcher) = Launcher::new(scene, id) else {
            continue;
        };
        let [low, high] = [domain.range.min, domain.range.max];
        // Pieces of some pixels each: then they are straight.
        let [width, height] = inside.size().map(f64::from);
        let pixel = 2.0 * inside.zoom / width.min(height).max(1.0);
        let pieces = ((high - low) / (6.0 * pixel)).ceil();
        let count = pieces.clamp(f64::from(domain.count), MOST_POINTS) as u32;
        let lengths: Vec<f64> = (0..=count)
            .map(|k| low + (high - low) * f64::from(k) / f64::from(count))
            .collect();
        let used = inside.uniforms_used(scene, seen);
        let mut worn = Worn {
            name: object.name.clone(),
            colour: request
                .colours
                .iter()
                .rev()
                .find(|(of, _)| *of == id)
                .map_or_else(
                    || crate::style::colour(&object.shape),
                    |(_, colour)| *colour,
                ),
            notes: Vec::new(),
            pieces: Vec::new(),
        };
        let instances = settings
            .instance_count(scene, object)
            .min((MAX_POINTS / u64::from(count)).max(1));
        let mut fault = None;
        for instance in 0..instances {
            let uniforms = settings.instance(scene, object, instance);
            if used
                .iter()
                .any(|&k| uniforms.get(k) != inside.uniforms.get(k))
            {
                continue;
            }
            match launcher.launch(&uniforms) {
                Ok(launch) => {
                    let start = Start::Chart(launch.start, launch.direction);
                    let knots = along(inside.ground().surface(), &start, &lengths);
                    let points: Vec<_> = knots.iter().map(|knot| knot.map(|k| k.uv)).collect();
                    worn.add(&points, inside);
                }
                Err(error) => fault = Some(error),
            }
        }
        if let Some(fault) = fault {
            let name = &worn.name;
            worn.notes.push(format!(
                "`{name}` is not drawn in all its instances: {fault}"
            ));
        }
        if !worn.pieces.is_empty() || !worn.notes.is_empty() {
            all.push(worn);
        }
    }
    all
}

/// A trail on the surface that is seen.
pub(super) fn trail(trail: &Trail, inside: &Inside) -> Worn {
    let mut worn = Worn {
        name: String::new(),
        colour: ink::TRAIL,
        notes: Vec::new(),
        pieces: Vec::new(),
    };
    let points: Vec<_> = trail.points.iter().copied().map(Some).collect();
    worn.add(&points, inside);
    worn
}

impl Worn {
    /// Takes a polyline apart; at seams a piece is continued on both sides.
    fn add(&mut self, points: &[Option<[f64; 2]>], inside: &Inside) {
        let (domain, sides) = (inside.domain(), inside.sides());
        for pair in points.windows(2) {
            let [Some(from), Some(to)] = [pair[0], pair[1]] else {
                continue;
            };
            let mut step = [to[0] - from[0], to[1] - from[1]];
            let mut turns = false;
            for k in 0..2 {
                let [low, high] = domain[k];
                let period = high - low;
                if sides.of(k)[0] == Side::Wrap {
                    step[k] -= period * (step[k] / period).round();
                }
                // Through a flip or a pole the chart turns over: what lies between is less than a step.
                turns |= step[k].abs() > 0.2 * period;
            }
            if turns {
                continue;
            }
            self.pieces
                .push([from, [from[0] + step[0], from[1] + step[1]]]);
            if [0, 1]
                .iter()
                .any(|&k| (from[k] + step[k] - to[k]).abs() > 1e-12 * step[k].abs())
            {
                self.pieces.push([[to[0] - step[0], to[1] - step[1]], to]);
            }
        }
    }

    pub(super) fn draw(&self, image: &mut RgbaImage, map: &Map, inside: &Inside) {
        let (domain, sides) = (inside.domain(), inside.sides());
        if map.by_pixel.is_empty() {
            return;
        }
        let low = [0, 1].map(|k| domain[k][0]);
        let period = domain.map(|[low, high]| high - low);
        let cell = |k: usize, x: f64| (x - low[k]) / period[k] * CELLS as f64;
        let wraps = [0, 1].map(|k| sides.of(k)[0] == Side::Wrap);
        let bounded = |k: usize, i: i64| -> Option<usize> {
            let n = CELLS as i64;
            if (0..n).contains(&i) {
                Some(i as usize)
            } else {
                wraps[k].then(|| i.rem_euclid(n) as usize)
            }
        };
        let mut table: Vec<Vec<u32>> = vec![Vec::new(); CELLS * CELLS];
        for (number, piece) in self.pieces.iter().enumerate() {
            let range = |k: usize| {
                let ends = [cell(k, piece[0][k]), cell(k, piece[1][k])];
                ends[0].min(ends[1]).floor() as i64..=ends[0].max(ends[1]).floor() as i64
            };
            for j in range(1) {
                for i in range(0) {
                    if let (Some(i), Some(j)) = (bounded(0, i), bounded(1, j)) {
                        table[j * CELLS + i].push(number as u32);
                    }
                }
            }
        }
        let most = f64::from(half_width(map.size)) + 2.5;
        stroke(image, self.colour, |index| {
            if map.status[index] != Status::Complete {
                return None;
            }
            let (uv, signs) = bring_back(domain, sides, map.uv(index));
            let d = map.by_pixel[index].map(f64::from);
            let [a, b, c, d] = [
                signs[0] * d[0],
                signs[1] * d[1],
                signs[0] * d[2],
                signs[1] * d[3],
            ];
            let determinant = a * d - b * c;
            let reach = [most * a.hypot(c), most * b.hypot(d)];
            let range = |k: usize| {
                let from = cell(k, uv[k] - reach[k]).floor() as i64;
                from..=cell(k, uv[k] + reach[k]).floor() as i64
            };
            let (across, down) = (range(0), range(1));
            let width = (across.end() - across.start() + 1).max(0) as usize;
            let height = (down.end() - down.start() + 1).max(0) as usize;
            if width.saturating_mul(height) > MOST_CELLS {
                return None;
            }
            let mut nearest = f64::INFINITY;
            for j in down {
                for i in across.clone() {
                    let (Some(i), Some(j)) = (bounded(0, i), bounded(1, j)) else {
                        continue;
                    };
                    for &number in &table[j * CELLS + i] {
                        let piece = self.pieces[number as usize];
                        let mut shift = [piece[0][0] - uv[0], piece[0][1] - uv[1]];
                        for k in 0..2 {
                            if wraps[k] {
                                shift[k] -= period[k] * (shift[k] / period[k]).round();
                            }
                        }
                        let step = [piece[1][0] - piece[0][0], piece[1][1] - piece[0][1]];
                        // From the chart to pixels: (u,v) = x (a,b) + y (c,d).
                        let pixels = |[u, v]: [f64; 2]| {
                            [(u * d - v * c) / determinant, (v * a - u * b) / determinant]
                        };
                        let (p, q) = (pixels(shift), pixels(step));
                        let square = q[0] * q[0] + q[1] * q[1];
                        let t = if square > 0.0 {
                            (-(p[0] * q[0] + p[1] * q[1]) / square).clamp(0.0, 1.0)
                        } else {
                            0.0
                        };
                        let off = (p[0] + t * q[0]).hypot(p[1] + t * q[1]);
                        if off < nearest {
                            nearest = off;
                        }
                    }
                }
            }
            (nearest < most).then_some(nearest as f32)
        });
    }
}
