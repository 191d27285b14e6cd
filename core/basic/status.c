#include "status.h"

#include <stddef.h>

const char *status_message(enum status st)
{
    static const char *const text[ST_COUNT] = {
        [ST_OK] = "ok",
        [ST_EINVAL] = "malformed input",
        [ST_ENOMEM] = "out of memory",
        [ST_ESIZE] = "more bytes than the limit",
        [ST_ELIMIT] = "over the limit",
        [ST_ETOOFEW] = "too few points",
        [ST_ENOTFINITE] = "a coordinate is not finite",
        [ST_ERANGE] = "a coordinate is out of range",
        [ST_EDEGENERATE] = "the points lie on one line",
        [ST_EUNITS] = "the extent is not that of a face in the given units",
        [ST_ENOFACE] = "no face was found",
        [ST_ESEVERAL] = "more than one face",
        [ST_EMIRRORED] = "a mirror image",
        [ST_ENOTFACE] = "not a face",
        [ST_EQUALITY] = "the scan's quality is too low",
        [ST_ECORRUPT] = "damaged data",
        [ST_EVERSION] = "unsupported format or version",
        [ST_ENOTFOUND] = "not found",
        [ST_EEXISTS] = "already there",
        [ST_EMISMATCH] = "the sample does not fit the subject's others",
        [ST_EREPLAYED] = "a scan that was used before",
        [ST_EDENIED] = "not permitted",
        [ST_ETOKEN] = "the token has ended",
        [ST_ECHANGED] = "it was changed meanwhile",
        [ST_EREFUSED] = "not the database that it should be",
        [ST_EHELD] = "on hold",
        [ST_EFULL] = "the subject has the greatest number of templates",
        [ST_EBUSY] = "busy",
        [ST_EIO] = "input or output failed",
        [ST_EUNSYNCED] = "done, but not flushed to the disk",
        [ST_EDB] = "the database failed",
        [ST_EINTERNAL] = "internal error",
        [ST_EPEOPLE] = "frames of more than one person",
        [ST_EAPART] = "the frame does not lie on the others",
    };

    if ((unsigned)st >= ST_COUNT)
        return "unknown status";
    return text[st];
}

const char *surface_message(enum surface_status st)
{
    return status_message(status_from(st));
}

const char *status_refusal(enum status st)
{
    static const char *const code[ST_COUNT] = {[ST_ELIMIT] = "too_many_points",
                                               [ST_ETOOFEW] = "too_few_points",
                                               [ST_ENOTFINITE] = "not_finite",
                                               [ST_ERANGE] = "out_of_range",
                                               [ST_EDEGENERATE] = "degenerate",
                                               [ST_EUNITS] = "units_suspicious",
                                               [ST_ENOFACE] = "no_face",
                                               [ST_ESEVERAL] = "several_faces",
                                               [ST_EMIRRORED] = "mirrored",
                                               [ST_ENOTFACE] = "not_a_face",
                                               [ST_EQUALITY] = "low_quality",
                                               [ST_EPEOPLE] = "several_people",
                                               [ST_EAPART] = "apart"};

    return st == ST_OK ? NULL : code[st] != NULL ? code[st] : "malformed";
}
