/* A morphable model's folder: read, brought to the canonical frame, and made into random people;
 * and folders that are none. */
#include <errno.h>
#include <unistd.h>

#include "morphable.h"
#include "sculpt.h"
#include "toy.h"
#include "unit.h"

static char dir[] = "/tmp/test_morphable.XXXXXX";
static struct errinfo e;

static void run(const char *command)
{
    char line[300];

    (void)snprintf(line, sizeof line, "cd %s && %s", dir, command);
    assert_int_equal(system(line), 0);
}

static struct morphable *model(double unit_mm, double pitch)
{
    struct morphable *m;

    run("rm -f *");
    assert_true(sculpt_write(dir, unit_mm, pitch));
    if (morphable_read(dir, &m, &e) != ST_OK)
        fail_msg("%s", e.msg);
    return m;
}

TEST(test_read)
{
    struct morphable *m = model(10, 0);

    assert_int_equal(m->nv, SCULPT_NX * SCULPT_NY); /* those of the lash are not used */
    assert_int_equal(m->nt, 2 * (SCULPT_NX - 1) * (SCULPT_NY - 1));
    assert_int_equal(m->nidentity, SCULPT_IDENTITIES);
    assert_int_equal(m->nexpression, SCULPT_EXPRESSIONS);
    assert_string_equal(m->kind[0].name, "browUp_L"); /* by name */
    assert_int_equal(m->kind[0].mirror, 1);
    assert_int_equal(m->kind[1].mirror, 0);
    assert_string_equal(m->kind[2].name, "jawOpen");
    assert_int_equal(m->kind[2].mirror, 2);
    assert_true(m->kind[2].share < m->kind[1].share);
    morphable_free(m);
    morphable_free(NULL);
}

/* Whatever the unit and the tilt, the nose tip is at the origin, and forehead and chin are
 * equally far back. */
TEST(test_place)
{
    static const double unit[] = {1, 10, 1000}, pitch[] = {-0.12, 0, 0.2};
    float first[GRID_N], h[GRID_N];

    for (int u = 0; u < 3; u++)
        for (int p = 0; p < 3; p++) {
            struct morphable *m = model(unit[u], pitch[p]);
            double most = 0;

            morphable_heights(m, m->neutral, h);
            if (u == 0 && p == 0)
                memcpy(first, h, sizeof h);
            for (uint32_t i = 0; i < GRID_N; i++)
                if (!isnan(h[i]) && !isnan(first[i]) && fabs(grid_x(i)) < 50 &&
                    fabs(grid_y(i)) < 62)
                    most = fmax(most, fabs((double)(h[i] - first[i])));
            assert_true(most < 1.5); /* the vertices lie elsewhere on slopes */
            assert_true(fabs((double)h[grid_cell(1, 1)]) < 0.7);
            assert_true(fabs((double)(h[grid_cell(1, 60)] - h[grid_cell(1, -60)])) < 1);
            morphable_free(m);
        }
}

static void refused(const char *change, enum status want, const char *words)
{
    struct morphable *m;

    run("rm -f *");
    assert_true(sculpt_write(dir, 10, 0.1));
    run(change);
    if (morphable_read(dir, &m, &e) != want)
        fail_msg("not status %d: %s", want, change);
    assert_null(m);
    if (strstr(e.msg, words) == NULL)
        fail_msg("'%s' lacks '%s'", e.msg, words);
}

TEST(test_refused)
{
    struct morphable *m;

    refused("rm neutral.obj", ST_EINVAL, "0 files of a neutral face");
    refused("cp neutral.obj other_Neutral.OBJ", ST_EINVAL, "2 files of a neutral face");
    refused("rm identity*", ST_EINVAL, "0 modes of identity");
    refused("rm mouth* brow* jaw*", ST_EINVAL, "0 expressions");
    refused("head -500 neutral.obj > identity00.obj", ST_EINVAL,
            "identity00.obj: 498 vertices, where the neutral face has 1890");
    refused("echo 'v 1 2 x' >> jawOpen.obj", ST_EINVAL, "jawOpen.obj: line");
    refused(
        "echo 'f 1 2 3000' >> neutral.obj; echo 'usemtl a\nf 1 2 3000' >> neutral.obj",
        ST_EINVAL, "neutral.obj: line");
    refused("rm jawOpen.obj; mkfifo jawOpen.obj", ST_EINVAL, "not a regular file");
    refused("sed -i 's/^v \\([^ ]*\\) \\([^ ]*\\) .*/v \\1 \\2 0/' neutral.obj",
            ST_ENOTFACE, "not a face"); /* flat */
    refused(
        "sed -i 's/^v \\([^ ]*\\) \\([^ ]*\\) \\(.*\\)/v \\1 \\2 -\\3/; s/--//' neutral.obj",
        ST_ENOTFACE, "not a face"); /* from behind */
    refused("sed -i 's/^v \\([^ ]*\\) \\([^ ]*\\) \\(.*\\)/v \\1 \\3 \\2/' neutral.obj",
            ST_ENOTFACE, "neutral.obj"); /* other axes */
    refused("sed -i 's/^v \\([^ ]*\\)/v 3\\1/; s/3-/-3/' neutral.obj", ST_ENOTFACE,
            "neutral.obj"); /* beside x = 0 */
    refused("sed -i 's/^f .*//' neutral.obj", ST_ENOTFACE, "neutral.obj");
    refused("sed -i 's/^v \\([^ ]*\\) \\([^ ]*\\)/v \\1 \\2e-7/' neutral.obj",
            ST_ENOTFACE, "as high as");
    assert_int_equal(morphable_read("/nowhere", &m, &e), ST_ENOTFOUND);
    assert_int_equal(morphable_read("/dev/null", &m, &e), ST_EIO);
    run("rm -f *");
    assert_int_equal(morphable_read(dir, &m, &e), ST_EINVAL);
}

/* Other files do not matter. */
TEST(test_others)
{
    struct morphable *m = model(10, 0);

    morphable_free(m);
    run("echo x > readme.txt; echo x > PupilDilate.obj; echo x > .jaw.obj; mkdir obj");
    assert_int_equal(morphable_read(dir, &m, &e), ST_OK);
    assert_int_equal(m->nexpression, SCULPT_EXPRESSIONS);
    morphable_free(m);
    run("rmdir obj; rm -f .jaw.obj *");
}

BEFORE_ALL(set_up)
{
    assert_false(mkdtemp(dir) == NULL);
}

AFTER_ALL(tear_down)
{
    assert_int_equal(rmdir(dir), 0);
}
