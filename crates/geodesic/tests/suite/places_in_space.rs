//! Ends with three coordinates: geodesics on the implicit unit sphere x² + y² + z² = 1, which has no chart, interpolated by
//! the same code as those of charts.

use geodesic::ends::{Coordinates, End, Ends};
use geodesic::map::pixel_place;
use geodesic::piecewise::PiecewiseMap;
use geodesic::point::PicturePoint;
use geodesic::trace::Status;

/// What the polynomials may add, in pixels.
const TOLERANCE: f64 = 0.05;

/// A camera on the unit sphere: its place, its two orthonormal directions, and the zoom.
struct Sphere {
    at: [f64; 3],
    x: [f64; 3],
    y: [f64; 3],
    zoom: f64,
    /// Where the sphere ends: below this z.
    least: f64,
}

fn combine(s: f64, a: [f64; 3], t: f64, b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|k| s * a[k] + t * b[k])
}

fn length(a: [f64; 3]) -> f64 {
    a.iter().map(|x| x * x).sum::<f64>().sqrt()
}

impl Sphere {
    fn new(zoom: f64, least: f64) -> Self {
        let (sin, cos) = 0.3_f64.sin_cos();
        let at = [0.6, 0.0, 0.8];
        let (east, north) = ([0.0, 1.0, 0.0], [-0.8, 0.0, 0.6]);
        Self {
            at,
            x: combine(cos, east, sin, north),
            y: combine(-sin, east, cos, north),
            zoom,
            least,
        }
    }
}

impl Ends<3> for Sphere {
    fn end(&self, PicturePoint([x, y]): PicturePoint) -> End<3> {
        let radius = x.hypot(y);
        let s = self.zoom * radius;
        let (cos, sin) = if radius > 0.0 {
            (x / radius, y / radius)
        } else {
            (1.0, 0.0)
        };
        let direction = combine(cos, self.x, sin, self.y);
        let at = combine(s.cos(), self.at, s.sin(), direction);
        End {
            coordinates: Coordinates::Plain,
            at,
            along: combine(-s.sin(), self.at, s.cos(), direction),
            across: combine(-sin, self.x, cos, self.y),
            stretch: if s > 0.0 { s.sin() / s } else { 1.0 },
            status: if at[2] < self.least {
                Status::LeftDomain
            } else {
                Status::Complete
            },
            error: 0.0,
        }
    }

    fn zoom(&self) -> f64 {
        self.zoom
    }

    fn origin(&self) -> [f64; 3] {
        self.at
    }

    fn bounds(&self) -> [[f64; 2]; 3] {
        let free = [f64::NEG_INFINITY, f64::INFINITY];
        [free, free, [self.least, f64::INFINITY]]
    }
}

#[test]
fn great_circles_on_an_implicit_sphere_are_interpolated_in_space() {
    // A part of it, more than a half with conjugate points beyond the border, and an edge.
    for (zoom, least) in [(0.3, -2.0), (2.0, -2.0), (4.0, -2.0), (1.0, 0.3)] {
        let sphere = Sphere::new(zoom, least);
        let size = [257, 193];
        let piecewise = PiecewiseMap::cut(&sphere, size, TOLERANCE);
        let map = piecewise.map(true);
        let pixels = size[0] * size[1];
        assert!(piecewise.samples < u64::from(pixels) / 4, "{zoom}");
        assert!(piecewise.estimate.max <= TOLERANCE, "{zoom}");
        let pixel = 2.0 * zoom / f64::from(size[1]);
        let mut mistaken = 0;
        for index in 0..pixels {
            let truth = sphere.end(pixel_place(size, index % size[0], index / size[0]));
            let k = index as usize;
            let found: [f64; 3] =
                std::array::from_fn(|n| map.origin[n] + f64::from(map.offset[k][n]));
            if map.status[k] != truth.status {
                // A little beside the edge it may be either.
                let off = (truth.at[2] - least).abs();
                assert!(off < 0.5 * pixel, "{zoom}, {index}: {off}");
                mistaken += 1;
                continue;
            }
            if truth.status != Status::Complete {
                continue;
            }
            let off = length(combine(1.0, found, -1.0, truth.at)) / pixel;
            assert!(off <= 1.5 * TOLERANCE, "{zoom}, {index}: {off} px");
            assert!((length(found) - 1.0).abs() < 0.2 * pixel);
            let place = pixel_place(size, index % size[0], index / size[0]);
            let [right, up] = truth.by_place(place, zoom);
            let per_pixel = 2.0 / f64::from(size[1]);
            for (found, true_step) in [
                (map.by_pixel[k][0], right),
                (map.by_pixel[k][1], up.map(|x| -x)),
            ] {
                let off = combine(1.0, found.map(f64::from), -per_pixel, true_step);
                assert!(length(off) < 0.1 * pixel, "{zoom}, {index}: {off:?}");
            }
        }
        assert!(mistaken < 20, "{zoom}: {mistaken}");
        let middle = map.offset[map.offset.len() / 2];
        assert_eq!(middle, [0.0; 3], "the camera's own place, to the last bit");
    }
}
