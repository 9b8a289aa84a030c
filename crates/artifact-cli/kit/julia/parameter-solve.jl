# Parameter-solve: a Kelvin model (spring beside damper) that has the dynamic crush of the test and its time.
include("artifact.jl")
m = number("/test", "mass_kg")
v0 = number("/events", "impact_speed_m_per_s")
crush = number("/events", "dynamic_crush_m")
last_s = number("/events", "time_of_dynamic_crush_s")
# v0 tm / C is pi/2 + (pi^2/4 - 1) z of a damping ratio z, to first order.
z = clamp((v0 * last_s / crush - pi / 2) / (pi^2 / 4 - 1), 0.0, 0.9)
w = acos(z) / sqrt(1 - z^2) / last_s
id, why = "kelvin/crush-and-time/1", "the only candidate of this stage"
put("/parameters/$id", "Candidate.v1", """{"model":"kelvin","method":"crush-and-time","physical":true,
    "parameters":{"mass_kg":$m,"stiffness_n_per_m":$(m * w^2),"damping_n_s_per_m":$(2 * z * w * m)}}""")
put("/recommendation", "Recommendation.v1", """{"recommended":"$id","recommended_because":"$why","simplest":"$id",
    "simplest_because":"$why","closest":"$id","closest_because":"$why"}""")
finish()
