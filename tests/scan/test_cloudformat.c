/* Formats by their names, and by what a file begins with; what is refused by name; files
 * compressed by gzip. */
#include <zlib.h>

#include "scanfile.h"
#include "unit.h"

TEST(test_endings)
{
    static const struct {
        const char *name, *ending;
    } c[] = {{"a.ply", ".ply"},
             {"a_b.PLY", ".PLY"},
             {"a.ply.gz", ".ply.gz"},
             {"A.OBJ.GZ", ".OBJ.GZ"},
             {"a.txt", ".txt"},
             {"a.WRZ", ".WRZ"},
             {"04221d550.abs.gz", ".abs.gz"},
             {"a.raw.gz", ".raw.gz"},
             {".ply", NULL},
             {"ply", NULL},
             {"a.gz", NULL},
             {"a.off", NULL},
             {"a.ply.bak", NULL},
             {"aply", NULL},
             {"", NULL},
             {".gz", NULL}};

    for (size_t i = 0; i < sizeof c / sizeof *c; i++) {
        const char *ending = cloudformat_ending(c[i].name);

        if (c[i].ending == NULL)
            assert_null(ending);
        else
            assert_string_equal(ending, c[i].ending);
    }
}

TEST(test_foreign)
{
    static const struct {
        const char *bytes;
        size_t len;
        const char *name;
    } c[] = {{"OFF\n3 1 0\n0 0 0\n", 16, "an OFF file"},
             {"PK\x03\x04\x14\0", 6, "3MF, XLSX"},
             {"Kaydara FBX Binary  \0", 21, "an FBX file"},
             {"; FBX 7.3.0 project file\n", 25, "an FBX file"},
             {"<?xml version=\"1.0\"?>\n<COLLADA>", 32, "DAE"},
             {"ASTM-E57\1\0\0\0", 12, "an E57 file"},
             {"LASF\0\0\0\0", 8, "a LAS file"},
             {"# vtk DataFile Version 3.0\n", 27, "a VTK file"},
             {"\xFF\xD8\xFF\xE0", 4, "a JPEG picture"},
             {"II*\0\x08", 5, "a TIFF picture"},
             {"\0\0\0\x18"
              "ftypheic",
              12, "a HEIC picture"},
             {"\xFF\xFE\x31\0", 4, "UTF-16"},
             {"\0\0\0\0\0\0", 6, "not a scan in a format"},
             {"\x7F"
              "ELF",
              4, "a program (ELF)"},
             {"\0\0\0\x14"
              "ftypqt  ",
              12, "a QuickTime video"},
             {"\0\0\0\x18"
              "ftypisom",
              12, "an MP4 video"},
             {"GIF89a", 6, "a GIF picture"},
             {"#ROSBAG V2.0\n", 13, "a ROS bag"},
             {"PAR1\x15\x04", 6, "a Parquet file"},
             {"SQLite format 3\0", 16, "an SQLite database"},
             {"RIFF\x24\0\0\0WAVEfmt ", 16, "a WAV recording"},
             {"version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 9\n", 64,
              "Git LFS"},
             {"ISO-10303-21;\nHEADER;\n", 22, "a STEP file"},
             {"  0\r\nSECTION\r\n  2\r\nHEADER\r\n", 27, "a DXF file"},
             {"# Blender\n\nnewmtl skin\nKd 1 1 1\n", 32, "MTL"},
             {"xof 0303txt 0032\n", 17, "a DirectX file"},
             {"\n <!DOCTYPE html>\n<html><body>1 2 3</body></html>\n", 50, "a web page"}};

    for (size_t i = 0; i < sizeof c / sizeof *c; i++) {
        struct scanfile f = {.len = 0};

        scanfile_put(&f, c[i].bytes, c[i].len);
        scanfile_bad(&f, CLOUDFORMAT_ANY, ST_EVERSION, c[i].name);
        scanfile_bad(&f, CLOUDFORMAT_ANY, ST_EVERSION,
                     "PLY, OBJ, STL, PCD, GLB, VRML, XYZ, PTS");
    }
}

/* Binary data after a program has converted it as text; the text around them is not said to be. */
TEST(test_converted)
{
    static const char *const head =
        "ply\nformat binary_little_endian 1.0\nelement vertex 400\n"
        "property float x\nproperty float y\nproperty float z\n"
        "end_header\n";
    static struct scanfile plain, changed[5];
    static const char words[] =
        "is damaged, or 1 2 3 \xC3\xA9\xC3\xA9\xC3\xA9\xC3\xA9\xC3\xA9"
        "\xC3\xA9\xC3\xA9\xC3\xA9\xC3\xA9\n";
    struct cloudpoints p;

    plain.len = 0;
    scanfile_text(&plain, head);
    for (int i = 0; i < 1200; i++)
        scanfile_real(&plain, 0.37 * i - 200, 4, false);
    scanfile_good(&plain, CLOUDFORMAT_ANY, &p);
    cloudpoints_free(&p);
    for (size_t i = 0; i < plain.len; i++) {
        const unsigned char c = plain.bytes[i],
                            latin[] = {(unsigned char)(0xC0 | c >> 6),
                                       (unsigned char)(0x80 | (c & 63))};

        scanfile_put(&changed[0], c < 0x80 ? &c : (const unsigned char *)"\xEF\xBF\xBD",
                     c < 0x80 ? 1 : 3);
        scanfile_put(&changed[1], c < 0x80 ? &c : latin, c < 0x80 ? 1 : 2);
        scanfile_put(&changed[2], "\r", c == '\n');
        scanfile_put(&changed[2], &c, 1);
        scanfile_put(&changed[4], c < 0x80 ? &c : (const unsigned char *)"?", 1);
    }
    scanfile_text(&changed[3], "\x89PNG\n\x1A\n");
    scanfile_put(&changed[3], "\0\0\0\rIHDR", 8);
    for (int i = 0; i < 5; i++) {
        scanfile_bad(&changed[i], CLOUDFORMAT_ANY, ST_EINVAL, "binary mode");
        scanfile_bad(&changed[i], CLOUDFORMAT_STL, ST_EINVAL, "binary mode");
    }
    plain.len = 0;
    scanfile_text(&plain, words);
    scanfile_text(&plain, words);
    scanfile_bad(&plain, CLOUDFORMAT_ANY, ST_EINVAL, "no list of numbers");
}

TEST(test_json)
{
    static const char *const good[] = {
        "{\"points\": [[1,2,3],[4,5,6]], \"units\": \"in\"}",
        "\xEF\xBB\xBF \n{\"units\":\"in\",\"points\":[[1,2,3],[4e0,5.0,6]]}\n"};
    static const struct scanfile_case bad[] = {
        {"{\"asset\": {\"version\": \"2.0\"}}", ST_EVERSION, "glTF as text"},
        {"{\"x\": [1,4], \"y\": [2,5], \"z\": [3,6]}", ST_EVERSION, "columns x, y and z"},
        {"{\"pts\": [[1,2,3]]}", ST_EINVAL,
         "the JSON: unknown member \"pts\"; allowed: points, units and axes"},
        {"[[1,2,3],[4,5]]", ST_EINVAL, "points[1] is not three finite numbers"},
        {"[[1,2,3],[4,NaN,5]]", ST_EINVAL, "NaN is no number of JSON"},
        {"{\"points\": [[1,2,-Infinity]]}", ST_EINVAL, "Infinity is no number of JSON"},
        {"{\"points\": [[1,2,1e999]]}", ST_ENOTFINITE, "points[0]"},
        {"{\"points\": [[1,2,3]], \"units\": \"ell\"}", ST_EINVAL,
         "units must be auto, mm, cm, m, in or um"},
        {"{\"points\": [[1,2,3]], \"axes\": \"camera\"}", ST_EINVAL,
         "axes must be auto or scanner"},
        {"{\"points\": [[1,2,3]], \"axes\": null}", ST_EINVAL,
         "axes must be auto or scanner"},
    };
    struct scanfile f;
    struct cloudpoints p;

    for (int i = 0; i < 2; i++) {
        f.len = 0;
        scanfile_text(&f, good[i]);
        scanfile_good(&f, i == 0 ? CLOUDFORMAT_ANY : CLOUDFORMAT_JSON, &p);
        assert_true(p.format == CLOUDFORMAT_JSON && p.n == 2 && p.unit_mm == 25.4);
        scanfile_at(p.at[1], 4, 5, 6);
        cloudpoints_free(&p);
    }
    scanfile_refused(bad, sizeof bad / sizeof *bad);
    scanfile_good_text(
        "{\"points\": [[1,2,3]], \"units\": \"auto\", \"axes\": \"scanner\"}", &p);
    assert_true(p.unit_mm == 0 && p.axes_given);
    cloudpoints_free(&p);
    scanfile_good_text("\xEF\xBB\xBF[[1,2,3],\n [4,5,6]]\n", &p);
    assert_true(p.format == CLOUDFORMAT_JSON && p.n == 2 && p.unit_mm == 0);
    scanfile_at(p.at[1], 4, 5, 6);
    cloudpoints_free(&p);
    scanfile_good_text("{\"points\": [[1,2,3]], \"axes\": \"auto\"}", &p);
    assert_true(p.unit_mm == 0 && !p.axes_given);
    cloudpoints_free(&p);
}

/* Declared as something else than it is. */
TEST(test_declared)
{
    struct scanfile f = {.len = 0};

    scanfile_text(&f, "v 1 2 3\nv 4 5 6\n");
    scanfile_bad(&f, CLOUDFORMAT_STL, ST_EINVAL, "this is OBJ, not STL as declared");
    scanfile_bad(&f, CLOUDFORMAT_GLB, ST_EINVAL, "this is OBJ, not GLB as declared");
    scanfile_bad(&f, CLOUDFORMAT_PNG, ST_EINVAL, "this is OBJ, not PNG as declared");
    scanfile_bad(&f, CLOUDFORMAT_JSON, ST_EINVAL, "this is OBJ, not JSON as declared");
    f.len = 0;
    scanfile_text(&f, "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    scanfile_bad(&f, CLOUDFORMAT_XYZ, ST_EVERSION, "an OFF file");
    f.len = 0;
    scanfile_text(&f, "1 2 3\n4 5 6\n");
    scanfile_bad(&f, CLOUDFORMAT_PLY, ST_EINVAL, "a PLY file begins with the word ply");
}

static void pack(struct scanfile *f, const void *bytes, size_t len)
{
    z_stream z = {0};

    assert_int_equal(deflateInit2(&z, 9, Z_DEFLATED, 31, 8, Z_DEFAULT_STRATEGY), Z_OK);
    z.next_in = (unsigned char *)(uintptr_t)bytes;
    z.avail_in = (unsigned)len;
    z.next_out = f->bytes;
    z.avail_out = sizeof f->bytes;
    assert_int_equal(deflate(&z, Z_FINISH), Z_STREAM_END);
    f->len = z.total_out;
    (void)deflateEnd(&z);
}

TEST(test_gzip)
{
    static unsigned char zeros[2 << 20];
    struct scanfile f, twice;
    struct cloudpoints p;

    pack(&f, "v 1 2 3\nv 4 5 6\n", 16);
    scanfile_good(&f, CLOUDFORMAT_ANY, &p);
    assert_true(p.format == CLOUDFORMAT_OBJ && p.n == 2);
    cloudpoints_free(&p);
    scanfile_good(&f, CLOUDFORMAT_OBJ, &p);
    cloudpoints_free(&p);
    scanfile_bad(&f, CLOUDFORMAT_STL, ST_EINVAL, "STL");
    scanfile_cut(&f, CLOUDFORMAT_ANY);
    pack(&twice, f.bytes, f.len);
    scanfile_bad(&twice, CLOUDFORMAT_ANY, ST_EVERSION, "a gzip file inside a gzip file");
    f.bytes[f.len - 1]++;
    scanfile_bad(&f, CLOUDFORMAT_ANY, ST_EINVAL, "gzip");
    pack(&f, zeros, sizeof zeros);
    scanfile_bad(&f, CLOUDFORMAT_ANY, ST_ESIZE, "1048576 bytes when unpacked");
    pack(&f, "", 0);
    scanfile_bad(&f, CLOUDFORMAT_ANY, ST_EINVAL, "no points");
}
