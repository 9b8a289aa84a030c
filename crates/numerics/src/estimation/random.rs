//! Random numbers that are the same for any number of threads.

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

/// The places that a resampled record of `samples` samples takes its values from: blocks of `length` neighbours on a
/// circle, each begun at random, so that the correlation in time is kept within a block.
///
/// Politis & Romano, "A circular block-resampling procedure for stationary data", 1992.
pub fn circular_blocks(random: &mut RandomNumbers, samples: usize, length: usize) -> Vec<usize> {
    let mut places = Vec::with_capacity(samples + length);
    while places.len() < samples {
        let first = random.below(samples);
        places.extend((0..length.max(1)).map(|k| (first + k) % samples));
    }
    places.truncate(samples);
    places
}

// Rows of random numbers: uniform and normal deviates of a seed.

/// 53 bits over the interval from 0 to 1.
const UNIT: f64 = 1.0 / (1_u64 << 53) as f64;

/// A row of independent random numbers, the same for the same seed: ChaCha8, 53 bits each.
#[derive(Debug, Clone)]
pub struct RandomNumbers(ChaCha8Rng);

impl RandomNumbers {
    /// The row of a seed.
    pub fn seeded(seed: u64) -> Self {
        Self(ChaCha8Rng::seed_from_u64(seed))
    }

    /// Row `index` of a seed, independent of its others: repetitions that each draw from their own row do not depend on
    /// the order in which they run.
    pub fn of_stream(seed: u64, index: usize) -> Self {
        let mut row = Self::seeded(seed);
        row.0.set_stream(index as u64);
        row
    }

    /// Uniform on [0, 1).
    pub fn uniform(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 * UNIT
    }

    /// A whole number from 0 to `count - 1`, each as likely to 1e-13 for fewer than a million; 0 for a count of 0.
    pub fn below(&mut self, count: usize) -> usize {
        (self.0.next_u64() % count.max(1) as u64) as usize
    }

    /// A standard normal deviate from two uniform numbers, `sqrt(-2 ln u) cos(2 pi w)` with `u` on (0, 1] and `w` on
    /// [0, 1). The 53 bits end the tails at 8.6.
    ///
    /// Box & Muller, "A note on the generation of random normal deviates", Ann. Math. Stat. 29, 1958.
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (self.uniform() + UNIT).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.uniform()).cos()
    }
}

// Points that fill a box more evenly than random ones.

/// Coordinates that [`EvenPoints`] have at most.
pub const MOST_COORDINATES: usize = 12;
/// Degree, inner coefficients and first direction numbers of the primitive polynomial of each coordinate after the
/// first: Joe & Kuo, "Constructing Sobol' sequences with better two-dimensional projections", SIAM J. Sci. Comput. 30,
/// 2008.
const DIRECTIONS: [(usize, u32, [u32; 5]); MOST_COORDINATES - 1] = [
    (1, 0, [1, 0, 0, 0, 0]),
    (2, 1, [1, 3, 0, 0, 0]),
    (3, 1, [1, 3, 1, 0, 0]),
    (3, 2, [1, 1, 1, 0, 0]),
    (4, 1, [1, 1, 3, 3, 0]),
    (4, 4, [1, 3, 5, 13, 0]),
    (5, 2, [1, 1, 5, 5, 17]),
    (5, 4, [1, 1, 5, 5, 5]),
    (5, 7, [1, 1, 7, 11, 19]),
    (5, 11, [1, 1, 5, 1, 1]),
    (5, 13, [1, 1, 1, 3, 11]),
];
/// Binary digits of a coordinate.
const DIGITS: usize = 32;

/// The points of Sobol's sequence in the unit cube, shifted at random by a seed: each alone is uniform, and of `2^k` of
/// them each coordinate has one in every `2^-k` of the interval.
///
/// Means over `n` of them are off by about `1/n` instead of `1/sqrt(n)` where a function is smooth, and quantiles by
/// something between. Sobol', "On the distribution of points in a cube and the approximate evaluation of integrals",
/// USSR Comput. Math. Math. Phys. 7, 1967; the shift adds random binary digits without carry (Cranley & Patterson
/// 1976).
#[derive(Debug, Clone)]
pub struct EvenPoints {
    /// Direction numbers of each coordinate.
    directions: Vec<[u32; DIGITS]>,
    shifts: Vec<u32>,
}

impl EvenPoints {
    /// The points of a seed, with so many coordinates, [`MOST_COORDINATES`] at most.
    pub fn seeded(seed: u64, coordinates: usize) -> Self {
        let coordinates = coordinates.min(MOST_COORDINATES);
        let mut random = RandomNumbers::seeded(seed);
        Self {
            directions: (0..coordinates).map(direction_numbers).collect(),
            shifts: (0..coordinates).map(|_| (random.0.next_u64() >> DIGITS) as u32).collect(),
        }
    }

    /// Point `index`, each coordinate above 0 and below 1.
    pub fn point(&self, index: usize) -> Vec<f64> {
        // Each point differs from the one before by one direction number.
        let gray = index ^ (index >> 1);
        let digits = |directions: &[u32; DIGITS]| {
            (0..DIGITS).filter(|bit| (gray >> bit) & 1 == 1).fold(0, |sum, bit| sum ^ directions[bit])
        };
        let shifted = self.directions.iter().zip(&self.shifts).map(|(directions, shift)| digits(directions) ^ shift);
        shifted.map(|x| (f64::from(x) + 0.5) / (1_u64 << DIGITS) as f64).collect()
    }
}

/// The direction numbers of a coordinate.
fn direction_numbers(coordinate: usize) -> [u32; DIGITS] {
    let Some((degree, inner, first)) = coordinate.checked_sub(1).map(|row| DIRECTIONS[row]) else {
        return std::array::from_fn(|bit| 1 << (DIGITS - 1 - bit));
    };
    let mut numbers = [0; DIGITS];
    for bit in 0..DIGITS {
        numbers[bit] = if bit < degree {
            first[bit] << (DIGITS - 1 - bit)
        } else {
            let earlier = (1..degree).filter(|k| (inner >> (degree - 1 - k)) & 1 == 1).map(|k| numbers[bit - k]);
            earlier.fold(numbers[bit - degree] ^ (numbers[bit - degree] >> degree), |sum, number| sum ^ number)
        };
    }
    numbers
}

// Random numbers that depend on their stream and index alone.
//
// Meant for starts and resampling in parallel: each draw names its place in the sequence, so no generator is shared
// and no order of evaluation matters.

/// Number `index` of stream `stream`, uniform on [0, 1): ChaCha8 with a fixed seed, so the same for any number of
/// threads and in any order.
pub fn uniform_at(stream: usize, index: usize) -> f64 {
    let mut rng = ChaCha8Rng::seed_from_u64(0x5EED);
    rng.set_stream(stream as u64);
    rng.set_word_pos(2 * index as u128);
    (rng.next_u64() >> 11) as f64 * 2.0_f64.powi(-53)
}

#[cfg(test)]
mod tests {

    use super::*;

    #[test]
    fn every_block_is_of_neighbours_and_every_place_as_likely() {
        let mut counts = [0; 10];
        for index in 0..2000 {
            let places = circular_blocks(&mut RandomNumbers::of_stream(1, index), 10, 4);
            assert_eq!(places.len(), 10);
            for block in places.chunks(4) {
                assert!(block.windows(2).all(|pair| pair[1] == (pair[0] + 1) % 10), "{places:?}");
            }
            places.iter().for_each(|place| counts[*place] += 1);
        }
        // 2000 times ten places; blocks make the count of one vary as three independent draws a record would, 2 sqrt
        // of the mean at most. Five of these.
        assert!(counts.iter().all(|count: &i32| (count - 2000).abs() < 450), "{counts:?}");
        assert!(circular_blocks(&mut RandomNumbers::seeded(1), 0, 3).is_empty());
    }

    #[test]
    fn mean_variance_and_fourth_moment_are_those_of_the_normal_distribution() {
        let mut random = RandomNumbers::seeded(3);
        let n = 20_000;
        let draws: Vec<f64> = (0..n).map(|_| random.normal()).collect();
        let moment = |power: i32| draws.iter().map(|x| x.powi(power)).sum::<f64>() / f64::from(n);
        // Five standard errors: sqrt(1/n), sqrt(2/n), sqrt(96/n).
        let error = 5.0 / f64::from(n).sqrt();
        assert!(moment(1).abs() < error, "{}", moment(1));
        assert!((moment(2) - 1.0).abs() < 2.0_f64.sqrt() * error, "{}", moment(2));
        assert!((moment(4) - 3.0).abs() < 96.0_f64.sqrt() * error, "{}", moment(4));
    }

    #[test]
    fn each_coordinate_of_even_points_has_one_in_every_part_of_the_interval() {
        for seed in 0..3 {
            let points = EvenPoints::seeded(seed, MOST_COORDINATES);
            // The first block, and one that begins later.
            for first in [0, 128] {
                for coordinate in 0..MOST_COORDINATES {
                    let mut parts: Vec<usize> =
                        (first..first + 128).map(|k| (128.0 * points.point(k)[coordinate]) as usize).collect();
                    parts.sort_unstable();
                    assert!(parts.iter().copied().eq(0..128), "{seed} {coordinate}: {parts:?}");
                }
            }
        }
        let points = |seed| EvenPoints::seeded(seed, 2);
        assert_eq!(points(7).point(5), points(7).point(5));
        assert_ne!(points(7).point(5), points(8).point(5));
    }

    #[test]
    fn even_points_know_a_product_better_than_random_ones() {
        // The mean of the product of four coordinates is 1/16, with a deviation of sqrt(1/81 - 1/256) = 0.092: 128
        // random points know it to 8e-3.
        let error = |seed: u64| {
            let points = EvenPoints::seeded(seed, 4);
            (0..128).map(|k| points.point(k).iter().product::<f64>()).sum::<f64>() / 128.0 - 1.0 / 16.0
        };
        let root = ((0..50).map(|seed| error(seed).powi(2)).sum::<f64>() / 50.0).sqrt();
        assert!(root < 8e-3 / 4.0, "{root}");
    }

    #[test]
    fn rows_of_a_seed_differ_and_come_back() {
        let row = |seed, index| {
            let mut random = RandomNumbers::of_stream(seed, index);
            std::array::from_fn::<usize, 8, _>(|_| random.below(1000))
        };
        assert_eq!(row(1, 2), row(1, 2));
        assert!(row(1, 2) != row(1, 3) && row(1, 2) != row(2, 2));
    }

    #[test]
    fn numbers_are_uniform_and_differ() {
        let numbers: Vec<f64> = (0..1000).map(|k| uniform_at(k % 10, k / 10)).collect();
        let mean = numbers.iter().sum::<f64>() / 1000.0;
        // Standard deviation of the mean 0.009.
        assert!((mean - 0.5).abs() < 0.04 && numbers.iter().all(|x| (0.0..1.0).contains(x)));
        assert!(uniform_at(0, 0) != uniform_at(1, 0) && uniform_at(0, 0) != uniform_at(0, 1));
    }
}
