//! Sense of rotation of faces that differ from their neighbours.

use super::{Welded, volume};

impl Welded {
    /// Turns faces so that neighbours at edges of two faces run in opposite directions along them, and shells have a
    /// positive volume. Triangles of a hull or a scan often have no common sense of rotation. Parts whose faces have
    /// one stay as they are.
    pub(super) fn orient(&mut self) {
        let edges = self.half_edges();
        let pairs = edges.chunk_by(|a, b| (a.low, a.high) == (b.low, b.high));
        let pairs = pairs.filter_map(|edge| match edge {
            [a, b] => Some((a.face, b.face, a.is_forward == b.is_forward)),
            _ => None,
        });
        let pairs: Vec<(u32, u32, bool)> = pairs.collect();
        if !pairs.iter().any(|(.., is_wrong)| *is_wrong) {
            return;
        }
        let mut neighbours: Vec<Vec<(u32, bool)>> = vec![Vec::new(); self.faces.len()];
        for (a, b, is_wrong) in pairs {
            neighbours[a as usize].push((b, is_wrong));
            neighbours[b as usize].push((a, is_wrong));
        }
        let mut is_met = vec![false; self.faces.len()];
        for seed in 0..self.faces.len() {
            if is_met[seed] {
                continue;
            }
            is_met[seed] = true;
            let mut shell = vec![(seed as u32, false)];
            let mut at = 0;
            while let Some((f, is_turned)) = shell.get(at).copied() {
                at += 1;
                for (g, is_wrong) in &neighbours[f as usize] {
                    if !std::mem::replace(&mut is_met[*g as usize], true) {
                        shell.push((*g, is_turned != *is_wrong));
                    }
                }
            }
            self.turn(&shell);
        }
    }

    /// Turns the faces of a shell that are marked, or all others if the volume is positive then.
    fn turn(&mut self, shell: &[(u32, bool)]) {
        if !shell.iter().any(|(_, is_turned)| *is_turned) {
            return;
        }
        for (f, _) in shell.iter().filter(|(_, is_turned)| *is_turned) {
            self.faces[*f as usize].reverse();
        }
        let own: Vec<Vec<u32>> = shell
            .iter()
            .map(|(f, _)| self.faces[*f as usize].clone())
            .collect();
        let is_inwards = volume(&self.vertices, &own) < 0.0;
        if is_inwards {
            for (f, _) in shell {
                self.faces[*f as usize].reverse();
            }
        }
        self.turned += shell
            .iter()
            .filter(|(_, is_turned)| *is_turned != is_inwards)
            .count();
    }
}
