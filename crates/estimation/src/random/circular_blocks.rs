//! Places of a block bootstrap.

use super::random_numbers::RandomNumbers;

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
}
