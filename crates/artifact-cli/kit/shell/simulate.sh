#!/bin/sh
# Simulate: the Kelvin candidates, in steps of 0.1 ms, until their force ends or for 0.2 s.
. "$(dirname "$0")/artifact.sh"
v0=$(number /test impact_speed_m_per_s)
topics "/parameters/kelvin/" > "$work/candidates" ||
    refuse "no candidate is a Kelvin model, and this stage simulates no other"
while read -r topic; do
    id=${topic#/parameters/}
    m=$(number "$topic" mass_kg)
    k=$(number "$topic" stiffness_n_per_m)
    c=$(number "$topic" damping_n_s_per_m)
    awk -v v="$v0" -v m="$m" -v k="$k" -v c="$c" -v work="$work" 'BEGIN {
        for (n = 0; n < 2000; n++) {
            a = -(k * x + c * v) / m
            printf "%.17g\n", a > (work "/acceleration"); printf "%.17g\n", v > (work "/velocity")
            printf "%.17g\n", x > (work "/displacement")
            if (x > crush) { crush = x; end = n * 1e-4 }
            if (n && a > 0) break
            v += a * 1e-4; x += v * 1e-4 } # the new velocity moves it: the energy stays
        printf "%.17g %.17g %.17g\n", crush, end, (n < 2000 ? n : 1999) * 1e-4 }' > "$work/events"
    read -r crush end last < "$work/events"
    put "/simulation/$id" Simulation.v1 "{\"from_s\":0,\"to_s\":$last,\"dynamic_crush_m\":$crush,
        \"time_of_dynamic_crush_s\":$end}"
    for name in acceleration velocity displacement; do
        put_wave "$id/$name" "$name" 0 0.0001 "$work/$name"
    done
done < "$work/candidates"
finish
