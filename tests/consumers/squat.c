/* The joints of somebody who squats, by the installed package alone. */
#include <saddlewalk/joint_command.h>
#include <stdio.h>

int main(void)
{
    const saddle_legs_t legs = saddle_legs_default(1.79f, 63.3f);
    const saddle_trunk_t trunk = {
        .hips_m = {0.0f, 0.0f, 0.7f},
        .axes = {{1.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}, {0.0f, 0.0f, 1.0f}}};
    const saddle_foot_t foot[2] = {{.position_m = {0.0f, 0.1f, 0.0f}},
                                   {.position_m = {0.0f, -0.1f, 0.0f}}};
    saddle_joints_t joints;
    const saddle_reach_t reach = saddle_inverse(&legs, &trunk, foot, &joints);
    printf("%d %.6f\n", reach.valid, joints.angle_rad[SADDLE_LEFT][SADDLE_KNEE]);
    return 0;
}
