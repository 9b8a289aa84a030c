//! Methods, flags and starts that earlier versions had, and what to do instead.

use crumple_stage::LeftOut;

const SHIFT: &str = "leave it out: era solves the shift equation in the form of Juang and Pappa (hankel)";
const IMPULSE: &str = "use okid or n4sid, which need no length of the impulse response";
const CORRELATIONS: &str = "use era with the default --rows and --columns, half of the record each";
const STARTS: &str = "leave it out: svf, iv, n4sid and arx lead to the same models";

/// All of them.
pub const LEFT_OUT: &[LeftOut] = &[
    LeftOut { option: "methods", value: "fir", instead: IMPULSE },
    LeftOut { option: "methods", value: "era-dc", instead: CORRELATIONS },
    LeftOut { option: "starts", value: "gpmf", instead: STARTS },
    LeftOut { option: "starts", value: "exponentials", instead: STARTS },
    LeftOut { option: "taps", value: "", instead: IMPULSE },
    LeftOut { option: "kernel", value: "", instead: IMPULSE },
    LeftOut { option: "offset", value: "", instead: CORRELATIONS },
    LeftOut { option: "lag_blocks", value: "", instead: CORRELATIONS },
    LeftOut { option: "shift_form", value: "", instead: SHIFT },
    LeftOut {
        option: "okid_states",
        value: "",
        instead: "leave it out: okid chooses its states from the system alone",
    },
    LeftOut {
        option: "bootstrap_noise",
        value: "",
        instead: "leave it out: the record chooses the model that noise is drawn from",
    },
];
