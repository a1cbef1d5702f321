//! Solids as meshes, by dual contouring.

use geometry::solids::{MAX_SHAPE_WORK, RayScene, RaySceneOptions, SOLID_COLOR};
use scene::{Object, ParamValues, Scene};
use tracer::contour;

use super::weld::{Mesh, Vertex};

/// The most cells along the longest side of a solid's box.
pub const MOST_CELLS: u32 = 128;
/// The least.
pub const LEAST_CELLS: u32 = 8;
/// So many solids have the most cells; more of them have fewer, so that all together have about as many triangles.
pub const FINE_SOLIDS: usize = 32;
/// A vertex has the normal of a triangle's plane where its own is farther from it than this cosine says: at edges.
const SMOOTH: f32 = 0.9;

/// The size of the meshes of a file's solids.
pub(super) struct Fineness {
    /// The number of cells along the longest side of a solid's box.
    pub(super) cells: u32,
    /// The work that is left to read their shapes.
    work: u64,
}

impl Fineness {
    /// That of so many solids. The number of triangles of a mesh goes with the square of that of its cells.
    pub(super) fn of(solids: usize) -> Self {
        let share = FINE_SOLIDS as f64 / solids.max(1) as f64;
        let cells = f64::from(MOST_CELLS) * share.sqrt();
        Self {
            cells: (cells as u32).clamp(LEAST_CELLS, MOST_CELLS),
            work: MAX_SHAPE_WORK,
        }
    }
}

/// Meshes a solid with all its instances. The sentences are for the user.
pub(super) fn meshed(
    scene: &Scene,
    params: &ParamValues,
    object: &Object,
    fineness: &mut Fineness,
) -> (Option<Mesh>, Vec<String>) {
    let options = RaySceneOptions {
        shown: &|_| true,
        color: &|_| SOLID_COLOR,
        thickness: None,
        picture_look: Default::default(),
    };
    let rays = RayScene::of_solid(scene, params, &options, object, &mut fineness.work);
    let mut notes: Vec<String> = rays.notes().iter().map(ToString::to_string).collect();
    if rays.world().solid_count() == 0 {
        return (None, notes);
    }
    let Some(bounds) = rays.world().bounds(0) else {
        let name = &object.name;
        notes.push(format!(
            "`{name}` is endless and has no mesh: intervals cut it, such as `x : [-3, 3]` behind it"
        ));
        return (None, notes);
    };
    let found = contour(rays.world(), 0, &bounds, fineness.cells);
    let mut mesh = Mesh {
        places: found.positions.iter().map(|at| at.to_array()).collect(),
        ..Mesh::default()
    };
    // Each place has the vertex of its own normal at its index; those of edges follow.
    let vertex = |(place, normal): (usize, &glam::DVec3)| Vertex {
        place: place as u32,
        normal: normal.as_vec3().to_array(),
        uv: [0.0; 2],
    };
    mesh.vertices = found.normals.iter().enumerate().map(vertex).collect();
    for triangle in &found.triangles {
        let [a, b, c] = triangle.map(|place| found.positions[place as usize]);
        let flat = (b - a).cross(c - a).normalize_or_zero().as_vec3();
        let corners = triangle.map(|place| {
            let own = glam::Vec3::from(mesh.vertices[place as usize].normal);
            if flat == glam::Vec3::ZERO || own.dot(flat) >= SMOOTH {
                return place;
            }
            mesh.vertices.push(Vertex {
                place,
                normal: flat.to_array(),
                uv: [0.0; 2],
            });
            mesh.vertices.len() as u32 - 1
        });
        mesh.triangles.push(corners);
    }
    (Some(mesh), notes)
}
