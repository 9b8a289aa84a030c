//! Key numbers, events, metrics.

texts! { NumberTexts
    key_numbers: "Key numbers";
    motion_over_ground: "Motion over ground";
    peak_cfc: "Peak, CFC\u{a0}{cfc}";
    peak_filtered: "Peak, filtered at {frequency}";
    no_interval:
        "no interval: it needs mass, impact speed and the uncertainty of the inputs";
    sensors: "{count} sensors: {interval}";
    inputs: "inputs, 90\u{a0}%";
    resolution: "resolution";
    interval: "interval";
    at: "at {time}";
    does_not_reach_zero: "; the velocity does not reach zero";
    rebound: "rebound {speed}";
    from_the_left: "from the left";
    from_the_right: "from the right";
    olc: "occupant load";
    hic: "head injury criterion";
    inputs_caption:
        "“Inputs”: {by} with mass, speed, gain, zero level and time zero within their stated uncertainty, one sensor.";
    resolution_caption: "“Resolution”: {by}.";
    sensors_caption:
        "“Sensors”: lowest to highest of channels {channels}, which measured the same motion.";
    marked_caption:
        "A marked range goes beyond the interval: the sensors differ by more than the stated uncertainty explains; \
         take both together.";
    velocity_never_zero: "the velocity does not reach zero";
    peak_not_filtered:
        "not filtered: the peak of a raw acceleration is mostly ringing";
    events_and_metrics: "Events and metrics";
    events: "Events";
    time_zero_rule:
        "Times count from time zero, which was set by: {rule}.";
    metrics: "Metrics";
    point_at_a_name:
        "Point at a name for its definition, or the reason why a value is absent; point at an interval for how it was \
         found.";
    of_others: "Occupants, barrier and recorder";
    place: "Place";
    metric: "Metric";
    value: "Value";
    lower_bound: "{value} (lower bound)";
    other_channel: "Metrics of {count} other channel, beside the pulse's";
    other_channels:
        "Metrics of {count} other channels, beside the pulse's";
    over: "over {channels}";
    range: "range";
    from_to: ", from {interval}";
    at_time: ", at {time}";
    change_of_event:
        "Impact speed minus the lowest velocity up to the end of the event at {time} ({rule}); the velocity does not \
         reach zero.";
    change_definition:
        "Impact speed minus rebound velocity.";
    crush_name: "dynamic crush C";
    crush_definition:
        "Displacement at the first zero of the velocity.";
    time_name: "time of dynamic crush tₘ";
    time_definition: "Time of the first zero of the velocity.";
    centroid_name: "centroid time t<sub>c</sub>";
    centroid_definition:
        "Centroid of the pulse from time zero to tₘ; C / v0.";
    rebound_name: "rebound velocity";
    rebound_definition: "Lowest velocity after tₘ.";
    rebound_time_name: "time of rebound";
    rebound_time_definition: "Time of the rebound velocity.";
    restitution_name: "coefficient of restitution e";
    restitution_definition:
        "−rebound velocity / impact speed.";
    change_name: "change of velocity";
    speed_name: "impact speed";
    speed_definition: "Speed the integration started from.";
    change_time_name: "time of the change of velocity";
    change_time_definition: "Time of the lowest velocity.";
    end_name: "end of the event";
    no_rule: "rule not stated";
}
