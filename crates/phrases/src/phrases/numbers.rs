//! Key numbers, events, metrics.

texts! { NumberTexts
    key_numbers: "Key numbers", "Kennwerte";
    dynamic_crush: "Dynamic crush C", "Dynamische Eindrückung C";
    motion_over_ground: "Motion over ground", "Weg über Grund";
    time_of_crush: "Time of crush t<sub>m</sub>", "Eindrückungszeit t<sub>m</sub>";
    delta_v: "Velocity change Δv", "Geschwindigkeits\u{ad}änderung Δv";
    maximum_delta_v: "Maximum Δv as recorded", "Größtes Δv laut Aufzeichnung";
    time_of_maximum_delta_v: "Time of maximum Δv", "Zeitpunkt des größten Δv";
    restitution: "Restitution e", "Stoßzahl e";
    clip_3ms: "3 ms clip", "3-ms-Wert";
    peak: "Peak", "Spitzenwert";
    peak_cfc: "Peak, CFC\u{a0}{cfc}", "Spitzenwert, CFC\u{a0}{cfc}";
    peak_filtered: "Peak, filtered at {frequency}", "Spitzenwert, gefiltert bei {frequency}";
    no_interval:
        "no interval: the uncertainty of the inputs is not stated",
        "kein Intervall: Die Unsicherheit der Eingaben ist nicht angegeben";
    sensors: "{count} sensors: {interval}", "{count} Aufnehmer: {interval}";
    inputs: "inputs, 90\u{a0}%", "Eingaben, 90\u{a0}%";
    resolution: "resolution", "Auflösung";
    interval: "interval", "Intervall";
    at: "at {time}", "bei {time}";
    does_not_reach_zero: "; the velocity does not reach zero", "; die Geschwindigkeit wird nicht null";
    rebound: "rebound {speed}", "Rückprall {speed}";
    olc: "occupant load", "Insassenbelastung";
    hic: "head injury criterion", "Kopf\u{ad}verletzungs\u{ad}kriterium";
    inputs_caption:
        "“Inputs”: {by} with mass, speed, gain, zero level and time zero within their stated uncertainty, one sensor.",
        "„Eingaben“: {by}, wobei Masse, Geschwindigkeit, Verstärkung, Nullpunkt und Zeitnullpunkt in ihrer \
         angegebenen Unsicherheit liegen, ein Aufnehmer.";
    resolution_caption: "“Resolution”: {by}.", "„Auflösung“: {by}.";
    sensors_caption:
        "“Sensors”: lowest to highest of channels {channels}, which measured the same motion.",
        "„Aufnehmer“: kleinster bis größter Wert der Kanäle {channels}, die dieselbe Bewegung maßen.";
    marked_caption:
        "A marked range goes beyond the interval: the sensors differ by more than the stated uncertainty explains; \
         take both together.",
        "Ein hervorgehobener Bereich reicht über das Intervall hinaus: Die Aufnehmer weichen stärker voneinander ab, \
         als die angegebene Unsicherheit erklärt; dann gelten beide zusammen.";
    velocity_never_zero: "the velocity does not reach zero", "die Geschwindigkeit wird nicht null";
    peak_of_a_table:
        "derived from a recorder's table of velocity changes, whose steps are too long for a peak",
        "aus der Tabelle der Geschwindigkeitsänderungen eines Aufzeichnungsgeräts, deren Schritte für einen \
         Spitzenwert zu lang sind";
    peak_not_filtered:
        "not filtered: the peak of a raw acceleration is mostly ringing",
        "nicht gefiltert: Der Spitzenwert einer rohen Beschleunigung ist meist Schwingung";
    events_and_metrics: "Events and metrics", "Ereignisse und Kenngrößen";
    events: "Events", "Ereignisse";
    time_zero_rule:
        "Times count from time zero, which was set by: {rule}.",
        "Zeiten zählen ab dem Zeitnullpunkt, gesetzt durch: {rule}.";
    metrics: "Metrics", "Kenngrößen";
    point_at_a_name:
        "Point at a name for its definition, or the reason why a value is absent; point at an interval for how it was \
         found.",
        "Wer auf einen Namen zeigt, liest seine Definition oder warum ein Wert fehlt; auf ein Intervall: wie es \
         bestimmt wurde.";
    of_others: "Occupants, barrier and recorder", "Insassen, Barriere und Aufzeichnungsgerät";
    place: "Place", "Ort";
    metric: "Metric", "Kenngröße";
    value: "Value", "Wert";
    lower_bound: "{value} (lower bound)", "{value} (untere Schranke)";
    other_channel: "Metrics of {count} other channel, beside the pulse's", "Kenngrößen von {count} weiteren Kanal";
    other_channels:
        "Metrics of {count} other channels, beside the pulse's",
        "Kenngrößen von {count} weiteren Kanälen";
    over: "over {channels}", "über {channels}";
    range: "range", "Bereich";
    from_to: ", from {interval}", ", von {interval}";
    at_time: ", at {time}", ", bei {time}";
    change_of_event:
        "Impact speed minus the lowest velocity up to the end of the event at {time} ({rule}); the velocity does not \
         reach zero.",
        "Aufprallgeschwindigkeit minus kleinste Geschwindigkeit bis zum Ende des Ereignisses bei {time} ({rule}); die \
         Geschwindigkeit wird nicht null.";
    change_definition:
        "Impact speed minus rebound velocity.",
        "Aufprallgeschwindigkeit minus Rückprallgeschwindigkeit.";
    crush_name: "dynamic crush C", "dynamische Eindrückung C";
    crush_definition:
        "Displacement at the first zero of the velocity.",
        "Weg bei der ersten Nullstelle der Geschwindigkeit.";
    time_name: "time of dynamic crush t_m", "Zeit der dynamischen Eindrückung t_m";
    time_definition: "Time of the first zero of the velocity.", "Zeit der ersten Nullstelle der Geschwindigkeit.";
    centroid_name: "centroid time t_c", "Schwerpunktzeit t_c";
    centroid_definition:
        "Centroid of the pulse from time zero to t_m; C / v0.",
        "Schwerpunkt des Pulses vom Zeitnullpunkt bis t_m; C / v0.";
    rebound_name: "rebound velocity", "Rückprallgeschwindigkeit";
    rebound_definition: "Lowest velocity after t_m.", "Kleinste Geschwindigkeit nach t_m.";
    rebound_time_name: "time of rebound", "Zeit des Rückpralls";
    rebound_time_definition: "Time of the rebound velocity.", "Zeit der Rückprallgeschwindigkeit.";
    restitution_name: "coefficient of restitution e", "Stoßzahl e";
    restitution_definition:
        "−rebound velocity / impact speed.",
        "−Rückprallgeschwindigkeit / Aufprallgeschwindigkeit.";
    change_name: "change of velocity", "Geschwindigkeitsänderung";
    speed_name: "impact speed", "Aufprallgeschwindigkeit";
    speed_definition: "Speed the integration started from.", "Geschwindigkeit, bei der die Integration begann.";
    zero_name: "time zero on the record's axis", "Zeitnullpunkt auf der Achse der Aufzeichnung";
    zero_definition:
        "Offset of time zero on the time axis of the file.",
        "Lage des Zeitnullpunkts auf der Zeitachse der Datei.";
    change_time_name: "time of the change of velocity", "Zeit der Geschwindigkeitsänderung";
    change_time_definition: "Time of the lowest velocity.", "Zeit der kleinsten Geschwindigkeit.";
    end_name: "end of the event", "Ende des Ereignisses";
    no_rule: "rule not stated", "Regel nicht angegeben";
}
