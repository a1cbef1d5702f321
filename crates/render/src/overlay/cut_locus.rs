//! The cut locus: beyond it, a place of the surface that a pixel shows is nearer by another pixel's way.
//!
//! Every pixel is entered into a table over the chart, or over space on a solid, of which a cell keeps the nearest to the
//! centre. By its derivative, that pixel's part of the picture gives the distance of a place close by. A pixel that is
//! much farther away than its cell's or a neighbouring cell's entry says surely lies beyond, and with it those that are farther
//! away at all, up to the cut locus. The line is their border.

use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use geodesic::map::bring_back;
use geodesic::pixels::Map;
use geodesic::point::Uv;
use geodesic::surface::{Side, Sides};
use geodesic::trace::Status;
use glam::{DVec2, DVec3};
use image::RgbaImage;
use rayon::prelude::*;
use rustc_hash::FxHashMap;

use super::lines::{place_of, reach};
use super::measured::{duals, steps};
use super::stroke;

/// The most cells along an axis of a solid's box.
const MOST_CELLS: usize = 1024;
/// The widths of the cells of a chart's tables, as powers of two of the median step of the ends from one pixel to the next. The
/// shorter way to an end may have shorter steps around it, so it is looked up in cells as wide as the steps around the end and
/// in narrower ones: in wider cells the kept pixel may be too far away in the picture. Beyond the widest, the picture is too
/// coarse for derivatives to tell ways apart.
const LEVELS: RangeInclusive<i32> = -2..=2;
/// A pixel surely lies beyond if another way is shorter by so many pixels.
const THRESHOLD: f32 = 1.0;
/// The distance in pixels up to which an entry gives the distances of places.
const FARTHEST: f64 = 10.0;
/// The distance from the centre, in pixels, within which no other geodesic is shorter.
const NEAR: f64 = 6.0;
/// The least cosine of the angle between two ways in the picture that are taken for one.
const ALONG: f64 = 0.5;
/// The largest ratio of such a way to what its ends say of it.
const LONGER: f64 = 2.0;
/// The largest sine of the angle between a surface and a step in space from one of its places to another: a longer way out of
/// the tangent plane leads to another sheet.
const STEEP: f64 = 0.5;

/// A pixel's end, in a chart or in space.
#[derive(Clone, Copy)]
struct PixelEnd<const N: usize> {
    at: [f64; N],
    /// The offset from the picture's centre, in pixels: right, down.
    place: [f64; 2],
    /// Its length.
    distance: f64,
    /// ∂(place) by each coordinate.
    by_at: [[f64; 2]; N],
}

impl<const N: usize> PixelEnd<N> {
    /// Returns `None` if the derivatives are not finite.
    fn new(size: [u32; 2], index: usize, at: [f64; N], by_at: [[f64; 2]; N]) -> Option<Self> {
        let [column, row] = place_of(size, index);
        let place = [
            f64::from(column) + 0.5 - 0.5 * f64::from(size[0]),
            f64::from(row) + 0.5 - 0.5 * f64::from(size[1]),
        ];
        let known = by_at
            .as_flattened()
            .iter()
            .chain(&at)
            .all(|x| x.is_finite());
        known.then_some(Self {
            at,
            place,
            distance: place[0].hypot(place[1]),
            by_at,
        })
    }

    /// The way in the picture of a step of the end, to first order.
    fn way_of(&self, step: [f64; N]) -> DVec2 {
        let ways = step.iter().zip(self.by_at);
        ways.map(|(step, by)| *step * DVec2::from(by)).sum()
    }

    /// Returns the number of pixels by which another pixel's way is shorter, of which `kept` shows the end that lies a step
    /// before this one; 0 where that is not another way, or is not known.
    fn excess_over(&self, kept: &Self, step: [f64; N]) -> f32 {
        // The kept pixel, moved by this step, is where the other way shows this point.
        let off = kept.way_of(step);
        let predicted = (DVec2::from(kept.place) + off).length();
        let excess = self.distance - predicted;
        // To first order only a short step can be trusted.
        let is_other = off.length() < FARTHEST
            && excess > 0.0
            && !self.is_same_way(kept, off, self.way_of(step));
        if is_other { excess as f32 } else { 0.0 }
    }

    /// Returns true if both are ends of neighbouring geodesics, `kept_way` and `own_way` being what each of them says of the way
    /// from one to the other in the picture: both lead along that way, and not much less far.
    fn is_same_way(&self, kept: &Self, kept_way: DVec2, own_way: DVec2) -> bool {
        let way = DVec2::from(self.place) - DVec2::from(kept.place);
        let leads_there = |it: DVec2| it.dot(way) > ALONG * it.length() * way.length();
        let length = kept_way.length().max(own_way.length());
        leads_there(kept_way) && leads_there(own_way) && way.length() <= LONGER * length
    }
}

/// Notes the pixels that lie behind a conjugate point, where no geodesic is the shortest. `degeneracy` is 0 there, and has at
/// each pixel the sign of the Jacobi field.
pub(super) fn add_conjugate(excess: &mut [f32], size: [u32; 2], degeneracy: &[f32]) {
    let signs = degeneracy
        .iter()
        .enumerate()
        .filter(|(_, it)| **it != 0.0 && it.is_finite());
    let nearest = signs.min_by(|(a, _), (b, _)| reach(size, *a).total_cmp(&reach(size, *b)));
    let Some((_, first)) = nearest else { return };
    for (excess, degeneracy) in excess.iter_mut().zip(degeneracy) {
        if degeneracy * first < 0.0 {
            *excess = f32::INFINITY;
        }
    }
}

/// Draws the border of the pixels that lie beyond the cut locus; gives the share of those that show the surface. `excess` is
/// the number of pixels by which another way to a pixel's end is shorter, or 0.
pub(super) fn draw(
    image: &mut RgbaImage,
    status: &[Status],
    excess: &[f32],
    ink: ([u8; 3], f32),
) -> f64 {
    let size = [image.width(), image.height()];
    // A lone pixel is a doubt, not a border: the majority of its neighbourhood counts. What lies behind a pixel that
    // lies beyond does so too.
    let flags: Vec<f32> = excess
        .iter()
        .map(|excess| f32::from(u8::from(*excess > THRESHOLD)))
        .collect();
    let mut found: Vec<f32> = mean_around(size, &flags, status)
        .into_iter()
        .map(|share| f32::from(u8::from(share > 0.5)))
        .collect();
    let mut order: Vec<u32> = (0..found.len() as u32).collect();
    order.par_sort_by(|&a, &b| {
        let [a, b] = [a, b].map(|index| reach(size, index as usize));
        a.total_cmp(&b)
    });
    let width = size[0] as usize;
    // The pixel so many pixels farther from the centre; `None` for pixels near it.
    let farther = |index: usize, by: f64| {
        let place = place_of(size, index);
        let from_centre = [0, 1].map(|k| f64::from(place[k]) + 0.5 - 0.5 * f64::from(size[k]));
        let distance = from_centre[0].hypot(from_centre[1]);
        let [x, y] = [0, 1].map(|k| {
            let there = from_centre[k] * (1.0 + by / distance);
            ((there + 0.5 * f64::from(size[k])).max(0.0) as usize).min(size[k] as usize - 1)
        });
        (distance >= NEAR).then_some(y * width + x)
    };
    for &index in &order {
        let index = index as usize;
        if let Some(nearer) = farther(index, -1.5)
            && found[index] == 0.0
        {
            found[index] = found[nearer];
        }
    }
    // The excess vanishes on the cut locus itself, and grows slowly where the ways meet at a small angle.
    for &index in order.iter().rev() {
        let index = index as usize;
        if let Some(farther) = farther(index, 1.5)
            && excess[index] > 0.0
            && found[index] == 0.0
        {
            found[index] = found[farther];
        }
    }
    let smooth = mean_around(size, &found, status);
    stroke(image, ink, |index| {
        // The mean over five pixels grows by a fifth a pixel across a straight border.
        let distance = 5.0 * (smooth[index] - 0.5).abs();
        let seen = status[index] == Status::Complete;
        (seen && distance < 2.4).then_some(distance)
    });
    let seen = found.iter().zip(status);
    let count = seen.filter(|(share, status)| **share > 0.0 && **status == Status::Complete);
    let count = count.count();
    count as f64 / found.len().max(1) as f64
}

/// The means over those pixels of squares of 5×5 that show the surface: where it ends, it is not known what lies behind. 0 where
/// there are none.
fn mean_around(size: [u32; 2], values: &[f32], status: &[Status]) -> Vec<f32> {
    let [width, height] = size.map(|side| side as usize);
    let index = |x: isize, y: isize| {
        let x = x.clamp(0, width as isize - 1) as usize;
        let y = y.clamp(0, height as isize - 1) as usize;
        y * width + x
    };
    (0..width * height)
        .into_par_iter()
        .map(|at| {
            let (x, y) = ((at % width) as isize, (at / width) as isize);
            let around = (-2..=2).flat_map(|dy| (-2..=2).map(move |dx| (dx, dy)));
            let seen = around
                .map(|(dx, dy)| index(x + dx, y + dy))
                .filter(|&index| status[index] == Status::Complete);
            let (sum, count) = seen.fold((0.0_f32, 0_u8), |(sum, count), index| {
                (sum + values[index], count + 1)
            });
            sum / f32::from(count.max(1))
        })
        .collect()
}

/// The cells of a table along its longest axis.
fn cell_count(size: [u32; 2]) -> usize {
    MOST_CELLS.min((size[0].max(size[1]) / 2).max(8) as usize)
}

/// Returns the median of the ends' steps along an axis from one pixel to the next; `None` if there are no ends.
fn median_step(map: &Map, axis: usize) -> Option<f64> {
    let ends = map.by_pixel.iter().zip(&map.status);
    let complete = ends.filter(|(_, status)| **status == Status::Complete);
    let steps = complete.map(|(by, _)| by[0][axis].hypot(by[1][axis]));
    let mut steps: Vec<f32> = steps.filter(|step| step.is_finite()).collect();
    let middle = steps.len() / 2;
    if steps.is_empty() {
        return None;
    }
    let (_, median, _) = steps.select_nth_unstable_by(middle, f32::total_cmp);
    Some(f64::from(*median))
}

/// A table over a chart, whose cells keep the nearest of the pixels that end in them.
struct ChartTable {
    domain: [[f64; 2]; 2],
    /// The number of cells along each axis, of which a picture may show a small part.
    cells: [i64; 2],
    wraps: [bool; 2],
    nearest: FxHashMap<[i64; 2], u32>,
}

impl ChartTable {
    /// Enters pixels into cells of these widths.
    fn new(
        entries: &[Option<PixelEnd<2>>],
        (domain, sides): ([[f64; 2]; 2], Sides),
        widths: [f64; 2],
    ) -> Self {
        let count = |k: usize| {
            let [low, high] = domain[k];
            // (A conversion saturates.)
            let count = (high - low) / widths[k].max(f64::MIN_POSITIVE);
            (count as i64).clamp(1, i64::from(u32::MAX))
        };
        let mut table = Self {
            domain,
            cells: [0, 1].map(count),
            wraps: [0, 1].map(|k| sides.of(k)[0] == Side::Wrap),
            nearest: FxHashMap::default(),
        };
        let ends = entries.iter();
        table.nearest =
            nearest_by_cell(ends.map(|it| it.map(|it| (table.cell(it.at), it.distance))));
        table
    }

    fn cell(&self, uv: [f64; 2]) -> [i64; 2] {
        [0, 1].map(|k| {
            let [low, high] = self.domain[k];
            let share = (uv[k] - low) / (high - low);
            ((share * self.cells[k] as f64) as i64).min(self.cells[k] - 1)
        })
    }

    /// Returns the pixels that are kept by the cell of a point and the eight cells around it.
    fn around(&self, uv: [f64; 2]) -> impl Iterator<Item = u32> {
        let cell = self.cell(uv);
        let moved = move |k: usize, step: i64| match self.wraps[k] {
            true => (cell[k] + step).rem_euclid(self.cells[k]),
            false => cell[k] + step,
        };
        let around = (0..9).map(move |n| [moved(0, n % 3 - 1), moved(1, n / 3 - 1)]);
        around.filter_map(|cell| self.nearest.get(&cell).copied())
    }
}

/// Returns the pixel nearest to the picture's centre of each cell, from all pixels' cells and distances: only that one can be the
/// shorter way for another one.
fn nearest_by_cell<const N: usize>(
    ends: impl Iterator<Item = Option<([i64; N], f64)>>,
) -> FxHashMap<[i64; N], u32> {
    let mut nearest: FxHashMap<[i64; N], (f64, u32)> = FxHashMap::default();
    for (index, end) in (0..).zip(ends) {
        let Some((cell, distance)) = end else {
            continue;
        };
        let kept = nearest.entry(cell).or_insert((distance, index));
        if distance < kept.0 {
            *kept = (distance, index);
        }
    }
    let without_distance = |(cell, (_, index))| (cell, index);
    nearest.into_iter().map(without_distance).collect()
}

/// Returns for each pixel by how many pixels a shorter geodesic from the camera leads to its point of the surface, given by
/// its chart: beyond the cut locus there is one; elsewhere the number is 0.
///
/// Two pixels that end at one point are two ways to it, and their distances from the picture's centre are the lengths of
/// these ways. Comparing all pairs would take the square of the number of pixels. Instead each cell of a grid over the
/// chart keeps the nearest pixel that ends in it, and a pixel is compared with those of its own and the eight cells
/// around: no other can be nearer by as much as a picture shows.
pub(super) fn excess_in_chart(map: &Map, domain: [[f64; 2]; 2], sides: Sides) -> Vec<f32> {
    let size = map.size;
    let entry = |index: usize| -> Option<PixelEnd<2>> {
        if map.status[index] != Status::Complete || map.by_pixel.is_empty() {
            return None;
        }
        let (Uv(uv), signs) = bring_back(domain, sides, map.uv(index));
        let [[a, b], [c, d]] = map.by_pixel[index].map(|d| d.map(f64::from));
        let determinant = a * d - b * c;
        // (u,v) = x (a,b) + y (c,d), solved for x and y. At conjugate points the determinant is 0: neighbouring
        // geodesics meet there, and (u,v) does not determine places.
        let by_uv = [
            [d, -b].map(|x| signs[0] * x / determinant),
            [-c, a].map(|x| signs[1] * x / determinant),
        ];
        PixelEnd::new(size, index, uv, by_uv)
    };
    let entries: Vec<Option<PixelEnd<2>>> =
        (0..map.status.len()).into_par_iter().map(entry).collect();
    let [Some(du), Some(dv)] = [0, 1].map(|axis| median_step(map, axis)) else {
        return vec![0.0; map.status.len()];
    };
    let level = |index: usize| {
        let [x, y] = map.by_pixel[index];
        let step = |k: usize, median: f64| f64::from(x[k].hypot(y[k])) / median;
        let step = step(0, du).max(step(1, dv)).log2().round();
        (step as i32).clamp(*LEVELS.start(), *LEVELS.end())
    };
    let levels: Vec<i32> = (0..entries.len()).map(level).collect();
    let mut tables: BTreeMap<i32, ChartTable> = BTreeMap::new();
    for (level, _) in levels
        .iter()
        .zip(&entries)
        .filter(|(_, entry)| entry.is_some())
    {
        tables.entry(*level).or_insert_with(|| {
            let widths = [du, dv].map(|step| step * f64::from(*level).exp2());
            ChartTable::new(&entries, (domain, sides), widths)
        });
    }
    let wraps = [0, 1].map(|k| sides.of(k)[0] == Side::Wrap);
    let period = domain.map(|[low, high]| high - low);
    entries
        .par_iter()
        .zip(&levels)
        .map(|(entry, level)| {
            let Some(entry) = entry else {
                return 0.0;
            };
            // Close to the camera there is one way to each point.
            if entry.distance < NEAR {
                return 0.0;
            }
            let tables = tables.range(..=level).map(|(_, table)| table);
            let kept = tables.flat_map(|table| table.around(entry.at));
            let kept = kept.filter_map(|index| entries[index as usize].as_ref());
            let excesses = kept.map(|kept| {
                // The two ends share a cell, not a point: the step between them is taken the short way round.
                let step: [f64; 2] = std::array::from_fn(|k| {
                    let d = entry.at[k] - kept.at[k];
                    if wraps[k] {
                        d - period[k] * (d / period[k]).round()
                    } else {
                        d
                    }
                });
                entry.excess_over(kept, step)
            });
            excesses.fold(0.0, f32::max)
        })
        .collect()
}

/// Returns for each pixel whether it lies beyond the cut locus of a solid's surface, as [`excess_in_chart`] does of a
/// surface with parameters. `normals` has the unit normal at each pixel's end: sheets that lie close together have
/// others, or lie to each other's sides.
pub(super) fn excess_in_space(map: &Map<3>, normals: &[Option<DVec3>]) -> Vec<f32> {
    let size = map.size;
    let entry = |index: usize| -> Option<(PixelEnd<3>, DVec3)> {
        let normal = normals[index]?;
        let offset = map.offset[index].map(f64::from);
        let [x, y] = duals(steps(*map.by_pixel.get(index)?));
        let by_at = [0, 1, 2].map(|k| [x[k], y[k]]);
        Some((PixelEnd::new(size, index, offset, by_at)?, normal))
    };
    let entries: Vec<Option<(PixelEnd<3>, DVec3)>> =
        (0..map.status.len()).into_par_iter().map(entry).collect();
    let ends = || entries.iter().flatten().map(|(end, _)| DVec3::from(end.at));
    let Some(low) = ends().reduce(DVec3::min) else {
        return vec![0.0; map.status.len()];
    };
    let extent = ends()
        .reduce(DVec3::max)
        .map_or(DVec3::ZERO, |high| high - low);
    let side = extent.max_element() / cell_count(size) as f64;
    let cell = |at: [f64; 3]| {
        let cells = (DVec3::from(at) - low) / side;
        cells.to_array().map(|x| x.floor() as i64)
    };
    let ends_of_pixels = entries.iter().map(|it| it.as_ref());
    let table =
        nearest_by_cell(ends_of_pixels.map(|it| it.map(|(end, _)| (cell(end.at), end.distance))));
    entries
        .par_iter()
        .map(|entry| {
            let Some((end, normal)) = entry else {
                return 0.0;
            };
            if end.distance < NEAR {
                return 0.0;
            }
            let here = cell(end.at);
            let around = (0..27).map(|n| [n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1]);
            let excesses = around.into_iter().map(|by: [i64; 3]| {
                let beside = [0, 1, 2].map(|k| here[k] + by[k]);
                let kept = table
                    .get(&beside)
                    .and_then(|&k| entries[k as usize].as_ref());
                let Some((kept, other)) = kept else {
                    return 0.0;
                };
                let step = DVec3::from(end.at) - DVec3::from(kept.at);
                let is_same_sheet =
                    normal.dot(*other) > 0.0 && step.dot(*other).abs() <= STEEP * step.length();
                if is_same_sheet {
                    end.excess_over(kept, step.to_array())
                } else {
                    0.0
                }
            });
            excesses.fold(0.0, f32::max)
        })
        .collect()
}
