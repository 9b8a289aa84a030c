//! The model as a picture, and what is said below it.

texts! { ModelTexts
    title: "The model";
    caption:
        "Under a value its 95 % interval, if the model is true and mass, speed and gain are as stated. Determined: \
         known within a factor of ten. Dashed and “?”: not determined. Zigzag: \
         spring; box and piston: damper; small curve: force over deflection.";
    recommended_and_closest: "Recommended, and closest to the record";
    recommended: "Recommended for predictions";
    in_doubt: "In doubt";
    closest: "Closest to the record";
    closest_alone: "Closest to the record; none is recommended";
    no_structure:
        "No structure of masses and elements belongs to this model.";
    off_the_test:
        "It misses its own test by {crush} of crush, {time} of t<sub>m</sub>{restitution}; displacement fit {fit}.";
    and_restitution: ", {restitution} of restitution";
    follows: "Displacement fit {fit}.";
    one_spring:
        "One spring with the energy and the crush of the test: <strong>k\u{a0}=\u{a0}{stiffness}</strong>.";
    for_exact_mass: "; 95\u{a0}% intervals for an exact mass and gain";
    held_by_intervals: ", stretched to hold the value";
    at_most: "at most {end}";
    rating: "ISO/TS 18571 of the acceleration {value}{grade}.";
    decided_by:
        "Chosen by sensors {sensors}.";
    same_record:
        "{model} gives the same record on this sensor.";
    sensor_fitted:
        "Sensor {sensor} on mass {mass}, fitted too: {quantity} off by {error} rms.";
    sensor_not_seen:
        "Sensor {sensor} on mass {mass}, which the fit did not see: displacement off by {error} rms{fit}.";
    fit: ", fit {fit}";
    no_sensor_on_front:
        "No sensor on its front mass: nothing in this record tests how the mass is divided.";
    no_sensor_in_front:
        "No sensor on the masses in front: nothing in this record tests how the mass is divided.";
    limit_of_physical: "physical limit";
    above: "above {end}";
    below: "below {end}";
    open: "open";
    on_a_bound: "on a bound";
    not_determined: "not determined";
    loading: "loading";
    unloading: "unloading";
    up_to: "{symbol} up to {force} at {deflection}{doubt}";
    knots: "{count} knots";
    knots_determined:
        "{count} knots, {determined} of {asked} determined";
    the_barrier: "the barrier";
    the_mass: "the mass";
    mass_number: "mass {number}";
    mass_words: "Mass {symbol}: {values}.";
    spring: "Spring";
    damper: "Damper";
    spring_and_damper: "Spring and damper in series";
    curve: "Force-deflection curve";
    between: "{kind} between {front} and {rear}: {values}.";
    barrier: "barrier";
    quantity_displacement: "displacement";
    quantity_velocity: "velocity";
    quantity_acceleration: "acceleration";
}
