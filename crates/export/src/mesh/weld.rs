//! Surfaces as connected triangles. In: a grid of samples. Out: welded triangles.
//!
//! Samples that coincide become one point: at glued sides, at poles, and where a parameter line has no length.
//! Vertices, which carry normals and texture coordinates, stay separate at such seams. A surface may intersect itself:
//! only samples that are neighbours, or are on the border of the grid, can be joined.

use std::collections::{BTreeMap, HashMap};

use glam::{DVec3, Vec3};

use render::sample::SurfaceSample;

/// The maximum distance at which two points coincide along an axis, as a fraction of the object's extent along it.
const COINCIDE: f64 = 1e-9;
/// The maximum distance at which two points coincide, as a fraction of the distance to the samples next to them.
const COINCIDE_LOCALLY: f64 = 1e-6;
/// The rounding error of a coordinate, as a fraction of it.
const ROUNDING: f64 = 8.0 * f64::EPSILON;
/// The maximum height of a triangle that is left out, as a fraction of its sides.
const FLAT: f64 = 1e-12;
/// The number of halvings between the sizes of the cells in which coinciding samples of a border are sought.
const CELL_LEVEL: i32 = 10;

/// Triangles, in the scene's units.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Points in space, each at most once per instance.
    pub places: Vec<[f64; 3]>,
    /// The corners of the triangles.
    pub vertices: Vec<Vertex>,
    /// Indices into the vertices. Triangles run counterclockwise as seen from the side to which the normals point; for a
    /// closed surface that is the outside.
    pub triangles: Vec<[u32; 3]>,
    /// The number of instances, each of which shows the whole image.
    pub(super) instances: u32,
}

/// A corner of triangles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Vertex {
    /// An index into the points.
    pub place: u32,
    /// The unit normal.
    pub normal: [f32; 3],
    /// The texture coordinates: (0, 0) at u min and v min, (1, 1) at u max and v max.
    pub uv: [f32; 2],
}

impl Mesh {
    /// Adds an instance: the grid's `places`, u fastest, with the normals and definedness of its `samples`. Returns the
    /// sample of each point that is added, the first of those that coincide.
    pub(super) fn add(
        &mut self,
        count: [u32; 2],
        places: &[[f64; 3]],
        samples: &[SurfaceSample],
    ) -> Vec<u32> {
        self.instances += 1;
        let grid = SampleGrid::new(count, places, samples);
        let triangles: Vec<[usize; 3]> = grid.triangles().collect();
        // Vertices in the order of the grid, and only those that a triangle needs.
        let mut vertex_of = vec![None; places.len()];
        for &corner in triangles.iter().flatten() {
            vertex_of[corner] = Some(0);
        }
        let mut place_of: HashMap<u32, u32> = HashMap::new();
        let mut added = Vec::new();
        let first = self.vertices.len();
        let [columns, rows] = grid.size;
        for (index, vertex) in vertex_of.iter_mut().enumerate() {
            if vertex.is_none() {
                continue;
            }
            *vertex = Some(self.vertices.len() as u32);
            let class = grid.class[index];
            let place = *place_of.entry(class).or_insert_with(|| {
                self.places.push(places[class as usize]);
                added.push(class);
                self.places.len() as u32 - 1
            });
            let share = |at: usize, of: usize| at as f32 / (of - 1) as f32;
            self.vertices.push(Vertex {
                place,
                normal: samples[index].normal,
                uv: [
                    share(index % columns, columns),
                    share(index / columns, rows),
                ],
            });
        }
        let turned = grid.faces_inwards(&triangles);
        let start = self.triangles.len();
        self.triangles.extend(triangles.iter().map(|corners| {
            let [a, b, c] = corners.map(|corner| vertex_of[corner].unwrap_or_default());
            if turned { [a, c, b] } else { [a, b, c] }
        }));
        if turned {
            for vertex in &mut self.vertices[first..] {
                vertex.normal = vertex.normal.map(|x| -x);
            }
        }
        self.complete_normals(first, start);
        added
    }

    /// Returns the corners of a triangle in space.
    pub fn corners(&self, triangle: [u32; 3]) -> [[f64; 3]; 3] {
        triangle.map(|vertex| self.places[self.vertices[vertex as usize].place as usize])
    }

    /// Returns the corners in single precision, after `shift` is subtracted.
    pub(super) fn single_corners(&self, triangle: [u32; 3], shift: [f32; 3]) -> [[f32; 3]; 3] {
        self.corners(triangle)
            .map(|place| std::array::from_fn(|k| (place[k] - f64::from(shift[k])) as f32))
    }

    /// Returns the number of triangles with corners that coincide in single precision, after `shift` is subtracted.
    pub(super) fn collapsed(&self, shift: [f32; 3]) -> usize {
        let triangles = self.triangles.iter();
        triangles
            .filter(|triangle| is_collapsed(self.single_corners(**triangle, shift)))
            .count()
    }

    /// Returns the unit normal of a triangle; zero if it has none.
    pub(crate) fn face_normal(&self, triangle: [u32; 3]) -> [f32; 3] {
        let [a, b, c] = self.corners(triangle).map(DVec3::from);
        let scale = (b - a).abs().max((c - a).abs()).max_element();
        let normal = ((b - a) / scale).cross((c - a) / scale);
        normal.normalize_or_zero().as_vec3().to_array()
    }

    /// Gives each vertex without a normal the mean normal of the triangles around it.
    fn complete_normals(&mut self, first_vertex: usize, first_triangle: usize) {
        let missing = |vertex: &Vertex| vertex.normal == [0.0; 3];
        if !self.vertices[first_vertex..].iter().any(missing) {
            return;
        }
        let mut sums = vec![Vec3::ZERO; self.vertices.len() - first_vertex];
        for &triangle in &self.triangles[first_triangle..] {
            let normal = Vec3::from(self.face_normal(triangle));
            for vertex in triangle {
                sums[vertex as usize - first_vertex] += normal;
            }
        }
        for (vertex, sum) in self.vertices[first_vertex..].iter_mut().zip(sums) {
            if missing(vertex) {
                vertex.normal = sum.try_normalize().unwrap_or(Vec3::Z).to_array();
            }
        }
    }
}

/// The measure by which points of an instance coincide. Each axis has its own, because the points may be very far apart
/// along one axis only.
pub(super) struct Coincidence {
    /// The maximum distance along each axis.
    widths: DVec3,
}

impl Coincidence {
    /// Returns the measure of an instance with these points.
    pub(super) fn of(places: impl Iterator<Item = [f64; 3]>) -> Self {
        let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for place in places.map(DVec3::from) {
            (low, high) = (low.min(place), high.max(place));
        }
        let extent = (high - low).max(DVec3::ZERO);
        Self {
            widths: COINCIDE * extent + rounding(low.abs().max(high.abs())),
        }
    }

    /// Returns whether two points are one, of which each has such a tolerance.
    pub(super) fn holds(&self, [a, b]: [[f64; 3]; 2], tolerance: f64) -> bool {
        let apart = (DVec3::from(a) - DVec3::from(b)).abs();
        apart.cmple(self.widths).all() && distance(a, b) <= tolerance
    }
}

/// Returns the distance within which others coincide with a point whose neighbours are a `step` away.
pub(super) fn tolerance(place: [f64; 3], step: f64) -> f64 {
    // Far from the origin, the rounding of the coordinates exceeds that fraction.
    COINCIDE_LOCALLY * step + ROUNDING * DVec3::from(place).abs().max_element()
}

/// Returns the rounding errors of coordinates of this magnitude. A coordinate may be nothing but rounding error, as on a
/// plane that is computed: its error is that of another axis.
fn rounding(farthest: DVec3) -> DVec3 {
    let [x, y, z] = farthest.to_array();
    let middle = x.min(y).max(x.max(y).min(z));
    ROUNDING * farthest.max(DVec3::splat(middle))
}

/// Returns the distance of two points of any magnitude: the squares of tiny coordinates would be zero.
pub(super) fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    let apart = DVec3::from(a) - DVec3::from(b);
    let scale = apart.abs().max_element();
    if scale > 0.0 {
        scale * (apart / scale).length()
    } else {
        scale
    }
}

/// Returns true if corners of a triangle coincide.
pub(super) fn is_collapsed([a, b, c]: [[f32; 3]; 3]) -> bool {
    a == b || b == c || c == a
}

/// One instance's grid of samples.
struct SampleGrid<'a> {
    places: &'a [[f64; 3]],
    defined: Vec<bool>,
    /// True for samples whose quads are left out.
    open: Vec<bool>,
    /// Columns (samples along u) and rows.
    size: [usize; 2],
    /// The first of the samples that coincide with each sample.
    class: Vec<u32>,
}

/// Returns the largest rounding error of a coordinate in single precision, after `shift` is subtracted, as a fraction of the
/// size of the box around the points.
pub(super) fn rounding_share(places: &[[f64; 3]], shift: [f32; 3]) -> f64 {
    let (mut low, mut high, mut most) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3], 0.0_f64);
    for place in places {
        for k in 0..3 {
            let local = place[k] - f64::from(shift[k]);
            most = most.max((f64::from(local as f32) - local).abs());
            (low[k], high[k]) = (low[k].min(local), high[k].max(local));
        }
    }
    let size = (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max);
    if size > 0.0 { most / size } else { 0.0 }
}

/// True if single precision can represent a point. All formats leave out other points, so that they agree.
pub(super) fn is_held(place: &[f64; 3]) -> bool {
    place.iter().all(|x| x.abs() < f64::from(f32::MAX))
}

impl<'a> SampleGrid<'a> {
    fn new(count: [u32; 2], places: &'a [[f64; 3]], samples: &[SurfaceSample]) -> Self {
        let both = places.iter().zip(samples);
        let mut grid = Self {
            places,
            defined: both
                .map(|(place, sample)| sample.defined != 0.0 && is_held(place))
                .collect(),
            open: samples.iter().map(SurfaceSample::is_last).collect(),
            size: count.map(|n| n as usize),
            class: (0..places.len() as u32).collect(),
        };
        grid.weld();
        grid
    }

    /// Joins coinciding samples: neighbours in the grid, and samples of its border.
    fn weld(&mut self) {
        let defined = self.places.iter().zip(&self.defined);
        let defined = defined.filter(|(_, defined)| **defined);
        let coincidence = Coincidence::of(defined.map(|(place, _)| *place));
        let mut steps = vec![0.0_f64; self.places.len()];
        let neighbours: Vec<[usize; 2]> = self.neighbours().collect();
        for pair in &neighbours {
            let [a, b] = pair.map(|index| self.places[index]);
            let step = distance(a, b);
            for &index in pair {
                steps[index] = steps[index].max(step);
            }
        }
        let both = self.places.iter().zip(&steps);
        let tolerances: Vec<f64> = both.map(|(place, step)| tolerance(*place, *step)).collect();
        for [a, b] in neighbours {
            let places = [a, b].map(|index| self.places[index]);
            if coincidence.holds(places, tolerances[a].min(tolerances[b])) {
                self.join(a, b);
            }
        }
        self.weld_border(&coincidence, &tolerances);
        for index in 0..self.class.len() {
            self.class[index] = self.first_of(index) as u32;
        }
    }

    /// Returns the pairs of defined samples that are next to each other.
    fn neighbours(&self) -> impl Iterator<Item = [usize; 2]> + '_ {
        let [columns, rows] = self.size;
        (0..self.places.len()).flat_map(move |index| {
            let right = (index % columns + 1 < columns).then_some(index + 1);
            let down = (index / columns + 1 < rows).then_some(index + columns);
            let others = [right, down].into_iter().flatten();
            let pairs = others.map(move |other| [index, other]);
            pairs.filter(|pair| pair.iter().all(|&index| self.defined[index]))
        })
    }

    /// Joins coinciding samples of the border, wherever they are on it. Hash grids hold the samples so far, so that each
    /// sample is compared only with those of 27 cells of each grid. A grid holds samples of similar tolerance, and its cells
    /// are at least twice as large as that, unless no two points coincide so far from each other along an axis.
    fn weld_border(&mut self, coincidence: &Coincidence, tolerances: &[f64]) {
        let [columns, rows] = self.size;
        let edge = |index: usize| {
            let (i, j) = (index % columns, index / columns);
            i == 0 || j == 0 || i + 1 == columns || j + 1 == rows
        };
        let widths = coincidence.widths.to_array();
        let cell = |place: [f64; 3], level: i32, by: [i64; 3]| -> [i64; 3] {
            let size = 2.0 * f64::powi(2.0, CELL_LEVEL * (level + 1));
            std::array::from_fn(|k| {
                let cell = (place[k] / size.min(2.0 * widths[k])).floor() as i64;
                cell.saturating_add(by[k])
            })
        };
        let mut grids: BTreeMap<i32, HashMap<[i64; 3], Vec<u32>>> = BTreeMap::new();
        for index in (0..self.places.len()).filter(|&index| edge(index)) {
            if !self.defined[index] || tolerances[index] == 0.0 {
                continue;
            }
            let place = self.places[index];
            let own = (tolerances[index].log2() / f64::from(CELL_LEVEL)).floor() as i32;
            let mut joined = false;
            for (&level, cells) in &grids {
                for code in 0..27 {
                    let by = [code % 3 - 1, code / 3 % 3 - 1, code / 9 - 1];
                    let others = cells.get(&cell(place, level, by));
                    for &other in others.into_iter().flatten() {
                        let other = other as usize;
                        let tolerance = tolerances[index].min(tolerances[other]);
                        if coincidence.holds([place, self.places[other]], tolerance) {
                            joined |= level == own && by == [0; 3];
                            let [a, b] = [index, other].map(|it| root(&mut self.class, it));
                            self.class[a.max(b)] = a.min(b) as u32;
                        }
                    }
                }
            }
            // One sample represents all that coincide in a cell: otherwise the samples of a pole would be compared
            // pairwise.
            if !joined {
                let cells = grids.entry(own).or_default();
                let cell = cells.entry(cell(place, own, [0; 3]));
                cell.or_default().push(index as u32);
            }
        }
    }

    fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.first_of(a), self.first_of(b));
        self.class[a.max(b)] = a.min(b) as u32;
    }

    fn first_of(&mut self, index: usize) -> usize {
        root(&mut self.class, index)
    }

    /// Returns the two triangles of the quad whose lowest corner is sample `at`, as the 3D view draws them.
    fn quad(&self, at: usize) -> [[usize; 3]; 2] {
        let columns = self.size[0];
        let [a, b, c, d] = [at, at + 1, at + columns + 1, at + columns];
        [[a, b, c], [a, c, d]]
    }

    /// Returns whether a triangle of [`SampleGrid::quad`] is drawn: all corners are defined, its quad is not left out,
    /// and it has an area, or corners that coincide.
    fn is_there(&self, triangle: [usize; 3]) -> bool {
        !self.open[triangle[0]]
            && triangle.iter().all(|&corner| self.defined[corner])
            && (self.is_collapsed(triangle) || self.has_area(triangle))
    }

    fn is_collapsed(&self, triangle: [usize; 3]) -> bool {
        let [a, b, c] = triangle.map(|corner| self.class[corner]);
        a == b || b == c || c == a
    }

    /// Returns whether a triangle has a height that is no rounding error of its corners. Its projections along the axes
    /// are compared with their own errors: along one axis it may be very long.
    fn has_area(&self, triangle: [usize; 3]) -> bool {
        let [a, b, c] = triangle.map(|corner| self.place(corner));
        let (p, q, r) = (b - a, c - b, a - c);
        let sides = p.abs().max(q.abs()).max(r.abs());
        let scale = sides.max_element();
        let farthest = a.abs().max(b.abs()).max(c.abs());
        let (p, q, sides) = (p / scale, q / scale, sides / scale);
        let error = FLAT * sides + rounding(farthest) / scale;
        let areas = p.cross(q).abs();
        (0..3).any(|axis| {
            let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
            areas[axis] > sides[i] * error[j] + sides[j] * error[i]
        })
    }

    /// Returns the position of a sample after welding.
    fn place(&self, index: usize) -> DVec3 {
        DVec3::from(self.places[self.class[index] as usize])
    }

    fn triangles(&self) -> impl Iterator<Item = [usize; 3]> + '_ {
        let quads = self.quads().flat_map(|at| self.quad(at));
        quads.filter(|&t| self.is_there(t) && !self.is_collapsed(t))
    }

    fn quads(&self) -> impl Iterator<Item = usize> + use<> {
        let [columns, rows] = self.size;
        (0..rows - 1).flat_map(move |j| (0..columns - 1).map(move |i| j * columns + i))
    }

    /// Returns whether the surface is closed and its triangles run counterclockwise as seen from inside, by the sign of
    /// the enclosed volume (the sum of the tetrahedra over its triangles).
    fn faces_inwards(&self, triangles: &[[usize; 3]]) -> bool {
        let Some(&[first, ..]) = triangles.first() else {
            return false;
        };
        if !self.is_closed() {
            return false;
        }
        let origin = self.place(first);
        let corners = triangles.iter().flatten();
        let away = corners.map(|corner| (self.place(*corner) - origin).abs().max_element());
        let extent = away.fold(0.0, f64::max);
        let volume = |triangle: &[usize; 3]| {
            let [a, b, c] = triangle.map(|corner| (self.place(corner) - origin) / extent);
            a.dot(b.cross(c))
        };
        triangles.iter().map(volume).sum::<f64>() < 0.0
    }

    /// Returns whether the triangles have no boundary: each edge is passed equally often in both directions.
    fn is_closed(&self) -> bool {
        let [columns, rows] = self.size;
        let mut balance: HashMap<[u32; 2], i32> = HashMap::new();
        let mut run = |from: usize, to: usize| {
            let [from, to] = [from, to].map(|index| self.class[index]);
            let sign = if from < to { 1 } else { -1 };
            if from != to {
                *balance.entry([from.min(to), from.max(to)]).or_default() += sign;
            }
        };
        // Within the grid, neighbours pass their common edge in both directions: only the other edges are counted.
        for at in self.quads() {
            let (i, j) = (at % columns, at / columns);
            let [lower, upper] = self.quad(at);
            let [there, above] = [lower, upper].map(|triangle| self.is_there(triangle));
            let [a, b, c] = lower;
            let d = upper[2];
            let beside = |inside: bool, at: usize, which: usize| {
                inside && self.is_there(self.quad(at)[which])
            };
            if there {
                if !(j > 0 && beside(true, at - columns, 1)) {
                    run(a, b);
                }
                if !beside(i + 2 < columns, at + 1, 1) {
                    run(b, c);
                }
                if !above {
                    run(c, a);
                }
            }
            if above {
                if !there {
                    run(a, c);
                }
                if !beside(j + 2 < rows, at + columns, 0) {
                    run(c, d);
                }
                if !(i > 0 && beside(true, at - 1, 0)) {
                    run(d, a);
                }
            }
        }
        balance.values().all(|&times| times == 0)
    }
}

/// Returns the representative of a sample's class in the union-find forest: the first of the samples that are joined
/// with it.
fn root(class: &mut [u32], mut index: usize) -> usize {
    while class[index] as usize != index {
        // Halving the path keeps long chains (a pole) cheap.
        class[index] = class[class[index] as usize];
        index = class[index] as usize;
    }
    index
}
