-- schema.sql -- the template database in SQLite, schema version 1.
-- Embedded in the programs at build and run in one transaction on an empty database.
--
-- A row of subjects, templates, tokens, devices and calibrations has a revision, one more each
-- time it is changed, and a MAC over the table's name and every column before the MAC
-- (db/rows/rows_table.h).  What is behind the MAC changes without an entry in the change log and
-- is not authenticated.  Each table's text, comments included, is compared with this one whenever the
-- rows are verified: another text is another version (user_version, and SQL_SQLITE_VERSION).

PRAGMA application_id = 0x53524644; -- "SRFD"
PRAGMA user_version = 1;

-- Where the master key comes from, and what it encrypts: struct crypt_root of db/crypt/crypt.h.
CREATE TABLE root (
    root_key  INTEGER PRIMARY KEY CHECK (root_key = 1),
    kind      INTEGER NOT NULL CHECK (kind IN (0, 1, 2)), -- in this row, a file, a passphrase
    passes    INTEGER NOT NULL CHECK (passes >= 0), -- of Argon2id, and its MB
    mib       INTEGER NOT NULL CHECK (mib >= 0),
    salt      BLOB NOT NULL CHECK (length(salt) = 16),
    plaintext BLOB NOT NULL CHECK (length(plaintext) = 32), -- the key itself, for kind 0
    public    BLOB NOT NULL CHECK (length(public) = 32), -- Ed25519
    secrets   BLOB NOT NULL CHECK (length(secrets) = 136)
) STRICT;

-- A person, under the client's own id, which is encrypted and found by a keyed hash.
CREATE TABLE subjects (
    subject_key INTEGER PRIMARY KEY AUTOINCREMENT, -- the order of creation
    uid         BLOB NOT NULL UNIQUE CHECK (length(uid) = 16), -- random; names it in the logs
    revision    INTEGER NOT NULL CHECK (revision >= 1),
    lookup      BLOB NOT NULL UNIQUE CHECK (length(lookup) = 32),
    key         BLOB NOT NULL CHECK (length(key) = 72), -- the subject's, wrapped
    about       BLOB NOT NULL CHECK (length(about) BETWEEN 41 AND 1024),
    created     TEXT NOT NULL CHECK (created GLOB '????-??-??T??:??:??.???Z'),
    expires     TEXT CHECK (expires IS NULL OR expires GLOB '????-??-??T??:??:??.???Z'),
    hold        INTEGER NOT NULL CHECK (hold IN (0, 1)),
    disabled    INTEGER NOT NULL CHECK (disabled IN (0, 1)),
    mac         BLOB NOT NULL CHECK (length(mac) = 32),
    seen        TEXT CHECK (seen IS NULL OR seen GLOB '????-??-??T??:??:??.???Z')
) STRICT;

CREATE INDEX subjects_expires ON subjects (expires) WHERE expires IS NOT NULL;

-- An enrolled template.  Its points never change; what an engine made of them may be re-encoded.
CREATE TABLE templates (
    template_key INTEGER PRIMARY KEY AUTOINCREMENT, -- the order of creation
    id           TEXT NOT NULL UNIQUE
                 CHECK (length(id) = 32 AND id NOT GLOB '*[^0-9a-f]*'),
    revision     INTEGER NOT NULL CHECK (revision >= 1),
    uid          BLOB NOT NULL REFERENCES subjects (uid), -- of its subject
    used         BLOB NOT NULL CHECK (length(used) = 32), -- keyed hash of its points
    read         BLOB NOT NULL CHECK (length(read) = 32), -- and of the scan's, as they were read
    created      TEXT NOT NULL CHECK (created GLOB '????-??-??T??:??:??.???Z'),
    engine       TEXT NOT NULL CHECK (length(engine) BETWEEN 1 AND 63),
    points       INTEGER NOT NULL CHECK (points BETWEEN 3 AND 2097152),
    triangles    INTEGER NOT NULL CHECK (triangles BETWEEN 1 AND 2 * points - 5),
    about        BLOB NOT NULL CHECK (length(about) BETWEEN 41 AND 1024),
    descriptor   BLOB NOT NULL CHECK (length(descriptor) = 141), -- by which a search finds it
    mac          BLOB NOT NULL CHECK (length(mac) = 32),
    UNIQUE (uid, used)                    -- the same cloud again is the same template
) STRICT;

-- Those of another engine are found without reading the rows.
CREATE INDEX templates_engine ON templates (engine, id);

-- The encoded face of a template (core/face/codec.h), its head and its mesh, each encrypted with the
-- template's id and revision: a comparison reads the heads alone.  A table of its own, so that what
-- reads all templates does not read the faces.
CREATE TABLE faces (
    template_key INTEGER PRIMARY KEY REFERENCES templates (template_key) ON DELETE CASCADE,
    face         BLOB NOT NULL CHECK (length(face) > 40),
    mesh         BLOB NOT NULL CHECK (length(mesh) > 40)
) STRICT;

-- Failed verifications of a subject in a row by one token (its id; '' without one), the time of the
-- last, and how much the failures between matches look like another person's.  No row: none of it,
-- or no failure for a month.
CREATE TABLE attempts (
    subject_key INTEGER NOT NULL REFERENCES subjects (subject_key) ON DELETE CASCADE,
    token       TEXT NOT NULL CHECK (length(token) <= 64),
    failures    INTEGER NOT NULL CHECK (failures BETWEEN 0 AND 1000000),
    at_ms       INTEGER NOT NULL CHECK (at_ms >= 0), -- since 1970, UTC
    suspicion   INTEGER NOT NULL CHECK (suspicion BETWEEN 0 AND 1000000),
    PRIMARY KEY (subject_key, token)
) STRICT;

-- How many subjects a token has tried in an hour.
CREATE INDEX attempts_token ON attempts (token, at_ms);

-- The change log: what changed one of the five tables with a MAC, and what an administrator did.
-- Rows are only added.  No biometrics, no secrets, no ids of subjects but their uid.  Each
-- entry's hash is of its columns and of the hash before it; the MAC is of that hash, so that the
-- last row authenticates the whole log.
CREATE TABLE change_log (
    seq         INTEGER PRIMARY KEY CHECK (seq >= 1),
    at          TEXT NOT NULL CHECK (at GLOB '????-??-??T??:??:??.???Z'),
    kind        TEXT NOT NULL CHECK (length(kind) BETWEEN 1 AND 64),
    actor       TEXT NOT NULL CHECK (length(actor) <= 64),
    uid         BLOB NOT NULL CHECK (length(uid) IN (0, 16)), -- of the subject
    object      TEXT NOT NULL CHECK (length(object) <= 64), -- id of a template, token, device
    outcome     TEXT NOT NULL CHECK (length(outcome) <= 64),
    digest      BLOB NOT NULL CHECK (length(digest) = 72), -- of all rows with a MAC, encrypted
    daemon      INTEGER NOT NULL CHECK (daemon BETWEEN 0 AND 63), -- the end of whose access log
    access_seq  INTEGER NOT NULL CHECK (access_seq >= 0), -- it names
    access_hash BLOB NOT NULL CHECK (length(access_hash) = 32), -- and that one's hash
    hash        BLOB NOT NULL CHECK (length(hash) = 32),
    mac         BLOB NOT NULL CHECK (length(mac) = 32),
    signature   BLOB CHECK (signature IS NULL OR length(signature) = 64) -- Ed25519
) STRICT;

-- The access logs: verifications, refusals, exports.  One for each daemon that shares the database, so
-- that none waits for another.  The oldest entries of each may be cut off.
CREATE TABLE access_log (
    daemon    INTEGER NOT NULL CHECK (daemon BETWEEN 0 AND 63),
    seq       INTEGER NOT NULL CHECK (seq >= 1),
    at        TEXT NOT NULL CHECK (at GLOB '????-??-??T??:??:??.???Z'),
    kind      TEXT NOT NULL CHECK (length(kind) BETWEEN 1 AND 64),
    actor     TEXT NOT NULL CHECK (length(actor) <= 64),
    uid       BLOB NOT NULL CHECK (length(uid) IN (0, 16)),
    object    TEXT NOT NULL CHECK (length(object) <= 64),
    outcome   TEXT NOT NULL CHECK (length(outcome) <= 64),
    hash      BLOB NOT NULL CHECK (length(hash) = 32),
    mac       BLOB NOT NULL CHECK (length(mac) = 32),
    signature BLOB CHECK (signature IS NULL OR length(signature) = 64),
    PRIMARY KEY (daemon, seq)
) STRICT, WITHOUT ROWID;

-- Bearer tokens: 256 random bits each, of which only a hash is stored; and the hash of the
-- secret before the last rotation, while that is still accepted.
CREATE TABLE tokens (
    token_key INTEGER PRIMARY KEY,
    id        TEXT NOT NULL UNIQUE CHECK (length(id) = 32 AND id NOT GLOB '*[^0-9a-f]*'),
    revision  INTEGER NOT NULL CHECK (revision >= 1),
    name      TEXT NOT NULL CHECK (length(name) BETWEEN 1 AND 64),
    hash      BLOB NOT NULL UNIQUE CHECK (length(hash) = 32), -- BLAKE2b-256 of the secret
    created   TEXT NOT NULL CHECK (created GLOB '????-??-??T??:??:??.???Z'),
    revoked   TEXT CHECK (revoked IS NULL OR revoked GLOB '????-??-??T??:??:??.???Z'),
    scopes    TEXT NOT NULL CHECK (length(scopes) BETWEEN 1 AND 128),
    groups    TEXT NOT NULL CHECK (length(groups) <= 519), -- of subjects; '': all
    expires   TEXT CHECK (expires IS NULL OR expires GLOB '????-??-??T??:??:??.???Z'),
    old_hash  BLOB CHECK (old_hash IS NULL OR length(old_hash) = 32),
    old_until TEXT CHECK (old_until IS NULL OR old_until GLOB '????-??-??T??:??:??.???Z'),
    mac       BLOB NOT NULL CHECK (length(mac) = 32),
    used      TEXT CHECK (used IS NULL OR used GLOB '????-??-??T??:??:??.???Z') -- to the minute
) STRICT;

CREATE UNIQUE INDEX tokens_old_hash ON tokens (old_hash);

-- Scanners whose captures are signed (docs/operation.md): the public keys, by name.
CREATE TABLE devices (
    device_key INTEGER PRIMARY KEY,
    id         TEXT NOT NULL UNIQUE CHECK (length(id) = 32 AND id NOT GLOB '*[^0-9a-f]*'),
    revision   INTEGER NOT NULL CHECK (revision >= 1),
    name       TEXT NOT NULL UNIQUE CHECK (length(name) BETWEEN 1 AND 32),
    public     BLOB NOT NULL CHECK (length(public) = 32), -- Ed25519
    created    TEXT NOT NULL CHECK (created GLOB '????-??-??T??:??:??.???Z'),
    mac        BLOB NOT NULL CHECK (length(mac) = 32)
) STRICT;

-- The nonces of captures that were taken, until a day after they expire: each is good once.
CREATE TABLE nonces (
    until_ms INTEGER NOT NULL CHECK (until_ms >= 0), -- since 1970, UTC
    nonce    BLOB NOT NULL CHECK (length(nonce) = 16), -- its random part
    PRIMARY KEY (until_ms, nonce)
) STRICT;

-- Verifications of a day (UTC) by decision and score: 64 counts, of scores from -40 on, 2 each, the
-- first and the last with what lies beyond.  Names nobody; not authenticated.
CREATE TABLE days (
    day      TEXT NOT NULL CHECK (day GLOB '????-??-??'),
    decision TEXT NOT NULL CHECK (decision IN ('match', 'no_match', 'inconclusive')),
    bins     BLOB NOT NULL CHECK (length(bins) = 256), -- little-endian, 4 bytes each
    daemon   INTEGER NOT NULL CHECK (daemon BETWEEN 0 AND 63), -- that counted them
    PRIMARY KEY (day, decision, daemon)
) STRICT;

-- Scans of a day (UTC) that a token (its id) sent to verify or to identify, and their quality: sums of
-- integers.  Names no subject; not authenticated; deleted after 12 weeks.
CREATE TABLE scans (
    day      TEXT NOT NULL CHECK (day GLOB '????-??-??'),
    token    TEXT NOT NULL CHECK (length(token) <= 64),
    daemon   INTEGER NOT NULL CHECK (daemon BETWEEN 0 AND 63), -- that counted them
    n        INTEGER NOT NULL CHECK (n >= 0), -- compared
    unusable INTEGER NOT NULL CHECK (unusable >= 0), -- refused: no face, or a poor one
    noise_um INTEGER NOT NULL CHECK (noise_um >= 0), -- sums of the n scans
    quality  INTEGER NOT NULL CHECK (quality >= 0), -- in 1/1000
    PRIMARY KEY (token, day, daemon) -- the order in which they are listed
) STRICT, WITHOUT ROWID;

-- From a score to a decision (docs/decision.md): the newest is in force.  Rows are only ever
-- added; going back to the shipped table is a new row too.
CREATE TABLE calibrations (
    calibration_key INTEGER PRIMARY KEY,
    revision     INTEGER NOT NULL CHECK (revision = 1),
    created      TEXT NOT NULL CHECK (created GLOB '????-??-??T??:??:??.???Z'),
    actor        TEXT NOT NULL CHECK (length(actor) <= 64),
    engine       TEXT NOT NULL CHECK (length(engine) BETWEEN 1 AND 63),
    shipped      INTEGER NOT NULL CHECK (shipped IN (0, 1)), -- the engine's own table
    fmr          REAL NOT NULL CHECK (fmr > 0 AND fmr < 1),  -- that was wanted
    threshold    REAL NOT NULL CHECK (abs(threshold) < 10000),
    low          REAL NOT NULL CHECK (low <= threshold),   -- 95 % interval of it
    high         REAL NOT NULL CHECK (high >= threshold),
    subjects     INTEGER NOT NULL CHECK (subjects >= 0),
    impostors    INTEGER NOT NULL CHECK (impostors >= 0),    -- comparisons
    genuine      INTEGER NOT NULL CHECK (genuine >= 0),
    knots        BLOB NOT NULL -- score, rate of each, as little-endian IEEE 754 doubles
                 CHECK (length(knots) BETWEEN 32 AND 512 AND length(knots) % 16 = 0),
    -- people with two templates, u32; then points of the DET, as doubles (rows_calibration.c)
    det          BLOB NOT NULL CHECK (length(det) BETWEEN 4 AND 684 AND length(det) % 40 = 4),
    mac          BLOB NOT NULL CHECK (length(mac) = 32)
) STRICT;
