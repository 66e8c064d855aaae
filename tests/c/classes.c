/* ODE's table of four user classes, and an ODE that is closed beneath us. */
#include "check.h"
#include "scene.h"

static int nothing(dGeomID a, dGeomID b, int flags, dContactGeom *contacts, int skip) {
  (void)a, (void)b, (void)flags, (void)contacts, (void)skip;
  return 0;
}

static dColliderFn *no_collider(int other) {
  (void)other;
  return &nothing;
}

static void point(dGeomID geom, dReal aabb[6]) {
  (void)geom;
  memset(aabb, 0, 6 * sizeof(dReal));
}

/* Takes places in ODE's table. */
static void register_others(int count) {
  dGeomClass other;
  memset(&other, 0, sizeof other);
  other.bytes = 8;
  other.collider = &no_collider;
  other.aabb = &point;
  for (; count > 0; count--) CHECK(dCreateGeomClass(&other) >= dFirstUserClass);
}

static void a_hull_collides(void) {
  dVisualHullDataID data = table_data();
  dGeomID hull = dCreateVisualHull(0, data), cube = dCreateBox(0, 0.2, 0.2, 0.2);
  dContactGeom contacts[8];
  CHECK(hull);
  dGeomSetPosition(cube, 0, 0, TOP + 0.096);
  CHECK(dCollide(hull, cube, 8, contacts, sizeof *contacts) == 8);
  dGeomDestroy(cube);
  dGeomDestroy(hull);
  dGeomVisualHullDataDestroy(data);
}

static void one_place_is_enough_however_often_it_is_opened(void) {
  int k, number;
  CHECK(dInitODE2(0));
  CHECK(dInitVisualHull());
  register_others(3);
  number = dGetVisualHullClass();
  for (k = 0; k < 5; k++) CHECK(dInitVisualHull() && dGetVisualHullClass() == number);
  for (k = 0; k < 6; k++) dCloseVisualHull();
  CHECK(dGetVisualHullClass() == -1);
  CHECK(dInitVisualHull() && dGetVisualHullClass() == number);
  a_hull_collides();
  dCloseVisualHull();
  dCloseODE();
}

static void a_full_table_is_an_error_and_no_abort(void) {
  dVisualHullDataID data;
  CHECK(dInitODE2(0));
  register_others(4);
  CHECK_REFUSED(dInitVisualHull(), 0, "four");
  CHECK_REFUSED(dInitVisualHull(), 0, "four");
  CHECK(dGetVisualHullClass() == -1);
  data = dGeomVisualHullDataCreate();
  CHECK_REFUSED(dCreateVisualHull(0, data), NULL, "dInitVisualHull");
  dGeomVisualHullDataDestroy(data);
  dCloseODE();
}

/* Our reference keeps ODE open after the caller's own is gone. */
static void the_class_keeps_ode_open(void) {
  CHECK(dInitODE2(0));
  CHECK(dInitVisualHull());
  dCloseODE();
  a_hull_collides();
  dCloseVisualHull();
}

static void ode_is_closed_beneath_the_class(void) {
  dVisualHullDataID data = table_data();
  dGeomID hull;
  CHECK(dInitODE2(0));
  CHECK(dInitVisualHull());
  hull = dCreateVisualHull(0, data);
  CHECK(hull);
  dCloseODE();
  dCloseODE(); /* one too many: that was ours */
  CHECK(dGetVisualHullClass() == -1);
  CHECK_REFUSED(dCreateVisualHull(0, data), NULL, "closed");
  CHECK(dGeomVisualHullPointInside(hull, 0, 0, 0) == 1);
  CHECK(dGeomVisualHullDataUpdate(data, 1));
  dGeomDestroy(hull);
  dCloseVisualHull(); /* has nothing to give back, and does not take another's */

  /* The same, and the program opens ODE anew while the class still thinks that it is open. */
  CHECK(dInitODE2(0));
  CHECK(dInitVisualHull());
  dCloseODE();
  dCloseODE();
  CHECK(dInitODE2(0));
  register_others(1);
  CHECK(dGetVisualHullClass() == -1);
  CHECK(dInitVisualHull() && dGetVisualHullClass() == dFirstUserClass + 1);
  a_hull_collides();
  dCloseVisualHull();
  dCloseVisualHull();
  CHECK(dGetVisualHullClass() == -1);
  dCloseODE();

  /* The class is closed after the program opened ODE anew: that reference is the program's. */
  CHECK(dInitODE2(0));
  CHECK(dInitVisualHull());
  dCloseODE();
  dCloseODE();
  CHECK(dInitODE2(0));
  dCloseVisualHull();
  CHECK(dAllocateODEDataForThread(dAllocateMaskAll)); /* aborts where ODE is closed */
  dCloseODE();
  dGeomVisualHullDataDestroy(data);
}

int main(void) {
  one_place_is_enough_however_often_it_is_opened();
  a_full_table_is_an_error_and_no_abort();
  the_class_keeps_ode_open();
  one_place_is_enough_however_often_it_is_opened();
  ode_is_closed_beneath_the_class();
  return 0;
}
