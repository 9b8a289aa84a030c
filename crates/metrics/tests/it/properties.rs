//! What holds for every signal.

use crumple_metrics::definitions::{CATALOGUE, Definition, Mark};
use crumple_metrics::{
    CoraOptions, Iso18571Options, OlcOptions, VpiOptions, clip_contiguous, clip_cumulative, cora, crash_events, hic,
    hic_all_pairs, hic_d, iso18571, olc, residuals, ride_down, sliding_mean, thiv_phd, vpi,
};
use crumple_signal::{Acceleration, Sampled, Signal};
use proptest::prelude::*;

/// A few half-sines, ramps and noise: what resultants look like, and worse.
fn pulse(length: std::ops::Range<usize>) -> impl Strategy<Value = Vec<f64>> {
    let bump = (0.0..1.0_f64, 0.02..0.6_f64, -300.0..900.0_f64);
    (length, prop::collection::vec(bump, 1..4), prop::collection::vec(-1.0..1.0_f64, 64), 0.0..200.0_f64).prop_map(
        |(n, bumps, noise, level)| {
            let at = |k: usize| {
                let u = k as f64 / n as f64;
                let of = |(start, width, height): &(f64, f64, f64)| {
                    let p = (u - start) / width;
                    if (0.0..=1.0).contains(&p) { height * (std::f64::consts::PI * p).sin() } else { 0.0 }
                };
                bumps.iter().map(of).sum::<f64>() + level * noise[k % 64]
            };
            (0..n).map(at).collect()
        },
    )
}

fn signal(t0_s: f64, samples: &[f64]) -> Signal<Acceleration> {
    Signal::new(t0_s, 1e-4, samples.to_vec()).unwrap()
}

fn close(found: f64, expected: f64, relative: f64) -> bool {
    (found - expected).abs() <= relative * expected.abs()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn hic_by_pruning_is_hic_by_all_pairs(
        a in pulse(2..3000), window_s in prop::sample::select(vec![0.0003, 0.015, 0.036])
    ) {
        let (fast, all) = (hic(&signal(0.0, &a), window_s), hic_all_pairs(&signal(0.0, &a), window_s));
        // Other roundings of the same sums.
        prop_assert!(close(fast.value.unwrap(), all.value.unwrap(), 1e-12), "{fast:?} {all:?}");
    }

    #[test]
    fn hic_does_not_depend_on_time_and_grows_with_the_power_of_the_pulse(
        a in pulse(400..2000), shift in 1_usize..400, factor in 0.1..5.0_f64,
    ) {
        // Of a resultant, as defined: of a large negative pulse and a small positive one in one row of sums, the
        // difference keeps the rounding of the large.
        let a: Vec<f64> = a.iter().map(|a| a.abs()).collect();
        let base = hic(&signal(0.0, &a), 0.015);
        let value = base.value.unwrap();
        let mut later = vec![0.0; shift];
        later.extend(&a);
        // Samples in front, none above: not more than what they join (the jump to the first sample).
        let moved = hic(&signal(5.0, &a), 0.015);
        prop_assert!(close(moved.value.unwrap(), value, 1e-12));
        if let Some(window) = base.window {
            // Times around 5 s are rounded to 1e-15.
            prop_assert!((moved.window.unwrap().from_s - 5.0 - window.from_s).abs() < 1e-9);
        }
        prop_assert!(hic(&signal(0.0, &later), 0.015).value.unwrap() >= value * (1.0 - 1e-12));
        let scaled: Vec<f64> = a.iter().map(|a| factor * a).collect();
        prop_assert!(close(hic(&signal(0.0, &scaled), 0.015).value.unwrap(), value * factor.powf(2.5), 1e-12));
    }

    #[test]
    fn a_longer_window_never_lowers_hic_of_a_resultant(a in pulse(50..2000)) {
        let a: Vec<f64> = a.iter().map(|a| a.abs()).collect();
        let s = signal(0.0, &a);
        let (short, long) = (hic(&s, 0.015).value.unwrap(), hic(&s, 0.036).value.unwrap());
        prop_assert!(long >= short * (1.0 - 1e-12));
        prop_assert!(close(hic_d(&s).value.unwrap(), 0.75446 * long + 166.4, 1e-12));
    }

    #[test]
    fn the_cumulative_clip_is_never_below_the_contiguous_one(a in pulse(31..1500)) {
        let s = signal(0.0, &a);
        let (one, all) = (clip_contiguous(&s, 0.003), clip_cumulative(&s, 0.003));
        let largest = a.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        // Bisection to neighbouring numbers.
        let slack = 1e-12 * largest.abs().max(1.0);
        prop_assert!(one.value.unwrap() <= all.value.unwrap() + slack && all.value.unwrap() <= largest + slack);
        let window = one.window.unwrap();
        prop_assert!(window.to_s - window.from_s >= 0.003 * (1.0 - 1e-9));
    }

    #[test]
    fn equal_curves_rate_one(a in pulse(9..700)) {
        prop_assume!(a.iter().any(|x| *x != a[0]));
        let s = signal(0.0, &a);
        let rating = iso18571(&s, &s, &Iso18571Options::default()).unwrap();
        // Weights sum to 1 but for rounding.
        prop_assert!(rating.overall.is_some_and(|r| (r - 1.0).abs() < 1e-12), "{rating:?}");
        prop_assert_eq!(rating.shift_samples, 0);
        let rating = cora(&s, &s, &CoraOptions::default()).unwrap();
        prop_assert!((rating.total - 1.0).abs() < 1e-9, "{rating:?}");
        let r = residuals(&s, &s).unwrap();
        prop_assert_eq!((r.fit_percent, r.vaf_percent, r.rmse), (Some(100.0), Some(100.0), 0.0));
    }

    #[test]
    fn ratings_of_any_two_curves_are_between_zero_and_one(a in pulse(9..400), b in pulse(400..401)) {
        prop_assume!(a.iter().any(|x| *x != a[0]));
        let (t, c) = (signal(0.0, &a), signal(0.0, &b[..a.len()]));
        let iso = iso18571(&t, &c, &Iso18571Options::default()).unwrap();
        for part in [Some(iso.corridor), Some(iso.phase), iso.magnitude, iso.slope, iso.overall].into_iter().flatten() {
            prop_assert!((0.0..=1.0 + 1e-12).contains(&part), "{iso:?}");
        }
        let cora = cora(&t, &c, &CoraOptions::default()).unwrap();
        prop_assert!((0.0..=1.0 + 1e-12).contains(&cora.total), "{cora:?}");
        let r = residuals(&t, &c).unwrap();
        prop_assert!(r.theil_u1.is_none_or(|u| (0.0..=1.0 + 1e-12).contains(&u)));
        prop_assert!(r.metrics("m/s^2").iter().all(|m| m.value.is_none_or(f64::is_finite)));
    }

    #[test]
    fn a_shifted_curve_is_found_at_its_shift(late in 0_usize..60, height in 0.2..3.0_f64) {
        let at = |k: usize, from: usize| {
            let u = (k as f64 - from as f64) / 90.0;
            if (0.0..=1.0).contains(&u) { (std::f64::consts::PI * u).sin() + 0.3 * (7.0 * u).sin() } else { 0.0 }
        };
        let t: Vec<f64> = (0..400).map(|k| at(k, 80)).collect();
        let c: Vec<f64> = (0..400).map(|k| height * at(k, 80 + late)).collect();
        let rating = iso18571(&signal(0.0, &t), &signal(0.0, &c), &Iso18571Options::default()).unwrap();
        prop_assert_eq!(rating.shift_samples, isize::try_from(late).unwrap());
        prop_assert!((rating.phase - (80.0 - late as f64) / 80.0).abs() < 1e-12);
    }

    #[test]
    fn a_constant_deceleration_follows_its_formulas(a in 30.0..600.0_f64, v0 in 10.0..30.0_f64) {
        let dt = 1e-4;
        // The slowest stops after 1 s.
        let n = 10_100;
        let t = |k: usize| k as f64 * dt;
        let acceleration = Signal::new(0.0, dt, vec![-a; n]).unwrap();
        let velocity = Signal::new(0.0, dt, (0..n).map(|k| v0 - a * t(k)).collect()).unwrap();
        let displacement = Signal::new(0.0, dt, (0..n).map(|k| v0 * t(k) - a * t(k) * t(k) / 2.0).collect()).unwrap();
        // Interpolation between samples: O((T/t1)²) with t1 above 14 ms.
        let (t1, found) = ((0.13 / a).sqrt(), olc(&velocity, &displacement, v0, OlcOptions::default()).unwrap());
        let t2 = 0.6 / (a * t1);
        prop_assert!(close(found.value.unwrap(), a * t2 / (t2 - t1), 1e-4));
        // Exact pieces: rounding only.
        let exact = a + (a * a + 2.0 * a * 0.03 * 2500.0).sqrt();
        prop_assert!(close(vpi(&acceleration, VpiOptions::default()).value.unwrap(), exact, 1e-10));
        let zeros = Sampled::new(0.0, dt, vec![0.0; n]).unwrap();
        let (thiv, _) = thiv_phd(&acceleration, &zeros.clone().into(), &zeros, Default::default()).unwrap();
        // The moment by linear interpolation of a parabola.
        prop_assert!(close(thiv.value.unwrap(), (1.2 * a).sqrt(), 1e-5));
        prop_assert!(close(sliding_mean(&acceleration, 0.025, 0.0).value.unwrap(), a, 1e-9));
        let events = crash_events(&velocity, &displacement).unwrap();
        prop_assert!(close(events.crush.unwrap().time_s, v0 / a, 1e-9));
    }

    #[test]
    fn ride_down_shares_sum_to_one(a in pulse(300..301), b in pulse(300..301), v0 in 5.0..20.0_f64) {
        // At rest in the seat at both ends.
        let mut b = b;
        (b[0], b[299]) = (0.0, 0.0);
        let found = ride_down(&signal(0.0, &a), &signal(0.0, &b), v0).unwrap();
        // Rounding of 300 sums of shares of the size of the largest.
        let size = 1.0 + found.efficiency.value.unwrap().abs() + found.restraint.value.unwrap().abs() + found.left;
        prop_assert!(found.residual().unwrap().abs() < 1e-12 * size);
    }

    #[test]
    fn nothing_panics_and_nothing_is_nan(
        a in prop::collection::vec(prop::num::f64::NORMAL | prop::num::f64::ZERO, 0..40), dt in 1e-7..1e3_f64,
    ) {
        let s: Signal<Acceleration> = Signal::new(-1.0, dt, a).unwrap();
        let all = [
            hic(&s, 0.015), hic_d(&s), clip_contiguous(&s, 0.003), clip_cumulative(&s, 0.003),
            sliding_mean(&s, 0.025, 0.0), vpi(&s, VpiOptions::default()),
        ];
        prop_assert!(all.iter().all(|m| m.value.is_none_or(f64::is_finite)), "{all:?}");
        if let Ok(rating) = iso18571(&s, &s, &Iso18571Options::default()) {
            prop_assert!(rating.metrics().iter().all(|m| m.value.is_none_or(f64::is_finite)));
        }
        if let Ok(rating) = cora(&s, &s, &CoraOptions::default()) {
            prop_assert!(rating.metrics().iter().all(|m| m.value.is_none_or(f64::is_finite)));
        }
        if let Ok(r) = residuals(&s, &s) {
            prop_assert!(r.metrics("1").iter().all(|m| m.value.is_none_or(f64::is_finite)));
        }
    }
}

const BEGIN: &str = "<!-- catalogue: generated, see crates/metrics/tests/it/properties.rs -->\n";

const END: &str = "<!-- end of catalogue -->\n";

/// An item a definition, in lines of at most 160 characters.
fn list() -> String {
    let item = |d: &Definition| {
        let text = d.text.replace('*', "\\*");
        let item = format!("`{}`, {} (`{}`): {text}. *{}*, **{}**", d.name, d.unit, d.id, d.source, d.mark.letter());
        format!("- {}\n", crumple_stage::wrapped(&item, 158).join("\n  "))
    };
    CATALOGUE.iter().map(item).collect()
}

/// `CRUMPLE_WRITE_DOCS=1 cargo test -p crumple-metrics --test it the_page_lists` writes the list.
#[test]
fn the_page_lists_every_definition() {
    let path = crumple_testkit::workspace().join("docs/metrics.md");
    let page = std::fs::read_to_string(&path).unwrap();
    let (before, rest) = page.split_once(BEGIN).unwrap();
    let (found, after) = rest.split_once(END).unwrap();
    if std::env::var_os("CRUMPLE_WRITE_DOCS").is_some() {
        std::fs::write(&path, format!("{before}{BEGIN}{}{END}{after}", list())).unwrap();
        return;
    }
    assert_eq!(found, list(), "docs/metrics.md and the catalogue differ: run with CRUMPLE_WRITE_DOCS=1");
}

/// Rows of the table of marks beyond the catalogue, and the mark of each.
fn rows(page: &str) -> Vec<(&str, &str)> {
    let (_, table) = page.split_once("## Marks beyond the catalogue").unwrap();
    let (table, _) = table.split_once("\n## ").unwrap();
    let cells = table.lines().filter(|line| line.starts_with("| ")).skip(1).map(|line| {
        let mut cells = line.split('|').map(str::trim).skip(1);
        (cells.next().unwrap(), cells.next().unwrap())
    });
    cells.collect()
}

fn page() -> String {
    std::fs::read_to_string(crumple_testkit::workspace().join("docs/metrics.md")).unwrap()
}

#[test]
fn every_mark_of_the_specification_is_on_the_page() {
    let Some(path) = crumple_testkit::shared("reference/crash-metrics.md") else { return };
    let specification = std::fs::read_to_string(path).unwrap();
    // Behind the paragraph that explains the marks.
    let (_, body) = specification.split_once("## 0.").unwrap();
    let page = page();
    let rows = rows(&page);
    for (mark, letter) in [("[U", "U"), ("[M", "M")] {
        let stated = body.matches(mark).count();
        let found = rows.iter().filter(|(_, row)| *row == letter).count();
        assert_eq!(found, stated, "{mark}]: {found} rows, {stated} in the specification");
    }
}

#[test]
fn a_definition_that_is_an_option_is_named_among_the_marks() {
    let page = page();
    let uncertain: Vec<&str> = rows(&page).into_iter().filter(|(_, mark)| *mark == "U").map(|(row, _)| row).collect();
    for definition in CATALOGUE.iter().filter(|definition| definition.mark == Mark::Uncertain) {
        let family = definition.id.split('-').next().unwrap().to_uppercase();
        assert!(uncertain.iter().any(|row| row.starts_with(&family)), "{}", definition.id);
    }
}
