/* ODE's table of four user classes, and programs that close ODE while the class is open. */
#include "check.h"
#include "scene.h"

/* A collider that finds no contacts. */
static int nothing(dGeomID a, dGeomID b, int flags, dContactGeom *contacts, int skip) {
  (void)a, (void)b, (void)flags, (void)contacts, (void)skip;
  return 0;
}

static dColliderFn *no_collider(int other) {
  (void)other;
  return &nothing;
}

/* A bounding box without extent at the origin. */
static void point(dGeomID geom, dReal aabb[6]) {
  (void)geom;
  memset(aabb, 0, 6 * sizeof(dReal));
}

/* Registers `count` other classes, which take entries of ODE's table. */
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

static void opening_the_class_again_and_again_takes_one_entry_of_the_table(void) {
  int k, number;

  CHECK(dInitODE2(0));
  CHECK(dInitVisualHull());
  register_others(3);
  number = dGetVisualHullClass();

  for (k = 0; k < 5; k++) CHECK(dInitVisualHull() && dGetVisualHullClass() == number);
  for (k = 0; k < 6; k++) dCloseVisualHull();
  CHECK(dGetVisualHullClass() == -1);

  /* Opened again, the class has its old number and works. */
  CHECK(dInitVisualHull() && dGetVisualHullClass() == number);
  a_hull_collides();
  dCloseVisualHull();
  dCloseODE();
}

static void a_full_table_gives_an_error_instead_of_an_abort(void) {
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

/* The class's reference to ODE keeps it open after the program has released its own. */
static void the_class_keeps_ode_open(void) {
  CHECK(dInitODE2(0));
  CHECK(dInitVisualHull());
  dCloseODE();
  a_hull_collides();
  dCloseVisualHull();
}

static void closing_ode_once_too_often_closes_the_class_with_it(void) {
  dVisualHullDataID data = table_data();
  dGeomID hull;

  CHECK(dInitODE2(0));
  CHECK(dInitVisualHull());
  hull = dCreateVisualHull(0, data);
  CHECK(hull);
  dCloseODE();
  dCloseODE(); /* one call too many, which releases the class's reference */
  CHECK(dGetVisualHullClass() == -1);
  CHECK_REFUSED(dCreateVisualHull(0, data), NULL, "closed");
  CHECK_REFUSED(dGeomVisualHullPointInside(hull, 0, 0, 0), -1, "closing ODE");
  CHECK(dGeomVisualHullDataUpdate(data, 1));
  dGeomDestroy(hull);
  dCloseVisualHull(); /* must not release a reference that is not the class's */

  /* Another class has the number by the time that the hull is destroyed, so that this library does not learn of it. */
  CHECK(dInitODE2(0));
  CHECK(dInitVisualHull());
  hull = dCreateVisualHull(0, data);
  dCloseODE();
  dCloseODE();
  CHECK(dInitODE2(0));
  register_others(1);
  dGeomDestroy(hull);
  CHECK_REFUSED(dGeomVisualHullPointInside(hull, 0, 0, 0), -1, "closing ODE");
  CHECK_REFUSED(dGeomVisualHullUpdate(hull), 0, "closing ODE");
  CHECK(dGeomVisualHullDataUpdate(data, 2));
  dCloseVisualHull();
  dCloseODE();

  /* A hull that outlives ODE's closing has no contacts, also when the class gets the same number again. */
  CHECK(dInitODE2(0));
  CHECK(dInitVisualHull());
  hull = dCreateVisualHull(0, data);
  dCloseODE();
  dCloseODE();
  CHECK(dInitODE2(0));
  CHECK(dInitVisualHull());
  {
    dContactGeom contact;
    dGeomID ball = dCreateSphere(0, 0.1);
    CHECK(dGeomGetClass(hull) == dGetVisualHullClass());
    CHECK(dCollide(hull, ball, 1, &contact, sizeof contact) == 0);
    dGeomDestroy(ball);
  }
  dGeomDestroy(hull);
  a_hull_collides();
  dCloseVisualHull();
  dCloseVisualHull();
  dCloseODE();

  /* The program closes ODE once too often, and opens it again before the class has noticed. */
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

  /* The class is closed after the program has opened ODE again. It must not release the program's reference. */
  CHECK(dInitODE2(0));
  CHECK(dInitVisualHull());
  dCloseODE();
  dCloseODE();
  CHECK(dInitODE2(0));
  dCloseVisualHull();
  CHECK(dAllocateODEDataForThread(dAllocateMaskAll)); /* aborts if ODE is closed */
  dCloseODE();
  dGeomVisualHullDataDestroy(data);
}

int main(void) {
  opening_the_class_again_and_again_takes_one_entry_of_the_table();
  a_full_table_gives_an_error_instead_of_an_abort();
  the_class_keeps_ode_open();
  opening_the_class_again_and_again_takes_one_entry_of_the_table();
  closing_ode_once_too_often_closes_the_class_with_it();
  return 0;
}
