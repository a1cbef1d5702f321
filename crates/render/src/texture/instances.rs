//! The images of the instances of a surface, if they differ.

use std::sync::Arc;

use super::Texture;

/// The maximum number of instances with images of their own.
pub(crate) const MOST_INSTANCES: u64 = MOST_TEXELS / (LEAST_SIDE as u64).pow(2);
/// The maximum number of texels of the images of all instances, and the least number along a side of one.
const MOST_TEXELS: u64 = 1 << 20;
const LEAST_SIDE: u32 = 16;

/// Returns the number of texels along u and along v of the images of so many instances: a power of two, at most that of
/// `most`.
pub(crate) fn side(instances: u64, most: u32) -> u32 {
    let mut side = most;
    while side > LEAST_SIDE && instances * u64::from(side).pow(2) > MOST_TEXELS {
        side /= 2;
    }
    side
}

impl Texture {
    /// Creates the image of a surface from those of its instances; white if there are none.
    pub(crate) fn of_instances(mut images: impl Iterator<Item = Self>) -> Self {
        let plain = || Self::of_texels([1; 2], vec![[255; 4]]);
        let mut first = images.next().unwrap_or_else(plain);
        let further: Vec<Arc<Self>> = images.map(Arc::new).collect();
        if further.iter().any(|other| **other != first) {
            first.further = further;
        }
        first
    }

    /// Returns the images of the instances of a surface, the first of which is this one; the last one is that of all further
    /// instances.
    pub fn instances(self: &Arc<Self>) -> impl Iterator<Item = &Arc<Self>> {
        std::iter::once(self).chain(&self.further)
    }

    /// Returns the image of an instance of a surface.
    pub fn of_instance(self: &Arc<Self>, instance: u64) -> &Arc<Self> {
        let last = self.further.len() as u64;
        match instance.min(last) {
            0 => self,
            further => &self.further[further as usize - 1],
        }
    }
}
