/* study.h -- the studies, each a file of its own.  What each writes stands in its .html
 * (the part of the report), what came out in docs/studies.md. */
#ifndef STUDIES_STUDY_H
#define STUDIES_STUDY_H

struct lab; /* lab.h */

void missing_run(const struct lab *lab); /* the missing-points paper's figures, tables */

#endif
