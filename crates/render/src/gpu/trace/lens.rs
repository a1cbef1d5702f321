//! Cameras and lights in f32, in the format of the pass of traced pictures.

use glam::DVec3;
use tracer::camera::{Bokeh, LensCamera, LensProjection, STAR_CORNERS, SampleAxes, SharpPlaces};
use tracer::light::{Light, LightKind};

use crate::gpu::layout::{Lens, ShaderLight};
use crate::gpu::trace::codes;

/// Converts a camera; its position is relative to `origin`.
pub(super) fn lens_of(
    camera: &LensCamera,
    axes: SampleAxes,
    size: [u32; 2],
    origin: DVec3,
) -> Lens {
    let [right, up, forward] = camera.axes();
    let (bokeh, corners) = match camera.bokeh {
        Bokeh::Circle => (codes::BOKEH_CIRCLE, 0),
        Bokeh::Line => (codes::BOKEH_LINE, 0),
        Bokeh::Box => (codes::BOKEH_BOX, 0),
        Bokeh::Gaussian => (codes::BOKEH_GAUSSIAN, 0),
        Bokeh::Polygon(count) => (codes::BOKEH_POLYGON, count),
        Bokeh::Star => (codes::BOKEH_STAR, STAR_CORNERS),
    };
    Lens {
        right: three(right),
        aperture: camera.aperture as f32,
        up: three(up),
        focus: camera.focus as f32,
        forward: three(forward),
        half_opening: (0.5 * camera.fov) as f32,
        position: three(camera.position - origin),
        tangent: (0.5 * camera.fov).tan() as f32,
        size,
        projection: match camera.projection {
            LensProjection::Pinhole => codes::PROJECTION_PINHOLE,
            LensProjection::Spherical => codes::PROJECTION_SPHERICAL,
            LensProjection::Cylindrical => codes::PROJECTION_CYLINDRICAL,
        },
        ball: u32::from(camera.sharp == SharpPlaces::Ball),
        bokeh,
        corners,
        axes: (codes::AXIS_LENS * u32::from(axes.lens))
            | (codes::AXIS_LIGHTS * u32::from(axes.lights)),
        grid: axes.grid.unwrap_or(0),
    }
}

/// Converts a light; its position is relative to `origin`.
pub(super) fn light_of(light: &Light, origin: DVec3) -> ShaderLight {
    let nowhere = DVec3::ZERO;
    let (kind, position, direction, edge, soft) = match light.kind {
        LightKind::Point(position) => (codes::LIGHT_POINT, position - origin, nowhere, 0.0, 0.0),
        LightKind::Parallel(direction) => (codes::LIGHT_PARALLEL, nowhere, direction, 0.0, 0.0),
        LightKind::Spot {
            position,
            direction,
            angle,
            soft,
        } => (
            codes::LIGHT_SPOT,
            position - origin,
            direction,
            0.5 * angle,
            soft,
        ),
        LightKind::Beam {
            position,
            direction,
            radius,
            soft,
        } => (
            codes::LIGHT_BEAM,
            position - origin,
            direction,
            radius,
            soft,
        ),
    };
    ShaderLight {
        position: three(position),
        kind,
        direction: three(direction.normalize_or_zero()),
        size: light.size as f32,
        color: three(light.colour),
        ambient: light.ambient as f32,
        highlight: three(light.highlight),
        falloff: light.falloff.map_or(-1.0, |falloff| falloff as f32),
        edge: edge as f32,
        soft: soft as f32,
        casts_shadows: u32::from(light.casts_shadows),
        padding: 0,
    }
}

/// Returns three numbers in f32.
pub(super) fn three(numbers: DVec3) -> [f32; 3] {
    numbers.as_vec3().to_array()
}
