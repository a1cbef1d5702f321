//! Samples: the depth and light of a tile's pixels, and the triangles that they see.

use crate::solids::{SolidSample, SolidTile};
use crate::style::{encode, encode_pixels};

/// Pixels along a tile's side.
pub(in crate::software) const TILE: usize = 64;
/// Pixels of a tile.
pub(super) const AREA: usize = TILE * TILE;
/// The number of adjacent pixels that are tested at once.
pub(super) const LANES: usize = 8;
/// The number of their samples, whose data is contiguous: first that of all pixels' first samples.
pub(super) const GROUP: usize = 4 * LANES;
/// Marks a sample that sees no triangle of the current batch.
pub(super) const NONE: u32 = u32::MAX;
/// Marks a pixel all of whose samples see something and have one light.
const WHOLE: u16 = u16::MAX;
/// Marks a pixel whose samples see nothing.
const EMPTY: u16 = WHOLE - 1;

/// One tile's samples.
pub(in crate::software) struct Tile {
    /// The position of the top left pixel.
    origin: [usize; 2],
    /// The depths by groups; 0 where only the background is seen.
    pub(super) depth: Vec<f32>,
    /// The linear light of each pixel, or the common light of its samples before they were split; meaningless if nothing has
    /// been seen.
    light: Vec<[f32; 3]>,
    /// For each pixel [`WHOLE`] or [`EMPTY`], or the index in `splits` of the light of its samples.
    split: Vec<u16>,
    splits: Vec<[[f32; 3]; 4]>,
    /// The pixels that may see anything.
    rows: Rows,
    /// The background in linear light, with its alpha.
    background: [f32; 4],
    /// The encoded colour of an empty pixel.
    empty: [u8; 4],
}

/// The triangles of a batch that the samples of a tile see.
pub(in crate::software) struct Layer {
    /// The numbers of the triangles, by groups.
    pub(super) ids: Vec<u32>,
    /// The pixels that may see any triangle.
    pub(super) rows: Rows,
}

/// The first relevant pixel and the one after the last in each row of a tile, by whole groups.
#[derive(Clone, Copy)]
pub(super) struct Rows([[u8; 2]; TILE]);

impl Tile {
    /// Creates a tile of background.
    pub(in crate::software) fn new(origin: [usize; 2], background: [f32; 4]) -> Self {
        Self {
            origin,
            depth: vec![0.0; 4 * AREA],
            light: vec![[0.0; 3]; AREA],
            split: vec![EMPTY; AREA],
            splits: Vec::new(),
            rows: Rows::none(),
            background,
            empty: {
                let [r, g, b, alpha] = background;
                let [r, g, b] = [r, g, b].map(encode);
                let alpha = (255.0 * alpha).round() as u8;
                if alpha == 0 { [0; 4] } else { [r, g, b, alpha] }
            },
        }
    }

    /// Resets the tile, at another position.
    pub(super) fn reset(&mut self, origin: [usize; 2]) {
        self.origin = origin;
        for (y, row) in self.rows.each() {
            let pixels = y * TILE + row.start..y * TILE + row.end;
            self.depth[4 * pixels.start..4 * pixels.end].fill(0.0);
            self.split[pixels].fill(EMPTY);
        }
        self.splits.clear();
        self.rows = Rows::none();
    }

    /// Begins an empty tile with the visible solids.
    pub(in crate::software) fn begin(&mut self, solids: &SolidTile) {
        for (index, pixel) in solids.pixels.iter().enumerate() {
            if pixel.depth > 0.0 {
                self.see(index, [*pixel; 4]);
            }
        }
        for &(index, samples) in &solids.splits {
            self.see(usize::from(index), samples);
        }
    }

    /// Sets the samples of a pixel that see solids.
    fn see(&mut self, index: usize, samples: [SolidSample; 4]) {
        let first = index / LANES * GROUP + index % LANES;
        let mut open = 0_u8;
        for (s, sample) in samples.iter().enumerate() {
            self.depth[first + s * LANES] = sample.depth;
            open |= u8::from(sample.depth > 0.0) << s;
        }
        self.split[index] = EMPTY;
        while open != 0 {
            let leader = samples[open.trailing_zeros() as usize];
            let mut same = 0;
            for (s, sample) in samples.iter().enumerate() {
                same |= u8::from(*sample == leader) << s;
            }
            let same = same & open;
            self.put(index, same, leader.light);
            open &= !same;
        }
        let column = index % TILE / LANES * LANES;
        self.rows.extend(index / TILE, [column, column + LANES]);
    }

    /// Returns the position of the top left pixel in the picture.
    pub(super) fn origin(&self) -> [usize; 2] {
        self.origin
    }

    /// Returns the index in the tile of a pixel of the picture.
    pub(in crate::software) fn index(&self, [x, y]: [usize; 2]) -> Option<usize> {
        let [left, top] = self.origin;
        let inside = (left..left + TILE).contains(&x) && (top..top + TILE).contains(&y);
        inside.then(|| (y - top) * TILE + x - left)
    }

    /// Returns the depths of a pixel's samples; 0 where nothing is seen.
    #[inline(always)]
    pub(in crate::software) fn depth(&self, index: usize) -> [f32; 4] {
        samples(&self.depth, index)
    }

    /// Adds pixels that may see something.
    pub(super) fn touch(&mut self, rows: &Rows) {
        for (y, row) in rows.each() {
            self.rows.extend(y, [row.start, row.end]);
        }
    }

    /// Lights the samples of a pixel whose bits are set in `samples`.
    #[inline(always)]
    pub(super) fn put(&mut self, index: usize, samples: u8, light: [f32; 3]) {
        if samples == 0b1111 {
            self.light[index] = light;
            self.split[index] = WHOLE;
            return;
        }
        if self.split[index] >= EMPTY {
            // There are no more splits than pixels, unless pixels became whole again.
            if self.splits.len() >= AREA {
                self.gather();
            }
            self.split[index] = self.splits.len() as u16;
            self.splits.push([self.light[index]; 4]);
        }
        for (s, own) in self.splits[usize::from(self.split[index])]
            .iter_mut()
            .enumerate()
        {
            if samples >> s & 1 == 1 {
                *own = light;
            }
        }
    }

    /// Removes splits that no pixel uses any more.
    #[cold]
    fn gather(&mut self) {
        let mut kept = Vec::with_capacity(AREA);
        for split in self.split.iter_mut().filter(|split| **split < EMPTY) {
            let samples = self.splits[usize::from(*split)];
            *split = kept.len() as u16;
            kept.push(samples);
        }
        self.splits = kept;
    }

    /// Returns the means of all pixels' samples, sRGB.
    #[inline(always)]
    pub(super) fn pixels(&self) -> Vec<[u8; 4]> {
        let mut pixels = vec![self.empty; AREA];
        let mut light = [[0.0; TILE]; 3];
        let mut alphas = [u8::MAX; TILE];
        for (y, row) in self.rows.each() {
            let first = y * TILE;
            let own = first + row.start..first + row.end;
            for (k, index) in own.clone().enumerate() {
                let (mean, alpha) = self.mean(index);
                alphas[k] = alpha;
                for (light, mean) in light.iter_mut().zip(mean) {
                    light[k] = mean;
                }
            }
            let seen = &mut pixels[own.clone()];
            encode_pixels(&light, seen.as_flattened_mut());
            for ((pixel, alpha), index) in seen.iter_mut().zip(alphas).zip(own) {
                pixel[3] = alpha;
                if self.split[index] == EMPTY {
                    *pixel = self.empty;
                }
            }
        }
        pixels
    }

    /// Returns the mean of a pixel's samples, sRGB; `x` and `y` are relative to the picture.
    pub(in crate::software) fn pixel(&self, x: usize, y: usize) -> [u8; 4] {
        let index = (y - self.origin[1]) * TILE + x - self.origin[0];
        if self.split[index] == EMPTY {
            return self.empty;
        }
        let ([r, g, b], alpha) = self.mean(index);
        [encode(r), encode(g), encode(b), alpha]
    }

    /// Returns the mean of a pixel's samples in linear light, and its alpha; nothing for an empty pixel.
    #[inline(always)]
    fn mean(&self, index: usize) -> ([f32; 3], u8) {
        match self.split[index] {
            EMPTY => ([0.0; 3], 0),
            WHOLE => (self.light[index], u8::MAX),
            split => {
                let seen = self.depth(index).map(|depth| depth > 0.0);
                self.mixed(self.splits[usize::from(split)], seen)
            }
        }
    }

    /// Returns the mean of samples, some of which see the background, and its alpha.
    fn mixed(&self, mut samples: [[f32; 3]; 4], seen: [bool; 4]) -> ([f32; 3], u8) {
        let [r, g, b, alpha] = self.background;
        for (sample, seen) in samples.iter_mut().zip(seen) {
            if !seen {
                *sample = [r, g, b];
            }
        }
        if alpha == 1.0 {
            let mean = |k: usize| 0.25 * samples.iter().map(|light| light[k]).sum::<f32>();
            return ([mean(0), mean(1), mean(2)], u8::MAX);
        }
        let alphas = seen.map(|seen| if seen { 1.0 } else { alpha });
        let sum: f32 = alphas.iter().sum();
        if sum == 0.0 {
            return ([0.0; 3], 0);
        }
        let mean = |k: usize| {
            let weighted = samples.iter().zip(alphas).map(|(light, a)| a * light[k]);
            weighted.sum::<f32>() / sum
        };
        let alpha = (0.25 * 255.0 * sum).round() as u8;
        ([mean(0), mean(1), mean(2)], alpha)
    }
}

impl Layer {
    /// Creates a layer in which nothing is seen.
    pub(in crate::software) fn new() -> Self {
        Self {
            ids: vec![NONE; 4 * AREA],
            rows: Rows::none(),
        }
    }

    /// Resets the tile.
    pub(super) fn clear(&mut self) {
        for (y, row) in self.rows.each() {
            let first = y * TILE;
            self.ids[4 * (first + row.start)..4 * (first + row.end)].fill(NONE);
        }
        self.rows = Rows::none();
    }

    /// Returns the triangles that the samples of the group that begins with this pixel see.
    #[inline(always)]
    pub(super) fn group(&self, index: usize) -> &[u32; GROUP] {
        const NOTHING: &[u32; GROUP] = &[NONE; GROUP];
        let group = self.ids[4 * index..].first_chunk();
        group.unwrap_or(NOTHING)
    }

    /// Returns the triangles that a pixel's samples see.
    #[inline(always)]
    pub(in crate::software) fn seen(&self, index: usize) -> [u32; 4] {
        samples(&self.ids, index)
    }
}

/// Returns the values of a pixel's four samples.
#[inline(always)]
fn samples<T: Copy + Default>(of: &[T], index: usize) -> [T; 4] {
    let first = index / LANES * GROUP + index % LANES;
    match of[first..].first_chunk::<{ 3 * LANES + 1 }>() {
        Some(group) => [group[0], group[LANES], group[2 * LANES], group[3 * LANES]],
        None => [T::default(); 4],
    }
}

impl Rows {
    fn none() -> Self {
        Self([[TILE as u8, 0]; TILE])
    }

    #[inline(always)]
    pub(super) fn extend(&mut self, y: usize, [first, end]: [usize; 2]) {
        let row = &mut self.0[y];
        *row = [row[0].min(first as u8), row[1].max(end as u8)];
    }

    /// Returns the rows in which any pixel is relevant.
    pub(super) fn each(&self) -> impl Iterator<Item = (usize, std::ops::Range<usize>)> + use<> {
        let rows = self.0.into_iter().enumerate();
        rows.map(|(y, [first, end])| (y, usize::from(first)..usize::from(end)))
            .filter(|(_, row)| !row.is_empty())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pixel_that_is_split_and_made_whole_again_and_again_keeps_its_samples() {
        let mut tile = Tile::new([0; 2], [0.0, 0.0, 0.0, 1.0]);
        let index = 70;
        tile.depth[index / LANES * GROUP..][..GROUP].fill(1.0);
        for _ in 0..3 * AREA {
            tile.put(index, 0b1111, [1.0; 3]);
            tile.put(index, 0b0011, [0.0; 3]);
        }
        let half = encode(0.5);
        assert_eq!(tile.pixel(6, 1), [half, half, half, 255]);
        assert!(tile.splits.len() <= AREA);
        // A reused tile keeps nothing.
        tile.touch(&{
            let mut rows = Rows::none();
            rows.extend(1, [0, 8]);
            rows
        });
        tile.reset([0; 2]);
        assert_eq!(tile.pixel(6, 1), [0, 0, 0, 255]);
    }
}
