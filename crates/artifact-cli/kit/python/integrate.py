"""Integrate: velocity and displacement of the pulse by the trapezoidal rule, from the impact speed at its start."""
import crumple, numpy

def trapezoid(artifact):
    test = artifact.records["/test"]
    id = test.pulse or next(id for id, wave in artifact.waves.items() if wave.quantity == "acceleration")
    pulse, v0 = artifact.waves[id], test.impact_speed_m_per_s
    if v0 is None:
        raise crumple.Refused("the record has no impact speed\n  hint: crumple run RECORD --impact-speed 50km/h")
    total = lambda y: numpy.concatenate([[0.0], numpy.cumsum((y[1:] + y[:-1]) / 2 * pulse.dt)])
    v = v0 + total(pulse.samples)
    x = total(v)
    x -= x[max(0, round(-pulse.t0 / pulse.dt))]  # zero at contact
    if v.min() > 0:
        raise crumple.Refused("the velocity never reaches zero: there is no dynamic crush")
    k = int(numpy.argmax(v <= 0))
    events = crumple.Record(
        "crumple.Events.v1", channel=id, time_zero_s=0.0, time_zero_rule=test.time_zero or "file", rule="trapezoid",
        start="record-start", impact_speed_m_per_s=v0, dynamic_crush_m=x[k], time_of_dynamic_crush_s=pulse.time[k],
        rebound_velocity_m_per_s=v.min(), coefficient_of_restitution=-v.min() / v0, delta_v_m_per_s=v0 - v.min(),
        time_of_rebound_s=pulse.time[v.argmin()])
    waves = {f"{id}/velocity": crumple.Wave(v, pulse.dt, pulse.t0, "velocity"),
             f"{id}/displacement": crumple.Wave(x, pulse.dt, pulse.t0, "displacement")}
    return crumple.Artifact({"/test": test, "/events": events}, waves)

crumple.stage(trapezoid)
