/* LibLZF's format: a control byte below 32 n is followed by n + 1 literal bytes; another control byte says in its upper three bits how many bytes to repeat (7: a byte with more
 * of the length follows), in its lower five and the next byte from how far back. */
#include "cloudlzf.h"

#include <string.h>

bool cloudlzf_unpack(const unsigned char *in, size_t len, unsigned char *out, size_t size)
{
    size_t from = 0, to = 0;

    while (from < len) {
        const unsigned control = in[from++];
        size_t n = control < 32 ? control + 1 : (control >> 5) + 2, back;

        if (control < 32) {
            if (n > len - from || n > size - to)
                return false;
            memcpy(out + to, in + from, n);
            from += n;
            to += n;
            continue;
        }
        if (control >> 5 == 7) {
            if (from == len)
                return false;
            n += in[from++];
        }
        if (from == len)
            return false;
        back = ((control & 31) << 8) + in[from++] + 1;
        if (back > to || n > size - to)
            return false;
        for (; n > 0; n--, to++) /* the two may overlap */
            out[to] = out[to - back];
    }
    return to == size;
}
