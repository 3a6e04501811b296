//! Text in SVG.

/// Escapes text for XML.
pub fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
}

/// Upper estimate of the width of a text at this font size [px]: DejaVu Sans, the widest of the common ones, takes
/// 0.6 of its size a character on average.
pub fn width(text: &str, size: f64) -> f64 {
    0.6 * size * text.chars().count() as f64
}
