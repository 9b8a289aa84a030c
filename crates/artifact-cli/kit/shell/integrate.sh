#!/bin/sh
# Integrate: velocity and displacement of the pulse by the trapezoidal rule, from the impact speed at its start.
. "$(dirname "$0")/artifact.sh"
id=$(pulse)
v0=$(number /test impact_speed_m_per_s)
t0=$(wave "$id" t0_s)
dt=$(wave "$id" dt_s)
awk -v v="$v0" -v t0="$t0" -v dt="$dt" -v work="$work" '
    { if (NR > 1) { w = v; v += (a + $1) / 2 * dt; x += (w + v) / 2 * dt }
      a = $1; speed[NR] = v; way[NR] = x; if (NR - 1 <= -t0 / dt + 0.5) contact = x }
    END { low = 1
          for (k = 1; k <= NR; k++) {
              printf "%.17g\n", speed[k] > (work "/velocity")
              printf "%.17g\n", way[k] - contact > (work "/displacement")
              if (!end && speed[k] <= 0) end = k
              if (speed[k] < speed[low]) low = k }
          if (end) printf "%.17g %.17g %.17g %.17g\n", way[end] - contact, t0 + (end - 1) * dt, speed[low],
              t0 + (low - 1) * dt }' "$(wave "$id" file)" > "$work/events"
read -r crush end rebound late < "$work/events" || refuse "the velocity never reaches zero: there is no dynamic crush"
put /events Events.v1 "{\"channel\":\"$id\",\"time_zero_s\":0,\"time_zero_rule\":\"$(text /test time_zero file)\",
    \"rule\":\"trapezoid\",\"start\":\"record-start\",\"impact_speed_m_per_s\":$v0,\"dynamic_crush_m\":$crush,
    \"time_of_dynamic_crush_s\":$end,\"rebound_velocity_m_per_s\":$rebound,\"time_of_rebound_s\":$late,
    \"coefficient_of_restitution\":$(number_of "-($rebound) / $v0"),
    \"delta_v_m_per_s\":$(number_of "$v0 - ($rebound)")}"
put_wave "$id/velocity" velocity "$t0" "$dt" "$work/velocity"
put_wave "$id/displacement" displacement "$t0" "$dt" "$work/displacement"
finish
