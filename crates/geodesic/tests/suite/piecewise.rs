//! The piecewise map against exponential maps in closed form.

use std::f64::consts::{FRAC_PI_2, TAU};

use geodesic::ends::{Coordinates, End, Ends, Polar};
use geodesic::map::pixel_place;
use geodesic::piecewise::{BLOCK, Cover, DEGREE, PiecewiseMap, table};
use geodesic::point::PicturePoint;
use geodesic::trace::Status;

/// The share of a pixel that polynomials may add.
const TOLERANCE: f64 = 0.025;

fn ended(status: Status) -> End {
    End {
        coordinates: Coordinates::Plain,
        at: [f64::NAN; 2],
        along: [f64::NAN; 2],
        across: [f64::NAN; 2],
        stretch: f64::NAN,
        status,
        error: 0.0,
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn combine(s: f64, a: [f64; 3], t: f64, b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|k| s * a[k] + t * b[k])
}

/// The unit sphere by longitude and latitude, its longitudes in [−π, π] wherever they come from. Within half a radian
/// of a pole ends are told about it.
struct Sphere {
    at: [f64; 2],
    zoom: f64,
    angle: f64,
    poles: bool,
}

impl Sphere {
    /// East, north, up.
    fn axes([lon, lat]: [f64; 2]) -> [[f64; 3]; 3] {
        let ((s, c), (t, d)) = (lon.sin_cos(), lat.sin_cos());
        [[-s, c, 0.0], [-t * c, -t * s, d], [d * c, d * s, t]]
    }

    /// Position, tangent, normal.
    fn moved(&self, place: [f64; 2]) -> [[f64; 3]; 3] {
        let [east, north, up] = Self::axes(self.at);
        let r = place[0].hypot(place[1]);
        let turned = place[1].atan2(place[0]) + self.angle;
        let (sin, cos) = turned.sin_cos();
        let way = combine(cos, east, sin, north);
        let left = combine(-sin, east, cos, north);
        let (s, c) = (self.zoom * r).sin_cos();
        [combine(c, up, s, way), combine(-s, up, c, way), left]
    }
}

impl Ends for Sphere {
    fn end(&self, PicturePoint(place): PicturePoint) -> End {
        let [p, along, across] = self.moved(place);
        let s = self.zoom * place[0].hypot(place[1]);
        let ground = p[0].hypot(p[1]);
        let at = [p[1].atan2(p[0]), p[2].atan2(ground)];
        let [east, north, _] = Self::axes(at);
        let base = End {
            coordinates: Coordinates::Plain,
            at,
            along: [0.0; 2],
            across: [0.0; 2],
            stretch: if s > 0.0 { s.sin() / s } else { 1.0 },
            status: Status::Complete,
            error: 0.0,
        };
        let sign = p[2].signum();
        let r = ground.atan2(sign * p[2]);
        if self.poles && r < 0.5 {
            // (a, b) = r (cos lon, sin lon): radially −sign·north, around east; a circle is sin r / r as long.
            let (sin, cos) = at[0].sin_cos();
            let squeeze = if r > 0.0 { r / r.sin() } else { 1.0 };
            let about = |v: [f64; 3]| {
                let (out, around) = (-sign * dot(v, north), squeeze * dot(v, east));
                [out * cos - around * sin, out * sin + around * cos]
            };
            return End {
                coordinates: Coordinates::Apex {
                    axis: 1,
                    end: u8::from(sign > 0.0),
                },
                at: [r * cos, r * sin],
                along: about(along),
                across: about(across),
                ..base
            };
        }
        let plain = |v: [f64; 3]| [dot(v, east) / ground, dot(v, north)];
        End {
            along: plain(along),
            across: plain(across),
            ..base
        }
    }

    fn zoom(&self) -> f64 {
        self.zoom
    }

    fn origin(&self) -> [f64; 2] {
        self.at
    }

    fn in_coordinates(&self, end: &End, coordinates: Coordinates) -> Option<End> {
        if end.coordinates == coordinates {
            return Some(*end);
        }
        let mut out = *end;
        if let Coordinates::Apex { end: side, .. } = end.coordinates {
            let sign = 2.0 * f64::from(side) - 1.0;
            let [a, b] = end.at;
            let r = a.hypot(b);
            let plain = |v: [f64; 2]| {
                let (radial, around) = ((a * v[0] + b * v[1]) / r, (a * v[1] - b * v[0]) / r);
                [around / r, -sign * radial]
            };
            out = End {
                coordinates: Coordinates::Plain,
                at: [b.atan2(a), sign * (FRAC_PI_2 - r)],
                along: plain(end.along),
                across: plain(end.across),
                ..out
            };
        }
        if let Coordinates::Apex { end: side, .. } = coordinates {
            let sign = 2.0 * f64::from(side) - 1.0;
            let r = FRAC_PI_2 - sign * out.at[1];
            if r > 1.5 {
                return None;
            }
            let (sin, cos) = out.at[0].sin_cos();
            let about = |v: [f64; 2]| {
                let (radial, around) = (-sign * v[1], r * v[0]);
                [radial * cos - around * sin, radial * sin + around * cos]
            };
            out = End {
                coordinates,
                at: [r * cos, r * sin],
                along: about(out.along),
                across: about(out.across),
                ..out
            };
        }
        Some(out)
    }

    fn periods(&self) -> [f64; 2] {
        [TAU, 0.0]
    }

    fn polar(&self, axis: u8, end: u8) -> Option<Polar> {
        let sign = 1.0 - 2.0 * f64::from(end);
        (self.poles && axis == 1).then_some(Polar {
            base: -sign * FRAC_PI_2,
            sign,
            low: 0.0,
            rate: 1.0,
            power: 1.0,
        })
    }
}

/// The largest distance in space between a sphere's pixels and the truth, and between their derivatives, in pixels.
fn off_sphere(sphere: &Sphere, piecewise: &PiecewiseMap) -> (f64, f64) {
    let map = piecewise.map(true);
    let size = map.size;
    let per_place = 2.0 / f64::from(size[0].min(size[1]));
    let pixel = sphere.zoom * per_place;
    let mut worst = (0.0_f64, 0.0_f64);
    for index in 0..map.offset.len() {
        let (column, row) = (index as u32 % size[0], index as u32 / size[0]);
        let PicturePoint(place) = pixel_place(size, column, row);
        assert_eq!(map.status[index], Status::Complete);
        let [p, along, across] = sphere.moved(place);
        let at = map.uv(index);
        let [east, north, q] = Sphere::axes(at.0);
        let off = combine(1.0, p, -1.0, q);
        worst.0 = worst.0.max(dot(off, off).sqrt() / pixel);
        // To the right and down, on the surface.
        let r = place[0].hypot(place[1]);
        let s = sphere.zoom * r;
        let (stretch, [cos, sin]) = if r > 0.0 {
            (s.sin() / s, place.map(|x| x / r))
        } else {
            (1.0, [1.0, 0.0])
        };
        let truth = [
            combine(pixel * cos, along, -pixel * stretch * sin, across),
            combine(-pixel * sin, along, -pixel * stretch * cos, across),
        ];
        let by = map.by_pixel[index].map(|d| d.map(f64::from));
        for (k, truth) in truth.into_iter().enumerate() {
            let found = combine(by[k][0] * at[1].cos(), east, by[k][1], north);
            let off = combine(1.0, found, -1.0, truth);
            // So near a pole that the angle is rounded, directions are too.
            if at[1].cos() > 0.1 * pixel {
                worst.1 = worst.1.max(dot(off, off).sqrt() / pixel);
            }
        }
    }
    worst
}

#[test]
fn a_sphere_is_met_through_poles_and_seams_by_few_evaluations() {
    let cases = [
        ([0.3, 0.2], 0.8, [512, 512], false),
        ([3.0, 0.2], 1.0, [512, 512], true),
        ([0.3, 1.2], 2.0, [513, 300], true),
        ([-2.0, -1.5], 3.0, [640, 480], true),
        ([1.0, 1.5607], 6.0, [256, 256], true),
        ([1.0, 0.1], 0.5, [7, 5], true),
        ([1.0, 0.1], 0.5, [64, 9], true),
    ];
    for (at, zoom, size, poles) in cases {
        let sphere = Sphere {
            at,
            zoom,
            angle: 0.4,
            poles,
        };
        let piecewise = PiecewiseMap::cut(&sphere, size, TOLERANCE);
        let (off, slope) = off_sphere(&sphere, &piecewise);
        let case = format!("{at:?} z = {zoom} {size:?}");
        assert!(off < TOLERANCE, "{off} px, {case}");
        assert!(slope < 0.04, "{slope} px a pixel, {case}");
        assert!(piecewise.estimate.max <= TOLERANCE, "{case}");
        let pixels = u64::from(size[0]) * u64::from(size[1]);
        if size[0] == 512 {
            assert!(
                piecewise.samples * 20 < pixels && piecewise.singles.is_empty(),
                "{} evaluations, {} blocks of single pixels, {case}",
                piecewise.samples,
                piecewise.singles.len()
            );
        }
    }
}

#[test]
fn deep_zooms_keep_their_digits() {
    // By differences that lose nothing: haversines of what is left when the camera is taken away.
    for (zoom, allowed) in [(1e-6, 0.001), (1e-12, 0.02)] {
        for at in [[1.0, 0.9], [0.2, 1.3], [0.7, 0.0]] {
            let sphere = Sphere {
                at,
                zoom,
                angle: 0.0,
                poles: true,
            };
            let size = [64, 64];
            let map = PiecewiseMap::cut(&sphere, size, TOLERANCE).map(true);
            for index in 0..map.offset.len() {
                let PicturePoint(place) = pixel_place(size, index as u32 % 64, index as u32 / 64);
                let [x, y] = place.map(|x| x * zoom);
                // The exponential map to second order, enough for both zooms.
                let (tan, cos) = (at[1].tan(), at[1].cos());
                let truth = [(x + x * y * tan) / cos, y - 0.5 * x * x * tan];
                let off = [0, 1].map(|k| f64::from(map.offset[index][k]) - truth[k]);
                let off = (off[0] * cos).hypot(off[1]) / (zoom / 32.0);
                assert!(off < allowed, "{off} px at {index}, z = {zoom}, {at:?}");
            }
        }
    }
}

/// A flat surface: a map of the picture into the plane by the caller, whose metric is dx² + dy² in the picture's own
/// units, and where it ends.
struct Flat<F: Fn([f64; 2]) -> ([f64; 2], Status) + Sync> {
    map: F,
}

impl<F: Fn([f64; 2]) -> ([f64; 2], Status) + Sync> Ends for Flat<F> {
    fn end(&self, PicturePoint(place): PicturePoint) -> End {
        let (at, status) = (self.map)(place);
        if status != Status::Complete {
            return ended(status);
        }
        End {
            at,
            along: [1.0, 0.0],
            across: [0.0, 1.0],
            stretch: 1.0,
            status,
            ..ended(status)
        }
    }
    fn zoom(&self) -> f64 {
        1.0
    }
    fn origin(&self) -> [f64; 2] {
        (self.map)([0.0; 2]).0
    }
    fn in_coordinates(&self, end: &End, coordinates: Coordinates) -> Option<End> {
        (coordinates == end.coordinates).then_some(*end)
    }
    fn periods(&self) -> [f64; 2] {
        [0.0; 2]
    }
}

/// The largest error in pixels; statuses must agree.
fn off_flat<F: Fn([f64; 2]) -> ([f64; 2], Status) + Sync>(
    flat: &Flat<F>,
    piecewise: &PiecewiseMap,
) -> f64 {
    let map = piecewise.map(false);
    let size = map.size;
    let mut worst = 0.0_f64;
    for index in 0..map.offset.len() {
        let PicturePoint(place) = pixel_place(size, index as u32 % size[0], index as u32 / size[0]);
        let (at, status) = (flat.map)(place);
        assert_eq!(map.status[index], status, "at {place:?}");
        if status == Status::Complete {
            let uv = map.uv(index);
            let off = (uv[0] - at[0]).hypot(uv[1] - at[1]);
            worst = worst.max(off * 0.5 * f64::from(size[0].min(size[1])));
        } else {
            assert_eq!(map.offset[index], [0.0; 2]);
        }
    }
    worst
}

#[test]
fn edges_are_exact_to_the_pixel_wherever_they_run() {
    for n in 0..24 {
        let angle = 0.26 * f64::from(n);
        let (sin, cos) = angle.sin_cos();
        let away = 0.07 * f64::from(n % 13) - 0.1;
        let flat = Flat {
            map: |[x, y]: [f64; 2]| {
                let out = cos * x + sin * y > away;
                (
                    [x + 0.1 * y * y, y - 0.1 * x * y],
                    if out {
                        Status::LeftDomain
                    } else {
                        Status::Complete
                    },
                )
            },
        };
        for size in [[513, 300], [256, 256]] {
            let piecewise = PiecewiseMap::cut(&flat, size, TOLERANCE);
            let off = off_flat(&flat, &piecewise);
            assert!(off < TOLERANCE, "{off} px, edge {n}");
        }
    }
}

#[test]
fn round_edges_and_holes_are_seen_where_they_bend_into_squares() {
    let mut random = Random(7);
    let mut all = 0;
    for n in 0..40 {
        let centre = [random.next() - 0.5, random.next() - 0.5];
        let radius = 0.08 + 0.6 * random.next();
        let hole = n % 2 == 0;
        let flat = Flat {
            map: |[x, y]: [f64; 2]| {
                let inside = (x - centre[0]).hypot(y - centre[1]) < radius;
                let status = if inside == hole {
                    Status::LeftDomain
                } else {
                    Status::Complete
                };
                ([x + 0.1 * y * y, y - 0.1 * x * y], status)
            },
        };
        let size = [400, 300];
        let map = PiecewiseMap::cut(&flat, size, TOLERANCE).map(false);
        let wrong = (0..map.status.len())
            .filter(|&k| {
                let PicturePoint(place) = pixel_place(size, k as u32 % 400, k as u32 / 400);
                (flat.map)(place).1 != map.status[k]
            })
            .count();
        all += wrong;
    }
    assert!(all <= 4, "{all} pixels");
}

#[test]
fn what_lies_behind_a_cone_s_tip_is_torn_along_a_line_to_the_pixel() {
    // Unrolled, the tip is 0.31 from the camera: (u, v) are distance and angle there, 1.7 times as fast on both sides.
    for n in 0..12 {
        let (sin, cos) = (0.5 * f64::from(n) + 0.1).sin_cos();
        let flat = Flat {
            map: |[x, y]: [f64; 2]| {
                let [a, b] = [cos * x + sin * y - 0.31, cos * y - sin * x];
                let (r, turn) = (a.hypot(b), 0.7 * (-b).atan2(-a));
                ([r * turn.cos(), r * turn.sin()], Status::Complete)
            },
        };
        let size = [300, 300];
        let piecewise = PiecewiseMap::cut(&flat, size, TOLERANCE);
        let map = piecewise.map(false);
        let mut wrong = 0;
        for index in 0..map.offset.len() {
            let (at, _) = (flat.map)(pixel_place(size, index as u32 % 300, index as u32 / 300).0);
            let uv = map.uv(index);
            let off = (uv[0] - at[0]).hypot(uv[1] - at[1]) * 150.0;
            wrong += u32::from(off > TOLERANCE);
        }
        assert!(wrong <= 16, "{wrong} pixels, direction {n}");
    }
}

/// Numbers in [0, 1), the same on every machine.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }
}

#[test]
fn the_estimate_is_at_least_half_the_truth_on_random_fields() {
    let mut random = Random(1);
    for n in 0..60 {
        let waves: Vec<[f64; 5]> = (0..6)
            .map(|_| {
                let speed = 1.0 + 40.0 * random.next().powi(3);
                let turn = TAU * random.next();
                let size = 2.0 * random.next() / speed;
                [
                    speed * turn.cos(),
                    speed * turn.sin(),
                    TAU * random.next(),
                    size,
                    size * random.next(),
                ]
            })
            .collect();
        let flat = Flat {
            map: |[x, y]: [f64; 2]| {
                let mut at = [x, y];
                for [a, b, c, p, q] in &waves {
                    let wave = (a * x + b * y + c).sin();
                    at[0] += p * wave;
                    at[1] += q * wave;
                }
                (at, Status::Complete)
            },
        };
        let size = if n % 2 == 0 { [384, 256] } else { [150, 201] };
        for tolerance in [TOLERANCE, 0.2] {
            let piecewise = PiecewiseMap::cut(&flat, size, tolerance);
            let truth = off_flat(&flat, &piecewise);
            let estimate = piecewise.estimate.max;
            assert!(
                truth <= 2.0 * estimate + 1e-4,
                "field {n}: {truth} px, estimated {estimate}"
            );
            assert!(estimate <= tolerance);
        }
    }
}

#[test]
fn every_block_is_covered_once() {
    for size in [[0, 0], [1, 1], [7, 5], [8, 8], [513, 300], [1000, 33]] {
        let flat = Flat {
            map: |[x, y]: [f64; 2]| {
                let status = if x > 0.4 {
                    Status::Undefined
                } else {
                    Status::Complete
                };
                ([x + 0.2 * (9.0 * y).sin(), y], status)
            },
        };
        let piecewise = PiecewiseMap::cut(&flat, size, TOLERANCE);
        let across = size[0].div_ceil(BLOCK);
        assert_eq!(
            piecewise.covers.len() as u32,
            across * size[1].div_ceil(BLOCK)
        );
        let mut by_patch = vec![0; piecewise.patches.len()];
        let mut by_single = vec![0; piecewise.singles.len()];
        for (n, cover) in (0..).zip(&piecewise.covers) {
            let corner = [n % across.max(1) * BLOCK, n / across.max(1) * BLOCK];
            match *cover {
                Cover::Patch(index) => {
                    let patch = &piecewise.patches[index as usize];
                    by_patch[index as usize] += 1;
                    for (k, at) in corner.into_iter().enumerate() {
                        let end = patch.corner[k] + patch.extent[k];
                        assert!((patch.corner[k]..end).contains(&at));
                    }
                }
                Cover::Single(index) => by_single[index as usize] += 1,
                Cover::Nothing(status) => assert_eq!(status, Status::Undefined),
            }
        }
        for (patch, covered) in piecewise.patches.iter().zip(by_patch) {
            let [columns, rows] = patch.extent.map(|n| n.div_ceil(BLOCK));
            assert_eq!(
                columns * rows,
                covered,
                "{:?} {:?}",
                patch.corner,
                patch.extent
            );
        }
        assert!(by_single.into_iter().all(|n| n == 1));
        if size[0] > 0 {
            let off = off_flat(&flat, &piecewise);
            assert!(off < TOLERANCE, "{off} px, {size:?}");
        }
    }
}

#[test]
fn one_core_or_many_make_the_same_map() {
    let sphere = Sphere {
        at: [0.3, 1.2],
        zoom: 2.0,
        angle: 0.0,
        poles: true,
    };
    let map = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.expect("a pool").install(|| {
            let piecewise = PiecewiseMap::cut(&sphere, [513, 300], TOLERANCE);
            (piecewise.map(true), piecewise.table())
        })
    };
    let (one, three) = (map(1), map(3));
    assert_eq!(one.0.offset, three.0.offset);
    assert_eq!(one.0.by_pixel, three.0.by_pixel);
    assert_eq!(one.0.status, three.0.status);
    assert_eq!(one.1, three.1);
}

#[test]
fn the_middle_of_an_odd_picture_is_the_camera_itself_and_no_zoom_is_finite() {
    for (zoom, size) in [
        (2.0, [65, 41]),
        (0.0, [33, 32]),
        (1.0, [1, 1]),
        (1e-300, [9, 9]),
    ] {
        let sphere = Sphere {
            at: [1.0, 0.3],
            zoom,
            angle: 0.0,
            poles: true,
        };
        let piecewise = PiecewiseMap::cut(&sphere, size, TOLERANCE);
        let map = piecewise.map(true);
        assert!(map.offset.as_flattened().iter().all(|x| x.is_finite()));
        assert!(
            map.by_pixel
                .as_flattened()
                .as_flattened()
                .iter()
                .all(|x| x.is_finite())
        );
        assert!(piecewise.estimate.max.is_finite() && piecewise.estimate.max <= TOLERANCE);
        if size[0] % 2 == 1 && size[1] % 2 == 1 {
            let middle = map.offset.len() / 2;
            assert_eq!(map.offset[middle], [0.0; 2]);
        }
    }
}

/// Reads the table as the shader does, pixel by pixel.
#[test]
fn the_table_says_the_same_as_the_map() {
    let sphere = Sphere {
        at: [0.3, 1.2],
        zoom: 1.5,
        angle: 0.2,
        poles: true,
    };
    let size = [200, 136];
    let piecewise = PiecewiseMap::cut(&sphere, size, TOLERANCE);
    let map = piecewise.map(true);
    let words = piecewise.table();
    let float = |at: u32| f32::from_bits(words[at as usize]);
    assert_eq!(words.len() as u32, words[7]);
    let mut seen = [0; 3];
    for index in 0..map.offset.len() as u32 {
        let [x, y] = [index % words[0], index / words[0]];
        let cover = words[(words[4] + y / BLOCK * words[2] + x / BLOCK) as usize];
        let number = cover & 0x3fff_ffff;
        seen[(cover >> 30) as usize] += 1;
        let offset = match cover >> 30 {
            0 => {
                let head = words[5] + number * table::PATCH_WORDS as u32;
                let scaled = |k: u32, n: u32| {
                    let (corner, extent) =
                        (words[(head + k) as usize], words[(head + 2 + k) as usize]);
                    (2 * (n - corner) + 1) as f32 / extent as f32 - 1.0
                };
                let (a, b) = (scaled(0, x), scaled(1, y));
                let n = DEGREE as u32 + 1;
                let value = [0, 1].map(|k| {
                    let mut sum = 0.0;
                    for j in (0..n).rev() {
                        let mut row = 0.0;
                        for i in (0..n).rev() {
                            row = row * a + float(head + 8 + n * n * k + n * j + i);
                        }
                        sum = sum * b + row;
                    }
                    sum + float(head + 6 + k)
                });
                match words[(head + 4) as usize] {
                    0 => value,
                    n => {
                        let apex = 8 + (n - 1) * table::APEX_WORDS as u32;
                        assert_eq!(words[(apex + 5) as usize], 1);
                        assert_eq!(float(apex + 4), 1.0);
                        let w = float(apex) + float(apex + 1) * value[0].hypot(value[1]);
                        let t = float(apex + 2) + float(apex + 3) * value[1].atan2(value[0]);
                        if n > 2 { [t, w] } else { [w, t] }
                    }
                }
            }
            1 => {
                let pixel = words[6]
                    + number * table::SINGLE_WORDS as u32
                    + 8 * (y % BLOCK * BLOCK + x % BLOCK);
                assert_eq!(words[(pixel + 6) as usize], 0);
                [float(pixel), float(pixel + 1)]
            }
            _ => panic!("nothing there"),
        };
        let expected = map.offset[index as usize];
        for k in 0..2 {
            let off = f64::from(offset[k] - expected[k]);
            let off = if k == 0 {
                off - TAU * (off / TAU).round()
            } else {
                off
            };
            assert!(off.abs() < 2e-6, "{offset:?} {expected:?} at {x}, {y}");
        }
    }
    assert!(seen[0] > 0, "{seen:?}");
}
