//! Is every body held? A body that nothing holds makes the equations singular.

/// Bodies that no chain of interfaces joins to a held one.
///
/// `held`: touched by a support or a beam, `[body]`; `joints`: pairs of bodies whose interface can
/// carry force in all directions.
pub(super) fn unheld_bodies(held: &[bool], joints: impl Iterator<Item = (u32, u32)>) -> Vec<usize> {
    let ground = held.len();
    let mut parent: Vec<usize> = (0..=ground).collect();
    for (body, _) in held.iter().enumerate().filter(|(_, held)| **held) {
        unite(&mut parent, body, ground);
    }
    for (a, b) in joints {
        unite(&mut parent, a as usize, b as usize);
    }
    let root = find(&mut parent, ground);
    (0..ground)
        .filter(|&body| find(&mut parent, body) != root)
        .collect()
}

fn find(parent: &mut [usize], mut i: usize) -> usize {
    while parent[i] != i {
        parent[i] = parent[parent[i]];
        i = parent[i];
    }
    i
}

fn unite(parent: &mut [usize], a: usize, b: usize) {
    let (a, b) = (find(parent, a), find(parent, b));
    parent[a.max(b)] = a.min(b);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chain_from_the_ground_holds() {
        let held = [true, false, false, false, false];
        // 0–2–1 hangs on the ground, 3–4 hangs on nothing
        let joints = [(2, 1), (0, 2), (3, 4)];
        assert_eq!(unheld_bodies(&held, joints.into_iter()), vec![3, 4]);
        assert_eq!(
            unheld_bodies(&held, joints.into_iter().chain([(4, 1)])),
            Vec::<usize>::new()
        );
        assert_eq!(
            unheld_bodies(&[false, false], [(0, 1)].into_iter()),
            vec![0, 1]
        );
    }
}
