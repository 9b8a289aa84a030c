//! How well each method finds the ten parameters of the second nonlinear model, over 20 seeds.
//!
//! `cargo run -p crumple-lumped-fit --example nonlinear_search > docs/methods/nonlinear-search.md`

use anyhow::Context;
use crumple_lumped::{Instants, Model, ModelKind, Nonlinear2};
use crumple_lumped_fit::{FireflyOptions, FireflyUnits, Method, SingleMassFitOptions, SolveSettings, TestData, solve};
use crumple_numerics::estimation::minimise::l_shade::LShadeOptions;
use crumple_numerics::estimation::minimise::levenberg_marquardt::{Bounds, Optimum, Response, descend};
use crumple_numerics::estimation::random::RandomNumbers;
use crumple_signal::{Displacement, Notes, Signal};
use crumple_testkit::table_5;
use nalgebra::DMatrix;
use rayon::prelude::*;

const SEEDS: u64 = 20;
const V0: f64 = 9.7222;
const CRUSH: f64 = 0.5063;
const SAMPLES: usize = 60;
const MASS_KG: f64 = 873.0;

/// Evaluations and root mean square errors, mm, over the seeds.
struct Row {
    name: &'static str,
    evaluations: Vec<u64>,
    errors_mm: Vec<f64>,
}

fn main() -> anyhow::Result<()> {
    println!("# Searching ten parameters: methods, evaluations, errors\n");
    println!(
        "Made by `cargo run -p crumple-lumped-fit --example nonlinear_search > docs/methods/nonlinear-search.md`.\n"
    );
    println!(
        "The record is the displacement of the model itself, {SAMPLES} samples up to 150 ms, with the parameters\n\
         of Table 5 of the single-mass paper, so that it can be met exactly. Errors are root mean squares over\n\
         the record, in mm, over {SEEDS} seeds. An evaluation is one simulation, with or without sensitivities.\n"
    );
    println!("| method | evaluations (median) | best | median | worst |");
    println!("|---|---|---|---|---|");
    for row in rows(&Model::Nonlinear2(table_5()))? {
        let (mut errors, mut evaluations) = (row.errors_mm, row.evaluations);
        errors.sort_by(f64::total_cmp);
        evaluations.sort_unstable();
        let middle = errors.len() / 2;
        let text = |x: f64| if x < 1e-3 { format!("{x:.0e}") } else { format!("{x:.3}") };
        println!(
            "| {} | {} | {} | {} | {} |",
            row.name,
            evaluations[middle],
            text(errors[0]),
            text(errors[middle]),
            text(errors[errors.len() - 1])
        );
    }
    println!();
    println!("## What it says\n");
    println!(
        "- **The firefly search as printed is a random walk.** Distances in N/m, N·s/m, m and m/s are near 1e6,\n\
         \x20\x20and `exp(-gamma r²)` with `gamma = 1/sqrt(L) = 6.1e-4` underflows to zero for every pair. With the\n\
         \x20\x20attraction set to zero (`beta0 = 0`) all trajectories are the same to the last bit (a test).\n\
         - In the unit box the attraction acts, and the search works moderately.\n\
         - L-SHADE is the general search for a model without a structure to use. It always ends with a descent.\n\
         \x20\x20Here 100 random descents with analytic sensitivities do better with fewer evaluations.\n\
         - The default, `direct-fit`, uses the structure: for fixed knots the momentum is linear in the seven\n\
         \x20\x20coefficients. It uses no random numbers. If the record identifies the parameters, it finds them with\n\
         \x20\x20a few hundred evaluations."
    );
    Ok(())
}

fn rows(truth: &Model) -> anyhow::Result<Vec<Row>> {
    let response = truth.respond(V0, 1e-4, 1501)?;
    let x = Signal::<Displacement>::new(0.0, 1e-4, response.compartment().displacement_m.clone())?;
    let events = truth.events(V0)?;
    let stop = events.time_of_dynamic_crush_s.unwrap_or(0.075);
    // The last knot of the spring of the table.
    let crush_m = CRUSH;
    let options = SingleMassFitOptions {
        mass_kg: MASS_KG,
        impact_speed_m_per_s: V0,
        crush_m,
        time_of_dynamic_crush_s: stop,
        from_s: 0.0,
        to_s: Some(0.15),
        samples: SAMPLES,
    };
    let test = TestData {
        mass_kg: MASS_KG,
        impact_speed_m_per_s: V0,
        time_of_dynamic_crush_s: Some(stop),
        dynamic_crush_m: Some(crush_m),
        coefficient_of_restitution: None,
        time_of_rebound_s: None,
        displacement: Some(&x),
        measurement: None,
        sensors: &[],
    };
    let mut rows = Vec::new();
    let (_, fit) = options.search_nonlinear2(&x)?;
    rows.push(Row {
        name: "`direct-fit` (default)",
        evaluations: vec![fit.evaluations],
        errors_mm: vec![1e3 * fit.rmse],
    });

    let mut row = Row { name: "`l-shade`, 20,000 evaluations, then descent", evaluations: vec![], errors_mm: vec![] };
    for seed in 1..=SEEDS {
        let settings = SolveSettings {
            models: vec![ModelKind::Nonlinear2],
            methods: vec![Method::LShade],
            l_shade: LShadeOptions { evaluations: 20_000, seed },
            fit_to_s: Some(0.15),
            fit_samples: SAMPLES,
            ..SolveSettings::default()
        };
        let found = solve(&test, &settings, &mut Notes::new())?;
        if let Some(fit) = found.first().and_then(|candidate| candidate.fit.as_ref()) {
            row.evaluations.push(fit.evaluations);
            row.errors_mm.push(1e3 * fit.rmse);
        }
    }
    rows.push(row);

    let mut row = Row { name: "100 random starts, descent from each", evaluations: vec![], errors_mm: vec![] };
    for seed in 1..=SEEDS {
        let (evaluations, rmse_m) = random_starts(&x, 100, seed)?;
        row.evaluations.push(evaluations);
        row.errors_mm.push(1e3 * rmse_m);
    }
    rows.push(row);

    for (name, units, beta0) in [
        ("`firefly`, unit box", FireflyUnits::Unit, 1.0),
        ("`firefly`, physical units, as printed", FireflyUnits::Physical, 1.0),
        ("  the same without attraction: a random walk", FireflyUnits::Physical, 0.0),
    ] {
        let mut row = Row { name, evaluations: vec![], errors_mm: vec![] };
        for seed in 1..=SEEDS {
            let search = FireflyOptions { units, beta0, seed, ..FireflyOptions::default() };
            let fit = options.firefly_nonlinear2(&x, &search)?.fit;
            row.evaluations.push(fit.evaluations);
            row.errors_mm.push(1e3 * fit.rmse);
        }
        rows.push(row);
    }
    Ok(rows)
}

/// Where descents start: `k1 k2 k3` and `c1 c2 c3 c4` in logarithms of their units `m (v0/C)²` and `m v0/C`, `x1` as a
/// share of the crush, `v2` of the impact speed, `v1` of `v2`. Order of the coordinates: k1 k2 k3 x1 c1 c2 c3 c4 v2 v1.
const KNOTS: [(usize, (f64, f64)); 3] = [(3, (0.1, 0.95)), (8, (0.05, 0.95)), (9, (0.05, 0.95))];
const COEFFICIENTS: (f64, f64) = (1e-3, 10.0);
/// Bounds of coefficients and of knots.
const WIDEST: (f64, f64) = (1e-8, 1e3);
const KNOT: (f64, f64) = (0.005, 0.995);

/// Places of the coordinates among the parameters of the model.
const PLACES: [usize; 10] = [1, 2, 3, 4, 5, 6, 7, 8, 10, 9];

/// The record of the table's model, and the second nonlinear model beside it, in units of the crush.
struct Beside {
    samples: Vec<f64>,
    dt_s: f64,
}

impl Beside {
    fn parameters(&self, theta: &[f64]) -> [f64; 10] {
        let rate = V0 / CRUSH;
        let (spring, damper) = (MASS_KG * rate * rate, MASS_KG * rate);
        let mut p = [spring, spring, spring, CRUSH, damper, damper, damper, damper, V0, 1.0];
        for (i, p) in p.iter_mut().enumerate() {
            *p *= if KNOTS.iter().any(|(knot, _)| *knot == i) { theta[i] } else { theta[i].exp() };
        }
        p[9] = theta[9] * p[8];
        p
    }

    fn model(&self, theta: &[f64]) -> Option<Model> {
        let [k1_n_per_m, k2_n_per_m, k3_n_per_m, x1_m, c1, c2, c3, c4, v2_m_per_s, v1_m_per_s] = self.parameters(theta);
        let model = Nonlinear2 {
            mass_kg: MASS_KG,
            k1_n_per_m,
            k2_n_per_m,
            k3_n_per_m,
            x1_m,
            c1_n_s_per_m: c1,
            c2_n_s_per_m: c2,
            c3_n_s_per_m: c3,
            c4_n_s_per_m: c4,
            v1_m_per_s,
            v2_m_per_s,
            crush_m: CRUSH,
            v0_m_per_s: V0,
        };
        model.check().is_ok().then_some(Model::Nonlinear2(model))
    }

    fn instants(&self) -> Instants {
        Instants { first_s: 0.0, dt_s: self.dt_s, samples: self.samples.len() }
    }
}

impl Response for Beside {
    fn rows(&self) -> usize {
        self.samples.len()
    }

    fn residuals(&self, theta: &[f64], out: &mut [f64]) -> bool {
        let Some(model) = self.model(theta) else { return false };
        let Ok(response) = model.sensitivity(V0, &self.instants(), &[]) else { return false };
        for (out, (x, s)) in out.iter_mut().zip(response.motions[0].displacement_m.iter().zip(&self.samples)) {
            *out = (x - s) / CRUSH;
        }
        out.iter().all(|r| r.is_finite())
    }

    fn sensitivities(&self, theta: &[f64], out: &mut DMatrix<f64>) -> bool {
        let Some(model) = self.model(theta) else { return false };
        let Ok(response) = model.sensitivity(V0, &self.instants(), &PLACES) else { return false };
        let p = self.parameters(theta);
        for (j, theta_j) in theta.iter().enumerate() {
            // A logarithm changes its parameter by the parameter itself, a share by what it is a share of; v1 follows
            // v2.
            let own = if KNOTS.iter().any(|(knot, _)| *knot == j) { p[j] / theta_j } else { p[j] };
            for k in 0..self.samples.len() {
                let by = |i: usize| response.derivatives[i][0].displacement_m[k];
                let follows = if j == 8 { by(9) * p[9] / p[8] * own } else { 0.0 };
                out[(k, j)] = (by(j) * own + follows) / CRUSH;
            }
        }
        true
    }
}

/// Evaluations and root mean square error, m, of the best of bounded Levenberg-Marquardt descents from `starts` points
/// drawn evenly in the logarithms of the coefficients.
fn random_starts(record: &Signal<Displacement>, starts: usize, seed: u64) -> anyhow::Result<(u64, f64)> {
    let stride = record.len().div_ceil(SAMPLES);
    let samples = record.samples().iter().copied().step_by(stride).collect();
    let problem = Beside { samples, dt_s: record.dt_s() * stride as f64 };
    let within = |coefficients: (f64, f64), knots: &dyn Fn((f64, f64)) -> (f64, f64)| -> Vec<(f64, f64)> {
        let coefficient = (coefficients.0.ln(), coefficients.1.ln());
        (0..10)
            .map(|i| KNOTS.iter().find(|(knot, _)| *knot == i).map_or(coefficient, |(_, ends)| knots(*ends)))
            .collect()
    };
    let begin = within(COEFFICIENTS, &|ends| ends);
    let limits = within(WIDEST, &|_| KNOT);
    let bounds = Bounds {
        lower: limits.iter().map(|ends| ends.0).collect(),
        upper: limits.iter().map(|ends| ends.1).collect(),
        max_iterations: 120,
        cost_tolerance: 1e-9,
        slow: 0.0,
    };
    let mut random = RandomNumbers::seeded(seed);
    let mut even = || random.uniform();
    let points: Vec<Vec<f64>> =
        (0..starts).map(|_| begin.iter().map(|(low, high)| low + (high - low) * even()).collect()).collect();
    let ends: Vec<Optimum> = points.par_iter().filter_map(|point| descend(&problem, point, &bounds)).collect();
    let best = ends.iter().map(|end| end.cost).min_by(f64::total_cmp).context("no start has a finite response")?;
    let evaluations = ends.iter().map(|end| end.evaluations).sum();
    Ok((evaluations, (best / problem.samples.len() as f64).sqrt() * CRUSH))
}
