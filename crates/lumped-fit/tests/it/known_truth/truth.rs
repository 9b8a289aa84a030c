//! A `truth.json` as the tests need it: the model, how it was sampled, and what is expected of it.

use crumple_lumped::{DoubleSpringMassDamper, Elastoplastic, Kelvin, Maxwell, Model, Nonlinear1, Nonlinear2};
use crumple_testkit::KnownTruth;
use serde_json::Value;

/// Everything that a test takes from a record.
#[derive(Debug, Clone)]
pub struct Truth {
    pub record: String,
    pub dt_s: f64,
    /// First sample, s after contact.
    pub first_s: f64,
    /// Samples from contact on, and before it.
    pub samples: usize,
    pub before: usize,
    pub model: Model,
    pub v0: f64,
    /// Scale of the displacement: the dynamic crush, or where the model never stops the largest displacement of the
    /// record.
    pub crush: f64,
    /// None where the model never stops.
    pub t_m: Option<f64>,
    /// None where the model has no rebound.
    pub t_rebound: Option<f64>,
    pub restitution: Option<f64>,
    /// Another set of parameters that gives the same record, as the file has it.
    pub stated_dual: Option<[f64; 4]>,
}

impl Truth {
    /// Reads the file of a record. What is missing or not known is an error with the record's name.
    pub fn read(known: &KnownTruth) -> Result<Self, String> {
        Self::of(known).map_err(|fault| format!("{}: {fault}", known.name))
    }

    fn of(known: &KnownTruth) -> Result<Self, String> {
        let value = &known.truth;
        let v0 = number(value, "v0_m_s")?;
        let expected = &value["expected"];
        let event = |key: &str| expected[key].as_f64();
        let sampling = &value["sampling"];
        let count = |key: &str| sampling[key].as_u64().map(|n| n as usize).ok_or(format!("sampling.{key} is missing"));
        let before = count("trigger_sample_index")?;
        let dt_s = 1.0 / number(sampling, "rate_hz").map_err(|fault| format!("sampling.{fault}"))?;
        let samples = count("samples")?.checked_sub(before).ok_or("sampling: contact is after the last sample")?;
        let first_s = sampling["t_first_s"].as_f64().unwrap_or(-(before as f64) * dt_s);
        let model = model(known.model(), &value["parameters"], event("C"))?;
        let crush = match event("C") {
            Some(crush) => crush,
            None => {
                let response = model.respond(v0, dt_s, samples).map_err(|error| error.to_string())?;
                response.compartment().displacement_m.iter().copied().fold(0.0, f64::max)
            }
        };
        let dual = &expected["dual_parameters"];
        let stated_dual = ["k1", "k2", "c1", "c2"].map(|key| dual[key].as_f64());
        Ok(Self {
            record: known.name.clone(),
            dt_s,
            first_s,
            samples,
            before,
            crush,
            model,
            v0,
            t_m: event("t_m"),
            t_rebound: event("t_rebound"),
            restitution: event("v_rebound").map(|v| -v / v0),
            stated_dual: match stated_dual {
                [Some(k1), Some(k2), Some(c1), Some(c2)] => Some([k1, k2, c1, c2]),
                _ => None,
            },
        })
    }

    /// Time after contact of the last sample.
    pub fn end_s(&self) -> f64 {
        (self.samples - 1) as f64 * self.dt_s
    }
}

fn number(value: &Value, key: &str) -> Result<f64, String> {
    value[key].as_f64().ok_or_else(|| format!("{key} is missing"))
}

/// The model of a file. The last knot of a nonlinear spring stands at the dynamic crush where there is one, where a fit
/// has it: the line up to there is the same, and its value at that place is what can come back.
fn model(kind: &str, p: &Value, crush: Option<f64>) -> Result<Model, String> {
    let n = |key: &str| number(p, key).map_err(|fault| format!("parameters.{fault}"));
    let list = |key: &str| -> Result<Vec<f64>, String> {
        let list = p[key].as_array().ok_or_else(|| format!("parameters.{key} is missing"))?;
        list.iter().map(|x| x.as_f64().ok_or_else(|| format!("parameters.{key} holds {x}"))).collect()
    };
    Ok(match kind {
        "kelvin" => Model::Kelvin(Kelvin { mass_kg: n("m")?, stiffness_n_per_m: n("k")?, damping_n_s_per_m: n("c")? }),
        "maxwell" => {
            Model::Maxwell(Maxwell { mass_kg: n("m")?, stiffness_n_per_m: n("k")?, damping_n_s_per_m: n("c")? })
        }
        "elastoplastic" => Model::Elastoplastic(Elastoplastic {
            mass_kg: n("m")?,
            loading_stiffness_n_per_m: n("k_E")?,
            unloading_stiffness_n_per_m: n("k_P")?,
            release: p["release"].as_bool().unwrap_or(false),
        }),
        "double" => Model::DoubleSpringMassDamper(DoubleSpringMassDamper {
            m1_kg: n("m1")?,
            m2_kg: n("m2")?,
            k1_n_per_m: n("k1")?,
            k2_n_per_m: n("k2")?,
            c1_n_s_per_m: n("c1")?,
            c2_n_s_per_m: n("c2")?,
        }),
        "nonlinear" => {
            let mass_kg = n("m")?;
            let (kx, k) = (list("k_knots")?, list("k_values")?);
            let (cv, c) = (list("c_knots")?, list("c_values")?);
            let at_crush = |i: usize| {
                let end = crush.unwrap_or(kx[i + 1]);
                (end, k[i] + (k[i + 1] - k[i]) * (end - kx[i]) / (kx[i + 1] - kx[i]))
            };
            match (&kx[..], &k[..], &cv[..], &c[..]) {
                ([_, _], [k1, _], [_, knee, last], [c1, c2, c3]) => {
                    let (crush_m, k2_n_per_m) = at_crush(0);
                    Model::Nonlinear1(Nonlinear1 {
                        mass_kg,
                        k1_n_per_m: *k1,
                        k2_n_per_m,
                        c1_n_s_per_m: *c1,
                        c2_n_s_per_m: *c2,
                        c3_n_s_per_m: *c3,
                        v_thresh_m_per_s: *knee,
                        crush_m,
                        v0_m_per_s: *last,
                    })
                }
                ([_, x1, _], [k1, k2, _], [_, v1, v2, last], [c1, c2, c3, c4]) => {
                    let (crush_m, k3_n_per_m) = at_crush(1);
                    Model::Nonlinear2(Nonlinear2 {
                        mass_kg,
                        k1_n_per_m: *k1,
                        k2_n_per_m: *k2,
                        k3_n_per_m,
                        x1_m: *x1,
                        c1_n_s_per_m: *c1,
                        c2_n_s_per_m: *c2,
                        c3_n_s_per_m: *c3,
                        c4_n_s_per_m: *c4,
                        v1_m_per_s: *v1,
                        v2_m_per_s: *v2,
                        crush_m,
                        v0_m_per_s: *last,
                    })
                }
                _ => return Err(format!("no nonlinear model has {} and {} knots", kx.len(), cv.len())),
            }
        }
        other => return Err(format!("a model {other:?} is not known here")),
    })
}
