//! Several runs on one page: comparison, Markdown of a run, index, the page of a fleet, one model for several tests.

texts! { RunTexts
    key_numbers: "Key numbers", "Kennwerte";
    number: "Number", "Kennwert";
    recommended_models: "Recommended models", "Empfohlene Modelle";
    of_the_model: "Of the model", "Vom Modell";
    predictions: "Predictions of the recommended models", "Vorhersagen der empfohlenen Modelle";
    prediction: "Prediction", "Vorhersage";
    made_with: "What the runs were made with", "Womit die Läufe gemacht sind";
    setting: "Setting", "Einstellung";
    compared: "{count} runs compared", "{count} Läufe im Vergleich";
    comparison_brand: "Crumple · comparison of runs", "Crumple · Vergleich von Läufen";
    what_differs: "What differs", "Was sich unterscheidet";
    what_each_says: "What each run says", "Was jeder Lauf sagt";
    one_gravest: "1 warning: {text}", "1 Warnung: {text}";
    gravest: "{count} warnings, the gravest: {text}", "{count} Warnungen, die schwerste: {text}";
    of_one_record: "one record", "einer Aufzeichnung";
    of_records: "{count} records", "{count} Aufzeichnungen";
    same_settings:
        "{runs} runs of {records}, made with the same settings.",
        "{runs} Läufe von {records}, mit denselben Einstellungen.";
    one_setting_differs:
        "{runs} runs of {records}; {count} setting differs: {names}{more}.",
        "{runs} Läufe von {records}; {count} Einstellung unterscheidet sich: {names}{more}.";
    settings_differ:
        "{runs} runs of {records}; {count} settings differ: {names}{more}.",
        "{runs} Läufe von {records}; {count} Einstellungen unterscheiden sich: {names}{more}.";
    of_common_model: "of the model that all recommend: {names}", "am Modell, das alle empfehlen: {names}";
    other_models: "the recommended model ({names})", "das empfohlene Modell ({names})";
    no_model: "none", "keines";
    tolerance: "0.1 ms, 1 mm, 0.01 m/s, else 0.5 %", "0,1 ms, 1 mm, 0,01 m/s, sonst 0,5 %";
    nothing_differs:
        "Nothing differs by more than {tolerance}.",
        "Nichts unterscheidet sich um mehr als {tolerance}.";
    differ:
        "These differ by more than {tolerance}: {names}.",
        "Um mehr als {tolerance} unterscheiden sich: {names}.";
    differs: "differs", "anders";
    curves: "Curves over each other", "Kurven übereinander";
    one_test: "test, the same in all runs", "Versuch, derselbe in allen Läufen";
    test_of: "{run}, test", "{run}, Versuch";
    model_of: "{run}, model ({model})", "{run}, Modell ({model})";
    curves_caption:
        "SAE J211 sign: deceleration is negative. Solid: the test; dashed: the model that its run recommends, its own \
         motion without the filter. The dots are dynamic crush and its time.",
        "Vorzeichen nach SAE J211: Verzögerung ist negativ. Durchgezogen: der Versuch; gestrichelt: das Modell, das \
         sein Lauf empfiehlt, seine eigene Bewegung ohne Filter. Die Punkte sind dynamische Eindrückung und ihre \
         Zeit.";
    recommended: "Recommended", "Empfohlen";
    certainty: "Certainty", "Sicherheit";
    displacement_fit: "Displacement fit", "Anpassung des Wegs";
    predicted_crush: "Predicted crush at {speed}", "Vorhergesagte Eindrückung bei {speed}";
    record: "record", "Aufzeichnung";
    pipeline: "pipeline", "Pipeline";
    more_in_report: "{count} more in the report.", "{count} weitere im Bericht.";
    value: "value", "Wert";
    model_for_predictions: "Model for predictions", "Modell für Vorhersagen";
    candidates: "Candidates", "Kandidaten";
    candidate_heads:
        "Model | Certainty | ΔC, mm | Δtₘ, ms | Fit, %",
        "Modell | Sicherheit | ΔC, mm | Δtₘ, ms | Anpassung, %";
    same_curve: " and {count} with the same curve", " und {count} mit derselben Kurve";
    again: "Again", "Noch einmal";
    record_is: "Record {record}.", "Aufzeichnung {record}.";
    record_elsewhere:
        "Record {record}: put its path in place of its name, or state it by --record.",
        "Aufzeichnung {record}: ihren Pfad statt ihres Namens einsetzen oder mit --record angeben.";
    run: "Run", "Lauf";
    runs: "Runs", "Läufe";
    one_run: "1 run", "1 Lauf";
    several_runs: "{count} runs", "{count} Läufe";
    index_brand: "Crumple · index of runs", "Crumple · Verzeichnis von Läufen";
    index_title: "Index of runs", "Verzeichnis von Läufen";
    with_model: "{runs}, {count} with a recommended model", "{runs}, {count} mit empfohlenem Modell";
    without_result: ", {count} without a result", ", {count} ohne Ergebnis";
    tables: " All numbers as tables: {links}.", " Alle Zahlen als Tabellen: {links}.";
    index_caption:
        "A name leads to the report of the run. C and t<sub>m</sub>: dynamic crush and its time; e: restitution; k: \
         stiffness of the Kelvin model. Pulses: the filtered acceleration over the first 150 ms, upwards as the \
         vehicle slows down, each to its own peak. Three digits are shown; the reports have all, with intervals.",
        "Ein Name führt zum Bericht des Laufs. C und t<sub>m</sub>: dynamische Eindrückung und ihre Zeit; e: \
         Stoßzahl; k: Steifigkeit des Kelvin-Modells. Pulse: die gefilterte Beschleunigung der ersten 150 ms, nach \
         oben, wenn das Fahrzeug langsamer wird, jeder bis zu seinem Spitzenwert. Drei Stellen sind gezeigt; die \
         Berichte haben alle, mit Intervallen.";
    sorts: " A head of a column sorts.", " Ein Spaltenkopf sortiert.";
    failures: "Without a result", "Ohne Ergebnis";
    and_more: " and {count} more", " und {count} weitere";
    no_word: "no word of why", "kein Wort, warum";
    done: "done", "fertig";
    usage: "usage", "Aufruf";
    refused: "refused", "abgelehnt";
    not_acceptable: "no acceptable result", "kein annehmbares Ergebnis";
    failed: "failed", "gescheitert";
    vehicle_or_test: "Vehicle or test", "Fahrzeug oder Versuch";
    numbers_of_it: "Numbers of it", "Seine Zahlen";
    pulse: "Pulse", "Puls";
    first_warning: "First warning", "Erste Warnung";
    pipeline_head: "Pipeline", "Pipeline";
    none: "none", "keines";
    determined: "{determined} of {parameters} determined", "{determined} von {parameters} bestimmt";
    order_of_magnitude: ", {count} to an order of magnitude", ", {count} der Größenordnung nach";
    open: ", {count} open", ", {count} offen";
    mass_name: "test mass", "Versuchsmasse";
    mass: "mass", "Masse";
    speed_name: "impact speed", "Aufprallgeschwindigkeit";
    speed: "speed", "v₀";
    year_name: "model year", "Modelljahr";
    year: "year", "Jahr";
    crush_name: "dynamic crush", "dynamische Eindrückung";
    crush: "C", "C";
    time_name: "time of dynamic crush", "Zeit der dynamischen Eindrückung";
    time: "t<sub>m</sub>", "t<sub>m</sub>";
    change_name: "change of velocity", "Geschwindigkeitsänderung";
    change: "Δv", "Δv";
    peak_name: "peak deceleration", "größte Verzögerung";
    peak: "peak", "Spitze";
    olc_name: "occupant load criterion", "Insassenbelastung (OLC)";
    olc: "OLC", "OLC";
    restitution_name: "coefficient of restitution", "Stoßzahl";
    restitution: "e", "e";
    stiffness_name: "Kelvin stiffness", "Kelvin-Steifigkeit";
    stiffness: "k", "k";
}

texts! { JointTexts
    brand: "Crumple · one model for several tests", "Crumple · ein Modell für mehrere Versuche";
    happened:
        "One model was fitted to {count} tests at {low} to {high}: {names}.",
        "Ein Modell wurde an {count} Versuche bei {low} bis {high} angepasst: {names}.";
    each_from_the_others:
        " Each predicted from the others, the crush is off by {worst} at most; {held} of {predicted} lie in the 90 % \
         interval.",
        " Jeder aus den anderen vorhergesagt: Die Eindrückung liegt um höchstens {worst} daneben, {held} von \
         {predicted} liegen im 90-%-Intervall.";
    tests_disagree:
        "Predicted from the others, the crush of {tests} is off: quote predictions with that error.",
        "Aus den anderen vorhergesagt liegt die Eindrückung von {tests} daneben: Vorhersagen mit diesem Fehler \
         angeben.";
    warn_missed:
        "predicted from the others, the crush of {tests} is outside of its 90 % interval: these tests may not be of \
         one structure; predictions of the joint model may be off by as much",
        "aus den anderen vorhergesagt liegt die Eindrückung von {tests} außerhalb ihres 90-%-Intervalls: Diese \
         Versuche sind vielleicht nicht von einer Struktur; Vorhersagen des gemeinsamen Modells können ebenso weit \
         danebenliegen";
    title: "The tests, and each predicted from the others", "Die Versuche, und jeder aus den anderen vorhergesagt";
    test: "Test", "Versuch";
    mass: "Mass, kg", "Masse, kg";
    speed: "Speed, km/h", "v₀, km/h";
    crush: "C, mm", "C, mm";
    time: "t<sub>m</sub>, ms", "t<sub>m</sub>, ms";
    restitution: "e", "e";
    crush_error: "ΔC, %", "ΔC, %";
    time_error: "Δt<sub>m</sub>, %", "Δt<sub>m</sub>, %";
    peak_error: "Δpeak, %", "ΔSpitze, %";
    rating: "ISO/TS 18571", "ISO/TS 18571";
    held: "C in its 90 % interval", "C im 90-%-Intervall";
    by: "By", "Durch";
    not_predicted: "not predicted: {why}", "nicht vorhergesagt: {why}";
    caption:
        "Mass, speed, dynamic crush C, its time t<sub>m</sub> and restitution e of each test as measured; then what a \
         model of the other tests alone says of it, less what was measured. This is how far a prediction by these \
         tests was off in tests that were made.",
        "Masse, Geschwindigkeit, dynamische Eindrückung C, ihre Zeit t<sub>m</sub> und Stoßzahl e jedes Versuchs, wie \
         gemessen; dann, was ein Modell allein der anderen Versuche davon sagt, abzüglich des Gemessenen. So weit lag \
         eine Vorhersage aus diesen Versuchen bei solchen daneben, die gemacht wurden.";
    over_speed: "Dynamic crush over impact speed", "Dynamische Eindrückung über der Aufprallgeschwindigkeit";
    tests_as_measured: "tests as measured", "Versuche, wie gemessen";
    interval: "its 90 % interval", "sein 90-%-Intervall";
    impact_speed: "impact speed, km/h", "Aufprallgeschwindigkeit, km/h";
    dynamic_crush: "dynamic crush, mm", "dynamische Eindrückung, mm";
    over_speed_caption:
        "Predictions of the joint model at {mass} against the wall of the tests; each test at its own mass.",
        "Vorhersagen des gemeinsamen Modells bei {mass} gegen die Wand der Versuche; jeder Versuch mit seiner Masse.";
}

texts! { FleetTexts
    over: "Over mass, speed and model year", "Über Masse, Geschwindigkeit und Modelljahr";
    no_law:
        "Mass, speed, year and class differ together in what was tested: a line here describes these runs, it is no \
         law.",
        "Masse, Geschwindigkeit, Jahr und Klasse unterscheiden sich im Geprüften gemeinsam: Eine Gerade hier \
         beschreibt diese Läufe, sie ist kein Gesetz.";
    distributions: "Distributions", "Verteilungen";
    how_many: "How many runs have which value.", "Wie viele Läufe welchen Wert haben.";
    runs_by_value: "Runs by value", "Läufe nach ihrem Wert";
    runs: "runs", "Läufe";
    a_run: "a run", "ein Lauf";
    line:
        "least-squares line of the runs that are no outliers",
        "Ausgleichsgerade der Läufe, die keine Ausreißer sind";
    outlier:
        "outlier: more than four robust standard deviations off the line; leads to its report",
        "Ausreißer: mehr als vier robuste Standardabweichungen neben der Geraden; führt zu seinem Bericht";
    tests: "tests", "Versuche";
    candidates: "candidates", "Kandidaten";
    metrics: "metrics", "Kennwerte";
    predictions: "predictions", "Vorhersagen";
    without_files:
        "The style and the scripts of this page lie in {folder}, with those of all runs of the fleet, and were not \
         found there. A page that needs no other file: crumple-report *.mcap -o report.html in the folder of the run.",
        "Stil und Skripte dieser Seite liegen in {folder}, mit denen aller Läufe der Flotte, und fehlen dort. Eine \
         Seite, die keine andere Datei braucht: crumple-report *.mcap -o report.html im Ordner des Laufs.";
}
