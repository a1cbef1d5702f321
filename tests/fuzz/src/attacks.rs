//! Attacks that need more than bytes: processes that are killed, disks that are full, options, programs without bounds.

mod commands;
mod files;
mod hostile;
mod images;
mod sessions;

use crate::run::Report;

/// A number of attempts at the program.
#[derive(Clone, Copy)]
pub struct Attack {
    /// A name for the command line.
    pub name: &'static str,
    /// What is tried and what must hold, in a sentence.
    pub about: &'static str,
    /// Makes so many attempts, of the sequence of a seed.
    pub run: fn(seed: u64, count: u64) -> Report,
    /// The number of attempts in the tests; 0 for what another test tries.
    pub tested: u64,
    /// The number of attempts of a whole attack.
    pub full: u64,
}

impl std::fmt::Debug for Attack {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name)
    }
}

/// All attacks.
pub const ATTACKS: &[Attack] = &[
    Attack {
        name: "utf-8",
        about: "edits through the language server in bytes, against the text alone; sessions of 1,000",
        run: sessions::utf_8,
        tested: 0,
        full: 100_000,
    },
    Attack {
        name: "utf-16",
        about: "the same in code units",
        run: sessions::utf_16,
        tested: 0,
        full: 100_000,
    },
    Attack {
        name: "utf-32",
        about: "the same in characters",
        run: sessions::utf_32,
        tested: 0,
        full: 100_000,
    },
    Attack {
        name: "unread",
        about: "requests whose answers are read late: the server holds few of them, and answers all; thousands at once",
        run: sessions::unread,
        tested: 0,
        full: 20_000,
    },
    Attack {
        name: "long",
        about: "requests about programs that are one expression, or one line: each is answered; the time is that of ten of them",
        run: sessions::long,
        tested: 0,
        full: 60,
    },
    Attack {
        name: "metric",
        about: "random metrics are checked and drawn from inside",
        run: hostile::metrics,
        tested: 150,
        full: 10_000,
    },
    Attack {
        name: "trace",
        about: "`trace --format json` on random metrics and surfaces: a status, JSON without NaN",
        run: commands::traces,
        tested: 40,
        full: 5_000,
    },
    Attack {
        name: "options",
        about: "random options: status 0, 1 or 2, a sentence, and no file where it failed",
        run: commands::options,
        tested: 60,
        full: 2_000,
    },
    Attack {
        name: "huge",
        about: "programs without bounds with each command: an end, or a sentence",
        run: commands::huge,
        tested: 0,
        full: hostile::HUGE.len() as u64 * commands::HUGE_COMMANDS.len() as u64,
    },
    Attack {
        name: "bomb",
        about: "small image files with many pixels: decoded, or refused before that",
        run: images::bombs,
        tested: 4,
        full: 200,
    },
    Attack {
        name: "kill",
        about: "kills while files are written: the old file or the new one, whole; TERM and INT leave nothing else",
        run: files::kills,
        tested: 40,
        full: 1_000,
    },
    Attack {
        name: "writers",
        about: "two processes write one file: it is that of one of them",
        run: files::writers,
        tested: 4,
        full: 200,
    },
    Attack {
        name: "full disk",
        about: "a disk that is full at a random byte: a sentence, the old file, and nothing else",
        run: files::full_disks,
        tested: 40,
        full: 1_000,
    },
];
