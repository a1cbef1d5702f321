// The exponential map, pixel by pixel: Runge–Kutta of order 4 with steps that follow the surface's bending.
//
// In a pixel (x, y) starts a geodesic with velocity x X + y Y; its end at time 1 is the pixel's place on the
// surface. The state is an offset from the camera, so that a deep zoom keeps its digits. Statuses are flags: no
// result depends on how a driver treats NaN in comparisons.

@group(0) @binding(0) var<uniform> camera: Camera;
@group(0) @binding(1) var<storage, read> uniforms: array<f32>;
// For each pixel of the rows: offset from the camera in scaled coordinates, as bits; status; steps.
@group(0) @binding(2) var<storage, read_write> map: array<vec4u>;

// A step turns by no more than this: bending, inner and outer, times length. The error of a step is about its
// fifth power over 120.
const BEND_PER_STEP: f32 = 0.2;
// Steps are no longer than this part of the geodesic, however flat the surface.
const LONGEST_STEP: f32 = 0.125;
// A step shorter than this part of the geodesic means that the parametrisation has lost its rank.
const SHORTEST_STEP: f32 = 1e-6;
// So close to a pole, in units of the camera's tangent vectors, the surface is flat to the last digit of f32.
const FLAT_RADIUS: f32 = 2e-3;
// A cone's tip is hit by what misses it by less than this part of the flat radius.
const TIP_RADIUS: f32 = 1e-3;

fn uniform_value(instance: u32, slot: u32) -> f32 {
    return uniforms[instance + slot];
}

// The jet at a place in scaled coordinates.
fn jet_at(at: vec2f) -> Jet {
    let uv = camera.origin + camera.scale * at;
    return scaled_jet(surface_jet(uv.x, uv.y, camera.instance), camera.scale, camera.per_length);
}

struct Bend {
    // Of the chart coordinates.
    acceleration: vec2f,
    // |A| over speed: how fast the direction turns in space along a straight line of the chart.
    rate: f32,
    defined: bool,
}

fn bend(jet: Jet, velocity: vec2f) -> Bend {
    let a = second_along(jet, velocity);
    let w = jet.du * velocity.x + jet.dv * velocity.y;
    let acceleration = -tangent_components(jet, a);
    let rate = length(a) * inverseSqrt(max(dot(w, w), 1e-30));
    return Bend(acceleration, rate, is_finite2(acceleration) && is_finite(rate));
}

// Going straight through the flat disc around a tip, in polar coordinates around it.
struct Crossing {
    // True where the mover is inside the disc and heads inwards.
    applies: bool,
    // True where it runs into a cone's tip.
    hits_tip: bool,
    at: vec2f,
    velocity: vec2f,
    // The time it takes.
    time: f32,
}

// The side that a mover runs into.
struct Tip {
    // 0 where u runs into it, 1 where v does.
    axis: u32,
    // Its coordinate along the axis.
    place: f32,
    // Distance grows as the coordinate's to the power of one over this.
    power: f32,
    is_cone: bool,
}

fn crossing(at: vec2f, velocity: vec2f, jet: Jet, tip: Tip, time_left: f32) -> Crossing {
    let axis = tip.axis;
    let around = 1u - axis;
    var radial = jet.du;
    var angular = jet.dv;
    if axis == 1u {
        radial = jet.dv;
        angular = jet.du;
    }
    let depth = at[axis] - tip.place;
    let radius = tip.power * length(radial) * abs(depth);
    // Inward speed, and speed around.
    let inward = -sign(depth) * velocity[axis] * length(radial);
    let sideways = velocity[around] * length(angular);
    if radius > FLAT_RADIUS || inward <= 0.0 || radius == 0.0 {
        return Crossing(false, false, at, velocity, 0.0);
    }
    let speed_squared = inward * inward + sideways * sideways;
    let miss = radius * abs(sideways) * inverseSqrt(speed_squared);
    let full = 2.0 * radius * inward / speed_squared;
    let time = min(full, time_left);
    if tip.is_cone && miss < TIP_RADIUS * FLAT_RADIUS && time_left > 0.5 * full {
        return Crossing(true, true, at, velocity, time);
    }
    // The tip is the origin, the mover starts at (radius, 0).
    let end = vec2f(radius - inward * time, sideways * time);
    let end_radius = max(length(end), 1e-12);
    let turned = atan2(end.y, end.x);
    // Angle around the tip per unit of the other coordinate.
    let winding = length(angular) / radius;
    var result = at;
    result[around] += turned / winding;
    let ratio = end_radius / radius;
    let depth_ratio = pow(ratio, tip.power);
    result[axis] = tip.place + depth * depth_ratio;
    // The velocity (-inward, sideways) in the polar frame at the end.
    let outwards = end / end_radius;
    let radial_speed = dot(vec2f(-inward, sideways), outwards);
    let angular_speed = dot(vec2f(-inward, sideways), vec2f(-outwards.y, outwards.x));
    var heading = velocity;
    heading[axis] = sign(depth) * radial_speed * (depth_ratio / ratio) / length(radial);
    heading[around] = angular_speed / (ratio * length(angular));
    return Crossing(true, false, result, heading, time);
}

// The longest step beside a tip, where the chart is polar: it neither reaches the tip nor, on the way out, leaves
// the scale on which the chart bends.
fn step_near_tip(distance: f32, speed: f32, radial_length: f32) -> f32 {
    let short = max(distance, 0.25 * FLAT_RADIUS / max(radial_length, 1e-20));
    return 0.5 * short / max(abs(speed), 1e-20);
}

struct End {
    at: vec2f,
    status: u32,
    steps: u32,
}

fn follow(start_velocity: vec2f) -> End {
    var mover = Mover(vec2f(), start_velocity, true);
    var time = 0.0;
    var wanted = LONGEST_STEP;
    let tips = vec4<bool>(
        is_tip(camera.sides.x), is_tip(camera.sides.y), is_tip(camera.sides.z), is_tip(camera.sides.w));
    var attempts = 0u;
    loop {
        if time >= 1.0 {
            return End(mover.at, COMPLETE, attempts);
        }
        if attempts >= camera.step_limit {
            return End(mover.at, WORK_LIMIT, attempts);
        }
        attempts += 1u;
        let left = 1.0 - time;
        let jet = jet_at(mover.at);
        var longest = min(left, LONGEST_STEP);
        if any(tips) {
            var tip = Tip(2u, 0.0, 1.0, false);
            let speed = mover.velocity;
            if tips.x {
                longest = min(longest, step_near_tip(mover.at.x - camera.minimum.x, speed.x, length(jet.du)));
                if speed.x < 0.0 {
                    tip = Tip(0u, camera.minimum.x, camera.tip_powers.x, camera.sides.x == SIDE_CONE);
                }
            }
            if tips.y {
                longest = min(longest, step_near_tip(camera.maximum.x - mover.at.x, speed.x, length(jet.du)));
                if speed.x > 0.0 {
                    tip = Tip(0u, camera.maximum.x, camera.tip_powers.y, camera.sides.y == SIDE_CONE);
                }
            }
            if tips.z {
                longest = min(longest, step_near_tip(mover.at.y - camera.minimum.y, speed.y, length(jet.dv)));
                if speed.y < 0.0 {
                    tip = Tip(1u, camera.minimum.y, camera.tip_powers.z, camera.sides.z == SIDE_CONE);
                }
            }
            if tips.w {
                longest = min(longest, step_near_tip(camera.maximum.y - mover.at.y, speed.y, length(jet.dv)));
                if speed.y > 0.0 {
                    tip = Tip(1u, camera.maximum.y, camera.tip_powers.w, camera.sides.w == SIDE_CONE);
                }
            }
            if tip.axis < 2u {
                let chord = crossing(mover.at, mover.velocity, jet, tip, left);
                if chord.applies {
                    if chord.hits_tip {
                        return End(mover.at, CONE_POINT, attempts);
                    }
                    time += chord.time;
                    mover.at = chord.at;
                    mover.velocity = chord.velocity;
                    if chord.time >= left {
                        time = 1.0;
                    }
                    mover = passed_sides(mover, camera);
                    continue;
                }
            }
        }
        let b1 = bend(jet, mover.velocity);
        if !b1.defined {
            return End(mover.at, UNDEFINED, attempts);
        }
        var h = min(min(wanted, longest), BEND_PER_STEP / max(b1.rate, 1e-20));
        if h < SHORTEST_STEP && h < left {
            return End(mover.at, DEGENERATE, attempts);
        }
        let v2 = mover.velocity + 0.5 * h * b1.acceleration;
        let b2 = bend(jet_at(mover.at + 0.5 * h * mover.velocity), v2);
        let v3 = mover.velocity + 0.5 * h * b2.acceleration;
        let b3 = bend(jet_at(mover.at + 0.5 * h * v2), v3);
        let v4 = mover.velocity + h * b3.acceleration;
        let b4 = bend(jet_at(mover.at + h * v3), v4);
        if !(b2.defined && b3.defined && b4.defined) {
            // A stage looked beyond an edge or into a hole: come closer, and end there.
            if h < 1e-4 {
                let ahead = mover.at + 2.0 * h * mover.velocity;
                let outside = any(ahead < camera.minimum) || any(ahead > camera.maximum);
                return End(mover.at, select(UNDEFINED, LEFT_DOMAIN, outside), attempts);
            }
            wanted = 0.25 * h;
            continue;
        }
        let rate = max(max(b1.rate, b2.rate), max(b3.rate, b4.rate));
        if rate * h > 1.75 * BEND_PER_STEP {
            wanted = BEND_PER_STEP / rate;
            continue;
        }
        mover.at += (h / 6.0) * (mover.velocity + 2.0 * v2 + 2.0 * v3 + v4);
        mover.velocity += (h / 6.0)
            * (b1.acceleration + 2.0 * b2.acceleration + 2.0 * b3.acceleration + b4.acceleration);
        // The last step's end is hit exactly.
        time = select(time + h, 1.0, h >= left);
        wanted = 2.0 * h;
        mover = passed_sides(mover, camera);
        if !mover.inside {
            return End(mover.at, LEFT_DOMAIN, attempts);
        }
        if !is_finite2(mover.at) || !is_finite2(mover.velocity) {
            return End(vec2f(), UNDEFINED, attempts);
        }
    }
    return End(mover.at, WORK_LIMIT, attempts);
}

@compute @workgroup_size(8, 8)
fn trace_geodesics(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= camera.size.x || id.y >= camera.rows.y {
        return;
    }
    let row = id.y + camera.rows.x;
    let pixel = vec2f(f32(id.x), f32(row)) + 0.5;
    let half_size = 0.5 * vec2f(camera.size);
    // [-1, 1] spans the shorter side; y points up.
    let xy = (pixel - half_size) / min(half_size.x, half_size.y);
    let velocity = xy.x * camera.x - xy.y * camera.y;
    let end = follow(velocity);
    map[(row - camera.map_row) * camera.size.x + id.x] = vec4u(bitcast<vec2u>(end.at), end.status, end.steps);
}
