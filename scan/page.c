#include "page.h"

#include <math.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>
#include <sys/stat.h>
#include <zlib.h>

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

enum status page_write(FILE *to, const void *arg, struct errinfo *e)
{
    const struct show *show = arg;
    uLongf len = compressBound((uLong)show->len);
    unsigned char *packed = mem_array(len, 1);

    if (packed == NULL || compress2(packed, &len, show->glb, (uLong)show->len,
                                    Z_BEST_COMPRESSION) != Z_OK) {
        mem_free(packed);
        return errinfo_set(e, ST_ENOMEM, "out of memory");
    }
    (void)fwrite(page_html, 1, sizeof page_html - 1, to);
    write_base64(to, packed, len);
    (void)fputs("</script>\n</body>\n</html>\n", to);
    mem_free(packed);
    return ST_OK;
}
