/*
 * ode_visual_hull.h - the visual hull of a real, moving subject as a geometry class of the Open Dynamics Engine.
 *
 * Several calibrated cameras see a subject. Each image gives a silhouette, and the silhouettes together define the
 * subject's visual hull. A geom of this class tests collisions with the hull directly in the images: the next step
 * collides with new silhouettes at once, and no mesh or voxel grid is rebuilt.
 *
 *     dInitODE2(0);
 *     dInitVisualHull();
 *     dVisualHullDataID data = dGeomVisualHullDataCreate();
 *     for (each camera) dGeomVisualHullDataAddView(data, P, width, height);
 *     dGeomVisualHullDataSetBounds(data, bounds);
 *     dGeomID hull = dCreateVisualHull(space, data);
 *     for (;;) {
 *         for (each camera) dGeomVisualHullDataSetMask(data, view, mask, width);
 *         dGeomVisualHullDataUpdate(data, time);
 *         dSpaceCollide(space, 0, &nearCallback);
 *         dWorldQuickStep(world, 0.01);
 *         dJointGroupEmpty(contacts);
 *     }
 *
 * Units are those of the ODE program; the defaults assume metres, seconds and radians. Camera axes: x right, y down,
 * z forward. Images: the upper left corner is (0, 0), pixel (i, j) covers [i, i+1) x [j, j+1), and its centre is
 * (i+0.5, j+0.5). Masks: one byte per pixel, from 0 for background to 255 for subject. A pixel is inside from 128 on;
 * values between 0 and 255 are the part of the pixel that the subject covers.
 *
 * Functions that can fail return nonzero, an id or an index on success, and 0, NULL or -1 on failure. After a failure
 * dVisualHullGetErrorMessage returns what was expected, what was found, and what to do. No function aborts or prints.
 * Ids that are NULL, stale or of another kind are refused and never dereferenced.
 *
 * A hull collides with spheres, boxes, capsules, cylinders, convex geoms, meshes and rays, alone or in a dGeomTransform,
 * and with geoms of other classes that have samples (dGeomVisualHullSetSamples). A hull against a plane, a heightfield
 * or another hull gives no contacts.
 *
 * ODE lets bodies sleep and wakes them only through contacts with bodies that are awake. This library wakes a sleeping
 * body when the hull's surface at it has moved, touches it first, or has left. It can do so only where the near callback
 * calls dCollide: a callback that skips pairs whose bodies all sleep never wakes any. As with any static geom, nothing
 * wakes bodies when the program disables or destroys a hull, or removes it from its space: call dBodyEnable for the bodies
 * on it.
 *
 * Collision detection keeps addresses of this library's functions in ODE, so the shared library stays loaded after
 * dlclose. Several copies of the library in one process take one of ODE's four user classes each.
 */
#ifndef _ODE_VISUAL_HULL_H_
#define _ODE_VISUAL_HULL_H_

#include <ode/ode.h>

#ifndef dDOUBLE
#error "ode_visual_hull.h needs an ODE of double precision, but <ode/precision.h> says single: its dReal would be read as \
double. Use Debian's libode-dev, or build ODE with --enable-double-precision, and check the order of the include paths."
#endif

#ifdef __cplusplus
extern "C" {
#endif

/** The version of this header; dVisualHullGetVersion returns the version of the library. */
#define dVISUAL_HULL_VERSION "0.1.0"

/** A data object: a subject's views and their masks, which any number of geoms may share. */
struct dxVisualHullData;
typedef struct dxVisualHullData *dVisualHullDataID;

/** How a view that does not see a point counts for it; see dGeomVisualHullDataSetUnseen. */
enum {
  dVisualHullUnseenOutside = 0, /**< The point is outside. The default. */
  dVisualHullUnseenAbstain = 1  /**< The view abstains, but at least minViews views must see a point that is inside. */
};

/** How contacts are computed from the colliding samples; see dGeomVisualHullSetContactMode. */
enum {
  dVisualHullContactsClustered = 0, /**< Clusters of samples with similar exit directions. The default. */
  dVisualHullContactsPaper = 1,     /**< One direction for the body, a depth for each sample, without a limit. */
  dVisualHullContactsPoint = 2,     /**< Each sample along its own exit direction. */
  dVisualHullContactsSingle = 3     /**< Only the deepest sample. */
};

/** Which hull a geom shows at the simulation's time; see dGeomVisualHullSetMotion. */
enum {
  dVisualHullMotionHeld = 0,         /**< The latest frame, until the next one. The default. */
  dVisualHullMotionInterpolated = 1, /**< The hull between the last two frames, one frame period late. */
  dVisualHullMotionPredicted = 2     /**< The latest frame, moved ahead by at most one frame period. */
};

/** Whether a hull collides with what it will meet within the next step; see dGeomVisualHullSetSwept. */
enum {
  dVisualHullSweptOff = 0,        /**< It does not. The default. */
  dVisualHullSweptBroadPhase = 1, /**< Its box holds all that it may meet within the next step. */
  dVisualHullSweptOn = 2          /**< In addition, what it will meet has contacts with it, which have not begun. */
};

/** What a contact event tells; see dGeomVisualHullGetEvents. */
enum {
  dVisualHullEventBegin = 0, /**< A touch has begun. */
  dVisualHullEventEnd = 1    /**< A touch has ended: there was no contact for the time of dGeomVisualHullSetEventWait. */
};

/** A touch of a body and a part of a hull has begun or ended; see dGeomVisualHullGetEvents. */
typedef struct dVisualHullEvent {
  int kind;          /**< one of dVisualHullEvent... */
  unsigned int part; /**< the part of the hull, from 1 on */
  dBodyID body;      /**< the body; NULL for a geom without one, also inside a dGeomTransform */
  dGeomID geom;      /**< the geom: of several geoms of the body, that of the deepest contact */
  dReal time;        /**< of the first or of the last contact, in seconds, by the clock of dGeomVisualHullSetTime */
  dVector3 position; /**< of the deepest contact of the first step, or of the whole touch, in the world */
  dVector3 normal;   /**< the unit normal of that contact, out of the hull, in the world */
  dReal depthRate;   /**< how fast the depth grew along the normal, per second: in the first step, or the most of all */
} dVisualHullEvent;

/**
 * @brief Opens the class: takes a reference to ODE (dInitODE2), checks that ODE computes in double precision, and
 * registers the geometry class.
 *
 * May be called any number of times; each call needs one dCloseVisualHull.
 *
 * @return Nonzero on success; 0 if ODE computes in single precision, or if all four user classes of ODE are taken.
 */
int dInitVisualHull(void);

/**
 * @brief Closes what one dInitVisualHull opened; the last call releases the reference to ODE.
 *
 * Destroy the geoms first, as before dCloseODE. Data objects remain until they are destroyed.
 */
void dCloseVisualHull(void);

/** @brief The class's number, which dGeomGetClass returns for a hull; -1 when the class is closed. */
int dGetVisualHullClass(void);

/**
 * @brief The error message of this thread's last call that failed; "" if none failed.
 *
 * A collision fails for a geom that cannot be sampled: dCollide then returns no contacts, and this function the reason.
 *
 * @return A string that is valid until the thread's next call of a function of this header.
 */
const char *dVisualHullGetErrorMessage(void);

/** @brief The library's version, such as "0.1.0". */
const char *dVisualHullGetVersion(void);

/**
 * @brief Creates a data object without views, without a work volume, and with the policy dVisualHullUnseenOutside.
 *
 * The caller destroys it with dGeomVisualHullDataDestroy. All functions on data objects may be called from any thread,
 * except dGeomVisualHullDataUpdate, which also changes geoms.
 *
 * @return The id.
 */
dVisualHullDataID dGeomVisualHullDataCreate(void);

/**
 * @brief Destroys a data object. Geoms bound to it keep its last frame until they are destroyed or bound to other data.
 */
void dGeomVisualHullDataDestroy(dVisualHullDataID d);

/**
 * @brief Adds a view, given by its projection matrix.
 *
 * @param d the data object
 * @param P 3x4, row-major, from homogeneous world to homogeneous image coordinates, of any scale; copied
 * @param width the image's width in pixels
 * @param height the image's height in pixels
 * @return The view's index, from 0; -1 if the matrix is singular or not finite, or a size is out of range.
 */
int dGeomVisualHullDataAddView(dVisualHullDataID d, const dReal P[12], int width, int height);

/**
 * @brief Adds a view, given by its camera with OpenCV's lens distortion.
 *
 * @param d the data object
 * @param K the intrinsic matrix, 3x3, row-major, in pixels; copied, as all arrays here. In OpenCV pixel centres have
 * integer coordinates: add 0.5 to its principal point.
 * @param R the rotation from world to camera, 3x3, row-major, without padding
 * @param t the translation, so that x_cam = R x_world + t
 * @param distortion k1 k2 p1 p2 [k3 [k4 k5 k6 [s1 s2 s3 s4 [taux tauy]]]]; may be NULL if nDistortion is 0
 * @param nDistortion 0, 4, 5, 8, 12 or 14
 * @param width the image's width in pixels
 * @param height the image's height in pixels
 * @return The view's index, from 0; -1 if the calibration is invalid.
 */
int dGeomVisualHullDataAddCamera(dVisualHullDataID d, const dReal K[9], const dReal R[9], const dReal t[3],
                                 const dReal *distortion, int nDistortion, int width, int height);

/**
 * @brief Adds a view, given by its camera with OpenCV's fisheye lens.
 *
 * @param d the data object
 * @param K the intrinsic matrix, as for dGeomVisualHullDataAddCamera
 * @param R the rotation from world to camera, 3x3, row-major, without padding
 * @param t the translation, so that x_cam = R x_world + t
 * @param k k1 k2 k3 k4; may be NULL if nk is 0, and then all four are zero
 * @param nk 0 or 4
 * @param width the image's width in pixels
 * @param height the image's height in pixels
 * @return The view's index, from 0; -1 if the calibration is invalid, if the image shows rays at 90 degrees or more
 * from the camera's axis, or if the model folds back before the nearest border of the image.
 */
int dGeomVisualHullDataAddFisheyeCamera(dVisualHullDataID d, const dReal K[9], const dReal R[9], const dReal t[3],
                                        const dReal *k, int nk, int width, int height);

/**
 * @brief Adds all views of a calibration file, the TOML of anipose, Pose2Sim and caliscope.
 *
 * @return The number of views in the file; 0 if it cannot be read or is invalid, and then no view is added.
 */
int dGeomVisualHullDataLoadRig(dVisualHullDataID d, const char *path);

/** @brief The number of views; -1 on failure. */
int dGeomVisualHullDataGetViewCount(dVisualHullDataID d);

/**
 * @brief Sets the work volume: points outside of it are outside the hull. It must be set before the first update.
 *
 * @param d the data object
 * @param aabb min x, max x, min y, max y, min z, max z, in the hull's frame, in the order of dGeomGetAABB
 */
int dGeomVisualHullDataSetBounds(dVisualHullDataID d, const dReal aabb[6]);

/**
 * @brief Sets how a view that does not see a point counts for it.
 *
 * @param d the data object
 * @param policy dVisualHullUnseenOutside or dVisualHullUnseenAbstain
 * @param minViews for dVisualHullUnseenAbstain, the number of views that must see a point that is inside; usually 2
 */
int dGeomVisualHullDataSetUnseen(dVisualHullDataID d, int policy, int minViews);

/**
 * @brief Sets a view's next mask, which takes effect with dGeomVisualHullDataUpdate. A view without a new mask keeps
 * its last one.
 *
 * The mask is read in place and prepared on the calling thread. The caller may reuse the buffer when the call returns.
 *
 * @param d the data object
 * @param view the view's index
 * @param mask the first byte of the top row; rows follow from top to bottom
 * @param rowStride bytes from one row to the next, at least the image's width
 * @return Nonzero on success; 0 for an invalid mask, such as one that is all subject, and then the last valid mask
 * stays.
 */
int dGeomVisualHullDataSetMask(dVisualHullDataID d, int view, const unsigned char *mask, int rowStride);

/**
 * @brief Sets a view's next mask with the time of its exposure. A mask that dGeomVisualHullDataSetMask sets gets the
 * time of the first update that publishes it.
 *
 * @param d the data object
 * @param view the view's index
 * @param mask the first byte of the top row; rows follow from top to bottom
 * @param rowStride bytes from one row to the next, at least the image's width
 * @param time the time of exposure in seconds, finite and not before that of the view's last mask
 * @return Nonzero on success; 0 for an invalid mask or time, and then the last valid mask stays.
 */
int dGeomVisualHullDataSetMaskAt(dVisualHullDataID d, int view, const unsigned char *mask, int rowStride, dReal time);

/**
 * @brief Sets a view's next mask from an image file (PNG, JPEG, PNM): from its alpha channel if it has one, else from
 * its grey values.
 *
 * @return Nonzero on success; 0 for an invalid file or mask, and then the last valid mask stays.
 */
int dGeomVisualHullDataLoadMask(dVisualHullDataID d, int view, const char *path);

/**
 * @brief Disables a view (0), so that it abstains, or enables it (1). The change takes effect with
 * dGeomVisualHullDataUpdate.
 */
int dGeomVisualHullDataSetViewEnabled(dVisualHullDataID d, int view, int enabled);

/**
 * @brief Sets how old a view's latest mask may be. A view whose mask is older at the time of an update is late: it
 * abstains in that frame as a disabled view does, until an update has a newer mask of it.
 *
 * If every view is late, or disabled, the hull is empty. Where some are, the hull is larger, and bodies over which it
 * grows then are not pushed out: for them the last masks of these views stay valid.
 *
 * @param d the data object
 * @param seconds the largest age, finite and not negative; 0, the default, for any age
 * @return Nonzero on success; 0 for an invalid age, and then the last one stays.
 */
int dGeomVisualHullDataSetMaxAge(dVisualHullDataID d, dReal seconds);

/**
 * @brief Sets the corrections of masks, for those that are set from now on. Both are off by default.
 *
 * A weight below 1 averages the signed distances from the edges of a mask and of the ones before it, along the optical
 * flow, so that parts that move do not lag; what the flow cannot follow, such as a part that appears, lags by
 * (1 - w) / w masks on average.
 *
 * @param d the data object
 * @param smallestHole holes of fewer pixels than this are filled; 0 for none, 2000 suits images of 640x480
 * @param newWeight the weight of a new mask against the average so far, above 0 and at most 1; 1 for no average
 * @return Nonzero on success; 0 for an invalid value, and then the last ones stay.
 */
int dGeomVisualHullDataSetMaskFilter(dVisualHullDataID d, int smallestHole, dReal newWeight);

/**
 * @brief Sets the depth from which on all other views overrule one, from the next update on: against masks from which a
 * part of the subject is missing now and then.
 *
 * Where one view sees a point as background, or much nearer to it than the others do, and the point lies deeper by this
 * depth in each of at least three other views, the one view abstains. With few cameras the hull grows where one of them
 * alone cuts it off.
 *
 * @param d the data object
 * @param depth in metres, finite and not negative; 0, the default, for never, 0.02 suits seven cameras or more
 * @return Nonzero on success; 0 for an invalid depth, and then the last one stays.
 */
int dGeomVisualHullDataSetOverruleDepth(dVisualHullDataID d, dReal depth);

/**
 * @brief Publishes the latest masks of all views as the frame of the given time, in seconds. Bound geoms collide with
 * this frame from now on.
 *
 * The call is cheap. Make it on the thread that runs the simulation, between two collides: it marks the bounding boxes
 * of all bound geoms as changed, which ODE forbids inside a near callback. Where worlds on several threads have geoms of
 * one data object, use dGeomVisualHullDataPublish and dGeomVisualHullUpdate instead.
 *
 * @return Nonzero on success; 0 if a view has no mask, if there are no bounds, or if the time is before the last
 * frame's, and then the last frame stays in use.
 */
int dGeomVisualHullDataUpdate(dVisualHullDataID d, dReal time);

/**
 * @brief As dGeomVisualHullDataUpdate, but bound geoms do not collide with the frame until dGeomVisualHullUpdate is
 * called for each. May be called from any thread.
 */
int dGeomVisualHullDataPublish(dVisualHullDataID d, dReal time);

/**
 * @brief Creates a geom of the class, bound to a data object. It is placeable, at the origin and without a body.
 *
 * dGeomDestroy or the destruction of its space destroys it, as any geom. Its pose is the transform from the cameras'
 * world frame to ODE's world, so it moves the subject as the cameras see it. It may be inside a dGeomTransform; after
 * dGeomVisualHullDataSetBounds or dGeomVisualHullSetData, call dGeomMoved for the transform, whose box ODE keeps.
 *
 * @param space the space to add the geom to; may be 0
 * @param d the data object
 * @return The geom; 0 on failure.
 */
dGeomID dCreateVisualHull(dSpaceID space, dVisualHullDataID d);

/**
 * @brief Lets a hull collide with the latest frame of its data object from now on. Call it between two collides, on the
 * thread that steps the geom's world. Calling it without a new frame is allowed and changes nothing.
 *
 * @return Nonzero on success; 0 if the geom is no visual hull.
 */
int dGeomVisualHullUpdate(dGeomID g);

/** @brief Binds a hull to another data object, and releases it: see dGeomVisualHullHold. Call it between two collides only. */
void dGeomVisualHullSetData(dGeomID g, dVisualHullDataID d);

/** @brief The data object that a hull is bound to; NULL if that was destroyed, and on failure. */
dVisualHullDataID dGeomVisualHullGetData(dGeomID g);

/**
 * @brief Sets which hull a geom shows at the simulation's time, from the next frame or dGeomVisualHullSetTime on.
 *
 * dVisualHullMotionHeld shows the latest frame: a surface that moves stands still for a frame period and then jumps.
 * dVisualHullMotionInterpolated moves it evenly and shows at time t what the cameras saw at t less the period, which
 * is the time between the last two frames. dVisualHullMotionPredicted moves the latest frame ahead to t; it is not
 * late, and wrong where the subject changes its speed. Both show the latest frame while it is the only one, and where
 * two masks of a view have equal times or are more than 0.5 seconds apart.
 *
 * @param g the hull
 * @param mode one of dVisualHullMotion...; the geom keeps its mode, with a message, if it is another number
 */
void dGeomVisualHullSetMotion(dGeomID g, int mode);

/**
 * @brief Sets the simulation's time for the collides that follow, by the clock of the frames' times, and lets the hull
 * collide with its shape at that time.
 *
 * Call it before each collide, between two collides, on the thread that steps the geom's world. It does what
 * dGeomVisualHullUpdate does too: a program that publishes its frames by dGeomVisualHullDataPublish computes each shape
 * once. A time beyond the frames is no failure: the hull stays as it was at the nearest time that the mode allows.
 *
 * @param g the hull
 * @param time in seconds, finite and not before the last one since the geom was bound to its data object
 * @return 1 on success; 0 if the geom is no visual hull or the time is invalid, and then the last time stays.
 */
int dGeomVisualHullSetTime(dGeomID g, dReal time);

/**
 * @brief Sets whether a hull collides with what it will meet within the next step, so that nothing fast passes through
 * between two collides.
 *
 * The hull moves ahead as its silhouettes do where its mode is dVisualHullMotionInterpolated or
 * dVisualHullMotionPredicted, and stands still otherwise; bodies move at their velocities. Call dGeomVisualHullSetTime
 * before each collide, also for a hull that is held: it tells the length of a step, and finds how fast the bodies are, by
 * which the hull's box grows. Bodies are looked for in the space of the hull and in those around and inside it, but not in
 * quadtrees.
 *
 * With dVisualHullSweptOn, dCollide returns up to 4 more contacts for a body that will meet the hull. Their depth is 0,
 * their position is where the body's surface is now, and dGeomVisualHullContactTime tells how long it takes. Pass all
 * contacts to dVisualHullSetContactMotion, which lets such a body go on until it touches; without it, the body stops where
 * it is. A body that slides off the hull while it touches it has its contact in the step after that, so that it loses the
 * rest of its speed along the normal. With dVisualHullSweptBroadPhase, the near callback gets the pair, and dCollide no
 * such contacts.
 *
 * What is left out is told by dVisualHullGetErrorMessage after a collide or dGeomVisualHullSetTime: all, where the length
 * of a step is not known; the motion of views whose masks do not follow one another; bodies that move by more than the
 * diagonal of the work volume in a step.
 *
 * @param g the hull
 * @param mode one of dVisualHullSwept...; the geom keeps its mode, with a message, if it is another number
 */
void dGeomVisualHullSetSwept(dGeomID g, int mode);

/**
 * @brief Lets each body that touches a hull stick to it from the next collide on, or releases all that do. It is the paper's
 * button (section 7): pushed, objects that the user touches stick to him until he releases it.
 *
 * A body that sticks moves and turns with the part of the subject that it touched, which is followed by the edges of the
 * silhouettes within 0.15 m. dCollide returns no contacts of the two, and gives the body the velocity that takes it to its
 * place; it does not sleep. In the first dCollide after its release it gets the velocity of the subject there, and has its
 * contacts again. Call dGeomVisualHullSetTime, or dGeomVisualHullUpdate, before each collide: they keep the box of the hull
 * around the bodies that stick to it. The former also tells the length of a step; it is otherwise seen from how bodies move.
 *
 * Geoms without a body and kinematic bodies do not stick; several geoms of one body count as one. A hull that shows nothing yet
 * may be held too: bodies stick once they touch it. A hull may be held, or released, twice, which changes nothing.
 * dGeomVisualHullSetData releases it.
 *
 * dVisualHullGetErrorMessage tells after a collide of a body that does not stick: since another hull holds it, which keeps it;
 * since too few edges are seen around its contacts; or not any more, since something has held it back by more than 0.15 m for
 * 0.1 s, since the program has moved it by more than 0.1 m, or since its part of the subject is not found for 0.2 s. A body
 * that is destroyed, or is not collided with the hull in 40 calls of dGeomVisualHullSetTime or
 * dGeomVisualHullUpdate, is forgotten.
 *
 * @param g the hull
 * @param on nonzero to hold, 0 to release
 * @return 1 on success; 0 if the geom is no visual hull.
 */
int dGeomVisualHullHold(dGeomID g, int on);

/**
 * @brief How long it takes from the time of the collide until two geoms touch, in seconds.
 *
 * @param contact one that dCollide has filled; its side1 and side2 hold the time of a contact with a hull
 * @return 0 where they touch already, and for contacts without a hull; -1 if the contact is NULL.
 */
dReal dGeomVisualHullContactTime(const dContactGeom *contact);

/** @brief Whether a point of the world is inside the hull: 1 inside, 0 outside, -1 on failure. */
int dGeomVisualHullPointInside(dGeomID g, dReal x, dReal y, dReal z);

/**
 * @brief The vector from a point of the world along the paper's normal to the hull's surface.
 *
 * @param w receives the vector, in the world's frame; 0 outside the hull
 * @return 1 inside, 0 outside, -1 on failure.
 */
int dGeomVisualHullPointResponse(dGeomID g, dReal x, dReal y, dReal z, dVector3 w);

/**
 * @brief The velocity of the real surface near a point of the world, from the motion of the silhouettes' edges around
 * the point.
 *
 * It is that of the hull's time: the mean over the last tenth of a second, or over the last two frames where they are
 * farther apart, and what the last frame shows that it has gained since, as far as masks so noisy tell. Speeds that may be
 * noise are 0: those below 0.1 m/s, with clean masks less. The motion of the geom itself, by its body or by
 * dGeomSetPosition, is not part of it.
 *
 * @param g the hull
 * @param v receives the velocity in metres per second, in the world's frame; 0 where it is not known
 * @return 1 where it is known; 0 where it is not: far from the surface, without two frames, where the hull stands still
 * because the next frame is late, and always for dVisualHullMotionHeld; -1 on failure, which a point that is not finite is too.
 */
int dGeomVisualHullPointVelocity(dGeomID g, dReal x, dReal y, dReal z, dVector3 v);

/**
 * @brief The vector that moves a geom out of the hull, by the paper's section 5.
 *
 * @param g the hull
 * @param body the other geom
 * @param v receives the vector, in the world's frame; 0 if they do not touch
 * @return The number of colliding samples; -1 on failure.
 */
int dGeomVisualHullBodyResponse(dGeomID g, dGeomID body, dVector3 v);

/** @brief Sets how contacts are computed: one of dVisualHullContacts... */
void dGeomVisualHullSetContactMode(dGeomID g, int mode);

/** @brief Sets the largest number of contacts per pair, 8 by default. dCollide returns fewer if its flags say so. */
void dGeomVisualHullSetMaxContacts(dGeomID g, int n);

/**
 * @brief Sets the largest depth of a contact, 0.05 by default, so that a body deep inside is pushed out slowly. Paper
 * mode has no limit.
 *
 * Less is reported where ODE would move the body out at more than 0.7 m/s and the speed of the surface, by the ERP of its
 * world and the length of a step: from dGeomVisualHullSetTime, from dVisualHullSetContactMotion, or else as seen from how
 * bodies move from one collide to the next. An ERP that the program sets for single contacts is not known here.
 */
void dGeomVisualHullSetMaxDepth(dGeomID g, dReal depth);

/**
 * @brief Sets the diameter of the thinnest real feature that must not slip between a body's samples, 0.03 by default.
 * 0.015 suits noisy masks.
 */
void dGeomVisualHullSetMinFeature(dGeomID g, dReal diameter);

/**
 * @brief Switches contact events on or off; they are off by default. Switched off, touches that go on are forgotten
 * without an event, and so are the events that were not fetched.
 *
 * @param g the hull
 * @param on nonzero for on
 */
void dGeomVisualHullSetEvents(dGeomID g, int on);

/**
 * @brief Sets how long a touch waits for its next contact before it ends, in seconds; 0.1 by default, three frames of 30 a
 * second. Within that time a mask may flicker, or a body bounce, and the touch goes on.
 *
 * @param g the hull
 * @param seconds finite and not negative; otherwise the geom keeps its time, with a message
 */
void dGeomVisualHullSetEventWait(dGeomID g, dReal seconds);

/**
 * @brief Ends a step and fetches its contact events, the earliest first. Call it in each step, after dSpaceCollide.
 *
 * A touch begins with the first contact that dCollide returns for a body, or for a geom without one, and a part of the
 * hull. It ends when there was none for the time of dGeomVisualHullSetEventWait, and its event tells the time of the last
 * contact. So masks that flicker neither end nor double a touch. A contact that has not begun counts, at the time of
 * dGeomVisualHullContactTime. The events and their order do not depend on which threads collide.
 *
 * Parts are what the cameras see as separate: pieces of the hull whose images are connected in most of the views are one
 * part. A part keeps its number while it moves, and no other part of this geom gets it. Two parts that become one go on as
 * the larger of them; of one that comes apart the larger piece keeps the number, and the other has its own after 0.1 s.
 *
 * The depth rate is the speed of the body against the surface, along the normal, before the contact acts; 0 where the two
 * part. With dVisualHullMotionInterpolated or dVisualHullMotionPredicted the surface has its own velocity, and rests
 * otherwise. A body that the program moves without a velocity rests too.
 *
 * A body that falls asleep at the hull, or sticks to it, goes on touching it where the near callback calls dCollide for it.
 * One that is destroyed or disabled, or leaves the space, ends its touches as one that moves away; the ids in its events
 * may be stale, so compare them before use. A new body at its address that touches the same part within the wait goes on with
 * its touch. dGeomVisualHullSetData ends all touches, and the parts of other data have new numbers. Events that were not fetched are
 * destroyed with the hull.
 *
 * Time is what dGeomVisualHullSetTime tells, which ends the step before too. Without it, each call is the end of a step
 * whose length is known as for dGeomVisualHullSetMaxDepth, or else the time between the frames, from 0 on; then call it a
 * second time in a step only if the first call has filled its buffer. Where no time passes, no touch can end, and
 * dVisualHullGetErrorMessage says so.
 *
 * @param g the hull
 * @param events memory for `size` events; may be NULL if `size` is 0
 * @param size how many events fit. Those that do not fit wait for the next call, up to 65536 of them; if more are lost,
 * dVisualHullGetErrorMessage tells how many.
 * @return How many events were written; if `size` is 0, how many wait. -1 if events are off, if the geom is no visual hull,
 * if `size` is negative, or if `events` is NULL and `size` is not 0; nothing is fetched then.
 */
int dGeomVisualHullGetEvents(dGeomID g, dVisualHullEvent *events, int size);

/**
 * @brief Lets a contact move as the real surface does, so that the surface pushes bodies at its own speed and carries
 * them along. Call it in the near callback, after the surface is set and before dJointCreateContact.
 *
 * It sets dContactFDir1, dContactMotion1, dContactMotion2 and dContactMotionN of contact->surface.mode and the values
 * that belong to them, for a joint that is attached to the bodies of geom.g1 and geom.g2 in this order. The friction
 * direction is that in which the bodies would slip over each other without friction, so that the friction pyramid has
 * Coulomb's limit along it. If the mode has dContactFDir1, contact->fdir1 stays, projected onto the tangent plane and
 * of unit length; if it is zero, not finite or along the normal, it is replaced. Other values of the surface stay.
 *
 * A body takes on the speed of a surface that moves towards it over the first 8 mm of depth, as from soft skin: motionN
 * is in proportion to the depth there. Twice that is subtracted from contact->geom.depth, down to 0, since the motion
 * makes up for it. The noisier the masks are, the more are both, up to 15 and 30 mm; below 0.3 m/s they are less, in
 * proportion to the speed; and they are at most 0.15 and 0.3 of half the body's least extent. Within them no contact gives a
 * body's centre more than the surface's speed. So call it once for a contact.
 *
 * A contact that has not begun (see dGeomVisualHullSetSwept) lets the body approach as far as the surface in the next step;
 * if the surface bounces (dContactBounce), the body bounces at once, at its whole speed. Without a velocity of the surface
 * it counts as at rest there.
 *
 * The contacts of a body that the hull has pressed from opposite sides in this step or one of the last twenty, as two hands do,
 * become soft: dContactSoftERP and dContactSoftCFM are set to those of a critically damped spring of 140 rad/s at the body's
 * mass, unless the mode has one of them. As stiff as other contacts they would press it by thousands of times its weight.
 *
 * A contact that bounces (dContactBounce) adds no energy on its own: where it parts already it gets a motionN towards the hull,
 * e times its speed, and where friction (dContactApprox1) would turn the slip about, its bounce becomes smaller.
 *
 * It may be called for all contacts, also those without a hull, which stay as they are. Where the velocity of a hull's surface
 * is not known, and always for dVisualHullMotionHeld, the friction direction alone is set, unless the mode has one. A body's
 * geom inside a dGeomTransform counts as at rest for the friction direction, and a hull inside one has no motion.
 *
 * @param contact a contact that dCollide has filled, with its surface's mode set
 * @param stepsize the length of the next step in seconds, in which gravity and forces change how bodies slip
 * @return 1 if the contact was changed; 0 if it was not; -1 if the contact or one of its geoms is NULL, its position is not
 * finite, its normal not a unit vector, or the stepsize negative or not finite. For 0 and -1 the contact is as it was.
 */
int dVisualHullSetContactMotion(dContact *contact, dReal stepsize);

/**
 * @brief Directs the friction of any contact, also of ODE's own geoms, along the slip of the bodies in the next step, so that
 * it is Coulomb's. Call it in the near callback, after the surface is set and before dJointCreateContact.
 *
 * ODE limits friction in each of two directions, which it takes from the normal alone. A body that slips between the two
 * meets up to 1.4 times the friction, and one that is pushed between them does not begin to move. This sets dContactFDir1
 * and contact->fdir1. A hull's surface counts as at rest: for hulls in motion use dVisualHullSetContactMotion, which directs
 * the friction too.
 *
 * @param contact a contact that dCollide has filled, with its surface's mode set
 * @param stepsize the length of the next step in seconds, in which gravity and forces change how bodies slip
 * @return 1 if the direction was set; 0 if the mode has dContactFDir1 already, or nothing slips; -1 on failure, as for
 * dVisualHullSetContactMotion. For 0 and -1 the contact is as it was.
 */
int dVisualHullSetContactFriction(dContact *contact, dReal stepsize);

/**
 * @brief Sets surface samples for a geom, in place of its class's own samples or for a class that has none.
 *
 * The samples belong to the geom until dGeomVisualHullClearSamples. Call that before you destroy the geom: ODE does not
 * report its end, and a new geom of equal shape at its address would inherit the samples. If the geom is resized, those of
 * its class are used again, and dVisualHullGetErrorMessage says so: set samples for the new size.
 *
 * @param body any geom
 * @param points count vectors of three numbers in the geom's frame; copied
 * @param normals as many outward normals, or NULL: then a sample can be pushed in any direction
 * @param count the number of samples
 * @param stride bytes from one vector to the next, such as sizeof(dVector3)
 * @return Nonzero on success; 0 if an argument is invalid, and then the geom keeps its samples.
 */
int dGeomVisualHullSetSamples(dGeomID body, const dReal *points, const dReal *normals, int count, int stride);

/** @brief Removes the samples that dGeomVisualHullSetSamples has set, so that the geom has those of its class again. */
void dGeomVisualHullClearSamples(dGeomID body);

#ifdef __cplusplus
}
#endif

#endif
