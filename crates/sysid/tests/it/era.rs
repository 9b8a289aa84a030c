//! ERA on records at the edge of making sense.

use crumple_sysid::{EraError, EraOptions, era};

#[test]
fn a_record_that_is_silent_but_for_its_last_sample_is_called_silent() {
    for samples in [51, 401, 2501] {
        let mut markov = vec![0.0; samples];
        markov[samples - 1] = 1.0;
        let result = era(&markov, EraOptions::new(1e-4));
        assert!(matches!(result, Err(EraError::Silent { .. })), "{samples}: {:?}", result.err());
    }
}
