/* Geoms inside a dGeomTransform collide as they do without: ODE's getters answer for such a geom with the body's rotation
   and with an old bounding box, and ODE does not tell the transform that its geom has changed. */
#include "check.h"
#include "scene.h"

#include <math.h>

#pragma GCC diagnostic ignored "-Wdeprecated-declarations"

enum { KINDS = 7 };

static dReal planes[] = {1, 0, 0, .1, -1, 0, 0, .1, 0, 1, 0, .1, 0, -1, 0, .1, 0, 0, 1, .1, 0, 0, -1, .1};
static dReal points[] = {-.1, -.1, -.1, .1, -.1, -.1, -.1, .1, -.1, .1, .1, -.1,
                         -.1, -.1, .1,  .1, -.1, .1,  -.1, .1, .1,  .1, .1, .1};
static unsigned polygons[] = {4, 0, 4, 6, 2, 4, 1, 3, 7, 5, 4, 0, 1, 5, 4, 4, 2, 6, 7, 3, 4, 0, 2, 3, 1, 4, 4, 5, 7, 6};
static int triangles[] = {0, 4, 6, 0, 6, 2, 1, 3, 7, 1, 7, 5, 0, 1, 5, 0, 5, 4,
                          2, 6, 7, 2, 7, 3, 0, 2, 3, 0, 3, 1, 4, 5, 7, 4, 7, 6};
static dTriMeshDataID mesh;

static dGeomID body_of_kind(int kind) {
  switch (kind) {
    case 0: return dCreateSphere(0, 0.1);
    case 1: return dCreateBox(0, 0.2, 0.1, 0.3);
    case 2: return dCreateCapsule(0, 0.05, 0.2);
    case 3: return dCreateCylinder(0, 0.1, 0.2);
    case 4: return dCreateConvex(0, planes, 6, points, 8, polygons);
    case 5: return dCreateTriMesh(0, mesh, 0, 0, 0);
    default: return dCreateRay(0, 0.5);
  }
}

static double state = 0.5;

/* A number from -1 to 1, of a sequence that is the same in each run. */
static double next(void) {
  state = fmod(state * 9301 + 0.49297, 1);
  return 2 * state - 1;
}

static void random_rotation(dQuaternion q) {
  int k;
  for (k = 0; k < 4; k++) q[k] = next();
  dNormalize4(q);
}

/* Both pairs have the same contacts up to rounding. Returns their number. */
static int same_contacts(dGeomID a1, dGeomID b1, dGeomID a2, dGeomID b2) {
  dContactGeom one[8], other[8];
  const int n = dCollide(a1, b1, 8, one, sizeof *one), m = dCollide(a2, b2, 8, other, sizeof *other);
  int k;
  CHECK(n == m);
  for (k = 0; k < n; k++) CHECK(fabs(one[k].depth - other[k].depth) < 1e-9);
  return n;
}

/* The pose of `inner` in `outer`, as the pose of one geom. */
static void place_together(dGeomID lone, dGeomID inner, dGeomID outer) {
  const dReal *p = dGeomGetPosition(inner);
  dQuaternion a, b, q;
  dVector3 at;
  dGeomGetRelPointPos(outer, p[0], p[1], p[2], at);
  dGeomGetQuaternion(outer, a), dGeomGetQuaternion(inner, b);
  dQMultiply0(q, a, b);
  dGeomSetPosition(lone, at[0], at[1], at[2]);
  dGeomSetQuaternion(lone, q);
}

static void a_body_inside_a_transform_has_the_contacts_of_the_bare_body(dVisualHullDataID data) {
  dGeomID hull = dCreateVisualHull(0, data);
  int kind, round, contacts;
  for (kind = 0; kind < KINDS; kind++) {
    dGeomID lone = body_of_kind(kind), inner = body_of_kind(kind), outer = dCreateGeomTransform(0);
    for (contacts = 0, round = 0; round < 30; round++) {
      dQuaternion q;
      dGeomTransformSetGeom(outer, 0); /* ODE returns the inner geom's own pose only while it is outside */
      random_rotation(q), dGeomSetQuaternion(inner, q), dGeomSetPosition(inner, 0.3 * next(), 0.3 * next(), 0.3 * next());
      random_rotation(q), dGeomSetQuaternion(outer, q);
      dGeomSetPosition(outer, 0.3 * next(), 0.3 * next(), TOP + 0.2 * next());
      place_together(lone, inner, outer);
      dGeomTransformSetGeom(outer, inner);
      contacts += same_contacts(hull, lone, hull, outer);
    }
    CHECK(contacts > 3);
    dGeomDestroy(outer), dGeomDestroy(inner), dGeomDestroy(lone);
  }
  dGeomDestroy(hull);
}

static void a_hull_inside_a_transform_has_the_contacts_of_the_bare_hull(dVisualHullDataID data, dWorldID world) {
  int with_body, kind, round, contacts = 0;
  for (with_body = 0; with_body < 2; with_body++)
    for (kind = 0; kind < KINDS; kind++) {
      dGeomID lone = dCreateVisualHull(0, data), inner = dCreateVisualHull(0, data), outer = dCreateGeomTransform(0);
      dGeomID body = body_of_kind(kind);
      dBodyID carrier = dBodyCreate(world);
      if (with_body) dGeomSetBody(outer, carrier);
      for (round = 0; round < 8; round++) {
        dQuaternion q;
        dGeomTransformSetGeom(outer, 0);
        random_rotation(q), dGeomSetQuaternion(inner, q), dGeomSetPosition(inner, 0.2 * next(), 0.2 * next(), 0.2 * next());
        random_rotation(q), dGeomSetQuaternion(outer, q), dGeomSetPosition(outer, 0.2 * next(), 0.2 * next(), 0.2 * next());
        random_rotation(q), dGeomSetQuaternion(body, q), dGeomSetPosition(body, 0.3 * next(), 0.3 * next(), 0.3 * next());
        place_together(lone, inner, outer);
        dGeomTransformSetGeom(outer, inner);
        contacts += same_contacts(lone, body, outer, body);
      }
      dGeomDestroy(outer), dGeomDestroy(inner), dGeomDestroy(lone), dGeomDestroy(body);
      dBodyDestroy(carrier);
    }
  CHECK(contacts > 50);
}

static int pairs, hits;

static void count(void *none, dGeomID a, dGeomID b) {
  dContactGeom contacts[8];
  (void)none;
  pairs++;
  hits += dCollide(a, b, 8, contacts, sizeof *contacts);
}

static void spaces_find_a_hull_inside_a_transform_in_every_frame(void) {
  const dVector3 centre = {0, 0, 0, 0}, extents = {2, 2, 2, 0};
  int kind;
  for (kind = 0; kind < 4; kind++) {
    dVisualHullDataID data = table_data();
    dSpaceID space = kind == 0   ? dSimpleSpaceCreate(0)
                     : kind == 1 ? dHashSpaceCreate(0)
                     : kind == 2 ? dSweepAndPruneSpaceCreate(0, dSAP_AXES_XYZ)
                                 : dQuadTreeSpaceCreate(0, centre, extents, 3);
    dGeomID hull = dCreateVisualHull(0, data), outer = dCreateGeomTransform(space), ball = dCreateSphere(space, 0.05);
    dGeomTransformSetGeom(outer, hull);
    dGeomSetPosition(ball, 0, 0, TOP + 0.21);

    hits = 0, dSpaceCollide(space, 0, count);
    CHECK(hits == 0);
    show_table(data, 0.3);
    CHECK(dGeomVisualHullDataUpdate(data, 1));
    hits = 0, dSpaceCollide(space, 0, count);
    CHECK(hits > 0);
    show_table(data, 0);
    CHECK(dGeomVisualHullDataUpdate(data, 2));
    hits = 0, dSpaceCollide(space, 0, count);
    CHECK(hits == 0);

    dGeomDestroy(outer), dGeomDestroy(hull);
    dSpaceDestroy(space);
    dGeomVisualHullDataDestroy(data);
  }
}

int main(void) {
  dVisualHullDataID data;
  dWorldID world;
  CHECK(dInitODE2(0) && dInitVisualHull());
  data = table_data(), world = dWorldCreate();
  mesh = dGeomTriMeshDataCreate();
  dGeomTriMeshDataBuildDouble(mesh, points, 3 * sizeof(dReal), 8, triangles, 36, 3 * sizeof(int));

  a_body_inside_a_transform_has_the_contacts_of_the_bare_body(data);
  a_hull_inside_a_transform_has_the_contacts_of_the_bare_hull(data, world);
  spaces_find_a_hull_inside_a_transform_in_every_frame();

  dGeomTriMeshDataDestroy(mesh);
  dGeomVisualHullDataDestroy(data);
  dWorldDestroy(world);
  dCloseVisualHull();
  dCloseODE();
  return 0;
}
