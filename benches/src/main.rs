//! Run times and peak memory, printed as tables: `cargo run --release -p geotrace-benches [PART…]`.
//!
//! Parts: `front` (checking and parsing), `editing` (keystrokes in long programs, beside
//! tree-sitter), `latency` (the language server, from an edit that is sent to its diagnostics), `preview` (from
//! an edit that is sent to its frame in the window; needs a display, such as `xvfb-run` gives), `growth` (the window's
//! memory over ten thousand edits; likewise), `jets` (positions with derivatives), `klein` (derivatives and WGSL), `render`
//! (both views of every example), `large` (many samples, many vectors), `stage` (frames of a
//! window: camera, param, walk), `walk` (frames of a being that walks inside each example, with the
//! processors' time, and which are over 16 ms), `accuracy` (the geodesic view against the
//! thesis' method, frames while moving, the sphere from ten thousand places), `estimates` (what the geodesic view says of
//! its errors against the truth, over random scenes), `stiff` (the stiff list: ours, its bounds, the
//! thesis' method), `povray` (solids in f64, on a GPU, and by POV-Ray where that is installed; with KEEP=1 the pictures
//! stay), `traced` (traced pictures in f64 and on a GPU), `surfaces` (implicit surfaces of the literature), `scripts` (a long CRT script: read, run,
//! edited; beside POV-Ray). Without a part all but `growth` are run. Times are medians of several runs with their
//! least and greatest; a picture is drawn in a process of its own, so that its peak memory is its own and nothing is
//! warm but the driver's cache on disk.

mod accuracy;
mod editing;
mod estimates;
mod front;
mod jets;
mod klein;
mod latency;
mod measure;
mod pictures;
mod povray;
mod preview;
mod scripts;
mod stage;
mod stiff;
mod surfaces;
mod thesis;
mod traced;

use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    if let Some(("child", rest)) = arguments
        .split_first()
        .map(|(first, rest)| (first.as_str(), rest))
    {
        return pictures::child(rest);
    }
    if cfg!(debug_assertions) {
        println!("This is a debug build: its times mean nothing. Use --release.\n");
    }
    let parts: &[(&str, fn())] = &[
        ("front", front::run),
        ("editing", editing::run),
        ("latency", latency::run),
        ("preview", preview::run),
        ("growth", preview::growth),
        ("jets", jets::run),
        ("klein", klein::run),
        ("render", pictures::examples),
        ("large", pictures::large),
        ("stage", stage::run),
        ("walk", stage::walk),
        ("accuracy", accuracy::run),
        ("estimates", estimates::run),
        ("stiff", stiff::run),
        ("povray", povray::run),
        ("traced", traced::run),
        ("surfaces", surfaces::run),
        ("scripts", scripts::run),
    ];
    for wanted in &arguments {
        if !parts.iter().any(|(name, _)| name == wanted) {
            let names: Vec<&str> = parts.iter().map(|(name, _)| *name).collect();
            eprintln!("no part `{wanted}`: {}", names.join(", "));
            return ExitCode::from(2);
        }
    }
    for (name, run) in parts {
        if arguments.is_empty() && *name != "growth"
            || arguments.iter().any(|wanted| wanted == name)
        {
            run();
            println!();
        }
    }
    ExitCode::SUCCESS
}
