# Identify: one undamped mode. Its quarter period is the time of dynamic crush.
program <- sub("--file=", "", grep("--file=", commandArgs(), value = TRUE)[1])
source(file.path(dirname(gsub("~+~", " ", program, fixed = TRUE)), "artifact.R"))
last <- number("/events", "time_of_dynamic_crush_s")
id <- text_of("/events", "channel")
samples <- round(last / wave(paste0(id, "/displacement"))$dt_s) + 1
w <- pi / 2 / last
pole <- function(im) {
    paste0('{"re_per_s":0,"im_rad_per_s":', digits(im), ',"natural_frequency_rad_per_s":', digits(w),
        ',"damping_ratio":0}')
}
put("/modes/quarter-sine", "Modes.v2", '{"modes":[', pole(w), ",", pole(-w), "]}")
put("/identification/quarter-sine", "Identification.v1", '{"method":"quarter-sine","order":2,"channel":"', id,
    '","treated_as":"free-decay","from_s":0,"to_s":', digits(last), ',"samples":', samples, ',"singular_values":[],',
    '"notes":["one undamped mode, from the time of dynamic crush alone"]}')
finish()
