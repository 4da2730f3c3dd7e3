/** The walking planner: standing, starting, walking, stopping, over the gait cycle. */
#ifndef SADDLEWALK_PLANNER_H
#define SADDLEWALK_PLANNER_H

#include <saddlewalk/gait_cycle.h>
#include <saddlewalk/gait_model.h>
#include <saddlewalk/model.h>
#include <saddlewalk/saddle_types.h>
#include <stdbool.h>
#include <stdint.h>

typedef enum {
    SADDLE_COMMAND_STAND = 0, /**< stop at the next place where the feet come side by side */
    SADDLE_COMMAND_WALK = 1   /**< walk; speed 0 is a stand */
} saddle_command_mode_t;

/** The slowest walk that is planned; a slower one, but for 0, is limited to it. */
#define SADDLE_SPEED_FLOOR_M_S 0.01f

/** What is asked of the planner, at any time. The speed is approached at acceleration_m_s2; the
 *  heel-strike angle holds from the heel strike after the next. */
typedef struct {
    uint8_t mode;          /**< saddle_command_mode_t; a stand does not need the numbers below */
    float speed_m_s;       /**< along x */
    float heel_strike_rad; /**< foot to ground when the heel strikes; erf ankles only */
} saddle_command_t;

typedef enum {
    SADDLE_MODE_STANDING = 0,
    SADDLE_MODE_STARTING = 1, /**< weight goes to the first stance leg, then the first step */
    SADDLE_MODE_WALKING = 2,
    SADDLE_MODE_STOPPING = 3  /**< until the feet are side by side and the CoM between them */
} saddle_mode_t;

/** Limits that shaped an output. */
typedef enum {
    SADDLE_LIMIT_SPEED = 1u << 0,       /**< commanded speed not feasible: the nearest that is */
    SADDLE_LIMIT_HEEL_STRIKE = 1u << 1, /**< angle outside [0, heel_strike_max_rad] */
    SADDLE_LIMIT_TOE_OFF = 1u << 2,     /**< ankle angle outside the geometry, [E13] [E25] */
    SADDLE_LIMIT_FEET = 1u << 3,        /**< measured feet that no plan can start or go on from */
    SADDLE_LIMIT_TICK_GAP = 1u << 4,    /**< late tick: the plan advanced by tick_max_s only */
    SADDLE_LIMIT_SAFE_STOP = 1u << 5    /**< inputs were lost: the walk stops, safe_state.h */
} saddle_limit_t;

/** Feet as they were measured. */
typedef struct {
    bool known;
    saddle_vec2_t cop_m[2]; /**< in any one frame with x forward and y left */
    bool contact[2];
} saddle_feet_t;

/** The plan at one instant. x is measured from the CoP of the planned stance foot, which lies at
 *  origin_x_nm from the first stance foot; y from the walking line; z from the ground. */
typedef struct {
    bool valid;             /**< false: the tick failed and all else is 0 */
    uint8_t mode;           /**< saddle_mode_t */
    uint8_t phase;          /**< 0 to 3: the quarter of the stride, from the left foot via point */
    uint8_t support;        /**< saddle_side_t; both feet carry while standing */
    uint32_t step_count;    /**< changes of the stance foot since the start */
    uint32_t stride_count;  /**< times the left foot via point was passed since the start */
    float theta_rad;        /**< gait phase within the stride, [0, 2 pi), [E8] */
    int64_t origin_x_nm;    /**< walked distance to the stance foot; integer, so it never drifts */
    float speed_m_s, step_length_m, step_width_m; /**< of the running quarter */
    saddle_vec3_t com_m, com_velocity_m_s;
    saddle_vec3_t foot_m[2];           /**< CoPs */
    float foot_pitch_rad[2];           /**< sole to ground, positive heel up */
    saddle_vec3_t swing_velocity_m_s;  /**< of the foot that is not in support */
    float leg_length_m;                /**< stance leg */
    float knee_flexion_m;              /**< stance leg shorter than l_p by this, cycloid only */
    float toe_off_rad, heel_strike_rad; /**< ankle angles, sole to ground */
    float time_to_via_point_s;         /**< next via point, or end of a shift of weight */
    float time_to_heel_strike_s;       /**< next heel strike, [E12] */
    float time_to_toe_off_s;           /**< next change of support: the swing CoP arrives */
    saddle_vec2_t landing_m;           /**< where the swing CoP arrives */
} saddle_plan_t;

/** Planner state, part of the context. */
typedef struct {
    uint8_t mode;
    bool shifting;          /**< time moves the CoM between the feet, not the gait cycle */
    bool braking;           /**< a stop has begun that ends beside the stance foot */
    float speed_m_s;        /**< wanted, feasible; 0: stand */
    float heel_strike_rad;  /**< wanted, in range */
    uint32_t shift_us;      /**< since the shift began */
    saddle_vec2_t shift_from_m, shift_to_m; /**< CoM from the stance CoP */
    saddle_vec2_t other_m;  /**< the other foot, from the stance CoP, while both stand */
    uint8_t start_phase;    /**< where the cycle begins after the shift */
    bool landing_open;      /**< the last landing has not been compared with the measured one */
    saddle_cycle_t cycle;
} saddle_planner_t;

/** True for a stand, whatever its numbers, and for a walk with numbers within +-10^6. */
bool saddle_command_usable(const saddle_command_t *command);

/** Standing, feet side by side at the width of slow walking, CoM between them. */
void saddle_planner_reset(saddle_planner_t *planner, const saddle_model_t *model);

/** Join a steady walk at the left foot via point (theta = 0, Phase0 = 0), at full speed: what the
 *  paper plans. Returns saddle_limit_t bits. */
uint32_t saddle_planner_join(saddle_planner_t *planner, const saddle_model_t *model, const saddle_command_t *command);

/** Advance by dt_us; then obey a usable command and take over measured feet. A walk starts from
 *  measured feet only if both are on the ground and no further apart than a step; else the plan stands
 *  and says SADDLE_LIMIT_FEET. Returns saddle_limit_t bits. */
uint32_t saddle_planner_update(saddle_planner_t *planner, const saddle_model_t *model, const saddle_command_t *command,
                               const saddle_feet_t *feet, uint32_t dt_us);

/** Let time pass, nothing else. */
void saddle_planner_advance(saddle_planner_t *planner, const saddle_model_t *model, uint32_t dt_us);

/** Speed of the walk; 0 while both feet stand. */
float saddle_planner_speed_m_s(const saddle_planner_t *planner);

/** How far saddle_planner_advance() may go in one call: to the end of the next step, 0.5 s standing. */
uint32_t saddle_planner_horizon_us(const saddle_planner_t *planner);

/** The plan of the present state. Returns SADDLE_LIMIT_TOE_OFF or 0. */
uint32_t saddle_planner_write(const saddle_planner_t *planner, const saddle_model_t *model, saddle_plan_t *plan);

#endif
