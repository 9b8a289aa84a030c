//! Settings of the methods that realise a model from Markov parameters, beyond those of plain ERA.

use crumple_stage::Usage;
use crumple_sysid::{Kernel, ShiftForm};
use serde::Serialize;

use crate::stage::options::flags::{Options, unknown};
use crate::stage::options::input_output::waveforms;

/// Criteria for the number of lags.
const CRITERIA: [&str; 2] = ["aicc", "bic"];

/// What `era-dc`, `okid` and `fir` need, and what is unusual about `era`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HankelSettings {
    /// Waveforms that `era` and `era-dc` take together; empty: the one of `--channel`, else the pulse.
    pub channels: Vec<String>,
    /// Form of the shift equation.
    pub shift_form: String,
    /// Whether the Hankel matrix has twice as many rows and columns as the model states.
    pub twice_the_order: bool,
    /// Lag of the first correlation.
    pub offset: usize,
    /// Correlations stacked beyond the first.
    pub lag_blocks: usize,
    /// Lags of the observer, if given.
    pub lags: Option<usize>,
    /// Criterion for their number otherwise.
    pub lag_criterion: String,
    /// Whether the observer gain takes part in the choice of states.
    pub okid_states: String,
    /// Taps of the impulse response.
    pub taps: usize,
    /// What is expected of it.
    pub kernel: String,
    /// Share of the peak below which the contact force has ended; 0: from the time of separation on.
    pub free_decay_share: Option<f64>,
}

impl HankelSettings {
    /// `None` for plain ERA of one channel, which has no need of it. Errors: unknown names, a share that is none.
    pub fn resolve(options: &Options) -> Result<Option<Self>, Usage> {
        let choice = |name: &str, given: &Option<String>, choices: &[&str]| match given {
            None => Ok(choices[0].to_owned()),
            Some(text) if choices.contains(&text.as_str()) => Ok(text.clone()),
            Some(text) => Err(unknown(name, text, choices)),
        };
        let size = |n: Option<u32>, default: usize| n.map_or(default, |n| n as usize);
        if options.lags == Some(0) || options.taps == Some(0) {
            return Err(Usage::new("lags and taps are counts of samples: a positive number is needed"));
        }
        let channels = channels(options)?;
        let asked = !channels.is_empty() || options.shift_form.is_some() || options.hankel_size.is_some();
        let others = ["era-dc", "okid", "fir"];
        let method = options.methods.iter().any(|m| others.contains(&m.as_str()));
        if !asked && !method && options.free_decay.is_none() {
            return Ok(None);
        }
        Ok(Some(Self {
            channels,
            shift_form: choice(
                "form of the shift equation",
                &options.shift_form,
                &ShiftForm::ALL.map(ShiftForm::name),
            )?,
            twice_the_order: choice("size of the Hankel matrix", &options.hankel_size, &["half", "twice-order"])?
                == "twice-order",
            offset: size(options.offset, 0),
            lag_blocks: size(options.lag_blocks, 10),
            lags: options.lags.map(|n| n as usize),
            lag_criterion: choice("criterion", &options.lag_criterion, &CRITERIA)?,
            okid_states: choice("choice of states", &options.okid_states, &["system", "joint"])?,
            taps: size(options.taps, 100),
            kernel: choice("kernel", &options.kernel, &Kernel::ALL.map(Kernel::name))?,
            free_decay_share: options.free_decay.as_deref().map(share).transpose()?,
        }))
    }

    /// The form as the library knows it.
    pub fn form(&self) -> ShiftForm {
        ShiftForm::ALL.into_iter().find(|form| form.name() == self.shift_form).unwrap_or_default()
    }

    /// The kernel as the library knows it.
    pub fn kernel(&self) -> Kernel {
        Kernel::ALL.into_iter().find(|kernel| kernel.name() == self.kernel).unwrap_or_default()
    }
}

/// What ERA takes together: the channels, or the outputs where neither they nor one channel are named.
fn channels(options: &Options) -> Result<Vec<String>, Usage> {
    let named = &options.channels;
    if let Some(twice) = named.iter().enumerate().find(|(i, c)| named[..*i].contains(c)) {
        return Err(Usage::new(format!("channel {} is named twice", twice.1)));
    }
    if !named.is_empty() && options.channel.is_some() {
        return Err(Usage::new("channel and channels are both given").hint("name all of them with --channels"));
    }
    let free = options.methods.is_empty() || options.methods.iter().any(|m| m == "era" || m == "era-dc");
    // The paper's procedure is one of the pulse, whatever its curve fit takes.
    let pulse = options.channel.is_some() || options.paper.as_deref() == Some("era");
    if free && named.is_empty() && !pulse {
        return waveforms("output", &options.output_channel, &options.output_channels);
    }
    Ok(named.clone())
}

/// `5%` as 0.05, `separation` as 0.
fn share(text: &str) -> Result<f64, Usage> {
    if text == "separation" {
        return Ok(0.0);
    }
    let percent = text.strip_suffix('%').and_then(|number| number.trim().parse::<f64>().ok());
    match percent {
        Some(percent) if percent > 0.0 && percent < 100.0 => Ok(percent / 100.0),
        _ => Err(Usage::new(format!("free decay {text:?} is neither \"separation\" nor a share of the peak"))
            .hint("write for instance --free-decay 5%")),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a failed unwrap is a failed test")]

    use super::*;

    #[test]
    fn plain_era_has_no_need_of_it_and_names_are_checked() {
        assert_eq!(HankelSettings::resolve(&Options::default()).unwrap(), None);
        let options = Options { free_decay: Some("5%".to_owned()), ..Options::default() };
        assert_eq!(HankelSettings::resolve(&options).unwrap().unwrap().free_decay_share, Some(0.05));
        let options = Options { free_decay: Some("5".to_owned()), ..Options::default() };
        assert!(HankelSettings::resolve(&options).unwrap_err().to_string().contains("neither"));
        let options = Options { shift_form: Some("total-least-square".to_owned()), ..Options::default() };
        let error = format!("{:?}", HankelSettings::resolve(&options).unwrap_err());
        assert!(error.contains("did you mean \\\"total-least-squares\\\""), "{error}");
        let options = Options { channels: vec!["a".to_owned(), "a".to_owned()], ..Options::default() };
        assert_eq!(HankelSettings::resolve(&options).unwrap_err().to_string(), "channel a is named twice");
    }
}
