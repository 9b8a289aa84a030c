//! Identified models: their section and its figures.

texts! { IdentificationTexts
    title: "Identification", "Identifikation";
    one_model:
        "{count} identified model: poles, order, frequency response",
        "{count} identifiziertes Modell: Pole, Ordnung, Frequenzgang";
    models:
        "{count} identified models: poles, order, frequency response",
        "{count} identifizierte Modelle: Pole, Ordnung, Frequenzgang";
    method: "method {method}", "Verfahren {method}";
    order: "order {order}", "Ordnung {order}";
    output: "output {channel}", "Ausgang {channel}";
    channel_taken_for: "channel {channel} taken for {what}", "Kanal {channel} als {what} genommen";
    stretch: "{times}, {count} samples", "{times}, {count} Werte";
    hankel: "Hankel matrix {rows} × {columns}", "Hankelmatrix {rows} × {columns}";
    fit: "fit {fit}", "Anpassung {fit}";
    poles_and_pairs: "{count} poles and pairs", "{count} Pole und Polpaare";
    pole: "Pole, 1/s", "Polstelle, 1/s";
    natural_frequency: "Natural frequency, Hz", "Eigenfrequenz, Hz";
    natural_frequency_definition: "Modulus of the pole over 2π.", "Betrag des Pols durch 2π.";
    damping_ratio: "Damping ratio, %", "Dämpfungsgrad, %";
    damping_ratio_definition: "−Re over the modulus; negative: unstable.", "−Re durch den Betrag; negativ: instabil.";
    coherence: "Coherence", "Kohärenz";
    coherence_definition:
        "Modal amplitude coherence, 0 to 1: how well the mode follows its own decay.",
        "Modale Amplitudenkohärenz, 0 bis 1: wie gut die Eigenschwingung ihrem eigenen Abklingen folgt.";
    share: "Share", "Anteil";
    share_definition:
        "Mode singular value relative to the largest: the mode's share of the response.",
        "Singulärwert der Eigenschwingung, bezogen auf den größten: ihr Anteil an der Antwort.";
    unstable: "unstable", "instabil";
    deviation:
        "± one standard deviation, from the covariance of the fit.",
        "± eine Standardabweichung, aus der Kovarianz der Anpassung.";
    no_deviation:
        "No uncertainty of these poles is known.",
        "Eine Unsicherheit dieser Pole ist nicht bekannt.";
    spread:
        "± one standard deviation, from the bootstrap.",
        "± eine Standardabweichung, aus dem Bootstrap.";
    integrator: "no mode: near zero", "keine Eigenschwingung: nahe null";
    beyond_nyquist: "no mode: beyond the sampling", "keine Eigenschwingung: jenseits der Abtastung";
    marginal: "marginal", "grenzstabil";
    unseen_fit: "unseen samples {fit}", "ungesehene Werte {fit}";
    failed_methods: "Not identified", "Nicht identifiziert";
    poles: "Poles and zeros of the identified models", "Pole und Nullstellen der identifizierten Modelle";
    real_part: "real part, 1/s", "Realteil, 1/s";
    imaginary_part: "imaginary part, rad/s", "Imaginärteil, rad/s";
    unstable_poles: "{model}, unstable", "{model}, instabil";
    zeros: "{model}, zeros", "{model}, Nullstellen";
    poles_caption:
        "Continuous poles, and zeros as circles; their mirror images below the real axis are not drawn. Rays join \
         poles of equal damping ratio ζ, circles those of equal natural frequency.",
        "Zeitkontinuierliche Pole, Nullstellen als Kreise; ihre Spiegelbilder unter der reellen Achse sind nicht \
         gezeichnet. Strahlen verbinden Pole gleichen Dämpfungsgrads ζ, Kreise solche gleicher Eigenfrequenz.";
    all_stable: " All poles are stable.", " Alle Pole sind stabil.";
    one_unstable:
        " One pole is unstable (right half plane): it describes the window, not what was measured.",
        " Ein Pol ist instabil (rechte Halbebene): Er beschreibt das Fenster, nicht das Gemessene.";
    several_unstable:
        " {count} poles are unstable (right half plane): they describe the window, not what was measured.",
        " {count} Pole sind instabil (rechte Halbebene): Sie beschreiben das Fenster, nicht das Gemessene.";
    one_marginal:
        " One pole is marginal (on the stability limit): it neither dies down nor grows over the record.",
        " Ein Pol ist grenzstabil: Er klingt über die Aufzeichnung weder ab noch an.";
    several_marginal:
        " {count} poles are marginal (on the stability limit): they neither die down nor grow over the record.",
        " {count} Pole sind grenzstabil: Sie klingen über die Aufzeichnung weder ab noch an.";
    one_far_zero:
        " {count} zero lies farther out than these poles.",
        " {count} Nullstelle liegt weiter außen als diese Pole.";
    far_zeros:
        " {count} zeros lie farther out than these poles.",
        " {count} Nullstellen liegen weiter außen als diese Pole.";
    one_far_pole: " {count} far pole lies outside the axes.", " {count} ferner Pol liegt außerhalb der Achsen.";
    far_poles: " {count} far poles lie outside the axes.", " {count} ferne Pole liegen außerhalb der Achsen.";
    singular_values: "Evidence for the order", "Was für die Ordnung spricht";
    index: "index", "Nummer";
    relative_singular_value: "relative singular value", "relativer Singulärwert";
    values: "{model}, values", "{model}, Werte";
    singular_values_caption:
        "Singular values of the Hankel matrix relative to the largest.",
        "Singulärwerte der Hankelmatrix, bezogen auf den größten.";
    wide_gap:
        " A wide gap supports the order before it; on a gentle slope the record does not determine the order.",
        " Ein großer Sprung stützt die Ordnung davor; bei sanftem Abfall bestimmt die Aufzeichnung die Ordnung nicht.";
    stabilisation: "Stabilisation diagram", "Stabilisierungsdiagramm";
    natural_frequency_axis: "natural frequency, Hz", "Eigenfrequenz, Hz";
    order_axis: "order", "Ordnung";
    all_are_stable: "frequency, damping, shape stable", "Frequenz, Dämpfung, Form stabil";
    frequency_and_damping_stable: "frequency and damping stable", "Frequenz und Dämpfung stabil";
    frequency_stable: "frequency stable", "Frequenz stabil";
    new: "new", "neu";
    rejected: "rejected", "verworfen";
    stabilisation_caption:
        "{method} of {channel}: poles of models of rising order, from one factorisation. Compared with the order \
         before, stable is a frequency within {frequency}, a damping ratio within {damping}{shape}. Rejected: growing, \
         damping ratio above {highest}, above {nyquist} of the Nyquist frequency, or no stronger than noise.",
        "{method} von {channel}: Pole von Modellen steigender Ordnung, aus einer Zerlegung. Stabil gegenüber der \
         Ordnung davor ist eine Frequenz innerhalb {frequency}, ein Dämpfungsgrad innerhalb {damping}{shape}. \
         Verworfen: anwachsend, Dämpfungsgrad über {highest}, über {nyquist} der Nyquistfrequenz oder nicht stärker \
         als Rauschen.";
    modes_marked:
        " Marked: modes present in {presence} of the orders or more ({count}).",
        " Markiert: Eigenschwingungen in {presence} der Ordnungen oder mehr ({count}).";
    no_mode_marked:
        " No mode is present in {presence} of the orders, none is marked.",
        " Keine Eigenschwingung liegt in {presence} der Ordnungen vor, keine ist markiert.";
    shape_within: ", a shape with MAC of {mac} or more", ", eine Form mit MAC ab {mac}";
    more_diagrams: " {count} more are in the artifact.", " {count} weitere stehen im Artefakt.";
    bode: "Frequency response", "Frequenzgang";
    frequency: "frequency, Hz", "Frequenz, Hz";
    magnitude: "magnitude, dB", "Betrag, dB";
    phase: "phase, °", "Phasenwinkel, °";
    bode_caption:
        "From {input} to {output}{units}. Phase is unwrapped; natural frequencies of oscillating poles are marked.",
        "Von {input} nach {output}{units}. Die Phase ist stetig fortgesetzt; Eigenfrequenzen schwingender Pole sind \
         markiert.";
    si_units: ", SI units", ", SI-Einheiten";
    the_input: "the input", "dem Eingang";
    the_output: "the output", "dem Ausgang";
    band_of: " Band of {model}: {band}.", " Band von {model}: {band}.";
    no_band:
        " No band: the records hold no uncertainty of these models.",
        " Kein Band: Die Datensätze enthalten keine Unsicherheit dieser Modelle.";
    impulse_title: "Impulse response", "Impulsantwort";
    impulse_and_step_title: "Impulse and step response", "Impuls- und Sprungantwort";
    record: "the record", "die Aufzeichnung";
    impulse_response: "impulse response{unit}", "Impulsantwort{unit}";
    step_response: "step response{unit}", "Sprungantwort{unit}";
    time_of_window: "time from the start of the window, {unit}", "Zeit ab Beginn des Fensters, {unit}";
    per: ", {output} per {input}", ", {output} je {input}";
    response_caption:
        "Response of {output} to a {impulse}, from rest.",
        "Antwort: {output} auf {impulse}, aus der Ruhe.";
    response_step_caption:
        "Response of {output} to a {impulse} and to a unit step, from rest.",
        "Antwort: {output} auf {impulse} und auf einen Einheitssprung, aus der Ruhe.";
    unit_impulse: "unit impulse", "Einheitsimpuls";
    unit_sample: "unit sample", "Einheitsabtastwert";
    died_down:
        " The axis of time ends where the impulse response has died down.",
        " Die Zeitachse endet, wo die Impulsantwort abgeklungen ist.";
    hidden:
        " {count} models with another output, another impulse, or far larger responses are hidden: their names in the \
         legend show them.",
        " {count} Modelle mit anderem Ausgang, anderem Impuls oder weit größerer Antwort sind ausgeblendet: Ihre \
         Namen in der Legende zeigen sie.";
}
