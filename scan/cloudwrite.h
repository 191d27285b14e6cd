/* cloudwrite.h -- a face as a scanner's file. */
#ifndef SCAN_CLOUDWRITE_H
#define SCAN_CLOUDWRITE_H
#include "newfile.h"

/* A struct surface_face as PLY, mm, to the last digit of the lattice. */
newfile_writer cloudwrite_ply;

#endif
