% Simulate: the Kelvin candidates, in steps of 0.1 ms, until their force ends or for 0.2 s.
source(fullfile(fileparts(mfilename("fullpath")), "artifact.m"));
candidates = topics("/parameters/kelvin/");
if isempty(candidates)
    refuse("no candidate is a Kelvin model, and this stage simulates no other");
end
for topic = candidates
    of = record(topic{1}).parameters;
    id = topic{1}(13:end);
    [a, v, x] = deal([]);
    state = [number("/test", "impact_speed_m_per_s"), 0];
    for n = 1:2000
        a(n) = -(of.stiffness_n_per_m * state(2) + of.damping_n_s_per_m * state(1)) / of.mass_kg;
        v(n) = state(1);
        x(n) = state(2);
        if n > 1 && a(n) > 0
            break
        end
        state(1) += a(n) * 1e-4; % the new velocity moves it: the energy stays
        state(2) += state(1) * 1e-4;
    end
    [crush, k] = max(x);
    put(["/simulation/" id], "Simulation.v1", sprintf( ...
        '{"from_s":0,"to_s":%.17g,"dynamic_crush_m":%.17g,"time_of_dynamic_crush_s":%.17g}', ...
        (n - 1) * 1e-4, crush, (k - 1) * 1e-4));
    put_wave([id "/acceleration"], "acceleration", 0, 1e-4, a);
    put_wave([id "/velocity"], "velocity", 0, 1e-4, v);
    put_wave([id "/displacement"], "displacement", 0, 1e-4, x);
end
finish();
