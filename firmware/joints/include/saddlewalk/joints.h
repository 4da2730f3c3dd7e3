/**
 * Joint angles of both legs from where trunk and feet should be, and back.
 *
 * What is true of the core holds here: C99, single precision, + - * / and sqrtf alone, no heap, no libc,
 * no globals, the same bits on every target, a bounded number of operations in every call. Each
 * function writes all of its result on every path. docs/joints.md has the equations and the figures.
 *
 * Frame: x forward, y to the left, z up, any origin. SI units and radians. Each joint turns
 * right-handed about its axis, on both sides alike: hip yaw about z, hip roll about x, hip pitch,
 * knee and ankle pitch about y, ankle roll about x, in this order from the trunk down. With all
 * angles 0 somebody stands upright on straight legs. So a bent knee is positive, hip pitch is
 * negative in flexion and ankle pitch is positive in plantar flexion.
 */
#ifndef SADDLEWALK_JOINTS_H
#define SADDLEWALK_JOINTS_H

#include <saddlewalk/types.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Index of every array of a leg's joints. */
typedef enum {
    SADDLE_HIP_YAW = 0,
    SADDLE_HIP_ROLL = 1,
    SADDLE_HIP_PITCH = 2,
    SADDLE_KNEE = 3,
    SADDLE_ANKLE_PITCH = 4,
    SADDLE_ANKLE_ROLL = 5
} saddle_joint_t;

#define SADDLE_LEG_JOINTS 6

/** The bit of a joint in every set of joints; `side` is a saddle_side_t. */
#define SADDLE_JOINT_BIT(side, joint) (1u << (6u * (unsigned)(side) + (unsigned)(joint)))

/** What a joint may do, on the left; yaw and roll of the right leg are the mirror image. */
typedef struct {
    float min_rad, max_rad; /**< of the knee at least 0.01: a bent knee keeps rates finite */
    float rate_max_rad_s;
} saddle_joint_range_t;

/** Segments of a body on two legs, its device included, and the ranges of its joints. Start from
 *  saddle_legs_default(), then override with what was measured. */
typedef struct {
    float thigh_m;            /**< hip to knee */
    float shank_m;            /**< knee to ankle */
    float ankle_height_m;     /**< above the sole */
    float hip_half_width_m;   /**< hip to the middle of the body */
    float foot_length_m;      /**< of the sole, heel to toe */
    float ankle_to_middle_m;  /**< from the ankle forward to the middle of the sole */
    float trunk_com_m;        /**< CoM of trunk, head and arms above the hips */
    float thigh_com_share;    /**< CoM from the hip, of the thigh's length */
    float shank_com_share;    /**< CoM from the knee, of the shank's length */
    float trunk_kg, thigh_kg; /**< trunk with head and arms; one thigh */
    float shank_kg, foot_kg;  /**< one of each */
    saddle_joint_range_t joint[SADDLE_LEG_JOINTS];
} saddle_legs_t;

/** Axes of a body, seen from the world: three unit vectors at right angles. */
typedef struct {
    saddle_vec3_t x, y, z;
} saddle_axes_t;

/** The trunk; its position is midway between the hips. */
typedef struct {
    saddle_vec3_t hips_m, velocity_m_s;
    saddle_axes_t axes;
    saddle_vec3_t turn_rad_s; /**< angular velocity, along the world's axes */
} saddle_trunk_t;

/** The point of a sole that a position belongs to. A foot that rolls over heel or toe has that point
 *  at rest on the ground. */
typedef enum { SADDLE_SOLE_MIDDLE = 0, SADDLE_SOLE_HEEL = 1, SADDLE_SOLE_TOE = 2 } saddle_sole_t;

/** Where a foot should be. It has no roll. */
typedef struct {
    uint8_t point; /**< saddle_sole_t */
    saddle_vec3_t position_m, velocity_m_s;
    float yaw_rad, yaw_rate_rad_s;     /**< heading, positive to the left */
    float pitch_rad, pitch_rate_rad_s; /**< sole to ground, positive heel up */
} saddle_foot_t;

/** Angles and rates of all joints, [side][joint]. */
typedef struct {
    float angle_rad[2][SADDLE_LEG_JOINTS];
    float rate_rad_s[2][SADDLE_LEG_JOINTS];
} saddle_joints_t;

/** What had to give way in saddle_inverse(). */
typedef struct {
    bool valid;            /**< false: an input is not finite or absurd, and all angles are 0 */
    bool out_of_reach[2];  /**< the foot is further from the hip than the leg is long */
    uint32_t angle_limits; /**< SADDLE_JOINT_BIT: held at the end of its range, and at rest there */
    uint32_t rate_limits;  /**< SADDLE_JOINT_BIT: turns faster than it may */
} saddle_reach_t;

/** A foot as the joints have it. */
typedef struct {
    saddle_vec3_t sole_m, velocity_m_s; /**< of the middle of the sole */
    saddle_axes_t axes;
    saddle_vec3_t turn_rad_s; /**< angular velocity, along the world's axes */
} saddle_foot_pose_t;

typedef struct {
    saddle_vec3_t position_m, velocity_m_s;
} saddle_com_t;

/** The whole body as the joints have it. */
typedef struct {
    saddle_com_t com;
    saddle_foot_pose_t foot[2];
} saddle_whole_body_t;

/**
 * Segments of a body of that height (m) and mass (kg): lengths by Drillis and Contini (1966), masses
 * and their centres by Winter (2009, table 4.1), ranges of ordinary walking machines. [J1]
 */
saddle_legs_t saddle_legs_default(float body_height_m, float body_mass_kg);

/** Name of the first field that saddle_inverse() and saddle_forward() cannot work with, or NULL. */
const char *saddle_legs_check(const saddle_legs_t *legs);

/** A field and its accepted range, or NULL beyond the last. Offsets are in saddle_legs_t. */
const saddle_config_field_t *saddle_legs_field(size_t index);

/**
 * Joint angles and rates that put the feet where they should be, in closed form. [J2] to [J6]
 *
 * A foot beyond reach is approached along the line from the hip, with the knee at its least angle; the
 * result says so, and which joints are at a limit. Trunk positions and feet share one origin.
 */
saddle_reach_t saddle_inverse(const saddle_legs_t *legs, const saddle_trunk_t *trunk,
                              const saddle_foot_t foot[2], saddle_joints_t *joints);

/** CoM and feet, and their velocities, from joint angles and rates and the trunk. Absurd angles count
 *  as 0. [J7] */
void saddle_forward(const saddle_legs_t *legs, const saddle_trunk_t *trunk,
                    const saddle_joints_t *joints, saddle_whole_body_t *posture);

/**
 * Move the hips of `trunk` until the CoM is where `com` has it, over feet that stay, and find the
 * joints. Three corrections from the hips that are given, so start from the last result or from near;
 * trunk->axes and trunk->turn_rad_s stay. [J8]
 */
saddle_reach_t saddle_inverse_of_com(const saddle_legs_t *legs, const saddle_com_t *com,
                                     const saddle_foot_t foot[2], saddle_trunk_t *trunk,
                                     saddle_joints_t *joints);

#ifdef __cplusplus
}
#endif

#endif
