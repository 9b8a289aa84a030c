//! Engine and compartment behind load paths that are crushed, where a sensor sits on the engine too.
//!
//! With sensors on both masses the motion at both ends of every path is known, and its force is linear in its knots:
//! one bounded least squares problem gives all curves, and the masses where they are free ([`extract`]). The fit as
//! measured to all sensors refines them. The path past the engine is taken where the accelerations of both ask for it,
//! and the force on the wall where that is fitted.

use crumple_lumped::{CrushedLoadPaths, LOAD_PATHS, LoadPath, MOST_KNOTS_OF_PATH, Model, ModelKind};
use crumple_signal::{About, Displacement, Notes, Sampled, Signal, TwoPassFilter, Weight, remarks};

use crate::candidate::{Candidate, Minimum};
use crate::coordinates::MassFit;
use crate::error::SolveError;
use crate::extraction::extract::extract;
use crate::extraction::problem::{
    AskedCurve, ExtractionTest, MeasuredElement, MeasuredMass, MeasuredThrough, MeasuredWall,
};
use crate::parameters::{MassEvidence, free_masses, free_parameters, masses};
use crate::record::observation::{Observation, ObservedWave};
use crate::record::sensor::{FitQuantity, SensorPlace};
use crate::selection::evidence::{Evidence, OF_A_NUMBER};
use crate::selection::rating::ComparedRecord;
use crate::solvers::closed_forms::{KNOT_SPACING_S, NoCurve, RATE_PRIOR_S_PER_M, restitution};
use crate::solvers::fitting::{FitStart, FitTask};
use crate::solvers::table::{Extent, Task, row_of};

/// Front and rear mass of each path, by their place; none: the wall.
const ENDS: [(Option<usize>, usize); LOAD_PATHS] = [(None, 0), (Some(0), 1), (None, 1)];
/// The path past the engine.
const PARALLEL: usize = 2;
/// Knots that are tried, over one every 9 ms: an engine that meets the wall needs closer ones.
const DENSITIES: [f64; 4] = [1.5, 1.0, 2.0 / 3.0, 0.5];
/// Knots of a path at least.
const FEWEST_KNOTS: usize = 2;
/// Knots are apart by this share of the largest deflection of their path at least.
const LEAST_PIECE: f64 = 0.03;
/// The last piece of a curve, at least, over its largest deflection: beyond it the curve goes on with its slope.
const LAST_PIECE: f64 = 0.12;
/// Least unloading stiffness over the steepest slope of the curve read: the fit moves the forces, and may not pass it.
const STIFFER: f64 = 1.5;
/// Most samples of the motions that curves are read from.
const SAMPLES: usize = 1000;
/// Samples that curves are read from at least.
const FEWEST_SAMPLES: usize = 24;

/// Candidates of two masses, numbered from `first` on; none without a displacement of the engine.
pub(super) fn fit(
    one_mass: &Task<'_>,
    extent: &Extent,
    first: usize,
    notes: &mut Notes,
) -> Result<Vec<Candidate>, SolveError> {
    let task = Task { model: ModelKind::LoadPaths, ..*one_mass };
    let on = |mass: usize| task.test.sensors.iter().find(move |sensor| sensor.place.mass(2) == Some(mass));
    let Some(engine) = on(0).filter(|engine| engine.quantity == FitQuantity::Displacement) else {
        if on(0).is_some() {
            notes.push(DisplacementsOnly { model: task.model.to_string() });
        }
        return Ok(Vec::new());
    };
    let to_s = task.settings.fit_to_s.or(extent.stops.then_some(extent.time_s));
    let Some(displacement) = task.test.displacement else { return Ok(Vec::new()) };
    let Some(mut fitting) = FitTask::of_sensors(&task, to_s, notes)? else { return Ok(Vec::new()) };
    let (m1_kg, m2_kg, split) = masses(task.test.mass_kg, task.settings.split, MassEvidence::SeveralMasses)?;
    let masses_kg = [m1_kg, m2_kg];
    let Some(motions) = Motions::of(&task, displacement, engine.record, fitting.end_s()) else {
        notes.push(TooFewForTwoMasses { model: task.model.to_string() });
        return Ok(Vec::new());
    };
    let accelerations = motions.observed(&task);
    let mut candidates = Vec::new();
    for share in DENSITIES {
        let mut of_paths = |parallel: bool| {
            let start = motions.extracted(&task, masses_kg, (share, parallel), extent)?;
            let mut free = free_parameters(&start, task.test.impact_speed_m_per_s, extent.crush_m);
            if let MassFit::Shares { lower, upper } = task.settings.mass_fit {
                free.extend(free_masses(&start, (lower, upper)));
            }
            let minimum = fitting.weighed_nearby(&start, &free)?;
            Some((minimum, fitting.observed.clone()))
        };
        let (without, with) = (of_paths(false), of_paths(true));
        let asked_for = match (&without, &with) {
            (Some((without, _)), Some((with, _))) => accelerations.as_ref().is_some_and(|a| asks_for(a, without, with)),
            (without, _) => without.is_none(),
        };
        let Some((minimum, observed)) = (if asked_for { with } else { without }) else { continue };
        fitting.observed = observed;
        let masses = match task.settings.mass_fit {
            MassFit::Known => split.clone(),
            MassFit::Shares { .. } => "masses fitted, their total known".to_owned(),
        };
        let remarks = [masses, remark(&minimum.model), assumed(&task)];
        let start = FitStart::computed(minimum.model.clone());
        candidates.push(fitting.candidate(&start, minimum, first + candidates.len(), &remarks));
    }
    if candidates.is_empty() {
        notes.push(NoCurve { model: task.model.to_string(), masses: 2 });
    }
    Ok(candidates)
}

/// Motions of engine and compartment on one grid, from long before contact to beyond the window, as a filter needs
/// them.
struct Motions {
    dt_s: f64,
    /// First sample, s after time zero.
    first_s: f64,
    /// First sample after contact, and the last of the window.
    window: (usize, usize),
    /// Displacement, velocity, acceleration of engine and compartment.
    of: [[Vec<f64>; 3]; 2],
    wall_n: Option<Vec<f64>>,
    filter: Option<TwoPassFilter>,
}

impl Motions {
    /// By differences of the displacements, which are sums of sums: the second difference is a mean of neighbours of
    /// the acceleration. `None` with too few samples.
    fn of(task: &Task<'_>, compartment: &Signal<Displacement>, engine: &Sampled, to_s: f64) -> Option<Self> {
        let (dt_s, count) = (compartment.dt_s(), compartment.len());
        let filter = task.test.measurement.and_then(|measurement| measurement.filter);
        let beyond = filter.map_or(0, |filter| filter.memory_samples());
        let contact = compartment.index_at_or_after(0.0);
        let end = compartment.index_at_or_after(to_s + 0.5 * dt_s);
        let last = end.saturating_add(beyond).min(count.checked_sub(2)?);
        let differences = |at: &dyn Fn(usize) -> Option<f64>| -> Option<[Vec<f64>; 3]> {
            let x: Vec<f64> = (0..last + 2).map(at).collect::<Option<_>>()?;
            // Nothing is slowed before contact.
            let inside = |k: usize| k > contact;
            let v = |k: usize| if inside(k) { (x[k + 1] - x[k - 1]) / (2.0 * dt_s) } else { 0.0 };
            let a = |k: usize| if inside(k) { (x[k + 1] - 2.0 * x[k] + x[k - 1]) / (dt_s * dt_s) } else { 0.0 };
            let before_contact = |k: usize| if k < contact { 0.0 } else { x[k] };
            Some([(0..=last).map(before_contact).collect(), (0..=last).map(v).collect(), (0..=last).map(a).collect()])
        };
        let t = |k: usize| compartment.time_s(k);
        // A record that begins at contact has nothing before it.
        let of_engine = differences(&|k| engine.at(t(k)).or_else(|| (t(k) < engine.t0_s()).then_some(0.0)))?;
        let of_compartment = differences(&|k| compartment.samples().get(k).copied())?;
        let wall = task.test.sensors.iter().find(|sensor| sensor.place == SensorPlace::Wall);
        let wall_n = wall.map(|wall| (0..=last).map(|k| wall.record.at(t(k)).unwrap_or(0.0)).collect());
        let window = (contact + 2, end.min(last));
        let enough = window.1 >= window.0 + FEWEST_SAMPLES;
        let (of, first_s) = ([of_engine, of_compartment], compartment.t0_s());
        enough.then_some(Self { dt_s, first_s, window, of, wall_n, filter })
    }

    /// Deflection of a path at every sample, m.
    fn deflection(&self, path: usize) -> Vec<f64> {
        let (front, rear) = ENDS[path];
        let front = |k: usize| front.map_or(0.0, |front| self.of[front][0][k]);
        self.of[rear][0].iter().enumerate().map(|(k, rear)| rear - front(k)).collect()
    }

    /// Deflections of the knots of a path, that at zero first: equal in time from its first touch to its largest
    /// deflection in the window, one every 9 ms times `share`. `None` for a path that is not compressed.
    fn knots(&self, path: usize, share: f64) -> Option<Vec<f64>> {
        let d = self.deflection(path);
        let (from, to) = self.window;
        let turn = (from..=to).max_by(|a, b| d[*a].total_cmp(&d[*b]))?;
        let end = d[turn];
        let touch = (from..turn).rev().find(|k| d[*k] <= 0.0).unwrap_or(from);
        let most = share * (turn - touch) as f64 * self.dt_s / KNOT_SPACING_S;
        let count = (most.round() as usize).clamp(FEWEST_KNOTS, MOST_KNOTS_OF_PATH);
        let mut knots = vec![0.0];
        for j in 1..count {
            let place = d[touch + (turn - touch) * j / count];
            let before = knots.last().copied().unwrap_or(0.0);
            if place > before + LEAST_PIECE * end && place < (1.0 - LAST_PIECE) * end {
                knots.push(place);
            }
        }
        knots.push(end);
        (end > 0.0).then_some(knots)
    }

    /// The model that is read off the motions, with this share of the knots that they carry. `None` without a solution.
    fn extracted(
        &self,
        task: &Task<'_>,
        masses_kg: [f64; 2],
        (share, parallel): (f64, bool),
        extent: &Extent,
    ) -> Option<Model> {
        let paths = if parallel { LOAD_PATHS } else { PARALLEL };
        let asked =
            |path: usize| Some(AskedCurve { knots_m: self.knots(path, share)?, rate_s_per_m: RATE_PRIOR_S_PER_M });
        let curves: Vec<AskedCurve> = (0..paths).map(asked).collect::<Option<_>>()?;
        let free = matches!(task.settings.mass_fit, MassFit::Shares { .. });
        let total_kg: f64 = masses_kg.iter().sum();
        let mass = |i: usize| {
            let [x, v, a] = self.of[i].clone();
            let mass_kg = (!free).then_some(masses_kg[i]);
            // Both accelerations are known equally well.
            let noise_n = masses_kg[i];
            MeasuredMass { mass_kg, displacement_m: x, velocity_m_per_s: v, acceleration_m_per_s2: a, noise_n }
        };
        let element =
            |path: usize| MeasuredElement { front: ENDS[path].0, rear: ENDS[path].1, curve: path, gap_m: 0.0 };
        let stride = ((self.window.1 - self.window.0) / SAMPLES).max(1);
        let test = ExtractionTest {
            dt_s: self.dt_s,
            masses: vec![mass(0), mass(1)],
            elements: (0..paths).map(element).collect(),
            total_mass_kg: free.then_some(total_kg),
            wall: self.wall_n.clone().map(|force_n| MeasuredWall { force_n, noise_n: total_kg }),
            through: Some(MeasuredThrough {
                filter: self.filter,
                compared: (self.window.0..=self.window.1).step_by(stride).collect(),
            }),
        };
        let extraction = extract(&[test], &curves, 0.0)?;
        let [m1_kg, m2_kg] = match (task.settings.mass_fit, extraction.masses_kg[0].as_slice()) {
            (MassFit::Shares { lower, upper }, [m1, _]) => {
                let m1 = m1.clamp(1.01 * lower * total_kg, 0.99 * upper * total_kg);
                [m1, total_kg - m1]
            }
            _ => masses_kg,
        };
        let turns: f64 = extraction.forces_n.iter().filter_map(|forces| forces.last()).map(|force| force * force).sum();
        let restitution = restitution(task);
        // All that the paths give back together is what the vehicle rebounds with.
        let by_restitution = turns / (total_kg * (task.test.impact_speed_m_per_s * restitution).powi(2));
        let mut model = CrushedLoadPaths { m1_kg, m2_kg, paths: [None; LOAD_PATHS] };
        for (path, (curve, forces_n)) in curves.iter().zip(&extraction.forces_n).enumerate() {
            let knots: Vec<(f64, f64)> = curve.knots_m.iter().copied().zip(forces_n.iter().copied()).collect();
            let slope = |pair: &[(f64, f64)]| (pair[1].1 - pair[0].1) / (pair[1].0 - pair[0].0);
            let steepest = knots.windows(2).map(slope).fold(0.0, f64::max);
            // An unloading that the window shows counts more than the rebound of the whole.
            let d = self.deflection(path);
            let turned = d[self.window.1] < 0.98 * d[self.window.0..=self.window.1].iter().copied().fold(0.0, f64::max);
            let unloading = extraction.unloading_n_per_m[path].filter(|_| turned).unwrap_or(by_restitution);
            let least = STIFFER * steepest.max(total_kg * (task.test.impact_speed_m_per_s / extent.crush_m).powi(2));
            model.paths[path] = LoadPath::new(&knots[1..], unloading.max(least), RATE_PRIOR_S_PER_M).ok();
        }
        let model = Model::LoadPaths(model);
        model.check().is_ok().then_some(model)
    }

    /// The accelerations of both in the window, as measured, and the force on the wall where that is fitted; `None`
    /// where they cannot be compared.
    fn observed(&self, task: &Task<'_>) -> Option<Observation> {
        let after_contact_s = |k: usize| self.first_s + k as f64 * self.dt_s;
        let window_s = (after_contact_s(self.window.0), after_contact_s(self.window.1));
        let wave = |mass: usize| {
            let from = self.window.0 - 1;
            let first_s = after_contact_s(from);
            let wave = Sampled::new(first_s, self.dt_s, self.of[mass][2][from..].to_vec()).ok()?;
            let measurement = task.test.measurement?;
            let what = (Some(mass), FitQuantity::Acceleration);
            ObservedWave::new(&wave, what, measurement, window_s, usize::MAX).ok()
        };
        let wall = task.test.sensors.iter().find(|sensor| sensor.place == SensorPlace::Wall).and_then(|wall| {
            let measurement = wall.measurement?;
            let window_s = (measurement.time_s(measurement.contact_index()), window_s.1);
            let what = (Some(2), FitQuantity::Force);
            ObservedWave::new(wall.record, what, measurement, window_s, usize::MAX).ok()
        });
        let mut waves: Vec<ObservedWave> = [wave(0)?, wave(1)?].into_iter().chain(wall).collect();
        let size = waves[0].size();
        waves.iter_mut().for_each(|wave| wave.weight = size / wave.size());
        Some(Observation { impact_speed_m_per_s: task.test.impact_speed_m_per_s, waves }.limited(1))
    }
}

/// Whether the accelerations of engine and compartment, and the force on the wall beside them, ask for the path that
/// one of the fits has more: a lower score with it, as in the choice of a candidate.
fn asks_for(accelerations: &Observation, without: &Minimum, with: &Minimum) -> bool {
    let records = [(accelerations.clone(), 1.0)];
    let of = |minimum: &Minimum| {
        let free: Vec<&str> = minimum.free.iter().map(|parameter| &*parameter.name).collect();
        Evidence::new(&records, &minimum.model, &free)
    };
    let Some((a, b)) = of(without).zip(of(with)) else { return false };
    let wave = &accelerations.waves[0];
    let record = ComparedRecord::of(wave, 0.0);
    let variance = record.variance([&a, &b]);
    let more = OF_A_NUMBER * (with.free.len() as f64 - without.free.len() as f64);
    b.score(variance).zip(a.score(variance)).is_some_and(|(with, without)| with + more < without)
}

/// Which paths with how many knots.
fn remark(model: &Model) -> String {
    let Model::LoadPaths(model) = model else { return String::new() };
    let names = ["barrier to engine", "engine to compartment", "barrier to compartment"];
    let knots = model.paths.iter().zip(names);
    let knots: Vec<String> =
        knots.filter_map(|(path, name)| Some(format!("{name} {}", path.as_ref()?.knots().len() - 1))).collect();
    let parallel = if model.paths[PARALLEL].is_some() {
        "the sensors ask for the path past the engine"
    } else {
        "the sensors do not ask for a path past the engine"
    };
    format!("load paths with knots beside that at zero: {}; {parallel}", knots.join(", "))
}

/// What was assumed.
fn assumed(task: &Task<'_>) -> String {
    let of_the_test = task.test.coefficient_of_restitution.is_some();
    let restitution = if of_the_test { "of the test" } else { "usual in full frontal tests" };
    format!(
        "rate factor {RATE_PRIOR_S_PER_M} s/m is a prior, +- 0.005; unloading stiffness of a path as the window shows \
         it, else from the restitution {restitution}"
    )
}

remarks! {
    /// Remarks of two masses on load paths.
    pub REMARKS;

    /// A sensor is on the engine, and load paths cannot be fitted to the quantity that is asked for.
    CR519 DisplacementsOnly { model: String }
    bears on (About::Model(String::new()), Weight::None)
    decided "Load paths are read off the displacements of engine and compartment; fit_quantity asks for another motion."
    means "There is no candidate of two masses on load paths. The curve of one mass is fitted."
    remedy "leave fit_quantity out to have them"
    says format!("{model}: two masses are fitted to displacements only");

    /// The displacements of engine and compartment hold too few samples for load paths.
    CR520 TooFewForTwoMasses { model: String }
    bears on (row_of(model), Weight::Slight)
    decided "Curves are read from 24 samples at least. They lie between contact and the end of the fit window, and \
             both displacements hold them."
    means "There is no candidate of two masses on load paths. The curve of one mass is not touched by it."
    remedy "give records with a higher rate, or end the fit window later: fit_to"
    says format!("{model}: no two masses, the record has too few samples");
}
