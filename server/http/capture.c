#include "capture.h"

#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app.h"
#include "errinfo.h"
#include "errmap.h"
#include "access.h"
#include "json.h"
#include "request.h"

#define BLANKS " \t"

enum { DEVICE, NONCE, LIVENESS, SIG, FIELDS };

struct capture { /* the header's fields */
    char field[FIELDS][96];
    unsigned char signature[CRYPT_SIGN];
};

void capture_take(struct request *r, const char *value)
{
    struct request_capture *c = &r->capture;
    const size_t len = strlen(value);

    c->bad = c->bad || c->header[0] != '\0' || len == 0 || len > REQUEST_CAPTURE_MAX;
    if (!c->bad)
        memcpy(c->header, value, len + 1);
}

void capture_digest(struct request *r)
{
    if (r->capture.header[0] == '\0' || r->capture.digested)
        return;
    r->capture.digested = true;
    (void)crypto_hash_sha256(r->capture.body, r->body, r->len);
}

/* ---- the header */

/* One field, s[0..len-1]: its name, "=" and value; each once. */
static bool read_field(const char *s, size_t len, struct capture *c)
{
    static const char *const name[FIELDS] = {"device", "nonce", "liveness", "sig"};

    while (len > 0 && strchr(BLANKS, s[len - 1]) != NULL)
        len--;
    for (int i = 0; i < FIELDS; i++) {
        const size_t n = strlen(name[i]);

        if (len <= n + 1 || strncmp(s, name[i], n) != 0 || s[n] != '=')
            continue;
        if (c->field[i][0] != '\0' || len - n > sizeof c->field[i])
            return false;
        memcpy(c->field[i], s + n + 1, len - n - 1);
        return true;
    }
    return false;
}

/* c is empty. */
static bool capture_read_header(const char *s, struct capture *c)
{
    const char *liveness = c->field[LIVENESS];
    size_t n;

    while (*s != '\0') {
        s += strspn(s, BLANKS);
        n = strcspn(s, ";");
        if (!read_field(s, n, c))
            return false;
        s += n + (s[n] == ';');
    }
    return store_device_valid(c->field[DEVICE]) && c->field[NONCE][0] != '\0' &&
           (strcmp(liveness, "pass") == 0 || strcmp(liveness, "fail") == 0 ||
            strcmp(liveness, "none") == 0) &&
           sodium_base642bin(c->signature, sizeof c->signature, c->field[SIG],
                             strlen(c->field[SIG]), NULL, &n, NULL,
                             sodium_base64_VARIANT_ORIGINAL) == 0 &&
           n == sizeof c->signature;
}

/* ---- taking a capture */

static bool capture_refuse(struct request *r, unsigned problem, const char *why)
{
    request_problem(r, problem, "%s", why);
    return false;
}

/* What the device has signed: heap, or NULL. */
static char *signed_text(const struct request *r, const struct capture *c)
{
    const char *type = r->capture.type != NULL ? r->capture.type : "";
    const char *coding = r->capture.coding != NULL ? r->capture.coding : "";
    const size_t size = strlen(r->target) + strlen(type) + strlen(coding) + 512;
    char *text = malloc(size), hex[2 * sizeof r->capture.body + 1];

    (void)sodium_bin2hex(hex, sizeof hex, r->capture.body, sizeof r->capture.body);
    if (text != NULL)
        (void)snprintf(text, size,
                       "surfaced capture 2\nPOST %s\n%s\n%s\n%s\n%s\n%s\n%s\n", r->target,
                       c->field[DEVICE], c->field[NONCE], c->field[LIVENESS], hex, type,
                       coding);
    return text;
}

/* A capture that its device has signed, and that is refused, is a sign of an attack. */
static void record(struct request *r, unsigned problem)
{
    char outcome[CAPTURE_OUTCOME];

    access_event(r, "capture", capture_outcome(r, errmap_get(problem)->code, outcome));
}

static bool judge(struct request *r, const struct capture *c, enum store_captured is)
{
    static const struct {
        unsigned problem;
        const char *why;
    } refusal[] = {
        [STORE_CAPTURE_UNKNOWN] = {ERRMAP_CAPTURE_INVALID, "there is no such device"},
        [STORE_CAPTURE_FORGED] =
            {ERRMAP_CAPTURE_INVALID,
             "the device has not signed this body, its type and coding, this target, nonce "
             "and liveness"},
        [STORE_CAPTURE_FOREIGN] = {ERRMAP_CAPTURE_INVALID,
                                   "the nonce is not from POST /v1/challenge"},
        [STORE_CAPTURE_STALE] = {ERRMAP_CAPTURE_STALE,
                                 "the nonce has expired after 2 minutes: request "
                                 "another"},
        [STORE_CAPTURE_REPLAYED] = {ERRMAP_CAPTURE_REPLAYED,
                                    "the nonce was used already: request another"},
    };
    const bool alive = strcmp(c->field[LIVENESS], "fail") != 0;

    if (is == STORE_CAPTURED && alive)
        return true;
    if (is == STORE_CAPTURED) {
        record(r, ERRMAP_LIVENESS);
        return capture_refuse(r, ERRMAP_LIVENESS,
                              "the scanner reports that this is not a living face");
    }
    if (is == STORE_CAPTURE_STALE || is == STORE_CAPTURE_REPLAYED)
        record(r, refusal[is].problem);
    return capture_refuse(r, refusal[is].problem, refusal[is].why);
}

bool capture_admit(struct request *r)
{
    struct request_capture *x = &r->capture;
    struct store_capture take = {.text = NULL};
    enum store_captured is;
    struct errinfo e = {0};
    struct capture c = {.field = {""}};
    enum status st;
    char *text;

    if (x->captured[0] != '\0') /* it was taken, by the worker for small bodies */
        return true;
    if (x->header[0] == '\0' && !x->bad)
        return !r->app->signed_captures ||
               capture_refuse(r, ERRMAP_CAPTURE_REQUIRED,
                              "send Capture-Signature, made by a scanner registered with "
                              "surfacectl device add");
    if (x->bad || !capture_read_header(x->header, &c))
        return capture_refuse(r, ERRMAP_CAPTURE_INVALID,
                              "Capture-Signature is not once device=NAME; nonce=NONCE; "
                              "liveness=pass|fail|none; sig=BASE64");
    if ((text = signed_text(r, &c)) == NULL) {
        request_problem(r, ST_ENOMEM, "no memory for the signed text");
        return false;
    }
    take.device = c.field[DEVICE];
    take.nonce = c.field[NONCE];
    take.text = text;
    take.len = strlen(text);
    memcpy(take.signature, c.signature, sizeof take.signature);
    st = store_capture_take(r->app->store, &take, &is, &e);
    free(text);
    if (st != ST_OK) {
        request_fail(r, &e);
        return false;
    }
    (void)snprintf(x->captured, sizeof x->captured, " capture=%.4s:%.*s",
                   c.field[LIVENESS], STORE_DEVICE_MAX, c.field[DEVICE]);
    return judge(r, &c, is);
}

const char *capture_outcome(const struct request *r, const char *outcome,
                            char out[CAPTURE_OUTCOME])
{
    (void)snprintf(out, CAPTURE_OUTCOME, "%s%s", outcome, r->capture.captured);
    return out;
}

/* ---- nonces */

void capture_challenge(struct request *r, struct worker *w)
{
    char nonce[STORE_NONCE_TEXT + 1], expires[32];
    struct errinfo e = {0};
    struct json *j;

    (void)w;
    if (store_capture_nonce(r->app->store, nonce, expires, &e) != ST_OK) {
        request_fail(r, &e);
        return;
    }
    j = json_new();
    json_text(j, "nonce", nonce);
    json_text(j, "expires_at", expires);
    request_respond(r, 200, json_compact(j));
}
