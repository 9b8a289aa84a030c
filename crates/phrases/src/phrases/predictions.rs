//! Impacts that were not made.

texts! { PredictionTexts
    title: "Predictions", "Vorhersagen";
    at_other_speeds: "At other speeds", "Bei anderen Geschwindigkeiten";
    speed_head: "km/h", "km/h";
    crush_head: "crush, mm", "Eindrückung, mm";
    peak_head: "peak, g", "Spitze, g";
    range_head: "test", "Versuch";
    inside: "inside", "darin";
    as_tested: "as tested", "wie geprüft";
    beyond: "beyond", "jenseits";
    by_the_record: "{peak} by the record", "{peak} aus der Aufzeichnung";
    all_predictions: "all predictions", "alle Vorhersagen";
    speed: "Speed, km/h", "Geschwindigkeit, km/h";
    mass: "Mass, kg", "Masse, kg";
    model: "Model", "Modell";
    dynamic_crush: "Dynamic crush, mm", "Dynamische Eindrückung, mm";
    time: "t<sub>m</sub>, ms", "t<sub>m</sub>, ms";
    change: "Δv, km/h", "Δv, km/h";
    peak: "Peak (CFC 60), g", "Spitzenwert (CFC 60), g";
    olc: "OLC, g", "OLC, g";
    remarks_head: "Remarks", "Bemerkungen";
    caption:
        "The models of this test at other speeds and masses, against the same wall where nothing else is said. In \
         brackets the 90 % interval: of the parameters as measured, of the inputs, of what adequate models differ by, \
         of a rate effect that one test hardly shows, and of the force beyond the tested crush. Not in it: a part that \
         was not reached, another failure mode, another overlap. Highlighted is the recommended model.",
        "Die Modelle dieses Versuchs bei anderen Geschwindigkeiten und Massen, gegen dieselbe Wand, wo nichts anderes \
         steht. In Klammern das 90-%-Intervall: aus den Parametern wie gemessen, den Eingaben, den Unterschieden \
         angemessener Modelle, einem Geschwindigkeitseinfluss, den ein Versuch kaum zeigt, und der Kraft jenseits der \
         geprüften Eindrückung. Nicht darin: ein nicht erreichtes Bauteil, ein anderes Versagen, eine andere \
         Überdeckung. Hervorgehoben ist das empfohlene Modell.";
    asked: "asked for", "angefragt";
    interval: "[{low} to {high}]", "[{low} bis {high}]";
    extrapolates: "extrapolates", "extrapoliert";
    remarks: "remarks", "Bemerkungen";
    a_partner: "a partner", "einen Partner";
    collision:
        "against {partner}, {mass} kg, closing at {closing} km/h: common velocity {common} km/h, mutual crush \
         {mutual} mm, of it the partner’s {crush} mm; energy {energy} and {energy_of_partner} kJ; partner’s Δv \
         {change} km/h",
        "gegen {partner}, {mass} kg, Annäherung mit {closing} km/h: gemeinsame Geschwindigkeit {common} km/h, \
         gemeinsame Eindrückung {mutual} mm, davon des Partners {crush} mm; Energie {energy} und {energy_of_partner} \
         kJ; Δv des Partners {change} km/h";
    occupant:
        "occupant: peak {peak} g, {excursion} mm ahead of the compartment, ride-down {share} %",
        "Insasse: Spitzenwert {peak} g, {excursion} mm vor der Fahrgastzelle, Ride-down {share} %";
}
