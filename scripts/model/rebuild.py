#!/usr/bin/env python3
"""Rebuilds core/face/default.model from ICT-FaceKit, byte by byte (docs/model.md, "How it is learned").

    git clone https://github.com/ICT-VGL/ICT-FaceKit
    scripts/model/rebuild.py ICT-FaceKit/FaceXModel core/face/default.model new.model
    cmp new.model core/face/default.model

The second argument is the model whose head the new model takes over: the name, the kinship, the noise
and the calibration, which were chosen on scans of real people.  The script needs numpy (Debian:
python3-numpy) and takes six minutes of one core; it uses all cores.

Why every machine writes the same bytes: faces are placed, moved and rendered with + - * / and sqrt in
float32 and double, each operation rounded, in a fixed order.  Covariances and eigenvectors come from
numpy's BLAS and LAPACK, whose last digits differ between machines; but the model's numbers are rounded
to 1/1000 mm, which is coarser by a factor of 1e9.
"""
import math
import multiprocessing
import os
import sys

import numpy as np

PEOPLE = 3000
EXPRESSIONS = 5000
EXPRESSED_DEVIATION = 0.8  # of people whose expressions are rendered

# The grid of core/face/grid.h: cells of the canonical frame, numbered by rows from the lower left.
NX, NY, MM, LEFT, BOTTOM = 32, 41, 4.0, -64.0, -94.0
CELL = np.arange(NX * NY)
MIRROR = CELL + NX - 1 - 2 * (CELL % NX)
X = LEFT + MM * (CELL % NX + 0.5)
Y = BOTTOM + MM * (CELL // NX + 0.5)

# Cells in use: covered by this share of the people, of this cosine of the mean face's slope, and from
# the chin to the forehead.
COVERED = 0.98
FLAT = np.float32(0.4)
LOWEST_MM, HIGHEST_MM = -88, 66

# Gaps are cut off: beyond them another part of the head comes into view, at the jaw above all.
FARTHEST_PERSON_MM = 17
FARTHEST_EXPRESSION_MM = 12

# What the model consists of: factors, modes, and fields (deviation and length, mm).  They make up for
# what the faces lack, and were chosen on scans of real people.
IDENTITY_SHARE, IDENTITY_FIELD = 0.49, (0.6, 14)
CHANGE_FACTOR, CHANGE_TISSUE, CHANGE_FIELD = 2, (1, 20), (0.4, 35)
CHANGE_BONE_SHARE = 0.25
SHAPE_IDENTITY, SHAPE_FIELD = 1.44, (0.6, 15)
SHAPE_PEOPLE, SHAPE_EXPRESSIONS = 60, 40
CHANGE_MODES, IDENTITY_MODES, SHAPE_MODES = 100, 100, 88
NOISE_MM = 1  # of a cell, if modes of identity are weighed against the rest
SHAPE_MM = 0.5  # that the rest of the shape has besides what its modes leave
LEAST_MM = 0.001  # of a rest: 0 stands for a cell that is not in use

# ---- the files


def read_obj(path):
    """Returns the vertices, and the triangles of materials that a scanner sees."""
    vertices, triangles, seen = [], [], True
    with open(path, encoding="ascii") as file:
        for line in file:
            word, *rest = line.split() or [""]
            if word == "v":
                vertices.append(rest[:3])
            elif word == "usemtl":
                seen = not any(w in rest[0].lower() for w in ("blend", "fluid", "lash", "occlusion"))
            elif word == "f" and seen:
                corner = [int(c.split("/")[0]) - 1 for c in rest]
                triangles += [(corner[0], *pair) for pair in zip(corner[1:], corner[2:])]
    return np.array(vertices, float).astype(np.float32), np.array(triangles)


def place(at, pose):
    """Returns vertices, given in cm, in the canonical frame: mm, in double precision."""
    (r, t), (x, y, z) = pose, 10 * at.astype(float).T
    return np.stack([r[i][0] * x + r[i][1] * y + r[i][2] * z + t[i] for i in range(3)], axis=1)


def upright(h, pose):
    """Returns the pose followed by the motion that turns the face of the heights h upright, as far back
    60 mm above the nose tip as 60 mm below, and brings its nose tip to the origin."""
    r, t = pose
    line = h.reshape(NY, NX)[:, NX // 2 - 1:NX // 2 + 1].astype(float).sum(axis=1) / 2

    def middle(y):
        row = (y - BOTTOM) / MM - 0.5
        i = math.floor(row)
        return line[i] + (row - i) * (line[i + 1] - line[i])

    rows = [y for y in Y[::NX] if -30 < y < 30]
    tip = max(rows, key=middle)
    a, b, c = middle(tip - MM), middle(tip), middle(tip + MM)  # a parabola through the three highest
    pitch = -(middle(tip + 60) - middle(tip - 60)) / 120
    tip += MM * 0.5 * (a - c) / (a + c - 2 * b)
    t = np.array([t[0], t[1] - tip, t[2] - b])
    s = 2 / (1 + 0.5 * pitch * (0.5 * pitch))  # the rotation of the quaternion (1, pitch / 2, 0, 0)
    sin, cos = s * (0.5 * pitch), 1 - s * (0.5 * pitch) * (0.5 * pitch)
    turn = np.array([[1, 0, 0], [0, cos, -sin], [0, sin, cos]])
    return turn @ r, turn @ t


class Faces:
    """The morphable model in the canonical frame, float32, mm."""

    def __init__(self, folder):
        names = sorted(n for n in os.listdir(folder) if n.endswith(".obj"))
        at, triangles = read_obj(os.path.join(folder, next(n for n in names if "neutral" in n)))
        kept, corner = np.unique(triangles, return_inverse=True)
        self.corner = corner.reshape(triangles.shape)
        at = at[kept]
        # The foremost vertex near the plane of symmetry is about the nose tip; six placings make it exact.
        start = place(at, (np.eye(3), np.zeros(3))).astype(np.float32)
        near = start[np.abs(start[:, 0]) < 5].astype(float)
        tip = near[near[:, 2].argmax()]
        pose = np.eye(3), np.array([0, -tip[1], -tip[2]])
        for _ in range(6):
            pose = upright(self.heights(place(at, pose).astype(np.float32)), pose)
        self.neutral = place(at, pose).astype(np.float32)

        def modes(chosen):
            shapes = (place(read_obj(os.path.join(folder, n))[0][kept], pose) for n in chosen)
            return [(s - self.neutral).astype(np.float32) for s in shapes]

        parts = ("brow", "cheek", "eye", "jaw", "mouth", "nose")
        expressions = [n[:-4] for n in names if n.startswith(parts)]
        sides = {"_L": "_R", "_R": "_L"}
        other = [n[:-2] + sides.get(n[-2:], n[-2:]) for n in expressions]
        self.mirror = [expressions.index(n) for n in other]
        # Looking far aside moves little that is seen; nobody is scanned with an open mouth.
        self.share = np.float32([0.5 if n.startswith(("eyeLook", "jawOpen")) else 1 for n in expressions])
        self.identity = modes(n for n in names if n.startswith("identity"))
        self.expression = modes(n + ".obj" for n in expressions)

    def person(self, deviation, random):
        at = self.neutral.copy()
        for by, mode in zip(np.float32(deviation) * random.normal(len(self.identity)).astype(np.float32),
                            self.identity):
            at += by * mode
        return at

    def express(self, random, at):
        """Gives the face at two to eight random expressions, mostly on both sides, and a little of all
        others."""
        n = len(self.expression)
        much = np.zeros(n)
        for _ in range(2 + random.below(7)):
            i = random.below(n)
            a, both = abs(random.normal(1)[0]) * 0.45, random.uniform()
            much[i] += a
            if self.mirror[i] != i and both < 0.85:
                much[self.mirror[i]] += a * (0.7 + 0.6 * random.uniform())
        much += np.abs(random.normal(n)) * 0.07
        for by, mode in zip(np.minimum(much, 1.1).astype(np.float32) * self.share, self.expression):
            at += by * mode

    def heights(self, at):
        """Returns the height of the front-most surface in each cell, NAN if there is none.  The mesh is
        sampled every 2 mm; slits of up to three samples along y, as between the lips, are bridged."""
        seen = self.seen(at, LEFT, BOTTOM, 2, 2 * NX, 2 * NY)
        for gap in (1, 2, 3):
            bridge(seen, gap)
        four = np.sort(seen.reshape(NY, 2, NX, 2).transpose(0, 2, 1, 3).reshape(-1, 4), axis=1)
        return layer(four)

    def seen(self, at, left, bottom, mm, w, h):
        """Returns the height of the front-most surface in the middle of each of h rows of w squares of mm, a
        float32, NAN if there is none."""
        per, half = np.float32(1 / mm), np.float32(0.5)
        corner = np.stack([(at[:, 0] - np.float32(left)) * per - half,
                           (at[:, 1] - np.float32(bottom)) * per - half, at[:, 2]])
        corner = corner[:, self.corner]  # [x, y, z][triangle][corner]
        low, high = corner[:2].min(axis=2), corner[:2].max(axis=2)
        first = np.maximum(np.ceil(low), 0).astype(int)
        count = np.minimum(np.floor(high), [[w - 1], [h - 1]]).astype(int) - first + 1
        some = np.flatnonzero((count > 0).all(axis=0))
        first, count = first[:, some], count[:, some]
        (ax, bx, cx), (ay, by, cy), (az, bz, cz) = corner[:, some].transpose(0, 2, 1)
        twice = (bx - ax) * (cy - ay) - (cx - ax) * (by - ay)
        each = np.where(np.abs(twice) > np.float32(1e-9), count[0] * count[1], 0)
        t = np.repeat(np.arange(len(some)), each)  # of each sample in a triangle's rectangle
        k = np.arange(len(t)) - np.repeat(np.cumsum(each) - each, each)
        i, j = first[0, t] + k % count[0, t], first[1, t] + k // count[0, t]
        x, y = i.astype(np.float32) - ax[t], j.astype(np.float32) - ay[t]
        u = (x * (cy - ay)[t] - y * (cx - ax)[t]) / twice[t]
        v = ((bx - ax)[t] * y - (by - ay)[t] * x) / twice[t]
        z = az[t] + u * (bz - az)[t] + v * (cz - az)[t]
        beside = np.float32(1e-5)  # a triangle also covers samples just beside it
        inside = (u >= -beside) & (v >= -beside) & (u + v <= np.float32(1) + beside)
        sample, z = (j * w + i)[inside], z[inside]
        order = np.argsort(z, kind="stable")
        seen = np.full(w * h, np.nan, np.float32)
        seen[sample[order]] = z[order]  # the front-most comes last
        return seen.reshape(h, w)


def bridge(z, gap):
    """Bridges the slits of gap samples if both sides are of about one height."""
    below, above = z[:-gap - 1], z[gap + 1:]
    slit = np.abs(above - below) < 8
    for k in range(1, gap + 1):
        slit &= np.isnan(z[k:k - gap - 1])
    j, i = np.nonzero(slit)
    a, b = z[j, i], z[j + gap + 1, i]
    for k in range(1, gap + 1):
        z[j + k, i] = a + (b - a) * np.float32(k) / np.float32(gap + 1)


def layer(four):
    """Returns, for each row of four samples (rising, NAN last), the mean of those within 4 mm of their
    median; NAN if these are fewer than two."""
    n = 4 - np.isnan(four).sum(axis=1)
    row = np.arange(len(four))
    median = np.float32(0.5) * (four[row, np.maximum(n - 1, 0) // 2] + four[row, np.minimum(n // 2, 3)])
    near = np.abs(four - median[:, None]) < 4
    v = np.where(near, four, np.float32(0))
    count = near.sum(axis=1)
    total = v[:, 0] + v[:, 1] + v[:, 2] + v[:, 3]
    return np.where((n >= 2) & (count >= 2), total / np.maximum(count, 1).astype(np.float32), np.float32(np.nan))


# ---- random faces


class Random:
    """splitmix64, as core/basic/rates.c: the same numbers on every machine."""

    def __init__(self, kind, i):
        self.state = (kind << 32) + i

    def draw(self, n):
        step = 0x9E3779B97F4A7C15
        z = np.uint64(self.state) + np.arange(1, n + 1, dtype=np.uint64) * np.uint64(step)
        self.state = (self.state + n * step) % 2**64
        z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
        return z ^ (z >> np.uint64(31))

    def below(self, n):
        return int(self.draw(1)[0]) % n

    def uniform(self):
        return (int(self.draw(1)[0]) >> 11) / 2**53

    def normal(self, n):
        """About standard normal: twelve uniform numbers less 6."""
        x = self.draw(6 * n).reshape(n, 6)
        halves = (x >> np.uint64(32)).astype(np.int64) + (x & np.uint64(2**32 - 1)).astype(np.int64)
        return (halves.sum(axis=1) - (6 << 32)) / 2**32


def render_person(i):
    return FACES.heights(FACES.person(1, Random(1, i)))


def render_expression(i):
    """Returns the heights of a random person with an expression, less those without it."""
    random = Random(2, i)
    at = FACES.person(EXPRESSED_DEVIATION, random)
    neutral = FACES.heights(at)
    FACES.express(random, at)
    return FACES.heights(at) - neutral


# ---- the mean face


def slopes(h):
    """Returns the slopes of h along x and y, from the neighbouring cells that have a height."""
    out = []
    grid = np.pad(h.reshape(NY, NX), 1, constant_values=np.nan)
    at = grid[1:-1, 1:-1]
    for before, behind in ((grid[1:-1, :-2], grid[1:-1, 2:]), (grid[:-2, 1:-1], grid[2:, 1:-1])):
        both = (behind - before) * np.float32(0.5 / MM)
        one = np.where(np.isnan(before), behind - at, at - before) * np.float32(1 / MM)
        none = np.isnan(before) & np.isnan(behind)
        out.append(np.where(none, np.float32(0), np.where(np.isnan(both), one, both)).ravel())
    return out


def mean_face(people):
    """Returns the mean of the people, symmetric, with NAN in cells that are not in use."""
    known = ~np.isnan(people)
    covered = known.sum(axis=0)
    mean = np.where(known, people, 0).sum(axis=0, dtype=float) / np.maximum(covered, 1)
    mean = np.where(covered > 0, mean, np.nan).astype(np.float32)
    mean = (mean + mean[MIRROR]) / np.float32(2)
    x, y = slopes(mean)
    flat = np.float32(1) / np.sqrt(np.float32(1) + (x * x + y * y)) > FLAT
    used = flat & (covered > COVERED * PEOPLE) & (Y >= LOWEST_MM) & (Y <= HIGHEST_MM) & ~np.isnan(mean)
    used = used.reshape(NY, NX)
    # The face is connected to the bridge of the nose; the neck is not.
    face = np.zeros((NY + 2, NX + 2), bool)
    face[1 + int((20 - BOTTOM) / MM), 1 + NX // 2] = True
    size = 0
    while face.sum() > size:
        size = face.sum()
        beside = face[1:-1, :-2] | face[1:-1, 2:] | face[:-2, 1:-1] | face[2:, 1:-1]
        face[1:-1, 1:-1] |= used & beside
    mean = np.where(face[1:-1, 1:-1].ravel(), mean, np.float32(np.nan))
    return (mean + mean[MIRROR]) / np.float32(2)


# ---- spreads: how gaps vary, the same for a face and for its mirror image.  So a covariance falls into
# two blocks, of even patterns, (a + b) / sqrt 2 of a cell and its mirror image, and of odd ones.


class Modes:
    """The n leading modes of a pair of blocks: variance, pattern (of length 1), and whether it is odd."""

    def __init__(self, blocks, n):
        found = [np.linalg.eigh(b) for b in blocks]
        variance = np.maximum(np.concatenate([f[0] for f in found]), 0)
        order = np.argsort(-variance, kind="stable")[:n]
        self.variance, self.odd = variance[order], order >= len(blocks[0])
        self.pattern = np.concatenate([f[1].T for f in found])[order]
        largest = np.abs(self.pattern).argmax(axis=1)
        self.pattern *= np.sign(self.pattern[np.arange(n), largest])[:, None]

    def blocks(self):
        return [(self.pattern[o] * self.variance[o, None]).T @ self.pattern[o] for o in (~self.odd, self.odd)]

    def left(self, blocks):
        """Returns the variance in each cell that the modes leave."""
        return np.maximum((np.diag(blocks[0]) + np.diag(blocks[1])) / 2 -
                          (self.variance[:, None] * self.pattern**2).sum(axis=0) / 2, 0)


class Population:
    def __init__(self, mean):
        self.mean = mean
        self.at = np.flatnonzero((CELL < MIRROR) & ~np.isnan(mean))
        used = ~np.isnan(mean)
        # Gaps, at right angles to the surface, by six motions: by a rotation of 2 mm at a lever of
        # POSE_LEVER_MM (core/measure/pose.h) about x, y, z, and by shifts of 2 mm.
        lever = 80.0
        zx, zy = (s.astype(float) for s in slopes(mean))
        z = mean.astype(float) + lever
        nz = 1 / np.sqrt(1 + zx * zx + zy * zy)
        nx, ny = -zx * nz, -zy * nz
        motion = np.stack([2 * (Y * nz - z * ny) / lever, 2 * (z * nx - X * nz) / lever,
                           2 * (X * ny - Y * nx) / lever, 2 * nx, 2 * ny, 2 * nz])
        motion = np.where(used, motion, 0).astype(np.float32)
        self.normal_z = motion[5] / np.float32(2)
        even, odd = self.split(motion)
        self.motion = even[[0, 4, 5]], odd[[1, 2, 3]]  # which are symmetric; the others antisymmetric

    def split(self, gaps):
        a, b = (np.nan_to_num(gaps[..., at].astype(float), nan=0) for at in (self.at, MIRROR[self.at]))
        return (a + b) * math.sqrt(0.5), (a - b) * math.sqrt(0.5)

    def spread(self, gaps, most):
        return self.still([part.T @ part / len(gaps) for part in self.split(np.clip(gaps, -most, most))])

    def still(self, blocks):
        """Returns the blocks without what varies as if the mean face moved."""
        out = []
        for block, motion in zip(blocks, self.motion):
            q = np.linalg.qr(motion.T)[0]
            rest = np.eye(len(q)) - q @ q.T
            out.append(rest @ block @ rest)
        return out

    def field(self, mm, length_mm, share=np.ones(NX * NY)):
        """Returns the covariance of a smooth random field of this deviation and length."""
        def near(b):
            square = (X[self.at, None] - X[None, b])**2 + (Y[self.at, None] - Y[None, b])**2
            return np.exp(-square / length_mm**2 / 2) * mm**2 * share[self.at, None] * share[None, self.at]

        return near(self.at) + near(MIRROR[self.at]), near(self.at) - near(MIRROR[self.at])

    def gaps(self, modes):
        """Returns the modes, times their deviations, as gaps of all cells."""
        v = (np.sqrt(modes.variance * 0.5)[:, None] * modes.pattern).astype(np.float32)
        out = np.zeros((len(v), NX * NY), np.float32)
        out[:, self.at] = v
        out[:, MIRROR[self.at]] = np.where(modes.odd[:, None], -v, v)
        return out

    def rest(self, variance):
        out = np.zeros(NX * NY, np.float32)
        out[self.at] = out[MIRROR[self.at]] = np.maximum(np.sqrt(variance), LEAST_MM)
        return out


def add(*terms):
    """Returns the sum of pairs of blocks."""
    return [sum(t[b] for t in terms) for b in (0, 1)]


def times(by, blocks):
    return [by * b for b in blocks]


def tissue():
    """Returns how deep soft tissue lies, 0 to 1: on the lower face, less above the lower lids and on the
    nose."""
    up = (Y - 8) / 12
    above = (1 + up / np.sqrt(1 + up * up)) / 2
    nose = (np.abs(X) < 18) & (Y > -12) & (Y < 34)
    return np.where(nose, CHANGE_BONE_SHARE, 1 - (1 - CHANGE_BONE_SHARE) * above)


def learn(people, expressions):
    """Yields the model's parts: the mean face, then rest and modes of change, identity and shape."""
    p = Population(mean_face(people))
    person = p.spread((people - p.mean) * p.normal_z, FARTHEST_PERSON_MM)
    expression = p.spread(expressions * p.normal_z, FARTHEST_EXPRESSION_MM)

    b = p.still(add(times(CHANGE_FACTOR, expression), p.field(*CHANGE_TISSUE, tissue()), p.field(*CHANGE_FIELD)))
    change = Modes(b, CHANGE_MODES)
    left = change.left(b)
    yield p.mean
    yield p.rest(left), p.gaps(change)

    # Identity against all that a scan shows besides: the modes that scans show best.
    b = p.still(add(times(IDENTITY_SHARE, person), p.field(*IDENTITY_FIELD)))
    noise = add(change.blocks(), [np.diag(left + NOISE_MM**2)] * 2, [m.T @ m for m in p.motion])
    root = [np.linalg.cholesky(n) for n in noise]
    over = [np.linalg.inv(r) for r in root]
    identity = Modes([o @ s @ o.T for o, s in zip(over, b)], IDENTITY_MODES)
    identity.pattern = np.stack([root[int(odd)] @ v for odd, v in zip(identity.odd, identity.pattern)])
    yield None, p.gaps(identity)

    b = add(p.still(p.field(*SHAPE_FIELD)), times(SHAPE_IDENTITY, Modes(person, SHAPE_PEOPLE).blocks()),
            Modes(expression, SHAPE_EXPRESSIONS).blocks())
    shape = Modes(b, SHAPE_MODES)
    over = np.divide(1, p.normal_z, out=np.zeros_like(p.normal_z), where=p.normal_z > 0)  # gaps to heights
    yield p.rest(shape.left(b) + SHAPE_MM**2) * over, p.gaps(shape) * over


# ---- the file


def table(word, values, units):
    words = ["." if math.isnan(v) else str(int(v)) for v in np.rint(values.astype(float) * units)]
    return [word] + [" ".join(words[i:i + NX]) for i in range(0, NX * NY, NX)]


def model_text(head, mean, *parts):
    lines = head + table("mean", mean, 1000)
    for word, (rest, modes) in zip(("change", "identity", "shape"), parts):
        lines.append("%s %d" % (word, len(modes)))
        if rest is not None:
            lines += table("rest", rest, 10000)
        for mode in modes:
            lines += table("mode", mode, 1000)
    return "\n".join(lines + ["end", ""])


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit("usage: rebuild.py FaceXModel BASE.model NEW.model")
    with open(sys.argv[2], encoding="ascii") as base:
        old = base.read().splitlines()
    FACES = Faces(sys.argv[1])
    with multiprocessing.get_context("fork").Pool() as pool:
        rendered = [np.array(pool.map(render, range(n), chunksize=20))
                    for render, n in ((render_person, PEOPLE), (render_expression, EXPRESSIONS))]
    text = model_text(old[:old.index("mean")], *learn(*rendered))
    with open(sys.argv[3], "w", encoding="ascii") as new:
        new.write(text)
