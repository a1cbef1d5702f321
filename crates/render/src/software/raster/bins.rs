//! The triangles that touch each tile.

use super::tile::TILE;
use crate::software::mesh::{Mesh, SUBPIXEL};

/// A mesh's triangles by tile.
pub(super) struct Bins {
    /// The index of each tile's first triangle, and a final entry with their total number.
    starts: Vec<u32>,
    /// The triangles whose box touches the tile, in order.
    triangles: Vec<u32>,
}

impl Bins {
    /// Creates bins for `across` by `down` tiles, the first of which begins at row `top` of the picture.
    pub(super) fn new(mesh: &Mesh, across: usize, down: usize, top: usize) -> Self {
        let side = TILE as i32 * SUBPIXEL;
        let top = top as i32 * SUBPIXEL;
        let tiles = |triangle: &[u32; 3]| {
            let corners = triangle.map(|c| mesh.corners[c as usize].at);
            [(0, 0, across), (1, top, down)].map(|(k, start, tiles)| {
                let low = corners.iter().map(|at| at[k]).min().unwrap_or(0) - start;
                let high = corners.iter().map(|at| at[k]).max().unwrap_or(0) - start;
                low.div_euclid(side).max(0)..(high.div_euclid(side) + 1).min(tiles as i32)
            })
        };
        let each = |triangle: &[u32; 3], visit: &mut dyn FnMut(usize)| {
            let [columns, rows] = tiles(triangle);
            for y in rows {
                for x in columns.clone() {
                    visit(y as usize * across + x as usize);
                }
            }
        };
        let mut starts = vec![0; across * down + 1];
        for triangle in &mesh.triangles {
            each(triangle, &mut |tile| starts[tile + 1] += 1);
        }
        for tile in 0..across * down {
            starts[tile + 1] += starts[tile];
        }
        let mut next = starts.clone();
        let mut triangles = vec![0; starts[across * down] as usize];
        for (number, triangle) in (0..).zip(&mesh.triangles) {
            each(triangle, &mut |tile| {
                triangles[next[tile] as usize] = number;
                next[tile] += 1;
            });
        }
        Self { starts, triangles }
    }

    /// Returns the triangles of a tile.
    pub(super) fn list(&self, tile: usize) -> &[u32] {
        &self.triangles[self.starts[tile] as usize..self.starts[tile + 1] as usize]
    }
}
