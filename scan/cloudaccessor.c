#include "cloudaccessor.h"

#include <string.h>

#include "errinfo.h"
#include "json.h"
#include "mem.h"

enum status cloudaccessor_items(const struct json_value *document, const char *name,
                                struct cloudaccessor_items *out, struct errinfo *e)
{
    const struct json_value *array = json_member(document, name);
    size_t n = 0;

    *out = (struct cloudaccessor_items){0};
    if (array == NULL)
        return ST_OK;
    if (!json_is_array(array))
        return errinfo_set(e, ST_EINVAL, "GLB: %s is not an array", name);
    if ((out->at = mem_array(json_count(array), sizeof *out->at)) == NULL)
        return errinfo_set(e, ST_ENOMEM, "no memory for the GLB file");
    for (const struct json_value *v = json_first(array); v != NULL; v = json_next(v))
        out->at[n++] = v;
    out->n = n;
    return ST_OK;
}

/* A member that is a count, or, if it is not there, otherwise.  False: something else. */
static bool count_or(const struct json_value *object, const char *name,
                     uint64_t otherwise, uint64_t *out)
{
    const struct json_value *v = json_member(object, name);

    *out = otherwise;
    return v == NULL || json_get_count(v, out);
}

/* Where a view of the chunk is, and how long. */
static enum status open_view(const struct cloudaccessor_file *f, uint64_t index,
                             uint64_t *offset, uint64_t *len, uint64_t *stride)
{
    const struct json_value *view;
    uint64_t buffer;

    if (index >= f->views.n)
        return errinfo_set(f->e, ST_EINVAL, "GLB: there is no bufferView %llu",
                           (unsigned long long)index);
    view = f->views.at[index];
    if (!count_or(view, "buffer", UINT64_MAX, &buffer) ||
        !count_or(view, "byteOffset", 0, offset) ||
        !count_or(view, "byteLength", UINT64_MAX, len) ||
        !count_or(view, "byteStride", 0, stride) || buffer >= f->buffers.n)
        return errinfo_set(f->e, ST_EINVAL, "GLB: bufferView %llu is malformed",
                           (unsigned long long)index);
    if (buffer != 0 || json_member(f->buffers.at[0], "uri") != NULL)
        return errinfo_set(f->e, ST_EVERSION,
                           "GLB: buffer %llu is not in the file, and nothing is opened: "
                           "export with all buffers in the GLB",
                           (unsigned long long)buffer);
    if (*offset > f->len || *len > f->len - *offset)
        return errinfo_set(f->e, ST_EINVAL,
                           "GLB: bufferView %llu is beyond the %zu bytes of data",
                           (unsigned long long)index, f->len);
    return ST_OK;
}

static bool set_type(uint64_t component, bool normalized, struct cloudaccessor *out)
{
    static const struct {
        uint64_t component;
        enum cloudvalue type;
        double most;
    } known[] = {{5120, CLOUDVALUE_I8, 127},    {5121, CLOUDVALUE_U8, 255},
                 {5122, CLOUDVALUE_I16, 32767}, {5123, CLOUDVALUE_U16, 65535},
                 {5125, CLOUDVALUE_U32, 1},     {5126, CLOUDVALUE_F32, 1}};

    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        if (known[i].component != component)
            continue;
        out->type = known[i].type;
        out->scale = normalized ? 1 / known[i].most : 1;
        return true;
    }
    return false;
}

enum status cloudaccessor_open(const struct cloudaccessor_file *f, uint64_t index,
                               const char *type, struct cloudaccessor *out)
{
    const struct json_value *a = index < f->accessors.n ? f->accessors.at[index] : NULL;
    const char *is = json_get_text(json_member(a, "type"));
    uint64_t component, n, from, view, offset, len, stride, size;
    bool normalized = false;
    enum status st;

    (void)json_get_flag(json_member(a, "normalized"), &normalized);
    if (is == NULL || strcmp(is, type) != 0 ||
        !count_or(a, "componentType", 0, &component) || !count_or(a, "count", 0, &n) ||
        !count_or(a, "byteOffset", 0, &from) ||
        !count_or(a, "bufferView", UINT64_MAX, &view) ||
        !set_type(component, normalized, out))
        return errinfo_set(f->e, ST_EINVAL, "GLB: accessor %llu is not a %s of numbers",
                           (unsigned long long)index, type);
    if (json_member(a, "sparse") != NULL || view == UINT64_MAX)
        return errinfo_set(f->e, ST_EVERSION,
                           "GLB: accessor %llu is sparse, which is not read: export "
                           "without it",
                           (unsigned long long)index);
    if ((st = open_view(f, view, &offset, &len, &stride)) != ST_OK)
        return st;
    size = cloudvalue_size[out->type] * (strcmp(type, "VEC3") == 0 ? 3U : 1U);
    if (stride == 0)
        stride = size;
    if (from > len || stride < size || stride > f->len || n > f->len ||
        (n > 0 && (len - from < size || (len - from - size) / stride < n - 1)))
        return errinfo_set(f->e, ST_EINVAL, "GLB: accessor %llu is beyond its bufferView",
                           (unsigned long long)index);
    out->at = f->bin + offset + from;
    out->n = (size_t)n;
    out->stride = (size_t)stride;
    return ST_OK;
}

double cloudaccessor_get(const struct cloudaccessor *a, size_t i, size_t k)
{
    return a->scale *
           cloudvalue_load(a->at + i * a->stride + k * cloudvalue_size[a->type], a->type,
                           cloudvalue_swap(false));
}
