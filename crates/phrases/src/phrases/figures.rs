//! Figures of the crash: titles, axes, legends, captions.

texts! { FigureTexts
    all_names: "names of the hidden curves", "Namen der verborgenen Kurven";
    curves_to_show: "Curves, to show or hide", "Kurven, zeigen oder ausblenden";
    over: "over", "über";
    lowest: "lowest", "kleinster Wert";
    highest: "highest", "größter";
    at: "at", "bei";
    marked: "Marked", "Markiert";
    panel: "panel", "Feld";
    time: "time after time zero, ms", "Zeit nach dem Zeitnullpunkt, ms";
    acceleration: "acceleration, g", "Beschleunigung, g";
    velocity: "velocity, km/h", "Geschwindigkeit, km/h";
    displacement: "displacement, mm", "Weg, mm";
    force: "force, kN", "Kraft, kN";
    deceleration: "deceleration, g (mass not known)", "Verzögerung, g (Masse nicht bekannt)";
    title: "What the test did, what the models do", "Versuch und Modelle: Kurven";
    title_of_test: "The test: curves", "Versuch: Kurven";
    test_cfc: "test, CFC\u{a0}{cfc}", "Versuch, CFC\u{a0}{cfc}";
    test_filtered: "test, filtered", "Versuch, gefiltert";
    test_as_read: "test, as read", "Versuch, wie gelesen";
    as_read: "as read", "wie gelesen";
    same_place: "sensors at the same place: {channels}", "Aufnehmer am selben Ort: {channels}";
    rebound: "rebound, {time}", "Rückprall, {time}";
    channel: "Channel {id}", "Kanal {id}";
    unknown: "unknown", "unbekannt";
    sign: ", SAE J211 sign: deceleration is negative.", ", Vorzeichen nach SAE J211: Verzögerung ist negativ.";
    filtered:
        " Filtered in mode {mode}; the record as read waits in the legend, and may reach beyond the axes.",
        " Gefiltert im Modus {mode}; die Aufzeichnung wie gelesen lässt sich in der Legende einschalten und kann über \
         die Achsen hinausreichen.";
    integrated_from:
        " Velocity and displacement by the {rule} rule from {start}.",
        " Geschwindigkeit und Weg nach der Regel „{rule}“ ab „{start}“.";
    integrated: " Integrated by the {rule} rule.", " Integriert nach der Regel „{rule}“.";
    no_crush_to_mark:
        " The velocity does not reach zero within the record: there is no dynamic crush to mark.",
        " Die Geschwindigkeit wird in der Aufzeichnung nicht null: Es gibt keine dynamische Eindrückung zu markieren.";
    window:
        " The shaded window, {from} to {to}, is the one the models are compared over; outside it they are only drawn.",
        " Verglichen werden die Modelle im schattierten Fenster, {from} bis {to}; außerhalb sind sie nur gezeichnet.";
    others_wait:
        " Other models wait in the legend; of parameter sets of one model that fit alike the first stands for all.",
        " Weitere Modelle lassen sich in der Legende einschalten; von Parametersätzen eines Modells, die gleich gut \
         passen, steht der erste für alle.";
    duals_once:
        " Parameter sets that give exactly the same record (duals) are drawn once.",
        " Parametersätze, die genau dieselbe Aufzeichnung ergeben (duale), sind einmal gezeichnet.";
    recommended_and_closest: "recommended and closest: ", "empfohlen und nächstes: ";
    recommended: "recommended: ", "empfohlen: ";
    closest: "closest: ", "nächstes: ";
    and_its_dual: "and its dual: same record", "und das duale: dieselbe Aufzeichnung";
    not_physical: "not physical", "nicht physikalisch";
    equal_energy: "equal-energy line (force over crush)", "Gerade gleicher Energie (Kraft über Weg)";
    load_cells: "barrier load cells (force over crush)", "Kraftmessdosen der Barriere (Kraft über Weg)";
    loading:
        "Loading takes up {work}; a linear spring with the same work at the same crush has {stiffness}. ",
        "Die Belastung nimmt {work} auf; eine lineare Feder mit derselben Arbeit bei derselben Eindrückung hat \
         {stiffness}. ";
    unloading: "Unloading gives {work} back. ", "Die Entlastung gibt {work} zurück. ";
    force_is:
        "Force is the test mass times the deceleration of this sensor: the barrier force of a vehicle that moves as \
         one body.",
        "Die Kraft ist die Versuchsmasse mal der Verzögerung dieses Aufnehmers: die Barrierenkraft eines Fahrzeugs, \
         das sich als ein Körper bewegt.";
    no_force:
        "Deceleration takes the place of force, since no force record or mass is at hand.",
        "Die Verzögerung steht für die Kraft, da weder eine Kraftaufzeichnung noch eine Masse vorliegt.";
    load_cells_differ:
        " The load cells measured it at the barrier: where the two part, the engine and other masses move otherwise \
         than this sensor.",
        " Die Kraftmessdosen maßen sie an der Barriere: Wo beide auseinandergehen, bewegen sich Motor und andere \
         Massen anders als dieser Aufnehmer.";
    elements: "Springs and dampers at work", "Federn und Dämpfer bei der Arbeit";
    compression_of_front: "compression of the front, mm", "Zusammendrückung des Vorderwagens, mm";
    compression_between: "compression between the masses, mm", "Zusammendrückung zwischen den Massen, mm";
    damper: "damper {name}", "Dämpfer {name}";
    spring: "spring {name}", "Feder {name}";
    elements_one_mass:
        "Force in each spring and damper of {model}, against the compression of the front, over the compared window. \
         The area below a curve is the work the element takes up.",
        "Kraft in jeder Feder und jedem Dämpfer von {model} über der Zusammendrückung des Vorderwagens, im \
         verglichenen Fenster. Die Fläche unter einer Kurve ist die Arbeit, die das Element aufnimmt.";
    elements_masses:
        "Force in each spring and damper of {model}, against how far the masses at its ends have come together, over \
         the compared window. The area below a curve is the work the element takes up.",
        "Kraft in jeder Feder und jedem Dämpfer von {model} über der Annäherung der Massen an seinen Enden, im \
         verglichenen Fenster. Die Fläche unter einer Kurve ist die Arbeit, die das Element aufnimmt.";
    sensors: "Other sensors on the vehicle", "Weitere Aufnehmer am Fahrzeug";
    sensors_caption:
        "Each sensor integrated from its own acceleration. A mass of a model is drawn over the sensor that sits on \
         it, for the best candidates, and the compartment of the best model over the pulse; sensors that the best \
         model was not compared with and no mass stands for wait in the legend.",
        "Jeder Aufnehmer aus seiner eigenen Beschleunigung integriert. Eine Masse eines Modells ist über den \
         Aufnehmer gezeichnet, der auf ihr sitzt, für die besten Kandidaten; die Fahrgastzelle des besten Modells über \
         den Puls. Aufnehmer, mit denen das beste Modell nicht verglichen wurde und für die keine Masse steht, lassen \
         sich in der Legende einschalten.";
    pulse: "pulse {channel}", "Puls {channel}";
    compartment_of: "compartment of {model}", "Fahrgastzelle von {model}";
    mass_of: "mass {mass} of {model}", "Masse {mass} von {model}";
    sensor: "sensor {channel}{place}", "Aufnehmer {channel}{place}";
    residual: "Test minus model", "Versuch minus Modell";
    residual_displacement: "residual of the displacement, mm", "Residuum des Wegs, mm";
    residual_velocity: "residual of the velocity, km/h", "Residuum der Geschwindigkeit, km/h";
    residual_band:
        "recommended: what its parameters leave open, 95 %",
        "empfohlen: was seine Parameter offen lassen, 95 %";
    residual_caption:
        "The axes hold the largest residual inside the shaded window, which the models are compared over; a model \
         that was made for the loading phase may leave them after it. Of many models the first six are drawn.",
        "Die Achsen fassen das größte Residuum im schattierten Fenster, in dem die Modelle verglichen werden; ein \
         Modell der Belastungsphase kann sie danach verlassen. Von vielen Modellen sind die ersten sechs gezeichnet.";
    mass_split:
        "Which divisions of the mass a double model can have",
        "Welche Aufteilungen der Masse ein Zweimassenmodell haben kann";
    mass_ratio: "mass ratio m2/m1 (compartment over chassis)", "Massenverhältnis m2/m1 (Fahrgastzelle zu Vorbau)";
    stiffness: "stiffness, kN/m", "Steifigkeit, kN/m";
    damping: "damping, kN·s/m", "Dämpfung, kN·s/m";
    all_positive: "{name}, all four positive", "{name}, alle vier positiv";
    another_negative: "{name}, another is negative", "{name}, ein anderer negativ";
    used: "used", "verwendet";
    only_up_to: "They exist only for m2/m1 up to {bound}.", "Es gibt sie nur für m2/m1 bis {bound}.";
    no_division:
        "No division allows them: the identified polynomial is not that of a passive structure.",
        "Keine Aufteilung erlaubt sie: Das identifizierte Polynom ist nicht das einer passiven Struktur.";
    same_poles:
        "Parameter sets with the same poles as {source}, at the same total mass, {mass}. At another division the \
         poles are kept, the motion is not quite: fit again with --front-mass-fraction to see by how much.",
        "Parametersätze mit denselben Polen wie {source} bei derselben Gesamtmasse, {mass}. Bei anderer Aufteilung \
         bleiben die Pole, die Bewegung nicht ganz: Eine neue Anpassung mit --front-mass-fraction zeigt, um wie viel.";
    real_solutions:
        "Real solutions of coefficient matching of {source} at the same total mass, {mass}.",
        "Reelle Lösungen des Koeffizientenvergleichs von {source} bei derselben Gesamtmasse, {mass}.";
    mass_split_filled:
        "Filled: all four parameters are positive, and such divisions are shaded; negative values have no place on a \
         logarithmic axis.",
        "Gefüllt: Alle vier Parameter sind positiv, solche Aufteilungen sind schattiert; negative Werte haben auf \
         einer logarithmischen Achse keinen Platz.";
    used_is_among:
        "The division used, m2/m1 = {ratio}, is among them.",
        "Die verwendete Aufteilung, m2/m1 = {ratio}, gehört dazu.";
    used_is_not_among:
        "The division used, m2/m1 = {ratio}, is not among them.",
        "Die verwendete Aufteilung, m2/m1 = {ratio}, gehört nicht dazu.";
}
