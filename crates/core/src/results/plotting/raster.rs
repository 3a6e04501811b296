//! Converts SVG to PNG with the same result on every machine, because no system font is used.

use std::sync::{Arc, OnceLock};

use resvg::{tiny_skia, usvg};
use usvg::fontdb::{Database, Source};

/// DejaVu Sans: Latin, Greek and mathematical characters (`fonts/LICENSE`).
static FONT: &[u8] = include_bytes!("../../../fonts/DejaVuSans-subset.ttf");
const FAMILY: &str = "DejaVu Sans";

fn fonts() -> Arc<Database> {
    static FONTS: OnceLock<Arc<Database>> = OnceLock::new();
    let make = || {
        let mut fonts = Database::new();
        fonts.load_font_source(Source::Binary(Arc::new(FONT)));
        fonts.set_sans_serif_family(FAMILY);
        Arc::new(fonts)
    };
    FONTS.get_or_init(make).clone()
}

/// Longest side of a picture [px]: 16,000 px squared take one gigabyte.
const LONGEST: f32 = 16_000.0;

fn tree(svg: &str) -> Result<usvg::Tree, String> {
    let options = usvg::Options {
        font_family: FAMILY.to_owned(),
        fontdb: fonts(),
        ..usvg::Options::default()
    };
    usvg::Tree::from_str(svg, &options).map_err(|error| error.to_string())
}

fn drawn(tree: &usvg::Tree, zoom: f32) -> Result<tiny_skia::Pixmap, String> {
    let (width, height) = (zoom * tree.size().width(), zoom * tree.size().height());
    let drawable = width.max(height) <= LONGEST;
    if !drawable {
        return Err(format!("{width:.0} by {height:.0} pixels are too many"));
    }
    let mut pixels = tiny_skia::Pixmap::new(width.ceil() as u32, height.ceil() as u32)
        .ok_or("the picture has no size")?;
    let scale = tiny_skia::Transform::from_scale(zoom, zoom);
    resvg::render(tree, scale, &mut pixels.as_mut());
    Ok(pixels)
}

/// The picture as PNG with `zoom` pixels per pixel of the SVG.
///
/// # Errors
/// The text is not an SVG, or the picture is too large.
pub fn png(svg: &str, zoom: f32) -> Result<Vec<u8>, String> {
    let pixels = drawn(&tree(svg)?, zoom)?;
    pixels.encode_png().map_err(|error| error.to_string())
}

/// The picture as PNG, `width` pixels wide.
///
/// # Errors
/// As for [`png`].
pub fn png_of_width(svg: &str, width: u32) -> Result<Vec<u8>, String> {
    let tree = tree(svg)?;
    let pixels = drawn(&tree, width as f32 / tree.size().width())?;
    pixels.encode_png().map_err(|error| error.to_string())
}

/// Width, height and pixels of an opaque picture, which is `width` pixels wide. `[pixel][rgba]`
///
/// # Errors
/// As for [`png`].
pub fn pixels(svg: &str, width: u32) -> Result<(u32, u32, Vec<u8>), String> {
    let tree = tree(svg)?;
    let mut pixels = drawn(&tree, width as f32 / tree.size().width())?;
    // Rounding up could add a pixel, and every frame of an animation has the same size.
    if pixels.width() != width {
        let even = tiny_skia::IntRect::from_xywh(0, 0, width, pixels.height());
        pixels = even
            .and_then(|even| pixels.clone_rect(even))
            .ok_or("the picture has no size")?;
    }
    Ok((pixels.width(), pixels.height(), pixels.take()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decoded(svg: &str, zoom: f32) -> tiny_skia::Pixmap {
        tiny_skia::Pixmap::decode_png(&png(svg, zoom).unwrap()).unwrap()
    }

    const HEAD: &str = r#"<svg xmlns="http://www.w3.org/2000/svg" width="40" height="20">"#;

    #[test]
    fn shapes_and_letters_are_drawn() {
        let square = format!(r##"{HEAD}<rect width="20" height="20" fill="#ff0000"/></svg>"##);
        let picture = decoded(&square, 2.0);
        assert_eq!((picture.width(), picture.height()), (80, 40));
        let red = picture.pixel(10, 10).map(|p| (p.red(), p.alpha()));
        assert_eq!(red, Some((255, 255)));
        // Also characters beyond ASCII that the pictures use, such as × and −.
        for text in ["kN", "×", "−", "Δ"] {
            let said =
                format!(r#"{HEAD}<text x="2" y="16" font-family="sans-serif">{text}</text></svg>"#);
            let inked = decoded(&said, 1.0)
                .pixels()
                .iter()
                .filter(|p| p.alpha() > 128)
                .count();
            assert!(inked > 3, "{text}");
        }
    }

    #[test]
    fn images_that_cannot_be_drawn_are_errors() {
        assert!(png("no picture", 1.0).is_err());
        let square = format!("{HEAD}</svg>");
        assert!(png(&square, 1e4).unwrap_err().contains("too many"));
        assert!(png(&square, f32::NAN).is_err());
    }
}
