//! The tables of a scene in f32, in buffers.

use bytemuck::{Pod, Zeroable};
use geometry::solids::VaryingAttribute;
use glam::{DVec3, DVec4};
use tracer::BoundingBox;
use tracer::shade::{FaceSides, Glass};
use tracer::tables::{LeafRow, LiteralRow, NodeRow, PieceRow, SurfaceRow};

use crate::error::RenderError;
use crate::gpu::device::Gpu;
use crate::gpu::layout::{BoxNode, Component, FaceMaterial, Leaf, LeafPiece};
use crate::gpu::trace::codes;
use crate::gpu::trace::lens::three;
use crate::solids::{AttributeList, SceneTables, TableField, TableLook};

/// Boxes are enlarged by this fraction of their sides, and of the distances of their corners, so that rounding excludes
/// nothing.
const SIDE_SLACK: f64 = 1e-5;
const CORNER_SLACK: f64 = 4e-6;
/// The coordinates of a box that contains everything.
const EVERYWHERE: f64 = 1e15;
/// The value of "no parent" in 15 bits.
const NO_PARENT: u32 = 0x7fff;
/// The material of components without glass.
const NO_GLASS: u32 = u32::MAX;
/// The highest bit.
const FLAG: u32 = 1 << 31;

/// A scene on the device.
#[derive(Debug)]
pub(super) struct TableBuffers {
    pub(super) boxes: wgpu::Buffer,
    pub(super) components: wgpu::Buffer,
    pub(super) leaves: wgpu::Buffer,
    pub(super) pieces: wgpu::Buffer,
    pub(super) words: wgpu::Buffer,
    pub(super) materials: wgpu::Buffer,
    pub(super) places: WordPlaces,
}

/// The index among the words at which each part begins; the nodes begin at 0.
#[derive(Clone, Copy, Debug)]
pub(super) struct WordPlaces {
    pub(super) order: u32,
    pub(super) terms: u32,
    pub(super) sky: u32,
}

impl TableBuffers {
    /// Copies a scene to the device.
    ///
    /// # Errors
    /// [`RenderError::Gpu`] if it does not support buffers of this size.
    pub(super) fn new(gpu: &Gpu, tables: &SceneTables) -> Result<Self, RenderError> {
        let world = &tables.world;
        let boxes = world.boxes.iter().map(|row| {
            let (lower, upper) = widened(Some(row.bounds));
            BoxNode {
                lower,
                place: row.place,
                upper,
                count: row.count,
            }
        });
        let components = world.components.iter().map(|row| {
            let glass = tables.glass.get(row.solid as usize);
            let (glass, look) = glass.copied().flatten().unzip();
            Component {
                solid: row.solid,
                first_leaf: row.first_leaf,
                leaf_count: row.leaf_count,
                first_node: row.first_node,
                node_count: row.node_count,
                glass: look.unwrap_or(NO_GLASS),
                ior: glass.map_or(1.0, |glass: Glass| glass.ior as f32),
                depth: glass.map_or(1.0, |glass| glass.depth as f32),
            }
        });
        let leaves = world.leaves.iter().map(|row| leaf(tables, row));
        let mut words: Vec<u32> = world.nodes.iter().flat_map(node).collect();
        let order = words.len() as u32;
        words.extend(&world.order);
        let terms = words.len() as u32;
        words.extend(world.terms.iter().flat_map(|&([x, y, z], c)| {
            let exponents = u32::from_le_bytes([x, y, z, 0]);
            [exponents, (c as f32).to_bits()]
        }));
        let sky = words.len() as u32;
        words.extend(
            tables
                .sky
                .iter()
                .flat_map(|&light| three(light))
                .map(f32::to_bits),
        );
        let fields: Vec<u32> = tables
            .fields
            .iter()
            .map(|field| add_field(&mut words, field))
            .collect();
        let pieces = world.pieces.iter().map(|row| piece(row, &fields));
        let mut pieces: Vec<LeafPiece> = pieces.collect();
        for (k, row) in world.leaves.iter().enumerate() {
            let own = row.first_piece as usize..(row.first_piece + row.piece_count) as usize;
            for piece in &mut pieces[own] {
                piece.leaf = k as u32;
            }
        }
        let mut lists = |look: &TableLook| {
            let first = words.len() as u32;
            look.lists
                .iter()
                .for_each(|list| add_list(&mut words, list));
            first
        };
        let looks = tables.looks.iter();
        let materials: Vec<FaceMaterial> = looks.map(|look| material(look, lists(look))).collect();
        Ok(Self {
            boxes: rows(gpu, "boxes", boxes)?,
            components: rows(gpu, "components", components)?,
            leaves: rows(gpu, "leaves", leaves)?,
            pieces: rows(gpu, "pieces", pieces)?,
            words: rows(gpu, "words", words)?,
            materials: rows(gpu, "materials", materials)?,
            places: WordPlaces { order, terms, sky },
        })
    }
}

/// Creates a buffer of rows, never empty.
fn rows<T: Pod>(
    gpu: &Gpu,
    label: &str,
    rows: impl IntoIterator<Item = T>,
) -> Result<wgpu::Buffer, RenderError> {
    let mut rows: Vec<T> = rows.into_iter().collect();
    if rows.is_empty() {
        rows.push(T::zeroed());
    }
    let bytes: &[u8] = bytemuck::cast_slice(&rows);
    gpu.check_size(label, bytes.len() as u64)?;
    Ok(gpu.storage(label, bytes))
}

/// Returns the corners of a box, slightly enlarged.
fn widened(bounds: Option<BoundingBox>) -> ([f32; 3], [f32; 3]) {
    let Some(BoundingBox { lower, upper }) = bounds else {
        let far = DVec3::splat(EVERYWHERE);
        return (three(-far), three(far));
    };
    let longest = (upper - lower).max_element().max(0.0);
    let slack = SIDE_SLACK * longest + CORNER_SLACK * lower.abs().max(upper.abs());
    (three(lower - slack), three(upper + slack))
}

fn literal(row: LiteralRow) -> u32 {
    row.node | if row.complemented { FLAG } else { 0 }
}

fn node(row: &NodeRow) -> [u32; 2] {
    let kind = if row.is_union { FLAG } else { 0 };
    let parent = row.parent.unwrap_or(NO_PARENT);
    [kind | parent << 16 | row.parts, row.holding]
}

fn leaf(tables: &SceneTables, row: &LeafRow) -> Leaf {
    let map = row.frame_from_world;
    let axes = map.matrix3.transpose();
    let with = |axis: DVec3, shift: f64| [axis.x, axis.y, axis.z, shift].map(|x| x as f32);
    let (lower, upper) = widened(row.bounds);
    let (look, sides) = tables.leaves[row.leaf as usize];
    Leaf {
        row_x: with(axes.x_axis, map.translation.x),
        row_y: with(axes.y_axis, map.translation.y),
        row_z: with(axes.z_axis, map.translation.z),
        centre: three(row.centre),
        first_piece: row.first_piece,
        lower,
        piece_count: row.piece_count,
        upper,
        gate: literal(row.gate),
        material: look,
        sides: match sides {
            FaceSides::Both => codes::SIDES_BOTH,
            FaceSides::Outer => codes::SIDES_OUTER,
            FaceSides::None => codes::SIDES_NONE,
        },
        padding: [0; 2],
    }
}

/// Converts a piece; its leaf is not known yet. `fields` has the first word of each field.
fn piece(row: &PieceRow, fields: &[u32]) -> LeafPiece {
    let piece = LeafPiece {
        literal: literal(row.literal),
        frame: row.frame,
        equation: row.equation,
        kind: codes::OPPOSITE_PIECE * u32::from(row.opposite),
        ..LeafPiece::zeroed()
    };
    match row.surface {
        SurfaceRow::Field(field) => LeafPiece {
            kind: piece.kind | codes::FIELD_PIECE,
            terms: fields[field as usize],
            ..piece
        },
        SurfaceRow::Polynomial(row) => LeafPiece {
            squares: three(row.squares),
            constant: row.constant as f32,
            mixed: three(row.mixed),
            linear: three(row.linear),
            kind: piece.kind | row.degree,
            terms: row.first_term << 6 | row.term_count,
            ..piece
        },
    }
}

/// Returns the material of a look whose lists begin at the word `lists`.
fn material(look: &TableLook, lists: u32) -> FaceMaterial {
    let base = look.base;
    let scattered = match look.lists[..] {
        [] => base.scattered(),
        // The remainder after mirror and glass is known only at a point.
        _ => base.diffuse.unwrap_or(-1.0),
    };
    let through = codes::VARIES_THROUGH * u32::from(look.varies_through());
    let colour = codes::VARIES_COLOR * u32::from(look.varies_in_colour());
    FaceMaterial {
        color: three(base.colour),
        scattered: scattered as f32,
        mirror: three(base.mirror),
        glass: base.glass as f32,
        specular: base.specular as f32,
        shininess: base.shininess as f32,
        lists,
        varies: look.lists.len() as u32 | through | colour,
    }
}

fn varied(attribute: VaryingAttribute) -> u32 {
    match attribute {
        VaryingAttribute::Colour => codes::VARIED_COLOR,
        VaryingAttribute::Mirror => codes::VARIED_MIRROR,
        VaryingAttribute::Glass => codes::VARIED_GLASS,
        VaryingAttribute::Diffuse => codes::VARIED_DIFFUSE,
        VaryingAttribute::Specular => codes::VARIED_SPECULAR,
        VaryingAttribute::Shininess => codes::VARIED_SHININESS,
        VaryingAttribute::Bump => codes::VARIED_BUMP,
    }
}

/// Adds the words of a list, in the format of pass/trace_varied.wgsl.
fn add_list(words: &mut Vec<u32>, list: &AttributeList) {
    let along = codes::LIST_ALONG * u32::from(list.along.is_some());
    let flags = along | (codes::LIST_BRIGHT * u32::from(list.bright));
    let count = list.attributes.len() as u32;
    let all = codes::LIST_HEAD + count + list.numbers.len() as u32;
    words.extend([list.function, count, flags, all]);
    let axes = list.frame.matrix3.transpose();
    let shift = list.frame.translation;
    let mut rows = [
        axes.x_axis.extend(shift.x),
        axes.y_axis.extend(shift.y),
        axes.z_axis.extend(shift.z),
    ];
    if let Some([from, to]) = list.along {
        // z from −1 to 1 as a fraction from 0 to 1, then the parameters.
        let share = 0.5 * rows[2] + DVec4::new(0.0, 0.0, 0.0, 0.5);
        rows = [share, DVec4::new(from, to, 0.0, 0.0), DVec4::ZERO];
    }
    let rows = rows.iter().flat_map(|row| row.to_array());
    words.extend(rows.map(|number| (number as f32).to_bits()));
    words.extend(list.attributes.iter().map(|attribute| varied(*attribute)));
    words.extend(list.numbers.iter().map(|&number| used(number).to_bits()));
}

/// Adds the words of a field, in the format of pass/trace_fields.wgsl, and returns the index of the first.
fn add_field(words: &mut Vec<u32>, field: &TableField) -> u32 {
    let first = words.len() as u32;
    words.push(field.function);
    let frame = field.frame.iter().flat_map(|place| three(*place));
    words.extend(frame.map(f32::to_bits));
    debug_assert_eq!(words.len() as u32, first + codes::FIELD_HEAD);
    words.extend(field.numbers.iter().map(|&number| used(number).to_bits()));
    first
}

/// Returns a number that a generated function reads; NaN and numbers that are too large are replaced by one that stands for
/// everything.
fn used(number: f64) -> f32 {
    if number.abs() < f64::from(f32::MAX) {
        number as f32
    } else {
        f32::MAX
    }
}
