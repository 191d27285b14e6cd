/* Text files with points: headings and where the columns are, units in them, PTS. */
#include "scanfile.h"
#include "unit.h"

static void good(const char *text, struct cloudpoints *p)
{
    scanfile_good_text(text, p);
    assert_int_equal(p->format, CLOUDFORMAT_XYZ);
}

/* All of these have the points (1, 2, 3) and (4, 5, 6). */
TEST(test_columns)
{
    static const char *const texts[] = {
        "time,x,y,z\n0.5,1,2,3\n0.6,4,5,6\n",
        "z;y;x\n3;2;1\n6;5;4\n",
        "Z\tlabel\tX\tY\n3\ta b\t1\t2\n6\t\t4\t5\n",
        "\"time\",\"X\",\"Y\",\"Z\"\n\"2020-01-01, 12:00\",1,2,3\n,4,5,6\n",
        "id x y z i\n7 1 2 3 9\n8 4 5 6 9\n",
        "# id x y z\n7 1 2 3\n8 4 5 6\n",
        "//X Y Z R G B\n1 2 3 255 0 0\n4 5 6 255 0 0\n",
        "# the x and the y and then z\n1 2 3\n4 5 6\n", /* not as many as there are */
        "# a scan; in x, y and z\n1;2;3\n4;5;6\n",      /* the same */
        "a scan of somebody\n1 2 3\n4 5 6\n",           /* no heading */
        "right up front\n1 2 3\n4 5 6\n",               /* three, in this order */
        "right,up,front\n1,2,3\n4,5,6\n",
        "Points:2,Points:0,Points:1,Normals:0\n3,1,2,7\n6,4,5,7\n",
        "x_scan,x,y,z\n9,1,2,3\n9,4,5,6\n",
        "frame , X , Y , Z\r\n1 , 1 , 2 , 3\r\n2 , 4 , 5 , 6\r\n",
        "x,y,z,\n1,2,3,\n4,5,6,\n",
        "OFFSET x y z\n9 1 2 3\n9 4 5 6\n",
        "2\n1 2 3 77 255 0 0\n4 5 6 77 255 0 0\n",
        "1\n1 2 3\n1\n4 5 6\n",
        "  2 \r\n1 2 3\r\n4 5 6\r\n",
        "# exported\n2\n1,2,3\n4,5,6\n",
        "1 2 3\r4 5 6\r",
        "1,2,3\r\n4, 5 ,6 \r\n",
        "1;2;3\n4 ; 5 ; 6;\n",
        "x y z\n1 2 3 255 0 0\n4\t5\t6 skin\n",
        "# a comment\n// X Y Z\n\"X\",\"Y\",\"Z\"\n1,2,3\n\n4,5,6,#\n#\n",
        /* an index, with names or with numbers over the columns */
        ",x,y,z\n0,1,2,3\n1,4,5,6\n",
        "\tx\ty\tz\n0\t1\t2\t3\n1\t4\t5\t6\n",
        ";x;y;z\n0;1,0;2,0;3,0\n1;4,0;5,0;6,0\n",
        ",0,1,2\n0,1,2,3\n1,4,5,6\n",
        "0,1,2\n1,2,3\n4,5,6\n",
        "0;1;2;3\n1;2;3;9\n4;5;6;9\n",
        "\"\",\"V1\",\"V2\",\"V3\"\n\"1\",1,2,3\n\"2\",4,5,6\n",
        "\"x\" \"y\" \"z\"\n\"1\" 1 2 3\n\"2\" 4 5 6\n",
        "x y z\n1 1.0 2.0 3.0\n2 4.0 5.0 6.0\n",
        " x y z\n0 1.0 2.0 3.0\n1 4.0 5.0 6.0\n",
        "  x   y  z\n 1.0 2.0 3.0\n 4.0 5.0 6.0\n",
        "V1,V2,V3\n1,2,3\n4,5,6\n",
        "x1,x2,x3,x4\n1,2,3,9\n4,5,6,9\n",
        "Column1;Column2;Column3\r\n1;2;3\r\n4;5;6\r\n",
        "Points_0,Points_1,Points_2,Normals_0\n1,2,3,9\n4,5,6,9\n",
        /* quotation marks, what separates, decimal commas */
        "\"x\",\"y\",\"z\"\n\"1\",\"2.0\",\"3\"\n\"4\",\"5\",\"6\"\n",
        "\"1,0\",\"2,0\",\"3,0\"\n\"4\",\"5\",\"6\"\n",
        "sep=;\r\nx;y;z\r\n1;2;3\r\n4;5;6\r\n",
        "\"sep=;\"\n1;2;3\n4;5;6\n",
        "sep=,\n1,2,3\n4,5,6\n",
        "x;y;z\n1,0;2,0;3,0\n4,0;5,0;6,0\n",
        "1,0;2,0;3,0\n4,0;5,0;6,0\n",
        "1,0\t2,0\t3,0\n4,0\t5,0\t6,0\n",
        "x\ty\tz\n1,0\t2,0\t3,0\n4\t5\t6\n",
        /* comments and ends */
        "% x y z\n1 2 3\n4 5 6\n",
        "% made by hand\n1,2,3\n// a note\n4,5,6\n",
        "1 2 3\n4 5 6\n\x1A",
        "1 2 3\r\n4 5 6\x1A\r\n",
        "\xEF\xBB\xBF,x,y,z\r\n0,1,2,3\r\n1,4,5,6\r\n",
    };

    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        struct cloudpoints p;

        good(texts[i], &p);
        if (p.n != 2)
            fail_msg("%zu points: %s", p.n, texts[i]);
        if (p.at[0].x != 1 || p.at[0].y != 2 || p.at[0].z != 3 || p.at[1].x != 4 ||
            p.at[1].y != 5 || p.at[1].z != 6)
            fail_msg("(%g, %g, %g), ... of: %s", p.at[0].x, p.at[0].y, p.at[0].z,
                     texts[i]);
        assert_true(p.unit_mm == 0 && p.normal == NULL);
        cloudpoints_free(&p);
    }
}

/* Fields that say that a point has no value. */
TEST(test_no_value)
{
    static const char *const texts[] = {
        "x,y,z\n1,2,3\n1,,3\n,,\n4,5,6\n",
        "1,2,3\n1,2,\nNA,2,3\n4,5,6\n",
        ",x,y,z\n0,1,2,3\n1,,,\n2,null,1,1\n3,4,5,6\n",
        "x,y,z\n1,2,3\n#N/A,1,2\n1,2,#N/A\n4,5,6\n",
        "x;y;z\n1;2;3\n1;n/a;3\n\"\";2;3\n4;5;6\n",
        "t\tx\ty\tz\n0\t1\t2\t3\n0\t1\t\t3\n\t\t\tNaN\n\t4\t5\t6\n",
        "x y z\n1 2 3\nNA NA NA\n1 None 3\n4 5 6\n"};

    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        struct cloudpoints p;

        good(texts[i], &p);
        if (p.read != 4 || p.n != 2)
            fail_msg("%zu of %zu points: %s", p.n, p.read, texts[i]);
        scanfile_at(p.at[0], 1, 2, 3);
        scanfile_at(p.at[1], 4, 5, 6);
        cloudpoints_free(&p);
    }
}

TEST(test_units)
{
    static const struct {
        const char *heading;
        double mm;
    } c[] = {{"x_mm,y_mm,z_mm", 1},     {"X (m),Y (m),Z (m)", 1000},
             {"x_um,y_um,z_um", 0.001}, {"x[cm],y[cm],z[cm]", 10},
             {"x/in,y/in,z/in", 25.4},  {"x,y,z", 0}};

    for (size_t i = 0; i < sizeof c / sizeof *c; i++) {
        struct cloudpoints p;
        char text[100];

        (void)snprintf(text, sizeof text, "%s\n1,2,3\n", c[i].heading);
        good(text, &p);
        assert_true(p.unit_mm == c[i].mm);
        cloudpoints_free(&p);
    }
}

TEST(test_normals)
{
    struct cloudpoints p;

    good("x y z nx ny nz\n1 2 3 0 0 1\n4 5 6 nan 0 1\n", &p);
    scanfile_at(p.normal[0], 0, 0, 1);
    scanfile_at(p.normal[1], 0, 0, 0);
    cloudpoints_free(&p);
    good("normal_z,normal_y,normal_x,x,y,z\n3,2,1,4,5,6\n", &p);
    scanfile_at(p.at[0], 4, 5, 6);
    scanfile_at(p.normal[0], 1, 2, 3);
    cloudpoints_free(&p);
    good("x y z nx ny\n1 2 3 0 0\n", &p);
    assert_null(p.normal);
    cloudpoints_free(&p);
}

TEST(test_bad)
{
    static const struct scanfile_case bad[] = {
        {"time,px,py,pz\n0,1,2,3\n", ST_EINVAL, "one column x, one y and one z"},
        {"time,x,y,z,x\n0,1,2,3,4\n", ST_EINVAL, "one column x, one y and one z"},
        {"time,x,y\n0,1,2\n", ST_EINVAL, "one column x, one y and one z"},
        {"time,x,y,z\n0,1,2\n", ST_EINVAL, "too few numbers"},
        {"x,y,z\n1,2,3\n1,-,3\n", ST_EINVAL, "a number is expected"},
        {"1 2 3\n1 2 \"3\n", ST_EINVAL, "line 2: a number is expected"},
        {"1 2 3\nx y z\n", ST_EINVAL, "line 2: a number is expected"},
        {"1,,2,3\n", ST_ENOTFINITE, "none of the 1 points"},
        {"1 inf 3\n", ST_ENOTFINITE, "none of the 1 points"},
        {"nan nan nan\n0 0 0\n0 0 0\n", ST_ENOTFINITE, "none of the 3 points"},
        {"1 2 3\n4 5 6 \x7f\n", ST_EINVAL, "line 2: binary data"},
        {"1,5\t2,5 3,5\n", ST_EINVAL, "is it a decimal comma?"},
        {"", ST_EINVAL, "line 1: there are no points"},
        {"\n\n# only\n", ST_EINVAL, "no points"},
        {"x,y,z\n1,2,3 4\n", ST_EINVAL, "is it a decimal comma?"},
        {"1,5 2,5 3,5\n", ST_EINVAL, "is it a decimal comma?"},
        {"root:x:0:0:root:/root\nbin:x:1:1:bin:/bin\n", ST_EINVAL, "no list of numbers"},
        {"Dear all,\nthe scan, as agreed, is below\n", ST_EINVAL, "no list of numbers"},
        {"a note, and nothing else\n", ST_EINVAL, "this is no list of numbers"},
        {"x,y,z\n", ST_EINVAL, "no points"},
        {"a,b,c,d\none,two,three,four\n", ST_EINVAL, "no list of numbers"},
        {"3\n1 2 3\n4 5 6\n", ST_EINVAL, "1 points fewer"},
        {"1\n1 2 3\n4 5 6\n", ST_EINVAL, "more points than the count"},
        {"2\n1 2 3\n1\n4 5 6\n", ST_EINVAL, "1 points fewer"},
        {"7\n", ST_EINVAL, ""},
        {"999999999999999999999\n1 2 3\n", ST_EINVAL, ""},
        {"480\n640\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n", ST_EVERSION, "PTX"},
    };

    scanfile_refused(bad, sizeof bad / sizeof *bad);
}
