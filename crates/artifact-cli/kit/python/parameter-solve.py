"""Parameter-solve: a Kelvin model (spring beside damper) that has the dynamic crush of the test and its time."""
import math
import crumple

def kelvin(artifact):
    test, events = artifact.records["/test"], artifact.records["/events"]
    m, v0 = test.mass_kg, events.impact_speed_m_per_s
    crush, end = events.dynamic_crush_m, events.time_of_dynamic_crush_s
    if not (m and v0 and crush and end):
        raise crumple.Refused("mass, impact speed, dynamic crush and its time must be known")
    # v0 tm / C is pi/2 + (pi^2/4 - 1) z of a damping ratio z, to first order.
    z = min(max((v0 * end / crush - math.pi / 2) / (math.pi**2 / 4 - 1), 0.0), 0.9)
    w = math.acos(z) / math.sqrt(1 - z * z) / end
    id, numbers = "kelvin/crush-and-time/1", {
        "mass_kg": m, "stiffness_n_per_m": m * w * w, "damping_n_s_per_m": 2 * z * w * m}
    because = "the only candidate of this stage"
    return crumple.Artifact({"/test": test, f"/parameters/{id}": crumple.Record(
        "crumple.Candidate.v1", model="kelvin", method="crush-and-time", parameters=numbers, physical=True),
        "/recommendation": crumple.Record(
            "crumple.Recommendation.v1", recommended=id, recommended_because=because, simplest=id,
            simplest_because=because, closest=id, closest_because=because)})

crumple.stage(kelvin)
