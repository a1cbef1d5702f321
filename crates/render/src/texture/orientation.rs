//! The image that shows orientation: named cells, drawn in code.
//!
//! The names, the hue (it follows u and closes after one turn) and the lightness (it follows v) distinguish left from right
//! and up from down. Names are written for a reader who sees u increase to the right and v upwards: they read correctly in a
//! geodesic view, and in space from the side that σu×σv points to; a flipped surface shows them mirrored. They are drawn
//! from strokes with round ends, so that they stay smooth when enlarged. A surface that is much longer one way has more cells
//! that way, so that none is so long that its name cannot be read.

use image::RgbaImage;
use rayon::prelude::*;

use super::proportions::{MOST_CELLS, Proportions};
use crate::style::encode;

/// The number of texels along a cell's side.
const CELL: u32 = 128;
/// Half the width of the lines between cells, in texels.
const LINE: f32 = 1.6;
/// Half the width of the lines along the image's own edges, which are the domain's ends.
const EDGE: f32 = 3.4;
/// The length of the ticks that mark a cell's halves, in texels.
const TICK: f32 = 11.0;
/// The number of texels per unit of a glyph's box, which is 4 wide and 6 high.
const SCALE: f32 = 8.0;
/// The same in a name of three glyphs.
const SMALL_SCALE: f32 = 6.4;
/// Half the width of a stroke, in units of a glyph's box.
const STROKE: f32 = 0.5;
/// The distance from the left of one letter to that of the next, in units of a glyph's box.
const ADVANCE: f32 = 5.7;

/// Returns the image, with [`CELL`] texels along each side of a cell. With `from_behind`, the names in the cells are flipped.
pub(super) fn image(proportions: Proportions, from_behind: bool) -> RgbaImage {
    let cells = proportions.cells();
    let [columns, rows] = cells;
    let size = cells.map(|count| count * CELL);
    let names: Vec<Name> = (0..columns * rows)
        .map(|cell| Name::new(cell % columns, cell / columns))
        .collect();
    let [columns_lines, rows_lines] = size.map(|side| -> Vec<LineShares> {
        let lines = (0..side).map(|x| LineShares::at(x, side));
        lines.collect()
    });
    let mut image = RgbaImage::new(size[0], size[1]);
    image
        .par_chunks_mut(4 * size[0] as usize)
        .enumerate()
        .for_each(|(y, texels)| {
            let (y, down) = (y as u32, &rows_lines[y]);
            let row = y / CELL;
            let py = (y % CELL) as f32 + 0.5;
            let py = if from_behind { py } else { CELL as f32 - py };
            let parts = texels.chunks_exact_mut(4 * CELL as usize);
            for (column, texels) in (0..columns).zip(parts) {
                let name = NameRow::new(&names[(row * columns + column) as usize], py);
                let hue = hue(column, columns);
                let (paper, ink) = (paper_colour(hue, row, rows), oklch(0.24, 0.05, hue));
                let plain = paper.map(encode);
                let across = &columns_lines[(column * CELL) as usize..];
                let places = (0..CELL).zip(across).zip(texels.chunks_exact_mut(4));
                for ((x, across), texel) in places {
                    let (inked, lined) = (name.ink(x as f32 + 0.5), across.with(down));
                    // Most texels are neither.
                    let [r, g, b] = if inked == 0.0 && lined == 0.0 {
                        plain
                    } else {
                        mix(mix(paper, ink, 0.9 * inked), [1.0; 3], lined).map(encode)
                    };
                    texel.copy_from_slice(&[r, g, b, 255]);
                }
            }
        });
    image
}

fn hue(column: u32, columns: u32) -> f32 {
    // The hue starts at a warm red and closes after one turn.
    25.0 + 360.0 * column as f32 / columns as f32
}

fn paper_colour(hue: f32, row: u32, rows: u32) -> [f32; 3] {
    let lightness = 0.885 - 0.255 * row as f32 / (rows - 1) as f32;
    oklch(lightness, 0.086, hue)
}

/// The fractions of a texel covered by grid lines across one of the image's axes.
struct LineShares {
    /// Lines between cells, and the image's own edges.
    line: f32,
    /// The line through the middle of a cell.
    middle: f32,
    /// The strip beside a line between cells that a tick reaches into.
    border: f32,
}

impl LineShares {
    /// Returns the fractions at a column, or a row, of an image with this side.
    fn at(x: u32, side: u32) -> Self {
        let side = side as f32;
        let x = x as f32 + 0.5;
        let to_edge = x.min(side - x);
        let in_cell = x % CELL as f32;
        let to_line = in_cell.min(CELL as f32 - in_cell);
        let to_middle = (in_cell - 0.5 * CELL as f32).abs();
        let strong = coverage(to_line - LINE).max(coverage(to_edge - EDGE));
        Self {
            line: 0.92 * strong,
            middle: coverage(to_middle - 1.0),
            border: coverage(to_line - TICK),
        }
    }

    /// Returns the fraction of a texel in a column and a row. Ticks at the border mark the halves: a line across would run
    /// through the name.
    fn with(&self, row: &Self) -> f32 {
        let ticks = (self.middle * row.border).max(row.middle * self.border);
        self.line.max(row.line).max(0.6 * ticks)
    }
}

/// Returns the fraction of a texel inside a shape whose border is at this signed distance.
fn coverage(distance: f32) -> f32 {
    (0.5 - distance).clamp(0.0, 1.0)
}

/// The name of a cell.
struct Name {
    segments: Vec<Segment>,
    /// Its width, in units of a glyph's box.
    width: f32,
    /// The number of texels of such a unit.
    scale: f32,
}

/// The name of a cell along a row of its texels.
struct NameRow<'a> {
    name: &'a Name,
    /// The strokes that may touch the row.
    strokes: Vec<Segment>,
    /// The row, in units of a glyph's box.
    y: f32,
}

impl<'a> NameRow<'a> {
    /// Returns the strokes of a name near the row `y`, in texels.
    fn new(name: &'a Name, y: f32) -> Self {
        let y = (y - 0.5 * CELL as f32) / name.scale + 3.0;
        // Half a stroke's width, and a texel in which it fades.
        let reach = STROKE + 1.0 / name.scale;
        let near = |&[_, a, _, b]: &Segment| a.min(b) - reach <= y && y <= a.max(b) + reach;
        let strokes = name.segments.iter().copied().filter(|it| near(it));
        Self {
            name,
            strokes: strokes.collect(),
            y,
        }
    }

    /// Returns the fraction of ink at the position `x` of the row, in texels.
    fn ink(&self, x: f32) -> f32 {
        let Name { width, scale, .. } = *self.name;
        let x = (x - 0.5 * CELL as f32) / scale + 0.5 * width;
        if !(-1.0..=width + 1.0).contains(&x) {
            return 0.0;
        }
        let nearest = self
            .strokes
            .iter()
            .map(|segment| distance(segment, x, self.y))
            .fold(f32::INFINITY, f32::min);
        coverage((nearest - STROKE) * scale)
    }
}

type Segment = [f32; 4];

fn distance([x0, y0, x1, y1]: &Segment, x: f32, y: f32) -> f32 {
    let (dx, dy) = (x1 - x0, y1 - y0);
    let square = dx * dx + dy * dy;
    let t = if square > 0.0 {
        (((x - x0) * dx + (y - y0) * dy) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    // `hypot` is slow in WebAssembly, and these numbers are too small to overflow.
    let [across, down] = [x - x0 - t * dx, y - y0 - t * dy];
    (across * across + down * down).sqrt()
}

/// A part of a glyph, in a box 4 wide and 6 high, y downwards.
enum Stroke {
    /// A polyline.
    Line(&'static [[f32; 2]]),
    /// Centre, radii, and first and last angle in degrees; 0 is right, 90 is down.
    Arc([f32; 6]),
}

impl Name {
    /// Creates the name of a cell: the column's letter and the row's number.
    fn new(column: u32, row: u32) -> Self {
        let number = row + 1;
        let figures = [number / 10, number % 10].map(|figure| FIGURES[figure as usize]);
        let shown = &figures[usize::from(number < 10)..];
        let mut segments = Vec::new();
        let mut left = 0.0;
        for glyph in [&LETTERS[column as usize]].into_iter().chain(shown) {
            for stroke in *glyph {
                let points: Vec<[f32; 2]> = match stroke {
                    Stroke::Line(points) => points.to_vec(),
                    Stroke::Arc([cx, cy, rx, ry, from, to]) => {
                        let steps = ((to - from).abs() / 12.0).ceil() as u32;
                        let place = |k: u32| {
                            let angle = (from + (to - from) * k as f32 / steps as f32).to_radians();
                            [cx + rx * angle.cos(), cy + ry * angle.sin()]
                        };
                        (0..=steps).map(place).collect()
                    }
                };
                for pair in points.windows(2) {
                    segments.push([pair[0][0] + left, pair[0][1], pair[1][0] + left, pair[1][1]]);
                }
            }
            left += ADVANCE;
        }
        Self {
            segments,
            width: ADVANCE * shown.len() as f32 + 4.0,
            scale: if number < 10 { SCALE } else { SMALL_SCALE },
        }
    }
}

use Stroke::{Arc, Line};

/// The letters A to X.
const LETTERS: [&[Stroke]; MOST_CELLS as usize] = [
    &[
        Line(&[[0.0, 6.0], [2.0, 0.0], [4.0, 6.0]]),
        Line(&[[0.7, 4.0], [3.3, 4.0]]),
    ],
    &[
        Line(&[[2.2, 0.0], [0.2, 0.0], [0.2, 6.0], [2.4, 6.0]]),
        Line(&[[0.2, 2.85], [2.4, 2.85]]),
        Arc([2.2, 1.425, 1.45, 1.425, -90.0, 90.0]),
        Arc([2.4, 4.425, 1.6, 1.575, -90.0, 90.0]),
    ],
    &[Arc([2.2, 3.0, 2.1, 3.0, 48.0, 312.0])],
    &[
        Line(&[[1.5, 0.0], [0.2, 0.0], [0.2, 6.0], [1.5, 6.0]]),
        Arc([1.5, 3.0, 2.5, 3.0, -90.0, 90.0]),
    ],
    &[
        Line(&[[3.7, 0.0], [0.3, 0.0], [0.3, 6.0], [3.7, 6.0]]),
        Line(&[[0.3, 2.9], [3.1, 2.9]]),
    ],
    &[
        Line(&[[3.7, 0.0], [0.4, 0.0], [0.4, 6.0]]),
        Line(&[[0.4, 2.9], [3.1, 2.9]]),
    ],
    &[
        Arc([2.1, 3.0, 2.1, 3.0, 0.0, 312.0]),
        Line(&[[4.2, 3.1], [2.6, 3.1]]),
    ],
    &[
        Line(&[[0.1, 0.0], [0.1, 6.0]]),
        Line(&[[3.9, 0.0], [3.9, 6.0]]),
        Line(&[[0.1, 2.9], [3.9, 2.9]]),
    ],
    &[Line(&[[2.0, 0.0], [2.0, 6.0]])],
    &[
        Line(&[[3.2, 0.0], [3.2, 4.3]]),
        Arc([1.75, 4.3, 1.45, 1.7, 0.0, 165.0]),
    ],
    &[
        Line(&[[0.3, 0.0], [0.3, 6.0]]),
        Line(&[[3.9, 0.0], [0.3, 3.7]]),
        Line(&[[1.6, 2.5], [4.1, 6.0]]),
    ],
    &[Line(&[[0.5, 0.0], [0.5, 6.0], [3.7, 6.0]])],
    &[Line(&[
        [0.0, 6.0],
        [0.0, 0.0],
        [2.0, 4.0],
        [4.0, 0.0],
        [4.0, 6.0],
    ])],
    &[Line(&[[0.1, 6.0], [0.1, 0.0], [3.9, 6.0], [3.9, 0.0]])],
    &[Arc([2.0, 3.0, 2.1, 3.0, 0.0, 360.0])],
    &[
        Line(&[[2.3, 0.0], [0.3, 0.0], [0.3, 6.0]]),
        Line(&[[0.3, 3.3], [2.3, 3.3]]),
        Arc([2.3, 1.65, 1.6, 1.65, -90.0, 90.0]),
    ],
    &[
        Arc([2.0, 3.0, 2.1, 3.0, 0.0, 360.0]),
        Line(&[[2.5, 4.4], [4.2, 6.4]]),
    ],
    &[
        Line(&[[2.3, 0.0], [0.3, 0.0], [0.3, 6.0]]),
        Line(&[[0.3, 3.1], [2.3, 3.1]]),
        Arc([2.3, 1.55, 1.6, 1.55, -90.0, 90.0]),
        Line(&[[2.3, 3.1], [4.0, 6.0]]),
    ],
    &[
        Arc([2.0, 1.45, 1.7, 1.45, -330.0, -90.0]),
        Arc([2.0, 4.45, 1.85, 1.55, -90.0, 160.0]),
    ],
    &[
        Line(&[[-0.1, 0.0], [4.1, 0.0]]),
        Line(&[[2.0, 0.0], [2.0, 6.0]]),
    ],
    &[
        Line(&[[0.2, 0.0], [0.2, 4.2]]),
        Line(&[[3.8, 0.0], [3.8, 4.2]]),
        Arc([2.0, 4.2, 1.8, 1.8, 0.0, 180.0]),
    ],
    &[Line(&[[0.0, 0.0], [2.0, 6.0], [4.0, 0.0]])],
    &[Line(&[
        [-0.4, 0.0],
        [0.9, 6.0],
        [2.0, 1.6],
        [3.1, 6.0],
        [4.4, 0.0],
    ])],
    &[
        Line(&[[0.1, 0.0], [3.9, 6.0]]),
        Line(&[[3.9, 0.0], [0.1, 6.0]]),
    ],
];

/// The figures 0 to 9.
const FIGURES: [&[Stroke]; 10] = [
    &[Arc([2.0, 3.0, 1.9, 3.0, 0.0, 360.0])],
    &[
        Line(&[[0.9, 1.4], [2.3, 0.0], [2.3, 6.0]]),
        Line(&[[0.9, 6.0], [3.7, 6.0]]),
    ],
    &[
        Arc([2.0, 1.8, 1.85, 1.8, 190.0, 395.0]),
        Line(&[[3.52, 2.83], [0.2, 6.0], [4.0, 6.0]]),
    ],
    &[
        Arc([1.9, 1.45, 1.65, 1.45, 205.0, 450.0]),
        Arc([1.9, 4.45, 1.95, 1.55, -90.0, 155.0]),
    ],
    &[Line(&[[3.0, 6.0], [3.0, 0.0], [0.0, 4.2], [4.1, 4.2]])],
    &[
        Line(&[[3.6, 0.0], [0.6, 0.0], [0.4, 2.75]]),
        Arc([1.95, 4.05, 2.0, 1.95, 220.0, 508.0]),
    ],
    &[
        Arc([2.0, 4.1, 1.9, 1.9, 0.0, 360.0]),
        Arc([3.5, 4.1, 3.4, 4.1, 180.0, 268.0]),
    ],
    &[Line(&[[0.1, 0.0], [3.9, 0.0], [1.5, 6.0]])],
    &[
        Arc([2.0, 1.45, 1.6, 1.45, 0.0, 360.0]),
        Arc([2.0, 4.45, 1.95, 1.55, 0.0, 360.0]),
    ],
    &[
        Arc([2.0, 1.9, 1.9, 1.9, 0.0, 360.0]),
        Arc([0.5, 1.9, 3.4, 4.1, 0.0, 88.0]),
    ],
];

fn mix(a: [f32; 3], b: [f32; 3], share: f32) -> [f32; 3] {
    std::array::from_fn(|k| a[k] + share * (b[k] - a[k]))
}

/// Converts Oklch (Ottosson 2020; hue in degrees) to linear sRGB.
fn oklch(lightness: f32, chroma: f32, hue: f32) -> [f32; 3] {
    let (sin, cos) = hue.to_radians().sin_cos();
    let (a, b) = (chroma * cos, chroma * sin);
    let l = (lightness + 0.396_337_78 * a + 0.215_803_76 * b).powi(3);
    let m = (lightness - 0.105_561_346 * a - 0.063_854_17 * b).powi(3);
    let s = (lightness - 0.089_484_18 * a - 1.291_485_5 * b).powi(3);
    [
        4.076_741_7 * l - 3.307_711_6 * m + 0.230_969_94 * s,
        -1.268_438 * l + 2.609_757_4 * m - 0.341_319_4 * s,
        -0.004_196_086 * l - 0.703_418_6 * m + 1.707_614_7 * s,
    ]
}
