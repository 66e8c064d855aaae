/* A person walks up and topples a stack of virtual boxes.
 *
 * The simulation knows the person only by silhouettes in seven cameras, 30 times a second, and steps 120 times. Here
 * the program draws them itself, of capsules; with real cameras, masks of any segmentation replace draw(). */
#include <math.h>
#include <ode_visual_hull.h>
#include <stdio.h>
#include <string.h>

enum { VIEWS = 7, WIDTH = 640, HEIGHT = 480, BOXES = 5, LIMBS = 8, STEPS_PER_FRAME = 4, FRAMES = 135 };

static const dReal SIDE = 0.26, FOCAL = 560, FRAME = 1.0 / 30, STEP = 1.0 / 120;
static dWorldID world;
static dJointGroupID contacts;
typedef struct { dReal a[3], b[3], radius; } Limb; /* a capsule from a to b, in the world */

/* The person at a time: stands for a second, then walks along x, half a metre a second. */
static void pose(dReal time, Limb limb[LIMBS]) {
  const dReal walked = fmax(time - 1, 0), x = 0.55 * walked - 1, swing = sin(2 * M_PI * walked / 1.2);
  const Limb head = {{x, 0, 1.6}, {x, 0, 1.65}, 0.1}, trunk = {{x, 0, 1}, {x, 0, 1.4}, 0.13};
  int k;

  limb[0] = head, limb[1] = trunk;
  for (k = 0; k < 2; k++) {
    const dReal y = k ? -0.1 : 0.1, s = k ? -swing : swing, knee = x + 0.12 + 0.1 * s;
    const Limb thigh = {{x, y, 0.9}, {knee, y, 0.5}, 0.07}, shin = {{knee, y, 0.5}, {x + 0.18 * s, y, 0.06}, 0.055};
    const Limb arm = {{x, 2 * y, 1.35}, {x - 0.25 * s + 0.1, 2.1 * y, 0.9}, 0.045};
    limb[2 + 3 * k] = thigh, limb[3 + 3 * k] = shin, limb[4 + 3 * k] = arm;
  }
}

/* The projection matrix K [R | t] of a horizontal camera 3.6 m from the middle. */
static const dReal *projection(int view) {
  static dReal P[12];
  const dReal angle = 2 * M_PI * (view + 0.3) / VIEWS, c = cos(angle), s = sin(angle);
  const dReal right[4] = {-s, c, 0, 0}, down[4] = {0, 0, -1, 0.8 + 0.1 * view}, forward[4] = {-c, -s, 0, 3.6};
  int k;

  for (k = 0; k < 4; k++) {
    P[k] = FOCAL * right[k] + WIDTH / 2 * forward[k];
    P[4 + k] = FOCAL * down[k] + HEIGHT / 2 * forward[k];
    P[8 + k] = forward[k];
  }
  return P;
}

/* Draws the silhouette of the limbs, with coverage at the edges: in the image a capsule is very nearly one again. */
static void draw(int view, const Limb *limb, unsigned char *mask) {
  const dReal *P = projection(view);
  dReal end[2][3], h[3];
  int k, e, j, row, column;

  memset(mask, 0, WIDTH * HEIGHT);
  for (k = 0; k < LIMBS; k++) {
    dReal u, v, most, t, inside;
    for (e = 0; e < 2; e++) {
      const dReal *p = e ? limb[k].b : limb[k].a;
      for (j = 0; j < 3; j++) h[j] = P[4 * j] * p[0] + P[4 * j + 1] * p[1] + P[4 * j + 2] * p[2] + P[4 * j + 3];
      end[e][0] = h[0] / h[2], end[e][1] = h[1] / h[2], end[e][2] = FOCAL * limb[k].radius / h[2];
    }
    u = end[1][0] - end[0][0], v = end[1][1] - end[0][1], most = fmax(end[0][2], end[1][2]) + 1;
    for (row = 0; row < HEIGHT; row++)
      for (column = 0; column < WIDTH; column++) {
        const dReal x = column + 0.5 - end[0][0], y = row + 0.5 - end[0][1];
        if (fabs(x - u / 2) > fabs(u) / 2 + most || fabs(y - v / 2) > fabs(v) / 2 + most) continue;
        t = fmin(fmax((x * u + y * v) / fmax(u * u + v * v, 1e-9), 0), 1);
        inside = end[0][2] + t * (end[1][2] - end[0][2]) - hypot(x - t * u, y - t * v) + 0.5;
        j = row * WIDTH + column;
        mask[j] = (unsigned char)fmax(mask[j], 255 * fmin(fmax(inside, 0), 1));
      }
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
    dVisualHullSetContactMotion(&contact[k], STEP); /* the surface moves as the person does */
    dJointAttach(dJointCreateContact(world, contacts, &contact[k]), dGeomGetBody(o1), dGeomGetBody(o2));
  }
}

int main(void) {
  static unsigned char mask[HEIGHT * WIDTH];
  const dReal bounds[6] = {-1.6, 2, -1, 1, -0.1, 2};
  dBodyID box[BOXES];
  dVisualHullDataID data;
  dGeomID hull;
  dSpaceID space;
  dMass mass;
  Limb limb[LIMBS];
  int k, view, frame;

  dInitODE2(0);
  if (!dInitVisualHull()) return fprintf(stderr, "%s\n", dVisualHullGetErrorMessage()), 1;
  world = dWorldCreate();
  dWorldSetGravity(world, 0, 0, -9.81);
  dWorldSetERP(world, 0.05); /* the surface's speed moves bodies, not their depth */
  dWorldSetContactSurfaceLayer(world, 0.001);
  dWorldSetQuickStepNumIterations(world, 50);
  space = dHashSpaceCreate(0);
  contacts = dJointGroupCreate(0);
  dCreatePlane(space, 0, 0, 1, 0);

  data = dGeomVisualHullDataCreate();
  for (view = 0; view < VIEWS; view++) dGeomVisualHullDataAddView(data, projection(view), WIDTH, HEIGHT);
  dGeomVisualHullDataSetBounds(data, bounds);
  hull = dCreateVisualHull(space, data);
  dGeomVisualHullSetMotion(hull, dVisualHullMotionInterpolated);
  dGeomVisualHullSetSwept(hull, dVisualHullSweptOn);
  dMassSetBox(&mass, 120, SIDE, SIDE, SIDE);
  for (k = 0; k < BOXES; k++) {
    box[k] = dBodyCreate(world);
    dBodySetMass(box[k], &mass);
    dGeomSetBody(dCreateBox(space, SIDE, SIDE, SIDE), box[k]);
    dBodySetPosition(box[k], 0.1, 0, SIDE * (k + 0.5) + 0.001 * k);
  }
  puts("   time  x and height of each virtual box");
  for (frame = 0; frame < FRAMES; frame++) {
    pose(frame * FRAME, limb);
    for (view = 0; view < VIEWS; view++) {
      draw(view, limb, mask);
      if (!dGeomVisualHullDataSetMask(data, view, mask, WIDTH)) puts(dVisualHullGetErrorMessage());
    }
    dGeomVisualHullDataPublish(data, frame * FRAME);
    for (k = 0; k < STEPS_PER_FRAME; k++) {
      dGeomVisualHullSetTime(hull, frame * FRAME + k * STEP);
      dSpaceCollide(space, 0, near_callback);
      dWorldQuickStep(world, STEP);
      dJointGroupEmpty(contacts);
    }
    if (frame % 15 != 0) continue;
    printf("%6.2f s", frame * FRAME);
    for (k = 0; k < BOXES; k++) printf("  %5.2f %4.2f", dBodyGetPosition(box[k])[0], dBodyGetPosition(box[k])[2]);
    puts("");
  }
  for (k = 0, frame = 0; k < BOXES; k++) frame += dBodyGetPosition(box[k])[2] < SIDE;
  printf("%d of %d boxes lie on the floor\n", frame, BOXES);
  dWorldDestroy(world);
  dSpaceDestroy(space);
  dGeomVisualHullDataDestroy(data);
  dCloseVisualHull();
  dCloseODE();
  return 0;
}
