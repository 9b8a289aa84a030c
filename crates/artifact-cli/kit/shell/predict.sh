#!/bin/sh
# Predict: dynamic crush of the Kelvin candidates at 40 km/h. It rises with the speed, and its time stays.
. "$(dirname "$0")/artifact.sh"
v=$(number_of "40 / 3.6")
tested=$(number /events dynamic_crush_m)
best=$(text /recommendation recommended)
topics "/parameters/kelvin/" > "$work/candidates" ||
    refuse "no candidate is a Kelvin model, and this stage predicts with no other"
n=0
while read -r topic; do
    id=${topic#/parameters/}
    n=$((n + 1))
    m=$(number "$topic" mass_kg)
    w=$(number_of "sqrt($(number "$topic" stiffness_n_per_m) / $m)")
    z=$(number_of "$(number "$topic" damping_n_s_per_m) / (2 * $m * $w)")
    end=$(number_of "atan2(sqrt(1 - $z ^ 2), $z) / ($w * sqrt(1 - $z ^ 2))")
    crush=$(number_of "$v / $w * exp(-$z * $w * $end)")
    put "/prediction/$n" Prediction.v1 "{\"candidate\":\"$id\",\"recommended\":$(truth "\"$id\" == \"$best\""),
        \"impact_speed_m_per_s\":$v,\"mass_kg\":$m,\"extrapolates\":$(truth "$crush > $tested"),
        \"dynamic_crush_m\":$crush,\"time_of_dynamic_crush_s\":$end}"
done < "$work/candidates"
finish
