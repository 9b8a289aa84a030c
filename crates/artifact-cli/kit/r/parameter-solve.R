# Parameter-solve: a Kelvin model (spring beside damper) that has the dynamic crush of the test and its time.
program <- sub("--file=", "", grep("--file=", commandArgs(), value = TRUE)[1])
source(file.path(dirname(gsub("~+~", " ", program, fixed = TRUE)), "artifact.R"))
m <- number("/test", "mass_kg")
v0 <- number("/events", "impact_speed_m_per_s")
crush <- number("/events", "dynamic_crush_m")
last <- number("/events", "time_of_dynamic_crush_s")
# v0 tm / C is pi/2 + (pi^2/4 - 1) z of a damping ratio z, to first order.
z <- min(max((v0 * last / crush - pi / 2) / (pi^2 / 4 - 1), 0), 0.9)
w <- acos(z) / sqrt(1 - z^2) / last
id <- "kelvin/crush-and-time/1"
put(paste0("/parameters/", id), "Candidate.v1", '{"model":"kelvin","method":"crush-and-time","physical":true,',
    '"parameters":{"mass_kg":', digits(m), ',"stiffness_n_per_m":', digits(m * w^2), ',"damping_n_s_per_m":',
    digits(2 * z * w * m), "}}")
choice <- paste0('"', c("recommended", "simplest", "closest"), '":"', id, '","',
    c("recommended", "simplest", "closest"), '_because":"the only candidate of this stage"')
put("/recommendation", "Recommendation.v1", "{", paste(choice, collapse = ","), "}")
finish()
