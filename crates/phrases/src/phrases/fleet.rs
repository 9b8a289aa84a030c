//! The page of a fleet.

texts! { FleetTexts
    over: "Over mass, speed and model year", "Über Masse, Geschwindigkeit und Modelljahr";
    over_text:
        "Mass, speed, year and class differ together in what was tested: a line here describes these runs, it is no \
         law.",
        "Masse, Geschwindigkeit, Jahr und Klasse unterscheiden sich im Geprüften gemeinsam: Eine Gerade hier \
         beschreibt diese Läufe, sie ist kein Gesetz.";
    distributions: "Distributions", "Verteilungen";
    distributions_text: "How many runs have which value.", "Wie viele Läufe welchen Wert haben.";
    by_value: "Runs by value", "Läufe nach Wert";
    runs: "runs", "Läufe";
    a_run: "a run", "ein Lauf";
    line:
        "least-squares line of the runs that are no outliers",
        "Ausgleichsgerade der Läufe, die keine Ausreißer sind";
    outlier:
        "outlier: more than four robust standard deviations off the line; leads to its report",
        "Ausreißer: mehr als vier robuste Standardabweichungen neben der Geraden; führt zu seinem Bericht";
}
