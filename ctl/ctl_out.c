#include "ctl_out.h"

#include <stdlib.h>

#include "json.h"

struct ctl_out {
    struct json *json; /* NULL: without --json */
};

struct ctl_out *ctl_out_new(bool json)
{
    struct ctl_out *o = calloc(1, sizeof *o);

    if (o != NULL && json && (o->json = json_new()) == NULL) {
        free(o);
        return NULL;
    }
    return o;
}

bool ctl_out_json(const struct ctl_out *o)
{
    return o->json != NULL;
}

struct json *ctl_out_document(struct ctl_out *o)
{
    return o->json;
}

void ctl_out_object(struct ctl_out *o, const char *key)
{
    json_object(o->json, key);
}

void ctl_out_array(struct ctl_out *o, const char *key)
{
    json_array(o->json, key);
}

void ctl_out_close(struct ctl_out *o)
{
    json_close(o->json);
}

void ctl_out_text(struct ctl_out *o, const char *key, const char *value)
{
    json_text(o->json, key, value);
}

void ctl_out_flag(struct ctl_out *o, const char *key, bool value)
{
    json_flag(o->json, key, value);
}

void ctl_out_number(struct ctl_out *o, const char *key, double value)
{
    json_number(o->json, key, value);
}

void ctl_out_extent(struct ctl_out *o, const char *key, double value)
{
    json_extent(o->json, key, value);
}

void ctl_out_rate(struct ctl_out *o, const char *key, double value)
{
    json_rate(o->json, key, value);
}

void ctl_out_direction(struct ctl_out *o, const char *key, const double value[3])
{
    json_direction(o->json, key, value);
}

void ctl_out_transform(struct ctl_out *o, const char *key, const double value[16])
{
    json_transform(o->json, key, value);
}

static bool print(char *text, FILE *to)
{
    const bool ok = text != NULL && fprintf(to, "%s\n", text) >= 0;

    free(text);
    return ok;
}

bool ctl_out_end(struct ctl_out *o, FILE *to)
{
    bool ok;

    if (o == NULL)
        return false;
    ok = o->json == NULL || print(json_pretty(o->json), to);
    free(o);
    return fflush(to) == 0 && ok;
}

bool ctl_out_line(struct ctl_out *o, FILE *to)
{
    const bool ok = o != NULL && print(json_compact(o->json), to);

    free(o);
    return ok;
}
