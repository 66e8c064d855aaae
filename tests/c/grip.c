/* Contacts of a body that a hull presses from opposite sides are soft. */
#include "check.h"
#include "scene.h"

#include <math.h>

#define STEP 0.005

/* What the near callback does and finds. */
typedef struct {
  int mode; /* of the contacts before the call */
  int contacts, softened;
  dContact last;
} Found;

static void near_hull(void *data, dGeomID o1, dGeomID o2) {
  Found *found = (Found *)data;
  dContact contact[8];
  const int n = dCollide(o1, o2, 8, &contact[0].geom, sizeof(dContact));
  int k;

  for (k = 0; k < n; k++) {
    contact[k].surface.mode = found->mode;
    contact[k].surface.mu = 1;
    contact[k].surface.soft_cfm = 0.125;
    CHECK(dVisualHullSetContactMotion(&contact[k], STEP) >= 0);
    found->softened += (contact[k].surface.mode & dContactSoftERP) != 0;
    found->last = contact[k];
  }
  found->contacts += n;
}

static Found collide(dSpaceID space, int mode) {
  Found found;
  memset(&found, 0, sizeof found);
  found.mode = mode;
  dSpaceCollide(space, &found, near_hull);
  return found;
}

int main(void) {
  /* A clamp about the table: points 2 mm inside its sides, which face one another. */
  const dReal points[2][3] = {{0.248, 0, 0}, {-0.248, 0, 0}}, normals[2][3] = {{-1, 0, 0}, {1, 0, 0}};
  dVisualHullDataID data;
  dWorldID world;
  dSpaceID space;
  dGeomID clamp;
  Found found;
  dReal erp, cfm, stiffness, damping;

  CHECK(dInitODE2(0) && dInitVisualHull());
  data = table_data();
  world = table_world();
  space = dHashSpaceCreate(0);
  CHECK(dCreateVisualHull(space, data) != NULL);
  clamp = add_cube(world, space, 0, 0, 0);
  CHECK(dGeomVisualHullSetSamples(clamp, points[0], normals[0], 2, sizeof points[0]));

  found = collide(space, dContactApprox1);
  CHECK(found.contacts == 2 && found.softened == 2);

  /* A critically damped spring at the body's mass, 1 kg. */
  erp = found.last.surface.soft_erp, cfm = found.last.surface.soft_cfm;
  stiffness = erp / (STEP * cfm), damping = (1 - erp) / cfm;
  CHECK(fabs(damping / (2 * sqrt(stiffness)) - 1) < 1e-9);

  /* A softness that the program has chosen is kept. */
  found = collide(space, dContactApprox1 | dContactSoftCFM);
  CHECK(found.contacts == 2 && found.softened == 0 && found.last.surface.soft_cfm == 0.125);

  /* A cube on the table is not held. */
  dGeomVisualHullClearSamples(clamp);
  dBodySetPosition(dGeomGetBody(clamp), 0, 0, TOP + 0.099);
  for (int k = 0; k < 30; k++) found = collide(space, dContactApprox1);
  CHECK(found.contacts > 0 && found.softened == 0);

  dSpaceDestroy(space);
  dWorldDestroy(world);
  dGeomVisualHullDataDestroy(data);
  dCloseVisualHull();
  dCloseODE();
  return 0;
}
