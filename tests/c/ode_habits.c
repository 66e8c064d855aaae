/* Everything that an ODE program does with a geom works with a hull. */
#include "check.h"
#include "scene.h"

#include <math.h>

/* dGeomTransform is deprecated, but programs still use it. */
#pragma GCC diagnostic ignored "-Wdeprecated-declarations"

static dWorldID world;
static dVisualHullDataID data;

/* A cube that is 4 mm deep in the table. */
static dGeomID sunk_cube(dSpaceID space) { return add_cube(world, space, 0, 0, TOP + 0.096); }

/* Destroys a geom and its body. */
static void dispose(dGeomID geom) {
  if (dGeomGetBody(geom)) dBodyDestroy(dGeomGetBody(geom));
  dGeomDestroy(geom);
}

/* The number of pairs that a collide of the space passes to the near callback. */
static int calls_in(dSpaceID space) {
  Contacts contacts;

  contacts.world = world;
  contacts.joints = dJointGroupCreate(0);
  contacts.calls = 0;
  dSpaceCollide(space, &contacts, near_callback);
  dJointGroupDestroy(contacts.joints);
  return contacts.calls;
}

static void a_hull_is_destroyed_by_dGeomDestroy_and_with_its_space(void) {
  dGeomID hull = dCreateVisualHull(0, data);
  dSpaceID space;

  dGeomDestroy(hull);
  CHECK_REFUSED(dGeomVisualHullPointInside(hull, 0, 0, 0), -1, "destroyed");

  /* A space with cleanup destroys its geoms. */
  space = dSimpleSpaceCreate(0);
  dSpaceSetCleanup(space, 1);
  hull = dCreateVisualHull(space, data);
  CHECK(dGeomVisualHullPointInside(hull, 0, 0, 0) == 1);
  dSpaceDestroy(space);
  CHECK_REFUSED(dGeomVisualHullPointInside(hull, 0, 0, 0), -1, "destroyed");

  /* A space without cleanup keeps them. */
  space = dSimpleSpaceCreate(0);
  dSpaceSetCleanup(space, 0);
  hull = dCreateVisualHull(space, data);
  dSpaceDestroy(space);
  CHECK(dGeomVisualHullPointInside(hull, 0, 0, 0) == 1);
  dGeomDestroy(hull);
}

static void a_hull_moves_with_its_body_and_offset(void) {
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

static void spaces_leave_out_a_hull_by_its_bits_and_when_disabled_or_removed(void) {
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

  /* The hull in another space collides through dSpaceCollide2, as a geom and with its space. */
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

static void a_hull_works_in_every_kind_of_space(void) {
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

static void geom_transforms_may_contain_a_hull_and_collide_with_it(void) {
  const int skip = sizeof(dContactGeom);
  dContactGeom plain[8], moved[8];
  dGeomID hull = dCreateVisualHull(0, data), cube = dCreateBox(0, 0.2, 0.2, 0.2);
  dGeomID transform = dCreateGeomTransform(0), other = dCreateGeomTransform(0);

  dGeomSetPosition(cube, 0, 0, TOP + 0.096);
  CHECK(dCollide(hull, cube, 8, plain, skip) == 8);

  /* A cube at the same place, but by way of a transform. */
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

/* A contact in a caller's larger structure, whose other bytes must not be written. */
typedef struct {
  dContactGeom geom;
  unsigned char own[40];
} Wide;

static void only_the_callers_contacts_are_written(void) {
  Wide contacts[8], blank;
  dContactGeom all[8];
  dGeomID hull = dCreateVisualHull(0, data), cube = sunk_cube(0);
  int capacity, k, deepest;

  memset(&blank, 0x5a, sizeof blank);
  CHECK(dCollide(hull, cube, 8, all, sizeof(dContactGeom)) == 8);
  for (deepest = 0, k = 1; k < 8; k++)
    if (all[k].depth > all[deepest].depth) deepest = k;

  /* With any capacity the deepest contact comes first, and no other bytes are written. */
  for (capacity = 1; capacity <= 8; capacity++) {
    for (k = 0; k < 8; k++) contacts[k] = blank;
    CHECK(dCollide(hull, cube, capacity, &contacts[0].geom, sizeof(Wide)) == capacity);
    CHECK(contacts[0].geom.depth == all[deepest].depth);
    for (k = 0; k < 8; k++) {
      CHECK(memcmp(contacts[k].own, blank.own, sizeof blank.own) == 0);
      CHECK(k < capacity ? contacts[k].geom.g1 == hull : memcmp(&contacts[k], &blank, sizeof blank) == 0);
    }
  }

  /* If any contacts will do there are some, but not more than the capacity. */
  for (k = 0; k < 8; k++) contacts[k] = blank;
  k = dCollide(hull, cube, (int)(CONTACTS_UNIMPORTANT | 3), &contacts[0].geom, sizeof(Wide));
  CHECK(k >= 1 && k <= 3 && contacts[0].geom.g1 == hull && memcmp(&contacts[3], &blank, sizeof blank) == 0);

  /* Without a collision nothing is written. */
  dBodySetPosition(dGeomGetBody(cube), 0, 0, 1);
  for (k = 0; k < 8; k++) contacts[k] = blank;
  CHECK(dCollide(hull, cube, 8, &contacts[0].geom, sizeof(Wide)) == 0);
  CHECK(dCollide(hull, cube, (int)(CONTACTS_UNIMPORTANT | 8), &contacts[0].geom, sizeof(Wide)) == 0);
  CHECK(memcmp(&contacts[0], &blank, sizeof blank) == 0);
  dispose(cube);
  dGeomDestroy(hull);
}

static void each_geom_has_its_own_settings_and_samples(void) {
  const dReal below[2][3] = {{0, 0, 0}, {0.01, 0, 0}};
  const int skip = sizeof(dContactGeom);
  dContactGeom contacts[64];
  dGeomID hull = dCreateVisualHull(0, data), other = dCreateVisualHull(0, data), cube = sunk_cube(0);
  dVector3 v;

  /* The settings of one hull do not affect another. */
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

  /* The cube's middle is 96 mm above the table, so samples in its middle do not touch the table. */
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

static void a_ray_hits_the_hulls_first_surface(void) {
  dContactGeom contact;
  dGeomID hull = dCreateVisualHull(0, data), ray = dCreateRay(0, 2);

  dGeomRaySet(ray, 0, 0, 1, 0, 0, -1);
  CHECK(dCollide(ray, hull, 1, &contact, sizeof contact) == 1);
  CHECK(fabs(contact.depth - 0.8) < PIXEL && fabs(contact.pos[2] - TOP) < PIXEL && contact.normal[2] > 0.99);
  dGeomDestroy(ray);
  dGeomDestroy(hull);
}

static void a_camera_and_its_projection_matrix_give_the_same_hull(void) {
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

/* Draws the table as a strongly distorting fisheye lens sees it in place of a view's pinhole camera. The angle of each
   pixel centre's ray follows by bisection of theta (1 + k1 theta^2). */
static void draw_table_through_fisheye(int view, const dReal K[9], dReal k1, unsigned char fisheye[HEIGHT * WIDTH]) {
  static unsigned char pinhole[HEIGHT * WIDTH];
  int row, column, k;

  draw_table(view, 0, pinhole);
  for (row = 0; row < HEIGHT; row++)
    for (column = 0; column < WIDTH; column++) {
      const dReal x = (column + 0.5 - K[2]) / K[0], y = (row + 0.5 - K[5]) / K[4], distorted = sqrt(x * x + y * y);
      dReal low = 0, high = 1.5, u, v;

      for (k = 0; k < 50; k++) {
        const dReal theta = (low + high) / 2;
        if (theta * (1 + k1 * theta * theta) < distorted) low = theta; else high = theta;
      }

      u = K[2] + K[0] * x * tan(low) / distorted, v = K[5] + K[4] * y * tan(low) / distorted;
      fisheye[row * WIDTH + column] =
          u >= 0 && v >= 0 && u < WIDTH && v < HEIGHT ? pinhole[(int)v * WIDTH + (int)u] : 0;
    }
}

static void a_fisheye_lens_and_a_pinhole_camera_give_the_same_hull(void) {
  static unsigned char mask[HEIGHT * WIDTH];
  const dReal bounds[6] = {-0.6, 0.6, -0.6, 0.6, -0.3, 0.9}, coefficients[4] = {5, 0, 0, 0};
  dVisualHullDataID own = dGeomVisualHullDataCreate();
  dGeomID hull = dCreateVisualHull(0, data), other = dCreateVisualHull(0, own);
  int view, k, differ = 0;

  for (view = 0; view < VIEWS; view++) {
    dReal K[9], R[9], t[3];
    camera(view, K, R, t);
    CHECK(dGeomVisualHullDataAddFisheyeCamera(own, K, R, t, coefficients, 4, WIDTH, HEIGHT) == view);
    draw_table_through_fisheye(view, K, coefficients[0], mask);
    CHECK(dGeomVisualHullDataSetMask(own, view, mask, WIDTH));
  }
  CHECK(dGeomVisualHullDataSetBounds(own, bounds) && dGeomVisualHullDataUpdate(own, 0));

  for (k = 0; k < 4000; k++) {
    const dReal x = dRandReal() - 0.5, y = dRandReal() - 0.5, z = dRandReal() - 0.5;
    differ += dGeomVisualHullPointInside(hull, x, y, z) != dGeomVisualHullPointInside(other, x, y, z);
  }
  /* A layer of one pixel's width on both sides of the table's surface of 1.3 m^2 is 1.6 % of the cubic metre. */
  CHECK(differ < 0.016 * 4000);

  dGeomDestroy(other);
  dGeomDestroy(hull);
  dGeomVisualHullDataDestroy(own);
}

static void a_disabled_view_abstains_until_it_is_enabled(void) {
  const dReal behind = 0.5; /* radius of a point that only the views 1 and 3 see as background */
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

static void a_late_view_abstains_until_its_next_mask(void) {
  const dReal behind = 0.5; /* as above */
  dVisualHullDataID own = table_data();
  dGeomID hull = dCreateVisualHull(0, own);
  unsigned char mask[HEIGHT * WIDTH];
  int view;

  CHECK(dGeomVisualHullDataSetUnseen(own, dVisualHullUnseenAbstain, 2));
  CHECK(dGeomVisualHullDataSetMaxAge(own, 0.5));
  for (view = 0; view < VIEWS; view += 2) {
    draw_table(view, 0, mask);
    CHECK(dGeomVisualHullDataSetMask(own, view, mask, WIDTH));
  }
  CHECK(dGeomVisualHullDataUpdate(own, 1));
  CHECK(dGeomVisualHullPointInside(hull, cos(0.3) * behind, sin(0.3) * behind, 0) == 1);

  show_table(own, 0);
  CHECK(dGeomVisualHullDataUpdate(own, 2));
  CHECK(dGeomVisualHullPointInside(hull, cos(0.3) * behind, sin(0.3) * behind, 0) == 0);

  /* Two seconds without masks make all views late, unless any age is allowed. */
  CHECK(dGeomVisualHullDataUpdate(own, 4));
  CHECK(dGeomVisualHullPointInside(hull, 0, 0, 0) == 0);
  CHECK(dGeomVisualHullDataSetMaxAge(own, 0));
  CHECK(dGeomVisualHullDataUpdate(own, 4));
  CHECK(dGeomVisualHullPointInside(hull, 0, 0, 0) == 1);
  dGeomDestroy(hull);
  dGeomVisualHullDataDestroy(own);
}

/* The number of colliding samples of a geom that touches the table. */
static int colliding(dGeomID hull, dGeomID body) {
  dVector3 v;
  return dGeomVisualHullBodyResponse(hull, body, v);
}

static void samples_belong_to_one_shape(void) {
  static dReal planes[] = {1, 0, 0, .1, -1, 0, 0, .1, 0, 1, 0, .1, 0, -1, 0, .1, 0, 0, 1, .1, 0, 0, -1, .1};
  static dReal points[] = {-.1, -.1, -.1, .1, -.1, -.1, -.1, .1, -.1, .1, .1, -.1,
                           -.1, -.1, .1,  .1, -.1, .1,  -.1, .1, .1,  .1, .1, .1};
  static dReal larger[24];
  static unsigned polygons[] = {4, 0, 4, 6, 2, 4, 1, 3, 7, 5, 4, 0, 1, 5, 4, 4, 2, 6, 7, 3, 4, 0, 2, 3, 1, 4, 4, 5, 7, 6};
  const dReal far[3] = {0, 0, 5};
  dGeomID hull = dCreateVisualHull(0, data), bodies[4];
  dContactGeom contact;
  int k;

  bodies[0] = dCreateBox(0, 0.2, 0.2, 0.2), bodies[1] = dCreateSphere(0, 0.1), bodies[2] = dCreateCapsule(0, 0.1, 0.1);
  bodies[3] = dCreateConvex(0, planes, 6, points, 8, polygons);
  for (k = 0; k < 24; k++) larger[k] = 1.5 * points[k];
  for (k = 0; k < 4; k++) {
    dGeomSetPosition(bodies[k], 0, 0, TOP + 0.05);
    CHECK(colliding(hull, bodies[k]) > 0);
    CHECK(dGeomVisualHullSetSamples(bodies[k], far, NULL, 1, sizeof far));
    CHECK(colliding(hull, bodies[k]) == 0);
    /* They stay when the geom moves, also for a convex geom, whose vertices this library reads in each pose. */
    dGeomSetPosition(bodies[k], 0.1, 0.03, TOP + 0.04);
    CHECK(colliding(hull, bodies[k]) == 0);
  }

  dGeomBoxSetLengths(bodies[0], 0.3, 0.2, 0.2);
  dGeomSphereSetRadius(bodies[1], 0.12);
  dGeomCapsuleSetParams(bodies[2], 0.1, 0.2);
  dGeomSetConvex(bodies[3], planes, 6, larger, 8, polygons);
  for (k = 0; k < 4; k++) {
    /* Those of the class are used for the new size, and a message says so. */
    forget_message();
    CHECK(colliding(hull, bodies[k]) > 0);
    CHECK_MESSAGE("set samples for the new shape");
    forget_message();
    CHECK(dCollide(hull, bodies[k], 1, &contact, sizeof contact) == 1);
    CHECK_MESSAGE("another shape or size");

    dGeomVisualHullClearSamples(bodies[k]);
    forget_message();
    CHECK(colliding(hull, bodies[k]) > 0);
    CHECK_MESSAGE("77");
    dGeomDestroy(bodies[k]);
  }
  dGeomDestroy(hull);
}

int main(void) {
  CHECK(dInitODE2(0) && dInitVisualHull());
  dRandSetSeed(1);
  world = table_world();
  data = table_data();

  a_hull_is_destroyed_by_dGeomDestroy_and_with_its_space();
  a_hull_moves_with_its_body_and_offset();
  spaces_leave_out_a_hull_by_its_bits_and_when_disabled_or_removed();
  a_hull_works_in_every_kind_of_space();
  geom_transforms_may_contain_a_hull_and_collide_with_it();
  normals_point_into_the_first_geom();
  only_the_callers_contacts_are_written();
  each_geom_has_its_own_settings_and_samples();
  a_ray_hits_the_hulls_first_surface();
  a_camera_and_its_projection_matrix_give_the_same_hull();
  a_fisheye_lens_and_a_pinhole_camera_give_the_same_hull();
  a_disabled_view_abstains_until_it_is_enabled();
  a_late_view_abstains_until_its_next_mask();
  samples_belong_to_one_shape();

  dGeomVisualHullDataDestroy(data);
  dWorldDestroy(world);
  dCloseVisualHull();
  dCloseODE();
  return 0;
}
