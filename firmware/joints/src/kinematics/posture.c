#include "kinematics/chain.h"
#include "math/bytes.h"

#include <saddlewalk/joints.h>

void saddle_forward(const saddle_legs_t *legs, const saddle_trunk_t *trunk,
                    const saddle_joints_t *joints, saddle_whole_body_t *posture)
{
    saddle_chain_t chain[2];
    for (unsigned side = 0; side < 2; side++) {
        saddle_chain(legs, trunk, joints, (saddle_side_t)side, &chain[side]);
        saddle_copy(&posture->foot[side], &chain[side].foot, sizeof posture->foot[side]);
    }
    posture->com = saddle_com_of(legs, trunk, chain);
}
