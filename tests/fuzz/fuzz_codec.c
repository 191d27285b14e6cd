/* Stored faces.  If the first byte is odd, the length is corrected, so that the bytes after it
 * are parsed.  An accepted face must encode to bytes that decode
 * and encode to themselves, and its mesh must be safe to walk: it is compared with itself. */
#include "fuzz.h"

#include <stdlib.h>
#include <string.h>

#include "codec.h"
#include "face.h"

#define LENGTH_AT 8 /* db/FORMAT.md */

static void put_u64(uint8_t *p, uint64_t value)
{
    for (int i = 0; i < 8; i++)
        p[i] = (uint8_t)(value >> (8 * i));
}

static void try_model(const uint8_t *block, size_t size)
{
    static struct surface_work *w; /* kept: making it takes longer than all the rest */
    struct surface_face f = {0};
    struct surface_comparison result;
    uint8_t *first, *again;
    enum status st;
    size_t n;

    if (w == NULL && (w = surface_work_new(NULL)) == NULL)
        abort();
    st = codec_decode(block, size, w, &f);
    if (st == ST_OK) {
        n = surface_encoded_size(&f);
        if ((first = malloc(n)) == NULL || (again = malloc(n)) == NULL)
            abort();
        surface_encode(&f, first);
        if (codec_decode(first, n, w, &f) != ST_OK)
            abort();
        surface_encode(&f, again);
        if (memcmp(again, first, n) != 0)
            abort();
        free(first);
        free(again);
        if (surface_compare(w, &f, &f, &result) != SURFACE_OK)
            abort();
    } else if (st != ST_ECORRUPT && st != ST_EVERSION) {
        abort();
    }
    face_free(&f);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    uint8_t *block;

    if (size < 2)
        return 0;
    if ((block = malloc(size - 1)) == NULL)
        abort();
    memcpy(block, data + 1, size - 1);
    if (data[0] % 2 == 1 && size - 1 >= LENGTH_AT + 8)
        put_u64(block + LENGTH_AT, size - 1);
    try_model(block, size - 1);
    free(block);
    return 0;
}
