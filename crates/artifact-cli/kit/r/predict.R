# Predict: dynamic crush of the Kelvin candidates at 40 km/h. It rises with the speed, and its time stays.
program <- sub("--file=", "", grep("--file=", commandArgs(), value = TRUE)[1])
source(file.path(dirname(gsub("~+~", " ", program, fixed = TRUE)), "artifact.R"))
v0 <- 40 / 3.6 # m/s
candidates <- topics("/parameters/kelvin/")
if (length(candidates) == 0) refuse("no candidate is a Kelvin model, and this stage predicts with no other")
truth <- function(is_so) if (is_so) "true" else "false"
for (n in seq_along(candidates)) {
    id <- sub("/parameters/", "", candidates[n])
    m <- number(candidates[n], "mass_kg")
    w <- sqrt(number(candidates[n], "stiffness_n_per_m") / m)
    z <- number(candidates[n], "damping_n_s_per_m") / (2 * m * w)
    last <- acos(z) / (w * sqrt(1 - z^2))
    crush <- v0 / w * exp(-z * w * last)
    put(paste0("/prediction/", n), "Prediction.v1", '{"candidate":"', id, '","recommended":',
        truth(id == text_of("/recommendation", "recommended")), ',"impact_speed_m_per_s":', digits(v0), ',"mass_kg":',
        digits(m), ',"extrapolates":', truth(crush > number("/events", "dynamic_crush_m")), ',"dynamic_crush_m":',
        digits(crush), ',"time_of_dynamic_crush_s":', digits(last), "}")
}
finish()
