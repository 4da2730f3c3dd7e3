/** [E47] The way that is walked: the line that the plan's x runs along and its y across. A sequence of
 *  arcs that meet beside the feet which landed, so that the line under a foot that stands never changes.
 *  A straight way leaves x and y as they are, bit for bit. */
#ifndef SADDLEWALK_WAY_H
#define SADDLEWALK_WAY_H

#include <saddlewalk/private/context.h>

/** A place along the way, from the stance foot, and across it, to the left; and their rates. */
typedef struct {
    saddle_vec2_t place_m, rate_m_s;
} saddle_course_t;

/** The same in the axes of the stance foot. */
typedef struct {
    saddle_vec2_t position_m, velocity_m_s;
    float yaw_rad; /**< of the way there */
} saddle_on_ground_t;

/** Straight on from the stance foot, in its heading. */
void saddle_way_begin(saddle_way_t *way);

/** As if the way had long turned at the wanted rate. */
void saddle_way_join(saddle_way_t *way, float speed_m_s);

/** It bends, or will from the next landing on. */
bool saddle_way_turns(const saddle_way_t *way);

/** A foot has landed after way_nm along the way: the arc that begins there has the wanted turning rate
 *  at the speed of the CoM there, as far as that is feasible and the rate may change in a step. */
void saddle_way_land(saddle_way_t *way, const saddle_model_t *model, float speed_m_s,
                     int64_t way_nm);

/** The foot that landed last did so further along the way by way_m, within 2 m; negative: before. */
void saddle_way_shift(saddle_way_t *way, float way_m);

/** The arcs of a plan, as if no change of curvature faded. */
void saddle_way_of(const saddle_plan_t *plan, saddle_arc_t arcs[2]);

/** From along the way to the axes of the stance foot. */
saddle_on_ground_t saddle_way_to_ground(const saddle_arc_t arcs[2], const saddle_course_t *course);

/** A point alone. */
saddle_vec2_t saddle_way_point_to_ground(const saddle_arc_t arcs[2], saddle_vec2_t place_m);

/** Back, as if no change of curvature faded. */
saddle_vec2_t saddle_way_from_ground(const saddle_arc_t arcs[2], saddle_vec2_t position_m);

/** [E49] How far a CoM leans to the left on a way of that curvature. */
float saddle_lean_m(const saddle_model_t *model, float curvature_1_m, float speed_m_s);

/** What was measured in the way's heading beside the CoM: along the way and across it. */
void saddle_way_measured(const saddle_arc_t arcs[2], saddle_vec2_t com_m,
                         saddle_measurement_t *measured);

#endif
