/* Contact events: a touch begins and ends once for each body, whichever threads collide. */
#include "check.h"
#include "scene.h"

#include <math.h>
#include <pthread.h>

enum { BOXES = 12, THREADS = 4, MOST = 64 };
#define STEP 0.01
#define SIDE 0.06

/* Boxes that lie on the table in two rows and are lifted off it, without a world that steps. */
typedef struct {
  dVisualHullDataID data;
  dWorldID world;
  dGeomID hull, boxes[BOXES];
} Scene;

static Scene new_scene(void) {
  Scene scene;
  int k;

  scene.data = table_data();
  scene.world = dWorldCreate();
  scene.hull = dCreateVisualHull(0, scene.data);
  dGeomVisualHullSetEvents(scene.hull, 1);
  for (k = 0; k < BOXES; k++) {
    dBodyID body = dBodyCreate(scene.world);
    scene.boxes[k] = dCreateBox(0, SIDE, SIDE, SIDE);
    dGeomSetBody(scene.boxes[k], body);
  }
  return scene;
}

static void destroy_scene(Scene *scene) {
  int k;
  for (k = 0; k < BOXES; k++) dGeomDestroy(scene->boxes[k]);
  dGeomDestroy(scene->hull);
  dWorldDestroy(scene->world);
  dGeomVisualHullDataDestroy(scene->data);
}

/* Puts a box on the table, 5 mm deep, or above it; it moves down at 0.1 m/s for each box before it. */
static void put(const Scene *scene, int box, int touches) {
  dBodyID body = dGeomGetBody(scene->boxes[box]);
  const dReal z = TOP + SIDE / 2 - 0.005 + (touches ? 0 : 0.1);
  dBodySetPosition(body, -0.2 + 0.08 * (box % 6), box < 6 ? -0.1 : 0.1, z);
  dBodySetLinearVel(body, 0, 0, -0.1 * box);
}

static int collide(dGeomID a, dGeomID b) {
  dContactGeom contacts[8];
  return dCollide(a, b, 8, contacts, sizeof(dContactGeom));
}

static void a_touch_begins_and_ends_once(void) {
  Scene scene = new_scene();
  dVisualHullEvent events[MOST];
  int step, count, begun = 0, ended = 0;

  for (step = 0; step < 60; step++) {
    CHECK(dGeomVisualHullSetTime(scene.hull, step * STEP));
    /* Gaps of up to five steps are shorter than the wait of ten. */
    put(&scene, 3, step >= 5 && step < 30 && step % 6 == 0);
    collide(scene.hull, scene.boxes[3]);
    count = dGeomVisualHullGetEvents(scene.hull, events, MOST);
    CHECK(count == 0 || count == 1);
    if (count == 1) {
      const dVisualHullEvent *event = &events[0];
      const int begins = event->kind == dVisualHullEventBegin;
      CHECK(begins || event->kind == dVisualHullEventEnd);
      CHECK(event->part == 1 && event->body == dGeomGetBody(scene.boxes[3]) && event->geom == scene.boxes[3]);
      CHECK(fabs(event->time - (begins ? 6 : 24) * STEP) < 1e-12);
      CHECK(step == (begins ? 6 : 35));
      CHECK(fabs(event->position[2] - TOP) < 0.005 + PIXEL && event->normal[2] > 0.999);
      CHECK(fabs(event->depthRate - 0.3) < 0.001);
      begun += begins, ended += !begins;
    }
  }
  CHECK(begun == 1 && ended == 1);
  destroy_scene(&scene);
}

static void events_that_do_not_fit_wait_for_the_next_call(void) {
  Scene scene = new_scene();
  dVisualHullEvent events[MOST], all[MOST];
  int k, count = 0;

  CHECK(dGeomVisualHullSetTime(scene.hull, 0));
  for (k = 0; k < BOXES; k++) {
    put(&scene, k, 1);
    CHECK(collide(scene.boxes[k], scene.hull) > 0);
  }
  CHECK(dGeomVisualHullGetEvents(scene.hull, NULL, 0) == BOXES);
  CHECK(dGeomVisualHullGetEvents(scene.hull, events, 0) == BOXES);
  memset(events, 0, sizeof events);
  CHECK(dGeomVisualHullGetEvents(scene.hull, events, 5) == 5 && events[5].geom == NULL);
  memcpy(all, events, 5 * sizeof *all), count = 5;
  CHECK(dGeomVisualHullGetEvents(scene.hull, NULL, 0) == BOXES - 5);
  CHECK(dGeomVisualHullGetEvents(scene.hull, all + count, MOST - count) == BOXES - 5);
  CHECK(dGeomVisualHullGetEvents(scene.hull, events, MOST) == 0);

  /* Each box has begun once. */
  for (k = 0; k < BOXES; k++) {
    int touches = 0, n;
    for (n = 0; n < BOXES; n++) touches += all[n].geom == scene.boxes[k] && all[n].kind == dVisualHullEventBegin;
    CHECK(touches == 1);
  }
  destroy_scene(&scene);
}

static void what_cannot_be_fetched_is_refused(void) {
  Scene scene = new_scene();
  dVisualHullEvent event;

  CHECK_REFUSED(dGeomVisualHullGetEvents(scene.hull, &event, -1), -1, "size");
  CHECK_REFUSED(dGeomVisualHullGetEvents(scene.hull, NULL, 1), -1, "expected memory for 1 events, found NULL");
  CHECK_REFUSED(dGeomVisualHullGetEvents(NULL, &event, 1), -1, "expected a visual hull, found NULL");
  CHECK_REFUSED(dGeomVisualHullGetEvents(scene.boxes[0], &event, 1), -1, "expected a visual hull");
  CHECK_REFUSED_VOID(dGeomVisualHullSetEvents(scene.boxes[0], 1), "expected a visual hull");
  CHECK_REFUSED_VOID(dGeomVisualHullSetEventWait(scene.hull, -0.1), "event wait");
  CHECK_REFUSED_VOID(dGeomVisualHullSetEventWait(scene.hull, NAN), "event wait");
  dGeomVisualHullSetEvents(scene.hull, 0);
  CHECK_REFUSED(dGeomVisualHullGetEvents(scene.hull, &event, 1), -1, "found them off");
  destroy_scene(&scene);
}

static void without_a_time_the_calls_count_the_steps_and_where_none_is_known_it_is_said(void) {
  Scene scene = new_scene();
  dBodyID body = dGeomGetBody(scene.boxes[0]);
  dVisualHullEvent event;
  dReal z = TOP + SIDE / 2 + 0.0405;
  int step, count = 0;

  /* A box that falls into the table and rises again by its velocity, which tells the length of a step. */
  dBodySetLinearVel(body, 0, 0, -0.5);
  for (step = 0; step < 60; step++) {
    if (step == 10) dBodySetLinearVel(body, 0, 0, 0.5);
    dBodySetPosition(body, 0, 0, z);
    z += dBodyGetLinearVel(body)[2] * STEP;
    collide(scene.hull, scene.boxes[0]);
    while (dGeomVisualHullGetEvents(scene.hull, &event, 1) == 1) {
      CHECK(event.kind == count++);
      if (count == 1) CHECK(fabs(event.depthRate - 0.5) < 0.001);
    }
  }
  CHECK(count == 2);
  destroy_scene(&scene);

  /* A box without velocity, and one frame. */
  scene = new_scene();
  forget_message();
  for (step = 0; step < 30; step++) {
    put(&scene, 0, step < 3);
    collide(scene.hull, scene.boxes[0]);
    CHECK(dGeomVisualHullGetEvents(scene.hull, &event, 1) == (step == 0));
  }
  CHECK_MESSAGE("no touch can end");
  destroy_scene(&scene);
}

static void destroyed_bodies_and_hulls_are_not_followed(void) {
  Scene scene = new_scene();
  dGeomID ghost = scene.boxes[BOXES - 1];
  dBodyID body = dGeomGetBody(ghost);
  dVisualHullEvent events[MOST];
  int step, ended = 0;

  for (step = 0; step < 30; step++) {
    CHECK(dGeomVisualHullSetTime(scene.hull, step * STEP));
    put(&scene, 0, 1), collide(scene.hull, scene.boxes[0]);
    if (step < 5) {
      put(&scene, BOXES - 1, 1);
      CHECK(collide(scene.hull, ghost) > 0);
    }
    if (step == 4) {
      /* Before the events of this step are fetched. */
      dBodyDestroy(body), dGeomDestroy(ghost);
      scene.boxes[BOXES - 1] = dCreateBox(0, SIDE, SIDE, SIDE);
    }
    {
      const int count = dGeomVisualHullGetEvents(scene.hull, events, MOST);
      int k;
      for (k = 0; k < count; k++)
        if (events[k].kind == dVisualHullEventEnd) {
          CHECK(events[k].body == body && events[k].geom == ghost && fabs(events[k].time - 4 * STEP) < 1e-12);
          ended++;
        }
    }
  }
  CHECK(ended == 1);

  /* Other data ends the touch of the other box. */
  {
    dVisualHullDataID other = table_data();
    dGeomVisualHullSetData(scene.hull, other);
    CHECK(dGeomVisualHullGetEvents(scene.hull, events, MOST) == 1 && events[0].kind == dVisualHullEventEnd);
    collide(scene.hull, scene.boxes[0]);
    CHECK(dGeomVisualHullGetEvents(scene.hull, events, MOST) == 1 && events[0].kind == dVisualHullEventBegin);
    CHECK(events[0].part == 2);
    dGeomVisualHullDataDestroy(scene.data);
    scene.data = other;
  }
  destroy_scene(&scene);
}

/* The part of the boxes that a thread collides with the hull. */
typedef struct {
  const Scene *scene;
  int first, stride;
} Share;

static void *collide_share(void *data) {
  const Share *share = (const Share *)data;
  int k;

  CHECK(dAllocateODEDataForThread(dAllocateMaskAll));
  for (k = share->first; k < BOXES; k += share->stride) collide(share->scene->hull, share->scene->boxes[k]);
  dCleanupODEAllDataForThread();
  return data;
}

/* Lifts boxes off the table and puts them on it again while `threads` threads collide them. Returns how many events there
   were. */
static int play(int threads, dVisualHullEvent *found, int *boxes) {
  Scene scene = new_scene();
  int step, k, count = 0;

  for (step = 0; step < 80; step++) {
    pthread_t handles[THREADS];
    Share shares[THREADS];
    CHECK(dGeomVisualHullSetTime(scene.hull, step * STEP));
    for (k = 0; k < BOXES; k++) put(&scene, k, (step + 7 * k) % 40 < 20);
    for (k = 0; k < threads; k++) {
      shares[k].scene = &scene, shares[k].first = threads - 1 - k, shares[k].stride = threads;
      CHECK(pthread_create(&handles[k], NULL, collide_share, &shares[k]) == 0);
    }
    for (k = 0; k < threads; k++) CHECK(pthread_join(handles[k], NULL) == 0);
    count += dGeomVisualHullGetEvents(scene.hull, found + count, MOST - count);
  }
  CHECK(count < MOST);
  for (k = 0; k < count; k++)
    for (boxes[k] = 0; scene.boxes[boxes[k]] != found[k].geom; boxes[k]++) CHECK(boxes[k] < BOXES);
  destroy_scene(&scene);
  return count;
}

static void events_do_not_depend_on_the_number_of_threads(void) {
  static dVisualHullEvent alone[MOST], shared[MOST];
  int boxes_alone[MOST], boxes[MOST], threads, k;
  const int count = play(1, alone, boxes_alone);

  /* Boxes are on the table for 20 steps of 40, at different times: two begins and one end or two each. */
  CHECK(count >= 3 * BOXES);
  for (threads = 2; threads <= THREADS; threads++) {
    CHECK(play(threads, shared, boxes) == count);
    for (k = 0; k < count; k++) {
      CHECK(shared[k].kind == alone[k].kind && shared[k].part == alone[k].part && boxes[k] == boxes_alone[k]);
      CHECK(shared[k].time == alone[k].time && shared[k].depthRate == alone[k].depthRate);
      CHECK(memcmp(shared[k].position, alone[k].position, sizeof(dVector3)) == 0);
      CHECK(memcmp(shared[k].normal, alone[k].normal, sizeof(dVector3)) == 0);
    }
  }
}

int main(void) {
  CHECK(dInitODE2(0) && dInitVisualHull());
  CHECK(dAllocateODEDataForThread(dAllocateMaskAll));
  a_touch_begins_and_ends_once();
  events_that_do_not_fit_wait_for_the_next_call();
  what_cannot_be_fetched_is_refused();
  without_a_time_the_calls_count_the_steps_and_where_none_is_known_it_is_said();
  destroyed_bodies_and_hulls_are_not_followed();
  events_do_not_depend_on_the_number_of_threads();
  dCloseVisualHull();
  dCloseODE();
  return 0;
}
