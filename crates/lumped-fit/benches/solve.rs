//! Time of one coefficient match and of the default fits.
//!
//! `cargo bench -p crumple-lumped-fit --bench solve`

#![allow(clippy::unwrap_used, reason = "a benchmark that cannot run has no figure")]

use std::hint::black_box;
use std::sync::LazyLock;

use crumple_lumped::{CoefficientMatching, DoubleSpringMassDamper, Model, ModelKind, Reading};
use crumple_lumped_fit::{
    FireflyOptions, FireflyUnits, MassSplit, SingleMassFitOptions, SolveSettings, TestData, solve,
};
use crumple_signal::{Notes, Signal};
use crumple_testkit::benchmark::{Figure, best_s, memory_pass_s};
use crumple_testkit::table_5;

/// One figure beside a copy of 1,501 samples.
fn figure(name: &str, run: impl FnMut()) -> Figure {
    static PASS_S: LazyLock<f64> = LazyLock::new(|| memory_pass_s(&[1.0; 1501]));
    Figure::new(name, best_s(run), *PASS_S)
}

fn main() {
    let civic = [35.7, 6024.0, 185_000.0, 414_600.0];
    figure("coefficient matching, all six solutions, certified", || {
        black_box(CoefficientMatching::new(black_box(civic), 284.4, 1137.6, Reading::Binary).unwrap().solve());
    })
    .aim(10e-6, "numpy 280 µs")
    .print();
    figure("  the same, numbers read as decimals", || {
        black_box(CoefficientMatching::new(black_box(civic), 284.4, 1137.6, Reading::Decimal).unwrap().solve());
    })
    .aim(10e-6, "")
    .print();
    let truth = Model::Nonlinear2(table_5());
    let response = truth.respond(9.7222, 1e-4, 1501).unwrap();
    let x = Signal::new(0.0, 1e-4, response.compartment().displacement_m.clone()).unwrap();
    let options = SingleMassFitOptions {
        mass_kg: 873.0,
        impact_speed_m_per_s: 9.7222,
        crush_m: 0.5063,
        time_of_dynamic_crush_s: 0.07516,
        from_s: 0.0,
        to_s: None,
        samples: 250,
    };
    figure("nonlinear II, all ten parameters to 1e-6, default method", || {
        black_box(options.search_nonlinear2(&x).unwrap());
    })
    .aim(0.2, "scipy 1.7 s")
    .print();
    figure("nonlinear I with side constraints, a record it does not meet", || {
        black_box(options.fit_nonlinear1(&x, true).unwrap());
    })
    .print();
    let test = TestData {
        mass_kg: 873.0,
        impact_speed_m_per_s: 9.7222,
        time_of_dynamic_crush_s: None,
        dynamic_crush_m: None,
        coefficient_of_restitution: None,
        time_of_rebound_s: None,
        displacement: Some(&x),
        measurement: None,
        sensors: &[],
    };
    let settings = SolveSettings { models: vec![ModelKind::Maxwell], ..SolveSettings::default() };
    figure("maxwell", || {
        black_box(solve(&test, &settings, &mut Notes::new()).unwrap());
    })
    .print();
    for (name, dampers) in [("light", [6e3, 9e3]), ("strong", [6e4, 4e4])] {
        let [c1_n_s_per_m, c2_n_s_per_m] = dampers;
        let springs = DoubleSpringMassDamper {
            m1_kg: 375.0,
            m2_kg: 1125.0,
            k1_n_per_m: 9e5,
            k2_n_per_m: 1e6,
            c1_n_s_per_m,
            c2_n_s_per_m,
        };
        let response = Model::DoubleSpringMassDamper(springs).respond(13.0, 1e-4, 2501).unwrap();
        let x = Signal::new(0.0, 1e-4, response.compartment().displacement_m.clone()).unwrap();
        let settings = SolveSettings {
            models: vec![ModelKind::DoubleSpringMassDamper],
            split: MassSplit::Both(springs.m1_kg, springs.m2_kg),
            fit_to_s: springs.events(13.0).unwrap()[1].time_of_dynamic_crush_s,
            ..SolveSettings::default()
        };
        let test = TestData { mass_kg: 1500.0, impact_speed_m_per_s: 13.0, displacement: Some(&x), ..test };
        figure(&format!("double, four parameters, {name} damping, 24 starts"), || {
            black_box(solve(&test, &settings, &mut Notes::new()).unwrap());
        })
        .print();
    }
    // Errors over 20 seeds, 20,000 evaluations each.
    for (name, units) in [("as printed", FireflyUnits::Physical), ("in the unit box", FireflyUnits::Unit)] {
        let mut errors: Vec<f64> = (1..=20)
            .map(|seed| {
                let search = FireflyOptions { units, seed, ..FireflyOptions::default() };
                let options = SingleMassFitOptions { samples: 60, ..options };
                1e3 * options.firefly_nonlinear2(&x, &search).unwrap().fit.rmse
            })
            .collect();
        errors.sort_by(f64::total_cmp);
        println!("firefly {name}: median {:.2} mm, {:.2} to {:.2} mm over 20 seeds", errors[10], errors[0], errors[19]);
    }
    let (_, fit) = options.search_nonlinear2(&x).unwrap();
    println!("default method: {:.1e} mm, {} evaluations", 1e3 * fit.rmse, fit.evaluations);
}
