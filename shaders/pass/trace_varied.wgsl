// The part of the pass of traced pictures for faces whose attributes are expressions: the numbers at a point, as in
// crates/geometry/src/solids/look.rs. A number that f32 does not determine well enough, or that is out of its range, marks
// the sample.
//
// The words of a list in one coordinate system: its number, the number of its attributes, flags, the number of its words;
// the rows of the map into its coordinates; its attributes; its numbers.

const LIST_HEAD: u32 = 16u;
const LIST_ALONG: u32 = 1u;
const LIST_BRIGHT: u32 = 2u;

const VARIED_COLOR: u32 = 0u;
const VARIED_MIRROR: u32 = 1u;
const VARIED_GLASS: u32 = 2u;
const VARIED_DIFFUSE: u32 = 3u;
const VARIED_SPECULAR: u32 = 4u;
const VARIED_SHININESS: u32 = 5u;
const VARIED_BUMP: u32 = 6u;

const MOST_ATTRIBUTES: u32 = 16u;
// The maximum error of numbers, as seen by the eye: half a step of a byte.
const ATTRIBUTE_ERROR: f32 = 2e-3;

var<private> attributes: array<vec2f, MOST_ATTRIBUTES>;

fn store_attribute(index: u32, number: Range) {
    attributes[index] = number.value;
}

// Returns a coordinate of a point that is known to within `slack`.
fn placed(row: vec4f, place: vec3f, slack: f32) -> Range {
    let parts = vec4f(row.xyz * place, row.w);
    let error = slack * length(row.xyz) + RANGE_ROUNDING * dot(abs(parts), vec4f(1.0));
    let at = dot(parts, vec4f(1.0));
    return Range(vec2f(at - error, at + error), vec2f(0.0));
}

fn list_row(list: u32, row: u32) -> vec4f {
    let at = list + 4u + 4u * row;
    return vec4f(
        bitcast<f32>(words[at]), bitcast<f32>(words[at + 1u]), bitcast<f32>(words[at + 2u]), bitcast<f32>(words[at + 3u]),
    );
}

// Returns a number in its range; a number that is out of range or too uncertain marks the sample.
fn settled(range: vec2f, least: f32, most: f32, error: f32) -> f32 {
    if !(range.y - range.x <= 2.0 * error) || range.y < least || range.x > most {
        is_marked = true;
    }
    return clamp(0.5 * (range.x + range.y), least, most);
}

fn settled_color(number: u32, most: f32, error: f32) -> vec3f {
    return vec3f(
        settled(attributes[number], 0.0, most, error),
        settled(attributes[number + 1u], 0.0, most, error),
        settled(attributes[number + 2u], 0.0, most, error),
    );
}

fn light_of_color(color: vec3f) -> vec3f {
    if trace.look == LOOK_CRT {
        return color;
    }
    let curved = pow((color + 0.055) / 1.055, vec3f(2.4));
    return select(curved, color / 12.92, color <= vec3f(0.04045));
}

// The look of a face at a point that is known to within `slack`, on a path whose light counts with this weight.
fn varied_look(material: Material, position: vec3f, slack: f32, weight: f32) -> VariedLook {
    var look = VariedLook(material, vec3f(0.0), 0.0);
    let most = ATTRIBUTE_ERROR / min(weight, 1.0);
    var list = material.lists;
    for (var k = 0u; k < (material.varies & 0xffffu); k++) {
        let flags = words[list + 2u];
        let rows = array<vec4f, 3>(list_row(list, 0u), list_row(list, 1u), list_row(list, 2u));
        var x = placed(rows[0], position, slack);
        if (flags & LIST_ALONG) != 0u {
            // From 0 to 1 along a part of a curve, whose parameters are in the second row.
            let share = clamp(x.value, vec2f(0.0), vec2f(1.0));
            let first = rows[1].x;
            let last = rows[1].y;
            let ends = first + share * (last - first);
            x.value = widened(vec2f(min(ends.x, ends.y), max(ends.x, ends.y)), RANGE_ROUNDING);
        }
        let count = words[list + 1u];
        let instance = list + LIST_HEAD + count;
        list_attributes(words[list], x, placed(rows[1], position, slack), placed(rows[2], position, slack), instance);
        var number = 0u;
        for (var j = 0u; j < count; j++) {
            let first = attributes[number];
            switch words[list + LIST_HEAD + j] {
                case VARIED_COLOR: {
                    let bright = (flags & LIST_BRIGHT) != 0u;
                    look.material.color = light_of_color(settled_color(number, select(1.0, ENDLESS, bright), most));
                    number += 3u;
                }
                case VARIED_MIRROR: {
                    look.material.mirror = settled_color(number, 1.0, most);
                    number += 3u;
                }
                case VARIED_GLASS: {
                    look.material.glass = settled(first, 0.0, 1.0, most);
                    number += 1u;
                }
                case VARIED_DIFFUSE: {
                    look.material.scattered = settled(first, 0.0, ENDLESS, most);
                    number += 1u;
                }
                case VARIED_SPECULAR: {
                    look.material.specular = settled(first, 0.0, ENDLESS, most);
                    number += 1u;
                }
                case VARIED_SHININESS: {
                    let error = most * max(abs(first.x), abs(first.y));
                    look.material.shininess = settled(first, 1e-12, ENDLESS, error);
                    number += 1u;
                }
                default: {
                    let error = 0.25 * most;
                    let second = attributes[number + 1u];
                    let third = attributes[number + 2u];
                    let slope = vec3f(
                        settled(first, -ENDLESS, ENDLESS, error),
                        settled(second, -ENDLESS, ENDLESS, error),
                        settled(third, -ENDLESS, ENDLESS, error),
                    );
                    let apart = 0.5 * vec3f(first.y - first.x, second.y - second.x, third.y - third.x);
                    look.bump_error =
                        dot(apart, vec3f(length(rows[0].xyz), length(rows[1].xyz), length(rows[2].xyz)));
                    look.bump = slope.x * rows[0].xyz + slope.y * rows[1].xyz + slope.z * rows[2].xyz;
                    number += 3u;
                }
            }
        }
        list += words[list + 3u];
    }
    // Mirror and glass are at most 1 together.
    let mirror = look.material.mirror;
    let sum = max(max(mirror.x, mirror.y), mirror.z) + look.material.glass;
    if sum > 1.0 {
        look.material.mirror /= sum;
        look.material.glass /= sum;
    }
    if look.material.scattered < 0.0 {
        look.material.scattered = max(1.0 - sum, 0.0);
    }
    return look;
}
