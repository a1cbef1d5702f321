//! Measures of a picture's geodesics for overlays: the ends of all pixels flow in, numbers for each pixel flow out, as far as
//! a request selects what needs them.

use std::borrow::Cow;

use geodesic::pixels::Map;
use geodesic::trace::Status;
use glam::DVec3;
use rayon::prelude::*;
use scene::ObjectId;

use super::{cut_locus, lines};
use crate::counters::PixelCounters;
use crate::geodesic_view::{PlacedCamera, PlacedSolidCamera, RayEnds};
use crate::request::Overlays;

/// The measures of the geodesics of a picture, on any surface.
pub(super) struct MeasuredEnds<'a> {
    /// The object that the camera stands on.
    pub(super) object: ObjectId,
    /// The camera's zoom.
    pub(super) zoom: f64,
    /// The reason why each pixel's geodesic ended; empty where nothing selected needs it.
    pub(super) status: Cow<'a, [Status]>,
    /// The estimated errors, for [`lines::error`].
    pub(super) errors: Option<Vec<f32>>,
    /// The number of pixels by which another way to a pixel's end is shorter, or 0; empty where the cut locus is not selected.
    pub(super) excess: Vec<f32>,
    /// The function that is 0 at conjugate points; empty where neither they nor the cut locus are selected.
    pub(super) degeneracy: Vec<f32>,
}

impl<'a> MeasuredEnds<'a> {
    /// Measures the geodesics on a surface or a metric. `status` holds why they end, where that is known.
    pub(super) fn in_chart(
        overlays: &Overlays,
        camera: &PlacedCamera,
        seen: &'a RayEnds,
        status: Option<&'a [Status]>,
        counters: &PixelCounters,
    ) -> Self {
        let map = (overlays.cut_locus || overlays.conjugate_points).then(|| seen.map(counters));
        let map = map.as_deref();
        let status: Cow<[Status]> = match (status, map) {
            (Some(status), _) => Cow::Borrowed(status),
            (None, Some(map)) => Cow::Owned(map.status.clone()),
            (None, None) if overlays.wavefronts.is_some() || overlays.legend => {
                seen.statuses(counters)
            }
            (None, None) => Cow::Borrowed(&[]),
        };
        let domain = camera.domain();
        let cut = map.filter(|_| overlays.cut_locus);
        let excess = cut.map(|map| cut_locus::excess_in_chart(map, domain, camera.sides()));
        let mut excess = excess.unwrap_or_default();
        let degeneracy =
            map.map(|map| lines::degeneracy_in_chart(map, camera.manifold().surface()));
        if let (Some(map), Some(degeneracy)) = (map, &degeneracy) {
            cut_locus::add_conjugate(&mut excess, map.size, degeneracy);
        }
        let errors = overlays.error.then(|| camera.errors(lines::STEP));
        Self {
            object: camera.surface,
            zoom: camera.zoom,
            status,
            errors: errors.flatten(),
            excess,
            degeneracy: degeneracy.unwrap_or_default(),
        }
    }

    /// Measures the geodesics on a solid.
    pub(super) fn in_space(
        overlays: &Overlays,
        camera: &PlacedSolidCamera,
        map: &'a Map<3>,
    ) -> Self {
        let (mut excess, mut degeneracy) = (Vec::new(), Vec::new());
        if overlays.cut_locus || overlays.conjugate_points {
            let normals = normals(camera, map);
            degeneracy = lines::degeneracy_in_space(map, &normals);
            if overlays.cut_locus {
                excess = cut_locus::excess_in_space(map, &normals);
                cut_locus::add_conjugate(&mut excess, map.size, &degeneracy);
            }
        }
        let errors = overlays.error.then(|| camera.errors(lines::STEP));
        Self {
            object: camera.object,
            zoom: camera.frame.zoom(),
            status: Cow::Borrowed(&map.status),
            errors: errors.flatten(),
            excess,
            degeneracy,
        }
    }
}

/// The steps in space of one pixel to the right and down, in which the derivatives of a pixel's end are stored.
pub(super) fn steps(by_pixel: [[f32; 3]; 2]) -> [DVec3; 2] {
    by_pixel.map(|step| DVec3::from(step.map(f64::from)))
}

/// Vectors whose products with a step in the tangent plane say how many pixels it goes to the right and down, from the steps in
/// space of one pixel to the right and down. Not finite at conjugate points.
pub(super) fn duals([right, down]: [DVec3; 2]) -> [DVec3; 2] {
    let (xx, xy, yy) = (right.dot(right), right.dot(down), down.dot(down));
    let determinant = xx * yy - xy * xy;
    [
        (yy * right - xy * down) / determinant,
        (xx * down - xy * right) / determinant,
    ]
}

/// The unit normal of a solid at each pixel's end; `None` where nothing is seen.
fn normals(camera: &PlacedSolidCamera, map: &Map<3>) -> Vec<Option<DVec3>> {
    let surface = camera.solid().surface();
    let normal = |(offset, status): (&[f32; 3], &Status)| {
        let at = [0, 1, 2].map(|k| map.origin[k] + f64::from(offset[k]));
        let is_seen = *status == Status::Complete;
        is_seen
            .then(|| surface.normal(at))
            .flatten()
            .map(DVec3::from)
    };
    map.offset.par_iter().zip(&map.status).map(normal).collect()
}
