//! The model as a picture, and what is said below it.

texts! { ModelTexts
    title: "The model", "Das Modell";
    caption:
        "Under a value its 95 % interval, if the model is true and mass, speed and gain are as stated. Determined: \
         known within a factor of ten. Dashed and “?”: not determined. Zigzag: \
         spring; box and piston: damper; small curve: force over deflection.",
        "Unter einem Wert sein 95-%-Intervall, falls das Modell stimmt und Masse, Geschwindigkeit und Verstärkung wie \
         angegeben sind. Bestimmt: auf einen Faktor zehn bekannt. Gestrichelt und \
         „?“: nicht bestimmt. Zickzack: Feder; Zylinder und Kolben: Dämpfer; kleine Kurve: Kraft über Verformung.";
    recommended_and_closest: "Recommended, and closest to the record", "Empfohlen und der Aufzeichnung am nächsten";
    recommended: "Recommended for predictions", "Für Vorhersagen empfohlen";
    in_doubt: "In doubt", "Fraglich";
    closest: "Closest to the record", "Der Aufzeichnung am nächsten";
    closest_alone: "Closest to the record; none is recommended", "Der Aufzeichnung am nächsten; keines ist empfohlen";
    no_structure:
        "No structure of masses and elements belongs to this model.",
        "Zu diesem Modell gehört keine Struktur aus Massen und Elementen.";
    off_the_test:
        "In its own test: crush {crush}, t<sub>m</sub> {time}{restitution}; displacement fit {fit}.",
        "Im eigenen Versuch: Eindrückung {crush}, t<sub>m</sub> {time}{restitution}; Anpassung des Wegs {fit}.";
    and_restitution: ", restitution {restitution}", ", Stoßzahl {restitution}";
    follows: "Displacement fit {fit}.", "Anpassung des Wegs {fit}.";
    one_spring:
        "One spring with the energy and the crush of the test: <strong>k\u{a0}=\u{a0}{stiffness}</strong>.",
        "Eine Feder mit Energie und Eindrückung des Versuchs: <strong>k\u{a0}=\u{a0}{stiffness}</strong>.";
    by_noise_alone: "; intervals: 95\u{a0}%, by the noise alone", "; Intervalle: 95\u{a0}%, nur aus dem Rauschen";
    rating: "ISO/TS 18571 of the acceleration {value}{grade}.", "ISO/TS 18571 der Beschleunigung {value}{grade}.";
    decided_by:
        "Chosen by sensors {sensors}.",
        "Gewählt nach den Aufnehmern {sensors}.";
    same_record:
        "{model} gives the same record on this sensor.",
        "{model} ergibt an diesem Aufnehmer dieselbe Aufzeichnung.";
    sensor_fitted:
        "Sensor {sensor} on mass {mass}, fitted too: {quantity} off by {error} rms.",
        "Aufnehmer {sensor} auf Masse {mass}, mit angepasst: {quantity} im Effektivwert um {error} daneben.";
    sensor_not_seen:
        "Sensor {sensor} on mass {mass}, which the fit did not see: displacement off by {error} rms{fit}.",
        "Aufnehmer {sensor} auf Masse {mass}, in der Anpassung nicht verwendet: Weg im Effektivwert um {error} \
         daneben{fit}.";
    fit: ", fit {fit}", ", Anpassung {fit}";
    no_sensor_on_front:
        "No sensor on its front mass: nothing in this record tests how the mass is divided.",
        "Kein Aufnehmer auf der vorderen Masse: Nichts in dieser Aufzeichnung prüft die Aufteilung der Masse.";
    no_sensor_in_front:
        "No sensor on the masses in front: nothing in this record tests how the mass is divided.",
        "Kein Aufnehmer auf den vorderen Massen: Nichts in dieser Aufzeichnung prüft die Aufteilung der Masse.";
    limit_of_physical: "limit of what is physical", "Grenze des Physikalischen";
    above: "above {end}", "über {end}";
    below: "below {end}", "unter {end}";
    open: "open", "offen";
    on_a_bound: "on a bound", "an einer Schranke";
    not_determined: "not determined", "nicht bestimmt";
    loading: "loading", "Belastung";
    unloading: "unloading", "Entlastung";
    up_to: "{symbol} up to {force} at {deflection}{doubt}", "{symbol} bis {force} bei {deflection}{doubt}";
    knots: "{count} knots", "{count} Stützstellen";
    knots_determined:
        "{count} knots, {determined} of {asked} determined",
        "{count} Stützstellen, {determined} von {asked} bestimmt";
    the_barrier: "the barrier", "Barriere";
    the_mass: "the mass", "der Masse";
    mass_number: "mass {number}", "Masse {number}";
    mass_words: "Mass {symbol}: {values}.", "Masse {symbol}: {values}.";
    spring: "Spring", "Feder";
    damper: "Damper", "Dämpfer";
    spring_and_damper: "Spring and damper in series", "Feder und Dämpfer in Reihe";
    curve: "Force-deflection curve", "Kraft-Weg-Verlauf";
    between: "{kind} between {front} and {rear}: {values}.", "{kind} zwischen {front} und {rear}: {values}.";
    barrier: "barrier", "Barriere";
    quantity_displacement: "displacement", "Weg";
    quantity_velocity: "velocity", "Geschwindigkeit";
    quantity_acceleration: "acceleration", "Beschleunigung";
}
