//! What is computed for a metric, in German. The English text is that of the record.

/// Key of the definition (`crumple-metrics`), German text.
pub const DEFINITIONS: &[(&str, &str)] = &[
    ("anova-mean", "Mittelwert von (m - c)/max|m|; bis 0,05 gilt für Schutzeinrichtungen als annehmbar"),
    (
        "anova-std",
        "Standardabweichung von (m - c)/max|m|, Teiler N - 1; bis 0,35 gilt für Schutzeinrichtungen als annehmbar",
    ),
    ("asi-en1317-1998", "Index der Beschleunigungsschwere aus 50-ms-Mitteln nach vorn, Grenzwerte 12, 9, 10 g"),
    (
        "asi-en1317-2010",
        "Index der Beschleunigungsschwere nach phasenfreiem vierpoligem Butterworth-Tiefpass, Entwurfsfrequenz 13 Hz \
         je Durchlauf, Grenzwerte 12, 9, 10 g",
    ),
    (
        "asi-en1317-2010-two-pass",
        "Index der Beschleunigungsschwere nach phasenfreiem vierpoligem Butterworth-Tiefpass, -3 dB bei 13 Hz nach \
         beiden Durchläufen, Grenzwerte 12, 9, 10 g",
    ),
    ("barrier-delta-v", "Impuls der Barriere durch die Masse"),
    (
        "barrier-delta-v-as-read",
        "Impuls aller Kraftmessdosen mit Daten, auch der nicht als gültig bezeichneten, durch die Masse; vor dem \
         Filtern abgezogene Nullpunkte sind wieder addiert",
    ),
    ("barrier-impulse", "Integral der Summe der Kraftmessdosen vom Zeitnullpunkt bis zum Ende, nach der Trapezregel"),
    ("barrier-peak", "betragsgrößter Messwert der Summe der Kraftmessdosen entlang x, Druck positiv"),
    ("centroid-crush", "t_c = C/v0, gleich dem Schwerpunkt des Pulses über 0..t_m (Huang, 2002)"),
    (
        "centroid-moment",
        "Integral von t*a durch Integral von a bis t_m, nach der Trapezregel; gleich C/v0 bis auf Abtast- und \
         Integrationsfehler",
    ),
    (
        "centroid-ratio",
        "t_c/t_m: 0,5 symmetrisch, 2/pi ungedämpfte Feder, kleiner bei frühem Kraftmaximum (Huang, 2002)",
    ),
    ("clip3-cumulative", "höchstes Niveau, das insgesamt 3 ms lang überschritten wird"),
    ("clip3-saej1727", "höchstes Niveau, das eine Spitze 3 ms lang ohne Unterbrechung überschreitet"),
    ("cora", "0,5 Korridor + 0,5 Kreuzkorrelation im genannten Intervall"),
    ("cora-automatic", "0,5 Korridor + 0,5 Kreuzkorrelation im automatischen Intervall"),
    ("cora-corridor", "Korridorbewertung wie in ISO 18571"),
    (
        "cora-corridor-automatic",
        "Korridorbewertung im automatischen Intervall: von 3 % des größten |T| bis zu den letzten 7,5 %, beidseits 1 % \
         länger",
    ),
    ("cora-cross", "0,5 Verlauf + 0,25 Größe + 0,25 Phase bei der Verschiebung mit der größten Kreuzkorrelation"),
    ("cora-cross-automatic", "Bewertung der Kreuzkorrelation im automatischen Intervall"),
    ("corridor-excursion", "Dauer des längsten Aufenthalts außerhalb des Korridors"),
    ("corridor-exit", "Zeit, zu der das Signal den Korridor zuerst verlässt"),
    ("corridor-inside", "Anteil der gemeinsamen Zeit, in der das Signal im Korridor liegt"),
    ("crash3-a", "A = m*b0*b1/L, Kraft je Breite, bei der die Verformung beginnt, aus V = b0 + b1*C_res"),
    ("crash3-b", "B = m*b1^2/L, Steifigkeit je Breite"),
    (
        "crash3-energy",
        "Verformungsenergie eines Schadensprofils aus gleich weit entfernten Messstellen, mal 1 + tan^2 des \
         Kraftwinkels",
    ),
    ("crash3-g", "G = A^2/(2B), ohne Verformung aufgenommene Energie je Breite"),
    ("delta-v", "v0 - v_s, Aufprallgeschwindigkeit minus kleinste Geschwindigkeit nach t_m"),
    ("drift-correction", "abgezogene Beschleunigung, mit der die genannte Geschwindigkeit erreicht wird"),
    ("dynamic-crush", "C = x(t_m), Weg beim ersten Nulldurchgang der Geschwindigkeit"),
    ("dynamic-crush-time", "t_m, erster Nulldurchgang der Geschwindigkeit, linear interpoliert"),
    (
        "edr-maximum-delta-v",
        "betragsgrößter aufgezeichneter Wert der Geschwindigkeitsänderung vom Zeitnullpunkt bis 300 ms, mit Vorzeichen",
    ),
    ("edr-maximum-delta-v-time", "Zeit des Werts von maximum_delta_v, bei gleichen die erste"),
    ("ees", "sqrt(2*E_abs/m), Geschwindigkeit mit der aufgenommenen Energie als Bewegungsenergie"),
    ("energy-absorbed", "m*(v0^2 - v_s^2)/2, Aufprallenergie minus Energie des Rückpralls"),
    (
        "energy-closure",
        "Arbeit der Barrierenkraft bis C durch die Aufprallenergie, minus 1; bei der Trapezregel 0 bis auf Rundung",
    ),
    ("energy-impact", "m*v0^2/2"),
    ("energy-loss-ratio", "1 - e^2, aufgenommene Energie durch Aufprallenergie"),
    ("energy-returned", "m*v_s^2/2, Energie des Rückpralls"),
    ("fit-percent", "100 (1 - ||y - yh||/||y - Mittelwert y||); negativ, wo der Mittelwert besser ist"),
    ("gsi", "Gadd-Index: Integral von (a in g)^2,5 über die Aufzeichnung, nach der Trapezregel"),
    ("hic-window", "Kopfverletzungskriterium mit dem genannten längsten Fenster"),
    (
        "hic15-fmvss208",
        "Kopfverletzungskriterium, Fenster bis einschließlich 15 ms: größtes (t2 - t1)*(Mittel von a in g)^2,5 aller \
         Paare von Messwerten",
    ),
    ("hic36-fmvss208", "Kopfverletzungskriterium, Fenster bis einschließlich 36 ms"),
    ("hicd-fmvss201", "HIC(d) = 0,75446*HIC36 + 166,4 eines frei bewegten Prüfkopfs"),
    ("iso18571", "R = 0,4 Z + 0,2 E_P + 0,2 E_M + 0,2 E_S"),
    ("iso18571-corridor", "Korridorbewertung Z, 5 % und 50 % des größten |T|, dazwischen quadratisch"),
    ("iso18571-magnitude", "Bewertung der Größe E_M nach Verschiebung und dynamischer Zeitnormierung"),
    ("iso18571-phase", "Bewertung der Phase E_P aus der Verschiebung mit der größten Korrelation, bis 20 %"),
    ("iso18571-slope", "Bewertung der Steigung E_S der verschobenen Signale, Ableitung über 9 Punkte gemittelt"),
    (
        "kw400",
        "2*W/(0,4^2 - 0,025^2), W die Arbeit der Wandkraft über dem Weg der Fahrgastzelle von 25 bis 400 mm: ergibt \
         die Steifigkeit einer linearen Feder; Grenzen und Teiler nach Sekundärquellen",
    ),
    (
        "momentum-ratio",
        "Impuls der Barriere bis zur Trennung durch Masse und Geschwindigkeitsänderung des Pulses; 1, wenn beide \
         stimmen",
    ),
    ("nrmse", "||y - yh||/||y - Mittelwert y|| = 1 - Anpassung/100"),
    (
        "oiv-x-mash",
        "Aufprallgeschwindigkeit des freien Insassen entlang x nach 0,6 m vorwärts oder 0,3 m seitwärts, ohne Gieren",
    ),
    ("oiv-y-mash", "Aufprallgeschwindigkeit des freien Insassen entlang y, wie entlang x"),
    (
        "olc-tb027",
        "Occupant Load Criterion: konstante Verzögerung über 235 mm Rückhalteweg nach 65 mm freiem Flug, am Ende mit \
         der Geschwindigkeit des Fahrzeugs; OLC++ fasst olc, sm25 und time_of_dynamic_crush mit unbekannten Gewichten \
         zusammen: angegeben sind die drei einzeln",
    ),
    ("ora-x-mash", "betragsgrößtes 10-ms-Mittel der Beschleunigung entlang x nach dem Aufprall des Insassen"),
    ("ora-y-mash", "betragsgrößtes 10-ms-Mittel der Beschleunigung entlang y, wie entlang x"),
    ("peak-sample", "größter Betrag |a| eines Messwerts ab dem Beginn der Integration"),
    ("peak-sample-time", "Zeit des Messwerts mit dem größten |a|"),
    ("phd-en1317", "größte Resultierende der 10-ms-Mittel nach dem Flug des Kopfes"),
    ("r2", "1 - NRMSE^2"),
    ("rebound-displacement", "d_e = C - x(t_s), bis zur kleinsten Geschwindigkeit zurückgewonnener Weg"),
    ("restitution-barrier", "e = -v_s/v0 gegen eine starre Barriere"),
    ("restitution-two-bodies", "e = (v2' - v1')/(v1 - v2) zweier Körper"),
    ("ridedown-efficiency", "2/v0^2 mal Arbeit der Insassenverzögerung über dem Weg des Fahrzeugs"),
    ("ridedown-restraint", "2/v0^2 mal Arbeit der Insassenverzögerung über dem Weg des Insassen im Fahrzeug"),
    ("ridedown-travel", "größter Weg des Insassen im Fahrzeug"),
    ("rmse", "Wurzel aus dem mittleren Quadrat von m - c"),
    (
        "separation-drift",
        "|Mittelwert von a| der letzten 20 ms der Aufzeichnung: unter 0,5 g, sobald das Fahrzeug frei ist",
    ),
    ("sliding-mean", "größtes |V(t + w) - V(t)|/w über die genannte Fensterlänge w, V = Integral von a, t im Raster"),
    (
        "sliding-mean-25ms",
        "größtes |V(t + 25 ms) - V(t)|/25 ms ab dem Zeitnullpunkt, V = Integral von a, t im Raster; ein Teil von OLC++",
    ),
    ("sprague-geers-c", "sqrt(M^2 + P^2)"),
    ("sprague-geers-m", "M = sqrt(I_cc/I_mm) - 1"),
    ("sprague-geers-p", "P = acos(I_mc/sqrt(I_mm I_cc))/pi; verliert nahe 0 die Hälfte der Stellen"),
    ("square-wave-displacement", "ESW = v0^2/(2C), konstante Verzögerung mit derselben Eindrückung (Huang, 2002)"),
    ("square-wave-time", "ASW = v0/t_m, konstante Verzögerung, die in derselben Zeit anhält (Huang, 2002)"),
    ("stiffness-average", "k = m*v0^2/C^2, lineare Feder gleicher Energie"),
    ("theil-u1", "||m - c||/(||m|| + ||c||), 0 bis 1"),
    ("theil-u2", "||m - c||/||m||"),
    (
        "thiv-en1317",
        "theoretische Kopfaufprallgeschwindigkeit: Geschwindigkeit eines freien Kopfes gegen die Kabine nach 0,6 m \
         vorwärts oder 0,3 m seitwärts",
    ),
    ("time-zero-edr", "erster Messwert der ersten 20 ms, in denen |Geschwindigkeitsänderung| 0,8 km/h übersteigt"),
    ("time-zero-threshold", "erstes dauerhaftes Überschreiten der Schwelle, interpoliert"),
    ("two-vehicles-common-velocity", "Geschwindigkeit des ersten Fahrzeugs beim ersten Nulldurchgang der relativen"),
    (
        "two-vehicles-common-velocity-momentum",
        "(m1 v1 + m2 v2)/(m1 + m2) der Geschwindigkeiten vor dem Stoß, entlang der Achse des ersten Fahrzeugs",
    ),
    (
        "two-vehicles-common-velocity-time",
        "erster Nulldurchgang der relativen Geschwindigkeit zweier Fahrzeuge, linear interpoliert",
    ),
    (
        "two-vehicles-momentum-gap",
        "(m1 dv1 + m2 dv2)/(m1 |dv1|) bis zur gemeinsamen Geschwindigkeit: 0, wenn keine andere Kraft wirkt",
    ),
    (
        "two-vehicles-relative-crush",
        "Annäherung der Sensoren zweier Fahrzeuge bis zur gemeinsamen Geschwindigkeit, Integral von v1 - v2 entlang \
         der Achse des ersten",
    ),
    ("vaf-percent", "100 (1 - var(y - yh)/var(y)): blind für einen konstanten Versatz"),
    ("vpi-iso12353-3", "Vehicle Pulse Index: größte Gurtkraft von 1 kg an 2500 N/m nach 30 mm Gurtlose"),
    ("wall-initial-stiffness", "Steigung der Ausgleichsgeraden der Wandkraft über dem Weg von 25 bis 200 mm"),
    ("x-mean", "mittlere Verzögerung über 0..t_m, (v(0) - v(t_m))/t_m aus der integrierten Geschwindigkeit"),
];
