//! The colours of the lines of overlays, by the medium of the picture.

use crate::style::Theme;
use crate::trail::TrailKind;

/// Colours of lines, sRGB.
#[derive(Clone, Copy, Debug)]
pub(super) struct Inks {
    /// Wavefronts.
    pub(super) wave: [u8; 3],
    /// Conjugate points.
    pub(super) conjugate: [u8; 3],
    /// The cut locus: clearly different from the colours of geodesics.
    pub(super) cut: [u8; 3],
    /// The axes of a geodesic camera's picture, to the right and up.
    pub(super) axes: [[u8; 3]; 2],
    /// The border of a geodesic camera's picture.
    pub(super) border: [u8; 3],
    /// The path of a geodesic camera.
    walked: [u8; 3],
    /// The lines of a figure.
    measured: [u8; 3],
}

/// On a screen.
const SCREEN: Inks = Inks {
    wave: [110, 255, 245],
    conjugate: [255, 70, 200],
    cut: [160, 40, 255],
    axes: [[255, 80, 60], [70, 220, 90]],
    border: [255, 210, 60],
    walked: [150, 130, 255],
    measured: [200, 255, 60],
};

/// On paper: their contrast to white is at least 4.5.
const PRINT: Inks = Inks {
    wave: [0, 115, 130],
    conjugate: [200, 0, 110],
    cut: [150, 30, 250],
    axes: [[190, 60, 30], [20, 125, 40]],
    border: [150, 95, 0],
    walked: [90, 70, 190],
    measured: [85, 110, 0],
};

impl Inks {
    /// Returns the colours of a medium.
    pub(super) fn of(theme: Theme) -> Self {
        match theme {
            Theme::Screen => SCREEN,
            Theme::Print => PRINT,
        }
    }

    /// Returns the colour of a trail.
    pub(super) fn trail(&self, kind: &TrailKind) -> [u8; 3] {
        match kind {
            TrailKind::Walked => self.walked,
            TrailKind::Measured(_) => self.measured,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::style;

    #[test]
    fn lines_on_paper_contrast_with_it() {
        let Inks {
            wave,
            conjugate,
            cut,
            axes: [right, up],
            border,
            walked,
            measured,
        } = Inks::of(Theme::Print);
        for colour in [wave, conjugate, cut, right, up, border, walked, measured] {
            let [r, g, b] = style::linear(colour);
            let contrast = 1.05 / (0.2126 * r + 0.7152 * g + 0.0722 * b + 0.05);
            assert!(contrast >= 4.5, "{colour:?}: {contrast}");
        }
    }

    #[test]
    fn the_cut_locus_has_a_colour_that_no_geodesic_has() {
        let on_screen: [&[[u8; 3]]; 2] =
            [&style::CURVE_COLOURS, &style::CURVE_COLOURS_ON_CURVATURE];
        let on_paper: [&[[u8; 3]]; 2] = [
            &style::CURVE_COLOURS_ON_PAPER,
            &style::CURVE_COLOURS_ON_CURVATURE_ON_PAPER,
        ];
        for (theme, palettes) in [(Theme::Screen, on_screen), (Theme::Print, on_paper)] {
            let inks = Inks::of(theme);
            let lines = [inks.wave, inks.conjugate];
            for colour in palettes.concat().into_iter().chain(lines) {
                let off = (0..3).map(|k| u32::from(colour[k].abs_diff(inks.cut[k])));
                assert!(off.sum::<u32>() > 150, "{colour:?}");
            }
        }
    }
}
