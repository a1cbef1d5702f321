//! What the geodesic view of every example costs, counted: a change of cost is a change of a line.

use std::fmt::Write;
use std::sync::Arc;

use geodesic::fan::{Fan, FanOptions};
use geodesic::piecewise::{Cover, PiecewiseMap};
use rayon::ThreadPoolBuilder;
use render::Renderer;
use scene::ObjectId;
use scene::ParamValues;
use testing::draw::scene;
use testing::examples;
use testing::inside::opening;
use testing::wanted::Wanted;

const SIZE: [u32; 2] = [512, 512];
/// Of pictures with lines.
const PICTURE: [u32; 2] = [256, 192];

/// One line for each example with a surface.
fn table(names: &[&str]) -> String {
    let mut table = String::new();
    for example in examples::all() {
        if !names.is_empty() && !names.contains(&example.name.as_str()) {
            continue;
        }
        let Some(view) = opening(&scene(&example.source)) else {
            continue;
        };
        let options = FanOptions::default();
        let fan = Fan::build(view.surface(), &view.frame(), SIZE, &options);
        let piecewise = PiecewiseMap::cut(&fan, SIZE, 0.25 * options.tolerance);
        let work = fan.work();
        let empty = piecewise
            .covers
            .iter()
            .filter(|cover| matches!(cover, Cover::Nothing(_)))
            .count();
        let _ = writeln!(
            table,
            "{:14} rays {:5}  steps {:6}  rejected {:5}  evaluations {:7}  followed {:6}  patches {:5}  \
             single blocks {:5}  empty blocks {:5}  samples {:7}",
            example.name,
            work.rays,
            work.steps,
            work.rejected,
            work.evaluations,
            work.followed,
            piecewise.patches.len(),
            piecewise.singles.len(),
            empty,
            piecewise.samples
        );
    }
    table
}

/// One line for each example with lines on a surface: how often the ends of the pixels of its picture are computed, for its
/// colours and for the lines together, and how many rows of eight pixels are measured against pieces of lines.
fn lines() -> String {
    let mut table = String::new();
    for example in examples::all() {
        let scene = Arc::new(scene(&example.source));
        let Some(on) = scene
            .objects
            .iter()
            .position(|object| object.shape.manifold().is_some())
        else {
            continue;
        };
        let mut stage = Renderer::software();
        let request = Wanted::geodesic(ObjectId::new(on), PICTURE);
        stage
            .draw(&request.of(&scene, &ParamValues::initial(&scene)))
            .expect("a picture");
        let made = stage.counters();
        let pixels = u64::from(PICTURE[0] * PICTURE[1]);
        if made.distances > 0 {
            let _ = writeln!(
                table,
                "{:14} ends {} of {pixels}  distances {:7}",
                example.name, made.ends, made.distances
            );
        }
    }
    table
}

#[test]
fn the_work_of_lines_over_every_example_is_what_it_was() {
    insta::assert_snapshot!("lines", lines());
}

#[test]
fn the_work_of_every_example_is_what_it_was() {
    insta::assert_snapshot!("examples", table(&[]));
}

#[test]
fn work_does_not_depend_on_the_number_of_threads() {
    let on = |threads: usize| {
        let pool = ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("threads");
        pool.install(|| table(&["torus", "monkey", "sphere"]))
    };
    let one = on(1);
    assert_eq!(one.lines().count(), 3);
    for threads in [2, 5] {
        assert_eq!(on(threads), one);
    }
}
