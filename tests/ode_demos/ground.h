/* Included before everything else in a demo of ODE: replaces its ground, the plane z = 0, by a visual hull. */
#ifndef GROUND_H
#define GROUND_H

#include <ode/ode.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Creates a hull whose top is z = 0, as far as bodies roll in a run. Ends the program if this fails. */
dGeomID create_hull_ground(dSpaceID space);

/* Has to be called before ODE closes. */
void close_hull_ground(void);

#ifdef __cplusplus
}
#endif

#ifdef HULL_GROUND
#define dCreatePlane(space, a, b, c, d) create_hull_ground(space)
#define dCloseODE() (close_hull_ground(), dCloseODE())
#endif

#endif
