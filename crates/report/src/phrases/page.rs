//! Header of a report, its table of channels, words of every table.

texts! { PageTexts
    brand: "Crumple · crash pulse report";
    brand_generic: "Crumple · identification report";
    untitled: "Untitled record";
    not_known: "not known";
    vehicle: "Vehicle";
    test_mass: "Test mass";
    impact_speed: "Impact speed";
    barrier: "Barrier";
    channel_taken: "Channel taken";
    sampling: "Sampling";
    samples: "{rate}, {count} samples";
    axis: ", {axis} axis";
    channels: "Channels";
    taken_of_one:
        "Taken as the crash pulse: <strong>{id}</strong>{place}. The test lists {count} channel in all{states}.";
    taken_of_several:
        "Taken as the crash pulse: <strong>{id}</strong>{place}. The test lists {count} channels in all{states}.";
    no_pulse:
        "The test does not say which of its channels is the crash pulse.";
    not_on_paper:
        "Left out on paper, for want of valid data: {count}.";
    all_channels: "Show all {count} channels";
    id: "Id";
    location: "Location";
    axis_head: "Axis";
    quantity: "Quantity";
    status: "Status";
    remark: "Remark";
    taken: "taken";
    redundant: "redundant";
    to: "to";
    yes: "yes";
    no: "no";
}
