#!/bin/sh
# Identify: one undamped mode. Its quarter period is the time of dynamic crush.
. "$(dirname "$0")/artifact.sh"
end=$(number /events time_of_dynamic_crush_s)
id=$(text /events channel)
samples=$(number_of "int($end / $(wave "$id/displacement" dt_s) + 1.5)")
w=$(number_of "atan2(1, 0) / $end")
pole="\"re_per_s\":0,\"natural_frequency_rad_per_s\":$w,\"damping_ratio\":0"
put /modes/quarter-sine Modes.v2 "{\"modes\":[{$pole,\"im_rad_per_s\":$w},{$pole,\"im_rad_per_s\":-$w}]}"
put /identification/quarter-sine Identification.v1 "{\"method\":\"quarter-sine\",\"order\":2,\"channel\":\"$id\",
    \"treated_as\":\"free-decay\",\"from_s\":0,\"to_s\":$end,\"samples\":$samples,\"singular_values\":[],
    \"notes\":[\"one undamped mode, from the time of dynamic crush alone\"]}"
finish
