/* digits -- print results of the whole library on simulated scans, to the last digit.  They must be those of
 * tests/golden/digits.txt, whatever the machine, the compiler and its optimisation (scripts/check_digits.sh).
 * After an intended change of the measure: build/digits > tests/golden/digits.txt, and raise the measure's
 * number in SURFACE_ENGINE. */
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "draw.h"
#include "facegen.h"
#include "headscan.h"
#include "libsurface.h"
#include "model.h"

#define POINTS 3000
#define FRAMES 3
#define PEOPLE 4
#define OTHERS 4000 /* made-up descriptors among theirs */

static struct surface_work *work;

/* wanted(st, what): The status must be SURFACE_OK. */
static void wanted(enum surface_status st, const char *what)
{
    if (st == SURFACE_OK)
        return;
    (void)fprintf(stderr, "digits: %s: %s\n", what, surface_message(st));
    exit(1);
}

/* ---- printing */

static void put(const char *what, const double *x, size_t n)
{
    printf("%s", what);
    for (size_t i = 0; i < n; i++)
        if (isnan(x[i])) /* printf() may print a sign */
            printf(" none");
        else
            printf(" %.17g", x[i]);
    printf("\n");
}

/* FNV-1a, 64 bits. */
static uint64_t digest(uint64_t h, uint64_t v, int bytes)
{
    for (int i = 0; i < bytes; i++)
        h = (h ^ (v >> 8 * i & 0xff)) * UINT64_C(0x100000001b3);
    return h;
}

static void put_bytes(const char *what, const void *bytes, size_t n)
{
    const unsigned char *p = bytes;
    uint64_t h = UINT64_C(0xcbf29ce484222325);

    for (size_t i = 0; i < n; i++)
        h = digest(h, p[i], 1);
    printf("%s %zu bytes %016" PRIx64 "\n", what, n, h);
}

static void put_doubles(const char *what, const double *x, size_t n)
{
    uint64_t h = UINT64_C(0xcbf29ce484222325), bits;

    for (size_t i = 0; i < n; i++) {
        memcpy(&bits, &x[i], sizeof bits);
        h = digest(h, isnan(x[i]) ? 1 : bits, 8);
    }
    printf("%s %zu numbers %016" PRIx64 "\n", what, n, h);
}

static void put_floats(const char *what, const float *x, size_t n)
{
    double *wide = malloc(n * sizeof *wide);

    if (wide == NULL)
        wanted(SURFACE_ENOMEM, what);
    for (size_t i = 0; i < n; i++)
        wide[i] = (double)x[i];
    put_doubles(what, wide, n);
    free(wide);
}

/* ---- scans */

/* Rounds the coordinates to steps, as the simulation has used the machine's own exp() and sin(). */
static void rounded(double (*at)[3], size_t n, double step)
{
    for (size_t i = 0; i < n; i++)
        for (int k = 0; k < 3; k++)
            at[i][k] = rint(at[i][k] / step) * step;
}

/* A frontal scan in mm.  Returns the number of points. */
static size_t frontal(uint64_t subject, uint64_t scan, double (*at)[3])
{
    struct dvec3 pts[POINTS];
    struct facegen_scan s;
    size_t n;

    facegen_default(&s);
    s.subject = subject;
    s.scan = scan;
    s.points = scan == 2 ? POINTS / 2 : POINTS;
    if (scan > 0)
        facegen_pose(&s, 12, 40);
    if (scan == 2) {
        s.holes = 0.1;
        s.spikes = 0.01;
        s.smile = 1;
    }
    n = facegen_sample(&s, pts);
    memcpy(at, pts, n * sizeof *at);
    rounded(at, n, 0x1p-10);
    return n;
}

static void build(uint64_t subject, uint64_t scan, struct surface_face **out)
{
    static double at[POINTS][3];
    const struct surface_cloud cloud = {.points = (const double(*)[3])at,
                                        .n = frontal(subject, scan, at),
                                        .flags = SURFACE_FRONTAL};

    wanted(surface_build(work, &cloud, out, NULL), "a frontal scan");
}

/* A head in any place, in a unit that is to be found. */
static void render(uint64_t subject, const char *kind, uint64_t seed, struct headscan *s)
{
    struct headscan_options o;
    struct head h;

    head_make_up(subject, &h);
    if (!headscan_kind(kind, seed, false, &o))
        wanted(SURFACE_EINVAL, kind);
    o.points = o.points < 10000 ? o.points : 10000;
    headscan_render(&h, &o, s);
    rounded((double(*)[3])s->at, s->n, o.unit_mm > 1 ? 0x1p-20 : 0x1p-10);
    head_free(&h);
}

static struct surface_cloud cloud_of(const struct headscan *s, uint32_t flags)
{
    return (struct surface_cloud){.points = (const double(*)[3])s->at,
                                  .n = s->n,
                                  .width = s->width,
                                  .height = s->height,
                                  .flags = flags};
}

/* ---- results */

/* The face, and what its bytes give when they are read again. */
static void put_face(const struct surface_face *face)
{
    const struct surface_quality q = surface_face_quality(face);
    const size_t n = surface_encoded_size(face);
    unsigned char *bytes = malloc(2 * n);
    struct surface_face *again = NULL;
    double frame[16];

    if (bytes == NULL)
        wanted(SURFACE_ENOMEM, "bytes");
    surface_face_frame(face, frame);
    put("frame", frame, 16);
    put("quality", (const double[]){q.score, q.coverage, q.density_mm, q.noise_mm}, 4);
    printf("reasons %" PRIu32 "\n", surface_quality_reasons(&q, face));
    surface_encode(face, bytes);
    put_bytes("face", bytes, n);
    wanted(surface_decode(work, bytes, n, &again), "decode");
    wanted(surface_face_check(again), "check");
    surface_encode(again, bytes + n);
    wanted(memcmp(bytes, bytes + n, n) == 0 ? SURFACE_OK : SURFACE_EINTERNAL,
           "encode again");
    surface_face_free(again);
    free(bytes);
}

static void put_comparison(const char *what, const struct surface_comparison *c)
{
    printf("%s %d", what, (int)c->decision);
    put("",
        (const double[]){c->score, c->threshold, c->expected, c->false_match_rate,
                         c->overlap},
        5);
}

static void compare(const char *what, const struct surface_face *a,
                    const struct surface_face *b)
{
    static struct surface_parts parts;
    struct surface_comparison c;
    struct surface_disparity d;

    printf("# %s\n", what);
    wanted(surface_compare(work, a, b, &c), "compare");
    put_comparison("comparison", &c);
    surface_best_of(work, 3, &c);
    put_comparison("of three", &c);
    wanted(surface_compare_mirrored(work, a, b, &c), "mirrored");
    put_comparison("mirrored", &c);
    wanted(surface_disparity(work, a, b, &d), "disparity");
    wanted(surface_weigh(work, a, b, &d), "weigh");
    put("disparity",
        (const double[]){d.disparity_mm, d.volume_mm3, d.area_mm2, d.weighted_mm}, 4);
    put("transform", d.transform, 16);
    put("alignment", d.align_transform, 16);
    put("spread", (const double[]){d.turn_deg, d.shift_mm, d.cost_mm, d.rival_mm}, 4);
    printf("search %" PRIu32 " %" PRIu32 " %s\n", d.starts, d.evaluations, d.stop);
    wanted(surface_parts(work, a, b, &parts), "parts");
    put("regions", parts.region, SURFACE_REGIONS);
    put_floats("gaps", parts.gap_mm, SURFACE_CELLS);
    put_floats("parts", parts.part, SURFACE_CELLS);
    put_floats("rests", parts.rest_mm, SURFACE_CELLS);
}

static void put_frontal(void)
{
    struct surface_face *face[4] = {NULL};
    struct surface_asymmetry y;

    for (uint64_t i = 0; i < 4; i++) {
        build(i < 3 ? 1 : 2, i, &face[i]);
        printf("# frontal scan %" PRIu64 "\n", i);
        put_face(face[i]);
    }
    compare("the same person", face[0], face[1]);
    compare("smiling, with holes and spikes", face[0], face[2]);
    compare("somebody else", face[0], face[3]);
    compare("itself", face[0], face[0]);
    wanted(surface_asymmetry(work, face[0], &y), "asymmetry");
    put("asymmetry",
        (const double[]){y.disparity_mm, y.first_mm, y.normal[0], y.normal[1],
                         y.normal[2], y.offset_mm, y.weighted_mm, y.moved_deg, y.moved_mm,
                         y.turn_deg, y.shift_mm},
        11);
    for (int i = 0; i < 4; i++)
        surface_face_free(face[i]);
}

static void put_found(const struct surface_found *f)
{
    printf("found %zu %zu %zu %" PRIu32 " %" PRIu32 "\n", f->points, f->points_used,
           f->kept, f->faces, f->warnings);
    put("unit", (const double[]){f->unit_mm, f->step_mm, f->focal_times, f->head_size},
        4);
    put("view", f->view, 16);
    put("turn", (const double[]){f->yaw_deg, f->pitch_deg, f->roll_deg}, 3);
    put("evidence",
        (const double[]){f->evidence, f->support, f->seen, f->residual_mm, f->likeness,
                         f->eyes, f->detail, f->forehead, f->occluded, f->elsewhere},
        10);
}

/* A head with shoulders before a camera, its pixels in metres; a turned one; one with a scarf. */
static void put_heads(void)
{
    static const struct {
        const char *kind;
        uint32_t flags;
    } scan[] = {{"depth", SURFACE_PINHOLE}, {"half", 0}, {"scarf", 0}};

    for (size_t i = 0; i < sizeof scan / sizeof *scan; i++) {
        struct surface_found found, why;
        enum surface_status refused;
        struct surface_face *face = NULL;
        struct surface_cloud cloud;
        struct headscan s;

        printf("# %s\n", scan[i].kind);
        render(1, scan[i].kind, i, &s);
        cloud = cloud_of(&s, scan[i].flags);
        put_doubles("scan", (const double *)s.at, 3 * s.n);
        wanted(surface_check(work, &cloud, &face, &refused, &why, &found), "a head");
        printf("enrolment %d\n", (int)refused);
        put_found(&found);
        put_face(face);
        surface_face_free(face);
        headscan_free(&s);
    }
}

static void put_fused(void)
{
    struct surface_cloud cloud[FRAMES];
    struct surface_frame frame[FRAMES];
    struct surface_face *face = NULL;
    struct surface_found found;
    struct headscan s[FRAMES];
    uint32_t base;

    for (uint64_t i = 0; i < FRAMES; i++) {
        render(3, "head", 20 + i, &s[i]);
        cloud[i] = cloud_of(&s[i], 0);
    }
    wanted(surface_fuse(work, FRAMES, cloud, frame, &base, &face, &found), "frames");
    printf("# frames, base %" PRIu32 "\n", base);
    for (int i = 0; i < FRAMES; i++) {
        printf("frame %d", (int)frame[i].status);
        put("", (const double[]){frame[i].score, frame[i].gap_mm}, 2);
        headscan_free(&s[i]);
    }
    put_found(&found);
    put_face(face);
    surface_face_free(face);
}

/* A face's descriptor, changed at random. */
static void made_up(const unsigned char of[SURFACE_DESCRIPTOR], struct draw *r,
                    unsigned char out[SURFACE_DESCRIPTOR])
{
    out[0] = (unsigned char)(draw_next(r) >> 61);
    for (int k = 1; k < SURFACE_DESCRIPTOR; k++) {
        const int x = (of[k] ^ 0x80) - 0x80 + (int)(draw_next(r) >> 60) - 8;

        out[k] = (unsigned char)((x < -127 ? -127 : x > 127 ? 127 : x) & 0xff);
    }
}

static void put_searches(void)
{
    static struct surface_hit hit[20];
    struct surface_index *x = surface_index_new();
    unsigned char d[PEOPLE][SURFACE_DESCRIPTOR], other[SURFACE_DESCRIPTOR];
    struct draw r = draw_stream(1, 2, 3);
    struct surface_face *face = NULL;
    size_t n;

    printf("# searches\n");
    for (uint64_t i = 0; i < PEOPLE; i++) {
        build(10 + i, 0, &face);
        wanted(surface_describe(work, face, d[i]), "describe");
        (void)surface_index_add(x, d[i]);
        put_bytes("descriptor", d[i], sizeof d[i]);
    }
    for (int i = 0; i < OTHERS; i++) {
        made_up(d[i % PEOPLE], &r, other);
        (void)surface_index_add(x, other);
    }
    for (uint64_t i = 0; i < PEOPLE; i += 2) {
        build(10 + i, 1 + i % 2, &face);
        wanted(surface_search(work, x, face, NULL, -1e9, 20, hit, &n), "search");
        printf("hits");
        for (size_t k = 0; k < n; k++)
            printf(" %" PRIu32 ":%.9g", hit[k].slot, (double)hit[k].score);
        printf("\n");
    }
    surface_face_free(face);
    surface_index_free(x);
}

/* Scores are rated by a calibration of the test's own: the model's may change more often than the measure. */
static void put_model(void)
{
    static const struct surface_calibration by = {
        .threshold = 8,
        .n = 4,
        .knot = {{-30, 1}, {0, 0.013}, {7, 0.0007}, {40, 0.00001}}};
    const size_t n = surface_model_write(&model_default, NULL, 0) + 1;
    char *text = malloc(n), engine[SURFACE_ENGINE_SIZE];
    struct surface_model *model = NULL;

    if (text == NULL)
        wanted(SURFACE_ENOMEM, "model");
    (void)surface_model_write(&model_default, text, n);
    wanted(surface_model_parse(text, n - 1, &model, NULL), "model");
    surface_engine(model, engine); /* from the text of what was parsed */
    printf("%s\n", engine);
    surface_model_free(model);
    free(text);
    wanted(surface_work_calibrate(work, &by), "calibrate");
}

int main(void)
{
    work = surface_work_new(NULL);
    if (work == NULL)
        wanted(SURFACE_ENOMEM, "memory");
    put_model();
    put_frontal();
    put_heads();
    put_fused();
    put_searches();
    surface_work_free(work);
    return 0;
}
