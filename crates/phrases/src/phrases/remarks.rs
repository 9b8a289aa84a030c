//! What is missing, notes, what the result can and cannot say, provenance.

texts! { RemarkTexts
    missing: "Not in this report", "Nicht in diesem Bericht";
    no_description:
        "the test description (crumple-ingest writes it)",
        "die Beschreibung des Versuchs (crumple-ingest schreibt sie)";
    no_crash:
        "motion, events and physical parameters: no channel is named as a pulse (crumple-ingest --channel names one)",
        "Bewegung, Ereignisse und physikalische Parameter: Kein Kanal ist als Puls benannt (crumple-ingest --channel \
         benennt einen)";
    no_pulse:
        "the crash pulse: the test names none of its channels (crumple-ingest --channel does)",
        "der Crashpuls: Der Versuch nennt keinen seiner Kanäle (crumple-ingest --channel tut es)";
    no_raw:
        "acceleration as read (crumple-ingest writes it)",
        "Beschleunigung wie gelesen (crumple-ingest schreibt sie)";
    no_filtered:
        "filtered acceleration (crumple-filter writes it)",
        "gefilterte Beschleunigung (crumple-filter schreibt sie)";
    no_events:
        "crash events, velocity, displacement and metrics (crumple-integrate writes them)",
        "Ereignisse des Crashs, Geschwindigkeit, Weg und Kenngrößen (crumple-integrate schreibt sie)";
    no_motion:
        "vehicle motion: see the notes of integrate",
        "Fahrzeugbewegung: siehe die Anmerkungen von integrate";
    no_motion_without_speed:
        "vehicle motion: the record has no impact speed (add --impact-speed)",
        "Fahrzeugbewegung: Die Aufzeichnung hat keine Aufprallgeschwindigkeit (--impact-speed angeben)";
    no_displacement:
        "velocity and displacement (crumple-integrate writes them)",
        "Geschwindigkeit und Weg (crumple-integrate schreibt sie)";
    no_models:
        "identified models (crumple-identify writes them)",
        "identifizierte Modelle (crumple-identify schreibt sie)";
    no_parameters:
        "physical parameters (crumple-parameter-solve writes them)",
        "physikalische Parameter (crumple-parameter-solve schreibt sie)";
    no_responses:
        "ranking: the candidates were not simulated (run crumple-simulate)",
        "Rangfolge: Die Kandidaten wurden nicht simuliert (crumple-simulate aufrufen)";
    without_parameters:
        "the parameters of {count} simulated candidates (crumple-parameter-solve writes them)",
        "die Parameter von {count} simulierten Kandidaten (crumple-parameter-solve schreibt sie)";
    by_fit_alone:
        "by the displacement fit alone: the artifacts hold no /recommendation (crumple-parameter-solve writes it)",
        "allein nach der Anpassung des Wegs: Die Artefakte enthalten keine /recommendation (crumple-parameter-solve \
         schreibt sie)";
    other_axis:
        "channel {channel} is along {axis}, and the models are of a crush along x",
        "Kanal {channel} liegt in {axis}, und die Modelle sind solche einer Eindrückung in x";
    no_end_of_crush:
        "the record shows no crush that comes to an end: its velocity never reaches zero",
        "die Aufzeichnung zeigt keine Eindrückung, die zu Ende kommt: Die Geschwindigkeit wird nie null";
    notes_title: "Warnings and notes", "Warnungen und Anmerkungen";
    words_of_stages:
        "Remarks of the stages are quoted in English.",
        "Bemerkungen der Stufen stehen in Anführungszeichen und auf Englisch.";
    one_warning: "1 warning", "1 Warnung";
    of_other_candidates:
        "{count} of them on candidates that are neither recommended nor simplest nor closest",
        "{count} davon zu Kandidaten, die weder empfohlen noch einfachstes noch nächstes sind";
    warnings:
        "{count} warnings, those first that change most of what is shown",
        "{count} Warnungen, zuerst die, die am meisten am Gezeigten ändern";
    notes: "{count} notes", "{count} Anmerkungen";
    limits: "What this can and cannot say", "Was sich daraus sagen lässt und was nicht";
    one_sensor_dual:
        "One compartment accelerometer cannot tell a double-mass parameter set from its dual: both give exactly the \
         same record, so the fit cannot choose between them. A second sensor on the front, on the engine or the \
         firewall, decides.",
        "Ein Beschleunigungsaufnehmer in der Fahrgastzelle kann einen Parametersatz zweier Massen nicht von seinem \
         dualen unterscheiden: Beide ergeben genau dieselbe Aufzeichnung, die Anpassung kann nicht wählen. Ein zweiter \
         Aufnehmer vorn, am Motor oder an der Stirnwand, entscheidet.";
    generic_limit:
        "A model describes the record it was fitted to, over the amplitudes and frequencies that its input excited; \
         what it predicts elsewhere is extrapolation.",
        "Ein Modell beschreibt die Aufzeichnung, an die es angepasst wurde, in den Amplituden und Frequenzen, die \
         deren Eingang anregte; was es anderswo vorhersagt, ist Extrapolation.";
    linear_limit:
        "A linear model of a crash is a model of the loading phase: a structure that has been crushed does not spring \
         back as it came.",
        "Ein lineares Modell eines Crashs ist eines der Belastungsphase: Eine eingedrückte Struktur federt nicht \
         zurück, wie sie kam.";
    compared_window:
        " Models are compared with the test from {from} to {to} ms after time zero; what they do later is \
         extrapolation.",
        " Verglichen werden Modelle und Versuch von {from} bis {to} ms nach dem Zeitnullpunkt; was sie später tun, \
         ist Extrapolation.";
    read_from_one:
        "All results come from one sensor and treat the vehicle as a rigid body.",
        "Alle Ergebnisse stammen von einem Aufnehmer und behandeln das Fahrzeug als starren Körper.";
    read_from_one_fitted_to_channel:
        "Crush and events are read from one sensor (models of several masses were fitted to channel {channels} too), \
         with the vehicle taken for a body that moves as one.",
        "Eindrückung und Ereignisse stammen von einem Aufnehmer (Modelle mehrerer Massen wurden auch an Kanal \
         {channels} angepasst), das Fahrzeug als ein Körper genommen, der sich als Ganzes bewegt.";
    read_from_one_fitted_to_channels:
        "Crush and events are read from one sensor (models of several masses were fitted to channels {channels} too), \
         with the vehicle taken for a body that moves as one.",
        "Eindrückung und Ereignisse stammen von einem Aufnehmer (Modelle mehrerer Massen wurden auch an die Kanäle \
         {channels} angepasst), das Fahrzeug als ein Körper genommen, der sich als Ganzes bewegt.";
    crush_is:
        " Crush is the displacement of that sensor, double-integrated: an error of its zero level grows with the \
         square of time. It is dynamic crush; the crush that remains after the test cannot be had from an \
         accelerometer.",
        " Die Eindrückung ist der Weg dieses Aufnehmers, zweifach integriert: Ein Fehler seines Nullpunkts wächst mit \
         dem Quadrat der Zeit. Es ist die dynamische Eindrückung; die bleibende lässt sich aus einem \
         Beschleunigungsaufnehmer nicht gewinnen.";
    no_kelvin:
        "t_c/t_m is {ratio}, above 2/π = {bound}: no Kelvin model with damping has such a pulse, and one labelled as \
         undamped is a reduction to the nearest that exists.",
        "t_c/t_m ist {ratio}, über 2/π = {bound}: Kein gedämpftes Kelvin-Modell hat einen solchen Puls, und ein als \
         ungedämpft bezeichnetes ist auf das nächste zurückgeführt, das es gibt.";
    does_not_stop:
        "The velocity does not reach zero within the record. This is a valid result: the vehicle was still moving \
         forward when the record ended, so dynamic crush, restitution and all that builds on them are absent.{end}",
        "Die Geschwindigkeit wird in der Aufzeichnung nicht null. Das ist ein gültiges Ergebnis: Das Fahrzeug bewegte \
         sich am Ende der Aufzeichnung noch vorwärts; dynamische Eindrückung, Stoßzahl und alles, was darauf beruht, \
         fehlen.{end}";
    end_of_event:
        " Its change is counted, and models are fitted, up to the end of the event at {time} ({rule}).",
        " Ihre Änderung zählt, und Modelle sind angepasst, bis zum Ende des Ereignisses bei {time} ({rule}).";
    none_recommended: "No model is recommended: {reason}.", "Kein Modell wird empfohlen: {reason}.";
    stopped_on_bound:
        "{model} fits closest but is not called the best: {names} stopped on a bound of the search, so the record \
         does not determine these values.",
        "{model} passt am besten, heißt aber nicht das beste: {names} endete an einer Schranke der Suche, die \
         Aufzeichnung bestimmt diese Werte also nicht.";
    divided_by_formula:
        "{model} fits no more than {points} percentage points better and its masses were looked for with a sensor on \
         the last one alone, which does not decide their division.",
        "{model} passt höchstens {points} Prozentpunkte besser, und seine Massen wurden mit einem Aufnehmer allein \
         auf der letzten gesucht, der ihre Aufteilung nicht entscheidet.";
    more_open:
        "{model} fits no more than {points} percentage points better, and this record leaves {count} of its \
         parameters undetermined instead of {instead}.",
        "{model} passt höchstens {points} Prozentpunkte besser, und diese Aufzeichnung lässt {count} seiner Parameter \
         unbestimmt statt {instead}.";
    more_parameters:
        "{model} fits no more than {points} percentage points better with {count} parameters instead of {instead}: \
         this record gives no reason for the larger model.",
        "{model} passt höchstens {points} Prozentpunkte besser mit {count} Parametern statt {instead}: Diese \
         Aufzeichnung gibt keinen Grund für das größere Modell.";
    provenance: "Provenance", "Herkunft";
    source:
        "Record: {name} ({format}), {digest}. Pipeline: {pipeline}.",
        "Aufzeichnung: {name} ({format}), {digest}. Pipeline: {pipeline}.";
    not_named: "not named", "nicht benannt";
    stage: "Stage", "Stufe";
    version: "Version", "Fassung";
    content: "Content", "Inhalt";
    made_from: "Made from", "Gemacht aus";
    settings: "Settings", "Einstellungen";
    none: "none", "keine";
    show: "show", "zeigen";
    made_by:
        "Made by crumple-report {version}. Full numbers are in summary.json and in the artifacts.",
        "Erstellt von crumple-report {version}. Volle Zahlen stehen in summary.json und in den Artefakten.";
}
