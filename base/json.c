#include "json.h"

#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cjson/cJSON.h>

#include "errinfo.h"
#include "json_text.h"
#include "mem.h"
#include "utf8.h"

/* The library reports a lack of memory as malformed text: this separates the two. */
static _Thread_local bool starved;

static void *take_memory(size_t size)
{
    void *p = malloc(size);

    starved = starved || p == NULL;
    return p;
}

static void watch_memory(void)
{
    cJSON_Hooks hooks = {.malloc_fn = take_memory, .free_fn = mem_free};

    cJSON_InitHooks(&hooks);
}

static void json_start(void)
{
    static pthread_once_t once = PTHREAD_ONCE_INIT;

    (void)pthread_once(&once, watch_memory);
    starved = false;
}

/* ---- writing */

struct json {
    bool failed;
    int depth;
    cJSON *open[JSON_DEPTH]; /* the first is the root, each other within the one before */
};

struct json *json_new(void)
{
    struct json *j = calloc(1, sizeof *j);

    json_start();
    if (j != NULL && (j->open[0] = cJSON_CreateObject()) == NULL) {
        free(j);
        return NULL;
    }
    return j;
}

/* After a failure nothing is added any more: the tree is not printed. */
static bool adds(const struct json *j)
{
    return j != NULL && !j->failed;
}

static void json_add(struct json *j, const char *key, cJSON *item)
{
    cJSON *in = j->open[j->depth];

    if (item == NULL || !(key == NULL ? cJSON_AddItemToArray(in, item)
                                      : cJSON_AddItemToObject(in, key, item))) {
        cJSON_Delete(item);
        j->failed = true;
    }
}

static void json_begin(struct json *j, const char *key, cJSON *item)
{
    json_add(j, key, item);
    if (!j->failed && j->depth + 1 < JSON_DEPTH)
        j->open[++j->depth] = item;
    else
        j->failed = true;
}

void json_object(struct json *j, const char *key)
{
    if (adds(j))
        json_begin(j, key, cJSON_CreateObject());
}

void json_array(struct json *j, const char *key)
{
    if (adds(j))
        json_begin(j, key, cJSON_CreateArray());
}

void json_close(struct json *j)
{
    if (adds(j) && j->depth > 0)
        j->depth--;
}

/* value with U+FFFD in place of each byte that is not UTF-8. */
static cJSON *create_repaired(const char *value, size_t len)
{
    char *text = malloc(3 * len + 1);
    size_t n = 0;
    cJSON *item;

    if (text == NULL)
        return NULL;
    for (size_t good; len > 0; value += good, len -= good) {
        good = utf8_valid(value, len);
        memcpy(text + n, good > 0 ? value : "\xef\xbf\xbd", good > 0 ? good : 3);
        n += good > 0 ? good : 3;
        good += good == 0;
    }
    text[n] = '\0';
    item = cJSON_CreateString(text);
    free(text);
    return item;
}

void json_text(struct json *j, const char *key, const char *value)
{
    const size_t len = value == NULL ? 0 : strlen(value);

    if (adds(j))
        json_add(j, key,
                 value == NULL                   ? cJSON_CreateNull()
                 : utf8_valid(value, len) == len ? cJSON_CreateString(value)
                                                 : create_repaired(value, len));
}

void json_text_or_null(struct json *j, const char *key, const char *value)
{
    json_text(j, key, value[0] != '\0' ? value : NULL);
}

void json_flag(struct json *j, const char *key, bool value)
{
    if (adds(j))
        json_add(j, key, cJSON_CreateBool(value));
}

/* The double nearest to value in steps of 1 / per_unit.  The library prints the shortest
 * text that reads as it, and null for what is not finite. */
static void add_rounded(struct json *j, const char *key, double value, double per_unit)
{
    const double scaled = round(value * per_unit);

    if (!adds(j))
        return;
    if (fabs(scaled) < 9007199254740992.0)
        value = scaled == 0 ? 0 : scaled / per_unit; /* no -0 */
    json_add(j, key, cJSON_CreateNumber(value));
}

#define LENGTH    1e4
#define EXTENT    1e1
#define SCORE     1e2
#define DIRECTION 1e7

void json_number(struct json *j, const char *key, double value)
{
    add_rounded(j, key, value, LENGTH);
}

void json_score(struct json *j, const char *key, double value)
{
    add_rounded(j, key, value, SCORE);
}

void json_extent(struct json *j, const char *key, double value)
{
    add_rounded(j, key, value, EXTENT);
}

void json_exact(struct json *j, const char *key, double value)
{
    if (adds(j))
        json_add(j, key, cJSON_CreateNumber(value));
}

void json_rate(struct json *j, const char *key, double value)
{
    char text[32];

    (void)snprintf(text, sizeof text, "%.2e", value);
    if (adds(j))
        json_add(j, key,
                 cJSON_CreateNumber(isfinite(value) ? strtod(text, NULL) : value));
}

void json_direction(struct json *j, const char *key, const double value[3])
{
    json_array(j, key);
    for (int i = 0; i < 3; i++)
        add_rounded(j, NULL, value[i], DIRECTION);
    json_close(j);
}

void json_similarity(struct json *j, const char *key, const double value[16],
                     double scale)
{
    const double direction = DIRECTION / pow(10, floor(log10(scale)));

    json_array(j, key);
    for (int i = 0; i < 16; i++)
        add_rounded(j, NULL, value[i], i % 4 == 3 ? LENGTH : direction);
    json_close(j);
}

void json_transform(struct json *j, const char *key, const double value[16])
{
    json_similarity(j, key, value, 1);
}

void json_discard(struct json *j)
{
    if (j == NULL)
        return;
    cJSON_Delete(j->open[0]);
    free(j);
}

char *json_compact(struct json *j)
{
    char *text = adds(j) ? cJSON_PrintUnformatted(j->open[0]) : NULL;

    json_discard(j);
    return text;
}

char *json_pretty(struct json *j)
{
    char *text = adds(j) ? cJSON_Print(j->open[0]) : NULL;

    json_discard(j);
    return text;
}

/* ---- reading */

/* A value is the library's; no other file sees into it. */
static const cJSON *item_of(const struct json_value *v)
{
    return (const cJSON *)v;
}

static const struct json_value *value_of(const cJSON *item)
{
    return (const struct json_value *)item;
}

/* The number of bytes of a member's name that a message shows. */
static int shown(const char *key)
{
    const size_t len = strlen(key);

    return (int)utf8_valid(key, len < 64 ? len : 64);
}

static enum status check_object(const cJSON *object, struct errinfo *e)
{
    unsigned n = 0;

    for (const cJSON *a = object->child; a != NULL; a = a->next) {
        if (++n > JSON_MEMBERS)
            return errinfo_set(e, ST_EINVAL, "an object has more than %d members",
                               JSON_MEMBERS);
        for (const cJSON *b = object->child; b != a; b = b->next)
            if (strcmp(a->string, b->string) == 0)
                return errinfo_set(e, ST_EINVAL,
                                   "an object has two members named \"%.*s\"",
                                   shown(a->string), a->string);
    }
    return ST_OK;
}

/* Points that were cut out of an array's text are in valuestring, and their number in
 * valueint: an array has no use for either, and the library frees the first. */
static size_t points_in(const cJSON *array)
{
    return array->valuestring == NULL ? 0 : (size_t)array->valueint;
}

/* A document on its way from the text to values. */
struct reader {
    struct json_text text;
    size_t arrays, given; /* met so far; of the cuts, those whose array has its points */
    struct errinfo *e;
};

/* array is the next one of the text. */
static void give_points(cJSON *array, struct reader *r)
{
    struct json_text_cut *cut = &r->text.cut[r->given];

    if (r->given < r->text.cuts && cut->array == r->arrays) {
        array->valuestring = (char *)cut->points.at;
        array->valueint = (int)cut->points.n;
        cut->points.at = NULL;
        r->given++;
    }
    r->arrays++;
}

/* Checks the objects of item and below, which are as deep as json_text_check() allowed, and
 * gives the arrays, which come in the order of the text, their points. */
static enum status check_values(cJSON *item, struct reader *r)
{
    enum status st = cJSON_IsObject(item) ? check_object(item, r->e) : ST_OK;

    if (cJSON_IsArray(item))
        give_points(item, r);
    for (item = item->child; item != NULL && st == ST_OK; item = item->next)
        st = check_values(item, r);
    return st;
}

static enum status parse(const struct json_text *t, cJSON **doc, struct errinfo *e)
{
    size_t len;
    char *rest = json_text_rest(t, &len);
    const char *end = NULL;
    enum status st = ST_OK;

    json_start();
    if (rest != NULL)
        *doc = cJSON_ParseWithLengthOpts(rest, len + 1, &end, true);
    if (rest == NULL || (*doc == NULL && starved))
        st = errinfo_set(e, ST_ENOMEM, "no memory for %zu bytes of JSON", t->len);
    else if (*doc == NULL && end >= rest + len)
        st = errinfo_set(e, ST_EINVAL, "not valid JSON: it ends too early");
    else if (*doc == NULL)
        st = json_text_wrong(end == NULL ? "" : end,
                             end == NULL ? 0 : json_text_place(t, (size_t)(end - rest)),
                             e);
    mem_free(rest);
    return st;
}

static enum status read_document(struct reader *r, struct json_value **out)
{
    cJSON *doc = NULL;
    enum status st = json_text_check(&r->text, r->e);

    *out = NULL;
    if (st == ST_OK)
        st = parse(&r->text, &doc, r->e);
    if (st == ST_OK)
        st = check_values(doc, r);
    json_text_free(&r->text);
    if (st != ST_OK)
        cJSON_Delete(doc);
    else
        *out = (struct json_value *)doc;
    return st;
}

static struct json_text text_of(const char *text, size_t len, size_t max_values,
                                size_t max_cuts)
{
    return (struct json_text){.bytes = text,
                              .len = len,
                              .max_values = max_values,
                              .max_depth = JSON_DEPTH,
                              .max_cuts = max_cuts};
}

enum status json_read(const char *text, size_t len, size_t max_values,
                      struct json_value **out, struct errinfo *e)
{
    struct reader r = {.text = text_of(text, len, max_values, 0), .e = e};

    return read_document(&r, out);
}

enum status json_read_points(const char *text, size_t len, size_t max_values,
                             struct json_value **out, struct errinfo *e)
{
    struct reader r = {.text = text_of(text, len, max_values, JSON_TEXT_CUTS), .e = e};

    return read_document(&r, out);
}

void json_free(struct json_value *document)
{
    cJSON_Delete((cJSON *)document);
}

bool json_is_array(const struct json_value *v)
{
    return cJSON_IsArray(item_of(v));
}

bool json_is_null(const struct json_value *v)
{
    return cJSON_IsNull(item_of(v));
}

const struct json_value *json_member(const struct json_value *object, const char *key)
{
    return cJSON_IsObject(item_of(object))
               ? value_of(cJSON_GetObjectItemCaseSensitive(item_of(object), key))
               : NULL;
}

static bool is_known(const char *key, const char *const known[])
{
    while (*known != NULL && strcmp(*known, key) != 0)
        known++;
    return *known != NULL;
}

static enum status unknown_member(const char *key, const char *where,
                                  const char *const known[], struct errinfo *e)
{
    char list[120] = "";

    for (size_t i = 0, n = 0; known[i] != NULL && n < sizeof list; i++)
        n += (size_t)snprintf(list + n, sizeof list - n, "%s%s",
                              i == 0                 ? ""
                              : known[i + 1] == NULL ? " and "
                                                     : ", ",
                              known[i]);
    return errinfo_set(e, ST_EINVAL, "%s: unknown member \"%.*s\"; allowed: %s", where,
                       shown(key), key, list);
}

enum status json_expect(const struct json_value *v, const char *where,
                        const char *const known[], struct errinfo *e)
{
    if (!cJSON_IsObject(item_of(v)))
        return errinfo_set(e, ST_EINVAL, "%s is not an object", where);
    for (v = json_first(v); v != NULL; v = json_next(v))
        if (!is_known(item_of(v)->string, known))
            return unknown_member(item_of(v)->string, where, known, e);
    return ST_OK;
}

const struct json_value *json_first(const struct json_value *v)
{
    return v == NULL ? NULL : value_of(item_of(v)->child);
}

const struct json_value *json_next(const struct json_value *v)
{
    return value_of(item_of(v)->next);
}

const char *json_get_text(const struct json_value *v)
{
    return cJSON_GetStringValue(item_of(v));
}

bool json_copy_text(const struct json_value *v, char *out, size_t size)
{
    const char *text = json_get_text(v);

    if (text == NULL || strlen(text) >= size)
        return false;
    memcpy(out, text, strlen(text) + 1);
    return true;
}

bool json_get_flag(const struct json_value *v, bool *out)
{
    if (!cJSON_IsBool(item_of(v)))
        return false;
    *out = cJSON_IsTrue(item_of(v));
    return true;
}

bool json_get_count(const struct json_value *v, uint64_t *out)
{
    const cJSON *item = item_of(v);

    if (!cJSON_IsNumber(item) || !(item->valuedouble >= 0) ||
        item->valuedouble > 9007199254740992.0 ||
        item->valuedouble != floor(item->valuedouble))
        return false;
    *out = (uint64_t)item->valuedouble;
    return true;
}

bool json_get_number(const struct json_value *v, double *out)
{
    const cJSON *item = item_of(v);

    if (!cJSON_IsNumber(item) || !isfinite(item->valuedouble))
        return false;
    *out = item->valuedouble;
    return true;
}

/* Three finite numbers. */
static enum status get_point(const cJSON *array, struct dvec3 *out)
{
    double xyz[3] = {0};
    const cJSON *item = array->child;
    int n = 0;

    if (!cJSON_IsArray(array))
        return ST_EINVAL;
    for (; n < 3 && cJSON_IsNumber(item); item = item->next)
        xyz[n++] = item->valuedouble;
    if (n < 3 || item != NULL)
        return ST_EINVAL;
    *out = (struct dvec3){xyz[0], xyz[1], xyz[2]};
    return isfinite(xyz[0]) && isfinite(xyz[1]) && isfinite(xyz[2]) ? ST_OK
                                                                    : ST_ENOTFINITE;
}

size_t json_count(const struct json_value *v)
{
    const cJSON *item = item_of(v);
    size_t n = json_is_array(v) ? points_in(item) : 0;

    for (v = json_first(v); v != NULL; v = json_next(v))
        n++;
    return n;
}

enum status json_get_points(const struct json_value *v, struct dvec3 *out, size_t *n)
{
    const cJSON *item = item_of(v);
    enum status st = ST_OK;

    *n = 0;
    if (!json_is_array(v))
        return ST_EINVAL;
    if ((*n = points_in(item)) > 0)
        memcpy(out, item->valuestring, *n * sizeof *out);
    for (item = item->child; item != NULL && st == ST_OK; item = item->next)
        if ((st = get_point(item, &out[*n])) == ST_OK)
            ++*n;
    return st;
}
