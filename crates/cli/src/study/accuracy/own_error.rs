//! Error of the reference itself, estimated from the choices that share a part of its refinement.
//!
//! Suppose that the reference has both elements and increments of half the size. Its difference from a run with
//! only one of the two shows the effect of the other. If the error is proportional to the size (first order),
//! every halving leaves an error as large as the change.

use super::errors::Errors;
use super::outcome::{Outcome, Studied};
use super::scene::Origin;
use crate::study::expect::percent;

/// Keys of the deck and their values.
type Set = [(String, String)];

/// Effect of each refinement of the reference and the remaining error, in words; none if no two choices share the
/// refinements between them.
pub fn own_error(studied: &Studied) -> Option<String> {
    let Origin::Run(reference) = &studied.scene.reference.origin else {
        return None;
    };
    let alone = |o: &&Outcome| o.choice.threads == 1;
    let outcomes: Vec<&Outcome> = studied.outcomes.iter().filter(alone).collect();
    let sets: Vec<&Set> = outcomes.iter().map(|o| o.choice.set.as_slice()).collect();
    let (mut told, mut peak, mut energy) = (Vec::new(), 0.0, 0.0);
    for pair in pairs(&reference.set, &sets) {
        let [part, other] = pair.map(|i| outcomes[i]);
        let name = &part.choice.name;
        let Ok(Errors {
            peak: of_peak,
            energy: of_energy,
            ..
        }) = part.errors
        else {
            return Some(format!(
                "Its own error is not known: `{name}` does not come to the end."
            ));
        };
        peak += of_peak.abs();
        energy += of_energy.abs();
        told.push(format!(
            "`{name}`, which lacks only what `{}` has, is {} off its peak and {} off its energy",
            other.choice.name,
            percent(of_peak),
            percent(of_energy)
        ));
    }
    let [peak, energy] = [peak, energy].map(|e| percent(e).trim_start_matches('+').to_owned());
    (!told.is_empty()).then(|| {
        format!(
            "Its own error: {}. If errors are proportional to element and increment size, the remaining error is as large: up to {peak} of its peak and {energy} of its energy.",
            told.join("; ")
        )
    })
}

/// Pairs of sets that together contain exactly the keys of `whole`: the set that lacks a part, and the set with
/// just that part. `[pair][lacks, has]`
fn pairs(whole: &Set, sets: &[&Set]) -> Vec<[usize; 2]> {
    let has = |lacks: &Set| sets.iter().position(|other| splits(whole, [lacks, other]));
    let parts = sets.iter().enumerate();
    let parts = parts.filter(|(_, part)| part.len() < whole.len());
    let mut pairs: Vec<[usize; 2]> = parts
        .filter_map(|(i, part)| Some([i, has(part)?]))
        .collect();
    // The empty set lacks the parts that the others lack together, so it is left out.
    if pairs.len() > 1 {
        pairs.retain(|&[lacks, _]| !sets[lacks].is_empty());
    }
    pairs
}

/// Whether `parts` together contain each key of `whole` once and no other key.
fn splits(whole: &Set, parts: [&Set; 2]) -> bool {
    let both = || parts.into_iter().flatten();
    both().count() == whole.len() && whole.iter().all(|key| both().any(|other| other == key))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn set(keys: &[&str]) -> Vec<(String, String)> {
        let pair = |key: &&str| ((*key).to_owned(), "1".to_owned());
        keys.iter().map(pair).collect()
    }

    #[test]
    fn keys_are_split_where_each_is_in_one_part() {
        let whole = set(&["mesh", "initial", "max"]);
        let is = |parts: [&[&str]; 2]| splits(&whole, [&set(parts[0]), &set(parts[1])]);
        assert!(is([&["mesh"], &["max", "initial"]]));
        assert!(is([&["mesh", "initial", "max"], &[]]));
        assert!(!is([&["mesh"], &["max"]]));
        assert!(!is([&["mesh", "max"], &["max", "initial"]]));
        assert!(!is([&["mesh", "other"], &["max"]]));
        assert!(!is([&["mesh", "mesh"], &["max"]]));
    }
    #[test]
    fn what_is_lacking_counts_once() {
        let whole = set(&["mesh", "initial", "max"]);
        let [default, mesh, steps, other] =
            [&[][..], &["mesh"], &["initial", "max"], &["other"]].map(set);
        let of = |sets: &[&Set]| pairs(&whole, sets);
        assert_eq!(of(&[&default, &mesh, &other, &steps]), [[1, 3], [3, 1]]);
        // A choice with all keys is the reference itself.
        assert_eq!(of(&[&default, &mesh, &steps, &whole]), [[1, 2], [2, 1]]);
        assert_eq!(of(&[&default, &mesh, &whole]), [[0, 2]]);
        assert!(of(&[&default, &mesh, &other]).is_empty());
    }
}
