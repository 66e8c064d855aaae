/* A cube that touches a held hull sticks to it until it is released: the paper's button. */
#include "check.h"
#include "scene.h"

#include <math.h>

/* Three cameras, 40 m away along y, x and z and so nearly parallel, see 100 pixels a metre around the origin. They and
   the simulation are slow, since valgrind runs this too: 20 frames and 120 steps a second. */
enum { CAMERAS = 3, COLUMNS = 160, ROWS = 120 };
#define DISTANCE 40.0
#define RESOLUTION 100.0
#define PERIOD 0.05
#define STEP (1.0 / 120)

/* The subject is a cuboid that moves at this velocity from START seconds on. */
#define START 0.1
static const dReal HALF[3] = {0.08, 0.06, 0.05}, PLACE[3] = {-0.1, 0.05, -0.1}, VELOCITY[3] = {0.5, -0.3, 0.3};

static dReal place(int axis, dReal time) { return PLACE[axis] + VELOCITY[axis] * (time > START ? time - START : 0); }

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
static void film(dVisualHullDataID data, dReal time) {
  static const int across[CAMERAS] = {0, 1, 0}, up[CAMERAS] = {2, 2, 1};
  static unsigned char mask[ROWS * COLUMNS];
  int view, row, column;

  for (view = 0; view < CAMERAS; view++) {
    const int a = across[view], b = up[view];
    const dReal u = COLUMNS / 2 + RESOLUTION * place(a, time), half_u = RESOLUTION * HALF[a];
    const dReal v = ROWS / 2 - RESOLUTION * place(b, time), half_v = RESOLUTION * HALF[b];
    for (row = 0; row < ROWS; row++)
      for (column = 0; column < COLUMNS; column++)
        mask[row * COLUMNS + column] = (unsigned char)(255 * covered(column, u - half_u, u + half_u) *
                                                     covered(row, v - half_v, v + half_v));
    CHECK(dGeomVisualHullDataSetMask(data, view, mask, COLUMNS));
  }
  CHECK(dGeomVisualHullDataPublish(data, time));
}

/* Counts the contacts of all pairs. */
static void count_contacts(void *count, dGeomID o1, dGeomID o2) {
  dContactGeom contacts[8];
  *(int *)count += dCollide(o1, o2, 8, contacts, sizeof contacts[0]);
}

/* A hull that moves, and a cube that lies on it. */
typedef struct {
  dVisualHullDataID data;
  dWorldID world;
  dSpaceID space;
  dGeomID hull, cube;
  dReal time;
  int frame;
} Scene;

static Scene new_scene(void) {
  Scene scene;
  scene.data = new_data(), scene.world = table_world(), scene.space = dHashSpaceCreate(0);
  scene.hull = dCreateVisualHull(scene.space, scene.data);
  dGeomVisualHullSetMotion(scene.hull, dVisualHullMotionInterpolated);
  /* 3 mm deep in the subject, on its top. */
  scene.cube = add_cube(scene.world, scene.space, PLACE[0], PLACE[1], PLACE[2] + HALF[2] + 0.1 - 0.003);
  scene.time = 0, scene.frame = 0;
  return scene;
}

static void destroy_scene(Scene *scene) {
  dSpaceDestroy(scene->space);
  dWorldDestroy(scene->world);
  dGeomVisualHullDataDestroy(scene->data);
}

/* Shows the hull at the scene's time, and returns how many contacts a collide finds then. */
static int collide(Scene *scene) {
  int count = 0;
  for (; scene->frame * PERIOD < scene->time + 1e-9; scene->frame++) film(scene->data, scene->frame * PERIOD);
  CHECK(dGeomVisualHullSetTime(scene->hull, scene->time) == 1);
  dSpaceCollide(scene->space, &count, count_contacts);
  return count;
}

/* Steps up to a time, without a contact. */
static void carry_to(Scene *scene, dReal end) {
  for (; scene->time < end - 1e-9; scene->time += STEP) {
    CHECK(collide(scene) == 0);
    dWorldQuickStep(scene->world, STEP);
  }
}

static void a_held_cube_moves_with_the_subject_and_leaves_at_its_velocity(void) {
  Scene scene = new_scene();
  dBodyID body = dGeomGetBody(scene.cube);
  const dReal *velocity;
  int axis;

  CHECK(dGeomVisualHullHold(scene.hull, 1) == 1);
  CHECK(dGeomVisualHullHold(scene.hull, 1) == 1);
  carry_to(&scene, 0.6);
  /* The subject's edges are known to half a pixel, of 10 mm, and it turns by as much: the cube's middle is twice as far from the
     contact as they are apart. The hull is a period late. */
  for (axis = 0; axis < 2; axis++)
    CHECK(fabs(dBodyGetPosition(body)[axis] - place(axis, scene.time - PERIOD)) < 1 / RESOLUTION);
  CHECK(fabs(dBodyGetPosition(body)[2] - place(2, scene.time - PERIOD) - HALF[2] - 0.097) < 1 / RESOLUTION);

  CHECK(dGeomVisualHullHold(scene.hull, 0) == 1);
  CHECK(collide(&scene) > 0);
  velocity = dBodyGetLinearVel(body);
  /* A pixel in a period. */
  for (axis = 0; axis < 3; axis++) CHECK(fabs(velocity[axis] - VELOCITY[axis]) < 1 / RESOLUTION / PERIOD);
  destroy_scene(&scene);
}

static void other_data_release_the_cube(void) {
  Scene scene = new_scene();
  dVisualHullDataID other = new_data();

  CHECK(dGeomVisualHullHold(scene.hull, 1) == 1);
  carry_to(&scene, 0.05);
  film(other, 0);
  dGeomVisualHullSetData(scene.hull, other);
  CHECK(collide(&scene) > 0);
  destroy_scene(&scene);
  dGeomVisualHullDataDestroy(other);
}

static void a_cube_that_is_destroyed_or_moved_away_is_forgotten(void) {
  Scene scene = new_scene();
  CHECK(dGeomVisualHullHold(scene.hull, 1) == 1);
  carry_to(&scene, 0.05);
  /* Beside the subject, where it does not touch. */
  dBodySetPosition(dGeomGetBody(scene.cube), PLACE[0] + 0.15, PLACE[1], PLACE[2] + HALF[2] + 0.15);
  forget_message();
  CHECK(collide(&scene) == 0);
  CHECK_MESSAGE("it was moved, or is another body");

  dBodySetPosition(dGeomGetBody(scene.cube), PLACE[0], PLACE[1], PLACE[2] + HALF[2] + 0.1 - 0.003);
  carry_to(&scene, 0.1);
  dBodyDestroy(dGeomGetBody(scene.cube));
  dGeomDestroy(scene.cube);
  carry_to(&scene, 0.4);
  destroy_scene(&scene);
}

static void only_a_hull_is_held(void) {
  dGeomID sphere = dCreateSphere(0, 1);
  CHECK_REFUSED(dGeomVisualHullHold(0, 1), 0, "expected a visual hull, found NULL");
  CHECK_REFUSED(dGeomVisualHullHold(sphere, 1), 0, "expected a visual hull, found a geom of another class");
  dGeomDestroy(sphere);
}

int main(void) {
  CHECK(dInitODE2(0) && dInitVisualHull());
  a_held_cube_moves_with_the_subject_and_leaves_at_its_velocity();
  other_data_release_the_cube();
  a_cube_that_is_destroyed_or_moved_away_is_forgotten();
  only_a_hull_is_held();
  dCloseVisualHull();
  dCloseODE();
  return 0;
}
