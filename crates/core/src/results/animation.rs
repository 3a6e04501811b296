//! The deformed wall frame by frame as an animated GIF, with the curve beside it.

use std::borrow::Cow;
use std::fmt::Write as _;

use super::comparison::points_of;
use super::plotting::{Line, load_displacements, raster};
use super::snapshot::{FrameChoice, Snapshots};
use super::wall_picture::{Look, Window, wall_picture, window};
use super::{ReadError, Snapshot};
use crate::experiment::Point;
use crate::model::Model;

/// How to draw an animation.
#[derive(Clone, Debug)]
pub struct Animation {
    /// The wall.
    pub look: Look,
    /// Width of the picture [px].
    pub width: u32,
    /// Time that each frame is shown [s].
    pub delay: f64,
    /// Whether the load-displacement curve lies beside the wall, if the run has one.
    pub curve: bool,
    /// Largest number of frames, at even distances, the last one always.
    pub most: usize,
}

impl Default for Animation {
    fn default() -> Self {
        Self {
            look: Look::default(),
            width: 960,
            delay: 0.15,
            curve: true,
            most: 120,
        }
    }
}

/// Time that the last frame is shown, in terms of the others.
const REST: f64 = 8.0;
/// Quality of the 256 colours of a frame: 1 best and slow, 30 worst and fast.
const SPEED: i32 = 10;

/// Pictures of all frames at one scale, as SVG texts.
///
/// # Errors
/// The run has no frames ([`ReadError::NoFrame`]), they cannot be read, or the section meets nothing.
pub fn pictures(
    snapshots: &Snapshots,
    model: Option<&Model>,
    animation: &Animation,
) -> Result<Vec<String>, ReadError> {
    // An error for a run without frames.
    let last = snapshots.at(FrameChoice::Last)?;
    let count = snapshots.count();
    let frames = chosen(count, animation.most.max(1));
    let mut look = animation.look.clone();
    if look.scale.is_none() {
        look.scale = Some(super::elevation::magnification(&last.mesh, &last.frame));
    }
    let mut common: Option<Window> = None;
    for &frame in &frames {
        let own = window(&snapshots.at(FrameChoice::Number(frame))?, &look)?;
        common = Some(common.map_or(own, |common| common.and(own)));
    }
    look.window = common;
    let curve = snapshots.history().curve();
    let points = points_of(&curve);
    let drawn = animation.curve && !curve.points().is_empty();
    frames
        .into_iter()
        .map(|frame| {
            let snapshot = snapshots.at(FrameChoice::Number(frame))?;
            let wall = wall_picture(&snapshot, model, &look)?;
            if drawn {
                beside(&wall, &snapshot, &points)
            } else {
                Ok(wall)
            }
        })
        .collect()
}

/// The animation as GIF.
///
/// # Errors
/// As for [`pictures`], and [`ReadError::Undrawn`] if a picture is too large.
pub fn gif(
    snapshots: &Snapshots,
    model: Option<&Model>,
    animation: &Animation,
) -> Result<Vec<u8>, ReadError> {
    let pictures = pictures(snapshots, model, animation)?;
    let undrawn = |why: &dyn std::fmt::Display| ReadError::Undrawn(why.to_string());
    let mut bytes = Vec::new();
    let mut encoder: Option<gif::Encoder<&mut Vec<u8>>> = None;
    let mut into = Some(&mut bytes);
    for (i, svg) in pictures.iter().enumerate() {
        let (wide, tall, mut pixels) =
            raster::pixels(svg, animation.width).map_err(ReadError::Undrawn)?;
        let side = |side: u32| u16::try_from(side).map_err(|error| undrawn(&error));
        let (wide, tall) = (side(wide)?, side(tall)?);
        if let Some(into) = into.take() {
            let mut new = gif::Encoder::new(into, wide, tall, &[]).map_err(|e| undrawn(&e))?;
            new.set_repeat(gif::Repeat::Infinite)
                .map_err(|e| undrawn(&e))?;
            encoder = Some(new);
        }
        let mut frame = gif::Frame::from_rgba_speed(wide, tall, &mut pixels, SPEED);
        let rest = if i + 1 == pictures.len() { REST } else { 1.0 };
        frame.delay = (100.0 * rest * animation.delay).round().clamp(2.0, 6000.0) as u16;
        frame.buffer = Cow::Owned(frame.buffer.into_owned());
        if let Some(encoder) = &mut encoder {
            encoder.write_frame(&frame).map_err(|e| undrawn(&e))?;
        }
    }
    drop(encoder);
    Ok(bytes)
}

/// Numbers of at most `most` frames at even distances, with the last one.
fn chosen(count: usize, most: usize) -> Vec<usize> {
    if count <= most {
        return (0..count).collect();
    }
    let last = count - 1;
    match most {
        1 => vec![last],
        _ => (0..most).map(|i| i * last / (most - 1)).collect(),
    }
}

/// The wall with the curve and its present point to the right.
fn beside(wall: &str, snapshot: &Snapshot, points: &[Point]) -> Result<String, ReadError> {
    let now = snapshot
        .row
        .as_ref()
        .map(|r| (r.displacement_mm, r.force_kN));
    let run = Line {
        name: String::new(),
        points: points.to_vec(),
        marks: now.into_iter().collect(),
    };
    let curve = load_displacements("", &[run], &[]).map_err(ReadError::Undrawn)?;
    let [(wide, tall), (right, high)] = [wall, curve.as_str()].map(size);
    let width = wide + 0.85 * right;
    let mut svg = format!(
        r##"<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0}" height="{tall:.0}" viewBox="0 0 {width:.0} {tall:.0}"><rect width="100%" height="100%" fill="#ffffff"/>"##
    );
    let y = (0.5 * (tall - 0.85 * high)).max(0.0);
    svg.push_str(wall);
    let drawn = write!(
        svg,
        r#"<g transform="translate({wide:.1} {y:.1}) scale(0.85)">{curve}</g></svg>"#
    );
    debug_assert!(drawn.is_ok(), "writing to a string does not fail");
    Ok(svg)
}

/// Width and height of a picture of this crate [px].
fn size(svg: &str) -> (f64, f64) {
    let of = |name: &str| {
        let text = svg.split(name).nth(1)?;
        text.split('"').next()?.parse::<f64>().ok()
    };
    (
        of(r#" width=""#).unwrap_or(1.0),
        of(r#" height=""#).unwrap_or(1.0),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::results::{RunDirectory, RunFolder, fake};
    use crate::solve::Recorder;

    fn snapshots(frames: usize) -> (tempfile::TempDir, Snapshots) {
        let folder = tempfile::tempdir().unwrap();
        let model = fake::model();
        let mut run = RunDirectory::create(folder.path(), &model).unwrap();
        for i in 1..=frames {
            let d = i as f64;
            run.take(
                &model,
                &fake::row(i, 1, d, 10.0 - d),
                Some(&fake::frame(&model, d)),
            )
            .unwrap();
        }
        drop(run);
        let open = Snapshots::open(&RunFolder::open(folder.path()).unwrap()).unwrap();
        (folder, open)
    }

    #[test]
    fn a_gif_has_as_many_frames_as_the_run() {
        let (_keep, snapshots) = snapshots(3);
        let small = Animation {
            width: 200,
            ..Animation::default()
        };
        let bytes = gif(&snapshots, None, &small).unwrap();
        let mut options = gif::DecodeOptions::new();
        options.set_color_output(gif::ColorOutput::RGBA);
        let mut decoder = options.read_info(&bytes[..]).unwrap();
        let mut frames = Vec::new();
        while let Some(frame) = decoder.read_next_frame().unwrap() {
            frames.push(frame.buffer.to_vec());
        }
        assert_eq!(frames.len(), 3);
        assert_eq!(decoder.width(), 200);
        assert!(frames[0] != frames[1] && frames[1] != frames[2]);
    }

    #[test]
    fn the_frames_chosen_are_spread_and_have_the_last() {
        assert_eq!(chosen(3, 5), [0, 1, 2]);
        assert_eq!(chosen(101, 3), [0, 50, 100]);
        assert_eq!(chosen(7, 1), [6]);
        let all = chosen(100, 40);
        assert!(all.len() == 40 && all.last() == Some(&99));
    }

    #[test]
    fn a_run_without_frames_is_an_error() {
        let (_keep, snapshots) = snapshots(0);
        let error = gif(&snapshots, None, &Animation::default()).unwrap_err();
        assert!(
            error.to_string().contains("has written none yet"),
            "{error}"
        );
    }
}
