//! Header of a report, its table of channels, words of every table.

texts! { PageTexts
    brand: "Crumple · crash pulse report", "Crumple · Bericht zum Crashpuls";
    brand_generic: "Crumple · identification report", "Crumple · Identifikationsbericht";
    untitled: "Untitled record", "Aufzeichnung ohne Titel";
    not_known: "not known", "nicht bekannt";
    vehicle: "Vehicle", "Fahrzeug";
    test_mass: "Test mass", "Versuchsmasse";
    impact_speed: "Impact speed", "Aufprallgeschwindigkeit";
    barrier: "Barrier", "Barriere";
    channel_taken: "Channel taken", "Verwendeter Kanal";
    sampling: "Sampling", "Abtastung";
    samples: "{rate}, {count} samples", "{rate}, {count} Werte";
    axis: ", {axis} axis", ", {axis}-Achse";
    channels: "Channels", "Kanäle";
    taken_of_one:
        "Taken as the crash pulse: <strong>{id}</strong>{place}. The test lists {count} channel in all{states}.",
        "Als Crashpuls verwendet: <strong>{id}</strong>{place}. Der Versuch nennt insgesamt {count} Kanal{states}.";
    taken_of_several:
        "Taken as the crash pulse: <strong>{id}</strong>{place}. The test lists {count} channels in all{states}.",
        "Als Crashpuls verwendet: <strong>{id}</strong>{place}. Der Versuch nennt insgesamt {count} Kanäle{states}.";
    no_pulse:
        "The test does not say which of its channels is the crash pulse.",
        "Der Versuch sagt nicht, welcher seiner Kanäle der Crashpuls ist.";
    not_on_paper:
        "Left out on paper, for want of valid data: {count}.",
        "Auf Papier weggelassen, da ohne gültige Daten: {count}.";
    all_channels: "Show all {count} channels", "Alle {count} Kanäle zeigen";
    id: "Id", "Kennung";
    location: "Location", "Einbauort";
    axis_head: "Axis", "Achse";
    quantity: "Quantity", "Größe";
    status: "Status", "Zustand";
    remark: "Remark", "Bemerkung";
    taken: "taken", "verwendet";
    redundant: "redundant", "redundant";
    to: "to", "bis";
    yes: "yes", "ja";
    no: "no", "nein";
}
