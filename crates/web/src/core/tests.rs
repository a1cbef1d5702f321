//! Tests of the core, natively: what a page does, without a page.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use super::{Core, DrawnPicture};
use crate::message::{CoreEvent, read_message};

const TORUS: &str = "param r = 0.8 : [0.4, 1.2];
surface s(u, v) = ((2 + r cos(v)) cos(u), (2 + r cos(v)) sin(u), r sin(v)), u : [0, 2pi], v : [-pi, pi];
";

/// A page: what it has received, and the time.
struct Page {
    core: Core,
    now: f64,
    events: Vec<CoreEvent>,
}

impl Page {
    fn open(text: &str) -> Self {
        Self::open_as("a.gtr", text)
    }

    fn open_as(name: &str, text: &str) -> Self {
        let mut page = Self {
            core: Core::new(),
            now: 0.0,
            events: Vec::new(),
        };
        let program = json!({ "name": name, "text": text, "version": 1 });
        page.call("open", program).expect("it opens");
        page
    }

    fn call(&mut self, name: &str, params: Value) -> Result<Value, String> {
        let call = read_message(name, &params.to_string())?;
        self.core.call(call, self.now)
    }

    fn notify(&mut self, name: &str, params: Value) {
        let notice = read_message(name, &params.to_string()).expect("a notice");
        self.core.notice(notice, self.now);
    }

    /// Works until nothing is left to be done at once; returns the pictures, which are shown at once.
    fn work(&mut self) -> Vec<DrawnPicture> {
        let mut pictures = Vec::new();
        for _ in 0..100 {
            let progress = self.core.step(self.now);
            self.events.extend(self.core.take_events());
            if let Some(drawn) = progress.drawn {
                self.notify("shown", json!({ "view": drawn.info.view }));
                pictures.push(drawn);
            }
            if progress.next != Some(0.0) {
                return pictures;
            }
        }
        panic!("it never rests");
    }

    /// Works after a second.
    fn rest(&mut self) -> Vec<DrawnPicture> {
        self.now += 1.0;
        self.work()
    }

    fn panes(&mut self, views: &[&str]) {
        let panes = views.iter();
        let panes: Vec<Value> = panes
            .map(|view| json!({ "view": view, "width": 64, "height": 48 }))
            .collect();
        self.notify("panes", json!({ "panes": panes }));
    }

    fn settings(&mut self) -> Value {
        self.call("settings", json!({})).expect("settings")
    }
}

fn views(pictures: &[DrawnPicture]) -> Vec<&str> {
    pictures.iter().map(|it| it.info.view.as_str()).collect()
}

#[test]
fn a_program_is_described_and_drawn() {
    let mut page = Page::open(TORUS);
    page.panes(&["3d", "geodesic:s"]);
    let pictures = page.work();
    assert_eq!(views(&pictures), ["3d", "geodesic:s"]);
    for drawn in &pictures {
        assert_eq!(drawn.pixels.len(), 64 * 48 * 4);
        assert!(
            drawn.info.exact && drawn.info.version == 1,
            "{:?}",
            drawn.info
        );
    }
    let Some(CoreEvent::Scene(scene)) = page
        .events
        .iter()
        .find(|event| matches!(event, CoreEvent::Scene(_)))
    else {
        panic!("{:?}", page.events);
    };
    assert_eq!(scene.objects[0].name, "s");
    assert_eq!(scene.params[0].components[0].value, 0.8);
    let ids: Vec<&str> = scene.views.iter().map(|view| &*view.id).collect();
    assert_eq!(ids, ["3d", "geodesic:s"]);
    // The 3D view shows the geodesic camera, which was put in place after its picture.
    let again = page.work();
    assert!(views(&again).len() <= 1, "{:?}", views(&again));
    assert!(page.rest().is_empty(), "nothing has changed");
}

#[test]
fn while_something_moves_pictures_are_coarse_and_then_exact() {
    let mut page = Page::open(TORUS);
    page.panes(&["geodesic:s"]);
    page.work();
    page.notify(
        "drag",
        json!({ "view": "geodesic:s", "grip": "pan", "by": [10, 0] }),
    );
    let moving = page.work();
    assert!(moving.iter().all(|drawn| !drawn.info.exact) && moving.len() == 1);
    let exact = page.rest();
    assert!(exact.len() == 1 && exact[0].info.exact);
    let place = exact[0].info.place.as_deref().expect("a camera");
    assert!(place.starts_with("from (u, v) = "), "{place}");
}

#[test]
fn a_picture_that_is_not_shown_yet_gets_no_other_one() {
    let mut page = Page::open(TORUS);
    page.panes(&["3d"]);
    let first = page.core.step(0.0).drawn.expect("a picture");
    for _ in 0..3 {
        page.notify(
            "drag",
            json!({ "view": "3d", "grip": "orbit", "by": [9, 0] }),
        );
        assert!(page.core.step(0.0).drawn.is_none());
    }
    page.notify("shown", json!({ "view": "3d" }));
    let next = page.core.step(0.0).drawn.expect("the last one");
    assert!(first.pixels != next.pixels || first.info.width != next.info.width);
    assert!(!next.info.exact);
}

#[test]
fn edits_that_wait_are_compiled_once() {
    let mut page = Page::open(TORUS);
    page.work();
    page.events.clear();
    let at = TORUS.find("0.8").expect("there");
    for version in 2..6 {
        let change = json!({ "from": at, "to": at + 3, "insert": format!("0.{version}") });
        page.notify("edit", json!({ "version": version, "changes": [change] }));
    }
    page.work();
    let versions = page.events.iter().filter_map(|event| match event {
        CoreEvent::Findings { version, .. } => Some(*version),
        _ => None,
    });
    assert_eq!(versions.collect::<Vec<_>>(), [5]);
    page.notify("edit", json!({ "version": 9, "changes": [] }));
    page.work();
    assert!(page.events.contains(&CoreEvent::Resync { version: 5 }));
    page.notify(
        "text",
        json!({ "version": 9, "text": "point p = (1, 2, 3);" }),
    );
    page.work();
    let Some(CoreEvent::Scene(scene)) = page.events.last() else {
        panic!("{:?}", page.events.last());
    };
    assert_eq!((scene.version, scene.objects[0].name.as_str()), (9, "p"));
}

#[test]
fn a_program_whose_settings_cannot_be_read_leaves_the_one_before_open() {
    let mut page = Page::open(TORUS);
    let other = json!({ "name": "b.gtr", "text": "", "version": 2, "settings": { "closed": 5 } });
    let error = page.call("open", other).expect_err("a list is expected");
    assert!(error.contains("settings"), "{error}");
    assert_eq!(page.core.editing().source().as_str(), TORUS);
    assert_eq!(page.core.editing().version(), 1);
}

#[test]
fn settings_are_those_of_the_window_and_can_be_undone() {
    let mut page = Page::open(TORUS);
    page.work();
    page.notify(
        "change",
        json!({ "patch": { "params": { "r": [1.1] } }, "step": "r" }),
    );
    page.notify(
        "change",
        json!({ "patch": { "params": { "r": [1.2] } }, "step": "r" }),
    );
    page.notify("release", json!({}));
    page.notify(
        "change",
        json!({ "patch": { "looks": { "s": { "hidden": true } } }, "step": "s" }),
    );
    page.work();
    assert_eq!(page.settings()["params"]["r"], json!([1.2]));
    assert_eq!(page.call("undo", json!({})), Ok(json!("Show or hide")));
    assert_eq!(page.call("undo", json!({})), Ok(json!("Move a param")));
    assert_eq!(page.settings()["params"].get("r"), None);
    assert_eq!(page.call("redo", json!({})), Ok(json!("Move a param")));
    let settings = page.settings();
    let mut other = Page::open("");
    let program = json!({ "name": "a.gtr", "text": TORUS, "version": 1, "settings": settings });
    other.call("open", program).expect("it opens");
    other.work();
    assert_eq!(other.settings(), settings);
}

#[test]
fn a_camera_of_a_program_that_is_opened_again_stays_where_it_was() {
    let mut page = Page::open(TORUS);
    page.panes(&["3d"]);
    page.work();
    let opened = page.settings()["space"].clone();
    page.notify("change", json!({ "patch": { "params": { "r": [1.2] } } }));
    page.rest();
    let settings = page.settings();
    assert_eq!(settings["space"], opened, "a param moves no camera");
    // Another Worker learns of the panes after the program.
    let mut other = Page::open("");
    let program = json!({ "name": "a.gtr", "text": TORUS, "version": 1, "settings": settings });
    other.call("open", program).expect("it opens");
    other.panes(&["3d"]);
    other.work();
    assert_eq!(other.settings()["space"], opened);
    // A pane of another shape needs another camera.
    let panes = json!([{ "view": "3d", "width": 64, "height": 96 }]);
    other.notify("panes", json!({ "panes": panes }));
    other.work();
    assert_ne!(other.settings()["space"], opened);
}

#[test]
fn a_camera_that_the_reader_has_not_moved_shows_everything_of_another_text() {
    let mut page = Page::open(TORUS);
    page.panes(&["3d"]);
    page.work();
    let opened = page.settings()["space"]["eye"].clone();
    let text = format!("{TORUS}# a comment");
    page.notify("text", json!({ "version": 3, "text": text }));
    page.rest();
    assert_eq!(page.settings()["space"]["eye"], opened);
    let text = TORUS.replace("(2 + r cos(v))", "(20 + r cos(v))");
    page.notify("text", json!({ "version": 4, "text": text }));
    page.rest();
    assert_ne!(page.settings()["space"]["eye"], opened);
}

#[test]
fn only_what_the_core_changes_by_itself_is_reported() {
    let mut page = Page::open(TORUS);
    page.panes(&["3d"]);
    page.work();
    page.rest();
    let settings_sent = |page: &mut Page| {
        let events = std::mem::take(&mut page.events).into_iter();
        let settings = events.filter(|event| matches!(event, CoreEvent::Settings { .. }));
        settings.count()
    };
    settings_sent(&mut page);
    page.notify(
        "change",
        json!({ "patch": { "preferences": { "fly": true } } }),
    );
    page.rest();
    assert_eq!(settings_sent(&mut page), 0);
    page.notify(
        "drag",
        json!({ "view": "3d", "grip": "orbit", "by": [9, 0] }),
    );
    page.work();
    assert_eq!(settings_sent(&mut page), 0, "it moves");
    page.rest();
    assert_eq!(settings_sent(&mut page), 1);
}

#[test]
fn a_click_puts_the_camera_there_and_a_double_click_withdraws_it() {
    let mut page = Page::open(TORUS);
    page.panes(&["3d", "geodesic:s"]);
    page.work();
    page.rest();
    let before = page.settings()["inside"]["s"].clone();
    // The tube in front lies below the middle.
    let at = json!({ "view": "3d", "at": [32, 33] });
    let clicked = page.call("click", at.clone()).expect("an answer");
    assert_eq!(clicked["pick"]["object"], "s", "{clicked}");
    assert_eq!(clicked["placed"], "geodesic:s");
    assert_eq!(clicked["pick"]["rows"][1]["name"], "K");
    assert_ne!(page.settings()["inside"]["s"]["at"], before["at"]);
    let found = page.call("doubleClick", at).expect("an answer");
    let from = found["range"]["from"].as_u64().expect("a declaration") as usize;
    assert_eq!(&TORUS[from..=from], "s");
    assert_eq!(page.settings()["inside"]["s"]["at"], before["at"]);
    let outside = json!({ "view": "3d", "at": [0, 0] });
    assert_eq!(page.call("pick", outside), Ok(Value::Null));
}

#[test]
fn keys_that_are_held_move_the_camera_with_the_time() {
    let mut page = Page::open(TORUS);
    page.panes(&["geodesic:s"]);
    page.work();
    let before = page.settings()["inside"]["s"]["at"].clone();
    let hold =
        |keys: Value| json!({ "view": "geodesic:s", "keys": keys, "shift": false, "alt": false });
    page.notify("hold", hold(json!(["w"])));
    for _ in 0..10 {
        page.now += 0.02;
        page.work();
    }
    page.notify("hold", hold(json!([])));
    let after = page.settings()["inside"]["s"]["at"].clone();
    assert_ne!(before, after);
    page.rest();
    assert_eq!(page.settings()["inside"]["s"]["at"], after);
    assert_eq!(
        page.call("undo", json!({})),
        Ok(json!("Move the geodesic camera"))
    );
    assert_eq!(page.settings()["inside"]["s"]["at"], before);
}

#[test]
fn a_key_that_is_tapped_between_two_frames_moves_the_camera_once() {
    let mut page = Page::open(TORUS);
    page.panes(&["geodesic:s"]);
    page.work();
    let at = |page: &mut Page| page.settings()["inside"]["s"]["at"].clone();
    let before = at(&mut page);
    for keys in [json!(["w"]), json!([])] {
        let hold = json!({ "view": "geodesic:s", "keys": keys, "shift": false, "alt": false });
        page.notify("hold", hold);
    }
    let after = at(&mut page);
    assert_ne!(before, after);
    page.rest();
    assert_eq!(at(&mut page), after);
}

#[test]
fn a_view_without_a_picture_says_why() {
    let mut page = Page::open("metric h(x, y) = (1, 0, 1)/y^2, x : [-2, 2], y : [1/4, 4];");
    page.panes(&["geodesic:h", "geodesic:none"]);
    let pictures = page.work();
    assert_eq!(views(&pictures), ["geodesic:h"]);
    let is_reported = page
        .events
        .iter()
        .any(|event| matches!(event, CoreEvent::NoPicture { view, .. } if view == "geodesic:none"));
    assert!(is_reported, "{:?}", page.events);
}

#[test]
fn images_are_those_that_were_given() {
    let mut page = Page::open(&TORUS.replace("v : [-pi, pi]", "v : [-pi, pi], image : earth"));
    page.panes(&["geodesic:s"]);
    let before = page.work().remove(0).pixels;
    let image = image::RgbaImage::from_pixel(4, 2, image::Rgba([200, 30, 60, 255]));
    let mut bytes = std::io::Cursor::new(Vec::new());
    image
        .write_to(&mut bytes, image::ImageFormat::Png)
        .expect("written");
    let bytes = bytes.into_inner();
    assert!(page.core.texture("earth.png", &bytes[..20]).is_err());
    let size = page.core.texture("earth.png", &bytes).expect("an image");
    assert_eq!(size, json!({ "width": 4, "height": 2 }));
    let after = page.rest().remove(0).pixels;
    assert_ne!(before, after);
    let Some(CoreEvent::Scene(scene)) = page
        .events
        .iter()
        .rfind(|it| matches!(it, CoreEvent::Scene(_)))
    else {
        panic!("a scene");
    };
    assert!(scene.images[0].is_there);
}

#[test]
fn files_hold_what_is_shown() {
    let mut page = Page::open(TORUS);
    let saved = page.core.save_picture("3d", [40, 30]).expect("a picture");
    let image = image::load_from_memory(&saved.bytes).expect("a PNG file");
    assert_eq!((image.width(), image.height()), (40, 30));
    for format in ["obj", "ply", "stl", "gltf", "glb"] {
        let saved = page.core.save_mesh(format).expect("a mesh");
        assert!(saved.bytes.len() > 10_000, "{format}");
    }
    page.notify(
        "change",
        json!({ "patch": { "looks": { "s": { "hidden": true } } } }),
    );
    let sentence = page.core.save_mesh("obj").expect_err("nothing");
    assert!(sentence.contains("nothing"), "{sentence}");
}

#[test]
fn the_mesh_of_a_script_is_that_of_its_params() {
    let script = "Scene {
        k = 0
        while (k <= t) {
            Sphere { center -> vec3(3*k, 0, 0) radius -> 1 }
            k = k + 1
        }
    }";
    let mut page = Page::open_as("a.crt", script);
    page.panes(&["3d"]);
    page.work();
    let balls = |page: &mut Page| {
        let saved = page.core.save_mesh("obj").expect("a mesh");
        let text = String::from_utf8(saved.bytes).expect("a text");
        text.lines().filter(|line| line.starts_with("o ")).count()
    };
    assert_eq!(balls(&mut page), 1);
    for t in [5, 4, 3] {
        page.notify("change", json!({ "patch": { "params": { "t": [t] } } }));
        assert!(page.core.model.awaits_rerun(), "a notice runs no script");
    }
    assert_eq!(balls(&mut page), 4);
    page.work();
    let scenes = page.events.iter().rev();
    let mut scenes = scenes.filter_map(|event| match event {
        CoreEvent::Scene(scene) => Some(scene.objects.len()),
        _ => None,
    });
    assert_eq!(scenes.next(), Some(4));
}

#[test]
fn the_findings_of_a_script_are_those_of_its_params() {
    let script = "Scene { Sphere { center -> vec3(0, 0, 5) radius -> 2 - t } }";
    let mut page = Page::open_as("a.crt", script);
    page.panes(&["3d"]);
    page.work();
    for (t, expected) in [(2, 1), (1, 0)] {
        page.notify("change", json!({ "patch": { "params": { "t": [t] } } }));
        page.work();
        let mut events = page.events.iter().rev();
        let found = events.find_map(|event| match event {
            CoreEvent::Findings { findings, .. } => Some(findings.len()),
            _ => None,
        });
        assert_eq!(found, Some(expected), "t = {t}");
    }
}

#[test]
fn a_stated_colour_is_written_into_the_text() {
    let mut page = Page::open(
        "point a = (0, 0, 0), color : (1, 0, 0);
         param t : [0, 1];
         point b = (t, 0, 0), color : t;
         point c = (0, 1, 0);",
    );
    page.work();
    let Some(CoreEvent::Scene(scene)) = page
        .events
        .iter()
        .find(|event| matches!(event, CoreEvent::Scene(_)))
    else {
        panic!("{:?}", page.events);
    };
    let stated: Vec<Option<&str>> = scene.objects.iter().map(|it| it.stated_colour).collect();
    assert_eq!(stated, [Some("constant"), Some("expression"), None]);
    assert_eq!(scene.objects[0].colour, [255, 0, 0]);
    let asked = json!({ "object": "a", "rgb": [0, 0, 255] });
    let edit = page.call("writeColour", asked).expect("an edit");
    assert_eq!(edit["insert"], "(0, 0, 1)", "{edit}");
    let asked = json!({ "object": "b", "rgb": [0, 0, 255] });
    assert!(page.call("writeColour", asked).is_err());
}

#[test]
fn a_param_and_a_camera_are_written_into_the_text() {
    let mut page = Page::open(TORUS);
    page.panes(&["3d"]);
    page.notify("change", json!({ "patch": { "params": { "r": [1.1] } } }));
    page.work();
    let edit = page
        .call("writeParam", json!({ "param": "r" }))
        .expect("an edit");
    assert_eq!(edit["insert"], "1.1", "{edit}");
    let edit = page
        .call("writeCamera", json!({ "name": "c" }))
        .expect("an edit");
    assert!(
        edit["insert"]
            .as_str()
            .expect("a text")
            .contains("camera c"),
        "{edit}"
    );
    assert!(page.call("writeParam", json!({ "param": "q" })).is_err());
    // `r` is the name of a param.
    let edit = page.call("writeCamera", json!({ "name": "r" }));
    let edit = edit.expect("an edit");
    assert!(
        edit["insert"]
            .as_str()
            .expect("a text")
            .contains("camera eye"),
        "{edit}"
    );
}

#[test]
fn a_figure_is_measured_drawn_and_taken_away() {
    let text =
        "surface s(u, v) = (sin(v) cos(u), sin(v) sin(u), cos(v)), u : [0, 2pi], v : [0, pi];
        point p = (0, 0 - 1, 0);
        curve c(t) = (sin(t), 0 - 1, cos(t)), t : [0, 1];";
    let mut page = Page::open(text);
    let panes = json!({ "panes": [{ "view": "3d", "width": 200, "height": 200 }] });
    page.notify("panes", panes);
    let plain = page.rest().pop().expect("a picture").pixels;
    let figure = |kind: &str, places: Value| json!({ "figure": { "surface": "s", "kind": kind, "places": places } });
    let quarter = json!([
        [0.0, 1.5],
        [std::f64::consts::FRAC_PI_2, std::f64::consts::FRAC_PI_2]
    ]);
    let measured = page
        .call("measure", figure("distance", quarter.clone()))
        .expect("measured");
    assert_eq!(measured["rows"][0]["name"], "distance");
    assert_eq!(measured["rows"][0]["value"], "1.5707963");
    assert_eq!(measured["places"], quarter);
    let drawn = page.rest().pop().expect("a picture").pixels;
    assert!(drawn != plain, "its line is not drawn");
    page.call("measure", json!({ "figure": null }))
        .expect("taken away");
    assert!(page.rest().pop().expect("a picture").pixels == plain);
    // A place that lacks is no camera's, but of a circle.
    let begun = page
        .call("measure", figure("distance", json!([[0.0, 1.5]])))
        .expect("begun");
    assert_eq!(begun["places"], json!([[0.0, 1.5]]));
    assert_eq!(begun["rows"], json!([]));
}

#[test]
fn a_walk_is_measured_and_closed_by_the_way_back() {
    let text =
        "surface s(u, v) = (sin(v) cos(u), sin(v) sin(u), cos(v)), u : [0, 2pi], v : [0, pi];";
    let mut page = Page::open(text);
    let marks =
        json!({ "patch": { "preferences": { "marks": { "trail": true } } }, "step": "trail" });
    page.notify("change", marks);
    page.panes(&["3d", "geodesic:s"]);
    page.rest();
    let rows = |page: &mut Page| {
        let measured = page.call("measureWalk", json!({})).expect("an answer");
        let rows = measured["rows"].as_array().expect("rows").clone();
        let row = |row: &Value| {
            let text = |key: &str| row[key].as_str().expect("a text").to_owned();
            (text("name"), text("value"))
        };
        rows.iter().map(row).collect::<BTreeMap<String, String>>()
    };
    let drag = |page: &mut Page, by: [f64; 2]| {
        let drag = json!({ "view": "geodesic:s", "grip": "orbit", "by": by });
        page.notify("drag", drag);
        page.notify("release", json!({}));
        page.rest();
    };
    // Two sides of a triangle; the third is the shortest way back.
    drag(&mut page, [9.0, 0.0]);
    drag(&mut page, [0.0, 9.0]);
    let open = rows(&mut page);
    assert!(
        open.contains_key("length") && open.contains_key("to the start"),
        "{open:?}"
    );
    page.call("walkBack", json!({})).expect("a way back");
    page.rest();
    let closed = rows(&mut page);
    let number = |rows: &BTreeMap<String, String>, name: &str| -> f64 {
        let text = rows.get(name).unwrap_or_else(|| panic!("{rows:?}"));
        let number = text
            .split([' ', '=', '°'])
            .find_map(|word| word.parse().ok());
        number.unwrap_or_else(|| panic!("{text}"))
    };
    let sides = number(&closed, "length");
    let way = number(&open, "length") + number(&open, "to the start");
    assert!((sides - way).abs() < 1e-6, "{open:?} {closed:?}");
    // The holonomy is the area of the triangle with a right angle and equal sides a, by Girard: 2 atan(tan²(a/2)).
    let side = number(&open, "length") / 2.0;
    let area = 2.0 * (side / 2.0).tan().powi(2).atan();
    let found = number(&closed, "holonomy").abs();
    assert!(
        (found - area).abs() < 1e-5,
        "{found} for {area}: {closed:?}"
    );
}

#[test]
fn a_place_to_be_measured_snaps_to_a_declared_point() {
    let text =
        "surface s(u, v) = (sin(v) cos(u), sin(v) sin(u), cos(v)), u : [0, 2pi], v : [0, pi];
        point p = (0, 0 - 1, 0);";
    let mut page = Page::open(text);
    let panes = json!({ "panes": [{ "view": "3d", "width": 200, "height": 200 }] });
    page.notify("panes", panes);
    page.rest();
    let near = |page: &mut Page, measures: bool| {
        let found = (0..40_000).map(|k| [f64::from(k % 200), f64::from(k / 200)]);
        let pick = |at: [f64; 2]| {
            let asked = json!({ "view": "3d", "at": at, "measures": measures });
            page.call("pick", asked).expect("picked")
        };
        found
            .step_by(97)
            .map(pick)
            .filter(|it| it["object"] == "s")
            .map(|it| it["parameters"].clone())
            .collect::<Vec<_>>()
    };
    let exact = json!([1.5 * std::f64::consts::PI, std::f64::consts::FRAC_PI_2]);
    let close = |place: &Value| {
        [0, 1].iter().all(|&k| {
            (place[k].as_f64().unwrap_or(9.0) - exact[k].as_f64().unwrap_or(0.0)).abs() < 1e-9
        })
    };
    assert!(near(&mut page, true).iter().any(close), "no place snaps");
    assert!(
        !near(&mut page, false).iter().any(close),
        "a place snaps though nothing is measured"
    );
}
