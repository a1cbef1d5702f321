// The camera of the 3D view and its light. Positions are in drawing units: the scene's centre is 0, its radius 1.

struct View {
    // To the clip space of the whole picture; depth is near / w: 1 at the near plane, 0 at infinity.
    clip_from_world: mat4x4f,
    // Where the camera stands.
    eye: vec3f,
    // How many pixels a unit across the line of sight covers at distance 1.
    pixels_per_unit: f32,
    // Unit vector from the scene towards the camera: the view direction, turned round.
    back: vec3f,
    // Nothing nearer than this is drawn.
    near: f32,
    // Unit vector towards the key light.
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
    padding: vec2f,
}

// The distance along the view direction.
fn distance_ahead(position: vec3f, view: View) -> f32 {
    return dot(view.eye - position, view.back);
}

// The tile's clip coordinates of a position, moved towards the eye by `lift` without moving on the picture.
fn tile_position(position: vec3f, lift: f32, view: View) -> vec4f {
    let clip = view.clip_from_world * vec4f(position, 1.0);
    var depth = clip.z;
    if lift > 0.0 && clip.w > view.near {
        depth *= clip.w / max(clip.w - lift, view.near);
    }
    return vec4f(clip.xy * view.tile_scale + clip.w * view.tile_offset, depth, clip.w);
}

// What is outside every picture: the corners of a triangle that is not drawn.
fn nowhere() -> vec4f {
    return vec4f(2.0, 2.0, 2.0, 1.0);
}

// The light on a glyph whose normal has the component `facing` towards the eye.
fn glyph_light(facing: f32, view: View) -> f32 {
    return view.glyph_rim + (1.0 - view.glyph_rim) * clamp(facing, 0.0, 1.0);
}

// A surface's colour in the light: both sides are lit, the normal is turned towards the eye first. A normal of
// length 0 stands for one that points to the eye.
fn lit(colour: vec3f, normal: vec3f, to_eye: vec3f, view: View) -> vec3f {
    var n = to_eye;
    if dot(normal, normal) > 1e-12 {
        n = normalize(normal);
    }
    if dot(n, to_eye) < 0.0 {
        n = -n;
    }
    let diffuse = view.ambient + view.fill * dot(n, to_eye) + view.key * max(dot(n, view.key_direction), 0.0);
    let half_way = normalize(view.key_direction + to_eye);
    let shine = view.highlight * pow(max(dot(n, half_way), 1e-6), view.highlight_power);
    return colour * diffuse + vec3f(shine);
}
