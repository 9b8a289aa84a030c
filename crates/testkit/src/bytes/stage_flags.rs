//! Flags of the other stages and of the tools.

/// Reading the record `double` with statements of a person: name and flags.
pub const INGEST: &[(&str, &str)] = &[
    ("stated", "--mass=1400kg --impact-speed=48km/h --vehicle=a-car --title=a-test --barrier=rigid"),
    ("sign", "--sign=flip --time-zero=1ms"),
    ("resampled", "--resample=5kHz"),
    ("unit", "--unit=m/s^2 --time-unit=ms"),
    ("refused-channel", "--channel=nope"),
    ("usage-mass", "--mass=1400"),
];

/// Filtering the made record `occupants`.
pub const FILTER: &[(&str, &str)] = &[
    ("cfc-180", "--cfc=180"),
    ("sae", "--mode=sae_reflect --cfc=1000"),
    ("none", "--cfc=none --zero-level=none"),
    ("window", "--zero-level-from=-40ms --zero-level-to=-20ms"),
    ("low", "--order=2 --cutoff=100Hz"),
    ("causal", "--order=3 --cutoff=100Hz --phase=causal"),
    ("resampled", "--resample=8kHz"),
    ("resampled-lines", "--resample=5kHz --interpolation=linear"),
    ("passed", "--channels=1?SECM*X? --pass=10ENGN000000ACXP"),
    ("refused-order", "--order=13 --cutoff=100Hz"),
    ("usage-class", "--cfc=61"),
];

/// Integrating the record `double`.
pub const INTEGRATE: &[(&str, &str)] = &[
    ("euler", "--rule=forward-euler"),
    ("simpson", "--rule=simpson"),
    ("time-zero", "--start=time-zero --time-zero=1.2ms"),
    ("threshold", "--time-zero-rule=threshold"),
    ("edr", "--time-zero-rule=edr"),
    ("standstill", "--end-velocity=standstill --drift=bias"),
    ("ramp", "--end-velocity=-2.5m/s --end-time=150ms --drift=linear"),
    ("speed", "--impact-speed=48km/h --barrier-cells=none --metrics=none"),
    ("damage", "--damage-width=1.6m --residual-crush=520mm"),
    ("roadside", "--metrics=roadside"),
    ("intervals", "--speed-uncertainty=0.1km/h --gain-uncertainty=1% --zero-level-uncertainty=0.05g"),
    ("seed", "--time-zero-uncertainty=0.5ms --uncertainty-replicates=50 --uncertainty-seed=4"),
    ("refused-start", "--time-zero=9s"),
    ("usage-end", "--end-time=150ms"),
];

/// Integrating the made record `occupants`.
pub const INTEGRATE_OCCUPANTS: &[(&str, &str)] = &[
    ("all", "--channels=all --barrier-cells=all"),
    ("engine", "--channels=1?ENGN*"),
    ("head", "--metrics=head"),
    ("chest", "--metrics=chest,ride-down"),
    ("roadside", "--metrics=roadside"),
    ("occupant-pulse", "--channel=11CHST0000H3ACXC"),
];

/// Simulating the candidates of the record `double`.
pub const SIMULATE: &[(&str, &str)] = &[
    ("to", "--to=60ms"),
    ("attached", "--stay-attached"),
    ("pulse-as-force", "--drive=pulse-as-force"),
    ("base", "--drive=base --drive-wave=accel_g"),
    ("refused-wave", "--drive=force --drive-wave=nope"),
    ("usage-drive", "--drive=force"),
];

pub const PREDICT: &[(&str, &str)] = &[
    ("own", ""),
    ("range", "--speed=20..80/20km/h"),
    ("masses", "--speed=40km/h,64km/h --mass=1300kg,1800kg"),
    ("candidate", "--speed=56km/h --candidate=double-spring-mass-damper/direct-fit/1"),
    ("inputs", "--speed-uncertainty=1km/h --mass-uncertainty=20kg"),
    ("usage-candidate", "--candidate=double/direct-fit/1"),
    ("usage-speed", "--speed=0km/h"),
];

/// Comparing the runs of `double` and `noisy`.
pub const DIFF: &[(&str, &str)] = &[
    ("plain", ""),
    ("all", "--all"),
    ("bits", "--bits --provenance"),
    ("exact", "--exact"),
    ("engineering", "--engineering"),
    ("json", "--json --rel=1e-3"),
];

/// Every program, for its help.
pub const PROGRAMS: [&str; 10] = [
    "ingest",
    "filter",
    "integrate",
    "identify",
    "parameter-solve",
    "simulate",
    "predict",
    "report",
    "diff",
    "artifact",
];
