//! Colours for the program pane: by the same highlighter as for editors, laid out for egui, and recomputed only when
//! the text, its errors or the theme have changed.

use std::sync::Arc;

use egui::text::{ByteIndex, LayoutJob, LayoutSection, TextFormat};
use egui::{Color32, FontId, Galley, Stroke, Ui};
use ide::Language;
use ide::highlight::{Highlight, HighlightKind};
use session::Finding;
use syntax::diagnostic::Severity;
use syntax::span::Span;

/// The maximum number of coloured pieces of a text: egui lays out each one separately. A text with more is plain.
const MOST_COLOURED: usize = 50_000;
/// The maximum number of underlined diagnostics in a text.
const MOST_MARKED: usize = 1_000;

/// The last layout.
#[derive(Debug, Default)]
pub(crate) struct Painter {
    text: String,
    highlights: Vec<Highlight>,
    marks: Vec<(Span, Severity)>,
    job: Option<(bool, FontId, LayoutJob)>,
    /// The number of times that the text was read for its colours.
    pub(crate) readings: u64,
}

impl Painter {
    /// Takes over the diagnostics of a text; they are underlined while the text stays the same.
    pub(crate) fn mark(&mut self, findings: &[Finding]) {
        let marked = findings.iter().take(MOST_MARKED);
        let marks = marked.map(|it| (it.span, it.severity)).collect();
        if self.marks != marks {
            self.marks = marks;
            self.job = None;
        }
    }

    /// Returns the laid-out text.
    pub(crate) fn layout(
        &mut self,
        ui: &Ui,
        language: &dyn Language,
        text: &str,
        width: f32,
    ) -> Arc<Galley> {
        if self.text != text || self.readings == 0 {
            text.clone_into(&mut self.text);
            self.highlights = language.highlight(text);
            if self.highlights.len() > MOST_COLOURED {
                self.highlights = Vec::new();
            }
            self.readings += 1;
            self.job = None;
        }
        let font = egui::TextStyle::Monospace.resolve(ui.style());
        let dark = ui.visuals().dark_mode;
        let plain = ui.visuals().text_color();
        let stale = !matches!(&self.job, Some((d, f, _)) if *d == dark && *f == font);
        if stale {
            let job = lay_out(
                &self.text,
                &self.highlights,
                &self.marks,
                dark,
                plain,
                &font,
            );
            self.job = Some((dark, font, job));
        }
        let mut job = self.job.as_ref().map(|it| it.2.clone()).unwrap_or_default();
        job.wrap.max_width = width;
        ui.fonts_mut(|fonts| fonts.layout_job(job))
    }
}

fn lay_out(
    text: &str,
    highlights: &[Highlight],
    marks: &[(Span, Severity)],
    dark: bool,
    plain: Color32,
    font: &FontId,
) -> LayoutJob {
    // The offsets at which a colour or an underline starts or ends.
    let length = text.len() as u32;
    let mut cuts: Vec<u32> = vec![0, length];
    for span in highlights
        .iter()
        .map(|it| it.span)
        .chain(marks.iter().map(|it| it.0))
    {
        cuts.extend([span.start.min(length), span.end.min(length)]);
    }
    cuts.retain(|cut| text.is_char_boundary(*cut as usize));
    cuts.sort_unstable();
    cuts.dedup();
    let mut sections = Vec::with_capacity(cuts.len());
    let mut next = 0;
    for pair in cuts.windows(2) {
        let [start, end] = [pair[0], pair[1]];
        while highlights.get(next).is_some_and(|it| it.span.end <= start) {
            next += 1;
        }
        let kind = highlights
            .get(next)
            .filter(|it| it.span.start <= start)
            .map(|it| it.kind);
        let mut format = TextFormat::simple(
            font.clone(),
            kind.map_or(plain, |it| colour(it, dark, plain)),
        );
        let mark = marks
            .iter()
            .find(|(span, _)| span.start <= start && end <= span.end);
        if let Some((_, severity)) = mark {
            format.underline = Stroke::new(1.5, severity_colour(*severity, dark));
        }
        sections.push(LayoutSection {
            leading_space: 0.0,
            byte_range: ByteIndex(start as usize)..ByteIndex(end as usize),
            format,
        });
    }
    LayoutJob {
        text: text.to_owned(),
        sections,
        ..LayoutJob::default()
    }
}

/// Returns the colour of a severity.
pub(crate) fn severity_colour(severity: Severity, dark: bool) -> Color32 {
    match (severity, dark) {
        (Severity::Error, true) => Color32::from_rgb(255, 100, 90),
        (Severity::Error, false) => Color32::from_rgb(190, 20, 20),
        (Severity::Warning, true) => Color32::from_rgb(240, 190, 70),
        (Severity::Warning, false) => Color32::from_rgb(140, 90, 0),
        (Severity::Hint, true) => Color32::from_rgb(120, 180, 255),
        (Severity::Hint, false) => Color32::from_rgb(0, 90, 170),
    }
}

/// Returns the colour of a kind: on dark the thesis' colours, on light darker ones of the same hues.
fn colour(kind: HighlightKind, dark: bool, plain: Color32) -> Color32 {
    let [on_dark, on_light] = match kind {
        HighlightKind::Comment => [[106, 153, 85], [0, 110, 0]],
        HighlightKind::Number => [[181, 206, 168], [9, 110, 80]],
        HighlightKind::Text => [[206, 145, 120], [163, 21, 21]],
        HighlightKind::Keyword => [[86, 156, 214], [0, 60, 200]],
        HighlightKind::Constant => [[156, 220, 254], [0, 50, 110]],
        HighlightKind::Function => [[214, 140, 209], [140, 30, 140]],
        HighlightKind::Variable => [[78, 201, 176], [0, 110, 100]],
        HighlightKind::Undefined | HighlightKind::Error => [[255, 120, 110], [190, 20, 20]],
        HighlightKind::Operator | HighlightKind::Punctuation => return plain,
    };
    let [r, g, b] = if dark { on_dark } else { on_light };
    Color32::from_rgb(r, g, b)
}

#[cfg(test)]
mod tests {
    use super::lay_out;
    use egui::{Color32, FontId};
    use syntax::diagnostic::Severity;
    use syntax::span::Span;

    #[test]
    fn the_sections_cover_the_text_without_gap_or_overlap() {
        let text = "# π\nparam a : [0, 1];\npoint p = (a, €, 1);\n";
        let languages = ide::Languages::standard();
        let highlights = languages.default_language().highlight(text);
        let marks = [
            (Span::new(10, 30), Severity::Error),
            (Span::new(40, 400), Severity::Hint),
        ];
        let font = FontId::monospace(12.0);
        let job = lay_out(text, &highlights, &marks, true, Color32::WHITE, &font);
        let mut at = 0;
        for section in &job.sections {
            assert_eq!(section.byte_range.start.0, at);
            at = section.byte_range.end.0;
        }
        assert_eq!(at, text.len());
        let underlined = job
            .sections
            .iter()
            .filter(|it| it.format.underline.width > 0.0);
        let first = underlined.map(|it| it.byte_range.start.0).min();
        assert_eq!(first, Some(10));
    }

    #[test]
    fn an_empty_text_has_an_empty_layout() {
        let job = lay_out(
            "",
            &[],
            &[],
            false,
            Color32::BLACK,
            &FontId::monospace(12.0),
        );
        assert!(job.sections.is_empty());
    }
}
