//! Comparison of pictures.

use std::path::PathBuf;

use image::RgbaImage;

use crate::examples::repository;
use crate::writes_expected;

/// How much two pictures differ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// The share of pixels, 0 to 1, of which a channel differs by more than the threshold.
    pub share: f64,
    /// The mean of the absolute differences of all channels, 0 to 255.
    pub mean: f64,
}

/// Compares two pictures of one size, pixel by pixel.
///
/// # Panics
/// When the sizes differ.
#[track_caller]
pub fn difference(a: &RgbaImage, b: &RgbaImage, threshold: u8) -> Difference {
    assert_eq!(a.dimensions(), b.dimensions(), "the pictures' sizes differ");
    let mut beyond = 0_u64;
    let mut sum = 0_u64;
    for (a, b) in a.pixels().zip(b.pixels()) {
        let distances = a.0.iter().zip(&b.0).map(|(a, b)| a.abs_diff(*b));
        sum += distances.clone().map(u64::from).sum::<u64>();
        beyond += u64::from(distances.max().is_some_and(|most| most > threshold));
    }
    let count = f64::from(a.width()) * f64::from(a.height());
    Difference {
        share: beyond as f64 / count,
        mean: sum as f64 / (4.0 * count),
    }
}

/// Compares a picture with `cases/pictures/NAME.png`, which `UPDATE=1` writes anew.
///
/// # Panics
/// When more than `share` of the pixels differ by more than 12 of 255 in a channel; the picture then lies in
/// the folder for temporary files.
#[track_caller]
pub fn assert_golden(name: &str, picture: &RgbaImage, share: f64) {
    let path = repository().join(format!("tests/cases/pictures/{name}.png"));
    if writes_expected() {
        picture.save(&path).expect("the golden picture is writable");
        return;
    }
    let golden = image::open(&path)
        .unwrap_or_else(|error| panic!("{}: {error}", path.display()))
        .to_rgba8();
    let difference = difference(picture, &golden, 12);
    if difference.share > share {
        let actual = actual_path(name);
        picture.save(&actual).expect("the picture is writable");
        panic!(
            "{name}: {:.2} % of the pixels differ from {}; see {}",
            100.0 * difference.share,
            path.display(),
            actual.display()
        );
    }
}

fn actual_path(name: &str) -> PathBuf {
    std::env::temp_dir().join(format!("geotrace-{name}.png"))
}

#[cfg(test)]
mod tests {
    use super::difference;
    use image::{Rgba, RgbaImage};

    #[test]
    fn equal_pictures_do_not_differ_and_others_do() {
        let black = RgbaImage::from_pixel(4, 4, Rgba([0, 0, 0, 255]));
        let mut other = black.clone();
        assert_eq!(difference(&black, &other, 0).share, 0.0);
        other.put_pixel(1, 2, Rgba([0, 40, 0, 255]));
        let found = difference(&black, &other, 12);
        assert_eq!(found.share, 1.0 / 16.0);
        assert_eq!(found.mean, 40.0 / 64.0);
        assert_eq!(difference(&black, &other, 40).share, 0.0);
    }
}
