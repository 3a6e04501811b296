//! The courses of a wall by its bond, and lengths in which a bond fits.
//!
//! ```text
//! stretcher      header       English              Flemish
//! ├───┬───┬─┤   ├┬┬┬┬┬┬┤   ├─┬┬─┬─┬─┬─┬┬─┤   ├─┬┬───┬─┬───┬─┤   odd courses
//! ├─┬───┬───┤   ├┬┬┬┬┬┬┤   ├───┬───┬───┤     ├───┬─┬───┬─┬──┤   even courses
//! ```

use super::course::{CourseRow, Sizes, stack, stretchers, written};
use super::headers::{english, flemish, header_bond, with_headers};
use super::layout::Refusal;
use crate::deck::quantity::Length;
use crate::deck::schema::{Bond, Wall};

/// Courses of a wall from the lowest one; after the last one the sequence repeats.
///
/// # Errors
/// Sizes that are not compatible. If the length does not fit, the help has the nearest lengths that do.
pub fn courses(wall: &Wall) -> Result<Vec<Vec<CourseRow>>, Refusal> {
    bond(wall).map_err(|refusal| {
        let near = if refusal.key == "length" {
            lengths_that_fit(wall)
        } else {
            Vec::new()
        };
        if near.is_empty() {
            return refusal;
        }
        let near: Vec<String> = near.iter().map(|length| format!("{length} mm")).collect();
        Refusal {
            help: format!("take {}", near.join(" or ")),
            ..refusal
        }
    })
}

/// The nearest lengths below and above that of a wall in which its bond fits [mm]: whole quarters of a unit and its
/// joint.
fn lengths_that_fit(wall: &Wall) -> Vec<f64> {
    let sizes = Sizes::of(wall);
    let quarter = 0.25 * (sizes.unit + sizes.head);
    let present = ((sizes.length + sizes.head) / quarter).floor();
    let fits = |quarters: &f64| {
        let length = quarters * quarter - sizes.head;
        let wall = Wall {
            length: Length::new(length),
            ..wall.clone()
        };
        length > 0.0 && bond(&wall).is_ok()
    };
    let away = (0..MOST_QUARTERS).map(f64::from);
    let below = away.clone().map(|k| present - k).find(fits);
    let above = away.map(|k| present + 1.0 + k).find(fits);
    let length = |quarters: f64| (1e6 * (quarters * quarter - sizes.head)).round() / 1e6;
    below.into_iter().chain(above).map(length).collect()
}

/// Quarters of a unit by which a length is changed at most to find one that fits.
const MOST_QUARTERS: u32 = 12;

/// Courses of a bond, see [`courses`].
fn bond(wall: &Wall) -> Result<Vec<Vec<CourseRow>>, Refusal> {
    let sizes = Sizes::of(wall);
    sizes.require_few()?;
    if wall.bond == Bond::Pattern && wall.pattern.iter().all(|c| c.leaves.is_empty()) {
        return Err(Refusal::new(
            "pattern",
            "the bond is a pattern, and there is none",
            "[[wall.pattern]] with leaves = [{ units = [204] }], one for each course",
        ));
    }
    match wall.bond {
        Bond::Stretcher => with_headers(wall, &sizes, &stretchers(wall)?),
        Bond::Stack => with_headers(wall, &sizes, &[stack(&sizes)?]),
        Bond::Header => header_bond(&sizes),
        Bond::English | Bond::EnglishCross => english(wall, &sizes),
        Bond::Flemish => flemish(&sizes),
        Bond::Pattern => {
            let courses = wall.pattern.iter().enumerate();
            let courses = courses.take((wall.courses as usize).max(1));
            courses
                .map(|(k, course)| written(wall, &sizes, k, course))
                .collect()
        }
    }
}
