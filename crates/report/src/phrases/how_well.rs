//! How well models follow the test: parts of a rating, residual, ratings of the trade, energy.

texts! { HowWellTexts
    title: "How well";
    model: "Model";
    by_standard: "Acceleration by ISO/TS 18571";
    residual: "Residual of the acceleration";
    wall_force: "Wall force off by, %";
    corridor: "Corridor";
    phase: "Phase";
    magnitude: "Magnitude";
    slope: "Slope";
    rating: "Rating";
    grade: "Grade";
    rms: "rms, g";
    of_the_test: "of the test, %";
    lags_beyond: "lags beyond limits, %";
    excellent: "excellent";
    good: "good";
    fair: "fair";
    poor: "poor";
    over: "Over {times} after time zero. ";
    caption:
        "1 is equal in every part; the rating is 0.4 corridor + 0.2 phase + 0.2 magnitude + 0.2 slope (ISO/TS \
         18571:2014), in words excellent above 0.94, good above 0.80, fair above 0.58, else poor. Residual: filtered \
         test minus the model’s own motion. Of noise one lag in twenty lies beyond the limits; more says that the \
         model misses a part of the pulse.";
    autocorrelation_title:
        "Autocorrelation of the residual of {model}: {share} of the lags up to {longest} lie beyond the limits of \
         noise";
    lag: "lag, up to {longest}";
    autocorrelation_caption:
        "Autocorrelation of the residual, {model}; shaded: 95\u{a0}% of noise";
    ratings: "Ratings: model against test";
    acceleration: "Acceleration";
    displacement: "Displacement";
    fit: "Fit, %";
    fit_definition: "100 (1 − |y − ŷ| / |y − mean y|).";
    standard_definition:
        "0.4 corridor + 0.2 phase + 0.2 magnitude + 0.2 slope; 1 is equal. Sampled at 10 kHz only.";
    cora_definition:
        "0.5 corridor + 0.5 cross-correlation over the compared window; 1 is equal.";
    m_definition:
        "Sprague-Geers magnitude: sqrt(I_cc/I_mm) − 1; 0 is equal.";
    p_definition:
        "Sprague-Geers phase: acos(I_mc/sqrt(I_mm I_cc))/π; 0 is equal.";
    c_definition:
        "Sprague-Geers comprehensive: sqrt(M² + P²); 0 is equal.";
    theil_definition:
        "Inequality |m − c|/(|m| + |c|), 0 to 1; 0 is equal.";
    mark: ", mark {mark}";
    cora_has: " CORA (mark {mark}) has {note}.";
    ratings_caption:
        "Over {times} after time zero. ISO/TS 18571 and CORA: 1 is equal; M, P, C (Sprague-Geers) and Theil's U1: 0 \
         is equal. Roadside practice accepts |M| and P up to 0.4.{cora} Marks: C checked, S after a secondary source, \
         M from memory, U uncertain.";
    energy: "Energy of the models";
    instant: "Instant";
    time: "Time, ms";
    brought_in: "Brought in, kJ";
    kinetic: "Kinetic, kJ";
    in_springs: "In springs, kJ";
    dissipated: "Dissipated, kJ";
    closure: "Closure";
    closure_definition:
        "Largest gap of the balance over the whole response, relative to its largest term.";
    diverges: "diverges";
    at_dynamic_crush: "dynamic crush";
    at_end: "end";
    energy_caption:
        "Heat and work are integrated apart from the motion, so the closure checks motion, forces and law together. \
         Plastic work of the elastoplastic model counts as dissipated.";
}
