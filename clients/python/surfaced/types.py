"""The responses' members, by the names of /openapi.json.  Lengths in mm, times in ms."""

from __future__ import annotations

from typing import Any, Literal, NotRequired, TypedDict


class Quality(TypedDict):
    score: float
    coverage: float
    density_mm: float
    noise_mm: float
    reasons: list[str]


class Scan(TypedDict):
    format: str
    points_read: int
    points_dropped: int
    points_used: int
    units: str | None
    view: list[float] | None
    yaw_deg: float | None
    occluded: float
    warnings: list[str]


class Check(TypedDict):
    usable: bool
    enrollable: bool
    code: str | None
    detail: str | None
    advice: list[str]
    notes: list[str]
    scan: Scan | None
    quality: Quality | None
    timing_ms: dict[str, float]


class Template(TypedDict):
    template_id: str
    subject: str
    label: str
    created: str
    points: int
    triangles: int
    digest: str
    quality: Quality
    engine: str
    manager: NotRequired[bool]
    first_score: NotRequired[float]
    scan: NotRequired[Scan]
    frames: NotRequired[list["Frame"]]


class Paired(TypedDict):
    """fits: False where it matches fewer of the others than it does not match; None: that cannot be told."""

    template_id: str
    label: str
    created: str
    compared: bool
    matches: int
    fits: bool | None


class Pair(TypedDict):
    """score: None to a token without score, detail and manage."""

    a: str
    b: str
    decision: Literal["match", "no_match", "inconclusive"]
    score: float | None


class Pairs(TypedDict):
    subject: str
    threshold: float
    templates: list[Paired]
    pairs: list[Pair]
    engine: str


class Refusal(TypedDict):
    code: str
    detail: str


class FramePart(TypedDict):
    region: str
    side: Literal["left", "right"] | None
    share: float


class FrameAdds(TypedDict):
    place: int
    share: float
    parts: list[FramePart]
    noise_mm: float


class Frame(TypedDict):
    file: str
    used: bool
    reason: Refusal | None
    adds: FrameAdds | None


class BurstFile(TypedDict):
    file: str
    template_id: str | None
    new: bool
    scan: Scan | None
    quality: Quality | None
    refusal: Refusal | None


class Burst(TypedDict):
    subject: str
    templates: list[BurstFile]


class Verdict(TypedDict):
    """scan and quality: of a comparison {"a": ..., "b": ...}.  Of a non-match the numbers, and the
    template, only to a token with score, detail or manage."""

    decision: Literal["match", "no_match", "inconclusive"]
    score: NotRequired[float]
    threshold: NotRequired[float]
    fmr_at_score: NotRequired[float]
    disparity_mm: NotRequired[float]
    overlap: NotRequired[float]
    subject: str | None
    template_id: str | None
    templates_compared: NotRequired[int]
    frames: NotRequired[list[Frame]]
    scan: Any
    quality: Any
    engine: str
    timing_ms: dict[str, float]
    minimal: NotRequired[dict[str, Any]]
    alignment: NotRequired[dict[str, Any]]
    regions: NotRequired[dict[str, float | None]]
    expected: NotRequired[float]
    heatmap: NotRequired[list[float | None]]
    cells: NotRequired[dict[str, Any]]


class Candidate(TypedDict):
    """To be reviewed by a person: one of the most alike, no decision."""

    subject: str
    template_id: str
    score: float
    fmr_at_score: float


class Identification(TypedDict):
    """Without a match the numbers only to a token with score, detail or manage, or with candidates.
    threshold: None if no score is a match among so many people."""

    decision: Literal["match", "no_match", "inconclusive"]
    subject: str | None
    template_id: str | None
    score: NotRequired[float | None]
    threshold: NotRequired[float | None]
    fpir_at_score: NotRequired[float | None]
    extrapolated: NotRequired[bool]
    searched: int
    skipped: NotRequired[int]
    compared: NotRequired[int]
    candidates: NotRequired[list[Candidate]]
    frames: NotRequired[list[Frame]]
    scan: Scan
    quality: Quality
    engine: str
    timing_ms: dict[str, float]


class Asymmetry(TypedDict):
    conclusive: bool
    plain_mm: float
    weighted_mm: float
    first_mm: float
    volume_mm3: float
    overlap_mm2: float
    overlap: float
    plane: dict[str, Any]
    scan: Scan
    quality: Quality
    engine: str
    timing_ms: dict[str, float]


class Attempts(TypedDict):
    failures: int
    locked_until: str | None


class Subject(TypedDict):
    subject: str
    created: str
    consent: str | None
    purpose: str | None
    expires_at: str | None
    last_seen: str | None
    hold: bool
    disabled: bool
    identify: bool
    groups: list[str]
    attempts: Attempts
    templates: list[Template]


class Listed(TypedDict):
    """A row of SubjectPage."""

    subject: str
    created: str
    consent: str | None
    purpose: str | None
    expires_at: str | None
    last_seen: str | None
    hold: bool
    disabled: bool
    identify: bool
    groups: list[str]
    templates: int
    quality: float | None
    locked_until: str | None


class AuditEntry(TypedDict):
    seq: int
    hash: str


class Erased(TypedDict):
    """The signed receipt of an erasure: surfacectl audit verify verifies it."""

    subject: str
    templates_removed: int
    template_ids: list[str]
    subject_uid: str
    erased_at: str
    digest: str
    audit: AuditEntry
    signature: str
    public_key: str


class Event(TypedDict):
    cursor: str
    at: str
    type: str
    outcome: str
    subject: str | None
    template_id: str | None
    token: str | None
    token_id: str | None
    until: NotRequired[str]


class Nonce(TypedDict):
    nonce: str
    expires_at: str


class OwnToken(TypedDict):
    id: str | None
    name: str | None
    scopes: list[str]
    groups: list[str]
    expires_at: str | None
