//! Impacts that were not made.

texts! { PredictionTexts
    title: "Predictions";
    at_other_speeds: "At other speeds";
    speed_head: "km/h";
    crush_head: "crush, mm";
    peak_head: "peak, g";
    range_head: "test";
    inside: "inside";
    as_tested: "as tested";
    beyond: "beyond";
    by_the_record: "{peak}*";
    peak_caption:
        "* Peak read from the test up to this energy, not from the model.";
    all_predictions: "all predictions";
    speed: "Speed, km/h";
    mass: "Mass, kg";
    model: "Model";
    dynamic_crush: "Dynamic crush, mm";
    time: "t<sub>m</sub>, ms";
    change: "Δv, km/h";
    peak: "Peak (CFC 60), g";
    olc: "OLC, g";
    remarks_head: "Remarks";
    caption:
        "The models of this test at other speeds and masses, against the same wall where nothing else is said. In \
         brackets the 90 % interval: of the parameters as measured, of the inputs, of what adequate models differ by, \
         of a rate effect that one test hardly shows, and of the force beyond the tested crush. Not in it: a part that \
         was not reached, another failure mode, another overlap. Highlighted is the chosen model.";
    asked: "asked for";
    interval: "[{low} to {high}]";
    extrapolates: "extrapolates";
    remarks: "remarks";
    a_partner: "a partner";
    collision:
        "against {partner}, {mass} kg, closing at {closing} km/h: common velocity {common} km/h, mutual crush \
         {mutual} mm, of it the partner’s {crush} mm; energy {energy} and {energy_of_partner} kJ; partner’s Δv \
         {change} km/h";
    occupant:
        "occupant: peak {peak} g, {excursion} mm ahead of the compartment, ride-down {share} %";
}
