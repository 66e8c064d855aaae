/*
 * A stack of virtual boxes stands on a real box, which is lifted and tilted until the stack slides off.
 *
 * The simulation knows the real box only by its silhouettes in seven cameras. Here the program draws them itself; with
 * real cameras, masks from any background subtraction replace draw(). The rest is an ordinary ODE program: its
 * near_callback has no code for hulls.
 */
#include <math.h>
#include <ode_visual_hull.h>
#include <stdio.h>
#include <string.h>

enum { VIEWS = 7, WIDTH = 640, HEIGHT = 480, BOXES = 5, STEPS_PER_FRAME = 8 };

static const dReal REAL_BOX[3] = {0.5, 0.5, 0.35}, SIDE = 0.15, FOCAL = 620, FRAME = 1.0 / 30;
/* Camera heights in metres, at heights that the box's top passes. The hull of the top is flat only if a camera looks
   along it; from other heights it is a tent. */
static const dReal CAMERA_HEIGHT[VIEWS] = {0.35, 0.35, 0.42, 0.35, 0.5, 0.35, 0.62};

static dWorldID world;
static dJointGroupID contacts;

/* The projection matrix K [R | t] of a horizontal camera 3 m from the middle. */
static void projection(int view, dReal P[12]) {
  const dReal angle = 2 * M_PI * view / VIEWS, c = cos(angle), s = sin(angle), h = CAMERA_HEIGHT[view];
  const dReal right[4] = {-s, c, 0, 0}, down[4] = {0, 0, -1, h}, forward[4] = {-c, -s, 0, 3};
  int k;

  for (k = 0; k < 4; k++) {
    P[k] = FOCAL * right[k] + WIDTH / 2 * forward[k];
    P[4 + k] = FOCAL * down[k] + HEIGHT / 2 * forward[k];
    P[8 + k] = forward[k];
  }
}

/* Draws the silhouette of the real box: the convex hull of its corners' images, with coverage at the edges. */
static void draw(int view, dReal lift, dReal tilt, unsigned char *mask) {
  dReal P[12], corner[8][2], line[56][3];
  int i, j, k, lines = 0, row, column;

  /* The corners of the lifted and tilted box in the image. */
  projection(view, P);
  for (i = 0; i < 8; i++) {
    const dReal x = (i & 1 ? 0.5 : -0.5) * REAL_BOX[0], y = (i & 2 ? 0.5 : -0.5) * REAL_BOX[1];
    const dReal z = i & 4 ? REAL_BOX[2] : 0, c = cos(tilt), s = sin(tilt);
    const dReal p[4] = {c * x + s * z, y, c * z - s * x + lift, 1};
    dReal image[3] = {0, 0, 0};
    for (j = 0; j < 3; j++)
      for (k = 0; k < 4; k++) image[j] += P[4 * j + k] * p[k];
    corner[i][0] = image[0] / image[2], corner[i][1] = image[1] / image[2];
  }

  /* The lines through two corners that have all corners on one side, as unit normal and offset. */
  for (i = 0; i < 8; i++)
    for (j = 0; j < 8; j++) {
      const dReal u = corner[j][0] - corner[i][0], v = corner[j][1] - corner[i][1], length = sqrt(u * u + v * v);
      if (length < 1e-6) continue;
      line[lines][0] = -v / length, line[lines][1] = u / length;
      line[lines][2] = (v * corner[i][0] - u * corner[i][1]) / length;
      for (k = 0; k < 8; k++)
        if (line[lines][0] * corner[k][0] + line[lines][1] * corner[k][1] + line[lines][2] < -1e-6) break;
      if (k == 8) lines++;
    }

  /* The coverage of a pixel follows from the distance of its centre to the nearest line. */
  for (row = 0; row < HEIGHT; row++)
    for (column = 0; column < WIDTH; column++) {
      dReal inside = 1; /* approximate part of the pixel that is covered */
      for (k = 0; k < lines && inside > 0; k++)
        inside = fmin(inside, line[k][0] * (column + 0.5) + line[k][1] * (row + 0.5) + line[k][2] + 0.5);
      mask[row * WIDTH + column] = inside > 0 ? (unsigned char)(255 * inside) : 0;
    }
}

static void near_callback(void *data, dGeomID o1, dGeomID o2) {
  dContact contact[8];
  int k, n = dCollide(o1, o2, 8, &contact[0].geom, sizeof(dContact));

  (void)data;
  for (k = 0; k < n; k++) {
    memset(&contact[k].surface, 0, sizeof contact[k].surface);
    contact[k].surface.mode = dContactApprox1;
    contact[k].surface.mu = 0.5;
    dJointAttach(dJointCreateContact(world, contacts, &contact[k]), dGeomGetBody(o1), dGeomGetBody(o2));
  }
}

int main(void) {
  static unsigned char mask[HEIGHT * WIDTH];
  const dReal bounds[6] = {-0.8, 0.8, -0.8, 0.8, -0.1, 1.4};
  dBodyID box[BOXES];
  dVisualHullDataID data;
  dSpaceID space;
  int k, view, frame;

  dInitODE2(0);
  if (!dInitVisualHull()) {
    fprintf(stderr, "%s\n", dVisualHullGetErrorMessage());
    return 1;
  }

  world = dWorldCreate();
  dWorldSetGravity(world, 0, 0, -9.81);
  dWorldSetCFM(world, 1e-5);
  dWorldSetContactSurfaceLayer(world, 0.001);
  dWorldSetQuickStepNumIterations(world, 50);
  space = dHashSpaceCreate(0);
  contacts = dJointGroupCreate(0);
  dCreatePlane(space, 0, 0, 1, 0);

  /* The real box: its views, its work volume, and a geom that represents it. */
  data = dGeomVisualHullDataCreate();
  for (view = 0; view < VIEWS; view++) {
    dReal P[12];
    projection(view, P);
    dGeomVisualHullDataAddView(data, P, WIDTH, HEIGHT);
  }
  dGeomVisualHullDataSetBounds(data, bounds);
  dCreateVisualHull(space, data);

  /* The virtual boxes, stacked on the real one. */
  for (k = 0; k < BOXES; k++) {
    dMass mass;
    dGeomID geom = dCreateBox(space, SIDE, SIDE, SIDE);
    dMassSetBox(&mass, 120, SIDE, SIDE, SIDE);
    box[k] = dBodyCreate(world);
    dBodySetMass(box[k], &mass);
    dGeomSetBody(geom, box[k]);
    dBodySetPosition(box[k], 0, 0, REAL_BOX[2] + SIDE * (k + 0.5) + 0.001);
  }

  puts("   time     lift     tilt  height of each virtual box");
  for (frame = 0; frame <= 180; frame++) {
    /* The real box rests for two seconds, then rises by 0.25 m and tilts by 28 degrees within two more. */
    const dReal time = frame * FRAME, at = fmin(fmax((time - 2) / 2, 0), 1), part = at * at * (3 - 2 * at);

    for (view = 0; view < VIEWS; view++) {
      draw(view, 0.25 * part, 28 * M_PI / 180 * part, mask);
      if (!dGeomVisualHullDataSetMask(data, view, mask, WIDTH)) fprintf(stderr, "%s\n", dVisualHullGetErrorMessage());
    }
    dGeomVisualHullDataUpdate(data, time); /* the hull's geom now collides with the new silhouettes */

    for (k = 0; k < STEPS_PER_FRAME; k++) {
      dSpaceCollide(space, 0, near_callback);
      dWorldQuickStep(world, FRAME / STEPS_PER_FRAME);
      dJointGroupEmpty(contacts);
    }

    if (frame % 15 == 0) {
      printf("%5.1f s %6.3f m %4.0f deg", time, 0.25 * part, 28 * part);
      for (k = 0; k < BOXES; k++) printf("  %6.3f", dBodyGetPosition(box[k])[2]);
      puts(" m");
    }
  }

  dSpaceDestroy(space); /* destroys the hull's geom too, as any geom in it */
  dWorldDestroy(world);
  dJointGroupDestroy(contacts);
  dGeomVisualHullDataDestroy(data);
  dCloseVisualHull();
  dCloseODE();
  return 0;
}
