//! Wavefront OBJ. Written by hand: no maintained writer exists, and its lines consist of words and numbers.

use std::io::{self, Write};

use super::{Geometry, Model};

/// Writes an object for each part; indices start at 1 and run through the whole file.
pub(super) fn write(model: &Model, out: &mut dyn Write) -> io::Result<()> {
    let mut out = io::BufWriter::new(out);
    writeln!(out, "# written by geotrace {}", env!("CARGO_PKG_VERSION"))?;
    let (mut places, mut vertices) = (1, 1);
    for part in &model.parts {
        writeln!(out, "o {}", part.name)?;
        let colours = part.colours_of_places();
        match &part.geometry {
            Geometry::Surface(mesh, _) => {
                for (place, colour) in mesh.places.iter().zip(colours) {
                    write_place(&mut out, *place, colour)?;
                }
                for vertex in &mesh.vertices {
                    // OBJ counts an image's rows from its lower edge.
                    writeln!(out, "vt {} {}", vertex.uv[0], 1.0 - vertex.uv[1])?;
                }
                for vertex in &mesh.vertices {
                    let [x, y, z] = vertex.normal;
                    writeln!(out, "vn {x} {y} {z}")?;
                }
                for triangle in &mesh.triangles {
                    write!(out, "f")?;
                    for &corner in triangle {
                        let place = places + mesh.vertices[corner as usize].place as usize;
                        let vertex = vertices + corner as usize;
                        write!(out, " {place}/{vertex}/{vertex}")?;
                    }
                    writeln!(out)?;
                }
                places += mesh.places.len();
                vertices += mesh.vertices.len();
            }
            Geometry::Lines(lines) => {
                for (place, colour) in lines.places.iter().zip(colours) {
                    write_place(&mut out, *place, colour)?;
                }
                for strip in &lines.strips {
                    write!(out, "l")?;
                    for &index in strip {
                        write!(out, " {}", places + index as usize)?;
                    }
                    writeln!(out)?;
                }
                places += lines.places.len();
            }
            Geometry::Points(points) => {
                for (place, colour) in points.iter().zip(colours) {
                    write_place(&mut out, *place, colour)?;
                }
                for index in 0..points.len() {
                    writeln!(out, "p {}", places + index)?;
                }
                places += points.len();
            }
        }
    }
    out.flush()
}

/// Writes a point and its colour, sRGB from 0 to 1: not in the original format, but other programs write and read it.
/// Writes all digits: reading them gives the same f64.
fn write_place(out: &mut impl Write, place: [f64; 3], colour: [u8; 3]) -> io::Result<()> {
    write!(out, "v")?;
    for x in place {
        if x == 0.0 || (1e-5..1e16).contains(&x.abs()) {
            write!(out, " {x}")?;
        } else {
            write!(out, " {x:e}")?;
        }
    }
    let [r, g, b] = colour.map(|byte| f64::from(byte) / 255.0);
    writeln!(out, " {r:.4} {g:.4} {b:.4}")
}
