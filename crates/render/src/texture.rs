//! Images on surfaces: loading, mip chains, filtering.
//!
//! An image's left side is u min, its top row v min; one width of the image is one width of the domain. It repeats beyond
//! glued sides, and ends at others ([`SurfaceImage`]). Texels are opaque sRGB; filtering is done in linear light, so that a fine checkerboard keeps its brightness.

mod budget;
mod curvature;
mod filter;
mod instances;
mod named;
mod orientation;
mod proportions;
mod surface_image;

pub use budget::{MAX_TOTAL_TEXELS, TexelBudget};
pub use curvature::CurvatureScale;
pub use filter::Sampler;
pub(crate) use filter::{threshold, thresholds};
pub(crate) use instances::{MOST_INSTANCES, side};
pub use named::{missing_file, named_file, named_files};
pub use proportions::Proportions;
pub use surface_image::SurfaceImage;

use std::fmt;
use std::io::{BufRead, Cursor, Seek};
use std::path::{Path, PathBuf};
use std::sync::{Arc, OnceLock};

use image::{DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits, RgbaImage};
use rayon::prelude::*;

use crate::style::{DARK_SQUARE, decode, encode};

/// The longest side of an image file in pixels.
pub const MAX_FILE_SIDE: u32 = 32_768;
/// The maximum number of pixels of an image file: a file of some kilobytes may decode to any number of them.
pub const MAX_FILE_PIXELS: u64 = 1 << 26;
/// The longest side of a texture in texels; a larger image is reduced to it.
pub const MAX_SIDE: u32 = 8_192;
/// The approximate maximum number of texels of a texture; a larger image is reduced to it. A picture that shows it needs 16
/// bytes for each texel: 4 for its colour, 8 for that in linear light, and a third more for the smaller levels.
pub const MAX_TEXELS: u32 = 1 << 25;
/// The maximum memory for decoding one image, in bytes.
const MAX_BYTES: u64 = 1 << 30;

/// An image with its mip chain.
#[derive(Clone, Debug)]
pub struct Texture {
    levels: Vec<Level>,
    /// The image in linear light, made on first use; a GPU does not need it.
    light: OnceLock<filter::LinearTexels>,
    /// The results of [`Texture::cover`].
    covers: [OnceLock<Arc<Texture>>; 3],
    /// The result of [`Texture::flipped`].
    flipped: OnceLock<Arc<Texture>>,
    /// The file from which it was read.
    file: Option<PathBuf>,
    /// Its share of the texels of all images.
    _share: Option<Arc<budget::Share>>,
    /// The scale of the colours, for a texture that shows the curvature.
    scale: Option<CurvatureScale>,
    /// The images of the second and further instances of the surface; none if all show this one.
    further: Vec<Arc<Texture>>,
}

impl PartialEq for Texture {
    fn eq(&self, other: &Self) -> bool {
        self.levels == other.levels && self.further == other.further
    }
}

/// One level of a mip chain.
#[derive(Clone, Debug, PartialEq)]
pub struct Level {
    /// Width and height in texels.
    pub size: [u32; 2],
    /// sRGB and an alpha of 255, row by row from the top.
    pub texels: Vec<[u8; 4]>,
}

/// The reason why a file could not be loaded.
#[derive(Clone, Debug, PartialEq)]
pub enum TextureError {
    /// The file cannot be read.
    Unreadable {
        /// The file.
        path: PathBuf,
        /// The system's message.
        message: String,
    },
    /// The file is not a PNG or JPEG image, or it is damaged.
    NotAnImage {
        /// The file.
        path: PathBuf,
        /// The decoder's message.
        message: String,
    },
    /// The image has too many pixels.
    TooLarge {
        /// The file.
        path: PathBuf,
    },
}

impl Texture {
    /// Reads a PNG or JPEG file, which must be a regular file: a pipe might never end. Transparent pixels show white. An
    /// image with more texels than the budget allows is reduced.
    ///
    /// # Errors
    /// See [`TextureError`].
    pub fn load(path: &Path, budget: &TexelBudget) -> Result<Self, TextureError> {
        let unreadable = |error: std::io::Error| TextureError::Unreadable {
            path: path.to_owned(),
            message: error.to_string(),
        };
        if !std::fs::metadata(path).map_err(unreadable)?.is_file() {
            let sentence = "it is not a regular file";
            return Err(unreadable(std::io::Error::other(sentence)));
        }
        Self::read(ImageReader::open(path).map_err(unreadable)?, path, budget)
    }

    /// Reads the bytes of a PNG or JPEG file, as [`Texture::load`] does; `path` is its name.
    ///
    /// # Errors
    /// See [`TextureError`].
    pub fn decode(bytes: &[u8], path: &Path, budget: &TexelBudget) -> Result<Self, TextureError> {
        Self::read(ImageReader::new(Cursor::new(bytes)), path, budget)
    }

    fn read<R: BufRead + Seek>(
        reader: ImageReader<R>,
        path: &Path,
        budget: &TexelBudget,
    ) -> Result<Self, TextureError> {
        let too_large = || TextureError::TooLarge {
            path: path.to_owned(),
        };
        let unreadable = |error: std::io::Error| TextureError::Unreadable {
            path: path.to_owned(),
            message: error.to_string(),
        };
        let mut limits = Limits::default();
        limits.max_image_width = Some(MAX_FILE_SIDE);
        limits.max_image_height = Some(MAX_FILE_SIDE);
        limits.max_alloc = Some(MAX_BYTES);
        let mut reader = reader.with_guessed_format().map_err(unreadable)?;
        // Other formats are decoded for animations only.
        let other = match reader.format() {
            Some(ImageFormat::Png | ImageFormat::Jpeg) => None,
            Some(format) => {
                let name = format.extensions_str().first().unwrap_or(&"strange");
                Some(format!("it is a {} file", name.to_uppercase()))
            }
            None => Some("its first bytes are those of no image format".to_owned()),
        };
        if let Some(message) = other {
            return Err(TextureError::NotAnImage {
                path: path.to_owned(),
                message,
            });
        }
        reader.limits(limits);
        let refused = |error| match error {
            image::ImageError::Limits(_) => too_large(),
            image::ImageError::IoError(error)
                if error.kind() != std::io::ErrorKind::UnexpectedEof =>
            {
                unreadable(error)
            }
            other => TextureError::NotAnImage {
                path: path.to_owned(),
                message: other.to_string(),
            },
        };
        // The header suffices to refuse an image that is too large.
        let decoder = reader.into_decoder().map_err(refused)?;
        let (width, height) = decoder.dimensions();
        if u64::from(width) * u64::from(height) > MAX_FILE_PIXELS {
            return Err(too_large());
        }
        let turn = budget.turn();
        let image = DynamicImage::from_decoder(decoder).map_err(refused)?;
        let texture = Self::within(image.into_rgba8(), turn.most());
        let texels = texture.levels[0].texels.len() as u32;
        Ok(Self {
            file: Some(path.to_owned()),
            _share: Some(Arc::new(turn.take(texels))),
            ..texture
        })
    }

    /// Creates a texture from an image with at least one pixel (an empty one becomes a white texel). Transparent pixels show
    /// white; an image with a side longer than [`MAX_SIDE`], or with more texels than [`MAX_TEXELS`], is reduced.
    pub fn from_image(image: RgbaImage) -> Self {
        Self::within(image, MAX_TEXELS)
    }

    /// Creates a texture with about `most_texels` texels at most.
    fn within(image: RgbaImage, most_texels: u32) -> Self {
        let size = [image.width(), image.height()];
        // In place: a large image needs a quarter of a gigabyte.
        let mut texels: Vec<[u8; 4]> =
            bytemuck::cast_slice_box(image.into_raw().into_boxed_slice()).into_vec();
        for texel in &mut texels {
            *texel = over_white(*texel);
        }
        if texels.is_empty() {
            let (size, texels) = ([1, 1], vec![[255; 4]]);
            return Self::chain(Level { size, texels });
        }
        let image = Level { size, texels };
        let scale = scale_to_fit(size, most_texels);
        if scale == 1.0 {
            return Self::chain(image);
        }
        let reduced = |side: u32| (f64::from(side) * scale).round().max(1.0) as u32;
        Self::chain(image.reduced(size.map(reduced)))
    }

    /// Creates a texture of opaque sRGB texels, row by row from v min, each row from u min; their number must match the
    /// size.
    pub(crate) fn of_texels(size: [u32; 2], texels: Vec<[u8; 4]>) -> Self {
        Self::chain(Level { size, texels })
    }

    fn chain(first: Level) -> Self {
        let mut levels = vec![first];
        while let Some(last) = levels.last().filter(|level| level.size != [1, 1]) {
            let next = last.reduced(last.size.map(|side| (side / 2).max(1)));
            levels.push(next);
        }
        Self {
            levels,
            light: OnceLock::new(),
            covers: Default::default(),
            flipped: OnceLock::new(),
            file: None,
            _share: None,
            scale: None,
            further: Vec::new(),
        }
    }

    /// Returns a white texture, which leaves a surface's colour unchanged.
    pub fn plain() -> Arc<Self> {
        static PLAIN: OnceLock<Arc<Texture>> = OnceLock::new();
        PLAIN
            .get_or_init(|| Arc::new(Self::from_image(RgbaImage::new(0, 0))))
            .clone()
    }

    /// Returns a texture of white squares and darker ones, eight along u and along v: they show how a surface of one colour
    /// bends.
    pub fn checker() -> Arc<Self> {
        static CHECKER: OnceLock<Arc<Texture>> = OnceLock::new();
        const SQUARES: u32 = 8;
        const SQUARE: u32 = 128;
        let texel = |x: u32, y: u32| {
            let is_dark = (x / SQUARE + y / SQUARE).is_multiple_of(2);
            let light = if is_dark { DARK_SQUARE } else { 1.0 };
            let [r, g, b] = [encode(light); 3];
            image::Rgba([r, g, b, 255])
        };
        CHECKER
            .get_or_init(|| {
                let side = SQUARES * SQUARE;
                Arc::new(Self::from_image(RgbaImage::from_fn(side, side, texel)))
            })
            .clone()
    }

    /// Returns the file from which the image was read.
    pub fn file(&self) -> Option<&Path> {
        self.file.as_deref()
    }

    /// Returns the texture of surfaces without an image: named cells, A1 at u min and v min; the hue follows u and the
    /// lightness v. The names read correctly if u increases to the right and v upwards, as in a geodesic view, and in space
    /// from the side that σu×σv points to; `from_behind`, from the other side. An even surface has 8 × 8 cells, to H8.
    pub fn orientation(proportions: Proportions, from_behind: bool) -> Arc<Self> {
        static ORIENTATIONS: [OnceLock<Arc<Texture>>; 6] = [const { OnceLock::new() }; 6];
        let index = 2 * proportions as usize + usize::from(from_behind);
        let make = || {
            Arc::new(Self::from_image(orientation::image(
                proportions,
                from_behind,
            )))
        };
        ORIENTATIONS[index].get_or_init(make).clone()
    }

    /// Returns the image upside down.
    pub fn flipped(&self) -> Arc<Self> {
        let make = || {
            let Level { size, texels } = &self.levels[0];
            let rows = texels.chunks(size[0] as usize).rev();
            let texels = rows.flatten().copied().collect();
            let level = Level {
                size: *size,
                texels,
            };
            let further = self.further.iter().map(|it| it.flipped());
            Arc::new(Self {
                further: further.collect(),
                ..Self::chain(level)
            })
        };
        self.flipped.get_or_init(make).clone()
    }

    /// Returns the mip chain: each level is half the size (rounded down) of the previous one, the last 1×1.
    pub fn levels(&self) -> &[Level] {
        &self.levels
    }

    /// Returns the image as it continues beyond the sides of its domain: itself if they wrap without a flip. If the sides of
    /// u are glued with a flip (`flips[0]`), a copy upside down follows, so that the result repeats after two widths;
    /// likewise `flips[1]` for v and left to right. It is made from the largest level with which it has at most
    /// [`MAX_TEXELS`] texels.
    pub fn cover(self: &Arc<Self>, flips: [bool; 2]) -> Arc<Self> {
        let index = match flips {
            [false, false] => return self.clone(),
            [true, false] => 0,
            [false, true] => 1,
            [true, true] => 2,
        };
        let make = || {
            let fits =
                |level: &&Level| level.covered_size(flips).iter().product::<u32>() <= MAX_TEXELS;
            let level = self.levels.iter().find(fits);
            let level = level.expect("a level of one texel fits");
            Arc::new(Self::chain(level.covered(flips)))
        };
        self.covers[index].get_or_init(make).clone()
    }

    /// Returns the colour in linear light at `uv` (1 is the image's width or height; repeats), averaged over a footprint:
    /// the parallelogram that `across` and `along` (in the same units) span around it.
    pub fn sample(&self, uv: [f32; 2], across: [f32; 2], along: [f32; 2]) -> [f32; 3] {
        let sampler = Sampler::new(self, [0.0; 2], [1.0; 2], [true; 2]);
        sampler.colour(uv, across, along)
    }

    fn light(&self) -> &filter::LinearTexels {
        self.light.get_or_init(|| filter::light_of(&self.levels))
    }
}

impl Level {
    /// Returns the size of [`Level::covered`].
    fn covered_size(&self, flips: [bool; 2]) -> [u32; 2] {
        [0, 1].map(|k| self.size[k] << u32::from(flips[k]))
    }

    /// Returns the level, doubled along each axis that flips: beside the image, its flipped copy.
    fn covered(&self, flips: [bool; 2]) -> Self {
        let [width, height] = self.size;
        let size = self.covered_size(flips);
        let texel = |x: u32, y: u32| {
            // A step beyond a side of u flips v, and one beyond a side of v flips u.
            let (over_u, over_v) = (x >= width, y >= height);
            let (x, y) = (x % width, y % height);
            let x = if over_v { width - 1 - x } else { x };
            let y = if over_u { height - 1 - y } else { y };
            self.texels[y as usize * width as usize + x as usize]
        };
        let rows = (0..size[1]).flat_map(|y| (0..size[0]).map(move |x| (x, y)));
        Self {
            size,
            texels: rows.map(|(x, y)| texel(x, y)).collect(),
        }
    }

    /// Returns a smaller level of this size: each texel is the average of the area it covers, in linear light. If an odd
    /// side is halved, a texel covers three texels in part.
    fn reduced(&self, size: [u32; 2]) -> Self {
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
                    for (j, &wy) in down.iter().enumerate() {
                        for (i, &wx) in across.iter().enumerate() {
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

/// Returns the factor that scales the sides of an image to fit into a texture; 1 if it fits.
fn scale_to_fit(size: [u32; 2], most_texels: u32) -> f64 {
    let [width, height] = size.map(f64::from);
    let side = f64::from(MAX_SIDE) / width.max(height);
    side.min((f64::from(most_texels) / (width * height)).sqrt())
        .min(1.0)
}

/// Returns the first of the texels that a texel of a smaller level covers along an axis, and the fraction of each in it.
fn taps(index: u32, from: u32, to: u32) -> (usize, Vec<f32>) {
    let scale = f64::from(from) / f64::from(to);
    let (start, end) = (f64::from(index) * scale, f64::from(index + 1) * scale);
    // A remainder beyond the end is due to rounding, and is not a texel.
    let last = ((end - 1e-6).ceil() as u32).min(from);
    let weights = (start as u32..last).map(|texel| {
        let low = f64::from(texel);
        let covered = (end.min(low + 1.0) - start.max(low)).max(0.0);
        (covered / scale) as f32
    });
    (start as usize, weights.collect())
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
                    "the image {} is too large: it may have {} million pixels, and {MAX_FILE_SIDE} on a side",
                    path.display(),
                    MAX_FILE_PIXELS / 1_000_000
                )
            }
        }
    }
}

impl std::error::Error for TextureError {}
