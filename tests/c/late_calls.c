/* Programs call this library while a thread or the process ends, when Rust's thread-local values are gone: destructors of
   global objects and of thread-local values do so. */
#include "check.h"
#include "scene.h"

#include <pthread.h>

static dVisualHullDataID data, empty;
static dGeomID hull, cube;
static pthread_key_t key;
static int calls;

/* What may happen late: collisions, queries, masks, failures and their messages, in this order. */
static void use_everything(void) {
  dContactGeom contacts[8];
  dVector3 w;
  int k;

  CHECK(dCollide(hull, cube, 8, contacts, sizeof *contacts) > 0);
  CHECK(dCollide(hull, cube, 8 | (int)CONTACTS_UNIMPORTANT, contacts, sizeof *contacts) > 0);
  CHECK(dGeomVisualHullPointInside(hull, 0, 0, 0) == 1);
  CHECK(dGeomVisualHullPointResponse(hull, 0, 0, TOP - 0.01, w) == 1);
  CHECK(dGeomVisualHullBodyResponse(hull, cube, w) > 0);
  show_table(data, 0);
  for (k = 0; k < 2; k++) {
    CHECK_REFUSED(dGeomVisualHullDataUpdate(empty, 0), 0, "at least one view");
    CHECK_REFUSED(dGeomVisualHullPointInside(0, 0, 0, 0), -1, "NULL");
  }
  calls++;
}

static void at_the_end_of_a_thread(void *none) {
  (void)none;
  use_everything();
}

static void *thread(void *argument) {
  CHECK(dAllocateODEDataForThread(dAllocateMaskAll));
  CHECK(pthread_setspecific(key, argument) == 0);
  use_everything();
  return NULL;
}

/* Runs after the thread-local values of the main thread are destroyed. */
static void at_exit(void) {
  CHECK_MESSAGE("at least one view"); /* the last failure of main */
  use_everything();
  dGeomDestroy(hull), dGeomDestroy(cube);
  dGeomVisualHullDataDestroy(data), dGeomVisualHullDataDestroy(empty);
  dCloseVisualHull();
  CHECK(dGetVisualHullClass() == -1);
  dCloseODE();
}

int main(void) {
  pthread_t other;
  CHECK(dInitODE2(0) && dInitVisualHull());
  data = table_data(), empty = dGeomVisualHullDataCreate();
  hull = dCreateVisualHull(0, data), cube = dCreateBox(0, 0.2, 0.2, 0.2);
  dGeomSetPosition(cube, 0, 0, TOP + 0.096);

  CHECK(pthread_key_create(&key, &at_the_end_of_a_thread) == 0);
  CHECK(pthread_create(&other, NULL, &thread, &key) == 0 && pthread_join(other, NULL) == 0);
  CHECK(calls == 2);

  CHECK(dGeomVisualHullDataUpdate(empty, 0) == 0);
  CHECK(atexit(&at_exit) == 0);
  return 0;
}
