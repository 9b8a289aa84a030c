//! Temporary.
use crumple_artifact::Artifact;
use crumple_artifact::records::*;
use crumple_lumped::{Model, ModelKind};
use crumple_parameter_solve::*;
use crumple_signal::Displacement;
fn main() {
    let dir = std::env::args().nth(1).unwrap();
    let open = |n: &str| Artifact::open(std::path::Path::new(&format!("{dir}/{n}.mcap"))).unwrap();
    let (a2, a3, a5) = (open("2"), open("3"), open("5"));
    let events: EventsV1 = a3.record("/events").unwrap().unwrap();
    let filter: Option<ChannelFilterV1> = a2.record(&format!("/filter/{}", events.channel)).unwrap();
    let acc = a2.waves().get(&events.channel).unwrap();
    let acc = acc.signal::<crumple_signal::Acceleration>().unwrap();
    let x = a3.waves().get(&format!("{}/displacement", events.channel)).unwrap().signal::<Displacement>().unwrap();
    let filter = filter.filter(|f| f.coefficients.len() == 5).map(|f| TwoPassFilter {
        coefficients: f.coefficients.clone().try_into().unwrap(), samples_added: f.samples_added as usize });
    let m = Measurement { dt_s: acc.dt_s(), first_s: acc.t0_s() - events.time_zero_s, samples: acc.len(), filter,
        from_contact: events.start.as_deref() == Some("time-zero"), rule: IntegrationRule::Trapezoid };
    println!("{m:?}");
    for raw in a5.records() {
        if !raw.topic.starts_with("/parameters/") { continue; }
        let c: CandidateV1 = a5.decode(raw).unwrap();
        let kind: ModelKind = c.model.parse().unwrap();
        let mut model = Model::from_parameters(kind, &c.parameters).unwrap();
        if dir.contains("elastoplastic-none") || dir.contains("elastoplastic-60") { if let Model::Elastoplastic(e) = &mut model { e.release = false; } }
        let v0 = events.impact_speed_m_per_s.unwrap();
        let t_m = events.time_of_dynamic_crush_s.unwrap();
        let ep = kind == ModelKind::Elastoplastic;
        let to = if ep { events.time_of_rebound_s.unwrap() } else { t_m };
        let o = Observed::new(&x, events.time_zero_s, m, v0, (0.0, to), 250).unwrap();
        let before = o.misfit(&model).unwrap();
        let rms = |r: &[f64]| (r.iter().map(|x| x * x).sum::<f64>() / r.len() as f64).sqrt();
        let free = free_parameters(&model, v0, events.dynamic_crush_m.unwrap(), ep);
        let t = std::time::Instant::now();
        let r = refine(&model, &free, &o).unwrap();
        println!("{} rms before {:.3e} after {:.3e} {:?} it {} ev {} {:?}", raw.topic, rms(&before), r.rmse_m(), r.stop_reason, r.iterations, r.evaluations, t.elapsed());
        for (p, b) in r.free.iter().zip(&r.on_bound) { print!("  {} {:.9} (was {:.4}){}", p.name, p.value, c.parameters[p.name], if *b {" BOUND"} else {""}); }
        println!();
    }
}
