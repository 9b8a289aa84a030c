"""Simulate: the Kelvin candidates, in steps of 0.1 ms, until their force ends or for 0.2 s."""
import crumple

def move(m, k, c, v, dt=1e-4):
    rows, x = [], 0.0
    for _ in range(2000):
        a = -(k * x + c * v) / m
        rows.append((a, v, x))
        if len(rows) > 1 and a > 0:
            break
        v += a * dt  # the new velocity moves it: the energy stays
        x += v * dt
    return zip(*rows)

def simulate(artifact):
    test, out = artifact.records["/test"], crumple.Artifact({"/test": artifact.records["/test"]})
    for id, candidate in artifact.below("/parameters/").items():
        if candidate.model == "kelvin":
            p = candidate.parameters
            curves = move(p["mass_kg"], p["stiffness_n_per_m"], p["damping_n_s_per_m"], test.impact_speed_m_per_s)
            for name, curve in zip(("acceleration", "velocity", "displacement"), curves):
                out.waves[f"{id}/{name}"] = crumple.Wave(curve, 1e-4, 0.0, name)
            crush = out.waves[f"{id}/displacement"].samples
            out.records[f"/simulation/{id}"] = crumple.Record(
                "crumple.Simulation.v1", from_s=0.0, to_s=1e-4 * (len(crush) - 1), dynamic_crush_m=max(crush),
                time_of_dynamic_crush_s=1e-4 * crush.index(max(crush)))
    if not out.waves:
        raise crumple.Refused("no candidate is a Kelvin model, and this stage simulates no other")
    return out

crumple.stage(simulate)
