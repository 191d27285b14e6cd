#include "event.h"

#include <stdio.h>
#include <string.h>

#include "ident.h"
#include "json.h"

#define UNTIL " until " /* before the end of a lock-out (store_verification.c) */

/* outcome: NULL: the first word of the entry's. */
static const struct kind {
    const char *kind, *type, *outcome;
} kinds[] = {
    {"verify", "verify", NULL},
    {"identify", "identify", NULL},
    {"enroll", "enroll", "enrolled"},
    {"enroll_mismatch", "enroll_mismatch", NULL},
    {"refused", "refused", NULL},
    {"capture", "refused", NULL},
    {"locked_out", "locked_out", "locked_out"},
    {"many_subjects", "many_subjects", "many_subjects"},
    {"attempts_pattern", "attempts_pattern", "attempts_pattern"},
    {"reset_attempts", "attempts_reset", "reset"},
    {"add_subject", "subject_added", NULL},
    {"import", "subject_imported", "imported"},
    {"set_subject", "consent_changed", NULL},
    {"set_groups", "groups_changed", NULL},
    {"rename_subject", "subject_renamed", NULL},
    {"hold_subject", "subject_held", NULL},
    {"release_subject", "subject_released", NULL},
    {"disable_subject", "subject_disabled", NULL},
    {"enable_subject", "subject_enabled", NULL},
    {"opt_in", "opted_in", "opted_in"},
    {"opt_out", "opted_out", "opted_out"},
    {"delete_template", "template_deleted", NULL},
    {"delete_subject", "subject_erased", NULL},
};

static const struct kind *event_find(const struct log_entry *entry)
{
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
        if (strcmp(kinds[i].kind, entry->kind) == 0)
            return &kinds[i];
    return NULL;
}

/* A search before an enrolment (unique=true). */
static bool is_for_twins(const struct log_entry *entry)
{
    return strcmp(entry->kind, "identify") == 0 &&
           strstr(entry->outcome, ", enroll") != NULL;
}

/* What a request was refused with that is logged as what it was sent for; NULL: it was not. */
static const char *refused_with(const struct log_entry *entry)
{
    if (strcmp(entry->outcome, "replayed") == 0)
        return "replayed";
    return is_for_twins(entry) ? "already_enrolled" : NULL;
}

const char *event_type(const struct log_entry *entry)
{
    const struct kind *k = event_find(entry);

    if (k == NULL || (is_for_twins(entry) && strncmp(entry->outcome, "match", 5) != 0))
        return NULL;
    return refused_with(entry) != NULL ? "refused" : k->type;
}

char *event_text(const struct store_audit_entry *a)
{
    const struct log_entry *entry = &a->entry;
    const struct kind *k = event_find(entry);
    const bool token = ident_id_valid(entry->actor);
    const char *until = strstr(entry->outcome, UNTIL);
    char first[LOG_TEXT + 1];
    struct json *j;

    if (event_type(entry) == NULL)
        return NULL;
    (void)snprintf(first, sizeof first, "%.*s", (int)strcspn(entry->outcome, " ,"),
                   entry->outcome);
    j = json_new();
    json_text(j, "at", entry->at);
    json_text(j, "type", event_type(entry));
    json_text(j, "outcome",
              refused_with(entry) != NULL ? refused_with(entry)
              : k->outcome != NULL        ? k->outcome
                                          : first);
    json_text_or_null(j, "subject", a->subject);
    json_text_or_null(j, "template_id", a->subject[0] != '\0' ? entry->object : "");
    json_text_or_null(j, "token", token ? a->actor_name : entry->actor);
    json_text(j, "token_id", token ? entry->actor : NULL);
    if (until != NULL)
        json_text(j, "until", until + strlen(UNTIL));
    return json_compact(j);
}

char *event_gap(const char *at)
{
    struct json *j = json_new();

    json_text(j, "at", at);
    json_text(j, "type", "gap");
    json_text(j, "outcome", "trimmed");
    json_text_or_null(j, "subject", "");
    json_text_or_null(j, "template_id", "");
    json_text_or_null(j, "token", "");
    json_text_or_null(j, "token_id", "");
    return json_compact(j);
}

bool event_visible(const struct store_audit_entry *a, const char *token,
                   const char *groups)
{
    if (groups[0] == '\0')
        return true;
    if (a->subject[0] == '\0')
        return token[0] != '\0' && strcmp(a->entry.actor, token) == 0;
    return groups_meet(groups, a->groups);
}
