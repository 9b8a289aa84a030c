//! Figures of the crash: titles, axes, legends, captions.

texts! { FigureTexts
    all_names: "names of the hidden curves";
    curves_to_show: "Curves, to show or hide";
    time: "time after time zero, ms";
    acceleration: "acceleration, g";
    velocity: "velocity, km/h";
    displacement: "displacement, mm";
    force: "force, kN";
    deceleration: "deceleration, g (mass not known)";
    title: "Test and models";
    title_of_recorded: "What the recorder kept";
    velocity_change: "change of velocity, km/h";
    title_of_test: "The test: curves";
    title_of_first: "The pulse, and the force over crush";
    test_cfc: "test, CFC\u{a0}{cfc}";
    test_filtered: "test, filtered";
    test_as_read: "test, as read";
    as_read: "as read";
    same_place: "sensors at the same place: {channels}";
    rebound: "rebound, {time}";
    channel: "Channel {id}";
    unknown: "unknown";
    sign: ", SAE J211 sign: deceleration is negative.";
    filtered:
        " Filtered in mode {mode}. Click the unfiltered record in the legend to show it; it may exceed the axes.";
    integrated_from:
        " Velocity and displacement by the {rule} rule from {start}.";
    integrated: " Integrated by the {rule} rule.";
    no_crush_to_mark:
        " The velocity does not reach zero within the record: there is no dynamic crush to mark.";
    window:
        " Models are compared in the shaded window, {from} to {to}.";
    others_wait:
        " Click other models in the legend to show them. One curve stands for parameter sets that fit alike.";
    duals_once:
        " Parameter sets that give exactly the same record (duals) are drawn once.";
    recommended_and_closest: "recommended and closest: ";
    recommended: "recommended: ";
    closest: "closest: ";
    and_its_dual: "and its dual: same record";
    not_physical: "not physical";
    equal_energy: "equal-energy line (force over crush)";
    load_cells: "barrier load cells (force over crush)";
    loading:
        "Loading takes up {work}; a linear spring with the same work at the same crush has {stiffness}. ";
    unloading: "Unloading gives {work} back. ";
    force_is:
        "Force is the test mass times the deceleration of this sensor: the barrier force of a vehicle that moves as \
         one body.";
    no_force:
        "Deceleration instead of force: the record has neither mass nor force.";
    load_cells_differ:
        " The load cells measured it at the barrier: where the two part, the engine and other masses move otherwise \
         than this sensor.";
    elements: "Springs and dampers at work";
    compression_of_front: "compression of the front, mm";
    compression_between: "compression between the masses, mm";
    damper: "damper {name}";
    spring: "spring {name}";
    elements_one_mass:
        "Force in each spring and damper of {model}, against the compression of the front, over the compared window. \
         The area below a curve is the work the element takes up.";
    elements_masses:
        "Force in each spring and damper of {model}, against how far the masses at its ends have come together, over \
         the compared window. The area below a curve is the work the element takes up.";
    sensors: "Other sensors on the vehicle";
    sensors_caption:
        "Each sensor integrated from its own acceleration. A mass of a model is drawn over the sensor that sits on \
         it, for the best candidates, and the compartment of the best model over the pulse; sensors that the best \
         model was not compared with and no mass stands for wait in the legend.";
    pulse: "pulse {channel}";
    compartment_of: "compartment of {model}";
    mass_of: "mass {mass} of {model}";
    sensor: "sensor {channel}{place}";
    residual: "Test minus model";
    residual_displacement: "residual of the displacement, mm";
    residual_velocity: "residual of the velocity, km/h";
    residual_band:
        "recommended: 95 % band from its parameters";
    residual_caption:
        "The axes hold the largest residual inside the shaded window, which the models are compared over; a model \
         that was made for the loading phase may leave them after it. Of many models the first six are drawn.";
    mass_split:
        "Mass splits that a double model can have";
    mass_ratio: "mass ratio m2/m1 (compartment over chassis)";
    stiffness: "stiffness, kN/m";
    damping: "damping, kN·s/m";
    all_positive: "{name}, all four positive";
    another_negative: "{name}, another is negative";
    used: "used";
    only_up_to: "They exist only for m2/m1 up to {bound}.";
    no_division:
        "No division allows them: the identified polynomial is not that of a passive structure.";
    same_poles:
        "Parameter sets with the same poles as {source}, at the same total mass, {mass}. At another division the \
         poles are kept, the motion is not quite: fit again with --front-mass-fraction to see by how much.";
    real_solutions:
        "Real solutions of coefficient matching of {source} at the same total mass, {mass}.";
    mass_split_filled:
        "Filled: all four parameters are positive, and such divisions are shaded; negative values have no place on a \
         logarithmic axis.";
    used_is_among:
        "The assumed split, m2/m1 = {ratio}, is one of them.";
    used_is_not_among:
        "The assumed split, m2/m1 = {ratio}, is not one of them.";
}
