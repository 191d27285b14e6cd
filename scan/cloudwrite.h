/* cloudwrite.h -- a mesh as a scanner's file. */
#ifndef SCAN_CLOUDWRITE_H
#define SCAN_CLOUDWRITE_H
#include "newfile.h"

newfile_writer
    cloudwrite_ply; /* a struct mesh as PLY, mm, to the last digit of the lattice */

#endif
