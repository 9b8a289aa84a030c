% Integrate: velocity and displacement of the pulse by the trapezoidal rule, from the impact speed at its start.
source(fullfile(fileparts(mfilename("fullpath")), "artifact.m"));
id = pulse();
a = wave(id);
v0 = number("/test", "impact_speed_m_per_s");
v = v0 + a.dt_s * cumtrapz(a.samples);
x = a.dt_s * cumtrapz(v);
x -= x(1 + max(0, round(-a.t0_s / a.dt_s))); % zero at contact
k = find(v <= 0, 1);
if isempty(k)
    refuse("the velocity never reaches zero: there is no dynamic crush");
end
[low, late] = min(v);
time = @(k) a.t0_s + (k - 1) * a.dt_s;
rule = record("/test").time_zero;
if isempty(rule)
    rule = "file";
end
put("/events", "Events.v1", sprintf(['{"channel":"%s","time_zero_s":0,"time_zero_rule":"%s","rule":"trapezoid",' ...
    '"start":"record-start","impact_speed_m_per_s":%.17g,"dynamic_crush_m":%.17g,"time_of_dynamic_crush_s":%.17g,' ...
    '"rebound_velocity_m_per_s":%.17g,"time_of_rebound_s":%.17g,"coefficient_of_restitution":%.17g,' ...
    '"delta_v_m_per_s":%.17g}'], id, rule, v0, x(k), time(k), low, time(late), -low / v0, v0 - low));
put_wave([id "/velocity"], "velocity", a.t0_s, a.dt_s, v);
put_wave([id "/displacement"], "displacement", a.t0_s, a.dt_s, x);
finish();
