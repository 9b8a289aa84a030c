//! What is missing, notes, what the result can and cannot say, provenance.

texts! { RemarkTexts
    missing: "Not in this report";
    no_description:
        "the test description (ingest writes it)";
    no_crash:
        "motion, events and physical parameters: no channel is named as a pulse (--channel names one)";
    no_pulse:
        "the crash pulse: the test names none of its channels (--channel does)";
    no_raw:
        "acceleration as read (ingest writes it)";
    no_filtered:
        "filtered acceleration (filter writes it)";
    no_events:
        "crash events, velocity, displacement and metrics (integrate writes them)";
    no_motion:
        "vehicle motion: see the notes of integrate";
    no_motion_without_speed:
        "vehicle motion: the record has no impact speed (add --impact-speed)";
    no_displacement:
        "velocity and displacement (integrate writes them)";
    no_models:
        "identified models (identify writes them)";
    no_parameters:
        "physical parameters (parameter-solve writes them)";
    none_found: "{what}: none found, {reason}";
    parameters: "physical parameters";
    models: "identified models";
    no_responses:
        "ranking: the candidates were not simulated (by the stage simulate)";
    without_parameters:
        "the parameters of {count} simulated candidates (parameter-solve writes them)";
    no_choice: "parameter-solve made no choice among the candidates";
    notes_title: "Warnings and notes";
    one_warning: "1 warning";
    of_other_candidates:
        "{count} of them on candidates that are neither recommended nor simplest nor closest";
    warnings:
        "{count} warnings, those first that change most of what is shown";
    notes: "{count} notes";
    limits: "What this can and cannot say";
    one_sensor_dual:
        "One compartment accelerometer cannot tell a double-mass parameter set from its dual: both give exactly the \
         same record, so the fit cannot choose between them. A second sensor on the front, on the engine or the \
         firewall, decides.";
    generic_limit:
        "A model describes the record it was fitted to, over the amplitudes and frequencies that its input excited; \
         what it predicts elsewhere is extrapolation.";
    linear_limit:
        "A linear model of a crash is a model of the loading phase: a structure that has been crushed does not spring \
         back as it came.";
    compared_window:
        " Models are compared with the test from {from} to {to} ms after time zero; what they do later is \
         extrapolation.";
    read_from_one:
        "All results come from one sensor and treat the vehicle as a rigid body.";
    read_from_one_fitted_to_channel:
        "Crush and events are read from one sensor (models of several masses were fitted to channel {channels} too), \
         with the vehicle taken for a body that moves as one.";
    read_from_one_fitted_to_channels:
        "Crush and events are read from one sensor (models of several masses were fitted to channels {channels} too), \
         with the vehicle taken for a body that moves as one.";
    crush_is:
        " Crush is the displacement of that sensor, double-integrated: an error of its zero level grows with the \
         square of time. It is dynamic crush; the crush that remains after the test cannot be had from an \
         accelerometer.";
    no_kelvin:
        "t_c/t_m is {ratio}, above 2/π = {bound}: no Kelvin model with damping has such a pulse, and one labelled as \
         undamped is a reduction to the nearest that exists.";
    does_not_stop:
        "The velocity does not reach zero within the record. This is a valid result: the vehicle was still moving \
         forward when the record ended, so dynamic crush, restitution and all that builds on them are absent.{end}";
    end_of_event:
        " Its change is counted, and models are fitted, up to the end of the event at {time} ({rule}).";
    none_recommended: "No model is recommended: {reason}.";
    provenance: "Provenance";
    source:
        "Record: {name} ({format}), {digest}. Pipeline: {pipeline}.";
    not_named: "not named";
    stage: "Stage";
    version: "Version";
    content: "Content";
    made_from: "Made from";
    settings: "Settings";
    none: "none";
    show: "show";
    made_by:
        "Made by crumple-report {version}. Full numbers are in summary.json and in the artifacts.";
}
