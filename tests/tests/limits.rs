//! `docs/limits.md`: the limits that a user can meet, each once, from the constants of the code.

use export::animation::MOST_FRAMES;
use export::command_line::MOST_PLACES;
use export::mesh::{MAX_MESH_WORK, MOST_CELLS, USUAL_CELLS};
use geodesic::fan::MOST_FOR_RAYS;
use geodesic::map::{LEAST_FOR_PIXEL, MOST_FOR_PIXEL, MapOptions};
use geodesic::measure::MOST_CONNECTIONS;
use geodesic::trace::MOST_OF_ONE;
use geometry::solids::MAX_SHAPE_WORK;
use render::texture::{self, MAX_FILE_PIXELS, MAX_FILE_SIDE};
use render::view::traced;
use scene::crt;
use scene::limits;
use testing::examples::repository;

/// A limit.
struct Limit {
    what: &'static str,
    most: String,
    why: String,
    /// The message, as it stands in the sources; what is in braces is put in there. Empty where a limit has none.
    message: &'static str,
    /// How to raise it; empty where nobody needs to.
    raised: &'static str,
}

fn limit(
    what: &'static str,
    most: impl std::fmt::Display,
    why: impl Into<String>,
    message: &'static str,
    raised: &'static str,
) -> Limit {
    Limit {
        what,
        most: most.to_string(),
        why: why.into(),
        message,
        raised,
    }
}

/// A count with its digits in groups of three.
fn grouped(count: impl Into<u64>) -> String {
    let digits = count.into().to_string();
    let mut text = String::new();
    for (n, digit) in digits.chars().enumerate() {
        if n > 0 && (digits.len() - n).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

fn bytes(count: u64) -> String {
    format!("{} MB", count >> 20)
}

fn programs() -> Vec<Limit> {
    vec![
        limit(
            "the size of a program that is read from a file",
            bytes(ide::language::LONGEST_PROGRAM),
            "memory",
            "it is longer than {} MB",
            "",
        ),
        limit(
            "the length of a name, in characters",
            syntax::geotrace::symbols::MAX_NAME_LENGTH,
            "words are split into names",
            "a name has at most {MAX_NAME_LENGTH} characters",
            "",
        ),
        limit(
            "brackets within brackets, operators within operators",
            syntax::geotrace::parser::MAX_DEPTH,
            "the stack",
            "this is nested deeper than {MAX_DEPTH} levels",
            "name a part by a declaration of its own",
        ),
        limit(
            "diagnostics of a program",
            grouped(syntax::text::MAX_DIAGNOSTICS as u64),
            "memory, and nobody reads more",
            "more than {MAX_DIAGNOSTICS} diagnostics: the rest is omitted",
            "",
        ),
        limit(
            "operations of all expressions with their derivatives",
            grouped(expr::graph::DEFAULT_LIMIT as u64),
            "memory and run time: derivatives of derivatives multiply",
            "this expression, or a derivative in it, has more operations than a program may have",
            "",
        ),
        limit(
            "values of a grid along an axis",
            grouped(limits::MAX_AXIS),
            "memory",
            "the count of this interval is {}, and the limit is {largest}",
            "",
        ),
        limit(
            "instances of an object, the product of its grids",
            grouped(limits::MAX_INSTANCES),
            "memory",
            "would be drawn {times} times, and the limit is {MAX_INSTANCES}: {}",
            "",
        ),
        limit(
            "samples of all objects",
            grouped(limits::MAX_SAMPLES),
            "memory",
            "has {} samples{all}; the limit is {MAX_SAMPLES} in all",
            "",
        ),
        limit(
            "components of params and grids",
            grouped(limits::MAX_UNIFORMS),
            "what every GPU takes: 64 KiB",
            "the params and grids have {components} components, and the limit is {MAX_UNIFORMS}",
            "",
        ),
        limit(
            "leaves of all solids, instances included",
            grouped(limits::MAX_LEAVES),
            "memory",
            "this solid has {count} leaves, instances included, and the limit is {MAX_LEAVES}",
            "",
        ),
    ]
}

fn scripts() -> Vec<Limit> {
    vec![
        limit(
            "rounds of loops, calls and objects of a script, 256 bytes of a new string counted as one",
            grouped(crt::MAX_WORK),
            "so that a script ends",
            "it takes more than {} rounds, calls and objects",
            "",
        ),
        limit(
            "expressions and statements that a script evaluates, elements of compared lists counted as such",
            grouped(crt::MAX_STEPS),
            "so that a script ends within seconds",
            "it takes more than {} expressions and statements",
            "",
        ),
        limit(
            "calls within calls",
            crt::MAX_CALLS,
            "the stack",
            "calls within calls are limited to {MAX_CALLS}",
            "",
        ),
        limit(
            "levels of blocks, brackets and operators within each other, the expressions in them included",
            syntax::crt::parser::MAX_DEPTH,
            "the stack",
            "this is nested deeper than {MAX_DEPTH} levels",
            "give a part a name",
        ),
        limit(
            "expressions and statements within each other, over all calls",
            grouped(crt::MAX_NESTING),
            format!(
                "the stack; in a browser at most {}",
                grouped(crt::MAX_NESTING_IN_BROWSER)
            ),
            "expressions and statements within calls are nested too deeply here",
            "",
        ),
        limit(
            "elements of a list, bytes of a string",
            grouped(crt::MAX_SIZE),
            "memory",
            "a string has at most {MAX_SIZE} bytes",
            "",
        ),
        limit(
            "shapes of a script that is converted",
            grouped(crt::MAX_CONVERTED_LEAVES),
            "the length of the program",
            "{most} shapes, the limit of conversions",
            "",
        ),
    ]
}

fn pictures() -> Vec<Limit> {
    vec![
        limit(
            "a side of a picture, in pixels",
            grouped(render::MAX_SIDE),
            "memory; what GPUs draw",
            "each side is from 1 to {MAX_SIDE}",
            "",
        ),
        limit(
            "a side of an image, in pixels",
            grouped(MAX_FILE_SIDE),
            "memory: a small file may unpack to a large image",
            "and {MAX_FILE_SIDE} on a side",
            "",
        ),
        limit(
            "pixels of an image",
            grouped(MAX_FILE_PIXELS),
            format!(
                "as above; it is reduced where it has more than {} or a side of more than {}",
                grouped(texture::MAX_TEXELS),
                grouped(texture::MAX_SIDE)
            ),
            "is too large: it may have {} million pixels",
            "",
        ),
        limit(
            "texels of all images that a program shows; each has half of those that are left",
            grouped(texture::MAX_TOTAL_TEXELS),
            "memory: about a gigabyte; an image that has more is reduced",
            "",
            "",
        ),
        limit(
            "operations on intervals to find where the solids of a scene lie; a sixteenth of that for a hover text",
            grouped(MAX_SHAPE_WORK),
            "run time: a few seconds",
            "locating the solids exceeds the work limit",
            "fewer instances; move copies by maps after `@`: they are compiled once",
        ),
        limit(
            "cells along the longest side of a solid's mesh without counts; with more than 32 solids in a file fewer, so that the total number of triangles stays about the same",
            USUAL_CELLS,
            "memory and run time",
            "cells along its longest side, not {USUAL_CELLS}",
            "counts of intervals, `x : [-3, 3, 400]`; `--object`: fewer solids in a file",
        ),
        limit(
            "cells along the longest side of a solid's mesh with counts",
            MOST_CELLS,
            "memory: the corners of the cells take 128 MB, the triangles more",
            "cells along its longest side, the maximum",
            "intervals that cut the solid into smaller ones",
        ),
        limit(
            "operations on numbers to mesh the solids of a file, all together",
            grouped(MAX_MESH_WORK),
            "run time: half a minute",
            "meshing the solids exceeds the work limit",
            "fewer solids, or fewer cells; `--object`: fewer solids in a file",
        ),
        limit(
            "samples of a pixel in the traced view",
            grouped(traced::MAX_SAMPLES),
            "run time",
            "is not in",
            "`--samples`, up to this",
        ),
        limit(
            "cells between samples in which a curve or a surface may have a pole or a jump, of all its instances together; beyond, what is on both sides is joined",
            grouped(geometry::MOST_BREAK_CELLS),
            "run time",
            "",
            "shorter intervals",
        ),
        limit(
            "the size of a solid of a function that is not a polynomial of degree at most 2, in units of the scene; a larger one counts as unbounded, and one below 10⁻¹² may be missing",
            format!("2^{}", tracer::LARGEST_EXPONENT),
            "run time: its box is sought up to this size, and has a margin of 10⁻¹²",
            "",
            "another unit",
        ),
        limit(
            "parts of a ray on which a function other than a polynomial is bounded; the rest of the ray is sampled, and may lack crossings beyond some thousand",
            grouped(tracer::MOST_RAY_EVALUATIONS as u64),
            "run time",
            "exceeds the work limit: crossings may be missing",
            "",
        ),
        limit(
            "operations on functions other than polynomials, for a ray of an 8 × 8 tile on average; beyond, rays are sampled, and beyond twice as many they meet none",
            grouped(tracer::TILE_RAY_OPERATIONS),
            "run time",
            "exceeded the work limit: objects along them may be missing",
            "",
        ),
        limit(
            "parts of parametric surfaces that are halved for rays of the traced view and kept for others; beyond, they are halved for each ray",
            grouped(tracer::MOST_HALVED as u64),
            "memory: about 100 MB",
            "",
            "",
        ),
        limit(
            "operations on solids, lights and surfaces in a 3D picture, or in a sample of a traced one, besides those for its pixels",
            grouped(render::MOST_OPERATIONS),
            "run time: seconds",
            "the picture exceeds the work limit",
            "a smaller `--size`; `--max-operations` for a traced picture",
        ),
        limit(
            "the same, more for each pixel of a 3D picture, and of a traced one",
            format!(
                "{}, {}",
                grouped(render::MOST_SPACE_PIXEL_OPERATIONS),
                grouped(render::MOST_TRACED_PIXEL_OPERATIONS)
            ),
            "as above",
            "",
            "",
        ),
        limit(
            "reflections and refractions in the traced view",
            traced::MAX_BOUNCES,
            "run time",
            "is not in",
            "`--bounces`, up to this",
        ),
        limit(
            "the distance to which an unbounded function is searched for rays, in radii of the bounded solids",
            tracer::SEARCHED_RADII,
            "run time",
            "",
            "intervals that cut the solid",
        ),
        limit(
            "frames of an animation",
            grouped(MOST_FRAMES),
            "run time",
            "is not in",
            "",
        ),
        limit(
            "points of a walked path in a copied command",
            grouped(MOST_PLACES as u64),
            "the length of a command line",
            "the path that was walked is too long for it, and is left out",
            "",
        ),
        limit(
            "rays of a file for `cast`",
            grouped(cli::MOST_RAYS as u64),
            "memory",
            "it has more than {MOST_RAYS} rays",
            "a part of the rays at a time",
        ),
        limit(
            "a line of such a file, in bytes",
            grouped(cli::LONGEST_LINE),
            "memory",
            "is longer than {LONGEST_LINE} bytes",
            "",
        ),
    ]
}

fn geodesics() -> Vec<Limit> {
    let picture = MapOptions::default().max_evaluations;
    vec![
        limit(
            "evaluations of the surface in a geodesic view; fewer if an evaluation is expensive",
            grouped(picture),
            "run time: a few seconds",
            "could not be traced within the work limit",
            "a smaller `--zoom`: shorter geodesics",
        ),
        limit(
            "evaluations of the surface for the rays of a geodesic view; pixels that these rays do not determine are traced individually",
            grouped(MOST_FOR_RAYS),
            "memory: their steps are kept",
            "could not be traced within the work limit",
            "a smaller `--zoom`: shorter geodesics",
        ),
        limit(
            "evaluations for a pixel with `--method adaptive`, on average over a large picture",
            grouped(LEAST_FOR_PIXEL),
            "run time",
            "could not be traced within the work limit",
            "",
        ),
        limit(
            "evaluations for a pixel",
            grouped(MOST_FOR_PIXEL),
            "run time",
            "could not be traced within the work limit",
            "`geotrace trace` follows one geodesic farther",
        ),
        limit(
            "evaluations of a geodesic that `trace` follows",
            grouped(MOST_OF_ONE as u64),
            "run time: a few seconds",
            "it reached the limit of evaluations",
            "`--max-evaluations`",
        ),
        limit(
            "steps of `trace --method rk4-pixel`",
            grouped(cli::MOST_EQUAL_STEPS),
            "run time",
            "is not in",
            "`--steps`, up to this",
        ),
        limit(
            "evaluations of the surface for one point of a geodesic, as `g(3)`; fewer if an evaluation is expensive",
            grouped(scene::MAX_VALUE_EVALUATIONS),
            "run time: a program may have many",
            "it exceeds the limit of steps",
            "`geotrace trace` follows one geodesic farther",
        ),
        limit(
            "evaluations of the surface for one geodesic that is drawn as a line",
            grouped(geometry::MAX_LINE_EVALUATIONS),
            "run time: about a second",
            "is not drawn to its end",
            "a shorter interval",
        ),
        limit(
            "evaluations for all declared geodesics of a scene; each declaration has an equal share, and each instance of it",
            grouped(geometry::MAX_DECLARED_EVALUATIONS),
            "run time: a few seconds",
            "is not drawn to its end",
            "fewer geodesics",
        ),
        limit(
            "geodesics between two places that `measure` lists",
            MOST_CONNECTIONS,
            "run time",
            "there may be more",
            "`--within` says how far to look",
        ),
    ]
}

fn table(limits: &[Limit]) -> String {
    let mut text = String::from(
        "\n| limit | at most | why | what is said | how to raise it |\n| --- | --: | --- | --- | --- |\n",
    );
    for limit in limits {
        // What is put in stands as an ellipsis.
        let mut message = String::new();
        let mut inside = false;
        for c in limit.message.chars() {
            match c {
                '{' => {
                    inside = true;
                    message.push('…');
                }
                '}' => inside = false,
                c if !inside => message.push(c),
                _ => {}
            }
        }
        text.push_str(&format!(
            "| {} | {} | {} | {message} | {} |\n",
            limit.what, limit.most, limit.why, limit.raised
        ));
    }
    text
}

fn page() -> String {
    let mut text = String::from(
        "# Limits\n\nNo input can exhaust the machine: sizes and work are limited, and most limits end in a message. This page is\n\
         generated from the constants of the code; `UPDATE=1 cargo test --workspace --test limits` writes it.\n",
    );
    for (title, limits) in [
        ("Programs", programs()),
        ("Scripts", scripts()),
        ("Pictures", pictures()),
        ("Geodesics", geodesics()),
    ] {
        text.push_str(&format!("\n## {title}\n{}", table(&limits)));
    }
    text
}

#[test]
fn the_page_of_limits_has_the_numbers_of_the_code() {
    let path = repository().join("docs/limits.md");
    if testing::writes_expected() {
        std::fs::write(path, page()).expect("docs/ is writable");
        return;
    }
    let found = std::fs::read_to_string(path).expect("docs/limits.md");
    assert_eq!(
        found,
        page(),
        "docs/limits.md is old; UPDATE=1 writes it anew"
    );
}

/// All sources of the crates, without the breaks of lines in long texts.
fn sources(folder: &std::path::Path, text: &mut String) {
    for entry in std::fs::read_dir(folder).expect("a folder").flatten() {
        let path = entry.path();
        if path.is_dir() {
            sources(&path, text);
        } else if path.extension().is_some_and(|end| end == "rs") {
            text.push_str(&std::fs::read_to_string(&path).expect("a source"));
        }
    }
}

#[test]
fn every_sentence_of_the_page_of_limits_is_one_of_the_program() {
    let mut all = String::new();
    sources(&repository().join("crates"), &mut all);
    for limit in [programs(), scripts(), pictures(), geodesics()]
        .into_iter()
        .flatten()
    {
        // What clap says of a number that is out of an option's range stands in no source of ours.
        if limit.message != "is not in" {
            assert!(
                all.contains(limit.message),
                "{}: {}",
                limit.what,
                limit.message
            );
        }
    }
}
