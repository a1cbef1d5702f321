// The hatching of unseen pixels: stripes at 45°, darker along the border to seen pixels, which is `reach` pixels wide.
fn hatched(x: i32, y: i32, paper: vec3f, stripe: vec3f, half_period: f32, reach: i32) -> vec3f {
    for (var dy = -reach; dy <= reach; dy++) {
        for (var dx = -reach; dx <= reach; dx++) {
            if dx * dx + dy * dy <= reach * reach && is_seen(x + dx, y + dy) {
                return 0.45 * stripe;
            }
        }
    }
    return stripes(x, y, half_period, paper, stripe);
}
