//! A page as SVG: texts stay texts, particles are an image within.

use super::{
    PlotError,
    color::Rgb,
    page::{Image, Item, Page},
};
use base64::{Engine, prelude::BASE64_STANDARD};
use std::fmt::Write;

/// The page as a document of its own, as wide in print as at any number of pixels.
pub(super) fn svg(page: &Page) -> Result<String, PlotError> {
    let (width, height) = (page.width, page.height);
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{:.4}in\" height=\"{:.4}in\" viewBox=\"0 0 {width:.2} \
         {height:.2}\" font-family=\"'DejaVu Sans', Verdana, sans-serif\" stroke-linejoin=\"round\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
        width / 100.0,
        height / 100.0
    );
    for item in &page.items {
        // Writing to a string cannot fail.
        let _ = write_item(&mut text, item)?;
    }
    text.push_str("</svg>\n");
    Ok(text)
}

fn write_item(out: &mut String, item: &Item) -> Result<std::fmt::Result, PlotError> {
    Ok(match item {
        Item::Line { points, width, color, dashed } => {
            let ends = if *dashed { "stroke-dasharray=\"9 6\"" } else { "stroke-linecap=\"round\"" };
            let (points, color) = (places(points), hex(*color));
            writeln!(
                out,
                "<polyline points=\"{points}\" fill=\"none\" stroke=\"{color}\" stroke-width=\"{width}\" {ends}/>"
            )
        }
        Item::Polygon { points, color } => {
            writeln!(out, "<polygon points=\"{}\" fill=\"{}\"/>", places(points), hex(*color))
        }
        Item::Text(text) => {
            let (x, y) = text.at;
            let place = if text.upwards {
                format!("transform=\"translate({x:.2} {y:.2}) rotate(-90)\"")
            } else {
                format!("x=\"{x:.2}\" y=\"{y:.2}\"")
            };
            // Where the font is another one, the text still takes the room that was kept for it.
            let (size, width) = (text.size, text.width);
            let (color, words) = (hex(text.color), escaped(&text.text));
            writeln!(
                out,
                "<text {place} font-size=\"{size}\" textLength=\"{width:.2}\" lengthAdjust=\"spacingAndGlyphs\" \
                 fill=\"{color}\">{words}</text>"
            )
        }
        Item::Image(image) => {
            let (area, data) = (image.area, BASE64_STANDARD.encode(png(image)?));
            writeln!(
                out,
                "<image x=\"{:.2}\" y=\"{:.2}\" width=\"{:.2}\" height=\"{:.2}\" preserveAspectRatio=\"none\" \
                 href=\"data:image/png;base64,{data}\"/>",
                area.x, area.y, area.width, area.height
            )
        }
    })
}

fn places(points: &[(f64, f64)]) -> String {
    points.iter().map(|(x, y)| format!("{x:.2},{y:.2}")).collect::<Vec<_>>().join(" ")
}

fn hex([r, g, b]: Rgb) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Characters that XML keeps for itself are written by name; control characters cannot be written at all.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for character in text.chars() {
        match character {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            c if c.is_control() => {}
            c => out.push(c),
        }
    }
    out
}

fn png(image: &Image) -> Result<Vec<u8>, PlotError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, image.columns as u32, image.rows as u32);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.write_header()?.write_image_data(image.pixels.as_flattened())?;
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::{
        page::{Anchor, Area, INK},
        paper::Paper,
    };

    #[test]
    fn every_item_is_an_element_and_any_title_is_text() {
        let mut page = Page::new(200.0, 100.0, Paper::default()).unwrap();
        page.line((0.0, 1.0), (2.0, 3.0), 1.5, INK);
        page.polygon(vec![(0.0, 0.0), (1.0, 0.0), (1.0, 1.0)], INK);
        page.text((10.0, 20.0), 13.0, Anchor::Left, "a < b & \"c\" >\u{7}");
        page.text_upwards((10.0, 50.0), 13.0, "up");
        let area = Area { x: 1.0, y: 2.0, width: 3.0, height: 4.0 };
        page.image(Image { area, columns: 1, rows: 1, pixels: vec![[1, 2, 3, 255]] });
        let text = svg(&page).unwrap();
        let document = roxmltree::Document::parse(&text).unwrap();
        let elements = document.root_element().children().filter(roxmltree::Node::is_element);
        let names: Vec<_> = elements.map(|node| node.tag_name().name().to_owned()).collect();
        assert_eq!(names, ["rect", "polyline", "polygon", "text", "text", "image"]);
        let words = document.descendants().find(|node| node.has_tag_name("text")).unwrap();
        assert_eq!(words.text(), Some("a < b & \"c\" >"));
        assert_eq!(document.root_element().attribute("width"), Some("2.0000in"));
    }
}
