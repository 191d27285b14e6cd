"""formats.py MESH.ply FOLDER: the vertices and triangles of an ascii PLY file, in every format
that is read and in its dialects.  A file's name ends with the media type's short name:
NAME.TYPE, or NAME.TYPE.gz."""
import gzip
import json
import math
import os
import struct
import sys
import zlib

out = sys.argv[2]
lines = open(sys.argv[1]).read().split("\n")
nv = int([x for x in lines if x.startswith("element vertex")][0].split()[2])
body = lines[lines.index("end_header") + 1:]
V = [tuple(map(float, x.split()[:3])) for x in body[:nv]]
F = [tuple(map(int, x.split()[1:4])) for x in body[nv:] if x]


def write(name, data):
    if isinstance(data, str):
        data = data.encode()
    with open(os.path.join(out, name), "wb") as f:
        f.write(data)


def rows(points, form="%.6f %.6f %.6f\n"):
    return "".join(form % p for p in points)


# ---- PLY
def ply(kind, order, types, faces=False, extra="", eol="\n"):
    head = ["ply", "format %s 1.0" % kind, "comment by hand", "obj_info made", "element vertex %d" % nv]
    head += ["property %s %s" % p for p in zip(types, order)]
    head += [extra] if extra else []
    if faces:
        head += ["element face %d" % len(F), "property list uchar int vertex_indices"]
    return (eol.join(head + ["end_header"]) + eol).encode()


def packed(big, order, types, extra=b""):
    code = {"float": "f", "double": "d", "short": "h"}
    form = (">" if big else "<") + "".join(code[t] for t in types)
    return b"".join(struct.pack(form, *[p["xyz".index(c)] for c in order]) + extra for p in V)


corners = "".join("3 %d %d %d\n" % f for f in F)
write("ascii.ply", ply("ascii", "xyz", ["float"] * 3) + rows(V).encode())
write("faces.ply", ply("ascii", "xyz", ["double"] * 3, True) + (rows(V) + corners).encode())
write("crlf.ply", ply("ascii", "xyz", ["float"] * 3, eol="\r\n") + rows(V).replace("\n", "\r\n").encode())
write("little.ply", ply("binary_little_endian", "xyz", ["float"] * 3) + packed(0, "xyz", ["float"] * 3))
write("big.ply", ply("binary_big_endian", "xyz", ["double"] * 3) + packed(1, "xyz", ["double"] * 3))
write("order.ply", ply("binary_big_endian", "zxy", ["float", "double", "float"], extra="property uchar red")
      + packed(1, "zxy", ["float", "double", "float"], b"\xff"))
write("mesh.ply", ply("binary_little_endian", "xyz", ["float"] * 3, True) + packed(0, "xyz", ["float"] * 3)
      + b"".join(struct.pack("<B3i", 3, *f) for f in F))
nan = "nan nan nan\n" * 40
write("nan.ply", ply("ascii", "xyz", ["float"] * 3).replace(b"%d" % nv, b"%d" % (nv + 80), 1)
      + (nan + rows(V) + nan).encode())
write("zeros.ply", ply("binary_little_endian", "xyz", ["float"] * 3).replace(b"%d" % nv, b"%d" % (nv + 50), 1)
      + packed(0, "xyz", ["float"] * 3) + bytes(600))

# ---- OBJ
v = rows(V, "v %.6f %.6f %.6f\n")
write("plain.obj", v)
write("faces.obj", "mtllib a.mtl\no face\n" + v + "vt 0 0\n" + "vn 0 0 1\n"
      + "".join("f %d/1/1 %d/1/1 %d/1/1\n" % tuple(i + 1 for i in f) for f in F))
write("negative.obj", v + "".join("f %d %d %d\n" % tuple(i - nv for i in f) for f in F))
write("color.obj", rows(V, "v  %.6f  %.6f  %.6f  0.5 0.5 0.5\r\n"))

# ---- STL
def stl(head):
    data = head.ljust(80, b" ") + struct.pack("<I", len(F))
    for f in F:
        data += struct.pack("<12fH", 0, 0, 0, *V[f[0]], *V[f[1]], *V[f[2]], 0)
    return data


write("binary.stl", stl(b"by hand"))
write("solid.stl", stl(b"solid, though binary"))
write("text.stl", "solid face\n" + "".join(
    "facet normal 0 0 0\n outer loop\n" + "".join("  vertex %.6e %.6e %.6e\n" % V[i] for i in f)
    + " endloop\nendfacet\n" for f in F) + "endsolid face\n")

# ---- PCD
def pcd(data, fields="x y z", width=nv, height=1):
    n = len(fields.split())
    return ("# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS %s\nSIZE %s\nTYPE %s\nCOUNT %s\n"
            "WIDTH %d\nHEIGHT %d\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS %d\nDATA %s\n"
            % (fields, "4 " * n, "F " * n, "1 " * n, width, height, width * height, data)).encode()


def lzf(raw):
    return b"".join(bytes([len(raw[i:i + 32]) - 1]) + raw[i:i + 32] for i in range(0, len(raw), 32))


soa = b"".join(struct.pack("<%df" % nv, *[p[k] for p in V]) for k in range(3))
write("ascii.pcd", pcd("ascii") + rows(V).encode())
write("binary.pcd", pcd("binary") + packed(0, "xyz", ["float"] * 3))
write("fields.pcd", pcd("binary", "rgb z x y") + b"".join(struct.pack("<4f", 7, p[2], p[0], p[1]) for p in V))
write("compressed.pcd", pcd("binary_compressed") + struct.pack("<II", len(lzf(soa)), len(soa)) + lzf(soa))
write("organised.pcd", pcd("binary", width=nv, height=2)
      + b"".join(struct.pack("<6f", *p, *([math.nan] * 3 if i % 2 else [0] * 3)) for i, p in enumerate(V)))

# ---- GLB, in metres
def glb(name, node, data, component, normalized=False):
    size = len(data) // nv // 3 * 3 // 3 * 3
    stride = len(data) // nv
    binary = data + b"\0" * (-len(data) % 4) + b"".join(struct.pack("<3I", *f) for f in F)
    at = len(binary) - 12 * len(F)
    doc = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
           "nodes": [{"children": [1], "translation": [0, 1.6, 0]}, dict(node, mesh=0)],
           "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
           "buffers": [{"byteLength": len(binary)}],
           "bufferViews": [{"buffer": 0, "byteLength": at, "byteStride": stride},
                           {"buffer": 0, "byteOffset": at, "byteLength": 12 * len(F)}],
           "accessors": [{"bufferView": 0, "componentType": component, "count": nv, "type": "VEC3",
                          "normalized": normalized},
                         {"bufferView": 1, "componentType": 5125, "count": 3 * len(F), "type": "SCALAR"}]}
    text = json.dumps(doc).encode()
    text += b" " * (-len(text) % 4)
    write(name, struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(binary)) + struct.pack("<I4s", len(text), b"JSON")
          + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary)


metres = [tuple(c / 1000 for c in p) for p in V]
glb("metres.glb", {}, b"".join(struct.pack("<3f", *p) for p in metres), 5126)
half = math.sqrt(0.5)
glb("turned.glb", {"rotation": [0, 0, half, half], "scale": [0.5] * 3},
    b"".join(struct.pack("<3f", 2 * p[1], -2 * p[0], 2 * p[2]) for p in metres), 5126)
mid = [(min(p[k] for p in metres) + max(p[k] for p in metres)) / 2 for k in range(3)]
glb("quantized.glb", {"translation": mid, "scale": [0.5] * 3},
    b"".join(struct.pack("<4h", *[round((p[k] - mid[k]) * 2 * 32767) for k in range(3)], 0) for p in metres),
    5122, True)

# ---- text
write("blanks.xyz", rows(V))
write("tabs.xyz", rows(V, "%.6f\t%.6f\t%.6f\n"))
write("commas.csv", rows(V, "%.6f,%.6f,%.6f\n"))
write("semicolons.csv", rows(V, "%.6f;%.6f;%.6f\n"))
write("heading.csv", "x,y,z\n" + rows(V, "%.6f,%.6f,%.6f\n"))
write("time.csv", "time,x,y,z\n" + "".join("%f,%f,%f,%f\n" % (i / 30, *p) for i, p in enumerate(V)))
write("quoted.csv", '"id";"Z";"Y";"X"\n' + "".join('"a %d";%f;%f;%f\n' % (i, *p[::-1]) for i, p in enumerate(V)))
write("inch.csv", "x (in),y (in),z (in)\n" + "".join("%.9f,%.9f,%.9f\n" % tuple(c / 25.4 for c in p) for p in V))
write("nan.csv", "x,y,z\nNaN,NaN,NaN\n" + rows(V, "%.6f,%.6f,%.6f\n") + "nan,inf,-inf\n")
write("colors.xyz", "//X Y Z R G B\n" + rows(V, "%.6f %.6f %.6f 200 150 120\n"))
write("comment.xyz", "# by a scanner\n\n" + rows(V))
write("crlf.xyz", rows(V, "%.6f %.6f %.6f\r\n"))
write("bom.csv", b"\xef\xbb\xbf" + ("x,y,z\n" + rows(V, "%.6f,%.6f,%.6f\n")).encode())
write("count.pts", "%d\n" % nv + rows(V, "%.6f %.6f %.6f -100 200 150 120\n"))
write("parts.pts", "%d\n%s%d\n%s" % (nv // 2, rows(V[:nv // 2]), nv - nv // 2, rows(V[nv // 2:])))

# ---- JSON
write("points.json", json.dumps({"points": V}))
write("metres.json", json.dumps({"units": "m", "points": metres}, indent=1))

# ---- VRML
def wrl(name, version, points, before="", after="", ccw=True):
    index = ", ".join("%d, %d, %d, -1" % (f if ccw else f[::-1]) for f in F)
    point = ",\n".join("%.6f %.6f %.6f" % p for p in points)
    if version == 1:
        write(name, "#VRML V1.0 ascii\nSeparator { %s\nDEF C Coordinate3 { point [ %s ] }\n"
              "TextureCoordinate2 { point [ 0 0, 1 1 ] }\nIndexedFaceSet { coordIndex [ %s ] } }\n"
              % (before, point, index))
    else:
        write(name, "#VRML V2.0 utf8\n# by hand\n%s DEF Face Shape { appearance Appearance { texture ImageTexture {"
              " url \"a.png\" } }\ngeometry IndexedFaceSet { %s coord Coordinate { point [ %s ] }\n"
              "coordIndex [ %s ] } } %s\n" % (before, "" if ccw else "ccw FALSE", point, index, after))


wrl("old.wrl", 1, V)
wrl("hints.wrl", 1, V, "ShapeHints { vertexOrdering CLOCKWISE } Scale { scaleFactor 1 1 1 }", ccw=False)
wrl("new.wrl", 2, V)
wrl("moved.wrl", 2, [(2 * p[1] - 2, -2 * p[0], 2 * p[2]) for p in V],
    "Transform { translation 0 1 0 rotation 0 0 1 1.5707963267948966 scale 0.5 0.5 0.5 children [", "] }", False)

# ---- BNT: a grid with places that have no value
ROWS, COLUMNS = -(-nv // 50) + 1, 50
grid = [p if p else (-1e9, -1e9, -1e9) for p in V + [None] * (ROWS * COLUMNS - nv)]
write("grid.bnt", struct.pack("<HHdH", ROWS, COLUMNS, -1e9, 5) + b"a.png" + struct.pack("<I", 5 * len(grid))
      + b"".join(struct.pack("<%dd" % len(grid), *[p[k] for p in grid]) for k in range(3)) + bytes(16 * len(grid)))


# ---- NPY
def npy(name, kind, shape, values, version=1, fortran=False):
    head = "{'descr': '%s', 'fortran_order': %s, 'shape': %s, }" % (kind, fortran, shape)
    size = 12 if version > 1 else 10
    head += " " * (-(size + len(head) + 1) % 64) + "\n"
    code = {"f4": "f", "f8": "d", "i4": "i", "u2": "H"}[kind[1:]]
    write(name, b"\x93NUMPY" + bytes([version, 0]) + struct.pack("<I" if version > 1 else "<H", len(head))
          + head.encode() + struct.pack("%s%d%s" % (kind[0], len(values), code), *values))


flat = [c for p in V for c in p]
columns = [p[k] for k in range(3) for p in V]
npy("rows.npy", "<f8", (nv, 3), flat)
npy("fortran.npy", ">f4", (nv, 3), columns, 2, True)
npy("columns.npy", "<f4", (3, nv), columns, 3)
npy("colors.npy", "<f4", (nv, 6), [c for p in V for c in p + (200, 150, 120)])
npy("micro.npy", "<i4", (nv, 3), [round(1000 * c) for c in flat])

# ---- a depth image: camera 600 mm in front of the face
W, H, FX, CX, CY = 240, 320, 600.0, 119.5, 159.5


def depth():
    """In mm; 0 where there is no face."""
    image = [0] * (W * H)
    z0 = sum(p[2] for p in V) / nv
    x0 = sum(p[0] for p in V) / nv
    y0 = sum(p[1] for p in V) / nv
    P = []
    for p in V:
        d = 600 - (p[2] - z0)
        P.append((CX + FX * (p[0] - x0) / d, CY - FX * (p[1] - y0) / d, d))
    for f in F:
        a, b, c = (P[i] for i in f)
        if max(math.dist(a[:2], b[:2]), math.dist(b[:2], c[:2]), math.dist(c[:2], a[:2])) > 12:
            continue
        area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
        if area == 0:
            continue
        for v in range(max(0, math.ceil(min(a[1], b[1], c[1]))), min(H - 1, int(max(a[1], b[1], c[1]))) + 1):
            for u in range(max(0, math.ceil(min(a[0], b[0], c[0]))), min(W - 1, int(max(a[0], b[0], c[0]))) + 1):
                s = ((u - a[0]) * (c[1] - a[1]) - (v - a[1]) * (c[0] - a[0])) / area
                t = ((b[0] - a[0]) * (v - a[1]) - (b[1] - a[1]) * (u - a[0])) / area
                if s >= 0 and t >= 0 and s + t <= 1:
                    image[v * W + u] = a[2] + s * (b[2] - a[2]) + t * (c[2] - a[2])
    return image


def png(name, w, h, bits, raw):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
    write(name, b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", w, h, bits, 0, 0, 0, 0))
          + chunk(b"IDAT", zlib.compress(raw)) + chunk(b"IEND", b""))


image = depth()
tenths = [round(10 * d) for d in image]
png("depth.png", W, H, 16, b"".join(b"\0" + struct.pack(">%dH" % W, *tenths[r * W:(r + 1) * W]) for r in range(H)))
write("five.pgm", b"P5\n# by hand\n%d %d\n65535\n" % (W, H) + struct.pack(">%dH" % (W * H), *tenths))
write("two.pgm", "P2\n%d %d\n9999\n" % (W, H) + "\n".join(map(str, tenths)) + "\n")
write("values.raw", struct.pack("<%dH" % (W * H), *tenths))
npy("depth.npy", "<u2", (H, W), tenths)
npy("floats.npy", ">f4", (H, W), [10 * image[v * W + u] for u in range(W) for v in range(H)], fortran=True)

os.mkdir(os.path.join(out, "metres"))
npy("metres/depth.npy", "<f4", (H, W), [d / 1000 for d in image])

# ---- the points that this camera sees, as a grid
seen = [((i % W - CX) * d / FX, (CY - i // W) * d / FX, -d) if d > 0 else None for i, d in enumerate(image)]
npy("image.npy", "<f4", (H, W, 3), [c for p in seen for c in p or [math.nan] * 3])
write("range.abs", "%d rows\n%d columns\npixels (flag X Y Z):\n" % (H, W)
      + " ".join("%d" % (p is not None) for p in seen) + "\n"
      + "".join(" ".join("%.6f" % (p[k] if p else -999999) for p in seen) + "\n" for k in range(3)))

# ---- compressed
for name in ("mesh.ply", "text.stl", "metres.glb", "time.csv", "points.json", "new.wrl", "grid.bnt", "range.abs",
             "rows.npy"):
    with open(os.path.join(out, name), "rb") as f:
        write(name + ".gz", gzip.compress(f.read()))

# ---- what is refused, in a folder of its own
out = os.path.join(out, "bad")
os.mkdir(out)
write("OFF", "OFF\n%d %d 0\n" % (nv, len(F)) + rows(V) + corners)
write("3MF", b"PK\x03\x04\x14\x00" + bytes(100))
write("FBX", b"Kaydara FBX Binary  \x00\x1a\x00" + bytes(100))
write("DAE", '<?xml version="1.0"?>\n<COLLADA></COLLADA>\n')
write("E57", b"ASTM-E57" + bytes(100))
write("LAS", b"LASF" + bytes(300))
write("PTX", "2\n2\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n" + rows(V))
png("bits", 4, 4, 8, (b"\0" + bytes(4)) * 4)
