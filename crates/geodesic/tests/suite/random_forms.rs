//! Seeded random geodesics against closed forms: the truth is within what is said of it, and within fixed bounds.

use crate::random::Random;
use crate::shapes::*;
use geodesic::surface::Surface;
use geodesic::trace::{Options, Status, Trace, trace};

impl Random {
    fn turn(&mut self) -> f64 {
        self.between(-PI, PI)
    }
}

/// Over many rays: how far the truth is off, and how far beyond the estimate.
struct Tally {
    what: &'static str,
    size: f64,
    worst: f64,
    ratio: f64,
    estimate: f64,
    evaluations: usize,
    worst_case: String,
}

impl Tally {
    fn new(what: &'static str) -> Self {
        Self {
            what,
            size: 1.0,
            worst: 0.0,
            ratio: 0.0,
            estimate: 0.0,
            evaluations: 0,
            worst_case: String::new(),
        }
    }

    fn add(&mut self, case: &str, error: f64, end: &Trace) {
        self.add_both(case, error, end.error_estimate, end);
    }

    fn add_both(&mut self, case: &str, error: f64, estimate: f64, end: &Trace) {
        assert_eq!(
            end.status,
            Status::Complete,
            "{}: {case}: {end:?}",
            self.what
        );
        assert!(error.is_finite(), "{}: {case}: {end:?}", self.what);
        // The closed form itself is good to a few units in the last place of the size, or of coordinates beyond it.
        let reach = place(end)
            .iter()
            .fold(self.size, |most, x| most.max(x.abs()));
        let ratio = error / (estimate + 1e-15 * reach);
        if ratio > self.ratio {
            self.worst_case = format!("{case}: error {error:e} estimate {estimate:e}");
        }
        self.ratio = self.ratio.max(ratio);
        self.worst = self.worst.max(error / self.size);
        self.estimate = self.estimate.max(estimate / self.size);
        self.evaluations = self.evaluations.max(end.evaluations);
    }

    #[track_caller]
    fn check(&self, bound: f64) {
        println!(
            "{:28} error {:8.1e} bound {:7.0e} ratio {:9.2e} estimate {:8.1e} evaluations {:5} | {}",
            self.what,
            self.worst,
            bound,
            self.ratio,
            self.estimate,
            self.evaluations,
            self.worst_case
        );
        assert!(
            self.worst <= bound,
            "{}: {:e} > {bound:e}",
            self.what,
            self.worst
        );
        assert!(self.ratio <= 3.0, "{}: {}", self.what, self.worst_case);
    }
}

fn go(surface: &dyn Surface, from: [f64; 2], direction: [f64; 2], length: f64) -> Trace {
    match trace(surface, from, direction, length, &Options::default()) {
        Ok(end) => end,
        Err(error) => panic!("{from:?} {direction:?}: {error}"),
    }
}

/// The position of an end in space.
fn place(end: &Trace) -> [f64; 3] {
    end.position.expect("an embedded surface")
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

/// The end of a great circle of the unit sphere, from (longitude, latitude), `angle` from east towards north.
fn great_circle([u, v]: [f64; 2], angle: f64, length: f64) -> [f64; 3] {
    let ((su, cu), (sv, cv)) = (u.sin_cos(), v.sin_cos());
    let (north, east) = angle.sin_cos();
    let tangent = [
        -east * su - north * sv * cu,
        east * cu - north * sv * su,
        north * cv,
    ];
    let (sin, cos) = length.sin_cos();
    let p = [cv * cu, cv * su, sv];
    [0, 1, 2].map(|k| p[k] * cos + tangent[k] * sin)
}

#[test]
fn great_circles_of_spheres_in_many_charts() {
    let mut random = Random(1);
    for (what, near, bound) in [("sphere", 0.0, 1e-8), ("sphere near a pole", 1.0, 1e-9)] {
        let mut tally = Tally::new(what);
        let s = spheroid(1.0, 1.0);
        for n in 0..200 {
            let side = if n % 2 == 0 { 1.0 } else { -1.0 };
            let v = if near > 0.0 {
                side * (PI / 2.0 - random.size(1e-14, 0.3))
            } else {
                random.between(-1.0, 1.0_f64).asin()
            };
            let from = [random.between(0.0, TAU), v];
            let angle = random.turn();
            let length = random.size(0.1, if near > 0.0 { 3.0 } else { 100.0 });
            let end = go(&s, from, [angle.cos() / v.cos(), angle.sin()], length);
            let error = distance(place(&end), great_circle(from, angle, length));
            tally.add(&format!("{from:?} {angle} {length}"), error, &end);
        }
        tally.check(bound);
    }
    // In units of the chart, and of the surface.
    for (what, unit, size) in [
        ("chart in 1e-10", 1e-10, 1.0),
        ("chart in 1e6", 1e6, 1.0),
        ("size 1e-6", 1.0, 1e-6),
        ("size 1e6", 1.0, 1e6),
        ("both", 1e-10, 1e6),
    ] {
        let mut tally = Tally::new(what);
        tally.size = size;
        let s = sphere_in_units(unit, size, 0.0);
        for n in 0..100 {
            let v = if n % 3 == 0 {
                PI / 2.0 - random.size(1e-12, 0.3)
            } else {
                random.between(-1.0, 1.0_f64).asin()
            };
            let from = [random.between(0.0, TAU), v].map(|x| x * unit);
            let point = from.map(|x| x / unit);
            let angle = random.turn();
            let length = random.size(0.1, 10.0);
            let direction = [angle.cos() / point[1].cos(), angle.sin()];
            let end = go(&s, from, direction, length * size);
            let exact = great_circle(point, angle, length).map(|x| size * x);
            tally.add(
                &format!("{from:?} {angle} {length}"),
                distance(place(&end), exact),
                &end,
            );
        }
        // Dividing by the unit rounds a latitude, which near the pole is a direction's error.
        tally.check(1e-9);
    }
    for (what, shear, bound) in [
        ("sheared by 2", 2.0, 1e-9),
        ("sheared by 100", 1e2, 1e-9),
        ("sheared by 1000", 1e3, 3e-9),
    ] {
        let mut tally = Tally::new(what);
        let s = sphere_in_units(1.0, 1.0, shear);
        for _ in 0..100 {
            let v = random.between(-0.9, 0.9_f64).asin();
            let from = [random.between(0.0, TAU), v];
            let point = [from[0] + shear * v, v];
            let angle = random.between(-1.0, 1.0);
            let length = random.size(0.1, 5.0);
            let north = angle.sin();
            let end = go(
                &s,
                from,
                [angle.cos() / v.cos() - shear * north, north],
                length,
            );
            let error = distance(place(&end), great_circle(point, angle, length));
            tally.add(&format!("{from:?} {angle} {length}"), error, &end);
        }
        tally.check(bound);
    }
}

#[test]
fn starts_at_a_pole_go_where_they_are_headed() {
    let mut tally = Tally::new("from a pole");
    let s = spheroid(1.0, 1.0);
    let mut random = Random(2);
    for n in 0..100 {
        let side = if n % 2 == 0 { 1.0 } else { -1.0 };
        let u = random.between(0.0, TAU);
        let from = [u, side * PI / 2.0];
        let angle = random.turn();
        let length = random.size(0.1, 3.0);
        let options = Options::default();
        let end =
            geodesic::frame::trace_heading(&s, from, angle, length, &options).expect("a start");
        let error = distance(place(&end), great_circle(from, angle, length));
        tally.add(&format!("{from:?} {angle} {length}"), error, &end);
        let end = go(&s, from, [0.7, -side], length);
        let error = distance(place(&end), great_circle(from, -side * PI / 2.0, length));
        tally.add(&format!("{from:?} meridian {length}"), error, &end);
    }
    tally.check(1e-11);
}

#[test]
fn straight_lines_of_surfaces_that_unroll() {
    let mut random = Random(3);
    let mut tally = Tally::new("cylinder");
    let s = cylinder();
    for _ in 0..100 {
        let from = [random.between(0.0, TAU), random.between(-10.0, 10.0)];
        let angle = random.turn();
        let length = random.size(0.1, 80.0);
        let end = go(&s, from, [angle.cos() / 2.0, angle.sin()], length);
        let u = from[0] + length * angle.cos() / 2.0;
        let exact = [2.0 * u.cos(), 2.0 * u.sin(), from[1] + length * angle.sin()];
        tally.add(
            &format!("{from:?} {angle} {length}"),
            distance(place(&end), exact),
            &end,
        );
    }
    tally.check(1e-11);
    for (what, slope) in [
        ("cone 1", 1.0),
        ("cone 0.3", 0.3),
        ("cone 3", 3.0),
        ("polar plane", 0.0),
    ] {
        let mut tally = Tally::new(what);
        let s = cone(slope);
        let root = f64::hypot(1.0, slope);
        for n in 0..100 {
            // A line from distance `d` whose nearest point to the tip is `miss` off.
            let d = random.size(0.1, 10.0);
            let miss = if n % 2 == 0 {
                random.size(1e-8, 0.05)
            } else {
                d * random.unit()
            };
            let side = if n % 3 == 0 { -1.0 } else { 1.0 };
            let sine = side * miss / d;
            let cosine = if n % 5 == 0 { 1.0 } else { -1.0 } * (1.0 - sine * sine).sqrt();
            let length = random.size(0.1, 20.0);
            let from = [random.between(0.0, TAU), d / root];
            let end = go(&s, from, [sine / from[1], cosine / root], length);
            let (x, y) = (d + length * cosine, length * sine);
            let u = from[0] + y.atan2(x) * root;
            let r = x.hypot(y) / root;
            let error = distance(place(&end), [r * u.cos(), r * u.sin(), slope * r]);
            tally.add(&format!("{from:?} {sine} {cosine} {length}"), error, &end);
        }
        tally.check(1e-10);
    }
    let mut tally = Tally::new("log-polar plane");
    let s = log_polar();
    for n in 0..100 {
        let d = random.size(0.1, 10.0);
        let miss = if n % 2 == 0 {
            random.size(1e-6, 0.05)
        } else {
            d * random.unit()
        };
        let sine = miss / d;
        let cosine = -(1.0 - sine * sine).sqrt();
        let length = random.size(0.1, 20.0);
        let from = [random.between(0.0, TAU), d.ln()];
        let end = go(&s, from, [sine / d, cosine / d], length);
        let (x, y) = (from[1].exp() + length * cosine, length * sine);
        let (su, cu) = from[0].sin_cos();
        let exact = [x * cu - y * su, x * su + y * cu, 0.0];
        tally.add(
            &format!("{from:?} {miss} {length}"),
            distance(place(&end), exact),
            &end,
        );
    }
    tally.check(2e-10);
}

#[test]
fn lines_of_the_pseudosphere_go_up_its_cusp_and_back() {
    let mut random = Random(4);
    let mut tally = Tally::new("pseudosphere");
    let s = pseudosphere();
    for _ in 0..100 {
        // In the half-plane: x = u, y = cosh v; lines are x = c ± R tanh t, y = R/cosh t.
        let (y, top) = (random.between(1.2, 3.0), random.size(3.0, 1e4));
        let t = -f64::acosh(top / y.min(top));
        let last = f64::acosh(top / 1.2);
        let length = random.between(0.1, last - t - 0.01);
        let t1 = t + length;
        let from = [random.between(0.0, TAU), f64::acosh(y)];
        // Unit components along x and y; v' = y'/sinh v.
        let (right, up) = (1.0 / t.cosh(), -t.tanh());
        let direction = [right * y, up * y / from[1].sinh()];
        let end = go(&s, from, direction, length);
        let u = from[0] + y * t.cosh() * (t1.tanh() - t.tanh());
        let v = f64::acosh(y * t.cosh() / t1.cosh());
        let exact = [u.cos() / v.cosh(), u.sin() / v.cosh(), v - v.tanh()];
        let clairaut = |uv: [f64; 2], d: [f64; 2]| d[0] / uv[1].cosh().powi(2);
        let drift = clairaut(end.uv.0, end.direction.0) / (right / y) - 1.0;
        assert!(
            drift.abs() <= 1e-6 || end.error_estimate > 1e-6,
            "{drift:e} {end:?}"
        );
        // The closed form's own rounding grows with R.
        let error = (distance(place(&end), exact) - 1e-15 * top).max(0.0);
        tally.add(&format!("{from:?} {direction:?} {length}"), error, &end);
    }
    tally.check(1e-6);
}

#[test]
fn catenoid_and_helicoid_have_the_same_lines() {
    let mut random = Random(5);
    let (catenoid, helicoid) = (catenoid(), helicoid());
    let mut tally = Tally::new("catenoid and helicoid");
    for _ in 0..100 {
        let from = [random.between(0.0, TAU), random.between(-1.5, 1.5)];
        let angle = random.turn();
        let direction = [angle.cos(), angle.sin()];
        let length = random.size(0.1, 5.0);
        let a = go(&catenoid, from, direction, length);
        let b = go(&helicoid, from, direction, length);
        let around = (a.uv[0] - b.uv[0] + PI).rem_euclid(TAU) - PI;
        let error = around.hypot(a.uv[1] - b.uv[1]) * a.uv[1].cosh();
        tally.add_both(
            &format!("{from:?} {angle} {length}"),
            error,
            a.error_estimate + b.error_estimate,
            &a,
        );
    }
    tally.check(1e-10);
}

#[test]
fn bumps_are_crossed_and_crossed_back() {
    let mut random = Random(6);
    let s = bumps();
    let mut tally = Tally::new("bumps");
    for _ in 0..60 {
        let from = [random.between(-0.5, 0.5), random.between(-0.5, 0.5)];
        let angle = random.turn();
        let length = random.size(0.1, 3.0);
        let there = go(&s, from, [angle.cos(), angle.sin()], length);
        let back = go(&s, there.uv.0, (-there.direction).0, length);
        assert!(there.speed_drift.abs() < 1e-10, "{there:?}");
        // Chaos: an error out there grows on the way back as it did on the way there.
        let error = distance(place(&back), s.jet(from.into()).position);
        tally.add_both(
            &format!("{from:?} {angle} {length}"),
            error,
            there.error_estimate + back.error_estimate,
            &back,
        );
    }
    tally.check(1e-6);
}

#[test]
fn seams_of_moebius_strip_and_klein_bottle_are_not_seen() {
    let mut random = Random(7);
    for (what, folded, unfolded) in [
        ("Möbius", moebius(0.0), moebius(-PI)),
        ("Klein", klein(TAU), klein(2.0 * TAU)),
    ] {
        let mut tally = Tally::new(what);
        for _ in 0..100 {
            let from = [random.between(0.1, 3.0), random.between(-0.3, 0.3)];
            let angle = random.between(-0.15, 0.15) + PI;
            let length = if what == "Klein" {
                random.size(0.1, 20.0)
            } else {
                random.size(0.1, 1.0)
            };
            let from = if what == "Klein" {
                [from[0], from[1] + 1.0]
            } else {
                from
            };
            let direction = [angle.cos(), angle.sin()];
            let a = go(&folded, from, direction, length);
            let b = go(&unfolded, from, direction, length);
            tally.add_both(
                &format!("{from:?} {angle} {length}"),
                distance(place(&a), place(&b)),
                a.error_estimate + b.error_estimate,
                &a,
            );
        }
        tally.check(1e-8);
    }
}
