/* The class beside others: a program's own colliders, and a second copy of this library in the process. */
#ifndef _GNU_SOURCE
#define _GNU_SOURCE /* dladdr */
#endif
#include "check.h"
#include "scene.h"

#include <dlfcn.h>
#include <unistd.h>

static int nothing(dGeomID a, dGeomID b, int flags, dContactGeom *contacts, int skip) {
  (void)a, (void)b, (void)flags, (void)contacts, (void)skip;
  return 0;
}

static int works(dGeomID hull) {
  dContactGeom contacts[8];
  dGeomID cube = dCreateBox(0, 0.2, 0.2, 0.2);
  int n;
  dGeomSetPosition(cube, 0, 0, TOP + 0.096);
  n = dCollide(hull, cube, 8, contacts, sizeof *contacts);
  dGeomDestroy(cube);
  return n > 0;
}

/* How often the class has one number and its old and new hulls work. */
static void class_stays(int number, dGeomID hull, dVisualHullDataID data) {
  int k;
  for (k = 0; k < 6; k++) {
    dGeomID fresh = dCreateVisualHull(0, data);
    CHECK(dInitVisualHull() && dGetVisualHullClass() == number);
    CHECK(works(hull) && works(fresh));
    dGeomDestroy(fresh);
    dCloseVisualHull();
  }
}

static void programs_may_override_colliders_of_their_own(int number, dGeomID hull, dVisualHullDataID data) {
  dSetColliderOverride(dRayClass, dRayClass, &nothing);
  class_stays(number, hull, data);
  dSetColliderOverride(dPlaneClass, dPlaneClass, &nothing);
  class_stays(number, hull, data);
  dSetColliderOverride(dSphereClass, dSphereClass, &nothing);
  class_stays(number, hull, data);
}

/* Copies the shared library, if this program uses it, into the library's own folder, and loads the copy. */
static void *second_copy(char path[4200]) {
  Dl_info info;
  char command[8400];
  CHECK(dladdr((void *)&dInitVisualHull, &info));
  if (!strstr(info.dli_fname, ".so")) return NULL;
  sprintf(path, "%.4096s.copy_%d", info.dli_fname, (int)getpid());
  sprintf(command, "cp '%.4096s' '%s'", info.dli_fname, path);
  CHECK(system(command) == 0);
  return dlopen(path, RTLD_NOW | RTLD_LOCAL);
}

static void copies_recognise_each_other(int number, dGeomID hull, dVisualHullDataID data) {
  char path[4200];
  int (*init)(void), (*get_class)(void), k;
  void *library = second_copy(path);
  dGeomID rays[2], planes[2];
  dContactGeom contact;
  if (!library) return;
  unlink(path);

  *(void **)&init = dlsym(library, "dInitVisualHull");
  *(void **)&get_class = dlsym(library, "dGetVisualHullClass");
  CHECK(init() && get_class() == number + 1);
  for (k = 0; k < 6; k++) CHECK(init() && get_class() == number + 1 && dGetVisualHullClass() == number);
  class_stays(number, hull, data);

  /* Unloaded, but ODE still has addresses of its functions. */
  dlclose(library);
  rays[0] = dCreateRay(0, 1), rays[1] = dCreateRay(0, 1);
  planes[0] = dCreatePlane(0, 0, 0, 1, 0), planes[1] = dCreatePlane(0, 0, 0, 1, 0);
  CHECK(dCollide(rays[0], rays[1], 1, &contact, sizeof contact) == 0);
  CHECK(dCollide(planes[0], planes[1], 1, &contact, sizeof contact) == 0);
  for (k = 0; k < 2; k++) dGeomDestroy(rays[k]), dGeomDestroy(planes[k]);
  class_stays(number, hull, data);
}

int main(void) {
  dVisualHullDataID data;
  dGeomID hull;
  int number;
  CHECK(dInitODE2(0) && dInitVisualHull());
  number = dGetVisualHullClass();
  data = table_data(), hull = dCreateVisualHull(0, data);

  copies_recognise_each_other(number, hull, data);
  programs_may_override_colliders_of_their_own(number, hull, data);

  dGeomDestroy(hull);
  dGeomVisualHullDataDestroy(data);
  dCloseVisualHull();
  dCloseODE();
  return 0;
}
