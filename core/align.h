/* align.h -- shifts and rotations to the smallest disparity.
 * Paper 1 section 4.  The probe moves, the template stays: its triangulation and tree are
 * never rebuilt.  (1) A pose estimate, several starts; (2) robust sums of vertical gaps at
 * probe points located in the template's triangulation, each found again from where it
 * was last time, coarse to fine, by reweighted Gauss-Newton steps; (3) the exact disparity
 * over the general triangulation, so that the number reported is a minimum of that. */
#ifndef CORE_ALIGN_H
#define CORE_ALIGN_H
#include <stdint.h>
#include "status.h"

enum align_stop {
    ALIGN_CONVERGED, /* the last step was below the resolution */
    ALIGN_STEPS,     /* the step limit was reached first */
    ALIGN_APART      /* the surfaces have too little in common at every start */
};

struct align_result {
    double transform[16];  /* probe (mm) -> template (mm), row-major 4 x 4, rigid */
    uint32_t evaluations;  /* robust sums evaluated (over subsets of points too) */
    uint32_t exact;        /* evaluations of the exact measure */
    uint32_t starts;       /* starting poses tried */
    enum align_stop stop;
};

#endif
