//! A scene's objects as files for other programs: meshes, lines and points, in the scene's units.
//!
//! ```text
//! PictureRequest ──weld.rs: surfaces as welded triangles ─┬─▶ Model ──obj.rs, ply.rs, stl.rs, gltf.rs──▶ bytes
//!                  solid.rs: solids as triangles by dual contouring ────┤
//!                              curves, geodesics, vectors, points ────┘
//! ```
//!
//! Positions are evaluated in f64, not taken from the samples that are drawn, and keep as many digits as a format
//! holds: all of them in OBJ and PLY, single precision in STL and glTF. A mesh has the same holes as the picture.
//!
//! No library is used for the model: mesh libraries have no surfaces that are welded where their samples coincide.

mod gltf;
mod obj;
mod ply;
mod solid;
mod stl;
mod weld;

pub use solid::{FINE_SOLIDS, MAX_MESH_WORK, MOST_CELLS, USUAL_CELLS};
pub use weld::{Mesh, Vertex};

use std::fmt;
use std::io::{self, Write};
use std::sync::Arc;

use geometry::follow_declared;
use render::PictureRequest;
use render::bounds::Bounds;
use render::placement::Placement;
use render::sample::{Samples, positions, sample_with_notes};
use render::style;
use render::texture::{SurfaceImage, Texture};
use scene::{Object, ObjectId};
use solid::Fineness;
use weld::Coincidence;

/// A shape is rounded roughly if rounding moves a place by more than this share of the shape's size.
const ROUGH: f64 = 1e-3;

/// A file format.
#[derive(Clone, Copy, Debug, Eq, Hash, PartialEq)]
pub enum MeshFormat {
    /// Wavefront OBJ: text; an object for each name, with normals, texture coordinates and the picture's colours at the
    /// vertices; lines and points.
    Obj,
    /// Stanford PLY, binary, little endian: f64 positions, normals, the picture's colours at the vertices; edges.
    Ply,
    /// STL, binary: only the triangles of surfaces.
    Stl,
    /// glTF 2.0 as one self-contained JSON file: materials, images, lines and points.
    Gltf,
    /// glTF 2.0 as one binary file.
    Glb,
}

/// The content of a file.
#[derive(Clone, Debug, Default)]
pub struct Model {
    /// The objects, in the order of the scene; an object that is defined nowhere is absent.
    pub parts: Vec<Part>,
    /// Sentences for the user, such as "`s` is undefined at 3 of its 100 samples and has holes there".
    pub notes: Vec<String>,
}

/// One object with all its instances that have one image.
#[derive(Clone, Debug)]
pub struct Part {
    /// The object.
    pub object: ObjectId,
    /// Its name.
    pub name: String,
    /// Its colour, sRGB; multiplies the texture. Colours of points replace it.
    pub colour: [u8; 3],
    /// The colours of its points, sRGB; empty if all have the part's colour.
    pub colours: Vec<[u8; 3]>,
    /// The specified colours of a surface's points, sRGB, which its image shows too; empty if they do not vary.
    stated: Vec<[u8; 3]>,
    /// Its shape.
    pub geometry: Geometry,
}

/// The shape of a part, in the scene's units.
#[derive(Clone, Debug)]
pub enum Geometry {
    /// A surface, and its image.
    Surface(Mesh, SurfaceImage),
    /// Curves, geodesics and vectors.
    Lines(Polylines),
    /// Points.
    Points(Vec<[f64; 3]>),
}

/// Polylines.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Polylines {
    /// Points in space.
    pub places: Vec<[f64; 3]>,
    /// Indices into the points, at least two per line; a closed line ends with its first point.
    pub strips: Vec<Vec<u32>>,
}

/// A mesh with the colours of its points, sRGB.
type ColouredMesh = (Mesh, Vec<[u8; 3]>);

/// A shape with its colours, as those of a [`Part`].
struct ColouredShape {
    geometry: Geometry,
    colours: Vec<[u8; 3]>,
    stated: Vec<[u8; 3]>,
}

/// The reason why a file could not be written.
#[derive(Debug)]
pub enum ExportError {
    /// The format holds none of the objects.
    Nothing {
        /// The format.
        format: MeshFormat,
        /// The names of the objects that the format does not hold.
        left_out: Vec<String>,
        /// The model's notes, which may say why.
        notes: Vec<String>,
    },
    /// The format cannot count this many vertices or bytes.
    TooLarge {
        /// The format.
        format: MeshFormat,
    },
    /// The writer failed.
    Write(io::Error),
}

impl MeshFormat {
    /// All formats.
    pub const ALL: [Self; 5] = [Self::Obj, Self::Ply, Self::Stl, Self::Gltf, Self::Glb];

    /// Returns the format for a file name's extension, without its dot, in any case of letters.
    pub fn from_extension(extension: &str) -> Option<Self> {
        let wanted = extension.to_lowercase();
        Self::ALL
            .into_iter()
            .find(|format| format.extension() == wanted)
    }

    /// Returns the extension of its files.
    pub const fn extension(self) -> &'static str {
        self.names().0
    }

    /// Returns its short name, for sentences.
    pub const fn name(self) -> &'static str {
        self.names().1
    }

    /// Returns its full name, for lists of formats.
    pub const fn title(self) -> &'static str {
        self.names().2
    }

    /// True if it holds only triangles: no lines, no points and no vertices shared by triangles.
    pub const fn has_only_triangles(self) -> bool {
        matches!(self, Self::Stl)
    }

    /// Returns the extension, the short name and the full name.
    const fn names(self) -> (&'static str, &'static str, &'static str) {
        match self {
            Self::Obj => ("obj", "OBJ", "Wavefront OBJ"),
            Self::Ply => ("ply", "PLY", "Stanford PLY"),
            Self::Stl => ("stl", "STL", "STL"),
            Self::Gltf => ("gltf", "glTF", "glTF 2.0, one JSON file"),
            Self::Glb => ("glb", "glTF", "glTF 2.0, binary"),
        }
    }
}

/// Builds the content of a file from the objects that the request does not hide, or from the listed ones. The request
/// also determines their colours and textures.
pub fn model(request: &PictureRequest, objects: Option<&[ObjectId]>) -> Model {
    let made = request.with_scene_of_params();
    let listed = objects.map(|objects| -> Vec<ObjectId> {
        let number = |id: &ObjectId| request.scene.number_in(&made.scene, *id);
        objects.iter().filter_map(number).collect()
    });
    model_of(&made.into_owned().with_curvatures(), listed.as_deref())
}

/// Builds the content of a file of a request that has all its images, but those of specified colours, and the scene of its
/// params.
fn model_of(unbaked: &PictureRequest, objects: Option<&[ObjectId]>) -> Model {
    let (request, notes) = unbaked.with_stated_colours();
    let request = &*request;
    let (scene, params) = (&*request.scene, &*request.params);
    let options = request.view.space();
    let is_shown = |id| options.is_none_or(|options| options.shows(id));
    let placement = Bounds::of(scene, params).placement;
    let colours = request.instance_colours();
    let mut model = Model {
        notes,
        ..Model::default()
    };
    let wanted = |id| objects.map_or(is_shown(id), |objects| objects.contains(&id));
    let all = scene.numbered().filter(|(id, _)| wanted(*id));
    let all: Vec<(ObjectId, &Object)> = all.collect();
    let solids = all
        .iter()
        .filter(|(_, object)| object.shape.solid().is_some());
    let solids = solids.count();
    let mut fineness = Fineness::of(solids);
    let cells = fineness.cells;
    if cells < USUAL_CELLS {
        model.notes.push(format!(
            "each of the {solids} solids has {cells} cells along its longest side, not {USUAL_CELLS}, unless it states counts: fewer solids in a file have more"
        ));
    }
    for (id, object) in all {
        let own = &*colours[id.index()];
        let (shapes, notes) = match object.shape.solid() {
            Some(_) => {
                let (mesh, notes) = solid::meshed(scene, params, object, own[0], &mut fineness);
                let mesh = mesh.filter(|(mesh, _)| !mesh.triangles.is_empty());
                let plain = |(mesh, colours)| {
                    let image = SurfaceImage::open(Texture::plain());
                    ColouredShape::new(Geometry::Surface(mesh, image), colours)
                };
                (mesh.map(plain).into_iter().collect(), notes)
            }
            None => {
                let stated = |instance| unbaked.stated_colours_at_samples(id, instance);
                shapes(request, id, object, &placement, own, stated)
            }
        };
        model.notes.extend(notes);
        let has_lost_image = object.shape.solid().is_some() && request.own_texture(id).is_some();
        let name = &object.name;
        let note = format!(
            "the image of `{name}` is left out: in a file of meshes only surfaces have images"
        );
        // Objects of a script may share a name.
        if has_lost_image && !model.notes.contains(&note) {
            model.notes.push(note);
        }
        model.parts.extend(shapes.into_iter().map(|shape| {
            let mut part = Part {
                object: id,
                name: object.name.clone(),
                colour: own[0],
                colours: shape.colours,
                stated: shape.stated,
                geometry: shape.geometry,
            };
            part.join_colours();
            part
        }));
    }
    model
}

impl Model {
    /// Writes a file. Returns sentences for the user about what this format leaves out.
    ///
    /// # Errors
    /// See [`ExportError`].
    pub fn write(
        &self,
        format: MeshFormat,
        out: &mut dyn Write,
    ) -> Result<Vec<String>, ExportError> {
        let is_surface = |part: &Part| matches!(part.geometry, Geometry::Surface(..));
        let fits = |part: &&Part| !format.has_only_triangles() || is_surface(part);
        let left_out: Vec<String> = self
            .parts
            .iter()
            .filter(|part| !fits(part))
            .map(|part| part.name.clone())
            .collect();
        let mut notes = self.collapsed(format);
        let is_empty = format.has_only_triangles() && self.triangles(format) == 0;
        if is_empty || left_out.len() == self.parts.len() {
            return Err(ExportError::Nothing {
                format,
                left_out,
                notes: [self.notes.clone(), notes].concat(),
            });
        }
        let vertices: usize = self.parts.iter().map(|part| part.vertices(format)).sum();
        // PLY's indices are signed, and glTF reserves the greatest one.
        if vertices > i32::MAX as usize {
            return Err(ExportError::TooLarge { format });
        }
        match format {
            MeshFormat::Obj => obj::write(self, out)?,
            MeshFormat::Ply => ply::write(self, out)?,
            MeshFormat::Stl => stl::write(self, out)?,
            MeshFormat::Gltf => gltf::write_text(self, out)?,
            MeshFormat::Glb => gltf::write_binary(self, out)?,
        }
        out.flush()?;
        if !left_out.is_empty() {
            notes.push(format!(
                "{} holds surfaces and solids only: {} left out",
                format.name(),
                listed(&left_out)
            ));
        }
        Ok(notes)
    }

    /// Returns the number of triangles in a file.
    pub fn triangles(&self, format: MeshFormat) -> usize {
        let parts = self.parts.iter();
        parts
            .map(|part| match (&part.geometry, format) {
                (Geometry::Surface(mesh, _), MeshFormat::Stl) => {
                    mesh.triangles.len() - mesh.collapsed([0.0; 3])
                }
                (Geometry::Surface(mesh, _), _) => mesh.triangles.len(),
                (Geometry::Lines(_) | Geometry::Points(_), _) => 0,
            })
            .sum()
    }

    /// Sentences about shapes for which a format has not enough digits.
    fn collapsed(&self, format: MeshFormat) -> Vec<String> {
        let (shift, end) = match format {
            MeshFormat::Obj | MeshFormat::Ply => return Vec::new(),
            MeshFormat::Stl => ([0.0; 3], "are left out"),
            MeshFormat::Gltf | MeshFormat::Glb => (gltf::shift(self), "have no area"),
        };
        let note = |part: &Part| {
            let (places, count, all) = match &part.geometry {
                Geometry::Surface(mesh, _) => {
                    (&mesh.places, mesh.collapsed(shift), mesh.triangles.len())
                }
                // They are left out, which is noted elsewhere.
                _ if format.has_only_triangles() => return None,
                Geometry::Lines(lines) => (&lines.places, 0, 0),
                Geometry::Points(places) => (places, 0, 0),
            };
            let (name, format) = (&part.name, format.name());
            let loss = if count > 0 {
                format!("{count} of the {all} triangles of `{name}` {end}")
            } else if weld::rounding_share(places, shift) > ROUGH {
                format!("the shape of `{name}` is rounded roughly")
            } else {
                return None;
            };
            Some(format!(
                "{loss}: {format} has single precision, which cannot distinguish such points; scale the object up, or move it \
                 towards the origin"
            ))
        };
        self.parts.iter().filter_map(note).collect()
    }
}

impl Part {
    /// If all points have the same colour, makes it the part's.
    fn join_colours(&mut self) {
        if let Some(&first) = self.colours.first()
            && self.colours.iter().all(|colour| *colour == first)
        {
            self.colour = first;
            self.colours.clear();
        }
    }

    /// Returns the colours of the points, sRGB: their own; on a surface multiplied by the image at the first vertex of
    /// a point, averaged over the distance to its neighbours. A specified colour is not averaged.
    fn colours_of_places(&self) -> Vec<[u8; 3]> {
        let own = |place: usize| self.colours.get(place).copied().unwrap_or(self.colour);
        if !self.stated.is_empty() {
            let stated = self.stated.iter().enumerate();
            let tinted =
                |(place, colour): (usize, &[u8; 3])| tinted(style::linear(*colour), own(place));
            return stated.map(tinted).collect();
        }
        let count = match &self.geometry {
            Geometry::Surface(mesh, image) => {
                if self.colours.is_empty() || !Arc::ptr_eq(&image.texture, &Texture::plain()) {
                    return mesh.colours_of_places(image, own);
                }
                mesh.places.len()
            }
            Geometry::Lines(lines) => lines.places.len(),
            Geometry::Points(places) => places.len(),
        };
        (0..count).map(own).collect()
    }

    /// Returns the number of vertices in a file: in OBJ and PLY, one per point; otherwise one per corner with its own
    /// normal or texture coordinates.
    pub fn vertices(&self, format: MeshFormat) -> usize {
        match &self.geometry {
            Geometry::Surface(mesh, _) => match format {
                MeshFormat::Obj | MeshFormat::Ply => mesh.places.len(),
                MeshFormat::Stl | MeshFormat::Gltf | MeshFormat::Glb => mesh.vertices.len(),
            },
            Geometry::Lines(lines) => lines.places.len(),
            Geometry::Points(places) => places.len(),
        }
    }
}

impl Mesh {
    /// Returns the image at the first vertex of each point, averaged over the distance to its neighbours, times the
    /// point's own colour.
    fn colours_of_places(
        &self,
        image: &SurfaceImage,
        own: impl Fn(usize) -> [u8; 3],
    ) -> Vec<[u8; 3]> {
        // The approximate distance between the vertices of an instance, as in a square grid of the same number.
        let vertices = self.vertices.len() as f32 / self.instances.max(1) as f32;
        let step = 1.0 / vertices.sqrt().max(1.0);
        let sampler = image.sampler();
        let mut colours: Vec<Option<[u8; 3]>> = vec![None; self.places.len()];
        for vertex in &self.vertices {
            let place = vertex.place as usize;
            colours[place].get_or_insert_with(|| {
                tinted(
                    sampler.colour(vertex.uv, [step, 0.0], [0.0, step]),
                    own(place),
                )
            });
        }
        let colours = colours.into_iter().enumerate();
        colours
            .map(|(place, colour)| colour.unwrap_or_else(|| own(place)))
            .collect()
    }
}

/// Returns a colour in linear light times one in sRGB, in sRGB.
fn tinted(light: [f32; 3], tint: [u8; 3]) -> [u8; 3] {
    let tint = style::linear(tint);
    [0, 1, 2].map(|k| style::encode(light[k] * tint[k]))
}

impl Polylines {
    /// Adds a polyline. A missing point interrupts it; coinciding ends close it.
    fn add(&mut self, places: &[Option<[f64; 3]>]) {
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
        if whole && strip.len() > 2 {
            let at = |k: usize| self.places[strip[k] as usize];
            let end = strip.len() - 1;
            // The line may begin or end slowly.
            let steps = [[0, 1], [end - 1, end]].map(|[a, b]| weld::distance(at(a), at(b)));
            let tolerance = weld::tolerance(at(0), steps[0].max(steps[1]));
            let coincidence = Coincidence::of(places.iter().flatten().copied());
            if coincidence.holds([at(0), at(end)], tolerance) {
                strip[end] = strip[0];
                self.places.pop();
            }
        }
        self.keep(strip);
    }

    /// Adds a strip whose points have already been added.
    fn keep(&mut self, strip: Vec<u32>) {
        match strip[..] {
            [] => {}
            // A single point is not a line.
            [_] => {
                self.places.pop();
            }
            _ => self.strips.push(strip),
        }
    }
}

/// The places of an object that are defined, counted: all of them, and those that single precision does not hold.
#[derive(Default)]
struct PlaceCount {
    defined: usize,
    beyond: usize,
}

impl PlaceCount {
    /// Counts a place that is defined; returns whether single precision holds it.
    fn is_held(&mut self, place: &[f64; 3]) -> bool {
        let is_held = weld::is_held(place);
        self.defined += 1;
        self.beyond += usize::from(!is_held);
        is_held
    }

    /// A sentence about the places of an object that are left out, or about all of it if `some` is false.
    fn note(&self, name: &str, some: bool) -> Option<String> {
        let Self { defined, beyond } = *self;
        let subject = match some {
            _ if beyond == 0 => return None,
            true => format!("{beyond} of the {defined} points of `{name}` are left out"),
            false => format!("`{name}` is left out"),
        };
        Some(format!(
            "{subject}: mesh files have single precision, which cannot hold points this far away"
        ))
    }
}

impl ColouredShape {
    fn new(geometry: Geometry, colours: Vec<[u8; 3]>) -> Self {
        Self {
            geometry,
            colours,
            stated: Vec::new(),
        }
    }
}

/// Returns the shape of an object that is not a solid, if it is defined anywhere, with the colours of its points if its
/// instances differ in colour, and sentences for the user; a surface whose instances differ in their images has several
/// shapes. `own` are the colours of the instances, and `stated` gives the specified colours of the samples of an instance, if
/// they vary.
fn shapes(
    request: &PictureRequest,
    id: ObjectId,
    object: &Object,
    placement: &Placement,
    own: &[[u8; 3]],
    stated: impl Fn(u64) -> Option<Vec<[u8; 3]>>,
) -> (Vec<ColouredShape>, Vec<String>) {
    let (scene, params) = (&*request.scene, &*request.params);
    let (samples, mut notes) = sample_with_notes(scene, params, id, placement);
    let mut counted = PlaceCount::default();
    let mut colours = Vec::new();
    let colour_of = |instance: usize| own[instance.min(own.len() - 1)];
    // Gives an instance's colour to its points, up to the total `count`.
    let mut paint = |instance: usize, count: usize| colours.resize(count, colour_of(instance));
    // A geodesic has samples, but no expression for its position.
    let geometry = match (&samples, object.shape.position()) {
        (Samples::Points(samples), Some(position)) => {
            let places = positions(scene, params, object, position);
            let mut kept = Vec::new();
            for (instance, (place, sample)) in places.into_iter().zip(samples).enumerate() {
                if sample.defined != 0.0 && counted.is_held(&place) {
                    kept.push(place);
                    paint(instance, kept.len());
                }
            }
            Geometry::Points(kept)
        }
        (Samples::Vectors(samples), _) => {
            let Some((direction, origin)) = object.shape.vector() else {
                return (Vec::new(), notes);
            };
            let origins = positions(scene, params, object, origin);
            let directions = positions(scene, params, object, direction);
            let mut lines = Polylines::default();
            let both = origins.iter().zip(&directions).zip(samples);
            let mut zero = 0;
            for (instance, ((from, by), sample)) in both.enumerate() {
                let tip = [0, 1, 2].map(|k| from[k] + by[k]);
                if sample.defined == 0.0 {
                    continue;
                }
                if tip == *from {
                    zero += 1;
                    continue;
                }
                let ends = [*from, tip].map(|end| counted.is_held(&end));
                if ends == [true; 2] {
                    lines.add(&[Some(*from), Some(tip)]);
                    paint(instance, lines.places.len());
                }
            }
            if zero > 0 {
                let (all, name) = (samples.len(), &object.name);
                notes.push(match all {
                    1 => format!("`{name}` is left out: it has no length"),
                    _ => format!(
                        "{zero} of the {all} vectors of `{name}` are left out: they have no length"
                    ),
                });
            }
            Geometry::Lines(lines)
        }
        (Samples::Curves { count, samples }, Some(position)) => {
            let places = positions(scene, params, object, position);
            let mut lines = Polylines::default();
            let count = *count as usize;
            let instances = places.chunks(count).zip(samples.chunks(count));
            for (instance, (places, samples)) in instances.enumerate() {
                let pairs = places.iter().zip(samples);
                let line = pairs.flat_map(|(place, sample)| {
                    let end = sample.is_last().then_some(None);
                    let is_there = sample.defined != 0.0 && counted.is_held(place);
                    std::iter::once(is_there.then_some(*place)).chain(end)
                });
                lines.add(&line.collect::<Vec<_>>());
                paint(instance, lines.places.len());
            }
            Geometry::Lines(lines)
        }
        (Samples::Curves { .. }, None) => {
            let mut lines = Polylines::default();
            let followed = follow_declared(scene, params, id);
            for (instance, line) in followed.lines.iter().enumerate() {
                let places = line.iter().map(|knot| knot.and_then(|knot| knot.position));
                let line = places.map(|place| place.filter(|place| counted.is_held(place)));
                lines.add(&line.collect::<Vec<_>>());
                paint(instance, lines.places.len());
            }
            Geometry::Lines(lines)
        }
        (Samples::Surfaces { count, samples }, Some(position)) => {
            let places = positions(scene, params, object, position);
            let images: Vec<SurfaceImage> = request.image_in_space(id).instances().collect();
            let empty = |(instance, image)| {
                let shape =
                    ColouredShape::new(Geometry::Surface(Mesh::default(), image), Vec::new());
                (shape, stated(instance))
            };
            let mut parts: Vec<_> = (0..).zip(images).map(empty).collect();
            let last = parts.len() - 1;
            let size = count[0] as usize * count[1] as usize;
            let instances = places.chunks(size).zip(samples.chunks(size));
            for (instance, (places, samples)) in instances.enumerate() {
                let (shape, stated) = &mut parts[instance.min(last)];
                for (place, sample) in places.iter().zip(samples) {
                    if sample.defined != 0.0 {
                        counted.is_held(place);
                    }
                }
                let Geometry::Surface(mesh, _) = &mut shape.geometry else {
                    continue;
                };
                let added = mesh.add(*count, places, samples);
                shape.colours.resize(mesh.places.len(), colour_of(instance));
                if let Some(stated) = stated {
                    let of_sample = |sample: u32| stated[sample as usize];
                    shape.stated.extend(added.into_iter().map(of_sample));
                }
            }
            let shapes = parts.into_iter().map(|(shape, _)| shape).collect();
            return defined(shapes, &counted, &object.name, notes);
        }
        _ => return (Vec::new(), notes),
    };
    let shape = ColouredShape::new(geometry, colours);
    defined(vec![shape], &counted, &object.name, notes)
}

/// Returns those of an object's shapes, at least one, that have an extent, and sentences for the user.
fn defined(
    mut shapes: Vec<ColouredShape>,
    counted: &PlaceCount,
    name: &str,
    mut notes: Vec<String>,
) -> (Vec<ColouredShape>, Vec<String>) {
    let lack = match &shapes[0].geometry {
        Geometry::Surface(..) => "it has no area",
        Geometry::Lines(_) => "it has no length",
        Geometry::Points(_) => "it has no place",
    };
    shapes.retain(|shape| match &shape.geometry {
        Geometry::Surface(mesh, _) => !mesh.triangles.is_empty(),
        Geometry::Lines(lines) => !lines.strips.is_empty(),
        Geometry::Points(places) => !places.is_empty(),
    });
    notes.extend(counted.note(name, !shapes.is_empty()));
    if shapes.is_empty() && notes.is_empty() {
        notes.push(format!("`{name}` is left out: {lack}"));
    }
    (shapes, notes)
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
            Self::Nothing {
                left_out, notes, ..
            } if left_out.is_empty() => {
                let reason = match notes[..] {
                    [] => "nothing is drawn in space",
                    _ => &notes.join("; "),
                };
                write!(f, "there is nothing to export: {reason}")
            }
            Self::Nothing {
                format,
                left_out,
                notes,
            } => {
                write!(
                    f,
                    "{} holds surfaces and solids only, so {} left out and nothing remains",
                    format.name(),
                    listed(left_out)
                )?;
                notes.iter().try_for_each(|note| write!(f, "; {note}"))
            }
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
