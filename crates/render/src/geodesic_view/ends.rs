//! The ends of all pixels' geodesics, and the pictures made of them.
//!
//! In: ends. Out: colours, and over them layers ([`Layer`]), drawn row by row while the ends are in the cache: a table's
//! polynomials are evaluated once for each pixel, and all layers share the results.

use std::borrow::Cow;

use geodesic::ends::{Estimate, GeodesicWork};
use geodesic::map::Map;
use geodesic::piecewise::{BLOCK, PiecewiseMap, Rows};
use geodesic::trace::Status;
use image::RgbaImage;
use rayon::prelude::*;

use super::Paint;
use super::resolve::{resolve, resolve_piecewise};
use crate::counters::PixelCounters;

/// The ends of the geodesics of all pixels.
#[derive(Clone, Debug)]
pub enum RayEnds {
    /// Polynomials between shared rays.
    Piecewise {
        /// The ends.
        piecewise: Box<PiecewiseMap>,
        /// The work to compute them.
        work: GeodesicWork,
        /// Its estimated error.
        estimate: Estimate,
    },
    /// One end for each pixel.
    Map(Map),
}

/// The ends of the pixels of several whole rows, as in [`Map`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct EndsOfRows<'a> {
    /// The index of the first row.
    pub(crate) first: usize,
    pub(crate) origin: [f64; 2],
    pub(crate) offset: &'a [[f32; 2]],
    /// Empty if unknown.
    pub(crate) by_pixel: &'a [[f32; 4]],
    pub(crate) status: &'a [Status],
}

/// A layer over the pixels that show the surface, computed from their ends. It does not change other pixels.
pub(crate) trait Layer: Sync {
    /// Draws the layer over the RGBA pixels of several whole rows.
    fn lay(&self, ends: EndsOfRows<'_>, pixels: &mut [u8]);
}

impl RayEnds {
    /// Returns the work to compute them.
    pub fn work(&self) -> GeodesicWork {
        match self {
            Self::Piecewise { work, .. } => *work,
            Self::Map(map) => map.work,
        }
    }

    /// Returns its estimated error, if the method has one.
    pub fn estimate(&self) -> Option<Estimate> {
        match self {
            Self::Piecewise { estimate, .. } => Some(*estimate),
            Self::Map(map) => map.estimate,
        }
    }

    /// Returns all pixels' ends.
    pub(crate) fn map(&self, counters: &PixelCounters) -> Cow<'_, Map> {
        match self {
            Self::Piecewise { piecewise, .. } => {
                let map = piecewise.map(true);
                counters.count_ends(map.status.len());
                Cow::Owned(map)
            }
            Self::Map(map) => Cow::Borrowed(map),
        }
    }

    /// Returns the statuses of all pixels' geodesics.
    pub(crate) fn statuses(&self, counters: &PixelCounters) -> Cow<'_, [Status]> {
        match self {
            Self::Piecewise { piecewise, .. } => {
                let status = piecewise.map(false).status;
                counters.count_ends(status.len());
                Cow::Owned(status)
            }
            Self::Map(map) => Cow::Borrowed(&map.status),
        }
    }

    /// Returns the picture, and each pixel's status.
    pub fn resolve(&self, paint: &Paint) -> (RgbaImage, Vec<Status>) {
        self.resolve_under(paint, None, &PixelCounters::default())
    }

    /// Returns the picture with a layer over it, and each pixel's status.
    pub(crate) fn resolve_under(
        &self,
        paint: &Paint,
        layer: Option<&dyn Layer>,
        counters: &PixelCounters,
    ) -> (RgbaImage, Vec<Status>) {
        match self {
            Self::Piecewise { piecewise, .. } => {
                let (image, status) = resolve_piecewise(piecewise, paint, layer);
                counters.count_ends(status.len());
                (image, status)
            }
            Self::Map(map) => {
                let mut image = resolve(map, paint);
                if let Some(layer) = layer {
                    self.lay(&mut image, layer, counters);
                }
                (image, map.status.clone())
            }
        }
    }

    /// Draws a layer over a picture of these ends that was coloured elsewhere.
    pub(crate) fn lay(&self, image: &mut RgbaImage, layer: &dyn Layer, counters: &PixelCounters) {
        let band = BLOCK as usize * image.width() as usize;
        if band == 0 {
            return;
        }
        let bands = image.par_chunks_mut(4 * band).enumerate();
        match self {
            Self::Piecewise { piecewise, .. } => {
                let buffers = || {
                    let status = vec![Status::Complete; band];
                    (vec![[0.0; 2]; band], vec![[0.0; 4]; band], status)
                };
                bands.for_each_init(buffers, |(offset, by_pixel, status), (row, pixels)| {
                    let count = pixels.len() / 4;
                    let (offset, by_pixel) = (&mut offset[..count], &mut by_pixel[..count]);
                    let status = &mut status[..count];
                    let rows = Rows {
                        offset: &mut *offset,
                        by_pixel: bytemuck::cast_slice_mut(by_pixel),
                        status: &mut *status,
                    };
                    piecewise.block_row(row as u32, rows);
                    counters.count_ends(count);
                    let ends = EndsOfRows {
                        first: row * BLOCK as usize,
                        origin: piecewise.origin,
                        offset,
                        by_pixel,
                        status,
                    };
                    layer.lay(ends, pixels);
                });
            }
            Self::Map(map) => bands.for_each(|(row, pixels)| {
                let here = row * band..row * band + pixels.len() / 4;
                let ends = EndsOfRows {
                    first: row * BLOCK as usize,
                    origin: map.origin,
                    offset: &map.offset[here.clone()],
                    by_pixel: bytemuck::cast_slice(
                        map.by_pixel.get(here.clone()).unwrap_or_default(),
                    ),
                    status: &map.status[here],
                };
                layer.lay(ends, pixels);
            }),
        }
    }
}
