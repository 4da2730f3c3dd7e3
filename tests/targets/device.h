/** A device's sensors and joints in random motion, the same on every target: own random numbers, no
 *  libm. */
#ifndef SADDLEWALK_DEVICE_H
#define SADDLEWALK_DEVICE_H

#include <saddlewalk/joint_walk.h>

typedef struct {
    bool absurd; /**< any bits for some of the floats */
    uint32_t random;
    uint32_t updates;
    saddle_legs_t legs;
    saddle_trunk_t trunk;
    saddle_foot_t foot[2];
    saddle_joints_t joints;
    saddle_reach_t reach;
    saddle_whole_body_t body;
    saddle_estimator_t estimator;
    saddle_sensors_t sensors;
    saddle_estimate_t estimate;
    saddle_drive_config_t drive;
    saddle_plan_t plan;
    saddle_joint_walk_t walk;
    saddle_intent_t intent;
    saddle_joint_commands_t commands;
} device_t;

void device_begin(device_t *device, bool absurd);

/** One millisecond: somebody steps in place; joints by the inverse, the body by the forward kinematics,
 *  what the sensors of that body give, the estimate, the intent of a plan in the same rhythm, and the
 *  joints' commands. */
void device_update(device_t *device);

#endif
