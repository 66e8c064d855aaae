/* A box falls on the table, comes to rest, is lifted with it, and wakes when it drops back. */
#include "check.h"
#include "scene.h"

#include <math.h>

static dReal height(dGeomID geom) { return dGeomGetPosition(geom)[2]; }

int main(void) {
  Contacts contacts;
  dSpaceID space;
  dVisualHullDataID data;
  dGeomID hull, cube;
  dReal aabb[6];
  dVector3 w;
  int k;

  CHECK(strcmp(dVisualHullGetVersion(), dVISUAL_HULL_VERSION) == 0);
  CHECK(strcmp(dVisualHullGetErrorMessage(), "") == 0);
  CHECK(dInitODE2(0));
  CHECK(dInitVisualHull());
  dRandSetSeed(1);
  contacts.world = table_world();
  contacts.joints = dJointGroupCreate(0);
  contacts.calls = 0;
  space = dHashSpaceCreate(0);

  data = table_data();
  CHECK(dGeomVisualHullDataGetViewCount(data) == VIEWS);
  hull = dCreateVisualHull(space, data);
  CHECK(hull && dGeomGetClass(hull) == dGetVisualHullClass());
  CHECK(dGeomVisualHullGetData(hull) == data && dGeomGetSpace(hull) == space && !dGeomGetBody(hull));
  dGeomGetAABB(hull, aabb);
  CHECK(aabb[0] < -0.2 && aabb[1] > 0.2 && aabb[5] >= TOP && aabb[5] < TOP + 3 * PIXEL);
  CHECK(dGeomVisualHullPointInside(hull, 0, 0, TOP - 0.01) == 1);
  CHECK(dGeomVisualHullPointInside(hull, 0, 0, TOP + 0.01) == 0);
  CHECK(dGeomVisualHullPointResponse(hull, 0, 0, TOP - 0.05, w) == 1);
  CHECK(w[2] > 0 && fabs(w[2] - 0.05) < PIXEL && fabs(w[0]) < PIXEL && fabs(w[1]) < PIXEL);
  CHECK(dGeomVisualHullPointResponse(hull, 0, 0, TOP + 0.05, w) == 0);
  CHECK(w[0] == 0 && w[1] == 0 && w[2] == 0);

  cube = add_cube(contacts.world, space, 0.03, -0.02, TOP + 0.15);
  CHECK(dGeomVisualHullBodyResponse(hull, cube, w) == 0 && w[2] == 0);
  /* It falls for 0.1 s; valgrind runs this too, which is why no more time passes than rest takes. */
  for (k = 0; k < 150; k++) step(&contacts, space);
  /* The surface layer lets it sink a millimetre, coverage places the top to a fraction of a pixel. */
  CHECK(fabs(height(cube) - TOP - 0.1) < 0.001 + 0.3 * PIXEL);
  CHECK(fabs(dBodyGetLinearVel(dGeomGetBody(cube))[2]) < 0.01);
  CHECK(dGeomVisualHullBodyResponse(hull, cube, w) > 0 && w[2] > 0);

  /* The table rises by 10 cm in half a second, then drops back; the box sleeps in between, and wakes. */
  for (k = 1; k <= 100; k++) {
    if (k % 5 == 0) { /* a camera's 40 frames a second */
      show_table(data, 0.001 * k);
      CHECK(dGeomVisualHullDataUpdate(data, 2 + 0.005 * k));
    }
    step(&contacts, space);
  }
  for (k = 0; k < 60; k++) step(&contacts, space);
  /* The cameras look at the risen top from below, which leaves a tent of 0.25 / 2.75 of the rise above it. */
  CHECK(height(cube) > TOP + 0.2 - 0.001 - 0.5 * PIXEL && height(cube) < TOP + 0.2 + 0.01 + 0.5 * PIXEL);
  dBodyDisable(dGeomGetBody(cube));
  for (k = 0; k < 20; k++) step(&contacts, space);
  CHECK(!dBodyIsEnabled(dGeomGetBody(cube)));
  show_table(data, 0);
  CHECK(dGeomVisualHullDataUpdate(data, 4));
  for (k = 0; k < 150; k++) step(&contacts, space);
  CHECK(fabs(height(cube) - TOP - 0.1) < 0.001 + 0.3 * PIXEL);

  dJointGroupDestroy(contacts.joints);
  dSpaceDestroy(space);
  dWorldDestroy(contacts.world);
  dGeomVisualHullDataDestroy(data);
  dCloseVisualHull();
  CHECK(dGetVisualHullClass() == -1);
  dCloseODE();
  return 0;
}
