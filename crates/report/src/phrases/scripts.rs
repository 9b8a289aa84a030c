//! What the scripts of the page say: cursor, zoom, downloads, sliders.

texts! { CursorTexts
    time_of_cursor: "Time of the cursor";
    at_the_cursor: "at the cursor";
    group: "Cursor and zoom of all figures over time";
    time: "time";
    zoom_in: "Zoom in at the cursor";
    zoom_out: "Zoom out";
    all: "all";
    show_all: "Show the whole of the first view";
    keys:
        "Figures: arrow keys move the cursor, + and − zoom, 0 shows all";
    download: "Download: ";
    download_svg: "Download the figure “{title}” as SVG";
    download_csv: "Download the curves of “{title}” as CSV";
    download_summary: "Download the summary as JSON";
    decimal_mark: ".";
}

texts! { WhatIfTexts
    title: "What if";
    not_fitted:
        "{model}, computed in this page with other numbers. Not fitted to anything: it shows what the model says, not \
         what a vehicle does.";
    motion_over_time: "Motion over time";
    switched_off:
        "Switched off: this page does not find the crush and time of the simulation again{instead}.";
    instead:
        " ({crush} at {time} instead of {stage_crush} at {stage_time})";
    stiffness: "Stiffness";
    damping: "Damping";
    rate_effect: "Rate effect";
    mass: "Mass";
    speed: "Speed";
    as_identified: "as identified";
    over_time:
        "{quantity} over time: test, model as identified, model as set";
    time_after_contact: "time after contact, ms";
    test: "test";
    model_as_identified: "model as identified";
    model_as_set: "model as set";
    does_not_stop: "The model does not stop.";
    answer:
        "C {crush} ({crush_change}) after {time} ({time_change}){restitution}{beyond}.";
    restitution: ", restitution {value}";
    beyond: "; beyond the tested crush";
    displacement: "Displacement";
    acceleration: "Acceleration";
    state:
        "As identified this page finds crush and time of the simulation again to 0.1 %. Stiffness and damping are \
         shares of those identified. The acceleration is that of the model itself, the test’s is filtered. The address \
         of the page keeps the sliders, to be sent.";
    decimal_mark: ".";
}
