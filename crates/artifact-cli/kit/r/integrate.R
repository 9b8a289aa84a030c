# Integrate: velocity and displacement of the pulse by the trapezoidal rule, from the impact speed at its start.
program <- sub("--file=", "", grep("--file=", commandArgs(), value = TRUE)[1])
source(file.path(dirname(gsub("~+~", " ", program, fixed = TRUE)), "artifact.R"))
a <- wave(pulse())
v0 <- number("/test", "impact_speed_m_per_s")
total <- function(y) c(0, cumsum((y[-1] + y[-length(y)]) / 2 * a$dt_s))
v <- v0 + total(a$samples)
x <- total(v)
x <- x - x[1 + max(0, round(-a$t0_s / a$dt_s))] # zero at contact
if (min(v) > 0) refuse("the velocity never reaches zero: there is no dynamic crush")
k <- which(v <= 0)[1]
time <- function(k) digits(a$t0_s + (k - 1) * a$dt_s)
put("/events", "Events.v1", '{"channel":"', a$id, '","time_zero_s":0,"time_zero_rule":"',
    text_of("/test", "time_zero", "file"), '","rule":"trapezoid","start":"record-start","impact_speed_m_per_s":',
    digits(v0), ',"dynamic_crush_m":', digits(x[k]), ',"time_of_dynamic_crush_s":', time(k),
    ',"rebound_velocity_m_per_s":', digits(min(v)), ',"time_of_rebound_s":', time(which.min(v)),
    ',"coefficient_of_restitution":', digits(-min(v) / v0), ',"delta_v_m_per_s":', digits(v0 - min(v)), "}")
put_wave(paste0(a$id, "/velocity"), "velocity", a$t0_s, a$dt_s, v)
put_wave(paste0(a$id, "/displacement"), "displacement", a$t0_s, a$dt_s, x)
finish()
