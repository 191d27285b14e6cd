/* eval: how well the comparison tells people apart, and how well it finds the pose.
 * usage: eval [--per-probe N] [--table] DIR
 * DIR holds index.csv (one line a scan: file, id, kind, ..., the pose applied) and
 * subjects.csv (id, ..., relative_of) beside the scans.  Every probe is compared with its
 * own subject's `enroll` scan and with N others' of its population (default: all), close
 * relatives counted apart.  --table prints the false match rate's quantiles, from which
 * core/decision.c is made. */
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "align_pose.h"
#include "cloudfile.h"
#include "face.h"
#include "mem.h"
#include "model.h"

#define MAX_SCANS  4096
#define MAX_FIELDS 24
#define KINDS      4

static const double pi = 3.14159265358979323846;
static const char *const kind_names[KINDS] = {"p1", "p2", "p3", "p4"};

struct scan {
    char file[64], id[32];
    int kind; /* of kind_names, or -1: enroll */
    double yaw, pitch, roll, shift[3];
    struct face face;
    bool built;
    int enrolled;   /* index of the subject's enroll scan */
    int population; /* index in subjects.csv order is not kept: only equality counts */
    char relative[32];
};

/* One comparison's outcome. */
struct score {
    double mm;
    int kind, probe;
    enum face_decision decision;
};

struct scores {
    struct score *at;
    size_t n, cap;
};

static struct scan scans[MAX_SCANS];
static int nscans;
static struct scores genuine, impostor, relative;
static double pose_error[KINDS][MAX_SCANS], align_ms[KINDS][MAX_SCANS];
static double measure_ms[KINDS][MAX_SCANS], exact_count[KINDS], overlap[KINDS][MAX_SCANS];
static int npose[KINDS], first_rank[KINDS], ranked[KINDS];

static void die(const char *what, const char *which)
{
    fprintf(stderr, "eval: %s %s\n", what, which);
    exit(2);
}

static double clock_ms(void)
{
    struct timespec t;

    (void)clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}

/* split(line, field): cut at the commas; returns how many fields there are. */
static int split(char *line, char *field[MAX_FIELDS])
{
    int n = 0;

    line[strcspn(line, "\r\n")] = '\0';
    while (n < MAX_FIELDS) {
        char *comma = strchr(line, ',');

        field[n++] = line;
        if (comma == NULL)
            break;
        *comma = '\0';
        line = comma + 1;
    }
    return n;
}

static int column(char *const *field, int n, const char *name)
{
    for (int i = 0; i < n; i++)
        if (strcmp(field[i], name) == 0)
            return i;
    return -1;
}

static void copy(char *to, size_t size, const char *from)
{
    if (strlen(from) >= size)
        die("name too long:", from);
    memcpy(to, from, strlen(from) + 1);
}

static FILE *open_in(const char *dir, const char *name)
{
    char path[512];
    FILE *f;

    (void)snprintf(path, sizeof path, "%s/%s", dir, name);
    if ((f = fopen(path, "rb")) == NULL)
        die("cannot read", path);
    return f;
}

static void read_index(const char *dir)
{
    FILE *f = open_in(dir, "index.csv");
    char line[512], *v[MAX_FIELDS];

    if (fgets(line, sizeof line, f) == NULL)
        die("empty index in", dir);
    while (fgets(line, sizeof line, f) != NULL && nscans < MAX_SCANS) {
        struct scan *s = &scans[nscans];

        if (split(line, v) < 10)
            die("short line for", v[0]);
        copy(s->file, sizeof s->file, v[0]);
        copy(s->id, sizeof s->id, v[1]);
        s->kind = -1;
        for (int k = 0; k < KINDS; k++)
            if (strcmp(v[2], kind_names[k]) == 0)
                s->kind = k;
        s->yaw = strtod(v[4], NULL);
        s->pitch = strtod(v[5], NULL);
        s->roll = strtod(v[6], NULL);
        for (int i = 0; i < 3; i++)
            s->shift[i] = strtod(v[7 + i], NULL);
        nscans++;
    }
    (void)fclose(f);
    for (int i = 0; i < nscans; i++) {
        scans[i].enrolled = -1;
        for (int k = 0; k < nscans; k++)
            if (scans[k].kind < 0 && strcmp(scans[k].id, scans[i].id) == 0)
                scans[i].enrolled = k;
    }
}

static void read_subjects(const char *dir)
{
    FILE *f = open_in(dir, "subjects.csv");
    char line[512], *v[MAX_FIELDS];
    int n, population, relative_of;

    if (fgets(line, sizeof line, f) == NULL)
        die("empty subjects in", dir);
    n = split(line, v);
    population = column(v, n, "population");
    relative_of = column(v, n, "relative_of");
    while (fgets(line, sizeof line, f) != NULL) {
        n = split(line, v);
        for (int i = 0; i < nscans; i++) {
            if (strcmp(scans[i].id, v[0]) != 0)
                continue;
            if (population >= 0 && population < n)
                scans[i].population = atoi(v[population]);
            if (relative_of >= 0 && relative_of < n)
                copy(scans[i].relative, sizeof scans[i].relative, v[relative_of]);
        }
    }
    (void)fclose(f);
}

static void build_faces(const char *dir, struct face_work *w)
{
    static unsigned char bytes[1 << 22];

    for (int i = 0; i < nscans; i++) {
        FILE *f = open_in(dir, scans[i].file);
        const size_t len = fread(bytes, 1, sizeof bytes, f);
        struct dvec3 *pts = NULL;
        size_t n = 0;
        enum status st;

        (void)fclose(f);
        st = cloudfile_parse(bytes, len, CLOUDFILE_ANY, FACE_MAX_POINTS, &pts, &n, NULL);
        if (st == ST_OK)
            st = face_build(pts, n, w, &scans[i].face, NULL);
        mem_free(pts);
        scans[i].built = st == ST_OK;
        if (st != ST_OK)
            printf("refused: %s: %s\n", scans[i].file, status_message(st));
    }
}

/* rotation(s, r): the pose applied to a scan, Rz Rx Ry. */
static void rotation(const struct scan *s, double r[9])
{
    const double y = s->yaw * pi / 180, x = s->pitch * pi / 180, z = s->roll * pi / 180;
    const double cy = cos(y), sy = sin(y), cx = cos(x), sx = sin(x), cz = cos(z),
                 sz = sin(z);
    const double m[9] = {cz * cy - sz * sx * sy,
                         -sz * cx,
                         cz * sy + sz * sx * cy,
                         sz * cy + cz * sx * sy,
                         cz * cx,
                         sz * sy - cz * sx * cy,
                         -cx * sy,
                         sx,
                         cx * cy};

    memcpy(r, m, sizeof m);
}

/* angle(probe, enroll, transform): degrees between the rotation found and the true one. */
static double angle(const struct scan *probe, const struct scan *enroll,
                    const double transform[16])
{
    double p[9], e[9], trace = 0;

    rotation(probe, p);
    rotation(enroll, e);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            for (int k = 0; k < 3; k++)
                trace += transform[4 * i + j] * e[3 * i + k] * p[3 * j + k];
    trace = (trace - 1) / 2;
    return acos(trace > 1 ? 1 : trace) * 180 / pi;
}

static void add(struct scores *s, struct score x)
{
    if (s->n == s->cap) {
        s->cap = s->cap > 0 ? 2 * s->cap : 4096;
        if ((s->at = realloc(s->at, s->cap * sizeof *s->at)) == NULL)
            die("out of", "memory");
    }
    s->at[s->n++] = x;
}

/* compare(e, p, w, out): how the comparison of enroll scan e and probe p came out; a
 * probe that cannot be compared scores worst. */
static struct score compare(int e, int p, struct face_work *w, struct face_result *out)
{
    struct score s = {INFINITY, scans[p].kind, p, FACE_INCONCLUSIVE};

    memset(out, 0, sizeof *out);
    if (!scans[e].built || !scans[p].built)
        return s;
    if (face_compare(&scans[e].face, &scans[p].face, 0, clock_ms, w, out) != ST_OK)
        die("comparison failed:", scans[p].file);
    s.decision = out->decision;
    if (out->decision != FACE_INCONCLUSIVE)
        s.mm = out->disparity_mm;
    return s;
}

static bool related(const struct scan *a, const struct scan *b)
{
    return strcmp(a->relative, b->id) == 0 || strcmp(b->relative, a->id) == 0;
}

static void run_probe(int p, int per_probe, struct face_work *w)
{
    const int k = scans[p].kind, e = scans[p].enrolled;
    struct face_result r;
    struct score own = compare(e, p, w, &r);
    int others = 0, seen = 0, better = 0;

    add(&genuine, own);
    if (r.disparity_mm > 0) {
        pose_error[k][npose[k]] = angle(&scans[p], &scans[e], r.align.transform);
        align_ms[k][npose[k]] = r.align_ms;
        overlap[k][npose[k]] =
            r.measure.overlap < r.weight_overlap ? r.measure.overlap : r.weight_overlap;
        measure_ms[k][npose[k]++] = r.measure_ms;
        exact_count[k] += r.align.exact;
    }
    for (int i = 0; i < nscans; i++)
        others +=
            scans[i].kind < 0 && i != e && scans[i].population == scans[p].population;
    for (int i = 0; i < nscans; i++) {
        struct score s;

        if (scans[i].kind >= 0 || i == e || scans[i].population != scans[p].population)
            continue;
        /* every others/per_probe-th, beginning at a place that changes with the probe */
        if (per_probe < others && (seen++ + p) % (1 + (others - 1) / per_probe) != 0)
            continue;
        s = compare(i, p, w, &r);
        add(related(&scans[i], &scans[p]) ? &relative : &impostor, s);
        better += s.mm <= own.mm;
    }
    ranked[k]++;
    first_rank[k] += better == 0 && own.mm < INFINITY;
}

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;

    return x < y ? -1 : x > y;
}

static int by_mm(const void *a, const void *b)
{
    const struct score *x = a, *y = b;

    return x->mm < y->mm ? -1 : x->mm > y->mm;
}

/* accepted(s, kind, mm): the share of the scores of a kind (-1: all) at or below mm. */
static double accepted(const struct scores *s, int kind, double mm)
{
    size_t n = 0, yes = 0;

    for (size_t i = 0; i < s->n; i++) {
        if (kind >= 0 && s->at[i].kind != kind)
            continue;
        n++;
        yes += s->at[i].mm <= mm;
    }
    return n > 0 ? (double)yes / (double)n : 0;
}

/* quantile(fmr): the largest disparity at which at most that share of the impostors is
 * accepted. */
static double quantile(double fmr)
{
    const size_t k = (size_t)floor(fmr * (double)impostor.n);

    return k == 0 ? 0 : impostor.at[k - 1].mm;
}

/* equal_error(kind): where as many impostors of all kinds are accepted as genuine probes
 * of this kind are refused. */
static double equal_error(int kind)
{
    double best = 1;

    for (size_t i = 0; i < impostor.n; i++) {
        const double fmr = (double)(i + 1) / (double)impostor.n;
        const double frr = 1 - accepted(&genuine, kind, impostor.at[i].mm);
        const double worse = fmr > frr ? fmr : frr;

        if (worse < best)
            best = worse;
        if (fmr > frr)
            break;
    }
    return best;
}

static double value_at(double *v, int n, double share)
{
    qsort(v, (size_t)n, sizeof *v, by_value);
    return n > 0 ? v[(int)(share * (n - 1))] : 0;
}

static void report(void)
{
    const double at_01 = quantile(0.001), at_1 = quantile(0.01);
    const char *const names[KINDS + 1] = {"p1", "p2", "p3", "p4", "all"};

    printf("\npose: rotation error against the truth, and time of one comparison\n");
    printf(
        "kind     n  median deg  90 %% deg  > 3 deg  align ms  finish ms  exact  least overlap\n");
    for (int k = 0; k < KINDS; k++) {
        const int n = npose[k];
        const double mid = value_at(pose_error[k], n, 0.5);
        int beyond = 0;

        for (int i = 0; i < n; i++)
            beyond += pose_error[k][i] > 3;
        printf("%-4s %5d  %10.2f  %8.2f  %7d  %8.2f  %9.2f  %5.2f  %13.2f\n", names[k], n,
               mid, value_at(pose_error[k], n, 0.9), beyond,
               value_at(align_ms[k], n, 0.5), value_at(measure_ms[k], n, 0.5),
               n > 0 ? exact_count[k] / n : 0, value_at(overlap[k], n, 0));
    }
    printf(
        "\n%zu genuine, %zu impostor comparisons; threshold %.4f mm accepts %.3f %% of "
        "the impostors\n",
        genuine.n, impostor.n, model_default.decision.threshold_mm,
        100 * accepted(&impostor, -1, model_default.decision.threshold_mm));
    printf("at FMR 0.1 %%: %.4f mm; at 1 %%: %.4f mm\n", at_01, at_1);
    printf(
        "kind   EER %%  TAR %% at FMR 0.1 %%  at 1 %%  at the threshold  first rank %%\n");
    for (int i = 0; i <= KINDS; i++) {
        const int k = i < KINDS ? i : -1;
        int r = 0, f = 0;

        for (int j = 0; j < KINDS; j++) {
            r += k < 0 || j == k ? ranked[j] : 0;
            f += k < 0 || j == k ? first_rank[j] : 0;
        }
        printf("%-4s  %6.2f  %18.1f  %7.1f  %16.1f  %12.1f\n", names[i],
               100 * equal_error(k), 100 * accepted(&genuine, k, at_01),
               100 * accepted(&genuine, k, at_1),
               100 * accepted(&genuine, k, model_default.decision.threshold_mm),
               r > 0 ? 100.0 * f / r : 0);
    }
    printf("close relatives: %zu comparisons, %.1f %% accepted at the threshold\n",
           relative.n,
           100 * accepted(&relative, -1, model_default.decision.threshold_mm));
}

static void print_table(void)
{
    static const double rate[] = {0.0002, 0.0005, 0.001, 0.002, 0.005, 0.01, 0.02,
                                  0.05,   0.1,    0.2,   0.5,   0.8,   0.95};

    printf("\nfalse match rate and the disparity that gives it\n");
    for (size_t i = 0; i < sizeof rate / sizeof *rate; i++)
        if (rate[i] * (double)impostor.n >= 5)
            printf("    {%.4f, %g},\n", quantile(rate[i]), rate[i]);
}

int main(int argc, char **argv)
{
    int per_probe = MAX_SCANS, arg = 1;
    bool table = false;
    struct face_work *w;

    for (; arg < argc && argv[arg][0] == '-'; arg++) {
        if (strcmp(argv[arg], "--table") == 0)
            table = true;
        else if (strcmp(argv[arg], "--per-probe") == 0 && arg + 1 < argc)
            per_probe = atoi(argv[++arg]);
        else
            die("unknown option", argv[arg]);
    }
    if (arg + 1 != argc || per_probe < 1)
        die("usage:", "eval [--per-probe N] [--table] DIR");
    if ((w = face_work_new(NULL)) == NULL)
        die("out of", "memory");
    read_index(argv[arg]);
    read_subjects(argv[arg]);
    build_faces(argv[arg], w);
    for (int p = 0; p < nscans; p++)
        if (scans[p].kind >= 0 && scans[p].enrolled >= 0)
            run_probe(p, per_probe, w);
    qsort(impostor.at, impostor.n, sizeof *impostor.at, by_mm);
    report();
    if (table)
        print_table();
    for (int i = 0; i < nscans; i++)
        face_free(&scans[i].face);
    free(genuine.at);
    free(impostor.at);
    free(relative.at);
    face_work_free(w);
    return 0;
}
