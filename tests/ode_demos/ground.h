/* Included before all else of a demo of ODE's: its ground, the plane z = 0, becomes a visual hull. */
#ifndef GROUND_H
#define GROUND_H

#include <ode/ode.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A hull whose top is z = 0, as far as bodies roll in a run; it ends the program where it cannot be made. */
dGeomID create_hull_ground(dSpaceID space);

/* To be called before ODE closes. */
void close_hull_ground(void);

#ifdef __cplusplus
}
#endif

#ifdef HULL_GROUND
#define dCreatePlane(space, a, b, c, d) create_hull_ground(space)
#define dCloseODE() (close_hull_ground(), dCloseODE())
#endif

#endif
