/* The scans of a corpus, their subjects and kinds: by file names and by a manifest. */
#include <sys/stat.h>
#include <unistd.h>

#include "corpus.h"
#include "corpus_read.h"
#include "corpus_pairs.h"
#include "unit.h"

static struct errinfo e;
static char dir[32], made[256][128];
static size_t nmade;

/* A file of the folder, removed after the test. */
static void put(const char *name, const char *text)
{
    char path[128];
    FILE *f;

    (void)snprintf(path, sizeof path, "%s/%s", dir, name);
    assert_non_null(f = fopen(path, "wb"));
    assert_true(fputs(text, f) >= 0);
    assert_int_equal(fclose(f), 0);
    (void)snprintf(made[nmade++], sizeof made[0], "%s", path);
}

AFTER_EACH(clean)
{
    while (nmade > 0)
        (void)unlink(made[--nmade]);
}

static struct corpus *corpus(void)
{
    struct corpus *c;

    if (corpus_read(dir, &c, &e) != ST_OK)
        fail_msg("%s", e.msg);
    return c;
}

static void refuse(enum status want, const char *words)
{
    struct corpus *c;

    assert_int_equal(corpus_read(dir, &c, &e), want);
    assert_null(c);
    if (strstr(e.msg, words) == NULL)
        fail_msg("'%s' lacks '%s'", e.msg, words);
}

static const char *kind(const struct corpus *c, uint32_t scan)
{
    return c->kind[c->scan[scan].kind];
}

TEST(test_folder)
{
    struct corpus *c;

    put("bob_2.ply.gz", "");
    put("bob_1.XYZ", "");
    put("alice_late_one.stl", "");
    put("alice_enroll.txt", "");
    put("alice_early.ply", "");
    put("README.md", "");
    put(".hidden_1.ply", "");
    c = corpus();
    assert_int_equal(c->nscan, 5);
    assert_int_equal(c->nsubject, 2);
    assert_string_equal(c->subject[0].id, "alice");
    assert_string_equal(c->scan[c->subject[0].enrolled].file, "alice_enroll.txt");
    assert_string_equal(c->scan[c->subject[1].enrolled].file, "bob_1.XYZ");
    assert_int_equal(c->subject[0].nscan, 3);
    assert_string_equal(kind(c, 2), "late_one");
    assert_string_equal(kind(c, 4), "2");
    assert_false(c->scan[2].enrolled);
    assert_true(c->scan[1].enrolled);
    assert_int_equal(corpus_pair(c, 0, 1), CORPUS_IMPOSTOR);
    assert_int_equal(corpus_pair(c, 1, 1), CORPUS_GENUINE);
    corpus_free(c);
    corpus_free(NULL);
}

/* What is no scan is left out and reported; the others are used. */
TEST(test_left_out)
{
    static const struct {
        const char *name, *why;
        bool scan;
    } left[] = {{"Makefile", "its extension is not", false},
                {"README.txt", "SUBJECT_KIND", true},
                {"a.off", "its extension is not", false},
                {"bad\xff\x1b_1.ply", "not UTF-8", true},
                {"carol.ply", "SUBJECT_KIND", true},
                {"dave-2.ply", "SUBJECT_KIND", true},
                {"more", "a folder", false},
                {"z_1.ply", "No such file", true}};
    struct corpus *c;
    char link[64], folder[64];

    (void)snprintf(link, sizeof link, "%s/z_1.ply", dir);
    (void)snprintf(folder, sizeof folder, "%s/more", dir);
    for (int i = 0; i < 6; i++)
        put(left[i].name, "");
    put("bob_1.ply", "");
    put("._bob_1.ply", "");
    put("subjects.csv", "id\n");
    assert_int_equal(symlink("nowhere", link), 0);
    assert_int_equal(mkdir(folder, 0700), 0);
    c = corpus();
    (void)unlink(link);
    (void)rmdir(folder);
    assert_int_equal(c->nscan, 1);
    assert_int_equal(c->nsubject, 1);
    assert_int_equal(c->nleft, 8);
    assert_int_equal(c->nleft_scan, 5);
    for (int i = 0; i < 8; i++) {
        assert_string_equal(c->left[i].file, i == 3 ? "bad??_1.ply" : left[i].name);
        assert_non_null(strstr(c->left[i].why, left[i].why));
        assert_int_equal(c->left[i].scan, left[i].scan);
    }
    corpus_free(c);
}

TEST(test_bad_folder)
{
    static const char *const bad[][2] = {{"_x.ply", "not named SUBJECT_KIND"},
                                         {"x_.ply", "not named SUBJECT_KIND"},
                                         {"a\nb_1.ply", "control character"},
                                         {"a\xC0\xAF_1.ply", "not UTF-8"}};
    struct corpus *c;

    refuse(ST_EINVAL, "no scans");
    put("list.xls", "");
    refuse(ST_EINVAL, "no scans; list.xls: its extension");
    put("noname.ply", "");
    refuse(ST_EINVAL, "no scans; noname.ply: not named SUBJECT_KIND.ply");
    refuse(ST_EINVAL, "; and 1 more");
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        clean();
        put(bad[i][0], "");
        refuse(ST_EINVAL, bad[i][1]);
    }
    assert_int_equal(corpus_read("/nowhere", &c, &e), ST_ENOTFOUND);
}

TEST(test_manifest)
{
    struct corpus *c;
    char path[64];

    put("1", "");
    put("2", "");
    put("3", "");
    put("4", "");
    put("index.csv", "id,n,kind,file,other\r\n"
                     "b,0,p,3,1\r\nb,0,enroll,1,0\r\n"
                     "b,0,enroll,4,0\r\n\"a \"\"x\"\"\",,,2,0\r\n");
    (void)snprintf(path, sizeof path, "%s/index.csv", dir);
    for (int i = 0; i < 2; i++) {
        assert_int_equal(corpus_read(i == 0 ? dir : path, &c, &e), ST_OK);
        assert_int_equal(c->nscan, 4);
        assert_int_equal(c->nsubject, 2);
        assert_int_equal(c->subject[0].enrolled, 1); /* the first that is marked */
        assert_false(c->scan[2].enrolled);
        assert_string_equal(c->subject[1].id, "a \"x\"");
        assert_int_equal(c->subject[1].enrolled, 3); /* or the first */
        assert_string_equal(kind(c, 3), "");
        corpus_free(c);
    }
}

TEST(test_families)
{
    struct corpus *c;

    put("a_1.ply", "");
    put("b_1.ply", "");
    put("c_1.ply", "");
    put("d_1.ply", "");
    put("e_1.ply", "");
    put("subjects.csv", "relative_of,id,population\n,a,x\na,b,x\nmother,c,x\nmother,d,x\n"
                        "mother,e,y\nb,nobody,x\n");
    c = corpus();
    assert_int_equal(c->nsubject, 5);
    assert_int_equal(corpus_pair(c, 0, 1), CORPUS_RELATIVE);
    assert_int_equal(corpus_pair(c, 1, 0), CORPUS_RELATIVE);
    assert_int_equal(corpus_pair(c, 2, 3), CORPUS_RELATIVE); /* siblings */
    assert_int_equal(corpus_pair(c, 0, 2), CORPUS_IMPOSTOR);
    assert_int_equal(corpus_pair(c, 3, 4), CORPUS_FOREIGN);
    assert_int_equal(corpus_pair(c, 4, 4), CORPUS_GENUINE);
    corpus_free(c);
}

TEST(test_bad_tables)
{
    static const struct {
        const char *index, *subjects; /* NULL: as before */
        enum status st;
        const char *words;
    } row[] = {
        {"name,id\n1,a\n", NULL, ST_EINVAL, "no column is named file"},
        {"file,kind\n1,a\n", NULL, ST_EINVAL, "no column is named subject"},
        {"file,id\n", NULL, ST_EINVAL, "no scans"},
        {"file,id\n1,\n", NULL, ST_EINVAL, "line 2, column id: empty"},
        {"file,id\n1,a\x01\n", NULL, ST_EINVAL, "line 2, column id: a control"},
        {"file,id\n1,a\n2,a\n", NULL, ST_ENOTFOUND, "line 3, column file: No such file"},
        {"file,id\n.,a\n", NULL, ST_ENOTFOUND, "not a file"},
        {"file,id\n1,a\n1,b\n", NULL, ST_EINVAL, "1 is listed twice"},
        {"file,id,population\n1,a,x\n", "id,population\na,y\n", ST_EINVAL,
         "subjects.csv, line 2, column population: a subject is in two"},
        {NULL, "name\na\n", ST_EINVAL, "no column is named id"},
        {NULL, "id,relative_of\na,a\n", ST_EINVAL,
         "line 2, column relative_of: a subject is its own relative"},
    };

    put("1", "");
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) {
        if (row[i].index != NULL)
            put("index.csv", row[i].index);
        if (row[i].subjects != NULL)
            put("subjects.csv", row[i].subjects);
        refuse(row[i].st, row[i].words);
    }
}

TEST(test_enroll_kind)
{
    struct corpus *c;

    put("a_enroll.ply", "");
    put("a_smile.ply", "");
    put("b_enroll.ply", "");
    put("c_smile.ply", "");
    put("c_smile.xyz", "");
    c = corpus();
    assert_int_equal(corpus_enroll(c, "frown", &e), ST_EINVAL);
    assert_non_null(
        strstr(e.msg, "no scan is of the kind frown: there are enroll, smile"));
    assert_int_equal(c->subject[1].enrolled, 2); /* as it was */
    assert_int_equal(corpus_enroll(c, "smile", &e), ST_OK);
    assert_int_equal(c->subject[0].enrolled, 1);
    assert_int_equal(c->subject[1].enrolled, CORPUS_NONE);
    assert_int_equal(c->subject[2].enrolled, 3);
    for (uint32_t i = 0; i < c->nscan; i++)
        assert_int_equal(c->scan[i].enrolled, i == 1 || i == 3);
    corpus_free(c);
}

/* ---- lists of pairs */

static enum status read_pairs(const char *text, struct corpus **c)
{
    char path[64];

    put("pairs.txt", text);
    (void)snprintf(path, sizeof path, "%s/pairs.txt", dir);
    return corpus_pairs_read(path, c, &e);
}

static struct corpus *pairs(const char *text)
{
    struct corpus *c;

    if (read_pairs(text, &c) != ST_OK)
        fail_msg("%s", e.msg);
    return c;
}

static void refuse_pairs(const char *text, enum status want, const char *words)
{
    struct corpus *c;

    assert_int_equal(read_pairs(text, &c), want);
    assert_null(c);
    if (strstr(e.msg, words) == NULL)
        fail_msg("'%s' lacks '%s'", e.msg, words);
}

static void is_pair(const struct corpus *c, size_t i, const char *template,
                    const char *probe, enum corpus_pair type)
{
    const struct corpus_scan *t = &c->scan[c->listed[i].template],
                             *p = &c->scan[c->listed[i].probe];

    assert_string_equal(t->file, template);
    assert_string_equal(p->file, probe);
    assert_int_equal(corpus_pair(c, t->subject, p->subject), type);
}

TEST(test_pairs_by_name)
{
    struct corpus *c;

    put("b_1.ply", "");
    put("a_1.ply", "");
    put("a_late_one.ply", "");
    c = pairs(
        "# a comment\nb_1.ply a_1.ply\n\na_1.ply\t./a_late_one.ply \nb_1.ply a_1.ply\n");
    assert_int_equal(c->nlisted, 3);
    assert_int_equal(c->nscan, 3);
    assert_int_equal(c->nsubject, 2);
    assert_int_equal(c->npopulation, 1);
    is_pair(c, 0, "b_1.ply", "a_1.ply", CORPUS_IMPOSTOR);
    is_pair(c, 1, "a_1.ply", "./a_late_one.ply", CORPUS_GENUINE);
    is_pair(c, 2, "b_1.ply", "a_1.ply", CORPUS_IMPOSTOR);
    assert_string_equal(kind(c, c->listed[1].probe), "late_one");
    for (uint32_t i = 0; i < c->nscan; i++)
        assert_false(c->scan[i].enrolled);
    corpus_free(c);
}

/* With labels the names say nothing: people are what mated pairs connect. */
TEST(test_pairs_by_label)
{
    struct corpus *c;

    for (char name[] = "1"; name[0] <= '6'; name[0]++)
        put(name, "");
    c = pairs(
        "Template,Probe,Label\n3,1,genuine\n4,2,same\n1,4,1\n5,6,0\n1,5,non-mated\n");
    assert_int_equal(c->nscan, 6);
    assert_int_equal(c->nsubject, 3);
    assert_int_equal(c->nnamed, 3);
    is_pair(c, 0, "3", "1", CORPUS_GENUINE);
    is_pair(c, 1, "4", "2", CORPUS_GENUINE);
    is_pair(c, 3, "5", "6", CORPUS_IMPOSTOR);
    assert_string_equal(c->subject[0].id, "1");
    assert_int_equal(c->subject[0].nscan, 4);
    assert_string_equal(c->subject[1].id, "5");
    corpus_free(c);
    refuse_pairs("3 1 same\n4 2 same\n3 2 0\n1 4 1\n", ST_EINVAL,
                 "line 3: a non-mated pair of two scans that the mated pairs say");
    refuse_pairs("4 5 1\n3 4 1\n2 3 1\n1 2 1\n1 5 0\n", ST_EINVAL,
                 "line 5: a non-mated pair");
}

TEST(test_bad_pairs)
{
    struct corpus *c;

    put("a_1.ply", "");
    put("a_2.ply", "");
    put("b", "");
    refuse_pairs("", ST_EINVAL, "no pairs");
    refuse_pairs("template probe\n", ST_EINVAL, "no pairs");
    refuse_pairs("a_1.ply a_2.ply\n\na_1.ply\n", ST_EINVAL, "line 3: a line must have");
    refuse_pairs("a_1.ply a_2.ply 1 2\n", ST_EINVAL, "line 1: a line must have");
    refuse_pairs("a_1.ply,,1\n", ST_EINVAL, "line 1, field 2: empty");
    refuse_pairs("a_1.ply a_\x01.ply\n", ST_EINVAL, "line 1, field 2: a control");
    refuse_pairs("a_1.ply a_2.ply maybe\n", ST_EINVAL,
                 "line 1, field 3: a label is mated");
    refuse_pairs("a_1.ply a_2.ply 1\na_1.ply b\n", ST_EINVAL,
                 "line 2: a label is missing");
    refuse_pairs("a_1.ply a_1.ply\n", ST_EINVAL, "line 1: a scan is paired with itself");
    refuse_pairs("a_1.ply a_2.ply\nb a_1.ply\n", ST_EINVAL,
                 "line 2: b: not named SUBJECT_KIND.ply, and no third");
    refuse_pairs("a_1.ply a_2.ply\na_1.ply a_3.ply\n", ST_ENOTFOUND,
                 "line 2: a_3.ply: No such file");
    refuse_pairs("a_1.ply \"a_2.ply\n", ST_EINVAL, "a quotation is not closed");
    assert_int_equal(corpus_pairs_read("/nowhere/list", &c, &e), ST_ENOTFOUND);
}

/* More subjects than the tables' first capacity. */
TEST(test_many)
{
    static char index[1 << 13], subjects[1 << 13];
    struct corpus *c;
    int n = snprintf(index, sizeof index, "file,id\n");
    int m = snprintf(subjects, sizeof subjects, "id,relative_of\nnobody,m\n");

    for (int i = 0; i < 200; i++) {
        char name[16];

        (void)snprintf(name, sizeof name, "f%d", i);
        put(name, "");
        n += sprintf(index + n, "f%d,s%d\n", i, i);
        m += sprintf(subjects + m, "s%d,mother%d\n", i, i);
    }
    put("index.csv", index);
    put("subjects.csv", subjects);
    c = corpus();
    assert_int_equal(c->nsubject, 200);
    assert_int_equal(c->nnamed, 400); /* a relative of no listed subject is not added */
    for (uint32_t i = 0; i < 200; i++)
        assert_int_equal(c->subject[i].relative_of, 200 + i);
    corpus_free(c);
}

BEFORE_ALL(set_up)
{
    (void)snprintf(dir, sizeof dir, "/tmp/test_corpus.XXXXXX");
    assert_false(mkdtemp(dir) == NULL);
}

AFTER_ALL(tear_down)
{
    (void)rmdir(dir);
}
