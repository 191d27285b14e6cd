/* OBJ files of a morphable model, and what is none. */
#include <sys/stat.h>
#include <unistd.h>

#include "objmesh.h"
#include "unit.h"

static char path[] = "/tmp/test_objmesh.XXXXXX";
static struct objmesh m;
static struct errinfo e;

static bool all(const char *material)
{
    (void)material;
    return true;
}

static bool skin(const char *material)
{
    return strcmp(material, "skin") == 0;
}

static enum status read_text(const char *text, size_t len,
                             bool (*takes)(const char *material))
{
    FILE *f = fopen(path, "wb");

    assert_non_null(f);
    assert_int_equal(fwrite(text, 1, len, f), len);
    assert_int_equal(fclose(f), 0);
    return objmesh_read(path, takes, &m, &e);
}

static void good(const char *text, bool (*takes)(const char *material))
{
    if (read_text(text, strlen(text), takes) != ST_OK)
        fail_msg("%s", e.msg);
}

static void bad(const char *text, size_t len, enum status want, const char *words)
{
    assert_int_equal(read_text(text, len, all), want);
    assert_int_equal(e.code, want);
    if (strstr(e.msg, words) == NULL || strstr(e.msg, path) == NULL)
        fail_msg("'%s' lacks '%s'", e.msg, words);
    assert_null(m.at);
    assert_null(m.corner);
}

TEST(test_good)
{
    static const uint32_t want[3][3] = {{0, 1, 2}, {0, 2, 3}, {3, 1, 0}};

    good(
        "# a comment\n\nmtllib x.mtl\r\no thing\nv 1 2.5 -3e1\n v\t0 0 0 1 1 1\r\nv 4 5 6\n"
        "v 7 8 9\nvt 0 0\nvn 0 0 1\ns off\nf 1 2/1 3//1 4/1/1\ng part\nf 4 2 1",
        all);
    assert_int_equal(m.nv, 4);
    assert_true(m.at[0] >= 1.0f && m.at[1] >= 2.5f && m.at[2] <= -30.0f);
    assert_true(m.at[11] >= 9.0f && m.at[11] <= 9.0f);
    assert_int_equal(m.nt, 3);
    assert_memory_equal(m.corner, want, sizeof want);
    objmesh_free(&m);
    assert_null(m.at);
    objmesh_free(&m);
}

/* Triangles of some materials; the vertices are all there. */
TEST(test_materials)
{
    static const char text[] =
        "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nusemtl skin\nf 2 3 1\n"
        "usemtl lash\nf 9 9 9\nusemtl skin\nf 3 2 1\nusemtl\nf 1 1 1\n";

    good(text, skin);
    assert_int_equal(m.nv, 3);
    assert_int_equal(m.nt, 2);
    assert_int_equal(m.corner[0][0], 1);
    assert_int_equal(m.corner[1][0], 2);
    objmesh_free(&m);
    good(text, NULL);
    assert_int_equal(m.nv, 3);
    assert_int_equal(m.nt, 0);
    objmesh_free(&m);
}

TEST(test_bad)
{
    static const struct {
        const char *text;
        enum status st;
        const char *words;
    } list[] = {
        {"", ST_EINVAL, "no vertices"},
        {"hello\nworld\n", ST_EINVAL, "no vertices"},
        {"v 1 2\n", ST_EINVAL, "line 1"},
        {"v 1 2 3\nv 1 x 3\n", ST_EINVAL, "line 2"},
        {"v 1,2,3\n", ST_EINVAL, "line 1"},
        {"v 1 2 nan\n", ST_ENOTFINITE, "line 1"},
        {"v 1 2 inf\n", ST_ENOTFINITE, "line 1"},
        {"v 1e300 2 3\n", ST_ENOTFINITE, "line 1"},
        {"v 1e999 2 3\n", ST_ENOTFINITE, "line 1"},
        {"v 1 2 3\nf 1 1\n", ST_EINVAL, "line 2: a face of fewer than 3"},
        {"v 1 2 3\nf\n", ST_EINVAL, "line 2"},
        {"v 1 2 3\nf 1 1 2\n", ST_EINVAL, "line 2: a face's corner"},
        {"v 1 2 3\nf 0 1 1\n", ST_EINVAL, "line 2"},
        {"v 1 2 3\nf -1 -1 -1\n", ST_EINVAL, "line 2"},
        {"v 1 2 3\nf 1 1 99999999999999999999\n", ST_EINVAL, "line 2"},
        {"v 1 2 3\nf 1 1 4294967297\n", ST_EINVAL, "line 2"},
        {"v 1 2 3\nf 1 /1 1\n", ST_EINVAL, "line 2"},
        {"v 1 2 3\nf a b c\n", ST_EINVAL, "line 2"},
    };

    for (size_t i = 0; i < sizeof list / sizeof *list; i++)
        bad(list[i].text, strlen(list[i].text), list[i].st, list[i].words);
    bad("v 1 2 3\0\nv 4 5 6\n", 17, ST_EINVAL, "line 1");
}

/* A long line without an end, and more vertices or triangles than are read. */
TEST(test_large)
{
    const size_t n = OBJMESH_MAX + 1;
    char *text = malloc(8 * n + 40), *at = text;

    assert_non_null(text);
    for (size_t i = 0; i < n; i++, at += 8)
        memcpy(at, "v 1 2 3\n", 8);
    bad(text, (size_t)(at - text), ST_ELIMIT, "line 1000001: more than 1000000 vertices");
    at = text;
    memcpy(at, "v 1 2 3\nf 1 1", 13);
    for (at += 13; at < text + 2 * n + 20; at += 2)
        memcpy(at, " 1", 2);
    bad(text, (size_t)(at - text), ST_ELIMIT, "line 2: more than 1000000 triangles");
    free(text);
}

TEST(test_no_file)
{
    assert_int_equal(objmesh_read("/nowhere/x.obj", all, &m, &e), ST_ENOTFOUND);
    assert_non_null(strstr(e.msg, "/nowhere/x.obj"));
    assert_int_equal(objmesh_read("/tmp", all, &m, &e), ST_EINVAL);
    assert_non_null(strstr(e.msg, "not a regular file"));
    assert_int_equal(unlink(path), 0);
    assert_int_equal(mkfifo(path, 0600), 0);
    assert_int_equal(objmesh_read(path, all, &m, &e), ST_EINVAL);
    assert_int_equal(unlink(path), 0);
}

BEFORE_ALL(set_up)
{
    const int fd = mkstemp(path);

    assert_false(fd < 0 || close(fd) != 0);
}
