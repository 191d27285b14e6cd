/* cloudfile.h -- the points of a scanner's file in memory.
 * Any bytes are safe.  Nothing that a file names is opened or fetched. */
#ifndef SCAN_CLOUDFILE_H
#define SCAN_CLOUDFILE_H
#include <stddef.h>
#include "clouddepth.h"
#include "cloudformat.h"
#include "cloudpoints.h"
#include "status.h"

struct errinfo;    /* errinfo.h */
struct json_value; /* json.h */
struct cloudlist;  /* cloudlist.h */

#define CLOUDFILE_POINTS 1000000 /* default limit: a depth image of 1280 x 720 fits */

struct cloudfile_options {
    /* as declared; CLOUDFORMAT_ANY: CLOUDFORMAT_RAW if the camera has a width, else
     * recognised by the content */
    enum cloudformat format;
    size_t max_points;               /* most points with a value */
    size_t max_bytes;                /* most bytes of a file or its parts, uncompressed */
    double unit_mm;                  /* millimetres per unit; 0: not given */
    struct clouddepth_camera camera; /* camera of a depth image; all 0: not given */
};

/* cloudfile_read(bytes, len, o, out, e): Reads a scanner's file; bytes[len] must be 0.
 * out   to be released by cloudpoints_free(); empty on failure.  Its unit is the file's own (JSON, a depth
 *       image, the heading of a text file), or else the unit of o.
 * e     on failure "line 3: ...", "byte 80: ...", or a sentence; may be NULL
 * A file may be compressed by gzip, and a byte order mark may stand before text.  Binary data that was
 * changed by a conversion as text is ST_EINVAL.
 * PLY   every scalar type, lists, any other elements and properties.  The data must be what the
 *       header says: too few rows, values on a line too many, or bytes after the last row are
 *       errors.  Behind the vertices only faces are read; if they cannot be read, the normals
 *       are unknown.  If the first row of an ascii file is not one
 *       line, the file is a stream of numbers, whatever its lines: then all of it must be
 *       what the header says.  Normals: nx, ny, nz, or the faces'.  No vertices at all is ST_OK with
 *       n == 0.
 * OBJ   "v" with 3 to 8 numbers, the first three taken; normals by the "f" lines; a backslash
 *       continues a line; other keywords are skipped.
 * STL   text and binary; equal vertices are one point; normals by the corners' order.
 * PCD   ascii, binary and binary_compressed, x, y, z anywhere among the fields, of type F, I or
 *       U; more bytes than the points take may follow.
 * GLB   glTF 2.0: the vertices of the scene's meshes, moved by their nodes; normals by the
 *       triangles' order; all data in the file, not compressed.  The format's unit is the metre,
 *       which not every program keeps to: it is not taken for granted.
 * VRML  1.0 and 2.0: the points of the coordinate nodes, moved by the transforms; normals by
 *       the faces; what would choose or repeat points is refused by name.  See read.h.
 * BNT   the Bosphorus database's: points with the z of its header have no value.
 * ABS   FRGC's: points whose flag is 0 have no value.
 * NPY   an array of points, or of distances: read.h.
 * PNG, PGM, RAW  depth images: clouddepth.h.
 * XYZ   numbers separated by blanks, commas, semicolons or tabs, not by a mixture; between
 *       semicolons or tabs, or in quotation marks, a comma is a decimal one.  An empty field,
 *       NA or null is no value.  Lines that begin with #, % or // are comments; "sep=;" and then
 *       a heading may come first, with an index before it: read_xyz.c.  PTS: a first line
 *       with a count, or one before each part.
 * JSON  {"points": [[x,y,z], ...], "units": "mm", "axes": "auto"}, or the list alone
 * Numbers do not depend on the locale and are correctly rounded.  Points without a value are
 * dropped (cloudpoints.h).
 * Cost O(n log n) for n bytes, unpacked.  Memory, whatever a header claims: 52 bytes a point
 * that is kept and has a normal, and twice that while it grows; uncompressed data, up to
 * max_bytes; of STL 8 bytes a vertex; and what cloudfile_read_document() says.
 * Returns ST_OK; ST_EINVAL malformed or truncated; ST_ENOTFINITE no point has a value, or a
 * number of JSON is too large; ST_ELIMIT more than max_points; ST_ESIZE more than max_bytes;
 * ST_EVERSION a format, or a variant of one, that is not read; ST_ENOMEM. */
enum status cloudfile_read(const void *bytes, size_t len,
                           const struct cloudfile_options *o, struct cloudpoints *out,
                           struct errinfo *e);

#define CLOUDFILE_POINT_WEIGHT 12 /* bytes of a point in a binary PLY */

/* cloudfile_weight(bytes, len, format): Returns how many bytes the points of a file would take as a binary
 * PLY of floats, by its header alone, if it is of a format that may have them in less (PNG and other
 * images, PCD, NPY, PLY); at least len.  SIZE_MAX: it is packed by gzip, and its length is
 * known only when it is unpacked.
 * format  as in struct cloudfile_options
 * bytes[len] need not be 0. */
size_t cloudfile_weight(const void *bytes, size_t len, enum cloudformat format);

/* cloudfile_read_json(object, name, prefix, o, out, e): Reads a cloud that is a part of a JSON document: an object,
 * or the list of its points alone.  Other members than points, units and axes are ST_EINVAL.
 *   name    the object's name in messages
 *   prefix  "" or "a.", before the names of its members */
enum status cloudfile_read_json(const struct json_value *object, const char *name,
                                const char *prefix, const struct cloudfile_options *o,
                                struct cloudpoints *out, struct errinfo *e);

/* cloudfile_read_document(text, len, max_points, clouds, out, e): Reads a JSON document of at most this many clouds.
 * text[len] is 0; *out is released by json_free().  Strict: one document and nothing behind it, valid UTF-8, no
 * key twice.
 * Memory: at most 75 bytes a point, and 80 a value behind one that is not a point; refused
 * before that when there are more values than the points can need.
 * Returns ST_OK; ST_EINVAL; ST_ELIMIT; ST_ENOMEM. */
enum status cloudfile_read_document(const char *text, size_t len, size_t max_points,
                                    size_t clouds, struct json_value **out,
                                    struct errinfo *e);

/* cloudfile_read_path(path, unit_mm, camera, out, e): Reads the points of a file of up to 256 MB ("-": standard
 * input), for the programs.
 *   unit_mm, camera  as in struct cloudfile_options
 *   e                on failure a message with the path */
enum status cloudfile_read_path(const char *path, double unit_mm,
                                const struct clouddepth_camera *camera,
                                struct cloudpoints *out, struct errinfo *e);

/* Readers of the programs' options --units (double: millimetres, 0: auto), --axes (bool: scanner) and --camera
 * (struct clouddepth_camera).  Each returns NULL, or the values that the option takes. */
const char *cloudfile_option_units(const char *text, void *value);
const char *cloudfile_option_axes(const char *text, void *value);
const char *cloudfile_option_camera(const char *text, void *value);

#endif
