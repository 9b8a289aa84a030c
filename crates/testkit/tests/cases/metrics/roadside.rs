//! Roadside hardware.

use crumple_metrics::{AsiLimits, AsiMethod, FlailSpace};
use crumple_signal::{STANDARD_GRAVITY_M_PER_S2, Sampled};
use crumple_testkit::reference_signals::{list, number};

use crate::metrics::check::Check;

pub fn asi(check: &mut Check<'_>) {
    let signals = [0, 1, 2].map(|k| check.acceleration(k));
    let limits: Vec<f64> =
        list(&check.case["params"]["limits_g"]).iter().map(|g| number(g) * STANDARD_GRAVITY_M_PER_S2).collect();
    let limits = AsiLimits { limits_m_per_s2: limits.try_into().unwrap() };
    let [x, y, z] = &signals;
    let of = |method| crumple_metrics::asi([x, y, z], limits, method).unwrap();
    let mean = of(AsiMethod::MovingAverage);
    check.metric("moving_average_50ms", &mean, 1.0);
    check.close_or_null("moving_average_t_start_s", mean.window.map(|w| w.from_s));
    let filtered = of(AsiMethod::ButterworthPerPass);
    check.metric("butterworth_13hz", &filtered, 1.0);
    check.close_or_null("butterworth_t_s", filtered.window.map(|w| w.from_s));
    let both = of(AsiMethod::ButterworthBothPasses);
    check.metric("butterworth_13hz_both_passes", &both, 1.0);
}

pub fn thiv_phd(check: &mut Check<'_>) {
    let default = FlailSpace::default();
    let space = FlailSpace {
        ahead_m: check.param_or("dx_m", default.ahead_m),
        aside_m: check.param_or("dy_m", default.aside_m),
        head_x_m: check.param_or("x0_m", default.head_x_m),
    };
    let (ax, ay, yaw) = if check.has_param("constant_decel_ms2") {
        let ax = check.constant_deceleration();
        let zeros = Sampled::new(0.0, ax.dt_s(), vec![0.0; ax.len()]).unwrap();
        (ax, zeros.clone().into(), zeros)
    } else {
        (check.acceleration(0), check.acceleration(1), check.si(2))
    };
    let (thiv, phd) = crumple_metrics::thiv_phd(&ax, &ay, &yaw, space).unwrap();
    check.close_or_null("T", thiv.window.map(|w| w.to_s));
    check.metric("thiv_ms", &thiv, 1.0);
    check.metric("thiv_kmh", &thiv, 1.0 / 3.6);
    check.metric_g("phd_g", &phd);
}
