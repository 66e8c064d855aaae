/* What an ODE program does with any geom, it may do with a hull. */
#include "check.h"
#include "scene.h"

#include <math.h>

/* dGeomTransform is, but programs have it. */
#pragma GCC diagnostic ignored "-Wdeprecated-declarations"

static dWorldID world;
static dVisualHullDataID data;

/* A cube whose base is 4 mm deep in the table. */
static dGeomID sunk_cube(dSpaceID space) { return add_cube(world, space, 0, 0, TOP + 0.096); }

static void dispose(dGeomID geom) {
  if (dGeomGetBody(geom)) dBodyDestroy(dGeomGetBody(geom));
  dGeomDestroy(geom);
}

static int calls_in(dSpaceID space) {
  Contacts contacts;
  contacts.world = world;
  contacts.joints = dJointGroupCreate(0);
  contacts.calls = 0;
  dSpaceCollide(space, &contacts, near_callback);
  dJointGroupDestroy(contacts.joints);
  return contacts.calls;
}

static void geoms_are_destroyed_as_any_other(void) {
  dGeomID hull = dCreateVisualHull(0, data);
  dSpaceID space;
  dGeomDestroy(hull);
  CHECK_REFUSED(dGeomVisualHullPointInside(hull, 0, 0, 0), -1, "destroyed");
  space = dSimpleSpaceCreate(0);
  dSpaceSetCleanup(space, 1);
  hull = dCreateVisualHull(space, data);
  CHECK(dGeomVisualHullPointInside(hull, 0, 0, 0) == 1);
  dSpaceDestroy(space);
  CHECK_REFUSED(dGeomVisualHullPointInside(hull, 0, 0, 0), -1, "destroyed");
  space = dSimpleSpaceCreate(0);
  dSpaceSetCleanup(space, 0);
  hull = dCreateVisualHull(space, data);
  dSpaceDestroy(space);
  CHECK(dGeomVisualHullPointInside(hull, 0, 0, 0) == 1);
  dGeomDestroy(hull);
}

static void it_moves_with_a_body_and_an_offset(void) {
  dGeomID hull = dCreateVisualHull(0, data);
  dBodyID body = dBodyCreate(world);
  dMatrix3 quarter;
  dGeomSetPosition(hull, 5, 0, 0);
  CHECK(dGeomVisualHullPointInside(hull, 5, 0, 0) == 1 && dGeomVisualHullPointInside(hull, 0, 0, 0) == 0);
  dGeomSetBody(hull, body);
  dBodySetPosition(body, 0, 7, 0);
  CHECK(dGeomVisualHullPointInside(hull, 0, 7, 0) == 1);
  dGeomSetOffsetPosition(hull, 0, 0, 1);
  dRFromAxisAndAngle(quarter, 1, 0, 0, M_PI / 2); /* z to -y */
  dBodySetRotation(body, quarter);
  CHECK(dGeomVisualHullPointInside(hull, 0, 6, 0) == 1 && dGeomVisualHullPointInside(hull, 0, 7, 0) == 0);
  dGeomSetBody(hull, 0);
  dBodyDestroy(body);
  dGeomDestroy(hull);
}

static void spaces_pass_over_it_when_told_to(void) {
  dSpaceID space = dHashSpaceCreate(0), others = dSimpleSpaceCreate(0);
  dGeomID hull = dCreateVisualHull(space, data), cube = sunk_cube(space);
  Contacts contacts;
  CHECK(calls_in(space) == 1);
  dGeomSetCategoryBits(hull, 2), dGeomSetCollideBits(hull, 0);
  dGeomSetCollideBits(cube, 1);
  CHECK(calls_in(space) == 0);
  dGeomSetCollideBits(cube, 2);
  CHECK(calls_in(space) == 1);
  dGeomDisable(hull);
  CHECK(calls_in(space) == 0);
  dGeomEnable(hull);
  CHECK(calls_in(space) == 1);
  dSpaceRemove(space, hull);
  CHECK(calls_in(space) == 0);
  dSpaceAdd(others, hull);
  contacts.world = world, contacts.joints = dJointGroupCreate(0), contacts.calls = 0;
  dSpaceCollide2(hull, (dGeomID)space, &contacts, near_callback);
  dSpaceCollide2((dGeomID)space, (dGeomID)others, &contacts, near_callback);
  CHECK(contacts.calls == 2 && dBodyGetNumJoints(dGeomGetBody(cube)) > 0);
  dJointGroupDestroy(contacts.joints);
  dispose(cube);
  dSpaceDestroy(space);
  dSpaceDestroy(others);
}

static void every_kind_of_space_holds_it(void) {
  const dVector3 centre = {0, 0, 0, 0}, extents = {2, 2, 2, 0};
  dSpaceID spaces[4];
  int k;
  spaces[0] = dSimpleSpaceCreate(0);
  spaces[1] = dHashSpaceCreate(0);
  spaces[2] = dSweepAndPruneSpaceCreate(0, dSAP_AXES_XYZ);
  spaces[3] = dQuadTreeSpaceCreate(0, centre, extents, 4);
  for (k = 0; k < 4; k++) {
    dGeomID cube;
    dCreateVisualHull(spaces[k], data);
    cube = sunk_cube(spaces[k]);
    CHECK(calls_in(spaces[k]) == 1);
    dBodySetPosition(dGeomGetBody(cube), 0, 0, 3);
    CHECK(calls_in(spaces[k]) == 0);
    dispose(cube);
    dSpaceDestroy(spaces[k]);
  }
}

static void transforms_hold_it_and_meet_it(void) {
  const int skip = sizeof(dContactGeom);
  dContactGeom plain[8], moved[8];
  dGeomID hull = dCreateVisualHull(0, data), cube = dCreateBox(0, 0.2, 0.2, 0.2);
  dGeomID transform = dCreateGeomTransform(0), other = dCreateGeomTransform(0);
  dGeomSetPosition(cube, 0, 0, TOP + 0.096);
  CHECK(dCollide(hull, cube, 8, plain, skip) == 8);
  dGeomSetPosition(cube, 0, 0, 1);
  dGeomTransformSetGeom(transform, cube);
  dGeomSetPosition(transform, 0, 0, TOP + 0.096 - 1);
  CHECK(dCollide(hull, transform, 8, moved, skip) == 8);
  CHECK(fabs(moved[0].depth - plain[0].depth) < 1e-9 && moved[0].g1 == hull && moved[0].g2 == cube);
  dGeomTransformSetInfo(transform, 1);
  CHECK(dCollide(hull, transform, 8, moved, skip) == 8 && moved[0].g2 == transform);
  dGeomTransformSetGeom(other, hull);
  CHECK(dCollide(other, transform, 8, moved, skip) == 8 && moved[0].g1 == hull);
  dGeomDestroy(other);
  dGeomDestroy(transform);
  dGeomDestroy(hull);
  dGeomDestroy(cube);
}

static void normals_point_into_the_first_geom(void) {
  const int skip = sizeof(dContactGeom);
  dContactGeom first[8], second[8];
  dGeomID hull = dCreateVisualHull(0, data), cube = sunk_cube(0);
  int k;
  CHECK(dCollide(hull, cube, 8, first, skip) == 8 && dCollide(cube, hull, 8, second, skip) == 8);
  for (k = 0; k < 8; k++) {
    CHECK(first[k].g1 == hull && first[k].g2 == cube && second[k].g1 == cube && second[k].g2 == hull);
    CHECK(first[k].normal[2] < -0.99 && second[k].normal[2] > 0.99);
    CHECK(first[k].depth == second[k].depth && fabs(first[k].depth - 0.004) < 0.3 * PIXEL);
    CHECK(first[k].side1 == -1 && first[k].side2 == -1);
  }
  dispose(cube);
  dGeomDestroy(hull);
}

/* A contact in a structure of the caller's, with room that is none of ours. */
typedef struct {
  dContactGeom geom;
  unsigned char own[40];
} Wide;

static void the_callers_room_is_kept_to(void) {
  Wide contacts[8], blank;
  dContactGeom all[8];
  dGeomID hull = dCreateVisualHull(0, data), cube = sunk_cube(0);
  int capacity, k, deepest;
  memset(&blank, 0x5a, sizeof blank);
  CHECK(dCollide(hull, cube, 8, all, sizeof(dContactGeom)) == 8);
  for (deepest = 0, k = 1; k < 8; k++)
    if (all[k].depth > all[deepest].depth) deepest = k;
  for (capacity = 1; capacity <= 8; capacity++) {
    for (k = 0; k < 8; k++) contacts[k] = blank;
    CHECK(dCollide(hull, cube, capacity, &contacts[0].geom, sizeof(Wide)) == capacity);
    CHECK(contacts[0].geom.depth == all[deepest].depth);
    for (k = 0; k < 8; k++) {
      CHECK(memcmp(contacts[k].own, blank.own, sizeof blank.own) == 0);
      CHECK(k < capacity ? contacts[k].geom.g1 == hull : memcmp(&contacts[k], &blank, sizeof blank) == 0);
    }
  }
  /* Any contacts will do, so that there are some, and not more than there is room for. */
  for (k = 0; k < 8; k++) contacts[k] = blank;
  k = dCollide(hull, cube, (int)(CONTACTS_UNIMPORTANT | 3), &contacts[0].geom, sizeof(Wide));
  CHECK(k >= 1 && k <= 3 && contacts[0].geom.g1 == hull && memcmp(&contacts[3], &blank, sizeof blank) == 0);
  dBodySetPosition(dGeomGetBody(cube), 0, 0, 1);
  for (k = 0; k < 8; k++) contacts[k] = blank;
  CHECK(dCollide(hull, cube, 8, &contacts[0].geom, sizeof(Wide)) == 0);
  CHECK(dCollide(hull, cube, (int)(CONTACTS_UNIMPORTANT | 8), &contacts[0].geom, sizeof(Wide)) == 0);
  CHECK(memcmp(&contacts[0], &blank, sizeof blank) == 0);
  dispose(cube);
  dGeomDestroy(hull);
}

static void settings_and_samples_are_the_geoms_own(void) {
  const dReal below[2][3] = {{0, 0, 0}, {0.01, 0, 0}};
  const int skip = sizeof(dContactGeom);
  dContactGeom contacts[64];
  dGeomID hull = dCreateVisualHull(0, data), other = dCreateVisualHull(0, data), cube = sunk_cube(0);
  dVector3 v;
  dGeomVisualHullSetMaxContacts(hull, 4);
  CHECK(dCollide(hull, cube, 64, contacts, skip) == 4 && dCollide(other, cube, 64, contacts, skip) == 8);
  dGeomVisualHullSetMaxContacts(hull, 8);
  dGeomVisualHullSetMaxDepth(hull, 0.002);
  CHECK(dCollide(hull, cube, 8, contacts, skip) == 8 && contacts[0].depth == 0.002);
  dGeomVisualHullSetContactMode(hull, dVisualHullContactsSingle);
  CHECK(dCollide(hull, cube, 8, contacts, skip) == 1);
  dGeomVisualHullSetContactMode(hull, dVisualHullContactsPaper);
  dGeomVisualHullSetMaxContacts(hull, 64);
  CHECK(dCollide(hull, cube, 64, contacts, skip) > 8);
  CHECK(contacts[0].depth > 0.002);
  dGeomVisualHullSetContactMode(hull, dVisualHullContactsClustered);
  /* Its middle is 96 mm above the table, so that samples there do not touch it. */
  CHECK(dGeomVisualHullSetSamples(cube, below[0], 0, 2, sizeof below[0]));
  CHECK(dCollide(hull, cube, 8, contacts, skip) == 0);
  dBodySetPosition(dGeomGetBody(cube), 0, 0, TOP - 0.01);
  CHECK(dGeomVisualHullBodyResponse(hull, cube, v) == 2 && fabs(v[2] - 0.01) < PIXEL);
  dGeomVisualHullClearSamples(cube);
  CHECK(dGeomVisualHullBodyResponse(hull, cube, v) > 2);
  dispose(cube);
  dGeomDestroy(other);
  dGeomDestroy(hull);
}

static void a_ray_meets_its_first_surface(void) {
  dContactGeom contact;
  dGeomID hull = dCreateVisualHull(0, data), ray = dCreateRay(0, 2);
  dGeomRaySet(ray, 0, 0, 1, 0, 0, -1);
  CHECK(dCollide(ray, hull, 1, &contact, sizeof contact) == 1);
  CHECK(fabs(contact.depth - 0.8) < PIXEL && fabs(contact.pos[2] - TOP) < PIXEL && contact.normal[2] > 0.99);
  dGeomDestroy(ray);
  dGeomDestroy(hull);
}

static void cameras_and_matrices_are_one(void) {
  const dReal none[14] = {0};
  const int counts[VIEWS] = {0, 8, 12, 14};
  const dReal bounds[6] = {-0.6, 0.6, -0.6, 0.6, -0.3, 0.9};
  dVisualHullDataID same = dGeomVisualHullDataCreate();
  dGeomID hull = dCreateVisualHull(0, data), other = dCreateVisualHull(0, same);
  int view, k;
  for (view = 0; view < VIEWS; view++) {
    dReal K[9], R[9], t[3];
    camera(view, K, R, t);
    CHECK(dGeomVisualHullDataAddCamera(same, K, R, t, none, counts[view], WIDTH, HEIGHT) == view);
  }
  CHECK(dGeomVisualHullDataSetBounds(same, bounds));
  CHECK(dGeomVisualHullPointInside(other, 0, 0, 0) == 0); /* no frame yet */
  show_table(same, 0);
  CHECK(dGeomVisualHullDataUpdate(same, 0));
  for (k = 0; k < 1000; k++) {
    const dReal x = dRandReal() - 0.5, y = dRandReal() - 0.5, z = dRandReal() - 0.5;
    CHECK(dGeomVisualHullPointInside(hull, x, y, z) == dGeomVisualHullPointInside(other, x, y, z));
  }
  dGeomVisualHullSetData(other, data);
  CHECK(dGeomVisualHullGetData(other) == data && dGeomVisualHullPointInside(other, 0, 0, 0) == 1);
  dGeomDestroy(other);
  dGeomDestroy(hull);
  dGeomVisualHullDataDestroy(same);
}

/* What a strongly bent fisheye sees of the table in the place of a view's pinhole, pixel centre by pixel centre. */
static void draw_table_through_fisheye(int view, const dReal K[9], dReal k1, unsigned char bent[HEIGHT * WIDTH]) {
  static unsigned char straight[HEIGHT * WIDTH];
  int row, column, k;
  draw_table(view, 0, straight);
  for (row = 0; row < HEIGHT; row++)
    for (column = 0; column < WIDTH; column++) {
      const dReal x = (column + 0.5 - K[2]) / K[0], y = (row + 0.5 - K[5]) / K[4], distorted = sqrt(x * x + y * y);
      dReal low = 0, high = 1.5, u, v;
      for (k = 0; k < 50; k++) {
        const dReal theta = (low + high) / 2;
        if (theta * (1 + k1 * theta * theta) < distorted) low = theta; else high = theta;
      }
      u = K[2] + K[0] * x * tan(low) / distorted, v = K[5] + K[4] * y * tan(low) / distorted;
      bent[row * WIDTH + column] =
          u >= 0 && v >= 0 && u < WIDTH && v < HEIGHT ? straight[(int)v * WIDTH + (int)u] : 0;
    }
}

static void a_fisheye_and_a_pinhole_see_one_table(void) {
  static unsigned char mask[HEIGHT * WIDTH];
  const dReal bounds[6] = {-0.6, 0.6, -0.6, 0.6, -0.3, 0.9}, coefficients[4] = {5, 0, 0, 0};
  dVisualHullDataID bent = dGeomVisualHullDataCreate();
  dGeomID hull = dCreateVisualHull(0, data), other = dCreateVisualHull(0, bent);
  int view, k, differ = 0;
  for (view = 0; view < VIEWS; view++) {
    dReal K[9], R[9], t[3];
    camera(view, K, R, t);
    CHECK(dGeomVisualHullDataAddFisheyeCamera(bent, K, R, t, coefficients, 4, WIDTH, HEIGHT) == view);
    draw_table_through_fisheye(view, K, coefficients[0], mask);
    CHECK(dGeomVisualHullDataSetMask(bent, view, mask, WIDTH));
  }
  CHECK(dGeomVisualHullDataSetBounds(bent, bounds) && dGeomVisualHullDataUpdate(bent, 0));
  for (k = 0; k < 4000; k++) {
    const dReal x = dRandReal() - 0.5, y = dRandReal() - 0.5, z = dRandReal() - 0.5;
    differ += dGeomVisualHullPointInside(hull, x, y, z) != dGeomVisualHullPointInside(other, x, y, z);
  }
  /* A pixel's width on both sides of the table's 1.3 square metres is 1.6 % of the cubic metre. */
  CHECK(differ < 0.016 * 4000);
  dGeomDestroy(other);
  dGeomDestroy(hull);
  dGeomVisualHullDataDestroy(bent);
}

static void a_lost_camera_abstains_until_it_is_back(void) {
  const dReal behind = 0.5; /* in all silhouettes but one or two */
  dVisualHullDataID own = table_data();
  dGeomID hull = dCreateVisualHull(0, own);
  int view;
  CHECK(dGeomVisualHullDataSetUnseen(own, dVisualHullUnseenAbstain, 2));
  for (view = 0; view < VIEWS; view++)
    CHECK(dGeomVisualHullDataSetViewEnabled(own, view, view % 2 == 0));
  CHECK(dGeomVisualHullDataUpdate(own, 1));
  CHECK(dGeomVisualHullPointInside(hull, cos(0.3) * behind, sin(0.3) * behind, 0) == 1);
  for (view = 0; view < VIEWS; view++) CHECK(dGeomVisualHullDataSetViewEnabled(own, view, 1));
  CHECK(dGeomVisualHullDataUpdate(own, 2));
  CHECK(dGeomVisualHullPointInside(hull, cos(0.3) * behind, sin(0.3) * behind, 0) == 0);
  dGeomDestroy(hull);
  dGeomVisualHullDataDestroy(own);
}

int main(void) {
  CHECK(dInitODE2(0) && dInitVisualHull());
  dRandSetSeed(1);
  world = table_world();
  data = table_data();
  geoms_are_destroyed_as_any_other();
  it_moves_with_a_body_and_an_offset();
  spaces_pass_over_it_when_told_to();
  every_kind_of_space_holds_it();
  transforms_hold_it_and_meet_it();
  normals_point_into_the_first_geom();
  the_callers_room_is_kept_to();
  settings_and_samples_are_the_geoms_own();
  a_ray_meets_its_first_surface();
  cameras_and_matrices_are_one();
  a_fisheye_and_a_pinhole_see_one_table();
  a_lost_camera_abstains_until_it_is_back();
  dGeomVisualHullDataDestroy(data);
  dWorldDestroy(world);
  dCloseVisualHull();
  dCloseODE();
  return 0;
}
