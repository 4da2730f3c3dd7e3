/** Saddle space: the frame of the two CoPs, the base of support in it, and gravity on the saddle. */
#ifndef SADDLEWALK_SADDLE_SPACE_H
#define SADDLEWALK_SADDLE_SPACE_H

#include <saddlewalk/types.h>

/** CoPs closer than this make saddle space undefined. */
#define SADDLE_FEET_DISTANCE_MIN_M 1.0e-3f

/** A pendulum lower than this share of its length lies on the ground: gravity along it is undefined. */
#define SADDLE_LOWEST_PENDULUM 0.1f

/** [E15] [E16] factor: the share of the geometric BoS that is used, 1 for the paper's. */
saddle_bos_t saddle_bos(const saddle_vec2_t cop_m[2], float half_depth_m, float factor);

/** [E17] Signed Euclidean distance to the border, positive inside. 0 if the BoS is undefined. */
float saddle_bos_margin_m(const saddle_bos_t *bos, saddle_vec2_t point_m);

/** Whether a point lies in the BoS, border included; false if the BoS is undefined. */
bool saddle_bos_contains(const saddle_bos_t *bos, saddle_vec2_t point_m);

/** The BoS of feet that are together or not known. */
saddle_bos_t saddle_bos_undefined(void);

/** [E26] Where a point that moves along direction_m_s leaves the BoS; the nearest point of the border
 *  for one at rest or outside. The point itself if the BoS is undefined. */
saddle_vec2_t saddle_bos_exit_m(const saddle_bos_t *bos, saddle_vec2_t point_m,
                                saddle_vec2_t direction_m_s);

/** The energy surface U = m g z_s at a place, over the CoP that carries, the nearer one. */
typedef struct {
    saddle_vec2_t lever_m; /**< from that CoP to the place */
    float height_m;        /**< z_s; 0 where the pendulum does not reach */
    bool reached;
} saddle_surface_t;

/** [E18] */
saddle_surface_t saddle_surface(const saddle_vec2_t cop_m[2], saddle_vec2_t place_m,
                                float pendulum_m);

/** [E18] Gravity along the energy surface; zero where the pendulum does not reach. */
saddle_vec2_t saddle_gravity_n(const saddle_surface_t *surface, float mass_kg);

#endif
