# Reads and writes artifacts for stages in Julia: include("artifact.jl") unpacks the inputs of the stage.
const WORK = mktempdir() # Julia removes it
const OUT = mkdir(joinpath(WORK, "out"))
const RECORDS = Dict{String,String}()
const WAVES = Dict{String,NamedTuple}()

"Runs `crumple artifact ...`. Where it fails, the stage ends with its exit code."
function call_artifact(words...)
    process = run(ignorestatus(`crumple artifact $(collect(words))`))
    process.exitcode == 0 || exit(process.exitcode)
end

"Ends the run with exit code 3."
function refuse(message)
    println(stderr, "error: ", message)
    exit(3)
end

"The line of a record; of several inputs that of the last."
function record(topic)
    haskey(RECORDS, topic) || refuse("there is no $topic")
    return RECORDS[topic]
end

"The first number of that name in a record."
function number(topic, name)
    found = match(Regex("\"$name\":(-?[0-9][-+.0-9eE]*)"), record(topic))
    found === nothing && refuse("$topic has no $name, which this stage needs")
    return parse(Float64, found[1])
end

"The first text of that name in a record, the default where there is none."
function text_of(topic, name, default = "")
    found = match(Regex("\"$name\":\"([^\"]*)\""), record(topic))
    return found === nothing ? default : String(found[1])
end

"The topics that start so."
topics(start) = sort([topic for topic in keys(RECORDS) if startswith(topic, start)])

"A waveform: id, quantity, t0_s, dt_s, samples."
function wave(id)
    haskey(WAVES, id) || refuse("there is no waveform $id")
    return WAVES[id]
end

"The id of the crash pulse, else of the only acceleration."
function pulse()
    accelerations = [one.id for one in values(WAVES) if one.quantity == "acceleration"]
    return text_of("/test", "pulse", isempty(accelerations) ? "" : accelerations[1])
end

"Appends a line to a file of the output."
append_line(name, line) = open(file -> println(file, line), joinpath(OUT, name), "a")

"A record for the output; its JSON may have several lines."
function put(topic, type, json)
    data = replace(json, r"\n *" => "")
    append_line("records.ndjson", """{"topic":"$topic","schema":"crumple.$type","data":$data}""")
end

"A waveform for the output."
function put_wave(id, quantity, t0, dt, samples)
    name = "$(length(readdir(OUT))).f64"
    write(joinpath(OUT, name), htol.(Float64.(samples)))
    about = """{"id":"$id","quantity":"$quantity","t0_s":$t0,"dt_s":$dt,"samples":$(length(samples)),"file":"$name"}"""
    append_line("waves.ndjson", about)
end

"Records for the output, unchanged, those whose topics start so."
pass(start) = foreach(topic -> append_line("records.ndjson", RECORDS[topic]), topics(start))

"Writes the output with /test, which every stage passes on."
function finish(output = OUTPUT)
    pass("/test")
    call_artifact("pack", "--quiet", OUT, output)
end

function read_input(path, folder)
    call_artifact("unpack", "--quiet", path, folder)
    for line in eachline(joinpath(folder, "records.ndjson"))
        RECORDS[match(r"\"topic\":\"([^\"]*)\"", line)[1]] = line
    end
    fields = r"\"id\":\"([^\"]*)\",\"quantity\":\"([^\"]*)\",\"t0_s\":([^,]*),\"dt_s\":([^,]*),.*\"file\":\"([^\"]*)\""
    for line in eachline(joinpath(folder, "waves.ndjson"))
        id, quantity, t0, dt, file = String.(match(fields, line).captures)
        samples = ltoh.(reinterpret(Float64, read(joinpath(folder, file))))
        WAVES[id] = (; id, quantity, t0_s = parse(Float64, t0), dt_s = parse(Float64, dt), samples)
    end
end

"Unpacks the inputs; returns the output."
function unpack_inputs(words)
    output, k = "", 1
    while k <= length(words)
        if words[k] == "-o"
            output = words[k + 1]
        end
        if words[k] in ("-o", "--pipeline")
            k += 1
        elseif !startswith(words[k], "-") # what starts so is a flag of the stages of the project
            read_input(words[k], joinpath(WORK, string(k)))
        end
        k += 1
    end
    return output
end

const OUTPUT = unpack_inputs(ARGS)
