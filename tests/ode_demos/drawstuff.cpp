/* ODE's drawing library without a window. Its loop runs for the number of steps in the program's second argument and drops
   100 bodies of the kind in the first, one every 20 steps. The poses of the geoms come from the drawing calls. At the end
   it prints the number of bodies below the ground, the lowest point then, and the lowest point of all steps. */
#include <drawstuff/drawstuff.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

namespace {

const int BODIES = 100, STEPS_BETWEEN = 20;

struct Step {
  double lowest;
  int beneath, drawn;
};

Step now;

/* Records a geom whose centre is at `pos` and whose lowest point lies `below` under the centre. */
void record(const double pos[3], double below) {
  now.drawn++;
  /* These comparisons count NaN as below. */
  if (!(pos[2] >= 0)) now.beneath++;
  if (!(pos[2] - below >= now.lowest)) now.lowest = pos[2] - below;
}

}  // namespace

void dsSimulationLoop(int argc, char **argv, int, int, dsFunctions *demo) {
  if (argc != 3) {
    fprintf(stderr, "usage: %s b|s|c|y|v STEPS\n", argv[0]);
    exit(2);
  }
  double lowest_ever = INFINITY;
  demo->start();
  for (int step = 0, dropped = 0; step < atoi(argv[2]); step++) {
    if (step % STEPS_BETWEEN == 0 && dropped < BODIES) demo->command(argv[1][0]), dropped++;
    now = {INFINITY, 0, 0};
    demo->step(0);
    if (now.lowest < lowest_ever) lowest_ever = now.lowest;
  }
  if (now.drawn != BODIES) fprintf(stderr, "expected %d geoms drawn, found %d\n", BODIES, now.drawn), exit(2);
  printf("result %d %.6f %.6f\n", now.beneath, now.lowest, lowest_ever);
}

void dsDrawBoxD(const double pos[3], const double R[12], const double sides[3]) {
  record(pos, 0.5 * (fabs(R[8]) * sides[0] + fabs(R[9]) * sides[1] + fabs(R[10]) * sides[2]));
}

void dsDrawSphereD(const double pos[3], const double *, float radius) { record(pos, radius); }

void dsDrawCapsuleD(const double pos[3], const double R[12], float length, float radius) {
  record(pos, 0.5 * fabs(R[10]) * length + radius);
}

void dsDrawCylinderD(const double pos[3], const double R[12], float length, float radius) {
  record(pos, 0.5 * fabs(R[10]) * length + radius * hypot(R[8], R[9]));
}

void dsDrawConvexD(const double pos[3], const double R[12], const double *, unsigned, const double *points,
                   unsigned count, const unsigned *) {
  double below = 0;
  for (unsigned k = 0; k < count; k++)
    below = fmax(below, -(R[8] * points[3 * k] + R[9] * points[3 * k + 1] + R[10] * points[3 * k + 2]));
  record(pos, below);
}

void dsDrawTriangleD(const double *, const double *, const double *, const double *, const double *, int) {}
void dsDrawLineD(const double *, const double *) {}
void dsSetViewpoint(float *, float *) {}
void dsSetTexture(int) {}
void dsSetColor(float, float, float) {}
void dsSetColorAlpha(float, float, float, float) {}
