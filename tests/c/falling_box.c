/* A box falls on the table, comes to rest, is lifted with the table, and wakes when the table drops back. */
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

  /* The hull is an ordinary geom around the table. */
  data = table_data();
  CHECK(dGeomVisualHullDataGetViewCount(data) == VIEWS);
  hull = dCreateVisualHull(space, data);
  CHECK(hull && dGeomGetClass(hull) == dGetVisualHullClass());
  CHECK(dGeomVisualHullGetData(hull) == data && dGeomGetSpace(hull) == space && !dGeomGetBody(hull));
  dGeomGetAABB(hull, aabb);
  CHECK(aabb[0] < -0.2 && aabb[1] > 0.2 && aabb[5] >= TOP && aabb[5] < TOP + 3 * PIXEL);

  /* Points inside and outside, and the vector to the nearest surface. */
  CHECK(dGeomVisualHullPointInside(hull, 0, 0, TOP - 0.01) == 1);
  CHECK(dGeomVisualHullPointInside(hull, 0, 0, TOP + 0.01) == 0);
  CHECK(dGeomVisualHullPointResponse(hull, 0, 0, TOP - 0.05, w) == 1);
  CHECK(w[2] > 0 && fabs(w[2] - 0.05) < PIXEL && fabs(w[0]) < PIXEL && fabs(w[1]) < PIXEL);
  CHECK(dGeomVisualHullPointResponse(hull, 0, 0, TOP + 0.05, w) == 0);
  CHECK(w[0] == 0 && w[1] == 0 && w[2] == 0);

  /* The box falls for 0.1 s and comes to rest. Valgrind runs this too, so the simulation ends soon after. */
  cube = add_cube(contacts.world, space, 0.03, -0.02, TOP + 0.15);
  CHECK(dGeomVisualHullBodyResponse(hull, cube, w) == 0 && w[2] == 0);
  for (k = 0; k < 150; k++) step(&contacts, space);
  /* The surface layer lets the box sink by 1 mm, and coverage gives the top to a fraction of a pixel. */
  CHECK(fabs(height(cube) - TOP - 0.1) < 0.001 + 0.3 * PIXEL);
  CHECK(fabs(dBodyGetLinearVel(dGeomGetBody(cube))[2]) < 0.01);
  CHECK(dGeomVisualHullBodyResponse(hull, cube, w) > 0 && w[2] > 0);

  /* The table rises by 10 cm in half a second and carries the box. */
  for (k = 1; k <= 100; k++) {
    if (k % 5 == 0) { /* 40 frames per second */
      show_table(data, 0.001 * k);
      CHECK(dGeomVisualHullDataUpdate(data, 2 + 0.005 * k));
    }
    step(&contacts, space);
  }
  for (k = 0; k < 60; k++) step(&contacts, space);
  /* The cameras see the risen top from below, which leaves a tent on it, up to 0.25 / 2.75 of the rise high. */
  CHECK(height(cube) > TOP + 0.2 - 0.001 - 0.5 * PIXEL && height(cube) < TOP + 0.2 + 0.01 + 0.5 * PIXEL);

  /* The box sleeps on the table, and wakes when the table drops back. */
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
