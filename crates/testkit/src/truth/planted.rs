//! Each kind of check sees a wrong value that is planted into a run that says what is true.

use std::collections::BTreeMap;

use crumple_signal::Sampled;
use serde_json::{Value, json};

use crate::records::fixture::fixture_models;
use crate::truth::found::Found;
use crate::truth::known::{Known, Maker};
use crate::truth::net::Net;
use crate::truth::run::Made;
use crate::truth::{codes, surfaces, values};

/// A run of the elastoplastic fixture that says what is true.
fn made() -> Made {
    let (_, model, mass, speed) = fixture_models().into_iter().find(|own| own.0 == "elastoplastic").unwrap();
    let known = Known::vehicle(Maker::Lumped(model), mass, speed);
    let [own, slow] = [speed, 0.7 * speed].map(|speed| known.impact(speed, mass).unwrap());
    let (crush, slow_crush) = (own.crush_m, slow.crush_m);
    let events = json!({"channel": "a", "impact_speed_m_per_s": speed, "dynamic_crush_m": crush,
        "time_of_dynamic_crush_s": own.time_s, "coefficient_of_restitution": own.restitution});
    let candidate = json!({"id": "fd/1", "model": "force-deflection", "physical": true, "equivalent_to": null,
        "parameters": {"mass_kg": mass, "knot1_m": crush, "knot1_n": mass * speed * speed / crush},
        "certainties": {"parameters": 1, "determined": 1, "order_of_magnitude": [], "open": []},
        "uncertainty": {"interval_low": {"knot1_n": 1e5}, "interval_high": {"knot1_n": 5e5}},
        "simulation": {"fit_percent": 99.5, "dynamic_crush_m": crush, "time_of_dynamic_crush_s": own.time_s,
            "coefficient_of_restitution": own.restitution}});
    let prediction = json!({"candidate": "fd/1", "recommended": true, "asked": false,
        "impact_speed_m_per_s": 0.7 * speed,
        "mass_kg": mass, "partner": null, "extrapolates": false, "dynamic_crush_m": slow_crush,
        "energy": {"kinetic_at_impact_j": 0.5 * mass * (0.7 * speed).powi(2)},
        "intervals": [{"name": "dynamic_crush_m", "low": 0.96 * slow_crush, "high": 1.04 * slow_crush}]});
    let verdict = json!({"status": "usable", "record": "sound", "record_about": null, "parameters": 1, "determined": 1,
        "status_reason": {"kind": "good-to", "good_to_percent": 4.0, "prediction": 0, "asked": false},
        "good_for": [{"kind": "measured-quantities"}, {"kind": "crush-at-the-tested-speed"}, {"kind": "forces"}],
        "numbers": [{"at": "/events/dynamic_crush_m", "value": crush, "shown": format!("{:.0} mm", 1e3 * crush)}]});
    let summary = json!({"verdict": verdict, "events": events, "recommended": "fd/1", "best": "fd/1", "closest": "fd/1",
        "simplest": "fd/1", "candidates": [candidate], "predictions": [prediction], "remarks": [], "impacts": [{}],
        "test": {"mass_kg": mass, "impact_speed_m_per_s": speed, "channel": "a", "sample_rate_hz": 1000.0},
        "key_numbers": [{"name": "dynamic_crush", "value": crush, "low": 0.98 * crush, "high": 1.02 * crush,
            "unit": "m"}],
        "metrics": {"delta_v": {"value": speed * (1.0 + own.restitution), "unit": "m/s"}},
        "models": [{"id": "era-2", "poles": [], "modes": [{"re_per_s": -3.0, "im_rad_per_s": 4.0,
            "natural_frequency_rad_per_s": 5.0}]}]});
    let pulse = Sampled::new(-0.01, 1e-3, vec![0.0; 50]).unwrap();
    Made {
        name: "planted".to_owned(),
        known,
        question: None,
        code: 0,
        summary,
        surfaces: vec![("console", format!("dynamic crush  {:.0} mm", 1e3 * crush))],
        raw: BTreeMap::from([("a".to_owned(), pulse)]),
        waves: BTreeMap::new(),
        records: BTreeMap::new(),
    }
}

/// The rules that a run contradicts.
fn contradicted(made: &Made) -> Vec<&'static str> {
    let all = values::check(made).into_iter().chain(surfaces::check(made));
    all.filter(|(_, found)| !found.wrong.is_empty()).map(|(rule, _)| rule).collect()
}

#[test]
fn each_rule_sees_what_is_planted() {
    assert_eq!(contradicted(&made()), Vec::<&str>::new());
    for (rule, at, wrong) in [
        ("mass and speed of the test", "/test/mass_kg", json!(1401.0)),
        ("events", "/events/dynamic_crush_m", json!(0.6)),
        ("events", "/metrics/delta_v/value", json!(15.0)),
        ("key numbers", "/key_numbers/0/low", json!(0.75)),
        ("record", "/verdict/record", json!("wrong")),
        ("record", "/verdict/record_about", json!("pulse")),
        ("status", "/candidates/0/simulation/dynamic_crush_m", json!(0.6)),
        ("status", "/predictions/0/dynamic_crush_m", json!(0.6)),
        ("status", "/verdict/status", json!("do-not-use")),
        ("reason of the status", "/verdict/status_reason/good_to_percent", json!(3.0)),
        ("reason of the status", "/verdict/status_reason", json!({"kind": "no-mass"})),
        ("reason of the status", "/verdict/status_reason", json!({"kind": "unheard-of"})),
        ("good for", "/verdict/good_for/0/kind", json!("identified-modes")),
        ("good for", "/verdict/good_for/2", json!({"kind": "parameters", "names": ["knot1_n"]})),
        ("good for", "/candidates/0/parameters/knot1_n", json!(3e5)),
        ("predictions", "/predictions/0/energy/kinetic_at_impact_j", json!(1e5)),
        ("predictions", "/predictions/0/intervals/0/high", json!(0.1)),
        ("recommended model", "/best", json!("fd/2")),
        ("recommended model", "/candidates/0/simulation/time_of_dynamic_crush_s", json!(0.08)),
        ("recommended model", "/candidates/0/simulation/fit_percent", json!(80.0)),
        ("candidates", "/candidates/0/certainties/open", json!(["knot1_n"])),
        ("candidates", "/candidates/0/uncertainty/interval_low/knot1_n", json!(1e4)),
        ("identified models", "/models/0/modes/0/natural_frequency_rad_per_s", json!(6.0)),
        ("identified models", "/models/0/poles", json!([{"re_per_s": 5.0}])),
        ("numbers of the verdict", "/verdict/numbers/0/shown", json!("600 mm")),
    ] {
        let mut made = made();
        *made.summary.pointer_mut(at).unwrap() = wrong.clone();
        assert!(contradicted(&made).contains(&rule), "{wrong} at {at}: {:?}", contradicted(&made));
    }
    let mut faulty = made();
    faulty.known.is_sound = false;
    faulty.known.remedy = Some("--unit g");
    for rule in ["record", "remedy", "status", "good for"] {
        assert!(contradicted(&faulty).contains(&rule), "{rule}");
    }
    let mut shown = made();
    shown.surfaces = vec![("console", "dynamic crush  600 mm".to_owned())];
    assert_eq!(contradicted(&shown), ["console"]);
    let mut asked = made();
    asked.question = Some(crate::truth::cases::Question { speed_m_per_s: Some(9.0), ..Default::default() });
    assert!(contradicted(&asked).contains(&"question"));
}

#[test]
fn each_claim_of_a_remark_sees_what_is_planted() {
    let made = made();
    let crush = made.number("/events/dynamic_crush_m").unwrap();
    let wrong = |code: &str, values: Value| {
        let mut found = Found::default();
        codes::check(&made, &json!({"code": code, "values": values}), &mut found);
        assert!(found.checked > 0, "{code}");
        !found.wrong.is_empty()
    };
    for (code, right, planted) in [
        ("CR808", None, json!({"crush_m": 1.01 * crush})),
        ("CR216", Some(json!({"rate_hz": 5, "class": 1, "ratio": 5})), json!({"rate_hz": 5, "class": 1, "ratio": 6})),
        ("CR531", Some(json!({"samples": 3, "needed": 5})), json!({"samples": 6, "needed": 5})),
        ("CR134", Some(json!({"samples_before": 10})), json!({"samples_before": 12})),
        ("CR121", Some(json!({"channel": "a"})), json!({"channel": "b"})),
        ("CR107", None, json!({})),
        ("CR801", None, json!({})),
        ("CR123", None, json!({})),
        ("CR156", None, json!({})),
        ("CR142", None, json!({})),
        ("CR535", None, json!({})),
    ] {
        assert!(right.is_none_or(|right| !wrong(code, right)), "{code} is right");
        assert!(wrong(code, planted), "{code} is wrong");
    }
    let mut net = Net::default();
    net.read(&made);
    assert!(net.holds(), "{}", net.table());
    let remark = json!({"code": "CR999", "stage": "report", "weight": 1, "text": "7.5 mm", "values": {}});
    let planted = Made { summary: json!({"remarks": [remark, {"code": "CR112"}]}), ..self::made() };
    net.read(&planted);
    let because: Vec<&str> = net.contradictions.iter().filter(|c| c[0] == "CR999").map(|c| &*c[2]).collect();
    assert!(net.contradictions.iter().any(|c| c[0] == "CR112" && c[2].starts_with("raised without an option")));
    assert_eq!(because, ["no value is 7.5: \"7.5 mm\"", "nothing explains this code"]);
}
