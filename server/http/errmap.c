#include "errmap.h"

#include <stdio.h>

#include <stddef.h>

#include "json.h"

static const struct errmap map[ERRMAP_COUNT] = {
    [ST_EINVAL] = {400, "malformed", "The request is malformed"},
    [ST_ENOMEM] = {503, "out_of_memory", "Out of memory for now"},
    [ST_ESIZE] = {413, "body_too_large", "The body is over the limit"},
    [ST_ELIMIT] = {422, "too_many_points", "Too many points"},
    [ST_ETOOFEW] = {422, "too_few_points", "Too few points"},
    [ST_ENOTFINITE] = {422, "not_finite", "A coordinate is not a finite number"},
    [ST_ERANGE] = {422, "out_of_range", "A coordinate is out of range"},
    [ST_EDEGENERATE] = {422, "degenerate", "The points do not span a surface"},
    [ST_EUNITS] = {422, "units_suspicious", "The extent is not that of a face"},
    [ST_ENOFACE] = {422, "no_face", "No face was found"},
    [ST_ESEVERAL] = {422, "several_faces", "More than one face"},
    [ST_EMIRRORED] = {422, "mirrored", "The scan is a mirror image"},
    [ST_ENOTFACE] = {422, "not_a_face", "The surface is not a face"},
    [ST_EQUALITY] = {422, "low_quality", "The quality of the scan is too low"},
    [ST_EPEOPLE] = {422, "several_people", "The frames are of more than one person"},
    [ST_ECORRUPT] = {500, "internal", "Internal error"},
    [ST_EVERSION] = {500, "internal", "Internal error"},
    [ST_ENOTFOUND] = {404, "not_found", "Not found"},
    [ST_EEXISTS] = {409, "exists", "It exists already"},
    [ST_EMISMATCH] = {409, "sample_mismatch",
                      "The sample does not fit the subject's others"},
    [ST_EREPLAYED] = {422, "replayed", "The scan was enrolled before"},
    [ST_EDENIED] = {403, "forbidden", "Not permitted"},
    [ST_ETOKEN] = {401, "unauthorized", "A valid token is needed"},
    [ST_EREFUSED] = {503, "database_refused", "The database was altered or replaced"},
    [ST_EFULL] = {409, "too_many_templates",
                  "The subject has the greatest number of templates"},
    [ST_EHELD] = {409, "on_hold", "The subject is on hold"},
    [ST_EBUSY] = {503, "busy", "Busy for now"},
    [ST_EIO] = {503, "storage", "The storage cannot be used for now"},
    [ST_EUNSYNCED] = {503, "storage", "The storage cannot be used for now"},
    [ST_EDB] = {500, "internal", "Internal error"},
    [ST_EINTERNAL] = {500, "internal", "Internal error"},
    [ERRMAP_ROUTE] = {404, "no_such_route", "No such route"},
    [ERRMAP_METHOD] = {405, "method_not_allowed", "Method not allowed"},
    [ERRMAP_TARGET] = {414, "uri_too_long", "The path and query are too long"},
    [ERRMAP_HEADERS] = {431, "headers_too_large", "The headers are too large"},
    [ERRMAP_VERSION] = {505, "http_version", "Unsupported version of HTTP"},
    [ERRMAP_TRANSFER] = {501, "unsupported_transfer_encoding",
                         "Unsupported Transfer-Encoding"},
    [ERRMAP_NO_LENGTH] = {411, "length_required", "Length required"},
    [ERRMAP_MEDIA_TYPE] = {415, "unsupported_media_type", "Unsupported media type"},
    [ERRMAP_CODING] = {415, "unsupported_content_encoding",
                       "Unsupported Content-Encoding"},
    [ERRMAP_PACKED] = {400, "damaged_content_encoding",
                       "The body cannot be "
                       "decompressed"},
    [ERRMAP_NO_TOKEN] = {401, "unauthorized", "A valid token is needed"},
    [ERRMAP_SCOPE] = {403, "insufficient_scope", "The token lacks the scope"},
    [ERRMAP_OTHER_SITE] = {403, "other_site", "The request comes from another site"},
    [ERRMAP_DISABLED] = {403, "subject_disabled", "The subject is disabled"},
    [ERRMAP_EXPIRED] = {403, "subject_expired", "The subject has expired"},
    [ERRMAP_TOKENS] = {429, "too_many_wrong_tokens", "Too many wrong tokens"},
    [ERRMAP_ATTEMPTS] = {429, "too_many_attempts", "Too many failed verifications"},
    [ERRMAP_SUBJECTS] = {429, "too_many_subjects", "Too many subjects without a match"},
    [ERRMAP_SEARCHES] = {429, "too_many_searches", "Too many searches without a match"},
    [ERRMAP_GALLERY] = {503, "gallery_unavailable", "Nobody can be identified for now"},
    [ERRMAP_TWIN] = {409, "already_enrolled", "The face is that of another subject"},
    [ERRMAP_STORAGE_FULL] = {503, "storage_full", "Too little disk space for enrolments"},
    [ERRMAP_CAPTURE_REQUIRED] = {403, "capture_required", "A signed capture is needed"},
    [ERRMAP_CAPTURE_INVALID] = {403, "capture_invalid",
                                "The capture's signature is wrong"},
    [ERRMAP_CAPTURE_STALE] = {403, "capture_stale", "The capture's nonce has expired"},
    [ERRMAP_CAPTURE_REPLAYED] = {403, "capture_replayed",
                                 "The capture's nonce was used before"},
    [ERRMAP_LIVENESS] = {403, "liveness_failed",
                         "The scanner's liveness check has failed"},
    [ERRMAP_PARAMETER] = {400, "invalid_parameter",
                          "A parameter is malformed or unknown"},
    [ERRMAP_OVERLOAD] = {503, "overloaded", "Too many requests for now"},
    [ERRMAP_STREAMS] = {503, "too_many_streams", "Too many streams of events"},
    [ERRMAP_CURSOR] = {410, "cursor_unknown", "The cursor is not one of this log"},
    [ERRMAP_NOT_READY] = {503, "not_ready", "Not ready"},
    [ERRMAP_OWN_TOKEN] = {409, "own_token", "The token is the request's own"},
    [ERRMAP_REVOKED] = {409, "token_revoked", "The token was revoked"},
};

const struct errmap *errmap_get(unsigned kind)
{
    if (kind >= ERRMAP_COUNT || map[kind].code == NULL)
        kind = ST_EINTERNAL;
    return &map[kind];
}

struct json *errmap_problem(const struct errmap *m, const char *detail,
                            const char *request_id)
{
    struct json *j = json_new();
    char type[96];

    (void)snprintf(type, sizeof type, "urn:surfaced:problem:%s", m->code);
    json_text(j, "type", type);
    json_text(j, "title", m->title);
    json_number(j, "status", m->http);
    json_text(j, "detail", detail);
    json_text(j, "code", m->code);
    json_text(j, "request_id", request_id);
    return j;
}
