/* read.h -- the readers of the formats behind cloudfile.h, each in read_FORMAT.c.
 * read_FORMAT_is(t): Returns true if a file of this format begins at t.  BNT is known by a header whose
 * numbers agree, STL by the word "solid" or the length that a binary file's count says, ABS by a line like
 * "480 rows"; OBJ and XYZ by their first line that is no comment.
 * read_FORMAT_count(t): Returns the number of points or pixels that the header at t says, which may be
 * wrong; 0: the header cannot be read.
 * read_FORMAT_parse(t, o, list): Adds the points to list; t stands at the first byte of the file,
 * for OBJ and XYZ behind a byte order mark.  Returns as cloudfile_read(), whose list of formats holds, and
 * PLY   ST_EVERSION also for a header of more than 16 elements or 256 properties
 * PCD   ST_EVERSION also for more than 64 fields
 * GLB   skins, morph targets and cameras are ignored
 * VRML  Coordinate (2.0) and Coordinate3 (1.0), moved by the Transforms above them (1.0: before
 *       them); normals by the IndexedFaceSets that can be read; other nodes are ignored.
 *       ST_EVERSION also for what might move, repeat or choose points in another way (Inline,
 *       LOD, MatrixTransform, PROTO, Switch, USE of points in another place), and for too many
 *       nested nodes or names
 * BNT   the rows of its grid go from the bottom up, unlike an image's: the cloud is not called
 *       organised, so that it does not seem to be a mirror image (mirror.h)
 * ABS   an organised cloud; ST_EVERSION also for other lists than flag, X, Y and Z
 * NPY   floats or integers, in C or Fortran order, by the shape.  C is 3 to 16, the first
 *       three are x, y and z: (N, C) and (3, N) are points, (H, W, C) and (3, H, W) an
 *       organised cloud, (H, W) a depth image (of floats without a scale the unit is unknown);
 *       of items with the fields x, y and z, or xyz, (N) and (H, W).  Other dimensions may be
 *       of length 1.  ST_EVERSION also for other types and shapes
 * PNG, PGM  of 16 bits, grey; ST_EVERSION: no camera is given, or other pixels */
#ifndef SCAN_READ_H
#define SCAN_READ_H
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include "status.h"

struct cloudfile_options; /* cloudfile.h */
struct cloudlist;         /* cloudlist.h */
struct cloudtext;         /* cloudtext.h */

typedef bool read_is(const struct cloudtext *t);
typedef uint64_t read_count(struct cloudtext t);
typedef enum status read_parse(struct cloudtext *t, const struct cloudfile_options *o,
                               struct cloudlist *list);

read_is read_abs_is, read_bnt_is, read_glb_is, read_npy_is, read_obj_is, read_pcd_is,
    read_pgm_is, read_ply_is, read_png_is, read_stl_is, read_vrml_is, read_xyz_is;
read_count read_npy_count, read_pcd_count, read_pgm_count, read_ply_count, read_png_count;
read_parse read_abs_parse, read_bnt_parse, read_glb_parse, read_npy_parse, read_obj_parse,
    read_pcd_parse, read_pgm_parse, read_ply_parse, read_png_parse, read_stl_parse,
    read_vrml_parse, read_xyz_parse;

/* read_pcd_unpack(in, len, out, size): LZF, as PCD files use it; false: it does not give just size
 * bytes.  Any bytes are safe.  O(size). */
bool read_pcd_unpack(const unsigned char *in, size_t len, unsigned char *out,
                     size_t size);

#endif
