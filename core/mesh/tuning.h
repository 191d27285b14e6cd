/* tuning.h -- every number that tunes the method, with its unit and the reason for it.
 * Measurements are those of docs/accuracy.md (simulated scans of 200 + 40 subjects) unless
 * another page is named.  "By hand" marks a value that works, was set by judgement, and has
 * no measurement of its own.
 * Whoever changes a number that a score depends on counts up the measure in FACE_ENGINE.
 * What a model learns (weights, modes, threshold) is in the model, not here. */
#ifndef CORE_TUNING_H
#define CORE_TUNING_H

/* ---- triangulation, merging: time, not results */

/* Points in a square of a strip (strips.h).  Time is flat from 4 to 12. */
#define STRIPS_PER_SQUARE 8

/* Walk steps and new triangles per point, on average, before merge_build() starts from
 * scratch.  Two scans of a face need about 5; contrived input would need N. */
#define MERGE_WORK 40

/* repair_mesh() gives up beyond so many steps and flips a point, where more than every so
 * manieth point has to be taken out, where one of these has more neighbours, or where, on
 * average, taking one out changes more triangles: then a triangulation from scratch costs no
 * more.  Of a face turned by 10 degrees 3 points in 1,000 have to be taken out, and it needs
 * 0.2 flips a point. */
#define REPAIR_FLIPS   2
#define REPAIR_GONE    8
#define REPAIR_RING    64
#define REPAIR_CHANGED 16

/* Steps per point, on average, before locate_mesh() locates the others by bisection.  Two
 * scans of a face need about 3; contrived input would need N. */
#define LOCATE_WORK 40

/* ---- holes (paper 2): relative to the local point spacing */

/* A triangle bridges missing points when its longest side and the radius of its circle
 * exceed these multiples of the mean spacing at its corners.  Of points wholly at random the
 * rule takes 0.5 % of the area, of sound simulated scans less than 0.01 % inside the
 * outline; of blobs 12 to 44 mm wide it misses 0.6 % of the area. */
#define HOLES_SIDE   4.0
#define HOLES_CIRCLE 2.8

/* The local spacing counts at most this multiple of the whole scan's.  Without the limit
 * points left over between wide holes took these for their own spacing: with 92 % of a face
 * cut out a third of it counted as measured.  1.3 and 2 fare alike (docs/studies.md). */
#define HOLES_MOST 1.5

/* A restored point is this far from the scan's points at least, in sides of the triangles that
 * the restored ones form: half as far as they are from each other. */
#define FILL_APART 0.5

/* Points missing in a hole, by its area and rim, below which it is left alone.  Points at random
 * leave such gaps: of sound simulated scans of 3,000 points one in six has one, of 20,000
 * points each; with 3 it would be three times as many. */
#define FILL_LEAST 5

/* Looks at a surface, the first included, until nothing is missing: 2, rarely 3. */
#define FILL_PASSES 8

/* Restored points against the true surface, by the diameter of the hole, mm: root mean square,
 * and what 95 % of the points stay below.  For each size the largest that study `filled` found
 * with round holes in made-up faces, of 3,000 and of 20,000 points, and in scans, rounded up;
 * not falling with the size.  Of long holes of the same area it is about half. */
#define FILL_SIZES 8
/* clang-format off */
#define FILL_SIZE_MM { 5,   7,   10,  14,  20,  28,  40,  56 }
#define FILL_RMS_MM  { 0.3, 0.7, 1.4, 1.4, 2.2, 2.8, 3.9, 6.8 }
#define FILL_95_MM   { 0.5, 1.4, 2.9, 2.9, 4.0, 5.5, 8.3, 15.8 }
/* clang-format on */

/* ---- spikes */

/* A spike rises above a neighbour by more than this (mm), and more steeply than 45 degrees,
 * so that neither noise nor the side of a nose is one.  By hand. */
#define SPIKES_STEP_MM 1

/* It does so above (or below) this many quarters of its neighbours: on an edge of the
 * surface only about half of them lie below.  By hand. */
#define SPIKES_QUARTERS 3

/* ---- quality: what is no face, and what is too poor a scan (quality.h) */

/* mm, of the longest side: what a scan in cm, inches or metres, or of a room, has not. */
#define QUALITY_EXTENT_MIN_MM 60
#define QUALITY_EXTENT_MAX_MM 500

/* Of so many points the largest extent leaves out one at either end of each axis: a few
 * stray points do not matter. */
#define QUALITY_STRAY_IN 100

/* Root mean square distance from the best plane, mm: below it there is no relief.  By
 * hand. */
#define QUALITY_RELIEF_MIN_MM 3

/* White noise, mm: the limit, at which the score is 0 too.  Of scans of a good scanner 99 in
 * 100 have less than 0.51. */
#define QUALITY_NOISE_MAX_MM 3.0

/* Noise is taken from each so manieth point: enough for a median, a quarter of the time. */
#define QUALITY_NOISE_STRIDE 4

/* The median of |x| of a normal distribution is its deviation over this. */
#define QUALITY_MEDIAN 1.4826

/* Measured area over the outline's area below which a scan says nothing.  By hand. */
#define QUALITY_COVER_MIN 0.1

/* Share of points that stand out as spikes, beyond which noise hides in them: white noise of
 * 58 mm had more than half laid flat and passed as 1.9 mm.  Simulated scans have 2 % at
 * most; a face seen from 28 degrees aside folds over itself in a tenth of its points. */
#define QUALITY_SPIKES_MAX 0.25

/* Warnings.  Density (mm): beyond it the score begins to fall, and with it q->score.  The
 * others: beyond what 99 of 100 scans of a good scanner have (noise 0.51 mm); a third of the outline missing; turns beyond what align_search() is
 * made for. */
#define QUALITY_SPARSE_MM        3.0
#define QUALITY_NOISY_MM         0.6
#define QUALITY_INCOMPLETE_SHARE 0.7
#define QUALITY_TURNED_YAW_DEG   30
#define QUALITY_TURNED_OTHER_DEG 20 /* pitch, roll */

/* ---- the crop of a raw scan (core/find/crop.h) */

/* Cells (12 mm) round the outline of the mean face that belong to a scan of it. */
#define CROP_RIM 3

/* mm before and behind the fitted face within which points are the face's; on the rim, where
 * the sides of a face fall off, of the height at its edge.  From 4 to 10 fare alike. */
#define CROP_BEFORE_MM     8.0
#define CROP_BEHIND_MM     8.0
#define CROP_RIM_BEFORE_MM 20.0
#define CROP_RIM_BEHIND_MM 40.0

/* A point is hidden from the front where another one in its cell lies farther before the
 * fitted face than it, by more than STEP mm and SLOPE times the distance between the two; by
 * NOISE times the lower quartile of what two points of a cell differ by, where that is more.  Of
 * points all over a head the mated score becomes 0.063 (2 mm and a slope of 1: 0.080; 5 mm:
 * 0.114); where nothing is hidden it grows by 0.001. */
#define CROP_SEEN_STEP_MM 1.5
#define CROP_SEEN_SLOPE   0.5
#define CROP_SEEN_NOISE   8.0

/* mm: a point kept by thinning becomes the mean, over the face, of the points in its place that
 * are so near to it, spikes not.  Of a depth camera the mated score becomes 0.094 instead of
 * 0.099. */
#define CROP_MEAN_MM 2.5

/* ---- a mirror image (core/find/mirror.h) */

/* So many normals must be known, or pixels, and so great a share of the normals must agree:
 * those of a mesh, or of a scanner, nearly all do.  By hand. */
#define MIRROR_LEAST 100
#define MIRROR_SHARE 0.9

/* How well rows and columns must explain where the points lie in the view.  By hand. */
#define MIRROR_IMAGE 0.7

/* ---- from a raw scan to a face (core/find/scan.h) */

/* Scans of so many points are not thinned; those of more, to so many points of the face, if it
 * has more: what is measured by 4 mm cells hardly changes with density (docs/accuracy.md). */
#define SCAN_FULL   10000
#define SCAN_ENOUGH 7000

/* What is plainly a face seen from the front, and is left as it is where nothing covers it: how far
 * it is turned from upright (1 + 2 cos 25 degrees), the least support of its shape, and the most
 * spikes: points of the back of a head, seen through, become such.  Of 1,400 scans of faces the
 * least has a support of 0.30. */
#define SCAN_PLAIN        0.28
#define SCAN_PLAIN_TRACE  2.8126
#define SCAN_PLAIN_SPIKES 0.03

/* mm, along x and y: larger than any head; and so near each other are two places for one nose.  By
 * hand. */
#define SCAN_PLAIN_SIDE_MM 300
#define SCAN_SAME_MM       10.0

/* Share of the face that may be covered at enrolment; and from which it is told, as is the
 * share of points elsewhere. */
#define SCAN_OCCLUDED_MOST  0.25
#define SCAN_OCCLUDED_SOME  0.05
#define SCAN_ELSEWHERE_SOME 0.05

/* A view is told against a scanner's axes that it is within 75 degrees of: the trace of the
 * rotation, 1 + 2 cos 75. */
#define SCAN_AXES_TRACE 1.5176

/* A face that is turned by more than QUALITY_TURNED_YAW_DEG is enrolled where so much of the side
 * to which it is turned is seen nevertheless, as of a frontal scan in other axes.  Of half
 * profiles from 35 degrees on 0.73 at most is, of frontal scans 0.93 and more. */
#define SCAN_FAR_SIDE 0.8

/* A scan is of one side where less than this share of the points, on a head's size of cells,
 * lies farther behind the front-most one of its cell.  Of heads from all sides about half do, of
 * one view with a wall behind, whose points share cells with the head's rim, 7 % at most. */
#define SIGHT_CELL_MM     6.0
#define SIGHT_BEHIND_MM   40.0
#define SIGHT_BEHIND_MOST 0.2

/* ---- poses */

/* Turns are taken about a point this far behind the surface, mm: a face is roughly a ball of
 * that radius, so that turns and shifts disturb each other least.  Turns count as lengths at
 * this distance. */
#define POSE_LEVER_MM 80.0

/* Axes and nose are those of this many points, at most twice as many: only starts of a search
 * come from them. */
#define POSE_AXES_POINTS 1000

/* The nose: the mean of this share of the points, those that protrude most; what lies d to
 * the side protrudes d^2 / RADIUS less, so that a chin or a forehead turned forward is no
 * nose.  BINS of protrusion, each about 1 mm.  By hand. */
#define POSE_NOSE_SHARE     0.02
#define POSE_NOSE_RADIUS_MM 250.0
#define POSE_NOSE_BINS      128

/* ---- alignment (align.h) */

/* Points of the probe that decide between starts, that bring the best of them home, and that
 * leave out what does not fit; at most twice as many.  A step shorter than MM is the last of
 * its stage, and there are STAGE_STEPS at most.  Time grows with the points; one start is
 * enough for 90 % of probes turned by up to 25 degrees, and none of 340 ended beyond 1.5
 * degrees. */
#define ALIGN_COARSE_POINTS 150
#define ALIGN_COARSE_MM     1.0
#define ALIGN_MIDDLE_POINTS 400
#define ALIGN_MIDDLE_MM     0.3
#define ALIGN_TUKEY_POINTS  1000
#define ALIGN_TUKEY_STEP_MM 0.1
#define ALIGN_STAGE_STEPS   8

/* Other starts are tilted by turns whose half angles have these tangents: 14 degrees from
 * the principal axes, 17 from the pose as scanned, which knows less.  By hand. */
#define ALIGN_TILT_AXES  0.12
#define ALIGN_TILT_AS_IS 0.15

/* A coarse pose needs no rival when it has GOOD_WITHIN of the points over the template and
 * costs less than GOOD_MM, or more when two or three starts led there (SAME_MM apart at
 * most).  A quarter of all scans tried all starts before agreement counted. */
#define ALIGN_GOOD_WITHIN 0.75
#define ALIGN_GOOD_MM     1.0
#define ALIGN_GOOD_2_MM   2.0
#define ALIGN_GOOD_3_MM   3.0
#define ALIGN_SAME_MM     5.0

/* Else the second best is followed too, if it costs less than this times the best. */
#define ALIGN_RIVAL 1.4

/* Share of the probe's points over the template below which both are apart. */
#define ALIGN_APART_WITHIN 0.2

/* The last step, which tells motion from change: over this many points, at most twice as
 * many (with half as many the median rotation error grows by 5 %, and a second step does not
 * make it less), and the prior on the motion (1 / mm^2), which is next to none.  By hand. */
#define ALIGN_LAST_POINTS 3000
#define ALIGN_LAST_TIE    1e-4

/* Triangles that the area of the probe is taken from, at most twice as many: to 2 %. */
#define ALIGN_AREA_TRIANGLES 2500

/* Steps that a walk of the search is allowed, and the steps a triangle that all of them may
 * take beyond that: time, not results.  On scans a walk takes two or three; what needs more
 * than both is no face, and the search ends apart. */
#define ALIGN_WALK 8
#define ALIGN_WORK 40

/* Gauss-Newton: the longest step, and damping that keeps what nothing tells where it is.  By
 * hand. */
#define ALIGN_MAX_TURN_RAD 0.25
#define ALIGN_MAX_SHIFT_MM 25.0
#define ALIGN_DAMPING      1e-4

/* Residuals, mm.  |r| is rounded off below SOFT, so that L1's weight 1 / |r| stays finite;
 * beyond TUKEY a residual counts nothing: it belongs to another expression, to hair or to a
 * spike; one residual adds at most CAP to a pose's cost; a point without a gap adds NO_GAP,
 * so that sliding apart does not pay.  By hand. */
#define ALIGN_SOFT_MM   0.05
#define ALIGN_TUKEY_MM  2.5
#define ALIGN_CAP_MM    5.0
#define ALIGN_NO_GAP_MM 3.0

/* ---- the minimal disparity (minimal.h): docs/decision.md, "How the minimum is found" */

/* tan(MINIMAL_TURN_DEG / 2). */
#define MINIMAL_TAN_HALF_TURN 0.08748866352592400

/* The first steps see so many of the probe's vertices; how many steps at most, and the length
 * of the last, mm.  Of non-mated pairs 97 % end within 1 % of the least known value with 1,500,
 * 96 with 750, 94 with 500; a seventh step gains nothing. */
#define MINIMAL_FEW      750
#define MINIMAL_STEPS    6
#define MINIMAL_SHORT_MM 0.1

/* The longest Newton step, mm, in the first steps and in the last.  By hand. */
#define MINIMAL_FAR_MM  4
#define MINIMAL_LAST_MM 1

/* Looks at all vertices, at most; and how long, mm, the way from the last one must have been
 * for another: one pair in 18.  Non-mated pairs more than 2 % above the least known value
 * become 0.7 % instead of 1.0; with 0.35 mm no fewer. */
#define MINIMAL_LOOKS   3
#define MINIMAL_NEAR_MM 1

/* Newton steps between two looks at the surfaces (2: 95.7 % of the non-mated pairs,
 * 3: 96.7, 4: 96.3), and how far one goes back. */
#define MINIMAL_NEWTON 3
#define MINIMAL_BACK   0.35

/* In terms of the mean of |gap|: below SHARP |gap| is rounded off; its curvature is spread
 * over SOFT.  0.05 to 0.2 and 0.3 to 0.6 fare alike. */
#define MINIMAL_SHARP 0.1
#define MINIMAL_SOFT  0.4

/* A mean gap, mm, below which there is nothing to make less: a tenth of a lattice unit. */
#define MINIMAL_LEVEL_MM 1e-4

/* The alignment is measured too unless estimate and measure are less than this share of the
 * estimate at the alignment, and the estimated area is not less than this share of the one
 * there.  Of 600 pairs the change of the estimate errs by -5 to +17 % of the measure's, of the
 * area by 2 %; one pair in 20 is measured at both poses. */
#define MINIMAL_SURE_GAP  0.95
#define MINIMAL_SURE_AREA 0.97

/* The least share of the motion that is tried where all of it is not allowed.  By hand. */
#define MINIMAL_LEAST_SHARE 0.1

/* Triangles passed on the way to a vertex before it counts as having no gap.  In two scans
 * alike it is one or two; between overturned triangles a walk may go in circles. */
#define MINIMAL_WALK 400

/* ---- asymmetry (asymmetry.h): alignment along three motions */

/* The surface is turned upright by the start, then by the corrected plane: after two rounds
 * the side it was scanned from does not matter. */
#define ASYMMETRY_ROUNDS 2

/* Points of the mirror image in a robust sum, at most; steps, and the length of the last. */
#define ASYMMETRY_POINTS  4000
#define ASYMMETRY_STEPS   40
#define ASYMMETRY_LAST_MM 2e-3

/* As in alignment; the start is nearer, and a sphere's plane stays where it is. */
#define ASYMMETRY_MAX_TURN_RAD 0.2
#define ASYMMETRY_MAX_SHIFT_MM 10.0
#define ASYMMETRY_DAMPING      1e-9

/* Bands across the surface, in halves, inner and outer: each is left out in turn. */
#define ASYMMETRY_BANDS 6

/* Least overlap of a surface with its mirror image that says something.  Of faces turned by
 * 35 degrees, or with 40 % missing in blobs, half of the surface lies over its image; of one
 * half of a face, which some other plane fits as well, less than a third. */
#define ASYMMETRY_MIN_OVERLAP 0.45

/* ---- the canonical frame (frame.h) */

/* Points of the face that its frame is found by, at most twice as many. */
#define FRAME_POINTS 1200

/* Reweighted steps onto a surface that does not fit are too short: each is three fifths of
 * the one before.  Stretched by this they end after 25 sums instead of 31. */
#define FRAME_STRETCH 1.5

/* Common cells below which the likeness is unknown: a third of a face. */
#define FRAME_LIKENESS_CELLS 350

/* Mean square, mm^2, below which a relief is rounding: the surface is a quadric. */
#define FRAME_RELIEF_MIN_MM2 1e-6

/* ---- the gap per cell (cells.h), and its fit (fit.h) */

/* mm^2 of a cell's 16 that both surfaces must cover before the cell counts at all.  By
 * hand: what little counts beyond it rises from nothing (cells_cover()). */
#define CELLS_COVERED 1.0f

/* Cosine between a normal and the frame's z (75 degrees) below which a place is left out: a
 * gap at right angles says little there, and the area is seen edge-on. */
#define CELLS_STEEP 0.25

/* Huber's limit, in standard deviations: 1.2 % of a normal distribution lies beyond. */
#define FIT_HUBER 2.5

/* A weight that a pass would change by less than this share of a full one stays: half of the
 * sums' work, and scores change by less than 0.1 %. */
#define FIT_STILL 0.05

/* With fewer covered cells nothing is explained; a third of a face has 350.  By hand. */
#define FIT_MIN_CELLS 40

/* ---- the shape of a face (shape.h) */

/* The passes of a fit: {limit in mm, prior (fit.h)}; the first SHAPE_PART_PASSES see a part of
 * the face alone.  Neighbouring cells are alike, so that the prior is stronger than 1: with a
 * third of it the worst of 20 faces with glasses has no more support than the best of 200 things
 * that are no faces; with twice as much 88 % of the cells of masks are told instead of 96. */
/* clang-format off */
#define SHAPE_PASSES { {12, 100, 88}, {12, 100, 88}, {8, 50, 88}, {8, 50, 88}, {5, 20, 88}, {5, 20, 88}, {3, 10, 88}, {3, 10, 88} }
#define SHAPE_ROUGH { {25, 100, 8}, {18, 100, 16} }
#define SHAPE_SEEK { {12, 100, 16}, {12, 100, 16}, {8, 50, 16} }
#define SHAPE_FILL 1
#define SHAPE_WORTH_MM 2.5
#define SHAPE_WORTH_COST 2.5
/* clang-format on */
#define SHAPE_PART_PASSES 4

/* The same for a face that stands alone, near its pose. */
/* clang-format off */
#define SHAPE_PLACE { {12, 100, 88}, {8, 50, 88}, {5, 20, 88}, {3, 10, 88}, {3, 10, 88} }
/* clang-format on */

/* mm: the most that a cell adds to the residual. */
#define SHAPE_RESIDUAL_MM 5.0

/* The prior on the motion, 1 / mm^2 (fit.h): next to none.  By hand. */
#define SHAPE_TIE 1e-2

/* The limit in front of the face is this share of the one behind: what covers a face lies in
 * front of it. */
#define SHAPE_FRONT 0.7

/* Points near the face that are looked at: ten in a cell.  By hand. */
#define SHAPE_POINTS 10000

/* mm: how far beside the grid and before it points are kept, and how deep behind the mean face,
 * at the pose that a fit starts from; a cell's points are those up to LAYER behind its first;
 * farther than BEHIND behind the face they are the back of the head, seen through a gap.  By
 * hand. */
#define SHAPE_AROUND_MM 30.0
#define SHAPE_DEEP_MM   60.0
#define SHAPE_LAYER_MM  4.0
#define SHAPE_BEHIND_MM 40.0

/* mm: the place round an eye, beside the nose; the share of it that must be skin before it is
 * told how much like an eye it is.  Of 1,400 scans of faces, up to 45 % of some cut out, one in
 * 700 has less. */
#define SHAPE_EYE_LEFT   4
#define SHAPE_EYE_RIGHT  54
#define SHAPE_EYE_BOTTOM 10
#define SHAPE_EYE_TOP    54
#define SHAPE_EYE_LEAST  0.15

/* Cells: fine relief is what is left once the mean over a square that reaches so far to each
 * side, 20 mm wide, is subtracted.  Squares of 12 and of 28 mm told faces from surfaces sought
 * against the gate as well or a little less well. */
#define SHAPE_FINE 2

/* mm: a cell is explained up to NEAR; what stands farther than STRONG in front of the face,
 * or WEAK beside such cells, covers it, if there are so many; and what is HOLE cells beside or
 * between them. */
#define SHAPE_NEAR_MM     2.0
#define SHAPE_STRONG_MM   3.0
#define SHAPE_WEAK_MM     1.6
#define SHAPE_COVER_CELLS 8
#define SHAPE_HOLE        6

/* mm: above the brows no expression moves the face, so that what stands WEAK in front of it from
 * the forehead's rim down is a cover, or FAR in front anywhere, as the peak of a cap.  By hand. */
#define SHAPE_BROW_Y 36.0
#define SHAPE_FAR_MM 10.0

/* Hair: a cell differs from the mean of those beside it by more than MM, and by more than TIMES
 * the median of the cheeks, as do SHARE of the known ones up to two cells away, LEAST at least; and
 * so many such CELLS are connected.  With 30 cells 7 of 1,400 scans of uncovered faces, once
 * fitted, had some hair. */
#define SHAPE_HAIR_MM    0.3
#define SHAPE_HAIR_TIMES 2.5
#define SHAPE_HAIR_SHARE 0.45
#define SHAPE_HAIR_LEAST 8
#define SHAPE_HAIR_CELLS 50

/* What a cover explains (shape.c): nothing up to MM in front of the fit, a cell from twice that on.
 * A fit from a part of the face is taken where it explains GAIN cells more.
 * So the right half is chosen for 39 of 40 masks and all of 40 pairs of glasses; of 150 whole faces
 * of real people without either the most that a part gains is 34, of 160 simulated ones 4. */
#define SHAPE_COVER_MM 3.0
#define SHAPE_GAIN     36.0

/* A mask covers more than this share of what is seen of the face below y in mm.  By hand. */
#define SHAPE_MASK_TOP   14.0
#define SHAPE_MASK_SHARE 0.6

/* Likeness: what is not explained counts up to REST mm; more where faces hardly differ, though
 * not below a rest of LEAST, and as it is at one of TYPICAL.  Both mean squares (mm^2) are
 * raised a little, so that neither noise nor a flat thing decides.  Of scans that these were
 * not chosen by, uncovered faces have 2.08 and more, masks 1.65; things and reliefs that are no
 * faces, and have a support of 0.25, 1.02 at most. */
#define SHAPE_REST_MM         3.0
#define SHAPE_REST_LEAST_MM   0.2
#define SHAPE_REST_TYPICAL_MM 0.54
#define SHAPE_REST_MM2        0.05
#define SHAPE_RELIEF_MM2      0.5

/* Share of skin among the cells with points, and worth (shape.c), that need no other start: most
 * scans of uncovered faces of real people have both. */
#define SHAPE_GOOD       0.95
#define SHAPE_GOOD_WORTH 540.0

/* Sizes of heads, over the mean face's: children from five years on, and large adults; taken where
 * they explain GAIN cells of a whole face more. */
#define SHAPE_SIZE_GAIN 24.0
/* clang-format off */
#define SHAPE_SIZES { 0.84, 1.16, 0.77, 0.71 }
/* clang-format on */

/* ---- the decision (face.h) */

/* A non-match is that of a mirrored scan where its mirror image scores higher by so much, and so
 * far above the threshold.  Of 40 made-up people the 13 whose mirrored scans do not match gain 20
 * to 65, to 26 or more; of 120 strangers the mirror image of one matches, with 10.3, where the
 * scan does not. */
#define DECISION_MIRRORED 10.0

/* ---- finding a face in a cloud (core/find/find.h)
 * Keys, counts and times are those of 20 simulated people as scanners deliver them (whole heads,
 * busts, half profiles, glasses, masks, depth cameras; 300 scans in any unit and axes). */

/* Units, the usual ones first: they are tried in this order. */
#define FIND_UNITS_MM                                                                    \
    {                                                                                    \
        1, 1000, 10, 25.4, 0.001                                                         \
    }

/* The largest side, mm, of what may be a head with shoulders, and of a room; leaving out one
 * point in STRAY_IN at either end, or, where that finds nothing, one in STRAYS_IN.  The
 * smallest crops are 130 mm, busts 500.  Nothing farther than REACH from the median is looked
 * at. */
#define FIND_HEAD_MIN_MM 110
#define FIND_ROOM_MIN_MM 900
#define FIND_ROOM_MAX_MM 6000
#define FIND_STRAY_IN    100
#define FIND_STRAYS_IN   10
#define FIND_REACH_MM    4000

/* A child's head, upright before a scanner, is looked at as if it were so much larger; it must be
 * worth so much more. */
#define FIND_SMALL      1.25
#define FIND_SMALL_COST 80.0

/* A view (find_view.h), mm: its cells; a nose stands out by OUT, as no ball of a head's size does,
 * from a ring about it, of which so many of 16 places must be SEEN; what lies farther than NEAR
 * before or behind the nose is something else.  The samples of the mean face: without what hair, a
 * collar or the view hides.  So great a share of them must be SEEN; gaps count up to CAP; the plane
 * may be so STEEP. */
#define FIND_CELL_MM        8.0
#define FIND_RING_MM        32.0
#define FIND_RING_SEEN      10
#define FIND_OUT_MM         8.5
#define FIND_NEAR_MM        60.0
#define FIND_FACE_X_MM      54.0
#define FIND_FACE_BOTTOM_MM (-62.0)
#define FIND_FACE_TOP_MM    50.0
#define FIND_SEEN           0.6
#define FIND_CAP_MM         6.0
#define FIND_STEEP          0.6

/* Starts that are kept; of these followed roughly at most, and of what that finds to the end: of
 * those along a scanner's axes, and of the others.  What is worth SURE roughly is followed at
 * once. */
#define FIND_STARTS       64
#define FIND_SEEKS        12
#define FIND_FITS         4
#define FIND_SEEKS_OTHERS 40
#define FIND_FITS_OTHERS  8
#define FIND_SURE         400.0

/* The search ends with what it has once it has spent what so many noses cost, some 4 us each, and
 * one for each so many points.  A view costs one for so many cubes and for so many cells that are
 * seen; a fit costs FIT and one for so many cubes. */
#define FIND_SPENT       5000
#define FIND_SPENT_SMALL 2000
#define FIND_SPENT_PER   12
#define FIND_SPENT_CUBES 512
#define FIND_SPENT_CELLS 96
#define FIND_SPENT_FIT   25
#define FIND_SPENT_FAR   1000

/* The worth of a fit (shape.h), and of eyes that are as the mean face's: what is plainly a face, as
 * neither the smooth back of a head is nor one the wrong way up; what is one if it is within 45
 * degrees (1 + 2 cos) of upright before a scanner; and what may well be one, so that other units
 * are not tried. */
#define FIND_WORTH_EYES    200.0
#define FIND_PLAIN         620.0
#define FIND_UPRIGHT       560.0
#define FIND_UPRIGHT_TRACE 2.4142
#define FIND_LIKELY        350.0

/* Where no face is plain, other poses than the best are told if they are worth this share of it. */
#define FIND_RIVAL 0.75

/* mm: where the nose is in a face that was fitted the wrong way up. */
#define FIND_WAY_UP_MM 56.0

/* Poses are the same within MM and 10 degrees (1 + 2 cos).  Another face is OTHER_MM away, of
 * nose from nose, and its start costs less than COST. */
#define FIND_SAME_MM    10.0
#define FIND_SAME_TRACE 2.9696
#define FIND_OTHER_MM   120.0
#define FIND_OTHER_COST 18.0

#endif
