//! Checks the tables of a material in the elements of a mesh: errors and warnings of the laws, with their place in
//! the deck.

use super::schema::Deck;
use crate::error::{ModelError, Warning};
use crate::material::by_energy::UNIT_LENGTH;
use crate::material::{
    Branch, ByEnergy, Curve, Curves, DamagePlasticityParameters, Material, MaterialParameters,
    TableError, TableWarning,
};

impl Deck {
    /// The law of the material `name` in elements of equivalent length `l_eq` [mm] (theory/crack-band.md, eq. 1).
    /// `None` is a single point, which has no size: its tables are not scaled.
    ///
    /// # Errors
    /// Unknown material, or tables from which no law can be made.
    pub fn law(
        &self,
        name: &str,
        l_eq: Option<f64>,
    ) -> Result<(Material, Vec<Warning>), ModelError> {
        let parameters = self.material(name)?;
        let lengths: Vec<f64> = l_eq.into_iter().collect();
        let warnings = match &parameters {
            MaterialParameters::Elastic(_) | MaterialParameters::Custom(_) => Vec::new(),
            MaterialParameters::DruckerPrager(p) => {
                let softens = p.tension_energy.or(p.compression_energy).is_some();
                let sized = l_eq.or(p.reference_length).is_some();
                let warning = (softens && !sized).then(|| without_length(self, name));
                warning.into_iter().collect()
            }
            MaterialParameters::DamagePlasticity(p) => {
                let mut warnings = judge(self, name, p, &lengths)?;
                let without = l_eq.is_none() && material_without_length(self, name);
                warnings.extend(without.then(|| one_millimetre(self, name)));
                warnings
            }
        };
        let (law, _) = Material::new(&parameters, l_eq)
            .map_err(|error| refusal(self, name, &parameters, &error))?;
        Ok((law, warnings))
    }
}

/// That a point without size does not soften.
fn without_length(deck: &Deck, name: &str) -> Warning {
    deck.warning(
        &format!("materials.{name}"),
        "softening by a fracture energy wants a length, and a point has none: it does not soften here; \
         reference_length gives it one"
            .to_owned(),
    )
}

/// Whether a material has fracture energies and no length for a point without size.
fn material_without_length(deck: &Deck, name: &str) -> bool {
    let material = deck.materials.get(name);
    material.is_some_and(|m| m.has_energies() && m.reference_length.is_none())
}

/// That a point without size softens as an element of 1 mm does.
fn one_millimetre(deck: &Deck, name: &str) -> Warning {
    deck.warning(
        &format!("materials.{name}"),
        format!(
            "softening by a fracture energy wants a length, and a point has none: it is that of an element of \
             {UNIT_LENGTH} mm; reference_length gives it another one"
        ),
    )
}

/// The strength and the fracture energy of a branch that the deck gives by them.
fn by_energy(deck: &Deck, name: &str, branch: Branch) -> Option<ByEnergy> {
    deck.materials.get(name)?.by_energy(branch)
}

/// Keys of strength and fracture energy.
fn keys_of(branch: Branch) -> [&'static str; 2] {
    match branch {
        Branch::Tension => ["f_t", "G_ft"],
        Branch::Compression => ["f_c", "G_fc"],
    }
}

/// Makes the law in elements of these equivalent lengths [mm], as a run does.
///
/// # Errors
/// What the law of the longest element says that has none.
pub(super) fn judge_law(
    deck: &Deck,
    name: &str,
    parameters: &MaterialParameters,
    lengths: &[f64],
) -> Result<(), ModelError> {
    let mut longest_first = lengths.iter().rev();
    match longest_first.find_map(|l_eq| Material::new(parameters, Some(*l_eq)).err()) {
        Some(error) => Err(refusal(deck, name, parameters, &error)),
        None => Ok(()),
    }
}

/// Builds both curves for elements of these equivalent lengths [mm], as a run does; without lengths the tables are
/// not scaled.
///
/// # Errors
/// Those of the curves; on each branch the first one of the longest element.
pub(super) fn judge(
    deck: &Deck,
    name: &str,
    p: &DamagePlasticityParameters,
    lengths: &[f64],
) -> Result<Vec<Warning>, ModelError> {
    let scalings: Vec<Option<(f64, f64)>> = match p.reference_length {
        Some(l_ref) if !lengths.is_empty() => lengths.iter().map(|l| Some((l_ref, *l))).collect(),
        _ => vec![None],
    };
    let (mut warnings, mut errors) = (Vec::new(), Vec::new());
    for (branch, rows) in [
        (Branch::Tension, &p.tension),
        (Branch::Compression, &p.compression),
    ] {
        let mut capped = Vec::new();
        let mut refused = None;
        for scaling in &scalings {
            match Curve::new(branch, rows, p.elastic.E, *scaling, p.interpolation) {
                Ok((_, said)) => capped.extend(said),
                // Of several lengths the longest is the most critical.
                Err(error) => refused = Some(error),
            }
        }
        let parameters = MaterialParameters::DamagePlasticity(p.clone());
        errors.extend(refused.map(|error| refusal(deck, name, &parameters, &error)));
        // The damage of rows that follow from an energy is no choice of the author.
        if by_energy(deck, name, branch).is_none() {
            warnings.extend(caps(deck, name, "elements", &capped));
        }
    }
    ModelError::gather(errors).map_or(Ok(warnings), Err)
}

/// Builds the curves of crack bands from the least to the largest of `widths` [mm], as a run does. Warns of damage that
/// is inadmissible in the table as given, that is in bands of the reference length.
///
/// # Errors
/// Those of the curves.
pub(super) fn judge_bands(
    deck: &Deck,
    name: &str,
    p: &DamagePlasticityParameters,
    widths: [f64; 2],
) -> Result<Vec<Warning>, ModelError> {
    let parameters = MaterialParameters::DamagePlasticity(p.clone());
    let (_, said) =
        Curves::of_bands(p, widths).map_err(|error| refusal(deck, name, &parameters, &error))?;
    let (of_the_table, _) = parted(deck, name, p, said);
    Ok(caps(deck, name, "bands", &of_the_table))
}

/// Notes on crack bands: those that count as narrower than they are (theory/crack-band.md, eq. 7), and damage that is
/// inadmissible only in bands wider than the reference length.
pub(super) fn band_notes(
    deck: &Deck,
    name: &str,
    p: &DamagePlasticityParameters,
    widths: [f64; 2],
) -> Vec<String> {
    let said = Curves::of_bands(p, widths).map_or_else(|_| Vec::new(), |(_, said)| said);
    let narrowed = said.iter().filter_map(|warning| match *warning {
        TableWarning::BandNarrowed {
            branch,
            row,
            width,
            limit,
        } => {
            let softening = match by_energy(deck, name, branch) {
                Some(_) => format!("softening with this {}", keys_of(branch)[1]),
                None => format!("softening to row {row}"),
            };
            Some(format!(
                "material {name}: elements are up to {width:.1} mm wide across a crack in {branch}; beyond {limit:.1} mm \
                 the {softening} would snap back, so it is that of {limit:.1} mm there, and a crack takes up to {:.1} \
                 times its energy: a run warns if that counted",
                width / limit
            ))
        }
        TableWarning::DamageCapped { .. } => None,
    });
    let mut notes: Vec<String> = narrowed.collect();
    let (_, of_wide_bands) = parted(deck, name, p, said);
    let caps = caps(deck, name, "bands", &of_wide_bands);
    notes.extend(caps.iter().map(ToString::to_string));
    notes
}

/// Capped damage of rows that are inadmissible in bands of the reference length, too, and of other rows. That of rows
/// that follow from an energy is no choice of the author and is left out.
fn parted(
    deck: &Deck,
    name: &str,
    p: &DamagePlasticityParameters,
    said: Vec<TableWarning>,
) -> (Vec<TableWarning>, Vec<TableWarning>) {
    let given = p
        .reference_length
        .map(|l_ref| Curves::of_bands(p, [l_ref; 2]));
    let given = given.and_then(Result::ok);
    let given = given.map_or_else(Vec::new, |(_, said)| said);
    let row = |warning: &TableWarning| match warning {
        TableWarning::DamageCapped { branch, row, .. }
            if by_energy(deck, name, *branch).is_none() =>
        {
            Some((*branch, *row))
        }
        _ => None,
    };
    let capped = said.into_iter().filter(|warning| row(warning).is_some());
    capped.partition(|warning| given.iter().any(|own| row(own) == row(warning)))
}

/// One warning for each row whose damage had to be capped (theory/damage-plasticity.md, eq. 11), for all lengths
/// together. `sized`: the things that have these lengths.
fn caps(deck: &Deck, name: &str, sized: &str, warnings: &[TableWarning]) -> Vec<Warning> {
    let mut rows: Vec<(Branch, usize)> = Vec::new();
    for warning in warnings {
        if let TableWarning::DamageCapped { branch, row, .. } = warning
            && !rows.contains(&(*branch, *row))
        {
            rows.push((*branch, *row));
        }
    }
    rows.into_iter()
        .map(|(branch, row)| {
            let of_row = warnings.iter().filter_map(|warning| match warning {
                TableWarning::DamageCapped {
                    branch: b,
                    row: r,
                    from,
                    to,
                    l_eq,
                } => (*b == branch && *r == row).then_some((*from, *to, *l_eq)),
                TableWarning::BandNarrowed { .. } => None,
            });
            let place = |(_, to, l_eq): (f64, f64, Option<f64>)| match l_eq {
                Some(l_eq) => format!("{to:.4} in {sized} of {l_eq:.1} mm"),
                None => format!("{to:.4}"),
            };
            let least = of_row.clone().reduce(|a, b| if b.1 < a.1 { b } else { a });
            let most = of_row.reduce(|a, b| if b.1 > a.1 { b } else { a });
            let (from, to) = match least.zip(most) {
                Some((least, most)) if most.1 - least.1 > 5e-5 => {
                    (least.0, format!("{} to {}", place(least), place(most)))
                }
                Some((least, _)) => (least.0, place(least)),
                None => (0.0, String::new()),
            };
            let message = format!(
                "row {row}: the damage {from} is inadmissible with this E, stress and strain (the \
                 plastic strain would fall); capped to {to}, the stress is kept"
            );
            deck.warning(&cell(name, branch, row, Some(2)), message)
        })
        .collect()
}

/// Path of a row, counted from 1, or of a cell in it.
fn cell(name: &str, branch: Branch, row: usize, column: Option<usize>) -> String {
    let row = format!("materials.{name}.{branch}.{}", row - 1);
    column.map_or(row.clone(), |column| format!("{row}.{column}"))
}

/// The error of a curve that follows from a strength and a fracture energy: its rows are not in the deck.
fn too_brittle(deck: &Deck, name: &str, error: &TableError) -> Option<ModelError> {
    let (branch, what) = match error {
        TableError::SnapBack {
            branch,
            l_eq,
            l_max,
            ..
        } => (
            *branch,
            format!(
                "elements of {l_eq:.1} mm (cube root of the volume) are over the limit of {l_max:.1} mm"
            ),
        ),
        TableError::Row { branch, .. } | TableError::Inadmissible { branch, .. } => (
            *branch,
            format!("an element of {UNIT_LENGTH} mm is too large"),
        ),
        _ => return None,
    };
    let of = by_energy(deck, name, branch)?;
    let [strength, energy] = keys_of(branch);
    Some(deck.error(
        &format!("materials.{name}.{energy}"),
        format!(
            "{what}: the softening in {branch} with `{strength}` = {} MPa and `{energy}` = {} N/mm snaps back within \
             an element",
            of.strength, of.energy
        ),
        &format!(
            "refine the mesh, give a larger {energy}, or leave out crack_band = \"volume\": `projected` narrows \
             bands that are too wide"
        ),
    ))
}

/// Converts the error of a law to one at its place in the deck, with advice.
#[expect(
    clippy::too_many_lines,
    reason = "one match: key, message and advice of each error of a law stand side by side"
)]
pub(super) fn refusal(
    deck: &Deck,
    name: &str,
    parameters: &MaterialParameters,
    error: &TableError,
) -> ModelError {
    let table = |branch: Branch| format!("materials.{name}.{branch}");
    if let Some(error) = too_brittle(deck, name, error) {
        return error;
    }
    match error {
        TableError::TooShort { branch } => deck.error(
            &table(*branch),
            "the table has one row: first yield, and nothing after it",
            &format!("add rows, e.g. {}", crate::deck::keys::example(&branch.to_string())),
        ),
        TableError::Row { branch, row, what } => deck.error(
            &cell(name, *branch, *row, None),
            format!("row {row}: {what}"),
            "give this row a larger inelastic strain (total strain minus stress/E), or E a larger \
             value",
        ),
        TableError::Inadmissible {
            branch,
            row,
            damage,
            capped,
        } => deck.error(
            &cell(name, *branch, *row, Some(2)),
            format!(
                "row {row}: the damage {damage} is inadmissible with this E, stress and strain (the \
                 plastic strain would fall), and the largest admissible one, {capped:.4}, is below \
                 that of row {}",
                row - 1
            ),
            "lower the damage of the rows before it, or give this row a larger inelastic strain",
        ),
        TableError::TooBrittle {
            branch,
            l_eq,
            l_max,
        } => {
            let key = match branch {
                Branch::Tension => "G_I",
                Branch::Compression => "G_c",
            };
            deck.error(
                &format!("materials.{name}.{key}"),
                format!(
                    "elements of {l_eq:.1} mm (cube root of the volume) are not below the limit of {l_max:.1} mm: \
                     beyond it the softening in {branch} with this {key} snaps back within an element"
                ),
                "refine the mesh, or give more fracture energy",
            )
        }
        TableError::Law { law, why } => deck.error(
            &format!("materials.{name}"),
            format!("the law `{law}`: {why}"),
            "change the parameters of this material, or the mesh",
        ),
        TableError::SnapBack {
            branch,
            row,
            l_eq,
            l_max,
        } => {
            let l_ref = match parameters {
                MaterialParameters::DamagePlasticity(p) => p.reference_length,
                _ => None,
            };
            let of = l_ref.map_or_else(String::new, |l| format!(" (for {l} mm)"));
            deck.error(
                &table(*branch),
                format!(
                    "elements of {l_eq:.1} mm (cube root of the volume) are over the limit of \
                     {l_max:.1} mm: beyond it the softening of this table{of} to row {row} snaps \
                     back within an element"
                ),
                if deck.has_walls() {
                    "refine wall.mesh, or give the last row a larger inelastic strain"
                } else {
                    "refine `mesh` of its blocks, or give the last row a larger inelastic strain"
                },
            )
        }
    }
}
