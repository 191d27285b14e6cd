/* The files of a form are found as browsers and curl send them, wherever line ends and dashes
 * stand in them; what is malformed, or other parts than are wanted, is refused with a reason. */
#include "errinfo.h"
#include "multipart.h"
#include "unit.h"

#define HEAD     "Content-Disposition: form-data; name=\"file\"; filename=\"a.ply\"\r\n"
#define PART(x)  "--b\r\n" HEAD "\r\n" x "\r\n"
#define FIELD(x) "--b\r\nContent-Disposition: form-data; name=\"" x "\"\r\n\r\n1\r\n"
#define BODY(x)  PART(x) "--b--\r\n"

static struct multipart_file file[MULTIPART_FILES_MAX];
#define f file[0]
static size_t files;
static size_t most = 1;
static struct errinfo e;

static enum status take(const char *body, size_t len, const char *boundary)
{
    unsigned char *exact = malloc(len > 0 ? len : 1); /* a byte beyond it is an error */
    enum status st;

    assert_non_null(exact);
    memcpy(exact, body, len);
    e = (struct errinfo){0};
    st = multipart_read(exact, len, boundary, most, file, &files, &e);
    for (size_t i = 0; st == ST_OK && i < files; i++) {
        const unsigned char *data = file[i].data;

        /* the same place, in memory that stays */
        assert_true(data >= exact && data + file[i].len <= exact + len);
        file[i].data = (const unsigned char *)body + (data - exact);
    }
    free(exact);
    return st;
}

static void assert_taken(const char *body, size_t len, const char *data, size_t datalen)
{
    if (take(body, len, "b") != ST_OK)
        fail_msg("%s", e.msg);
    assert_int_equal(f.len, datalen);
    assert_memory_equal(f.data, data, datalen);
}

static void assert_refused(const char *body, const char *why)
{
    assert_int_equal(take(body, strlen(body), "b"), ST_EINVAL);
    if (strstr(e.msg, why) == NULL)
        fail_msg("'%s' lacks '%s'", e.msg, why);
}

TEST(test_boundary)
{
    static const struct {
        const char *type, *boundary;
    } known[] = {
        {"multipart/form-data; boundary=----WebKitFormBoundaryAb1",
         "----WebKitFormBoundaryAb1"},
        {"multipart/form-data;boundary=x", "x"},
        {"multipart/form-data; charset=utf-8; Boundary=\"a b:c\" ; x=y", "a b:c"},
        {"multipart/form-data; boundary=\"a\\?c\"", "a?c"},
        {"multipart/form-data; boundary=0123456789012345678901234567890123456789"
         "012345678901234567890123456789",
         "0123456789012345678901234567890123456789012345678901234567890123456789"},
        {"multipart/form-data; boundary=01234567890123456789012345678901234567890"
         "123456789012345678901234567890",
         ""},
        {"multipart/form-data", ""},
        {"multipart/form-data; boundary", ""},
        {"multipart/form-data; boundary=", ""},
        {"multipart/form-data; boundary=\"a", ""},
        {"multipart/form-data; boundary=\"a \"", ""},
        {"multipart/form-data; boundary=a;b", "a"},
        {"multipart/form-data; b;boundary=a", ""},
        {"multipart/form-data; xboundary=a", ""},
        {"multipart/form-data; boundary=\"a\x01\"", ""},
    };
    char out[MULTIPART_BOUNDARY_MAX + 1];

    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        assert_int_equal(multipart_boundary(known[i].type, out),
                         known[i].boundary[0] != '\0');
        assert_string_equal(out, known[i].boundary);
    }
}

TEST(test_file)
{
    static const char *const data[] = {"ply",     "",         "\r\n",       "\r\n\r\n",
                                       "\r",      "--b",      "--b--",      "\r\n--",
                                       "\r\n--c", "\r\n--bx", "\r\n--b-x",  "\r\n--b x",
                                       "\n--b\n", "\r\r\n",   "ends with\r"};
    char body[400];

    for (size_t i = 0; i < sizeof data / sizeof *data; i++) {
        (void)snprintf(body, sizeof body, "%s%s%s", "--b\r\n" HEAD "\r\n", data[i],
                       "\r\n--b--\r\n");
        assert_taken(body, strlen(body), data[i], strlen(data[i]));
    }
    assert_taken(PART("x\0y") "--b--", sizeof(PART("x\0y") "--b--") - 1, "x\0y", 3);
    assert_taken(PART("x") "--b-- \t\r\n\r\n ", strlen(PART("x") "--b-- \t\r\n\r\n "),
                 "x", 1);
    assert_string_equal(f.type, "");
    assert_string_equal(f.coding, "");
    assert_taken(
        "--b \r\ncontent-type: model/ply; x=1\r\n"
        "content-encoding:gzip\r\nContent-Transfer-Encoding: binary\r\nX-A: b\r\n"
        "content-disposition:form-data;filename=\"a;\\\"name=b\";name=file\r\n\r\nx"
        "\r\n--b--",
        strlen(
            "--b \r\ncontent-type: model/ply; x=1\r\n"
            "content-encoding:gzip\r\nContent-Transfer-Encoding: binary\r\nX-A: b\r\n"
            "content-disposition:form-data;filename=\"a;\\\"name=b\";name=file\r\n\r\nx"
            "\r\n--b--"),
        "x", 1);
    assert_string_equal(f.type, "model/ply; x=1");
    assert_string_equal(f.coding, "gzip");
}

/* What stands before the first boundary is ignored (RFC 2046, section 5.1.1). */
TEST(test_preamble)
{
    assert_taken("\r\n" BODY("x"), strlen("\r\n" BODY("x")), "x", 1);
    assert_taken("A form.\n--b\r\n--c\r\n" BODY("x"),
                 strlen("A form.\n--b\r\n--c\r\n" BODY("x")), "x", 1);
}

TEST(test_refused)
{
    const char whole[] = BODY("x");

    assert_refused("", "byte 0: no line of the body is the boundary");
    assert_refused("x" BODY("x"), "no parts"); /* but for the last */
    assert_refused("--c\r\n" HEAD "\r\nx\r\n--c--", "no line of the body");
    assert_refused("--b--\r\n", "no parts");
    assert_refused(BODY("x") "y", "more behind");
    assert_refused("--b\r\n\r\nx\r\n--b--", "without Content-Disposition");
    assert_refused("--b\r\nContent-Type: model/ply\r\n\r\nx\r\n--b--",
                   "without Content-Disposition");
    assert_refused("--b\r\nContent-Disposition: attachment; name=\"x\"\r\n\r\nx\r\n--b--",
                   "not form-data with a name");
    assert_refused(
        "--b\r\nContent-Disposition: form-data; filename=\"x\"\r\n\r\nx\r\n--b--",
        "not form-data with a name");
    assert_refused("--b\r\nContent-Transfer-Encoding: base64\r\n" HEAD "\r\nx\r\n--b--",
                   "not binary");
    assert_refused("--b\r\nnothing\r\n" HEAD "\r\nx\r\n--b--", "is malformed");
    assert_refused("--b\r\n: x\r\n" HEAD "\r\nx\r\n--b--", "is malformed");
    assert_refused("--b\n" HEAD "\r\nx\r\n--b--", "no parts");
    assert_refused("--b\r\nContent-Disposition: form-data; name=\"x\"\n\nx\r\n--b--", "");
    for (size_t len = 0; len < sizeof whole - 3; len++) /* but for the last end of line */
        assert_int_equal(take(whole, len, "b"), ST_EINVAL);
}

TEST(test_parts)
{
    char many[9000] = "", part[1200];

    assert_refused(PART("x") PART("y") "--b--",
                   "the form has the parts file, file: send one");
    assert_refused(FIELD("units") PART("x") "--b--",
                   "the parts units, file: send one file");
    for (int i = 0; i < 20; i++)
        strcat(many, FIELD("n"));
    strcat(many, "--b--");
    assert_refused(many, "the parts n, n, ...: send one");
    memset(part, 'x', sizeof part);
    memcpy(part, "--b\r\nX: ", 8);
    part[sizeof part - 1] = '\0';
    strcpy(many, part);
    strcat(many, "\r\n" HEAD "\r\nx\r\n--b--");
    assert_refused(many, "too long");
    strcpy(many, "--b\r\n");
    for (int i = 0; i < 1000; i++)
        strcat(many, "X: y\r\n");
    strcat(many, HEAD "\r\nx\r\n--b--");
    assert_refused(many, "more than 4 KB");
}

/* Several files, each with its name. */
TEST(test_several)
{
    char many[3000] = "";

    most = MULTIPART_FILES_MAX;
    assert_taken(FIELD("units") "--b--", strlen(FIELD("units") "--b--"), "1", 1);
    assert_string_equal(f.name, "");
    assert_int_equal(take(PART("x") PART("\r\n--c") PART("") "--b--",
                          strlen(PART("x") PART("\r\n--c") PART("") "--b--"), "b"),
                     ST_OK);
    assert_int_equal(files, 3);
    for (size_t i = 0; i < 3; i++) {
        static const char *const data[] = {"x", "\r\n--c", ""};

        assert_int_equal(file[i].len, strlen(data[i]));
        assert_memory_equal(file[i].data, data[i], strlen(data[i]));
        assert_string_equal(file[i].name, "a.ply");
    }
    assert_refused(PART("x") FIELD("units") "--b--",
                   "the parts file, units: send 1 to 20 files, each with a file name");
    assert_refused(PART("x") PART("y"), "ends before the last boundary");
    for (int i = 1; i <= 21; i++) {
        strcat(many, PART("x"));
        strcat(many, "--b--");
        assert_int_equal(take(many, strlen(many), "b"), i <= 20 ? ST_OK : ST_EINVAL);
        assert_int_equal(
            files, i <= MULTIPART_FILES_MAX ? i : 0); /* no more than there is room for */
        many[strlen(many) - 5] = '\0';
    }
    assert_non_null(strstr(e.msg, "send 1 to 20 files"));
    assert_refused("--b--", "no parts: send 1 to 20");
    most = 1;
}
