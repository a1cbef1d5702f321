//! The preview as an editor meets it: the binary as language server, and the window that it starts.
//!
//! A time is that from the moment before an edit is written to the server to the moment after it has reported that the
//! window shows the pictures of that text: three processes, their pipes and whatever else the machine does are part of
//! it. The window's own share, from reading the text on, is printed beside it, and what a frame of the window takes to be
//! laid out and handed to the driver: that of the pictures is still before it when it is reported.

use std::time::{Duration, Instant};

use crate::latency::{SCRIPT_URI, Session, URI, behind, memory_of, print, print_within};
use crate::measure::megabytes;

/// Edits of each kind.
const EDITS: usize = 200;
/// The longest that the edits of a kind take.
const ENOUGH: Duration = Duration::from_secs(60);
/// Between two keys of a hand that types ten a second.
const PAUSE: Duration = Duration::from_millis(100);
/// Hovers while the window has more to do than it can.
const HOVERS: usize = 200;
/// Edits after which memory is read.
const MANY: [usize; 6] = [10, 100, 1_000, 2_000, 5_000, MOST];
/// Edits in all.
const MOST: usize = 10_000;
/// An editor that asks for a report of each picture.
const CAPABILITIES: &str = r#"{"experimental":{"geotrace":{"shown":true}}}"#;

const TORUS: &str = "\
param r = 0.5 : [0.4, 0.9];
surface s(u,v) = ((1 + r cos v) cos u, (1 + r cos v) sin u, r sin v), u : [0, 2pi], v : [0, 2pi];
";

/// A die on a mirror under two lights.
const DIE: &str = "\
param ball = 0.65 : [0.5, 0.8];
solid cube(x,y,z) = max(abs x, abs y, abs z) - 1/2, color : (0.9, 0.8, 0.6);
solid round(x,y,z) = x^2 + y^2 + z^2 - ball^2, color : (0.8, 0.2, 0.3);
solid die = cube \\ round;
solid ground(x,y,z) = z + 0.5, mirror : 0.3;
light lamp = @ (2, -3, 4);
light other = @ (-3, -2, 3), power : 0.4;
camera front = (0, 1, -0.4) @ (0.8, -3, 1.4);
";
/// The example of a carved box, a script.
const CARVED: &str = include_str!("../../examples/carved_box.crt");

/// So many waves, one above the other.
fn waves(count: usize) -> String {
    (0..count)
        .map(|k| {
            format!(
                "surface s{k}(u,v) = (u, v, {k} + 0.2 sin(3u) cos(2v)), u : [-1, 1, 40], v : [-1, 1, 40];\n"
            )
        })
        .collect()
}

/// A server, a window that shows a text, and how long both took to its first frame.
fn opened(text: &str) -> std::io::Result<(Session, Duration)> {
    opened_in(URI, text, "3d")
}

/// As [`opened`], of a document in either language, in a view of the whole scene.
fn opened_in(uri: &'static str, text: &str, view: &str) -> std::io::Result<(Session, Duration)> {
    let (mut session, _) = Session::start_as(CAPABILITIES)?;
    session.open_as(uri, text)?;
    let start = Instant::now();
    session.ask(
        "workspace/executeCommand",
        &format!(r#"{{"command":"geotrace.preview","arguments":["{uri}",{{"view":"{view}"}}]}}"#),
    )?;
    shown(&mut session)?;
    Ok((session, start.elapsed()))
}

/// Waits for the frame of the current version; the window's own share of the time and what a frame takes, in milliseconds.
fn shown(session: &mut Session) -> std::io::Result<[f64; 2]> {
    let version = format!("\"version\":{},", session.version());
    let other = format!("\"version\":{}}}", session.version());
    loop {
        let message = session.wait(&["\"method\":"])?;
        if message.contains("window/showMessage") {
            return Err(std::io::Error::other(message));
        }
        if message.contains("geotrace/shown")
            && (message.contains(&version) || message.contains(&other))
        {
            return Ok(["\"milliseconds\":", "\"painting\":"].map(|key| {
                let rest = message.split(key).nth(1);
                let digits = rest.and_then(|rest| rest.split([',', '}']).next());
                digits.and_then(|d| d.parse().ok()).unwrap_or(f64::NAN)
            }));
        }
    }
}

/// Inserts a text and takes it out again, in turn: how long until the frame is there. First as a hand types, then each
/// edit as soon as the one before has been shown, while what was shown may still be drawn.
fn edits(session: &mut Session, what: &str, at: [usize; 2], inserted: &str) {
    typed(
        session,
        &format!("{what}, ten a second"),
        at,
        inserted,
        PAUSE,
    );
    typed(
        session,
        &format!("{what}, at once"),
        at,
        inserted,
        Duration::ZERO,
    );
}

fn typed(session: &mut Session, what: &str, at: [usize; 2], inserted: &str, pause: Duration) {
    let [line, column] = at;
    let mut own = Vec::new();
    print_within(ENOUGH, what, EDITS, |k| {
        std::thread::sleep(pause);
        let start = Instant::now();
        if k.is_multiple_of(2) {
            session.change(line, [column, column], inserted)?;
        } else {
            session.change(line, [column, column + inserted.len()], "")?;
        }
        own.push(shown(session)?);
        Ok(start.elapsed())
    });
    for (k, what) in ["  the window's share", "  a frame of the window"]
        .into_iter()
        .enumerate()
    {
        let mut times: Vec<f64> = own.iter().map(|it| it[k]).collect();
        times.sort_unstable_by(f64::total_cmp);
        let at = |share: f64| times.get((times.len() as f64 * share) as usize).copied();
        println!(
            "    {:<44} p50 {:>9.3} ms   p99 {:>9.3} ms",
            what,
            at(0.5).unwrap_or(f64::NAN),
            at(0.99).unwrap_or(f64::NAN)
        );
    }
}

fn measure() -> std::io::Result<()> {
    let (mut session, cold) = opened(TORUS)?;
    println!(
        "    {:<44} {:>13.0} ms",
        "from the command to the first frame",
        1e3 * cold.as_secs_f64()
    );
    // An odd number of edits would leave the text changed: `print` makes 20 more than are asked for.
    edits(
        &mut session,
        "a param's value",
        behind(TORUS, "r = 0.5"),
        "1",
    );
    session.quit()?;
    let (mut session, _) = opened(TORUS)?;
    edits(
        &mut session,
        "the only surface",
        behind(TORUS, "(1 + r cos v) cos u"),
        "+0",
    );
    session.quit()?;

    for (uri, text, place, what) in [
        (URI, DIE, "ball = 0.65", "a number of a traced solid"),
        (
            SCRIPT_URI,
            CARVED,
            "radius -> 1.38",
            "a number of a traced script",
        ),
    ] {
        let (mut session, _) = opened_in(uri, text, "traced")?;
        edits(&mut session, what, behind(text, place), "1");
        session.quit()?;
    }

    let text = waves(20);
    let (mut session, _) = opened(&text)?;
    edits(
        &mut session,
        "one of twenty surfaces",
        behind(&text, "v, 7 + 0.2"),
        "1",
    );

    // The window is given more than it can draw, and the editor asks on.
    let [line, column] = behind(&text, "v, 7 + 0.2");
    let hover =
        format!(r#"{{"textDocument":{{"uri":"{URI}"}},"position":{{"line":3,"character":9}}}}"#);
    print("a hover while the window is saturated", HOVERS, |k| {
        for _ in 0..5 {
            session.change(line, [column, column], "1")?;
            session.change(line, [column, column + 1], "")?;
        }
        let _ = k;
        let start = Instant::now();
        session.ask("textDocument/hover", &hover)?;
        Ok(start.elapsed())
    });
    session.quit()
}

/// Edits one of twenty surfaces, each time to a text that was not there before, and waits for each frame.
fn grow() -> std::io::Result<()> {
    let text = waves(20);
    let (mut session, _) = opened(&text)?;
    let [line, column] = behind(&text, "v, 7 + 0.2");
    let window = session.children().first().copied();
    let Some(window) = window else {
        return Err(std::io::Error::other("the window's process is not known"));
    };
    let start = Instant::now();
    let mut digits = 0;
    for made in 1..=MOST {
        let next = format!("{made:05}");
        session.change(line, [column, column + digits], &next)?;
        digits = next.len();
        shown(&mut session)?;
        if MANY.contains(&made) {
            let [now, most] = memory_of(window);
            println!(
                "    after {made:>6} edits {:>7.1} MB, at most {:.1} MB, {:.0} s",
                megabytes(now),
                megabytes(most),
                start.elapsed().as_secs_f64()
            );
        }
    }
    session.quit()
}

/// Prints the table of times.
pub(crate) fn run() {
    println!("The preview, from an edit that is sent to its frame in the window");
    with_display(measure);
}

/// Prints how the window's memory grows.
pub(crate) fn growth() {
    println!("The window's memory, each of so many edits shown (takes half an hour without a GPU)");
    with_display(grow);
}

fn with_display(run: impl FnOnce() -> std::io::Result<()>) {
    if std::env::var_os("DISPLAY").is_none() && std::env::var_os("WAYLAND_DISPLAY").is_none() {
        println!(
            "  there is no display; `xvfb-run -a cargo run --release -p geotrace-benches preview` makes one"
        );
        return;
    }
    if let Err(error) = run() {
        println!("  it has ended: {error}");
    }
}
