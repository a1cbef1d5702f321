//! Meshes of solids by dual contouring.
//!
//! In: a solid of a world, a box, a number of cells. Out: triangles. Rays along the lines of the grid give the points and
//! normals where its edges cross the surface. Each patch of the surface in a cell has a vertex at the best common point of
//! the planes at its edges (T. Ju and others, *Dual Contouring of Hermite Data*, 2002), so that sharp edges and corners are
//! preserved; each grid edge that crosses the surface has a polygon of the four patches around it. The patches are those of
//! marching cubes; an ambiguous face is decided by the membership of its centre. If such a face joins two patches twice,
//! each connection has its own vertex, so that the mesh is closed and each of its edges belongs to two triangles.
//!
//! `fidget` has such a mesher for its own shapes in f32; its mesh is not a manifold if a cell holds several patches.

use glam::{DMat3, DVec3};
use rustc_hash::FxHashMap;

use crate::bounds::{BoundingBox, WorkBudget};
use crate::line::Ray;
use crate::world::World;

/// A closed surface of triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SolidMesh {
    /// The vertices.
    pub positions: Vec<DVec3>,
    /// The mean of the normals around each vertex: an outward unit vector.
    pub normals: Vec<DVec3>,
    /// A leaf whose surface contains the vertex; `None` if no ray has met one.
    pub leaves: Vec<Option<usize>>,
    /// The vertices of each triangle, counterclockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// True if parts of the solid are thinner than a cell, so that the mesh lacks them or has holes there.
    pub is_thin: bool,
}

/// Directions whose singular value is below this fraction of the largest do not position a vertex.
const LEAST_SINGULAR: f64 = 0.1;
/// The fractions of a cell by which the grid begins before the box and ends behind it. They keep the faces of solids with
/// round numbers out of the planes of the grid.
const BEFORE: f64 = 0.377;
const BEHIND: f64 = 0.623;
/// A solid is thin if a line passes through it and no corner within this number of cells is inside. Near an edge or a
/// silhouette there is such a corner, unless the solid tapers to an edge of less than about 20 degrees.
const NEAR: usize = 3;
/// A solid is also thin if, along an axis, more than this fraction of its chords contain no corner. Edges and silhouettes of
/// solids a few cells thick stay below it: for a ball of radius r cells the fraction is 1/8r². A shell three quarters of a
/// cell thick reaches it.
const MOST_LOST: f64 = 1.0 / 16.0;
/// The number of bisection steps for the crossing of an edge that no ray has found.
const HALVINGS: u32 = 40;

/// Marks a patch without a vertex.
const NONE: u32 = u32::MAX;

/// A point where an edge of the grid crosses the surface.
#[derive(Clone, Copy, Debug)]
struct EdgeCrossing {
    position: DVec3,
    /// 0 if unknown.
    normal: DVec3,
    leaf: Option<usize>,
}

/// A point where a line of the grid crosses the surface.
#[derive(Clone, Copy, Debug)]
struct LineCrossing {
    /// In steps from the line's first corner.
    along: f64,
    entering: bool,
    place: EdgeCrossing,
}

/// A part of a face's intersection with the surface: the positions of two edges among the face's four.
type Segment = [usize; 2];

struct Contour<'w> {
    world: &'w World,
    solid: usize,
    work: &'w WorkBudget,
    /// The work of deciding whether the solid contains a point, in operations.
    work_on_point: u64,
    lower: DVec3,
    step: f64,
    /// The number of cells along each axis.
    cells: [usize; 3],
    /// True for the corners inside.
    inside: Vec<bool>,
    /// Keyed by the lower corner and the axis.
    edges: FxHashMap<(usize, u8), EdgeCrossing>,
    /// Keyed by the cell: for each of its edges, the vertex of the edge's patch.
    patches: FxHashMap<usize, [u32; 12]>,
    /// Keyed by the cell above an ambiguous face, the face's axis and the first edge of a segment: the vertex of the
    /// segment.
    ways: FxHashMap<(usize, u8, u8), u32>,
    mesh: SolidMesh,
}

/// Makes a mesh of a solid within a box. The cells are cubes, `cells` of them along the longest side. Returns `None`, and
/// uses up `work`, if the mesh takes more work than is left.
pub fn contour(
    world: &World,
    solid: usize,
    bounds: &BoundingBox,
    cells: u32,
    work: &WorkBudget,
) -> Option<SolidMesh> {
    let extent = bounds.upper - bounds.lower;
    let longest = extent.max_element();
    if bounds.is_empty() || !longest.is_finite() || longest <= 0.0 {
        return Some(SolidMesh::default());
    }
    let step = longest / f64::from(cells.max(1));
    let counts = extent
        .to_array()
        .map(|side| (side / step + BEFORE + BEHIND).ceil() as usize + 1);
    let corners: usize = counts.map(|count| count + 1).iter().product();
    let mut contour = Contour {
        world,
        solid,
        work,
        work_on_point: world.work_on_point(solid),
        lower: bounds.lower - BEFORE * step,
        step,
        cells: counts,
        inside: vec![false; corners],
        edges: FxHashMap::default(),
        patches: FxHashMap::default(),
        ways: FxHashMap::default(),
        mesh: SolidMesh::default(),
    };
    contour.cast();
    contour.place_vertices();
    contour.join();
    (!work.is_used_up()).then_some(contour.mesh)
}

impl Contour<'_> {
    /// Returns the position of a corner, or of a point between corners, from its grid coordinates.
    fn place(&self, at: [f64; 3]) -> DVec3 {
        self.lower + self.step * DVec3::from_array(at)
    }

    /// Returns true if the solid contains the point; false once no work is left.
    fn contains(&self, point: DVec3) -> bool {
        self.work.take(self.work_on_point) && self.world.contains(self.solid, point)
    }

    fn corner(&self, [i, j, k]: [usize; 3]) -> usize {
        let [_, ny, nz] = self.cells;
        (i * (ny + 1) + j) * (nz + 1) + k
    }

    fn corner_numbers(&self, corner: usize) -> [usize; 3] {
        let [_, ny, nz] = self.cells;
        [
            corner / ((ny + 1) * (nz + 1)),
            corner / (nz + 1) % (ny + 1),
            corner % (nz + 1),
        ]
    }

    fn cell(&self, [i, j, k]: [usize; 3]) -> usize {
        let [_, ny, nz] = self.cells;
        (i * ny + j) * nz + k
    }

    /// Finds the corners and edges from rays along the lines of the grid; the corners from those along x.
    fn cast(&mut self) {
        let mut caster = self.world.caster();
        let [nx, ny, nz] = self.cells;
        caster.begin_tile(nx * ny + ny * nz + nz * nx);
        let mut operations = 0;
        let mut lines: Vec<(usize, [usize; 3], Vec<LineCrossing>)> = Vec::new();
        for axis in 0..3 {
            let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
            let mut direction = DVec3::ZERO;
            direction[axis] = 1.0;
            for p in 1..self.cells[b] {
                for q in 1..self.cells[c] {
                    let mut first = [0; 3];
                    (first[b], first[c]) = (p, q);
                    let mut start = first.map(|k| k as f64);
                    start[axis] = -1.0;
                    let ray = Ray {
                        origin: self.place(start),
                        direction,
                        leaving: None,
                    };
                    let found = caster.cast(&ray).to_vec();
                    let before = std::mem::replace(&mut operations, caster.operations());
                    if !self.work.take(operations - before) {
                        return;
                    }
                    let found = found.iter().filter(|it| it.solid == self.solid);
                    let found = found.map(|it| LineCrossing {
                        along: it.t / self.step - 1.0,
                        entering: it.entering,
                        place: EdgeCrossing {
                            position: it.position,
                            normal: it.normal,
                            leaf: Some(it.leaf),
                        },
                    });
                    let found: Vec<LineCrossing> = found.collect();
                    if !found.is_empty() {
                        lines.push((axis, first, found));
                    }
                }
            }
        }
        for (_, first, found) in lines.iter().filter(|(axis, ..)| *axis == 0) {
            let mut next = found.iter().peekable();
            let mut inside = false;
            // A mesh that touches the boundary of the grid would not be closed.
            for i in 1..self.cells[0] {
                while let Some(crossing) = next.next_if(|it| it.along <= i as f64) {
                    inside = crossing.entering;
                }
                let corner = self.corner([i, first[1], first[2]]);
                self.inside[corner] = inside;
            }
        }
        self.mesh.is_thin = self.is_thin(&lines);
        self.read_edges(&lines);
    }

    /// Returns true if parts of the solid are thinner than a cell.
    fn is_thin(&self, lines: &[(usize, [usize; 3], Vec<LineCrossing>)]) -> bool {
        let (mut chords, mut lost) = ([0; 3], [0; 3]);
        for (axis, first, found) in lines {
            for pair in found.windows(2).filter(|pair| pair[0].entering) {
                chords[*axis] += 1;
                let [from, to] = [pair[0].along, pair[1].along];
                if from.ceil() < to {
                    continue;
                }
                lost[*axis] += 1;
                let mut low = *first;
                low[*axis] = from.max(0.0) as usize;
                if !self.has_corner_near(low) {
                    return true;
                }
            }
        }
        let mut shares = lost.iter().zip(chords);
        shares.any(|(&lost, chords)| f64::from(lost) > MOST_LOST * f64::from(chords))
    }

    /// Returns true if a corner near this one is inside.
    fn has_corner_near(&self, at: [usize; 3]) -> bool {
        let [x, y, z] = [0, 1, 2].map(|k| {
            let last = self.cells[k];
            at[k].saturating_sub(NEAR)..=(at[k] + NEAR).min(last)
        });
        let mut rows = x.flat_map(|i| y.clone().map(move |j| [i, j]));
        rows.any(|[i, j]| {
            let row = self.corner([i, j, 0]);
            self.inside[row + z.start()..=row + z.end()].contains(&true)
        })
    }

    /// Finds the crossings on the edges whose ends differ.
    fn read_edges(&mut self, lines: &[(usize, [usize; 3], Vec<LineCrossing>)]) {
        let known: FxHashMap<(usize, [usize; 3]), &[LineCrossing]> = lines
            .iter()
            .map(|(axis, first, found)| ((*axis, *first), &found[..]))
            .collect();
        for (low, axis) in self.crossed() {
            let mut first = low;
            first[axis] = 0;
            let found = known.get(&(axis, first)).copied().unwrap_or_default();
            let crossing = self.crossing(low, axis, found);
            self.edges.insert((self.corner(low), axis as u8), crossing);
        }
    }

    /// Returns the edges whose ends differ: the lower corner and the axis of each. The corners at the boundary are outside.
    fn crossed(&self) -> Vec<([usize; 3], usize)> {
        let [nx, ny, nz] = self.cells;
        let mut crossed = Vec::new();
        for i in 0..nx {
            for j in 0..ny {
                for (axis, next) in [[i + 1, j, 0], [i, j + 1, 0], [i, j, 1]]
                    .into_iter()
                    .enumerate()
                {
                    // Most rows of corners are equal to the next ones.
                    let [row, next] = [[i, j, 0], next].map(|first| {
                        let first = self.corner(first);
                        &self.inside[first..first + nz]
                    });
                    if row != next {
                        let pairs = row.iter().zip(next).enumerate();
                        let differ = pairs.filter(|(_, (a, b))| a != b);
                        crossed.extend(differ.map(|(k, _)| ([i, j, k], axis)));
                    }
                }
            }
        }
        crossed
    }

    /// Returns the crossing on an edge whose ends differ; `found` has the crossings of its line.
    fn crossing(&self, low: [usize; 3], axis: usize, found: &[LineCrossing]) -> EdgeCrossing {
        let mut high = low;
        high[axis] += 1;
        let inside = self.inside[self.corner(low)];
        let along = low[axis] as f64;
        let from = found.partition_point(|it| it.along < along);
        let mut on_edge = found[from..]
            .iter()
            .take_while(|it| it.along <= along + 1.0);
        match on_edge.find(|it| it.entering != inside) {
            Some(found) => found.place,
            None => self.halved(low, high, inside),
        }
    }

    /// Returns the point between two corners where membership changes, found by bisection.
    fn halved(&self, low: [usize; 3], high: [usize; 3], inside: bool) -> EdgeCrossing {
        let [mut a, mut b] = [low, high].map(|corner| self.place(corner.map(|k| k as f64)));
        for _ in 0..HALVINGS {
            let middle = 0.5 * (a + b);
            if self.contains(middle) == inside {
                a = middle;
            } else {
                b = middle;
            }
        }
        EdgeCrossing {
            position: 0.5 * (a + b),
            normal: DVec3::ZERO,
            leaf: None,
        }
    }

    /// Returns the crossing of an edge of a cell.
    fn edge(&self, cell: [usize; 3], edge: usize) -> Option<&EdgeCrossing> {
        let axis = edge / 4;
        let mut low = cell;
        low[(axis + 1) % 3] += edge & 1;
        low[(axis + 2) % 3] += edge >> 1 & 1;
        self.edges.get(&(self.corner(low), axis as u8))
    }

    /// Returns the edges of a cell's face in order, as edges of the cell, and the segments in which the surface intersects
    /// the face.
    fn face(&self, cell: [usize; 3], axis: usize, side: usize) -> ([usize; 4], Vec<Segment>) {
        let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
        let edges = [
            4 * b + (side << 1),
            4 * c + (side | 2),
            4 * b + (1 | side << 1),
            4 * c + side,
        ];
        let corner = |p: usize, q: usize| {
            let mut corner = cell;
            corner[axis] += side;
            corner[b] += p;
            corner[c] += q;
            self.inside[self.corner(corner)]
        };
        let inside = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
        let crossing: Vec<usize> = (0..4)
            .filter(|&k| inside[k] != inside[(k + 1) % 4])
            .collect();
        let segments = match crossing[..] {
            [a, b] => vec![[a, b]],
            [_, _, _, _] => {
                let mut middle = cell.map(|k| k as f64);
                middle[axis] += side as f64;
                middle[b] += 0.5;
                middle[c] += 0.5;
                let joined = self.contains(self.place(middle)) == inside[0];
                if joined {
                    vec![[0, 1], [2, 3]]
                } else {
                    vec![[3, 0], [1, 2]]
                }
            }
            _ => Vec::new(),
        };
        (edges, segments)
    }

    /// Gives each patch of each cell a vertex, and likewise each segment of an ambiguous face.
    fn place_vertices(&mut self) {
        for cell in self.active() {
            // The two edges to which the faces connect an edge.
            let mut next = [[usize::MAX; 2]; 12];
            let mut link = |from: usize, to: usize| {
                let place = usize::from(next[from][0] != usize::MAX);
                next[from][place] = to;
            };
            for axis in 0..3 {
                for side in 0..2 {
                    let (edges, segments) = self.face(cell, axis, side);
                    for &[a, b] in &segments {
                        link(edges[a], edges[b]);
                        link(edges[b], edges[a]);
                    }
                    if side == 0 && segments.len() == 2 {
                        for &[a, b] in &segments {
                            let ends = [a, b].map(|k| self.edge(cell, edges[k]).copied());
                            let ends: Vec<EdgeCrossing> = ends.into_iter().flatten().collect();
                            let middle = mean(ends.iter().map(|end| end.position));
                            let vertex = self.vertex(middle, &ends);
                            for k in [a, b] {
                                self.ways
                                    .insert((self.cell(cell), axis as u8, k as u8), vertex);
                            }
                        }
                    }
                }
            }
            let mut patch = [NONE; 12];
            for start in 0..12 {
                if next[start][0] == usize::MAX || patch[start] != NONE {
                    continue;
                }
                let mut members = vec![start];
                let (mut last, mut here) = (start, next[start][0]);
                while here != start && members.len() <= 12 {
                    members.push(here);
                    let onward = next[here];
                    let way = usize::from(onward[0] == last);
                    (last, here) = (here, onward[way]);
                }
                let planes = members.iter().filter_map(|&edge| self.edge(cell, edge));
                let planes: Vec<EdgeCrossing> = planes.copied().collect();
                let position = self.best(cell, &planes);
                let vertex = self.vertex(position, &planes);
                for edge in members {
                    patch[edge] = vertex;
                }
            }
            self.patches.insert(self.cell(cell), patch);
        }
    }

    /// Returns the cells that intersect the surface, those around the edges that cross it, in ascending order.
    fn active(&self) -> Vec<[usize; 3]> {
        let [nx, ny, nz] = self.cells;
        let mut is_active = vec![false; nx * ny * nz];
        for &(corner, axis) in self.edges.keys() {
            let (low, axis) = (self.corner_numbers(corner), usize::from(axis));
            for (p, q) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
                let mut cell = low;
                cell[(axis + 1) % 3] -= p;
                cell[(axis + 2) % 3] -= q;
                is_active[self.cell(cell)] = true;
            }
        }
        let numbers = |cell: usize| [cell / (ny * nz), cell / nz % ny, cell % nz];
        let all = is_active.iter().enumerate();
        all.filter(|(_, active)| **active)
            .map(|(cell, _)| numbers(cell))
            .collect()
    }

    fn vertex(&mut self, position: DVec3, planes: &[EdgeCrossing]) -> u32 {
        let normal: DVec3 = planes.iter().map(|plane| plane.normal).sum();
        self.mesh.positions.push(position);
        self.mesh.normals.push(normal.normalize_or(DVec3::Z));
        // A vertex may lie on one leaf alone, away from the others that its cell crosses.
        let apart = |plane: &EdgeCrossing| plane.normal.dot(position - plane.position).abs();
        let known = planes.iter().filter(|plane| plane.leaf.is_some());
        let nearest = known.min_by(|a, b| apart(a).total_cmp(&apart(b)));
        self.mesh.leaves.push(nearest.and_then(|plane| plane.leaf));
        self.mesh.positions.len() as u32 - 1
    }

    /// Returns the point of a cell that fits the planes best.
    fn best(&self, cell: [usize; 3], planes: &[EdgeCrossing]) -> DVec3 {
        let middle = mean(planes.iter().map(|plane| plane.position));
        let (mut matrix, mut right) = (DMat3::ZERO, DVec3::ZERO);
        for plane in planes {
            let normal = plane.normal;
            matrix += DMat3::from_cols(normal * normal.x, normal * normal.y, normal * normal.z);
            right += normal * normal.dot(plane.position - middle);
        }
        let (values, vectors) = eigen(matrix);
        // Eigenvalues are squares of singular values.
        let least = LEAST_SINGULAR * LEAST_SINGULAR * values.max_element();
        let mut offset = DVec3::ZERO;
        for k in 0..3 {
            if values[k] > least {
                offset += vectors.col(k) * (vectors.col(k).dot(right) / values[k]);
            }
        }
        let low = self.place(cell.map(|k| k as f64));
        (middle + offset).clamp(low, low + self.step)
    }

    /// Joins the patches around each edge.
    fn join(&mut self) {
        let mut edges: Vec<((usize, u8), DVec3)> = self
            .edges
            .iter()
            .map(|(key, crossing)| (*key, crossing.normal))
            .collect();
        edges.sort_unstable_by_key(|(key, _)| *key);
        for ((corner, axis), normal) in edges {
            let axis = usize::from(axis);
            let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
            let low = self.corner_numbers(corner);
            // The corners at the boundary are outside: there are cells on all sides.
            let cell = |p: usize, q: usize| {
                let mut cell = low;
                cell[b] -= p;
                cell[c] -= q;
                cell
            };
            let around = [(1, 1), (0, 1), (0, 0), (1, 0)];
            // Between each cell and the next: the cell above their common face, and the face's axis.
            let between = [((0, 1), b), ((0, 0), c), ((0, 0), b), ((1, 0), c)];
            let mut polygon = Vec::with_capacity(8);
            let mut from_way = None;
            for k in 0..4 {
                let (p, q) = around[k];
                let own = 4 * axis + (p | q << 1);
                let patch = self.patches.get(&self.cell(cell(p, q)));
                polygon.extend(patch.map(|patch| patch[own]));
                let ((p, q), face) = between[k];
                let above = cell(p, q);
                let own = 4 * axis + (p | q << 1);
                let (edges, segments) = self.face(above, face, 0);
                if segments.len() == 2
                    && let Some(place) = edges.iter().position(|&edge| edge == own)
                {
                    let key = (self.cell(above), face as u8, place as u8);
                    from_way = self.ways.get(&key).copied();
                    polygon.extend(from_way);
                }
            }
            if !self.inside[corner] {
                polygon.reverse();
            }
            self.fill(&polygon, from_way, normal);
        }
    }

    /// Fills a polygon with triangles about one of its vertices, so that they follow the surface as well as possible. If the
    /// polygon has a vertex of an ambiguous face, it is that one: an edge between other vertices might belong to two
    /// polygons.
    fn fill(&mut self, polygon: &[u32], about: Option<u32>, normal: DVec3) {
        let count = polygon.len();
        let triangles = |first: usize| {
            (1..count.saturating_sub(1))
                .map(move |k| [0, k, k + 1].map(|step| polygon[(first + step) % count]))
        };
        let turned = |first: usize| {
            let flattest = triangles(first).map(|triangle| {
                let [a, b, c] = triangle.map(|vertex| self.mesh.positions[vertex as usize]);
                (b - a).cross(c - a).normalize_or_zero().dot(normal)
            });
            flattest.fold(f64::INFINITY, f64::min)
        };
        let allowed = (0..count).filter(|&first| about.is_none_or(|it| polygon[first] == it));
        let best = allowed.reduce(|a, b| if turned(b) > turned(a) + 1e-9 { b } else { a });
        let all: Vec<[u32; 3]> = best.into_iter().flat_map(triangles).collect();
        self.mesh.triangles.extend(all);
    }
}

fn mean(places: impl ExactSizeIterator<Item = DVec3>) -> DVec3 {
    let count = places.len().max(1) as f64;
    places.sum::<DVec3>() / count
}

/// Off-diagonal elements below this fraction of the diagonal ones are rounding errors.
const ROUNDING: f64 = 1e-17;

/// Returns the eigenvalues and unit eigenvectors of a symmetric matrix, by the Jacobi method.
fn eigen(mut matrix: DMat3) -> (DVec3, DMat3) {
    let mut vectors = DMat3::IDENTITY;
    for _ in 0..16 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            let off = matrix.col(q)[p];
            let size = matrix.col(p)[p].abs() + matrix.col(q)[q].abs();
            if off.abs() <= ROUNDING * size {
                continue;
            }
            let ratio = (matrix.col(q)[q] - matrix.col(p)[p]) / (2.0 * off);
            let tangent = ratio.signum() / (ratio.abs() + (1.0 + ratio * ratio).sqrt());
            let cosine = 1.0 / (1.0 + tangent * tangent).sqrt();
            let sine = tangent * cosine;
            let mut turn = DMat3::IDENTITY;
            turn.col_mut(p)[p] = cosine;
            turn.col_mut(q)[q] = cosine;
            turn.col_mut(q)[p] = sine;
            turn.col_mut(p)[q] = -sine;
            matrix = turn.transpose() * matrix * turn;
            vectors *= turn;
        }
    }
    let values = DVec3::new(matrix.col(0)[0], matrix.col(1)[1], matrix.col(2)[2]);
    (values, vectors)
}
