/*
 * Bodies fall on a recorded subject, which is given by a rig file and a folder of masks per camera.
 *
 *     from_images RECORDING CAMERA...
 *
 * reads RECORDING/rig.toml and the masks RECORDING/CAMERA/mask/000000.png, 000001.png, ... Name the cameras in the rig
 * file's order.
 */
#include <math.h>
#include <ode_visual_hull.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { BODIES = 24, STEPS_PER_FRAME = 4, FRAMES = 150 };

static const dReal FRAME = 1.0 / 60, RADIUS = 0.06;

/* The work volume, which contains the subject. */
static const dReal BOUNDS[6] = {-2, 2, -2, 2, 0, 2.2};

static dWorldID world;
static dJointGroupID contacts;

/* Prints the message of the last failure and exits. */
static void fail(void) {
  fprintf(stderr, "error: %s\n", dVisualHullGetErrorMessage());
  exit(1);
}

/* Loads the masks of a frame. Returns 0 after the last frame. */
static int load_frame(dVisualHullDataID data, const char *recording, char **camera, int cameras, int frame) {
  char path[4096];
  int view;

  for (view = 0; view < cameras; view++) {
    FILE *file;
    snprintf(path, sizeof path, "%s/%s/mask/%06d.png", recording, camera[view], frame);
    /* A missing file ends the recording, except in the first frame, where it is an error. */
    if (frame > 0 && !(file = fopen(path, "rb"))) return 0;
    if (frame > 0) fclose(file);
    if (!dGeomVisualHullDataLoadMask(data, view, path)) fail();
  }
  return 1;
}

/* Finds the centre of the hull's topmost slice that is too large to be noise. Returns 0 if there is none. */
static int find_top(dGeomID hull, dVector3 top) {
  const dReal grid = 0.02;
  dReal x, y, z;

  for (z = BOUNDS[5]; z > BOUNDS[4]; z -= grid) {
    int inside = 0;
    dSetZero(top, 4);
    for (x = BOUNDS[0]; x < BOUNDS[1]; x += grid)
      for (y = BOUNDS[2]; y < BOUNDS[3]; y += grid)
        if (dGeomVisualHullPointInside(hull, x, y, z) == 1) top[0] += x, top[1] += y, inside++;
    if (inside < 10) continue;
    top[0] /= inside, top[1] /= inside, top[2] = z;
    return 1;
  }
  return 0;
}

static void near_callback(void *touched, dGeomID o1, dGeomID o2) {
  dContact contact[8];
  int k, n = dCollide(o1, o2, 8, &contact[0].geom, sizeof(dContact));
  const int hull = dGetVisualHullClass();

  /* Nothing but this count depends on the class of a geom. */
  if (n > 0 && (dGeomGetClass(o1) == hull || dGeomGetClass(o2) == hull)) ++*(int *)touched;
  for (k = 0; k < n; k++) {
    memset(&contact[k].surface, 0, sizeof contact[k].surface);
    contact[k].surface.mode = dContactApprox1 | dContactBounce;
    contact[k].surface.mu = 0.5;
    contact[k].surface.bounce = 0.2;
    contact[k].surface.bounce_vel = 0.1;
    dJointAttach(dJointCreateContact(world, contacts, &contact[k]), dGeomGetBody(o1), dGeomGetBody(o2));
  }
}

/* Adds a ball, a box or a capsule. */
static void add_body(dSpaceID space, int kind, dReal x, dReal y, dReal z) {
  dBodyID body = dBodyCreate(world);
  dGeomID geom;
  dMass mass;

  if (kind == 0) {
    geom = dCreateSphere(space, RADIUS);
    dMassSetSphere(&mass, 200, RADIUS);
  } else if (kind == 1) {
    geom = dCreateBox(space, 2 * RADIUS, 2 * RADIUS, RADIUS);
    dMassSetBox(&mass, 200, 2 * RADIUS, 2 * RADIUS, RADIUS);
  } else {
    geom = dCreateCapsule(space, RADIUS / 2, 2 * RADIUS);
    dMassSetCapsule(&mass, 200, 3, RADIUS / 2, 2 * RADIUS);
  }

  dBodySetMass(body, &mass);
  dGeomSetBody(geom, body);
  dBodySetPosition(body, x, y, z);
}

int main(int argc, char **argv) {
  const int cameras = argc - 2;
  char path[4096];
  dVisualHullDataID data;
  dSpaceID space;
  dGeomID hull;
  dVector3 top = {0};
  int k, frame, recorded = 0;

  if (argc < 3) {
    fprintf(stderr, "usage: from_images RECORDING CAMERA...\n");
    return 2;
  }

  dInitODE2(0);
  if (!dInitVisualHull()) fail();

  data = dGeomVisualHullDataCreate();
  snprintf(path, sizeof path, "%s/rig.toml", argv[1]);
  if (!dGeomVisualHullDataLoadRig(data, path)) fail();
  if (dGeomVisualHullDataGetViewCount(data) != cameras) {
    fprintf(stderr, "error: %s has %d cameras, but %d are named: name all of them in the file's order\n", path,
            dGeomVisualHullDataGetViewCount(data), cameras);
    return 2;
  }
  dGeomVisualHullDataSetBounds(data, BOUNDS);

  world = dWorldCreate();
  dWorldSetGravity(world, 0, 0, -9.81);
  dWorldSetCFM(world, 1e-5);
  dWorldSetContactSurfaceLayer(world, 0.002); /* half a pixel's footprint */
  space = dHashSpaceCreate(0);
  contacts = dJointGroupCreate(0);
  dCreatePlane(space, 0, 0, 1, 0);
  hull = dCreateVisualHull(space, data);
  dGeomVisualHullSetMinFeature(hull, 0.015);

  for (frame = 0; frame < FRAMES; frame++) {
    int touched = 0;

    /* After the end of the recording its last frame stays in use. */
    if (recorded == frame && load_frame(data, argv[1], argv + 2, cameras, frame)) {
      if (!dGeomVisualHullDataUpdate(data, frame * FRAME)) fail();
      recorded++;
    }

    if (frame == 0) {
      if (!find_top(hull, top)) {
        fprintf(stderr, "error: no point of the work volume is in all silhouettes: check the rig and the masks\n");
        return 1;
      }
      printf("the subject's top is at (%.2f, %.2f, %.2f) m\n", top[0], top[1], top[2]);
    }

    if (frame % 3 == 0 && frame / 3 < BODIES) /* a new body above the subject, on a spiral */
      add_body(space, frame / 3 % 3, top[0] + 0.003 * frame * cos(0.8 * frame),
               top[1] + 0.003 * frame * sin(0.8 * frame), top[2] + 0.3);

    for (k = 0; k < STEPS_PER_FRAME; k++) {
      dSpaceCollide(space, &touched, near_callback);
      dWorldQuickStep(world, FRAME / STEPS_PER_FRAME);
      dJointGroupEmpty(contacts);
    }

    if (frame % 15 == 14) printf("frame %3d: %2d bodies touch the subject\n", frame, touched / STEPS_PER_FRAME);
  }

  printf("%d frames recorded\n", recorded);

  dSpaceDestroy(space);
  dWorldDestroy(world);
  dJointGroupDestroy(contacts);
  dGeomVisualHullDataDestroy(data);
  dCloseVisualHull();
  dCloseODE();
  return 0;
}
