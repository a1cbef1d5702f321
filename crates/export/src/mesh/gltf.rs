//! glTF 2.0, as JSON with embedded data, or binary. The crate `gltf` provides the types of the JSON document and the
//! binary container.
//!
//! In glTF the y axis points up, in a scene the z axis: the root node rotates one into the other. Positions are in
//! single precision; if a scene is far from the origin, the root node holds its offset, so that the shape keeps its
//! digits.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{self, Cursor, Write};
use std::sync::Arc;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use gltf::binary::{Glb, Header};
use gltf::json::accessor::{ComponentType, GenericComponentType, Type};
use gltf::json::buffer::{Target, View};
use gltf::json::image::MimeType;
use gltf::json::material::{PbrBaseColorFactor, PbrMetallicRoughness, StrengthFactor};
use gltf::json::mesh::{Mode, Primitive, Semantic};
use gltf::json::scene::UnitQuaternion;
use gltf::json::texture::{Info, MagFilter, MinFilter, Sampler, WrappingMode};
use gltf::json::validation::{Checked, USize64};
use gltf::json::{
    Accessor, Buffer, Image, Index, Material, Mesh as JsonMesh, Node, Root, Scene, Value,
};
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};

use super::{ExportError, Geometry, MeshFormat, Model, Part};
use render::style;
use render::texture::{SurfaceImage, Texture};

/// A scene is shifted if its distance from the origin exceeds this multiple of its size.
const FAR: f64 = 64.0;
/// The roughness of the surfaces, chosen to give about the same highlight as the 3D view.
const ROUGHNESS: f32 = 0.55;

/// Writes one JSON file, with its buffer as a data URI.
pub(super) fn write_text(model: &Model, out: &mut dyn Write) -> Result<(), ExportError> {
    let mut document = GltfDocument::of(model, MeshFormat::Gltf)?;
    let uri = format!(
        "data:application/octet-stream;base64,{}",
        BASE64.encode(&document.bytes)
    );
    document.root.buffers[0].uri = Some(uri);
    let mut out = io::BufWriter::new(out);
    document.root.to_writer(&mut out).map_err(io::Error::from)?;
    Ok(out.flush()?)
}

/// Writes one binary file.
pub(super) fn write_binary(model: &Model, out: &mut dyn Write) -> Result<(), ExportError> {
    let document = GltfDocument::of(model, MeshFormat::Glb)?;
    let json = document.root.to_vec().map_err(io::Error::from)?;
    // The header, and the chunks with their own headers.
    let length = 12 + 8 + json.len().next_multiple_of(4) + 8 + document.bytes.len();
    let Ok(length) = u32::try_from(length) else {
        return Err(ExportError::TooLarge {
            format: MeshFormat::Glb,
        });
    };
    let glb = Glb {
        header: Header {
            magic: *b"glTF",
            version: 2,
            length,
        },
        json: Cow::Owned(json),
        bin: Some(Cow::Owned(document.bytes)),
    };
    glb.to_writer(out).map_err(|error| match error {
        gltf::Error::Io(error) => ExportError::Write(error),
        other => ExportError::Write(io::Error::other(other)),
    })
}

/// The JSON description and the binary data that it describes.
struct GltfDocument {
    root: Root,
    bytes: Vec<u8>,
    /// The textures that were added.
    textures: Vec<(SurfaceImage, Index<gltf::json::Texture>)>,
    /// The images of these textures.
    images: Vec<(Arc<Texture>, Index<Image>)>,
    /// The offset that is subtracted from all positions.
    shift: [f32; 3],
}

impl GltfDocument {
    fn of(model: &Model, format: MeshFormat) -> Result<Self, ExportError> {
        let mut document = Self {
            root: Root::default(),
            bytes: Vec::new(),
            textures: Vec::new(),
            images: Vec::new(),
            shift: shift(model),
        };
        document.root.asset.generator = Some(format!("geotrace {}", env!("CARGO_PKG_VERSION")));
        document.root.buffers.push(Buffer {
            byte_length: USize64(0),
            name: None,
            uri: None,
            extensions: None,
            extras: Default::default(),
        });
        let mut children = Vec::new();
        for part in &model.parts {
            let mesh = document.mesh(part)?;
            children.push(document.root.push(Node {
                mesh: Some(mesh),
                name: Some(part.name.clone()),
                ..Node::default()
            }));
        }
        // (x, y, z) ↦ (x, z, −y): a quarter turn about x.
        let half = std::f32::consts::FRAC_1_SQRT_2;
        let [x, y, z] = document.shift;
        let top = document.root.push(Node {
            children: Some(children),
            rotation: Some(UnitQuaternion([-half, 0.0, 0.0, half])),
            translation: (document.shift != [0.0; 3]).then_some([x, z, -y]),
            ..Node::default()
        });
        let scene = document.root.push(Scene {
            extensions: None,
            extras: Default::default(),
            name: None,
            nodes: vec![top],
        });
        document.root.scene = Some(scene);
        if u32::try_from(document.bytes.len()).is_err() {
            return Err(ExportError::TooLarge { format });
        }
        document.root.buffers[0].byte_length = USize64::from(document.bytes.len());
        Ok(document)
    }

    fn mesh(&mut self, part: &Part) -> Result<Index<JsonMesh>, ExportError> {
        let mut attributes = BTreeMap::new();
        // The colours of the vertices, if the part has several.
        let mut colours = part.colours.clone();
        let (indices, mode, image) = match &part.geometry {
            Geometry::Surface(mesh, image) => {
                let vertices = &mesh.vertices;
                let places = vertices.iter().map(|v| mesh.places[v.place as usize]);
                let positions = self.positions(places);
                attributes.insert(Checked::Valid(Semantic::Positions), positions);
                let normals = self.numbers(vertices.iter().flat_map(|v| v.normal), Type::Vec3);
                attributes.insert(Checked::Valid(Semantic::Normals), normals);
                let coordinates = self.numbers(vertices.iter().flat_map(|v| v.uv), Type::Vec2);
                attributes.insert(Checked::Valid(Semantic::TexCoords(0)), coordinates);
                colours = vertices
                    .iter()
                    .filter_map(|v| part.colours.get(v.place as usize).copied())
                    .collect();
                let indices = self.indices(mesh.triangles.iter().flatten().copied());
                (Some(indices), Mode::Triangles, Some(image))
            }
            Geometry::Lines(lines) => {
                let positions = self.positions(lines.places.iter().copied());
                attributes.insert(Checked::Valid(Semantic::Positions), positions);
                let pairs = lines.strips.iter().flat_map(|strip| strip.windows(2));
                let indices = self.indices(pairs.flatten().copied());
                (Some(indices), Mode::Lines, None)
            }
            Geometry::Points(points) => {
                let positions = self.positions(points.iter().copied());
                attributes.insert(Checked::Valid(Semantic::Positions), positions);
                (None, Mode::Points, None)
            }
        };
        if !colours.is_empty() {
            let light = colours.into_iter().flat_map(style::linear);
            let colours = self.numbers(light, Type::Vec3);
            attributes.insert(Checked::Valid(Semantic::Colors(0)), colours);
        }
        let material = self.material(part, image)?;
        let primitive = Primitive {
            attributes,
            extensions: None,
            extras: Default::default(),
            indices,
            material: Some(material),
            mode: Checked::Valid(mode),
            targets: None,
        };
        Ok(self.root.push(JsonMesh {
            extensions: None,
            extras: Default::default(),
            name: Some(part.name.clone()),
            primitives: vec![primitive],
            weights: None,
        }))
    }

    fn material(
        &mut self,
        part: &Part,
        image: Option<&SurfaceImage>,
    ) -> Result<Index<Material>, ExportError> {
        // It multiplies the vertices' colours.
        let [r, g, b] = match part.colours.is_empty() {
            true => style::linear(part.colour),
            false => [1.0; 3],
        };
        let texture = match image {
            Some(image) => Some(Info {
                index: self.texture(image)?,
                tex_coord: 0,
                extensions: None,
                extras: Default::default(),
            }),
            None => None,
        };
        Ok(self.root.push(Material {
            name: Some(part.name.clone()),
            double_sided: true,
            pbr_metallic_roughness: PbrMetallicRoughness {
                base_color_factor: PbrBaseColorFactor([r, g, b, 1.0]),
                base_color_texture: texture,
                metallic_factor: StrengthFactor(0.0),
                roughness_factor: StrengthFactor(ROUGHNESS),
                ..PbrMetallicRoughness::default()
            },
            ..Material::default()
        }))
    }

    /// Adds a texture, once for all surfaces that show its image in the same way.
    fn texture(&mut self, image: &SurfaceImage) -> Result<Index<gltf::json::Texture>, ExportError> {
        let is_same = |of: &SurfaceImage| {
            Arc::ptr_eq(&of.texture, &image.texture) && of.repeats == image.repeats
        };
        if let Some((_, index)) = self.textures.iter().find(|(of, _)| is_same(of)) {
            return Ok(*index);
        }
        let source = self.image(&image.texture)?;
        let [wrap_s, wrap_t] = image.repeats.map(|repeats| {
            Checked::Valid(match repeats {
                true => WrappingMode::Repeat,
                false => WrappingMode::ClampToEdge,
            })
        });
        let sampler = self.root.push(Sampler {
            mag_filter: Some(Checked::Valid(MagFilter::Linear)),
            min_filter: Some(Checked::Valid(MinFilter::LinearMipmapLinear)),
            wrap_s,
            wrap_t,
            ..Sampler::default()
        });
        let index = self.root.push(gltf::json::Texture {
            name: None,
            sampler: Some(sampler),
            source,
            extensions: None,
            extras: Default::default(),
        });
        self.textures.push((image.clone(), index));
        Ok(index)
    }

    /// Adds an image, once for all textures that have it.
    fn image(&mut self, texture: &Arc<Texture>) -> Result<Index<Image>, ExportError> {
        let is_same = |(of, _): &&(Arc<Texture>, Index<Image>)| Arc::ptr_eq(of, texture);
        if let Some((_, index)) = self.images.iter().find(is_same) {
            return Ok(*index);
        }
        let level = &texture.levels()[0];
        let texels: Vec<u8> = level
            .texels
            .iter()
            .flat_map(|t| [t[0], t[1], t[2]])
            .collect();
        let mut file = Cursor::new(Vec::new());
        let [width, height] = level.size;
        PngEncoder::new(&mut file)
            .write_image(&texels, width, height, ExtendedColorType::Rgb8)
            .map_err(io::Error::other)?;
        let view = self.view(file.into_inner(), None);
        let index = self.root.push(Image {
            buffer_view: Some(view),
            mime_type: Some(MimeType("image/png".to_owned())),
            name: None,
            uri: None,
            extensions: None,
            extras: Default::default(),
        });
        self.images.push((texture.clone(), index));
        Ok(index)
    }

    /// Adds positions, with the bounds that the format requires.
    fn positions(&mut self, places: impl Iterator<Item = [f64; 3]>) -> Index<Accessor> {
        let shift = self.shift;
        let local = |place: [f64; 3]| -> [f32; 3] {
            std::array::from_fn(|k| (place[k] - f64::from(shift[k])) as f32)
        };
        let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        let numbers: Vec<f32> = places
            .flat_map(|place| {
                let place = local(place);
                for k in 0..3 {
                    low[k] = low[k].min(place[k]);
                    high[k] = high[k].max(place[k]);
                }
                place
            })
            .collect();
        let index = self.numbers(numbers.into_iter(), Type::Vec3);
        let accessor = &mut self.root.accessors[index.value()];
        accessor.min = Some(Value::from(low.to_vec()));
        accessor.max = Some(Value::from(high.to_vec()));
        index
    }

    fn numbers(&mut self, numbers: impl Iterator<Item = f32>, kind: Type) -> Index<Accessor> {
        let bytes: Vec<u8> = numbers.flat_map(f32::to_le_bytes).collect();
        let count = bytes.len() / (4 * kind.multiplicity());
        let view = self.view(bytes, Some(Target::ArrayBuffer));
        self.accessor(view, count, ComponentType::F32, kind)
    }

    fn indices(&mut self, indices: impl Iterator<Item = u32>) -> Index<Accessor> {
        let bytes: Vec<u8> = indices.flat_map(u32::to_le_bytes).collect();
        let count = bytes.len() / 4;
        let view = self.view(bytes, Some(Target::ElementArrayBuffer));
        self.accessor(view, count, ComponentType::U32, Type::Scalar)
    }

    fn accessor(
        &mut self,
        view: Index<View>,
        count: usize,
        component: ComponentType,
        kind: Type,
    ) -> Index<Accessor> {
        self.root.push(Accessor {
            buffer_view: Some(view),
            byte_offset: None,
            count: USize64::from(count),
            component_type: Checked::Valid(GenericComponentType(component)),
            extensions: None,
            extras: Default::default(),
            type_: Checked::Valid(kind),
            min: None,
            max: None,
            name: None,
            normalized: false,
            sparse: None,
        })
    }

    /// Adds data, padded with zeros to a multiple of four bytes.
    fn view(&mut self, bytes: Vec<u8>, target: Option<Target>) -> Index<View> {
        let (offset, length) = (self.bytes.len(), bytes.len());
        self.bytes.extend(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.root.push(View {
            buffer: Index::new(0),
            byte_length: USize64::from(length),
            byte_offset: Some(USize64::from(offset)),
            byte_stride: None,
            name: None,
            target: target.map(Checked::Valid),
            extensions: None,
            extras: Default::default(),
        })
    }
}

/// Returns the centre of all points if it is far from the origin, otherwise zero.
pub(super) fn shift(model: &Model) -> [f32; 3] {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for part in &model.parts {
        let places = match &part.geometry {
            Geometry::Surface(mesh, _) => &mesh.places,
            Geometry::Lines(lines) => &lines.places,
            Geometry::Points(points) => points,
        };
        for place in places {
            for k in 0..3 {
                low[k] = low[k].min(place[k]);
                high[k] = high[k].max(place[k]);
            }
        }
    }
    let middle = [0, 1, 2].map(|k| 0.5 * low[k] + 0.5 * high[k]);
    let size = (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max);
    let away = middle.iter().fold(0.0, |a: f64, b| a.max(b.abs()));
    if away > FAR * size && away.is_finite() {
        middle.map(|x| x as f32)
    } else {
        [0.0; 3]
    }
}
