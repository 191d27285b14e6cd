"""The enrolled face, as a holder of the scan PROBE learns it from the daemon's heat map: each
point of the probe is moved onto the template and by its gap along z.
Usage: rebuild.py PROBE.json RESPONSE.json OUT.json; exit status 1: the response has no heat map."""

import json
import sys

probe, response, out = sys.argv[1:]
with open(response) as f:
    told = json.load(f)
if "heatmap" not in told:
    sys.exit(1)
t = told.get("transform") or told["alignment"]["transform"]
with open(probe) as f:
    points = json.load(f)["points"]
face = []
for p, gap in zip(points, told["heatmap"]):
    if gap is not None:
        x, y, z = (sum(t[4 * i + k] * p[k] for k in range(3)) + t[4 * i + 3] for i in range(3))
        face.append([x, y, z - gap])
with open(out, "w") as f:
    json.dump({"units": "mm", "points": face}, f)
