//! Without a pointer, and with a screen reader; on small and on dense screens.

use std::collections::BTreeSet;

use egui::accesskit::Role;
use egui::{Key, Modifiers};

use crate::hand::{Hand, SPHERE};

#[test]
fn every_control_has_a_name() {
    let mut hand = Hand::on(SPHERE);
    assert_eq!(hand.harness.unnamed_widgets(), Vec::<String>::new());
    for menu in ["File", "Edit", "View", "Overlays", "Help"] {
        hand.click_on(Role::Button, menu);
        assert_eq!(
            hand.harness.unnamed_widgets(),
            Vec::<String>::new(),
            "{menu}"
        );
        hand.press(Modifiers::NONE, Key::Escape);
    }
    hand.click_on(Role::Button, "File");
    hand.click("Save picture…");
    assert_eq!(hand.harness.unnamed_widgets(), Vec::<String>::new());
}

/// The names that Tab stops at, from the first until it comes round.
fn stops(hand: &mut Hand) -> Vec<String> {
    let mut stops = Vec::new();
    for _ in 0..200 {
        hand.press(Modifiers::NONE, Key::Tab);
        hand.harness.run_steps(4);
        let Some((role, name)) = hand.focused() else {
            continue;
        };
        let name = format!("{role:?}: {name}");
        if stops.first() == Some(&name) && stops.len() > 5 {
            break;
        }
        stops.push(name);
    }
    stops
}

#[test]
fn tab_reaches_every_control() {
    let mut hand = Hand::on(SPHERE);
    for (tab, controls) in [
        (
            "Preferences",
            &["ComboBox: Theme", "ComboBox: Interface scale"][..],
        ),
        ("Views", &["Slider: Camera speed"]),
        (
            "Objects",
            &[
                "CheckBox: Show s",
                "ColorWell: Colour of s",
                "ComboBox: Texture of s",
                "Button: Open textures…",
            ],
        ),
        (
            "Params",
            &["Slider: r", "Button: Animate r", "Button: More for r"],
        ),
    ] {
        hand.settings(tab);
        let stops = stops(&mut hand);
        let reached: BTreeSet<&str> = stops.iter().map(String::as_str).collect();
        let all = ["Button: File", "Button: Help"];
        for wanted in all.iter().chain(controls) {
            assert!(
                reached.contains(wanted),
                "Tab does not reach {wanted}: {stops:#?}"
            );
        }
    }
    let stops = stops(&mut hand);
    let nameless = |it: &&String| it.ends_with(": ");
    assert_eq!(stops.iter().find(nameless), None, "{stops:#?}");
    assert!(
        stops.iter().any(|it| it.starts_with("Image: 3D view")),
        "{stops:#?}"
    );
    assert!(
        stops
            .iter()
            .any(|it| it.starts_with("Image: Geodesic view of s")),
        "{stops:#?}"
    );
}

#[test]
fn a_view_that_tab_reaches_has_the_keys() {
    let mut hand = Hand::on(SPHERE);
    hand.tab_to("Geodesic view of s");
    let before = (hand.camera("s"), hand.eye());
    hand.hold(Key::W, 6);
    assert_ne!(hand.camera("s").at, before.0.at);
    assert_eq!(hand.eye(), before.1);
}

#[test]
fn a_small_window_and_a_dense_screen_show_whole_pictures() {
    let mut hand = Hand::with(SPHERE, |builder| builder.with_size([480.0, 320.0]));
    assert!(hand.shows("Status: no errors"));
    hand.hold(Key::W, 4);

    let mut hand = Hand::with(SPHERE, |builder| {
        builder
            .with_size([1200.0, 800.0])
            .with_pixels_per_point(2.0)
    });
    let rect = hand.space();
    let place = hand.window().counters().panes["3d"];
    assert!(
        (place[2] - 2.0 * rect.width()).abs() < 1.0,
        "{place:?} of {rect:?}"
    );
    hand.hold(Key::W, 4);
    assert!(hand.window().is_settled());
}

#[test]
fn all_settings_fit_a_narrow_pane() {
    let mut hand = Hand::with(SPHERE, |builder| builder.with_size([880.0, 1400.0]));
    let edge = hand.space().left();
    assert!(edge < 260.0, "{edge}");
    for (tab, controls) in [
        ("Params", &["Animate r", "More for r"][..]),
        (
            "Objects",
            &[
                "Texture of s",
                "Default texture",
                "Open textures…",
                "Image file",
                "Add",
            ],
        ),
        ("Views", &["Camera speed", "3D pictures", "Background"]),
        ("Preferences", &["Theme", "Interface scale"]),
    ] {
        hand.settings(tab);
        for name in controls {
            let rects = hand.rects(name);
            assert!(!rects.is_empty(), "{name} is not there");
            for rect in rects {
                assert!(
                    rect.right() <= edge,
                    "{name} at {rect} is cut off at {edge}"
                );
            }
        }
    }
}
