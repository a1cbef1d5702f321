//! PDF: one page with an image, paths, and the outlines of words.

use image::RgbaImage;
use miniz_oxide::deflate::compress_to_vec_zlib;
use pdf_writer::types::{LineCapStyle, LineJoinStyle};
use pdf_writer::{Content, Filter, Finish, Name, Pdf, Rect, Ref, TextStr};
use render::layers::{Layers, PlacedWords, Stroke, outlines};

/// The size of a pixel in points: 96 pixels per inch.
const POINTS: f32 = 72.0 / 96.0;
/// The compression level, of 10.
const LEVEL: u8 = 6;
/// The name of the image on its page.
const IMAGE: Name<'static> = Name(b"Pixels");

pub(super) fn bytes(layers: &Layers, title: &str) -> Vec<u8> {
    let [catalog, pages, page, content, image, mask, info] = [1, 2, 3, 4, 5, 6, 7].map(Ref::new);
    let pixels = &layers.below.image;
    let [width, height] = [pixels.width(), pixels.height()].map(|side| side as f32 * POINTS);
    let mut pdf = Pdf::new();
    pdf.catalog(catalog).pages(pages);
    pdf.pages(pages).kids([page]).count(1);
    let mut only = pdf.page(page);
    only.media_box(Rect::new(0.0, 0.0, width, height));
    only.parent(pages).contents(content);
    let opacities = opacities(layers);
    let states = || (info.get() + 1..).map(Ref::new).zip(&opacities);
    let mut resources = only.resources();
    resources.x_objects().pair(IMAGE, image);
    let mut named = resources.ext_g_states();
    for (state, opacity) in states() {
        named.pair(Name(state_name(*opacity).as_bytes()), state);
    }
    named.finish();
    resources.finish();
    only.finish();
    for (state, opacity) in states() {
        let mut state = pdf.ext_graphics(state);
        state.stroking_alpha(*opacity).non_stroking_alpha(*opacity);
    }
    let mut about = pdf.document_info(info);
    about.title(TextStr(title)).creator(TextStr("Geotrace"));
    about.finish();
    embed(&mut pdf, pixels, [image, mask]);
    let drawn = drawing(layers, [width, height]);
    let packed = compress_to_vec_zlib(&drawn, LEVEL);
    pdf.stream(content, &packed).filter(Filter::FlateDecode);
    pdf.finish()
}

/// Returns the opacities of words that are translucent, each once.
fn opacities(layers: &Layers) -> Vec<f32> {
    let all = layers.words.iter().map(|words| words.opacity);
    let mut all: Vec<f32> = all.filter(|opacity| *opacity < 1.0).collect();
    all.sort_unstable_by(f32::total_cmp);
    all.dedup();
    all
}

/// Returns the name of the graphics state with an opacity.
fn state_name(opacity: f32) -> String {
    format!("Opacity{}", (100.0 * opacity).round())
}

/// Adds the pixels, and a mask if they are partly transparent.
fn embed(pdf: &mut Pdf, pixels: &RgbaImage, [image, mask]: [Ref; 2]) {
    let [width, height] = [pixels.width(), pixels.height()].map(|side| side as i32);
    let colours: Vec<u8> = pixels
        .pixels()
        .flat_map(|it| [it.0[0], it.0[1], it.0[2]])
        .collect();
    let colours = compress_to_vec_zlib(&colours, LEVEL);
    let is_opaque = pixels.pixels().all(|it| it.0[3] == 255);
    let mut embedded = pdf.image_xobject(image, &colours);
    embedded.filter(Filter::FlateDecode);
    embedded.width(width).height(height).bits_per_component(8);
    embedded.color_space().device_rgb();
    if !is_opaque {
        embedded.s_mask(mask);
    }
    embedded.finish();
    if !is_opaque {
        let alphas: Vec<u8> = pixels.pixels().map(|it| it.0[3]).collect();
        let alphas = compress_to_vec_zlib(&alphas, LEVEL);
        let mut opacity = pdf.image_xobject(mask, &alphas);
        opacity.filter(Filter::FlateDecode);
        opacity.width(width).height(height).bits_per_component(8);
        opacity.color_space().device_gray();
    }
}

/// Returns the page's content.
fn drawing(layers: &Layers, [width, height]: [f32; 2]) -> Vec<u8> {
    let mut content = Content::new();
    content.save_state();
    content.transform([width, 0.0, 0.0, height, 0.0, 0.0]);
    content.x_object(IMAGE);
    content.restore_state();
    // From here on, lengths are in pixels, and y points down.
    content.transform([POINTS, 0.0, 0.0, -POINTS, 0.0, height]);
    content.set_line_cap(LineCapStyle::RoundCap);
    content.set_line_join(LineJoinStyle::RoundJoin);
    for stroke in &layers.strokes {
        line(&mut content, stroke);
    }
    for words in &layers.words {
        letters(&mut content, words);
    }
    content.finish().into_vec()
}

fn line(content: &mut Content, stroke: &Stroke) {
    let [r, g, b] = shares(stroke.colour);
    content.set_stroke_rgb(r, g, b).set_line_width(stroke.width);
    if let Some(dashes) = stroke.dashes() {
        content
            .set_line_cap(LineCapStyle::ButtCap)
            .set_dash_pattern(dashes, 0.0);
    }
    for (k, [x, y]) in stroke.points.iter().enumerate() {
        match k {
            0 => content.move_to(*x, *y),
            _ => content.line_to(*x, *y),
        };
    }
    content.stroke();
    if stroke.is_hidden {
        content
            .set_line_cap(LineCapStyle::RoundCap)
            .set_dash_pattern([], 0.0);
    }
}

fn letters(content: &mut Content, words: &PlacedWords) {
    let contours = outlines(words);
    let trace = |content: &mut Content| {
        for contour in &contours {
            content.move_to(contour.start[0], contour.start[1]);
            for [a, b, c] in &contour.pieces {
                content.cubic_to(a[0], a[1], b[0], b[1], c[0], c[1]);
            }
            content.close_path();
        }
    };
    if words.opacity < 1.0 {
        content.save_state();
        content.set_parameters(Name(state_name(words.opacity).as_bytes()));
    }
    let [r, g, b] = shares(words.rim);
    content
        .set_stroke_rgb(r, g, b)
        .set_line_width(2.0 * words.rim_width);
    trace(content);
    content.stroke();
    let [r, g, b] = shares(words.colour);
    content.set_fill_rgb(r, g, b);
    trace(content);
    content.fill_nonzero();
    if words.opacity < 1.0 {
        content.restore_state();
    }
}

fn shares(colour: [u8; 3]) -> [f32; 3] {
    colour.map(|part| f32::from(part) / 255.0)
}
