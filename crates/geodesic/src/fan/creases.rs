//! Creases between two rays: the arc lengths at which their points in between do not follow from both.
//!
//! In: two rays with the creases that they have passed. Out: ranges of arc length. Between two rays that have passed the same
//! creases all points have passed them too if no other crease is between the rays. Intervals prove that part by part: a part
//! is a box of the chart that contains everything between the rays from one arc length to another.

use std::cell::Cell;

use expr::interval::Interval;

use super::cell;
use super::ray::{CreasePassage, Ray};
use crate::chart::ChartLayout;
use crate::surface::Surface;

/// The maximum number of parts that are examined between two rays.
const MOST_PARTS: u32 = 192;
/// Parts are not divided further if they are shorter and narrower than this, in pixels.
const LEAST_PART: f64 = 1.0;
/// A part that is not proven belongs to the crease next to it if it is at most this far from it, in pixels: a crease may bulge
/// between two rays.
const BESIDE: f64 = 4.0;

/// Returns true if the points between two rays do not follow from both at an arc length, because they have not passed the
/// same creases, or are just passing one.
#[inline(always)]
pub(super) fn is_hidden(rays: [&Ray; 2], s: f64) -> bool {
    let [a, b] = rays.map(|ray| ray.passages.as_slice());
    !(a.is_empty() && b.is_empty()) && gaps(a, b).any(|[from, to]| from < s && s < to)
}

/// Returns the arc length at which the first of two rays passes its first crease.
pub(super) fn first_of(rays: [&Ray; 2]) -> f64 {
    let firsts = rays.into_iter().filter_map(|ray| ray.passages.first());
    firsts.fold(f64::INFINITY, |first, passage| first.min(passage.from))
}

/// Returns the ranges of arc length in which only one of two rays has passed a crease; the last one is endless if they pass
/// different creases.
fn gaps<'a>(
    a: &'a [CreasePassage],
    b: &'a [CreasePassage],
) -> impl Iterator<Item = [f64; 2]> + use<'a> {
    let mut apart = false;
    (0..a.len().max(b.len())).map_while(move |n| {
        if apart {
            return None;
        }
        Some(match (a.get(n), b.get(n)) {
            (Some(a), Some(b)) => {
                apart = a.piece != b.piece;
                let to = a.to.max(b.to);
                [a.from.min(b.from), if apart { f64::INFINITY } else { to }]
            }
            (Some(one), None) | (None, Some(one)) => {
                apart = true;
                [one.from, f64::INFINITY]
            }
            (None, None) => return None,
        })
    })
}

/// The area between two rays of a fan, as far as a picture shows it.
#[derive(Clone, Copy)]
pub(super) struct AreaBetween<'a> {
    pub(super) surface: &'a dyn Surface,
    pub(super) layout: &'a ChartLayout,
    pub(super) rays: [&'a Ray; 2],
    /// The angle between the rays.
    pub(super) width: f64,
    /// The arc length up to which the picture extends.
    pub(super) border: f64,
    /// The width of a pixel, as an arc length.
    pub(super) pixel: f64,
}

/// A part of the area between two rays.
#[derive(Clone, Copy)]
struct AreaPart {
    /// From one arc length to another.
    s: [f64; 2],
    /// From one fraction of the angle to another.
    t: [f64; 2],
}

impl AreaBetween<'_> {
    /// Returns the ranges of arc length in which points between the rays do not follow from both, in order and without
    /// overlaps; the last one is endless where a crease is between the rays. `proofs` counts the parts that are examined.
    pub(super) fn hidden(&self, proofs: &Cell<u64>) -> Vec<[f64; 2]> {
        if !self.layout.has_creases {
            return Vec::new();
        }
        let [a, b] = self.rays;
        let end = self.border.min(a.limit()).min(b.limit());
        let beside = BESIDE * self.pixel;
        let mut hidden: Vec<[f64; 2]> = Vec::new();
        let mut from = 0.0;
        let past_end = [f64::INFINITY; 2];
        for gap in gaps(&a.passages, &b.passages).chain([past_end]) {
            let to = gap[0].min(end);
            let unproven = self.unproven([from, to], proofs);
            let island = unproven.iter().find(|[first, last]| {
                let is_behind = from > 0.0 && *first <= from + beside;
                let is_before = gap[0] <= end && *last >= to - beside;
                !is_behind && !is_before
            });
            hidden.extend(&unproven);
            if let Some(island) = island {
                hidden.push([island[0], f64::INFINITY]);
            }
            if gap[0] < end {
                hidden.push(gap);
            }
            if island.is_some() || gap[1] >= end {
                break;
            }
            from = gap[1];
        }
        hidden.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let mut merged: Vec<[f64; 2]> = Vec::with_capacity(hidden.len());
        for range in hidden {
            match merged.last_mut() {
                Some(last) if range[0] <= last[1] => last[1] = last[1].max(range[1]),
                _ => merged.push(range),
            }
        }
        merged
    }

    /// Returns the ranges of arc length in which the surface is not proven to be smooth between the rays.
    fn unproven(&self, [from, to]: [f64; 2], proofs: &Cell<u64>) -> Vec<[f64; 2]> {
        let mut unproven = Vec::new();
        if from >= to {
            return unproven;
        }
        let mut parts = vec![AreaPart {
            s: [from, to],
            t: [0.0, 1.0],
        }];
        let mut left = MOST_PARTS;
        while let Some(part) = parts.pop() {
            proofs.set(proofs.get() + 1);
            if self.is_proven(&part) {
                continue;
            }
            let AreaPart { s, t } = part;
            let long = s[1] - s[0];
            let wide = s[1] * self.width * (t[1] - t[0]);
            if left == 0 || long.max(wide) <= LEAST_PART * self.pixel {
                unproven.push(s);
                continue;
            }
            left -= 1;
            let halves = |[low, high]: [f64; 2]| {
                let middle = 0.5 * (low + high);
                [[middle, high], [low, middle]]
            };
            if long >= wide {
                parts.extend(halves(s).map(|s| AreaPart { s, t }));
            } else {
                parts.extend(halves(t).map(|t| AreaPart { s, t }));
            }
        }
        unproven
    }

    /// Returns true if the surface is smooth in a part; false where that is not proven. Nothing is examined about an apex.
    fn is_proven(&self, part: &AreaPart) -> bool {
        let [a, b] = self.rays;
        let middle = 0.5 * (part.s[0] + part.s[1]);
        let (Some((first, second)), Some(unlifted)) = (
            cell::pair(self.layout, self.rays, self.width, middle),
            b.at(middle),
        ) else {
            return false;
        };
        let third = self.width / 3.0;
        let (true, Some(near), Some(far)) = (
            first.chart.is_plain() && second.chart.is_plain(),
            a.ranges(part.s, third),
            b.ranges(part.s, -third),
        ) else {
            return true;
        };
        // The hull of the control points of the cubic between the rays contains the part.
        let within = [0, 1].map(|k| {
            let lift = second.at[k] - unlifted.at[k];
            let ([p, q], [s, r]) = (near[k], far[k].map(|range| range.map(|x| x + lift)));
            part_of([p, q, r, s], part.t)
        });
        self.layout.is_one_piece(self.surface, within)
    }
}

/// Returns the hull of a part of a cubic whose control points are in these ranges: de Casteljau's algorithm.
fn part_of(controls: [[f64; 2]; 4], [from, to]: [f64; 2]) -> Interval {
    let mix =
        |x: [f64; 2], y: [f64; 2], t: f64| [0, 1].map(|end: usize| (1.0 - t) * x[end] + t * y[end]);
    // The part's control points are the polar form at (from or to, three times).
    let polar = |ts: [f64; 3]| {
        let [p, q, r, s] = controls;
        let [p, q, r] = [mix(p, q, ts[0]), mix(q, r, ts[0]), mix(r, s, ts[0])];
        let [p, q] = [mix(p, q, ts[1]), mix(q, r, ts[1])];
        mix(p, q, ts[2])
    };
    let points = [
        polar([from; 3]),
        polar([from, from, to]),
        polar([from, to, to]),
        polar([to; 3]),
    ];
    let lower = points
        .iter()
        .fold(f64::INFINITY, |low, point| low.min(point[0]));
    let upper = points
        .iter()
        .fold(f64::NEG_INFINITY, |high, point| high.max(point[1]));
    let rounding = 16.0 * f64::EPSILON * lower.abs().max(upper.abs());
    Interval::new(lower - rounding, upper + rounding)
}
