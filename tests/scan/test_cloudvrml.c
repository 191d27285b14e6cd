/* VRML 1.0 and 2.0: points by their nodes and transforms, normals by the faces, names, and
 * what is not read. */
#include "scanfile.h"
#include "unit.h"

#define V1     "#VRML V1.0 ascii\n"
#define V2     "#VRML V2.0 utf8\n"
#define SQUARE "point [ 0 0 1, 2 0 1, 2 3 1, 0 3 1 ]"
#define FACES  "coordIndex [ 0, 1, 2, -1, 0, 2, 3, -1 ]"

static void make(struct scanfile *f, const char *text)
{
    f->len = 0;
    scanfile_text(f, text);
}

/* A square of two triangles, or of a quadrangle. */
static const char *const squares[] = {
    V2 "Shape { geometry IndexedFaceSet { coord Coordinate { " SQUARE " } " FACES " } }",
    /* faces before their points; comments, strings and names in the way */
    V2 "# { [ \"\nWorldInfo{title\"a } \\\" # b\"info[\"c]\",\"d\\\\\"]}\r\n"
       "DEF Face Group{children[DEF A Shape{geometry DEF B IndexedFaceSet{solid FALSE,"
       "coordIndex[0 1,2 3 -1]texCoord TextureCoordinate{point[0 0,1 0,1 1,0 1]}"
       "texCoordIndex[0 1 2 3 -1]coord DEF C Coordinate{point[0 0 1 2 0 1 2 3 1,\n"
       "0,3,1,]}}appearance Appearance{texture ImageTexture{url\"a.png\"}}}]}",
    V2 "Shape { geometry IndexedFaceSet { ccw FALSE coord Coordinate { " SQUARE " }\n"
       "coordIndex [ 2 1 0 -1 3, 2, 0 ] normal Normal { vector [ 0 0 1 ] } } }",
    V2
    "Group { children [ DEF L Shape { geometry IndexedLineSet { coordIndex [ 0 1 -1 ] } }\n"
    "Shape { geometry IndexedFaceSet { coord DEF C Coordinate { " SQUARE " } "
    "coordIndex [ 0 1 2 -1 ] } } USE L\n"
    "Shape { geometry IndexedFaceSet { coord USE C coordIndex [ 0 2 3 -1 ] } } ] }\n"
    "ROUTE L.translation TO L.center",
    V1 "Separator { Coordinate3 { " SQUARE " } IndexedFaceSet { " FACES " } }",
    V1
    "DEF a Separator { Info { string \"{\" } DEF C Coordinate3 { " SQUARE " }\n"
    "Separator { Coordinate3 { point [ ] } }\n"
    "TextureCoordinate2 { point [ 0 0, 1 0, 1 1, 0 1 ] }\n"
    "Group { ShapeHints { vertexOrdering CLOCKWISE faceType CONVEX } }\n"
    "IndexedFaceSet { coordIndex [ 2 1 0 -1 3 2 0 -1 ] textureCoordIndex [ 0 1 2 -1 ] } }",
};

TEST(test_square)
{
    static struct scanfile f;
    struct cloudpoints p;

    for (size_t i = 0; i < sizeof squares / sizeof *squares; i++) {
        make(&f, squares[i]);
        scanfile_good(&f, i % 2 == 0 ? CLOUDFORMAT_ANY : CLOUDFORMAT_VRML, &p);
        assert_true(p.format == CLOUDFORMAT_VRML && p.n == 4 && p.read == 4);
        assert_true(p.unit_mm == 0 && p.width == 0 && p.height == 0);
        scanfile_at(p.at[0], 0, 0, 1);
        scanfile_at(p.at[1], 2, 0, 1);
        scanfile_at(p.at[2], 2, 3, 1);
        scanfile_at(p.at[3], 0, 3, 1);
        scanfile_at(p.normal[0], 0, 0, 12);
        scanfile_at(p.normal[1], 0, 0, 6);
        scanfile_at(p.normal[2], 0, 0, 12);
        scanfile_at(p.normal[3], 0, 0, 6);
        cloudpoints_free(&p);
    }
}

/* No faces, or some that cannot be read: the points stay. */
TEST(test_faces)
{
    static const char *const index[] = {
        "",
        "coordIndex [ ]",
        "coordIndex [ 0 1 -1 0 1 -1 ]",
        "coordIndex [ 0 1 2 -1 0 1 4 -1 ]",
        "coordIndex [ 0 1 2 -1 0 1 -2 -1 ]",
        "coordIndex [ 0 1 2 -1 0 1 2.5 -1 ]",
        "coordIndex [ 0 1 2 -1 0 1 99999999999999999999 -1 ]",
    };
    char text[300];
    struct cloudpoints p;

    for (size_t i = 0; i < sizeof index / sizeof *index; i++) {
        (void)snprintf(text, sizeof text,
                       V2 "Shape { geometry IndexedFaceSet { coord Coordinate { " SQUARE
                          " } %s } }",
                       index[i]);
        scanfile_good_text(text, &p);
        assert_true(p.n == 4 && p.normal == NULL);
        cloudpoints_free(&p);
    }
}

static void near(struct dvec3 p, double x, double y, double z)
{
    if (!(fabs(p.x - x) < 1e-9 && fabs(p.y - y) < 1e-9 && fabs(p.z - z) < 1e-9))
        fail_msg("%g %g %g, not %g %g %g", p.x, p.y, p.z, x, y, z);
}

#define POINTS                                                                           \
    "Shape { geometry PointSet { coord Coordinate { point [ 1 2 3, 2 2 3 ] } } }"
#define QUARTER "rotation 0 0 5 1.5707963267948966 "

/* Where they leave the points (1, 2, 3) and (2, 2, 3). */
TEST(test_transforms)
{
    static const struct {
        const char *text;
        double at[2][3];
    } c[] = {
        {V2 "Transform { children " POINTS " }", {{1, 2, 3}, {2, 2, 3}}},
        {V2 "Transform { translation 10 0 0 scale 2 2 2 children [ " POINTS " ] }",
         {{12, 4, 6}, {14, 4, 6}}},
        {V2 "Transform { " QUARTER "children [ " POINTS " ] }", {{-2, 1, 3}, {-2, 2, 3}}},
        {V2 "Transform { rotation 0 0 0 1 children [ " POINTS " ] }",
         {{1, 2, 3}, {2, 2, 3}}},
        {V2 "Transform { center 1 2 3 scale 3 1 1 " QUARTER "children [ " POINTS " ] }",
         {{1, 2, 3}, {1, 5, 3}}},
        {V2 "Transform { translation 0 0 1 children Transform { scale 2 2 2\n"
            "scaleOrientation 0 1 0 1 children [ Group { children " POINTS " } ] } }",
         {{2, 4, 7}, {4, 4, 7}}},
        {V2 "Transform { translation 5 5 5 children [ Shape { } ] }\n" POINTS,
         {{1, 2, 3}, {2, 2, 3}}},
        {V1 "Separator { Translation { translation 10 0 0 } Scale { scaleFactor 2 2 2 }\n"
            "Rotation { " QUARTER "} Coordinate3 { point [ 1 2 3, 2 2 3 ] } }",
         {{6, 2, 6}, {6, 4, 6}}},
        {V1 "Separator { Separator { Transform { translation 9 9 9 } }\n"
            "Group { Transform { translation 1 0 0 scaleFactor 1 1 2 } }\n"
            "Coordinate3 { point [ 1 2 3, 2 2 3 ] } }",
         {{2, 2, 6}, {3, 2, 6}}},
    };
    struct cloudpoints p;

    for (size_t i = 0; i < sizeof c / sizeof *c; i++) {
        scanfile_good_text(c[i].text, &p);
        assert_int_equal(p.n, 2);
        for (size_t k = 0; k < 2; k++)
            near(p.at[k], c[i].at[k][0], c[i].at[k][1], c[i].at[k][2]);
        cloudpoints_free(&p);
    }
}

/* The normals are those of the points as they were moved; several lists of points. */
TEST(test_moved_faces)
{
    static struct scanfile f;
    struct cloudpoints p;

    make(&f,
         V2 "Transform { rotation 1 0 0 1.5707963267948966 children [ Shape { geometry "
            "IndexedFaceSet { coord Coordinate { " SQUARE " } " FACES " } } ] }\n"
            "Shape { geometry IndexedFaceSet { coord Coordinate {\n" SQUARE
            " } coordIndex [ 0 1 2 -1 ] } }");
    scanfile_good(&f, CLOUDFORMAT_ANY, &p);
    assert_int_equal(p.n, 8);
    near(p.normal[0], 0, -12, 0);
    near(p.normal[4], 0, 0, 6);
    near(p.normal[7], 0, 0, 0);
    cloudpoints_free(&p);
}

TEST(test_bad)
{
    static const struct scanfile_case bad[] = {
        {V2, ST_EINVAL, "no points"},
        {V2 "Shape { geometry Box { } }", ST_EINVAL, "no points"},
        {V2 "Shape { geometry X { texCoord TextureCoordinate { point [ 1 2 ] } } }",
         ST_EINVAL, "no points"},
        {"#VRML V3.0 utf8\nShape { }", ST_EVERSION, "another version than 1.0 and 2.0"},
        {"#VRML", ST_EVERSION, "another version than 1.0 and 2.0"},
        {V2 "Group {\nchildren [\nCoordinate { point [ 1 2 3, 4 5 ] }", ST_EINVAL,
         "line 4: a number is expected here"},
        {V2 "Coordinate { point [ 1 2 x ] }", ST_EINVAL, "line 2: a number is expected"},
        {V2 "Coordinate { point [ 1 2 \"3\" ] }", ST_EINVAL, "a number is expected here"},
        {V2 "Coordinate { point 1 2 3 }", ST_EINVAL, "a list of points is expected here"},
        {V2 "IndexedFaceSet { coordIndex 0 1 2 }", ST_EINVAL, "a list of corners"},
        {V2 "IndexedFaceSet { coordIndex [ 0 1 { ] }", ST_EINVAL, "a number is expected"},
        {V2 "IndexedFaceSet { ccw { } }", ST_EINVAL, "a word is expected here"},
        {V2 "Transform { translation 1 2 children [ ] }", ST_EINVAL,
         "a number is expected here"},
        {V2 "Transform { scale 1 -1 1 }", ST_EINVAL, "a scale is not above 0"},
        {V2 "Transform { scale 1 0 1 }", ST_EINVAL, "a scale is not above 0"},
        {V2 "Transform { scale nan 1 1 }", ST_EINVAL, "a scale is not above 0"},
        {V2 "Transform { scale 1 2 3 scaleOrientation 0 1 0 1 }", ST_EVERSION,
         "VRML with a scaleOrientation is not read"},
        {V2 "Transform { children " POINTS " translation 1 2 3 }", ST_EVERSION,
         "a transform behind the points"},
        {V2 "Transform { translation inf 0 0 children " POINTS " }", ST_ENOTFINITE,
         "none of the 2 points"},
        {V2 "Shape { \n { } }", ST_EINVAL, "line 3: a node without its type"},
        {V2 "Shape { ]", ST_EINVAL, "a closing bracket without an opening one"},
        {V2 "}", ST_EINVAL, "a closing bracket without an opening one"},
        {V2 "Group { children [ }", ST_EINVAL,
         "a closing bracket without an opening one"},
        {V2 "Coordinate { " SQUARE, ST_EINVAL, "the VRML file ends within a node"},
        {V2 "Info { \"a } ", ST_EINVAL, "the VRML file ends within a node"},
        {V2 "DEF { }", ST_EINVAL, "a name is expected here"},
        {V2 "USE [ ]", ST_EINVAL, "a name is expected here"},
        {V2 "PROTO A [ ] { }", ST_EVERSION, "VRML with PROTO is not read"},
        {V2 "EXTERNPROTO A [ ] \"a.wrl\"", ST_EVERSION, "with EXTERNPROTO is not read"},
        {V2 "Group { children [ Inline { url \"a.wrl\" } ] }", ST_EVERSION,
         "VRML with Inline is not read"},
        {V1 "WWWInline { name \"a.wrl\" }", ST_EVERSION,
         "VRML with WWWInline is not read"},
        {V2 "LOD { level [ ] }", ST_EVERSION, "VRML with LOD is not read"},
        {V1 "Switch { whichChild 0 }", ST_EVERSION, "VRML with Switch is not read"},
        {V1 "MatrixTransform { matrix 1 0 0 0 }", ST_EVERSION,
         "VRML with MatrixTransform is not read"},
        {V2 "DEF A " POINTS " Transform { translation 1 0 0 children USE A }",
         ST_EVERSION, "USE of points in another place"},
        {V2
         "Shape { geometry PointSet { coord DEF C Coordinate { " SQUARE " } } }\n"
         "Transform { scale 2 2 2 children Shape { geometry PointSet { coord USE C } } }",
         ST_EVERSION, "line 3: VRML with USE of points in another place"},
        {V2 "Coordinate { point [ 1 2 3 ] }\001", ST_EINVAL, "binary data inside text"},
    };
    static struct scanfile f;

    scanfile_refused(bad, sizeof bad / sizeof *bad);
    make(&f, "Shape { }");
    scanfile_bad(&f, CLOUDFORMAT_VRML, ST_EINVAL, "a VRML file begins with #VRML");
}

/* Cut off anywhere, but for the end of what follows the last node. */
TEST(test_cut)
{
    static struct scanfile f;

    for (size_t i = 0; i < sizeof squares / sizeof *squares; i++) {
        make(&f, squares[i]);
        while (f.bytes[f.len - 1] != '}')
            f.len--;
        scanfile_cut(&f, CLOUDFORMAT_VRML);
    }
}

TEST(test_limits)
{
    static struct scanfile f;
    struct cloudpoints p;

    for (int depth = 62; depth < 65; depth++) {
        make(&f, V2);
        for (int i = 1; i < depth; i++)
            scanfile_text(&f, "Group {");
        scanfile_text(&f, "Coordinate { point [ 1 2 3 ] }");
        for (int i = 1; i < depth; i++)
            scanfile_text(&f, "}");
        if (depth < 64) {
            scanfile_good(&f, CLOUDFORMAT_ANY, &p);
            cloudpoints_free(&p);
        } else {
            scanfile_bad(&f, CLOUDFORMAT_ANY, ST_EVERSION, "more than 63 nodes");
        }
    }
    make(&f, V2);
    for (int i = 0; i < 65; i++) {
        scanfile_text(&f, "DEF A Coordinate { point [ 1 2 3 ] }");
        if (i == 63) {
            scanfile_good(&f, CLOUDFORMAT_ANY, &p);
            assert_int_equal(p.n, 64);
            cloudpoints_free(&p);
        }
    }
    scanfile_bad(&f, CLOUDFORMAT_ANY, ST_EVERSION, "more than 64 names");
}
