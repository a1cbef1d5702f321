//! The parts of a picture that lines cross. In: segments. Out: whether they cross a rectangle, so that words are placed beside
//! them.

use crate::point::PixelPoint;

/// The side of a cell in pixels.
const CELL: f64 = 4.0;

/// Square cells of a picture, and whether a line crosses them.
#[derive(Clone, Debug)]
pub(crate) struct LineMap {
    /// The number of cells in a row, and of rows.
    cells: [usize; 2],
    is_crossed: Vec<bool>,
}

impl LineMap {
    /// The map of a picture of this size in pixels, without lines.
    pub(crate) fn new(size: [u32; 2]) -> Self {
        let cells = size.map(|side| (f64::from(side) / CELL).ceil() as usize);
        Self {
            cells,
            is_crossed: vec![false; cells[0] * cells[1]],
        }
    }

    /// Adds a segment, the part of it that is in the picture.
    pub(crate) fn add(&mut self, PixelPoint(a): PixelPoint, PixelPoint(b): PixelPoint) {
        let [mut from, mut to] = [0.0_f64, 1.0_f64];
        for k in 0..2 {
            let way = b[k] - a[k];
            let far = CELL * self.cells[k] as f64;
            // The shares of the way at which it enters and leaves; all of it or nothing if it runs along the border.
            let shares = [0.0, far].map(|border| (border - a[k]) / way);
            let [enters, leaves] = match way {
                0.0 if (0.0..far).contains(&a[k]) => continue,
                way if way < 0.0 => [shares[1], shares[0]],
                _ => shares,
            };
            (from, to) = (from.max(enters), to.min(leaves));
        }
        let way = [0, 1].map(|k| (b[k] - a[k]) * (to - from));
        let length = way[0].hypot(way[1]);
        if from > to || !length.is_finite() {
            return;
        }
        let count = (2.0 * length / CELL).ceil().max(1.0);
        for n in 0..=count as u32 {
            let share = from + (to - from) * f64::from(n) / count;
            let cell = [0, 1].map(|k| ((a[k] + share * (b[k] - a[k])) / CELL) as usize);
            if cell[0] < self.cells[0] && cell[1] < self.cells[1] {
                self.is_crossed[cell[1] * self.cells[0] + cell[0]] = true;
            }
        }
    }

    /// Returns true if a line crosses a part of the picture: left, top, right, bottom in pixels.
    pub(crate) fn crosses(&self, [left, top, right, bottom]: [f32; 4]) -> bool {
        // (A conversion saturates.)
        let cell = |x: f32| (f64::from(x) / CELL) as usize;
        let end = |x: f32, k: usize| (cell(x) + 1).min(self.cells[k]);
        let mut rows = cell(top)..end(bottom, 1);
        let columns = cell(left)..end(right, 0);
        rows.any(|row| {
            let mut cells = columns.clone().map(|column| row * self.cells[0] + column);
            cells.any(|cell| self.is_crossed[cell])
        })
    }
}

#[cfg(test)]
mod tests {
    use super::{LineMap, PixelPoint};

    #[test]
    fn a_segment_crosses_the_cells_along_it() {
        let mut map = LineMap::new([100, 80]);
        let [whole, below] = [[0.0, 0.0, 100.0, 80.0], [0.0, 44.0, 100.0, 80.0]];
        // Nothing of these is in the picture.
        for [a, b] in [
            [[-5.0, -5.0], [-1.0, 90.0]],
            [[10.0, 200.0], [90.0, 200.0]],
            [[f64::NAN, 0.0], [50.0, 10.0]],
            [[-50.0, 100.0], [60.0, 300.0]],
        ] {
            map.add(PixelPoint(a), PixelPoint(b));
        }
        assert!(!map.crosses(whole));
        // From far outside, through the middle of the picture.
        map.add(PixelPoint([-1e9, 42.0]), PixelPoint([1e9, 42.0]));
        assert!(map.crosses(whole) && !map.crosses(below));
        for column in 0..25 {
            let left = 4.0 * column as f32;
            assert!(map.crosses([left, 40.0, left + 1.0, 41.0]), "{column}");
        }
        map.add(PixelPoint([10.0, 60.0]), PixelPoint([10.0, 60.0]));
        assert!(map.crosses([8.0, 58.0, 11.0, 61.0]) && map.crosses(below));
    }
}
