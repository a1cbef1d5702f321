//! The motions of a geodesic camera.

/// A motion of a geodesic camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Motion {
    /// Along the geodesic with the velocity xX + yY, for unit time.
    Walk([f64; 2]),
    /// A turn by radians, anticlockwise.
    Turn(f64),
    /// X and Y are scaled by a factor; above 1, the picture shows more of the surface.
    Zoom(f64),
}

/// Appends a motion to the pending ones, or joins it with the last one if the effect is the same.
pub(crate) fn push(motions: &mut Vec<Motion>, next: Motion) {
    match (motions.last_mut(), next) {
        (Some(Motion::Turn(last)), Motion::Turn(by)) => *last += by,
        (Some(Motion::Zoom(last)), Motion::Zoom(by)) => *last *= by,
        (Some(Motion::Walk(last)), Motion::Walk(by))
            if (last[0] * by[1] - last[1] * by[0]).abs() <= 1e-12 =>
        {
            *last = [last[0] + by[0], last[1] + by[1]];
        }
        _ => motions.push(next),
    }
}

#[cfg(test)]
mod tests {
    use super::{Motion, push};

    #[test]
    fn motions_that_wait_are_joined_where_that_comes_to_the_same() {
        let mut motions = Vec::new();
        for motion in [
            Motion::Walk([0.0, 0.1]),
            Motion::Walk([0.0, 0.2]),
            Motion::Walk([0.1, 0.0]),
            Motion::Turn(0.5),
            Motion::Turn(0.25),
            Motion::Zoom(2.0),
            Motion::Zoom(4.0),
        ] {
            push(&mut motions, motion);
        }
        let expected = [
            Motion::Walk([0.0, 0.1 + 0.2]),
            Motion::Walk([0.1, 0.0]),
            Motion::Turn(0.75),
            Motion::Zoom(8.0),
        ];
        assert_eq!(motions, expected);
    }
}
