// A traced picture: rays are followed through solids, mirrors and glass as in crates/tracer/src/shade.rs. The scene is data
// (trace_tables.wgsl); crates/wgsl/src/traced.rs writes the functions of its expressions. There is one invocation per pixel.
// A sample for which f32 may decide differently from f64, or which exceeds the lists here and in trace_crossings.wgsl, is
// marked and adds nothing.

// The maximum sizes of the lists of a ray.
const MOST_MEDIA: u32 = 4u;
const MOST_PATHS: u32 = 16u;
// The maximum number of points at which a ray crosses a component, but no visible face.
const MOST_PASSED: u32 = 64u;
// The maximum error of a share of light, as seen by the eye: half a step of a byte.
const SHARE_ERROR: f32 = 2e-3;
// Errors are multiplied by the reciprocal of a cosine, or of a lesser one than this.
const LEAST_COSINE: f32 = 1e-2;
// In the look `crt`, faces block parallel light up to this distance.
const PARALLEL_REACH: f32 = 1e4;

struct Medium {
    component: u32,
    color: vec3f,
}

struct Path {
    ray: Ray,
    share: vec3f,
    weight: f32,
    // The length of the path from the eye.
    length: f32,
    bounces: u32,
    // The errors of its start, and of its direction, as they have grown from face to face.
    slack: f32,
    drift: f32,
    media_count: u32,
    media: array<Medium, MOST_MEDIA>,
}

struct Face {
    t: f32,
    piece: u32,
    position: vec3f,
    // On the side of the ray's start.
    normal: vec3f,
    // The normal for lighting: a height may turn it.
    lit_normal: vec3f,
    // The errors of the point, and of the latter normal where a height turns it.
    slack: f32,
    lit_error: f32,
}

var<private> paths: array<Path, MOST_PATHS>;
var<private> path_count: u32;

fn is_seen(k: u32) -> bool {
    let sides = leaves[pieces[together_piece[k]].leaf].sides;
    return sides == SIDES_BOTH || (sides == SIDES_OUTER && together_enters[k]);
}

fn material_of(k: u32) -> u32 {
    return leaves[pieces[together_piece[k]].leaf].material;
}

// The first of the crossings that is opaque, else the first.
fn seen_first() -> u32 {
    var first = NONE;
    var opaque = NONE;
    var count = 0u;
    var varies = 0u;
    for (var k = 0u; k < together_count; k++) {
        if is_seen(k) {
            let material = material_of(k);
            first = min(first, k);
            if materials[material].glass == 0.0 {
                opaque = min(opaque, k);
            }
            count++;
            varies |= materials[material].varies & VARIES_THROUGH;
        }
    }
    if count > 1u && varies != 0u {
        is_marked = true;
    }
    return select(opaque, first, opaque == NONE);
}

// Returns the normal of a face that is turned by a height with this gradient.
fn turned(normal: vec3f, bump: vec3f) -> vec3f {
    let slope = bump - dot(normal, bump) * normal;
    let lit = normal - slope;
    let size = length(lit);
    if !(size > 0.0) {
        return normal;
    }
    return lit / size;
}

// Returns the error of a face's point.
fn slack_at(face: Face) -> f32 {
    let place = abs(face.position);
    return 2.0 * PLACE_ERROR * max(max(max(place.x, place.y), place.z), face.t);
}

fn ray_from(face: Face, direction: vec3f) -> Ray {
    return Ray(face.position, direction, pieces[face.piece].equation, slack_at(face));
}

// Returns the light on a face that arrives even if something blocks the light source.
fn ambient_light(light: Light, material: Material) -> vec3f {
    if trace.look == LOOK_CRT {
        return light.ambient * light.color * (1.0 - material.mirror);
    }
    return material.scattered * light.ambient * material.color * light.color;
}

// Returns the light on a face from a light that it sees.
fn seen_share(
    light: Light, towards: vec3f, face: Face, material: Material, direction: vec3f,
) -> vec3f {
    let height = dot(face.lit_normal, towards);
    var along = 0.0;
    if trace.look == LOOK_CRT {
        along = dot(towards - 2.0 * height * face.lit_normal, direction);
    } else {
        let between = towards - direction;
        along = dot(face.lit_normal, between) / max(length(between), 1e-30);
    }
    let highlight = material.specular * share_power(max(along, 0.0), material.shininess);
    if trace.look == LOOK_CRT {
        return material.color
            * (material.scattered * height * light.color + highlight * light.highlight);
    }
    return material.scattered * height * material.color * light.color + highlight * light.highlight;
}

// Returns the light of the background: a table over the height of the direction, from −1 to 1.
fn sky(direction: vec3f) -> vec3f {
    let at = clamp(0.5 + 0.5 * direction.z, 0.0, 1.0) * f32(trace.sky_cells);
    let cell = min(u32(at), trace.sky_cells - 1u);
    let share = at - f32(cell);
    let word = trace.sky_at + 3u * cell;
    let a = vec3f(
        bitcast<f32>(words[word]), bitcast<f32>(words[word + 1u]), bitcast<f32>(words[word + 2u]),
    );
    let b = vec3f(
        bitcast<f32>(words[word + 3u]), bitcast<f32>(words[word + 4u]), bitcast<f32>(words[word + 5u]),
    );
    return a + share * (b - a);
}

fn index_of(path: Path) -> f32 {
    if path.media_count == 0u {
        return 1.0;
    }
    return components[path.media[path.media_count - 1u].component].ior;
}

// The path with the glass behind the crossings that are met; the face of one of them, or of none, has this colour.
fn beyond(path: Path, found: u32, found_color: vec3f) -> Path {
    var next = path;
    for (var k = 0u; k < together_count; k++) {
        let component = together[k];
        let solid = components[component].solid;
        var kept = 0u;
        for (var j = 0u; j < next.media_count; j++) {
            let medium = next.media[j];
            if components[medium.component].solid != solid {
                next.media[kept] = medium;
                kept++;
            }
        }
        next.media_count = kept;
        if together_enters[k] && components[component].glass != NONE {
            if kept == MOST_MEDIA {
                is_marked = true;
                return next;
            }
            var at = kept;
            for (; at > 0u; at--) {
                if components[next.media[at - 1u].component].solid < solid {
                    break;
                }
                next.media[at] = next.media[at - 1u];
            }
            var color = found_color;
            if k != found {
                let material = material_of(k);
                color = materials[material].color;
                if (materials[material].varies & VARIES_COLOR) != 0u {
                    is_marked = true;
                }
            }
            next.media[at] = Medium(component, color);
            next.media_count = kept + 1u;
        }
    }
    return next;
}

// The share of light that is left after a way of this length within the last glass around a path.
fn kept(path: Path, length: f32) -> vec3f {
    if path.media_count == 0u {
        return vec3f(1.0);
    }
    let medium = path.media[path.media_count - 1u];
    if all(medium.color == vec3f(1.0)) {
        return vec3f(1.0);
    }
    let exponent = length / components[medium.component].depth;
    return vec3f(
        share_power(medium.color.x, exponent),
        share_power(medium.color.y, exponent),
        share_power(medium.color.z, exponent),
    );
}

// The glass around the start of a ray from the eye.
fn media_at_start(path: ptr<function, Path>) {
    for (var k = 0u; k < start_count; k++) {
        let component = start[k];
        let glass = components[component].glass;
        if glass == NONE {
            continue;
        }
        let count = (*path).media_count;
        if count > 0u {
            let last = (*path).media[count - 1u].component;
            if components[last].solid == components[component].solid {
                continue;
            }
        }
        if count == MOST_MEDIA {
            is_marked = true;
            return;
        }
        if (materials[glass].varies & VARIES_COLOR) != 0u {
            is_marked = true;
            return;
        }
        (*path).media[count] = Medium(component, materials[glass].color);
        (*path).media_count = count + 1u;
    }
}

// Adds a path that continues another one, or the background if the path ends. Returns the light of the latter.
fn go_on(next: Path) -> vec3f {
    if next.weight < trace.least_weight {
        return vec3f(0.0);
    }
    if next.bounces == 0u {
        if trace.look == LOOK_CRT {
            return vec3f(0.0);
        }
        return next.share * sky(next.ray.direction);
    }
    if path_count == MOST_PATHS {
        is_marked = true;
        return vec3f(0.0);
    }
    paths[path_count] = next;
    paths[path_count].bounces--;
    path_count++;
    return vec3f(0.0);
}

// The face that a path meets.
fn meet(path: Path, found: u32) -> Face {
    var face: Face;
    face.t = together_t;
    face.piece = together_piece[found];
    face.position = path.ray.origin + face.t * path.ray.direction;
    face.normal = normal_at(face.piece, path.ray, face.t);
    face.lit_normal = face.normal;
    let cosine = max(abs(dot(face.normal, path.ray.direction)), LEAST_COSINE);
    face.slack = slack_at(face) + (path.slack + path.drift * face.t) / cosine;
    face.lit_error = 0.0;
    return face;
}

// Goes on from a face along what it reflects and what it lets through, with the glass behind it around `inner`.
fn part(path: Path, face: Face, material: Material, inner: Path) -> vec3f {
    var out = vec3f(0.0);
    var mirror = material.mirror;
    var next = path;
    next.length = path.length + face.t;
    if material.glass > 0.0 {
        var behind = inner;
        behind.length = next.length;
        let n1 = index_of(path);
        let n2 = index_of(behind);
        let cosine = clamp(-dot(face.lit_normal, path.ray.direction), 0.0, 1.0);
        let reflects = fresnel(cosine, n1, n2);
        mirror += material.glass * reflects;
        let bent = refracted(path.ray.direction, face.lit_normal, n1, n2);
        let through = material.glass * (1.0 - reflects);
        let error = path.drift + face.lit_error;
        if error > 0.0 {
            let least = fresnel(clamp(cosine + error, 0.0, 1.0), n1, n2);
            let most = fresnel(clamp(cosine - error, 0.0, 1.0), n1, n2);
            if path.weight * material.glass * abs(most - least) > SHARE_ERROR {
                is_marked = true;
            }
        }
        if bent.passes && through != 0.0 {
            behind.ray = ray_from(face, bent.direction);
            behind.share = path.share * through;
            behind.weight = path.weight * through;
            behind.slack = face.slack;
            // A height may bend the light so that it stays on its side of the true face.
            let height = dot(bent.direction, face.normal);
            if height >= 0.0 {
                behind.media = path.media;
                behind.media_count = path.media_count;
            }
            if n1 != n2 {
                let ratio = n1 / n2;
                let inside = max(-dot(face.lit_normal, bent.direction), LEAST_COSINE);
                behind.drift = ratio * path.drift + abs(ratio * cosine - inside) * face.lit_error
                    + ratio * ratio * cosine / inside * error;
            }
            if face.lit_error > 0.0 && abs(height) <= behind.drift + PLACE_ERROR {
                is_marked = true;
            }
            out += go_on(behind);
        }
    }
    if any(mirror != vec3f(0.0)) {
        let direction = path.ray.direction;
        var away = direction - 2.0 * dot(face.lit_normal, direction) * face.lit_normal;
        // It points into the true face: reflect it at that face, too.
        away -= 2.0 * min(dot(face.normal, away), 0.0) * face.normal;
        next.ray = ray_from(face, normalize(away));
        next.share = path.share * mirror;
        next.weight = path.weight * max(max(mirror.x, mirror.y), mirror.z);
        next.slack = face.slack;
        next.drift = path.drift + 2.0 * face.lit_error;
        out += go_on(next);
    }
    return out;
}

// Returns the light of a sample: casts rays along paths and, from each face that a path meets, rays to the lights. Drivers
// inline a function wherever it is called, so all rays are cast at one point in the code.
fn sample_light(pixel: vec2u, sample: u32) -> vec3f {
    let place = sample_place(trace.lens, pixel, sample);
    let eye = lens_ray(trace.lens, pixel, place);
    path_count = 1u;
    paths[0].ray = Ray(eye.origin, eye.direction, NONE, 0.0);
    paths[0].share = vec3f(1.0);
    paths[0].weight = 1.0;
    paths[0].length = 0.0;
    paths[0].bounces = trace.bounces;
    paths[0].slack = 0.0;
    paths[0].drift = 0.0;
    paths[0].media_count = 0u;
    var out = vec3f(0.0);
    var path: Path;
    var face: Face;
    var material: Material;
    var ray: Ray;
    var before = ENDLESS;
    // The light to which the ray leads; NONE for a ray of the path itself.
    var light = NONE;
    var towards = vec3f(0.0);
    // The share of its light that comes there, and the glass on the way to it.
    var share = vec3f(0.0);
    var inner: Path;
    var behind_t = 0.0;
    var passed = 0u;
    var is_done = true;
    loop {
        if is_done {
            if path_count == 0u {
                break;
            }
            path_count--;
            path = paths[path_count];
            ray = path.ray;
            before = ENDLESS;
            light = NONE;
            behind_t = 0.0;
            passed = 0u;
            is_done = false;
        }
        together_t = ENDLESS;
        if before > 0.0 {
            next_crossing(ray, behind_t, before);
        }
        passed++;
        if passed > MOST_PASSED {
            is_marked = true;
        }
        if passed == 1u && ray.leaving == NONE {
            media_at_start(&path);
        }
        if is_marked {
            break;
        }
        let is_path = light == NONE;
        var found = NONE;
        if is_path && together_t < ENDLESS {
            found = seen_first();
            if found == NONE {
                behind_t = together_t;
                continue;
            }
        }
        if is_path {
            inner = path;
        }
        // What the glass on the way leaves.
        let way = min(together_t, before) - select(behind_t, 0.0, is_path);
        let left = kept(inner, way);
        behind_t = together_t;
        var enters = false;
        if is_path {
            path.share *= left;
            if together_t >= ENDLESS {
                out += path.share * sky(path.ray.direction);
                is_done = true;
                continue;
            }
            face = meet(path, found);
            material = materials[leaves[pieces[face.piece].leaf].material];
            if material.varies != 0u {
                let varied = varied_look(material, face.position, face.slack, path.weight);
                material = varied.material;
                if any(varied.bump != vec3f(0.0)) {
                    let bump = select(-varied.bump, varied.bump, together_enters[found]);
                    face.lit_normal = turned(face.normal, bump);
                    face.lit_error = varied.bump_error;
                }
            }
            enters = material.glass > 0.0;
        } else {
            share *= left;
            if together_t < ENDLESS {
                let passed_face = seen_first();
                if passed_face != NONE {
                    let other = material_of(passed_face);
                    share *= materials[other].glass;
                    if (materials[other].varies & VARIES_THROUGH) != 0u {
                        is_marked = true;
                    }
                }
                enters = any(share != vec3f(0.0));
            }
        }
        if enters {
            inner = beyond(inner, found, material.color);
        }
        if is_path {
            out += part(path, face, material, inner);
            light = 0u;
        } else {
            if enters {
                continue;
            }
            out += path.share * share
                * seen_share(lights[light], towards, face, material, path.ray.direction);
            light++;
        }
        // The next light from which something may shade the face.
        is_done = true;
        while light < trace.light_count {
            out += path.share * ambient_light(lights[light], material);
            let is_crt = trace.look == LOOK_CRT;
            let way = select(0.0, path.length + face.t, is_crt);
            let seen = seen_light(lights[light], face.position, place.light, way);
            if dot(face.lit_normal, seen.towards) > 0.0 && seen.share > 0.0 {
                towards = seen.towards;
                share = vec3f(seen.share);
                inner = path;
                before = seen.distance;
                if is_crt && before >= ENDLESS {
                    before = PARALLEL_REACH;
                }
                is_done = false;
                break;
            }
            light++;
        }
        if !is_done {
            ray = ray_from(face, towards);
            behind_t = 0.0;
            passed = 0u;
            if lights[light].casts_shadows == 0u {
                // Nothing can block it.
                before = 0.0;
            }
        }
    }
    return out;
}

// Returns true if loops have been cut short. A driver may end all loops of an invocation after a maximum number of
// iterations, including those of this function: lavapipe does after 65,535.
fn is_cut() -> bool {
    let rounds = 3u * trace.one;
    var passed = 0u;
    while passed < rounds {
        passed += trace.one;
    }
    return passed < rounds;
}

@compute @workgroup_size(8, 8)
fn trace_scene(@builtin(global_invocation_id) at: vec3u) {
    if at.x >= trace.lens.size.x || at.y >= trace.rows {
        return;
    }
    let pixel = vec2u(at.x, trace.first_row + at.y);
    let place = (pixel.y - trace.slab_row) * trace.lens.size.x + pixel.x;
    var sum = vec4f(0.0);
    if trace.bit != 1u {
        sum = sums[place];
    }
    is_marked = false;
    let light = sample_light(pixel, trace.sample);
    // False for NaN.
    let is_light = all(light >= vec3f(0.0)) && all(light < vec3f(ENDLESS));
    if is_marked || !is_light || is_cut() {
        // The bits as a number: their pattern could be a NaN.
        sum.w += f32(trace.bit);
    } else {
        sum += vec4f(light, 0.0);
    }
    sums[place] = sum;
}
