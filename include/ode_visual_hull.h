/*
 * ode_visual_hull.h - the visual hull of a real, moving subject as a geometry class of the Open Dynamics Engine.
 *
 * Several calibrated cameras see a subject; each image gives a silhouette; together they bound the subject's visual
 * hull. A geom of this class collides with it directly in the images: new silhouettes, the next step collides,
 * nothing is rebuilt.
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
 * Units are ODE's own; metres, seconds and radians are assumed in defaults. Camera axes: x right, y down, z forward.
 * Images: the upper left corner is (0, 0), pixel (i, j) covers [i, i+1) x [j, j+1), its centre is (i+0.5, j+0.5).
 * Masks: one byte a pixel, 0 background to 255 subject, inside where it is 128 or more; values between are coverage.
 *
 * Functions that can fail return nonzero, an id or an index on success, and 0, NULL or -1 on failure; then
 * dVisualHullGetErrorMessage tells what was expected, what was found, and what to do. Nothing here aborts or prints.
 * Ids that are NULL, stale or of another kind are refused, not followed.
 */
#ifndef _ODE_VISUAL_HULL_H_
#define _ODE_VISUAL_HULL_H_

#include <ode/ode.h>

#ifdef __cplusplus
extern "C" {
#endif

/** The version of this header, as dVisualHullGetVersion gives that of the library. */
#define dVISUAL_HULL_VERSION "0.1.0"

/** A subject's views and their masks. Made by dGeomVisualHullDataCreate; shared by any number of geoms. */
struct dxVisualHullData;
typedef struct dxVisualHullData *dVisualHullDataID;

/** What a view that does not see a point says of it; see dGeomVisualHullDataSetUnseen. */
enum {
  dVisualHullUnseenOutside = 0, /**< The point is outside. The default. */
  dVisualHullUnseenAbstain = 1  /**< Nothing; but minViews views must see a point that is inside. */
};

/** How contacts are made; see dGeomVisualHullSetContactMode. */
enum {
  dVisualHullContactsClustered = 0, /**< Samples with like ways out, guided by the body's normals. The default. */
  dVisualHullContactsPaper = 1,     /**< One direction for the body, each sample its own depth, uncapped. */
  dVisualHullContactsPoint = 2,     /**< Each sample along its own way out. */
  dVisualHullContactsSingle = 3     /**< The deepest sample alone. */
};

/**
 * @brief Opens the class: takes a reference on ODE (dInitODE2), checks that it computes in double precision, and
 * registers the one geometry class.
 *
 * May be called any number of times; each call wants one dCloseVisualHull.
 *
 * @return Nonzero on success. 0 where ODE is of single precision, or where all four user classes of ODE are taken.
 */
int dInitVisualHull(void);

/**
 * @brief Gives back one dInitVisualHull; the last one drops the reference on ODE.
 *
 * Destroy the geoms first, as before dCloseODE. Data objects stay until they are destroyed.
 */
void dCloseVisualHull(void);

/** @brief The class's number, as dGeomGetClass gives it for a hull; -1 when closed. */
int dGetVisualHullClass(void);

/**
 * @brief What went wrong in this thread's last call that failed; "" if none did.
 *
 * A collision can fail too, for a geom that cannot be sampled: dCollide then gives no contacts, and this tells why.
 *
 * @return A string that is valid until the thread's next call of a function of this header.
 */
const char *dVisualHullGetErrorMessage(void);

/** @brief The library's version, such as "0.1.0". */
const char *dVisualHullGetVersion(void);

/**
 * @brief A data object without views, without a work volume, and with the policy dVisualHullUnseenOutside.
 *
 * Yours to destroy. All functions on data objects may be called from any thread, dGeomVisualHullDataUpdate excepted.
 *
 * @return The id.
 */
dVisualHullDataID dGeomVisualHullDataCreate(void);

/**
 * @brief Destroys a data object. Geoms that are bound to it keep its last frame until they are destroyed or bound to
 * other data.
 */
void dGeomVisualHullDataDestroy(dVisualHullDataID d);

/**
 * @brief Adds a view by its projection matrix.
 *
 * @param d the data object
 * @param P 3x4, row-major, from homogeneous world to image coordinates, of any scale; copied
 * @param width the image's width in pixels
 * @param height the image's height in pixels
 * @return The view's index, from 0; -1 for a singular or NaN matrix, or a size out of range.
 */
int dGeomVisualHullDataAddView(dVisualHullDataID d, const dReal P[12], int width, int height);

/**
 * @brief Adds a view by its camera, with OpenCV's lens distortion.
 *
 * @param d the data object
 * @param K the intrinsic matrix, 3x3, row-major, in pixels; copied, as all arrays here. OpenCV puts pixel centres at
 * whole numbers: add 0.5 to its principal point.
 * @param R the rotation from world to camera, 3x3, row-major, without padding
 * @param t the translation, so that x_cam = R x_world + t
 * @param distortion k1 k2 p1 p2 [k3 [k4 k5 k6 [s1 s2 s3 s4 [taux tauy]]]]; may be NULL where nDistortion is 0
 * @param nDistortion 0, 4, 5, 8, 12 or 14
 * @param width the image's width in pixels
 * @param height the image's height in pixels
 * @return The view's index, from 0; -1 for a calibration that cannot be used.
 */
int dGeomVisualHullDataAddCamera(dVisualHullDataID d, const dReal K[9], const dReal R[9], const dReal t[3],
                                 const dReal *distortion, int nDistortion, int width, int height);

/**
 * @brief Adds a view by its camera, with OpenCV's fisheye lens.
 *
 * @param d the data object
 * @param K the intrinsic matrix, as for dGeomVisualHullDataAddCamera
 * @param R the rotation from world to camera, 3x3, row-major, without padding
 * @param t the translation, so that x_cam = R x_world + t
 * @param k k1 k2 k3 k4; may be NULL where nk is 0: all of them are then zero
 * @param nk 0 or 4
 * @param width the image's width in pixels
 * @param height the image's height in pixels
 * @return The view's index, from 0; -1 for a calibration that cannot be used, for an image that shows rays at 90
 * degrees or more from the camera's axis, and for a model that folds back before the nearest border of the image.
 */
int dGeomVisualHullDataAddFisheyeCamera(dVisualHullDataID d, const dReal K[9], const dReal R[9], const dReal t[3],
                                        const dReal *k, int nk, int width, int height);

/**
 * @brief Adds all views of a calibration file, the TOML of anipose, Pose2Sim and caliscope.
 *
 * @return Their number; 0 where the file cannot be read or used, and then none is added.
 */
int dGeomVisualHullDataLoadRig(dVisualHullDataID d, const char *path);

/** @brief The number of views; -1 on failure. */
int dGeomVisualHullDataGetViewCount(dVisualHullDataID d);

/**
 * @brief Sets the work volume: points outside are outside the hull. Needed before the first update.
 *
 * @param d the data object
 * @param aabb min x, max x, min y, max y, min z, max z, in the hull's frame, as dGeomGetAABB has it
 */
int dGeomVisualHullDataSetBounds(dVisualHullDataID d, const dReal aabb[6]);

/**
 * @brief Sets what views that do not see a point say of it.
 *
 * @param d the data object
 * @param policy dVisualHullUnseenOutside or dVisualHullUnseenAbstain
 * @param minViews for dVisualHullUnseenAbstain, how many views must see a point that is inside; 2 is usual
 */
int dGeomVisualHullDataSetUnseen(dVisualHullDataID d, int policy, int minViews);

/**
 * @brief Gives a view its next mask. It is read where it lies and prepared here, on this thread, and seen after
 * dGeomVisualHullDataUpdate; when the call returns, the buffer is the caller's again. A view that gets none keeps its
 * last one.
 *
 * @param d the data object
 * @param view the view's index
 * @param mask the first byte of the upper row; rows from top to bottom
 * @param rowStride bytes from a row to the next, at least the image's width
 * @return 0 for a mask that cannot be used, a full one among them; the last good one then stays.
 */
int dGeomVisualHullDataSetMask(dVisualHullDataID d, int view, const unsigned char *mask, int rowStride);

/**
 * @brief Gives a view its next mask, which was taken at @p time seconds. A mask without a time of its own counts as taken
 * at that of the first update that shows it.
 *
 * @param d the data object
 * @param view the view's index
 * @param mask the first byte of the upper row; rows from top to bottom
 * @param rowStride bytes from a row to the next, at least the image's width
 * @param time finite, and not before that of the view's last mask
 * @return 0 as dGeomVisualHullDataSetMask, and for a time that cannot be; the last good mask then stays.
 */
int dGeomVisualHullDataSetMaskAt(dVisualHullDataID d, int view, const unsigned char *mask, int rowStride, dReal time);

/** @brief Gives a view its next mask from an image file (PNG, JPEG, PNM): its alpha channel where it has one, else its grey values. */
int dGeomVisualHullDataLoadMask(dVisualHullDataID d, int view, const char *path);

/** @brief Takes a view out (0), so that it abstains, or puts it back (1); seen after dGeomVisualHullDataUpdate. */
int dGeomVisualHullDataSetViewEnabled(dVisualHullDataID d, int view, int enabled);

/**
 * @brief Publishes the masks as the frame of that time, in seconds; bound geoms collide with it from now on.
 *
 * Cheap. Call it where the simulation runs, between two collides: it tells the spaces of all bound geoms that their
 * boxes have changed, which ODE forbids inside a near callback.
 *
 * @return 0 where the masks are no frame yet (a view without a mask, no bounds, a time before the last one's); the
 * last frame then stays in force.
 */
int dGeomVisualHullDataUpdate(dVisualHullDataID d, dReal time);

/**
 * @brief A geom of the class, bound to a data object; placeable, without a body, at the origin.
 *
 * Destroyed by dGeomDestroy or with its space, as any geom. Its pose moves the whole capture space.
 *
 * @param space where to put it; may be 0
 * @param d the data object
 * @return The geom; 0 on failure.
 */
dGeomID dCreateVisualHull(dSpaceID space, dVisualHullDataID d);

/** @brief Binds a hull to other data. Between two collides only. */
void dGeomVisualHullSetData(dGeomID g, dVisualHullDataID d);

/** @brief The data object that a hull is bound to; NULL once that was destroyed, and on failure. */
dVisualHullDataID dGeomVisualHullGetData(dGeomID g);

/** @brief 1 where a point of the world is inside, 0 outside, -1 on failure. */
int dGeomVisualHullPointInside(dGeomID g, dReal x, dReal y, dReal z);

/**
 * @brief The way out for a point of the world, by the paper's normal.
 *
 * @param w gets the vector from the point to the hull's surface, 0 outside
 * @return 1 inside, 0 outside, -1 on failure.
 */
int dGeomVisualHullPointResponse(dGeomID g, dReal x, dReal y, dReal z, dVector3 w);

/**
 * @brief The way out for a body's shape.
 *
 * @param g the hull
 * @param body the other geom
 * @param v gets the vector that moves the body out, 0 where they do not touch
 * @return The number of colliding samples; -1 on failure.
 */
int dGeomVisualHullBodyResponse(dGeomID g, dGeomID body, dVector3 v);

/** @brief How contacts are made: one of dVisualHullContacts... */
void dGeomVisualHullSetContactMode(dGeomID g, int mode);

/** @brief The most contacts for a pair, 8 by default; a caller of dCollide may ask for fewer. */
void dGeomVisualHullSetMaxContacts(dGeomID g, int n);

/** @brief The largest depth of a contact, 0.05 by default: a body deep inside leaves slowly. Not in paper mode. */
void dGeomVisualHullSetMaxDepth(dGeomID g, dReal depth);

/**
 * @brief The diameter of the thinnest real feature that must not slip between a body's samples, 0.03 by default;
 * 0.015 suits noisy masks.
 */
void dGeomVisualHullSetMinFeature(dGeomID g, dReal diameter);

/**
 * @brief Gives a geom surface samples of your own, for classes that have none, or better ones.
 *
 * They belong to the geom until dGeomVisualHullClearSamples; call that before you destroy it.
 *
 * @param body any geom
 * @param points count vectors of three numbers in the geom's frame; copied
 * @param normals as many outward normals, or NULL: then every sample counts, whatever pushes it
 * @param count their number
 * @param stride bytes from a vector to the next, such as sizeof(dVector3)
 */
int dGeomVisualHullSetSamples(dGeomID body, const dReal *points, const dReal *normals, int count, int stride);

/** @brief Goes back to the samples of the geom's class. */
void dGeomVisualHullClearSamples(dGeomID body);

#ifdef __cplusplus
}
#endif

#endif
