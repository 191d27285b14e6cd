/* STL files, text and binary: equal vertices become one, the corners' order gives the
 * normals, and a file that is not just what it says is refused. */
#include "scanfile.h"
#include "unit.h"

/* A triangle with a corner without a value, and a square of two. */
static const double triangle[3][3][3] = {{{2, 0, 0}, {NAN, 1, 1}, {0, 3, 0}},
                                         {{0, 0, 0}, {2, 0, 0}, {2, 3, 0}},
                                         {{0, 0, 0}, {2, 3, 0}, {0, 3, 0}}};

static void make_binary(struct scanfile *f, const char *head, uint32_t count)
{
    unsigned char first[80] = {0};

    memcpy(first, head, strlen(head));
    f->len = 0;
    scanfile_put(f, first, sizeof first);
    scanfile_whole(f, count, 4, false);
    for (size_t i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++)
            scanfile_real(f, 77, 4, false); /* a normal, which nobody looks at */
        for (int k = 0; k < 9; k++)
            scanfile_real(f, triangle[i][k / 3][k % 3], 4, false);
        scanfile_whole(f, 0xFFFF, 2, false);
    }
}

static void make_text(struct scanfile *f, const char *name, const char *eol)
{
    char line[200];

    f->len = 0;
    (void)snprintf(line, sizeof line, "solid %s%s", name, eol);
    scanfile_text(f, line);
    for (size_t i = 0; i < 3; i++) {
        (void)snprintf(line, sizeof line, "  facet normal 0 0 1%s\touter loop%s", eol,
                       eol);
        scanfile_text(f, line);
        for (size_t k = 0; k < 3; k++) {
            const double *v = triangle[i][k];

            (void)snprintf(line, sizeof line, "vertex %e %g %.9f%s", v[0], v[1], v[2],
                           eol);
            scanfile_text(f, line);
        }
        (void)snprintf(line, sizeof line, "endloop%sENDFACET%s%s", eol, eol, eol);
        scanfile_text(f, line);
    }
    (void)snprintf(line, sizeof line, "endsolid %s%s", name, eol);
    scanfile_text(f, line);
}

static void check_square(const struct scanfile *f, enum cloudformat format)
{
    struct cloudpoints p;

    scanfile_good(f, format, &p);
    assert_int_equal(p.format, CLOUDFORMAT_STL);
    assert_int_equal(p.read, 5);
    assert_int_equal(p.n, 4);
    scanfile_at(p.at[0], 2, 0, 0);
    scanfile_at(p.at[1], 0, 3, 0);
    scanfile_at(p.at[2], 0, 0, 0); /* once, and therefore a point */
    scanfile_at(p.at[3], 2, 3, 0);
    scanfile_at(p.normal[0], 0, 0, 6);
    scanfile_at(p.normal[1], 0, 0, 6);
    scanfile_at(p.normal[2], 0, 0, 12);
    scanfile_at(p.normal[3], 0, 0, 12);
    assert_true(p.unit_mm == 0 && p.width == 0 && p.height == 0);
    cloudpoints_free(&p);
}

TEST(test_both)
{
    static struct scanfile f;

    make_binary(&f, "by a scanner", 3);
    check_square(&f, CLOUDFORMAT_ANY);
    check_square(&f, CLOUDFORMAT_STL);
    make_binary(&f, "solid, it says", 3);
    check_square(&f, CLOUDFORMAT_ANY);
    make_text(&f, "face", "\n");
    check_square(&f, CLOUDFORMAT_ANY);
    make_text(&f, "", "\r\n");
    check_square(&f, CLOUDFORMAT_STL);
}

TEST(test_hostile)
{
    static const uint32_t count[] = {0, 2, 4, 0x80000000U, 0xFFFFFFFFU};
    static struct scanfile f;

    for (size_t i = 0; i < sizeof count / sizeof *count; i++) {
        make_binary(&f, "x", count[i]);
        scanfile_bad(&f, CLOUDFORMAT_STL, ST_EINVAL, "the STL file has 234");
    }
    make_binary(&f, "x", 3);
    scanfile_cut(&f, CLOUDFORMAT_STL);
    f.len = 0;
    scanfile_text(&f, "nothing of the kind");
    scanfile_bad(&f, CLOUDFORMAT_STL, ST_EINVAL, "neither the word solid");
}

TEST(test_bad_text)
{
    static const struct scanfile_case bad[] = {
        {"solid\nvertex 1 2 3\nendsolid\n", ST_EINVAL, "malformed STL file"},
        {"solid\nfacet\nouter loop\nvertex 1 2 3\nvertex 1 2 4\nendloop\nendfacet\nendsolid\n",
         ST_EINVAL, "fewer than three"},
        {"solid\nfacet\nouter loop\nvertex 1 2 3\nvertex 1 2 4\nvertex 1 2 5\nvertex 1 2 6\n",
         ST_EINVAL, "more than three"},
        {"solid\nfacet\nouter loop\nvertex 1 2\n", ST_EINVAL, "too few numbers"},
        {"solid\nfacet\nouter loop\nvertex 1 2 x\n", ST_EINVAL, "a number is expected"},
        {"solid\nfacet normal 0 0 1\nouter loop\nvertex 1 2 3\nvertex 1 2 4\nvertex 1 3 4\n"
         "endloop\nendfacet\n",
         ST_EINVAL, "ends within a solid"},
        {"solid\nendsolid\n", ST_EINVAL, "there are no points"},
        {"solid\nfacet \x01\n", ST_EINVAL, "binary data inside text"},
    };

    scanfile_refused(bad, sizeof bad / sizeof *bad);
}

/* Many vertices, six times each, far beyond the first rooms. */
TEST(test_weld)
{
    enum { SIDE = 70 };
    const size_t triangles = 2 * (SIDE - 1) * (SIDE - 1), len = 84 + 50 * triangles;
    const struct cloudfile_options o = {.max_points = SIDE * SIDE, .max_bytes = 1};
    const struct cloudfile_options less = {.max_points = SIDE * SIDE - 1, .max_bytes = 1};
    unsigned char *file = calloc(1, len), *at = file + 84;
    struct cloudpoints p;
    struct scanfile_said err;

    assert_non_null(file);
    for (int i = 0; i < 4; i++)
        file[80 + i] = (unsigned char)(triangles >> (8 * i));
    for (size_t t = 0; t < triangles; t++, at += 50) {
        static const unsigned corner[2][3][2] = {{{0, 0}, {1, 0}, {1, 1}},
                                                 {{0, 0}, {1, 1}, {0, 1}}};
        struct scanfile f = {.len = 0};

        for (int k = 0; k < 3; k++) {
            scanfile_real(&f, 5, 4, false);
            scanfile_real(&f, (double)(t / 2 / (SIDE - 1) + corner[t % 2][k][1]), 4,
                          false);
            scanfile_real(&f, (double)(t / 2 % (SIDE - 1) + corner[t % 2][k][0]), 4,
                          false);
        }
        memcpy(at + 12, f.bytes, f.len);
    }
    assert_int_equal(scanfile_read(file, len, &o, &p, &err), ST_OK);
    assert_int_equal(p.n, SIDE * SIDE);
    assert_int_equal(p.read, SIDE * SIDE);
    cloudpoints_free(&p);
    assert_int_equal(scanfile_read(file, len, &less, &p, &err), ST_ELIMIT);
    free(file);
}
