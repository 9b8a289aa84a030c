//! Candidates: which to use and why, a row a distinct curve, every one with its remarks.

texts! { CandidateTexts
    title: "Which model to use", "Welches Modell verwenden";
    recommended: "Recommended for predictions", "Für Vorhersagen empfohlen";
    simplest: "Simplest", "Einfachstes";
    closest: "Closest to the record", "Der Aufzeichnung am nächsten";
    none: "none", "keines";
    evidence_of_all: "Evidence for and against every candidate", "Was für und gegen jeden Kandidaten spricht";
    model: "Model", "Modell";
    determined: "Determined", "Bestimmt";
    of: "{determined} of {parameters}", "{determined} von {parameters}";
    evidence_against: "Evidence against", "Spricht dagegen";
    evidence_definition:
        "Akaike criterion with what is known beside the record, above the lowest of the adequate models: \
         below 2 says nothing, above 10 decides.",
        "Akaike-Kriterium samt Vorwissen, über dem kleinsten der angemessenen Modelle: unter 2 sagt es \
         nichts, über 10 entscheidet es.";
    crush_at: "C at {speed}, mm", "C bei {speed}, mm";
    crush_at_definition:
        "Dynamic crush as predicted at this speed, same mass, same wall; below it the 90 % interval.",
        "Vorhergesagte dynamische Eindrückung bei dieser Geschwindigkeit, gleiche Masse, gleiche Wand; darunter das \
         90-%-Intervall.";
    crush_error: "ΔC, mm", "ΔC, mm";
    crush_error_definition:
        "Dynamic crush of the model minus that of the test.",
        "Dynamische Eindrückung des Modells minus die des Versuchs.";
    time_error: "Δt<sub>m</sub>, ms", "Δt<sub>m</sub>, ms";
    time_error_definition:
        "Time of dynamic crush of the model minus that of the test.",
        "Eindrückungszeit des Modells minus die des Versuchs.";
    fit: "Fit, %", "Anpassung, %";
    fit_as_measured_definition:
        "100 (1 − |x − x̂| / |x − mean x|) of the displacement over the compared window, the model measured as the \
         record was.",
        "100 (1 − |x − x̂| / |x − Mittel x|) des Wegs im verglichenen Fenster, das Modell gemessen wie die \
         Aufzeichnung.";
    fit_definition:
        "100 (1 − |x − x̂| / |x − mean x|) of the displacement over the compared window.",
        "100 (1 − |x − x̂| / |x − Mittel x|) des Wegs im verglichenen Fenster.";
    distinct_curves:
        "{candidates} candidates, {curves} distinct curves: those in one row differ over the compared window by no \
         more than {share} of the largest displacement and velocity (root mean square), and in restitution by no more \
         than {restitution}. ",
        "{candidates} Kandidaten, {curves} verschiedene Kurven: Die einer Zeile weichen im verglichenen Fenster um \
         höchstens {share} des größten Wegs und der größten Geschwindigkeit (Effektivwert) voneinander ab, in der \
         Stoßzahl um höchstens {restitution}. ";
    bars_caption:
        "Highlighted is the model recommended for predictions. A bar is a 95 % interval between a tenth and ten times \
         the value; it fades where it goes on or is open.",
        "Hervorgehoben ist das für Vorhersagen empfohlene Modell. Ein Balken ist ein 95-%-Intervall zwischen einem \
         Zehntel und dem Zehnfachen des Werts; er verblasst, wo es weitergeht oder offen ist.";
    parameters_of_row: "parameters", "Parameter";
    badge_recommended: "recommended", "empfohlen";
    badge_simplest: "simplest", "einfachstes";
    badge_closest: "closest", "nächstes";
    not_adequate: "not adequate: {why}", "nicht angemessen: {why}";
    not_passive: "not a passive structure", "keine passive Struktur";
    same_curve: "same curve: {count} more", "gleiche Kurve: {count} weitere";
    parameter: "Parameter", "Parameter";
    value: "Value", "Wert";
    interval: "95&nbsp;%", "95&nbsp;%";
    scale_value: "value", "Wert";
    order_of_magnitude: "to an order of magnitude", "der Größenordnung nach";
    limit_of_physical: "limit of what is physical", "Grenze des Physikalischen";
    the_limit_of_physical: " (the limit of what is physical)", " (Grenze des Physikalischen)";
    given: "given", "vorgegeben";
    open: "open", "offen";
    energy_goes_into: "Energy goes into", "Energie geht in";
    plastic: "plastic deformation", "plastische Verformung";
    damped: "dampers", "Dämpfer";
    elastic: "springs", "Federn";
    with_priors: "Δ with priors", "Δ mit Vorwissen";
    adequate: "Adequate", "Angemessen";
    no_because: "no: {why}", "nein: {why}";
    wall_force: "Wall force, %", "Wandkraft, %";
    wall_force_definition:
        "Force on the wall: model less measured, root mean square over that of the measured, from contact to \
         separation, both filtered alike.",
        "Kraft auf die Wand: Modell minus Messung, Effektivwert bezogen auf den der Messung, vom Kontakt bis zur \
         Trennung, beide gleich gefiltert.";
    evidence_caption:
        "Evidence is the Akaike criterion of the {quantity}{filtered}, over {effective} independent samples \
         of {samples}; a difference below 2 says nothing, above 10 it decides. ",
        "Maßstab ist das Akaike-Kriterium ({quantity}{filtered}) über {effective} unabhängige Werte von \
         {samples}; ein Unterschied unter 2 sagt nichts, über 10 entscheidet er. ";
    filtered_alike: ", the models filtered as the record was", ", die Modelle gefiltert wie die Aufzeichnung";
    no_priors: "none.", "keines.";
    priors_caption:
        "Prior knowledge adds the terms beside it, which a reader can take off: {priors}",
        "Vorwissen fügt die Terme daneben hinzu, die sich abziehen lassen: {priors}";
    every_candidate:
        "Every candidate with its parameters and remarks",
        "Jeder Kandidat mit Parametern und Bemerkungen";
    rank: "Rank", "Rang";
    model_and_method: "Model and method", "Modell und Verfahren";
    parameters: "Parameters", "Parameterwerte";
    physical: "Physical", "Physikalisch";
    physical_definition:
        "No parameter is negative: a passive structure.",
        "Kein Parameter ist negativ: eine passive Struktur.";
    rmse: "RMSE, mm", "RMSE, mm";
    rmse_definition:
        "Root mean square displacement error over the compared window.",
        "Effektivwert des Wegfehlers im verglichenen Fenster.";
    aicc_definition:
        "Corrected Akaike criterion of the displacement error over the same window, at the same number of independent \
         samples for all: lower is better, it charges for every parameter.",
        "Korrigiertes Akaike-Kriterium des Wegfehlers im selben Fenster, bei gleicher Zahl unabhängiger Werte für \
         alle: kleiner ist besser, jeder Parameter wird angerechnet.";
    matching_supported:
        "Of the solutions of coefficient matching the simulation supports {model}{dual}: fit {fit}{physical}.",
        "Von den Lösungen des Koeffizientenvergleichs stützt die Simulation {model}{dual}: Anpassung {fit}{physical}.";
    and_its_dual:
        " and its dual {model}, which this sensor cannot tell from it",
        " und das duale {model}, das dieser Aufnehmer nicht davon unterscheiden kann";
    it_is_not_passive: "; it is not a passive structure", "; es ist keine passive Struktur";
    ranked_recommended:
        "Ranked by the fit of the displacement, the model measured as the record was; AICc stands beside it, over the \
         same window, for information. Highlighted is the model recommended for predictions, which need not be the one \
         that follows this record closest: the list above says why. A dual gives exactly the same record on this \
         sensor and so the same figures.",
        "Geordnet nach der Anpassung des Wegs, das Modell gemessen wie die Aufzeichnung; der AICc über dasselbe \
         Fenster steht zur Information daneben. Hervorgehoben ist das für Vorhersagen empfohlene Modell, das nicht das \
         nächste sein muss: Die Liste oben sagt, warum. Ein duales Modell ergibt an diesem Aufnehmer genau dieselbe \
         Aufzeichnung und so dieselben Zahlen.";
    ranked_best:
        "Ranked by the fit of the displacement, the model measured as the record was; AICc stands beside it, over the \
         same window, for information. Highlighted is the best that is physical, has no parameter left on a bound of \
         its search other than zero, the limit of what is physical, and a fit within 0.1 points of the best such \
         candidate; of those the one with the fewest parameters left open by the record, then the one with the fewest \
         parameters. A dual gives exactly the same record on this sensor and so the same figures.",
        "Geordnet nach der Anpassung des Wegs, das Modell gemessen wie die Aufzeichnung; der AICc über dasselbe \
         Fenster steht zur Information daneben. Hervorgehoben ist das beste, das physikalisch ist, keinen Parameter an \
         einer Schranke der Suche außer null, der Grenze des Physikalischen, hat und dessen Anpassung höchstens 0,1 \
         Punkte unter der besten solchen liegt; davon das mit den wenigsten offenen, dann das mit den wenigsten \
         Parametern. Ein duales Modell ergibt an diesem Aufnehmer genau dieselbe Aufzeichnung und so dieselben \
         Zahlen.";
    ranked_none:
        "No candidate is called the best: that takes a physical candidate without a parameter on a bound that \
         explains at least half of the displacement; zero is no such bound, but the limit of what is physical.",
        "Kein Kandidat heißt der beste: Dazu gehört ein physikalischer ohne Parameter an einer Schranke, der \
         mindestens die Hälfte des Wegs erklärt; null ist keine solche Schranke, sondern die Grenze des \
         Physikalischen.";
    intervals_caption:
        "± is one standard deviation, from the misfit and the sensitivities at the fit; “95 %” is the interval that \
         holds the value in 95 of 100 such records if the model is true and mass, speed, gain and the division of the \
         mass are exact, “open” where the record does not bound it. It is far wider than two standard deviations where \
         the misfit is worth few independent samples (see the remarks), and not symmetric. Profile, bootstrap and \
         uncertain inputs, where asked for, are among a candidate's remarks.",
        "± ist eine Standardabweichung, aus dem Anpassungsfehler und den Empfindlichkeiten; „95 %“ ist das Intervall, \
         das den Wert in 95 von 100 solchen Aufzeichnungen enthält, wenn das Modell stimmt und Masse, Geschwindigkeit, \
         Verstärkung und Aufteilung der Masse genau sind, „offen“, wo die Aufzeichnung ihn nicht begrenzt. Es ist weit \
         breiter als zwei Standardabweichungen, wo der Fehler wenige unabhängige Werte zählt (siehe Bemerkungen), und \
         nicht symmetrisch. Profil, Bootstrap und unsichere Eingaben stehen, wo verlangt, unter den Bemerkungen.";
    dual_of: "dual of {model}: same record", "dual zu {model}: dieselbe Aufzeichnung";
    fitted_to:
        "Fitted to the {quantity} of channel {channel} from {from} to {to} ms ({samples} samples); stopped: {reason}.",
        "Angepasst an {quantity} von Kanal {channel} von {from} bis {to} ms ({samples} Werte); Ende: {reason}.";
    on_bounds: "On a bound of the search: {names}.", "An einer Schranke der Suche: {names}.";
    one_remark: "{count} remark", "{count} Bemerkung";
    remarks: "{count} remarks", "{count} Bemerkungen";
    star: "recommended for predictions", "für Vorhersagen empfohlen";
    directions:
        "Independent directions in the parameters that the waves respond to: {rank} of {order}; how well each \
         parameter is known, its interval says.",
        "Unabhängige Richtungen der Parameter, auf die die Signale antworten: {rank} von {order}; wie gut jeder \
         Parameter bekannt ist, sagt sein Intervall.";
    known_least: "Known least: {what}.", "Am wenigsten bekannt: {what}.";
    condition: "Condition of the sensitivities: {value}.", "Kondition der Empfindlichkeiten: {value}.";
    independent_samples:
        "{parameters} parameters, {samples} independent samples in the window{few}.",
        "{parameters} Parameter, {samples} unabhängige Werte im Fenster{few}.";
    too_few: ": too few for an AICc", ": zu wenige für einen AICc";
    other_sensor:
        "Sensor {channel} on mass {mass}, which the fit did not use: {error} root mean square{fit}.",
        "Aufnehmer {channel} auf Masse {mass}, in der Anpassung nicht verwendet: {error} im Effektivwert{fit}.";
    sensor_fit: ", fit {fit}", ", Anpassung {fit}";
    interval_open: "; 95\u{a0}%: open", "; 95\u{a0}%: offen";
    interval_of: "; 95\u{a0}%: {low} to {high}", "; 95\u{a0}%: {low} bis {high}";
    profile: "Profile likelihood, 95\u{a0}%: {intervals}.", "Profil-Likelihood, 95\u{a0}%: {intervals}.";
    bootstrap: "Bootstrap", "Bootstrap";
    uncertain_inputs: "Uncertain inputs", "Unsichere Eingaben";
    replicates:
        "{name} ({method}; {count} repetitions), {coverage}: {intervals}.",
        "{name} ({method}; {count} Wiederholungen), {coverage}: {intervals}.";
}
