//! Binary STL by the crate `stl_io`: triangles with their normals, in single precision.

use std::io::{self, Write};

use stl_io::{Normal, Triangle, Vertex};

use super::weld::is_collapsed;
use super::{Geometry, Mesh, Model};

/// Writes the triangles of all surfaces, except those whose corners coincide in single precision.
pub(super) fn write(model: &Model, out: &mut dyn Write) -> io::Result<()> {
    let meshes = || {
        model.parts.iter().filter_map(|part| match &part.geometry {
            Geometry::Surface(mesh, _) => Some(mesh),
            Geometry::Lines(_) | Geometry::Points(_) => None,
        })
    };
    let triangles =
        || meshes().flat_map(|mesh| mesh.triangles.iter().filter_map(|&t| facet(mesh, t)));
    let count = triangles().count();
    let mut rest = triangles();
    // The writer requires the exact number of triangles before it writes the first.
    let counted = (0..count).map(|_| {
        rest.next().unwrap_or(Triangle {
            normal: Normal::new([0.0; 3]),
            vertices: [Vertex::new([0.0; 3]); 3],
        })
    });
    let mut out = out;
    stl_io::write_stl(&mut out, counted)
}

fn facet(mesh: &Mesh, triangle: [u32; 3]) -> Option<Triangle> {
    let corners = mesh.single_corners(triangle, [0.0; 3]);
    (!is_collapsed(corners)).then(|| Triangle {
        normal: Normal::new(mesh.face_normal(triangle)),
        vertices: corners.map(Vertex::new),
    })
}
