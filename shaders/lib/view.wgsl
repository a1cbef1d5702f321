// The camera of the 3D view and its light. Samples are in drawing units: the scene's centre is 0, its radius 1. View
// space has x right, y up, z towards the eye, and the eye at 0.

struct View {
    view_from_world: mat4x4f,
    // One over the tangents of half the field of view, across and up.
    zoom: vec2f,
    // Nothing nearer than this is drawn.
    near: f32,
    // How many pixels a unit across the line of sight covers at distance 1.
    pixels_per_unit: f32,
    // Unit vector towards the key light, in view space.
    key_direction: vec3f,
    // Pixels that count as one in bounds of widths.
    pixel_unit: f32,
    // Strength of the light from everywhere, from the eye, from the key; strength of the highlight.
    ambient: f32,
    fill: f32,
    key: f32,
    highlight: f32,
    highlight_power: f32,
    // What a glyph keeps of its colour at its rim.
    glyph_rim: f32,
    // From the whole picture's normalised device coordinates to those of the tile being drawn.
    tile_scale: vec2f,
    tile_offset: vec2f,
    // Of an orthographic camera: the distance of the plane of its target, and the depth that is drawn on either side;
    // 0 in perspective.
    plane: f32,
    reach: f32,
    // What emphasised objects are mixed with, linear light.
    emphasis: vec4f,
}

// A sample in view space.
fn seen(position: vec3f, view: View) -> vec3f {
    return (view.view_from_world * vec4f(position, 1.0)).xyz;
}

// What a view place is divided by to be projected: its distance, in perspective.
fn distance_of(at: vec3f, view: View) -> f32 {
    return select(-at.z, view.plane, view.plane > 0.0);
}

// The unit vector to the eye from a view place.
fn to_eye_from(at: vec3f, view: View) -> vec3f {
    return select(-normalize(at), vec3f(0.0, 0.0, 1.0), view.plane > 0.0);
}

// The tile's clip coordinates of a view place, its depth that of a place nearer by `lift`. In perspective, depth is
// near / w: 1 at the near plane, 0 at infinity; lifted at most halfway: a glyph before the camera does not jump behind it.
// Without, it is linear, and 1/2 in the plane of the target.
fn tile_position(at: vec3f, lift: f32, view: View) -> vec4f {
    let w = distance_of(at, view);
    var depth = view.near;
    if view.plane > 0.0 {
        depth = w * (0.5 + 0.5 * (at.z + lift + w) / view.reach);
    } else if w > 0.0 {
        depth = view.near * w / max(w - lift, 0.5 * w);
    }
    return vec4f(at.xy * view.zoom * view.tile_scale + w * view.tile_offset, depth, w);
}

// What is outside every picture: the corners of a triangle that is not drawn.
fn nowhere() -> vec4f {
    return vec4f(2.0, 2.0, 2.0, 1.0);
}

// The length of a pixel at a view place.
fn pixel_at(at: vec3f, view: View) -> f32 {
    return max(distance_of(at, view), view.near) / view.pixels_per_unit;
}

// The light on a glyph whose normal has the component `facing` towards the eye.
fn glyph_light(facing: f32, view: View) -> f32 {
    return view.glyph_rim + (1.0 - view.glyph_rim) * clamp(facing, 0.0, 1.0);
}

// A lit colour with a share of the emphasis.
fn emphasised(colour: vec3f, share: f32, view: View) -> vec3f {
    return mix(colour, view.emphasis.rgb, share);
}

// A surface's colour in the light; unit vectors in view space, the normal on the eye's side.
fn lit(colour: vec3f, normal: vec3f, to_eye: vec3f, view: View) -> vec3f {
    let diffuse = view.ambient
        + view.fill * max(dot(normal, to_eye), 0.0)
        + view.key * max(dot(normal, view.key_direction), 0.0);
    let half_way = normalize(view.key_direction + to_eye);
    let shine = view.highlight * pow(max(dot(normal, half_way), 1e-6), view.highlight_power);
    return colour * diffuse + vec3f(shine);
}
