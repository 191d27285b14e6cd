/* link: -Wl,--wrap=aligned_alloc,--wrap=malloc,--wrap=calloc */
/* Surfaces written as GLB, read by our own reader, and looked at byte by byte. */
#include "cloudfile.h"
#include "errinfo.h"
#include "fail_alloc.h"
#include "glbwrite.h"
#include "json.h"
#include "mem.h"
#include "unit.h"

static const float square[4][3] = {{-1.5f, 0, 0.25f}, {2, 0, 0}, {2, 3, 0}, {0, 3, 0.1f}};
static const uint32_t corners[2][3] = {{0, 1, 2}, {0, 2, 3}};
static const unsigned char color[4][4] = {
    {1, 2, 3, 255}, {4, 5, 6, 0}, {7, 8, 9, 255}, {0}};
static const float part[4] = {0.5f, -1, 0, 2};

static const struct glbwrite_node nodes[] = {{.name = "probe",
                                              .at = square[0],
                                              .n = 4,
                                              .triangle = corners[0],
                                              .triangles = 2,
                                              .color = color[0],
                                              .scalar = {{"_PART", part}}},
                                             {.name = "scan", .at = square[0], .n = 4}};

static unsigned char *file;
static size_t len;

static void write_nodes(const struct glbwrite_node *node, size_t n)
{
    struct json *j = json_new();

    json_object(j, "extras");
    json_text(j, "decision", "match");
    json_close(j);
    assert_int_equal(glbwrite(node, n, j, &file, &len), ST_OK);
}

AFTER_EACH(tear_down)
{
    free(file);
    file = NULL;
}

static uint32_t word(size_t at)
{
    assert_true(at + 4 <= len);
    return (uint32_t)file[at] | (uint32_t)file[at + 1] << 8 |
           (uint32_t)file[at + 2] << 16 | (uint32_t)file[at + 3] << 24;
}

/* The document of the file; *bin: where the arrays begin. */
static struct json_value *document(size_t *bin)
{
    struct json_value *out = NULL;
    struct errinfo e = {0};
    const size_t n = word(12);
    char *text = malloc(n + 1);

    assert_non_null(text);
    memcpy(text, file + 20, n);
    text[n] = '\0';
    assert_int_equal(json_read(text, n, 10000, &out, &e), ST_OK);
    free(text);
    *bin = 20 + n + 8;
    return out;
}

TEST(test_the_container)
{
    write_nodes(nodes, 2);
    assert_memory_equal(file, "glTF", 4);
    assert_int_equal(word(4), 2);
    assert_int_equal(word(8), len);
    assert_int_equal(word(12) % 4, 0);
    assert_memory_equal(file + 16, "JSON", 4);
    assert_int_equal(20 + word(12) + 8 + word(20 + word(12)), len);
    assert_memory_equal(file + 24 + word(12), "BIN\0", 4);
    assert_int_equal(len % 4, 0);
}

static double number(const struct json_value *object, const char *key)
{
    double x = NAN;

    assert_true(json_get_number(json_member(object, key), &x));
    return x;
}

static const struct json_value *item(const struct json_value *array, size_t i)
{
    const struct json_value *v = json_first(array);

    while (i-- > 0)
        v = json_next(v);
    assert_non_null(v);
    return v;
}

TEST(test_each_array_is_where_the_document_says)
{
    /* POSITION, COLOR_0, _PART, indices; POSITION */
    static const size_t bytes[] = {48, 16, 16, 12, 48};
    static const void *const from[] = {square, color, part, NULL, square};
    struct json_value *doc;
    const struct json_value *views;
    size_t bin;

    write_nodes(nodes, 2);
    doc = document(&bin);
    views = json_member(doc, "bufferViews");
    assert_int_equal(json_count(views), 5);
    for (size_t i = 0; i < 5; i++) {
        const size_t at = bin + (size_t)number(item(views, i), "byteOffset");

        assert_int_equal((size_t)number(item(views, i), "byteLength"), bytes[i]);
        assert_true(at % 4 == 0 && at + bytes[i] <= len);
        if (from[i] != NULL)
            assert_memory_equal(file + at, from[i], bytes[i]);
        else
            for (size_t k = 0; k < 6; k++)
                assert_int_equal(file[at + 2 * k] | file[at + 2 * k + 1] << 8,
                                 corners[k / 3][k % 3]);
    }
    json_free(doc);
}

TEST(test_the_bounds_are_the_floats)
{
    struct json_value *doc;
    const struct json_value *least, *most;
    double x;
    size_t bin;

    write_nodes(nodes, 1);
    doc = document(&bin);
    least = json_member(item(json_member(doc, "accessors"), 0), "min");
    most = json_member(item(json_member(doc, "accessors"), 0), "max");
    assert_true(json_get_number(item(least, 0), &x) && (float)x == -1.5f);
    assert_true(json_get_number(item(most, 0), &x) && (float)x == 2.0f);
    assert_true(json_get_number(item(most, 2), &x) && (float)x == 0.25f);
    assert_string_equal(
        json_get_text(json_member(json_member(doc, "extras"), "decision")), "match");
    json_free(doc);
}

TEST(test_our_reader_reads_it)
{
    struct cloudfile_options o = {
        .max_points = 100, .max_bytes = 10000, .camera = CLOUDDEPTH_NO_CAMERA};
    struct cloudpoints c = {0};
    struct errinfo e = {0};
    unsigned char *copy;

    write_nodes(nodes, 1);
    assert_non_null(copy = mem_array(len + 1, 1));
    memcpy(copy, file, len);
    copy[len] = 0;
    assert_int_equal(cloudfile_read(copy, len, &o, &c, &e), ST_OK);
    assert_int_equal(c.n, 4);
    assert_true(fabs(c.at[2].y - 0.003) < 1e-9); /* m */
    cloudpoints_free(&c);
    mem_free(copy);
}

TEST(test_many_points_have_wide_indices)
{
    const uint32_t n = 65536;
    float *at = calloc(n, 3 * sizeof *at);
    const uint32_t last[3] = {0, 1, n - 1};
    const struct glbwrite_node node = {
        .name = "face", .at = at, .n = n, .triangle = last, .triangles = 1};
    struct json_value *doc;
    size_t bin;

    assert_non_null(at);
    write_nodes(&node, 1);
    doc = document(&bin);
    assert_true(number(item(json_member(doc, "accessors"), 1), "componentType") == 5125);
    assert_int_equal(word(len - 4), n - 1);
    json_free(doc);
    free(at);
}

static enum status run(void *arg)
{
    enum status st = glbwrite(nodes, 2, json_new(), &file, &len);

    (void)arg;
    assert_int_equal(st == ST_OK, file != NULL);
    if (st == ST_OK) {
        free(file);
        file = NULL;
    }
    return st;
}

TEST(test_memory_that_runs_out)
{
    assert_true(fail_alloc_walk(run, NULL) > 10);
}
