//! Models of one discrete method, one attempt after the other: identified, simulated, written.

use crumple_stage::{Outcome, RefuseExt};
use crumple_sysid::{IdentifyError, IoData};

use crate::stage::options::input_output::BeyondEra;
use crate::stage::options::settings::Settings;
use crate::stage::records::acceptance::simulate_accepted;
use crate::stage::records::discrete_model::{Chosen, Found};
use crate::stage::records::results::Results;
use crate::stage::records::state_space::{Task, put};
use crate::stage::waves::input_output::{Record, record};
use crate::stage::waves::source::Source;

/// A method and the waveforms that it works on.
pub struct Attempts<'a> {
    /// Name of the method.
    pub method: &'a str,
    /// Settings of the stage.
    pub settings: &'a Settings,
    /// Those beside `era`.
    pub beyond: &'a BeyondEra,
    /// The waveforms.
    pub record: Record,
    /// The window, inputs delayed.
    pub data: IoData,
    /// The same with what is kept after it.
    pub whole: IoData,
    /// What to do where no attempt leads to a model.
    pub hint: &'static str,
}

/// Gives the model of a record.
pub type Identify<'a> = Box<dyn Fn(&IoData, Chosen) -> Result<Found, IdentifyError> + Sync + 'a>;

/// One model that is asked for.
pub struct Attempt<'a> {
    /// Its id.
    pub id: String,
    /// States asked for.
    pub order: usize,
    /// The model of a record, which may be another one of the same shape, with the choices that are made already.
    pub identify: Identify<'a>,
    /// What is known of it before it is there.
    pub remark: Option<String>,
}

impl<'a> Attempts<'a> {
    /// Reads the waveforms.
    pub fn new(method: &'a str, source: Source<'a>, beyond: &'a BeyondEra, hint: &'static str) -> anyhow::Result<Self> {
        let record = record(source, beyond)?;
        let (data, whole) = (record.data.delayed(beyond.delay), record.whole.delayed(beyond.delay));
        Ok(Self { method, settings: source.settings, beyond, record, data, whole, hint })
    }

    /// Writes one model an attempt. What one attempt does not allow is a warning; an error, told by who asked, only if there
    /// is no model at all.
    pub fn put(&self, attempts: &[Attempt<'_>], results: &mut Results<'_>) -> anyhow::Result<Outcome> {
        let mut written = 0;
        let mut failures = Vec::new();
        for attempt in attempts {
            let found = (attempt.identify)(&self.data, Chosen::default());
            match found.and_then(|found| simulate_accepted(found, &self.data)) {
                Ok((simulated, found)) => {
                    self.put_one(attempt, found, &simulated, results)?;
                    written += 1;
                }
                Err(error) => failures.push((&attempt.id, error)),
            }
        }
        let mut failures = failures.into_iter();
        // Where there is no model the first failure is the answer.
        let answer = if written == 0 { failures.next() } else { None };
        for (id, error) in failures {
            results.out.notes().warning(format!("{id}: {error}"));
        }
        match answer.map(|(_, error)| error) {
            // Nothing is passed on, but what was found is written: it is a result.
            Some(error @ (IdentifyError::Diverged { .. } | IdentifyError::Misses { .. })) => {
                Ok(Outcome::NoAcceptableResult(error.to_string()))
            }
            Some(error) => Err(error).refuse_with_hint(self.hint),
            None => Ok(Outcome::Done),
        }
    }

    fn put_one(
        &self,
        attempt: &Attempt<'_>,
        mut found: Found,
        simulated: &[Vec<f64>],
        results: &mut Results<'_>,
    ) -> anyhow::Result<()> {
        let Self { method, settings, beyond, record, data, whole, .. } = self;
        attempt.remark.iter().for_each(|remark| found.notes.info(remark));
        if beyond.delay > 0 {
            found.notes.info(format!("the input acts {} samples late; the model itself has no delay", beyond.delay));
        }
        let chosen = found.chosen;
        let refit = |y: &[Vec<f64>]| {
            let again = IoData::new(data.inputs().to_vec(), y.to_vec(), data.sample_time_s()).ok()?;
            Some((attempt.identify)(&again, chosen).ok()?.model)
        };
        let task = Task {
            id: &attempt.id,
            method,
            order: attempt.order,
            record,
            hold: &beyond.hold,
            data,
            whole,
            bootstrap: settings.bootstrap.as_ref(),
            refit: &refit,
        };
        put(&task, &found, simulated, results)
    }
}
