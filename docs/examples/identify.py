"""A stage in another language: one decaying mode by an AR(2) model of the crash pulse. Reads waves, writes JSON."""
import argparse, cmath, json, struct
from mcap.reader import make_reader
from mcap.writer import Writer

parser = argparse.ArgumentParser()
parser.add_argument("inputs", nargs="+")
parser.add_argument("-o", "--output", required=True)
parser.add_argument("-p", "--pipeline")
args, _ = parser.parse_known_args()  # -q, --force and the like are for stages that know them

test, waves = None, {}
for path in args.inputs:
    for schema, channel, message in make_reader(open(path, "rb"), validate_crcs=True).iter_messages():
        if channel.topic == "/test":
            test = json.loads(message.data)
        elif schema.name == "crumple.WaveBlock.v1":
            t0_ns, dt, first, n = struct.unpack_from("<qdQQ", message.data)
            wave = waves.setdefault(channel.topic, (t0_ns / 1e9, dt, []))
            wave[2].extend(struct.unpack_from(f"<{n}d", message.data, 32))

t0, dt, a = waves["/wave/" + test["pulse"]]
a, step = a[max(0, round(-t0 / dt))::20], 20 * dt
rows = [(a[k - 1], a[k - 2], a[k]) for k in range(2, len(a))]
s11, s12, s22 = (sum(r[i] * r[j] for r in rows) for i, j in ((0, 0), (0, 1), (1, 1)))
b1, b2 = (sum(r[i] * r[2] for r in rows) for i in (0, 1))
p, q = (b1 * s22 - b2 * s12) / (s11 * s22 - s12**2), (b2 * s11 - b1 * s12) / (s11 * s22 - s12**2)
poles = [cmath.log((p + sign * cmath.sqrt(p * p + 4 * q)) / 2) / step for sign in (1, -1)]

modes = [{"re_per_s": s.real, "im_rad_per_s": s.imag, "natural_frequency_rad_per_s": abs(s),
          "damping_ratio": -s.real / abs(s)} for s in poles]
about = {"method": "ar", "order": 2, "channel": test["pulse"], "treated_as": "free-decay", "from_s": 0.0,
         "to_s": (len(a) - 1) * step, "samples": len(a), "singular_values": [], "notes": ["written by a Python stage"]}
with open(args.output, "wb") as file:
    writer = Writer(file)
    writer.start(profile="", library="python")
    for topic, kind, data in (("/test", "Test.v1", test), ("/modes/ar-2", "Modes.v2", {"modes": modes}), ("/identification/ar-2", "Identification.v1", about)):
        schema = writer.register_schema(f"crumple.{kind}", "jsonschema", b"{}")
        channel = writer.register_channel(topic, "json", schema)
        writer.add_message(channel, log_time=0, publish_time=0, data=json.dumps(data).encode())
    writer.finish()
