//! The geodesic view: the ends of all pixels' geodesics, a table of polynomials that the fan's rays gave in f64, coloured
//! by a fixed pass. Maps pixel by pixel, which are there for comparison, are coloured on the CPU.
//!
//! Pictures are made in slabs of rows, so that memory is bounded.

use geodesic::patchwork::table::code_of;
use geodesic::trace::Status;
use geometry::ManifoldError;
use image::RgbaImage;
use scene::ParamValues;
use scene::Scene;

use crate::geodesic_view::{self, Cover, HATCH, LEAST_RING, RING, Seen, Tally};
use crate::gpu::Drawn;
use crate::gpu::layout::Resolve;
use crate::gpu::workshop::{Workshop, dispatch};
use crate::overlay::OverInside;
use crate::plan::Plan;
use crate::request::{RenderError, Request};
use crate::software;
use crate::style;

/// Pixels of one slab: 16 MB of colours.
const SLAB_PIXELS: u32 = 1 << 22;
/// How many statuses there are.
pub(crate) const STATUSES: usize = 6;

/// Draws the plan's geodesic view; gives the picture and its notes.
pub(crate) fn render(
    workshop: &mut Workshop<'_>,
    scene: &Scene,
    settings: &ParamValues,
    request: &Request,
    plan: &Plan,
    progress: &(dyn Fn(f32) + Sync),
) -> Result<Drawn, RenderError> {
    let Some(view) = &plan.geodesic else {
        return Err(ManifoldError::NoSurface { name: None }.into());
    };
    let inside = geodesic_view::Inside::new(scene, settings, request)?;
    let object = &scene.objects[view.surface.0 as usize];
    let seen = inside.look(&|share| progress(0.9 * share));
    let tally = Tally::default();
    let Seen::Patchwork { patchwork, .. } = &seen else {
        let picture = software::paint(scene, settings, request, &inside, &seen, &tally)?;
        progress(1.0);
        return Ok(Drawn {
            image: picture.image,
            notes: picture.notes,
            overlays: picture.overlays,
        });
    };
    let [width, height] = request.size;
    let mut picture = RgbaImage::new(width, height);

    let pipeline = workshop.resolve_pipeline(&wgsl::painter::resolve_patchwork()?);
    let cover = Cover::new(
        &request.texture(view.surface),
        inside.domain(),
        inside.sides(),
    );
    let sampler = workshop.sampler(cover.repeats);
    let image = workshop.texture(&cover.texture);
    let colour = request.colour(view.surface, &object.shape);
    let mut resolve = description(request, &cover, inside.frame.uv.0, colour);
    let slab = (SLAB_PIXELS / width).clamp(1, height);
    let gpu = workshop.gpu;
    let table = gpu.storage("table", bytemuck::cast_slice(&patchwork.table()));
    let counts = gpu.output("counts", 4 * STATUSES as u64)?;
    for first in (0..height).step_by(slab as usize) {
        let rows = slab.min(height - first);
        resolve.rows = [first, rows];
        let uniform = gpu.uniform("resolve", &resolve);
        let size = 4 * u64::from(width) * u64::from(rows);
        let colours = gpu.output("colours", size)?;
        let group = workshop.bind(
            &pipeline.get_bind_group_layout(0),
            &[
                uniform.as_entire_binding(),
                table.as_entire_binding(),
                colours.as_entire_binding(),
                counts.as_entire_binding(),
                wgpu::BindingResource::TextureView(&image),
                wgpu::BindingResource::Sampler(&sampler),
            ],
        );
        gpu.submit(|encoder| {
            dispatch(
                encoder,
                &pipeline,
                &group,
                [width.div_ceil(8), rows.div_ceil(8)],
            )
        });
        let start = 4 * first as usize * width as usize;
        gpu.read(&colours, size, |bytes| {
            picture.as_flat_samples_mut().samples[start..start + bytes.len()]
                .copy_from_slice(bytes);
        })?;
        progress((first + rows) as f32 / height as f32);
    }
    let counts: Vec<u32> = gpu.read(&counts, 4 * STATUSES as u64, bytemuck::pod_collect_to_vec)?;
    let count = |status| {
        counts
            .get(code_of(status) as usize)
            .map_or(0, |&count| count as usize)
    };
    let pixels = width as usize * height as usize;
    let mut notes = geodesic_view::notes(pixels, count, &seen.work(), seen.estimate());
    let over = OverInside::new(scene, settings, request, &inside, view.surface, &tally);
    let (over, overlays) = over.draw(&mut picture, &seen);
    notes.extend(over);
    Ok(Drawn {
        image: picture,
        notes,
        overlays,
    })
}

/// What the fixed pass needs, but for the rows. The ends' offsets count from `origin`.
pub(crate) fn description(
    request: &Request,
    cover: &Cover,
    origin: [f64; 2],
    [r, g, b]: [f32; 3],
) -> Resolve {
    let size = request.size;
    let pixel_unit = style::pixel_unit(size);
    let hatch_unit = pixel_unit.max(0.4);
    let mark = request.mark_centre && size[0].min(size[1]) >= 32;
    let mut hatching = [[1.0; 4]; 12];
    for (code, pair) in hatching.chunks_exact_mut(2).enumerate() {
        let colours = geodesic_view::hatching(status_of(code as u32));
        for (to, colour) in pair.iter_mut().zip(colours) {
            let [r, g, b] = style::linear(colour);
            *to = [r, g, b, 1.0];
        }
    }
    let place = cover.share(origin);
    Resolve {
        colour: [r, g, b, 1.0],
        // Where the image repeats, whole turns would only cost digits.
        place: [0, 1].map(|k| match cover.repeats[k] {
            true => (place[k] - place[k].floor()) as f32,
            false => place[k] as f32,
        }),
        per_width: [0, 1].map(|k| (1.0 / cover.period[k]) as f32),
        repeats: cover.repeats.map(|repeats| f32::from(u8::from(repeats))),
        size,
        rows: [0, size[1]],
        padding: [0; 2],
        hatch: HATCH * hatch_unit,
        reach: (hatch_unit.round() as i32).max(1),
        ring: if mark {
            (RING * pixel_unit).max(LEAST_RING)
        } else {
            0.0
        },
        ring_half: (0.75 * pixel_unit).max(0.6),
        stride: [size[0], 0, 0, 0],
        hatching,
    }
}

fn status_of(code: u32) -> Status {
    match code {
        0 => Status::Complete,
        1 => Status::LeftDomain,
        2 => Status::ConePoint,
        3 => Status::Degenerate,
        4 => Status::Undefined,
        _ => Status::WorkLimit,
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_pass_reads_a_table_of_the_layout_that_is_written() {
        use geodesic::patchwork::table::{APEX_WORDS, PATCH_WORDS, SINGLE_WORDS};
        use geodesic::patchwork::{ARC_TANGENT, BLOCK, DEGREE};
        let joined = wgsl::painter::resolve_patchwork().expect("valid");
        let text = joined.source();
        for (name, value) in [
            ("APEX_WORDS", APEX_WORDS),
            ("PATCH_WORDS", PATCH_WORDS),
            ("SINGLE_WORDS", SINGLE_WORDS),
            ("DEGREE", DEGREE),
        ] {
            let line = format!("const {name}: u32 = {value}u;");
            assert!(text.contains(&line), "{line}");
        }
        assert_eq!(BLOCK, 8, "a workgroup is a block");
        for coefficient in ARC_TANGENT {
            let number = coefficient.abs().to_string();
            assert!(text.contains(&number), "{number}");
        }
    }
}
