//! Random numbers of Python's `random.Random(seed)`, so that Python and Rust draw the same wall from a seed.
//!
//! The generator is MT19937 (Matsumoto and Nishimura, 1998). This file implements the parts that CPython adds to
//! it (Modules/_randommodule.c, Lib/random.py, unchanged since Python 3.2): the seed from an integer, and
//! fractions and choices from 32-bit words.

use rand_mt::Mt;

/// Python's `random.Random` with an integer seed.
pub struct PythonRandom(Mt);

impl PythonRandom {
    /// `random.Random(seed)`: the key of `init_by_array` consists of the 32-bit digits of the seed, the lowest
    /// first, at least one.
    pub fn new(seed: u64) -> Self {
        let (low, high) = (seed as u32, (seed >> 32) as u32);
        let digits = if high == 0 { 1 } else { 2 };
        Self(Mt::new_with_key([low, high].into_iter().take(digits)))
    }

    /// `random()`: a fraction of 53 bits from two words, 0 ≤ x < 1.
    pub fn random(&mut self) -> f64 {
        let (a, b) = (self.0.next_u32() >> 5, self.0.next_u32() >> 6);
        (f64::from(a) * 67_108_864.0 + f64::from(b)) / 9_007_199_254_740_992.0 // (a 2²⁶ + b) / 2⁵³
    }

    /// `uniform(a, b)`.
    pub fn uniform(&mut self, a: f64, b: f64) -> f64 {
        a + (b - a) * self.random()
    }

    /// `choice(of)`: takes the highest bits of a word, as many as the length of the list has, and repeats until
    /// they are less than the length. An empty list does not compile.
    pub fn choice<T: Copy, const N: usize>(&mut self, of: &[T; N]) -> T {
        const { assert!(N > 0) };
        let length = N as u32;
        loop {
            let bits = self.0.next_u32() >> length.leading_zeros();
            if bits < length {
                return of[bits as usize];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Values of Python 3.11: `r = random.Random(seed); r.random(), r.uniform(-2, 5), r.choice(range(10)),
    /// r.choice(range(8)), r.random()`.
    #[test]
    fn numbers_are_those_of_python() {
        for (seed, random, uniform, choices, last) in STORED {
            let mut random_numbers = PythonRandom::new(seed);
            let tens: [u32; 10] = std::array::from_fn(|i| i as u32);
            let eights: [u32; 8] = std::array::from_fn(|i| i as u32);
            // The operations and their order are those of Python, so all bits agree.
            assert_eq!(random_numbers.random(), random, "{seed}");
            assert_eq!(random_numbers.uniform(-2.0, 5.0), uniform, "{seed}");
            assert_eq!(random_numbers.choice(&tens), choices[0], "{seed}");
            assert_eq!(random_numbers.choice(&eights), choices[1], "{seed}");
            assert_eq!(random_numbers.random(), last, "{seed}");
        }
    }

    const STORED: [(u64, f64, f64, [u32; 2], f64); 4] = [
        (
            0,
            0.8444218515250481,
            3.3056808205821175,
            [6, 0],
            0.25891675029296335,
        ),
        (
            1,
            0.13436424411240122,
            3.9320361585606287,
            [1, 4],
            0.11791870367106105,
        ),
        (
            4294967301,
            0.15727238718789782,
            -0.022593578476600484,
            [9, 0],
            0.35506619235705983,
        ),
        (
            18446744073709551615,
            0.021825695401270107,
            0.36666728802963044,
            [3, 7],
            0.6151259995625727,
        ),
    ];
}
