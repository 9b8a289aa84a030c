//! Options for what speaks for a model: stabilisation diagram, bootstrap, validation.

use crumple_signal::value::Time;
use crumple_stage::Usage;
use crumple_sysid::Resampling;
use serde::Serialize;

use crate::stage::options::flags::{Options, unknown};

/// Ways to draw noise, default first.
const NOISES: [Resampling; 2] = [Resampling::Blocks, Resampling::Autoregression];

/// Settings of the stabilisation diagram.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Stabilisation {
    /// Largest damping ratio that counts.
    pub highest_damping: f64,
}

/// Settings of the bootstrap.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct BootstrapSettings {
    /// Fits.
    pub replicates: usize,
    /// `blocks` or `autoregression`.
    pub noise: String,
    /// Seed.
    pub seed: u32,
}

impl BootstrapSettings {
    /// The way to draw noise as the library knows it.
    pub fn resampling(&self) -> Resampling {
        NOISES.into_iter().find(|known| known.name() == self.noise).unwrap_or(NOISES[0])
    }
}

/// The diagram, if asked for. Errors: a damping ratio that is none.
pub fn stabilisation(options: &Options) -> Result<Option<Stabilisation>, Usage> {
    let highest_damping = options.highest_damping.unwrap_or(2.0);
    if !(highest_damping > 0.0 && highest_damping.is_finite()) {
        return Err(Usage::new(format!("highest damping ratio {highest_damping}, a positive number is needed")));
    }
    Ok(options.stabilisation.unwrap_or(false).then_some(Stabilisation { highest_damping }))
}

/// The bootstrap, if asked for. Errors: an unknown noise, a single replicate.
pub fn bootstrap(options: &Options) -> Result<Option<BootstrapSettings>, Usage> {
    let noise = options.bootstrap_noise.clone().unwrap_or_else(|| NOISES[0].name().to_owned());
    if !NOISES.iter().any(|known| known.name() == noise) {
        return Err(unknown("bootstrap noise", &noise, &NOISES.map(Resampling::name)));
    }
    if options.bootstrap == Some(1) {
        return Err(Usage::new("one bootstrap fit has no spread").hint("200 are usual, 0 for none"));
    }
    Ok(options.bootstrap.filter(|count| *count > 0).map(|replicates| BootstrapSettings {
        replicates: replicates as usize,
        noise,
        seed: options.bootstrap_seed.unwrap_or(1),
    }))
}

/// First time of the samples kept for validation. Errors: nothing before it, or nothing after.
pub fn validate_from(options: &Options, from_s: f64, to_s: Option<f64>) -> Result<Option<f64>, Usage> {
    let validate_from_s = options.validate_from.map(Time::si);
    match validate_from_s.filter(|v| *v <= from_s || to_s.is_some_and(|to| *v >= to)) {
        Some(from) => Err(Usage::new(format!("validation from {from} s leaves nothing before it, or nothing after"))
            .hint("give --validate-from a time between --from and --to")),
        None => Ok(validate_from_s),
    }
}
