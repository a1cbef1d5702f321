// The tables of a traced scene, which is data: written by crates/render/src/gpu/trace/tables.rs.

const NONE: u32 = 0xffffffffu;
const LOOK_CRT: u32 = 1u;
const SIDES_BOTH: u32 = 0u;
const SIDES_OUTER: u32 = 1u;
const SIDES_NONE: u32 = 2u;
// The kind of a piece that a field bounds, in place of the degree.
const FIELD_PIECE: u32 = 255u;
// The piece is inside where its polynomial or its field is positive.
const OPPOSITE_PIECE: u32 = 256u;
// What a material lets through depends on the place, or its colour does.
const VARIES_THROUGH: u32 = 0x10000u;
const VARIES_COLOR: u32 = 0x20000u;

struct Trace {
    lens: Lens,
    first_row: u32,
    rows: u32,
    sample: u32,
    // The bit that marks the sample; the sums begin with the first bit.
    bit: u32,
    light_count: u32,
    endless: u32,
    boxes: u32,
    bounces: u32,
    look: u32,
    least_weight: f32,
    order_at: u32,
    terms_at: u32,
    sky_at: u32,
    sky_cells: u32,
    // The first row of the picture in the sums.
    slab_row: u32,
    // The value 1, unknown to the compiler.
    one: u32,
}

struct BoxNode {
    lower: vec3f,
    place: u32,
    upper: vec3f,
    count: u32,
}

struct Component {
    solid: u32,
    first_leaf: u32,
    leaf_count: u32,
    first_node: u32,
    node_count: u32,
    // The material of the leaf whose glass its solid is of, or NONE.
    glass: u32,
    ior: f32,
    depth: f32,
}

struct Leaf {
    // The rows of the map into its frame, from positions relative to its centre.
    row_x: vec4f,
    row_y: vec4f,
    row_z: vec4f,
    centre: vec3f,
    first_piece: u32,
    lower: vec3f,
    piece_count: u32,
    upper: vec3f,
    gate: u32,
    material: u32,
    sides: u32,
    padding: vec2u,
}

struct Piece {
    squares: vec3f,
    constant: f32,
    mixed: vec3f,
    literal: u32,
    linear: vec3f,
    frame: u32,
    equation: u32,
    leaf: u32,
    // The degree, or FIELD_PIECE; plus OPPOSITE_PIECE or 0.
    kind: u32,
    // 64 times the first term, plus their number; for a field its first word.
    terms: u32,
}

struct Material {
    color: vec3f,
    scattered: f32,
    mirror: vec3f,
    glass: f32,
    specular: f32,
    shininess: f32,
    // The first word of the lists of attributes that are expressions, and the number of lists, with VARIES_THROUGH and
    // VARIES_COLOR.
    lists: u32,
    varies: u32,
}

// The look of a face at a point: its material there, and the gradient of the height along the outward normal.
struct VariedLook {
    material: Material,
    bump: vec3f,
    // The error of that.
    bump_error: f32,
}

@group(0) @binding(0) var<uniform> trace: Trace;
@group(0) @binding(1) var<storage, read> boxes: array<BoxNode>;
@group(0) @binding(2) var<storage, read> components: array<Component>;
@group(0) @binding(3) var<storage, read> leaves: array<Leaf>;
@group(0) @binding(4) var<storage, read> pieces: array<Piece>;
// Nodes of trees, the order of components, terms of polynomials, the sky, attributes and fields.
@group(0) @binding(5) var<storage, read> words: array<u32>;
@group(0) @binding(6) var<storage, read> materials: array<Material>;
@group(0) @binding(7) var<storage, read> lights: array<Light>;
// For each pixel the light of its samples, and the bits of the marked ones.
@group(0) @binding(8) var<storage, read_write> sums: array<vec4f>;

// Returns a number that a generated function reads.
fn uniform_value(instance: u32, slot: u32) -> f32 {
    return bitcast<f32>(words[instance + slot]);
}
