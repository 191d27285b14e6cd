/* cloudlzf.h -- decompresses LZF, as PCD files use it. */
#ifndef SCAN_CLOUDLZF_H
#define SCAN_CLOUDLZF_H
#include <stdbool.h>
#include <stddef.h>

/* cloudlzf_unpack(in, len, out, size): false: it does not give just size bytes.  Any bytes
 * are safe.  O(size). */
bool cloudlzf_unpack(const unsigned char *in, size_t len, unsigned char *out,
                     size_t size);

#endif
