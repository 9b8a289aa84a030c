//! Times of the parts that a run waits for: `cargo run --release -p crumple-lumped-fit --example timing`.

use std::time::Instant;

use crumple_lumped::{DoubleSpringMassDamper, Model, ModelKind};
use crumple_lumped_fit::{MassSplit, SolveSettings, TestData, solve};
use crumple_signal::{Displacement, Notes, Signal};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let model = DoubleSpringMassDamper {
        m1_kg: 375.0,
        m2_kg: 1125.0,
        k1_n_per_m: 900_000.0,
        k2_n_per_m: 1_000_000.0,
        c1_n_s_per_m: 6_000.0,
        c2_n_s_per_m: 9_000.0,
    };
    let (v0, dt) = (50.0 / 3.6, 1e-4);
    let lumped = Model::DoubleSpringMassDamper(model);
    let response = best(20, || lumped.respond(v0, dt, 2001))?;
    best(20, || lumped.events(v0))?;
    let events = lumped.events(v0)?;
    let settings = SolveSettings {
        models: vec![ModelKind::DoubleSpringMassDamper],
        split: MassSplit::Both(375.0, 1125.0),
        ..SolveSettings::default()
    };
    let fit = |displacement: &Signal<Displacement>| {
        let test = TestData {
            mass_kg: 1500.0,
            impact_speed_m_per_s: v0,
            time_of_dynamic_crush_s: events.time_of_dynamic_crush_s,
            dynamic_crush_m: events.dynamic_crush_m,
            coefficient_of_restitution: None,
            time_of_rebound_s: None,
            displacement: Some(displacement),
            measurement: None,
            sensors: &[],
        };
        solve(&test, &settings, &mut Notes::new())
    };
    let exact = Signal::<Displacement>::new(0.0, dt, response.compartment().displacement_m.clone())?;
    println!("fit of an exact record");
    let found = best(10, || fit(&exact))?;
    println!("  {} candidates, {:?}", found.len(), found[0].fit);
    // A crash is not a linear model: 10 mm of something else.
    let bent = exact
        .with_samples(exact.samples().iter().enumerate().map(|(k, x)| x + 0.01 * (k as f64 * 0.02).sin()).collect())?;
    println!("fit of a record with 10 mm misfit");
    let found = best(10, || fit(&bent))?;
    println!("  {} candidates, {:?}", found.len(), found[0].fit);
    Ok(())
}

fn best<T, E>(times: usize, mut work: impl FnMut() -> Result<T, E>) -> Result<T, E> {
    let mut shortest = f64::INFINITY;
    let mut result = work()?;
    for _ in 0..times {
        let start = Instant::now();
        result = work()?;
        shortest = shortest.min(start.elapsed().as_secs_f64());
    }
    println!("  {:.3} ms", 1e3 * shortest);
    Ok(result)
}
