//! Several runs on one page: comparison, Markdown of a run, index, the page of a fleet, one model for several tests.

texts! { RunTexts
    key_numbers: "Key numbers";
    number: "Number";
    recommended_models: "Recommended models";
    of_the_model: "Of the model";
    predictions: "Predictions of the recommended models";
    prediction: "Prediction";
    made_with: "What the runs were made with";
    setting: "Setting";
    compared: "{count} runs compared";
    comparison_brand: "Crumple · comparison of runs";
    what_differs: "What differs";
    what_each_says: "What each run says";
    one_gravest: "1 warning: {text}";
    gravest: "{count} warnings, the gravest: {text}";
    of_one_record: "one record";
    of_records: "{count} records";
    same_settings:
        "{runs} runs of {records}, made with the same settings.";
    one_setting_differs:
        "{runs} runs of {records}; {count} setting differs: {names}{more}.";
    settings_differ:
        "{runs} runs of {records}; {count} settings differ: {names}{more}.";
    of_common_model: "of the model that all recommend: {names}";
    other_models: "the recommended model ({names})";
    no_model: "none";
    tolerance: "0.1 ms, 1 mm, 0.01 m/s, else 0.5 %";
    own_limits: "the limits that the first run's pipeline states, else 0.1 ms, 1 mm, 0.01 m/s, 0.5 %";
    nothing_differs:
        "Nothing differs by more than {tolerance}.";
    differ:
        "These differ by more than {tolerance}: {names}.";
    differs: "differs";
    curves: "Curves over each other";
    one_test: "test, the same in all runs";
    test_of: "{run}, test";
    model_of: "{run}, model ({model})";
    curves_caption:
        "SAE J211 sign: deceleration is negative. Solid: the test; dashed: the model that its run recommends, its own \
         motion without the filter. The dots are dynamic crush and its time.";
    recommended: "Recommended";
    certainty: "Certainty";
    displacement_fit: "Displacement fit";
    predicted_crush: "Predicted crush at {speed}";
    predicted_number: "Predicted {number} at {speed}";
    record: "record";
    pipeline: "pipeline";
    more_in_report: "{count} more in the report.";
    value: "value";
    model_for_predictions: "Model for predictions";
    candidates: "Candidates";
    candidate_heads:
        "Model | Certainty | ΔC, mm | Δtₘ, ms | Fit, %";
    same_curve: " and {count} with the same curve";
    again: "Again";
    record_is: "Record {record}.";
    record_elsewhere:
        "Record {record}: put its path in place of its name, or state it by --record.";
    run: "Run";
    runs: "Runs";
    one_run: "1 run";
    several_runs: "{count} runs";
    index_brand: "Crumple · index of runs";
    index_title: "Index of runs";
    with_model: "{runs}, {count} with a recommended model";
    without_result: ", {count} without a result";
    tables: " All numbers as tables: {links}.";
    index_caption:
        "A name leads to the report of the run. C and tₘ: dynamic crush and its time; e: restitution; k: \
         stiffness of the Kelvin model. Pulses: the filtered acceleration over the first 150 ms, upwards as the \
         vehicle slows down, each to its own peak. Three digits are shown; the reports have all, with intervals.";
    sorts: " A head of a column sorts.";
    failures: "Without a result";
    and_more: "and {count} more";
    no_word: "no word of why";
    done: "done";
    usage: "usage";
    refused: "refused";
    not_acceptable: "no acceptable result";
    failed: "failed";
    ended_at: "the run ended at {stage}, before its report";
    of_an_earlier_run: "{name} (results of an earlier run)";
    earlier_report: "the last run ended before its report: the numbers are those of the run before";
    vehicle_or_test: "Vehicle or test";
    numbers_of_it: "Numbers of it";
    pulse: "Pulse";
    first_warning: "First warning";
    pipeline_head: "Pipeline";
    none: "none";
    determined: "{determined} of {parameters} determined";
    order_of_magnitude: ", {count} with a wide interval";
    open: ", {count} open";
}

texts! { JointTexts
    brand: "Crumple · one model for several tests";
    happened:
        "One model was fitted to {count} tests at {low} to {high}: {names}.";
    each_from_the_others:
        " Each predicted from the others, the crush is off by {worst} at most; {held} of {predicted} lie in the 90 % \
         interval.";
    tests_disagree:
        "Predicted from the others, the crush of {tests} is off: quote predictions with that error.";
    warn_missed:
        "predicted from the others, the crush of {tests} is outside of its 90 % interval: these tests may not be of \
         one structure; predictions of the joint model may be off by as much";
    title: "The tests, and each predicted from the others";
    test: "Test";
    mass: "Mass, kg";
    speed: "Speed, km/h";
    crush: "C, mm";
    time: "t<sub>m</sub>, ms";
    restitution: "e";
    crush_error: "ΔC, %";
    time_error: "Δt<sub>m</sub>, %";
    peak_error: "Δpeak, %";
    rating: "ISO/TS 18571";
    held: "C in its 90 % interval";
    by: "By";
    not_predicted: "not predicted: {why}";
    caption:
        "Mass, speed, dynamic crush C, its time t<sub>m</sub> and restitution e of each test as measured; then what a \
         model of the other tests alone says of it, less what was measured. This is how far a prediction by these \
         tests was off in tests that were made.";
    over_speed: "Dynamic crush over impact speed";
    tests_as_measured: "tests as measured";
    interval: "its 90 % interval";
    impact_speed: "impact speed, km/h";
    dynamic_crush: "dynamic crush, mm";
    over_speed_caption:
        "Predictions of the joint model at {mass} against the wall of the tests; each test at its own mass.";
}

texts! { FleetTexts
    over: "Over mass, speed and model year";
    no_law:
        "Mass, speed, year and class differ together in what was tested: a line here describes these runs, it is no \
         law.";
    distributions: "Distributions";
    how_many: "How many runs have which value.";
    runs_by_value: "Runs by value";
    runs: "runs";
    a_run: "a run";
    line:
        "least-squares line of the runs that are no outliers";
    outlier:
        "outlier: more than four robust standard deviations off the line; leads to its report";
    tests: "tests";
    candidates: "candidates";
    metrics: "metrics";
    predictions: "predictions";
    without_files:
        "The style and the scripts of this page lie in {folder}, with those of all runs of the fleet, and were not \
         found there. A page that needs no other file: crumple-report *.mcap -o report.html in the folder of the run.";
}
