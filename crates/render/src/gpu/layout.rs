//! Uniform structs with the layout of WGSL; tests compare each with its counterpart in `/shaders`.

use bytemuck::{Pod, Zeroable};

use crate::camera::Camera;
use crate::style::{self, Look};

/// `View` of lib/view.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct ViewUniform {
    pub(crate) view_from_world: [[f32; 4]; 4],
    pub(crate) zoom: [f32; 2],
    pub(crate) near: f32,
    pub(crate) pixels_per_unit: f32,
    pub(crate) key_direction: [f32; 3],
    pub(crate) pixel_unit: f32,
    pub(crate) ambient: f32,
    pub(crate) fill: f32,
    pub(crate) key: f32,
    pub(crate) highlight: f32,
    pub(crate) highlight_power: f32,
    pub(crate) glyph_rim: f32,
    pub(crate) tile_scale: [f32; 2],
    pub(crate) tile_offset: [f32; 2],
    pub(crate) plane: f32,
    pub(crate) reach: f32,
    pub(crate) emphasis: [f32; 4],
}

impl ViewUniform {
    /// Returns the view of a camera, for a tile (first pixel, size) of its picture.
    pub(crate) fn new(camera: &Camera, first: [u32; 2], size: [u32; 2]) -> Self {
        // x_tile = x · scale + offset maps the tile's part of [−1,1] to [−1,1]; y points up, rows go down.
        let scale = [0, 1].map(|k| camera.size[k] as f32 / size[k] as f32);
        let middle = [0, 1].map(|k| {
            let place = (2 * first[k] + size[k]) as f32 / camera.size[k] as f32 - 1.0;
            if k == 0 { place } else { -place }
        });
        Self {
            view_from_world: camera.view_from_world().to_cols_array_2d(),
            zoom: camera.half_tangents().map(|tangent| (1.0 / tangent) as f32),
            near: camera.near as f32,
            pixels_per_unit: camera.pixels_per_unit(),
            key_direction: style::KEY_DIRECTION,
            pixel_unit: style::pixel_unit(camera.size),
            ambient: style::AMBIENT,
            fill: style::FILL,
            key: style::KEY,
            highlight: style::HIGHLIGHT,
            highlight_power: style::HIGHLIGHT_POWER as f32,
            glyph_rim: style::GLYPH_RIM,
            tile_scale: scale,
            tile_offset: [-middle[0] * scale[0], -middle[1] * scale[1]],
            plane: camera.parallel.map_or(0.0, |it| it.distance as f32),
            reach: camera.parallel.map_or(0.0, |it| it.reach as f32),
            emphasis: {
                let [r, g, b] = style::linear(style::EMPHASIS_COLOUR);
                [r, g, b, 0.0]
            },
        }
    }
}

/// `Glyph` of lib/glyph.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Glyph {
    pub(crate) nominal: f32,
    pub(crate) min_pixels: f32,
    pub(crate) max_pixels: f32,
    pub(crate) least: f32,
    pub(crate) lift: f32,
    pub(crate) join_lift: f32,
    pub(crate) head_length: f32,
    pub(crate) head_radius: f32,
    pub(crate) head_share: f32,
    pub(crate) count: u32,
    pub(crate) total: u32,
    pub(crate) first: u32,
    pub(crate) emphasis: f32,
}

impl Glyph {
    /// Returns a glyph of the given look and width: `count` samples per instance, `total` in all, drawn from `first` on.
    pub(crate) fn new(
        look: &Look,
        length: &style::Length,
        least: f32,
        count: u32,
        total: u32,
        first: u32,
    ) -> Self {
        let line = look.line;
        let length = length.times(line.width);
        Self {
            nominal: length.nominal,
            min_pixels: length.min_pixels,
            max_pixels: length.max_pixels,
            least,
            lift: style::GLYPH_LIFT + line.lift,
            join_lift: style::JOIN_LIFT + line.lift,
            head_length: style::HEAD_LENGTH,
            head_radius: style::HEAD_RADIUS,
            head_share: style::HEAD_SHARE,
            count,
            total,
            first,
            emphasis: look.emphasis,
        }
    }
}

/// `Patch` of pass/draw_surfaces.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Patch {
    pub(crate) count: [u32; 2],
    pub(crate) first: u32,
    pub(crate) emphasis: f32,
}

/// `SolidExtent` of pass/draw_solids.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct SolidExtent {
    pub(crate) columns: u32,
}

/// `Sampling` of lib/sampling.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Sampling {
    pub(crate) minimum: [f32; 2],
    pub(crate) maximum: [f32; 2],
    pub(crate) count: [u32; 2],
    pub(crate) total: u32,
    pub(crate) slots: u32,
    pub(crate) centre: [f32; 3],
    pub(crate) per_length: f32,
    pub(crate) horizon: f32,
    pub(crate) nudge: f32,
    pub(crate) padding: [f32; 2],
}

/// `Resolve` of lib/picture.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Resolve {
    pub(crate) colour: [f32; 4],
    pub(crate) place: [f32; 2],
    pub(crate) per_width: [f32; 2],
    pub(crate) repeats: [f32; 2],
    pub(crate) size: [u32; 2],
    pub(crate) rows: [u32; 2],
    pub(crate) padding: [u32; 2],
    pub(crate) hatch: f32,
    pub(crate) reach: i32,
    pub(crate) ring: f32,
    pub(crate) ring_half: f32,
    pub(crate) stride: [u32; 4],
    pub(crate) hatching: [[f32; 4]; 12],
}

/// `Table` of pass/evaluate.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Table {
    pub(crate) rows: u32,
    pub(crate) variables: u32,
    pub(crate) uniforms: u32,
    pub(crate) roots: u32,
}

/// `Lens` of lib/lens.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Lens {
    pub(crate) right: [f32; 3],
    pub(crate) aperture: f32,
    pub(crate) up: [f32; 3],
    pub(crate) focus: f32,
    pub(crate) forward: [f32; 3],
    pub(crate) half_opening: f32,
    pub(crate) position: [f32; 3],
    pub(crate) tangent: f32,
    pub(crate) size: [u32; 2],
    pub(crate) projection: u32,
    pub(crate) ball: u32,
    pub(crate) bokeh: u32,
    pub(crate) corners: u32,
    pub(crate) axes: u32,
    pub(crate) grid: u32,
}

/// `Trace` of pass/trace_tables.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Trace {
    pub(crate) lens: Lens,
    pub(crate) first_row: u32,
    pub(crate) rows: u32,
    pub(crate) sample: u32,
    pub(crate) bit: u32,
    pub(crate) light_count: u32,
    pub(crate) endless: u32,
    pub(crate) boxes: u32,
    pub(crate) bounces: u32,
    pub(crate) look: u32,
    pub(crate) least_weight: f32,
    pub(crate) order_at: u32,
    pub(crate) terms_at: u32,
    pub(crate) sky_at: u32,
    pub(crate) sky_cells: u32,
    pub(crate) slab_row: u32,
    pub(crate) one: u32,
}

/// `BoxNode` of pass/trace_tables.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct BoxNode {
    pub(crate) lower: [f32; 3],
    pub(crate) place: u32,
    pub(crate) upper: [f32; 3],
    pub(crate) count: u32,
}

/// `Component` of pass/trace_tables.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Component {
    pub(crate) solid: u32,
    pub(crate) first_leaf: u32,
    pub(crate) leaf_count: u32,
    pub(crate) first_node: u32,
    pub(crate) node_count: u32,
    pub(crate) glass: u32,
    pub(crate) ior: f32,
    pub(crate) depth: f32,
}

/// `Leaf` of pass/trace_tables.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct Leaf {
    pub(crate) row_x: [f32; 4],
    pub(crate) row_y: [f32; 4],
    pub(crate) row_z: [f32; 4],
    pub(crate) centre: [f32; 3],
    pub(crate) first_piece: u32,
    pub(crate) lower: [f32; 3],
    pub(crate) piece_count: u32,
    pub(crate) upper: [f32; 3],
    pub(crate) gate: u32,
    pub(crate) material: u32,
    pub(crate) sides: u32,
    pub(crate) padding: [u32; 2],
}

/// `Piece` of pass/trace_tables.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct LeafPiece {
    pub(crate) squares: [f32; 3],
    pub(crate) constant: f32,
    pub(crate) mixed: [f32; 3],
    pub(crate) literal: u32,
    pub(crate) linear: [f32; 3],
    pub(crate) frame: u32,
    pub(crate) equation: u32,
    pub(crate) leaf: u32,
    pub(crate) kind: u32,
    pub(crate) terms: u32,
}

/// `Material` of pass/trace_tables.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct FaceMaterial {
    pub(crate) color: [f32; 3],
    pub(crate) scattered: f32,
    pub(crate) mirror: [f32; 3],
    pub(crate) glass: f32,
    pub(crate) specular: f32,
    pub(crate) shininess: f32,
    pub(crate) lists: u32,
    pub(crate) varies: u32,
}

/// `Light` of lib/optics.wgsl.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(crate) struct ShaderLight {
    pub(crate) position: [f32; 3],
    pub(crate) kind: u32,
    pub(crate) direction: [f32; 3],
    pub(crate) size: f32,
    pub(crate) color: [f32; 3],
    pub(crate) ambient: f32,
    pub(crate) highlight: [f32; 3],
    pub(crate) falloff: f32,
    pub(crate) edge: f32,
    pub(crate) soft: f32,
    pub(crate) casts_shadows: u32,
    pub(crate) padding: u32,
}

#[cfg(test)]
mod tests {
    use std::mem::{offset_of, size_of};

    use wgsl::{Joined, library, painter};

    /// Compares offsets of members and the size of a struct with those that naga finds.
    macro_rules! assert_same_layout {
        ($joined:expr, $name:literal, $rust:ty, [$($member:ident),* $(,)?]) => {
            let found: Vec<(String, usize)> = $joined
                .struct_layout($name)
                .into_iter()
                .map(|(member, offset, _)| (member, offset as usize))
                .collect();
            let here = vec![$((stringify!($member).to_owned(), offset_of!($rust, $member))),*];
            assert_eq!(found, here, "members of {}", $name);
            assert_eq!($joined.struct_size($name) as usize, size_of::<$rust>(), "size of {}", $name);
        };
    }

    fn stubbed(pieces: &[library::Piece<'_>]) -> Joined {
        wgsl::join::join(pieces).expect("stubs join")
    }

    #[test]
    fn uniform_structs_are_laid_out_as_in_the_shaders() {
        let surfaces = painter::surfaces().expect("valid");
        assert_same_layout!(
            surfaces,
            "View",
            super::ViewUniform,
            [
                view_from_world,
                zoom,
                near,
                pixels_per_unit,
                key_direction,
                pixel_unit,
                ambient,
                fill,
                key,
                highlight,
                highlight_power,
                glyph_rim,
                tile_scale,
                tile_offset,
                plane,
                reach,
                emphasis,
            ]
        );
        assert_same_layout!(surfaces, "Patch", super::Patch, [count, first, emphasis]);
        let solids = painter::solids().expect("valid");
        assert_same_layout!(solids, "SolidExtent", super::SolidExtent, [columns]);
        let curves = painter::curves().expect("valid");
        assert_same_layout!(
            curves,
            "Glyph",
            super::Glyph,
            [
                nominal,
                min_pixels,
                max_pixels,
                least,
                lift,
                join_lift,
                head_length,
                head_radius,
                head_share,
                count,
                total,
                first,
                emphasis,
            ]
        );
        let resolve = painter::resolve_piecewise().expect("valid");
        assert_same_layout!(
            resolve,
            "Resolve",
            super::Resolve,
            [
                colour, place, per_width, repeats, size, rows, padding, hatch, reach, ring,
                ring_half, stride, hatching,
            ]
        );
        let samples = stubbed(&[
            library::NUMBER,
            library::SAMPLING,
            library::CONTRACT_POINT,
            library::PASS_SAMPLE_POINT,
        ]);
        assert_same_layout!(
            samples,
            "Sampling",
            super::Sampling,
            [
                minimum, maximum, count, total, slots, centre, per_length, horizon, nudge, padding,
            ]
        );
        let evaluate = stubbed(&[
            library::NUMBER,
            library::SAMPLING,
            library::CONTRACT_EVALUATE,
            library::PASS_EVALUATE,
        ]);
        assert_same_layout!(
            evaluate,
            "Table",
            super::Table,
            [rows, variables, uniforms, roots]
        );
    }

    #[test]
    fn structs_of_traced_pictures_are_laid_out_as_in_the_shader() {
        let trace = wgsl::traced::trace_scene("").expect("valid");
        assert_same_layout!(
            trace,
            "Lens",
            super::Lens,
            [
                right,
                aperture,
                up,
                focus,
                forward,
                half_opening,
                position,
                tangent,
                size,
                projection,
                ball,
                bokeh,
                corners,
                axes,
                grid
            ]
        );
        assert_same_layout!(
            trace,
            "Trace",
            super::Trace,
            [
                lens,
                first_row,
                rows,
                sample,
                bit,
                light_count,
                endless,
                boxes,
                bounces,
                look,
                least_weight,
                order_at,
                terms_at,
                sky_at,
                sky_cells,
                slab_row,
                one
            ]
        );
        assert_same_layout!(
            trace,
            "BoxNode",
            super::BoxNode,
            [lower, place, upper, count]
        );
        assert_same_layout!(
            trace,
            "Component",
            super::Component,
            [
                solid, first_leaf, leaf_count, first_node, node_count, glass, ior, depth
            ]
        );
        assert_same_layout!(
            trace,
            "Leaf",
            super::Leaf,
            [
                row_x,
                row_y,
                row_z,
                centre,
                first_piece,
                lower,
                piece_count,
                upper,
                gate,
                material,
                sides,
                padding
            ]
        );
        assert_same_layout!(
            trace,
            "Piece",
            super::LeafPiece,
            [
                squares, constant, mixed, literal, linear, frame, equation, leaf, kind, terms
            ]
        );
        assert_same_layout!(
            trace,
            "Material",
            super::FaceMaterial,
            [
                color, scattered, mirror, glass, specular, shininess, lists, varies
            ]
        );
        assert_same_layout!(
            trace,
            "Light",
            super::ShaderLight,
            [
                position,
                kind,
                direction,
                size,
                color,
                ambient,
                highlight,
                falloff,
                edge,
                soft,
                casts_shadows,
                padding
            ]
        );
    }
}
