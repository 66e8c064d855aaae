/* Capture threads set masks while another thread steps a world, and two threads step a world each, with data objects of
   their own or with one. */
#include "check.h"
#include "scene.h"

#include <math.h>
#include <pthread.h>

enum { FRAMES = 20 };

/* The masks of the table at rest, drawn once. All threads read them. */
static unsigned char masks[VIEWS][HEIGHT * WIDTH];

/* A camera's thread: sets the masks of all views again and again. Returns NULL if a mask is refused. */
static void *capture(void *data) {
  int frame, view;

  for (frame = 0; frame < FRAMES; frame++)
    for (view = 0; view < VIEWS; view++)
      if (!dGeomVisualHullDataSetMask((dVisualHullDataID)data, view, masks[view], WIDTH)) return NULL;
  return data;
}

static int publish_all(dVisualHullDataID data, dGeomID hull, dReal time) {
  (void)hull;
  return dGeomVisualHullDataUpdate(data, time);
}

static int only_take(dVisualHullDataID data, dGeomID hull, dReal time) {
  (void)data, (void)time;
  return dGeomVisualHullUpdate(hull);
}

/* Drops a cube on the table of `data`, with a call of `update` before each step, and returns its height at rest. Worlds that are stepped at the same time need a
   threading object each, because ODE's default one is shared and not thread-safe. */
static dReal rest_on(dVisualHullDataID data, int (*update)(dVisualHullDataID, dGeomID, dReal)) {
  dThreadingImplementationID threading = dThreadingAllocateSelfThreadedImplementation();
  dSpaceID space = dHashSpaceCreate(0);
  dGeomID hull = dCreateVisualHull(space, data), cube;
  dReal height;
  Contacts contacts;
  int k;

  CHECK(hull);
  contacts.world = table_world();
  dWorldSetStepThreadingImplementation(contacts.world, dThreadingImplementationGetFunctions(threading), threading);
  contacts.joints = dJointGroupCreate(0);
  contacts.calls = 0;

  cube = add_cube(contacts.world, space, 0.02, 0.01, TOP + 0.101);
  for (k = 0; k < 60; k++) {
    CHECK(update(data, hull, 0.005 * k));
    step(&contacts, space);
  }

  height = dGeomGetPosition(cube)[2];
  dJointGroupDestroy(contacts.joints);
  dSpaceDestroy(space);
  dWorldDestroy(contacts.world);
  dThreadingFreeImplementation(threading);
  return height;
}

/* A thread with its own world and its own data object. Returns its argument. */
static void *own_world(void *own) {
  dVisualHullDataID data = table_data();
  int k;

  CHECK(dAllocateODEDataForThread(dAllocateMaskAll)); /* ODE requires this of each thread that collides */
  CHECK(fabs(rest_on(data, publish_all) - TOP - 0.1) < 0.001 + 0.5 * PIXEL);
  for (k = 0; k < 50; k++) dGeomDestroy(dCreateVisualHull(0, data));
  dGeomVisualHullDataDestroy(data);

  /* Each thread has its own message. */
  CHECK(strcmp(dVisualHullGetErrorMessage(), "") == 0);
  CHECK(dGeomVisualHullDataUpdate(data, 0) == 0 && strcmp(dVisualHullGetErrorMessage(), "") != 0);
  dCleanupODEAllDataForThread();
  return own;
}

/* A thread with its own world, but with a data object that it shares. */
static void *shared_data(void *data) {
  CHECK(dAllocateODEDataForThread(dAllocateMaskAll));
  CHECK(fabs(rest_on((dVisualHullDataID)data, only_take) - TOP - 0.1) < 0.001 + 0.5 * PIXEL);
  return data;
}

int main(void) {
  dVisualHullDataID data;
  pthread_t threads[2];
  void *result;
  int k;

  CHECK(dInitODE2(0) && dInitVisualHull());
  for (k = 0; k < VIEWS; k++) draw_table(k, 0, masks[k]);

  /* Two threads set masks of one data object, while this one collides with it. */
  data = table_data();
  for (k = 0; k < 2; k++) CHECK(pthread_create(&threads[k], NULL, capture, data) == 0);
  CHECK(fabs(rest_on(data, publish_all) - TOP - 0.1) < 0.001 + 0.5 * PIXEL);
  for (k = 0; k < 2; k++) CHECK(pthread_join(threads[k], &result) == 0 && result == data);
  dGeomVisualHullDataDestroy(data);

  /* Two threads share nothing but the masks. */
  for (k = 0; k < 2; k++) CHECK(pthread_create(&threads[k], NULL, own_world, masks) == 0);
  for (k = 0; k < 2; k++) CHECK(pthread_join(threads[k], &result) == 0 && result == masks);

  /* Two worlds have hulls of one data object, whose frames this thread publishes. */
  data = table_data();
  for (k = 0; k < 2; k++) CHECK(pthread_create(&threads[k], NULL, shared_data, data) == 0);
  for (k = 1; k < 100; k++) {
    CHECK(dGeomVisualHullDataSetMask(data, k % VIEWS, masks[k % VIEWS], WIDTH));
    CHECK(dGeomVisualHullDataPublish(data, k));
  }
  for (k = 0; k < 2; k++) CHECK(pthread_join(threads[k], &result) == 0 && result == data);
  dGeomVisualHullDataDestroy(data);

  dCloseVisualHull();
  dCloseODE();
  return 0;
}
