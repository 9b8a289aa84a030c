//! Flags of stages and methods that are compared byte by byte.

/// Identification of the record `double`: name of the case and flags.
pub const IDENTIFY: &[(&str, &str)] = &[
    ("era-orders", "--methods=era --orders=auto,2,4,6 --max-order=12 --stabilisation --highest-damping=0.9"),
    ("era-evidence", "--methods=era --orders=2,4 --bootstrap=8 --validate-from=100ms"),
    ("era-seed", "--methods=era --bootstrap=8 --bootstrap-seed=7"),
    ("era-twice-order", "--methods=era --hankel-size=twice-order --orders=4"),
    ("era-channels", "--methods=era --channels=accel_g,accel_g/velocity --orders=4 --rows=80 --bootstrap=4"),
    ("era-free-decay", "--methods=era --free-decay=separation --orders=2"),
    ("refused-free-decay", "--methods=era --free-decay=20% --orders=2"),
    ("era-window", "--methods=era --from=5ms --to=120ms --samples=900 --channel=accel_g/displacement"),
    ("okid", "--methods=okid --orders=2,4 --bootstrap=4 --validate-from=120ms"),
    ("okid-bic", "--methods=okid --orders=auto --lag-criterion=bic --inputs=accel_g --outputs=accel_g/velocity"),
    ("arx", "--methods=arx --orders=2,4 --bootstrap=8 --validate-from=120ms"),
    ("arx-structures", "--methods=arx --arx-orders=2,2,2;3,3,1 --remove-mean"),
    ("arx-scan", "--methods=arx --arx-scan=1-3,1-3,0-4"),
    ("arx-outputs", "--methods=arx --orders=2 --outputs=accel_g/velocity,accel_g/displacement --delay=2"),
    ("n4sid", "--methods=n4sid --orders=auto,2 --bootstrap=4 --stabilisation"),
    ("moesp", "--methods=moesp --orders=2,4 --block-rows=20 --validate-from=120ms"),
    ("cva", "--methods=cva --orders=auto --max-order=8 --thin=4"),
    ("subspace-free", "--methods=moesp,n4sid,cva --inputs=none --outputs=accel_g,accel_g/displacement --orders=4"),
    ("output-error", "--methods=output-error --orders=2 --max-iterations=40 --bootstrap=4"),
    ("output-error-initial", "--methods=output-error --orders=2,4 --initial=auto --max-iterations=20"),
    ("tfest", "--methods=tfest --bootstrap=4 --validate-from=120ms --max-iterations=30"),
    ("tfest-iterations", "--methods=tfest --max-iterations=5,40 --hold=zero-order --initial=auto"),
    ("tfest-stable", "--methods=tfest --poles=3 --zeros=2 --stable --delay=2 --initial=zero"),
    ("tfest-svf", "--methods=tfest --starts=svf --max-iterations=20"),
    ("tfest-arx", "--methods=tfest --starts=arx --max-iterations=20"),
    ("tfest-iv", "--methods=tfest --starts=iv --max-iterations=20"),
    ("tfest-n4sid", "--methods=tfest --starts=n4sid --max-iterations=20"),
    ("tfest-integrators", "--methods=tfest --starts=integrators --max-iterations=20"),
    ("tfest-random", "--methods=tfest --starts=random --max-iterations=20"),
    ("tfest-outputs", "--methods=tfest --poles=2 --outputs=accel_g/velocity,accel_g/displacement --max-iterations=30"),
    ("exponentials", "--methods=exponentials --bootstrap=4 --validate-from=120ms"),
    ("exponentials-real", "--methods=exponentials --terms=3 --real --outputs=accel_g/velocity"),
    (
        "exponentials-conditions",
        "--methods=exponentials --terms=4 --conditions=position,velocity,acceleration --start-velocity=50km/h \
         --start-acceleration=-3g",
    ),
    (
        "several-methods",
        "--methods=era,tfest,exponentials,moesp,arx,output-error --orders=4 --poles=2 --zeros=0 --block-rows=40",
    ),
    ("paper-era", "--paper=era"),
    ("paper-curve-fit", "--paper=curve-fit"),
    ("paper-tfest", "--paper=tfest"),
    ("refused-order", "--methods=era --orders=4 --samples=5"),
    ("refused-zeros", "--methods=tfest --zeros=5"),
    ("refused-waveform", "--methods=tfest --outputs=94/displacement"),
    ("usage-method", "--methods=eraa"),
    ("usage-conditions", "--methods=exponentials --conditions=velocity"),
];

/// Identification of the made record `process`: inputs `p`, `q` and outputs `y`, `z` that are no crash.
pub const IDENTIFY_PROCESS: &[(&str, &str)] = &[
    ("process-all", "--methods=n4sid,moesp,cva,arx,output-error,okid --orders=2 --inputs=p,q --outputs=y,z"),
    ("process-automatic", "--methods=n4sid,moesp,cva --orders=auto,3 --inputs=p --outputs=y"),
    ("process-scan", "--methods=arx --arx-scan --inputs=p --outputs=y --remove-mean"),
    ("process-scan-outputs", "--methods=arx --arx-scan=1-2,1-2,0-2 --inputs=p --outputs=y,z"),
    ("process-tfest", "--methods=tfest --inputs=p,q --outputs=y,z --poles=2 --max-iterations=30"),
    ("process-evidence", "--methods=n4sid,arx,output-error --orders=2 --inputs=p,q --outputs=y --bootstrap=8"),
    ("process-diagram", "--methods=era,n4sid --orders=2 --channel=y --inputs=none --outputs=y --stabilisation"),
];

/// Models and methods that work on the events or the motion.
pub const SOLVERS: &[(&str, &str)] = &[
    ("kelvin", "closed-form,direct-fit,l-shade"),
    ("elastoplastic", "closed-form,direct-fit,l-shade"),
    ("maxwell", "direct-fit,l-shade"),
    ("nonlinear-1", "direct-fit,interior-point,l-shade"),
    ("nonlinear-2", "direct-fit,firefly,l-shade"),
    ("double-spring-mass-damper", "direct-fit,l-shade"),
    ("triple-spring-mass-damper", "direct-fit,l-shade"),
];

/// What is added to each of them: name and flags.
pub const SOLVER_VARIANTS: &[(&str, &str)] = &[
    ("plain", "--l-shade-evaluations=3000 --firefly-generations=60"),
    ("assessed", "--l-shade-evaluations=3000 --firefly-generations=20 --profile --bootstrap=20"),
    (
        "uncertain",
        "--l-shade-evaluations=1000 --firefly-generations=20 --mass-uncertainty=15kg --speed-uncertainty=0.1km/h \
         --bias-uncertainty=0.05g --repetitions=20",
    ),
    ("velocity", "--l-shade-evaluations=1000 --firefly-generations=20 --fit-quantity=velocity --fit-to=60ms"),
    ("acceleration", "--l-shade-evaluations=1000 --firefly-generations=20 --fit-quantity=acceleration --fit-from=2ms"),
];

/// Solving for parameters of the record `double` in other ways.
pub const SOLVE: &[(&str, &str)] = &[
    ("default", ""),
    ("masses", "--m1=400kg --m2=1100kg --models=double-spring-mass-damper"),
    ("mass", "--mass=1400kg --models=kelvin,maxwell --front-mass-fraction=0.3"),
    ("free-masses", "--fit-masses=free --models=double-spring-mass-damper --method=direct-fit"),
    ("share-bounds", "--fit-masses=0.1..0.4 --models=double-spring-mass-damper,triple-spring-mass-damper"),
    ("triple-masses", "--models=triple-spring-mass-damper --triple-masses=250kg,250kg,1000kg"),
    ("stay-attached", "--models=elastoplastic --method=closed-form,direct-fit --stay-attached"),
    ("firefly-physical", "--models=nonlinear-2 --method=firefly --firefly-units=physical --firefly-seed=3"),
    ("l-shade-seed", "--models=kelvin --method=l-shade --l-shade-seed=3 --l-shade-evaluations=2000"),
    ("paper-tfest", "--models=double-spring-mass-damper --method=coefficient-matching --paper=tfest"),
    ("usage-method", "--method=direct-fti"),
    ("refused-window", "--fit-to=2s"),
    ("refused-no-model", "--models=double-spring-mass-damper --method=curve-fit"),
];

/// Solving from identified models: name, the case of [`IDENTIFY`] or the run that has the model, and flags.
pub const SOLVE_IDENTIFIED: &[(&str, &str, &str)] = &[
    ("matching-tfest", "identify/tfest-iterations", "--method=coefficient-matching"),
    ("matching-masses", "identify/tfest", "--method=coefficient-matching --m1=300kg --m2=900kg"),
    ("matching-exponentials", "identify/exponentials", "--method=coefficient-matching,curve-fit"),
    ("curve-fit", "identify/paper-curve-fit", "--method=curve-fit,coefficient-matching,direct-fit"),
    ("matching-era", "identify/era-evidence", "--method=coefficient-matching"),
    ("matching-bootstrap", "identify/tfest", "--method=coefficient-matching --mass-uncertainty=10kg --repetitions=20"),
];

/// Solving with two sensors on the made record `two-sensors`.
pub const SOLVE_SENSORS: &[(&str, &str)] = &[
    ("both", "--sensors=front=95"),
    ("free-masses", "--sensors=front=95 --fit-masses=free --models=double-spring-mass-damper"),
    ("assessed", "--sensors=front=95 --models=double-spring-mass-damper --profile --bootstrap=20"),
    ("l-shade", "--sensors=m1=95 --models=double-spring-mass-damper --method=l-shade --l-shade-evaluations=2000"),
    (
        "uncertain",
        "--sensors=front=95 --models=double-spring-mass-damper,kelvin --method=closed-form,direct-fit \
         --speed-uncertainty=0.1km/h --bias-uncertainty=0.05g --repetitions=20",
    ),
    ("refused", "--sensors=front=96"),
];

/// Pipeline files of chains, for parameter-solve or simulate: name, stage, content.
pub const CHAINS: &[(&str, &str, &str)] = &[
    (
        "car",
        "parameter-solve",
        "[parameter-solve]\nmodels = [\"kelvin\"]\n[parameter-solve.chain.car]\nmasses = [\n\
         { name = \"front\", mass = \"375 kg\", stiffness = \"free\", damping = \"6 kN*s/m\" },\n\
         { name = \"rest\", mass = \"rest\", stiffness = { start = \"1 MN/m\", lower = \"100 kN/m\" }, damping = \
         \"free\" },\n]\n",
    ),
    (
        "free",
        "parameter-solve",
        "[parameter-solve]\nmodels = [\"kelvin\"]\nbootstrap = 20\n[parameter-solve.chain.loose]\nmasses = [\n\
         { mass = \"free\", stiffness = \"free\" },\n{ mass = \"free\", stiffness = \"free\", damping = \"free\" \
         },\n]\n",
    ),
    (
        "dual",
        "parameter-solve",
        "[parameter-solve]\nmodels = [\"kelvin\"]\nprofile = true\nmass_uncertainty = \"10 kg uniform\"\nrepetitions = \
         20\n\
         [parameter-solve.chain.light]\nmasses = [\n{ mass = \"300 kg\", stiffness = \"free\", damping = \"free\" },\n\
         { mass = \"900 kg\", stiffness = \"free\", damping = \"free\" },\n]\n",
    ),
    (
        "knots",
        "parameter-solve",
        "[parameter-solve]\nmodels = [\"kelvin\"]\n[parameter-solve.chain.knots]\nmasses = [\n\
         { mass = \"1500 kg\", stiffness = [[\"0 mm\", \"free\"], [\"200 mm\", \"free\"], [\"400 mm\", \"300 \
         kN/m\"]],\n\
         damping = [[\"0 m/s\", \"free\"], [\"5 m/s\", \"free\"]] },\n]\n",
    ),
    (
        "refused",
        "parameter-solve",
        "[parameter-solve.chain.odd]\nmasses = [{ mass = \"2000 kg\", stiffness = \"free\" }, { mass = \"rest\", \
         stiffness = \"free\" }]\n",
    ),
    (
        "stated",
        "simulate",
        "[simulate.chain.two]\nmasses = [\n\
         { name = \"chassis\", mass = \"375 kg\", stiffness = \"900 kN/m\", damping = \"6 kN*s/m\" },\n\
         { name = \"compartment\", mass = \"1.125 t\", stiffness = \"1 MN/m\", damping = \"9 N*s/mm\" },\n]\n\
         [simulate.chain.soft]\nspeed = \"36 km/h\"\nmasses = [\n\
         { name = \"engine\", mass = \"201 kg\", stiffness = [[\"0 mm\", \"900 kN/m\"], [\"200 mm\", \"150 kN/m\"]],\n\
         damping = [[\"0 m/s\", \"9 kN*s/m\"], [\"18 km/h\", \"2 kN*s/m\"]] },\n\
         { mass = \"582 kg\", stiffness = \"500 kN/m\" },\n]\n",
    ),
    ("usage", "simulate", "[simulate.chain.car]\nmasses = [{ mass = \"900 kg\", stifness = \"300 kN/m\" }]\n"),
];

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
    ("seed", "--speed-uncertainty=0.2km/h --uncertainty-replicates=50 --uncertainty-seed=4"),
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

/// Flags of `crumple-predict`.
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
    ("rounding", "--rounding"),
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
