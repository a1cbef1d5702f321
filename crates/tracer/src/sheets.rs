//! Several parametric surfaces, each with its box.
//!
//! Input: surfaces, then rays. Output: where a ray meets them.

use glam::DVec3;

use crate::bounds::BoundingBox;
use crate::bvh::Hierarchy;
use crate::sheet::{Sheet, SheetHit, SheetScratch};

/// Parametric surfaces by their numbers.
#[derive(Debug, Default)]
pub struct Sheets {
    all: Vec<Sheet>,
    hierarchy: Hierarchy,
    /// The surface of each box: those that are defined nowhere have none.
    boxed: Vec<u32>,
}

impl Sheets {
    /// Prepares the surfaces.
    pub fn new(all: Vec<Sheet>) -> Self {
        let boxed: Vec<u32> = (0..all.len() as u32)
            .filter(|&k| !all[k as usize].bounds().is_empty())
            .collect();
        let boxes = boxed.iter().map(|&k| all[k as usize].bounds()).collect();
        Self {
            hierarchy: Hierarchy::new(boxes),
            all,
            boxed,
        }
    }

    /// A box that contains all of them, empty if there are none.
    pub fn bounds(&self) -> BoundingBox {
        self.hierarchy.bounds()
    }

    /// Hands the places with t > 0 where the ray meets a surface to `found`, those of each surface by t. With `leaving`, the
    /// ray starts on that surface at these parameters.
    pub fn cast(
        &self,
        scratch: &mut SheetScratch,
        origin: DVec3,
        direction: DVec3,
        leaving: Option<(usize, [f64; 2])>,
        found: &mut dyn FnMut(usize, &SheetHit),
    ) {
        if self.boxed.is_empty() {
            return;
        }
        let (mut stack, mut met) = (Vec::new(), Vec::new());
        self.hierarchy
            .met(origin, direction, &mut stack, &mut |k, _| {
                met.push(self.boxed[k])
            });
        for k in met {
            let sheet = k as usize;
            let uv = leaving.and_then(|(other, uv)| (other == sheet).then_some(uv));
            for hit in self.all[sheet].cast(scratch, origin, direction, uv) {
                found(sheet, hit);
            }
        }
    }
}
