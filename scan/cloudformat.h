/* cloudformat.h -- the formats of scanners' files: their names, the endings of files and the
 * media types by which they are known, and the formats that are refused by name. */
#ifndef SCAN_CLOUDFORMAT_H
#define SCAN_CLOUDFORMAT_H
#include <stdbool.h>
#include <stddef.h>

enum cloudformat {
    CLOUDFORMAT_ANY, /* recognised by its content */
    CLOUDFORMAT_PLY,
    CLOUDFORMAT_OBJ,
    CLOUDFORMAT_STL,
    CLOUDFORMAT_PCD,
    CLOUDFORMAT_GLB,
    CLOUDFORMAT_XYZ, /* numbers in lines: XYZ, PTS, CSV */
    CLOUDFORMAT_PNG, /* a depth image */
    CLOUDFORMAT_JSON,
    CLOUDFORMAT_VRML,
    CLOUDFORMAT_BNT, /* of the Bosphorus database */
    CLOUDFORMAT_ABS, /* of FRGC */
    CLOUDFORMAT_NPY,
    CLOUDFORMAT_PGM, /* a depth image */
    CLOUDFORMAT_RAW, /* the values of a depth image alone: nothing in it says so */
    CLOUDFORMAT_COUNT
};

/* The formats that are read, for messages. */
#define CLOUDFORMAT_READ                                                                 \
    "PLY, OBJ, STL, PCD, GLB, VRML, XYZ, PTS, CSV, NPY, BNT, ABS, JSON, and depth "      \
    "images in PNG, PGM and RAW"

const char *cloudformat_name(enum cloudformat f); /* "PLY"; "" of CLOUDFORMAT_ANY */

/* cloudformat_ending(name): Returns the ending of a scan's file within its name, small and capital letters
 * alike; .gz with the ending before it ("a.ply.gz": ".ply.gz").  NULL: it is not the name of a scan. */
const char *cloudformat_ending(const char *name);

/* cloudformat_media(type, len, out): Finds the format of a media type without parameters; CLOUDFORMAT_ANY for
 * text, bytes and types that say nothing about the content.  Returns false if the type is that of no scan. */
bool cloudformat_media(const char *type, size_t len, enum cloudformat *out);

/* cloudformat_media_list(): Returns the media types, for messages. */
const char *cloudformat_media_list(void);

/* cloudformat_foreign(p, len): Returns the kind of a file that is known and not read by its first
 * bytes, in words ("an OFF file"); NULL if it is none of them. */
const char *cloudformat_foreign(const char *p, size_t len);

/* cloudformat_converted(bytes, len): Returns true if these are binary data that a program has converted as text,
 * to other line ends, to UTF-8 or to ASCII.  Binary data have zero bytes.  By chance they are not valid UTF-8 with
 * characters beyond ASCII, nor ASCII with many question marks, nor do they have a CR before each LF.
 * Cost: O(len) for such data and for text; else it stops at the first byte that shows the contrary. */
bool cloudformat_converted(const char *bytes, size_t len);

#endif
