//! The simple pulses that a measured one is replaced by, each with what it misses, and the one that fits best.

use std::f64::consts::PI;

use crumple_signal::{Acceleration, STANDARD_GRAVITY_M_PER_S2, Signal};

use crate::metric::definitions::{
    PULSE_AS_HALF_SINE, PULSE_AS_HAVERSINE, PULSE_AS_TESW, PULSE_AS_TRAPEZOID, PULSE_AS_TRIANGLE,
};
use crate::{Definition, Metric};

/// A pulse of few numbers over its duration `T`; accelerations in m/s², with their sign, times in s from its start.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(missing_docs, reason = "fields are named after what they are")]
pub enum Wave {
    /// `peak sin(π t/T)`.
    HalfSine { peak_m_per_s2: f64 },
    /// `peak (1 - cos(2 π t/T))/2`.
    Haversine { peak_m_per_s2: f64 },
    /// From zero to the peak at `peak_s`, and back to zero at `T`.
    Triangle { peak_m_per_s2: f64, peak_s: f64 },
    /// Tipped equivalent square wave: a straight line from the first to the last acceleration.
    Tesw { first_m_per_s2: f64, last_m_per_s2: f64 },
    /// From zero to the peak at `rise_s`, level up to `fall_s`, and back to zero at `T`.
    Trapezoid { peak_m_per_s2: f64, rise_s: f64, fall_s: f64 },
}

impl Wave {
    /// Acceleration at `t_s` after the start, for a duration, s.
    pub fn at(self, t_s: f64, duration_s: f64) -> f64 {
        match self {
            Self::HalfSine { peak_m_per_s2 } => peak_m_per_s2 * (PI * t_s / duration_s).sin(),
            Self::Haversine { peak_m_per_s2 } => peak_m_per_s2 * (PI * t_s / duration_s).sin().powi(2),
            Self::Triangle { peak_m_per_s2, peak_s } => {
                peak_m_per_s2 * trapezoid(t_s / duration_s, [peak_s / duration_s; 2])
            }
            Self::Tesw { first_m_per_s2, last_m_per_s2 } => {
                first_m_per_s2 + (last_m_per_s2 - first_m_per_s2) * t_s / duration_s
            }
            Self::Trapezoid { peak_m_per_s2, rise_s, fall_s } => {
                peak_m_per_s2 * trapezoid(t_s / duration_s, [rise_s / duration_s, fall_s / duration_s])
            }
        }
    }

    /// Numbers that a fit has to choose, beside duration and change of velocity.
    fn free_numbers(self) -> usize {
        match self {
            Self::HalfSine { .. } | Self::Haversine { .. } => 0,
            Self::Triangle { .. } | Self::Tesw { .. } => 1,
            Self::Trapezoid { .. } => 2,
        }
    }

    fn definition(self) -> &'static Definition {
        match self {
            Self::HalfSine { .. } => &PULSE_AS_HALF_SINE,
            Self::Haversine { .. } => &PULSE_AS_HAVERSINE,
            Self::Triangle { .. } => &PULSE_AS_TRIANGLE,
            Self::Tesw { .. } => &PULSE_AS_TESW,
            Self::Trapezoid { .. } => &PULSE_AS_TRAPEZOID,
        }
    }
}

/// A simple pulse beside the measured one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SimplePulse {
    /// The pulse.
    pub wave: Wave,
    /// Its start, s, on the axis of the signal.
    pub from_s: f64,
    /// Its end, s.
    pub to_s: f64,
    /// Root of the mean square of the measured pulse less this one over the duration, m/s².
    pub rms_m_per_s2: f64,
    /// The same over the largest |a| there.
    pub share_of_peak: f64,
}

impl SimplePulse {
    /// `half sine of 25.0 g and 100.0 ms`, magnitudes.
    pub fn words(&self) -> String {
        let g = |a: f64| format!("{:.1} g", a.abs() / STANDARD_GRAVITY_M_PER_S2);
        let ms = |s: f64| format!("{:.1} ms", 1e3 * s);
        let lasting = ms(self.to_s - self.from_s);
        match self.wave {
            Wave::HalfSine { peak_m_per_s2 } => format!("half sine of {} and {lasting}", g(peak_m_per_s2)),
            Wave::Haversine { peak_m_per_s2 } => format!("haversine of {} and {lasting}", g(peak_m_per_s2)),
            Wave::Triangle { peak_m_per_s2, peak_s } => {
                format!("triangle of {} at {} and {lasting}", g(peak_m_per_s2), ms(peak_s))
            }
            Wave::Tesw { first_m_per_s2, last_m_per_s2 } => {
                // Positive is the way in which the pulse acts.
                let sign = (first_m_per_s2 + last_m_per_s2).signum();
                let [first, last] = [first_m_per_s2, last_m_per_s2].map(|a| sign * a / STANDARD_GRAVITY_M_PER_S2);
                format!("tipped equivalent square wave from {first:.1} g to {last:.1} g within {lasting}")
            }
            Wave::Trapezoid { peak_m_per_s2, rise_s, fall_s } => {
                format!("trapezoid of {} from {} to {} and {lasting}", g(peak_m_per_s2), ms(rise_s), ms(fall_s))
            }
        }
    }

    /// What it misses as a share of the peak, with its numbers as a remark.
    pub fn metric(&self) -> Metric {
        Metric::with_value(self.wave.definition(), self.share_of_peak)
            .over(self.from_s, self.to_s)
            .remarked(&self.words())
    }
}

/// Fewer samples have no shape.
const FEWEST_SAMPLES: usize = 10;

/// The five simple pulses that keep duration and change of velocity of the acceleration between two times, in the
/// order of [`Wave`]; none where there are fewer than ten samples, or no change of velocity.
///
/// The free numbers are those with the least squares, `∫(a - w)² dt` by trapezoid on the samples: none of a half sine
/// and a haversine, whose peak the change of velocity gives; the time of the peak of a triangle; both corners of a
/// trapezoid, of which a triangle and a square wave are limits; the slope of a tipped equivalent square wave. For a
/// straight line least squares with that change of velocity also keep the first moment `∫t·a dt`, and so the
/// displacement over the duration: it is Huang's wave of equal velocity change, crush and time. Corners are found to
/// 1e-8 of the duration in up to 2000 samples: a wave gives itself back. A pulse with two humps, or with a tail that
/// belongs to no contact, is none of them; what they miss says so.
///
/// Huang, *Vehicle Crash Mechanics* (2002), chapter 2; Varat and Husher, ESV 18-501 (2003).
pub fn simple_pulses(acceleration: &Signal<Acceleration>, from_s: f64, to_s: f64) -> Vec<SimplePulse> {
    let Some(stretch) = Stretch::new(acceleration, from_s, to_s) else { return Vec::new() };
    let lasting = stretch.lasting_s;
    let peak = |shape: &dyn Fn(f64) -> f64| stretch.change_m_per_s / stretch.integral(shape);
    let sine = |x: f64| (PI * x).sin();
    let haversine = |x: f64| (PI * x).sin().powi(2);
    let searched = stretch.thinned();
    let corner = searched.best_corners(&[[-1.0; 2], [1.0; 2]], |x, y| x == y);
    let corners = searched.best_corners(&WAYS, |x, y| y >= x);
    let [first_m_per_s2, last_m_per_s2] = stretch.line();
    let waves = [
        Wave::HalfSine { peak_m_per_s2: peak(&sine) },
        Wave::Haversine { peak_m_per_s2: peak(&haversine) },
        Wave::Triangle { peak_m_per_s2: peak(&|x| trapezoid(x, corner)), peak_s: corner[0] * lasting },
        Wave::Tesw { first_m_per_s2, last_m_per_s2 },
        Wave::Trapezoid {
            peak_m_per_s2: peak(&|x| trapezoid(x, corners)),
            rise_s: corners[0] * lasting,
            fall_s: corners[1] * lasting,
        },
    ];
    let largest = stretch.accelerations.iter().fold(0.0_f64, |most, a| most.max(a.abs()));
    let missed = |wave: Wave| {
        let rms_m_per_s2 = (stretch.misfit(&|x| wave.at(x * lasting, lasting)) / lasting).sqrt();
        SimplePulse { wave, from_s, to_s, rms_m_per_s2, share_of_peak: rms_m_per_s2 / largest }
    };
    waves.into_iter().map(missed).filter(|pulse| pulse.share_of_peak.is_finite()).collect()
}

/// What a wave with fewer free numbers may miss more than the closest one and still be called the best: 5 %. A
/// trapezoid is never worse than a triangle, by as little as noise has it.
const AS_GOOD: f64 = 1.05;
/// Misfits below this share of the peak are rounding.
const ROUNDING: f64 = 1e-6;

/// The simple pulse that fits best: of those that miss at most 5 % more than the closest the one with the fewest free
/// numbers, of several the closest.
pub fn best_simple_pulse(pulses: &[SimplePulse]) -> Option<&SimplePulse> {
    let least = pulses.iter().map(|pulse| pulse.share_of_peak).fold(f64::INFINITY, f64::min);
    let is_as_good = |pulse: &&SimplePulse| pulse.share_of_peak <= AS_GOOD * least + ROUNDING;
    pulses.iter().filter(is_as_good).min_by(|a, b| {
        let free = |pulse: &SimplePulse| pulse.wave.free_numbers();
        free(a).cmp(&free(b)).then(a.share_of_peak.total_cmp(&b.share_of_peak))
    })
}

/// 0 at 0, 1 from the first corner to the second, 0 at 1; straight lines between. Corners on an end are jumps.
fn trapezoid(x: f64, [rise, fall]: [f64; 2]) -> f64 {
    if x < rise {
        x / rise
    } else if x > fall {
        (1.0 - x) / (1.0 - fall)
    } else {
        1.0
    }
}

/// An acceleration between two times, with the weights of the trapezoidal rule; instants as shares of the duration.
struct Stretch {
    lasting_s: f64,
    instants: Vec<f64>,
    accelerations: Vec<f64>,
    weights_s: Vec<f64>,
    change_m_per_s: f64,
}

/// Places of each corner that are tried before the best is refined.
const PLACES: usize = 24;
/// Ways of a compass search of two corners.
const WAYS: [[f64; 2]; 8] =
    [[-1.0, -1.0], [-1.0, 0.0], [-1.0, 1.0], [0.0, -1.0], [0.0, 1.0], [1.0, -1.0], [1.0, 0.0], [1.0, 1.0]];
/// Samples that corners are looked for in, at most: 20 in each step of the grid.
const MOST_SEARCHED: usize = 2000;
/// Smallest step of a corner, as a share of the duration: below it the sum of squares changes by rounding.
const SMALLEST_STEP: f64 = 1e-9;

impl Stretch {
    /// The samples between, and the ends interpolated linearly; `None` outside the record or with too few samples.
    fn new(acceleration: &Signal<Acceleration>, from_s: f64, to_s: f64) -> Option<Self> {
        let lasting_s = to_s - from_s;
        let ends = [acceleration.at(from_s)?, acceleration.at(to_s)?];
        // What is an end but for rounding is one.
        let slack = 1e-6 * acceleration.dt_s();
        let within = |t: &f64| *t > from_s + slack && *t < to_s - slack;
        let inner = acceleration.samples().iter().enumerate().map(|(k, a)| (acceleration.time_s(k), *a));
        let (times, values): (Vec<f64>, Vec<f64>) = std::iter::once((from_s, ends[0]))
            .chain(inner.filter(|(t, _)| within(t)))
            .chain(std::iter::once((to_s, ends[1])))
            .unzip();
        if times.len() < FEWEST_SAMPLES {
            return None;
        }
        let mut weights_s = vec![0.0; times.len()];
        for k in 1..times.len() {
            let half = (times[k] - times[k - 1]) / 2.0;
            weights_s[k - 1] += half;
            weights_s[k] += half;
        }
        let change_m_per_s: f64 = weights_s.iter().zip(&values).map(|(w, a)| w * a).sum();
        let instants = times.iter().map(|t| (t - from_s) / lasting_s).collect();
        (change_m_per_s != 0.0).then_some(Self {
            lasting_s,
            instants,
            accelerations: values,
            weights_s,
            change_m_per_s,
        })
    }

    /// `∫shape dt`, s.
    fn integral(&self, shape: &dyn Fn(f64) -> f64) -> f64 {
        self.weights_s.iter().zip(&self.instants).map(|(w, x)| w * shape(*x)).sum()
    }

    /// `∫(a - wave)² dt`, m²/s³.
    fn misfit(&self, wave: &dyn Fn(f64) -> f64) -> f64 {
        let samples = self.instants.iter().zip(&self.accelerations);
        self.weights_s.iter().zip(samples).map(|(w, (x, a))| w * (a - wave(*x)).powi(2)).sum()
    }

    /// First and last acceleration of the line with the least squares. It keeps the change of velocity.
    fn line(&self) -> [f64; 2] {
        let mean = self.change_m_per_s / self.lasting_s;
        let middle = self.integral(&|x| x) / self.lasting_s;
        let spread = self.integral(&|x| (x - middle).powi(2));
        let samples = self.instants.iter().zip(&self.accelerations);
        let moment: f64 = self.weights_s.iter().zip(samples).map(|(w, (x, a))| w * (x - middle) * a).sum();
        let slope = moment / spread;
        [mean - slope * middle, mean + slope * (1.0 - middle)]
    }

    /// The same with at most [`MOST_SEARCHED`] samples, so that a search does not take longer the faster a sensor is.
    fn thinned(&self) -> Self {
        let together = self.instants.len().div_ceil(MOST_SEARCHED);
        let mean = |values: &[f64]| -> Vec<f64> {
            let chunks = values.chunks(together).zip(self.weights_s.chunks(together));
            chunks.map(|(x, w)| x.iter().zip(w).map(|(x, w)| x * w).sum::<f64>() / w.iter().sum::<f64>()).collect()
        };
        Self {
            instants: mean(&self.instants),
            accelerations: mean(&self.accelerations),
            weights_s: self.weights_s.chunks(together).map(|w| w.iter().sum()).collect(),
            ..*self
        }
    }

    /// The corners with the least squares: tried on a grid where they are allowed, then refined by a compass search
    /// along these ways.
    fn best_corners(&self, ways: &[[f64; 2]], is_tried: impl Fn(f64, f64) -> bool) -> [f64; 2] {
        let cost = |[x, y]: [f64; 2]| {
            let corners = [x.min(y), x.max(y)];
            let peak = self.change_m_per_s / self.integral(&|x| trapezoid(x, corners));
            self.misfit(&|x| peak * trapezoid(x, corners))
        };
        let step = 1.0 / PLACES as f64;
        let places = || (0..=PLACES).map(|k| k as f64 * step);
        let grid = places().flat_map(|x| places().map(move |y| [x, y])).filter(|[x, y]| is_tried(*x, *y));
        let tried = grid.map(|place| (cost(place), place));
        let (mut least, mut best) = tried.min_by(|(a, _), (b, _)| a.total_cmp(b)).unwrap_or((f64::INFINITY, [0.5; 2]));
        let mut step = step / 2.0;
        while step > SMALLEST_STEP {
            let moved = |[x, y]: [f64; 2]| [(best[0] + x * step).clamp(0.0, 1.0), (best[1] + y * step).clamp(0.0, 1.0)];
            let around = ways.iter().map(|way| moved(*way)).map(|place| (cost(place), place));
            match around.min_by(|(a, _), (b, _)| a.total_cmp(b)).filter(|(lower, _)| *lower < least) {
                Some(lower) => (least, best) = lower,
                None => step /= 2.0,
            }
        }
        [best[0].min(best[1]), best[0].max(best[1])]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crumple_numerics::estimation::random::RandomNumbers;

    const LASTING_S: f64 = 0.09;

    const WAVES: [Wave; 5] = [
        Wave::HalfSine { peak_m_per_s2: -250.0 },
        Wave::Haversine { peak_m_per_s2: -250.0 },
        Wave::Triangle { peak_m_per_s2: -250.0, peak_s: 0.031 },
        Wave::Tesw { first_m_per_s2: -80.0, last_m_per_s2: -230.0 },
        Wave::Trapezoid { peak_m_per_s2: -250.0, rise_s: 0.0123, fall_s: 0.0677 },
    ];

    fn record(wave: Wave, noise_m_per_s2: f64) -> Signal<Acceleration> {
        let mut random = RandomNumbers::seeded(7);
        let at = |k: i32| {
            let t = f64::from(k) * 1e-4;
            let a = if (0.0..=LASTING_S + 1e-9).contains(&t) { wave.at(t, LASTING_S) } else { 0.0 };
            a + noise_m_per_s2 * random.normal()
        };
        Signal::new(-0.05, 1e-4, (-500..2000).map(at).collect()).unwrap()
    }

    #[test]
    fn every_wave_gives_itself_back_and_is_the_best() {
        for wave in WAVES {
            let pulses = simple_pulses(&record(wave, 0.0), 0.0, LASTING_S);
            let best = best_simple_pulse(&pulses).unwrap();
            assert!(best.share_of_peak < 1e-6, "{best:?}");
            for t in [0.005, 0.02, 0.04, 0.07, 0.085] {
                let (found, true_value) = (best.wave.at(t, LASTING_S), wave.at(t, LASTING_S));
                // A corner is right to 1e-8 of the duration.
                assert!((found / true_value - 1.0).abs() < 1e-6, "{:?} for {wave:?} at {t}", best.wave);
            }
            assert_eq!(std::mem::discriminant(&best.wave), std::mem::discriminant(&wave), "{best:?}");
        }
    }

    #[test]
    fn every_wave_keeps_the_change_of_velocity_and_a_line_the_displacement() {
        let record = record(WAVES[4], 0.0);
        let stretch = Stretch::new(&record, 0.0, LASTING_S).unwrap();
        for pulse in simple_pulses(&record, 0.0, LASTING_S) {
            let at = |x: f64| pulse.wave.at(x * LASTING_S, LASTING_S);
            assert!((stretch.integral(&at) / stretch.change_m_per_s - 1.0).abs() < 1e-12, "{pulse:?}");
            if let Wave::Tesw { .. } = pulse.wave {
                // ∫(T - t) a dt is the displacement over the duration.
                let way = |a: &dyn Fn(f64) -> f64| stretch.integral(&|x| (1.0 - x) * a(x));
                let measured = way(&|x| WAVES[4].at(x * LASTING_S, LASTING_S));
                assert!((way(&at) / measured - 1.0).abs() < 1e-12, "{pulse:?}");
            }
        }
    }

    #[test]
    fn noise_is_what_is_missed_and_names_no_other_wave() {
        for wave in WAVES {
            let noise = 10.0;
            let pulses = simple_pulses(&record(wave, noise), 0.0, LASTING_S);
            let best = best_simple_pulse(&pulses).unwrap();
            assert_eq!(std::mem::discriminant(&best.wave), std::mem::discriminant(&wave), "{pulses:?}");
            // 900 samples: the deviation is known to 2.4 %.
            assert!((best.rms_m_per_s2 / noise - 1.0).abs() < 0.1, "{best:?}");
        }
    }

    #[test]
    fn what_is_no_pulse_has_none() {
        assert_eq!(simple_pulses(&record(WAVES[0], 0.0), 0.0, 5e-4), []);
        assert_eq!(simple_pulses(&record(WAVES[0], 0.0), 0.0, 9.0), []);
        assert_eq!(simple_pulses(&record(Wave::HalfSine { peak_m_per_s2: 0.0 }, 0.0), 0.0, 0.05), []);
        assert_eq!(best_simple_pulse(&[]), None);
    }
}
