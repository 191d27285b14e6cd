/* study.h -- the studies, each a file of its own.  What each writes stands in its .html
 * (the part of the report), what came out in docs/studies.md. */
#ifndef STUDIES_STUDY_H
#define STUDIES_STUDY_H

struct lab; /* lab.h */

void approx_run(const struct lab *lab);  /* general triangulation against exact overlay */
void method_run(const struct lab *lab);  /* the disparity paper's figures 1 to 9 */
void bound_run(const struct lab *lab);   /* the minimum, a lower bound */
void climb_run(const struct lab *lab);   /* faces learned from scores */
void cost_run(const struct lab *lab);    /* the disparity paper's tables 1 to 4, growth */
void cover_run(const struct lab *lab);   /* faces with parts missing */
void fewer_run(const struct lab *lab);   /* simplified surfaces and templates */
void filled_run(const struct lab *lab);  /* restored points by the size of the hole */
void faces_run(const struct lab *lab);   /* figures 10 and 11, the weight */
void removal_run(const struct lab *lab); /* which removals hurt */
void scans_run(const struct lab *lab);   /* scans as scanners deliver them */
void several_run(const struct lab *lab); /* the best of several templates */
void mirror_run(const struct lab *lab);  /* asymmetry planted and found */
void minimal_run(const struct lab *lab); /* the minimum, against brute force */
void missing_run(const struct lab *lab); /* the missing-points paper's figures, tables */

#endif
