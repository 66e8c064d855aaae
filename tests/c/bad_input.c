/* Invalid arguments give 0, -1 or NULL and a message, and leave everything usable. */
#include "check.h"
#include "scene.h"

#include <limits.h>
#include <math.h>

/* A copy of `numbers` with a NaN at `index`. */
static dReal *nan_at(int index, const dReal *numbers, int count) {
  static dReal copy[14];
  memcpy(copy, numbers, count * sizeof(dReal));
  copy[index] = NAN;
  return copy;
}

static void calls_before_the_class_is_open_are_refused(void) {
  dVisualHullDataID data = dGeomVisualHullDataCreate();

  CHECK(data);
  CHECK(dGetVisualHullClass() == -1);
  CHECK_REFUSED(dCreateVisualHull(0, data), NULL, "dInitVisualHull");
  CHECK_REFUSED_VOID(dCloseVisualHull(), "dInitVisualHull");
  dGeomVisualHullDataDestroy(data);
}

static void invalid_data_ids_are_refused(dVisualHullDataID stale) {
  const dReal numbers[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  const unsigned char mask[1] = {0};
  const dVisualHullDataID ids[3] = {0, stale, (dVisualHullDataID)0x10001};
  int k;

  for (k = 0; k < 3; k++) {
    const dVisualHullDataID d = ids[k];
    CHECK_REFUSED_VOID(dGeomVisualHullDataDestroy(d), "data");
    CHECK_REFUSED(dGeomVisualHullDataAddView(d, numbers, 8, 8), -1, "data");
    CHECK_REFUSED(dGeomVisualHullDataAddCamera(d, numbers, numbers, numbers, 0, 0, 8, 8), -1, "data");
    CHECK_REFUSED(dGeomVisualHullDataAddFisheyeCamera(d, numbers, numbers, numbers, 0, 0, 8, 8), -1, "data");
    CHECK_REFUSED(dGeomVisualHullDataLoadRig(d, "rig.toml"), 0, "data");
    CHECK_REFUSED(dGeomVisualHullDataGetViewCount(d), -1, "data");
    CHECK_REFUSED(dGeomVisualHullDataSetBounds(d, numbers), 0, "data");
    CHECK_REFUSED(dGeomVisualHullDataSetUnseen(d, 0, 2), 0, "data");
    CHECK_REFUSED(dGeomVisualHullDataSetMask(d, 0, mask, 8), 0, "data");
    CHECK_REFUSED(dGeomVisualHullDataLoadMask(d, 0, "mask.png"), 0, "data");
    CHECK_REFUSED(dGeomVisualHullDataSetViewEnabled(d, 0, 1), 0, "data");
    CHECK_REFUSED(dGeomVisualHullDataSetMaxAge(d, 1), 0, "data");
    CHECK_REFUSED(dGeomVisualHullDataSetMaskFilter(d, 0, 1), 0, "data");
    CHECK_REFUSED(dGeomVisualHullDataSetOverruleDepth(d, 0), 0, "data");
    CHECK_REFUSED(dGeomVisualHullDataUpdate(d, 0), 0, "data");
    CHECK_REFUSED(dCreateVisualHull(0, d), NULL, "data");
  }
}

static void geoms_other_than_hulls_are_refused(dVisualHullDataID data, dGeomID stale) {
  dSpaceID space = dSimpleSpaceCreate(0);
  dGeomID geoms[5];
  dVector3 w;
  int k;

  geoms[0] = 0, geoms[1] = stale, geoms[2] = (dGeomID)space;
  geoms[3] = dCreateSphere(space, 1), geoms[4] = dCreatePlane(space, 0, 0, 1, 0);

  for (k = 0; k < 5; k++) {
    const dGeomID g = geoms[k];
    CHECK_REFUSED_VOID(dGeomVisualHullSetData(g, data), "visual hull");
    CHECK_REFUSED(dGeomVisualHullGetData(g), NULL, "visual hull");
    CHECK_REFUSED_VOID(dGeomVisualHullSetMotion(g, dVisualHullMotionPredicted), "visual hull");
    CHECK_REFUSED(dGeomVisualHullSetTime(g, 1), 0, "visual hull");
    CHECK_REFUSED(dGeomVisualHullPointVelocity(g, 0, 0, 0, w), -1, "visual hull");
    CHECK_REFUSED(dGeomVisualHullPointInside(g, 0, 0, 0), -1, "visual hull");
    CHECK_REFUSED(dGeomVisualHullPointResponse(g, 0, 0, 0, w), -1, "visual hull");
    CHECK_REFUSED(dGeomVisualHullBodyResponse(g, geoms[3], w), -1, "visual hull");
    CHECK_REFUSED_VOID(dGeomVisualHullSetContactMode(g, dVisualHullContactsPaper), "visual hull");
    CHECK_REFUSED_VOID(dGeomVisualHullSetMaxContacts(g, 8), "visual hull");
    CHECK_REFUSED_VOID(dGeomVisualHullSetMaxDepth(g, 0.1), "visual hull");
    CHECK_REFUSED_VOID(dGeomVisualHullSetMinFeature(g, 0.1), "visual hull");
    CHECK_REFUSED_VOID(dGeomVisualHullSetEvents(g, 1), "visual hull");
    CHECK_REFUSED_VOID(dGeomVisualHullSetEventWait(g, 0.1), "visual hull");
    CHECK_REFUSED(dGeomVisualHullGetEvents(g, NULL, 0), -1, "visual hull");
  }
  dSpaceDestroy(space);
}

static void invalid_views_are_refused(void) {
  static const int sizes[][2] = {{0, 10}, {10, 0}, {-1, 10}, {10, INT_MIN}, {INT_MAX, INT_MAX}, {INT_MAX, 1}};
  const dReal zeros[12] = {0}, mirror[9] = {-1, 0, 0, 0, 1, 0, 0, 0, 1}, lens[14] = {0}, folding[4] = {-50, 0, 0, 0};
  dVisualHullDataID d = dGeomVisualHullDataCreate();
  dReal P[12], K[9], R[9], t[3], wide[9] = {4, 0, 4, 0, 4, 4, 0, 0, 1};
  int k;

  projection(0, P);
  camera(0, K, R, t);
  for (k = 0; k < 6; k++) {
    CHECK_REFUSED(dGeomVisualHullDataAddView(d, P, sizes[k][0], sizes[k][1]), -1, "size");
    CHECK_REFUSED(dGeomVisualHullDataAddCamera(d, K, R, t, 0, 0, sizes[k][0], sizes[k][1]), -1, "size");
  }

  /* A NaN in any argument. */
  for (k = 0; k < 12; k++) CHECK_REFUSED(dGeomVisualHullDataAddView(d, nan_at(k, P, 12), 8, 8), -1, "");
  for (k = 0; k < 9; k++) {
    CHECK_REFUSED(dGeomVisualHullDataAddCamera(d, nan_at(k, K, 9), R, t, 0, 0, 8, 8), -1, "");
    CHECK_REFUSED(dGeomVisualHullDataAddCamera(d, K, nan_at(k, R, 9), t, 0, 0, 8, 8), -1, "R");
  }
  for (k = 0; k < 3; k++)
    CHECK_REFUSED(dGeomVisualHullDataAddCamera(d, K, R, nan_at(k, t, 3), 0, 0, 8, 8), -1, "");
  for (k = 0; k < 14; k++)
    CHECK_REFUSED(dGeomVisualHullDataAddCamera(d, K, R, t, nan_at(k, lens, 14), 14, 8, 8), -1, "finite");
  for (k = 0; k < 4; k++)
    CHECK_REFUSED(dGeomVisualHullDataAddFisheyeCamera(d, K, R, t, nan_at(k, lens, 4), 4, 8, 8), -1, "finite");

  /* Missing and degenerate matrices. */
  CHECK_REFUSED(dGeomVisualHullDataAddView(d, NULL, 8, 8), -1, "P");
  CHECK_REFUSED(dGeomVisualHullDataAddView(d, zeros, 8, 8), -1, "");
  CHECK_REFUSED(dGeomVisualHullDataAddCamera(d, NULL, R, t, 0, 0, 8, 8), -1, "K");
  CHECK_REFUSED(dGeomVisualHullDataAddCamera(d, K, NULL, t, 0, 0, 8, 8), -1, "R");
  CHECK_REFUSED(dGeomVisualHullDataAddCamera(d, K, R, NULL, 0, 0, 8, 8), -1, "t");
  CHECK_REFUSED(dGeomVisualHullDataAddCamera(d, zeros, R, t, 0, 0, 8, 8), -1, "");
  CHECK_REFUSED(dGeomVisualHullDataAddCamera(d, K, zeros, t, 0, 0, 8, 8), -1, "rotation");
  CHECK_REFUSED(dGeomVisualHullDataAddCamera(d, K, mirror, t, 0, 0, 8, 8), -1, "rotation");

  /* Distortion: missing coefficients, and counts that OpenCV's model does not have. */
  CHECK_REFUSED(dGeomVisualHullDataAddCamera(d, K, R, t, NULL, 5, 8, 8), -1, "distortion");
  CHECK_REFUSED(dGeomVisualHullDataAddCamera(d, K, R, t, lens, -1, 8, 8), -1, "nDistortion");
  CHECK_REFUSED(dGeomVisualHullDataAddCamera(d, K, R, t, lens, 3, 8, 8), -1, "found 3");
  CHECK_REFUSED(dGeomVisualHullDataAddCamera(d, K, R, t, lens, 13, 8, 8), -1, "found 13");
  CHECK_REFUSED(dGeomVisualHullDataAddCamera(d, K, R, t, lens, INT_MAX, 8, 8), -1, "nDistortion");

  /* The fisheye lens: missing arrays, counts, sizes, a model that folds back, and rays beyond 90 degrees. */
  CHECK_REFUSED(dGeomVisualHullDataAddFisheyeCamera(d, NULL, R, t, 0, 0, 8, 8), -1, "K");
  CHECK_REFUSED(dGeomVisualHullDataAddFisheyeCamera(d, K, NULL, t, 0, 0, 8, 8), -1, "R");
  CHECK_REFUSED(dGeomVisualHullDataAddFisheyeCamera(d, K, R, NULL, 0, 0, 8, 8), -1, "t");
  CHECK_REFUSED(dGeomVisualHullDataAddFisheyeCamera(d, K, R, t, NULL, 4, 8, 8), -1, "k");
  CHECK_REFUSED(dGeomVisualHullDataAddFisheyeCamera(d, K, R, t, lens, -1, 8, 8), -1, "nk");
  CHECK_REFUSED(dGeomVisualHullDataAddFisheyeCamera(d, K, R, t, lens, 5, 8, 8), -1, "nk");
  CHECK_REFUSED(dGeomVisualHullDataAddFisheyeCamera(d, K, R, t, lens, 2, 8, 8), -1, "found 2");
  CHECK_REFUSED(dGeomVisualHullDataAddFisheyeCamera(d, K, R, t, lens, 4, 0, 8), -1, "size");
  CHECK_REFUSED(dGeomVisualHullDataAddFisheyeCamera(d, wide, R, t, folding, 4, 8, 8), -1, "folds back");
  wide[0] = wide[4] = 3; /* the corners are 5.7 px from the axis, at 108 degrees */
  CHECK_REFUSED(dGeomVisualHullDataAddFisheyeCamera(d, wide, R, t, lens, 4, 8, 8), -1, "108.0 degrees");

  /* Paths of rig files. */
  CHECK_REFUSED(dGeomVisualHullDataLoadRig(d, NULL), 0, "path");
  CHECK_REFUSED(dGeomVisualHullDataLoadRig(d, "/no/such/rig.toml"), 0, "/no/such/rig.toml");
  CHECK_REFUSED(dGeomVisualHullDataLoadRig(d, "/"), 0, "/");
  CHECK_REFUSED(dGeomVisualHullDataLoadRig(d, "\xff\xfe"), 0, "path");

  CHECK(dGeomVisualHullDataGetViewCount(d) == 0);
  dGeomVisualHullDataDestroy(d);
}

static void invalid_masks_and_updates_are_refused(void) {
  static unsigned char mask[HEIGHT * WIDTH];
  const dReal bounds[6] = {-1, 1, -1, 1, -1, 1}, inverted[6] = {1, -1, -1, 1, -1, 1};
  dVisualHullDataID d = dGeomVisualHullDataCreate();
  dReal P[12];
  int k;

  /* An update needs views, bounds and masks, in this order. */
  CHECK_REFUSED(dGeomVisualHullDataUpdate(d, 0), 0, "view");
  projection(0, P);
  CHECK(dGeomVisualHullDataAddView(d, P, WIDTH, HEIGHT) == 0);
  CHECK_REFUSED(dGeomVisualHullDataUpdate(d, 0), 0, "bounds");
  CHECK_REFUSED(dGeomVisualHullDataSetBounds(d, NULL), 0, "aabb");
  CHECK_REFUSED(dGeomVisualHullDataSetBounds(d, inverted), 0, "");
  for (k = 0; k < 6; k++) CHECK_REFUSED(dGeomVisualHullDataSetBounds(d, nan_at(k, bounds, 6)), 0, "");
  CHECK(dGeomVisualHullDataSetBounds(d, bounds));
  CHECK_REFUSED(dGeomVisualHullDataUpdate(d, 0), 0, "mask");

  /* Masks: views, pointers, strides, times and files. */
  draw_table(0, 0, mask);
  CHECK_REFUSED(dGeomVisualHullDataSetMask(d, -1, mask, WIDTH), 0, "view");
  CHECK_REFUSED(dGeomVisualHullDataSetMask(d, 1, mask, WIDTH), 0, "view");
  CHECK_REFUSED(dGeomVisualHullDataSetMask(d, INT_MAX, mask, WIDTH), 0, "view");
  CHECK_REFUSED(dGeomVisualHullDataSetMask(d, 0, NULL, WIDTH), 0, "mask");
  CHECK_REFUSED(dGeomVisualHullDataSetMask(d, 0, mask, WIDTH - 1), 0, "rowStride");
  CHECK_REFUSED(dGeomVisualHullDataSetMask(d, 0, mask, 0), 0, "rowStride");
  CHECK_REFUSED(dGeomVisualHullDataSetMask(d, 0, mask, INT_MIN), 0, "rowStride");
  CHECK_REFUSED(dGeomVisualHullDataSetMaskAt(d, 0, NULL, WIDTH, 0), 0, "mask");
  CHECK_REFUSED(dGeomVisualHullDataSetMaskAt(d, 0, mask, WIDTH - 1, 0), 0, "rowStride");
  CHECK_REFUSED(dGeomVisualHullDataSetMaskAt(d, 0, mask, WIDTH, NAN), 0, "finite time");
  CHECK_REFUSED(dGeomVisualHullDataLoadMask(d, 0, NULL), 0, "path");
  CHECK_REFUSED(dGeomVisualHullDataLoadMask(d, 0, "/no/such/mask.png"), 0, "/no/such/mask.png");
  CHECK_REFUSED(dGeomVisualHullDataLoadMask(d, 7, "/no/such/mask.png"), 0, "");

  CHECK_REFUSED(dGeomVisualHullDataSetViewEnabled(d, 1, 0), 0, "view");
  CHECK_REFUSED(dGeomVisualHullDataSetViewEnabled(d, -1, 0), 0, "view");
  CHECK_REFUSED(dGeomVisualHullDataSetMaxAge(d, -1), 0, "max_age");
  CHECK_REFUSED(dGeomVisualHullDataSetMaxAge(d, NAN), 0, "max_age");
  CHECK_REFUSED(dGeomVisualHullDataSetMaxAge(d, INFINITY), 0, "max_age");
  CHECK_REFUSED(dGeomVisualHullDataSetMaskFilter(d, -1, 1), 0, "smallestHole");
  CHECK_REFUSED(dGeomVisualHullDataSetMaskFilter(d, 0, 0), 0, "weight");
  CHECK_REFUSED(dGeomVisualHullDataSetMaskFilter(d, 0, 1.01), 0, "weight");
  CHECK_REFUSED(dGeomVisualHullDataSetMaskFilter(d, 0, NAN), 0, "weight");
  CHECK_REFUSED(dGeomVisualHullDataSetOverruleDepth(d, -0.02), 0, "depth");
  CHECK_REFUSED(dGeomVisualHullDataSetOverruleDepth(d, NAN), 0, "depth");
  CHECK_REFUSED(dGeomVisualHullDataSetOverruleDepth(d, INFINITY), 0, "depth");
  CHECK_REFUSED(dGeomVisualHullDataSetUnseen(d, -1, 2), 0, "policy");
  CHECK_REFUSED(dGeomVisualHullDataSetUnseen(d, dVisualHullUnseenAbstain, 0), 0, "min_views");
  CHECK_REFUSED(dGeomVisualHullDataSetUnseen(d, dVisualHullUnseenAbstain, -3), 0, "minViews");

  /* Times of updates, which must not decrease. */
  CHECK(dGeomVisualHullDataSetMask(d, 0, mask, WIDTH));
  CHECK_REFUSED(dGeomVisualHullDataUpdate(d, NAN), 0, "time");
  CHECK_REFUSED(dGeomVisualHullDataUpdate(d, INFINITY), 0, "time");
  CHECK(dGeomVisualHullDataUpdate(d, 1));
  CHECK_REFUSED(dGeomVisualHullDataUpdate(d, 0.5), 0, "time");

  /* A mask without background. The last valid one stays. */
  memset(mask, 255, sizeof mask);
  CHECK_REFUSED(dGeomVisualHullDataSetMask(d, 0, mask, WIDTH), 0, "background");
  CHECK(dGeomVisualHullDataUpdate(d, 1));
  dGeomVisualHullDataDestroy(d);
}

static void invalid_motions_and_times_are_refused(void) {
  dVisualHullDataID data = table_data();
  dGeomID hull = dCreateVisualHull(0, data);
  dVector3 v;

  CHECK_REFUSED_VOID(dGeomVisualHullSetMotion(hull, 3), "dVisualHullMotion");
  CHECK_REFUSED_VOID(dGeomVisualHullSetMotion(hull, -1), "dVisualHullMotion");
  dGeomVisualHullSetMotion(hull, dVisualHullMotionInterpolated);

  /* Times, which must not decrease. A refused time changes nothing. */
  CHECK_REFUSED(dGeomVisualHullSetTime(hull, NAN), 0, "time");
  CHECK_REFUSED(dGeomVisualHullSetTime(hull, -INFINITY), 0, "time");
  CHECK(dGeomVisualHullSetTime(hull, -1e300) == 1);
  CHECK(dGeomVisualHullSetTime(hull, 5) == 1 && dGeomVisualHullSetTime(hull, 5) == 1);
  CHECK_REFUSED(dGeomVisualHullSetTime(hull, 4.9), 0, "not before");
  CHECK_REFUSED(dGeomVisualHullSetTime(hull, INFINITY), 0, "time");
  CHECK(dGeomVisualHullSetTime(hull, 1e300) == 1);
  CHECK(dGeomVisualHullPointInside(hull, 0, 0, 0) == 1);

  /* Velocities. Nothing is known of a hull with a single frame. */
  CHECK(dGeomVisualHullPointVelocity(hull, 0.25, 0, 0, v) == 0 && v[0] == 0 && v[1] == 0 && v[2] == 0);
  CHECK(dGeomVisualHullPointVelocity(hull, 1e300, 0, 0, v) == 0);
  CHECK_REFUSED(dGeomVisualHullPointVelocity(hull, 0.25, 0, 0, NULL), -1, "v");
  CHECK_REFUSED(dGeomVisualHullPointVelocity(hull, NAN, 0, 0, v), -1, "finite");
  CHECK_REFUSED(dGeomVisualHullPointVelocity(hull, 0, INFINITY, 0, v), -1, "finite");
  CHECK_REFUSED(dGeomVisualHullPointVelocity(hull, 0, 0, -INFINITY, v), -1, "finite");

  dGeomDestroy(hull);
  dGeomVisualHullDataDestroy(data);
}

static void invalid_contacts_are_refused(void) {
  const dReal lengths[4] = {0, 0.99, 1.01, 1e200};
  dVisualHullDataID data = table_data();
  dGeomID hull = dCreateVisualHull(0, data), cube = dCreateBox(0, 0.2, 0.2, 0.2);
  dContact good, bad;
  int k;

  memset(&good, 0, sizeof good);
  dGeomSetPosition(cube, 0, 0, TOP + 0.096);
  CHECK(dCollide(hull, cube, 1, &good.geom, sizeof good) == 1);
  CHECK(dVisualHullSetContactMotion(&good, 0.005) == 0 && dVisualHullSetContactMotion(&good, 0) == 0);

  CHECK_REFUSED(dVisualHullSetContactMotion(NULL, 0.005), -1, "contact");
  CHECK_REFUSED(dVisualHullSetContactMotion(&good, -0.005), -1, "stepsize");
  CHECK_REFUSED(dVisualHullSetContactMotion(&good, NAN), -1, "stepsize");
  CHECK_REFUSED(dVisualHullSetContactMotion(&good, INFINITY), -1, "stepsize");
  CHECK(dVisualHullSetContactFriction(&good, 0.005) == 0);
  CHECK_REFUSED(dVisualHullSetContactFriction(NULL, 0.005), -1, "contact");
  CHECK_REFUSED(dVisualHullSetContactFriction(&good, NAN), -1, "stepsize");
  bad = good, bad.geom.g1 = 0;
  CHECK_REFUSED(dVisualHullSetContactMotion(&bad, 0.005), -1, "g1");
  bad = good, bad.geom.g2 = 0;
  CHECK_REFUSED(dVisualHullSetContactMotion(&bad, 0.005), -1, "g2");
  for (k = 0; k < 3; k++) {
    bad = good, bad.geom.pos[k] = NAN;
    CHECK_REFUSED(dVisualHullSetContactMotion(&bad, 0.005), -1, "finite");
    bad = good, bad.geom.normal[k] = NAN;
    CHECK_REFUSED(dVisualHullSetContactMotion(&bad, 0.005), -1, "unit");
  }
  for (k = 0; k < 4; k++) {
    bad = good, bad.geom.normal[0] = bad.geom.normal[1] = 0, bad.geom.normal[2] = lengths[k];
    CHECK_REFUSED(dVisualHullSetContactMotion(&bad, 0.005), -1, "unit");
  }

  /* A hull that was destroyed is an unknown address, which is not followed. */
  dGeomDestroy(hull);
  CHECK(dVisualHullSetContactMotion(&good, 0.005) == 0);
  dGeomDestroy(cube);
  dGeomVisualHullDataDestroy(data);
}

static void invalid_arguments_of_a_hull_are_refused(void) {
  const dReal points[4] = {0, 0, 0, 0}, bad[3] = {0, NAN, 0};
  const int stride = sizeof(dVector3), skip = sizeof(dContactGeom);
  dVisualHullDataID data = table_data();
  dGeomID hull = dCreateVisualHull(0, data), cube = dCreateBox(0, 0.2, 0.2, 0.2);
  dContactGeom contacts[8];
  dVector3 w;

  /* Points and vectors. A point that is not finite is outside. */
  CHECK(dGeomVisualHullPointInside(hull, NAN, 0, 0) == 0 && dGeomVisualHullPointInside(hull, 0, INFINITY, 0) == 0);
  CHECK(dGeomVisualHullPointResponse(hull, 0, 0, NAN, w) == 0 && w[0] == 0 && w[1] == 0 && w[2] == 0);
  CHECK_REFUSED(dGeomVisualHullPointResponse(hull, 0, 0, 0, NULL), -1, "w");
  CHECK_REFUSED(dGeomVisualHullBodyResponse(hull, NULL, w), -1, "body");
  CHECK_REFUSED(dGeomVisualHullBodyResponse(hull, cube, NULL), -1, "v");

  /* Settings. */
  CHECK_REFUSED_VOID(dGeomVisualHullSetContactMode(hull, 4), "mode");
  CHECK_REFUSED_VOID(dGeomVisualHullSetContactMode(hull, -1), "mode");
  CHECK_REFUSED_VOID(dGeomVisualHullSetMaxContacts(hull, 0), "max_contacts");
  CHECK_REFUSED_VOID(dGeomVisualHullSetMaxContacts(hull, -8), "n");
  CHECK_REFUSED_VOID(dGeomVisualHullSetMaxDepth(hull, NAN), "max_depth");
  CHECK_REFUSED_VOID(dGeomVisualHullSetMaxDepth(hull, -1), "max_depth");
  CHECK_REFUSED_VOID(dGeomVisualHullSetMinFeature(hull, 0), "min_feature");
  CHECK_REFUSED_VOID(dGeomVisualHullSetMinFeature(hull, INFINITY), "min_feature");

  /* Samples: pointers, counts, strides and numbers. */
  CHECK_REFUSED(dGeomVisualHullSetSamples(NULL, points, 0, 1, stride), 0, "body");
  CHECK_REFUSED(dGeomVisualHullSetSamples(cube, NULL, 0, 1, stride), 0, "points");
  CHECK_REFUSED(dGeomVisualHullSetSamples(cube, points, 0, 0, stride), 0, "sample");
  CHECK_REFUSED(dGeomVisualHullSetSamples(cube, points, 0, -1, stride), 0, "count");
  CHECK_REFUSED(dGeomVisualHullSetSamples(cube, points, 0, INT_MAX, stride), 0, "count");
  CHECK_REFUSED(dGeomVisualHullSetSamples(cube, points, 0, 1, 0), 0, "stride");
  CHECK_REFUSED(dGeomVisualHullSetSamples(cube, points, 0, 1, -stride), 0, "stride");
  CHECK_REFUSED(dGeomVisualHullSetSamples(cube, bad, 0, 1, stride), 0, "sample");
  CHECK_REFUSED(dGeomVisualHullSetSamples(cube, points, bad, 1, stride), 0, "normal");
  dGeomVisualHullClearSamples(cube);
  dGeomVisualHullClearSamples(NULL);

  CHECK_REFUSED_VOID(dGeomVisualHullSetData(hull, NULL), "data");
  CHECK(dGeomVisualHullGetData(hull) == data);

  /* The data object is destroyed, and the geom keeps its last frame. */
  dGeomVisualHullDataDestroy(data);
  CHECK_REFUSED(dGeomVisualHullDataUpdate(data, 9), 0, "destroyed");
  CHECK(dGeomVisualHullGetData(hull) == NULL);
  CHECK(dGeomVisualHullPointInside(hull, 0, 0, 0) == 1);
  dGeomSetPosition(cube, 0, 0, TOP + 0.096);
  CHECK(dCollide(hull, cube, 8, contacts, skip) == 8);

  /* A body too large to be sampled gives no contacts and a message instead of an abort. */
  dGeomBoxSetLengths(cube, 1e6, 1e6, 1e6);
  CHECK_REFUSED(dCollide(hull, cube, 8, contacts, skip), 0, "samples");
  CHECK_REFUSED(dGeomVisualHullBodyResponse(hull, cube, w), -1, "");
  invalid_data_ids_are_refused(data);

  /* Stale ids of the data object and of the hull. */
  dGeomDestroy(hull);
  data = table_data();
  geoms_other_than_hulls_are_refused(data, hull);
  dGeomVisualHullDataDestroy(data);
  dGeomDestroy(cube);
}

static void calls_after_the_class_is_closed_are_refused(void) {
  dVisualHullDataID data = table_data();

  CHECK(dInitVisualHull());
  dCloseVisualHull();
  CHECK(dGetVisualHullClass() != -1); /* opened twice, closed once */
  dCloseVisualHull();
  CHECK(dGetVisualHullClass() == -1);
  CHECK_REFUSED(dCreateVisualHull(0, data), NULL, "dInitVisualHull");
  CHECK_REFUSED_VOID(dCloseVisualHull(), "dInitVisualHull");
  CHECK(dGeomVisualHullDataUpdate(data, 10)); /* data objects need no ODE */
  dGeomVisualHullDataDestroy(data);
}

int main(void) {
  calls_before_the_class_is_open_are_refused();
  CHECK(dInitODE2(0) && dInitVisualHull());
  invalid_views_are_refused();
  invalid_masks_and_updates_are_refused();
  invalid_motions_and_times_are_refused();
  invalid_contacts_are_refused();
  invalid_arguments_of_a_hull_are_refused();
  calls_after_the_class_is_closed_are_refused();
  dCloseODE();
  return 0;
}
