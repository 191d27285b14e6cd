/* clouderror.h -- what is wrong with a scanner's file, and where. */
#ifndef SCAN_CLOUDERROR_H
#define SCAN_CLOUDERROR_H
#include <stddef.h>
#include <stdint.h>

struct clouderror {
    size_t where;  /* byte offset */
    uint32_t line; /* line number from 1 for text, 0 in binary data */
    char what[96]; /* a sentence without its full stop; no coordinates */
};

#endif
