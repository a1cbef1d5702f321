//! The memory limit for all images of a program together.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::MAX_TEXELS;

/// The maximum number of texels of all images of a program together.
pub const MAX_TOTAL_TEXELS: u32 = 2 * MAX_TEXELS;

/// The texels that images share. Each may use half of the remaining ones, and is reduced if it has more: two large images
/// look good, and any number fits.
#[derive(Clone, Debug, Default)]
pub struct TexelBudget {
    taken: Arc<Mutex<u32>>,
}

/// The texels of one image, which are released when it is dropped.
#[derive(Debug)]
pub(super) struct Share {
    budget: TexelBudget,
    texels: u32,
}

/// The permission to decode an image: one is decoded at a time, since decoding needs more memory than the texels.
#[derive(Debug)]
pub(super) struct Turn<'b> {
    budget: &'b TexelBudget,
    taken: MutexGuard<'b, u32>,
}

impl TexelBudget {
    /// Waits until no other image is being decoded.
    pub(super) fn turn(&self) -> Turn<'_> {
        Turn {
            budget: self,
            taken: self.lock(),
        }
    }

    fn lock(&self) -> MutexGuard<'_, u32> {
        self.taken.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Turn<'_> {
    /// Returns the maximum number of texels of the image.
    pub(super) fn most(&self) -> u32 {
        (MAX_TOTAL_TEXELS.saturating_sub(*self.taken) / 2).max(1)
    }

    /// Reserves the texels of the image, at most [`Self::most`].
    pub(super) fn take(mut self, texels: u32) -> Share {
        *self.taken += texels;
        Share {
            budget: self.budget.clone(),
            texels,
        }
    }
}

impl Drop for Share {
    fn drop(&mut self) {
        *self.budget.lock() -= self.texels;
    }
}

#[cfg(test)]
mod tests {
    use super::{MAX_TEXELS, MAX_TOTAL_TEXELS, TexelBudget};

    #[test]
    fn each_image_takes_half_of_what_is_left_and_gives_it_back() {
        let budget = TexelBudget::default();
        assert_eq!(budget.turn().most(), MAX_TEXELS);
        let small = budget.turn().take(1000);
        let mut shares = Vec::new();
        for _ in 0..100 {
            let turn = budget.turn();
            let most = turn.most();
            shares.push(turn.take(most.min(MAX_TEXELS)));
        }
        let taken = *budget.lock();
        // The last images have a texel each.
        assert!(taken <= MAX_TOTAL_TEXELS + 100, "{taken}");
        drop((small, shares));
        assert_eq!(*budget.lock(), 0);
    }
}
