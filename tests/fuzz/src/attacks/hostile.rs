//! Programs that are meant badly: random metrics, and texts without bounds.

use crate::mutation::Random;
use crate::run::Report;
use crate::targets;

const NUMBERS: &[&str] = &[
    "0", "1", "-1", "2", "0.5", "pi", "1e-200", "1e180", "1e-9", "1e9", "(1/0)",
];
const DOMAINS: &[&str] = &[
    "[0, 1]",
    "[-1, 1]",
    "[0, 2pi]",
    "[-pi/2, pi/2]",
    "[1e-3, 1]",
    "[-1e150, 1e150]",
    "[0, 1e-150]",
];

/// A random expression in u and v.
fn expression(random: &mut Random, depth: usize) -> String {
    if depth == 0 {
        return match random.below(3) {
            0 => random.choose(NUMBERS).to_owned(),
            1 => "u".to_owned(),
            _ => "v".to_owned(),
        };
    }
    let a = expression(random, depth - 1);
    let form = random.choose(&[
        "sum", "product", "quotient", "power", "function", "function", "greater",
    ]);
    match form {
        "power" => format!(
            "({a})^{}",
            ["2", "3", "(1/2)", "(-1)", "u"][random.below(5)]
        ),
        "function" => {
            let functions = ["sin", "cos", "tan", "exp", "ln", "sqrt", "abs", "atan"];
            format!("{}({a})", random.choose(&functions))
        }
        _ => {
            let depth = random.below(depth);
            let b = expression(random, depth);
            match form {
                "sum" => format!("({a} + {b})"),
                "product" => format!("({a})*({b})"),
                "quotient" => format!("({a})/({b})"),
                _ => format!("max({a}, {b})"),
            }
        }
    }
}

/// A program with a random metric or, with `surfaces`, sometimes a surface, called `s`. Half of the metrics are positive
/// wherever they are defined.
pub(super) fn program(random: &mut Random, surfaces: bool) -> String {
    let part = |random: &mut Random| {
        let depth = random.below(4);
        expression(random, depth)
    };
    let [a, b, c] = [part(random), part(random), part(random)];
    let [u, v] = [random.choose(DOMAINS), random.choose(DOMAINS)];
    let domain = format!("u : {u}, v : {v};\n");
    match random.below(4) {
        0 if surfaces => format!("surface s(u,v) = ({a}, {b}, {c}), {domain}"),
        1 if surfaces => format!("surface s(u,v) = (u, v, {a}), {domain}"),
        0 | 1 => format!("metric s(u,v) = (1 + ({a})^2, 0, 1 + ({b})^2), {domain}"),
        2 => format!("metric s(u,v) = (({a})^2, 0, ({b})^2), {domain}"),
        _ => format!("metric s(u,v) = ({a}, {b}, {c}), {domain}"),
    }
}

/// Checks random metrics and draws them from inside.
pub(super) fn metrics(seed: u64, count: u64) -> Report {
    let mut random = Random::new(seed);
    let mut report = Report::default();
    for _ in 0..count {
        if report.is_hopeless() {
            break;
        }
        let program = program(&mut random, false);
        report.attempt(program.as_bytes(), || {
            targets::read_and_draw(program.as_bytes());
            0
        });
    }
    report
}

/// Declarations that each have a number.
fn each(count: usize, one: impl Fn(usize) -> String) -> String {
    (0..count).map(one).collect()
}

fn overlapping_solids() -> String {
    each(5_000, |k| {
        format!("solid s{k}(x,y,z) = x^2 + (y - {k}/5000)^2 + z^2 - 1;\n")
    })
}

const SPHERE: &str =
    "surface s(u,v) = (cosv cosu, cosv sinu, sinv), u : [0, 2pi], v : [-pi/2, pi/2];\n";

/// A program without bounds: its name, and its text.
pub(super) type Huge = (&'static str, fn() -> String);

/// Programs without bounds.
pub(super) const HUGE: &[Huge] = &[
    ("declarations", || {
        each(100_000, |k| format!("define a{k} = {k};\n"))
    }),
    ("uses", || {
        format!(
            "define a0 = 1;\n{}",
            each(20_000, |k| format!("define a{} = a{k} + 1;\n", k + 1))
        )
    }),
    ("repeated", || "define a = 1;\n".repeat(100_000)),
    ("brackets", || {
        format!(
            "define a = {}1{};",
            "(".repeat(100_000),
            ")".repeat(100_000)
        )
    }),
    ("open brackets", || {
        format!("define a = {}", "(".repeat(100_000))
    }),
    ("closed brackets", || {
        format!("define a = 1{};", ")".repeat(100_000))
    }),
    ("intervals", || "[0, 1] ".repeat(100_000)),
    ("functions", || {
        format!("define a = {}1;", "sin ".repeat(100_000))
    }),
    ("exponents", || {
        format!("define a = 2{};", "^2".repeat(100_000))
    }),
    ("negations", || {
        format!("define a = {}1;", "-".repeat(100_000))
    }),
    ("terms", || {
        format!("define a = 0{};", " + 1".repeat(200_000))
    }),
    ("factors", || {
        format!("define a = {}1;", "2 ".repeat(200_000))
    }),
    ("quotients", || {
        format!("define a = 1{};", "/2".repeat(100_000))
    }),
    ("word", || format!("define a = {};", "pi".repeat(500_000))),
    ("name", || format!("define {} = 1;", "a".repeat(1_000_000))),
    ("number", || {
        format!("define a = {};", "9".repeat(1_000_000))
    }),
    ("digits", || {
        format!("define a = 0.{}1;", "0".repeat(1_000_000))
    }),
    ("semicolons", || ";".repeat(1_000_000)),
    ("NUL", || "\0".repeat(1_000_000)),
    ("comment", || {
        format!("# {}\n{SPHERE}", "x".repeat(5_000_000))
    }),
    ("comments", || format!("{}{SPHERE}", "#\n".repeat(500_000))),
    ("line", || "point p = (1, 2, 3); ".repeat(200_000)),
    ("errors", || "define = ;\n".repeat(20_000)),
    ("undefined names", || {
        each(20_000, |k| format!("define a{k} = b{k};\n"))
    }),
    ("bytes of four", || "𝛼".repeat(250_000)),
    ("byte order marks", || "\u{FEFF}".repeat(300_000)),
    ("carriage returns", || "\r".repeat(1_000_000)),
    ("doublings", || {
        format!(
            "function f0(x) = x + x;\n{}point p = (f59(1), 0, 0);\n",
            each(59, |k| format!("function f{}(x) = f{k}(f{k}(x));\n", k + 1))
        )
    }),
    ("squares", || {
        format!(
            "define a0 = 2;\n{}",
            each(200, |k| format!("define a{} = a{k} a{k};\n", k + 1))
        )
    }),
    ("sums of sums", || {
        format!(
            "define a0 = 1;\n{}",
            each(2_000, |k| format!("define a{} = a{k} + a{k};\n", k + 1))
        )
    }),
    ("primes", || {
        format!(
            "function f(x) = x^2/(1 + exp x);\npoint p = (f{}(1), 0, 0);\n",
            "'".repeat(1_000)
        )
    }),
    ("few primes", || {
        format!(
            "function f(x) = 1/(1 + x^2);\npoint p = (f{}(1), 0, 0);\n",
            "'".repeat(100)
        )
    }),
    ("partials", || {
        format!(
            "function f(u,v) = sin(u v);\npoint p = (f_{}(1, 2), 0, 0);\n",
            "u".repeat(1_000)
        )
    }),
    ("arguments", || {
        format!(
            "function f({}) = 1;\n",
            each(5_000, |k| format!("x{k}, ")) + "y"
        )
    }),
    ("params", || {
        each(10_000, |k| format!("param p{k} : [0, 1];\n"))
    }),
    ("a param's parts", || {
        format!("param p : {}[0, 1];\n", "[0, 1], ".repeat(5_000))
    }),
    ("grids", || {
        each(30, |k| format!("grid g{k} : [0, 1, 10];\n"))
            + &format!(
                "point p = ({}, 0, 0);\n",
                each(29, |k| format!("g{k} + ")) + "g29"
            )
    }),
    ("a large grid", || {
        "grid g : [0, 1, 1000000000];\npoint p = (g, 0, 0);\n".to_owned()
    }),
    ("three grids", || {
        "grid a : [0, 1, 1000]; grid b : [0, 1, 1000]; grid c : [0, 1, 1000];\npoint p = (a, b, c);\n".to_owned()
    }),
    ("samples", || {
        "surface s(u,v) = (u, v, u v), u : [0, 1, 100000], v : [0, 1, 100000];\n".to_owned()
    }),
    ("a curve's samples", || {
        "curve c(t) = (t, 0, 0), t : [0, 1, 1000000000];\n".to_owned()
    }),
    ("far away", || {
        "surface s(u,v) = (u, v, u), u : [-1e308, 1e308], v : [-1e308, 1e308];\n".to_owned()
    }),
    ("nearby", || {
        "surface s(u,v) = (u, v, u), u : [0, 1e-308], v : [0, 1e-308];\n".to_owned()
    }),
    ("no length", || {
        "surface s(u,v) = (u, v, u), u : [1, 1], v : [0, 0];\n".to_owned()
    }),
    ("surfaces", || {
        each(300, |k| {
            SPHERE.replace("surface s", &format!("surface s{k}"))
        })
    }),
    ("points", || {
        each(20_000, |k| format!("point p{k} = ({k}, 0, 0);\n"))
    }),
    ("vectors", || {
        each(5_000, |k| {
            format!("vector v{k} = ({k}, 0, 0) @ (0, 0, 0);\n")
        })
    }),
    ("curves", || {
        each(1_000, |k| {
            format!("curve c{k}(t) = (t, {k}, 0), t : [0, 1];\n")
        })
    }),
    ("geodesics", || {
        SPHERE.to_owned()
            + &each(1_000, |k| {
                format!("geodesic g{k}(t) : s = (1, 0) @ ({k}, 0), t : [0, 6];\n")
            })
    }),
    ("a long geodesic", || {
        format!("{SPHERE}geodesic g(t) : s = (1, 1) @ (0, 0), t : [0, 1e6];\n")
    }),
    ("solids", || {
        each(200, |k| {
            format!("solid s{k}(x,y,z) = x^2 + y^2 + (z - {k})^2 - 1;\n")
        })
    }),
    ("a union", || {
        each(500, |k| {
            format!("solid s{k}(x,y,z) = x^2 + y^2 + (z - {k})^2 - 1;\n")
        }) + &format!(
            "solid t = {};\n",
            each(499, |k| format!("s{k} | ")) + "s499"
        )
    }),
    ("overlapping solids", overlapping_solids),
    ("a long tree", || {
        overlapping_solids()
            + &format!(
                "solid t = s0{};\n",
                each(4_999, |k| format!(" \\ s{}", k + 1))
            )
    }),
    ("lights", || {
        "solid s(x,y,z) = x^2 + y^2 + z^2 - 1;\n".to_owned()
            + &each(10_000, |k| format!("light l{k} = ({k}, 1, 5);\n"))
    }),
    ("a function without bounds", || {
        "solid s(x,y,z) = x^21/0 + y^2 + z^2 - 1;\n".to_owned()
    }),
    ("a wave", || "solid s(x,y,z) = sin(1e9 x);\n".to_owned()),
    ("waves", || {
        each(15_000, |k| {
            format!("solid s{k}(x,y,z) = x^2 + y^2 + z^2 + sin({k} x y) - 1;\n")
        })
    }),
    ("powers", || {
        each(20_000, |k| {
            format!("solid s{k}(x,y,z) = (x + 2y + 3z + {k})^12 - 1;\n")
        })
    }),
    ("a million leaves", || {
        let grids = "grid a : [0, 98, 99]; grid b : [0, 99, 100]; grid c : [0, 99, 100];\n";
        let ball = "solid s(x,y,z) = x^2 + y^2 + z^2 - 0.1;\n";
        format!("{grids}{ball}solid all = s @ (a, b, c);\n")
    }),
    ("a million cuts", || {
        let grids = "grid a : [0, 98, 99]; grid b : [0, 99, 100]; grid c : [0, 99, 100];\n";
        let wave = "solid s(x,y,z) = x^2 + sin(y) + z^2 - 0.1, y : [-1, 1];\n";
        format!("{grids}{wave}solid all = s @ (a, b, c);\n")
    }),
    ("a hundred thousand radii", || {
        "grid r : [1, 2, 100000]; solid s(x,y,z) = x^2 + y^2 + z^2 - r;\n".to_owned()
    }),
    ("a waving surface", || {
        "surface s(u,v) = (u, v, sin(1e6 u v)), u : [-1, 1], v : [-1, 1];\n".to_owned()
    }),
    ("a high degree", || {
        "solid s(x,y,z) = x^60 + y^60 + z^60 - 1;\n".to_owned()
    }),
    ("a field", || {
        format!("solid s(x,y,z) = {}x - 1;\n", "sin ".repeat(200))
    }),
    ("a waving metric", || {
        "metric s(u,v) = (1 + sin(1e6 u)^2, 0, 1 + cos(1e6 v)^2), u : [0, 1], v : [0, 1];\n"
            .to_owned()
    }),
    ("a hostile metric", || {
        "metric s(u,v) = (1e-200+((v)(-v))^2, 0, abs(1/(u-0.5)+u/pi)), u : [0,1], v : [-1,1];\n"
            .to_owned()
    }),
];
