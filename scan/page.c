#include "page.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>
#include <sys/stat.h>
#include <zlib.h>

#include "bytes.h"
#include "errinfo.h"
#include "json.h"
#include "mem.h"
#include "page_html.h"
#include "show.h"
#include "utc.h"

void page_side(struct json *j, const char *key, const char *name, const char *about,
               const char *at, double quality)
{
    json_object(j, key);
    json_text(j, "name", name);
    json_text(j, "about", about);
    json_text(j, "at", at);
    json_number(j, "quality", quality);
    json_close(j);
}

void page_file(struct json *j, const char *key, const char *path, double quality)
{
    const char *slash = strrchr(path, '/');
    struct stat sb;
    char at[UTC_TEXT];
    const bool known = strcmp(path, "-") != 0 && stat(path, &sb) == 0;

    if (known)
        utc_print((int64_t)sb.st_mtime * 1000, at);
    page_side(j, key, slash != NULL ? slash + 1 : path, known ? "file of" : "file",
              known ? at : NULL, quality);
}

void page_made(struct json *j)
{
    char at[UTC_TEXT];
    int64_t now;

    (void)utc_now(&now);
    utc_print(now, at);
    json_text(j, "made_at", at);
}

static void write_base64(FILE *to, const unsigned char *in, size_t len)
{
    static const char digit[] =
        "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";

    for (size_t i = 0; i < len; i += 3) {
        const unsigned b = i + 1 < len ? in[i + 1] : 0, c = i + 2 < len ? in[i + 2] : 0;
        const unsigned bits = (unsigned)in[i] << 16 | b << 8 | c;

        (void)fputc(digit[bits >> 18], to);
        (void)fputc(digit[bits >> 12 & 63], to);
        (void)fputc(i + 1 < len ? digit[bits >> 6 & 63] : '=', to);
        (void)fputc(i + 2 < len ? digit[bits & 63] : '=', to);
    }
}

/* The array's bytes: first all first ones of its elements, then all second ones, and so on, each as the
 * difference from the one before.  Coordinates and corners that lie together differ little, so that
 * this packs a third better (page.js puts them back). */
static void reorder(const unsigned char *from, size_t len, size_t size, unsigned char *to)
{
    for (size_t k = 0; k < size; k++) {
        unsigned char last = 0;

        for (size_t at = k; at < len; at += size) {
            *to++ = (unsigned char)(from[at] - last);
            last = from[at];
        }
    }
}

/* An element, or a triangle. */
static size_t size_of(const struct json_value *accessor)
{
    char type[8] = "";
    uint64_t number = 0;

    (void)json_copy_text(json_member(accessor, "type"), type, sizeof type);
    (void)json_get_count(json_member(accessor, "componentType"), &number);
    return strcmp(type, "VEC3") == 0 || number == 5125 ? 12 : number == 5123 ? 6 : 4;
}

/* The file with its arrays reordered: accessor i is of the view i (glbwrite.h).  NULL: no memory. */
static unsigned char *reordered(const struct show *show)
{
    unsigned char *out = mem_array(show->len, 1);
    const size_t size = bytes_number(show->glb + 12, 4);
    struct json_value *doc = NULL;
    const struct json_value *a, *v;
    uint64_t offset = 0, len = 0;

    if (out == NULL)
        return NULL;
    memcpy(out, show->glb + 20, size);
    out[size] = '\0'; /* as json_read() asks for */
    if (json_read((char *)out, size, SIZE_MAX, &doc, NULL) != ST_OK) {
        mem_free(out);
        return NULL;
    }
    memcpy(out, show->glb, show->len);
    a = json_first(json_member(doc, "accessors"));
    for (v = json_first(json_member(doc, "bufferViews")); v != NULL && a != NULL;
         v = json_next(v), a = json_next(a))
        if (json_get_count(json_member(v, "byteOffset"), &offset) &&
            json_get_count(json_member(v, "byteLength"), &len))
            reorder(show->glb + 28 + size + offset, len, size_of(a),
                    out + 28 + size + offset);
    json_free(doc);
    return out;
}

enum status page_write(FILE *to, const void *arg, struct errinfo *e)
{
    const struct show *show = arg;
    uLongf len = compressBound((uLong)show->len);
    unsigned char *packed = mem_array(len, 1), *ordered = reordered(show);
    const bool done =
        packed != NULL && ordered != NULL &&
        compress2(packed, &len, ordered, (uLong)show->len, Z_BEST_COMPRESSION) == Z_OK;

    mem_free(ordered);
    if (!done) {
        mem_free(packed);
        return errinfo_memory(e);
    }
    (void)fwrite(page_html, 1, sizeof page_html - 1, to);
    write_base64(to, packed, len);
    (void)fputs("</script>\n</body>\n</html>\n", to);
    mem_free(packed);
    return ST_OK;
}
