#!/usr/bin/env python3
"""The crates of the program as a CycloneDX 1.5 bill of materials: sbom.py TARGET < cargo metadata > sbom.json.

Crates that only build scripts or tests use are left out. No clock and no random number: the same lock file gives the
same bytes.
"""

import json
import sys

PROGRAM = "crumple-cli"


def used(metadata):
    """Ids of what the program is linked from: dependencies of the normal kind, from the program on."""
    of = {node["id"]: node for node in metadata["resolve"]["nodes"]}
    start = next(one["id"] for one in metadata["packages"] if one["name"] == PROGRAM)
    found, left = set(), [start]
    while left:
        id = left.pop()
        if id not in found:
            found.add(id)
            left += [dep["pkg"] for dep in of[id]["deps"] if any(kind["kind"] is None for kind in dep["dep_kinds"])]
    return start, found, of


def purl(package):
    return f"pkg:cargo/{package['name']}@{package['version']}"


def component(package, kind="library"):
    made = {"type": kind, "bom-ref": purl(package), "name": package["name"], "version": package["version"],
            "purl": purl(package)}
    licence = package["license"]
    return made | ({"licenses": [{"expression": licence.replace("/", " OR ")}]} if licence else {})


def main():
    metadata = json.load(sys.stdin)
    start, found, nodes = used(metadata)
    of = {one["id"]: one for one in metadata["packages"] if one["id"] in found}
    names = {id: purl(package) for id, package in of.items()}
    below = sorted((package for id, package in of.items() if id != start), key=purl)
    depends = [
        {"ref": names[id], "dependsOn": sorted({names[dep["pkg"]] for dep in nodes[id]["deps"] if dep["pkg"] in names})}
        for id in sorted(of, key=names.get)
    ]
    bom = {
        "bomFormat": "CycloneDX", "specVersion": "1.5", "version": 1,
        "metadata": {"component": component(of[start], "application"),
                     "properties": [{"name": "cargo:target", "value": sys.argv[1]}]},
        "components": [component(package) for package in below], "dependencies": depends,
    }
    json.dump(bom, sys.stdout, indent=1, sort_keys=True)
    print()


if __name__ == "__main__":
    main()
