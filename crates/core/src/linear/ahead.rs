//! Prefetching of factors.
//!
//! A substitution reads each number of the factors once in each direction. Factors that exceed the caches are read
//! from memory. Processors predict such reads only for one long ascending stream. Fronts, however, are read four
//! columns at a time, and in back substitution from the last one to the first. So one number of each cache line is
//! read some fronts ahead, which loads many lines at the same time. The results do not depend on it.

use std::hint::black_box;
use std::ops::Range;

use super::number::Number;

/// Size of the factors from which they exceed the caches [bytes].
const FAR: usize = 16 << 20;
/// Largest size that is prefetched together, except for one larger front [bytes]. It stays in a cache of its core.
const PIECE: usize = 256 << 10;
/// Size of a cache line [bytes].
const LINE: usize = 64;

/// Prefetches fronts where that saves time.
pub(super) struct Ahead<'a, T> {
    numbers: &'a [T],
    /// Start of each front. `[supernode + 1]`
    starts: &'a [usize],
    /// Supernodes already read. All, if the factors fit into the caches.
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

    /// Call before front `s` is used, in ascending order of supernodes up to `end`.
    pub fn up(&mut self, s: usize, end: usize) {
        if !self.read.contains(&s) {
            let last = (s + 1..end).find(|&t| self.bytes(&(s..t + 1)) > PIECE);
            self.read(s..last.unwrap_or(end));
        }
    }

    /// Call before front `s` is used, in descending order of supernodes down to `start`.
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
        // The unused sum prevents the compiler from removing the reads.
        black_box(lines.fold(T::ZERO, |sum, x| sum + *x));
        self.read = supernodes;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Fronts are read once in each direction, in pieces that end with a front. A front larger than a piece is read
    /// alone.
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

    /// Factors that fit into the caches are not prefetched.
    #[test]
    fn small_gaps_are_not_read_ahead() {
        let (numbers, starts) = (vec![0.0_f64; 8], [0, 4, 8]);
        let mut ahead = Ahead::new(&numbers, &starts);
        let all = ahead.read.clone();
        ahead.up(0, 2);
        ahead.down(1, 0);
        assert_eq!(ahead.read, all);
    }
}
