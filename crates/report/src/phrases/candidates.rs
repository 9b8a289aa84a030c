//! Candidates: which to use and why, a row a distinct curve, every one with its remarks.

texts! { CandidateTexts
    title: "Which model to use";
    recommended: "Recommended for predictions";
    simplest: "Simplest";
    closest: "Closest to the record";
    none: "none";
    evidence_of_all: "Evidence for every candidate";
    model: "Model";
    determined: "Determined";
    of: "{determined} of {parameters}";
    evidence_against: "Evidence against";
    evidence_definition:
        "Score of what the model foretells of the record, with what is known beside it, above the lowest of the \
         adequate models: below 2 says nothing, above 10 decides.";
    crush_at: "C at {speed}, mm";
    crush_at_definition:
        "Dynamic crush as predicted at this speed, same mass, same wall; below it the 90 % interval.";
    crush_error: "ΔC, mm";
    crush_error_definition:
        "Dynamic crush, model minus test.";
    time_error: "Δt<sub>m</sub>, ms";
    time_error_definition:
        "Time of dynamic crush, model minus test.";
    fit: "Fit, %";
    fit_as_measured_definition:
        "100 (1 − |x − x̂| / |x − mean x|) of the displacement over the compared window, the model measured as the \
         record was.";
    fit_definition:
        "100 (1 − |x − x̂| / |x − mean x|) of the displacement over the compared window.";
    distinct_curves:
        "{candidates} candidates, {curves} distinct curves: those in one row differ over the compared window by no \
         more than {share} of the largest displacement and velocity (root mean square), in restitution by no more than \
         {restitution}, and the evidence does not tell their misfits apart. ";
    bars_caption:
        "Highlighted is the chosen model. A bar is a 95 % interval between a tenth and ten times \
         the value; it fades where it goes on or is open.";
    parameters_of_row: "parameters";
    in_doubt: "In doubt, not recommended";
    badge_recommended: "recommended";
    badge_simplest: "simplest";
    badge_closest: "closest";
    not_adequate: "not adequate: {why}";
    not_passive: "not a passive structure";
    same_curve: "same curve: {count} more";
    parameter: "Parameter";
    value: "Value";
    interval: "95&nbsp;%";
    scale_value: "value";
    order_of_magnitude: "wide interval";
    limit_of_physical: "physical limit";
    the_limit_of_physical: " (physical limit)";
    given: "given";
    open: "open";
    energy_goes_into: "Energy goes into";
    plastic: "plastic deformation";
    damped: "dampers";
    elastic: "springs";
    with_priors: "Δ with priors";
    adequate: "Adequate";
    no_because: "no: {why}";
    wall_force: "Wall force, %";
    wall_force_definition:
        "Force on the wall: model less measured, root mean square over that of the measured, from contact to \
         separation, both filtered alike.";
    evidence_caption:
        "Evidence is minus twice the logarithm of the density that a model gives the {quantity}{filtered} before it \
         is fitted to it, over {effective} terms below 60 Hz of {samples} samples; a difference below 2 says \
         nothing, above 10 it decides. ";
    filtered_alike: ", the models filtered as the record was";
    no_priors: "none.";
    priors_caption:
        "Prior knowledge adds these terms: {priors}";
    every_candidate:
        "Every candidate with its parameters and remarks";
    rank: "Rank";
    model_and_method: "Model and method";
    parameters: "Parameters";
    physical: "Physical";
    physical_definition:
        "No parameter is negative: a passive structure.";
    rmse: "RMSE, mm";
    rmse_definition:
        "Root mean square displacement error over the compared window.";
    matching_supported:
        "Of the solutions of coefficient matching the simulation supports {model}{dual}: fit {fit}{physical}.";
    and_its_dual:
        " and its dual {model}, which this sensor cannot tell from it";
    it_is_not_passive: "; it is not a passive structure";
    ranked_recommended:
        "In the order of the choice: adequate models first, then by the evidence. Highlighted is the recommended \
         model: the list above says why. A dual gives exactly the same record on this sensor and so the same figures.";
    ranked_by_fit:
        "In the order of the displacement fit, the model measured as the record was. No model is recommended. A dual \
         gives exactly the same record on this sensor and so the same figures.";
    intervals_caption:
        "± is one standard deviation, from the misfit and the sensitivities at the fit; “95 %” is the interval that \
         holds the value in 95 of 100 such records if the model is true and mass, gain and the division of the mass \
         are exact, with two masses or more the speed too, “open” where the record does not bound it. It is far \
         wider than two standard deviations where the misfit is worth few independent samples (see the remarks), and \
         not symmetric. Profile, bootstrap and uncertain inputs, where asked for, are among a candidate's remarks.";
    dual_of: "dual of {model}: same record";
    fitted_to:
        "Fitted to the {quantity} of channel {channel} from {from} to {to} ms ({samples} samples); stopped: {reason}.";
    on_bounds: "Reached the search limit: {names}.";
    one_remark: "{count} remark";
    remarks: "{count} remarks";
    star: "chosen";
    directions:
        "Independent directions in the parameters that the waves respond to: {rank} of {order}; how well each \
         parameter is known, its interval says.";
    known_least: "Known least: {what}.";
    condition: "Condition of the sensitivities: {value}.";
    other_sensor:
        "Sensor {channel} on mass {mass}, which the fit did not use: {error} root mean square{fit}.";
    sensor_fit: ", fit {fit}";
    interval_open: "; 95\u{a0}%: open";
    interval_of: "; 95\u{a0}%: {low} to {high}";
    profile: "Profile likelihood, 95\u{a0}%: {intervals}.";
    bootstrap: "Bootstrap";
    uncertain_inputs: "Uncertain inputs";
    replicates:
        "{name} ({method}; {count} repetitions), {coverage}: {intervals}.";
}
