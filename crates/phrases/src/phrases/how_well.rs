//! How well models follow the test: parts of a rating, residual, ratings of the trade, energy.

texts! { HowWellTexts
    title: "How well", "Wie gut";
    model: "Model", "Modell";
    by_standard: "Acceleration by ISO/TS 18571", "Beschleunigung nach ISO/TS 18571";
    residual: "Residual of the acceleration", "Residuum der Beschleunigung";
    wall_force: "Wall force off by, %", "Abweichung der Wandkraft, %";
    corridor: "Corridor", "Korridor";
    phase: "Phase", "Phasenlage";
    magnitude: "Magnitude", "Größe";
    slope: "Slope", "Steigung";
    rating: "Rating", "Bewertung";
    grade: "Grade", "Note";
    rms: "rms, g", "Effektivwert, g";
    of_the_test: "of the test, %", "vom Versuch, %";
    lags_beyond: "lags beyond limits, %", "außerhalb der Grenzen, %";
    excellent: "excellent", "sehr gut";
    good: "good", "gut";
    fair: "fair", "ausreichend";
    poor: "poor", "ungenügend";
    over: "Over {times} after time zero. ", "Über {times} nach dem Zeitnullpunkt. ";
    caption:
        "1 is equal in every part; the rating is 0.4 corridor + 0.2 phase + 0.2 magnitude + 0.2 slope (ISO/TS \
         18571:2014), in words excellent above 0.94, good above 0.80, fair above 0.58, else poor. Residual: filtered \
         test minus the model’s own motion. Of noise one lag in twenty lies beyond the limits; more says that the \
         model misses a part of the pulse.",
        "1 ist gleich, in jedem Teil; die Bewertung ist 0,4 Korridor + 0,2 Phasenlage + 0,2 Größe + 0,2 Steigung \
         (ISO/TS 18571:2014), in Worten sehr gut über 0,94, gut über 0,80, ausreichend über 0,58, sonst ungenügend. \
         Residuum: gefilterter Versuch minus die eigene Bewegung des Modells. Bei Rauschen liegt eine von zwanzig \
         Verschiebungen außerhalb der Grenzen; mehr heißt, dass dem Modell ein Teil des Pulses fehlt.";
    autocorrelation_title:
        "Autocorrelation of the residual of {model}: {share} of the lags up to {longest} lie beyond the limits of \
         noise",
        "Autokorrelation des Residuums von {model}: {share} der Verschiebungen bis {longest} liegen außerhalb der \
         Grenzen von Rauschen";
    lag: "lag, up to {longest}", "Verschiebung, bis {longest}";
    autocorrelation_caption:
        "Autocorrelation of the residual, {model}; shaded: 95\u{a0}% of noise",
        "Autokorrelation des Residuums, {model}; schattiert: 95\u{a0}% von Rauschen";
    ratings: "Ratings: model against test", "Bewertungen: Modell gegen Versuch";
    acceleration: "Acceleration", "Beschleunigung";
    displacement: "Displacement", "Weg";
    fit: "Fit, %", "Anpassung, %";
    fit_definition: "100 (1 − |y − ŷ| / |y − mean y|).", "100 (1 − |y − ŷ| / |y − Mittel y|).";
    standard_definition:
        "0.4 corridor + 0.2 phase + 0.2 magnitude + 0.2 slope; 1 is equal. Sampled at 10 kHz only.",
        "0,4 Korridor + 0,2 Phasenlage + 0,2 Größe + 0,2 Steigung; 1 ist gleich. Nur bei Abtastung mit 10 kHz.";
    cora_definition:
        "0.5 corridor + 0.5 cross-correlation over the compared window; 1 is equal.",
        "0,5 Korridor + 0,5 Kreuzkorrelation im verglichenen Fenster; 1 ist gleich.";
    m_definition:
        "Sprague-Geers magnitude: sqrt(I_cc/I_mm) − 1; 0 is equal.",
        "Sprague-Geers, Größe: sqrt(I_cc/I_mm) − 1; 0 ist gleich.";
    p_definition:
        "Sprague-Geers phase: acos(I_mc/sqrt(I_mm I_cc))/π; 0 is equal.",
        "Sprague-Geers, Phase: acos(I_mc/sqrt(I_mm I_cc))/π; 0 ist gleich.";
    c_definition:
        "Sprague-Geers comprehensive: sqrt(M² + P²); 0 is equal.",
        "Sprague-Geers, gesamt: sqrt(M² + P²); 0 ist gleich.";
    theil_definition:
        "Inequality |m − c|/(|m| + |c|), 0 to 1; 0 is equal.",
        "Ungleichheit |m − c|/(|m| + |c|), 0 bis 1; 0 ist gleich.";
    mark: ", mark {mark}", ", Kennbuchstabe {mark}";
    cora_has: " CORA (mark {mark}) has {note}.", " CORA (Kennbuchstabe {mark}): {note}.";
    ratings_caption:
        "Over {times} after time zero. ISO/TS 18571 and CORA: 1 is equal; M, P, C (Sprague-Geers) and Theil's U1: 0 \
         is equal. Roadside practice accepts |M| and P up to 0.4.{cora} Marks: C checked, S after a secondary source, \
         M from memory, U uncertain.",
        "Über {times} nach dem Zeitnullpunkt. ISO/TS 18571 und CORA: 1 ist gleich; M, P, C (Sprague-Geers) und Theils \
         U1: 0 ist gleich. Bei Schutzeinrichtungen gelten |M| und P bis 0,4 als annehmbar.{cora} Kennbuchstaben: C \
         geprüft, S nach zweiter Quelle, M aus dem Gedächtnis, U unsicher.";
    energy: "Energy of the models", "Energie der Modelle";
    instant: "Instant", "Zeitpunkt";
    time: "Time, ms", "Zeit, ms";
    brought_in: "Brought in, kJ", "Eingebracht, kJ";
    kinetic: "Kinetic, kJ", "Kinetisch, kJ";
    in_springs: "In springs, kJ", "In Federn, kJ";
    dissipated: "Dissipated, kJ", "Dissipiert, kJ";
    closure: "Closure", "Bilanzfehler";
    closure_definition:
        "Largest gap of the balance over the whole response, relative to its largest term.",
        "Größte Lücke der Bilanz über die ganze Antwort, bezogen auf ihren größten Term.";
    diverges: "diverges", "divergiert";
    at_dynamic_crush: "dynamic crush", "dynamische Eindrückung";
    at_end: "end", "Ende";
    energy_caption:
        "Heat and work are integrated apart from the motion, so the closure checks motion, forces and law together. \
         Plastic work of the elastoplastic model counts as dissipated.",
        "Wärme und Arbeit sind getrennt von der Bewegung integriert; so prüft der Bilanzfehler Bewegung, Kräfte und \
         Gesetz zusammen. Plastische Arbeit des elastoplastischen Modells zählt als dissipiert.";
}
