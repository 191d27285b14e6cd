"""A scan between two people: at each point of B the height is (1 - SHARE) of A's surface and SHARE of
B's.  Points of B that are not above A's surface are left out.
Usage: blend.py A.xyz B.xyz SHARE OUT.xyz, both frontal."""

import random
import sys

CELL = 2.5  # mm


def read(path):
    with open(path) as f:
        return [tuple(map(float, line.split()[:3])) for line in f if line.strip()]


def heights(points):
    """The mean height of each cell."""
    cells = {}
    for x, y, z in points:
        cells.setdefault((round(x / CELL), round(y / CELL)), []).append(z)
    return {key: sum(z) / len(z) for key, z in cells.items()}


def height_at(cells, x, y):
    """Bilinear, over the corners that there are; None where they are too few."""
    i, j = int(x // CELL), int(y // CELL)
    u, v = x / CELL - i, y / CELL - j
    total = weight = 0.0
    for di, dj, w in ((0, 0, (1 - u) * (1 - v)), (1, 0, u * (1 - v)), (0, 1, (1 - u) * v), (1, 1, u * v)):
        z = cells.get((i + di, j + dj))
        if z is not None:
            total += w * z
            weight += w
    return total / weight if weight > 0.3 else None


a, b, share, out = sys.argv[1:]
share = float(share)
random.seed(1)
cells = heights(read(a))
with open(out, "w") as f:
    for x, y, z in read(b):
        below = height_at(cells, x, y)
        if below is not None:
            f.write("%.6f %.6f %.6f\n" % (x, y, (1 - share) * below + share * z + random.gauss(0, 0.02)))
