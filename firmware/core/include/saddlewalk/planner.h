/** The walking planner: gait phase to CoM, feet and ankles. */
#ifndef SADDLEWALK_PLANNER_H
#define SADDLEWALK_PLANNER_H

#include <saddlewalk/ankle_strategy.h>
#include <saddlewalk/gait_model.h>
#include <saddlewalk/saddle_types.h>
#include <stdbool.h>
#include <stdint.h>

typedef enum {
    SADDLE_COMMAND_STAND = 0, /**< no walk is planned; a walk in progress ends */
    SADDLE_COMMAND_WALK = 1
} saddle_command_mode_t;

/** The slowest walk that is planned; a slower one is limited to it. */
#define SADDLE_SPEED_FLOOR_M_S 0.01f

/** What is asked of the planner. A walk keeps the speed and angle that it started with: another
 *  value is reported as SADDLE_LIMIT_COMMAND_HELD until the walk is ended and begun again. */
typedef struct {
    uint8_t mode;          /**< saddle_command_mode_t; a stand does not need the numbers below */
    float speed_m_s;       /**< along x */
    float heel_strike_rad; /**< foot to ground when the heel strikes */
} saddle_command_t;

/** Limits that shaped an output. */
typedef enum {
    SADDLE_LIMIT_SPEED = 1u << 0,        /**< commanded speed not feasible: the nearest that is */
    SADDLE_LIMIT_HEEL_STRIKE = 1u << 1,  /**< angle outside [0, heel_strike_max_rad] */
    SADDLE_LIMIT_TOE_OFF = 1u << 2,      /**< toe-off angle outside the geometry, [E13] */
    SADDLE_LIMIT_COMMAND_HELD = 1u << 3, /**< a change of command waits for the next walk */
    SADDLE_LIMIT_TICK_GAP = 1u << 4      /**< late tick: the plan advanced by tick_max_s only */
} saddle_limit_t;

/** The plan at one instant. x is measured from the CoP of the planned stance foot, which lies at
 *  origin_x_nm from the first stance foot; y from the walking line; z from the ground. */
typedef struct {
    bool valid;             /**< false: no walk is planned and all else is 0 */
    uint8_t phase;          /**< 0 to 3: the quarter of the stride, from the left foot via point */
    uint8_t support;        /**< saddle_side_t */
    uint32_t step_count;    /**< changes of the stance foot since the start */
    uint32_t stride_count;  /**< whole turns of theta since the start */
    float theta_rad;        /**< gait phase within the stride, [0, 2 pi), [E8] */
    int64_t origin_x_nm;    /**< walked distance to the stance foot; integer, so it never drifts */
    float speed_m_s, step_length_m, step_width_m;
    saddle_vec3_t com_m, com_velocity_m_s;
    saddle_vec3_t foot_m[2];           /**< CoPs */
    saddle_vec3_t swing_velocity_m_s;  /**< of the foot that is not in support */
    float leg_length_m;                /**< stance leg */
    float toe_off_rad, heel_strike_rad; /**< ankle angles, sole to ground */
    float time_to_heel_strike_s;       /**< > 0; until the saddle via point, where the swing CoP
                                            arrives; the heel of [E12] touches d_h (1 - cos)/v
                                            earlier */
    saddle_vec2_t landing_m;           /**< where the swing CoP arrives */
} saddle_plan_t;

/** Planner state, about 80 bytes, part of the context. */
typedef struct {
    uint64_t phase_q64;    /**< gait phase, 2^-64 strides: wraps and never drifts */
    uint32_t stride_count; /**< its wraps */
    int64_t origin_x_nm;
    saddle_gait_t gait;
    saddle_transition_t transition;
    float commanded_speed_m_s, commanded_heel_strike_rad;
    uint32_t start_limits; /**< limits taken when the walk began */
    bool walking;
} saddle_planner_t;

/** True for a stand, whatever its numbers, and for a walk with numbers within +-10^6. */
bool saddle_command_usable(const saddle_command_t *command);

/** Obey a usable command, then advance by dt_s in [0, tick_max_s] and write the plan.
 *  Returns saddle_limit_t bits; those that shaped the start of a walk stay until it ends. The tick
 *  that begins a walk plans theta = 0, whatever dt_s is. */
uint32_t saddle_planner_update(saddle_planner_t *planner, const saddle_config_t *config,
                               const saddle_body_t *body, const saddle_command_t *command,
                               float dt_s, saddle_plan_t *plan);

#endif
