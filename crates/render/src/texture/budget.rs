//! The memory of all images of a program together.

use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::MAX_TEXELS;

/// The most texels that the images of a program have together.
pub const MAX_TOTAL_TEXELS: u32 = 2 * MAX_TEXELS;

/// The texels that images share. Each may take half of those that are left, and is reduced if it has more: two large images
/// are shown well, and any number fits.
#[derive(Clone, Debug, Default)]
pub struct TexelBudget {
    taken: Arc<Mutex<u32>>,
}

/// The texels of one image, which are free again when it is dropped.
#[derive(Debug)]
pub(super) struct Share {
    budget: TexelBudget,
    texels: u32,
}

/// The right to decode an image: one is decoded at a time, since that takes more memory than its texels do.
#[derive(Debug)]
pub(super) struct Turn<'b> {
    budget: &'b TexelBudget,
    taken: MutexGuard<'b, u32>,
}

impl TexelBudget {
    /// Waits until no other image is decoded.
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
    /// The most texels that the image may have.
    pub(super) fn most(&self) -> u32 {
        (MAX_TOTAL_TEXELS.saturating_sub(*self.taken) / 2).max(1)
    }

    /// Takes the texels of the image, as many as [`Self::most`] or fewer.
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
        // The last have a texel each.
        assert!(taken <= MAX_TOTAL_TEXELS + 100, "{taken}");
        drop((small, shares));
        assert_eq!(*budget.lock(), 0);
    }
}
