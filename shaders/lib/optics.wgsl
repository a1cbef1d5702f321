// Reflection, refraction and lights: as in crates/tracer/src/optics.rs and light.rs.

const LIGHT_POINT: u32 = 0u;
const LIGHT_PARALLEL: u32 = 1u;
const LIGHT_SPOT: u32 = 2u;
const LIGHT_BEAM: u32 = 3u;

// The value of an infinite distance.
const ENDLESS: f32 = 3.0e38;

struct Light {
    position: vec3f,
    kind: u32,
    // The unit direction in which it shines.
    direction: vec3f,
    // The radius of the emitting ball.
    size: f32,
    color: vec3f,
    ambient: f32,
    highlight: vec3f,
    // The distance of full strength; a negative number stands for none.
    falloff: f32,
    // Half the opening, or the radius of a beam.
    edge: f32,
    soft: f32,
    casts_shadows: u32,
    padding: u32,
}

struct SeenLight {
    towards: vec3f,
    distance: f32,
    share: f32,
}

// Returns 1 − smoothstep from (1 − soft)·edge to the edge.
fn share_within(x: f32, edge: f32, soft: f32) -> f32 {
    let inner = (1.0 - soft) * edge;
    if x >= edge {
        return 0.0;
    }
    if x <= inner {
        return 1.0;
    }
    let s = (x - inner) / (edge - inner);
    return 1.0 - s * s * (3.0 - 2.0 * s);
}

// Returns the vector to a point of the disc that an emitting ball shows.
fn shining(size: f32, offset: vec3f, place: vec2f) -> vec3f {
    let distance = length(offset);
    if size <= 0.0 || distance == 0.0 {
        return offset;
    }
    let n = offset / distance;
    let side = select(-1.0, 1.0, n.z >= 0.0);
    let a = -1.0 / (side + n.z);
    let b = n.x * n.y * a;
    let across = vec3f(1.0 + side * n.x * n.x * a, side * b, -side * n.x);
    let along = vec3f(b, side + n.y * n.y * a, -n.y);
    let turn = 6.2831853 * place.y;
    return offset + size * sqrt(place.x) * (cos(turn) * across + sin(turn) * along);
}

// Returns the light as seen from a point; the path from there to the eye has the length `path`.
fn seen_light(light: Light, place: vec3f, sample: vec2f, path: f32) -> SeenLight {
    var seen = SeenLight(-light.direction, ENDLESS, 1.0);
    if light.kind == LIGHT_POINT || light.kind == LIGHT_SPOT {
        let offset = shining(light.size, light.position - place, sample);
        seen.distance = length(offset);
        seen.towards = offset / max(seen.distance, 1e-30);
        if light.kind == LIGHT_SPOT {
            // The angle from a difference: for small angles the cosine loses precision.
            let apart = length(seen.towards + light.direction);
            let angle = 2.0 * asin(clamp(0.5 * apart, 0.0, 1.0));
            seen.share = share_within(angle, light.edge, light.soft);
        }
    } else if light.kind == LIGHT_BEAM {
        let offset = place - light.position;
        let along = dot(offset, light.direction);
        seen.distance = max(along, 0.0);
        let off = length(offset - along * light.direction);
        seen.share = 0.0;
        if along > 0.0 {
            seen.share = share_within(off, light.edge, light.soft);
        }
    }
    if light.falloff >= 0.0 && seen.distance < ENDLESS && seen.share > 0.0 {
        let fading = light.falloff / (seen.distance + path);
        seen.share *= fading * fading;
    }
    return seen;
}

// Returns a power of a non-negative number.
fn share_power(x: f32, exponent: f32) -> f32 {
    if x <= 0.0 {
        return select(0.0, 1.0, exponent == 0.0);
    }
    return pow(x, exponent);
}

// Returns the fraction of unpolarised light that is reflected.
fn fresnel(cosine: f32, n1: f32, n2: f32) -> f32 {
    if n1 == n2 {
        return 0.0;
    }
    let sine2 = (n1 / n2) * (n1 / n2) * (1.0 - cosine * cosine);
    if sine2 >= 1.0 {
        return 1.0;
    }
    let inner = sqrt(1.0 - sine2);
    let across = (n1 * cosine - n2 * inner) / (n1 * cosine + n2 * inner);
    let along = (n1 * inner - n2 * cosine) / (n1 * inner + n2 * cosine);
    return 0.5 * (across * across + along * along);
}

struct Refracted {
    // False at total reflection.
    passes: bool,
    direction: vec3f,
}

fn refracted(direction: vec3f, normal: vec3f, n1: f32, n2: f32) -> Refracted {
    if n1 == n2 {
        return Refracted(true, direction);
    }
    let ratio = n1 / n2;
    let cosine = -dot(normal, direction);
    let sine2 = ratio * ratio * (1.0 - cosine * cosine);
    if sine2 > 1.0 {
        return Refracted(false, direction);
    }
    let bent = ratio * direction + (ratio * cosine - sqrt(1.0 - sine2)) * normal;
    return Refracted(true, normalize(bent));
}
