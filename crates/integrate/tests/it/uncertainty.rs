//! Propagated uncertainty against closed forms to first order, and its independence of threads.

use std::f64::consts::PI;

use crumple_artifact::records::QualityV1;
use crumple_integrate::{EVENT_NAMES, Intervals, Perturbation, Uncertainty, ZeroShift, perturbed, propagate};
use crumple_metrics::{CrashEvents, Interval, Pulse, crash_events, pulse_metrics};
use crumple_numerics::estimation::random::RandomNumbers;
use crumple_numerics::estimation::statistics::quantile;
use crumple_signal::{
    Acceleration, Cfc, Class, Distribution, DriftShape, EndCondition, FilterSettings, IntegrationRule,
    IntegrationSettings, IntegrationStart, KnownEnd, STANDARD_GRAVITY_M_PER_S2, Signal, Spread, ZeroLevel, filter,
    integrate,
};

const V0: f64 = 14.0;
/// Replicates where nothing else is said.
const N: usize = 1500;
/// Half-sine of 25 g over 100 ms.
const PEAK: f64 = 25.0 * STANDARD_GRAVITY_M_PER_S2;
const DURATION_S: f64 = 0.1;
/// Time of rest before contact, s.
const BEFORE_S: f64 = 0.02;

fn pulse(at: impl Fn(f64) -> f64) -> Signal<Acceleration> {
    Signal::new(-BEFORE_S, 1e-4, (0..1501).map(|k| at(f64::from(k) * 1e-4 - BEFORE_S)).collect()).unwrap()
}

fn half_sine() -> Signal<Acceleration> {
    pulse(|t| if (0.0..=DURATION_S).contains(&t) { -PEAK * (PI * t / DURATION_S).sin() } else { 0.0 })
}

fn settings(start: IntegrationStart) -> IntegrationSettings {
    IntegrationSettings { rule: IntegrationRule::Trapezoid, start, impact_speed_m_per_s: V0, low_pass_filtered: true }
}

fn events(a: &Signal<Acceleration>, start: IntegrationStart, by: Perturbation) -> CrashEvents {
    let motion = perturbed(a, &settings(start), None, &by).unwrap();
    crash_events(&motion.velocity, &motion.displacement).unwrap()
}

/// Crush, its time and delta-v with an error less those without.
fn moved(a: &Signal<Acceleration>, start: IntegrationStart, by: Perturbation) -> [f64; 3] {
    let of = |by: Perturbation| {
        let events = events(a, start, by);
        let crush = events.crush.unwrap();
        let v0 = V0 + by.impact_speed_m_per_s;
        [crush.displacement_m, crush.time_s, events.delta_v_m_per_s(v0).unwrap()]
    };
    let (with, without) = (of(by), of(Perturbation::default()));
    std::array::from_fn(|k| with[k] - without[k])
}

fn close(found: f64, expected: f64, within: f64, what: &str) {
    assert!((found - expected).abs() <= within, "{what}: {found} {expected} {within}");
}

#[test]
fn an_error_of_speed_moves_the_crush_by_the_time_of_crush_times_it() {
    let a = half_sine();
    let crush = events(&a, IntegrationStart::RecordStart, Perturbation::default()).crush.unwrap();
    // Closed form: v = v0 - (A·D/π)(1 - cos(πt/D)), so cos(π·t_m/D) = 1 - π·v0/(A·D); the trapezoid errs by O(T²).
    let t_m = DURATION_S / PI * (1.0 - PI * V0 / (PEAK * DURATION_S)).acos();
    close(crush.time_s, t_m, 1e-6, "t_m");
    let at_crush = PEAK * (PI * t_m / DURATION_S).sin();
    let dv = 0.1 / 3.6;
    for start in [IntegrationStart::RecordStart, IntegrationStart::TimeZero] {
        let by = Perturbation { impact_speed_m_per_s: dv, ..Perturbation::default() };
        let [crush, time, delta_v] = moved(&a, start, by);
        // x = ∫v dt: from the start of the record x counts from time zero all the same. Second order: δv²/(2a) =
        // 2.6e-6.
        close(crush, t_m * dv, 4e-6, "crush");
        // Second order: δv²·a'/(2a³), a' of the order of A·π/D: 5e-6.
        close(time, dv / at_crush, 1e-5, "time");
        // Delta-v is the area of the pulse, whatever the speed.
        close(delta_v, 0.0, 1e-12, "delta-v");
    }
}

#[test]
fn an_error_of_the_zero_level_acts_from_where_the_integration_starts() {
    let a = half_sine();
    let t_m = events(&a, IntegrationStart::RecordStart, Perturbation::default()).crush.unwrap().time_s;
    let db = 0.05 * STANDARD_GRAVITY_M_PER_S2;
    let by = Perturbation { zero_level_m_per_s2: db, ..Perturbation::default() };
    // δx = -δb·t²/2 from time zero. Second order (δb·t_m)²/(2a) = 5e-6 m.
    let [crush, ..] = moved(&a, IntegrationStart::TimeZero, by);
    close(crush, -db * t_m * t_m / 2.0, 8e-6, "from time zero");
    // From the record's start δv = -δb·(t + 20 ms), and the displacement counts from time zero:
    // δx = -δb·(t²/2 + 20 ms·t). Second order (δb·(t_m + 20 ms))²/(2a) = 8e-6 m.
    let [crush, ..] = moved(&a, IntegrationStart::RecordStart, by);
    close(crush, -db * (t_m * t_m / 2.0 + BEFORE_S * t_m), 1.2e-5, "from the record's start");
}

#[test]
fn an_error_of_the_gain_moves_the_crush_by_its_share_of_what_the_pulse_took() {
    let by = Perturbation { gain: 0.01, ..Perturbation::default() };
    for start in [IntegrationStart::TimeZero, IntegrationStart::RecordStart] {
        let a = half_sine();
        let without = events(&a, start, Perturbation::default()).crush.unwrap();
        let [crush, _, delta_v] = moved(&a, start, by);
        let first_order = -0.01 * (V0 * without.time_s - without.displacement_m);
        // Second order: (δg·v0)²/(2a) with a = 146 m/s² at t_m: 7e-5 m.
        close(crush, first_order, 1e-4, "crush");
        // A percent more of the area 2·A·D/π.
        close(delta_v, 0.01 * 2.0 * PEAK * DURATION_S / PI, 1e-5, "delta-v");
    }
    // A constant pulse has closed forms beyond the first order: C = v0²/(2a), t_m = v0/a, over a grid that has time
    // zero.
    let constant = Signal::new(0.0, 1e-4, vec![-200.0; 1501]).unwrap();
    let [crush, time, _] = moved(&constant, IntegrationStart::TimeZero, by);
    // A velocity that is linear is summed without error: rounding only.
    close(crush, V0 * V0 / 400.0 * (1.0 / 1.01 - 1.0), 1e-9, "crush of a constant pulse");
    close(time, V0 / 200.0 * (1.0 / 1.01 - 1.0), 1e-9, "time of a constant pulse");
}

#[test]
fn an_error_of_time_zero_moves_what_its_place_in_the_record_moves() {
    let a = half_sine();
    let dt = 0.5e-3;
    let by = |later_s| Perturbation { later_s, ..Perturbation::default() };
    // Integrated from the record's start the velocity does not know time zero: only the label moves. The crush counts
    // from the label. Before contact, at rest, exactly; after it but for what the pulse took in 0.5 ms: A·π/D·δ³/6 =
    // 2e-7 m.
    let [crush, time, delta_v] = moved(&a, IntegrationStart::RecordStart, by(-dt));
    close(crush, V0 * dt, 1e-12, "early label");
    close(time, dt, 1e-12, "early label");
    close(delta_v, 0.0, 1e-12, "early label");
    let [crush, time, delta_v] = moved(&a, IntegrationStart::RecordStart, by(dt));
    close(crush, -V0 * dt, 2e-7, "late label");
    close(time, -dt, 1e-12, "late label");
    close(delta_v, 0.0, 1e-12, "late label");
    // Integrated from time zero, a late one cuts the record: v0·δ of crush, and the area A·π·δ²/(2D) = 9.6e-4 m/s of
    // the half-sine, which acts up to t_m: 8e-5 m. Counted on a grid of T: T²·A·π/(8D) per sample more.
    let [crush, _, delta_v] = moved(&a, IntegrationStart::TimeZero, by(dt));
    let area = PEAK * PI * dt * dt / (2.0 * DURATION_S);
    close(crush, -V0 * dt + area * 0.0792, 2e-6, "cut late");
    close(delta_v, -area, 1e-5 * area + 1e-7, "cut late");
    // An early one adds rest.
    let [crush, _, delta_v] = moved(&a, IntegrationStart::TimeZero, by(-dt));
    close(crush, V0 * dt, 1e-12, "cut early");
    close(delta_v, 0.0, 1e-12, "cut early");
    // A pulse that jumps at contact loses velocity to first order: a·δ.
    let constant = Signal::new(0.0, 1e-4, vec![-200.0; 1501]).unwrap();
    let [crush, time, _] = moved(&constant, IntegrationStart::TimeZero, by(dt));
    close(crush, 0.0, 1e-9, "a constant pulse looks the same later");
    close(time, 0.0, 1e-9, "a constant pulse looks the same later");
    // Contact before the record: the speed is held until the first sample.
    let [crush, time, _] = moved(&constant, IntegrationStart::TimeZero, by(-dt));
    close(crush, V0 * dt, 1e-9, "before the record");
    close(time, dt, 1e-9, "before the record");
}

#[test]
fn a_soft_front_moves_contact_to_the_earlier_side_alone() {
    let certain = Uncertainty {
        impact_speed_m_per_s: None,
        zero_level_m_per_s2: None,
        gain: None,
        contact_s: None,
        earlier_by_s: 4e-3,
        ..uncertainty(Distribution::Uniform)
    };
    let leads: Vec<f64> = (0..N).map(|k| -certain.perturbation(k).later_s).collect();
    assert!(leads.iter().all(|lead| (0.0..=4e-3).contains(lead)));
    // Half of the draws have none, the others are uniform: their mean is a quarter of the largest lead. Deviation of
    // the mean: sqrt(E[u²] - E[u]²) = sqrt(1/6 - 1/16) of it over sqrt(N); four of them.
    let (mean, none) = (leads.iter().sum::<f64>() / N as f64, leads.iter().filter(|lead| **lead == 0.0).count());
    close(mean, 1e-3, 4.0 * 4e-3 * 0.323 / (N as f64).sqrt(), "mean lead");
    close(none as f64 / N as f64, 0.5, 4.0 * 0.5 / (N as f64).sqrt(), "none");
}

fn uncertainty(distribution: Distribution) -> Uncertainty {
    let of = |size| Some(Spread { size, distribution });
    Uncertainty {
        impact_speed_m_per_s: of(0.1 / 3.6),
        zero_level_m_per_s2: of(0.05 * STANDARD_GRAVITY_M_PER_S2),
        gain: of(0.01),
        contact_s: of(0.5e-3),
        earlier_by_s: 0.0,
        lost_s: None,
        zero_shift: None,
        replicates: N,
        seed: 1,
    }
}

fn intervals(uncertainty: &Uncertainty, end: Option<EndCondition>) -> Intervals {
    let (a, settings) = (half_sine(), settings(IntegrationStart::RecordStart));
    let motion = integrate(&a, &settings).unwrap();
    propagate(&a, &motion, &settings, end, Some(1000.0), uncertainty, |_| ())
}

/// 5 % and 95 % of the crush and of the time of crush.
fn of_crush(uncertainty: &Uncertainty) -> [[f64; 2]; 2] {
    let found = intervals(uncertainty, None);
    [0, 1].map(|k| found.events[k].map(|interval| [interval.low, interval.high]).unwrap())
}

#[test]
fn one_uncertain_input_gives_its_own_quantiles() {
    let crush = events(&half_sine(), IntegrationStart::RecordStart, Perturbation::default()).crush.unwrap();
    for (distribution, quantile, density) in [
        // 95 % of a uniform distribution over ±1 lie below 0.9, where its density is 1/2; of a normal one below 1.6449,
        // where it is 0.1031.
        (Distribution::Uniform, 0.9, 0.5),
        (Distribution::Normal, 1.6449, 0.1031),
    ] {
        let all = uncertainty(distribution);
        let nothing = Uncertainty {
            impact_speed_m_per_s: None,
            zero_level_m_per_s2: None,
            gain: None,
            contact_s: None,
            ..all.clone()
        };
        // A quantile of N replicates has the standard deviation sqrt(0.05·0.95/N)/density; four of them are allowed,
        // and 2 % for the second order.
        let noise = 4.0 * (0.05 * 0.95 / N as f64).sqrt() / density;
        let t = crush.time_s;
        for (stated, effect) in [
            (Uncertainty { impact_speed_m_per_s: all.impact_speed_m_per_s, ..nothing.clone() }, t * 0.1 / 3.6),
            (
                Uncertainty { zero_level_m_per_s2: all.zero_level_m_per_s2, ..nothing.clone() },
                0.05 * STANDARD_GRAVITY_M_PER_S2 * (t * t / 2.0 + BEFORE_S * t),
            ),
            (Uncertainty { gain: all.gain, ..nothing.clone() }, 0.01 * (V0 * t - crush.displacement_m)),
            (Uncertainty { contact_s: all.contact_s, ..nothing.clone() }, V0 * 0.5e-3),
        ] {
            let [[low, high], _] = of_crush(&stated);
            let within = (noise + 0.02 * quantile) * effect;
            close(high - crush.displacement_m, quantile * effect, within, "high");
            close(crush.displacement_m - low, quantile * effect, within, "low");
        }
    }
}

/// Root mean square error of both ends of an interval of a value that is linear in the four stated inputs, over seeds,
/// in its deviations; and the share of the value that the intervals hold. `draw`: the value of a replicate of a seed.
fn errors_of_ends(exact: &[f64], count: usize, draw: impl Fn(u64, usize) -> f64) -> [f64; 2] {
    const SEEDS: u64 = 100;
    let ends = [0.05, 0.95].map(|share| quantile(exact, share).unwrap());
    let deviation = (exact.iter().map(|x| x * x).sum::<f64>() / exact.len() as f64).sqrt();
    let (mut square, mut held) = (0.0, 0.0);
    for seed in 0..SEEDS {
        let interval = Interval::of_replicates((0..count).map(|index| draw(seed, index)).collect()).unwrap();
        square += [interval.low - ends[0], interval.high - ends[1]]
            .map(|error| (error / deviation).powi(2) / 2.0)
            .iter()
            .sum::<f64>();
        let inside = exact.partition_point(|x| *x <= interval.high) - exact.partition_point(|x| *x < interval.low);
        held += inside as f64 / exact.len() as f64;
    }
    [(square / SEEDS as f64).sqrt(), held / SEEDS as f64]
}

#[test]
fn the_ends_of_128_even_replicates_are_as_sure_as_those_of_250_random_ones() {
    // Effects of speed, zero level, gain and contact on the crush, m: one that outweighs the others, and equal ones.
    for effects in [[2e-3, 1.3e-3, 4e-3, 8e-3], [1e-3; 4]] {
        for distribution in [Distribution::Uniform, Distribution::Normal] {
            let one = Some(Spread { size: 1.0, distribution });
            let stated = |seed| Uncertainty {
                impact_speed_m_per_s: one,
                zero_level_m_per_s2: one,
                gain: one,
                contact_s: one,
                seed,
                ..uncertainty(distribution)
            };
            let value = |inputs: [f64; 4]| inputs.iter().zip(effects).map(|(x, effect)| x * effect).sum::<f64>();
            let even = |seed, index| {
                let by = stated(seed).perturbation(index);
                value([by.impact_speed_m_per_s, by.zero_level_m_per_s2, by.gain, by.later_s])
            };
            let random = |seed: u64, index| {
                let mut random = RandomNumbers::of_stream(1000 + seed, index);
                value(std::array::from_fn(|_| match distribution {
                    Distribution::Uniform => 2.0 * random.uniform() - 1.0,
                    Distribution::Normal => random.normal(),
                }))
            };
            let mut exact: Vec<f64> = (0..1 << 16).map(|index| random(1 << 20, index)).collect();
            exact.sort_unstable_by(f64::total_cmp);
            let [of_even, held_by_even] = errors_of_ends(&exact, 128, even);
            let [of_random, held_by_random] = errors_of_ends(&exact, 400, random);
            let said = format!("{distribution:?} {effects:?}: {of_even} {of_random}, {held_by_even} {held_by_random}");
            // Errors of random draws fall with the root of their number: those of 250 are 1.27 times those of 400.
            assert!(of_even <= (400.0_f64 / 250.0).sqrt() * of_random, "{said}");
            // Evenly spread, 6.35 + 0.5 of 128 lie outside on either side, of 400 random ones 20.95 of 401: 0.0025 of
            // the value, and as much by chance.
            assert!((held_by_even - held_by_random).abs() < 0.01 && (held_by_even - 0.9).abs() < 0.015, "{said}");
        }
    }
}

#[test]
fn the_intervals_of_several_inputs_add_as_independent_errors() {
    let crush = events(&half_sine(), IntegrationStart::RecordStart, Perturbation::default()).crush.unwrap();
    let t = crush.time_s;
    let effects = [
        t * 0.1 / 3.6,
        0.05 * STANDARD_GRAVITY_M_PER_S2 * (t * t / 2.0 + BEFORE_S * t),
        0.01 * (V0 * t - crush.displacement_m),
        V0 * 0.5e-3,
    ];
    let sum = effects.iter().map(|e| e * e).sum::<f64>().sqrt();
    let [[low, high], [early, late]] = of_crush(&uncertainty(Distribution::Normal));
    // As above: noise of the replicates and the second order.
    let within = (4.0 * (0.05 * 0.95 / N as f64).sqrt() / 0.1031 + 0.02 * 1.6449) * sum;
    close(high - crush.displacement_m, 1.6449 * sum, within, "high");
    close(crush.displacement_m - low, 1.6449 * sum, within, "low");
    assert!(early < t && t < late);
}

#[test]
fn every_event_and_metric_has_an_interval_but_what_replicates_lack_and_a_check_of_the_arithmetic() {
    let found = intervals(&Uncertainty { replicates: 400, ..uncertainty(Distribution::Uniform) }, None);
    assert_eq!(found.events.len(), EVENT_NAMES.len());
    assert!(found.events.iter().all(Option::is_some), "{found:?}");
    let (a, settings) = (half_sine(), settings(IntegrationStart::RecordStart));
    let motion = integrate(&a, &settings).unwrap();
    let metrics = pulse_metrics(&Pulse {
        acceleration: &motion.acceleration,
        velocity: &motion.velocity,
        displacement: &motion.displacement,
        events: &crash_events(&motion.velocity, &motion.displacement).unwrap(),
        impact_speed_m_per_s: Some(V0),
        mass_kg: Some(1000.0),
    })
    .unwrap();
    assert_eq!(metrics.len(), found.metrics.len());
    let without = metrics.iter().zip(&found.metrics).filter(|(_, interval)| interval.is_none());
    let names: Vec<&str> = without.map(|(metric, _)| metric.name).collect();
    // A zero level that is too low lets the velocity fall on, but the contact ends where it did.
    assert_eq!(names, ["energy_closure"]);
    // Every error makes a magnitude of zero larger.
    for (metric, interval) in
        metrics.iter().zip(&found.metrics).filter(|(m, _)| m.name != "acceleration_after_separation")
    {
        let (Some(value), Some(interval)) = (metric.value, interval) else { continue };
        assert!(interval.low <= value && value <= interval.high, "{} {value} {interval:?}", metric.name);
    }
}

#[test]
fn a_known_velocity_takes_the_zero_level_out_of_the_intervals() {
    let end = |velocity| EndCondition { known: KnownEnd::Velocity(velocity), time_s: None, shape: DriftShape::Bias };
    let only = |zero_level_m_per_s2, gain| Uncertainty {
        impact_speed_m_per_s: None,
        contact_s: None,
        zero_level_m_per_s2,
        gain,
        replicates: 100,
        ..uncertainty(Distribution::Uniform)
    };
    let all = uncertainty(Distribution::Uniform);
    let rebound = -1.6;
    let of = |stated: &Uncertainty| intervals(stated, Some(end(rebound))).events[0].unwrap();
    // The correction finds the same bias whatever was added: rounding of 1500 sums is left.
    let certain = of(&only(all.zero_level_m_per_s2, None));
    assert!(certain.high - certain.low < 1e-10, "{certain:?}");
    let gain = of(&only(None, all.gain));
    assert!(gain.high - gain.low > 1e-5, "{gain:?}");
}

#[test]
fn the_number_of_threads_and_of_replicates_changes_no_replicate() {
    let stated = Uncertainty { replicates: 150, ..uncertainty(Distribution::Normal) };
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| intervals(&stated, None))
    };
    assert_eq!(with(1), with(3));
    let more = Uncertainty { replicates: N, ..stated.clone() };
    assert_eq!(stated.perturbation(7), more.perturbation(7));
    let alone = Uncertainty { gain: None, ..stated.clone() };
    assert_eq!(alone.perturbation(7), Perturbation { gain: 0.0, ..stated.perturbation(7) });
    assert_ne!(stated.perturbation(7), stated.perturbation(8));
    assert_ne!(stated.perturbation(7), Uncertainty { seed: 2, ..stated.clone() }.perturbation(7));
}

#[test]
fn a_value_that_some_replicates_do_not_have_has_no_interval() {
    // The record ends in the pulse, after 14.76 of 15.6 m/s: at 14.6 ± 0.3 m/s some replicates do not stop in it.
    let whole = half_sine();
    let a = Signal::from(whole.slice(0, whole.index_at_or_after(0.085)));
    let settings = IntegrationSettings { impact_speed_m_per_s: 14.6, ..settings(IntegrationStart::RecordStart) };
    let motion = integrate(&a, &settings).unwrap();
    let stated = Uncertainty {
        impact_speed_m_per_s: Some(Spread { size: 0.3, distribution: Distribution::Uniform }),
        replicates: 100,
        ..uncertainty(Distribution::Uniform)
    };
    let found = propagate(&a, &motion, &settings, None, None, &stated, |_| ());
    assert_eq!(found.events[0], None);
    // It is said how many: 14.6 ± 0.3 m/s against 14.76 m/s, a gain of ± 1 % and more.
    assert!((10..90).contains(&found.without_event[0]), "{:?}", found.without_event);
    assert_eq!(found.without_metric[0], 0);
    // The peak is there in every replicate.
    assert!(found.metrics[0].is_some());
}

/// What a record that lacks something says of the whole half sine: crush, delta-v, and whether both intervals hold
/// them.
fn holds_whole(lacking: &Signal<Acceleration>, stated: &Uncertainty) -> [bool; 2] {
    let whole = events(&half_sine(), IntegrationStart::RecordStart, Perturbation::default());
    let truth = [(0, whole.crush.unwrap().displacement_m), (5, whole.delta_v_m_per_s(V0).unwrap())];
    let settings = settings(IntegrationStart::RecordStart);
    let motion = integrate(lacking, &settings).unwrap();
    let found = propagate(lacking, &motion, &settings, None, None, stated, |_| ());
    truth.map(|(k, value)| found.events[k].is_some_and(|interval| interval.low <= value && value <= interval.high))
}

#[test]
fn samples_that_are_lost_widen_crush_and_delta_v_up_to_what_they_lack() {
    let stated = uncertainty(Distribution::Uniform);
    for (from_s, to_s) in [(0.020, 0.022), (0.030, 0.034), (0.045, 0.048), (0.055, 0.057)] {
        let whole = half_sine();
        let is_lost = |t: f64| (from_s..=to_s).contains(&t);
        let lacking: Vec<f64> =
            (0..whole.len()).map(|k| if is_lost(whole.time_s(k)) { 0.0 } else { whole.samples()[k] }).collect();
        let lacking = whole.with_samples(lacking).unwrap();
        let told = Uncertainty { lost_s: Some([from_s, to_s]), ..stated.clone() };
        assert_eq!(holds_whole(&lacking, &told), [true; 2], "{from_s}");
        for class in [Cfc::Cfc60, Cfc::Cfc180] {
            let settings =
                FilterSettings { class: Class::Cfc(class), zero_level: ZeroLevel::None, ..FilterSettings::default() };
            let filtered = filter(&lacking.clone().into_sampled(), None, &settings).unwrap().samples;
            assert_eq!(holds_whole(&filtered.into(), &told), [true; 2], "{from_s} {class:?}");
        }
    }
}

#[test]
fn a_shift_of_the_zero_level_widens_delta_v_up_to_the_whole_of_it() {
    let stated = uncertainty(Distribution::Uniform);
    for level in [0.3, -0.9] {
        for from_s in [0.0, 0.03, 0.05] {
            let shift = level * STANDARD_GRAVITY_M_PER_S2;
            let whole = half_sine();
            let moved = |k: usize| whole.samples()[k] + if whole.time_s(k) > from_s { shift } else { 0.0 };
            let lacking = whole.with_samples((0..whole.len()).map(moved).collect()).unwrap();
            let zero_shift = Some(ZeroShift { level_m_per_s2: shift, until_s: 0.05 });
            let told = Uncertainty { zero_shift, ..stated.clone() };
            assert_eq!(holds_whole(&lacking, &told), [true; 2], "{level} g from {from_s}");
        }
    }
}

#[test]
fn the_level_at_the_end_counts_as_a_shift_only_where_the_impact_is_over_and_it_is_no_stated_error() {
    let stated = uncertainty(Distribution::Uniform);
    let events = events(&half_sine(), IntegrationStart::RecordStart, Perturbation::default());
    let separated_s = events.rebound.unwrap().time_s;
    let largest = stated.zero_level_m_per_s2.unwrap().size;
    let seen = |end_level, end_s| {
        let quality = QualityV1 { end_level: Some(end_level), ..QualityV1::default() };
        let shift = stated.clone().with_quality(&quality, &events, end_s).zero_shift;
        shift.map(|shift| shift.level_m_per_s2)
    };
    assert_eq!(seen(3.0 * largest, separated_s + 0.05), Some(3.0 * largest));
    assert_eq!(seen(3.0 * largest, separated_s + 0.03), None);
    assert_eq!(seen(0.9 * largest, separated_s + 0.05), None);
    // A force.
    assert_eq!(seen(1.1 * STANDARD_GRAVITY_M_PER_S2, separated_s + 0.05), None);
    // The record ends in the impact.
    let whole = half_sine();
    let cut = Signal::from(whole.slice(0, whole.index_at_or_after(0.09)));
    let events = self::events(&cut, IntegrationStart::RecordStart, Perturbation::default());
    let quality = QualityV1 { end_level: Some(3.0 * largest), ..QualityV1::default() };
    assert_eq!(stated.with_quality(&quality, &events, separated_s + 0.05).zero_shift, None);
}
