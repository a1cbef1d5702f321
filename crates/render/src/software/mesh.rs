//! Triangles. In: vertices in view space, from painters. Out: clipped and projected triangles.

use glam::{Mat4, Vec2, Vec3, Vec4};

use crate::camera::Camera;
use crate::style::{self, Length, LineStyle};

/// The number of fixed-point steps per pixel in projected positions.
pub(super) const SUBPIXEL: i32 = 256;
/// Triangles are clipped at this many half pictures from the centre, so that fixed-point positions stay small.
const GUARD: f32 = 3.0;

/// The camera, in the form that painters need.
#[derive(Clone, Copy, Debug)]
pub(super) struct Eye {
    /// The matrix from drawing units to view space.
    pub view: Mat4,
    /// 1 over the tangents of half the field of view.
    pub zoom: Vec2,
    /// The near plane's distance.
    pub near: f32,
    /// [`Camera::pixels_per_unit`].
    pub pixels_per_unit: f32,
    /// [`style::pixel_unit`].
    pub unit: f32,
    /// The distance of an orthographic camera's plane, and its depth range on either side; 0 in perspective.
    pub plane: f32,
    pub reach: f32,
    /// The picture's size in pixels.
    pub size: Vec2,
    /// Half the width of lines, and the radius of points.
    pub line: Length,
    pub point: Length,
    /// The distance by which glyphs are moved towards the eye, and that for joins, in half widths.
    pub lift: f32,
    pub join_lift: f32,
}

impl Eye {
    pub(super) fn new(camera: &Camera) -> Self {
        let [x, y] = camera.half_tangents();
        let parallel = camera.parallel;
        Self {
            plane: parallel.map_or(0.0, |it| it.distance as f32),
            reach: parallel.map_or(0.0, |it| it.reach as f32),
            view: camera.view_from_world(),
            zoom: Vec2::new(1.0 / x as f32, 1.0 / y as f32),
            near: camera.near as f32,
            pixels_per_unit: camera.pixels_per_unit(),
            unit: style::pixel_unit(camera.size),
            size: Vec2::new(camera.size[0] as f32, camera.size[1] as f32),
            line: style::LINE_HALF_WIDTH,
            point: style::POINT_RADIUS,
            lift: style::GLYPH_LIFT,
            join_lift: style::JOIN_LIFT,
        }
    }

    /// Returns the camera for an object with this look of its lines.
    pub(super) fn with_lines(self, style: LineStyle) -> Self {
        Self {
            line: style::LINE_HALF_WIDTH.times(style.width),
            point: style::POINT_RADIUS.times(style.width),
            lift: style::GLYPH_LIFT + style.lift,
            join_lift: style::JOIN_LIFT + style.lift,
            ..self
        }
    }

    /// Converts a position of the scene to view space.
    pub(super) fn see(&self, position: [f32; 3]) -> Vec3 {
        self.view.transform_point3(Vec3::from(position))
    }

    /// Returns true if lines of sight are parallel.
    #[inline(always)]
    pub(super) fn is_parallel(&self) -> bool {
        self.plane > 0.0
    }

    /// Returns the number by which a point in view space is divided in the projection: its distance, in perspective.
    #[inline(always)]
    pub(super) fn distance(&self, at: Vec3) -> f32 {
        if self.is_parallel() {
            self.plane
        } else {
            -at.z
        }
    }

    /// Returns true if a point in view space is not behind the near plane.
    #[inline(always)]
    pub(super) fn is_in_front(&self, at: Vec3) -> bool {
        self.distance(at) >= self.near
    }

    /// Returns half the width of a line at a point in view space, in drawing units.
    pub(super) fn half_width(&self, at: Vec3) -> f32 {
        let w = self.distance(at).max(self.near);
        self.line
            .at(w, self.pixels_per_unit, self.unit, style::LEAST_HALF_WIDTH)
    }

    /// Returns the length of one pixel at a point in view space, in drawing units.
    pub(super) fn pixel(&self, at: Vec3) -> f32 {
        self.distance(at).max(self.near) / self.pixels_per_unit
    }

    /// Converts a point to clip space, with the depth of a point nearer by `lift`.
    pub(super) fn clip(&self, at: Vec3, lift: f32) -> Vec4 {
        let w = self.distance(at);
        // Lift it at most halfway to the eye, so that a glyph in front of the camera does not jump behind it.
        let depth = if self.is_parallel() {
            w * (0.5 + 0.5 * (at.z + lift + w) / self.reach)
        } else if w > 0.0 {
            self.near * w / (w - lift).max(0.5 * w)
        } else {
            self.near
        };
        Vec4::new(at.x * self.zoom.x, at.y * self.zoom.y, depth, w)
    }

    /// Projects a point in view space in front of the eye. Returns offsets from the picture's centre in units that are equal
    /// in x and y.
    pub(super) fn project(&self, at: Vec3) -> Vec2 {
        at.truncate() / self.distance(at).max(self.near)
    }
}

/// A corner of a triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Vertex {
    /// The position in clip space; depth is z / w, and w is the distance.
    pub clip: Vec4,
    /// The normal in view space, of any length; for surfaces and cones.
    pub normal: Vec3,
    /// Texture coordinates for surfaces; the position in the unit disc for glyphs.
    pub uv: Vec2,
}

/// A projected corner.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    /// The position in pixels × [`SUBPIXEL`] from the picture's top left.
    pub at: [i32; 2],
    pub depth: f32,
    pub inv_w: f32,
    pub normal: Vec3,
    pub uv: Vec2,
}

/// A part of an object's triangles, projected. Corners are shared.
#[derive(Clone, Debug, Default)]
pub(super) struct Mesh {
    pub corners: Vec<Corner>,
    pub triangles: Vec<[u32; 3]>,
    /// Index into the picture's materials; one for all triangles.
    pub material: u32,
}

/// A handle to a vertex of a [`MeshBuilder`].
#[derive(Clone, Copy, Debug)]
pub(super) struct VertexId(u32);

/// Collects vertices and triangles, clips those that leave the view, and projects the rest.
pub(super) struct MeshBuilder<'a> {
    eye: &'a Eye,
    vertices: Vec<Vertex>,
    /// The corner of each vertex inside the guarded view.
    corner_of: Vec<Option<u32>>,
    mesh: Mesh,
}

impl<'a> MeshBuilder<'a> {
    pub(super) fn new(eye: &'a Eye, material: u32) -> Self {
        let mesh = Mesh {
            material,
            ..Mesh::default()
        };
        Self {
            eye,
            vertices: Vec::new(),
            corner_of: Vec::new(),
            mesh,
        }
    }

    pub(super) fn vertex(&mut self, vertex: Vertex) -> VertexId {
        let [x, y, _, w] = vertex.clip.to_array();
        let inside = w >= self.eye.near && x.abs() <= GUARD * w && y.abs() <= GUARD * w;
        let corner = inside.then(|| {
            self.mesh.corners.push(project(self.eye, &vertex));
            self.mesh.corners.len() as u32 - 1
        });
        self.vertices.push(vertex);
        self.corner_of.push(corner);
        VertexId(self.vertices.len() as u32 - 1)
    }

    pub(super) fn triangle(&mut self, a: VertexId, b: VertexId, c: VertexId) {
        let ids = [a, b, c].map(|id| id.0 as usize);
        if let [Some(a), Some(b), Some(c)] = ids.map(|id| self.corner_of[id]) {
            self.mesh.triangles.push([a, b, c]);
        } else {
            self.cut(ids.map(|id| self.vertices[id]));
        }
    }

    pub(super) fn finish(self) -> Mesh {
        self.mesh
    }

    /// Clips a triangle by the Sutherland–Hodgman algorithm against the near plane and the guard planes.
    fn cut(&mut self, triangle: [Vertex; 3]) {
        let near = self.eye.near;
        let planes: [&dyn Fn(Vec4) -> f32; 5] = [
            &|p| p.w - near,
            &|p| GUARD * p.w - p.x,
            &|p| GUARD * p.w + p.x,
            &|p| GUARD * p.w - p.y,
            &|p| GUARD * p.w + p.y,
        ];
        let mut polygon = triangle.to_vec();
        for plane in planes {
            let mut kept = Vec::with_capacity(polygon.len() + 1);
            for (k, a) in polygon.iter().enumerate() {
                let b = &polygon[(k + 1) % polygon.len()];
                let (da, db) = (plane(a.clip), plane(b.clip));
                if da >= 0.0 {
                    kept.push(*a);
                }
                if (da >= 0.0) != (db >= 0.0) {
                    kept.push(between(a, b, da / (da - db)));
                }
            }
            polygon = kept;
            if polygon.len() < 3 {
                return;
            }
        }
        let first = self.mesh.corners.len() as u32;
        self.mesh
            .corners
            .extend(polygon.iter().map(|vertex| project(self.eye, vertex)));
        let fan = (1..polygon.len() as u32 - 1).map(|k| [first, first + k, first + k + 1]);
        self.mesh.triangles.extend(fan);
    }
}

fn between(a: &Vertex, b: &Vertex, t: f32) -> Vertex {
    Vertex {
        clip: a.clip.lerp(b.clip, t),
        normal: a.normal.lerp(b.normal, t),
        uv: a.uv.lerp(b.uv, t),
    }
}

fn project(eye: &Eye, vertex: &Vertex) -> Corner {
    let clip = vertex.clip;
    let inv_w = 1.0 / clip.w.max(eye.near);
    let x = (0.5 + 0.5 * clip.x * inv_w) * eye.size.x;
    let y = (0.5 - 0.5 * clip.y * inv_w) * eye.size.y;
    let fixed = |x: f32| (x * SUBPIXEL as f32).round() as i32;
    Corner {
        at: [fixed(x), fixed(y)],
        depth: clip.z * inv_w,
        inv_w,
        normal: vertex.normal,
        uv: vertex.uv,
    }
}
