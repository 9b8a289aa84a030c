# Reads and writes artifacts for stages in R: source("artifact.R") unpacks the inputs of the stage.
kit <- new.env()
kit$work <- tempfile("stage") # R removes it
kit$records <- list()
kit$waves <- list()
kit$out <- file.path(kit$work, "out")
dir.create(kit$out, recursive = TRUE)

# crumple artifact ...; where it fails, the stage ends with its exit code.
call_artifact <- function(...) {
    status <- system2("crumple", c("artifact", shQuote(c(...))))
    if (status != 0) quit(status = status)
}

# Ends the run with exit code 3.
refuse <- function(...) {
    message("error: ", ...)
    quit(status = 3)
}

# Appends lines to a file of the output.
append_line <- function(name, ...) {
    cat(..., "\n", sep = "", file = file.path(kit$out, name), append = TRUE)
}

# A number as text that reads back to the same number.
digits <- function(x) sprintf("%.17g", x)

# What a pattern finds in its brackets in a text; nothing where it is not there.
find_in <- function(text, pattern) {
    regmatches(text, regexec(pattern, text))[[1]][-1]
}

# The line of a record; of several inputs that of the last.
record <- function(topic) {
    line <- kit$records[[topic]]
    if (is.null(line)) refuse("there is no ", topic)
    line
}

# The first number of that name in a record.
number <- function(topic, name) {
    found <- find_in(record(topic), paste0('"', name, '":(-?[0-9][-+.0-9eE]*)'))
    if (length(found) == 0) refuse(topic, " has no ", name, ", which this stage needs")
    as.numeric(found)
}

# The first text of that name in a record, the default where there is none.
text_of <- function(topic, name, default = "") {
    found <- find_in(record(topic), paste0('"', name, '":"([^"]*)"'))
    if (length(found) == 0) default else found
}

# The topics that start so.
topics <- function(start) names(kit$records)[startsWith(names(kit$records), start)]

# A waveform: id, quantity, t0_s, dt_s, samples.
wave <- function(id) {
    if (is.null(kit$waves[[id]])) refuse("there is no waveform ", id)
    kit$waves[[id]]
}

# The id of the crash pulse, else of the only acceleration.
pulse <- function() {
    accelerations <- Filter(function(w) w$quantity == "acceleration", kit$waves)
    text_of("/test", "pulse", names(accelerations)[1])
}

# A record for the output.
put <- function(topic, type, ...) {
    append_line("records.ndjson", '{"topic":"', topic, '","schema":"crumple.', type, '","data":', ..., "}")
}

# A waveform for the output.
put_wave <- function(id, quantity, t0, dt, samples) {
    name <- paste0(length(list.files(kit$out)), ".f64")
    writeBin(as.double(samples), file.path(kit$out, name), endian = "little")
    append_line("waves.ndjson", '{"id":"', id, '","quantity":"', quantity, '","t0_s":', digits(t0), ',"dt_s":',
        digits(dt), ',"samples":', length(samples), ',"file":"', name, '"}')
}

# Records for the output, unchanged, those whose topics start so.
pass <- function(start) for (topic in topics(start)) append_line("records.ndjson", kit$records[[topic]])

# Writes the output with /test, which every stage passes on.
finish <- function() {
    pass("/test")
    call_artifact("pack", "--quiet", kit$out, kit$output)
}

read_input <- function(path, folder) {
    call_artifact("unpack", "--quiet", path, folder)
    for (line in readLines(file.path(folder, "records.ndjson"), encoding = "UTF-8")) {
        kit$records[[find_in(line, '"topic":"([^"]*)"')]] <- line
    }
    for (line in readLines(file.path(folder, "waves.ndjson"), encoding = "UTF-8")) {
        found <- find_in(line, paste0('"id":"([^"]*)","quantity":"([^"]*)","t0_s":([^,]*),"dt_s":([^,]*),',
            '"samples":([0-9]*),"file":"([^"]*)"'))
        samples <- readBin(file.path(folder, found[6]), "double", as.integer(found[5]), endian = "little")
        kit$waves[[found[1]]] <- list(id = found[1], quantity = found[2], t0_s = as.numeric(found[3]),
            dt_s = as.numeric(found[4]), samples = samples)
    }
}

words <- commandArgs(trailingOnly = TRUE)
k <- 1
while (k <= length(words)) {
    if (words[k] == "-o") kit$output <- words[k + 1]
    if (words[k] %in% c("-o", "--pipeline")) {
        k <- k + 1
    } else if (!startsWith(words[k], "-")) { # what starts so is a flag of the stages of the project
        read_input(words[k], file.path(kit$work, k))
    }
    k <- k + 1
}
