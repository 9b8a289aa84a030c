"""Predict: dynamic crush of the Kelvin candidates at 40 km/h. It rises with the speed, and its time stays."""
import math
import crumple

SPEED = 40 / 3.6  # m/s

def predict(artifact):
    tested, records = artifact.records["/events"].dynamic_crush_m, {"/test": artifact.records["/test"]}
    choice = artifact.records.get("/recommendation", {}).get("recommended")
    for id, candidate in artifact.below("/parameters/").items():
        if candidate.model == "kelvin":
            m, k, c = (candidate.parameters[name] for name in ("mass_kg", "stiffness_n_per_m", "damping_n_s_per_m"))
            w = math.sqrt(k / m)
            z = min(c / (2 * m * w), 0.999)
            end = math.acos(z) / (w * math.sqrt(1 - z * z))
            crush = SPEED / w * math.exp(-z * w * end)
            records[f"/prediction/{len(records)}"] = crumple.Record(
                "crumple.Prediction.v1", candidate=id, recommended=id == choice, impact_speed_m_per_s=SPEED, mass_kg=m,
                extrapolates=tested is None or crush > tested, dynamic_crush_m=crush, time_of_dynamic_crush_s=end)
    if len(records) == 1:
        raise crumple.Refused("no candidate is a Kelvin model, and this stage predicts with no other")
    return crumple.Artifact(records)

crumple.stage(predict)
