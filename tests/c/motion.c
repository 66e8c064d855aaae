/* A hull that moves between its frames pushes bodies at its own speed and carries them along. */
#include "check.h"
#include "scene.h"

#include <math.h>

#pragma GCC diagnostic ignored "-Wdeprecated-declarations"

/* Three cameras, 40 m away along y, x and z and so nearly parallel, see 100 pixels a metre around the origin. They and
   the simulation are slow, since valgrind runs this too: 20 frames and 120 steps a second. */
enum { CAMERAS = 3, COLUMNS = 160, ROWS = 120 };
#define DISTANCE 40.0
#define RESOLUTION 100.0
#define PERIOD 0.05
#define STEP (1.0 / 120)

/* A cuboid subject, and how it moves from time 0 on. */
typedef struct {
  dReal half[3], start[3], velocity[3];
} Subject;

static dReal place(const Subject *subject, int axis, dReal time) {
  return subject->start[axis] + subject->velocity[axis] * (time > 0 ? time : 0);
}

static dVisualHullDataID new_data(void) {
  const dReal f = RESOLUTION * DISTANCE, u = COLUMNS / 2, v = ROWS / 2, d = DISTANCE;
  const dReal bounds[6] = {-0.8, 0.8, -0.6, 0.6, -0.6, 0.6};
  const dReal P[CAMERAS][12] = {{f, u, 0, u * d, 0, v, -f, v * d, 0, 1, 0, d},
                                {-u, f, 0, u * d, -v, 0, -f, v * d, -1, 0, 0, d},
                                {f, 0, -u, u * d, 0, -f, -v, v * d, 0, 0, -1, d}};
  dVisualHullDataID data = dGeomVisualHullDataCreate();
  int view;

  for (view = 0; view < CAMERAS; view++) CHECK(dGeomVisualHullDataAddView(data, P[view], COLUMNS, ROWS) == view);
  CHECK(dGeomVisualHullDataSetBounds(data, bounds));
  return data;
}

/* The part of the pixel from `first` to `first + 1` that lies between `low` and `high`. */
static dReal covered(int first, dReal low, dReal high) {
  const dReal from = low > first ? low : first, to = high < first + 1 ? high : first + 1;
  return to > from ? to - from : 0;
}

/* Publishes the frame of `time`: rectangles. */
static void film(dVisualHullDataID data, const Subject *subject, dReal time) {
  static const int across[CAMERAS] = {0, 1, 0}, up[CAMERAS] = {2, 2, 1};
  static unsigned char mask[ROWS * COLUMNS];
  int view, row, column;

  for (view = 0; view < CAMERAS; view++) {
    const int a = across[view], b = up[view];
    const dReal u = COLUMNS / 2 + RESOLUTION * place(subject, a, time), half_u = RESOLUTION * subject->half[a];
    const dReal v = ROWS / 2 - RESOLUTION * place(subject, b, time), half_v = RESOLUTION * subject->half[b];
    for (row = 0; row < ROWS; row++)
      for (column = 0; column < COLUMNS; column++)
        mask[row * COLUMNS + column] = (unsigned char)(255 * covered(column, u - half_u, u + half_u) *
                                                     covered(row, v - half_v, v + half_v));
    CHECK(dGeomVisualHullDataSetMask(data, view, mask, COLUMNS));
  }
  CHECK(dGeomVisualHullDataPublish(data, time));
}

/* A board that moves along x at 1 m/s, 5 pixels a frame. */
static const Subject BOARD = {{0.02, 0.15, 0.15}, {-0.22, 0, 0}, {1, 0, 0}};

/* A cube that moves along all axes and is at the origin after three frames. */
static const Subject CUBE = {{0.15, 0.15, 0.15}, {-0.075, -0.06, 0.045}, {0.5, 0.4, -0.3}};

/* The place along x at which the hull's front ends. */
static dReal front(dGeomID hull) {
  dReal inside = dGeomGetPosition(hull)[0] - 0.7, outside = 0.7;
  while (dGeomVisualHullPointInside(hull, inside, 0, 0) != 1) CHECK((inside += 0.02) < outside);
  while (outside - inside > 1e-5) {
    const dReal middle = (inside + outside) / 2;
    if (dGeomVisualHullPointInside(hull, middle, 0, 0) == 1) inside = middle;
    else outside = middle;
  }
  return inside;
}

static void each_mode_shows_the_hull_at_its_time(void) {
  const dReal last = 3 * PERIOD, time = last + 0.4 * PERIOD, pixel = 1 / RESOLUTION;
  dVisualHullDataID data = new_data();
  dGeomID hull = dCreateVisualHull(0, data);
  dVector3 v;
  int frame;

  for (frame = 0; frame < 4; frame++) film(data, &BOARD, frame * PERIOD);
  /* The front is known to a pixel, of 10 mm; from one mode to another it is 20 mm at least. */
  CHECK(dGeomVisualHullSetTime(hull, time) == 1);
  CHECK(fabs(front(hull) - place(&BOARD, 0, last) - 0.02) < pixel);
  CHECK(dGeomVisualHullPointVelocity(hull, front(hull), 0, 0, v) == 0 && v[0] == 0 && v[1] == 0 && v[2] == 0);

  dGeomVisualHullSetMotion(hull, dVisualHullMotionInterpolated);
  CHECK(dGeomVisualHullSetTime(hull, time) == 1);
  CHECK(fabs(front(hull) - place(&BOARD, 0, time - PERIOD) - 0.02) < pixel);

  dGeomVisualHullSetMotion(hull, dVisualHullMotionPredicted);
  CHECK(dGeomVisualHullSetTime(hull, time) == 1);
  CHECK(fabs(front(hull) - place(&BOARD, 0, time) - 0.02) < pixel);

  /* Velocities from masks without noise are wrong by less than a tenth. */
  CHECK(dGeomVisualHullPointVelocity(hull, front(hull), 0, 0, v) == 1);
  CHECK(fabs(v[0] - 1) < 0.1 && fabs(v[1]) < 0.1 && fabs(v[2]) < 0.1);
  CHECK(dGeomVisualHullPointVelocity(hull, 0.7, 0.5, 0.5, v) == 0 && v[0] == 0 && v[1] == 0 && v[2] == 0);

  /* The geom's pose turns the velocity, too. */
  {
    dMatrix3 R;
    dRFromAxisAndAngle(R, 0, 0, 1, M_PI / 2);
    dGeomSetRotation(hull, R);
    CHECK(dGeomVisualHullPointVelocity(hull, 0, place(&BOARD, 0, time) + 0.02, 0, v) == 1);
    CHECK(fabs(v[0]) < 0.1 && fabs(v[1] - 1) < 0.1);
  }
  dGeomDestroy(hull);
  dGeomVisualHullDataDestroy(data);
}

/* What the near callback needs. */
typedef struct {
  dWorldID world;
  dJointGroupID joints;
  dReal friction; /* of the hull; other contacts have none */
  int carries;    /* whether contacts carry the surface's velocity */
} Scene;

static void near_hull(void *data, dGeomID o1, dGeomID o2) {
  const Scene *scene = (const Scene *)data;
  const int has_hull = dGeomGetClass(o1) == dGetVisualHullClass() || dGeomGetClass(o2) == dGetVisualHullClass();
  dContact contact[8];
  const int n = dCollide(o1, o2, 8, &contact[0].geom, sizeof(dContact));
  int k;

  for (k = 0; k < n; k++) {
    contact[k].surface.mode = dContactApprox1;
    contact[k].surface.mu = has_hull ? scene->friction : 0;
    if (scene->carries) {
      const int is_filled = dVisualHullSetContactMotion(&contact[k], STEP);
      CHECK(is_filled == 0 || (is_filled == 1 && has_hull));
    }
    dJointAttach(dJointCreateContact(scene->world, scene->joints, &contact[k]), dGeomGetBody(o1), dGeomGetBody(o2));
  }
}

/* How a simulation of a cube of 0.2 m ended. */
typedef struct {
  dReal x, speed, shown; /* the cube's place and speed; the subject's place when the cameras saw what the hull shows */
} Outcome;

/* Simulates the subject, which begins to move at 0.1 s, and the cube until the time `end`. */
static Outcome simulate(const Subject *subject, dReal cube_x, dReal cube_z, dReal floor_z, int carries, dReal end) {
  dVisualHullDataID data = new_data();
  dSpaceID space = dHashSpaceCreate(0);
  const dReal start = 0.1;
  Outcome outcome;
  Scene scene;
  dGeomID hull, cube;
  int step, frame = 0;

  scene.world = table_world(), scene.joints = dJointGroupCreate(0);
  scene.friction = 0.8, scene.carries = carries;
  dWorldSetERP(scene.world, 0.05); /* docs/c.md recommends it for contacts that carry velocity */
  dRandSetSeed(1);
  dCreatePlane(space, 0, 0, 1, floor_z);
  hull = dCreateVisualHull(space, data);
  dGeomVisualHullSetMotion(hull, dVisualHullMotionInterpolated);
  cube = add_cube(scene.world, space, cube_x, 0, cube_z);

  for (step = 0; step * STEP < end; step++) {
    const dReal time = step * STEP;
    for (; frame * PERIOD < time + 1e-9; frame++) {
      Subject shifted = *subject;
      int axis;
      for (axis = 0; axis < 3; axis++) shifted.start[axis] = place(subject, axis, frame * PERIOD - start);
      shifted.velocity[0] = shifted.velocity[1] = shifted.velocity[2] = 0;
      film(data, &shifted, frame * PERIOD);
    }
    CHECK(dGeomVisualHullSetTime(hull, time) == 1);
    dSpaceCollide(space, &scene, near_hull);
    dWorldQuickStep(scene.world, STEP);
    dJointGroupEmpty(scene.joints);
    outcome.shown = place(subject, 0, time - PERIOD - start);
  }

  outcome.x = dGeomGetPosition(cube)[0];
  outcome.speed = dBodyGetLinearVel(dGeomGetBody(cube))[0];
  dJointGroupDestroy(scene.joints);
  dSpaceDestroy(space);
  dWorldDestroy(scene.world);
  dGeomVisualHullDataDestroy(data);
  return outcome;
}

static void a_board_pushes_a_cube_at_its_own_speed(void) {
  const Outcome pushed = simulate(&BOARD, 0, 0, -0.1, 1, 0.38);
  /* At the first touch the board is at most a step's way deep, of which the ERP of 0.05 corrects a twentieth in the
     next step: that adds at most a twentieth of the speed. The velocity itself is wrong by up to 3%. */
  CHECK(pushed.speed > 0.97 && pushed.speed < 1.08);
}

static void a_tray_carries_a_cube_by_the_velocity_of_its_surface(void) {
  const dReal top = 0.1 - 0.0005; /* in the surface layer, so that it does not fall */
  const Subject tray = {{0.2, 0.2, 0.02}, {-0.2, 0, -0.02}, {0.5, 0, 0}};
  const Outcome carried = simulate(&tray, -0.2, top, -0.3, 1, 0.4), left = simulate(&tray, -0.2, top, -0.3, 0, 0.3);

  /* Friction gives it the tray's speed after 0.06 s, and the velocity is at most that of 0.05 s ago, a tenth of a second's
     mean. So it falls back by 0.016 and 0.025 m at most. From 0.31 s on its speed is the tray's, up to errors of 3%. */
  CHECK(fabs(carried.speed - 0.5) < 0.03 * 0.5);
  CHECK(carried.x < carried.shown && carried.x > carried.shown - 0.041);
  /* A static geom whose top stays in place gives no force along it. */
  CHECK(fabs(left.x + 0.2) < 0.001);
}

/* A hull of the data's cube, as it is at the origin. */
static dGeomID moving_cube(dVisualHullDataID data) {
  dGeomID hull = dCreateVisualHull(0, data);
  dGeomVisualHullSetMotion(hull, dVisualHullMotionPredicted);
  CHECK(dGeomVisualHullSetTime(hull, 3 * PERIOD) == 1);
  return hull;
}

/* The contact of two geoms that sticks and has no error correction. */
static dContact sticky_contact(dGeomID g1, dGeomID g2) {
  dContact contact;
  memset(&contact, 0, sizeof contact);
  CHECK(dCollide(g1, g2, 1, &contact.geom, sizeof contact) == 1);
  CHECK(contact.geom.g1 == g1 && contact.geom.g2 == g2);
  contact.surface.mode = dContactSoftERP | dContactSoftCFM;
  contact.surface.mu = dInfinity;
  return contact;
}

/* The velocity of the hull's surface at a contact. */
static int velocity_at(dGeomID hull, const dContact *contact, dVector3 v) {
  const dReal *p = contact->geom.pos;
  return dGeomVisualHullPointVelocity(hull, p[0], p[1], p[2], v);
}

/* The velocity that a body at rest has at a contact after one step with it. */
static void velocity_after_a_step(dWorldID world, dBodyID body, const dContact *contact, dVector3 v) {
  dJointGroupID joints = dJointGroupCreate(0);
  const dReal *linear, *angular;
  dVector3 arm;
  int k;

  dBodySetLinearVel(body, 0, 0, 0), dBodySetAngularVel(body, 0, 0, 0);
  for (k = 0; k < 3; k++) arm[k] = contact->geom.pos[k] - dBodyGetPosition(body)[k];
  dJointAttach(dJointCreateContact(world, joints, contact), dGeomGetBody(contact->geom.g1),
               dGeomGetBody(contact->geom.g2));
  dWorldStep(world, STEP);
  linear = dBodyGetLinearVel(body), angular = dBodyGetAngularVel(body);
  dCalcVectorCross3(v, angular, arm);
  for (k = 0; k < 3; k++) v[k] += linear[k];
  dJointGroupDestroy(joints);
}

static void any_order_and_friction_direction_gives_the_velocity_of_the_surface(dVisualHullDataID data) {
  /* None, usable ones, and ones without a part along the surface, whose normal is along x. */
  const dVector3 directions[8] = {{0, 0, 0}, {0, 1, 0},   {5, 0, -2},  {0, 0, 0},
                                  {3, 0, 0}, {NAN, 0, 1}, {0, INFINITY, 0}, {0, 1e-300, 0}};
  dWorldID world = dWorldCreate();
  dGeomID hull = moving_cube(data), box = add_cube(world, 0, 0, 0, 0);
  dBodyID body = dGeomGetBody(box);
  int order, k, axis;

  dWorldSetCFM(world, 0);
  for (order = 0; order < 2; order++)
    for (k = 0; k < 8; k++) {
      dVector3 surface, v;
      dContact contact;
      dMatrix3 upright;
      dReal depth;

      dRSetIdentity(upright), dBodySetRotation(body, upright);
      dBodySetPosition(body, 0.25 - 0.02, 0, 0);
      contact = order ? sticky_contact(box, hull) : sticky_contact(hull, box);
      if (k > 0) contact.surface.mode |= dContactFDir1;
      memcpy(contact.fdir1, directions[k], sizeof contact.fdir1);
      depth = contact.geom.depth;
      CHECK(dVisualHullSetContactMotion(&contact, STEP) == 1);

      /* The contact is complete and otherwise as it was. */
      CHECK(contact.surface.mode == (dContactSoftERP | dContactSoftCFM | dContactFDir1 | dContactMotion1 |
                                     dContactMotion2 | dContactMotionN));
      CHECK(contact.surface.mu == dInfinity && contact.surface.soft_erp == 0 && contact.surface.soft_cfm == 0);
      CHECK(fabs(dCalcVectorLength3(contact.fdir1) - 1) < 1e-9);
      CHECK(fabs(dCalcVectorDot3(contact.fdir1, contact.geom.normal)) < 1e-9);
      if (k == 1) CHECK(contact.fdir1[1] > 0.99);
      if (k == 2) CHECK(contact.fdir1[2] < -0.99);

      /* It is deeper than the 8 mm over which the box takes on the speed; twice that is not corrected, and the rest at a
         tenth of the surface's speed at most. */
      CHECK(depth - contact.geom.depth > 0.016 - 1e-12 && contact.geom.depth > 0);
      CHECK(velocity_at(hull, &contact, surface) == 1);
      CHECK(contact.geom.depth * dWorldGetERP(world) / STEP < 0.1 * dCalcVectorLength3(surface) + 1e-9);

      /* ODE solves the contact's three equations exactly, up to rounding. */
      velocity_after_a_step(world, body, &contact, v);
      for (axis = 0; axis < 3; axis++) CHECK(fabs(v[axis] - surface[axis]) < 1e-9);
      for (axis = 0; axis < 3; axis++) CHECK(fabs(v[axis] - CUBE.velocity[axis]) < 0.1);
    }

  dGeomDestroy(hull), dGeomDestroy(box);
  dWorldDestroy(world);
}

static void the_friction_direction_follows_the_slip_that_the_step_brings(dVisualHullDataID data) {
  dWorldID world = dWorldCreate();
  dGeomID hull = moving_cube(data), box = add_cube(world, 0, 0.25 - 0.005, 0, 0);
  dBodyID body = dGeomGetBody(box);
  dContact contact = sticky_contact(hull, box);
  dVector3 surface;

  /* The body moves as the surface does along y, and gravity along z is all of its slip. */
  CHECK(velocity_at(hull, &contact, surface) == 1);
  dBodySetLinearVel(body, 0, surface[1], surface[2]);
  dWorldSetGravity(world, 0, 0, -9.81);
  CHECK(dVisualHullSetContactMotion(&contact, STEP) == 1);
  /* The normal is along x to some thousandths. */
  CHECK(contact.fdir1[2] < -0.99);

  /* A force along y that is much larger. */
  contact = sticky_contact(hull, box);
  dBodyAddForce(body, 0, 500, 0);
  CHECK(dVisualHullSetContactMotion(&contact, STEP) == 1);
  CHECK(contact.fdir1[1] > 0.99);

  dGeomDestroy(hull), dGeomDestroy(box);
  dWorldDestroy(world);
}

static void contacts_without_a_known_velocity_get_a_friction_direction_at_most(dVisualHullDataID data) {
  dGeomID hull = moving_cube(data), box = dCreateBox(0, 0.2, 0.2, 0.2), other = dCreateBox(0, 0.2, 0.2, 0.2);
  dGeomID outer = dCreateGeomTransform(0);
  dContact contact, before;

  /* Two geoms of other classes, and a hull that is held. */
  contact = before = sticky_contact(box, other);
  CHECK(dVisualHullSetContactMotion(&contact, STEP) == 0 && memcmp(&contact, &before, sizeof contact) == 0);
  dGeomSetPosition(box, 0.25 - 0.005, 0, 0);
  dGeomVisualHullSetMotion(hull, dVisualHullMotionHeld);
  contact = before = sticky_contact(box, hull);
  CHECK(dVisualHullSetContactMotion(&contact, STEP) == 0 && memcmp(&contact, &before, sizeof contact) == 0);

  /* A body's geom inside a transform has a velocity; a hull inside one has none, since its place is not known. */
  dGeomVisualHullSetMotion(hull, dVisualHullMotionPredicted);
  dGeomSetPosition(box, 0, 0, 0);
  dGeomTransformSetGeom(outer, box);
  dGeomSetPosition(outer, 0.25 - 0.005, 0, 0);
  memset(&contact, 0, sizeof contact);
  CHECK(dCollide(outer, hull, 1, &contact.geom, sizeof contact) == 1 && contact.geom.g1 == box);
  CHECK(dVisualHullSetContactMotion(&contact, STEP) == 1);
  dGeomTransformSetGeom(outer, hull);
  dGeomSetPosition(box, 0.49, 0, 0);
  memset(&contact, 0, sizeof contact);
  CHECK(dCollide(outer, box, 1, &contact.geom, sizeof contact) == 1 && contact.geom.g1 == hull);
  before = contact;
  CHECK(dVisualHullSetContactMotion(&contact, STEP) == 0 && memcmp(&contact, &before, sizeof contact) == 0);

  dGeomDestroy(outer), dGeomDestroy(hull), dGeomDestroy(box), dGeomDestroy(other);
}

static void friction_is_along_the_slip_of_any_two_geoms(void) {
  dWorldID world = dWorldCreate();
  dGeomID plane = dCreatePlane(0, 0, 0, 1, 0), box = add_cube(world, 0, 0, 0, 0);
  dBodyID body = dGeomGetBody(box);
  dContact contact, before;

  dBodySetPosition(body, 0, 0, 0.1 - 0.001);
  contact = before = sticky_contact(box, plane);
  CHECK(dVisualHullSetContactFriction(&contact, STEP) == 0 && memcmp(&contact, &before, sizeof contact) == 0);
  dBodySetLinearVel(body, 0.3, -0.4, 5);
  CHECK(dVisualHullSetContactFriction(&contact, STEP) == 1);
  CHECK(contact.surface.mode == (before.surface.mode | dContactFDir1));
  CHECK(fabs(contact.fdir1[0] - 0.6) < 1e-9 && fabs(contact.fdir1[1] + 0.8) < 1e-9 && fabs(contact.fdir1[2]) < 1e-9);

  /* A direction that the program has chosen is kept. */
  before = contact;
  dBodySetLinearVel(body, 1, 0, 0);
  CHECK(dVisualHullSetContactFriction(&contact, STEP) == 0 && memcmp(&contact, &before, sizeof contact) == 0);

  dGeomDestroy(plane), dGeomDestroy(box);
  dWorldDestroy(world);
}

int main(void) {
  dVisualHullDataID data;
  int frame;

  CHECK(dInitODE2(0) && dInitVisualHull());
  each_mode_shows_the_hull_at_its_time();
  a_board_pushes_a_cube_at_its_own_speed();
  a_tray_carries_a_cube_by_the_velocity_of_its_surface();

  data = new_data();
  for (frame = 0; frame < 4; frame++) film(data, &CUBE, frame * PERIOD);
  any_order_and_friction_direction_gives_the_velocity_of_the_surface(data);
  the_friction_direction_follows_the_slip_that_the_step_brings(data);
  contacts_without_a_known_velocity_get_a_friction_direction_at_most(data);
  friction_is_along_the_slip_of_any_two_geoms();
  dGeomVisualHullDataDestroy(data);
  dCloseVisualHull();
  dCloseODE();
  return 0;
}
