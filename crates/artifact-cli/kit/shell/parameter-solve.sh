#!/bin/sh
# Parameter-solve: a Kelvin model (spring beside damper) that has the dynamic crush of the test and its time.
. "$(dirname "$0")/artifact.sh"
m=$(number /test mass_kg)
v0=$(number /events impact_speed_m_per_s)
crush=$(number /events dynamic_crush_m)
end=$(number /events time_of_dynamic_crush_s)
# v0 tm / C is pi/2 + (pi^2/4 - 1) z of a damping ratio z, to first order.
z=$(number_of "($v0 * $end / $crush - atan2(1, 0)) / (atan2(1, 0) ^ 2 - 1)")
z=$(number_of "$z < 0 ? 0 : $z > 0.9 ? 0.9 : $z")
w=$(number_of "atan2(sqrt(1 - $z ^ 2), $z) / sqrt(1 - $z ^ 2) / $end")
id=kelvin/crush-and-time/1
why="the only candidate of this stage"
put "/parameters/$id" Candidate.v1 "{\"model\":\"kelvin\",\"method\":\"crush-and-time\",\"physical\":true,
    \"parameters\":{\"mass_kg\":$m,\"stiffness_n_per_m\":$(number_of "$m * $w ^ 2"),
    \"damping_n_s_per_m\":$(number_of "2 * $z * $w * $m")}}"
put /recommendation Recommendation.v1 "{\"recommended\":\"$id\",\"recommended_because\":\"$why\",\"simplest\":\"$id\",
    \"simplest_because\":\"$why\",\"closest\":\"$id\",\"closest_because\":\"$why\"}"
finish
