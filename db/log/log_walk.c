#include "log_walk.h"

#include <inttypes.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>

void log_walk_begin(struct log_walk *w, const struct crypt *crypt,
                    const unsigned char public[CRYPT_KEY], log_report *report, void *arg)
{
    *w = (struct log_walk){.crypt = crypt, .report = report, .arg = arg};
    memcpy(w->public, public, CRYPT_KEY);
}

void log_walk_problem(struct log_walk *w, uint64_t seq, const char *line)
{
    w->problems++;
    if (w->first == 0 || w->log < w->first_log ||
        (w->log == w->first_log && seq < w->first)) {
        w->first_log = w->log;
        w->first = seq;
    }
    w->report(w->arg, w->log, seq, line);
}

/* "entry 5 is", "entries 5 to 9 of daemon 1 are", and what is said of them. */
static void tell_of(struct log_walk *w, uint32_t daemon, uint64_t from, uint64_t to,
                    const char *what)
{
    char line[160], whose[24] = "";

    if (daemon != 0)
        (void)snprintf(whose, sizeof whose, " of daemon %" PRIu32, daemon);
    if (from == to)
        (void)snprintf(line, sizeof line, "entry %" PRIu64 "%s is %s", from, whose, what);
    else
        (void)snprintf(line, sizeof line, "entries %" PRIu64 " to %" PRIu64 "%s are %s",
                       from, to, whose, what);
    log_walk_problem(w, from, line);
}

static void log_walk_tell(struct log_walk *w, uint64_t from, uint64_t to,
                          const char *what)
{
    tell_of(w, w->daemon, from, to, what);
}

/* The run of wrong entries, if there is one, ends with the last. */
static void end_run(struct log_walk *w)
{
    if (w->bad != 0)
        log_walk_tell(w, w->bad, w->at.seq, "not what was written");
    w->bad = 0;
}

/* Is it the next one?  What lies between is missing. */
static bool come_to(struct log_walk *w, uint64_t seq)
{
    if (seq <= w->at.seq) {
        end_run(w);
        log_walk_tell(w, seq, seq, "not in its place");
        return false;
    }
    if (seq > w->at.seq + 1) {
        end_run(w);
        log_walk_tell(w, w->at.seq + 1, seq - 1, "missing");
        w->lost = true;
    }
    return true;
}

static bool has_mac(const struct log_walk *w, const struct log_entry *entry)
{
    unsigned char mac[CRYPT_HASH];

    if (w->crypt == NULL)
        return true;
    log_mac(w->crypt, entry->hash, mac);
    return sodium_memcmp(mac, entry->mac, sizeof mac) == 0;
}

/* A signature of the key before a rekey is none of this key's, and proves nothing any more. */
static void note_change(struct log_walk *w, const struct log_entry *entry)
{
    w->accesses[entry->daemon] = entry->accesses;
    (void)log_trimmed(entry, w->trimmed);
    if (log_signed(w->public, entry, "")) {
        w->checkpoints++;
        w->signed_to = entry->seq;
    }
}

/* The entry that the last change found at the end of the accesses. */
static void check_bound(struct log_walk *w, const struct log_entry *entry)
{
    const struct log_end *bound = &w->accesses[entry->daemon];

    if (entry->seq == bound->seq && memcmp(entry->hash, bound->hash, LOG_HASH) != 0)
        log_walk_tell(w, entry->seq, entry->seq,
                      "not the one that was the last when the last change was made");
}

/* The accesses of the daemon have ended. */
static void end_accesses(struct log_walk *w)
{
    const struct log_end *bound = &w->accesses[w->daemon];

    end_run(w);
    if (w->at.seq < bound->seq)
        log_walk_tell(w, w->at.seq + 1, bound->seq, "cut off the end");
    else if (w->crypt == NULL && w->at.seq > bound->seq)
        log_walk_tell(w, bound->seq + 1, w->at.seq, "not signed by any change");
}

static void begin_accesses(struct log_walk *w, uint32_t daemon)
{
    w->daemon = daemon;
    w->at = w->trimmed[daemon];
    w->lost = false;
}

void log_walk_step(struct log_walk *w, const struct log_entry *entry)
{
    unsigned char made[LOG_HASH];
    bool good;

    w->entries++;
    while (w->log == LOG_ACCESSES && entry->daemon > w->daemon) {
        end_accesses(w);
        begin_accesses(w, w->daemon + 1);
    }
    if (w->log == LOG_ACCESSES && entry->daemon < w->daemon) {
        end_run(w);
        tell_of(w, entry->daemon, entry->seq, entry->seq, "behind another daemon's");
        return;
    }
    if (!come_to(w, entry->seq))
        return;
    log_hash(w->at.hash, entry, made);
    good = (w->lost || memcmp(made, entry->hash, sizeof made) == 0) && has_mac(w, entry);
    if (good)
        end_run(w);
    else if (w->bad == 0)
        w->bad = entry->seq;
    w->lost = false;
    w->at.seq = entry->seq;
    memcpy(w->at.hash, entry->hash, LOG_HASH);
    if (w->log == LOG_CHANGES)
        note_change(w, entry);
    else
        check_bound(w, entry);
}

void log_walk_damaged(struct log_walk *w, uint64_t seq)
{
    w->entries++;
    if (!come_to(w, seq))
        return;
    if (w->bad == 0)
        w->bad = seq;
    w->lost = true;
    w->at.seq = seq;
}

void log_walk_accesses(struct log_walk *w)
{
    end_run(w);
    w->changes = w->entries;
    w->head = w->at;
    w->log = LOG_ACCESSES;
    begin_accesses(w, 0);
}

void log_walk_end(struct log_walk *w)
{
    if (w->log == LOG_CHANGES) {
        end_run(w);
        return;
    }
    end_accesses(w);
    while (w->daemon + 1 < LOG_DAEMONS) {
        begin_accesses(w, w->daemon + 1);
        end_accesses(w);
    }
}
