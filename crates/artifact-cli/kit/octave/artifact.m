% Reads and writes artifacts for stages in Octave: source("artifact.m") unpacks the inputs of the stage.
1;

function call(varargin) % crumple artifact ...; where it fails, the stage ends with its exit code
    quoted = cellfun(@(word) ["'" strrep(word, "'", "'\\''") "'"], varargin, "UniformOutput", false);
    status = system(strjoin([{"crumple", "artifact"}, quoted], " "));
    if status != 0
        exit(status);
    end
end

function refuse(message) % ends the run with exit code 3
    fprintf(stderr, "error: %s\n", message);
    exit(3);
end

function data = record(topic) % its fields; of several inputs those of the last
    global kit
    if !isKey(kit.records, topic)
        refuse(["there is no " topic]);
    end
    data = jsondecode(kit.records(topic)).data;
end

function value = number(topic, name) % a number of a record
    data = record(topic);
    if !isfield(data, name) || isempty(data.(name))
        refuse([topic " has no " name ", which this stage needs"]);
    end
    value = data.(name);
end

function found = topics(start) % the topics that start so
    global kit
    found = keys(kit.records)(strncmp(keys(kit.records), start, length(start)));
end

function wave = wave(id) % samples, t0_s, dt_s, quantity
    global kit
    if !isKey(kit.waves, id)
        refuse(["there is no waveform " id]);
    end
    wave = kit.waves(id);
end

function id = pulse() % the crash pulse, else the only acceleration
    global kit
    id = record("/test").pulse;
    if isempty(id)
        id = keys(kit.waves){find(cellfun(@(w) strcmp(w.quantity, "acceleration"), values(kit.waves)), 1)};
    end
end

function put(topic, type, json) % a record for the output
    global kit
    kit.out.records{end + 1} = sprintf('{"topic":"%s","schema":"crumple.%s","data":%s}', topic, type, json);
end

function put_wave(id, quantity, t0, dt, samples) % a waveform for the output
    global kit
    name = sprintf("%d.f64", length(kit.out.waves));
    file = fopen(fullfile(kit.out.folder, name), "w");
    fwrite(file, samples, "double", 0, "ieee-le");
    fclose(file);
    kit.out.waves{end + 1} = sprintf( ...
        '{"id":"%s","quantity":"%s","t0_s":%.17g,"dt_s":%.17g,"samples":%d,"file":"%s"}', ...
        id, quantity, t0, dt, length(samples), name);
end

function pass(start) % records for the output, unchanged, those whose topics start so
    global kit
    kit.out.records = [kit.out.records, values(kit.records, topics(start))];
end

function finish() % writes the output with /test, which every stage passes on
    global kit
    pass("/test");
    for name = {"records", "waves"}
        file = fopen(fullfile(kit.out.folder, [name{1} ".ndjson"]), "w");
        fprintf(file, "%s\n", kit.out.(name{1}){:});
        fclose(file);
    end
    call("pack", "--quiet", kit.out.folder, kit.output);
end

function unpack_inputs(words)
    global kit
    kit = struct("records", containers.Map(), "waves", containers.Map(), "output", "");
    work = tempname();
    mkdir(work);
    confirm_recursive_rmdir(false);
    kit.work = work;
    kit.out = struct("folder", fullfile(work, "out"), "records", {{}}, "waves", {{}});
    mkdir(kit.out.folder);
    k = 1;
    while k <= length(words)
        if any(strcmp(words{k}, {"-o", "--pipeline"}))
            if strcmp(words{k}, "-o")
                kit.output = words{k + 1};
            end
            k += 1;
        elseif words{k}(1) != "-" % what starts so is a flag of the stages of the project
            read_input(words{k}, fullfile(work, int2str(k)));
        end
        k += 1;
    end
end

function read_input(path, folder)
    global kit
    call("unpack", "--quiet", path, folder);
    for line = strsplit(strtrim(fileread(fullfile(folder, "records.ndjson"))), "\n")
        kit.records(jsondecode(line{1}).topic) = line{1};
    end
    for line = strsplit(strtrim(fileread(fullfile(folder, "waves.ndjson"))), "\n")
        if !isempty(line{1})
            about = jsondecode(line{1});
            file = fopen(fullfile(folder, about.file));
            about.samples = fread(file, Inf, "double", 0, "ieee-le");
            fclose(file);
            kit.waves(about.id) = about;
        end
    end
end

function remove_work()
    global kit
    work = kit.work;
    clear -global kit
    rmdir(work, "s");
end

atexit("remove_work");
unpack_inputs(argv());
