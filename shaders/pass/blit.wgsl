// Copies a picture onto a target, stretched over the viewport, without blending and with unchanged colours.

struct Corner {
    @builtin(position) position: vec4<f32>,
    @location(0) place: vec2<f32>,
}

@group(0) @binding(0) var picture: texture_2d<f32>;
@group(0) @binding(1) var between: sampler;

// A triangle that covers the viewport; `place` ranges over the picture from its upper left corner.
@vertex
fn cover(@builtin(vertex_index) index: u32) -> Corner {
    let place = vec2<f32>(f32((index << 1u) & 2u), f32(index & 2u));
    return Corner(vec4<f32>(2.0 * place.x - 1.0, 1.0 - 2.0 * place.y, 0.0, 1.0), place);
}

@fragment
fn copy(corner: Corner) -> @location(0) vec4<f32> {
    return textureSampleLevel(picture, between, corner.place, 0.0);
}
