/* Bodies that sleep on a hull wake when the hull at them changes, whatever has changed it and however many they are. */
#include "check.h"
#include "scene.h"

#include <math.h>

enum { SIDE = 33, MANY = SIDE * SIDE };

static Contacts contacts;
static dSpaceID space;
static dVisualHullDataID data;
static dGeomID hull;

static void begin(void) {
  contacts.world = table_world(), contacts.joints = dJointGroupCreate(0), contacts.calls = 0;
  dWorldSetAutoDisableFlag(contacts.world, 1);
  dRandSetSeed(1);
  space = dHashSpaceCreate(0);
  data = table_data();
  hull = dCreateVisualHull(space, data);
}

static void end(void) {
  dJointGroupDestroy(contacts.joints);
  dSpaceDestroy(space);
  dWorldDestroy(contacts.world);
  dGeomVisualHullDataDestroy(data);
}

static void steps(int count) {
  while (count-- > 0) step(&contacts, space);
}

static void show(dReal lift, dReal time) {
  show_table(data, lift);
  CHECK(dGeomVisualHullDataUpdate(data, time));
}

/* A cube of 0.2 m that sleeps at the centre of the table. */
static dBodyID sleeping_cube(void) {
  dBodyID body = dGeomGetBody(add_cube(contacts.world, space, 0, 0, TOP + 0.101));
  int k;
  for (k = 0; k < 400 && dBodyIsEnabled(body); k++) steps(1);
  CHECK(!dBodyIsEnabled(body));
  return body;
}

static void more_bodies_than_a_step_has_pairs_in_any_table_wake(void) {
  static dBodyID bodies[MANY];
  const dReal half = 0.004, pitch = 0.46 / SIDE;
  int k;
  begin();
  for (k = 0; k < MANY; k++) {
    dMass mass;
    bodies[k] = dBodyCreate(contacts.world);
    dMassSetBoxTotal(&mass, 0.01, 2 * half, 2 * half, 2 * half);
    dBodySetMass(bodies[k], &mass);
    dGeomSetBody(dCreateBox(space, 2 * half, 2 * half, 2 * half), bodies[k]);
    dBodySetPosition(bodies[k], -0.23 + pitch * (k % SIDE + 0.5), -0.23 + pitch * (k / SIDE + 0.5), TOP + half - 0.0005);
  }
  /* The few that would still move are put to sleep where they touch. */
  steps(1);
  for (k = 0; k < MANY; k++) dBodyDisable(bodies[k]);
  steps(1);
  for (k = 0; k < MANY; k++) CHECK(!dBodyIsEnabled(bodies[k]));

  show(-0.05, 1);
  steps(2);
  for (k = 0; k < MANY; k++) CHECK(dBodyIsEnabled(bodies[k]));
  end();
}

static void a_body_that_the_hull_touches_first_in_its_sleep_wakes(void) {
  dGeomID shelf;
  dBodyID body;
  int k;
  begin();
  shelf = dCreateBox(space, 0.3, 0.6, 0.02);
  dGeomSetPosition(shelf, 0.40, 0, 0.45);
  body = dGeomGetBody(add_cube(contacts.world, space, 0.33, 0, 0.561));
  for (k = 0; k < 400 && dBodyIsEnabled(body); k++) steps(1);
  CHECK(!dBodyIsEnabled(body));
  show(0.3, 1);
  steps(2);
  CHECK(dBodyIsEnabled(body));
  end();
}

/* ODE itself wakes nothing here: its static geoms may leave a body in the air. */
static void a_hull_that_the_program_moves_wakes_what_lay_on_it(void) {
  dBodyID body;
  begin();
  body = sleeping_cube();
  dGeomSetPosition(hull, 5, 0, 0);
  steps(2);
  CHECK(dBodyIsEnabled(body));

  /* A hull that comes back under it in small steps. */
  end(), begin();
  body = sleeping_cube();
  dGeomSetPosition(hull, 0, 0, -0.004), steps(1);
  dGeomSetPosition(hull, 0, 0, -0.008), steps(1);
  dGeomSetPosition(hull, 0, 0, -0.012), steps(1);
  CHECK(dBodyIsEnabled(body));
  end();
}

static void data_that_is_exchanged_wakes_what_lay_on_the_hull(void) {
  dVisualHullDataID other;
  dBodyID body;
  begin();
  body = sleeping_cube();
  other = table_data();
  show_table(other, -0.1);
  CHECK(dGeomVisualHullDataUpdate(other, 1));
  dGeomVisualHullSetData(hull, other);
  steps(2);
  CHECK(dBodyIsEnabled(body));
  dGeomVisualHullDataDestroy(other);
  end();
}

static void frames_that_no_collide_has_seen_are_not_lost(void) {
  dBodyID body;
  int k;
  begin();
  body = sleeping_cube();
  /* Queries by the program itself between the frames do not count as collides of the space. */
  for (k = 1; k < 5; k++) {
    dContactGeom contact;
    dGeomID probe = dCreateSphere(0, 0.1);
    show(-0.05 * k, k);
    dCollide(hull, probe, 1, &contact, sizeof contact);
    dGeomDestroy(probe);
  }
  steps(2);
  CHECK(dBodyIsEnabled(body));
  end();
}

static void a_body_sleeps_on_while_the_hull_stays(void) {
  dBodyID body;
  int k;
  begin();
  body = sleeping_cube();
  for (k = 1; k < 30; k++) show(0.001 * (k % 2), k), steps(1);
  CHECK(!dBodyIsEnabled(body));
  dGeomVisualHullSetMaxDepth(hull, 0.002); /* a limit below a pixel does not hide that the hull has gone */
  show(-0.05, 100);
  steps(2);
  CHECK(dBodyIsEnabled(body));
  end();
}

/* ODE 0.16's hash space overlooks pairs of boxes of 0.5 to 1 unit that cross z = 0 near the origin. */
static void a_hash_space_finds_every_pair_of_a_hull(void) {
  int k;
  begin();
  for (k = 0; k < 8; k++) {
    const dReal x = k & 1 ? 0.1 : -0.1, y = k & 2 ? 0.1 : -0.1, z = k & 4 ? 0.1 : -0.1;
    dGeomID ball = dCreateSphere(space, 0.01);
    dGeomSetPosition(ball, x, y, z);
    contacts.calls = 0;
    steps(1);
    CHECK(contacts.calls == 1);
    dGeomDestroy(ball);
  }
  end();
}

int main(void) {
  CHECK(dInitODE2(0) && dInitVisualHull());
  more_bodies_than_a_step_has_pairs_in_any_table_wake();
  a_body_that_the_hull_touches_first_in_its_sleep_wakes();
  a_hull_that_the_program_moves_wakes_what_lay_on_it();
  data_that_is_exchanged_wakes_what_lay_on_the_hull();
  frames_that_no_collide_has_seen_are_not_lost();
  a_body_sleeps_on_while_the_hull_stays();
  a_hash_space_finds_every_pair_of_a_hull();
  dCloseVisualHull();
  dCloseODE();
  return 0;
}
