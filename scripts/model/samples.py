#!/usr/bin/env python3
"""Makes the console's sample scans from ICT-FaceKit, byte by byte (docs/model.md, "The sample scans").

    git clone https://github.com/ICT-VGL/ICT-FaceKit
    scripts/model/samples.py ICT-FaceKit/FaceXModel server/console/samples

The people are invented: the coefficients of their shape and of their expressions are random numbers of
the seeds that the script prints.  No model and no threshold was made from these scans.  The script needs
numpy (Debian: python3-numpy), takes a minute, and writes the same bytes on every machine, because it
computes as rebuild.py does: with + - * / and sqrt, each operation rounded, in a fixed order.
"""
import os
import sys

import numpy as np

from rebuild import Faces, Random

# File: the seeds of person and day, the half tangents of pitch, yaw and roll, and the share of the
# expressions.  A day is another expression and other noise.
SCANS = {
    "one": (4, 1, (0.02, -0.05, 0.01), 0.3),
    "one_again": (4, 2, (-0.03, 0.06, -0.02), 0.6),
    "one_turned": (4, 3, (0.02, -0.31, 0.03), 0.3),
    "other": (12, 22, (0.03, 0.04, -0.01), 0.3),
}
DEVIATION = 0.8  # of the people: less than that of the model, in which a face can be odd
STEP_MM = 1.8  # between the scanner's rays
REACH_MM = 98  # from the middle of the head, MIDDLE_MM behind the nose tip, to what is cut off
MIDDLE_MM = 60
STEEP_MM = 5  # between two rays: the scanner loses a surface that falls more
NOISE_MM = 0.08
PART_MM = 1 / 64  # the unit of the file's numbers


def rotation(x, y, z):
    """Returns the rotation of the quaternion (1, x, y, z)."""
    s = 2 / (1 + x * x + y * y + z * z)
    return [[1 - s * (y * y + z * z), s * (x * y - z), s * (x * z + y)],
            [s * (x * y + z), 1 - s * (x * x + z * z), s * (y * z - x)],
            [s * (x * z - y), s * (y * z + x), 1 - s * (x * x + y * y)]]


def scan(faces, person, day, turned, share):
    """Returns the points that a scanner sees of the person, float32, mm."""
    at = faces.person(DEVIATION, Random(3, person))
    random = Random(4, day)
    with_it = at.copy()
    faces.express(random, with_it)
    at += np.float32(share) * (with_it - at)
    at[:, 2] += np.float32(MIDDLE_MM)
    x, y, z = at.astype(float).T
    at = np.stack([r[0] * x + r[1] * y + r[2] * z for r in rotation(*turned)], axis=1).astype(np.float32)
    n = 2 * int(REACH_MM / STEP_MM)
    low = -STEP_MM * n / 2
    height = faces.seen(at, low, low, STEP_MM, n, n)
    beside = np.pad(height, 1, constant_values=np.nan)
    near = [np.abs(height - b) < STEEP_MM for b in (beside[1:-1, :-2], beside[1:-1, 2:], beside[:-2, 1:-1], beside[2:, 1:-1])]
    line = low + STEP_MM * (np.arange(n) + 0.5)
    x, y = np.meshgrid(line, line)
    kept = np.all(near, axis=0) & (x * x + y * y + height.astype(float)**2 < REACH_MM**2)
    points = np.stack([x[kept], y[kept], height[kept].astype(float)], axis=1)
    points[:, 2] += NOISE_MM * random.normal(len(points))
    return (np.rint(points / PART_MM) * PART_MM).astype("<f4")


def write(path, points):
    head = ("ply\nformat binary_little_endian 1.0\n"
            "comment an invented person, from ICT-FaceKit, (c) 2020 USC Institute for Creative Technologies, MIT\n"
            "element vertex %d\nproperty float x\nproperty float y\nproperty float z\nend_header\n" % len(points))
    with open(path, "wb") as file:
        file.write(head.encode("ascii") + points.tobytes())


if __name__ == "__main__":
    if len(sys.argv) != 3:
        sys.exit("usage: samples.py FaceXModel FOLDER")
    FACES = Faces(sys.argv[1])
    for name, what in SCANS.items():
        seen = scan(FACES, *what)
        write(os.path.join(sys.argv[2], name + ".ply"), seen)
        print("%s.ply: person %d, day %d: %d points" % (name, *what[:2], len(seen)))
