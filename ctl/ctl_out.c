#include "ctl_out.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cjson/cJSON.h>

#define DEPTH 8

struct ctl_out {
    bool json, failed;
    int depth;
    cJSON *open[DEPTH]; /* the first is the root, each other within the one before */
};

struct ctl_out *ctl_out_new(bool json)
{
    struct ctl_out *o = calloc(1, sizeof *o);

    if (o == NULL || !json)
        return o;
    o->json = true;
    if ((o->open[0] = cJSON_CreateObject()) == NULL) {
        free(o);
        return NULL;
    }
    return o;
}

bool ctl_out_json(const struct ctl_out *o)
{
    return o->json;
}

static void add(struct ctl_out *o, const char *key, cJSON *item)
{
    cJSON *in = o->open[o->depth];

    if (item == NULL || !(key == NULL ? cJSON_AddItemToArray(in, item)
                                      : cJSON_AddItemToObject(in, key, item))) {
        cJSON_Delete(item);
        o->failed = true;
    }
}

static void begin(struct ctl_out *o, const char *key, cJSON *item)
{
    add(o, key, item);
    if (!o->failed && o->depth + 1 < DEPTH)
        o->open[++o->depth] = item;
    else
        o->failed = true;
}

/* After a failure nothing is added any more: the tree is not printed. */
static bool adds(const struct ctl_out *o)
{
    return o->json && !o->failed;
}

void ctl_out_object(struct ctl_out *o, const char *key)
{
    if (adds(o))
        begin(o, key, cJSON_CreateObject());
}

void ctl_out_array(struct ctl_out *o, const char *key)
{
    if (adds(o))
        begin(o, key, cJSON_CreateArray());
}

void ctl_out_close(struct ctl_out *o)
{
    if (adds(o) && o->depth > 0)
        o->depth--;
}

void ctl_out_text(struct ctl_out *o, const char *key, const char *value)
{
    if (adds(o))
        add(o, key, cJSON_CreateString(value));
}

void ctl_out_number(struct ctl_out *o, const char *key, double value)
{
    if (adds(o))
        add(o, key, cJSON_CreateNumber(value));
}

void ctl_out_flag(struct ctl_out *o, const char *key, bool value)
{
    if (adds(o))
        add(o, key, cJSON_CreateBool(value));
}

bool ctl_out_end(struct ctl_out *o, FILE *to)
{
    bool ok;
    char *text;

    if (o == NULL)
        return false;
    ok = !o->failed;
    if (o->json && ok) {
        ok = (text = cJSON_Print(o->open[0])) != NULL && fprintf(to, "%s\n", text) >= 0;
        cJSON_free(text);
    }
    cJSON_Delete(o->open[0]);
    free(o);
    return fflush(to) == 0 && ok;
}

bool ctl_out_line(struct ctl_out *o, FILE *to)
{
    char *text = o != NULL && !o->failed ? cJSON_PrintUnformatted(o->open[0]) : NULL;
    const bool ok = text != NULL && fprintf(to, "%s\n", text) >= 0;

    cJSON_free(text);
    ctl_out_drop(o);
    return ok;
}

struct ctl_out *ctl_out_parse(const char *text)
{
    struct ctl_out *o = calloc(1, sizeof *o);

    if (o == NULL)
        return NULL;
    o->json = true;
    o->open[0] = cJSON_ParseWithOpts(text, NULL, true);
    if (cJSON_IsObject(o->open[0]))
        return o;
    ctl_out_drop(o);
    return NULL;
}

bool ctl_out_take_text(const struct ctl_out *o, const char *key, char *out, size_t size)
{
    const char *text =
        cJSON_GetStringValue(cJSON_GetObjectItemCaseSensitive(o->open[o->depth], key));

    if (text == NULL || strlen(text) >= size)
        return false;
    memcpy(out, text, strlen(text) + 1);
    return true;
}

bool ctl_out_enter(struct ctl_out *o, const char *key)
{
    cJSON *item = cJSON_GetObjectItemCaseSensitive(o->open[o->depth], key);

    if (o->depth + 1 >= DEPTH || !(cJSON_IsObject(item) || cJSON_IsArray(item)))
        return false;
    o->open[++o->depth] = item;
    return true;
}

size_t ctl_out_count(const struct ctl_out *o)
{
    return (size_t)cJSON_GetArraySize(o->open[o->depth]);
}

bool ctl_out_take_item(const struct ctl_out *o, size_t i, char *out, size_t size)
{
    const char *text =
        cJSON_GetStringValue(cJSON_GetArrayItem(o->open[o->depth], (int)i));

    if (text == NULL || strlen(text) >= size)
        return false;
    memcpy(out, text, strlen(text) + 1);
    return true;
}

bool ctl_out_take_count(const struct ctl_out *o, const char *key, uint64_t *out)
{
    const cJSON *item = cJSON_GetObjectItemCaseSensitive(o->open[o->depth], key);

    if (!cJSON_IsNumber(item) || !(item->valuedouble >= 0) ||
        item->valuedouble > 9007199254740992.0)
        return false;
    *out = (uint64_t)item->valuedouble;
    return (double)*out == item->valuedouble;
}

void ctl_out_drop(struct ctl_out *o)
{
    if (o == NULL)
        return;
    cJSON_Delete(o->open[0]);
    free(o);
}
