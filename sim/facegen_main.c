/* facegen -- write a simulated scan of a made-up face to a file. */
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "facegen.h"
#include "outfile.h"

static const char usage[] =
    "usage: facegen [OPTION]... [-o FILE]\n"
    "Write a simulated scan of a made-up face in millimetres.\n"
    "  --subject N    whose face (0)\n"
    "  --scan N       which scan: sampling, noise, outline, holes (0)\n"
    "  --points N     points sampled, 100 to 1000000 (3000)\n"
    "  --pose D       yaw, pitch and roll at random within +-D degrees\n"
    "  --shift MM     and moved at random within +-MM along each axis\n"
    "  --yaw D  --pitch D  --roll D  --tx MM\n"
    "                 instead of --pose and --shift: each value given (0)\n"
    "  --noise MM     white noise (0.12)\n"
    "  --warp MM      smooth depth error, root mean square (0.15)\n"
    "  --holes S      share of the points cut out in blobs, 0 to 0.9 (0)\n"
    "  --spikes S     share of the points thrown 4 to 40 mm off, 0 to 0.5 (0)\n"
    "  --smile S      0 to 1 (0)\n"
    "  --symmetry S   share of the face's asymmetry taken away, -2 to 1 (0)\n"
    "  --format F     ply (binary), xyz, json; else by FILE's ending\n"
    "  -o FILE        where to (-: standard output); a file that exists is replaced\n"
    "  --count N      of N subjects, from --subject on; % in FILE is each one's number\n";

enum format { PLY, XYZ, JSON, FORMATS };
static const char *const format_names[FORMATS] = {"ply", "xyz", "json"};

struct options {
    struct facegen_scan scan;
    double subject, number, points, pose, shift, count;
    int format; /* FORMATS: by the file's ending */
    const char *file;
};

struct number_option {
    const char *name;
    double *value, low, high;
};

static int bad(const char *what, const char *which)
{
    (void)fprintf(stderr, "facegen: %s%s\n%s", what, which, usage);
    return 2;
}

/* Returns 0, or 2 after saying what is wrong; -1 for --help. */
static int read_options(int argc, char **argv, struct options *o)
{
    struct facegen_scan *s = &o->scan;
    const struct number_option numbers[] = {
        {"--subject", &o->subject, 0, 9e15}, {"--scan", &o->number, 0, 9e15},
        {"--points", &o->points, 100, 1e6},  {"--pose", &o->pose, 0, 45},
        {"--shift", &o->shift, 0, 1000},     {"--yaw", &s->yaw, -60, 60},
        {"--pitch", &s->pitch, -60, 60},     {"--roll", &s->roll, -180, 180},
        {"--tx", &s->tx, -1e4, 1e4},         {"--noise", &s->noise, 0, 10},
        {"--warp", &s->warp, 0, 10},         {"--holes", &s->holes, 0, 0.9},
        {"--spikes", &s->spikes, 0, 0.5},    {"--smile", &s->smile, 0, 1},
        {"--symmetry", &s->symmetry, -2, 1}, {"--count", &o->count, 0, 1e7},
    };
    const size_t count = sizeof numbers / sizeof *numbers;

    for (int i = 1; i < argc; i += 2) {
        size_t k = 0;
        char *end;

        if (strcmp(argv[i], "--help") == 0)
            return -1;
        while (k < count && strcmp(argv[i], numbers[k].name) != 0)
            k++;
        if (k == count && strcmp(argv[i], "-o") != 0 && strcmp(argv[i], "--format") != 0)
            return bad("unknown option ", argv[i]);
        if (i + 1 == argc)
            return bad("a value is missing after ", argv[i]);
        if (k < count) {
            *numbers[k].value = strtod(argv[i + 1], &end);
            if (end == argv[i + 1] || *end != 0 ||
                !(*numbers[k].value >= numbers[k].low &&
                  *numbers[k].value <= numbers[k].high))
                return bad("bad value of ", argv[i]);
        } else if (strcmp(argv[i], "-o") == 0) {
            o->file = argv[i + 1];
        } else {
            for (o->format = 0; o->format < FORMATS; o->format++)
                if (strcmp(argv[i + 1], format_names[o->format]) == 0)
                    break;
            if (o->format == FORMATS)
                return bad("unknown format ", argv[i + 1]);
        }
    }
    if (o->count > 0 && (o->file == NULL || strchr(o->file, '%') == NULL))
        return bad("--count needs -o with a %", "");
    return 0;
}

static int format_of(const char *file)
{
    const char *dot = file != NULL ? strrchr(file, '.') : NULL;

    for (int f = 0; dot != NULL && f < FORMATS; f++)
        if (strcmp(dot + 1, format_names[f]) == 0)
            return f;
    return PLY;
}

/* Four bytes, the lowest first, on any machine. */
static void put_float(FILE *out, double value)
{
    const float f = (float)value;
    uint32_t bits;
    unsigned char bytes[4];

    memcpy(&bits, &f, sizeof bits);
    for (int i = 0; i < 4; i++)
        bytes[i] = (unsigned char)(bits >> (8 * i));
    (void)fwrite(bytes, 1, 4, out);
}

static void write_points(FILE *out, int format, const struct dvec3 *p, size_t n)
{
    if (format == PLY)
        (void)fprintf(out,
                      "ply\nformat binary_little_endian 1.0\ncomment a made-up face\n"
                      "element vertex %zu\nproperty float x\nproperty float y\n"
                      "property float z\nend_header\n",
                      n);
    else if (format == JSON)
        (void)fputs("{\"units\": \"mm\", \"points\": [", out);
    for (size_t i = 0; i < n; i++) {
        if (format == PLY) {
            put_float(out, p[i].x);
            put_float(out, p[i].y);
            put_float(out, p[i].z);
        } else if (format == JSON) {
            (void)fprintf(out, "%s[%.4f,%.4f,%.4f]", i != 0 ? ",\n" : "\n", p[i].x,
                          p[i].y, p[i].z);
        } else {
            (void)fprintf(out, "%.4f %.4f %.4f\n", p[i].x, p[i].y, p[i].z);
        }
    }
    if (format == JSON)
        (void)fputs("\n]}\n", out);
}

static int write_file(const struct options *o, const char *file, const struct dvec3 *p,
                      size_t n)
{
    FILE *out = file != NULL && strcmp(file, "-") != 0 ? fopen(file, "wb") : stdout;
    bool failed;

    if (out == NULL) {
        (void)fprintf(stderr, "facegen: %s: %s\n", file, strerror(errno));
        return 1;
    }
    write_points(out, o->format != FORMATS ? o->format : format_of(file), p, n);
    failed = ferror(out) != 0;
    failed |= fclose(out) != 0;
    if (failed)
        (void)fprintf(stderr, "facegen: the scan could not be written\n");
    return failed;
}

/* One subject's scan into the file; points: room for it. */
static int make_scan(const struct options *o, uint64_t subject, const char *file,
                     struct dvec3 *points)
{
    struct facegen_scan scan = o->scan;
    size_t n;

    scan.subject = subject;
    if (o->pose >= 0 || o->shift > 0)
        facegen_pose(&scan, o->pose > 0 ? o->pose : 0, o->shift);
    if ((n = facegen_sample(&scan, points)) != 0)
        return write_file(o, file, points, n);
    (void)fputs("facegen: no face to be seen in this pose\n", stderr);
    return 1;
}

static int make_scans(const struct options *o, struct dvec3 *points)
{
    const uint64_t first = (uint64_t)o->subject, end = first + (uint64_t)o->count;
    char file[FILENAME_MAX];
    int rc = 0;

    if (o->count == 0)
        return make_scan(o, first, o->file, points);
    for (uint64_t s = first; s < end && rc == 0; s++) {
        const char *mark = strchr(o->file, '%');

        if (snprintf(file, sizeof file, "%.*s%" PRIu64 "%s", (int)(mark - o->file),
                     o->file, s, mark + 1) >= (int)sizeof file)
            return bad("too long: ", o->file);
        rc = make_scan(o, s, file, points);
    }
    return rc;
}

int main(int argc, char **argv)
{
    struct options o = {.points = 3000, .pose = -1, .shift = 0, .format = FORMATS};
    struct dvec3 *points;
    int rc;

    facegen_default(&o.scan);
    if ((rc = read_options(argc, argv, &o)) > 0)
        return rc;
    if (rc < 0) {
        (void)fputs(usage, stdout);
        return outfile_flush(stdout) ? 0 : 1;
    }
    o.scan.scan = (uint64_t)o.number;
    o.scan.points = (uint32_t)o.points;
    if ((points = malloc(o.scan.points * sizeof *points)) == NULL) {
        (void)fputs("facegen: out of memory\n", stderr);
        return 1;
    }
    rc = make_scans(&o, points);
    free(points);
    return rc;
}
