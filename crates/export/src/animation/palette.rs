//! Pictures of a GIF. In: all colours. Out: 255 colours and a transparent one. The crate `color_quant` finds the
//! palette; no library dithers with a pattern that is the same in every frame.
//!
//! A colour that the palette lacks is approximated by alternating between two of its colours in a 4 × 4 pattern
//! (ordered dithering, B. E. Bayer 1973). The pattern does not move, so that still parts of the animation stay still.

use std::collections::HashMap;

use color_quant::NeuQuant;
use gif::{DisposalMethod, Frame};
use image::RgbaImage;
use rayon::prelude::*;

/// The number of colours of a picture, without the transparent one.
const COLOURS: usize = 255;
/// The maximum number of pixels to which the palette is fitted; larger pictures are sampled.
const LOOKED_AT: usize = 1 << 17;
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

struct Palette {
    entries: Vec<[u8; 3]>,
    finder: Finder,
}

/// Finds the entry nearest to a colour.
enum Finder {
    /// The picture has no other colours.
    Exact(HashMap<[u8; 3], u8>),
    Nearest(NeuQuant),
}

impl Palette {
    fn of(image: &RgbaImage) -> Self {
        let colours = || image.as_raw().chunks_exact(4).filter_map(colour_of);
        let mut exact = HashMap::new();
        let mut entries = Vec::new();
        for colour in colours() {
            exact.entry(colour).or_insert_with(|| {
                entries.push(colour);
                (entries.len() - 1) as u8
            });
            if entries.len() > COLOURS {
                break;
            }
        }
        if entries.len() <= COLOURS {
            let finder = Finder::Exact(exact);
            return Self { entries, finder };
        }
        let seen: Vec<u8> = colours().flat_map(|[r, g, b]| [r, g, b, 255]).collect();
        let step = (seen.len() / 4 / LOOKED_AT + 1).min(30) as i32;
        let network = NeuQuant::new(step, COLOURS, &seen);
        let entries = network.color_map_rgb();
        Self {
            entries: entries
                .chunks_exact(3)
                .map(|c| [c[0], c[1], c[2]])
                .collect(),
            finder: Finder::Nearest(network),
        }
    }

    /// Returns the two entries that replace a colour: the nearest one, and the one nearest to that entry's mirror image
    /// about the colour, so that a mixture of the two can approximate the colour.
    fn pair(&self, colour: [u8; 3]) -> [u8; 2] {
        let network = match &self.finder {
            Finder::Exact(entries) => {
                return [entries.get(&colour).copied().unwrap_or_default(); 2];
            }
            Finder::Nearest(network) => network,
        };
        let nearest = |[r, g, b]: [u8; 3]| network.index_of(&[r, g, b, 255]) as u8;
        let first = nearest(colour);
        let entry = self.entry(first);
        // The first entry, reflected about the colour.
        let beyond = std::array::from_fn(|k| {
            (2 * i16::from(colour[k]) - i16::from(entry[k])).clamp(0, 255) as u8
        });
        [first, nearest(beyond)]
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
