//! Chart of a scene: error over computing time.

use super::front::front;
use super::outcome::Studied;
use super::scene::Group;
use wythe_core::results::plotting::{Scatter, Spot};

/// Errors below this part of the reference's uncertainty are drawn at that value, because they are small by
/// accident [-].
const LEAST: f64 = 0.05;

/// Errors over computing times as SVG text. Choices without an error are left out. None if no choice has an error.
///
/// # Errors
/// The message of plotters if it cannot draw.
pub fn chart(studied: &Studied) -> Result<Option<String>, String> {
    let points = studied.points();
    let floor = studied.scene.reference.uncertainty;
    let percent = |(time, error): (f64, f64)| (time, 100.0 * error.max(LEAST * floor));
    let all = points.iter().zip(&studied.outcomes);
    let finite = all.filter(|(p, _)| p.0.is_finite() && p.1.is_finite() && p.0 > 0.0);
    let spot = |(at, outcome): (&(f64, f64), &super::outcome::Outcome)| Spot {
        name: outcome.choice.name.clone(),
        at: percent(*at),
        series: outcome.choice.group as usize,
        marked: outcome.choice.group == Group::Default,
    };
    let mut spots: Vec<Spot> = finite.map(spot).collect();
    spots.extend(peers(studied));
    if spots.is_empty() {
        return Ok(None);
    }
    let on: Vec<(f64, f64)> = front(&points, floor)
        .into_iter()
        .map(|i| percent(points[i]))
        .collect();
    let series: Vec<&str> = Group::ALL
        .iter()
        .map(|g| g.name())
        .chain(["peer"])
        .collect();
    let told = format!("uncertainty of the reference, {:.2} %", 100.0 * floor);
    let chart = Scatter {
        title: &studied.scene.name(),
        axes: [
            "CPU time over that of the default",
            "error: the larger of peak and energy [%]",
        ],
        series: &series,
        spots: &spots,
        front: &on,
        floor: Some((100.0 * floor, &told)),
    };
    chart.svg().map(Some)
}

/// Peers that reached the end, as a series of their own.
fn peers(studied: &Studied) -> Vec<Spot> {
    let least = LEAST * studied.scene.reference.uncertainty;
    let peers = studied.peers().into_iter();
    let spots = peers.filter_map(|(peer, errors)| {
        let error = errors.ok()?.of_chart();
        Some(Spot {
            name: peer.name.clone(),
            at: (peer.ratio(), 100.0 * error.max(least)),
            series: Group::ALL.len(),
            marked: false,
        })
    });
    spots.collect()
}
