//! A window that an editor's server feeds: what it receives, and what it sends.

use std::io::{BufRead, BufReader, PipeReader, PipeWriter, Write};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use egui::{Key, Modifiers, PointerButton, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT, Queryable};
use preview::Window;
use protocol::{Command, Event, Hello, ViewName};

use crate::hand::{FRAME, SPHERE};

struct Desk {
    harness: Harness<'static, Window>,
    server: Option<PipeWriter>,
    events: Receiver<Event>,
    received: Vec<Event>,
}

impl Desk {
    fn new() -> Self {
        let (input, mut server) = std::io::pipe().expect("a pipe");
        let (listener, output) = std::io::pipe().expect("a pipe");
        write(&mut server, &Command::Hello(Hello::own()));
        let (sender, events) = channel();
        std::thread::spawn(move || listen(listener, &sender));
        let mut ends = Some((input, output));
        let mut window: Option<Window> = None;
        let context = egui::Context::default();
        let (input, output) = ends.take().expect("both");
        let attached = Window::attached(
            &context,
            ide::Languages::standard(),
            render::Views::standard(),
            input,
            output,
        );
        window.replace(attached.expect("its threads start"));
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
            received: Vec::new(),
        }
    }

    fn send(&mut self, command: &Command) {
        write(self.server.as_mut().expect("not closed"), command);
    }

    fn text(&mut self, version: i32, text: &str) {
        self.text_of("file:///nowhere/a.gtr", None, version, text);
    }

    fn text_of(&mut self, uri: &str, path: Option<&str>, version: i32, text: &str) {
        self.send(&Command::Text {
            uri: uri.to_owned(),
            path: path.map(str::to_owned),
            version,
            text: text.into(),
        });
    }

    fn show_inside(&mut self, surface: &str) {
        self.send(&Command::Show {
            view: Some(ViewName::of_object("geodesic", surface)),
        });
    }

    /// The sentences for the user so far.
    fn messages(&self) -> Vec<&str> {
        let received = self.received.iter();
        let texts = received.filter_map(|event| match event {
            Event::Message { text, .. } => Some(text.as_str()),
            _ => None,
        });
        texts.collect()
    }

    fn until(&mut self, what: &str, mut holds: impl FnMut(&Self) -> bool) {
        let begun = Instant::now();
        loop {
            self.harness.step();
            while let Ok(event) = self.events.try_recv() {
                self.received.push(event);
            }
            if holds(self) {
                return;
            }
            assert!(
                begun.elapsed() < Duration::from_secs(60),
                "{what}: {:?}",
                self.received
            );
            std::thread::sleep(Duration::from_millis(2));
        }
    }

    fn shown(&self, wanted: i32) -> Option<bool> {
        self.received.iter().find_map(|event| match event {
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

fn write(server: &mut PipeWriter, command: &Command) {
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
fn a_text_is_shown_and_its_version_reported_and_an_error_too() {
    let mut desk = Desk::new();
    desk.text(1, SPHERE);
    desk.until("version 1 is shown", |desk| desk.shown(1) == Some(true));
    desk.until("values are sent", |desk| {
        desk.received
            .iter()
            .any(|event| matches!(event, Event::Values { values, .. } if values["r"] == [1.0]))
    });
    desk.text(2, "surface s(u,v) = (u, ");
    desk.until("version 2 has errors", |desk| desk.shown(2) == Some(false));
    desk.until("it is reported after a pause", |desk| {
        desk.shows("out of date until the error is fixed")
    });
    desk.text(3, SPHERE);
    desk.until("version 3 is shown", |desk| desk.shown(3) == Some(true));
    assert!(!desk.shows("out of date"));
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
}

#[test]
fn the_cursor_highlights_a_double_click_opens_and_a_value_is_written() {
    let mut desk = Desk::new();
    desk.text(7, SPHERE);
    desk.until("it is shown", |desk| desk.shown(7) == Some(true));
    let offset = SPHERE.find("point p").expect("there") as u32 + 6;
    desk.send(&Command::Cursor { version: 7, offset });
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
        desk.received
            .iter()
            .any(|event| matches!(event, Event::Open { .. }))
    });
    let start = SPHERE.find("s(u,v)").expect("there") as u32;
    let open = Event::Open {
        version: 7,
        range: [start, start + 1],
    };
    assert!(desk.received.contains(&open), "{:?}", desk.received);

    desk.harness.get_by_label("More for r").click();
    desk.harness.run_steps(3);
    desk.harness.get_by_label("Update the text").click();
    let write = Event::Write {
        version: 7,
        param: "r".to_owned(),
        value: vec![1.0],
    };
    desk.until("the value is to be written", |desk| {
        desk.received.contains(&write)
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
        desk.harness
            .state()
            .model()
            .choices
            .closed
            .contains("geodesic:s")
    });
    desk.show_inside("s");
    desk.until("it is open", |desk| desk.shows("Geodesic view of s from"));
    assert!(desk.messages().is_empty());
}

#[test]
fn a_view_of_no_surface_is_answered_with_a_sentence_and_opens_nothing() {
    let mut desk = Desk::new();
    // Both before the text has been read, and behind it.
    for version in 1..=2 {
        desk.text(version, SPHERE);
        desk.show_inside("nosuch");
        desk.until("it is reported", |desk| {
            desk.messages().len() == version as usize
        });
        desk.until("it is shown", |desk| desk.shown(version) == Some(true));
        assert!(!desk.shows("Geodesic view – nosuch"));
    }
    let wanted = "There is no surface, metric or solid `nosuch`: the program has s.";
    assert_eq!(desk.messages(), [wanted; 2]);
    assert!(desk.shows(wanted), "and in the window");
    // What is no surface is none, and a program may have none at all.
    desk.show_inside("p");
    desk.until("it is reported", |desk| desk.messages().len() == 3);
    desk.text(3, &SPHERE.replace("r + 1)", ""));
    desk.show_inside("t");
    desk.until("it is reported", |desk| desk.messages().len() == 4);
    let wanted = "There is no surface, metric or solid `t`: the program has s, and errors.";
    assert_eq!(desk.messages()[3], wanted);
}

#[test]
fn a_view_of_a_surface_that_was_just_written_opens_when_it_is_read() {
    let mut desk = Desk::new();
    desk.text(1, SPHERE);
    desk.until("it is shown", |desk| desk.shown(1) == Some(true));
    let mut text = String::from(SPHERE);
    for k in 0..20 {
        text += &format!("surface t{k}(u,v) = (u, v, {k}), u : [0, 1], v : [0, 1];\n");
    }
    // As a command from an editor comes: directly behind the text. Of many surfaces only the first have views unasked.
    desk.text(2, &text);
    desk.show_inside("t19");
    desk.until("it is open", |desk| desk.shows("Geodesic view of t19 from"));
    assert!(desk.messages().is_empty(), "{:?}", desk.messages());
}

#[test]
fn the_window_is_called_like_its_document() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("my surface.gtr");
    let path = path.to_str().expect("UTF-8");
    for (uri, path, title) in [
        (
            "file:///nowhere/my%20surface.gtr",
            Some(path),
            "my surface.gtr – Geotrace",
        ),
        ("untitled:Untitled-1", None, "Untitled-1 – Geotrace"),
        ("memfs:/a/b.gtr", None, "b.gtr – Geotrace"),
    ] {
        let mut desk = Desk::new();
        assert_eq!(desk.harness.state().title(), "Geotrace");
        desk.text_of(uri, path, 1, SPHERE);
        desk.until("it is shown", |desk| desk.shown(1) == Some(true));
        assert_eq!(desk.harness.state().title(), title);
    }
}

#[test]
fn a_server_that_is_gone_is_reported_and_the_picture_stays() {
    let mut desk = Desk::new();
    desk.text(1, SPHERE);
    desk.until("it is shown", |desk| desk.shown(1) == Some(true));
    drop(desk.server.take());
    let sentence = "The language server has exited; the picture shows its last text.";
    desk.until("it is reported", |desk| desk.shows(sentence));
    desk.until("its picture stays", |desk| {
        desk.shows("3D view of 2 objects") && desk.harness.state().model().choices.space.is_some()
    });
    // And the window can still be used.
    let before = desk
        .harness
        .state()
        .model()
        .choices
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
            .choices
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
fn another_version_of_the_messages_is_reported_in_a_sentence() {
    let mut desk = Desk::new();
    // The greeting of `Desk` was right; a second window gets a wrong one.
    let (input, mut server) = std::io::pipe().expect("a pipe");
    let (_listener, output) = std::io::pipe().expect("a pipe");
    write(
        &mut server,
        &Command::Hello(Hello {
            protocol: 9999,
            program: "9.9".to_owned(),
        }),
    );
    let context = egui::Context::default();
    *desk.harness.state_mut() = Window::attached(
        &context,
        ide::Languages::standard(),
        render::Views::standard(),
        input,
        output,
    )
    .expect("its threads start");
    desk.until("it is reported", |desk| {
        desk.shows(
            "The language server (geotrace 9.9) speaks version 9999 of the preview's messages",
        )
    });
    assert!(!desk.shows("has gone") && !desk.shows("last picture"));
}
