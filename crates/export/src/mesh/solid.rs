//! Solids as meshes, by dual contouring.

use expr::number;
use geometry::solids::{MAX_SHAPE_WORK, RayFault, RayNote, RayScene, RaySceneOptions};
use glam::DVec3;
use scene::{Object, ParamValues, Scene};
use tracer::shade::{Face, FaceObject};
use tracer::{BoundingBox, SolidMesh, SurfaceId, WorkBudget, contour, srgb};

use super::ColouredMesh;
use super::weld::{Mesh, Vertex, is_held};

/// The maximum number of cells along the longest side of the box of a solid whose intervals specify no counts.
pub const USUAL_CELLS: u32 = 128;
/// The minimum number.
const LEAST_CELLS: u32 = 8;
/// The maximum number of cells along the longest side if intervals specify counts. The corners of a grid of this size
/// take 128 MB, and a solid that fills its box has some three million triangles.
pub const MOST_CELLS: u32 = 512;
/// The number of solids up to which each has the usual number of cells; with more solids each has fewer, so that the
/// total number of triangles stays about the same.
pub const FINE_SOLIDS: usize = 32;
/// The maximum work for the meshes of a file's solids, in operations on numbers.
pub const MAX_MESH_WORK: u64 = 1 << 32;
/// The minimum cosine between a vertex's own normal and that of a triangle's plane; below it, at edges, the vertex gets
/// the plane's normal.
const SMOOTH: f32 = 0.9;
/// The box of a point extends by this fraction of its distance from the origin, or of [`POINT_UNIT`]: more than the margin
/// of boxes.
const POINT: f64 = 1e-8;
const POINT_UNIT: f64 = 1e-3;
/// The relative rounding error that is allowed for the size of a cell.
const ROUNDING: f64 = 1e-6;

/// The resolution of the meshes of a file's solids.
pub(super) struct Fineness {
    /// The number of cells along the longest side of a solid's box, unless its intervals specify counts.
    pub(super) cells: u32,
    /// The remaining work for reading their shapes.
    shape_work: u64,
    /// The remaining work for meshing them.
    mesh_work: WorkBudget,
}

impl Fineness {
    /// Returns the resolution for a number of solids. The number of triangles of a mesh is proportional to the square
    /// of its number of cells.
    pub(super) fn of(solids: usize) -> Self {
        let share = FINE_SOLIDS as f64 / solids.max(1) as f64;
        let cells = f64::from(USUAL_CELLS) * share.sqrt();
        Self {
            cells: (cells as u32).clamp(LEAST_CELLS, USUAL_CELLS),
            shape_work: MAX_SHAPE_WORK,
            mesh_work: WorkBudget::new(MAX_MESH_WORK),
        }
    }
}

/// Meshes a solid with all its instances; `colour`, sRGB, is that of faces that specify none. The sentences are for the
/// user.
pub(super) fn meshed(
    scene: &Scene,
    params: &ParamValues,
    object: &Object,
    colour: [u8; 3],
    fineness: &mut Fineness,
) -> (Option<ColouredMesh>, Vec<String>) {
    let unstated = DVec3::from_array(colour.map(f64::from)) / 255.0;
    let options = RaySceneOptions {
        shown: &|_| true,
        colour: &|_| unstated,
        thickness: None,
        stage: false,
        picture_look: Default::default(),
    };
    let rays = RayScene::of_solid(scene, params, &options, object, &mut fineness.shape_work);
    let ray_notes = || -> Vec<String> {
        // Vertices are slightly off curved surfaces: attributes may leave their ranges only there.
        let notes = rays.notes().into_iter();
        // `thin` reports an empty mesh.
        let is_kept =
            |note: &RayNote| !matches!(note.fault, RayFault::ClampedAttribute(_) | RayFault::Empty);
        let notes = notes.filter(is_kept);
        notes.map(|note| note.to_string()).collect()
    };
    if rays.world().solid_count() == 0 {
        return (None, ray_notes());
    }
    let name = &object.name;
    let Some(bounds) = rays.world().bounds(0) else {
        let mut notes = ray_notes();
        notes.push(format!(
            "`{name}` has no mesh, because it may be unbounded: {}",
            rays.missing_cuts(0)
        ));
        return (None, notes);
    };
    let corners = [bounds.lower, bounds.upper].map(|corner| corner.to_array());
    if !bounds.is_empty() && !corners.iter().all(is_held) {
        let mut notes = ray_notes();
        notes.push(format!(
            "`{name}` has no mesh: mesh files have single precision, too little for its coordinates"
        ));
        return (None, notes);
    }
    let longest = (bounds.upper - bounds.lower).max_element();
    let stated = rays.stated_cell(0);
    let asked = stated.map(|cell| (longest / cell * (1.0 - ROUNDING)).ceil());
    let cells = asked.map_or(fineness.cells, |cells| (cells as u32).clamp(1, MOST_CELLS));
    let Some(found) = contour(rays.world(), 0, &bounds, cells, &fineness.mesh_work) else {
        let mut notes = ray_notes();
        notes.push(format!(
            "`{name}` has no mesh: meshing the solids exceeds the work limit; use fewer solids, or fewer cells"
        ));
        return (None, notes);
    };
    let mesh = of_contour(&found);
    let colours = colours(&rays, &found, colour);
    // The attributes have been evaluated: it is known where they are undefined.
    let mut notes = ray_notes();
    if let Some(asked) = asked.filter(|asked| *asked > f64::from(MOST_CELLS)) {
        notes.push(format!(
            "`{name}` is meshed with {MOST_CELLS} cells along its longest side, the maximum: its counts request {asked}"
        ));
    }
    notes.extend(thin(&rays, &bounds, cells, &found));
    (Some((mesh, colours)), notes)
}

fn of_contour(found: &SolidMesh) -> Mesh {
    let mut mesh = Mesh {
        places: found.positions.iter().map(|at| at.to_array()).collect(),
        ..Mesh::default()
    };
    // Each point has the vertex with its own normal at its index; the additional vertices at edges follow.
    let vertex = |(place, normal): (usize, &DVec3)| Vertex {
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
    mesh
}

/// Returns the sRGB colours of the points: those of the leaves to which they belong, without images.
fn colours(rays: &RayScene, found: &SolidMesh, unstated: [u8; 3]) -> Vec<[u8; 3]> {
    let mut leaves = found.leaves.clone();
    // A point whose leaf is not known has that of a neighbour.
    for triangle in &found.triangles {
        let corners = triangle.map(|corner| corner as usize);
        if let Some(known) = corners.iter().find_map(|corner| found.leaves[*corner]) {
            for corner in corners {
                leaves[corner].get_or_insert(known);
            }
        }
    }
    let places = found.positions.iter().zip(&found.normals).zip(leaves);
    let colour = |((position, normal), leaf): ((&DVec3, &DVec3), Option<usize>)| {
        let Some(leaf) = leaf else {
            return unstated;
        };
        let face = Face {
            t: 0.0,
            position: *position,
            normal: *normal,
            beam: DVec3::ZERO,
            of: FaceObject::Solid {
                solid: 0,
                leaf,
                surface: SurfaceId::of_leaf(leaf),
                entering: true,
            },
        };
        srgb::bytes(rays.look(&face, &|_, _| None).colour)
    };
    places.map(colour).collect()
}

/// Returns a sentence about the parts that a mesh lacks because they are thinner than a cell, and what makes the cells
/// smaller; the solids of a script have no counts.
fn thin(rays: &RayScene, bounds: &BoundingBox, cells: u32, found: &SolidMesh) -> Option<String> {
    let name = &rays.object_of_solid(0).name;
    let sides = bounds.upper - bounds.lower;
    let longest = sides.max_element();
    let farthest = bounds.lower.abs().max(bounds.upper.abs()).max_element();
    let cell = number::text(brief(longest / f64::from(cells)));
    let text = match (found.triangles.is_empty(), found.is_thin) {
        (true, _) if bounds.is_empty() => {
            return Some(format!("`{name}` has no mesh: it is empty"));
        }
        (true, _) if longest <= POINT * (POINT_UNIT + farthest) => {
            let size = number::text(brief(longest));
            return Some(format!(
                "`{name}` has no mesh: it is empty, or smaller than {size}"
            ));
        }
        (true, true) => {
            format!("`{name}` has no mesh: it is thinner than a cell of {cell} everywhere")
        }
        (true, false) => {
            format!("`{name}` has no mesh: it is empty, or smaller than a cell of {cell}")
        }
        (false, true) => {
            format!("parts of `{name}` are thinner than a cell ({cell}) and may be missing")
        }
        (false, false) => return None,
    };
    if cells >= MOST_CELLS {
        return Some(text);
    }
    let axis = (0..3).find(|&k| sides[k] >= longest).unwrap_or(0);
    // The interval contains the box up to rounding, with three digits.
    let unit = 10f64.powi(2 - longest.log10().floor() as i32);
    let low = (bounds.lower[axis] * unit + ROUNDING).floor() / unit;
    let high = (bounds.upper[axis] * unit - ROUNDING).ceil() / unit;
    let axis = rays.coordinates(0)[axis];
    let [low, high] = [low, high].map(number::text);
    let counts = format!("`{axis} : [{low}, {high}, {MOST_CELLS}]`");
    Some(match rays.is_script() {
        true => format!(
            "{text}; `geotrace convert` makes a program of the script, where counts make the cells smaller: {counts}"
        ),
        false => format!("{text}; make the cells smaller by counts: {counts}"),
    })
}

/// Returns a length rounded to two digits.
fn brief(length: f64) -> f64 {
    number::rounded(length, 2)
}
