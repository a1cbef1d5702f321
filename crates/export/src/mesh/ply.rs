//! Stanford PLY, binary, little endian. Written by hand: the file is a header and fixed records, while the libraries'
//! writers expect each vertex as a map from names to values.

use std::io::{self, Write};

use glam::Vec3;

use super::{Geometry, Mesh, MeshFormat, Model, Part};

/// Writes the vertices of all parts, then faces, then edges. Each point is one vertex, even where seams meet.
pub(super) fn write(model: &Model, out: &mut dyn Write) -> io::Result<()> {
    let mut out = io::BufWriter::new(out);
    let places = |part: &Part| part.vertices(MeshFormat::Ply);
    let edges = |part: &Part| match &part.geometry {
        Geometry::Lines(lines) => lines.strips.iter().map(|strip| strip.len() - 1).sum(),
        Geometry::Surface(..) | Geometry::Points(_) => 0_usize,
    };
    let parts = &model.parts;
    let faces = model.triangles(MeshFormat::Ply);
    let edge_count: usize = parts.iter().map(edges).sum();
    write!(
        out,
        "ply\nformat binary_little_endian 1.0\ncomment written by geotrace {}\nelement vertex {}\n",
        env!("CARGO_PKG_VERSION"),
        parts.iter().map(places).sum::<usize>()
    )?;
    for axis in ["x", "y", "z"] {
        writeln!(out, "property double {axis}")?;
    }
    for axis in ["nx", "ny", "nz"] {
        writeln!(out, "property float {axis}")?;
    }
    for colour in ["red", "green", "blue"] {
        writeln!(out, "property uchar {colour}")?;
    }
    // Some readers reject an element without entries.
    if faces > 0 {
        writeln!(out, "element face {faces}")?;
        writeln!(out, "property list uchar int vertex_indices")?;
    }
    if edge_count > 0 {
        writeln!(out, "element edge {edge_count}")?;
        writeln!(out, "property int vertex1\nproperty int vertex2")?;
    }
    writeln!(out, "end_header")?;

    for part in parts {
        let colours = part.colours_of_places();
        let plain =
            |(place, colour): (&[f64; 3], [u8; 3])| record(&mut out, *place, [0.0; 3], colour);
        match &part.geometry {
            Geometry::Surface(mesh, _) => {
                let places = mesh.places.iter().zip(normals(mesh));
                for ((place, normal), colour) in places.zip(colours) {
                    record(&mut out, *place, normal, colour)?;
                }
            }
            Geometry::Lines(lines) => lines.places.iter().zip(colours).try_for_each(plain)?,
            Geometry::Points(points) => points.iter().zip(colours).try_for_each(plain)?,
        }
    }
    let mut first = 0;
    for part in parts {
        if let Geometry::Surface(mesh, _) = &part.geometry {
            for triangle in &mesh.triangles {
                out.write_all(&[3])?;
                for &corner in triangle {
                    let place = mesh.vertices[corner as usize].place as usize;
                    out.write_all(&((first + place) as i32).to_le_bytes())?;
                }
            }
        }
        first += places(part);
    }
    first = 0;
    for part in parts {
        if let Geometry::Lines(lines) = &part.geometry {
            for pair in lines.strips.iter().flat_map(|strip| strip.windows(2)) {
                for &index in pair {
                    out.write_all(&((first + index as usize) as i32).to_le_bytes())?;
                }
            }
        }
        first += places(part);
    }
    out.flush()
}

fn record(
    out: &mut impl Write,
    place: [f64; 3],
    normal: [f32; 3],
    colour: [u8; 3],
) -> io::Result<()> {
    for x in place {
        out.write_all(&x.to_le_bytes())?;
    }
    for x in normal {
        out.write_all(&x.to_le_bytes())?;
    }
    out.write_all(&colour)
}

/// Returns the normals of the points: the mean over the vertices of a point, or the normal of its first vertex where
/// they cancel, as on the seam of a one-sided surface.
fn normals(mesh: &Mesh) -> Vec<[f32; 3]> {
    let mut first: Vec<Option<Vec3>> = vec![None; mesh.places.len()];
    let mut sums = vec![Vec3::ZERO; mesh.places.len()];
    for vertex in &mesh.vertices {
        let (place, normal) = (vertex.place as usize, Vec3::from(vertex.normal));
        first[place].get_or_insert(normal);
        sums[place] += normal;
    }
    let both = sums.into_iter().zip(first);
    both.map(|(sum, first)| {
        let mean = if sum.length() > 1e-3 {
            Some(sum.normalize())
        } else {
            first
        };
        mean.unwrap_or_default().to_array()
    })
    .collect()
}
