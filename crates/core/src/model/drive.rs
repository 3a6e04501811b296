//! Direction along which the force of a run counts.

use super::Model;

/// Direction along which the force of the curve counts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive {
    /// 0, 1, 2 for x, y, z.
    pub axis: usize,
    /// 1, or −1 against the axis.
    pub sense: f64,
}

impl Drive {
    /// `x`, `-x`, …
    pub fn name(self) -> String {
        let sign = if self.sense < 0.0 { "-" } else { "" };
        format!("{sign}{}", ["x", "y", "z"][self.axis])
    }

    /// Direction in which a step first drives a beam, else a spring, else a load; `None` if there is none of them.
    pub fn of(model: &Model) -> Option<Self> {
        let steps = || model.steps.iter();
        let of_beam = steps().find_map(|step| {
            let driven = step.driven?;
            let way = driven.way(step)?;
            // Along a vector its largest component counts.
            largest(driven.direction.map(|part| part * way))
        });
        let of_spring = || {
            steps()
                .flat_map(|step| &step.springs)
                .find_map(|by| first(*by))
        };
        let of_load = || {
            let mut changed =
                steps().filter_map(|step| step.loads.iter().position(Option::is_some));
            largest(model.loads.get(changed.next()?)?.direction)
        };
        of_beam.or_else(of_spring).or_else(of_load)
    }
}

/// Axis of the first component other than 0.
fn first(v: [f64; 3]) -> Option<Drive> {
    let axis = (0..3).find(|i| v[*i] != 0.0)?;
    let sense = v[axis].signum();
    Some(Drive { axis, sense })
}

/// Axis of the largest component.
pub(crate) fn largest(v: [f64; 3]) -> Option<Drive> {
    let size = |i: &usize| v[*i].abs();
    let axis = (0..3).max_by(|a, b| size(a).total_cmp(&size(b)))?;
    let sense = v[axis].signum();
    (v[axis] != 0.0).then_some(Drive { axis, sense })
}
