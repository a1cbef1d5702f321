//! Pictures of a GIF. In: all colours. Out: 255 colours and a transparent one.
//!
//! The palette begins with the most frequent colour. Each further entry is the colour with the greatest squared distance
//! to the entries so far times its number of pixels, so that small, strong colours have entries of their own. Then entries
//! become the means of the colours nearest to them (k-means, S. Lloyd 1982). The libraries' palettes, of neural networks
//! that are trained with pixels, miss colours of few pixels, and no library dithers with a pattern that is the same in
//! every frame.
//!
//! A colour that the palette lacks is approximated by alternating between two of its colours in a 4 × 4 pattern
//! (ordered dithering, B. E. Bayer 1973). The pattern does not move, so that still parts of the animation stay still.

use std::collections::HashMap;

use gif::{DisposalMethod, Frame};
use image::RgbaImage;
use rayon::prelude::*;

/// The number of colours of a picture, without the transparent one.
const COLOURS: usize = 255;
/// The maximum number of colours that are counted one by one; if there are more, similar ones are counted together.
const COUNTED: usize = 1 << 15;
/// The number of bits of a component in which similar colours may differ.
const SIMILAR_BITS: u32 = 2;
/// The number of times that entries become means.
const ROUNDS: usize = 2;
/// The minimum number of colours for which one thread finds the nearest entries.
const COLOURS_FOR_THREAD: usize = 1024;
/// Bayer's threshold matrix: the order in which the pixels of the pattern switch to the second colour.
const PATTERN: [[u8; 4]; 4] = [[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]];

/// Encodes a picture with its own palette, shown for `delay` hundredths of a second. Its sides must be below 65,536.
pub(super) fn frame(image: &RgbaImage, delay: u16) -> Frame<'static> {
    let (width, height) = image.dimensions();
    let palette = Palette::of(image);
    let row = |(y, pixels): (usize, &[u8])| -> Vec<u8> {
        let mut known: HashMap<[u8; 3], [u8; 2]> = HashMap::new();
        let pixels = pixels.chunks_exact(4).enumerate();
        pixels
            .map(|(x, pixel)| match colour_of(pixel) {
                None => COLOURS as u8,
                Some(colour) => {
                    let pair = known.entry(colour).or_insert_with(|| palette.pair(colour));
                    palette.mixed(colour, *pair, PATTERN[y % 4][x % 4])
                }
            })
            .collect()
    };
    let rows = image.as_raw().par_chunks(4 * width.max(1) as usize);
    let indices: Vec<Vec<u8>> = rows.enumerate().map(row).collect();
    let mut entries = palette.entries.as_flattened().to_vec();
    entries.resize(3 * (COLOURS + 1), 0);
    Frame {
        width: width as u16,
        height: height as u16,
        buffer: indices.concat().into(),
        palette: Some(entries),
        transparent: Some(COLOURS as u8),
        delay,
        dispose: DisposalMethod::Background,
        ..Frame::default()
    }
}

/// Returns the colour of a pixel; `None` if it is more transparent than opaque.
fn colour_of(pixel: &[u8]) -> Option<[u8; 3]> {
    (pixel[3] >= 128).then_some([pixel[0], pixel[1], pixel[2]])
}

/// The colours of similar pixels.
struct Similar {
    /// Their mean.
    colour: [f32; 3],
    pixels: f32,
    /// The squared distance to the nearest entry.
    apart: f32,
}

impl Similar {
    /// Returns the colours of pixels, in ascending order.
    fn all(colours: impl Iterator<Item = [u8; 3]> + Clone) -> Vec<Self> {
        let counted = |bits: u32, most: usize| {
            let mut counted: HashMap<[u8; 3], [u64; 4]> = HashMap::new();
            for colour in colours.clone() {
                let sums = counted.entry(colour.map(|part| part >> bits)).or_default();
                for k in 0..3 {
                    sums[k] += u64::from(colour[k]);
                }
                sums[3] += 1;
                if counted.len() > most {
                    return None;
                }
            }
            Some(counted)
        };
        let all = counted(0, COUNTED).or_else(|| counted(SIMILAR_BITS, usize::MAX));
        let mut all: Vec<_> = all.into_iter().flatten().collect();
        all.sort_unstable();
        let similar = |(_, [r, g, b, pixels]): ([u8; 3], [u64; 4])| Self {
            colour: [r, g, b].map(|sum| (sum as f64 / pixels as f64) as f32),
            pixels: pixels as f32,
            apart: f32::INFINITY,
        };
        all.into_iter().map(similar).collect()
    }

    /// Returns the weight with which a palette misses the colour.
    fn error(&self) -> f32 {
        self.pixels * self.apart
    }
}

struct Palette {
    /// The entries, by their shares of green.
    entries: Vec<[u8; 3]>,
}

impl Palette {
    fn of(image: &RgbaImage) -> Self {
        let colours = image.as_raw().chunks_exact(4).filter_map(colour_of);
        let mut all = Similar::all(colours);
        let mut entries: Vec<[f32; 3]> = Vec::new();
        let first = all.iter().max_by(|a, b| a.pixels.total_cmp(&b.pixels));
        let mut next = first.map(|it| it.colour);
        while let Some(entry) = next.filter(|_| entries.len() < COLOURS) {
            entries.push(entry);
            for it in &mut all {
                it.apart = it.apart.min(squared_distance(it.colour, entry));
            }
            let worst = all.iter().max_by(|a, b| a.error().total_cmp(&b.error()));
            next = worst.filter(|it| it.apart > 0.0).map(|it| it.colour);
        }
        for _ in 0..ROUNDS {
            move_to_means(&mut entries, &all);
        }
        let round = |entry: [f32; 3]| entry.map(|part| part.round() as u8);
        let mut entries: Vec<[u8; 3]> = entries.into_iter().map(round).collect();
        entries.sort_unstable_by_key(|[r, g, b]| [*g, *r, *b]);
        Self { entries }
    }

    /// Returns the entry nearest to a colour: from the entries with its share of green to both sides, as long as green
    /// alone is not farther away.
    fn nearest(&self, colour: [u8; 3]) -> u8 {
        let begin = self.entries.partition_point(|entry| entry[1] < colour[1]);
        let (mut least, mut nearest) = (i32::MAX, 0);
        let mut look = |index: usize| {
            let apart = [0, 1, 2].map(|k| {
                let difference = i32::from(self.entries[index][k]) - i32::from(colour[k]);
                difference * difference
            });
            let all = apart.iter().sum();
            if all < least {
                (least, nearest) = (all, index);
            }
            apart[1] <= least
        };
        let up = (begin..self.entries.len()).take_while(|&index| look(index));
        up.for_each(drop);
        let down = (0..begin).rev().take_while(|&index| look(index));
        down.for_each(drop);
        nearest as u8
    }

    /// Returns the two entries that replace a colour: the nearest one, and the one nearest to that entry's mirror image
    /// about the colour, so that a mixture of the two can approximate the colour.
    fn pair(&self, colour: [u8; 3]) -> [u8; 2] {
        let first = self.nearest(colour);
        let entry = self.entry(first);
        // The first entry, reflected about the colour.
        let beyond = std::array::from_fn(|k| {
            (2 * i16::from(colour[k]) - i16::from(entry[k])).clamp(0, 255) as u8
        });
        [first, self.nearest(beyond)]
    }

    /// Chooses one of two entries for a cell of the pattern, so that the mean over the pattern is as close as possible
    /// to the colour.
    fn mixed(&self, colour: [u8; 3], [first, second]: [u8; 2], place: u8) -> u8 {
        let (low, high) = (self.entry(first), self.entry(second));
        let (mut along, mut square) = (0.0, 0.0);
        for k in 0..3 {
            let step = f32::from(high[k]) - f32::from(low[k]);
            along += step * (f32::from(colour[k]) - f32::from(low[k]));
            square += step * step;
        }
        // The projection of the colour onto the line from the first to the second.
        let share = along / square;
        if share > (f32::from(place) + 0.5) / 16.0 {
            second
        } else {
            first
        }
    }

    fn entry(&self, index: u8) -> [u8; 3] {
        self.entries
            .get(usize::from(index))
            .copied()
            .unwrap_or_default()
    }
}

fn squared_distance(a: [f32; 3], b: [f32; 3]) -> f32 {
    let [r, g, b] = [0, 1, 2].map(|k| a[k] - b[k]);
    r * r + g * g + b * b
}

/// Moves each entry to the mean of the colours that are nearer to it than to the others.
fn move_to_means(entries: &mut [[f32; 3]], colours: &[Similar]) {
    let nearest = |it: &Similar| {
        let (mut least, mut nearest) = (f32::INFINITY, 0);
        for (index, entry) in entries.iter().enumerate() {
            let apart = squared_distance(it.colour, *entry);
            if apart < least {
                (least, nearest) = (apart, index);
            }
        }
        nearest
    };
    let each = colours.par_iter().with_min_len(COLOURS_FOR_THREAD);
    let nearest: Vec<usize> = each.map(nearest).collect();
    let mut sums = vec![[0.0_f64; 4]; entries.len()];
    for (it, nearest) in colours.iter().zip(nearest) {
        let [r, g, b] = it.colour;
        let sum = &mut sums[nearest];
        for (sum, part) in sum.iter_mut().zip([r, g, b, 1.0]) {
            *sum += f64::from(it.pixels) * f64::from(part);
        }
    }
    for (entry, [r, g, b, pixels]) in entries.iter_mut().zip(sums) {
        if pixels > 0.0 {
            *entry = [r, g, b].map(|sum| (sum / pixels) as f32);
        }
    }
}
