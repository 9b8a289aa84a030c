//! Identified models: their section and its figures.

texts! { IdentificationTexts
    title: "Identification";
    one_model:
        "{count} identified model: poles, order, frequency response";
    models:
        "{count} identified models: poles, order, frequency response";
    recommended: "Use <code>{model}</code> for {output}: {because}.";
    smallest_bic: "it has the smallest BIC of all";
    validates_better:
        "it follows unseen samples better than <code>{other}</code>, which has the smallest BIC and a single state";
    method: "method {method}";
    order: "order {order}";
    output: "output {channel}";
    channel_taken_for: "channel {channel} taken for {what}";
    stretch: "{times}, {count} samples";
    hankel: "Hankel matrix {rows} × {columns}";
    stopped: "search stopped: {reason}";
    output_column: "Output";
    fit_column: "Fit, %";
    fit_definition: "Of the simulated output, with its start fitted, on the samples identified from.";
    restarted_column: "Unseen, %";
    restarted_definition: "Fit of the samples kept for validation, with the start fitted to them.";
    run_on_column: "Run on, %";
    run_on_definition: "The same from the state at the end of the samples identified from.";
    lag_one_column: "Errors at lag one";
    lag_one_definition: "Autocorrelation of the errors of the simulation one sample apart; near 0: white.";
    effective_column: "Worth";
    effective_definition: "Number of independent samples that the correlated errors are worth.";
    correlated:
        "The errors of the simulation are correlated (Q {statistic}, {limit} allowed): {effect}.";
    correlated_of:
        "The errors of {count} of {all} outputs are correlated (Q {statistic}, {limit} allowed): {effect}.";
    drawn_from_ar: "intervals are drawn from noise of an autoregression of order {order}";
    drawn_from_arx: "intervals are drawn from noise that goes through the poles of the system";
    unexplained: "no noise model explains them, deviations would be too small, and intervals are left out";
    counted: "the deviations count as many independent samples as they are worth, {count}";
    too_small: "deviations that take them for white would be too small";
    continuous: "continuous";
    sampled: "sampled every {time} s";
    sizes: "State space, {sampled}: states {states}, inputs {inputs}, outputs {outputs}.";
    numerator: "Numerator";
    numerator_of: "Numerator from {input} to {output}";
    more_numerators: "{count} more numerators are in the artifact.";
    denominator: "Denominator";
    notes_of_model: "Notes on this model ({count})";
    poles_and_pairs: "{count} poles and pairs";
    pole: "Pole, 1/s";
    natural_frequency: "Natural frequency, Hz";
    natural_frequency_definition: "Modulus of the pole over 2π.";
    damping_ratio: "Damping ratio, %";
    damping_ratio_definition: "−Re over the modulus; negative: unstable.";
    coherence: "Coherence";
    coherence_definition:
        "Modal amplitude coherence, 0 to 1: how well the mode follows its own decay.";
    share: "Share";
    share_definition:
        "Mode singular value relative to the largest: the mode's share of the response.";
    zeros_of_model: "Zeros, 1/s: {zeros}.";
    pair_of_zeros: "{re} with imaginary parts ±({im})";
    unstable: "unstable";
    deviation:
        "± one standard deviation, from the covariance of the linearised fit.";
    no_deviation:
        "No uncertainty of these poles is known.";
    spread:
        "± one standard deviation, and the 90 % interval, from the bootstrap.";
    integrator: "no mode: near zero";
    beyond_nyquist: "no mode: beyond the sampling";
    cancelled: "no mode: a zero cancels it";
    harmonic: "no mode: a machine that runs";
    marginal: "marginal";
    failed_methods: "Not identified";
    compare: "Measured and simulated";
    measured: "measured";
    legend_fit: "{model}, {fit}";
    legend_unseen: "{model}, {fit}, unseen {unseen}";
    time_of_record: "time, {unit}";
    compare_caption:
        "The record and the outputs that the models answer the recorded inputs with.";
    compare_unseen:
        " Shaded: unseen samples, with the start of the model fitted to them.";
    compare_cut:
        " The axis of time shows a part of the record at first.";
    more_outputs: " {count} more outputs are in the artifact.";
    errors: "Errors of the simulation";
    limits_of_white: "95 % limits of white errors";
    own_correlation: "errors of {channel}";
    input_correlation: "errors of {channel} with {input}";
    lag: "lag, samples";
    errors_caption:
        "Autocorrelation of the errors, and their correlation with the inputs; a negative lag is an input after the \
         error. Errors outside the limits are correlated: deviations that assume white ones are wrong.";
    errors_outside:
        " {model}: {outside} of {lags} lags are outside.";
    poles: "Poles and zeros of the identified models";
    real_part: "real part, 1/s";
    imaginary_part: "imaginary part, rad/s";
    unstable_poles: "{model}, unstable";
    zeros: "{model}, zeros";
    poles_caption:
        "Continuous poles, and zeros as circles; their mirror images below the real axis are not drawn. Rays join \
         poles of equal damping ratio ζ, circles those of equal natural frequency.";
    all_stable: " All poles are stable.";
    one_unstable:
        " One pole is unstable (right half plane): it describes the window, not what was measured.";
    several_unstable:
        " {count} poles are unstable (right half plane): they describe the window, not what was measured.";
    one_marginal:
        " One pole is marginal (on the stability limit): it neither dies down nor grows over the record.";
    several_marginal:
        " {count} poles are marginal (on the stability limit): they neither die down nor grow over the record.";
    one_far_zero:
        " {count} zero lies farther out than these poles.";
    far_zeros:
        " {count} zeros lie farther out than these poles.";
    one_far_pole: " {count} far pole lies outside the axes.";
    far_poles: " {count} far poles lie outside the axes.";
    singular_values: "Evidence for the order";
    index: "index";
    relative_singular_value: "relative singular value";
    values: "{model}, values";
    singular_values_caption:
        "Singular values of the Hankel matrix relative to the largest.";
    wide_gap:
        " A wide gap supports the order before it; on a gentle slope the record does not determine the order.";
    stabilisation: "Stabilisation diagram";
    natural_frequency_axis: "natural frequency, Hz";
    order_axis: "order";
    all_are_stable: "frequency, damping, shape stable";
    frequency_and_damping_stable: "frequency and damping stable";
    frequency_stable: "frequency stable";
    new: "new";
    rejected: "rejected";
    stabilisation_caption:
        "{method} of {channel}: poles of models of rising order, from one factorisation. Compared with the order \
         before, stable is a frequency within {frequency}, a damping ratio within {damping}{shape}. Rejected: growing, \
         damping ratio above {highest}, above {nyquist} of the Nyquist frequency, or no stronger than noise.";
    modes_marked:
        " Marked: modes present in {presence} of the orders or more ({count}).";
    no_mode_marked:
        " No mode is present in {presence} of the orders, none is marked.";
    shape_within: ", a shape with MAC of {mac} or more";
    more_diagrams: " {count} more are in the artifact.";
    bode: "Frequency response";
    frequency: "frequency, Hz";
    magnitude: "magnitude, dB";
    phase: "phase, °";
    bode_caption:
        "From {input} to {output}{units}. Phase is unwrapped; natural frequencies of oscillating poles of the \
         recommended, else the closest model are marked.";
    si_units: ", SI units";
    the_input: "the input";
    the_output: "the output";
    band_of: " Band of {model}: {band}.";
    no_band:
        " No band: the records hold no uncertainty of these models.";
    impulse_title: "Impulse response";
    impulse_and_step_title: "Impulse and step response";
    impulse_response: "impulse response{unit}";
    step_response: "step response{unit}";
    time_of_window: "time from the start of the window, {unit}";
    per: ", {output} per {input}";
    response_caption:
        "Response of {output} to a {impulse}, from rest.";
    response_step_caption:
        "Response of {output} to a {impulse} and to a unit step, from rest.";
    unit_impulse: "unit impulse";
    unit_sample: "unit sample";
    died_down:
        " The axis of time ends where the impulse response has died down.";
    hidden:
        " {count} models with another output, another impulse, or far larger responses are hidden: their names in the \
         legend show them.";
}
