"""memory.py PID FILE...: how many points of the scans, binary PLY of float32 as facegen writes them,
are in the process's memory: as three float32, three doubles, or x and y of an int32 lattice in um.
Prints the number of each kind."""
import re
import struct
import sys

MOST = 3000  # points of a scan; of more, some would be found by chance
FORMS = ("float32", "double", "lattice")


def points(path):
    with open(path, "rb") as f:
        data = f.read()
    at = data.index(b"end_header\n") + len(b"end_header\n")
    n = int(re.search(rb"element vertex (\d+)", data).group(1))
    return [struct.unpack_from("<3f", data, at + 12 * i) for i in range(0, n, max(1, n // MOST))]


def needles(xyz):
    yield struct.pack("<3f", *xyz)
    yield struct.pack("<3d", *xyz)
    yield struct.pack("<2i", *(round(1000 * v) for v in xyz[:2]))


def memory(pid):
    with open("/proc/%s/maps" % pid) as maps, open("/proc/%s/mem" % pid, "rb", 0) as mem:
        for line in maps:
            span, rights = line.split()[:2]
            if not rights.startswith("rw"):
                continue
            start, end = (int(x, 16) for x in span.split("-"))
            try:
                mem.seek(start)
                yield mem.read(end - start)
            except OSError:
                pass


def main():
    wanted, firsts = {}, set()
    for path in sys.argv[2:]:
        for xyz in points(path):
            for form, bytes_ in zip(FORMS, needles(xyz)):
                wanted[bytes_] = form
                firsts.add(struct.unpack_from("<I", bytes_)[0])
    found = {form: set() for form in FORMS}
    for block in memory(sys.argv[1]):
        words = memoryview(block).cast("I")
        for at in [i for i, word in enumerate(words) if word in firsts]:
            for length in (8, 12, 24):
                bytes_ = block[4 * at:4 * at + length]
                if bytes_ in wanted:
                    found[wanted[bytes_]].add(bytes_)
    print(" ".join(str(len(found[form])) for form in FORMS))


main()
