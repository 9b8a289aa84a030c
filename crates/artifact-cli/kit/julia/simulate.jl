# Simulate: the Kelvin candidates, in steps of 0.1 ms, until their force ends or for 0.2 s.
include("artifact.jl")
function move(m, k, c, v, dt)
    x, curves = 0.0, (acceleration = Float64[], velocity = Float64[], displacement = Float64[])
    for n in 1:2000
        a = -(k * x + c * v) / m
        push!.(values(curves), (a, v, x))
        n > 1 && a > 0 && break
        v += a * dt # the new velocity moves it: the energy stays
        x += v * dt
    end
    return curves
end
candidates = topics("/parameters/kelvin/")
isempty(candidates) && refuse("no candidate is a Kelvin model, and this stage simulates no other")
for topic in candidates
    id = replace(topic, "/parameters/" => "")
    m, k, c = (number(topic, name) for name in ("mass_kg", "stiffness_n_per_m", "damping_n_s_per_m"))
    curves = move(m, k, c, number("/test", "impact_speed_m_per_s"), 1e-4)
    crush, place = findmax(curves.displacement)
    put("/simulation/$id", "Simulation.v1", """{"from_s":0,"to_s":$((length(curves.velocity) - 1) * 1e-4),
        "dynamic_crush_m":$crush,"time_of_dynamic_crush_s":$((place - 1) * 1e-4)}""")
    for (name, curve) in pairs(curves)
        put_wave("$id/$name", name, 0, 1e-4, curve)
    end
end
finish()
