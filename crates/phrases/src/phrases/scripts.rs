//! What the scripts of the page say: cursor, zoom, downloads, sliders.

texts! { CursorTexts
    time_of_cursor: "Time of the cursor", "Zeit des Cursors";
    at_the_cursor: "at the cursor", "am Cursor";
    group: "Cursor and zoom of all figures over time", "Cursor und Zoom aller Bilder über der Zeit";
    time: "time", "Zeit";
    zoom_in: "Zoom in at the cursor", "Am Cursor vergrößern";
    zoom_out: "Zoom out", "Verkleinern";
    all: "all", "alles";
    show_all: "Show the whole of the first view", "Die ganze erste Ansicht zeigen";
    keys:
        "Figures: arrow keys move the cursor, + and − zoom, 0 shows all",
        "Bilder: Pfeiltasten bewegen den Cursor, + und − vergrößern und verkleinern, 0 zeigt alles";
    download: "Download: ", "Herunterladen: ";
    download_svg: "Download the figure “{title}” as SVG", "Das Bild „{title}“ als SVG herunterladen";
    download_csv: "Download the curves of “{title}” as CSV", "Die Kurven von „{title}“ als CSV herunterladen";
    download_summary: "Download the summary as JSON", "Die Zusammenfassung als JSON herunterladen";
    decimal_mark: ".", ",";
}

texts! { WhatIfTexts
    title: "What if", "Was wäre wenn";
    not_fitted:
        "{model}, computed in this page with other numbers. Not fitted to anything: it shows what the model says, not \
         what a vehicle does.",
        "{model}, in dieser Seite mit anderen Zahlen berechnet. An nichts angepasst: Es zeigt, was das Modell sagt, \
         nicht, was ein Fahrzeug tut.";
    motion_over_time: "Motion over time", "Bewegung über der Zeit";
    switched_off:
        "Switched off: this page does not find the crush and time of the simulation again{instead}.",
        "Abgeschaltet: Diese Seite findet Eindrückung und Zeit der Simulation nicht wieder{instead}.";
    instead:
        " ({crush} at {time} instead of {stage_crush} at {stage_time})",
        " ({crush} bei {time} statt {stage_crush} bei {stage_time})";
    stiffness: "Stiffness", "Steifigkeit";
    damping: "Damping", "Dämpfung";
    rate_effect: "Rate effect", "Rateneffekt";
    mass: "Mass", "Masse";
    speed: "Speed", "Geschwindigkeit";
    as_identified: "as identified", "wie identifiziert";
    over_time:
        "{quantity} over time: test, model as identified, model as set",
        "{quantity} über der Zeit: Versuch, Modell wie identifiziert, Modell wie eingestellt";
    time_after_contact: "time after contact, ms", "Zeit nach dem Kontakt, ms";
    test: "test", "Versuch";
    model_as_identified: "model as identified", "Modell wie identifiziert";
    model_as_set: "model as set", "Modell wie eingestellt";
    does_not_stop: "The model does not stop.", "Das Modell kommt nicht zum Stehen.";
    answer:
        "C {crush} ({crush_change}) after {time} ({time_change}){restitution}{beyond}.",
        "C {crush} ({crush_change}) nach {time} ({time_change}){restitution}{beyond}.";
    restitution: ", restitution {value}", ", Stoßzahl {value}";
    beyond: "; beyond the tested crush", "; jenseits der geprüften Eindrückung";
    displacement: "Displacement", "Weg";
    acceleration: "Acceleration", "Beschleunigung";
    state:
        "As identified this page finds crush and time of the simulation again to 0.1 %. Stiffness and damping are \
         shares of those identified. The acceleration is that of the model itself, the test’s is filtered. The address \
         of the page keeps the sliders, to be sent.",
        "Wie identifiziert findet diese Seite Eindrückung und Zeit der Simulation auf 0,1 % wieder. Steifigkeit und \
         Dämpfung sind Anteile der identifizierten. Die Beschleunigung ist die des Modells selbst, die des Versuchs \
         ist gefiltert. Die Adresse der Seite behält die Regler, um sie weiterzugeben.";
    decimal_mark: ".", ",";
}
