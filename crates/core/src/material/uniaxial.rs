//! Uniaxial tables and the curves derived from them (theory/damage-plasticity.md, eqs 9 to 11, and
//! theory/crack-band.md, eqs 4 and 6).

use std::fmt;

use super::parameters::{Interpolation, TableRow};

/// Tension or compression.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Branch {
    /// Uniaxial tension.
    Tension,
    /// Uniaxial compression.
    Compression,
}

impl fmt::Display for Branch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Tension => "tension",
            Self::Compression => "compression",
        })
    }
}

/// An invalid table. Rows are counted from 1.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TableError {
    /// Fewer than two rows.
    #[error("the {branch} table needs at least two rows: first yield and one after it")]
    TooShort {
        /// Branch of the table.
        branch: Branch,
    },
    /// A number is out of range.
    #[error("{branch} row {row}: {what}")]
    Row {
        /// Branch of the table.
        branch: Branch,
        /// Row.
        row: usize,
        /// Description with the admissible range.
        what: String,
    },
    /// The damage is larger than stress and strain allow, and capping it would let it decrease.
    #[error(
        "{branch} row {row}: damage {damage} is inadmissible (plastic strain would fall) and \
         capping it to {capped:.4} would let it fall below the row before"
    )]
    Inadmissible {
        /// Branch of the table.
        branch: Branch,
        /// Row.
        row: usize,
        /// Damage as given.
        damage: f64,
        /// Largest admissible damage.
        capped: f64,
    },
    /// Softening with a given fracture energy would snap back in an element of this size.
    #[error(
        "the softening in {branch} snaps back in an element of equivalent length {l_eq:.1} mm; below \
         {l_max:.1} mm with this modulus, strength and energy"
    )]
    TooBrittle {
        /// Tension or compression.
        branch: Branch,
        /// Equivalent length of the element [mm].
        l_eq: f64,
        /// Limit of the length [mm].
        l_max: f64,
    },
    /// An error of a law without tables, in its own words.
    #[error("the law `{law}`: {why}")]
    Law {
        /// Name of the law.
        law: &'static str,
        /// Description.
        why: String,
    },
    /// Softening would snap back in an element of this size.
    #[error(
        "{branch} row {row}: the softening snaps back in an element of equivalent length \
         {l_eq:.1} mm; at most {l_max:.1} mm with this table and reference_length"
    )]
    SnapBack {
        /// Branch of the table.
        branch: Branch,
        /// Row at the end of the steepest segment.
        row: usize,
        /// Equivalent length of the element [mm].
        l_eq: f64,
        /// Largest admissible length [mm].
        l_max: f64,
    },
}

/// A change to a table.
#[derive(Clone, Debug, PartialEq)]
pub enum TableWarning {
    /// The damage of a row was capped so that the plastic strain does not decrease (theory/damage-plasticity.md, eq.
    /// 11).
    DamageCapped {
        /// Branch of the table.
        branch: Branch,
        /// Row, from 1.
        row: usize,
        /// Damage as given.
        from: f64,
        /// Damage used.
        to: f64,
        /// Length of the element [mm]; `None` for tables used as given.
        l_eq: Option<f64>,
    },
    /// Bands above the snap-back limit were reduced to it (theory/crack-band.md, eq. 7).
    BandNarrowed {
        /// Branch of the table.
        branch: Branch,
        /// Row at the end of the steepest segment.
        row: usize,
        /// Widest band of all elements [mm].
        width: f64,
        /// Width used for it [mm].
        limit: f64,
    },
}

impl fmt::Display for TableWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (branch, row, from, to, l_eq) = match self {
            Self::DamageCapped {
                branch,
                row,
                from,
                to,
                l_eq,
            } => (branch, row, from, to, l_eq),
            Self::BandNarrowed {
                branch,
                row,
                width,
                limit,
            } => {
                return write!(
                    f,
                    "{branch} row {row}: in bands wider than {limit:.1} mm (up to {width:.1} mm) the softening would \
                     snap back; it is that of {limit:.1} mm there"
                );
            }
        };
        write!(
            f,
            "{branch} row {row}: damage {from} is inadmissible with this E, stress and strain (the \
             plastic strain would fall); capped to {to:.5}"
        )?;
        if let Some(l_eq) = l_eq {
            write!(f, " where l_eq = {l_eq:.1} mm")?;
        }
        Ok(())
    }
}

/// Smallest slope of the plastic strain over the inelastic strain. A slope b = 0 would be a jump of σ̄
/// (theory/damage-plasticity.md, eq. 11).
const LEAST_PLASTIC: f64 = 0.1;
/// Pieces per interval for [`Interpolation::Lit`].
const PIECES: usize = 20;

/// A node of the curves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Node {
    /// Hardening variable κ (plastic strain in the uniaxial test) [-].
    pub kappa: f64,
    /// Nominal stress σ [MPa].
    pub stress: f64,
    /// Effective stress σ̄ [MPa].
    pub effective: f64,
}

/// σ̄(κ) and d(κ): σ and σ̄ piecewise linear between nodes, constant after the last.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    nodes: Vec<Node>,
    /// One segment from each node; the last one is constant.
    segments: Vec<Segment>,
}

/// The straight line from a node to the next one.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Segment {
    from: Node,
    /// dσ/dκ [MPa].
    stress_slope: f64,
    /// dσ̄/dκ [MPa].
    effective_slope: f64,
}

/// Number of segments up to which a linear search is faster than bisection.
const FEW: usize = 8;

/// Values of a curve at one κ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvePoint {
    /// σ̄ [MPa].
    pub effective: f64,
    /// dσ̄/dκ [MPa].
    pub effective_slope: f64,
    /// d [-].
    pub damage: f64,
    /// dd/dκ [-].
    pub damage_slope: f64,
}

impl Curve {
    /// Curve of a table for Young's modulus `e` [MPa] in an element of size `l_eq` [mm].
    ///
    /// # Errors
    /// [`TableError`].
    pub fn new(
        branch: Branch,
        rows: &[TableRow],
        e: f64,
        scaling: Option<(f64, f64)>,
        interpolation: Interpolation,
    ) -> Result<(Self, Vec<TableWarning>), TableError> {
        validate(branch, rows)?;
        let rows = scale(branch, rows, e, scaling)?;
        let l_eq = scaling.map(|(_, l_eq)| l_eq);
        let mut warnings: Vec<TableWarning> = Vec::new();
        let mut nodes = vec![Node {
            kappa: 0.0,
            stress: rows[0].stress,
            effective: rows[0].stress,
        }];
        let mut before = (0.0, 0.0, 0.0); // ε_in, ε_pl, d of the last node
        let pieces = if interpolation == Interpolation::Lit {
            PIECES
        } else {
            1
        };
        for (i, pair) in rows.windows(2).enumerate() {
            for piece in 1..=pieces {
                let s = piece as f64 / pieces as f64;
                let mix = |a: f64, b: f64| if piece == pieces { b } else { a + s * (b - a) };
                let stress = mix(pair[0].stress, pair[1].stress);
                let inelastic = mix(pair[0].inelastic_strain, pair[1].inelastic_strain);
                let given = mix(pair[0].damage, pair[1].damage);
                let mut plastic = inelastic - given / (1.0 - given) * stress / e;
                let mut damage = given;
                let least = before.1 + LEAST_PLASTIC * (inelastic - before.0);
                if plastic < least {
                    plastic = least;
                    let x = e * (inelastic - plastic);
                    damage = x / (x + stress);
                    if damage < before.2 - 1e-12 {
                        return Err(TableError::Inadmissible {
                            branch,
                            row: i + 2,
                            damage: given,
                            capped: damage,
                        });
                    }
                    if piece == pieces {
                        let (row, from, to) = (i + 2, given, damage);
                        warnings.push(TableWarning::DamageCapped {
                            branch,
                            row,
                            from,
                            to,
                            l_eq,
                        });
                    }
                }
                before = (inelastic, plastic, damage);
                let effective = stress + e * (inelastic - plastic);
                nodes.push(Node {
                    kappa: plastic,
                    stress,
                    effective,
                });
            }
        }
        let segments = segments(&nodes);
        Ok((Self { nodes, segments }, warnings))
    }

    /// The nodes.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// κ at the peak stress; for a plateau at its end.
    pub fn peak(&self) -> f64 {
        let by_stress = |best: &Node, node: &Node| {
            if node.stress >= best.stress {
                *node
            } else {
                *best
            }
        };
        let first = self.nodes[0];
        self.nodes
            .iter()
            .fold(first, |best, node| by_stress(&best, node))
            .kappa
    }

    /// Energy per volume dissipated in the uniaxial test from the peak to `kappa` [N/mm²]: ∫ σ dκ + ∫ σ̄²/2E dd, for
    /// Young's modulus `e` [MPa] (theory/crack-band.md, eq. 9). 0 before the peak.
    pub fn softening_energy(&self, kappa: f64, e: f64) -> f64 {
        let peak = self.peak();
        let mut energy = 0.0;
        for (i, segment) in self.segments.iter().enumerate() {
            let end = self.nodes.get(i + 1).map_or(f64::INFINITY, |n| n.kappa);
            let from = segment.from;
            if from.kappa < peak || kappa <= from.kappa {
                continue;
            }
            let grown = kappa.min(end) - from.kappa;
            let mean = from.stress + 0.5 * segment.stress_slope * grown;
            // σ̄² dd/dκ is constant on a segment, where σ and σ̄ are linear.
            let release =
                from.stress * segment.effective_slope - segment.stress_slope * from.effective;
            energy += (mean + 0.5 * release / e) * grown;
        }
        energy
    }

    /// σ̄ at first yield [MPa].
    pub fn first_yield(&self) -> f64 {
        self.nodes[0].effective
    }

    /// σ̄, d and their slopes at κ ≥ 0.
    #[inline(always)]
    pub fn at(&self, kappa: f64) -> CurvePoint {
        let later = &self.segments[1..];
        let i = if later.len() <= FEW {
            later.iter().take_while(|s| s.from.kappa <= kappa).count()
        } else {
            later.partition_point(|s| s.from.kappa <= kappa)
        };
        let Segment {
            from,
            stress_slope,
            effective_slope,
        } = self.segments[i];
        let ahead = kappa - from.kappa;
        let stress = from.stress + stress_slope * ahead;
        let effective = from.effective + effective_slope * ahead;
        let share = 1.0 / effective;
        CurvePoint {
            effective,
            effective_slope,
            damage: 1.0 - stress * share,
            damage_slope: (stress * share * effective_slope - stress_slope) * share,
        }
    }
}

/// Segments between the nodes, and a constant one after the last node.
fn segments(nodes: &[Node]) -> Vec<Segment> {
    let mut segments: Vec<Segment> = (nodes.windows(2))
        .map(|pair| {
            let (from, to) = (pair[0], pair[1]);
            let width = to.kappa - from.kappa;
            Segment {
                from,
                stress_slope: (to.stress - from.stress) / width,
                effective_slope: (to.effective - from.effective) / width,
            }
        })
        .collect();
    segments.extend(nodes.last().map(|from| Segment {
        from: *from,
        stress_slope: 0.0,
        effective_slope: 0.0,
    }));
    segments
}

/// Checks the ranges of a table, independently of the element.
///
/// # Errors
/// [`TableError`] with the row.
#[expect(
    clippy::too_many_lines,
    reason = "one check after the other, each with its error"
)]
pub fn validate(branch: Branch, rows: &[TableRow]) -> Result<(), TableError> {
    if rows.len() < 2 {
        return Err(TableError::TooShort { branch });
    }
    let wrong = |row: usize, what: String| {
        Err(TableError::Row {
            branch,
            row: row + 1,
            what,
        })
    };
    for (i, row) in rows.iter().enumerate() {
        let TableRow {
            stress,
            inelastic_strain,
            damage,
        } = *row;
        if !(stress.is_finite() && stress > 0.0) {
            return wrong(
                i,
                format!("stress {stress} must be positive (a residual keeps it so)"),
            );
        }
        if !(0.0..1.0).contains(&damage) {
            return wrong(i, format!("damage {damage} must be at least 0 and below 1"));
        }
        if !inelastic_strain.is_finite() {
            return wrong(
                i,
                format!("inelastic strain {inelastic_strain} must be finite"),
            );
        }
        if i == 0 {
            if inelastic_strain != 0.0 || damage != 0.0 {
                return wrong(
                    0,
                    "the first row is first yield: strain 0 and damage 0".to_owned(),
                );
            }
        } else {
            let before = rows[i - 1];
            if inelastic_strain <= before.inelastic_strain {
                return wrong(
                    i,
                    format!(
                        "inelastic strain {inelastic_strain} must be above {} of the row before",
                        before.inelastic_strain
                    ),
                );
            }
            if damage < before.damage {
                return wrong(
                    i,
                    format!(
                        "damage {damage} must not be below {} of the row before",
                        before.damage
                    ),
                );
            }
        }
    }
    Ok(())
}

/// Stretches the inelastic strain after the peak by l_ref/l_eq and rejects a snap-back (theory/crack-band.md, eq. 7).
fn scale(
    branch: Branch,
    rows: &[TableRow],
    e: f64,
    scaling: Option<(f64, f64)>,
) -> Result<Vec<TableRow>, TableError> {
    let peak = peak_row(rows);
    let (l_ref, l_eq) = scaling.unwrap_or((1.0, 1.0));
    let at_peak = rows[peak].inelastic_strain;
    let scaled: Vec<TableRow> = rows
        .iter()
        .enumerate()
        .map(|(i, row)| TableRow {
            inelastic_strain: if i > peak {
                at_peak + (row.inelastic_strain - at_peak) * l_ref / l_eq
            } else {
                row.inelastic_strain
            },
            ..*row
        })
        .collect();
    for i in 1..rows.len() {
        let fall = rows[i - 1].stress - rows[i].stress;
        let width = rows[i].inelastic_strain - rows[i - 1].inelastic_strain;
        if fall <= 0.0 {
            continue;
        }
        let ratio = e * width / fall;
        // Rows before the peak are not scaled, and without scaling the element size is not the cause.
        if ratio <= 1.0 && (i <= peak || scaling.is_none()) {
            let what = format!(
                "the stress falls by {fall} MPa within an inelastic strain of {width:.3e}: it snaps \
                 back below {:.3e} (the fall over E)",
                fall / e
            );
            return Err(TableError::Row {
                branch,
                row: i + 1,
                what,
            });
        }
    }
    match snap_back(e, rows) {
        Some((row, ratio)) if l_eq >= ratio * l_ref => Err(TableError::SnapBack {
            branch,
            row,
            l_eq,
            l_max: ratio * l_ref,
        }),
        _ => Ok(scaled),
    }
}

/// Row of the peak stress, from 0; for a plateau the last row, after which softening begins.
pub(super) fn peak_row(rows: &[TableRow]) -> usize {
    let higher = |p: usize, i: usize| {
        if rows[i].stress >= rows[p].stress {
            i
        } else {
            p
        }
    };
    (0..rows.len()).fold(0, higher)
}

/// Smallest E Δε_in/Δσ of the softening segments, the largest l/l_ref without snap-back (theory/crack-band.md, eq.
/// 7), with the row (from 1) at the end of that segment; `None` without softening.
pub fn snap_back(e: f64, rows: &[TableRow]) -> Option<(usize, f64)> {
    (peak_row(rows) + 1..rows.len())
        .filter(|&i| rows[i].stress < rows[i - 1].stress)
        .map(|i| {
            let width = rows[i].inelastic_strain - rows[i - 1].inelastic_strain;
            (i + 1, e * width / (rows[i - 1].stress - rows[i].stress))
        })
        .reduce(|least, next| if next.1 < least.1 { next } else { least })
}
