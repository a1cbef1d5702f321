// The camera of the 3D view and its light. Samples are in drawing units: the scene's centre is 0, its radius 1. View
// space has x right, y up, z towards the eye, and the eye at 0.

struct View {
    view_from_world: mat4x4f,
    // One over the tangents of half the field of view, across and up.
    zoom: vec2f,
    // The distance of the near plane; nothing nearer is drawn.
    near: f32,
    // The number of pixels of a unit across the line of sight at distance 1.
    pixels_per_unit: f32,
    // Unit vector towards the key light, in view space.
    key_direction: vec3f,
    // The number of pixels that count as one in the limits of widths.
    pixel_unit: f32,
    // The strengths of the ambient light, of the light from the eye and of the key light; the strength of the highlight.
    ambient: f32,
    fill: f32,
    key: f32,
    highlight: f32,
    highlight_power: f32,
    // The fraction of its colour that a glyph keeps at its rim.
    glyph_rim: f32,
    // The map from the whole picture's normalised device coordinates to those of the current tile.
    tile_scale: vec2f,
    tile_offset: vec2f,
    // For an orthographic camera: the distance of the plane of its target, and the depth range on either side; 0 in
    // perspective.
    plane: f32,
    reach: f32,
    // The colour that is mixed into emphasised objects, in linear light.
    emphasis: vec4f,
}

// Converts a sample to view space.
fn seen(position: vec3f, view: View) -> vec3f {
    return (view.view_from_world * vec4f(position, 1.0)).xyz;
}

// Returns the divisor of a point in view space in the projection: its distance, in perspective.
fn distance_of(at: vec3f, view: View) -> f32 {
    return select(-at.z, view.plane, view.plane > 0.0);
}

// Returns the unit vector to the eye from a point in view space.
fn to_eye_from(at: vec3f, view: View) -> vec3f {
    return select(-normalize(at), vec3f(0.0, 0.0, 1.0), view.plane > 0.0);
}

// Returns the tile's clip coordinates of a point in view space, with the depth of a point nearer by `lift`. In perspective,
// depth is near / w: 1 at the near plane, 0 at infinity; the point is lifted at most halfway, so that a glyph in front of
// the camera does not jump behind it. Otherwise it is linear, and 1/2 in the plane of the target.
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

// Returns a position outside every picture, for the corners of a triangle that is not drawn.
fn nowhere() -> vec4f {
    return vec4f(2.0, 2.0, 2.0, 1.0);
}

// Returns the length of a pixel at a point in view space.
fn pixel_at(at: vec3f, view: View) -> f32 {
    return max(distance_of(at, view), view.near) / view.pixels_per_unit;
}

// Returns the light on a glyph whose normal has the component `facing` towards the eye.
fn glyph_light(facing: f32, view: View) -> f32 {
    return view.glyph_rim + (1.0 - view.glyph_rim) * clamp(facing, 0.0, 1.0);
}

// Returns a lit colour with a fraction of the emphasis.
fn emphasised(colour: vec3f, share: f32, view: View) -> vec3f {
    return mix(colour, view.emphasis.rgb, share);
}

// Returns a surface's colour in the light; unit vectors in view space, the normal on the eye's side.
fn lit(colour: vec3f, normal: vec3f, to_eye: vec3f, view: View) -> vec3f {
    let diffuse = view.ambient
        + view.fill * max(dot(normal, to_eye), 0.0)
        + view.key * max(dot(normal, view.key_direction), 0.0);
    let half_way = normalize(view.key_direction + to_eye);
    let shine = view.highlight * pow(max(dot(normal, half_way), 1e-6), view.highlight_power);
    return colour * diffuse + vec3f(shine);
}
