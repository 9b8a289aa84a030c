//! Remarks of the stages whose numbers are all that they claim: each has to stand in a record.

/// Name and sentence; a place takes words, also none.
pub const REMARKS: &[(&str, &str)] = &[
    ("note.too-flat", "the pulse never exceeds {level} for {time}: check its channel and unit"),
    (
        "note.noisy-before",
        "the pulse is noisy before the event: standard deviation {level}, at most {usual} is usual: {more}",
    ),
    ("note.first-exceeds", "the pulse first exceeds {level} for {time} at {instant}: check time zero {more}"),
    ("note.equal-samples", "equal samples in a row at an extreme (clipped?) in {channels}"),
    (
        "note.recorder-zero",
        "event data recorder (49 CFR 563): time zero is the recorder's, some milliseconds after contact",
    ),
    ("note.recorder-table", "event data recorder table: the velocity change is cumulative and coarse {more}"),
    ("note.change-as-pulse", "the change of velocity {channel} is taken as the pulse"),
    ("note.level-in", "mean over the last {time} above {level} (drift, or still moving) in {channels}"),
    ("note.without-file", "{count} of {all} listed channels have no file here: {channels}"),
    ("note.left-and-right", "channels {one} and {two} (left and right) differ by at most {more}"),
    ("note.configuration", "configuration: {what}"),
    (
        "note.vehicles-meet",
        "vehicles {one} and {two} meet: mass, speed and description are those of vehicle {which}, {more}",
    ),
    ("note.no-pulse", "no channel is named as the crash pulse: {why}"),
    ("note.time-zero-of-file", "time zero is the file's t = 0, {samples} samples after its start"),
    ("note.start", "integrated from the start of the record ({time}) with the impact speed, because {why}"),
    ("note.intervals", "intervals are {level} of {count} replicates (seed {seed}) with {inputs}"),
    ("note.thirds", "{model}: {masses}: {more}, an assumption that the parameters depend on"),
    (
        "note.sets",
        "{model}: {count} parameter sets fit within {share} as well as the best; the record does not determine \
         the parameters",
    ),
    ("note.free-fall", "free fall before contact {more}"),
    ("note.level-before", "the level before contact is {level}: an offset, or a free fall. {more}"),
    ("note.axis", "channels start {more}"),
    ("note.no-unit", "no unit is known for {channels}: kept as read, quantity other"),
    ("note.handed-on", "channel {channel}: handed on as it is"),
    ("note.of-a-dummy", "channel {channel}: of a dummy, filtered to {more}"),
    (
        "note.no-motion",
        "channel {channel}: all {count} samples after the first are zero: there is no motion to identify",
    ),
    ("note.no-stabilisation", "{method}: no stabilisation diagram: {why}"),
    (
        "note.waits",
        "channel {channel} first exceeds {level} for {time} at {instant}, and nothing says that contact is at {more}",
    ),
    ("note.not-in-spread", "channel {channel} is not in the spread: {why}"),
    ("note.not-integrated", "not integrated, because {why}: channels {channels} {more}"),
    ("note.against", "channel {one} against {two}: largest |da| {more}"),
    ("note.bounds-of-axes", "criteria are lower bounds where the resultant is of one or two axes alone: {channels}"),
    ("note.crash3", "crush stiffness (CRASH3): {why}"),
    ("note.spread", "dynamic crush of {count} channels: {range}; the spread of every metric is {more}"),
    (
        "note.as-if-wall",
        "models of one vehicle at a rigid barrier are fitted to the pulse as if it had met one: {more}",
    ),
    ("note.momentum", "momentum: the changes of both vehicles leave {share} of that of vehicle {which} over; {more}"),
    ("note.heads", "vehicle {which} heads towards it, as the changes of velocity say: closing speed {speed}; {more}"),
    ("note.to-the-end", "{model}: the velocity of the record never reaches zero: fitted up to {time}, {more}"),
    ("note.not-solved-no-crush", "{model}: not solved, since the velocity of the record never reaches zero: {more}"),
    ("note.to-the-event", "the velocity never reaches zero: fitted up to the end of the event at {more}"),
    ("note.does-not-stop", "the vehicle does not stop within the record: its models are assessed over {more}"),
    ("note.no-force", "the pulse does not slow the vehicle down, so that there is no force to model"),
    (
        "note.elastoplastic",
        "elastoplastic: not solved, coefficient_of_restitution is {value}, expected at most 1 {more}",
    ),
    (
        "note.pairs",
        "{model}: {count} pairs of parameter sets fit equally well within the accuracy of the record; {more}",
    ),
    ("note.too-far", "the vehicle moves further than its impact speed alone would carry it, {more}"),
    ("note.no-mass-no-models", "the test has no mass, which turns frequencies into N/m"),
    (
        "note.none-for-predictions",
        "none of the candidates is for predictions: {why}; --candidate shows what one of them says",
    ),
];
