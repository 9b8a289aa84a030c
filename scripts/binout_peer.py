"""What `just bench --binout` times beside `crumple-ingest`: motions of three nodes of a large binout, read by lasso-python.

Run as `binout_peer.py INGEST BINOUT TURNS`: both read the same nodes in turns, each in a process of its own. Prints the
shortest time and the largest memory of each as Markdown, with their ratio. `binout_peer.py BINOUT` is the peer itself.
"""

import os
import subprocess
import sys
import tempfile
import time

NODES = 3
COLUMNS = [f"{axis}_{what}" for what in ("displacement", "velocity", "acceleration") for axis in "xyz"]


def read(path):
    """All columns that ingest reads, of the nodes 1 to 3; the largest displacement is printed."""
    from lasso.dyna import Binout

    binout = Binout(path)
    ids = list(binout.read("nodout", "ids"))
    places = [ids.index(node) for node in range(1, NODES + 1)]
    times = binout.read("nodout", "time")
    waves = {name: binout.read("nodout", name)[:, places] for name in COLUMNS}
    print(len(times), waves["x_displacement"].max())


def cost(command):
    """Seconds and MiB of a command that succeeds."""
    start = time.perf_counter()
    child = subprocess.Popen(command, stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(child.pid, 0)
    if status != 0:
        sys.exit(f"{command}: exit status {status}")
    return time.perf_counter() - start, usage.ru_maxrss / 1024


def main(ingest, binout, turns):
    with tempfile.TemporaryDirectory() as folder:
        flags = ["--units", "mm-ms-kg", "--node", "1", "--mass", "1000kg", "-q", "--force"]
        own = [ingest, binout, "-o", os.path.join(folder, "1-ingest.mcap"), *flags]
        peer = [sys.executable, __file__, binout]
        costs = [(cost(own), cost(peer)) for _ in range(turns)]
    (own_s, own_mib), (peer_s, peer_mib) = (
        (min(pair[k][0] for pair in costs), max(pair[k][1] for pair in costs)) for k in (0, 1)
    )
    print(f"binout of {os.path.getsize(binout) / 1e6:.0f} MB, the shortest of {turns} turns\n")
    print("| program | time, s | memory, MiB |\n|---|---|---|")
    print(f"| crumple-ingest | {own_s:.2f} | {own_mib:.0f} |\n| lasso-python | {peer_s:.2f} | {peer_mib:.0f} |")
    print(f"| ratio | {peer_s / own_s:.1f} | {peer_mib / own_mib:.1f} |")


if __name__ == "__main__":
    if len(sys.argv) == 2:
        read(sys.argv[1])
    else:
        main(sys.argv[1], sys.argv[2], int(sys.argv[3]))
