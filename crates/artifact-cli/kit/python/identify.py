"""Identify: one undamped mode. Its quarter period is the time of dynamic crush."""
import math
import crumple

def quarter_sine(artifact):
    events = artifact.records["/events"]
    end, wave = events.time_of_dynamic_crush_s, artifact.waves[f"{events.channel}/displacement"]
    if not end:
        raise crumple.Refused("/events has no time of dynamic crush")
    w = math.pi / 2 / end
    poles = [{"re_per_s": 0.0, "im_rad_per_s": im, "natural_frequency_rad_per_s": w, "damping_ratio": 0.0}
             for im in (w, -w)]
    about = crumple.Record(
        "crumple.Identification.v1", method="quarter-sine", order=2, channel=events.channel, from_s=0.0, to_s=end,
        treated_as="free-decay", samples=round(end / wave.dt) + 1, singular_values=[],
        notes=["one undamped mode, from the time of dynamic crush alone"])
    return crumple.Artifact({
        "/test": artifact.records["/test"], "/modes/quarter-sine": crumple.Record("crumple.Modes.v2", modes=poles),
        "/identification/quarter-sine": about})

crumple.stage(quarter_sine)
