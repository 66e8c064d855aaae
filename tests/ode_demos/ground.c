/* The hull of a slab, seen from its sides by four level cameras as the lower half of each image. The cameras' centres lie
   in the plane of its top, so that the image of the top is the horizon, and the hull's top is z = 0 in the field of view of
   all cameras. */
#include "ground.h"

#include <ode_visual_hull.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { VIEWS = 4, WIDTH = 640, HEIGHT = 480 };

/* A ball that rolls away at 1 m/s gets 80 m far in the 80 s of a run. */
static const dReal REACH = 100, THICKNESS = 10, DISTANCE = 250, FOCAL = 400;

static dVisualHullDataID ground;

static void need(int success) {
  if (!success) {
    fprintf(stderr, "the ground: %s\n", dVisualHullGetErrorMessage());
    exit(2);
  }
}

dGeomID create_hull_ground(dSpaceID space) {
  static const dReal forward[VIEWS][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
  const dReal bounds[6] = {-REACH, REACH, -REACH, REACH, -THICKNESS, REACH};
  const dReal K[9] = {FOCAL, 0, WIDTH / 2, 0, FOCAL, HEIGHT / 2, 0, 0, 1}, t[3] = {0, 0, DISTANCE};
  static unsigned char mask[HEIGHT][WIDTH];
  dGeomID hull;
  int k;
  memset(mask[HEIGHT / 2], 255, sizeof mask / 2);
  need(dInitVisualHull());
  ground = dGeomVisualHullDataCreate();
  need(dGeomVisualHullDataSetBounds(ground, bounds));
  for (k = 0; k < VIEWS; k++) {
    const dReal x = forward[k][0], y = forward[k][1], R[9] = {y, -x, 0, 0, 0, -1, x, y, 0}; /* right, down, forward */
    need(dGeomVisualHullDataAddCamera(ground, K, R, t, NULL, 0, WIDTH, HEIGHT) == k);
    need(dGeomVisualHullDataSetMask(ground, k, mask[0], WIDTH));
  }
  need(dGeomVisualHullDataUpdate(ground, 0));
  hull = dCreateVisualHull(space, ground);
  need(hull != NULL);
  return hull;
}

void close_hull_ground(void) {
  dGeomVisualHullDataDestroy(ground);
  dCloseVisualHull();
}
