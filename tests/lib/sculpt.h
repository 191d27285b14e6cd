/* sculpt.h -- a small morphable model of the toy's face (toy.h), as a folder of OBJ files. */
#ifndef TESTS_SCULPT_H
#define TESTS_SCULPT_H
#include <stdbool.h>

#define SCULPT_IDENTITIES  4
#define SCULPT_EXPRESSIONS 5
#define SCULPT_NX          27 /* vertices of the mesh */
#define SCULPT_NY          35

/* sculpt_write(dir, unit_mm, pitch): the files, in an existing folder; false: errno.
 * unit_mm  millimetres per unit of the files
 * pitch    slope by which the head is tilted, and it is shifted by some cm: to be undone
 * The mesh has a second surface 3 mm in front of the brows, of a material "M_Lash". */
bool sculpt_write(const char *dir, double unit_mm, double pitch);

#endif
