//! A scene's objects as files for other programs: meshes, lines and points, in the scene's own units.
//!
//! ```text
//! Scene + ParamValues + Request ──mesh.rs: surfaces as welded triangles ─┬─▶ Model ──obj.rs, ply.rs, stl.rs, gltf.rs──▶ bytes
//!                              curves, geodesics, vectors, points ────┘
//! ```
//!
//! Places are taken in f64, not from the samples that are drawn, and keep as many digits as a format holds: all of them
//! in OBJ and PLY, those of single precision in STL and glTF. What a picture leaves open, a file leaves open too.

mod gltf;
mod mesh;
mod obj;
mod ply;
mod stl;

pub use mesh::{Mesh, Vertex};

use std::fmt;
use std::io::{self, Write};
use std::sync::Arc;

use expr::NodeId;
use expr::tape::Tape;
use scene::ParamValues;
use scene::{Object, ObjectId, Scene, Shape};

use crate::bounds::{Bounds, Placement};
use crate::geodesics;
use crate::request::Request;
use crate::sample::{Resolution, Sampler, Samples, sample_with_notes};
use crate::texture::Texture;

/// A file format.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub enum Format {
    /// Wavefront OBJ: text; an object for each name, with normals and texture coordinates; lines and points.
    Obj,
    /// Stanford PLY, binary, little endian: f64 places, normals, colours of the picture at the vertices; edges.
    Ply,
    /// STL, binary: the triangles of surfaces and nothing else.
    Stl,
    /// glTF 2.0 as one JSON file with everything in it: materials, images, lines and points.
    Gltf,
    /// The same, binary.
    Glb,
}

/// What a file holds.
#[derive(Clone, Debug, Default)]
pub struct Model {
    /// The objects, in the order of the scene; those of which nothing is defined are absent.
    pub parts: Vec<Part>,
    /// What a reader of the file should know: sentences such as "`s` is undefined at 3 of its 100 samples and is left
    /// open there".
    pub notes: Vec<String>,
}

/// One object with all its instances.
#[derive(Clone, Debug)]
pub struct Part {
    /// The object.
    pub object: ObjectId,
    /// Its name.
    pub name: String,
    /// sRGB; multiplies the texture.
    pub colour: [u8; 3],
    /// Its shape.
    pub geometry: Geometry,
}

/// The shape of a part, in the scene's units.
#[derive(Clone, Debug)]
pub enum Geometry {
    /// A surface, and its image.
    Surface(Mesh, Arc<Texture>),
    /// Curves, geodesics and vectors.
    Lines(Lines),
    /// Points.
    Points(Vec<[f64; 3]>),
}

/// Polylines.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Lines {
    /// Places.
    pub places: Vec<[f64; 3]>,
    /// Indices into the places, at least two for each line; a closed line ends with its first place.
    pub strips: Vec<Vec<u32>>,
}

/// Why there is no file.
#[derive(Debug)]
pub enum ExportError {
    /// Nothing of the scene, or of the objects asked for, has a place in such a file.
    Nothing {
        /// The format.
        format: Format,
        /// The names of objects that are there and have no place in it.
        left_out: Vec<String>,
    },
    /// The format cannot count so many vertices or bytes.
    TooLarge {
        /// The format.
        format: Format,
    },
    /// The writer failed.
    Write(io::Error),
}

impl Format {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Obj, Self::Ply, Self::Stl, Self::Gltf, Self::Glb];

    /// The format of a file name's extension, without its dot, in any case of letters.
    pub fn of_extension(extension: &str) -> Option<Self> {
        let wanted = extension.to_lowercase();
        Self::ALL
            .into_iter()
            .find(|format| format.extension() == wanted)
    }

    /// The extension of its files.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Obj => "obj",
            Self::Ply => "ply",
            Self::Stl => "stl",
            Self::Gltf => "gltf",
            Self::Glb => "glb",
        }
    }

    /// What people call it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Obj => "OBJ",
            Self::Ply => "PLY",
            Self::Stl => "STL",
            Self::Gltf | Self::Glb => "glTF",
        }
    }
}

/// Builds what a file holds: of all objects that the request does not hide, or of those that are listed. Of the request,
/// also the colours and the textures matter.
pub fn model(
    scene: &Scene,
    settings: &ParamValues,
    request: &Request,
    objects: Option<&[ObjectId]>,
) -> Model {
    let placement = Bounds::of(scene, settings).placement;
    let mut model = Model::default();
    for (index, object) in scene.objects.iter().enumerate() {
        let id = ObjectId(index as u32);
        if !objects.map_or(request.shows(id), |objects| objects.contains(&id)) {
            continue;
        }
        let (geometry, notes) = geometry(scene, settings, request, id, object, &placement);
        model.notes.extend(notes);
        model.parts.extend(geometry.map(|geometry| {
            let own = request.colours.iter().rev().find(|(of, _)| *of == id);
            Part {
                object: id,
                name: object.name.clone(),
                colour: own.map_or_else(|| crate::style::colour(&object.shape), |(_, c)| *c),
                geometry,
            }
        }));
    }
    model
}

impl Model {
    /// Writes a file. Gives the sentences that a reader of this format should be told.
    ///
    /// # Errors
    /// See [`ExportError`].
    pub fn write(&self, format: Format, out: &mut dyn Write) -> Result<Vec<String>, ExportError> {
        let fits = |part: &&Part| format != Format::Stl || part.triangles() > 0;
        let left_out: Vec<String> = self
            .parts
            .iter()
            .filter(|part| !fits(part))
            .map(|part| part.name.clone())
            .collect();
        if left_out.len() == self.parts.len() {
            return Err(ExportError::Nothing { format, left_out });
        }
        let vertices: usize = self.parts.iter().map(Part::vertices).sum();
        // PLY's indices are signed, and glTF keeps the greatest one for itself.
        if vertices > i32::MAX as usize {
            return Err(ExportError::TooLarge { format });
        }
        match format {
            Format::Obj => obj::write(self, out)?,
            Format::Ply => ply::write(self, out)?,
            Format::Stl => stl::write(self, out)?,
            Format::Gltf => gltf::write_text(self, out)?,
            Format::Glb => gltf::write_binary(self, out)?,
        }
        out.flush()?;
        Ok(if left_out.is_empty() {
            Vec::new()
        } else {
            vec![format!(
                "{} has no place for what is not a surface: {} left out",
                format.name(),
                listed(&left_out)
            )]
        })
    }
}

impl Part {
    /// How many triangles it has.
    pub fn triangles(&self) -> usize {
        match &self.geometry {
            Geometry::Surface(mesh, _) => mesh.triangles.len(),
            Geometry::Lines(_) | Geometry::Points(_) => 0,
        }
    }

    /// How many vertices it has.
    pub fn vertices(&self) -> usize {
        match &self.geometry {
            Geometry::Surface(mesh, _) => mesh.vertices.len(),
            Geometry::Lines(lines) => lines.places.len(),
            Geometry::Points(places) => places.len(),
        }
    }
}

impl Lines {
    /// Adds a polyline; it is interrupted where a place is missing, and closed where its ends coincide.
    fn add(&mut self, places: &[Option<[f64; 3]>]) {
        let defined = places.iter().flatten();
        let tolerance = mesh::tolerance(defined.copied());
        let whole = places.iter().all(Option::is_some);
        let mut strip = Vec::new();
        for place in places {
            match place {
                Some(place) => {
                    strip.push(self.places.len() as u32);
                    self.places.push(*place);
                }
                None => self.keep(std::mem::take(&mut strip)),
            }
        }
        if let (true, [first, _, .., last]) = (whole, &mut strip[..]) {
            let ends = [*first, *last].map(|index| self.places[index as usize]);
            if mesh::distance(ends[0], ends[1]) <= tolerance {
                *last = *first;
                self.places.pop();
            }
        }
        self.keep(strip);
    }

    fn keep(&mut self, strip: Vec<u32>) {
        match strip[..] {
            [] => {}
            // A lone place is no line.
            [_] => {
                self.places.pop();
            }
            _ => self.strips.push(strip),
        }
    }
}

/// The shape of an object, if any of it is defined, and what should be told of it.
fn geometry(
    scene: &Scene,
    settings: &ParamValues,
    request: &Request,
    id: ObjectId,
    object: &Object,
    placement: &Placement,
) -> (Option<Geometry>, Vec<String>) {
    let (samples, notes) = sample_with_notes(scene, settings, id, placement);
    let geometry = match (&object.shape, &samples) {
        (Shape::Point { position }, Samples::Points(samples)) => {
            let places = places(scene, settings, object, position);
            let defined = samples.iter().map(|sample| sample.defined != 0.0);
            let kept = places.into_iter().zip(defined).filter(|(_, kept)| *kept);
            Geometry::Points(kept.map(|(place, _)| place).collect())
        }
        (Shape::Vector { direction, origin }, Samples::Vectors(samples)) => {
            let origins = places(scene, settings, object, origin);
            let directions = places(scene, settings, object, direction);
            let mut lines = Lines::default();
            for ((from, by), sample) in origins.iter().zip(&directions).zip(samples) {
                if sample.defined != 0.0 {
                    let tip = [0, 1, 2].map(|k| from[k] + by[k]);
                    lines.add(&[Some(*from), Some(tip)]);
                }
            }
            Geometry::Lines(lines)
        }
        (Shape::Curve { position, .. }, Samples::Curves { count, samples }) => {
            let places = places(scene, settings, object, position);
            let mut lines = Lines::default();
            let count = *count as usize;
            for (places, samples) in places.chunks(count).zip(samples.chunks(count)) {
                let pairs = places.iter().zip(samples);
                let line = pairs.map(|(place, sample)| (sample.defined != 0.0).then_some(*place));
                lines.add(&line.collect::<Vec<_>>());
            }
            Geometry::Lines(lines)
        }
        (Shape::Geodesic { .. }, Samples::Curves { .. }) => {
            let mut lines = Lines::default();
            for line in &geodesics::declared(scene, settings, id).lines {
                let line = line.iter().map(|knot| knot.and_then(|knot| knot.position));
                lines.add(&line.collect::<Vec<_>>());
            }
            Geometry::Lines(lines)
        }
        (Shape::Surface { position, .. }, Samples::Surfaces { count, samples }) => {
            let places = places(scene, settings, object, position);
            let mut mesh = Mesh::default();
            let size = count[0] as usize * count[1] as usize;
            for (places, samples) in places.chunks(size).zip(samples.chunks(size)) {
                mesh.add(*count, places, samples);
            }
            Geometry::Surface(mesh, request.texture(id))
        }
        _ => return (None, notes),
    };
    let some = match &geometry {
        Geometry::Surface(mesh, _) => !mesh.triangles.is_empty(),
        Geometry::Lines(lines) => !lines.strips.is_empty(),
        Geometry::Points(places) => !places.is_empty(),
    };
    (some.then_some(geometry), notes)
}

/// The places of all samples of all instances.
fn places(
    scene: &Scene,
    settings: &ParamValues,
    object: &Object,
    position: &[NodeId; 3],
) -> Vec<[f64; 3]> {
    let tape = Tape::new(&scene.graph, position);
    let sampler = Sampler::new(scene, settings, object, tape, Resolution::Full);
    sampler.map(|_, out: &[f64; 3]| *out)
}

fn listed(names: &[String]) -> String {
    let quoted: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    match quoted.len() {
        1 => format!("{} is", quoted[0]),
        _ => format!("{} are", quoted.join(", ")),
    }
}

impl fmt::Display for ExportError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Nothing { left_out, .. } if left_out.is_empty() => {
                write!(
                    f,
                    "there is nothing to be exported: nothing is drawn in space"
                )
            }
            Self::Nothing { format, left_out } => write!(
                f,
                "{} holds surfaces and nothing else, so {} left out and nothing remains",
                format.name(),
                listed(left_out)
            ),
            Self::TooLarge { format } => {
                write!(
                    f,
                    "the scene has more vertices than {} can hold",
                    format.name()
                )
            }
            Self::Write(error) => write!(f, "{error}"),
        }
    }
}

impl std::error::Error for ExportError {}

impl From<io::Error> for ExportError {
    fn from(error: io::Error) -> Self {
        Self::Write(error)
    }
}
