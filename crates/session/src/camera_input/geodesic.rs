//! The camera of a geodesic view: it walks on its surface, turns and zooms.

use super::{CameraKey, Held, TURN_SPEED, ZOOM_SPEED};
use crate::inside_camera::InsideCamera;
use crate::model::Model;
use crate::motion::Motion;

/// Lengths of X per second.
const WALK_SPEED: f64 = 0.8;

/// Returns the motions for the held keys; `speed` is that of the preferences.
pub fn motions_of_keys(held: Held, speed: f64) -> Vec<Motion> {
    let mut motions = Vec::new();
    if !held.any() {
        return motions;
    }
    let step = held.seconds * speed;
    let [right, up] = held.arrows();
    let x = (held.direction(CameraKey::D, CameraKey::A) + right).clamp(-1.0, 1.0);
    let y = (held.direction(CameraKey::W, CameraKey::S) + up).clamp(-1.0, 1.0);
    if x != 0.0 || y != 0.0 {
        let length = x.hypot(y);
        motions.push(Motion::Walk([x, y].map(|k| k / length * step * WALK_SPEED)));
    }
    let turn = held.direction(CameraKey::Q, CameraKey::E);
    if turn != 0.0 {
        motions.push(Motion::Turn(turn * step * TURN_SPEED));
    }
    let out = (held.direction(CameraKey::X, CameraKey::Z) - held.nearer()).clamp(-1.0, 1.0);
    if out != 0.0 {
        motions.push(Motion::Zoom((out * step * ZOOM_SPEED).exp()));
    }
    motions
}

/// Returns the motion for a drag in points, to the right and down: the surface follows the pointer. `side` is the
/// picture's shorter side in points.
pub fn dragged(by: [f64; 2], side: f64) -> Motion {
    let half = 0.5 * side.max(1.0);
    Motion::Walk([-by[0] / half, by[1] / half])
}

/// Returns the position of a surface's camera in words, to follow a view's name; `None` if there is no camera yet.
pub fn place(model: &Model, surface: &str) -> Option<String> {
    let camera = model.choices.inside.get(surface)?;
    let zoom = camera.zoom();
    let place = match camera {
        InsideCamera::Chart(camera) => {
            let (_, object) = model.scene.as_ref()?.object(surface)?;
            let [u, v] = camera.at;
            format!("{} = ({u:.3}, {v:.3})", object.shape.chart_label())
        }
        InsideCamera::Solid(camera) => {
            let [x, y, z] = model.scene.as_ref()?.stated(camera.at);
            format!("(x, y, z) = ({x:.3}, {y:.3}, {z:.3})")
        }
    };
    Some(format!(" from {place}, {zoom:.3} from centre to edge"))
}

#[cfg(test)]
mod tests {
    use super::{dragged, motions_of_keys};
    use crate::camera_input::{CameraKey, Held, Modifiers};
    use crate::motion::Motion;

    #[test]
    fn keys_walk_turn_and_zoom_as_fast_in_every_direction() {
        let motions = |keys: &[CameraKey]| {
            let held = Held::new(|key| keys.contains(&key), true, Modifiers::default(), 0.1);
            motions_of_keys(held, 1.0)
        };
        let [Motion::Walk([x, y])] = motions(&[CameraKey::W, CameraKey::Right])[..] else {
            panic!("one walk");
        };
        assert!((x.hypot(y) - 0.08).abs() < 1e-15 && (x - y).abs() < 1e-15);
        assert_eq!(motions(&[CameraKey::W, CameraKey::Down]), []);
        let others = motions(&[CameraKey::E, CameraKey::Plus]);
        let expected = [
            Motion::Turn(-0.1 * 1.2),
            Motion::Zoom((-0.1f64 * 0.9).exp()),
        ];
        assert_eq!(others, expected);
    }

    #[test]
    fn the_surface_goes_with_the_pointer() {
        // The zoom is the distance from the middle to the edge of the shorter side.
        assert_eq!(dragged([50.0, -25.0], 100.0), Motion::Walk([-1.0, -0.5]));
    }
}
