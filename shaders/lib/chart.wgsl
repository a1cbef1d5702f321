// The domain of a chart in scaled coordinates around the camera, and what lies beyond its sides.

// What a side is: the numbers that `Camera.sides` holds.
const SIDE_EDGE: u32 = 0u;
const SIDE_WRAP: u32 = 1u;
const SIDE_WRAP_FLIP: u32 = 2u;
const SIDE_POLE: u32 = 3u;
const SIDE_CONE: u32 = 4u;

// Why a geodesic ended: the numbers that a map's pixels hold.
const COMPLETE: u32 = 0u;
const LEFT_DOMAIN: u32 = 1u;
const CONE_POINT: u32 = 2u;
const DEGENERATE: u32 = 3u;
const UNDEFINED: u32 = 4u;
const WORK_LIMIT: u32 = 5u;

// A camera on the surface, and the chart around it. Chart coordinates are offsets from the camera divided by
// `scale`; lengths are in units of the camera's tangent vectors.
struct Camera {
    // (u, v) of the camera.
    origin: vec2f,
    // Chart units for one scaled unit.
    scale: vec2f,
    // The camera's tangent vectors, scaled.
    x: vec2f,
    y: vec2f,
    // The domain, scaled.
    minimum: vec2f,
    maximum: vec2f,
    // u min, u max, v min, v max.
    sides: vec4u,
    // Where a side is a point: the distance to it grows as the parameter's to the power of one over this.
    tip_powers: vec4f,
    // The whole picture in pixels.
    size: vec2u,
    // The rows of this dispatch: first, and how many.
    rows: vec2u,
    // One over the length of the camera's tangent vectors.
    per_length: f32,
    // The most steps that a pixel may take.
    step_limit: u32,
    // Which instance of the surface.
    instance: u32,
    // The row of the picture that the map begins with.
    map_row: u32,
}

// A point that moves over the chart.
struct Mover {
    at: vec2f,
    velocity: vec2f,
    // False once it has left through an edge.
    inside: bool,
}

// Brings a mover that has passed a side back into the domain, or finds that it has left.
fn passed_sides(mover: Mover, camera: Camera) -> Mover {
    var m = mover;
    let period = camera.maximum - camera.minimum;
    // A step is far shorter than a period: the passes below suffice, and end in any case.
    for (var pass_number = 0u; pass_number < 4u; pass_number++) {
        let below = m.at < camera.minimum;
        let above = m.at > camera.maximum;
        if !any(below) && !any(above) {
            break;
        }
        for (var axis = 0u; axis < 2u; axis++) {
            if !below[axis] && !above[axis] {
                continue;
            }
            let other = 1u - axis;
            let side = camera.sides[2u * axis + select(1u, 0u, below[axis])];
            let direction = select(-1.0, 1.0, below[axis]);
            switch side {
                case SIDE_WRAP: {
                    m.at[axis] += direction * period[axis];
                }
                case SIDE_WRAP_FLIP: {
                    m.at[axis] += direction * period[axis];
                    m.at[other] = camera.minimum[other] + camera.maximum[other] - m.at[other];
                    m.velocity[other] = -m.velocity[other];
                }
                case SIDE_POLE: {
                    m.at[axis] = 2.0 * select(camera.maximum[axis], camera.minimum[axis], below[axis]) - m.at[axis];
                    let middle = 0.5 * (camera.minimum[other] + camera.maximum[other]);
                    m.at[other] += select(-0.5, 0.5, m.at[other] < middle) * period[other];
                    m.velocity[axis] = -m.velocity[axis];
                }
                default: {
                    m.inside = false;
                }
            }
        }
        if !m.inside {
            break;
        }
    }
    return m;
}

// True for a side that is one point.
fn is_tip(side: u32) -> bool {
    return side == SIDE_POLE || side == SIDE_CONE;
}
