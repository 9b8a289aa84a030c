#!/bin/sh
# Filter: a moving average over 4.5 ms, about CFC 60. Its ends are means of the samples that there are.
. "$(dirname "$0")/artifact.sh"
waves | while read -r id; do
    dt=$(wave "$id" dt_s)
    half=$(number_of "int(0.0022 / $dt + 0.5)")
    awk -v half="$half" '{ sum[NR] = sum[NR - 1] + $1 }
        END { for (k = 1; k <= NR; k++) {
                  first = k > half ? k - half : 1; last = k + half < NR ? k + half : NR
                  printf "%.17g\n", (sum[last] - sum[first - 1]) / (last - first + 1) } }' \
        "$(wave "$id" file)" > "$work/smooth"
    put_wave "$id" "$(wave "$id" quantity)" "$(wave "$id" t0_s)" "$dt" "$work/smooth"
    put "/filter/$id" ChannelFilter.v1 "{\"mode\":\"moving-average\",\"phase\":\"zero\",\"samples_added\":0,
        \"width_s\":$(number_of "(2 * $half + 1) * $dt"),\"coefficients\":[],\"zero_level_removed\":0,\"notes\":[]}"
done
pass /quality/
finish
