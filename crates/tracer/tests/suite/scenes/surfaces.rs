//! Implicit surfaces of the literature, and some that are hard to find.

use expr::ops::{Binary, Unary};

use super::Formula;

/// Name, expression, and half the side of the cube that cuts it.
pub type Surface = (&'static str, Formula, f64);

/// The surfaces over x, y, z.
pub fn surfaces(xyz: &[Formula; 3]) -> Vec<Surface> {
    let mut all = algebraic(xyz);
    all.extend(transcendental(xyz));
    all
}

fn algebraic([x, y, z]: &[Formula; 3]) -> Vec<Surface> {
    let [xx, yy, zz] = &[x.squared(), y.squared(), z.squared()];
    let rr = &(xx + yy);
    let r2 = &(rr + zz);
    let phi = (1.0 + 5.0f64.sqrt()) / 2.0;
    let p2 = phi * phi;
    let p4 = p2 * p2;
    let barth = 4.0 * (p2 * xx - yy) * (p2 * yy - zz) * (p2 * zz - xx)
        - (1.0 + 2.0 * phi) * (r2 - 1.0).squared();
    let decic = 8.0
        * (xx - p4 * yy)
        * (yy - p4 * zz)
        * (zz - p4 * xx)
        * (x.powi(4) + y.powi(4) + z.powi(4) - 2.0 * xx * yy - 2.0 * xx * zz - 2.0 * yy * zz)
        + (3.0 + 5.0 * phi) * (r2 - 1.0).squared() * (r2 - (2.0 - phi)).squared();
    let klein = (r2 + 2.0 * y - 1.0) * ((r2 - 2.0 * y - 1.0).squared() - 8.0 * zz)
        + 16.0 * x * z * (r2 - 2.0 * y - 1.0);
    let w = &(1.0 - z);
    let root = 2.0f64.sqrt();
    let boy = 64.0 * w.powi(3) * z.powi(3) - 48.0 * w.squared() * zz * (3.0 * rr + 2.0 * zz)
        + 12.0
            * w
            * z
            * (27.0 * rr.squared() - 24.0 * zz * rr
                + 36.0 * root * y * z * (yy - 3.0 * xx)
                + 4.0 * z.powi(4))
        + (9.0 * rr - 2.0 * zz)
            * (-81.0 * rr.squared() - 72.0 * zz * rr
                + 108.0 * root * x * z * (xx - 3.0 * yy)
                + 4.0 * z.powi(4));
    let mu = 1.3f64 * 1.3;
    let lambda = (3.0 * mu - 1.0) / (3.0 - mu);
    let kummer = (r2 - mu).squared()
        - lambda
            * (1.0 - z - root * x)
            * (1.0 - z + root * x)
            * (1.0 + z + root * y)
            * (1.0 + z - root * y);
    let chebyshev = |x: &Formula| {
        let xx = &x.squared();
        32.0 * xx.powi(3) - 48.0 * xx.squared() + 18.0 * xx - 1.0
    };
    let chair = (r2 - 0.95 * 25.0).squared()
        - 0.8 * ((z - 5.0).squared() - 2.0 * xx) * ((z + 5.0).squared() - 2.0 * yy);
    let clebsch = 81.0 * (x.powi(3) + y.powi(3) + z.powi(3))
        - 189.0 * (xx * y + xx * z + yy * x + yy * z + zz * x + zz * y)
        + 54.0 * x * y * z
        + 126.0 * (x * y + x * z + y * z)
        - 9.0 * r2
        - 9.0 * (x + y + z)
        + 1.0;
    let decocube = ((rr - 0.64).squared() + (zz - 1.0).squared())
        * ((yy + zz - 0.64).squared() + (xx - 1.0).squared())
        * ((zz + xx - 0.64).squared() + (yy - 1.0).squared())
        - 0.02;
    vec![
        (
            "tanglecube",
            x.powi(4) + y.powi(4) + z.powi(4) - 5.0 * r2 + 11.8,
            4.0,
        ),
        ("Barth sextic", barth, 2.0),
        ("Barth decic", decic, 1.5),
        ("Klein bottle", klein, 5.0),
        ("Boy", boy, 2.0),
        ("Kummer", kummer, 2.5),
        (
            "Chmutov",
            chebyshev(x) + chebyshev(y) + chebyshev(z) + 1.0,
            1.2,
        ),
        ("chair", chair, 6.0),
        ("Clebsch cubic", clebsch, 2.0),
        ("Cayley cubic", 4.0 * r2 + 16.0 * x * y * z - 1.0, 1.0),
        ("Steiner", xx * yy + yy * zz + zz * xx - x * y * z, 1.0),
        ("decocube", decocube, 1.4),
        (
            "heart",
            (2.25 * xx + yy + zz - 1.0).powi(3) - (xx + 0.09 * yy) * z.powi(3),
            1.5,
        ),
        ("torus", (rr.sqrt() - 1.0).squared() + zz - 0.1, 1.5),
        (
            "cyclide",
            (r2 - 2.0).squared() - 4.0 * (x - 1.5).squared() * 0.6 - 3.0 * yy,
            4.0,
        ),
        (
            "hunt",
            4.0 * (r2 - 13.0).powi(3) + 27.0 * (3.0 * xx + yy - 4.0 * zz - 12.0).squared(),
            4.0,
        ),
        ("thin shell", (r2.sqrt() - 1.0).abs() - 1e-3, 1.2),
    ]
}

fn transcendental([x, y, z]: &[Formula; 3]) -> Vec<Surface> {
    let r2 = &(x.squared() + y.squared() + z.squared());
    let power = |x: &Formula| x.abs().binary(Binary::Pow, &x.number(2.5));
    let (sx, sy, sz) = (&x.sin(), &y.sin(), &z.sin());
    let (cx, cy, cz) = (&x.cos(), &y.cos(), &z.cos());
    let blob = |a: f64, b: f64| -> Formula {
        (-2.0 * ((x - a).squared() + (y - b).squared() + z.squared())).exp()
    };
    let waves = (8.0 * x).sin() * (8.0 * y).sin() * (8.0 * z).sin();
    let turned = (x * cz - y * sz).abs().max(&(x * sz + y * cz).abs());
    vec![
        ("gyroid", sx * cy + sy * cz + sz * cx, 4.0),
        (
            "thin gyroid",
            (sx * cy + sy * cz + sz * cx).abs() - 1e-3,
            4.0,
        ),
        ("Schwarz P", cx + cy + cz, 4.0),
        (
            "Schwarz D",
            sx * sy * sz + sx * cy * cz + cx * sy * cz + cx * cy * sz,
            4.0,
        ),
        ("Neovius", 3.0 * (cx + cy + cz) + 4.0 * cx * cy * cz, 4.0),
        ("superellipsoid", power(x) + power(y) + power(z) - 1.0, 1.2),
        ("step", r2 - 1.0 + 1e-3 * x.unary(Unary::Sign), 1.2),
        (
            "metaballs",
            0.4 - blob(0.7, 0.0) - blob(-0.7, 0.0) - blob(0.0, 0.9),
            2.0,
        ),
        ("waves on a ball", r2.sqrt() - 1.0 - 0.1 * waves, 1.4),
        (
            "twisted bar",
            turned.max(&z.abs().binary(Binary::Sub, &x.number(3.0))) - 0.5,
            3.6,
        ),
        ("tangents", (0.5 * x).unary(Unary::Tan) + y * z - 0.3, 3.0),
        (
            "funnel",
            z - (x.squared() + y.squared()).unary(Unary::Log),
            2.0,
        ),
        (
            "arcs",
            x.unary(Unary::Asin) + y.unary(Unary::Acos) - 1.5 - 0.2 * z,
            1.2,
        ),
        ("sinc", z - (3.0 * r2.sqrt()).sin() / (3.0 * r2.sqrt()), 2.0),
        ("tiny", r2 * 1e6 - 1.0, 1.0),
    ]
}
