//! Image files that are small and have many pixels.

use std::io::{BufWriter, Write};
use std::path::Path;

use render::texture::{TexelBudget, Texture};

use crate::mutation::Random;
use crate::run::Report;

/// The longest side, in pixels.
const LONGEST: usize = 24_000;

/// Writes black images, some of which end too early, and decodes them.
pub(super) fn bombs(seed: u64, count: u64) -> Report {
    let mut random = Random::new(seed);
    let mut report = Report::default();
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("bomb.png");
    for _ in 0..count {
        // Most images are small, and each size is as likely as half of it.
        let mut side = || ((1 + random.below(LONGEST)) >> random.below(8)).max(1) as u32;
        let [width, height] = [side(), side()];
        let is_cut = random.below(4) == 0;
        report.attempt(format!("{width}x{height} {is_cut}").as_bytes(), || {
            write(&path, width, height);
            if is_cut {
                let length = std::fs::metadata(&path).expect("a file").len();
                let file = std::fs::File::options().write(true).open(&path);
                file.and_then(|it| it.set_len(length / 2)).expect("cut");
            }
            match Texture::load(&path, &TexelBudget::default()) {
                Ok(texture) => assert!(!texture.levels().is_empty(), "a texture has levels"),
                Err(error) => assert!(!error.to_string().is_empty(), "a sentence"),
            }
            0
        });
    }
    report
}

fn write(path: &Path, width: u32, height: u32) {
    let file = BufWriter::new(std::fs::File::create(path).expect("a file"));
    let mut encoder = png::Encoder::new(file, width, height);
    encoder.set_color(png::ColorType::Grayscale);
    encoder.set_depth(png::BitDepth::One);
    let mut writer = encoder.write_header().expect("a head");
    let mut rows = writer.stream_writer().expect("a stream");
    let row = vec![0; width.div_ceil(8) as usize];
    for _ in 0..height {
        rows.write_all(&row).expect("a row");
    }
    rows.finish().expect("the end");
}
