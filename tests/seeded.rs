//! Seeded numbers and seeded changes of texts, for the tests of every reader: a run is the same on every machine.

#![allow(dead_code, clippy::unwrap_used, reason = "each test takes its part; a panic is a failure")]

/// SplitMix64.
pub struct Random(pub u64);

impl Random {
    /// Sixty-four bits.
    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// In [0, bound).
    pub fn below(&mut self, bound: usize) -> usize {
        usize::try_from(self.next() % bound.max(1) as u64).unwrap()
    }

    /// In [0, 1).
    pub fn part(&mut self) -> f64 {
        (self.next() >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// One of the seeds after one to `most` changes: bytes removed, copied and exchanged, words of `words` inserted, the rest of another
/// seed appended. Half of the changed bytes are printable.
pub fn mutated(seeds: &[&str], words: &[&str], most: usize, random: &mut Random) -> Vec<u8> {
    let mut bytes = seeds[random.below(seeds.len())].as_bytes().to_vec();
    for _ in 0..=random.below(most) {
        let at = random.below(bytes.len() + 1);
        let until = (at + random.below(20)).min(bytes.len());
        let word = words[random.below(words.len())].as_bytes();
        match random.below(7) {
            0 => drop(bytes.drain(at..until)),
            1 => drop(bytes.splice(at..at, word.iter().copied())),
            2 => drop(bytes.splice(at..until, word.iter().copied())),
            3 => {
                let copy = bytes[at..until].to_vec();
                let to = random.below(bytes.len() + 1);
                bytes.splice(to..to, copy);
            }
            4 if at < bytes.len() => bytes[at] = (random.next() & 0xff) as u8,
            5 if at < bytes.len() => bytes[at] = b' ' + u8::try_from(random.below(95)).unwrap(),
            _ => {
                let other = seeds[random.below(seeds.len())].as_bytes();
                let from = random.below(other.len());
                bytes.truncate(at);
                bytes.extend_from_slice(&other[from..]);
            }
        }
    }
    bytes
}
