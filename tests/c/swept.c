/* A swept hull collides with what it will meet within the next step. */
#include "check.h"
#include "scene.h"

#include <math.h>

#define STEP (1.0 / 120)
#define RADIUS 0.02
#define SPEED 60.0

/* What the near callback needs and counts. */
typedef struct {
  dWorldID world;
  dJointGroupID joints;
  int pairs, contacts;
  dReal time; /* of the last contact */
} Scene;

static void near_hull(void *data, dGeomID o1, dGeomID o2) {
  Scene *scene = (Scene *)data;
  dContact contact[8];
  const int n = dCollide(o1, o2, 8, &contact[0].geom, sizeof(dContact));
  int k;

  scene->pairs++;
  for (k = 0; k < n; k++) {
    contact[k].surface.mode = dContactApprox1;
    contact[k].surface.mu = 0;
    scene->contacts++;
    scene->time = dGeomVisualHullContactTime(&contact[k].geom);
    if (scene->time > 0) {
      CHECK(contact[k].geom.depth == 0);
      /* The ball may go on as fast as it reaches the table at the end of the step. */
      CHECK(dVisualHullSetContactMotion(&contact[k], STEP) == 1);
      CHECK(contact[k].surface.mode & dContactMotionN);
      CHECK(fabs(contact[k].surface.motionN + SPEED * scene->time / STEP) < 1e-6 * SPEED);
    }
    dJointAttach(dJointCreateContact(scene->world, scene->joints, &contact[k]), dGeomGetBody(o1), dGeomGetBody(o2));
  }
}

/* Where the ball comes to rest, by its lowest point above the table, and what the first collide has found. */
static dReal fall(int mode, Scene *first) {
  dVisualHullDataID data = table_data();
  dSpaceID space = dHashSpaceCreate(0);
  dGeomID hull = dCreateVisualHull(space, data), ball = dCreateSphere(space, RADIUS);
  dBodyID body;
  dMass mass;
  dReal height;
  Scene scene;
  int k;

  memset(&scene, 0, sizeof scene);
  scene.world = table_world();
  scene.joints = dJointGroupCreate(0);
  dWorldSetGravity(scene.world, 0, 0, 0);
  body = dBodyCreate(scene.world);
  dMassSetSphereTotal(&mass, 1, RADIUS);
  dBodySetMass(body, &mass);
  dGeomSetBody(ball, body);
  dBodySetPosition(body, 0.01, 0.02, TOP + RADIUS + 0.1);
  dBodySetLinearVel(body, 0, 0, -SPEED);
  dGeomVisualHullSetSwept(hull, mode);
  CHECK(dGeomVisualHullSetTime(hull, 0) == 1);

  for (k = 1; k < 12; k++) {
    CHECK(dGeomVisualHullSetTime(hull, k * STEP) == 1);
    dSpaceCollide(space, &scene, near_hull);
    if (k == 1) *first = scene;
    dWorldQuickStep(scene.world, STEP);
    dJointGroupEmpty(scene.joints);
  }
  height = dBodyGetPosition(body)[2] - RADIUS - TOP;
  dJointGroupDestroy(scene.joints);
  dSpaceDestroy(space);
  dWorldDestroy(scene.world);
  dGeomVisualHullDataDestroy(data);
  return height;
}

static void a_fast_ball_does_not_pass_a_swept_hull(void) {
  Scene first;

  CHECK(fall(dVisualHullSweptOff, &first) < -1);
  CHECK(first.pairs == 0);

  CHECK(fall(dVisualHullSweptBroadPhase, &first) < -1);
  CHECK(first.pairs == 1 && first.contacts == 0);

  CHECK(fabs(fall(dVisualHullSweptOn, &first)) < PIXEL);
  CHECK(first.pairs == 1 && first.contacts == 1);
  CHECK(fabs(first.time * SPEED - 0.1) < PIXEL);
}

static void bad_arguments_are_refused(void) {
  dVisualHullDataID data = table_data();
  dGeomID hull = dCreateVisualHull(0, data), box = dCreateBox(0, 1, 1, 1);
  dContactGeom contact;

  CHECK_REFUSED_VOID(dGeomVisualHullSetSwept(hull, 3), "dVisualHullSwept");
  CHECK_REFUSED_VOID(dGeomVisualHullSetSwept(box, dVisualHullSweptOn), "visual hull");
  CHECK_REFUSED(dGeomVisualHullContactTime(NULL), -1, "contact");

  memset(&contact, 0, sizeof contact);
  contact.g1 = contact.g2 = box;
  contact.side1 = contact.side2 = 1000;
  CHECK(dGeomVisualHullContactTime(&contact) == 0);
  contact.g2 = hull;
  contact.side2 = -1;
  CHECK(dGeomVisualHullContactTime(&contact) == 0);
  contact.side2 = 4000000;
  CHECK(fabs(dGeomVisualHullContactTime(&contact) - 0.004) < 1e-12);
  dGeomDestroy(hull);
  dGeomDestroy(box);
  dGeomVisualHullDataDestroy(data);
}

int main(void) {
  CHECK(dInitVisualHull());
  a_fast_ball_does_not_pass_a_swept_hull();
  bad_arguments_are_refused();
  dCloseVisualHull();
  return 0;
}
