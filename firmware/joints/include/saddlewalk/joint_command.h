/**
 * What each joint's drive should do: an impedance about a reference angle, and the torque that carries
 * the body there. Bare angles do not walk, see docs/joints.md.
 *
 * The drive closes the loop by itself, at its own rate:
 *
 *     torque = limited(torque_nm + stiffness (angle_rad - angle) + damping (rate_rad_s - rate))
 *
 * within [torque_min_nm, torque_max_nm]. Call it at 250 Hz to 1 kHz.
 */
#ifndef SADDLEWALK_JOINT_COMMAND_H
#define SADDLEWALK_JOINT_COMMAND_H

#include <saddlewalk/estimator.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Stiffness N m/rad, damping N m s/rad, torque N m. */
typedef struct {
    float stance_stiffness, stance_damping;
    float swing_stiffness, swing_damping;
    float torque_max_nm; /**< of the drive */
} saddle_joint_drive_t;

/** Start from saddle_drive_default(), then override; floats only. */
typedef struct {
    float xcom_gain;   /**< the CoP goes beyond an error of the XCoM by this share, [J16] */
    float cop_along_m; /**< how far the CoP may leave the middle of a sole, [J16] */
    float cop_across_m;
    float trunk_stiffness;   /**< N m/rad, [J18] */
    float trunk_damping;     /**< N m s/rad */
    float heading_stiffness; /**< of the trunk about the vertical */
    float heading_damping;
    float height_stiffness_1_s2; /**< of the CoM, [J17]; 0: the reference angles alone hold it */
    float height_damping_1_s;
    float edge_inset_m;     /**< the ankle keeps the CoP so far from heel and toe, [J20] */
    float edge_across_m;    /**< and so near the middle of the sole to the side */
    float full_load_share;  /**< of the weight: from there a leg has its stance gains, [J20] */
    float swing_roll_kg_m2; /**< inertia of a leg about its hip, [J19] */
    float swing_pitch_kg_m2;
    float swing_knee_kg_m2;   /**< and of the shank about its knee */
    float max_age_s;          /**< older estimates move no joint: the fallback holds */
    float fallback_damping;   /**< of the drives then, share of their stance damping */
    float fallback_stiffness; /**< and of their stiffness at the last angles; 0: only damped */
    saddle_joint_drive_t joint[SADDLE_LEG_JOINTS];
} saddle_drive_config_t;

/** What a leg is for. */
typedef enum {
    SADDLE_LEG_SWINGS = 0,
    SADDLE_LEG_STANDS = 1, /**< on its sole */
    SADDLE_LEG_TRAILS = 2  /**< on its toe, and gives its load to the other */
} saddle_leg_role_t;

/** What should be. Points are on the ground, from the estimate's anchor. */
typedef struct {
    uint8_t role[2];             /**< saddle_leg_role_t */
    uint8_t leading;             /**< saddle_side_t: the foot that takes the load */
    float trailing_share_max;    /**< of the load, that the other foot may keep */
    saddle_vec2_t xcom_m, cop_m; /**< of the walk that is planned, saddle_plan_t.reference */
    float com_height_m, com_rise_m_s;
    saddle_joints_t joints;                          /**< reference, by saddle_inverse() */
    float acceleration_rad_s2[2][SADDLE_LEG_JOINTS]; /**< of the reference */
} saddle_intent_t;

typedef struct {
    float angle_rad, rate_rad_s;
    float torque_nm;
    float stiffness, damping;
    float torque_min_nm, torque_max_nm;
} saddle_joint_command_t;

/** The answer, with what it was made of. */
typedef struct {
    saddle_joint_command_t joint[2][SADDLE_LEG_JOINTS];
    bool fallback;       /**< nothing to go by: see saddle_drive_config_t */
    saddle_vec2_t cop_m; /**< that is wanted, from the anchor */
    float load_share[2]; /**< of the ground force */
} saddle_joint_commands_t;

/** Gains that walk with commands up to 10 ms late, found on a simulated body, 2026-11 and -12; torques
 *  of human joints. */
saddle_drive_config_t saddle_drive_default(void);

/** Name of the first field that is out of its range, or NULL. */
const char *saddle_drive_check(const saddle_drive_config_t *config);

/** A field and its accepted range, or NULL beyond the last. */
const saddle_config_field_t *saddle_drive_field(size_t index);

/**
 * The commands of all joints. [J16] to [J20]
 *
 * No command is ever outside the joints' ranges and torques. An estimate whose CoM is older than
 * max_age_s, or an intent that is not finite, gives the fallback at the last sound angles: no torque, and the
 * configured share of stiffness and damping.
 */
void saddle_joint_commands(const saddle_legs_t *legs, const saddle_drive_config_t *config,
                           const saddle_estimate_t *estimate, const saddle_intent_t *intent,
                           saddle_joint_commands_t *commands);

#ifdef __cplusplus
}
#endif

#endif
