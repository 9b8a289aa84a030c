//! The poles of an identified model as records: its modes, and the poles that are none.

use crumple_numerics::lti::{Complex, Mode};
use crumple_stage::Output;
use crumple_stage::records::{EvidenceV1, ModeV1, ModesV2, OtherPoleKindV1, OtherPoleV1};
use crumple_sysid::{PoleKind, PoleRecord, pole_kinds};

/// All poles of a model that was identified from a record, one entry each, and what each is.
pub struct Poles {
    entries: Vec<ModeV1>,
    kinds: Vec<PoleKind>,
}

impl Poles {
    /// Of entries with whatever the method knows of each.
    pub fn new(entries: Vec<ModeV1>, record: PoleRecord) -> Self {
        let poles: Vec<Complex> = entries.iter().map(|pole| Complex::new(pole.re_per_s, pole.im_rad_per_s)).collect();
        let kinds = pole_kinds(&poles, record);
        Self { entries, kinds }
    }

    /// Of continuous poles, with their discrete counterparts where the model is sampled.
    pub fn of(poles: impl Iterator<Item = (Mode, Option<Complex>)>, record: PoleRecord) -> Self {
        Self::new(poles.map(|(mode, discrete)| entry(&mode, discrete)).collect(), record)
    }

    /// Whether each is a mode, in their order.
    pub fn are_modes(&self) -> impl Iterator<Item = bool> {
        self.kinds.iter().map(|kind| *kind == PoleKind::Mode)
    }

    /// The modes alone.
    pub fn modes(&self) -> impl Iterator<Item = &ModeV1> {
        self.entries.iter().zip(self.are_modes()).filter_map(|(entry, is_mode)| is_mode.then_some(entry))
    }

    /// Writes them as `/modes/<id>`.
    pub fn put(&self, id: &str, out: &mut Output) -> anyhow::Result<()> {
        let others = self.entries.iter().zip(&self.kinds).filter_map(|(pole, kind)| {
            let kind = match kind {
                PoleKind::Mode => return None,
                PoleKind::Integrator => OtherPoleKindV1::Integrator,
                PoleKind::BeyondNyquist => OtherPoleKindV1::BeyondNyquist,
            };
            let ModeV1 { re_per_s, im_rad_per_s, discrete_re, discrete_im, .. } = *pole;
            Some(OtherPoleV1 { re_per_s, im_rad_per_s, discrete_re, discrete_im, kind })
        });
        out.put(
            &format!("/modes/{id}"),
            &ModesV2 { modes: self.modes().cloned().collect(), other_poles: others.collect() },
        )
    }

    /// Leaves deviations and spreads of the modes alone where the evidence has one of every pole.
    pub fn keep_those_of_modes(&self, evidence: &mut [EvidenceV1]) {
        for EvidenceV1 { frequency_deviations, damping_deviations, frequency_spreads, damping_spreads, .. } in evidence
        {
            self.keep(frequency_deviations);
            self.keep(damping_deviations);
            self.keep(frequency_spreads);
            self.keep(damping_spreads);
        }
    }

    fn keep<T>(&self, of_poles: &mut Vec<T>) {
        if of_poles.len() == self.kinds.len() {
            let mut are_modes = self.are_modes();
            of_poles.retain(|_| are_modes.next().unwrap_or(true));
        }
    }
}

/// The entry of a pole of which no more is known.
pub fn entry(mode: &Mode, discrete: Option<Complex>) -> ModeV1 {
    ModeV1 {
        // Adding zero takes the sign from a zero.
        re_per_s: mode.pole.re + 0.0,
        im_rad_per_s: mode.pole.im + 0.0,
        natural_frequency_rad_per_s: mode.natural_frequency_rad_per_s,
        damping_ratio: mode.damping_ratio,
        modal_amplitude_coherence: None,
        mode_singular_value: None,
        discrete_re: discrete.map(|z| z.re),
        discrete_im: discrete.map(|z| z.im),
    }
}
