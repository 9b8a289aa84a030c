% Predict: dynamic crush of the Kelvin candidates at 40 km/h. It rises with the speed, and its time stays.
source(fullfile(fileparts(mfilename("fullpath")), "artifact.m"));
v0 = 40 / 3.6; % m/s
candidates = topics("/parameters/kelvin/");
if isempty(candidates)
    refuse("no candidate is a Kelvin model, and this stage predicts with no other");
end
words = {"false", "true"};
for n = 1:length(candidates)
    id = candidates{n}(13:end);
    of = record(candidates{n}).parameters;
    w = sqrt(of.stiffness_n_per_m / of.mass_kg);
    z = of.damping_n_s_per_m / (2 * of.mass_kg * w);
    last = acos(z) / (w * sqrt(1 - z ^ 2));
    crush = v0 / w * exp(-z * w * last);
    put(sprintf("/prediction/%d", n), "Prediction.v1", sprintf(['{"candidate":"%s","recommended":%s,' ...
        '"impact_speed_m_per_s":%.17g,"mass_kg":%.17g,"extrapolates":%s,"dynamic_crush_m":%.17g,' ...
        '"time_of_dynamic_crush_s":%.17g}'], id, words{1 + strcmp(record("/recommendation").recommended, id)}, v0, ...
        of.mass_kg, words{1 + (crush > number("/events", "dynamic_crush_m"))}, crush, last));
end
finish();
