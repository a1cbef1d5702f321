//! The targets, one module for each subject.

mod document;
mod expression;
mod messages;
mod picture;
mod program;
mod requests;
mod settings;
mod texture;

use crate::seeds;

/// A function that any bytes may be given to.
#[derive(Clone, Copy)]
pub struct Target {
    /// A name for the command line.
    pub name: &'static str,
    /// What holds for all inputs, in a sentence.
    pub about: &'static str,
    /// The inputs to begin with.
    pub seeds: fn() -> Vec<Vec<u8>>,
    /// Pieces that mutation puts in.
    pub words: &'static [&'static str],
    /// Panics where something is wrong.
    pub run: fn(&[u8]),
    /// The number of mutated inputs in the tests.
    pub tested: u64,
    /// The number of mutated inputs of a whole attack.
    pub full: u64,
}

impl std::fmt::Debug for Target {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name)
    }
}

/// All targets.
pub const TARGETS: &[Target] = &[
    Target {
        name: "program",
        about: "a program is read, and every feature of an editor answers with places of its text",
        seeds: seeds::programs,
        words: program::WORDS,
        run: program::geotrace,
        tested: 3_000,
        full: 1_000_000,
    },
    Target {
        name: "script",
        about: "a CRT script is read, and every feature of an editor answers with places of its text",
        seeds: seeds::scripts,
        words: program::SCRIPT_WORDS,
        run: program::crt,
        tested: 1_500,
        full: 100_000,
    },
    Target {
        name: "edits",
        about: "an edited program has the diagnostics and tokens of its text",
        seeds: seeds::programs,
        words: program::WORDS,
        run: document::edits,
        tested: 2_000,
        full: 100_000,
    },
    Target {
        name: "format",
        about: "layout is idempotent and changes neither tokens nor diagnostics",
        seeds: seeds::programs,
        words: program::WORDS,
        run: document::format,
        tested: 3_000,
        full: 100_000,
    },
    Target {
        name: "expression",
        about: "simplified values and intervals are those of the expression as it stands, its derivative is among its slopes, its WGSL is valid",
        seeds: expression::seeds,
        words: &[],
        run: expression::run,
        tested: 20_000,
        full: 1_000_000,
    },
    Target {
        name: "picture",
        about: "what compiles is drawn in every view, or refused with a sentence",
        seeds: seeds::programs,
        words: program::WORDS,
        run: picture::run,
        tested: 400,
        full: 10_000,
    },
    Target {
        name: "server",
        about: "the language server answers or ends, whatever its input is",
        seeds: messages::conversations,
        words: messages::WORDS,
        run: messages::server,
        tested: 1_000,
        full: 50_000,
    },
    Target {
        name: "requests",
        about: "the language server answers every request, whatever its method and the types of its params",
        seeds: requests::seeds,
        words: &[],
        run: requests::run,
        tested: 1_000,
        full: 50_000,
    },
    Target {
        name: "protocol",
        about: "a window's messages are read, and composed edits have the effect of all of them",
        seeds: messages::lines,
        words: messages::WORDS,
        run: messages::protocol,
        tested: 20_000,
        full: 1_000_000,
    },
    Target {
        name: "settings",
        about: "the file beside a program is read or refused, and what was read is written as it was read",
        seeds: settings::seeds,
        words: settings::WORDS,
        run: settings::run,
        tested: 20_000,
        full: 1_000_000,
    },
    Target {
        name: "texture",
        about: "an image is decoded or refused with a sentence",
        seeds: seeds::pictures,
        words: &[
            "IHDR",
            "IDAT",
            "IEND",
            "PLTE",
            "tRNS",
            "\u{0}\u{0}\u{0}\u{1}",
        ],
        run: texture::run,
        tested: 400,
        full: 20_000,
    },
];

/// Reads a program and asks for everything, and draws it where it compiles.
pub(crate) fn read_and_draw(program: &[u8]) {
    self::program::geotrace(program);
    picture::run(program);
}

/// The target of a name.
pub fn target(name: &str) -> Option<&'static Target> {
    TARGETS.iter().find(|target| target.name == name)
}
