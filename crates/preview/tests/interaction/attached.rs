//! A window that an editor's server feeds: what it is told, what it tells.

use std::io::{BufRead, BufReader, PipeReader, PipeWriter, Write};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use egui::{Key, Modifiers, PointerButton, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use preview::Window;
use protocol::{Command, Event, Hello, View};

use crate::hand::{FRAME, SPHERE};

struct Desk {
    harness: Harness<'static, Window>,
    server: Option<PipeWriter>,
    events: Receiver<Event>,
    heard: Vec<Event>,
}

impl Desk {
    fn new() -> Self {
        let (input, mut server) = std::io::pipe().expect("a pipe");
        let (listener, output) = std::io::pipe().expect("a pipe");
        say(&mut server, &Command::Hello(Hello::own()));
        let (sender, events) = channel();
        std::thread::spawn(move || listen(listener, &sender));
        let mut ends = Some((input, output));
        let mut window: Option<Window> = None;
        let context = egui::Context::default();
        let (input, output) = ends.take().expect("both");
        window.replace(Window::attached(&context, input, output));
        let harness = Harness::builder()
            .with_size([1100.0, 700.0])
            .with_step_dt(FRAME)
            .build_ui_state(
                |ui, window: &mut Window| window.show(ui),
                window.expect("made"),
            );
        Self {
            harness,
            server: Some(server),
            events,
            heard: Vec::new(),
        }
    }

    fn tell(&mut self, command: &Command) {
        say(self.server.as_mut().expect("not closed"), command);
    }

    fn text(&mut self, version: i32, text: &str) {
        self.tell(&Command::Text {
            uri: "file:///nowhere/a.gtr".to_owned(),
            path: None,
            version,
            text: text.into(),
        });
    }

    fn until(&mut self, what: &str, mut holds: impl FnMut(&Self) -> bool) {
        let begun = Instant::now();
        loop {
            self.harness.step();
            while let Ok(event) = self.events.try_recv() {
                self.heard.push(event);
            }
            if holds(self) {
                return;
            }
            assert!(
                begun.elapsed() < Duration::from_secs(60),
                "{what}: {:?}",
                self.heard
            );
            std::thread::sleep(Duration::from_millis(2));
        }
    }

    fn shown(&self, wanted: i32) -> Option<bool> {
        self.heard.iter().find_map(|event| match event {
            Event::Shown { version, ok, .. } if *version == wanted => Some(*ok),
            _ => None,
        })
    }

    fn shows(&self, part: &str) -> bool {
        self.harness
            .query_all_by_label_contains(part)
            .next()
            .is_some()
    }
}

fn say(server: &mut PipeWriter, command: &Command) {
    let mut line = serde_json::to_vec(command).expect("a message");
    line.push(b'\n');
    server.write_all(&line).expect("read");
}

fn listen(listener: PipeReader, sender: &std::sync::mpsc::Sender<Event>) {
    for line in BufReader::new(listener).lines().map_while(Result::ok) {
        let event = serde_json::from_str(&line).expect("an event");
        if sender.send(event).is_err() {
            return;
        }
    }
}

#[test]
fn a_text_is_shown_and_its_version_told_and_an_error_too() {
    let mut desk = Desk::new();
    desk.text(1, SPHERE);
    desk.until("version 1 is shown", |desk| desk.shown(1) == Some(true));
    desk.until("values are told", |desk| {
        desk.heard
            .iter()
            .any(|event| matches!(event, Event::Values { values, .. } if values["r"] == [1.0]))
    });
    desk.text(2, "surface s(u,v) = (u, ");
    desk.until("version 2 has errors", |desk| desk.shown(2) == Some(false));
    assert!(desk.shows("stale: the program has errors"));
    desk.text(3, SPHERE);
    desk.until("version 3 is shown", |desk| desk.shown(3) == Some(true));
    assert!(!desk.shows("stale"));
}

#[test]
fn of_texts_in_a_burst_the_last_one_is_shown() {
    let mut desk = Desk::new();
    for version in 1..=200 {
        desk.text(version, &format!("point p = (0, 0, {version});\n"));
    }
    desk.until("the last one is shown", |desk| {
        desk.shown(200) == Some(true)
    });
    let compiled = desk.harness.state().counters().compiled;
    assert!(compiled <= 200, "{compiled}");
}

#[test]
fn the_cursor_highlights_a_double_click_opens_and_a_value_is_written() {
    let mut desk = Desk::new();
    desk.text(7, SPHERE);
    desk.until("it is shown", |desk| desk.shown(7) == Some(true));
    let offset = SPHERE.find("point p").expect("there") as u32 + 6;
    desk.tell(&Command::Cursor { version: 7, offset });
    desk.until("p is highlighted", |desk| {
        desk.harness.state().model().highlighted.as_deref() == Some("p")
    });

    let middle = desk
        .harness
        .get_all_by_label_contains("3D view of ")
        .next()
        .expect("a view")
        .rect()
        .center();
    let at = middle + vec2(20.0, 10.0);
    desk.harness.hover_at(at);
    desk.harness.step();
    for pressed in [true, false, true, false] {
        desk.harness.event(egui::Event::PointerButton {
            pos: at,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        });
        desk.harness.step();
    }
    desk.until("its declaration is asked for", |desk| {
        desk.heard
            .iter()
            .any(|event| matches!(event, Event::Open { .. }))
    });
    let start = SPHERE.find("s(u,v)").expect("there") as u32;
    let open = Event::Open {
        version: 7,
        range: [start, start + 1],
    };
    assert!(desk.heard.contains(&open), "{:?}", desk.heard);

    desk.harness.get_by_label("Write r into the text").click();
    let write = Event::Write {
        version: 7,
        param: "r".to_owned(),
        value: vec![1.0],
    };
    desk.until("the value is to be written", |desk| {
        desk.heard.contains(&write)
    });
}

#[test]
fn show_opens_the_view_that_is_named() {
    let mut desk = Desk::new();
    desk.text(1, SPHERE);
    desk.until("it is shown", |desk| desk.shown(1) == Some(true));
    desk.harness.get_by_label("View").click();
    desk.harness.run_steps(3);
    desk.harness.get_by_label("Geodesic view of s").click();
    desk.harness.run_steps(3);
    desk.harness.key_press(Key::Escape);
    desk.until("it is closed", |desk| {
        desk.harness.state().model().view.closed.contains("s")
    });
    desk.tell(&Command::Show {
        view: Some(View::Geodesic {
            surface: "s".to_owned(),
        }),
    });
    desk.until("it is open", |desk| desk.shows("Geodesic view of s from"));
}

#[test]
fn a_server_that_is_gone_is_told_and_the_picture_stays() {
    let mut desk = Desk::new();
    desk.text(1, SPHERE);
    desk.until("it is shown", |desk| desk.shown(1) == Some(true));
    drop(desk.server.take());
    desk.until("it is told", |desk| desk.shows("The editor has gone"));
    desk.until("its picture stays", |desk| {
        desk.shows("3D view of 2 objects") && desk.harness.state().model().view.space.is_some()
    });
    // And the window can still be used.
    let before = desk
        .harness
        .state()
        .model()
        .view
        .space
        .expect("a camera")
        .eye;
    desk.harness.key_down(Key::W);
    desk.harness.run_steps(5);
    desk.harness.key_up(Key::W);
    desk.harness.run_steps(5);
    assert_ne!(
        desk.harness
            .state()
            .model()
            .view
            .space
            .expect("a camera")
            .eye,
        before
    );
    let names: Vec<_> = desk
        .harness
        .root()
        .children_recursive()
        .filter_map(|it| it.accesskit_node().label())
        .collect();
    assert!(!names.is_empty());
}

#[test]
fn another_version_of_the_messages_is_told_in_a_sentence() {
    let mut desk = Desk::new();
    // The greeting of `Desk` was right; a second window gets a wrong one.
    let (input, mut server) = std::io::pipe().expect("a pipe");
    let (_listener, output) = std::io::pipe().expect("a pipe");
    say(
        &mut server,
        &Command::Hello(Hello {
            protocol: 9999,
            program: "9.9".to_owned(),
        }),
    );
    let context = egui::Context::default();
    *desk.harness.state_mut() = Window::attached(&context, input, output);
    desk.until("it is told", |desk| {
        desk.shows("The editor has gone") && desk.shows("9999")
    });
}
