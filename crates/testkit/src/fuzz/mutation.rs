//! Bytes with changes that matter to readers.

use crate::random::uniform;

/// Numbers by the place of the file in its campaign, so that any file can be made again.
#[derive(Debug, Clone)]
pub struct Dice {
    place: u64,
}

impl Dice {
    /// The dice of file `number` of a campaign.
    pub fn new(number: u64) -> Self {
        Self { place: number << 20 }
    }

    /// A whole number below `limit`; 0 where there is none.
    pub fn below(&mut self, limit: usize) -> usize {
        self.place += 1;
        (((uniform(self.place) + 1.0) / 2.0 * limit as f64) as usize).min(limit.saturating_sub(1))
    }

    /// One of several.
    pub fn one_of<'a, T>(&mut self, choices: &'a [T]) -> &'a T {
        &choices[self.below(choices.len())]
    }
}

/// Lengths, counts and offsets that a reader must not believe.
pub const LYING_LENGTHS: [u64; 9] = [0, 1, 0xff, 1 << 16, 1 << 31, 1 << 32, 1 << 40, u64::MAX / 2, u64::MAX];

const PIECES: [&[u8]; 14] = [
    b"NaN",
    b"1e999",
    b"-1e308",
    b"99999999999999999999",
    b"\n",
    b",",
    b"\"",
    b"\0",
    b"\x1b[2J",
    b"\xff\xfe",
    b"[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[",
    b"{\"a\":",
    b"=",
    b"0",
];

/// One to four changes: bits, lengths, pieces of text, cuts, parts left out or twice.
pub fn mutate(bytes: &mut Vec<u8>, dice: &mut Dice) {
    for _ in 0..=dice.below(4) {
        let span = if dice.below(2) == 0 { bytes.len().min(4096) } else { bytes.len() };
        let at = dice.below(span + 1).min(bytes.len());
        let end = (at + dice.below(400)).min(bytes.len());
        match dice.below(8) {
            0 | 1 => bytes[at..].iter_mut().take(1).for_each(|byte| *byte ^= 1 << dice.below(8)),
            2 => {
                let length = dice.one_of(&LYING_LENGTHS).to_le_bytes();
                let end = bytes.len().min(at + 8);
                bytes[at..end].copy_from_slice(&length[..end - at]);
            }
            3 => drop(bytes.splice(at..at, dice.one_of(&PIECES).iter().copied())),
            4 => {
                let piece = *dice.one_of(&PIECES);
                let end = bytes.len().min(at + piece.len());
                bytes.splice(at..end, piece.iter().copied());
            }
            5 => drop(bytes.drain(at..end)),
            6 => {
                let copy = bytes[at..end].to_vec();
                drop(bytes.splice(at..at, copy));
            }
            _ if dice.below(4) == 0 => bytes.truncate(at),
            _ => {}
        }
    }
}
