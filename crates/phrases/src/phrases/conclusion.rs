//! What verdict, warnings and console say.

texts! { ConclusionTexts
    usable: "usable", "brauchbar";
    usable_with_care: "usable with care", "mit Vorsicht brauchbar";
    do_not_use: "do not use", "nicht verwenden";
    status: "{status}: {reason}.", "{status}: {reason}.";
    because_good_to:
        "the crush {scenario} is known to ±{good_to}",
        "die Eindrückung {scenario} ist auf ±{good_to} bekannt";
    because_beyond:
        "{scenario}, beyond the test, the crush is known to ±{good_to}",
        "{scenario}, jenseits des Versuchs, ist die Eindrückung auf ±{good_to} bekannt";
    because_sensors:
        "the crush is known to ±{apart}, not ±{half_width}: {count} sensors of the compartment differ",
        "die Eindrückung ist auf ±{apart} bekannt, nicht auf ±{half_width}: {count} Aufnehmer der Fahrgastzelle \
         weichen voneinander ab";
    because_few_forces:
        "use its crush, not its forces: the record determines {determined} of {parameters}",
        "seine Eindrückung gilt, seine Kräfte nicht: die Aufzeichnung bestimmt {determined} von {parameters}";
    because_few_parameters:
        "use its crush, not its parameters: the record determines {determined} of {parameters}",
        "seine Eindrückung gilt, seine Parameter nicht: die Aufzeichnung bestimmt {determined} von {parameters}";
    because_unassessed:
        "the parameters of the model have no intervals",
        "die Parameter des Modells haben keine Intervalle";
    because_dual:
        "use its crush, not its mass split: one sensor cannot identify the split",
        "seine Eindrückung gilt, seine Massenaufteilung nicht: ein Aufnehmer kann sie nicht identifizieren";
    because_misses_its_test:
        "use its crush only: the model misses the {events} of its own test",
        "nur seine Eindrückung gilt: das Modell verfehlt den eigenen Versuch in {events}";
    because_weak:
        "the evidence is weak: {model} fits nearly as well",
        "die Belege sind schwach: {model} passt fast ebenso gut";
    because_contrary:
        "chosen for its crush at lower speeds: {model} follows the pulse closer",
        "gewählt für seine Eindrückung bei kleinerer Geschwindigkeit: {model} folgt dem Puls enger";
    because_no_interval:
        "the crush at other speeds has no interval",
        "seine Eindrückung bei anderer Geschwindigkeit hat kein Intervall";
    because_tests_disagree: "the tests disagree", "die Versuche widersprechen sich";
    because_no_stop:
        "use its delta-v: the vehicle did not stop within the record",
        "das Delta-v gilt: das Fahrzeug kam in der Aufzeichnung nicht zum Stehen";
    because_other_axis:
        "use its delta-v: the pulse is along {axis}, the models are of a crush along x",
        "das Delta-v gilt: der Puls liegt in {axis}, die Modelle sind solche einer Eindrückung in x";
    because_two_vehicles:
        "use its delta-v: its motion over ground is not its crush",
        "das Delta-v gilt: der Weg über Grund ist nicht die Eindrückung";
    because_occupant:
        "use the criteria of the occupant, nothing for the vehicle",
        "die Kriterien des Insassen gelten, nichts für das Fahrzeug";
    because_recorder:
        "use its delta-v, not its forces: the table is coarse",
        "das Delta-v gilt, die Kräfte nicht: die Tabelle ist grob";
    because_identified:
        "for the amplitudes and frequencies that this record excited",
        "für die Amplituden und Frequenzen, die diese Aufzeichnung anregte";
    because_no_mass: "no mass is stated: use the motion", "keine Masse ist angegeben: die Bewegung gilt";
    because_no_speed:
        "no impact speed is stated: use delta-v and pulse",
        "keine Aufprallgeschwindigkeit ist angegeben: Delta-v und Puls gelten";
    because_no_mass_nor_speed:
        "neither mass nor impact speed is stated: use delta-v and pulse",
        "weder Masse noch Aufprallgeschwindigkeit ist angegeben: Delta-v und Puls gelten";
    because_measured_only:
        "use what was measured: no model was fitted",
        "das Gemessene gilt: kein Modell wurde angepasst";
    because_none_recommended:
        "use what was measured: no model is for other speeds",
        "das Gemessene gilt: kein Modell ist für andere Geschwindigkeiten";
    because_no_result: "there is no acceptable result", "es gibt kein annehmbares Ergebnis";
    because_decisive:
        "{subject} is in doubt, see warning {number}",
        "{subject} steht in Zweifel, siehe Warnung {number}";
    the_pulse: "the pulse", "der Puls";
    the_mass: "the mass", "die Masse";
    the_impact_speed: "the impact speed", "die Aufprallgeschwindigkeit";
    the_time_axis: "the time axis", "die Zeitachse";
    the_motion: "the motion", "die Bewegung";
    the_model: "the model", "das Modell";
    the_identified_models: "every identified model", "jedes identifizierte Modell";
    the_record: "the record", "die Aufzeichnung";
    because_not_adequate: "no model is adequate", "kein Modell ist angemessen";
    because_poor_fit:
        "the fit of the best model is {fit}, below {limit}",
        "die Anpassung des besten Modells ist {fit}, unter {limit}";
    scenario: "at {speed}{mass}{partner}", "bei {speed}{mass}{partner}";
    with_mass: " with {mass}", " mit {mass}";
    against_partner: " against {partner}", " gegen {partner}";
    crushed:
        "The vehicle was crushed by {crush} within {time}{rebound}.",
        "Das Fahrzeug wurde in {time} um {crush} eingedrückt{rebound}.";
    reached: ", reached at {time}", ", erreicht nach {time}";
    within: " within {time}", " in {time}";
    level: "{percent}\u{a0}%: ", "{percent}\u{a0}%: ";
    interval: " ({low} to {high})", " ({low} bis {high})";
    rebounded: " and rebounded at {speed}", " und prallte mit {speed} zurück";
    no_rebound: " and did not rebound", " und prallte nicht zurück";
    no_stop:
        "The vehicle did not stop within the record: it lost {change} in {time}.",
        "Das Fahrzeug kam in der Aufzeichnung nicht zum Stehen: Es verlor {change} in {time}.";
    no_stop_no_end:
        "The vehicle did not stop within the record.",
        "Das Fahrzeug kam in der Aufzeichnung nicht zum Stehen.";
    two_vehicles:
        "Two vehicles collided: this one lost {change}{time}.",
        "Zwei Fahrzeuge stießen zusammen: Dieses verlor {change}{time}.";
    occupant:
        "The sensor sits in an occupant ({place}), not in the vehicle{criteria}.",
        "Der Aufnehmer sitzt in einem Insassen ({place}), nicht im Fahrzeug{criteria}.";
    occupant_use:
        "Do not use its crush, stiffness and models for the vehicle{bounds}.",
        "Eindrückung, Steifigkeit und Modelle gelten nicht für das Fahrzeug{bounds}.";
    lower_bounds:
        "; the criteria are lower bounds, since not all axes were measured",
        "; die Kriterien sind untere Schranken, da nicht alle Achsen gemessen wurden";
    recorded:
        "The recorder kept a delta-v of {change}{time}.",
        "Das Aufzeichnungsgerät hielt ein Delta-v von {change} fest{time}.";
    recorder_use:
        "Its table is too coarse for peak and force{crush}{none}.",
        "Seine Tabelle ist zu grob für Spitzenwert und Kraft{crush}{none}.";
    recorder_without_model: "; no model is recommended", "; kein Modell wird empfohlen";
    rough_crush: "; its crush of {crush}{interval} is rough", "; ihre Eindrückung von {crush}{interval} ist grob";
    identified:
        "The closest identified model, {model}, has a fit of {fit}{unseen}{mode}.",
        "Das nächste identifizierte Modell, {model}, hat eine Anpassung von {fit}{unseen}{mode}.";
    unseen: " (unseen samples: {fit})", " (ungesehene Werte: {fit})";
    identified_fails:
        "No identified model holds: the best, {model}, has a fit of {fit}{unseen}.",
        "Kein identifiziertes Modell hält: Das beste, {model}, hat eine Anpassung von {fit}{unseen}.";
    identified_none:
        "No identified model has a fit.",
        "Kein identifiziertes Modell hat eine Anpassung.";
    identified_no_use:
        "Do not use it: its modes are not known to be those of what was measured.",
        "Es ist nicht zu verwenden: Seine Eigenschwingungen sind nicht nachweislich die des Gemessenen.";
    damping: ", damping ratio {ratio}", ", Dämpfungsgrad {ratio}";
    mode:
        "; its slowest mode is at {frequency}{damping}",
        "; die langsamste Eigenschwingung liegt bei {frequency}{damping}";
    changed:
        "The record gives a delta-v of {change}{time}{peak}{olc}.",
        "Die Aufzeichnung gibt ein Delta-v von {change}{time}{peak}{olc}.";
    and_peak: ", a peak of {peak}", ", einen Spitzenwert von {peak}";
    and_olc: ", an OLC of {olc}", ", eine OLC von {olc}";
    not_stated_both:
        "Mass and impact speed are missing, so there is no crush and no force: add --mass and --impact-speed.",
        "Masse und Aufprallgeschwindigkeit fehlen, daher keine Eindrückung und keine Kraft: --mass und \
         --impact-speed angeben.";
    not_stated_mass:
        "The mass is missing, so there is no force and no stiffness: add --mass.",
        "Die Masse fehlt, daher keine Kraft und keine Steifigkeit: --mass angeben.";
    not_stated_speed:
        "The impact speed is missing, so there is no crush and no stiffness: add --impact-speed.",
        "Die Aufprallgeschwindigkeit fehlt, daher keine Eindrückung und keine Steifigkeit: --impact-speed angeben.";
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
    one_spring:
        "One spring of {stiffness} has the same energy and crush.",
        "Eine Feder von {stiffness} hat dieselbe Energie und Eindrückung.";
    use_model: "For other speeds use {model}{predicts}.", "Für andere Geschwindigkeiten gilt {model}{predicts}.";
    asked_for:
        "Asked for: {scenario} {model} gives {crush}{interval}.",
        "Angefragt: {scenario} ergibt {model} {crush}{interval}.";
    force_deflection_curve: "the force-deflection curve", "die Kraft-Weg-Kurve";
    named_model: "the {model} model", "das Modell {model}";
    predicts: ": {scenario} it gives {crush}{interval}", ": {scenario} Eindrückung {crush}{interval}";
    predicts_beyond:
        ": {scenario}, beyond the test, it gives {crush}{interval}",
        ": {scenario}, jenseits des Versuchs, Eindrückung {crush}{interval}";
    determined: "{determined} of {parameters} numbers determined", "{determined} von {parameters} Zahlen bestimmt";
    order_of_magnitude: ", {count} to an order of magnitude", ", {count} der Größenordnung nach";
    open: ", {count} open", ", {count} offen";
    other_partner:
        "It takes the other vehicle for a rigid wall: do not use it against anything else.",
        "Es nimmt das andere Fahrzeug für eine starre Wand: Gegen anderes gilt es nicht.";
    none_recommended: "No model is recommended: {because}.", "Kein Modell wird empfohlen: {because}.";
    no_crush:
        "the vehicle was not seen to stop",
        "das Fahrzeug wurde nicht zum Stehen kommend gemessen";
    other_axis:
        "the pulse is along {axis}, and the models are of a crush along x",
        "der Puls liegt in {axis}, und die Modelle sind solche einer Eindrückung in x";
    closest:
        "The closest, {model}, has a displacement fit of {fit} up to {time}.",
        "Das nächste, {model}, hat bis {time} eine Anpassung des Wegs von {fit}.";
    open_numbers:
        "Not identifiable from this record: {names}.",
        "Aus dieser Aufzeichnung nicht identifizierbar: {names}.";
    dual:
        "The mass split cannot be identified from one sensor: a mirrored (dual) model fits equally well.",
        "Die Massenaufteilung ist mit einem Aufnehmer nicht identifizierbar: Ein gespiegeltes (duales) Modell passt \
         ebenso gut.";
    few_forces:
        "Use its crush, not its forces: the record determines only {determined} of {parameters}.",
        "Seine Eindrückung gilt, seine Kräfte nicht: Die Aufzeichnung bestimmt nur {determined} von {parameters}.";
    few_parameters:
        "Use its crush, not its parameters: the record determines only {determined} of {parameters}.",
        "Seine Eindrückung gilt, seine Parameter nicht: Die Aufzeichnung bestimmt nur {determined} von {parameters}.";
    extrapolates:
        "Above {speed}, the speed of the test, it extrapolates.",
        "Über {speed}, der Geschwindigkeit des Versuchs, extrapoliert es.";
    and: "and", "und";
    force_at: "the force at {deflection}", "die Kraft bei {deflection}";
    forces_at: "the forces at {deflection}", "die Kräfte bei {deflection}";
    sensors_differ:
        "{count} sensors of the compartment give a crush of {low} to {high}: quote the range",
        "{count} Aufnehmer der Fahrgastzelle ergeben eine Eindrückung von {low} bis {high}: den Bereich angeben";
    warn_open:
        "{model}, recommended: not identifiable from this record: {names}",
        "{model}, empfohlen: aus dieser Aufzeichnung nicht identifizierbar: {names}";
    warn_hardly:
        "{model}, recommended: known to an order of magnitude only: {names}",
        "{model}, empfohlen: nur der Größenordnung nach bekannt: {names}";
    warn_dual:
        "a mirrored (dual) model fits as well as {model}: a second sensor, on the front or the engine, decides between \
         them",
        "ein gespiegeltes (duales) Modell passt ebenso gut wie {model}: ein zweiter Aufnehmer, am Vorderwagen oder am \
         Motor, entscheidet";
    warn_extrapolates:
        "predictions above {speed} go beyond the test",
        "Vorhersagen über {speed} gehen über den Versuch hinaus";
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
    about_wall_force: "Wall", "Wand";
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
    over_sensors: "; {count} sensors of the compartment: {range}", "; {count} Aufnehmer der Fahrgastzelle: {range}";
    model_label: "recommended", "empfohlen";
    doubtful_label: "model in doubt", "Modell, fraglich";
    warnings_label: "warnings", "Warnungen";
    failed_label: "not identified", "nicht identifiziert";
    missing_label: "not in it", "fehlt darin";
    files_label: "report", "Bericht";
}
