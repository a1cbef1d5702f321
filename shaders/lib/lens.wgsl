// Rays from a lens, and the positions of samples: as in crates/tracer/src/camera.rs.

// Samples have separate axes for the lens and for lights with a size.
const AXIS_LENS: u32 = 1u;
const AXIS_LIGHTS: u32 = 2u;

const PROJECTION_PINHOLE: u32 = 0u;
const PROJECTION_SPHERICAL: u32 = 1u;
const PROJECTION_CYLINDRICAL: u32 = 2u;

const BOKEH_CIRCLE: u32 = 0u;
const BOKEH_LINE: u32 = 1u;
const BOKEH_BOX: u32 = 2u;
const BOKEH_GAUSSIAN: u32 = 3u;
const BOKEH_POLYGON: u32 = 4u;
const BOKEH_STAR: u32 = 5u;

const TURN: f32 = 6.2831853;
const STAR_INNER: f32 = 0.382;

struct Lens {
    right: vec3f,
    // The radius of the lens.
    aperture: f32,
    up: vec3f,
    // The distance at which the picture is sharp.
    focus: f32,
    forward: vec3f,
    // Half the vertical opening, and its tangent.
    half_opening: f32,
    position: vec3f,
    tangent: f32,
    size: vec2u,
    projection: u32,
    // 1 if the sharp points form a ball.
    ball: u32,
    bokeh: u32,
    corners: u32,
    // The bits of AXIS_LENS and AXIS_LIGHTS.
    axes: u32,
    // The number of columns and rows of the grid of samples; 0 for no grid.
    grid: u32,
}

struct SamplePlace {
    pixel: vec2f,
    lens: vec2f,
    light: vec2f,
}

struct LensRay {
    origin: vec3f,
    direction: vec3f,
}

fn pixel_hash(pixel: vec2u, axis: u32) -> u32 {
    var mixed = 0x9e3779b9u;
    var parts = array<u32, 3>(pixel.x, pixel.y, axis);
    for (var k = 0u; k < 3u; k++) {
        mixed ^= parts[k];
        mixed = (mixed ^ (mixed >> 16u)) * 0x7feb352du;
        mixed = (mixed ^ (mixed >> 15u)) * 0x846ca68bu;
        mixed ^= mixed >> 16u;
    }
    return mixed;
}

// Returns the step of one of 2, 4 or 6 axes.
fn axis_step(axes: u32, axis: u32) -> u32 {
    var two = array<u32, 2>(3242174889u, 2447445413u);
    var four = array<u32, 4>(3679390609u, 3152041523u, 2700274806u, 2313257605u);
    var six = array<u32, 6>(
        3859688306u, 3468523226u, 3117001274u, 2801104767u, 2517223199u, 2262111973u,
    );
    if axes == 0u {
        return two[axis];
    }
    if axes == AXIS_LENS + AXIS_LIGHTS {
        return six[axis];
    }
    return four[axis];
}

fn axis_place(axes: u32, pixel: vec2u, sample: u32, axis: u32) -> f32 {
    var start = 0x80000000u;
    if axis >= 2u {
        start = pixel_hash(pixel, axis);
    }
    // Stay below 1 despite rounding.
    return min(f32(axis_step(axes, axis) * sample + start) / 4294967296.0, 0.99999994);
}

fn axis_pair(axes: u32, pixel: vec2u, sample: u32, axis: u32) -> vec2f {
    return vec2f(
        axis_place(axes, pixel, sample, axis),
        axis_place(axes, pixel, sample, axis + 1u),
    );
}

fn sample_place(lens: Lens, pixel: vec2u, sample: u32) -> SamplePlace {
    var place = SamplePlace(vec2f(0.5), vec2f(0.5), vec2f(0.5));
    if lens.grid == 0u {
        place.pixel = axis_pair(lens.axes, pixel, sample, 0u);
    } else if lens.grid > 1u {
        let at = sample % (lens.grid * lens.grid);
        place.pixel = vec2f(f32(at / lens.grid), f32(at % lens.grid)) / f32(lens.grid);
    }
    if (lens.axes & AXIS_LENS) != 0u {
        place.lens = axis_pair(lens.axes, pixel, sample, 2u);
    }
    if (lens.axes & AXIS_LIGHTS) != 0u {
        place.light = axis_pair(lens.axes, pixel, sample, select(2u, 4u, lens.axes > AXIS_LIGHTS));
    }
    return place;
}

fn bokeh_corner(angle: f32, radius: f32) -> vec2f {
    return radius * vec2f(cos(angle), sin(angle));
}

fn fan_corner(bokeh: u32, corners: u32, k: u32) -> vec2f {
    if bokeh == BOKEH_STAR {
        let radius = select(STAR_INNER, 1.0, k % 2u == 0u);
        return bokeh_corner(0.25 * TURN + f32(k) * (0.1 * TURN), radius);
    }
    return bokeh_corner(f32(k) * TURN / f32(corners), 1.0);
}

// Returns the position in the lens' shape, to the right and up.
fn bokeh_place(bokeh: u32, corners: u32, at: vec2f) -> vec2f {
    switch bokeh {
        case BOKEH_CIRCLE: {
            return bokeh_corner(TURN * at.y, sqrt(at.x));
        }
        case BOKEH_LINE: {
            return vec2f(2.0 * at.x - 1.0, 0.0);
        }
        case BOKEH_BOX: {
            return 2.0 * at - 1.0;
        }
        case BOKEH_GAUSSIAN: {
            return bokeh_corner(TURN * at.y, sqrt(-2.0 * log(1.0 - at.x)));
        }
        default: {
            let scaled = at.x * f32(corners);
            let k = min(u32(scaled), corners - 1u);
            let out = sqrt(scaled - f32(k));
            let a = fan_corner(bokeh, corners, k);
            let b = fan_corner(bokeh, corners, k + 1u);
            return out * ((1.0 - at.y) * a + at.y * b);
        }
    }
}

fn lens_ray(lens: Lens, pixel: vec2u, place: SamplePlace) -> LensRay {
    let size = vec2f(lens.size);
    // Twice the offset from the centre, computed from integers first: they are exact.
    let middle = vec2f(2.0 * vec2f(pixel) - size);
    let at = (middle + 2.0 * place.pixel) / size.y;
    var across = lens.tangent * at.x;
    var upward = -lens.tangent * at.y;
    if lens.projection != PROJECTION_PINHOLE {
        across = sin(lens.half_opening * at.x);
    }
    if lens.projection == PROJECTION_SPHERICAL {
        upward = -sin(lens.half_opening * at.y);
    }
    let direction = lens.forward + across * lens.right + upward * lens.up;
    if lens.aperture <= 0.0 {
        return LensRay(lens.position, normalize(direction));
    }
    let on_lens = bokeh_place(lens.bokeh, lens.corners, place.lens);
    let offset = lens.aperture * (on_lens.x * lens.right + on_lens.y * lens.up);
    if lens.ball != 0u {
        let sharp = lens.focus * normalize(direction);
        return LensRay(lens.position - offset, normalize(sharp + offset));
    }
    return LensRay(lens.position + offset, normalize(lens.focus * direction - offset));
}
