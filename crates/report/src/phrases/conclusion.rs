//! What verdict, warnings and console say.

texts! { ConclusionTexts
    usable: "usable";
    usable_with_care: "usable with care";
    do_not_use: "do not use";
    status: "{status}: {reason}.";
    sound: "sound";
    check: "check";
    wrong: "wrong";
    record_label: "record";
    good_for_label: "good for";
    good_for_nothing: "nothing";
    use_measured: "measured quantities";
    use_crush: "crush at the tested speed";
    use_other_speeds: "other speeds to ±{percent}";
    use_forces: "forces";
    use_parameters: "parameters";
    use_criteria: "criteria of the occupant";
    use_modes: "frequencies and damping";
    because_good_to:
        "the crush {scenario} is predicted to ±{good_to}";
    because_beyond:
        "{scenario}, beyond the test, the crush is predicted to ±{good_to}";
    because_sensors:
        "{count} sensors of the compartment read {low} to {high} of crush; a single one is good to ±{half_width}";
    because_few_forces:
        "use its crush, not its forces: {determined} of {parameters} {are} well known";
    because_few_parameters:
        "use its crush, not its parameters: {determined} of {parameters} {are} well known";
    because_unassessed:
        "the parameters of the model have no intervals";
    because_dual:
        "use its crush, not its mass split: one sensor cannot identify the split";
    because_misses_its_test:
        "use its crush only: the model misses the {events} of its own test";
    because_weak:
        "the evidence is weak: {model} fits nearly as well";
    because_contrary:
        "chosen for its crush at lower speeds: {model} follows the pulse closer";
    because_no_interval:
        "the crush at other speeds has no interval";
    because_tests_disagree: "the tests disagree";
    because_no_stop:
        "use its delta-v: the vehicle did not stop within the record";
    because_other_axis:
        "use its delta-v: the pulse is along {axis}, the models are of a crush along x";
    because_two_vehicles:
        "use its delta-v: its motion over ground is not its crush";
    because_occupant:
        "use the criteria of the occupant, nothing for the vehicle";
    because_recorder:
        "use its delta-v, not its forces: the table is coarse";
    because_identified:
        "for the amplitudes and frequencies that this record excited";
    because_no_mass: "no mass is stated: use the motion";
    because_no_speed:
        "no impact speed is stated: use delta-v and pulse";
    because_no_mass_nor_speed:
        "neither mass nor impact speed is stated: use delta-v and pulse";
    because_measured_only:
        "use what was measured: no model was fitted";
    because_none_recommended:
        "use what was measured: no model is for other speeds";
    because_no_result: "there is no acceptable result";
    because_decisive:
        "{subject} is in doubt, see warning {number}";
    because_check:
        "check {subject}, see warning {number}";
    the_pulse: "the pulse";
    the_mass: "the mass";
    the_impact_speed: "the impact speed";
    the_time_axis: "the time axis";
    the_motion: "the motion";
    the_model: "the model";
    the_identified_models: "every identified model";
    the_record: "the record";
    because_not_adequate: "no model is adequate";
    because_none_adequate: "use what was measured: no model is adequate";
    because_poor_fit:
        "the fit of the best model is {fit}, below {limit}";
    scenario: "at {speed}{mass}{partner}";
    with_mass: " with {mass}";
    against_partner: " against {partner}";
    crushed:
        "The dynamic crush was {crush} at {time}{rebound}.";
    reached: ", reached at {time}";
    within: " within {time}";
    level: "{percent}\u{a0}%: ";
    interval: " ({low} to {high})";
    rebounded: "; the vehicle rebounded at {speed}";
    rebounded_at_least: "; the vehicle rebounded at {speed} or more";
    no_rebound: "; the vehicle did not rebound";
    at_least: "at least ";
    at_most: "at most ";
    no_stop:
        "The vehicle did not stop within the record: it lost {bound}{change} in {time}.";
    no_stop_in_impact:
        "The vehicle did not stop in this impact: it lost {change} in {time}, and another impact followed.";
    no_stop_no_end:
        "The vehicle did not stop within the record.";
    two_vehicles:
        "Two vehicles collided: this one lost {change}{time}.";
    occupant:
        "The sensor sits in an occupant ({place}), not in the vehicle{criteria}.";
    occupant_use:
        "Do not use its crush, stiffness and models for the vehicle{bounds}.";
    lower_bounds:
        "; the criteria are lower bounds: not all axes are in this record";
    recorded:
        "The recorder kept a delta-v of {change}{time}.";
    recorded_at_least:
        "The recorder kept a delta-v of at least {change}: its table ends at {time} while the velocity still changes.";
    recorder_energy_at_least:
        "If what it hit did not give way{speed}, the EES is at least {ees}{share}.";
    recorder_use:
        "Its table is too coarse for peak and force{crush}{none}.";
    recorder_energy:
        "If what it hit did not give way{speed}, the EES is {ees}{interval}{share}.";
    speed_is_exact: " and the stated speed is exact";
    of_energy: ": {share} of the kinetic energy went into deformation";
    recorder_without_model: "; no model is recommended";
    rough_crush: "; its crush of {crush}{interval} is rough";
    identified:
        "The closest identified model, {model}, has a fit of {fit}{unseen}{mode}.";
    identified_chosen:
        "The recommended identified model, {model}, has a fit of {fit}{unseen}{mode}.";
    unseen: " (unseen samples: {fit})";
    identified_fails:
        "No identified model holds: the best, {model}, has a fit of {fit}{unseen}.";
    ambient:
        "Nobody measured what drove this record. Modes that stay over model orders and in both halves: {modes}.";
    no_mode: "none";
    identified_none:
        "No identified model has a fit.";
    identified_no_use:
        "Do not use it: its modes are not known to be those of what was measured.";
    damping: ", damping ratio {ratio}";
    mode:
        "; its slowest mode is at {frequency}{damping}";
    changed:
        "The record gives a delta-v of {bound}{change}{time}{peak}{olc}{stroke}.";
    and_peak: ", a peak of {peak}";
    and_olc: ", an OLC of {olc}";
    and_stroke: ", a stroke of {stroke}";
    not_stated_both:
        "Mass and impact speed are missing, so there is no crush and no force: add --mass and --impact-speed.";
    not_stated_mass:
        "The mass is missing, so there is no force and no stiffness: add --mass.";
    not_stated_speed:
        "The impact speed is missing, so there is no crush and no stiffness: add --impact-speed.";
    no_model: "There is no model: {reason}.";
    read_the_notes:
        "the notes of the run say more, and its folder";
    measured_only:
        "This report holds no motion of a vehicle.";
    no_structure:
        "What was tested has no structure, so there is no model of it for other speeds.";
    no_models_here:
        "It holds no models: their stages did not run.";
    one_spring:
        "One spring of {stiffness} has the same energy and crush.";
    use_model: "For other speeds use {model}{predicts}.";
    asked_for:
        "Asked for: {scenario} {model} gives {crush}{interval}.";
    force_deflection_curve: "the force-deflection curve";
    named_model: "the {model} model";
    predicts: ": {scenario} it gives {crush}{interval}";
    predicts_beyond:
        ": {scenario}, beyond the test, it gives {crush}{interval}";
    determined: "{determined} of {parameters} parameters determined";
    order_of_magnitude: ", {count} with a wide interval";
    open: ", {count} open";
    none_recommended: "No model is recommended: {because}.";
    no_crush:
        "the vehicle was not seen to stop";
    other_axis:
        "the pulse is along {axis}, and the models are of a crush along x";
    closest:
        "The closest, {model}, has a displacement fit of {fit} up to {time}.";
    open_numbers:
        "Not identifiable from this record: {names}.";
    dual:
        "The mass split cannot be identified from one sensor: a mirrored (dual) model fits equally well.";
    few_forces:
        "Use its crush, not its forces: {determined} of {parameters} {are} well known.";
    few_parameters:
        "Use its crush, not its parameters: {determined} of {parameters} {are} well known.";
    extrapolates:
        "Beyond {crush}, the crush of the test, it extrapolates.";
    and: "and";
    is: "is";
    are: "are";
    force_at: "the force at {deflection}";
    forces_at: "the forces at {deflection}";
    sensors_differ:
        "{count} sensors of the compartment give a crush of {low} to {high}: quote the range";
    warn_open:
        "{model}: not identifiable from this record: {names}";
    warn_hardly:
        "{model}: wide intervals of {names}";
    warn_dual:
        "a mirrored (dual) model fits as well as {model}: a second sensor, on the front or the engine, decides between \
         them";
    warn_extrapolates:
        "predictions beyond {crush}, the crush of the test, extrapolate";
    warn_two_vehicles:
        "a collision of two vehicles: the displacement over ground is not the crush of either, and the models take \
         the other vehicle for a rigid wall";
    warn_clipped:
        "{channels} may be clipped: HIC and 3 ms clip would then be larger than shown";
    about_record: "Record";
    about_model: "Model";
    about_predictions: "Predictions";
    about_occupants: "Occupants";
    about_wall_force: "Wall";
    about_identified_models: "Identified models";
    no_fault: "No fault was found in the record.";
    before_use: "Before you use this";
    allowed_label: "allowed";
    allowed: "{count} by the pipeline: {codes}";
    one_more: "1 more warning";
    more: "{count} more warnings";
    verdict: "Verdict";
    what_to_do: "What to do: {remedy}.";
    ground_label: "motion over ground";
    curve: "curve of {count} knots to {end}";
    as_one_spring: "as one spring k {stiffness}";
    given: "given";
    over_sensors: "; {count} sensors of the compartment: {range}";
    model_label: "recommended";
    doubtful_label: "model in doubt";
    warnings_label: "warnings";
    explains: "what contradicts, and what to do";
    failed_label: "not identified";
    missing_label: "not in it";
    files_label: "report";
}
