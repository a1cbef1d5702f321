//! Surfaces for the tests, as expressions: their derivatives and their topology are found as for a user's.

use expr::ops::{Binary, Unary};
use expr::{Graph, Input, NodeId};
use geodesic::intrinsic::MetricSurface;
use geodesic::surface::ParametricSurface;

/// A graph with the few constructors that the shapes need.
#[allow(dead_code)]
pub(crate) struct Maker {
    pub(crate) g: Graph,
    pub(crate) u: NodeId,
    pub(crate) v: NodeId,
}

#[allow(dead_code)]
impl Maker {
    pub(crate) fn new() -> Self {
        let mut g = Graph::default();
        let u = g.input(Input::Variable(0));
        let v = g.input(Input::Variable(1));
        Self { g, u, v }
    }
    pub(crate) fn c(&mut self, x: f64) -> NodeId {
        self.g.constant(x)
    }
    pub(crate) fn f(&mut self, op: Unary, a: NodeId) -> NodeId {
        self.g.unary(op, a)
    }
    pub(crate) fn mul(&mut self, a: NodeId, b: NodeId) -> NodeId {
        self.g.mul(a, b)
    }
    pub(crate) fn add(&mut self, a: NodeId, b: NodeId) -> NodeId {
        self.g.add(a, b)
    }
    pub(crate) fn scale(&mut self, s: f64, a: NodeId) -> NodeId {
        let s = self.c(s);
        self.g.mul(s, a)
    }
    pub(crate) fn plus(&mut self, s: f64, a: NodeId) -> NodeId {
        let s = self.c(s);
        self.g.add(s, a)
    }
    /// (r cos t, r sin t, z).
    pub(crate) fn around(&mut self, r: NodeId, t: NodeId, z: NodeId) -> [NodeId; 3] {
        let (cos, sin) = (self.f(Unary::Cos, t), self.f(Unary::Sin, t));
        [self.mul(r, cos), self.mul(r, sin), z]
    }
    pub(crate) fn done(self, position: [NodeId; 3], domain: [[f64; 2]; 2]) -> ParametricSurface {
        ParametricSurface::new(&self.g, position, domain, &[]).expect("small expressions")
    }
}

pub(crate) const TAU: f64 = std::f64::consts::TAU;
pub(crate) const PI: f64 = std::f64::consts::PI;

/// A spheroid with the axes a, a, b; longitude, latitude.
#[allow(dead_code)]
pub(crate) fn spheroid(a: f64, b: f64) -> ParametricSurface {
    triaxial(a, a, b)
}

/// An ellipsoid.
#[allow(dead_code)]
pub(crate) fn triaxial(a: f64, b: f64, c: f64) -> ParametricSurface {
    let mut m = Maker::new();
    let (cos, sin) = (m.f(Unary::Cos, m.v), m.f(Unary::Sin, m.v));
    let u = m.u;
    let [x, y, z] = m.around(cos, u, sin);
    let p = [m.scale(a, x), m.scale(b, y), m.scale(c, z)];
    m.done(p, [[0.0, TAU], [-PI / 2.0, PI / 2.0]])
}

/// v(cos u, sin u, slope).
#[allow(dead_code)]
pub(crate) fn cone(slope: f64) -> ParametricSurface {
    let mut m = Maker::new();
    let z = m.scale(slope, m.v);
    let (u, v) = (m.u, m.v);
    let p = m.around(v, u, z);
    m.done(p, [[0.0, TAU], [0.0, 100.0]])
}

/// The torus with the radii 1 and r.
#[allow(dead_code)]
pub(crate) fn torus(r: f64) -> ParametricSurface {
    let mut m = Maker::new();
    let (cos, sin) = (m.f(Unary::Cos, m.v), m.f(Unary::Sin, m.v));
    let tube = m.scale(r, cos);
    let radius = m.plus(1.0, tube);
    let z = m.scale(r, sin);
    let u = m.u;
    let p = m.around(radius, u, z);
    m.done(p, [[0.0, TAU], [0.0, TAU]])
}

/// The cylinder of radius 2.
#[allow(dead_code)]
pub(crate) fn cylinder() -> ParametricSurface {
    let mut m = Maker::new();
    let two = m.c(2.0);
    let (u, v) = (m.u, m.v);
    let p = m.around(two, u, v);
    m.done(p, [[0.0, TAU], [-100.0, 100.0]])
}

/// The plane, in a rectangle.
#[allow(dead_code)]
pub(crate) fn plane() -> ParametricSurface {
    let mut m = Maker::new();
    let (u, v, zero) = (m.u, m.v, m.c(0.0));
    m.done([u, v, zero], [[-4.0, 4.0], [-3.0, 3.0]])
}

/// The Möbius strip with its seam at u = `low`.
#[allow(dead_code)]
pub(crate) fn moebius(low: f64) -> ParametricSurface {
    let mut m = Maker::new();
    let half = m.scale(0.5, m.u);
    let (cos, sin) = (m.f(Unary::Cos, half), m.f(Unary::Sin, half));
    let v = m.v;
    let out = m.mul(v, cos);
    let radius = m.plus(1.0, out);
    let z = m.mul(v, sin);
    let u = m.u;
    let p = m.around(radius, u, z);
    m.done(p, [[low, low + TAU], [-0.8, 0.8]])
}

/// The pseudosphere (cos u/cosh v, sin u/cosh v, v − tanh v), v ∈ [0.01, 20].
#[allow(dead_code)]
pub(crate) fn pseudosphere() -> ParametricSurface {
    let mut m = Maker::new();
    let cosh = m.f(Unary::Cosh, m.v);
    let one = m.c(1.0);
    let r = m.g.div(one, cosh);
    let tanh = m.f(Unary::Tanh, m.v);
    let v = m.v;
    let z = m.g.sub(v, tanh);
    let u = m.u;
    let p = m.around(r, u, z);
    m.done(p, [[0.0, TAU], [0.01, 20.0]])
}

/// The pseudosphere (sin v cos u, sin v sin u, cos v + log tan v/2) to its rim v = π/2, which is a cuspidal edge.
#[allow(dead_code)]
pub(crate) fn pseudosphere_to_rim() -> ParametricSurface {
    let mut m = Maker::new();
    let (u, v) = (m.u, m.v);
    let half = m.scale(0.5, v);
    let tan = m.f(Unary::Tan, half);
    let log = m.f(Unary::Log, tan);
    let cosine = m.f(Unary::Cos, v);
    let z = m.add(cosine, log);
    let r = m.f(Unary::Sin, v);
    let p = m.around(r, u, z);
    m.done(p, [[0.0, TAU], [0.05, 0.5 * PI]])
}

/// The cross-cap (sin u sin 2v/2, sin 2u cos² v, cos 2u cos² v) with u from `low` over a half turn. For `low` = 0 the sides of
/// constant u are the segment in which it meets itself.
#[allow(dead_code)]
pub(crate) fn cross_cap(low: f64) -> ParametricSurface {
    let mut m = Maker::new();
    let (u, v) = (m.u, m.v);
    let [two_u, two_v] = [u, v].map(|x| m.scale(2.0, x));
    let [sin, sin_twice] = [u, two_v].map(|x| m.f(Unary::Sin, x));
    let cosine = m.f(Unary::Cos, v);
    let x = m.mul(sin, sin_twice);
    let x = m.scale(0.5, x);
    let square = m.mul(cosine, cosine);
    let [along, across] = [Unary::Sin, Unary::Cos].map(|op| m.f(op, two_u));
    let (y, z) = (m.mul(along, square), m.mul(across, square));
    m.done([x, y, z], [[low, low + PI], [-0.5 * PI, 0.5 * PI]])
}

/// The cuspidal edge (u², u³, v).
#[allow(dead_code)]
pub(crate) fn cuspidal() -> ParametricSurface {
    let mut m = Maker::new();
    let u = m.u;
    let a = m.mul(u, u);
    let b = m.mul(a, u);
    let v = m.v;
    m.done([a, b, v], [[-1.0, 1.0], [-1.0, 1.0]])
}

/// A sphere with height as its second parameter: (√(1−v²) cos u, √(1−v²) sin u, v).
#[allow(dead_code)]
pub(crate) fn sphere_by_height() -> ParametricSurface {
    let mut m = Maker::new();
    let v = m.v;
    let square = m.mul(v, v);
    let one = m.c(1.0);
    let rest = m.g.sub(one, square);
    let r = m.f(Unary::Sqrt, rest);
    let u = m.u;
    let p = m.around(r, u, v);
    m.done(p, [[0.0, TAU], [-1.0, 1.0]])
}

/// The upper half of the unit sphere as a graph over its disc: σu and σv grow without bound at the rim.
#[allow(dead_code)]
pub(crate) fn dome() -> ParametricSurface {
    let mut m = Maker::new();
    let (u, v) = (m.u, m.v);
    let (uu, vv) = (m.mul(u, u), m.mul(v, v));
    let sum = m.add(uu, vv);
    let one = m.c(1.0);
    let rest = m.g.sub(one, sum);
    let z = m.f(Unary::Sqrt, rest);
    m.done([u, v, z], [[-1.0, 1.0], [-1.0, 1.0]])
}

/// The sphere of radius `size` with u and v in units of `unit` radians, sheared: longitude u + shear·v.
#[allow(dead_code)]
pub(crate) fn sphere_in_units(unit: f64, size: f64, shear: f64) -> ParametricSurface {
    let mut m = Maker::new();
    let unit_node = m.c(unit);
    let (u, v) = (m.u, m.v);
    let latitude = m.g.div(v, unit_node);
    let longitude = m.g.div(u, unit_node);
    let skew = m.scale(shear, latitude);
    let longitude = m.add(longitude, skew);
    let (cos, sin) = (m.f(Unary::Cos, latitude), m.f(Unary::Sin, latitude));
    let p = m.around(cos, longitude, sin);
    let p = p.map(|x| m.scale(size, x));
    m.done(p, [[0.0, TAU * unit], [-PI / 2.0 * unit, PI / 2.0 * unit]])
}

/// The plane, (eᵛ cos u, eᵛ sin u, 0).
#[allow(dead_code)]
pub(crate) fn log_polar() -> ParametricSurface {
    let mut m = Maker::new();
    let r = m.f(Unary::Exp, m.v);
    let zero = m.c(0.0);
    let u = m.u;
    let p = m.around(r, u, zero);
    m.done(p, [[0.0, TAU], [-20.0, 6.0]])
}

/// The catenoid (cosh v cos u, cosh v sin u, v).
#[allow(dead_code)]
pub(crate) fn catenoid() -> ParametricSurface {
    let mut m = Maker::new();
    let r = m.f(Unary::Cosh, m.v);
    let (u, v) = (m.u, m.v);
    let p = m.around(r, u, v);
    m.done(p, [[0.0, TAU], [-10.0, 10.0]])
}

/// The helicoid (sinh v cos u, sinh v sin u, u), which the catenoid bends into.
#[allow(dead_code)]
pub(crate) fn helicoid() -> ParametricSurface {
    let mut m = Maker::new();
    let cosh = m.f(Unary::Cosh, m.v);
    let tanh = m.f(Unary::Tanh, m.v);
    let r = m.mul(cosh, tanh);
    let u = m.u;
    let p = m.around(r, u, u);
    m.done(p, [[-50.0, 50.0], [-10.0, 10.0]])
}

/// The graph of 0.1 sin 20u sin 20v.
#[allow(dead_code)]
pub(crate) fn bumps() -> ParametricSurface {
    let mut m = Maker::new();
    let (a, b) = (m.scale(20.0, m.u), m.scale(20.0, m.v));
    let (a, b) = (m.f(Unary::Sin, a), m.f(Unary::Sin, b));
    let p = m.mul(a, b);
    let z = m.scale(0.1, p);
    let (u, v) = (m.u, m.v);
    m.done([u, v, z], [[-5.0, 5.0], [-5.0, 5.0]])
}

/// The bottle of Klein that a figure of eight sweeps, turning by half a turn on its way round. Over `turns` of
/// 2·2π it is covered twice and wraps without a flip.
#[allow(dead_code)]
pub(crate) fn klein(turns: f64) -> ParametricSurface {
    let mut m = Maker::new();
    let half = m.scale(0.5, m.u);
    let (cos, sin) = (m.f(Unary::Cos, half), m.f(Unary::Sin, half));
    let double = m.scale(2.0, m.v);
    let (s, t) = (m.f(Unary::Sin, m.v), m.f(Unary::Sin, double));
    let (cs, st) = (m.mul(cos, s), m.mul(sin, t));
    let out = m.g.sub(cs, st);
    let radius = m.plus(2.5, out);
    let (ss, ct) = (m.mul(sin, s), m.mul(cos, t));
    let z = m.add(ss, ct);
    let u = m.u;
    let p = m.around(radius, u, z);
    m.done(p, [[0.0, turns], [0.0, TAU]])
}

/// The plane as (√u, v), u ≥ `low`.
#[allow(dead_code)]
pub(crate) fn root_plane(low: f64) -> ParametricSurface {
    let mut m = Maker::new();
    let x = m.f(Unary::Sqrt, m.u);
    let (v, zero) = (m.v, m.c(0.0));
    m.done([x, v, zero], [[low, 4.0], [-300.0, 300.0]])
}

/// The plane (u, v, 0), undefined for u < 0: 0 is written as 2√u − 2√u, moved off the edge by 10⁻³⁰⁰.
#[allow(dead_code)]
pub(crate) fn walled_plane() -> ParametricSurface {
    let mut m = Maker::new();
    let shifted = m.plus(1e-300, m.u);
    let root = m.f(Unary::Sqrt, shifted);
    let other = m.scale(2.0, root);
    let twice = m.add(root, root);
    let zero = m.g.sub(twice, other);
    let (u, v) = (m.u, m.v);
    m.done([u, v, zero], [[0.0, 4.0], [-300.0, 300.0]])
}

/// A metric by three expressions.
#[allow(dead_code)]
pub(crate) fn metric(
    domain: [[f64; 2]; 2],
    form: impl FnOnce(&mut Maker) -> [NodeId; 3],
) -> MetricSurface {
    let mut m = Maker::new();
    let form = form(&mut m);
    MetricSurface::new(&m.g, form, domain, &[]).expect("small expressions")
}

/// The half-plane of curvature −1: (du² + dv²)/v².
#[allow(dead_code)]
pub(crate) fn half_plane() -> MetricSurface {
    metric([[-1e6, 1e6 + 1.0], [1e-9, 1e9]], |m| {
        let one = m.c(1.0);
        let square = m.mul(m.v, m.v);
        let e = m.g.div(one, square);
        let zero = m.c(0.0);
        [e, zero, e]
    })
}

/// The disc of curvature −1: 4(du² + dv²)/(1 − u² − v²)², on a square around it.
#[allow(dead_code)]
pub(crate) fn poincare_disc() -> MetricSurface {
    metric([[-1.0, 1.0], [-1.0, 1.0]], |m| {
        let (uu, vv) = (m.mul(m.u, m.u), m.mul(m.v, m.v));
        let sum = m.add(uu, vv);
        let one = m.c(1.0);
        let rest = m.g.sub(one, sum);
        let square = m.mul(rest, rest);
        let four = m.c(4.0);
        let e = m.g.div(four, square);
        let zero = m.c(0.0);
        [e, zero, e]
    })
}

/// The Tannery–Zoll metric (1 + cos u/2)² du² + sin²u dv², all of whose geodesics close after 2π.
#[allow(dead_code)]
pub(crate) fn zoll() -> MetricSurface {
    metric([[0.0, PI], [0.0, TAU]], |m| {
        let cos = m.f(Unary::Cos, m.u);
        let half = m.scale(0.5, cos);
        let stretch = m.plus(1.0, half);
        let e = m.mul(stretch, stretch);
        let sin = m.f(Unary::Sin, m.u);
        let g = m.mul(sin, sin);
        let zero = m.c(0.0);
        [e, zero, g]
    })
}

/// The metric of the spheroid with the axes a, a, b in longitude and latitude, or of another chart of it:
/// longitude u + shear·v.
#[allow(dead_code)]
pub(crate) fn spheroid_metric(a: f64, b: f64, shear: f64) -> MetricSurface {
    metric([[0.0, TAU], [-PI / 2.0, PI / 2.0]], |m| {
        let (cos, sin) = (m.f(Unary::Cos, m.v), m.f(Unary::Sin, m.v));
        let (cc, ss) = (m.mul(cos, cos), m.mul(sin, sin));
        let e = m.scale(a * a, cc);
        let (x, y) = (m.scale(a * a, ss), m.scale(b * b, cc));
        let along = m.add(x, y);
        let f = m.scale(shear, e);
        let skew = m.scale(shear * shear, e);
        let g = m.add(along, skew);
        [e, f, g]
    })
}

/// The unit sphere by stereographic projection, far out: infinity is its pole.
#[allow(dead_code)]
pub(crate) fn stereographic() -> ParametricSurface {
    let mut m = Maker::new();
    let (uu, vv) = (m.mul(m.u, m.u), m.mul(m.v, m.v));
    let sum = m.add(uu, vv);
    let below = m.plus(1.0, sum);
    let above = m.plus(-1.0, sum);
    let (x, y) = (m.scale(2.0, m.u), m.scale(2.0, m.v));
    let p = [x, y, above].map(|w| m.g.div(w, below));
    m.done(p, [[-1e6, 1e6], [-1e6, 1e6]])
}

/// (|x| + x)/2.
fn positive_part(m: &mut Maker, x: NodeId) -> NodeId {
    let abs = m.f(Unary::Abs, x);
    let twice = m.add(abs, x);
    m.scale(0.5, twice)
}

/// The plane, rising with a slope for u > 0: a crease at u = 0.
#[allow(dead_code)]
pub(crate) fn bent_plane(slope: f64) -> ParametricSurface {
    folded_plane(0.0, slope)
}

/// The plane, rising with u − tilt·v where that is positive.
#[allow(dead_code)]
pub(crate) fn folded_plane(tilt: f64, slope: f64) -> ParametricSurface {
    let mut m = Maker::new();
    let (u, v) = (m.u, m.v);
    let across = m.scale(-tilt, v);
    let across = m.add(u, across);
    let part = positive_part(&mut m, across);
    let z = m.scale(slope, part);
    m.done([u, v, z], [[-5.0, 5.0], [-5.0, 5.0]])
}

/// The roof z = slope·|u|.
#[allow(dead_code)]
pub(crate) fn roof(slope: f64) -> ParametricSurface {
    let mut m = Maker::new();
    let (u, v) = (m.u, m.v);
    let abs = m.f(Unary::Abs, u);
    let z = m.scale(slope, abs);
    m.done([u, v, z], [[-5.0, 5.0], [-5.0, 5.0]])
}

/// The graph of Σ a sin(bu + cv) for waves [a, b, c], torn where its square root of a wave is undefined if asked for.
#[allow(dead_code)]
pub(crate) fn waves_over_plane(waves: &[[f64; 3]], torn: bool, half: f64) -> ParametricSurface {
    let mut m = Maker::new();
    let (u, v) = (m.u, m.v);
    let mut z = m.c(0.0);
    for &[a, b, c] in waves {
        let (x, y) = (m.scale(b, u), m.scale(c, v));
        let phase = m.add(x, y);
        let sin = m.f(Unary::Sin, phase);
        let wave = m.scale(a, sin);
        z = m.add(z, wave);
    }
    if torn {
        let shifted = m.plus(2.0, z);
        z = m.f(Unary::Sqrt, shifted);
    }
    m.done([u, v, z], [[-half, half]; 2])
}

/// The plane, (u³, v, 0): σu is 0 on the line u = 0.
#[allow(dead_code)]
pub(crate) fn cubed_plane() -> ParametricSurface {
    let mut m = Maker::new();
    let square = m.mul(m.u, m.u);
    let cube = m.mul(square, m.u);
    let zero = m.c(0.0);
    let v = m.v;
    m.done([cube, v, zero], [[-1.0, 1.0], [-1.0, 1.0]])
}

/// A sheet with 200 waves, (u, v, sin(400πu)/100).
#[allow(dead_code)]
pub(crate) fn ripple() -> ParametricSurface {
    let mut m = Maker::new();
    let (u, v) = (m.u, m.v);
    let phase = m.scale(200.0 * TAU, u);
    let wave = m.f(Unary::Sin, phase);
    let height = m.scale(0.01, wave);
    m.done([u, v, height], [[0.0, 1.0], [0.0, 1.0]])
}

/// A plane with the height max(0, slope (width − f)) over it, f an expression in u and v.
#[allow(dead_code)]
pub(crate) fn creased(
    width: f64,
    slope: f64,
    f: impl FnOnce(&mut Maker) -> NodeId,
) -> ParametricSurface {
    let mut m = Maker::new();
    let f = f(&mut m);
    let f = m.scale(-1.0, f);
    let height = m.plus(width, f);
    let height = m.scale(slope, height);
    let zero = m.c(0.0);
    let z = m.g.binary(Binary::Max, zero, height);
    let (u, v) = (m.u, m.v);
    m.done([u, v, z], [[-2.0, 2.0]; 2])
}

/// |u − 0.5|.
#[allow(dead_code)]
pub(crate) fn off_line(m: &mut Maker) -> NodeId {
    let off = m.plus(-0.5, m.u);
    m.f(Unary::Abs, off)
}

/// The distance from (0.5, 0.13).
#[allow(dead_code)]
pub(crate) fn off_point(m: &mut Maker) -> NodeId {
    let (x, y) = (m.plus(-0.5, m.u), m.plus(-0.13, m.v));
    let (xx, yy) = (m.mul(x, x), m.mul(y, y));
    let square = m.add(xx, yy);
    m.f(Unary::Sqrt, square)
}
