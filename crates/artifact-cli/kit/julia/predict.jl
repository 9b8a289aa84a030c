# Predict: dynamic crush of the Kelvin candidates at 40 km/h. It rises with the speed, and its time stays.
include("artifact.jl")
candidates = topics("/parameters/kelvin/")
isempty(candidates) && refuse("no candidate is a Kelvin model, and this stage predicts with no other")
for (n, topic) in enumerate(candidates)
    v0 = 40 / 3.6 # m/s
    id = replace(topic, "/parameters/" => "")
    m, k, c = (number(topic, name) for name in ("mass_kg", "stiffness_n_per_m", "damping_n_s_per_m"))
    w = sqrt(k / m)
    z = c / (2 * m * w)
    last_s = acos(z) / (w * sqrt(1 - z^2))
    crush = v0 / w * exp(-z * w * last_s)
    is_best = id == text_of("/recommendation", "recommended")
    put("/prediction/$n", "Prediction.v1", """{"candidate":"$id","recommended":$is_best,
        "impact_speed_m_per_s":$v0,"mass_kg":$m,"extrapolates":$(crush > number("/events", "dynamic_crush_m")),
        "dynamic_crush_m":$crush,"time_of_dynamic_crush_s":$last_s}""")
end
finish()
