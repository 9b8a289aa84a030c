//! All that verdict, warnings and console say, in each language. A field is a sentence or a part of one; `{name}` is
//! filled in.

/// The texts of one language.
#[derive(Debug)]
pub struct Phrases {
    /// A crush that comes to an end.
    pub crushed: &'static str,
    /// Its interval.
    pub interval: &'static str,
    /// The way back.
    pub rebounded: &'static str,
    /// No way back.
    pub no_rebound: &'static str,
    /// A velocity that never reaches zero.
    pub no_stop: &'static str,
    /// The same where nothing ends the event.
    pub no_stop_no_end: &'static str,
    /// A collision with another vehicle.
    pub two_vehicles: &'static str,
    /// A sensor in an occupant.
    pub occupant: &'static str,
    /// What such a record is good for.
    pub occupant_use: &'static str,
    /// Its criteria are of one or two axes.
    pub lower_bounds: &'static str,
    /// A recorder's table.
    pub recorded: &'static str,
    /// What such a table is good for.
    pub recorder_use: &'static str,
    /// The crush from it.
    pub rough_crush: &'static str,
    /// An identified model.
    pub identified: &'static str,
    /// Damping of its slowest mode.
    pub damping: &'static str,
    /// Its slowest mode.
    pub mode: &'static str,
    /// Where an identified model holds.
    pub identified_use: &'static str,
    /// What is not stated: mass and speed, mass, speed.
    pub not_stated: [&'static str; 3],
    /// What a record without them is good for.
    pub not_stated_use: &'static str,
    /// No result at all.
    pub no_model: &'static str,
    /// What to do where the stage does not say it.
    pub read_the_notes: &'static str,
    /// Waves or channels alone.
    pub measured_only: &'static str,
    /// No models because their stages did not run.
    pub no_models_here: &'static str,
    /// The model to use.
    pub use_model: &'static str,
    /// How many of its numbers are determined.
    pub determined: &'static str,
    /// How many of them to an order of magnitude.
    pub order_of_magnitude: &'static str,
    /// How many are open.
    pub open: &'static str,
    /// How close it is.
    pub follows: &'static str,
    /// What it predicts against the wall.
    pub predicts: &'static str,
    /// What it predicts against a partner.
    pub predicts_collision: &'static str,
    /// No model is recommended.
    pub none_recommended: &'static str,
    /// Why: no crush that ends.
    pub no_crush: &'static str,
    /// Why: another axis.
    pub other_axis: &'static str,
    /// The closest all the same.
    pub closest: &'static str,
    /// What to distrust, before what.
    pub distrust: &'static str,
    /// Numbers that the record leaves open.
    pub open_numbers: &'static str,
    /// Two parameter sets of one record.
    pub dual: &'static str,
    /// Numbers known to an order of magnitude.
    pub hardly: &'static str,
    /// Beyond the tested speed.
    pub extrapolates: &'static str,
    /// A decisive warning.
    pub decisive: &'static str,
    /// Between the items of a list.
    pub and: &'static str,
    /// Warning: sensors of the compartment differ by more than the interval.
    pub sensors_differ: &'static str,
    /// Warning: numbers of the recommended candidate are open.
    pub warn_open: &'static str,
    /// Warning: numbers of it are hardly determined.
    pub warn_hardly: &'static str,
    /// Warning: the recommended candidate has a dual.
    pub warn_dual: &'static str,
    /// Warning: the closest candidate leaves numbers open.
    pub warn_closest: &'static str,
    /// Warning: predictions go beyond the test.
    pub warn_extrapolates: &'static str,
    /// Warning: a collision with a vehicle.
    pub warn_two_vehicles: &'static str,
    /// Heading over the warnings.
    pub before_use: &'static str,
    /// One more warning.
    pub one_more: &'static str,
    /// More warnings.
    pub more: &'static str,
    /// Heading over the identified models.
    pub identification: &'static str,
    /// Heading of the verdict for those who hear it.
    pub verdict: &'static str,
    /// What to do.
    pub what_to_do: &'static str,
    /// Labels of the console: crush, its time, change of velocity, restitution, peak, OLC.
    pub labels: [&'static str; 6],
    /// Label of the recommended model.
    pub model_label: &'static str,
    /// Label of the warnings.
    pub warnings_label: &'static str,
    /// Label of what is not in the report.
    pub missing_label: &'static str,
    /// Label of the files.
    pub files_label: &'static str,
    /// Between the ends of an interval.
    pub to: &'static str,
}

/// English.
pub const ENGLISH: Phrases = Phrases {
    crushed: "The vehicle was crushed by {crush}{interval} within {time} of an impact{speed}{rebound}.",
    interval: " ({low} to {high})",
    rebounded: " and rebounded with {restitution} of that speed",
    no_rebound: " and did not rebound",
    no_stop: "The vehicle did not stop within the record: it lost {change} in {time}, and there is no dynamic crush.",
    no_stop_no_end: "The vehicle did not stop within the record: there is no dynamic crush.",
    two_vehicles: "Two vehicles collided: this one lost {change}{time}; its motion over ground is not its crush.",
    occupant: "The sensor sits in an occupant ({place}), not in the vehicle{criteria}.",
    occupant_use: "Crush, stiffness and models of such a record are those of the sensor: use none for the \
                   vehicle{bounds}.",
    lower_bounds: "; the criteria are lower bounds, since not all axes were measured",
    recorded: "The recorder kept a change of velocity of {change}{time}.",
    recorder_use: "No peak and no force can be taken from such a coarse table{crush}.",
    rough_crush: "; the crush of {crush}{interval} made from it is rough",
    identified: "{model} follows {fit} of the record{mode}.",
    damping: ", damping ratio {ratio}",
    mode: "; its slowest mode is at {frequency}{damping}",
    identified_use: "It holds for the amplitudes and frequencies that this record excited; what it says beyond is \
                     extrapolation.",
    not_stated: [
        "The record states neither mass nor impact speed, as allowed: there is no crush, no force and no stiffness.",
        "The record states no mass, as allowed: there is no force and no stiffness.",
        "The record states no impact speed, as allowed: there is no crush, no force and no stiffness.",
    ],
    not_stated_use: "A linear model alone was identified: {model} follows {fit} of the pulse{mode}.",
    no_model: "There is no model: {reason}.",
    read_the_notes: "the notes of the run say more: just notes, and the folder of the run",
    measured_only: "This report holds no motion of a vehicle.",
    no_models_here: "It holds no models: their stages did not run.",
    use_model: "For predictions use {model}{determined}{follows}{predicts}{distrust}.",
    determined: "{determined} of {parameters} numbers determined",
    order_of_magnitude: ", {count} to an order of magnitude",
    open: ", {count} open",
    follows: ": it follows the displacement to {fit}",
    predicts: " and predicts a crush of {crush}{interval} at {speed}",
    predicts_collision: " and predicts against {partner} a crush of {crush}{interval}",
    none_recommended: "No model is recommended: {because}{closest}.",
    no_crush: "springs that stop a mass do not explain such a record",
    other_axis: "the pulse is along {axis}, and the models are of a crush along x",
    closest: "; the closest, {model}, follows the displacement to {fit} up to {time} and says nothing beyond",
    distrust: "; distrust {what}",
    open_numbers: "{names}, which this record leaves open",
    dual: "the division of its masses, since its mirror image gives the same record",
    hardly: "{names}, known to an order of magnitude only",
    extrapolates: "it above the {speed} of the test, where it extrapolates",
    decisive: "all of it until the first warning is settled",
    and: "and",
    sensors_differ: "sensors of the compartment give a crush of {low} to {high}, outside of the interval of this one",
    warn_open: "{names} of the recommended {model} may be anything as far as this record tells",
    warn_hardly: "{names} of the recommended {model} is known to an order of magnitude only",
    warn_dual: "the recommended {model} has a mirror image that gives exactly the same record; a second sensor, on \
                the front or the engine, decides between them",
    warn_closest: "the closest model, {model}, leaves {open} of its {parameters} numbers open: its curve may be used, \
                   its numbers not",
    warn_extrapolates: "predictions above {speed} go beyond what was tested",
    warn_two_vehicles: "a collision of two vehicles: the displacement over ground is not the crush of either, and the \
                        models take the other vehicle for a rigid wall",
    before_use: "Before you use this",
    one_more: "1 more warning",
    more: "{count} more warnings",
    identification: "Identification",
    verdict: "Verdict",
    what_to_do: "What to do: {remedy}.",
    labels: ["dynamic crush", "time of crush", "delta-v", "restitution", "peak", "OLC"],
    model_label: "recommended",
    warnings_label: "before you use it",
    missing_label: "not in it",
    files_label: "report",
    to: "to",
};

/// German.
pub const GERMAN: Phrases = Phrases {
    crushed: "Das Fahrzeug wurde bei einem Aufprall{speed} in {time} um {crush}{interval} eingedrückt{rebound}.",
    interval: " ({low} bis {high})",
    rebounded: " und prallte mit dem {restitution}-Fachen dieser Geschwindigkeit zurück",
    no_rebound: " und prallte nicht zurück",
    no_stop: "Das Fahrzeug kam in der Aufzeichnung nicht zum Stehen: Es verlor {change} in {time}, eine dynamische \
              Eindrückung gibt es nicht.",
    no_stop_no_end: "Das Fahrzeug kam in der Aufzeichnung nicht zum Stehen: Eine dynamische Eindrückung gibt es nicht.",
    two_vehicles: "Zwei Fahrzeuge stießen zusammen: Dieses verlor {change}{time}; sein Weg über Grund ist nicht seine \
                   Eindrückung.",
    occupant: "Der Aufnehmer sitzt in einem Insassen ({place}), nicht im Fahrzeug{criteria}.",
    occupant_use: "Eindrückung, Steifigkeit und Modelle einer solchen Aufzeichnung sind die des Aufnehmers: Keines \
                   gilt für das Fahrzeug{bounds}.",
    lower_bounds: "; die Kriterien sind untere Schranken, da nicht alle Achsen gemessen wurden",
    recorded: "Das Aufzeichnungsgerät hielt eine Geschwindigkeitsänderung von {change} fest{time}.",
    recorder_use: "Spitzenwert und Kraft lassen sich aus einer so groben Tabelle nicht ablesen{crush}.",
    rough_crush: "; die daraus gebildete Eindrückung von {crush}{interval} ist grob",
    identified: "{model} folgt der Aufzeichnung zu {fit}{mode}.",
    damping: ", Dämpfungsgrad {ratio}",
    mode: "; die langsamste Eigenschwingung liegt bei {frequency}{damping}",
    identified_use: "Es gilt für die Amplituden und Frequenzen, die diese Aufzeichnung anregte; alles darüber hinaus \
                     ist Extrapolation.",
    not_stated: [
        "Masse und Aufprallgeschwindigkeit sind nicht angegeben, wie erlaubt: keine Eindrückung, keine Kraft, keine \
         Steifigkeit.",
        "Die Masse ist nicht angegeben, wie erlaubt: keine Kraft, keine Steifigkeit.",
        "Die Aufprallgeschwindigkeit ist nicht angegeben, wie erlaubt: keine Eindrückung, keine Kraft, keine \
         Steifigkeit.",
    ],
    not_stated_use: "Nur ein lineares Modell wurde identifiziert: {model} folgt dem Puls zu {fit}{mode}.",
    no_model: "Es gibt kein Modell: {reason}.",
    read_the_notes: "die Anmerkungen des Laufs sagen mehr: just notes und der Ordner des Laufs",
    measured_only: "Dieser Bericht enthält keine Bewegung eines Fahrzeugs.",
    no_models_here: "Er enthält keine Modelle: Deren Stufen liefen nicht.",
    use_model: "Für Vorhersagen gilt {model}{determined}{follows}{predicts}{distrust}.",
    determined: "{determined} von {parameters} Zahlen bestimmt",
    order_of_magnitude: ", {count} der Größenordnung nach",
    open: ", {count} offen",
    follows: ": Es folgt dem Weg zu {fit}",
    predicts: " und sagt bei {speed} eine Eindrückung von {crush}{interval} voraus",
    predicts_collision: " und sagt gegen {partner} eine Eindrückung von {crush}{interval} voraus",
    none_recommended: "Kein Modell wird empfohlen: {because}{closest}.",
    no_crush: "Federn, die eine Masse anhalten, erklären eine solche Aufzeichnung nicht",
    other_axis: "der Puls liegt in {axis}, und die Modelle sind solche einer Eindrückung in x",
    closest: "; das nächste, {model}, folgt dem Weg zu {fit} bis {time} und sagt darüber hinaus nichts",
    distrust: "; Misstrauen verdient {what}",
    open_numbers: "{names}, von dieser Aufzeichnung offen gelassen",
    dual: "die Aufteilung der Massen, denn das Spiegelbild ergibt dieselbe Aufzeichnung",
    hardly: "{names}, nur der Größenordnung nach bekannt",
    extrapolates: "alles über {speed}, der Geschwindigkeit des Versuchs: Dort wird extrapoliert",
    decisive: "alles, bis die erste Warnung geklärt ist",
    and: "und",
    sensors_differ: "Aufnehmer der Fahrgastzelle ergeben eine Eindrückung von {low} bis {high}, außerhalb des \
                     Intervalls dieses einen",
    warn_open: "{names} des empfohlenen Modells {model} kann nach dieser Aufzeichnung alles sein",
    warn_hardly: "{names} des empfohlenen Modells {model} ist nur der Größenordnung nach bekannt",
    warn_dual: "das empfohlene Modell {model} hat ein Spiegelbild mit genau derselben Aufzeichnung; ein zweiter \
                Aufnehmer, am Vorderwagen oder am Motor, entscheidet",
    warn_closest: "das nächste Modell, {model}, lässt {open} von {parameters} Zahlen offen: Seine Kurve ist brauchbar, \
                   seine Zahlen sind es nicht",
    warn_extrapolates: "Vorhersagen über {speed} gehen über das Geprüfte hinaus",
    warn_two_vehicles: "ein Zusammenstoß zweier Fahrzeuge: Der Weg über Grund ist keines Fahrzeugs Eindrückung, und \
                        die Modelle nehmen das andere für eine starre Wand",
    before_use: "Vor dem Gebrauch",
    one_more: "1 weitere Warnung",
    more: "{count} weitere Warnungen",
    identification: "Identifikation",
    verdict: "Urteil",
    what_to_do: "Abhilfe: {remedy}.",
    labels: ["Eindrückung", "Zeit bis dahin", "Delta-v", "Stoßzahl", "Spitzenwert", "OLC"],
    model_label: "empfohlen",
    warnings_label: "vor dem Gebrauch",
    missing_label: "fehlt darin",
    files_label: "Bericht",
    to: "bis",
};
