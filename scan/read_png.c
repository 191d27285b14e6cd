#include "read.h"

#include <spng.h>
#include <stdint.h>
#include <string.h>

#include "clouddepth.h"
#include "cloudfile.h"
#include "cloudlist.h"
#include "cloudtext.h"
#include "cloudvalue.h"
#include "errinfo.h"
#include "mem.h"

#define CHUNK_MAX  (1U << 20) /* bytes of what a file says beside its pixels */
#define PNG_LENGTH 8          /* of the signature */

bool read_png_is(const struct cloudtext *t)
{
    return t->end - t->p >= PNG_LENGTH &&
           memcmp(t->p, "\x89PNG\r\n\x1A\n", PNG_LENGTH) == 0;
}

/* The first chunk: its length, its name, the width and the height. */
uint64_t read_png_count(struct cloudtext t)
{
    const unsigned char *at = (const unsigned char *)t.p + PNG_LENGTH + 8;
    const bool swap = cloudvalue_swap(true);

    if (t.end - t.p < PNG_LENGTH + 16)
        return 0;
    return (uint64_t)cloudvalue_load(at, CLOUDVALUE_U32, swap) *
           (uint64_t)cloudvalue_load(at + 4, CLOUDVALUE_U32, swap);
}

static enum status png_failed(struct cloudlist *list, int code)
{
    return code == SPNG_EMEM
               ? errinfo_set(list->e, ST_ENOMEM, "no memory for the PNG file")
               : errinfo_set(list->e, ST_EINVAL, "the PNG file is damaged: %s",
                             spng_strerror(code));
}

static enum status check_image(const struct spng_ihdr *h, size_t max_bytes,
                               struct cloudlist *list)
{
    if (h->color_type != SPNG_COLOR_TYPE_GRAYSCALE || h->bit_depth != 16)
        return errinfo_set(
            list->e, ST_EVERSION,
            "a PNG picture of %u bits%s: a depth image has 16 bits, grey", h->bit_depth,
            h->color_type == SPNG_COLOR_TYPE_GRAYSCALE ? "" : ", in colour");
    if ((uint64_t)h->width * h->height > max_bytes / 2)
        return errinfo_set(list->e, ST_ESIZE,
                           "%lu x %lu pixels: the limit is %zu bytes when unpacked",
                           (unsigned long)h->width, (unsigned long)h->height, max_bytes);
    return ST_OK;
}

static enum status decode(spng_ctx *png, const struct clouddepth_camera *camera,
                          size_t max_bytes, struct cloudlist *list)
{
    struct clouddepth depth;
    struct spng_ihdr h;
    uint16_t *pixels;
    size_t n;
    enum status st;
    int code = spng_get_ihdr(png, &h);

    if (code != SPNG_OK)
        return png_failed(list, code);
    if ((st = check_image(&h, max_bytes, list)) != ST_OK ||
        (st = clouddepth_begin(&depth, camera, h.width, h.height, list)) != ST_OK)
        return st;
    n = (size_t)h.width * h.height;
    if ((pixels = mem_array(n, sizeof *pixels)) == NULL)
        return png_failed(list, SPNG_EMEM);
    code = spng_decode_image(png, pixels, n * sizeof *pixels, SPNG_FMT_PNG, 0);
    if (code != SPNG_OK)
        st = png_failed(list, code);
    for (size_t i = 0; i < n && st == ST_OK; i++)
        st = clouddepth_add(&depth, pixels[i]);
    mem_free(pixels);
    return st;
}

enum status read_png_parse(struct cloudtext *t, const struct cloudfile_options *o,
                           struct cloudlist *list)
{
    spng_ctx *png = spng_ctx_new(0);
    enum status st;
    int code;

    if (png == NULL)
        return png_failed(list, SPNG_EMEM);
    code = spng_set_chunk_limits(png, CHUNK_MAX, CHUNK_MAX);
    if (code == SPNG_OK)
        code = spng_set_png_buffer(png, t->p, (size_t)(t->end - t->p));
    st = code == SPNG_OK ? decode(png, &o->camera, o->max_bytes, list)
                         : png_failed(list, code);
    spng_ctx_free(png);
    return st;
}
