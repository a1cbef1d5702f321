//! Several parametric surfaces, each with its box.
//!
//! Input: surfaces, then rays. Output: where a ray meets them.

use glam::DVec3;

use crate::bounds::BoundingBox;
use crate::bvh::Hierarchy;
use crate::sheet::{MOST_HALVED, Sheet, SheetHit, SheetRay, SheetScratch};

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
    pub fn new(mut all: Vec<Sheet>) -> Self {
        let share = MOST_HALVED / all.len().max(1);
        for sheet in &mut all {
            sheet.keep_at_most(share);
        }
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

    /// True if rays meet none.
    pub(crate) fn is_empty(&self) -> bool {
        self.boxed.is_empty()
    }

    /// Hands the places with 0 < t < `reach` where the ray meets a surface to `found`, each once. `found` returns the reach from
    /// then on. With `leaving`, the ray starts on that surface at these parameters.
    pub fn cast(
        &self,
        scratch: &mut SheetScratch,
        ray: SheetsRay,
        found: &mut dyn FnMut(usize, &SheetHit) -> f64,
    ) {
        let SheetsRay {
            origin,
            direction,
            leaving,
            reach,
        } = ray;
        if self.is_empty() {
            return;
        }
        let ray = SheetRay::new(origin, direction, leaving.is_some());
        let mut stack = Vec::new();
        self.hierarchy
            .each_met(origin, direction, reach, &mut stack, &mut |k, reach| {
                let sheet = self.boxed[k] as usize;
                let uv = leaving.and_then(|(other, uv)| (other == sheet).then_some(uv));
                let found = &mut |hit: &SheetHit| found(sheet, hit);
                self.all[sheet].each(scratch, &ray, uv, reach, found)
            });
    }
}

/// A ray among surfaces.
#[derive(Clone, Copy, Debug)]
pub struct SheetsRay {
    /// The start.
    pub origin: DVec3,
    /// The direction.
    pub direction: DVec3,
    /// The surface that it starts on, with the parameters there.
    pub leaving: Option<(usize, [f64; 2])>,
    /// The parameter up to which places are looked for.
    pub reach: f64,
}
