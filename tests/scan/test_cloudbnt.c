/* The Bosphorus database's files: points by blocks, missing ones, headers that are not true. */
#include "scanfile.h"
#include "unit.h"

#define ZMIN (-1e9)

static void make(struct scanfile *f, unsigned rows, unsigned columns, const char *name)
{
    const double none[3] = {ZMIN, ZMIN, ZMIN};
    const double point[3][3] = {{-1, 2, -30}, {0, 0, 0}, {5, 6, -40}};

    f->len = 0;
    scanfile_whole(f, rows, 2, false);
    scanfile_whole(f, columns, 2, false);
    scanfile_real(f, ZMIN, 8, false);
    scanfile_whole(f, strlen(name), 2, false);
    scanfile_text(f, name);
    scanfile_whole(f, 5 * rows * columns, 4, false);
    for (size_t block = 0; block < 5; block++)
        for (size_t i = 0; i < rows * columns; i++)
            scanfile_real(f,
                          block > 2   ? 0.5
                          : i % 4 < 3 ? point[i % 4][block]
                                      : none[block],
                          8, false);
}

TEST(test_points)
{
    static const char *const names[] = {"", "a_0.png"};
    static struct scanfile f;
    struct cloudpoints p;

    for (int i = 0; i < 4; i++) {
        make(&f, 2, 2, names[i / 2]);
        scanfile_good(&f, i % 2 == 0 ? CLOUDFORMAT_ANY : CLOUDFORMAT_BNT, &p);
        assert_true(p.format == CLOUDFORMAT_BNT && p.unit_mm == 0 && p.normal == NULL);
        assert_true(p.n == 3 && p.read == 4 && p.width == 0 && p.height == 0);
        scanfile_at(p.at[0], -1, 2, -30);
        scanfile_at(p.at[1], 0, 0, 0);
        scanfile_at(p.at[2], 5, 6, -40);
        assert_true(p.index[2] == 2);
        cloudpoints_free(&p);
    }
    scanfile_cut(&f, CLOUDFORMAT_ANY);
    scanfile_cut(&f, CLOUDFORMAT_BNT);
    make(&f, '<', 1, ""); /* 60 rows, and no XML */
    scanfile_good(&f, CLOUDFORMAT_ANY, &p);
    assert_int_equal(p.n, 30); /* the points at (0, 0, 0) are none */
    cloudpoints_free(&p);
}

TEST(test_bad)
{
    static struct scanfile f;

    make(&f, 2, 2, "a");
    f.len -= 8;
    scanfile_bad(&f, CLOUDFORMAT_ANY, ST_EINVAL,
                 "byte 0: 4 points take 179 bytes, the BNT file has 171");
    f.len += 9;
    scanfile_bad(&f, CLOUDFORMAT_ANY, ST_EINVAL, "the BNT file has 180");
    make(&f, 2, 2, "a");
    f.bytes[15]++; /* not five times the product */
    scanfile_bad(&f, CLOUDFORMAT_ANY, ST_EVERSION, "not a scan in a format");
    scanfile_bad(&f, CLOUDFORMAT_BNT, ST_EINVAL, "a BNT file begins with rows, columns");
    make(&f, 0, 0, "a");
    scanfile_bad(&f, CLOUDFORMAT_BNT, ST_EINVAL, "a BNT file begins with rows, columns");
    make(&f, 2, 2, "a");
    f.bytes[12] = f.bytes[13] = 0xFF; /* a name of 65535 bytes */
    scanfile_bad(&f, CLOUDFORMAT_BNT, ST_EINVAL, "a BNT file begins with rows, columns");
    memset(f.bytes, 0xFF, f.len);
    scanfile_bad(&f, CLOUDFORMAT_BNT, ST_EINVAL, "a BNT file begins with rows, columns");
    make(&f, 1, 1, "");
    for (size_t i = 34; i < 42; i++)
        f.bytes[i] = f.bytes[i - 30]; /* z is what stands for none */
    scanfile_bad(&f, CLOUDFORMAT_ANY, ST_ENOTFINITE, "none of the 1 points");
}
