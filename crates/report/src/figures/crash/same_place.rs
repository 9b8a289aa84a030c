//! What the sensors at the place of the pulse's say, together.

use crate::drawing::numbers::MILLI;
use crate::findings::Run;
use crumple_artifact::records::MetricV1;
use crumple_signal::Sampled;

/// Lowest and highest of the sensors that the metrics take for one place, the pulse among them.
pub struct Envelope<'a> {
    /// Their channels.
    pub channels: Vec<&'a str>,
    velocities: Vec<&'a Sampled>,
    displacements: Vec<&'a Sampled>,
}

impl<'a> Envelope<'a> {
    /// Of the channels whose metrics have a range with the pulse's (`93+94`); `None` where no second one was
    /// integrated.
    pub fn of_run(run: &'a Run) -> Option<Self> {
        let pulse = run.channel_id()?;
        let ranges = run.metrics.iter().filter(|metric| metric.low.is_some() && metric.high.is_some());
        let channels = ranges.map(MetricV1::channels).find(|ids| ids.len() > 1 && ids.contains(&pulse))?;
        let others: Vec<_> =
            run.other_sensors.iter().filter(|sensor| channels.contains(&sensor.channel.as_str())).collect();
        if others.is_empty() {
            return None;
        }
        Some(Self {
            channels: [pulse].into_iter().chain(others.iter().map(|sensor| sensor.channel.as_str())).collect(),
            velocities: run.measured.velocity.iter().chain(others.iter().filter_map(|s| s.velocity.as_ref())).collect(),
            displacements: run.measured.displacement.iter().chain(others.iter().map(|s| &s.displacement)).collect(),
        })
    }

    /// Time in ms, lowest and highest times `factor`, of the acceleration (0), velocity (1) or displacement (2), where
    /// two sensors have it. The acceleration is the difference quotient of the velocity.
    pub fn edges(&self, what: usize, factor: f64) -> Option<Vec<[f64; 3]>> {
        let signals = if what == 2 { &self.displacements } else { &self.velocities };
        let (first, rest) = signals.split_first().filter(|(_, rest)| !rest.is_empty())?;
        let value = |signal: &Sampled, t: f64| {
            let dt = first.dt_s();
            if what == 0 { Some((signal.at(t + dt)? - signal.at(t - dt)?) / (2.0 * dt)) } else { signal.at(t) }
        };
        let at = |k: usize| {
            let t = first.time_s(k);
            let own = factor * value(first, t)?;
            let reach = rest.iter().filter_map(|signal| Some(factor * value(signal, t)?));
            let (low, high) = reach.fold((own, own), |(low, high), x| (low.min(x), high.max(x)));
            Some([MILLI * t, low, high])
        };
        Some((0..first.len()).filter_map(at).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::findings::SensorMotion;

    #[test]
    fn the_envelope_holds_the_sensors_that_share_a_range_with_the_pulse() {
        let ramp =
            |slope: f64| Sampled::new(0.0, 0.01, (0..10).map(|k| slope * 0.01 * f64::from(k)).collect()).unwrap();
        let mut run = Run::default();
        run.test.channels = ["1", "2", "3"]
            .map(|id| crumple_signal::Channel::new(id, crumple_signal::QuantityKind::Acceleration))
            .into();
        run.test.pulse = Some("1".into());
        (run.measured.velocity, run.measured.displacement) = (Some(ramp(-10.0)), Some(ramp(5.0)));
        run.other_sensors = [("2", -12.0, 4.0), ("3", -90.0, 90.0)]
            .map(|(id, v, x)| SensorMotion { channel: id.into(), velocity: Some(ramp(v)), displacement: ramp(x) })
            .into();
        assert!(Envelope::of_run(&run).is_none());
        let range = MetricV1 { channel: "1+2".into(), low: Some(0.0), high: Some(1.0), ..MetricV1::default() };
        run.metrics.push(range);
        let envelope = Envelope::of_run(&run).unwrap();
        assert_eq!(envelope.channels, ["1", "2"]);
        let displacement = envelope.edges(2, 1e3).unwrap();
        assert!((displacement[9][1] - 360.0).abs() < 1e-9 && (displacement[9][2] - 450.0).abs() < 1e-9);
        // Constant slopes are met exactly; the ends have no neighbour.
        let acceleration = envelope.edges(0, 1.0).unwrap();
        assert_eq!(acceleration.len(), 8);
        assert!((acceleration[0][1] + 12.0).abs() < 1e-9 && (acceleration[0][2] + 10.0).abs() < 1e-9);
    }
}
