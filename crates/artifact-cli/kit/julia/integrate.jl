# Integrate: velocity and displacement of the pulse by the trapezoidal rule, from the impact speed at its start.
include("artifact.jl")
a = wave(pulse())
v0 = number("/test", "impact_speed_m_per_s")
total(y) = [0.0; cumsum((y[2:end] .+ y[1:end-1]) ./ 2 .* a.dt_s)]
v = v0 .+ total(a.samples)
x = total(v)
x = x .- x[1 + max(0, round(Int, -a.t0_s / a.dt_s))] # zero at contact
minimum(v) > 0 && refuse("the velocity never reaches zero: there is no dynamic crush")
k = findfirst(v .<= 0)
low, late = findmin(v)
time_of(k) = a.t0_s + (k - 1) * a.dt_s
rule = text_of("/test", "time_zero", "file")
put("/events", "Events.v1", """{"channel":"$(a.id)","time_zero_s":0,"time_zero_rule":"$rule",
    "rule":"trapezoid","start":"record-start","impact_speed_m_per_s":$v0,"dynamic_crush_m":$(x[k]),
    "time_of_dynamic_crush_s":$(time_of(k)),"rebound_velocity_m_per_s":$low,"time_of_rebound_s":$(time_of(late)),
    "coefficient_of_restitution":$(-low / v0),"delta_v_m_per_s":$(v0 - low)}""")
put_wave("$(a.id)/velocity", "velocity", a.t0_s, a.dt_s, v)
put_wave("$(a.id)/displacement", "displacement", a.t0_s, a.dt_s, x)
finish()
