# Simulate: the Kelvin candidates, in steps of 0.1 ms, until their force ends or for 0.2 s.
program <- sub("--file=", "", grep("--file=", commandArgs(), value = TRUE)[1])
source(file.path(dirname(gsub("~+~", " ", program, fixed = TRUE)), "artifact.R"))
candidates <- topics("/parameters/kelvin/")
if (length(candidates) == 0) refuse("no candidate is a Kelvin model, and this stage simulates no other")
for (topic in candidates) {
    id <- sub("/parameters/", "", topic)
    m <- number(topic, "mass_kg")
    k <- number(topic, "stiffness_n_per_m")
    c <- number(topic, "damping_n_s_per_m")
    now <- list(v = number("/test", "impact_speed_m_per_s"), x = 0)
    a <- v <- x <- numeric(0)
    for (n in 1:2000) {
        a[n] <- -(k * now$x + c * now$v) / m
        v[n] <- now$v
        x[n] <- now$x
        if (n > 1 && a[n] > 0) break
        now$v <- now$v + a[n] * 1e-4 # the new velocity moves it: the energy stays
        now$x <- now$x + now$v * 1e-4
    }
    put(paste0("/simulation/", id), "Simulation.v1", '{"from_s":0,"to_s":', digits((n - 1) * 1e-4),
        ',"dynamic_crush_m":', digits(max(x)), ',"time_of_dynamic_crush_s":', digits((which.max(x) - 1) * 1e-4), "}")
    put_wave(paste0(id, "/acceleration"), "acceleration", 0, 1e-4, a)
    put_wave(paste0(id, "/velocity"), "velocity", 0, 1e-4, v)
    put_wave(paste0(id, "/displacement"), "displacement", 0, 1e-4, x)
}
finish()
