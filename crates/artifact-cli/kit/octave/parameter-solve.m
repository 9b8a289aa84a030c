% Parameter-solve: a Kelvin model (spring beside damper) that has the dynamic crush of the test and its time.
source(fullfile(fileparts(mfilename("fullpath")), "artifact.m"));
m = number("/test", "mass_kg");
v0 = number("/events", "impact_speed_m_per_s");
crush = number("/events", "dynamic_crush_m");
last = number("/events", "time_of_dynamic_crush_s");
% v0 tm / C is pi/2 + (pi^2/4 - 1) z of a damping ratio z, to first order.
z = min(max((v0 * last / crush - pi / 2) / (pi ^ 2 / 4 - 1), 0), 0.9);
w = acos(z) / sqrt(1 - z ^ 2) / last;
put("/parameters/kelvin/crush-and-time/1", "Candidate.v1", sprintf( ...
    ['{"model":"kelvin","method":"crush-and-time","physical":true,"parameters":{"mass_kg":%.17g,' ...
    '"stiffness_n_per_m":%.17g,"damping_n_s_per_m":%.17g}}'], m, m * w ^ 2, 2 * z * w * m));
because = '_because":"the only candidate of this stage"';
names = {"recommended", "simplest", "closest"};
choices = cellfun(@(name) ['"' name '":"kelvin/crush-and-time/1","' name because], names, "UniformOutput", false);
put("/recommendation", "Recommendation.v1", ['{' strjoin(choices, ",") '}']);
finish();
