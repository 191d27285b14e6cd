/* FRGC's range images: four lists after each other, on any number of lines; points whose flag
 * is 0; headers that are not true. */
#include "scanfile.h"
#include "unit.h"

#define HEAD "2 rows\n3 columns\npixels (flag X Y Z):\n"

TEST(test_points)
{
    static const char *const texts[] = {
        HEAD "0 1 1 0 0 1\n-999999.0 1 2 -999999.0 -999999.0 3\n"
             "-999999.0 4 5 -999999.0 -999999.0 6\n-999999.0 7 8 -999999.0 -999999.0 9\n",
        "2  rows \r\n3  columns \r\npixels (flag X Y Z): \r\n"
        "0 1 1\r\n 0 0 1\r\nnone 1 2\r\nx x 3\r\n\r\n"
        "x 4 5 x x 6 x 7 8 x x 9",
    };
    static struct scanfile f;
    struct cloudpoints p;

    for (int i = 0; i < 4; i++) {
        f.len = 0;
        scanfile_text(&f, texts[i / 2]);
        scanfile_good(&f, i % 2 == 0 ? CLOUDFORMAT_ANY : CLOUDFORMAT_ABS, &p);
        assert_true(p.format == CLOUDFORMAT_ABS && p.unit_mm == 0 && p.normal == NULL);
        assert_true(p.n == 3 && p.read == 6 && p.width == 3 && p.height == 2);
        scanfile_at(p.at[0], 1, 4, 7);
        scanfile_at(p.at[1], 2, 5, 8);
        scanfile_at(p.at[2], 3, 6, 9);
        assert_true(p.index[0] == 1 && p.index[1] == 2 && p.index[2] == 5);
        cloudpoints_free(&p);
    }
    scanfile_cut(&f, CLOUDFORMAT_ABS);
}

TEST(test_bad)
{
    static const struct scanfile_case bad[] = {
        {"2 rows", ST_EINVAL, "line 1: a line like \"480 columns\""},
        {"2 rows\n", ST_EINVAL, "line 2: a line like \"480 columns\""},
        {"2 rows\n3 rows\n", ST_EINVAL, "line 2: a line like \"480 columns\""},
        {"2 rows\n3 columns\npixels (flag X Y Z R G B):\n", ST_EVERSION,
         "line 3: \"pixels (flag X Y Z):\""},
        {"2 rows\n3 columns\n", ST_EVERSION, "line 3: \"pixels (flag X Y Z):\""},
        {"2 rows\n4294967296 columns\npixels (flag X Y Z):\n", ST_EINVAL, "too large"},
        {"4294967295 rows\n4294967295 columns\npixels (flag X Y Z):\n1 2 3\n", ST_EINVAL,
         "promises 18446744065119617025 values, the list flags ends after 3"},
        {"0 rows\n3 columns\npixels (flag X Y Z):\n", ST_EINVAL, "no points"},
        {HEAD "1 1 1 1 1 1\n1 1 1 1 1 1\n1 1 1 1 1 1\n1 1 1 1 1\n", ST_EINVAL,
         "line 8: the header promises 6 values, the list Z ends after 5"},
        {HEAD "1 1 1 1 1 1\n1 1 1 1 1 1\n1 1 1 1 1 1\n1 1 1 1 1 1 1\n", ST_EINVAL,
         "line 7: more values than the header promises"},
        {HEAD "1 1 1 1 1 1\n1 1 1 1 1 1\n1 1 x 1 1 1\n1 1 1 1 1 1\n", ST_EINVAL,
         "line 6: a number is expected here"},
        {HEAD "1 1 x 1 1 1\n1 1 1 1 1 1\n1 1 1 1 1 1\n1 1 1 1 1 1\n", ST_EINVAL,
         "line 4: a number is expected here"},
        {HEAD "1 1 1 1 1 1\n1,1,1,1,1,1 1 1 1 1 1\n1 1 1 1 1 1\n1 1 1 1 1 1\n", ST_EINVAL,
         "line 5: a number is expected here"},
        {HEAD "1 1\001 1 1 1\n", ST_EINVAL, "line 4: binary data"},
        {HEAD "0 0 0 0 0 0\n0 0 0 0 0 0\n0 0 0 0 0 0\n0 0 0 0 0 0\n", ST_ENOTFINITE,
         "none of the 6 points"},
    };

    scanfile_refused(bad, sizeof bad / sizeof *bad);
}
