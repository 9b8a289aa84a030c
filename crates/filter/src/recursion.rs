//! The second-order difference equation that every recursive filter here runs.

// The second-order recursion that class filters and Butterworth sections run.

/// A second-order difference equation on its way through a record:
/// `y[i] = a0·x[i] + a1·x[i-1] + a2·x[i-2] + b1·y[i-1] + b2·y[i-2]`.
///
/// Direct form I: the state is the last two inputs and the last two outputs, so a pass can be interrupted between
/// blocks and continued with the same bits. Five products a sample; that `y[i]` needs `y[i-1]` sets the speed.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Recursion {
    /// a0, a1, a2, b1, b2.
    c: [f64; 5],
    x1: f64,
    x2: f64,
    y1: f64,
    y2: f64,
}

impl Recursion {
    /// Stands behind two samples, in the order they were met, for both of which the output was `start`.
    pub(crate) fn new(c: [f64; 5], [first, second]: [f64; 2], start: f64) -> Self {
        Self { c, x1: second, x2: first, y1: start, y2: start }
    }

    /// The next output.
    #[inline(always)]
    pub(crate) fn step(&mut self, x: f64) -> f64 {
        let [a0, a1, a2, b1, b2] = self.c;
        // Summed in the order of the standard's equation: another order gives other last digits.
        let y = a0 * x + a1 * self.x1 + a2 * self.x2 + b1 * self.y1 + b2 * self.y2;
        (self.x2, self.x1) = (self.x1, x);
        (self.y2, self.y1) = (self.y1, y);
        y
    }

    /// Replaces samples by outputs.
    #[inline]
    pub(crate) fn in_place<'a>(&mut self, samples: impl Iterator<Item = &'a mut f64>) {
        // A copy, so that the state lives in registers.
        let mut state = *self;
        for sample in samples {
            *sample = state.step(*sample);
        }
        *self = state;
    }

    /// Appends the outputs for samples less a zero level.
    #[inline]
    pub(crate) fn append(&mut self, samples: &[f64], zero_level: f64, output: &mut Vec<f64>) {
        let mut state = *self;
        output.extend(samples.iter().map(|x| state.step(x - zero_level)));
        *self = state;
    }
}
