//! A parameter of a candidate as people read it: symbol, value and interval in the unit of the page.

use std::collections::BTreeMap;

use crumple_artifact::records::CandidateV1;
use crumple_lumped::{ParameterKind, parameter_kind};

use crate::drawing::numbers::Rounding;
use crate::findings::text::parameter;
use crate::words;

/// A parameter with the digits that its interval supports.
#[derive(Debug, Clone, PartialEq)]
pub struct ShownParameter {
    /// `k`, `c1`.
    pub symbol: String,
    /// Its value.
    pub value: String,
    /// Its standard deviation.
    pub deviation: Option<String>,
    /// Low and high end of its interval, an open one `None`; `None`: nobody asked the record for it.
    pub ends: Option<[Option<String>; 2]>,
    /// Unit of all of them.
    pub unit: &'static str,
}

impl ShownParameter {
    /// Of a candidate that has the parameter. Without an interval the standard deviation rounds the value; without
    /// either it has four digits, a mass whole kilograms.
    pub fn of(record: &CandidateV1, name: &str) -> Self {
        let in_unit = |si: f64| parameter(&record.model, name, si).1;
        let (symbol, value, unit) =
            parameter(&record.model, name, record.parameters.get(name).copied().unwrap_or(f64::NAN));
        let known = record.uncertainty.as_ref();
        let end = |ends: &BTreeMap<String, Option<f64>>| ends.get(name).map(|end| end.map(in_unit));
        let ends = known.and_then(|known| Some([end(&known.interval_low)?, end(&known.interval_high)?]));
        let deviation = known.and_then(|known| known.standard_deviation.get(name)).map(|si| in_unit(*si));
        let by_ends = ends.and_then(|[low, high]| Rounding::of_ends(low, high));
        let by_deviation =
            || deviation.and_then(|deviation| Rounding::of_interval(value - deviation, value + deviation));
        let rounding = by_ends.or_else(by_deviation).unwrap_or_else(|| without_interval(&record.model, name, value));
        Self {
            symbol,
            value: rounding.show(value),
            deviation: deviation.map(|deviation| rounding.show(deviation)),
            ends: ends.map(|ends| ends.map(|end| end.map(|end| rounding.show(end)))),
            unit,
        }
    }

    /// `310 to 330`; an end that the record does not bound is "open".
    pub fn interval(&self) -> Option<String> {
        let [low, high] = self.ends.as_ref()?;
        let end = |end: &Option<String>| end.clone().unwrap_or_else(|| "open".to_owned());
        Some(words::between(&end(low), &end(high)))
    }
}

/// How a parameter without an interval is rounded, in the unit of the page.
pub(crate) fn without_interval(model: &str, name: &str, value: f64) -> Rounding {
    match parameter_kind(model, name) {
        Some(ParameterKind::Mass) => Rounding::to_integers(value),
        _ => Rounding::WITHOUT_INTERVAL,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crumple_artifact::records::UncertaintyV1;

    const UNLOADING: &str = "unloading_stiffness_n_per_m";

    fn record(uncertainty: UncertaintyV1) -> CandidateV1 {
        let parameters = BTreeMap::from([(UNLOADING.to_owned(), 47_782.4e3), ("mass_kg".to_owned(), 15_875.0)]);
        CandidateV1 {
            model: "elastoplastic".to_owned(),
            parameters,
            uncertainty: Some(uncertainty),
            ..CandidateV1::default()
        }
    }

    fn with_ends(low: Option<f64>, high: Option<f64>) -> ShownParameter {
        let ends = |end| BTreeMap::from([(UNLOADING.to_owned(), end)]);
        let (interval_low, interval_high) = (ends(low), ends(high));
        ShownParameter::of(
            &record(UncertaintyV1 { interval_low, interval_high, ..UncertaintyV1::default() }),
            UNLOADING,
        )
    }

    #[test]
    fn a_value_ends_where_its_interval_does() {
        let shown = with_ends(Some(22_656e3), Some(104_254e3));
        assert_eq!((&*shown.symbol, &*shown.value, shown.unit), ("k unloading", "48000", "kN/m"));
        assert_eq!(shown.interval().as_deref(), Some("23000 to 104000"));
        let open = with_ends(Some(22_656e3), None);
        assert_eq!((&*open.value, open.interval().as_deref()), ("48000", Some("23000 to open")));
    }

    #[test]
    fn a_standard_deviation_rounds_where_there_is_no_interval() {
        let standard_deviation = BTreeMap::from([(UNLOADING.to_owned(), 1234e3)]);
        let record = record(UncertaintyV1 { standard_deviation, ..UncertaintyV1::default() });
        let shown = ShownParameter::of(&record, UNLOADING);
        assert_eq!((&*shown.value, shown.deviation.as_deref()), ("47800", Some("1200")));
        assert_eq!(shown.interval(), None);
        assert_eq!(ShownParameter::of(&record, "mass_kg").value, "15875");
    }
}
