//! What verdict, warnings and console say.

texts! { ConclusionTexts
    crushed:
        "The vehicle was crushed by {crush}{interval} within {time} of an impact{speed}{rebound}.",
        "Das Fahrzeug wurde bei einem Aufprall{speed} in {time} um {crush}{interval} eingedrückt{rebound}.";
    at_speed: " at {speed}", " mit {speed}";
    reached: ", reached at {time}", ", erreicht nach {time}";
    within: " in {time}", " in {time}";
    level: "{percent}\u{a0}%: ", "{percent}\u{a0}%: ";
    interval: " ({level}{low} to {high})", " ({level}{low} bis {high})";
    interval_and_sensors:
        " ({level}{low} to {high}; {lowest} to {highest} over the sensors there)",
        " ({level}{low} bis {high}; {lowest} bis {highest} über die Sensoren dort)";
    rebounded:
        " and rebounded with {restitution} of that speed",
        " und prallte mit dem {restitution}-Fachen dieser Geschwindigkeit zurück";
    no_rebound: " and did not rebound", " und prallte nicht zurück";
    no_stop:
        "The vehicle did not stop within the record: it lost {change} in {time}, and its dynamic crush cannot be told.",
        "Das Fahrzeug kam in der Aufzeichnung nicht zum Stehen: Es verlor {change} in {time}, eine dynamische \
         Eindrückung gibt es nicht.";
    no_stop_no_end:
        "The vehicle did not stop within the record: its dynamic crush cannot be told.",
        "Das Fahrzeug kam in der Aufzeichnung nicht zum Stehen: Eine dynamische Eindrückung gibt es nicht.";
    two_vehicles:
        "Two vehicles collided: this one lost {change}{time}; its motion over ground is not its crush.",
        "Zwei Fahrzeuge stießen zusammen: Dieses verlor {change}{time}; sein Weg über Grund ist nicht seine \
         Eindrückung.";
    occupant:
        "The sensor sits in an occupant ({place}), not in the vehicle{criteria}.",
        "Der Aufnehmer sitzt in einem Insassen ({place}), nicht im Fahrzeug{criteria}.";
    occupant_use:
        "Crush, stiffness and models of such a record are those of the sensor: use none for the vehicle{bounds}.",
        "Eindrückung, Steifigkeit und Modelle einer solchen Aufzeichnung sind die des Aufnehmers: Keines gilt für das \
         Fahrzeug{bounds}.";
    lower_bounds:
        "; the criteria are lower bounds, since not all axes were measured",
        "; die Kriterien sind untere Schranken, da nicht alle Achsen gemessen wurden";
    recorded:
        "The recorder kept a change of velocity of {change}{time}.",
        "Das Aufzeichnungsgerät hielt eine Geschwindigkeitsänderung von {change} fest{time}.";
    recorder_use:
        "No peak and no force can be taken from such a coarse table{crush}{none}.",
        "Spitzenwert und Kraft lassen sich aus einer so groben Tabelle nicht ablesen{crush}{none}.";
    recorder_without_model:
        "; no model is recommended, use none at another speed",
        "; kein Modell wird empfohlen, keines gilt bei anderer Geschwindigkeit";
    rough_crush:
        "; the crush of {crush}{interval} made from it is rough",
        "; die daraus gebildete Eindrückung von {crush}{interval} ist grob";
    identified: "{model} follows {fit} of the record{mode}.", "{model} folgt der Aufzeichnung zu {fit}{mode}.";
    damping: ", damping ratio {ratio}", ", Dämpfungsgrad {ratio}";
    mode:
        "; its slowest mode is at {frequency}{damping}",
        "; die langsamste Eigenschwingung liegt bei {frequency}{damping}";
    identified_use:
        "It holds for the amplitudes and frequencies that this record excited; what it says beyond is extrapolation.",
        "Es gilt für die Amplituden und Frequenzen, die diese Aufzeichnung anregte; alles darüber hinaus ist \
         Extrapolation.";
    not_stated_both:
        "The record states neither mass nor impact speed, as allowed: there is no crush, no force and no stiffness.",
        "Masse und Aufprallgeschwindigkeit sind nicht angegeben, wie erlaubt: keine Eindrückung, keine Kraft, keine \
         Steifigkeit.";
    not_stated_mass:
        "The record states no mass, as allowed: there is no force and no stiffness.",
        "Die Masse ist nicht angegeben, wie erlaubt: keine Kraft, keine Steifigkeit.";
    not_stated_speed:
        "The record states no impact speed, as allowed: there is no crush, no force and no stiffness.",
        "Die Aufprallgeschwindigkeit ist nicht angegeben, wie erlaubt: keine Eindrückung, keine Kraft, keine \
         Steifigkeit.";
    not_stated_use:
        "A linear model alone was identified: {model} follows {fit} of the pulse{mode}.",
        "Nur ein lineares Modell wurde identifiziert: {model} folgt dem Puls zu {fit}{mode}.";
    no_model: "There is no model: {reason}.", "Es gibt kein Modell: {reason}.";
    read_the_notes:
        "the notes of the run say more: just notes, and the folder of the run",
        "die Anmerkungen des Laufs sagen mehr: just notes und der Ordner des Laufs";
    measured_only:
        "This report holds no motion of a vehicle.",
        "Dieser Bericht enthält keine Bewegung eines Fahrzeugs.";
    no_models_here:
        "It holds no models: their stages did not run.",
        "Er enthält keine Modelle: Deren Stufen liefen nicht.";
    use_model:
        "For predictions use {model}{determined}{follows}{predicts}{distrust}.",
        "Für Vorhersagen gilt {model}{determined}{follows}{predicts}{distrust}.";
    determined: "{determined} of {parameters} numbers determined", "{determined} von {parameters} Zahlen bestimmt";
    order_of_magnitude: ", {count} to an order of magnitude", ", {count} der Größenordnung nach";
    open: ", {count} open", ", {count} offen";
    follows: ": it follows the displacement to {fit}", ": Es folgt dem Weg zu {fit}";
    predicts:
        " and predicts a crush of {crush}{interval} at {speed}",
        " und sagt bei {speed} eine Eindrückung von {crush}{interval} voraus";
    usable:
        "; within what was tested it may be used: at {speed} it predicts a crush of {crush}{interval}",
        "; im erprobten Bereich ist es brauchbar: Bei {speed} sagt es eine Eindrückung von {crush}{interval} voraus";
    predicts_beyond:
        "; beyond what was tested, at {speed}, it predicts a crush of {crush}{interval}",
        "; jenseits des Erprobten, bei {speed}, sagt es eine Eindrückung von {crush}{interval} voraus";
    other_partner:
        "it against anything but this other vehicle, which it takes for a rigid wall",
        "jeder andere Partner als dieses zweite Fahrzeug, das es für eine starre Wand nimmt";
    predicts_collision:
        " and predicts against {partner} a crush of {crush}{interval}",
        " und sagt gegen {partner} eine Eindrückung von {crush}{interval} voraus";
    none_recommended:
        "No model is recommended, use none at another speed: {because}{closest}.",
        "Kein Modell wird empfohlen, keines gilt bei anderer Geschwindigkeit: {because}{closest}.";
    no_crush:
        "the vehicle was not seen to stop, and what was not measured no model knows",
        "das Fahrzeug wurde nicht zum Stehen kommend gemessen, und was nicht gemessen ist, weiß kein Modell";
    other_axis:
        "the pulse is along {axis}, and the models are of a crush along x",
        "der Puls liegt in {axis}, und die Modelle sind solche einer Eindrückung in x";
    closest:
        "; the closest, {model}, follows the displacement to {fit} up to {time} and says nothing beyond",
        "; das nächste, {model}, folgt dem Weg zu {fit} bis {time} und sagt darüber hinaus nichts";
    distrust: "; distrust {what}", "; mit Vorsicht zu nehmen: {what}";
    open_numbers: "{names}, which this record leaves open", "{names}, von dieser Aufzeichnung offen gelassen";
    dual:
        "the division of its masses, since its mirror image gives the same record",
        "die Aufteilung der Massen, denn das Spiegelbild ergibt dieselbe Aufzeichnung";
    hardly: "{names}, known to an order of magnitude only", "{names}, nur der Größenordnung nach bekannt";
    extrapolates:
        "it above the {speed} of the test, where it extrapolates",
        "alles über {speed}, der Geschwindigkeit des Versuchs: Dort wird extrapoliert";
    decisive: "all of it until the first warning is settled", "alles, bis die erste Warnung geklärt ist";
    and: "and", "und";
    force_at: "the force at {deflection}", "die Kraft bei {deflection}";
    forces_at: "the forces at {deflection}", "die Kräfte bei {deflection}";
    sensors_differ:
        "the sensors of the compartment give a crush of {low} to {high}: they differ by more than the interval of one \
         says",
        "die Aufnehmer der Fahrgastzelle ergeben eine Eindrückung von {low} bis {high}: Sie weichen stärker \
         voneinander ab, als das Intervall des einen besagt";
    warn_open:
        "{names} of the recommended {model} may be anything as far as this record tells",
        "{names} des empfohlenen Modells {model} kann nach dieser Aufzeichnung alles sein";
    warn_hardly:
        "of the recommended {model} the record gives {names} to an order of magnitude only",
        "vom empfohlenen Modell {model} gibt die Aufzeichnung {names} nur der Größenordnung nach an";
    warn_dual:
        "the recommended {model} has a mirror image that gives exactly the same record; a second sensor, on the front \
         or the engine, decides between them",
        "das empfohlene Modell {model} hat ein Spiegelbild mit genau derselben Aufzeichnung; ein zweiter Aufnehmer, \
         am Vorderwagen oder am Motor, entscheidet";
    warn_closest:
        "the closest model, {model}, leaves {open} of its {parameters} numbers open: its curve may be used, its \
         numbers not",
        "das nächste Modell, {model}, lässt {open} von {parameters} Zahlen offen: Seine Kurve ist brauchbar, seine \
         Zahlen sind es nicht";
    warn_extrapolates:
        "predictions above {speed} go beyond what was tested",
        "Vorhersagen über {speed} gehen über das Geprüfte hinaus";
    warn_two_vehicles:
        "a collision of two vehicles: the displacement over ground is not the crush of either, and the models take \
         the other vehicle for a rigid wall",
        "ein Zusammenstoß zweier Fahrzeuge: Der Weg über Grund ist keines Fahrzeugs Eindrückung, und die Modelle \
         nehmen das andere für eine starre Wand";
    warn_clipped:
        "{channels} may be clipped: HIC and 3 ms clip would then be larger than shown",
        "vielleicht abgeschnitten: {channels}; HIC und 3-ms-Wert wären dann größer als angegeben";
    about_record: "Record", "Aufzeichnung";
    about_model: "Model", "Modell";
    about_predictions: "Predictions", "Vorhersagen";
    about_occupants: "Occupants", "Insassen";
    about_wall_force: "Wall force", "Wandkraft";
    about_identified_models: "Identified models", "Identifizierte Modelle";
    no_fault: "No fault was found in the record.", "Ein Fehler der Aufzeichnung wurde nicht gefunden.";
    before_use: "Before you use this", "Vor dem Gebrauch";
    one_more: "1 more warning", "1 weitere Warnung";
    more: "{count} more warnings", "{count} weitere Warnungen";
    verdict: "Verdict", "Urteil";
    what_to_do: "What to do: {remedy}.", "Abhilfe: {remedy}.";
    crush_label: "dynamic crush", "Eindrückung";
    ground_label: "motion over ground", "Weg über Grund";
    time_label: "time of crush", "Zeit bis dahin";
    change_label: "delta-v", "Delta-v";
    restitution_label: "restitution", "Stoßzahl";
    peak_label: "peak", "Spitzenwert";
    olc_label: "OLC", "OLC";
    curve: "curve of {count} knots to {end}", "Kurve mit {count} Stützstellen bis {end}";
    as_one_spring: "as one spring k {stiffness}", "als eine Feder k {stiffness}";
    given: "given", "vorgegeben";
    over_sensors: "; {range} over the sensors there", "; {range} über die Sensoren dort";
    model_label: "recommended", "empfohlen";
    warnings_label: "warnings", "Warnungen";
    missing_label: "not in it", "fehlt darin";
    files_label: "report", "Bericht";
}
