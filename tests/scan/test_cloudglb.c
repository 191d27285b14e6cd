/* GLB files: nodes' transforms, several meshes, indices and components of each type, and
 * files whose numbers lead outside of them. */
#include "scanfile.h"
#include "unit.h"

/* The binary chunk: at 0 four vertices of a square as floats, 16 bytes each; at 64 the
 * indices of two triangles, as bytes; at 70 as 16 bits; at 84 as 32 bits; at 108 the
 * vertices as signed 16 bits, 8 bytes each. */
static const double square[4][3] = {{0, 0, 0}, {2, 0, 0}, {2, 3, 0}, {0, 3, 0}};
static const unsigned corners[6] = {0, 1, 2, 0, 2, 3};

static void put_bin(struct scanfile *f)
{
    f->len = 0;
    for (int i = 0; i < 4; i++) {
        for (int k = 0; k < 3; k++)
            scanfile_real(f, square[i][k], 4, false);
        scanfile_real(f, NAN, 4, false); /* between the vertices */
    }
    for (int i = 0; i < 6; i++)
        scanfile_whole(f, corners[i], 1, false);
    for (int i = 0; i < 6; i++)
        scanfile_whole(f, corners[i], 2, false);
    scanfile_text(f, "--");
    for (int i = 0; i < 6; i++)
        scanfile_whole(f, corners[i], 4, false);
    for (int i = 0; i < 4; i++) {
        for (int k = 0; k < 3; k++)
            scanfile_whole(f, (uint64_t)(square[i][k] * 32767 / 3), 2, false);
        scanfile_text(f, "--");
    }
    assert_int_equal(f->len, 140);
}

/* One string of JSON for what all files here have, with the length of the buffer. */
#define SHARED(len)                                                                      \
    "\"buffers\":[{\"byteLength\":" len "}],"                                            \
    "\"bufferViews\":[{\"buffer\":0,\"byteLength\":64,\"byteStride\":16},"               \
    "{\"buffer\":0,\"byteOffset\":64,\"byteLength\":44},"                                \
    "{\"buffer\":0,\"byteOffset\":108,\"byteLength\":32,\"byteStride\":8}],"             \
    "\"accessors\":["                                                                    \
    "{\"bufferView\":0,\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"},"           \
    "{\"bufferView\":1,\"componentType\":5121,\"count\":6,\"type\":\"SCALAR\"},"         \
    "{\"bufferView\":1,\"byteOffset\":6,\"componentType\":5123,\"count\":6,"             \
    "\"type\":\"SCALAR\"},"                                                              \
    "{\"bufferView\":1,\"byteOffset\":20,\"componentType\":5125,\"count\":6,"            \
    "\"type\":\"SCALAR\"},"                                                              \
    "{\"bufferView\":2,\"componentType\":5122,\"normalized\":true,\"count\":4,"          \
    "\"type\":\"VEC3\"}]"

static void make(struct scanfile *f, const char *json)
{
    struct scanfile bin;
    const size_t len = (strlen(json) + 3) / 4 * 4;

    put_bin(&bin);
    f->len = 0;
    scanfile_text(f, "glTF");
    scanfile_whole(f, 2, 4, false);
    scanfile_whole(f, 12 + 8 + len + 8 + bin.len, 4, false);
    scanfile_whole(f, len, 4, false);
    scanfile_text(f, "JSON");
    scanfile_text(f, json);
    scanfile_put(f, "   ", len - strlen(json));
    scanfile_whole(f, bin.len, 4, false);
    scanfile_put(f, "BIN", 4);
    scanfile_put(f, bin.bytes, bin.len);
}

#define SCENE(nodes, meshes)                                                             \
    "{\"asset\":{\"version\":\"2.0\"},\"scene\":1,\"scenes\":[{},{\"nodes\":[0]}],"      \
    "\"nodes\":" nodes ",\"meshes\":" meshes "," SHARED("140") "}"
#define MESH(indices)                                                                    \
    "[{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":" indices "}]}]"

static void check_square(const struct cloudpoints *p, size_t from, const double m[16])
{
    for (size_t i = 0; i < 4; i++) {
        const struct dvec3 at = {square[i][0], square[i][1], square[i][2]};
        const struct dvec3 want = vec_transform(m, at);

        scanfile_at(p->at[from + i], want.x, want.y, want.z);
    }
}

static const double same[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

TEST(test_indices)
{
    static const char *const json[] = {SCENE("[{\"mesh\":0}]", MESH("1")),
                                       SCENE("[{\"mesh\":0}]", MESH("2")),
                                       SCENE("[{\"mesh\":0}]", MESH("3"))};
    static struct scanfile f;
    struct cloudpoints p;

    for (size_t i = 0; i < 3; i++) {
        make(&f, json[i]);
        scanfile_good(&f, i == 0 ? CLOUDFORMAT_ANY : CLOUDFORMAT_GLB, &p);
        assert_int_equal(p.format, CLOUDFORMAT_GLB);
        assert_true(p.n == 4 && p.read == 4 && p.unit_mm == 0);
        check_square(&p, 0, same);
        scanfile_at(p.normal[0], 0, 0, 12);
        scanfile_at(p.normal[1], 0, 0, 6);
        cloudpoints_free(&p);
    }
    scanfile_cut(&f, CLOUDFORMAT_ANY);
}

/* Without scenes the nodes are those that are no other's children; without nodes each mesh is one. */
TEST(test_no_scenes)
{
    static const char *const json[] = {
        "{\"nodes\":[{\"mesh\":0}],\"meshes\":" MESH("1") "," SHARED("140") "}",
        "{\"scenes\":[],\"nodes\":[{\"mesh\":0},{\"children\":[0]}],\"meshes\":" MESH(
            "1") "," SHARED("140") "}",
        "{\"meshes\":" MESH("1") "," SHARED("140") "}"};
    static struct scanfile f;
    struct cloudpoints p;

    for (size_t i = 0; i < 3; i++) {
        make(&f, json[i]);
        scanfile_good(&f, CLOUDFORMAT_ANY, &p);
        assert_int_equal(p.n, 4);
        check_square(&p, 0, same);
        cloudpoints_free(&p);
    }
    make(&f,
         "{\"nodes\":[{\"mesh\":0,\"children\":[1]},{\"children\":[0]}],\"meshes\":" MESH(
             "1") "," SHARED("140") "}");
    scanfile_bad(&f, CLOUDFORMAT_ANY, ST_EINVAL, "no node of the scene");
}

/* Compression is named wherever it is declared, if the data is not there as well. */
TEST(test_compressed)
{
#define FILE_OF(extension, views, used)                                                  \
    "{\"nodes\":[{\"mesh\":0}],\"buffers\":[{\"byteLength\":140},{\"byteLength\":9}],"   \
    "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}" extension "}]}],"    \
    "\"bufferViews\":[" views "],\"accessors\":[{" used                                  \
    "\"componentType\":5126,\"count\":4,\"type\":\"VEC3\"}]"
    static const struct {
        const char *json, *words;
    } c[] = {
        {FILE_OF(",\"extensions\":{\"KHR_draco_mesh_compression\":{\"bufferView\":0}}",
                 "", "") "}",
         "by KHR_draco_mesh_compression"},
        {FILE_OF("", "", "") ",\"extensionsUsed\":[\"KHR_draco_mesh_compression\"]}",
         "by KHR_draco_mesh_compression"},
        {FILE_OF(
             "",
             "{\"buffer\":1,\"byteLength\":9,\"extensions\":{\"EXT_meshopt_compression\":{}}}",
             "\"bufferView\":0,") "}",
         "by EXT_meshopt_compression"},
        {FILE_OF(
             "", "{\"buffer\":1,\"byteLength\":9}",
             "\"bufferView\":0,") ",\"extensionsUsed\":[1,\"KHR_meshopt_compression\"]}",
         "by KHR_meshopt_compression"},
        {FILE_OF("", "{\"buffer\":1,\"byteLength\":9}", "\"bufferView\":0,") "}",
         "nothing is opened"},
        {FILE_OF("", "", "") "}", "accessor 0 has no data"}};
    static struct scanfile f;
    struct cloudpoints p;

    for (size_t i = 0; i < sizeof c / sizeof *c; i++) {
        make(&f, c[i].json);
        scanfile_bad(&f, CLOUDFORMAT_ANY, ST_EVERSION, c[i].words);
    }
    make(&f,
         "{\"extensionsUsed\":[\"KHR_draco_mesh_compression\"],\"nodes\":[{\"mesh\":0}],"
         "\"meshes\":" MESH("1") "," SHARED("140") "}");
    scanfile_good(&f, CLOUDFORMAT_ANY, &p);
    cloudpoints_free(&p);
}

/* A node below another, one by a matrix and one by its parts, each with a mesh. */
TEST(test_nodes)
{
    static const double turned[16] = {0, -4, 0, 5, 2, 0, 0, 6, 0, 0, 1, 7, 0, 0, 0, 1};
    static const double mirrored[16] = {0, -4, 0, 5, -2, 0, 0, 8, 0, 0, 1, 7, 0, 0, 0, 1};
    static struct scanfile f;
    struct cloudpoints p;

    make(&f, SCENE("[{\"children\":[2],\"mesh\":0,\"translation\":[5,6,7],"
                   "\"rotation\":[0,0,0.70710678118654752,0.70710678118654752],"
                   "\"scale\":[2,4,1]},{\"mesh\":0},"
                   "{\"mesh\":0,\"matrix\":[-1,0,0,0, 0,1,0,0, 0,0,1,0, 1,0,0,1]}]",
                   MESH("1")));
    scanfile_good(&f, CLOUDFORMAT_ANY, &p);
    assert_int_equal(p.n, 8);
    for (size_t i = 0; i < p.n; i++) /* sin 45 degrees is not exact */
        p.at[i] =
            (struct dvec3){round(p.at[i].x * 1e9) / 1e9, round(p.at[i].y * 1e9) / 1e9,
                           round(p.at[i].z * 1e9) / 1e9};
    check_square(&p, 0, turned);
    check_square(&p, 4, mirrored);
    assert_true(p.normal[0].z > 0);
    assert_true(p.normal[4].z > 0); /* mirrored, and so is the order of the corners */
    cloudpoints_free(&p);
}

TEST(test_quantized)
{
    static struct scanfile f;
    struct cloudpoints p;

    make(&f,
         SCENE("[{\"mesh\":0,\"scale\":[3,3,3]}]",
               "[{\"primitives\":[{\"attributes\":{\"POSITION\":4},\"mode\":0},"
               "{\"attributes\":{\"POSITION\":4}},{\"attributes\":{\"COLOR_0\":9}}]}]"));
    scanfile_good(&f, CLOUDFORMAT_ANY, &p);
    assert_int_equal(p.n, 4); /* of the two that share them */
    for (size_t i = 0; i < 4; i++)
        assert_true(fabs(p.at[i].x - square[i][0]) < 1e-4 &&
                    fabs(p.at[i].y - square[i][1]) < 1e-4);
    assert_non_null(p.normal);
    cloudpoints_free(&p);
}

TEST(test_units)
{
    const struct cloudfile_options o = {.max_points = 10, .unit_mm = 1};
    static struct scanfile f;
    struct scanfile_said err;
    struct cloudpoints p;

    make(&f, SCENE("[{\"mesh\":0}]", MESH("1")));
    assert_int_equal(scanfile_read(f.bytes, f.len, &o, &p, &err), ST_OK);
    assert_true(p.unit_mm == 1);
    cloudpoints_free(&p);
}

TEST(test_bad)
{
    static const struct scanfile_case bad[] = {
        {"{", ST_EINVAL, "GLB: not valid JSON"},
        {"{}", ST_EINVAL, "no node of the scene"},
        {SCENE("[{\"mesh\":1}]", MESH("1")), ST_EINVAL, "no mesh 1"},
        {SCENE("[{\"mesh\":0,\"children\":[0]}]", MESH("1")), ST_EINVAL, "a tree"},
        {SCENE("[{\"children\":[1,1]},{\"mesh\":0}]", MESH("1")), ST_EINVAL, "a tree"},
        {SCENE("[{\"children\":[7]}]", MESH("1")), ST_EINVAL, "a tree"},
        {SCENE("[{\"children\":[-1]}]", MESH("1")), ST_EINVAL, "a tree"},
        {SCENE("[{\"mesh\":0,\"matrix\":[1]}]", MESH("1")), ST_EINVAL,
         "transform of node 0"},
        {SCENE("[{\"mesh\":0,\"scale\":[1,1,\"x\"]}]", MESH("1")), ST_EINVAL,
         "transform"},
        {SCENE("[{\"mesh\":0}]", MESH("9")), ST_EINVAL, "accessor 9"},
        {SCENE("[{\"mesh\":0}]", MESH("0")), ST_EINVAL, "not a SCALAR"},
        {SCENE("[{\"mesh\":0}]", MESH("-1")), ST_EINVAL, "indices"},
        {SCENE("[{\"mesh\":0}]",
               "[{\"primitives\":[{\"attributes\":{\"POSITION\":1}}]}]"),
         ST_EINVAL, "not a VEC3"},
        {SCENE("[{\"mesh\":0}]", "{}"), ST_EINVAL, "meshes is not an array"},
        {"{\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0}],\"meshes\":" MESH(
             "1") "," SHARED("140") ",\"extensionsRequired\":[\"KHR_draco_mesh_compression\"]}",
         ST_EVERSION, "KHR_draco_mesh_compression"},
    };
    /* Changes of the one file; each leads beyond the data or out of the file. */
    static const struct {
        const char *text, *instead;
        enum status st;
        const char *words;
    } change[] = {
        {"\"count\":4,", "\"count\":3,", ST_EINVAL, "is beyond its 3 vertices"},
        {"\"count\":4,", "\"count\":5,", ST_EINVAL, "beyond its bufferView"},
        {"\"count\":4,", "\"count\":9007199254740992,", ST_EINVAL,
         "beyond its bufferView"},
        {"\"byteStride\":16", "\"byteStride\":19", ST_EINVAL, "beyond its bufferView"},
        {"\"byteStride\":16", "\"byteStride\":9007199254740992", ST_EINVAL, "beyond"},
        {"\"byteStride\":16", "\"byteStride\":4", ST_EINVAL, "beyond"},
        {"\"byteLength\":64", "\"byteLength\":141", ST_EINVAL, "beyond the 140 bytes"},
        {"\"byteOffset\":64", "\"byteOffset\":97", ST_EINVAL, "beyond the 140 bytes"},
        {"\"byteOffset\":64", "\"byteOffset\":9007199254740992", ST_EINVAL, "beyond the"},
        {"\"byteOffset\":64", "\"byteOffset\":10", ST_EINVAL,
         "of a mesh is beyond its 4"},
        {"\"byteOffset\":64", "\"byteOffset\":-1", ST_EINVAL, "malformed"},
        {"\"buffer\":0", "\"buffer\":1", ST_EINVAL, "malformed"},
        {"\"bufferView\":0", "\"bufferView\":3", ST_EINVAL, "no bufferView 3"},
        {"\"bufferView\":0", "\"sparse\":{}", ST_EVERSION, "sparse"},
        {"5126", "5130", ST_EINVAL, "not a VEC3"},
        {"{\"byteLength\":140}", "{\"uri\":\"a.bin\"}", ST_EVERSION, "nothing is opened"},
        {"{\"byteLength\":140}", "{\"uri\":\"data:,\"}", ST_EVERSION,
         "nothing is opened"},
    };
    static struct scanfile f;

    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        make(&f, bad[i].text);
        scanfile_bad(&f, CLOUDFORMAT_ANY, bad[i].st, bad[i].words);
    }
    for (size_t i = 0; i < sizeof change / sizeof *change; i++) {
        const char *json = SCENE("[{\"mesh\":0}]", MESH("1"));
        const char *at = strstr(json, change[i].text);
        char other[4000];

        assert_non_null(at);
        (void)snprintf(other, sizeof other, "%.*s%s%s", (int)(at - json), json,
                       change[i].instead, at + strlen(change[i].text));
        make(&f, other);
        scanfile_bad(&f, CLOUDFORMAT_ANY, change[i].st, change[i].words);
    }
}

/* A version that is not 2; lengths that are not true; no chunks. */
TEST(test_bad_head)
{
    static struct scanfile f;

    make(&f, SCENE("[{\"mesh\":0}]", MESH("1")));
    f.bytes[4] = 1;
    scanfile_bad(&f, CLOUDFORMAT_ANY, ST_EVERSION, "version 1");
    f.bytes[4] = 2;
    f.bytes[16] = 'X';
    scanfile_bad(&f, CLOUDFORMAT_ANY, ST_EINVAL, "a chunk of JSON");
    f.bytes[16] = 'J';
    f.bytes[15] = 0x7F;
    scanfile_bad(&f, CLOUDFORMAT_ANY, ST_EINVAL, "cut off");
    f.bytes[15] = 0;
    f.bytes[8] = 8;
    f.bytes[9] = 0;
    scanfile_bad(&f, CLOUDFORMAT_ANY, ST_EINVAL, "a chunk");
    f.len = 0;
    scanfile_text(&f, "glTF");
    scanfile_bad(&f, CLOUDFORMAT_ANY, ST_EINVAL, "12 bytes");
}

/* One mesh shown by ever so many nodes is no way to a long computation. */
TEST(test_work)
{
    const struct cloudfile_options o = {.max_points = CLOUDFILE_POINTS, .max_bytes = 1};
    static struct scanfile f;
    static char json[60000];
    struct scanfile_said err;
    struct cloudpoints p;
    size_t n;

    n = (size_t)snprintf(json, sizeof json,
                         "{\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"scale\":"
                         "[1e308,1e308,1e308],\"children\":[1");
    for (int i = 2; i <= 1000; i++)
        n += (size_t)snprintf(json + n, sizeof json - n, ",%d", i);
    n += (size_t)snprintf(json + n, sizeof json - n, "]}");
    for (int i = 1; i <= 1000; i++)
        n += (size_t)snprintf(json + n, sizeof json - n,
                              ",{\"mesh\":0,\"scale\":[1e9,1e9,1e9]}");
    (void)snprintf(json + n, sizeof json - n,
                   "],\"meshes\":" MESH("1") "," SHARED("140") "}");
    make(&f, json);
    assert_int_equal(scanfile_read(f.bytes, f.len, &o, &p, &err), ST_ELIMIT);
}
