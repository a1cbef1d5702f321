//! The settings: sliders, animation, colours, textures, menus, undo.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use egui::{Key, Modifiers, PointerButton, accesskit::Role, vec2};
use egui_kittest::kittest::Queryable;
use session::TextureChoice;

use crate::hand::{Hand, SPHERE};

#[test]
fn a_slider_moves_its_param_and_compiles_and_builds_nothing() {
    let mut hand = Hand::on(SPHERE);
    let before = hand.window().counters().clone();
    hand.slide("r", 60.0);
    let value = hand.param("r");
    assert!(value > 1.2 && value < 2.8, "{value}");
    let after = hand.window().counters().clone();
    assert!(after.pictures > before.pictures);
    assert_eq!(
        after.compiled, before.compiled,
        "a param is no part of the text"
    );
    assert_eq!(after.pipelines, before.pipelines);
    // One drag is one step.
    hand.press(Modifiers::COMMAND, Key::Z);
    hand.settle();
    assert_eq!(hand.param("r"), 1.0);
    hand.press(Modifiers::COMMAND, Key::Y);
    hand.settle();
    assert_eq!(hand.param("r"), value);
}

#[test]
fn the_rows_of_params_stand_in_columns_whatever_their_names_and_values() {
    let mut hand = Hand::on(
        "param r : [0, 1]; param alongname : [-1000, 1000]; param half : [-0.125, 0.5];
        param o : [0, 1], [0, 300]; point p = (r, alongname, half + o_1 + o_2);",
    );
    hand.keep("params");
    let names = ["r", "alongname", "half", "o_1", "o_2"];
    let left = |role, name: &str| {
        let found = hand.harness.query_all_by_role_and_label(role, name);
        found.map(|node| node.rect().left()).collect::<Vec<f32>>()
    };
    for role in [Role::Label, Role::Slider, Role::SpinButton] {
        let places = names.map(|name| left(role, name));
        assert_eq!(places[0].len(), 1, "{role:?}");
        for place in &places {
            assert_eq!(place, &places[0], "{role:?}: {places:?}");
        }
    }
    for button in ["Animate", "More for"] {
        let places = names.map(|name| left(Role::Button, &format!("{button} {name}")));
        assert_eq!(places[0].len(), 1, "{button}");
        for place in &places {
            assert_eq!(place, &places[0], "{button}: {places:?}");
        }
    }
}

#[test]
fn a_name_that_is_cut_off_is_shown_once_on_hover() {
    let name = "averyveryverylongparametername";
    let mut hand = Hand::on(&format!("param {name} : [0, 1]; point p = ({name}, 0, 0);"));
    let label = |hand: &Hand| {
        let found = hand.harness.query_all_by_role_and_label(Role::Label, name);
        found.map(|node| node.rect()).collect::<Vec<egui::Rect>>()
    };
    let at = label(&hand)[0].center();
    hand.harness.hover_at(at);
    hand.harness.run_steps(90);
    // The name itself, and one plate with it.
    assert_eq!(label(&hand).len(), 2, "{:?}", hand.names());
}

#[test]
fn a_field_that_was_not_edited_leaves_its_number() {
    let mut hand = Hand::on(
        "param third = 1/3 : [0, 1];\nparam tiny = 5e-10 : [0, 1e-9];\npoint p = (third, 1e9 tiny, 0);\n",
    );
    hand.settings("Preferences");
    hand.click("Update the program when a slider is released");
    hand.settings("Params");
    let text = hand.window().text().map(str::to_owned);
    for name in ["third", "tiny"] {
        hand.click_on(Role::SpinButton, name);
        hand.harness.run_steps(2);
        hand.press(Modifiers::NONE, Key::Tab);
        hand.settle();
    }
    assert!(hand.window().model().choices.params.is_empty());
    assert_eq!(hand.window().text(), text.as_deref());
    // What is typed counts, if it differs from what is displayed.
    hand.type_number(Role::SpinButton, "third", "0");
    assert_eq!(hand.param("third"), 0.0);
}

#[test]
fn the_value_that_is_written_into_the_text_is_the_one_that_is_shown() {
    let mut hand = Hand::on(
        "param big = 2pi : [0, 1000pi];\nparam a = 1 : [0, 100];\npoint p = (a, big, 0);\n",
    );
    hand.update_text("big");
    hand.settle();
    let text = |hand: &Hand| hand.window().text().expect("a text").to_owned();
    let shown = |hand: &Hand| {
        let model = hand.window().model();
        let scene = model.scene.clone().expect("a scene");
        let param = scene.params.iter().find(|it| it.name == "a");
        let values = model.chosen_values().expect("values");
        values.param(param.expect("declared"))[0]
    };
    assert!(
        text(&hand).starts_with("param big = 2pi :"),
        "{}",
        text(&hand)
    );
    hand.type_number(Role::SpinButton, "a", "0.1234");
    assert_eq!(shown(&hand), 0.1234);
    hand.update_text("a");
    hand.settle();
    assert!(
        text(&hand).contains("param a = 0.1234 :"),
        "{}",
        text(&hand)
    );
    assert_eq!(shown(&hand), 0.1234);
    // A drag has no more digits than the slider has positions, in the picture too.
    hand.slide("a", 30.0);
    let value = shown(&hand);
    assert!(
        value > 1.0 && value == (value * 100.0).round() / 100.0,
        "{value}"
    );
    hand.update_text("a");
    hand.settle();
    assert!(
        text(&hand).contains(&format!("param a = {value} :")),
        "{}",
        text(&hand)
    );
    assert_eq!(shown(&hand), value);
}

#[test]
fn an_animated_param_moves_one_unit_a_second_and_rests_when_it_is_stopped() {
    let mut hand = Hand::on(SPHERE);
    hand.click("Animate r");
    let pictures = hand.window().counters().pictures;
    hand.until("a picture of it", |hand| {
        hand.window().counters().pictures > pictures
    });
    let from = hand.param("r");
    hand.harness.run_steps(30);
    let to = hand.param("r");
    assert!(
        (to - from - 0.5).abs() < 1e-3,
        "30 frames of a sixtieth of a second: {from} to {to}"
    );
    // It begins anew at the least value.
    hand.harness.run_steps(90);
    assert!((1.0..=3.0).contains(&hand.param("r")));
    hand.click("Animate r");
    hand.settle();
    let rest = hand.param("r");
    hand.harness.run_steps(20);
    assert_eq!(hand.param("r"), rest);
}

#[test]
fn an_object_can_be_hidden_and_coloured_and_a_surface_takes_a_texture_from_the_list() {
    let mut hand = Hand::on(SPHERE);
    hand.settings("Objects");
    hand.click("Show p");
    assert!(hand.window().model().choices.look("p").hidden);
    hand.click("Show p");
    assert!(!hand.window().model().choices.look("p").hidden);

    let list = hand
        .harness
        .get_by_role_and_label(Role::ComboBox, "Texture of s")
        .rect();
    hand.keep("objects");
    assert!(list.width() > 120.0, "it has the room of the pane: {list}");
    let flip = hand.harness.get_by_label("Flip the image of s").rect();
    assert!(flip.right() < hand.space().left(), "{flip}");
    hand.click("Texture of s");
    hand.click("Plain colour");
    assert_eq!(
        hand.window().model().choices.look("s").texture,
        TextureChoice::Plain
    );
    hand.settle();

    let image = hand.path.with_file_name("map.png");
    image::RgbImage::from_pixel(8, 4, image::Rgb([200, 30, 30]))
        .save(&image)
        .expect("written");
    hand.harness
        .get_by_role_and_label(Role::TextInput, "Image file")
        .focus();
    hand.harness.run_steps(2);
    hand.harness
        .get_by_role_and_label(Role::TextInput, "Image file")
        .type_text("map.png");
    hand.harness.run_steps(2);
    hand.click("Add");
    hand.until("the image is read", |hand| {
        hand.window().model().choices.textures == [image.clone()]
    });
    hand.click("Texture of s");
    hand.click_on(Role::Button, "map.png");
    assert_eq!(
        hand.window().model().choices.look("s").texture,
        TextureChoice::Image(image.clone())
    );
    hand.settle();
    hand.click("Remove map.png");
    assert!(hand.window().model().choices.textures.is_empty());
}

#[test]
fn a_colour_is_chosen_from_the_palette_by_its_digits_or_by_sliders() {
    let mut hand = Hand::on(SPHERE);
    hand.settings("Objects");
    let colour = |hand: &Hand| hand.window().model().choices.look("p").colour;
    hand.click("Colour of p");
    hand.click("Bluish green");
    assert_eq!(colour(&hand), Some([0, 158, 115]));
    hand.enter("#009e73", "#d55e00");
    assert_eq!(colour(&hand), Some([213, 94, 0]));
    // What is no colour yet changes nothing.
    hand.enter("#d55e00", "#d5");
    assert_eq!(colour(&hand), Some([213, 94, 0]));
    hand.enter("#d5", "fff");
    assert_eq!(colour(&hand), Some([255; 3]));
    hand.press(Modifiers::NONE, Key::Escape);
    hand.press(Modifiers::NONE, Key::Escape);
    hand.press(Modifiers::COMMAND, Key::Z);
    assert_ne!(colour(&hand), Some([255; 3]));
}

#[test]
fn axes_step_the_camera_back_unless_it_was_moved() {
    let mut hand = Hand::on(SPHERE);
    let distance = |hand: &Hand| {
        let (eye, target) = hand.eye();
        let squares = (0..3).map(|k| (eye[k] - target[k]).powi(2));
        squares.sum::<f64>().sqrt()
    };
    let first = distance(&hand);
    let toggle = |hand: &mut Hand| {
        hand.click("Overlays");
        hand.click_on(Role::CheckBox, "Axes");
        hand.press(Modifiers::NONE, Key::Escape);
        hand.settle();
    };
    toggle(&mut hand);
    assert!(
        distance(&hand) > 1.1 * first,
        "{first}, {}",
        distance(&hand)
    );
    toggle(&mut hand);
    assert!((distance(&hand) - first).abs() < 1e-9 * first);
    let middle = hand.space().center();
    hand.wheel(middle, 100.0);
    hand.settle();
    let moved = distance(&hand);
    toggle(&mut hand);
    assert_eq!(distance(&hand), moved, "the camera stays where it was put");
}

/// A file as a desktop hands it over.
#[derive(Debug)]
struct Dropped(PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}

#[test]
fn an_image_dropped_onto_the_window_is_in_the_list_and_on_the_surface_in_use() {
    let mut hand = Hand::on(SPHERE);
    let image = hand.path.with_file_name("drop.png");
    image::RgbImage::from_pixel(4, 4, image::Rgb([30, 200, 30]))
        .save(&image)
        .expect("written");
    let file = Dropped(image.clone());
    hand.harness.input_mut().dropped_files.push(Arc::new(file));
    hand.harness.step();
    hand.settle();
    assert_eq!(
        hand.window().model().choices.textures,
        std::slice::from_ref(&image)
    );
    assert!(hand.shows("drop.png lies on s"));
    let texture = |hand: &Hand| hand.window().model().choices.look("s").texture;
    assert_eq!(texture(&hand), TextureChoice::Image(image));
    // All of it is one step.
    hand.press(Modifiers::COMMAND, Key::Z);
    hand.settle();
    assert_eq!(texture(&hand), TextureChoice::Default);
    assert!(hand.window().model().choices.textures.is_empty());
}

#[test]
fn defines_have_their_values_below_the_sliders() {
    let mut hand = Hand::on("param a = 0.25 : [0, 1];\ndefine b = (2a, 1);\ndefine c = 5;\n");
    hand.until("the value of b", |hand| hand.shows("= (0.5, 1)"));
    let names = hand.names();
    assert!(
        !names.iter().any(|name| name == "= 5"),
        "c depends on no param"
    );
    hand.slide("a", 1000.0);
    hand.until("it follows the slider", |hand| hand.shows("= (2, 1)"));
}

#[test]
fn the_menus_do_what_their_entries_say() {
    let mut hand = Hand::on(SPHERE);
    hand.click("Overlays");
    hand.click("Legend");
    assert!(hand.window().model().choices.preferences.marks.legend);
    hand.press(Modifiers::NONE, Key::Escape);
    hand.settle();

    hand.click("Edit");
    hand.click_like("Undo: Change the overlays");
    assert!(!hand.window().model().choices.preferences.marks.legend);
    hand.settle();
    hand.click("Edit");
    hand.click_like("Redo: Change the overlays");
    assert!(hand.window().model().choices.preferences.marks.legend);
    hand.settle();

    let followed = hand.window().counters().followed;
    hand.click("View");
    hand.click("Geodesic view of s");
    hand.press(Modifiers::NONE, Key::Escape);
    hand.settle();
    assert!(hand.window().model().choices.closed.contains("geodesic:s"));
    hand.hold(Key::W, 5);
    assert_eq!(
        hand.window().counters().followed,
        followed,
        "a view that is not seen is not drawn"
    );
    hand.click("View");
    hand.click("Geodesic view of s");
    hand.press(Modifiers::NONE, Key::Escape);
    hand.settle();
    assert!(!hand.window().model().choices.closed.contains("geodesic:s"));

    // What was opened has the keys, and what was clicked on.
    hand.hold(Key::W, 5);
    assert!(hand.camera("s").moved);
    hand.click("View");
    hand.click_like("Reset the camera");
    hand.settle();
    assert!(!hand.camera("s").moved);
    assert!(hand.window().model().choices.space.expect("a camera").moved);
    hand.click("Geodesic view – s");
    hand.click("3D view");
    hand.click("View");
    hand.click_like("Reset the camera");
    hand.settle();
    assert!(!hand.window().model().choices.space.expect("a camera").moved);

    hand.press(Modifiers::NONE, Key::F1);
    hand.settle();
    assert!(hand.shows("put the geodesic camera there"));
}

#[test]
fn settings_of_the_window_are_steps_that_can_be_undone() {
    let mut hand = Hand::on(SPHERE);
    let model = |hand: &Hand| hand.window().model().choices.preferences.clone();
    let before = model(&hand);
    hand.settings("Preferences");
    hand.click_on(Role::ComboBox, "Theme");
    hand.click("Dark");
    assert_eq!(model(&hand).theme, session::Theme::Dark);
    hand.settle();
    hand.press(Modifiers::COMMAND, Key::Z);
    assert_eq!(model(&hand), before);
}

#[test]
fn a_picture_is_saved_at_any_size_with_a_transparent_background() {
    let mut hand = Hand::on(SPHERE);
    hand.click_on(Role::Button, "File");
    hand.click("Save picture…");
    hand.harness.run_steps(3);
    let target = hand.path.with_file_name("program-3d.png");
    let file = hand
        .harness
        .get_all_by_role(Role::TextInput)
        .find(|node| node.value().is_some_and(|value| value.ends_with("3d.png")));
    assert_eq!(
        file.expect("a field for the file").value(),
        Some(target.display().to_string())
    );
    let width = hand
        .harness
        .get_by_role_and_label(Role::SpinButton, "Width");
    width.set_value_accesskit(320.0);
    hand.harness.run_steps(2);
    let height = hand
        .harness
        .get_by_role_and_label(Role::SpinButton, "Height");
    height.set_value_accesskit(200.0);
    hand.harness.run_steps(2);
    hand.click("Transparent background");
    let save = hand
        .harness
        .get_all_by_role_and_label(Role::Button, "Save")
        .last();
    save.expect("offered").click();
    hand.harness.run_steps(3);
    hand.until("the picture is written", |_| target.exists());
    hand.until("the window says so", |hand| hand.shows("320"));
    let picture = image::open(&target).expect("a picture").to_rgba8();
    assert_eq!(picture.dimensions(), (320, 200));
    assert_eq!(picture.get_pixel(0, 0).0[3], 0, "the corner is background");
    assert!(
        picture.pixels().any(|pixel| pixel.0[3] == 255),
        "the sphere is not"
    );
}

#[test]
fn a_picture_of_a_view_that_moves_is_as_large_as_its_pane() {
    let mut hand = Hand::on(SPHERE);
    hand.click("Animate r");
    // Long enough to know that pictures of that size take their time.
    let pictures = hand.window().counters().pictures;
    hand.until("some pictures have come", |hand| {
        hand.window().counters().pictures > pictures + 6
    });
    let room = hand.space().size();
    hand.press(Modifiers::COMMAND, Key::E);
    for (side, expected) in [("Width", room.x), ("Height", room.y)] {
        let field = hand.harness.get_by_role_and_label(Role::SpinButton, side);
        let value = field.value().unwrap_or_default();
        assert_eq!(value, format!("{} px", expected.round()), "{side}");
    }
}

#[test]
fn a_drag_within_one_slow_frame_is_a_drag() {
    let mut hand = Hand::on(SPHERE);
    let start = hand.eye();
    let from = hand.space().center();
    let by = vec2(60.0, 20.0);
    hand.drag(from, by, PointerButton::Primary, Modifiers::NONE);
    let slow = hand.eye();
    assert_ne!(slow, start);
    hand.press(Modifiers::COMMAND, Key::Z);
    hand.settle();
    assert_eq!(hand.eye(), start);
    // All of it comes between two frames, and where it begins there is another pane.
    let slider = hand.harness.get_by_role_and_label(Role::Slider, "r").rect();
    hand.harness.hover_at(slider.center());
    hand.harness.step();
    quick_drag(&mut hand, from, by);
    let same = |(eye, target): ([f64; 3], [f64; 3])| {
        let pairs = eye.iter().zip(slow.0).chain(target.iter().zip(slow.1));
        pairs.into_iter().all(|(a, b)| (a - b).abs() < 1e-9)
    };
    assert!(same(hand.eye()), "{:?} is not {slow:?}", hand.eye());
    assert_eq!(hand.param("r"), 1.0);
    quick_drag(
        &mut hand,
        slider.left_center() + vec2(6.0, 0.0),
        vec2(60.0, 0.0),
    );
    let value = hand.param("r");
    assert!(value > 1.2 && value < 2.8, "{value}");
    assert!(same(hand.eye()));
}

#[test]
fn a_picture_that_comes_soon_is_part_of_the_frame_that_asked_for_it() {
    let mut hand = Hand::on(SPHERE);
    hand.window_mut()
        .set_frame_wait_budget(Duration::from_secs(60));
    let slider = hand.harness.get_by_role_and_label(Role::Slider, "r");
    slider.focus();
    hand.settle();
    let before = hand.window().counters().clone();
    hand.harness.key_down(Key::ArrowRight);
    hand.harness.step();
    assert!(hand.param("r") > 1.0);
    assert!(hand.window().is_settled());
    let now = hand.window().counters();
    assert_eq!(now.frames, before.frames + 1);
    assert_eq!(now.pictures, before.pictures + 2, "one of each view");
}

#[test]
fn a_slow_click_is_a_click() {
    let mut hand = Hand::on(SPHERE);
    let at = hand
        .harness
        .get_by_role_and_label(Role::Button, "File")
        .rect();
    let pos = at.center();
    hand.harness.hover_at(pos);
    for pressed in [true, false] {
        hand.harness.event(egui::Event::PointerButton {
            pos,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        });
        // More than a second.
        hand.harness.run_steps(90);
    }
    assert!(hand.shows("Save picture…"));
}

/// Presses, moves and releases the pointer before the window draws itself again.
fn quick_drag(hand: &mut Hand, from: egui::Pos2, by: egui::Vec2) {
    let button = |pos, pressed| egui::Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    // Events that are queued would have a frame each.
    hand.harness.input_mut().events.extend([
        egui::Event::PointerMoved(from),
        button(from, true),
        egui::Event::PointerMoved(from + 0.5 * by),
        egui::Event::PointerMoved(from + by),
        button(from + by, false),
    ]);
    hand.harness.run_steps(4);
    hand.settle();
}

#[test]
fn a_scene_of_metrics_alone_is_seen_from_inside_alone() {
    let metric = "metric h(u,v) = (1/v^2, 0, 1/v^2), u : [-1, 1], v : [0.5, 2];
geodesic g(t) : h = (1, 0) @ (0, 1), t : [0, 0.5];\n";
    let mut hand = Hand::on(metric);
    assert!(hand.shows("Geodesic view of h") && !hand.shows("3D view of"));
    // It has the keys, and fills what the 3D view would have had.
    hand.hold(Key::W, 5);
    assert!(hand.camera("h").moved);
    hand.click("View");
    hand.click_on(Role::CheckBox, "3D view");
    hand.press(Modifiers::NONE, Key::Escape);
    hand.settle();
    assert!(hand.shows("A metric has no embedding: see its geodesic view"));

    let mut hand = Hand::on(metric);
    hand.window_mut()
        .set_text(format!("{metric}point p = (0, 0, 0);\n"));
    hand.until("what has a place in space is seen there", |hand| {
        hand.shows("3D view of 3 objects")
    });
    assert!(!hand.shows("A metric has no embedding"));
}
