//! The geodesic view of a solid: it waits until it is asked for, its camera walks, is put somewhere and is remembered.

use egui::{Key, Modifiers};

use crate::hand::Hand;
use crate::measuring;

const EGG: &str = "param r = 2 : [1.5, 3];
solid egg(x,y,z) = x^2/4 + y^2 + z^2/r^2 - 1, color : (0.6, 0.6, 0.6) + 0.4(sin(6x), sin(6y), sin(6z));
solid cap(x,y,z) = z + 0.5;
solid dish = egg \\ cap @ (0,0,0.2);
point p = (3, 0, 0);
";
const LONE: &str = "solid ball(x,y,z) = x^2 + y^2 + z^2 - 1, color : (1, 0.8, 0.2);\n";

/// Opens the view of a solid by the menu.
fn look_from_inside(hand: &mut Hand, solid: &str) {
    hand.click("View");
    hand.click_like("Geodesic view of a solid");
    hand.click(&format!("Geodesic view of {solid}"));
    hand.press(Modifiers::NONE, Key::Escape);
    hand.settle();
}

#[test]
fn the_view_of_a_solid_opens_when_it_is_asked_for_and_is_remembered() {
    let mut hand = Hand::on(EGG);
    assert!(!hand.shows("Geodesic view"), "{:?}", hand.names());
    look_from_inside(&mut hand, "dish");
    assert!(hand.shows("Geodesic view of dish from (x, y, z) ="));
    hand.hold(Key::W, 5);
    let walked = hand.solid_camera("dish");
    assert!(walked.moved);
    // The place is on the solid, and stays there while a param moves.
    hand.slide("r", 10.0);
    hand.settle();
    let moved = hand.solid_camera("dish");
    assert_ne!(moved.at, walked.at);
    let mut hand = hand.again();
    hand.settle();
    assert!(hand.shows("Geodesic view of dish from"));
    let again = hand.solid_camera("dish");
    for k in 0..3 {
        assert!(
            (again.at[k] - moved.at[k]).abs() < 1e-9,
            "{again:?}, {moved:?}"
        );
    }
    // Closed once, it stays closed.
    hand.click("View");
    hand.click_like("Geodesic view of a solid");
    hand.click("Geodesic view of dish");
    hand.press(Modifiers::NONE, Key::Escape);
    hand.settle();
    assert!(!hand.shows("Geodesic view of dish from"));
    let hand = hand.again();
    assert!(!hand.shows("Geodesic view of dish from"));
}

#[test]
fn a_click_on_a_solid_puts_the_camera_there_where_one_looks_from_inside() {
    let mut hand = Hand::on(LONE);
    let middle = hand.space().center();
    hand.click_at(middle);
    hand.settle();
    assert!(hand.window().model().choices.inside.is_empty());
    look_from_inside(&mut hand, "ball");
    let before = hand.solid_camera("ball");
    let (eye, target) = hand.eye();
    let towards = |k: usize| eye[k] - target[k];
    let distance = (0..3).map(|k| towards(k).powi(2)).sum::<f64>().sqrt();
    hand.click_at(hand.space().center());
    hand.until("it stands there", |hand| {
        hand.solid_camera("ball").at != before.at
    });
    // The ball's middle is the target, so the place lies towards the eye.
    let placed = hand.solid_camera("ball");
    for k in 0..3 {
        let expected = towards(k) / distance;
        assert!((placed.at[k] - expected).abs() < 0.02, "{placed:?}");
    }
    assert!((placed.zoom() - before.zoom()).abs() < 1e-12);
    hand.window_mut().undo();
    hand.settle();
    assert_eq!(hand.solid_camera("ball").at, before.at);
}

#[test]
fn the_camera_of_a_solid_is_dragged_turned_zoomed_and_put_back() {
    let mut hand = Hand::on(LONE);
    look_from_inside(&mut hand, "ball");
    let first = hand.solid_camera("ball");
    let middle = hand.inside("ball").center();
    hand.click_at(middle);
    hand.hold(Key::Q, 5);
    let turned = hand.solid_camera("ball");
    assert_eq!(turned.at, first.at);
    assert_ne!(turned.x, first.x);
    hand.hold(Key::Z, 5);
    assert!(hand.solid_camera("ball").zoom() < turned.zoom());
    hand.drag(
        middle,
        egui::vec2(40.0, 0.0),
        egui::PointerButton::Primary,
        Modifiers::NONE,
    );
    let dragged = hand.solid_camera("ball");
    let radius = dragged.at.iter().map(|x| x * x).sum::<f64>().sqrt();
    assert!((radius - 1.0).abs() < 1e-9 && dragged.at != first.at);
    hand.press(Modifiers::NONE, Key::R);
    hand.settle();
    assert_eq!(hand.solid_camera("ball").at, first.at);
}

#[test]
fn a_stated_colour_is_picked_into_the_text() {
    let text = "solid ball(x,y,z) = x^2 + y^2 + z^2 - 1, color : (1, 0.8, 0.2), mirror : 0.1;
param c : [0, 1];
point p = (c, 0, 2), color : (c, 0, 0);
point q = (0, 0, 3);
";
    let mut hand = Hand::on(text);
    hand.settings("Objects");
    hand.click("Colour of ball");
    hand.click("Blue");
    hand.settle();
    let blue = text.replace("(1, 0.8, 0.2)", "(0, 0.447, 0.698)");
    hand.until("it is written", |hand| hand.window().text() == Some(&blue));
    assert!(hand.window().model().choices.looks.is_empty());
    // An expression is not, and what states none is a choice of the window.
    hand.press(Modifiers::NONE, Key::Escape);
    hand.click("Colour of q");
    hand.click("Blue");
    hand.settle();
    assert_eq!(hand.window().text(), Some(&*blue));
    assert_eq!(
        hand.window().model().choices.look("q").colour,
        Some([0, 114, 178])
    );
}

#[test]
fn a_resting_pointer_has_its_place_on_a_solid_with_its_curvature() {
    let mut hand = Hand::on("solid ball(x,y,z) = x^2 + y^2 + z^2 - 4;\n");
    let middle = hand.space().center();
    hand.harness.hover_at(middle);
    hand.until("the place is in the status line", |hand| {
        hand.shows("ball at (x, y, z) = (") && hand.shows("), K = 0.25")
    });
    look_from_inside(&mut hand, "ball");
    measuring::open(&mut hand);
    let zoom = hand.solid_camera("ball").zoom();
    let place = measuring::at(&hand, "ball", [-0.3, 0.4]);
    hand.harness.hover_at(place);
    let length = measuring::number(&mut hand, "length of the geodesic seen");
    measuring::near(length, 0.5 * zoom);
    measuring::equal(measuring::number(&mut hand, "K"), 0.25);
    let direction = measuring::number(&mut hand, "direction");
    measuring::near(direction, f64::atan2(0.4, -0.3));
}

#[test]
fn the_pointer_on_a_set_names_the_part_and_forgets_its_place_where_a_param_moves() {
    let mut hand = Hand::on(
        "param r = 1 : [1, 3];\nsolid ball(x,y,z) = x^2 + y^2 + z^2 - r^2;\nsolid cap(x,y,z) = -z;\nsolid half = ball \\ cap;\n",
    );
    let middle = hand.space().center();
    hand.harness.hover_at(middle);
    hand.until("the part is named", |hand| {
        hand.shows("half: ") && hand.shows(" at (x, y, z) = (")
    });
    measuring::open(&mut hand);
    hand.harness.hover_at(middle);
    hand.until("it is measured", |hand| hand.shows("Pointer on half"));
    hand.slide("r", 60.0);
    hand.until("the place is not on it any more", |hand| {
        !hand.shows("Pointer on half")
    });
}
