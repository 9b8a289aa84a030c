//! Runs one discrete method: every model asked for is identified, simulated and written.

use crumple_signal::{About, Weight};
use crumple_stage::{Outcome, RefuseExt};
use crumple_sysid::{IdentifyError, IoData};

use crate::stage::options::input_output::InputOutputSettings;
use crate::stage::options::settings::Settings;
use crate::stage::records::acceptance::simulate_accepted;
use crate::stage::records::discrete_model::{DiscreteModel, RecordChoices};
use crate::stage::records::results::Results;
use crate::stage::records::state_space::{DiscreteTask, put_discrete_model};
use crate::stage::waves::Source;
use crate::stage::waves::{Record, record};

/// A method and the waveforms that it works on.
pub struct MethodRun<'a> {
    /// Name of the method.
    pub method: &'a str,
    /// Settings of the stage.
    pub settings: &'a Settings,
    /// Settings of the methods other than `era`.
    pub input_output: &'a InputOutputSettings,
    /// The waveforms.
    pub record: Record,
    /// The window, inputs delayed.
    pub data: IoData,
    /// The same with what is kept after it.
    pub whole: IoData,
    /// What a user can do where no request leads to a model.
    pub hint: &'static str,
}

/// Identifies a model from a record.
pub type Estimator<'a> = Box<dyn Fn(&IoData, RecordChoices) -> Result<DiscreteModel, IdentifyError> + Sync + 'a>;

/// One model that is asked for.
pub struct ModelRequest<'a> {
    /// Its id.
    pub id: String,
    /// States asked for.
    pub order: usize,
    /// Identifies the model from a record, the measured one or a replicate of it, with the choices already made.
    pub identify: Estimator<'a>,
    /// A note on why this model is asked for.
    pub remark: Option<String>,
}

impl<'a> MethodRun<'a> {
    /// Reads the waveforms.
    pub fn new(
        method: &'a str,
        source: Source<'a>,
        input_output: &'a InputOutputSettings,
        hint: &'static str,
    ) -> anyhow::Result<Self> {
        let record = record(source, input_output)?;
        let (data, whole) = (record.data.delayed(input_output.delay), record.whole.delayed(input_output.delay));
        Ok(Self { method, settings: source.settings, input_output, record, data, whole, hint })
    }

    /// Writes one model per request. A request that cannot be met is a warning; where none can, the first reason is
    /// returned, as an error or as a diagnosis.
    pub fn put_all(&self, requests: &[ModelRequest<'_>], results: &mut Results<'_>) -> anyhow::Result<Outcome> {
        let mut written = 0;
        let mut failures = Vec::new();
        for request in requests {
            let identified = (request.identify)(&self.data, RecordChoices::default());
            match identified.and_then(|model| simulate_accepted(model, &self.data)) {
                Ok((simulated, model)) => {
                    self.put_model(request, model, &simulated, results)?;
                    written += 1;
                }
                Err(error) => failures.push((&request.id, error)),
            }
        }
        let mut failures = failures.into_iter();
        // Where there is no model the first failure is the answer.
        let answer = if written == 0 { failures.next() } else { None };
        for (id, error) in failures {
            let about = About::Method(self.method.to_owned());
            results.out.notes().concern(about, Weight::Slight, format!("{id} gave no model: {error}"));
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

    fn put_model(
        &self,
        request: &ModelRequest<'_>,
        mut model: DiscreteModel,
        simulated: &[Vec<f64>],
        results: &mut Results<'_>,
    ) -> anyhow::Result<()> {
        let Self { method, settings, input_output, record, data, whole, .. } = self;
        request.remark.iter().for_each(|remark| model.notes.info(remark));
        if input_output.delay > 0 {
            model
                .notes
                .info(format!("the input acts {} samples late; the model itself has no delay", input_output.delay));
        }
        let choices = model.choices;
        let refit = |y: &[Vec<f64>]| {
            let again = IoData::new(data.inputs().to_vec(), y.to_vec(), data.sample_time_s()).ok()?;
            Some((request.identify)(&again, choices).ok()?.state_space)
        };
        let task = DiscreteTask {
            id: &request.id,
            method,
            order: request.order,
            record,
            hold: &input_output.hold,
            data,
            whole,
            bootstrap: settings.bootstrap.as_ref(),
            refit: &refit,
        };
        put_discrete_model(&task, &model, simulated, results)
    }
}
