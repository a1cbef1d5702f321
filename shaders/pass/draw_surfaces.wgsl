// The painter of surfaces: samples → lit triangles with a texture.

struct Patch {
    // Samples of one instance along u and v.
    count: vec2u,
    // The first instance of this draw.
    first: u32,
    // The fraction of the view's emphasis.
    emphasis: f32,
}

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> patch_: Patch;
// Two vectors for each sample: position (w: 0 if undefined, 2 if the cell after it is left open, otherwise 1), normal.
@group(0) @binding(2) var<storage, read> samples: array<vec4f>;
@group(0) @binding(3) var image: texture_2d<f32>;
@group(0) @binding(4) var image_sampler: sampler;
// The colours of the instances in linear light, which multiply the texture; the last one is that of all further instances.
@group(0) @binding(5) var<storage, read> colours: array<vec4f>;

struct PatchVertex {
    @builtin(position) position: vec4f,
    // In view space.
    @location(0) at: vec3f,
    @location(1) normal: vec3f,
    // 0 to 1 over the domain, v downwards in the image as in the domain.
    @location(2) place: vec2f,
    // 1 if all corners of the triangle are defined. An undefined corner changes it so much that it is not 1 anywhere else in
    // a triangle of any size; beside the triangle, where a pixel's centre may be, it exceeds 1.
    @location(3) defined: f32,
    // 1 if the cell of the triangle is left open; taken from its first corner.
    @location(4) @interpolate(flat, first) open: u32,
    // The colour of the instance.
    @location(5) @interpolate(flat) colour: vec3f,
}

@vertex
fn place_surfaces(@builtin(vertex_index) index: u32, @builtin(instance_index) instance: u32) -> PatchVertex {
    let colour = colours[min(patch_.first + instance, arrayLength(&colours) - 1u)].rgb;
    let at = ((patch_.first + instance) * patch_.count.x * patch_.count.y + index) * 2u;
    let sample = samples[at];
    let along = vec2u(index % patch_.count.x, index / patch_.count.x);
    let place = vec2f(along) / vec2f(patch_.count - vec2u(1u));
    let here = seen(sample.xyz, view);
    let normal = (view.view_from_world * vec4f(samples[at + 1u].xyz, 0.0)).xyz;
    let defined = select(-1e6, 1.0, sample.w > 0.0);
    return PatchVertex(tile_position(here, 0.0, view), here, normal, place, defined, u32(sample.w == 2.0), colour);
}

@fragment
fn shade_surfaces(vertex: PatchVertex, @builtin(front_facing) front: bool) -> @location(0) vec4f {
    let texel = filtered(image, image_sampler, vertex.place, dpdx(vertex.place), dpdy(vertex.place));
    // Interpolating ones yields 1 up to rounding.
    if vertex.open == 1u || abs(vertex.defined - 1.0) > 1e-4 {
        discard;
    }
    let to_eye = to_eye_from(vertex.at, view);
    var normal = to_eye;
    if dot(vertex.normal, vertex.normal) > 1e-12 {
        // The side is the triangle's: near a silhouette an interpolated normal may lean away from the eye, and flipping it
        // there would speckle the rim.
        normal = select(-1.0, 1.0, front) * normalize(vertex.normal);
    }
    let colour = lit(vertex.colour * texel, normal, to_eye, view);
    return vec4f(emphasised(colour, patch_.emphasis, view), 1.0);
}
