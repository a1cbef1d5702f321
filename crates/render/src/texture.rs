//! Images on surfaces: loading, mip chains, filtering.
//!
//! An image's left is u min, its top row v min; one width of the image is one width of the domain, and it repeats
//! beyond. Texels are opaque sRGB; filtering happens in linear light, so a fine checkerboard keeps its brightness.

mod orientation;

use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use image::{ImageReader, Limits, RgbaImage, imageops};
use rayon::prelude::*;

use crate::style::{decode, encode};

/// The longest side of an image file in pixels.
pub const MAX_FILE_SIDE: u32 = 32_768;
/// The longest side of a texture in texels; a larger image is reduced to it.
pub const MAX_SIDE: u32 = 8_192;
/// What decoding one image may take, in bytes.
const MAX_BYTES: u64 = 1 << 30;
/// How many times a footprint may be longer than wide before it is blurred across.
const MAX_ANISOTROPY: f32 = 8.0;

/// An image with its mip chain.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    levels: Vec<Level>,
}

/// One level of a mip chain.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    /// Width and height in texels.
    pub size: [u32; 2],
    /// sRGB and an alpha of 255, row by row from the top.
    pub texels: Vec<[u8; 4]>,
}

/// Why a file gave no texture.
#[derive(Clone, Debug, PartialEq)]
pub enum TextureError {
    /// The file cannot be read.
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The system's words.
        message: String,
    },
    /// The file is no PNG or JPEG image, or a damaged one.
    NotAnImage {
        /// The file.
        path: PathBuf,
        /// The decoder's words.
        message: String,
    },
    /// The image has too many pixels.
    TooLarge {
        /// The file.
        path: PathBuf,
    },
}

impl Texture {
    /// Reads a PNG or JPEG file. What is transparent shows white.
    ///
    /// # Errors
    /// See [`TextureError`].
    pub fn load(path: &Path) -> Result<Self, TextureError> {
        let unreadable = |error: std::io::Error| TextureError::Unreadable {
            path: path.to_owned(),
            message: error.to_string(),
        };
        let mut limits = Limits::default();
        limits.max_image_width = Some(MAX_FILE_SIDE);
        limits.max_image_height = Some(MAX_FILE_SIDE);
        limits.max_alloc = Some(MAX_BYTES);
        let mut reader = ImageReader::open(path)
            .map_err(unreadable)?
            .with_guessed_format()
            .map_err(unreadable)?;
        reader.limits(limits);
        let image = reader.decode().map_err(|error| match error {
            image::ImageError::Limits(_) => TextureError::TooLarge {
                path: path.to_owned(),
            },
            image::ImageError::IoError(error)
                if error.kind() != std::io::ErrorKind::UnexpectedEof =>
            {
                unreadable(error)
            }
            other => TextureError::NotAnImage {
                path: path.to_owned(),
                message: other.to_string(),
            },
        })?;
        Ok(Self::from_image(image.into_rgba8()))
    }

    /// A texture of an image with at least one pixel (an empty one gives a white texel). What is transparent shows
    /// white; an image larger than [`MAX_SIDE`] is reduced.
    pub fn from_image(image: RgbaImage) -> Self {
        let longest = image.width().max(image.height());
        let image = if longest > MAX_SIDE {
            let reduced = |side: u32| {
                (u64::from(side) * u64::from(MAX_SIDE) / u64::from(longest)).max(1) as u32
            };
            let size = [reduced(image.width()), reduced(image.height())];
            imageops::resize(&image, size[0], size[1], imageops::FilterType::Triangle)
        } else {
            image
        };
        let size = [image.width(), image.height()];
        let mut texels: Vec<[u8; 4]> = image.pixels().map(|pixel| over_white(pixel.0)).collect();
        if texels.is_empty() {
            texels.push([255; 4]);
            return Self {
                levels: vec![Level {
                    size: [1, 1],
                    texels,
                }],
            };
        }
        let mut levels = vec![Level { size, texels }];
        while let Some(last) = levels.last().filter(|level| level.size != [1, 1]) {
            let next = last.halved();
            levels.push(next);
        }
        Self { levels }
    }

    /// The texture of surfaces without an image: 8 × 8 cells named A1 (u min, v min) to H8 (u max, v max), the hue
    /// following u and the lightness v. The names read rightly where u grows to the right and v upwards, as in a
    /// geodesic view, and in space from the side that σu×σv points to.
    pub fn orientation() -> Arc<Self> {
        static ORIENTATION: OnceLock<Arc<Texture>> = OnceLock::new();
        ORIENTATION
            .get_or_init(|| Arc::new(Self::from_image(orientation::image())))
            .clone()
    }

    /// The mip chain: each level half the size (rounded down) of the one before, the last 1×1.
    pub fn levels(&self) -> &[Level] {
        &self.levels
    }

    /// The colour in linear light at `uv` (1 is the image's width or height; repeats), averaged over a footprint:
    /// the parallelogram that `across` and `along` (in the same units) span around it. Up to eight trilinear probes
    /// along the longer axis of its ellipse.
    pub fn sample(&self, uv: [f32; 2], across: [f32; 2], along: [f32; 2]) -> [f32; 3] {
        let size = self.levels[0].size.map(|side| side as f32);
        let [a, b] = [across, along].map(|d| [d[0] * size[0], d[1] * size[1]]);
        // The ellipse's axes are the singular vectors of (a b).
        let (xx, xy, yy) = (
            a[0] * a[0] + b[0] * b[0],
            a[0] * a[1] + b[0] * b[1],
            a[1] * a[1] + b[1] * b[1],
        );
        let (mean, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
        let spread = half.hypot(xy);
        let major = (mean + spread).max(0.0).sqrt();
        let minor = (mean - spread).max(0.0).sqrt();
        if !major.is_finite() {
            return self.level(self.levels.len() as f32, uv);
        }
        let minor = minor.max(major / MAX_ANISOTROPY).max(1.0);
        let level = minor.log2();
        // A footprint that is a circle but for rounding has one probe.
        let probes = (major / minor - 0.1).ceil().clamp(1.0, MAX_ANISOTROPY);
        if probes == 1.0 {
            return self.level(level, uv);
        }
        let angle = 0.5 * xy.atan2(half);
        let step = [major * angle.cos() / size[0], major * angle.sin() / size[1]];
        let mut sum = [0.0; 3];
        for k in 0..probes as u32 {
            let t = (k as f32 + 0.5) / probes - 0.5;
            let probe = self.level(level, [uv[0] + t * step[0], uv[1] + t * step[1]]);
            sum = std::array::from_fn(|k| sum[k] + probe[k]);
        }
        sum.map(|x| x / probes)
    }

    /// Between two levels.
    fn level(&self, level: f32, uv: [f32; 2]) -> [f32; 3] {
        let last = self.levels.len() - 1;
        let level = level.clamp(0.0, last as f32);
        let lower = level as usize;
        let near = self.levels[lower].bilinear(uv);
        let share = level - lower as f32;
        if share == 0.0 {
            return near;
        }
        let far = self.levels[(lower + 1).min(last)].bilinear(uv);
        std::array::from_fn(|k| near[k] + share * (far[k] - near[k]))
    }
}

impl Level {
    fn bilinear(&self, uv: [f32; 2]) -> [f32; 3] {
        let axis = |k: usize| {
            let side = self.size[k];
            // Brought into one period first: a large coordinate would leave no digits for the weight.
            let x = (uv[k] - uv[k].floor()) * side as f32 - 0.5;
            let low = x.floor();
            let first = (low as i64).rem_euclid(i64::from(side)) as usize;
            (first, (first + 1) % side as usize, x - low)
        };
        let ((x0, x1, tx), (y0, y1, ty)) = (axis(0), axis(1));
        let width = self.size[0] as usize;
        let texel = |x: usize, y: usize| {
            let [r, g, b, _] = self.texels[y * width + x];
            [decode(r), decode(g), decode(b)]
        };
        let (p, q, r, s) = (texel(x0, y0), texel(x1, y0), texel(x0, y1), texel(x1, y1));
        std::array::from_fn(|k| {
            let top = p[k] + tx * (q[k] - p[k]);
            let bottom = r[k] + tx * (s[k] - r[k]);
            top + ty * (bottom - top)
        })
    }

    /// The next level: each texel is the average of the area it covers, in linear light. With an odd side a texel
    /// covers three texels in part.
    fn halved(&self) -> Self {
        let size = self.size.map(|side| (side / 2).max(1));
        let columns: Vec<_> = (0..size[0])
            .map(|x| taps(x, self.size[0], size[0]))
            .collect();
        let width = self.size[0] as usize;
        let mut texels = vec![[255; 4]; size[0] as usize * size[1] as usize];
        texels
            .par_chunks_mut(size[0] as usize)
            .enumerate()
            .for_each(|(y, row)| {
                let (top, down) = taps(y as u32, self.size[1], size[1]);
                for (texel, (left, across)) in row.iter_mut().zip(&columns) {
                    let mut sum = [0.0; 3];
                    for (j, &wy) in down.iter().enumerate().filter(|(_, w)| **w > 0.0) {
                        for (i, &wx) in across.iter().enumerate().filter(|(_, w)| **w > 0.0) {
                            let from = self.texels[(top + j) * width + left + i];
                            for k in 0..3 {
                                sum[k] += wx * wy * decode(from[k]);
                            }
                        }
                    }
                    *texel = [encode(sum[0]), encode(sum[1]), encode(sum[2]), 255];
                }
            });
        Self { size, texels }
    }
}

/// The first of up to three texels that a texel of the next level covers, and their weights.
fn taps(index: u32, from: u32, to: u32) -> (usize, [f32; 3]) {
    let scale = f64::from(from) / f64::from(to);
    let (start, end) = (f64::from(index) * scale, f64::from(index + 1) * scale);
    let first = start.floor();
    let weights = std::array::from_fn(|k| {
        let low = first + k as f64;
        let covered = (end.min(low + 1.0) - start.max(low)).max(0.0);
        // What rounding leaves over is no texel.
        if covered > 1e-6 && low < f64::from(from) {
            (covered / scale) as f32
        } else {
            0.0
        }
    });
    (first as usize, weights)
}

fn over_white([r, g, b, a]: [u8; 4]) -> [u8; 4] {
    if a == 255 {
        return [r, g, b, a];
    }
    let alpha = f32::from(a) / 255.0;
    let [r, g, b] = [r, g, b].map(|c| encode(1.0 + alpha * (decode(c) - 1.0)));
    [r, g, b, 255]
}

impl fmt::Display for TextureError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unreadable { path, message } => {
                write!(f, "the image {} cannot be read: {message}", path.display())
            }
            Self::NotAnImage { path, message } => {
                write!(
                    f,
                    "{} is not a PNG or JPEG image that can be read: {message}",
                    path.display()
                )
            }
            Self::TooLarge { path } => {
                write!(
                    f,
                    "the image {} is too large: each side may have {MAX_FILE_SIDE} pixels",
                    path.display()
                )
            }
        }
    }
}

impl std::error::Error for TextureError {}
