/* Contacts that bounce off a hull and part already: Newton's law of restitution lets them come back, and adds no energy. */
#include "check.h"
#include "scene.h"

#include <math.h>

#define STEP 0.005

/* The surface of the contacts, and the last one's afterwards. */
typedef struct {
  dSurfaceParameters surface, last;
  int contacts;
} Found;

static void near_hull(void *data, dGeomID o1, dGeomID o2) {
  Found *found = (Found *)data;
  dContact contact[8];
  const int n = dCollide(o1, o2, 8, &contact[0].geom, sizeof(dContact));
  int k;

  for (k = 0; k < n; k++) {
    contact[k].surface = found->surface;
    CHECK(dVisualHullSetContactMotion(&contact[k], STEP) >= 0);
    found->last = contact[k].surface;
  }
  found->contacts += n;
}

static dSurfaceParameters surface_at(dSpaceID space, int mode) {
  Found found;
  memset(&found, 0, sizeof found);
  found.surface.mode = mode;
  found.surface.mu = 1;
  found.surface.bounce = 0.8;
  found.surface.bounce_vel = 0.1;
  dSpaceCollide(space, &found, near_hull);
  CHECK(found.contacts > 0);
  return found.last;
}

int main(void) {
  const int bouncing = dContactApprox1 | dContactBounce;
  dVisualHullDataID data;
  dWorldID world;
  dSpaceID space;
  dBodyID cube;
  dSurfaceParameters surface;

  CHECK(dInitODE2(0) && dInitVisualHull());
  data = table_data();
  world = table_world();
  space = dHashSpaceCreate(0);
  CHECK(dCreateVisualHull(space, data) != NULL);
  cube = dGeomGetBody(add_cube(world, space, 0, 0, TOP + 0.099));

  /* It parts at 0.5 m/s; the hull's normals are exact to two degrees. */
  dBodySetLinearVel(cube, 0, 0, 0.5);
  surface = surface_at(space, bouncing);
  CHECK((surface.mode & dContactMotionN) && fabs(surface.motionN + 0.8 * 0.5) < 1e-3);
  CHECK(!(surface_at(space, dContactApprox1).mode & dContactMotionN));

  /* No faster than what bounces, and towards the hull. */
  dBodySetLinearVel(cube, 0, 0, 0.05);
  CHECK(!(surface_at(space, bouncing).mode & dContactMotionN));
  dBodySetLinearVel(cube, 0, 0, -0.5);
  CHECK(!(surface_at(space, bouncing).mode & dContactMotionN));

  dSpaceDestroy(space);
  dWorldDestroy(world);
  dGeomVisualHullDataDestroy(data);
  dCloseVisualHull();
  dCloseODE();
  return 0;
}
