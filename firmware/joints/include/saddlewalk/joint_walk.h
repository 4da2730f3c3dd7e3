/**
 * The walking layer: from the core's plan and the estimate to what saddle_joint_commands() needs.
 *
 * It decides what each leg is for by the plan and by the loads that the feet really carry, guides the
 * swing foot from where it left the ground to where it should land, and finds the reference of every
 * joint. At 250 Hz to 1 kHz:
 *
 *     saddle_estimator_update(&estimator, &sensors, &estimate);
 *     saddle_plan_at(&context, now_us, &plan);
 *     saddle_joint_walk_update(&walk, &input, &estimate, &intent);
 *     saddle_joint_commands(&legs, &drive, &estimate, &intent, &commands);
 *
 * docs/joints.md has the equations, [J21] to [J25], and what was reached.
 */
#ifndef SADDLEWALK_JOINT_WALK_H
#define SADDLEWALK_JOINT_WALK_H

#include <saddlewalk/joint_command.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Start from saddle_joint_walk_default(), then override; floats only. */
typedef struct {
    float double_support_share; /**< as in saddle_config_t, [J21] */
    float sole_half_width_m;    /**< that the CoP uses of a foot that stands alone, [J21] */
    float lifted_n, lifted_s;   /**< a trailing foot this light for so long lifts, [J21] */
    float carrying_n;           /**< while the other carries as much */
    float landed_n;             /**< a foot has landed with this load */
    float landed_early_n;       /**< before its time with this load, */
    float early_max_s;          /**< and no earlier than this */
    float step_gain;            /**< of the landing by an error of the XCoM, [J23] */
    float nearby_along_m;       /**< recovery steps nearer to the planned one are ignored, [J23] */
    float nearby_across_m;
    float need_along_m; /**< the recovery step is taken where the XCoM is off by more, [J23] */
    float need_across_m;
    float reach_along_m; /**< longest recovery step from the stance foot, [J23] */
    float reach_across_m;
    float landing_frozen_s;    /**< so long before it the landing stays, [J23] */
    float detour_rate_rad_s;   /**< of the filter of a landing that moves, [J23] */
    float lift_off_share;      /**< of the swing, in which the place of the lift-off fades, [J22] */
    float pitch_time_s;        /**< time constant of the swing foot's pitch, [J22] */
    float reach_down_m_s;      /**< a foot that should have landed goes down so fast, [J22] */
    float reach_down_max_m;    /**< and no further */
    float fade_s;              /**< in which a change of a leg's role fades, [J25] */
    float height_rate_rad_s;   /**< of the filter of the planned height, [J24] */
    float acceleration_time_s; /**< of the filter of the reference's acceleration, [J25] */
} saddle_joint_walk_config_t;

/** A foot in the air. Not for users. */
typedef struct {
    saddle_vec3_t mismatch_m; /**< of the lift-off and the plan */
    float fade_s, age_s;      /**< 0: not begun */
    saddle_vec2_t shift_m, detour_m, detour_rate_m_s;
    saddle_vec3_t position_m, velocity_m_s; /**< from the other foot's sole */
    float pitch_rad, pitch_rate_rad_s;
} saddle_swing_path_t;

/** A leg's reference on its way. Not for users. */
typedef struct {
    uint8_t role;   /**< saddle_leg_role_t of the last call */
    bool has_role;  /**< false: this is the first call */
    float fading_s; /**< since the role changed */
    float offset_rad[SADDLE_LEG_JOINTS], rate_rad_s[SADDLE_LEG_JOINTS];
    float acceleration_rad_s2[SADDLE_LEG_JOINTS];
} saddle_leg_reference_t;

/** State of the walking layer; owned by the caller, may be static. Not for users. */
typedef struct {
    saddle_legs_t legs;
    saddle_joint_walk_config_t config;
    bool initialised, started;
    uint64_t time_us;
    bool stands[2];        /**< by the plan and by the ground */
    bool swings[2];        /**< has a swing: in the air, or on its way down after its time */
    float light_s[2];      /**< so long the foot has carried nothing */
    uint8_t leading;       /**< saddle_side_t: landed last */
    bool first_swing;      /**< nobody has landed since standing */
    float since_landing_s; /**< negative: before the plan has it */
    saddle_vec2_t recovery_shift_m;
    bool in_need; /**< takes the recovery step */
    saddle_swing_path_t swing[2];
    float height_m, height_rate_m_s; /**< filtered reference */
    saddle_joints_t joints;          /**< last reference */
    saddle_leg_reference_t leg[2];
} saddle_joint_walk_t;

/** What to follow at one time. */
typedef struct {
    uint64_t time_us;          /**< the clock of saddle_sensors_t */
    const saddle_plan_t *plan; /**< by saddle_plan_at(); NULL or not valid: stand where you are */
    const saddle_verdict_t *verdict; /**< of the last tick; NULL: no recovery steps */
} saddle_joint_walk_input_t;

/** Gains of the body of a person on whom they were found, 2026-11; docs/joints.md. */
saddle_joint_walk_config_t saddle_joint_walk_default(void);

/** Name of the first field that is out of its range, or NULL. */
const char *saddle_joint_walk_check(const saddle_joint_walk_config_t *config);

/** A field and its accepted range, or NULL beyond the last. */
const saddle_config_field_t *saddle_joint_walk_field(size_t index);

/** Copies both. SADDLE_ERROR_CONFIG if saddle_legs_check() or saddle_joint_walk_check() names a field;
 *  then updates are rejected. */
saddle_status_t saddle_joint_walk_init(saddle_joint_walk_t *walk, const saddle_legs_t *legs,
                                       const saddle_joint_walk_config_t *config);

/**
 * The intent at input->time_us. [J21] to [J25]
 *
 * Begins with both feet on the ground, and again after a gap of more than 50 ms. An estimate that is
 * not finite, or a plan that is not, gives an intent that saddle_joint_commands() answers with the
 * fallback. SADDLE_ERROR_UNINITIALISED: such an intent as well.
 */
saddle_status_t saddle_joint_walk_update(saddle_joint_walk_t *walk,
                                         const saddle_joint_walk_input_t *input,
                                         const saddle_estimate_t *estimate,
                                         saddle_intent_t *intent);

#ifdef __cplusplus
}
#endif

#endif
