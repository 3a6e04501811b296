//! Factors read ahead of their use.
//!
//! A substitution reads every number of the factors once each way. What does not fit into the caches comes from memory, and
//! processors foresee reads there if these are one long ascending stream: fronts are read four columns side by side, and
//! on the way back from the last one to the first. One number of each cache line, read some fronts ahead and for nothing else,
//! has many lines under way at a time. Nothing is computed by it.

use std::hint::black_box;
use std::ops::Range;

use super::number::Number;

/// Bytes of factors from which on they are not found in caches.
const FAR: usize = 16 << 20;
/// Bytes that are read ahead together, unless one front has more: they stay in a cache of their core.
const PIECE: usize = 256 << 10;
/// Bytes of a cache line.
const LINE: usize = 64;

/// Reads fronts ahead, if that pays.
pub(super) struct Ahead<'a, T> {
    numbers: &'a [T],
    /// Where each front begins. `[supernode + 1]`
    starts: &'a [usize],
    /// Supernodes that are read already; of factors in caches all.
    read: Range<usize>,
}

impl<'a, T: Number> Ahead<'a, T> {
    pub fn new(numbers: &'a [T], starts: &'a [usize]) -> Self {
        let near = size_of_val(numbers) < FAR;
        Self {
            numbers,
            starts,
            read: if near { 0..starts.len() } else { 0..0 },
        }
    }

    /// Before the front of `s`, of supernodes that ascend up to `end`.
    pub fn up(&mut self, s: usize, end: usize) {
        if !self.read.contains(&s) {
            let last = (s + 1..end).find(|&t| self.bytes(&(s..t + 1)) > PIECE);
            self.read(s..last.unwrap_or(end));
        }
    }

    /// Before the front of `s`, of supernodes that descend to `start`.
    pub fn down(&mut self, s: usize, start: usize) {
        if !self.read.contains(&s) {
            let first = (start..s).rev().find(|&t| self.bytes(&(t..s + 1)) > PIECE);
            self.read(first.map_or(start, |t| t + 1)..s + 1);
        }
    }

    fn bytes(&self, supernodes: &Range<usize>) -> usize {
        (self.starts[supernodes.end] - self.starts[supernodes.start]) * size_of::<T>()
    }

    fn read(&mut self, supernodes: Range<usize>) {
        let numbers = &self.numbers[self.starts[supernodes.start]..self.starts[supernodes.end]];
        let lines = numbers.iter().step_by(LINE / size_of::<T>());
        // Sums that nobody wants, so that the reads are not left out.
        black_box(lines.fold(T::ZERO, |sum, x| sum + *x));
        self.read = supernodes;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Fronts are read in pieces that end with a front, each once, both ways; one that is larger than a piece by itself.
    #[test]
    fn reads_whole_fronts_once() {
        let piece = PIECE / size_of::<f32>();
        let sizes = [piece / 2, piece / 2, 1, 3 * piece, piece, FAR];
        let starts: Vec<usize> = (0..=sizes.len()).map(|s| sizes[..s].iter().sum()).collect();
        let numbers = vec![0.0_f32; starts[sizes.len()]];
        let mut ahead = Ahead::new(&numbers, &starts);
        let mut up: Vec<Range<usize>> = Vec::new();
        for s in 0..sizes.len() {
            ahead.up(s, sizes.len());
            up.push(ahead.read.clone());
        }
        assert_eq!(up, [0..2, 0..2, 2..3, 3..4, 4..5, 5..6]);
        ahead.read = 0..0;
        let mut down = Vec::new();
        for s in (0..sizes.len()).rev() {
            ahead.down(s, 0);
            down.push(ahead.read.clone());
        }
        assert_eq!(down, [5..6, 4..5, 3..4, 1..3, 1..3, 0..1]);
    }

    /// What fits into the caches is not read ahead.
    #[test]
    fn what_is_near_is_left() {
        let (numbers, starts) = (vec![0.0_f64; 8], [0, 4, 8]);
        let mut ahead = Ahead::new(&numbers, &starts);
        let all = ahead.read.clone();
        ahead.up(0, 2);
        ahead.down(1, 0);
        assert_eq!(ahead.read, all);
    }
}
