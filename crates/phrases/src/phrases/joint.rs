//! One model of several tests.

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
    distrust:
        "its predictions, since the others miss the crush of {tests}",
        "seine Vorhersagen, denn die anderen verfehlen die Eindrückung von {tests}";
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
    predicted_by: "{model}", "{model}";
    interval: "its 90 % interval", "sein 90-%-Intervall";
    impact_speed: "impact speed, km/h", "Aufprallgeschwindigkeit, km/h";
    dynamic_crush: "dynamic crush, mm", "dynamische Eindrückung, mm";
    over_speed_caption:
        "Predictions of the joint model at {mass} against the wall of the tests; each test at its own mass.",
        "Vorhersagen des gemeinsamen Modells bei {mass} gegen die Wand der Versuche; jeder Versuch mit seiner Masse.";
}
