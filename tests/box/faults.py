#!/usr/bin/env python3
"""Lets one system call of a command fail, or kills the command there, and checks what is left.
usage: faults.py BUILD WORK file|server|owner [CASE [LAYOUT [FAULT...]]]
  BUILD   the programs    WORK  a folder of its own
  file    databases in files    server  databases on the PostgreSQL of $PGHOST
  owner   no call fails: the command runs as another user, in folders that this user may not write,
          list or rename in
  CASE    a command    LAYOUT  plain, or which of its files is behind a symbolic link, or no-anchor
  FAULT   as strace's option inject= takes it; the command runs once for each
FAULT_POINTS: the faults of each case, chosen by SEED, of half the layouts with links or without an
anchor; all: every one.
A recording run lists the calls that the command makes from its first use of the case's files on.
Each of them fails; a command is killed at those that change something.  strace counts the calls of
each thread: when=3 is the third call of every thread.

After a fault, in this order:
1. the command has ended by itself, with status 0 or a message;
2. the database opens with its key (or KEY.new) and its anchor; its contents are those from before
   or from after the command, the latter if the status is 0; the database that the command puts
   aside opens with a key that is kept; no file of before is gone unless the command has done all;
3. the command, run again, ends as an undisturbed one, with the contents from after;
4. the files are those of an undisturbed run, and doctor finds no error.
A trial ends early if an earlier one of its case has told the same and left the same bytes.
Exit status 1: a trial failed."""
import collections
import hashlib
import json
import multiprocessing
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import time

from contents import Failure, look, names, tell

BUILD, WORK, ENGINE, *ONLY = sys.argv[1:]
POINTS, SEED = os.environ.get('FAULT_POINTS', '3'), int(os.environ.get('SEED') or time.time())
SERVER = ENGINE == 'server'
LIMIT = 30  # seconds of a command
SHOWN = 12  # failed trials of a case
USER = 65534  # of the owner's cases
NULL = subprocess.DEVNULL

# What a call may fail with; +: and all later calls of its thread.
ERRORS = {'openat': 'EMFILE EMFILE+ EACCES ENOSPC', 'read': 'EIO', 'pread64': 'EIO', 'write': 'ENOSPC EIO+',
          'pwrite64': 'EIO ENOSPC+', 'fsync': 'EIO EIO+', 'fdatasync': 'EIO EIO+', 'ftruncate': 'EIO',
          'rename': 'EIO EACCES', 'renameat': 'EIO EACCES', 'renameat2': 'EINVAL EACCES', 'link': 'EACCES EMLINK',
          'unlink': 'EIO EACCES', 'unlinkat': 'EIO EACCES', 'fchmod': 'EPERM', 'fcntl': 'EIO', 'flock': 'EIO',
          'newfstatat': 'EIO EACCES', 'access': 'EACCES', 'faccessat2': 'EACCES', 'readlink': 'EIO', 'mmap': 'ENOMEM',
          'socket': 'EMFILE', 'connect': 'ECONNREFUSED', 'sendto': '', 'recvfrom': 'ECONNRESET', 'poll': 'ENOMEM'}
# A command that is killed between two of these leaves what it leaves at the later one.
CHANGES = {'write', 'pwrite64', 'ftruncate', 'rename', 'renameat', 'renameat2', 'link', 'unlink', 'unlinkat', 'fchmod',
           'sendto', 'recvfrom'}
# A sample has more of these.
OFTEN = CHANGES | {'fsync', 'fdatasync', 'openat'}


def sh(*words, **more):
    return subprocess.run(words, stdin=NULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False, **more)


def must(*words):
    r = sh(*words)
    if r.returncode != 0:
        raise Failure('%s: %s' % (' '.join(words), r.stdout.decode()))
    return r.stdout.decode().strip()


def psql(database, sql):
    return must('psql', '-X', '-q', '-At', '-v', 'ON_ERROR_STOP=1', '-d', database, '-c', sql)


# Of a database: the other connections, the daemons that have joined, and a digest of its rows.
ROWS = """SELECT count(*) FROM pg_stat_activity WHERE datname = current_database() AND pid <> pg_backend_pid();
SELECT CASE WHEN to_regclass('change_log') IS NOT NULL THEN (xpath('//n/text()', query_to_xml(
    'SELECT count(*) AS n FROM change_log WHERE kind = ''join''', false, false, '')))[1]::text END;
SELECT md5(schema_to_xml(current_schema(), true, false, '')::text)"""
untouched = {}  # a database of trials: that which it is still a copy of
passed = set()  # ends and states of this process's trials that were found right


# ---- cases

# The state before, and the command; @NAME is a file of the trial, @url its database on the server.
FILE = {'init': ('empty', 'init'), 'enroll': ('full', 'enroll dave @s4.ply'),
        'erase': ('full', 'subject erase --yes alice'), 'rekey': ('full', 'rekey --yes'),
        'rekey-keep': ('full', 'rekey --keep-old'), 'restore': ('full', 'restore @copy'),
        'restore-lost': ('lost', 'restore @copy'), 'copy': ('full', 'copy @to'), 'vacuum': ('full', 'vacuum'),
        'backup': ('full', 'backup --force @copy'), 'accept': ('older', 'accept-state --yes'),
        'accept-same': ('full', 'accept-state --yes'),
        'import': ('full', 'import @archive --archive-key @akey')}
ON_SERVER = {'init': ('empty', 'init'), 'enroll': FILE['enroll'], 'erase': FILE['erase'], 'import': FILE['import'],
             'accept': FILE['accept'], 'accept-same': FILE['accept-same'], 'join': ('full', 'join'),
             'copy-from': ('full', 'copy @to'), 'copy-to': ('full', 'copy @url')}
# What a command of another user meets: modes of folders and of the key.  root owns a sticky folder, and a key that the
# user's group may read.
OWNED = {'db-0300': {'db': 0o300}, 'db-0500': {'db': 0o500}, 'keys-0300': {'keys': 0o300}, 'keys-0500': {'keys': 0o500},
         'anchors-0500': {'anchors': 0o500}, 'out-0500': {'out': 0o500}, 'key-of-root': {'keys/key': 0o440},
         'sticky': {'db': 0o1777, 'keys': 0o1777, 'anchors': 0o1777, 'keys/key': 0o440}}
RENAMED = 'rekey rekey-keep restore restore-lost copy backup copy-from'.split()  # these say what is done, if they fail
NO_OUTPUT = 'surfacectl: the output cannot be written'
LINKED = 'rekey rekey-keep restore accept'.split()
OF_OWNERS = 'init enroll rekey rekey-keep restore restore-lost backup'.split()
NO_ANCHOR = 'init rekey rekey-keep restore'.split()


class Case:
    """A command, its files in the folder of a trial, and what they contain before and after it."""

    def __init__(self, name, layout):
        self.name, self.layout = name, layout
        self.base, self.command = (ON_SERVER if SERVER else FILE)[name]
        self.base = WORK + '/base.' + self.base
        self.anchor = 'anchor2' if name == 'join' else 'anchor'
        self.in_file = not SERVER or name == 'copy-to'
        self.ctl = [WORK + '/surfacectl']
        if ENGINE == 'owner':
            self.ctl[:0] = ['setpriv', '--reuid', str(USER), '--regid', str(USER), '--clear-groups']
        self.target = {'copy': 'to', 'copy-from': 'to', 'backup': 'copy'}.get(name)
        self.aside = {'rekey-keep': 'before-rekey', 'restore': 'before-restore'}.get(name)
        self.before = self.after = self.public = self.rows = None
        self.groups, self.trials, self.failed = [], [], []

    def place(self):
        """The folder of this process's trials, and its database on the server."""
        self.dir = '%s/trial.%d' % (WORK, os.getpid())
        self.file, self.key = self.dir + '/db/f', self.dir + '/keys/key'
        self.database = 'trial%d' % os.getpid()
        self.url = 'postgresql:///' + self.database
        self.db = self.file if self.in_file else self.url
        self.options = ['--db', self.db, '--key', self.key, '--anchor',
                        'none' if self.layout == 'no-anchor' else self.dir + '/anchors/' + self.anchor]
        self.words = [*self.ctl, *self.options] + \
            [self.url if w == '@url' else self.dir + '/out/' + w[1:] if w[0] == '@' else w
             for w in self.command.split()]

    def set_up(self):
        self.place()
        shutil.rmtree(self.dir, ignore_errors=True)
        shutil.copytree(self.base, self.dir, symlinks=True)
        for what, path in (('key', self.key), ('anchor', self.dir + '/anchors/anchor'), ('db', self.file)):
            if self.layout == 'linked-' + what:
                os.mkdir(self.dir + '/far')
                if os.path.exists(path):
                    os.rename(path, self.dir + '/far/it')
                os.symlink('../far/it', path)
        if ENGINE == 'owner':
            self.give()
        if SERVER:
            self.set_up_rows()

    def set_up_rows(self):
        """Makes the database anew, unless the last trial has not changed it."""
        empty = self.in_file or self.name == 'init'
        of = 'template1' if empty else os.path.basename(self.base).replace('.', '_')
        if untouched.get(self.database) != of:
            psql('postgres', 'DROP DATABASE IF EXISTS %s WITH (FORCE)' % self.database)
            psql('postgres', 'CREATE DATABASE %s TEMPLATE %s' % (self.database, of))
        untouched[self.database] = of
        self.rows = self.rows_before = self.read_rows()

    # ---- what is there

    def read_rows(self):
        """Waits until the server has ended the command's transactions; returns a digest of all rows, and the number
        of daemons that have joined, '' without a database."""
        until = time.time() + LIMIT
        while time.time() < until:
            others, joined, rows = psql(self.database, ROWS).split('\n')
            if others == '0':
                return rows, joined
            time.sleep(0.01)
        raise Failure('the command has ended, and its connections have not')

    def digest(self):
        """Returns a digest of all bytes of a trial's files and rows."""
        h = hashlib.blake2b()
        for folder, _, names in sorted(os.walk(self.dir)):
            for name in sorted(n for n in names if not n.endswith('-shm')):
                path = folder + '/' + name
                link = os.readlink(path) if os.path.islink(path) else ''
                h.update(('%s %s\0' % (path[len(self.dir):], link)).encode())
                if os.path.isfile(path):
                    with open(path, 'rb') as f:
                        h.update(hashlib.blake2b(f.read()).digest())
        h.update(repr(self.rows).encode())
        return h.digest()

    def look(self, db, *options, key=None):
        try:
            return look([*self.ctl, '--db', db, '--key', key or self.key, *options])
        except Failure as e:
            if 'there is no database' in str(e):
                return 'none'
            raise

    def contents(self):
        seen = {}
        anchor = self.options[4:] if self.name != 'join' else ('--anchor', self.dir + '/anchors/anchor')
        if self.in_file:
            seen['database'] = self.look(self.file, *anchor)
            if 'rekey' in self.name:
                public = tell([*self.ctl, *self.options], 'audit', 'verify')['public_key']
                self.public = self.public or public
                seen['keys'] = 'old' if self.public == public else 'new'
        if SERVER:
            seen['joined'] = self.rows[1]
            seen['server'] = self.look(self.url, *anchor) if self.rows[1] else 'none'
        if self.target:
            seen['target'] = self.look(self.dir + '/out/' + self.target)
        return seen

    def kept(self, now):
        """The database that the command puts aside is openable by a key that is kept."""
        if not self.aside or now == self.before:
            return
        why = ''
        real, file = os.path.realpath(self.key), os.path.realpath(self.file)
        for key in real + '.old', real, real + '.new':
            if not os.path.exists(key):
                continue
            try:
                if self.look(file + '.' + self.aside, key=key) == self.before['database']:
                    return
                why = 'other contents'
            except Failure as e:
                why = e
        raise Failure('%s is lost: %s' % (self.aside, why))

    def gone(self):
        """The old key is in no file any more."""
        if self.name != 'rekey':
            return
        with open(self.base + '/keys/key', 'rb') as f:
            key = f.read()
        for folder, _, names in os.walk(self.dir):
            for path in (folder + '/' + n for n in names):
                if os.path.isfile(path):
                    with open(path, 'rb') as f:
                        if key in f.read():
                            raise Failure('the old key is in %s' % path[len(self.dir) + 1:])

    # ---- a trial

    def run(self, fault=None):
        """Returns the exit status, negative for a signal, and the messages."""
        how = []
        if fault in OWNED:
            self.take(fault)
        elif fault:
            fast = [] if 'signal' in fault else ['--seccomp-bpf']  # strace 6.1 then sends no signal
            how = ['strace', '-f', *fast, '-o', '/dev/null', '-e', 'trace=' + fault.split(':')[0],
                   '-e', 'inject=' + fault]
        p = subprocess.Popen([*how, *self.words], stdin=NULL, stdout=NULL, stderr=subprocess.PIPE,
                             start_new_session=True)
        try:
            said = p.communicate(timeout=LIMIT)[1].decode()
        except subprocess.TimeoutExpired:
            os.killpg(p.pid, signal.SIGKILL)
            p.communicate()
            raise Failure('it does not end within %d s' % LIMIT) from None
        finally:
            if fault in OWNED:
                self.give()
            if SERVER:
                self.rows = self.read_rows()
                if self.rows != self.rows_before:
                    untouched.pop(self.database, None)
        if p.returncode < 0 and (not fault or 'signal' not in fault):
            raise Failure('killed by signal %d: %s' % (-p.returncode, said))
        if p.returncode > 0 and said == '' and not (fault or '').startswith('write:'):
            raise Failure('status %d without a message' % p.returncode)
        return p.returncode, said.strip()

    def judge(self, rc, said):
        """Checks the state that a run has left; returns whether it is the state after the command."""
        said = 'status %d: %s' % (rc, said)
        try:
            now = self.contents()
        except Failure as e:
            if self.before['database' if self.in_file else 'server'] != 'refused' or rc == 0:
                raise Failure('%s\n  after %s' % (e, said)) from e
            now = self.before
        if now != self.after and (rc == 0 or now != self.before):
            raise Failure('%s: %s\n  after %s' % (
                'not the contents after' if rc == 0 else 'the contents neither before nor after',
                ', '.join('%s: %s' % (k, now[k]) for k in now if now[k] != self.after.get(k)), said))
        self.kept(now)
        return now == self.after

    def trial(self, *faults):
        self.set_up()
        there = names(self.dir)
        for fault in faults or [None]:
            rc, said = self.run(fault)
        state = self.name, self.layout, rc, said, self.digest()
        if state in passed:
            return
        done = self.judge(rc, said)
        gone = there - names(self.dir)
        if gone and not done:
            raise Failure('not done, and gone are %s\n  after status %d: %s' % (gone, rc, said))
        if len(faults) == 1 and done and rc > 0 and self.name in RENAMED and self.after != self.before and \
                said not in ('', NO_OUTPUT) and ', but ' not in said:
            raise Failure('done, and told as failed: %s' % said)
        again, told = self.run()
        what = 'first status %d: %s\n  run again: status %d: %s' % (rc, said, again, told)
        if again not in (self.rc, *[self.rc_twice] * done):
            raise Failure(what)
        try:
            self.finished(again, told)
            if names(self.dir) not in (self.names, *[self.names_twice] * done):
                raise Failure('the files are %s, and should be %s' % (names(self.dir), self.names))
        except Failure as e:
            raise Failure('%s\n  %s' % (e, what)) from e
        passed.add(state)

    def give(self):
        """Gives all files to the case's user."""
        for folder, _, names in os.walk(self.dir):
            for path, mode in (folder, 0o700), *[(folder + '/' + n, 0o600) for n in names]:
                os.chown(path, USER, USER)
                os.chmod(path, mode)

    def take(self, what):
        """Takes rights from the case's user."""
        for path, mode in OWNED[what].items():
            path = self.dir + '/' + path
            if os.path.exists(path):
                os.chmod(path, mode)
                if mode & 0o1040:
                    os.chown(path, 0, USER)

    def finished(self, rc, said):
        """Checks the state of a command that has done all."""
        if not self.judge(rc, said):
            raise Failure('not the contents after')
        self.gone()
        r = sh(*self.ctl, *self.options, '--json', 'doctor')
        wrong = [f['what'] for f in json.loads(r.stdout)['findings']
                 if f['severity'] == 'error' and f['about'] != 'server']  # it does not sync
        if wrong:
            raise Failure('doctor: %s' % '; '.join(wrong))

    def reference(self):
        """Runs the command undisturbed, twice, and recorded; returns its calls."""
        self.set_up()
        try:
            self.before = self.contents()
        except Failure:
            self.before = {'database' if self.in_file else 'server': 'refused'}
        self.rc, said = self.run()
        try:
            self.after = self.contents()
        except Failure as e:
            raise Failure('%s\n  after status %d: %s' % (e, self.rc, said)) from e
        if self.rc != 0 and (self.layout == 'plain' or self.after != self.before):
            raise Failure('undisturbed: status %d: %s' % (self.rc, said))
        self.names = names(self.dir)
        self.finished(self.rc, said)
        self.rc_twice, said = self.run()
        self.finished(self.rc_twice, said)
        self.names_twice = names(self.dir)
        if ENGINE == 'owner':
            return [[what] for what in OWNED]
        self.set_up()
        log = self.dir + '.calls'
        r = sh('strace', '-f', '--seccomp-bpf', '-o', log, '-e', 'trace=' + ','.join('?' + n for n in ERRORS),
               *self.words)
        untouched.pop(self.database, None)
        if r.returncode != self.rc:
            raise Failure('under strace: status %d: %s' % (r.returncode, r.stdout.decode()))
        with open(log, encoding='latin1') as f:
            return self.faults(f)

    def faults(self, log):
        """Returns the faults of the calls of a log, grouped by the call's name and the error."""
        first, count, groups, begun = None, collections.Counter(), {}, False
        for line in log:
            m = re.match(r'(\d+) +(\w+)\((.*)', line)
            if not m:
                continue
            thread, name, rest = m.groups()
            first = first or thread
            count[thread, name] += 1
            begun = begun or self.dir in rest or (SERVER and os.environ['PGHOST'] in rest)
            if not begun or (thread != first and count[thread, name] <= count[first, name]):
                continue
            for error in ERRORS[name].split():
                if error == 'ENOSPC' and name.startswith('open') and 'O_CREAT' not in rest:
                    continue
                groups.setdefault((name, error), {})['%s:error=%s:when=%d%s' % (
                    name, error.strip('+'), count[thread, name], error[len(error.strip('+')):])] = True
            if name in CHANGES or 'O_CREAT' in rest:
                groups.setdefault((name, 'kill'), {})['%s:signal=KILL:when=%d' % (name, count[thread, name])] = True
        return [list(g) for g in groups.values()]


# ---- states

def make_scans():
    for n in 1, 2, 3, 4:
        must(BUILD + '/facegen', '--subject', str(n), '--scan', '0', '--points', '600', '-o', '%s/s%d.ply' % (WORK, n))


def in_state(name, copy=None):
    """A folder of a state; returns it, and a function that runs surfacectl there."""
    folder = WORK + '/base.' + name
    if copy:
        shutil.copytree(copy, folder)
    else:
        for sub in 'db', 'keys', 'anchors', 'out':
            os.makedirs(folder + '/' + sub)
    db = 'postgresql:///base_' + name if SERVER else folder + '/db/f'

    def ctl(*words):
        return must(BUILD + '/surfacectl', '--db', db, '--key', folder + '/keys/key', '--anchor',
                    folder + '/anchors/anchor', *words)
    return folder, ctl


def make_states():
    """empty: nothing.  full: subjects, a token, and a backup of before an erasure.  lost: as full, the
    database is missing.  older: as full, of before its anchor's last change."""
    make_scans()
    in_state('empty')
    if SERVER:
        psql('postgres', 'CREATE DATABASE base_full')
    full, ctl = in_state('full')
    out = full + '/out/'
    shutil.copy(WORK + '/s4.ply', out)
    with open(out + 'akey', 'w', encoding='ascii') as f:
        f.write('5a' * 32)
    other = [BUILD + '/surfacectl', '--db', WORK + '/other']
    must(*other, 'init')
    must(*other, 'enroll', 'erin', out + 's4.ply')
    must(*other, 'export', '--all', '-o', out + 'archive', '--archive-key', out + 'akey')
    ctl('init')
    ctl('enroll', 'alice', WORK + '/s1.ply')
    ctl('enroll', 'bob', WORK + '/s2.ply')
    ctl('token', 'create', 'gate', '--scope', 'verify')
    if SERVER:
        psql('postgres', 'CREATE DATABASE base_older TEMPLATE base_full')
    else:
        ctl('backup', out + 'copy')
    ctl('subject', 'erase', '--yes', 'bob')
    ctl('enroll', 'carol', WORK + '/s3.ply')
    if SERVER:
        ctl('copy', full + '/db/f')
        in_state('older', full)
        return
    lost = in_state('lost', full)[0]
    os.unlink(lost + '/db/f')
    older = in_state('older', full)[0]
    shutil.copyfile(older + '/out/copy', older + '/db/f')


# ---- all of it

def reference(case):
    """Returns the case with its contents and its faults, or why it fails without one."""
    try:
        case.groups = case.reference()
    except Failure as e:
        case.failed.append(((), str(e)))
    return case


def trial(job):
    case, faults = job
    try:
        case.trial(*faults)
    except Failure as e:
        return str(e)
    return None


def choose(groups, rng):
    """Returns the faults of a case's trials: a sample, or all; and for every fourth of them, one of a run that follows
    on a run that was killed."""
    every = [(rng.random() * (len(g) - i + 3) * (1 if f.split(':')[0] in OFTEN else 3), f)
             for g in groups for i, f in enumerate(g)]  # names change towards the end of a command
    single = [f for _, f in sorted(every)[:None if POINTS == 'all' else int(POINTS)]]
    kills = [g for g in groups if 'KILL' in g[0]]
    return [(f,) for f in single] + [(rng.choice(rng.choice(kills)), rng.choice(rng.choice(groups)))
                                     for _ in single[::4] if kills]


def run_cases(pool, cases, given):
    """Returns the cases, each with its trials and those that failed."""
    cases = pool.map(reference, cases, 1)
    jobs = []
    for i, case in enumerate(cases):
        case.trials = []
        if case.groups:
            case.trials = [tuple(given)] if given else choose(case.groups, random.Random(SEED))
        jobs += [(i, t) for t in case.trials]
    for (i, t), why in zip(jobs, pool.imap(trial, [(cases[i], t) for i, t in jobs])):
        if why:
            cases[i].failed.append((t, why))
    return cases


def report(case):
    for faults, why in case.failed[:SHOWN]:
        print('FAIL: %s\n  repeat: %ssh tests/box/faults.sh %s' % (
            why, 'scripts/with_postgres ' * SERVER, ' '.join([ENGINE, case.name, case.layout, *faults])))
    print('%s %s: %d trials of %d faults, %d failed' % (case.name, case.layout, len(case.trials),
                                                       sum(map(len, case.groups)), len(case.failed)))


def main():
    if ENGINE == 'owner' and os.geteuid() != 0:
        print('SKIP faults of owners: only root has other users')
        return False
    os.umask(0o077)  # a key's file is its owner's
    shutil.copy(BUILD + '/surfacectl', WORK)
    make_states()
    print('seed %d' % SEED)
    cases = [(n, 'plain') for n in (ON_SERVER if SERVER else OF_OWNERS if ENGINE == 'owner' else FILE)]
    if ENGINE == 'file':
        others = [(n, 'linked-' + what) for what in ('key', 'anchor', 'db') for n in LINKED]
        others += [(n, 'no-anchor') for n in NO_ANCHOR]
        half = len(others) // 2 if POINTS != 'all' and not ONLY else len(others)
        cases += random.Random(SEED).sample(others, half)
    begun = time.time()
    with multiprocessing.Pool(os.cpu_count()) as pool:
        cases = run_cases(pool, [Case(*c) for c in cases if c[:len(ONLY)] == tuple(ONLY[:2])], ONLY[2:])
    for case in cases:
        report(case)
    failed = sum(len(c.failed) for c in cases)
    print('%d trials in %.0f s, %d failed' % (sum(len(c.trials) for c in cases), time.time() - begun, failed))
    return failed > 0 or not cases


sys.exit(main())
