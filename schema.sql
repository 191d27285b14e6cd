-- schema.sql -- the template database, schema version 1.
-- Embedded in the programs at build and run in one transaction on an empty database.
-- A change here is a new user_version.

PRAGMA application_id = 0x53524644; -- "SRFD"
PRAGMA user_version = 1;

-- A person, under the client's own external id.
CREATE TABLE subjects (
    subject_key INTEGER PRIMARY KEY,
    id          TEXT NOT NULL UNIQUE
                CHECK (length(id) BETWEEN 1 AND 128
                       AND id NOT GLOB '*[^A-Za-z0-9._@:-]*'),
    created     TEXT NOT NULL CHECK (created GLOB '????-??-??T??:??:??.???Z')
) STRICT;

-- One enrolled face; never changed, only added and deleted.
CREATE TABLE templates (
    template_key INTEGER PRIMARY KEY,
    id           TEXT NOT NULL UNIQUE
                 CHECK (length(id) = 32 AND id NOT GLOB '*[^0-9a-f]*'),
    subject_key  INTEGER NOT NULL REFERENCES subjects (subject_key) ON DELETE CASCADE,
    label        TEXT NOT NULL CHECK (length(CAST(label AS BLOB)) <= 256),
    created      TEXT NOT NULL CHECK (created GLOB '????-??-??T??:??:??.???Z'),
    digest       TEXT NOT NULL            -- SHA-256 of the canonical points (db/FORMAT.md)
                 CHECK (length(digest) = 64 AND digest NOT GLOB '*[^0-9a-f]*'),
    engine       TEXT NOT NULL CHECK (length(engine) BETWEEN 1 AND 63),
    points       INTEGER NOT NULL CHECK (points BETWEEN 3 AND 2097152),
    triangles    INTEGER NOT NULL CHECK (triangles BETWEEN 1 AND 2 * points - 5),
    quality      REAL NOT NULL CHECK (quality BETWEEN 0 AND 1),
    coverage     REAL NOT NULL CHECK (coverage BETWEEN 0 AND 1),
    density_mm   REAL NOT NULL CHECK (density_mm BETWEEN 0 AND 1e6),
    noise_mm     REAL NOT NULL CHECK (noise_mm BETWEEN 0 AND 1e6),
    model        BLOB NOT NULL CHECK (length(model) > 0), -- db/FORMAT.md; last: rows are
                                                          -- listed without reading it
    UNIQUE (subject_key, digest)          -- the same cloud again is the same template
) STRICT;

-- Who did what, when, with what outcome; no biometrics, no tokens.  Kept when a subject is
-- deleted: so no foreign keys.
CREATE TABLE events (
    event_key   INTEGER PRIMARY KEY AUTOINCREMENT,
    at          TEXT NOT NULL CHECK (at GLOB '????-??-??T??:??:??.???Z'),
    kind        TEXT NOT NULL CHECK (length(kind) BETWEEN 1 AND 64),
    actor       TEXT NOT NULL CHECK (length(actor) <= 64),
    subject     TEXT NOT NULL CHECK (length(subject) <= 128),
    template_id TEXT NOT NULL CHECK (length(template_id) <= 32),
    outcome     TEXT NOT NULL CHECK (length(outcome) <= 64)
) STRICT;

-- Bearer tokens: 256 random bits each, of which only a hash is kept.
CREATE TABLE tokens (
    token_key INTEGER PRIMARY KEY,
    id        TEXT NOT NULL UNIQUE CHECK (length(id) = 32 AND id NOT GLOB '*[^0-9a-f]*'),
    name      TEXT NOT NULL CHECK (length(name) BETWEEN 1 AND 64),
    hash      BLOB NOT NULL UNIQUE CHECK (length(hash) = 32), -- BLAKE2b-256 of the secret
    created   TEXT NOT NULL CHECK (created GLOB '????-??-??T??:??:??.???Z'),
    revoked   TEXT CHECK (revoked IS NULL OR revoked GLOB '????-??-??T??:??:??.???Z')
) STRICT;
