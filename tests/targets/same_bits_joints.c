/* One hash of everything that the joints' library computes, printed: the same on every target.
 * tests/targets/same_bits_joints.txt is what it must print. */
#include "device.h"

#include <stdio.h>
#include <string.h>

#define UPDATES 20000u

static uint64_t hash;

/* FNV-1a's step with a float's bits, and the high half folded down. */
static void add(const float *values, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        uint32_t bits;
        memcpy(&bits, &values[i], sizeof bits);
        hash = (hash ^ bits) * 0x100000001B3u;
        hash ^= hash >> 32;
    }
}

static void add_bits(uint32_t bits)
{
    hash = (hash ^ bits) * 0x100000001B3u;
    hash ^= hash >> 32;
}

static void add_foot(const saddle_foot_pose_t *foot)
{
    add(&foot->sole_m.x, sizeof *foot / sizeof(float));
}

static void add_kinematics(const device_t *device)
{
    add(&device->joints.angle_rad[0][0], sizeof device->joints / sizeof(float));
    add(&device->body.com.position_m.x, sizeof device->body.com / sizeof(float));
    add_foot(&device->body.foot[0]);
    add_foot(&device->body.foot[1]);
    add_bits(device->reach.angle_limits);
    add_bits(device->reach.rate_limits);
}

static void add_estimate(const saddle_estimate_t *estimate)
{
    const saddle_measurement_t *m = &estimate->measurement;
    add(&m->com.height_m, 1);
    add(&m->com.velocity_m_s.x, 2);
    for (unsigned side = 0; side < 2; side++) {
        add(&m->foot[side].cop_m.x, 2);
        add_bits(m->foot[side].contact);
        add_bits(m->foot[side].age_us);
        add_foot(&estimate->body.foot[side]);
    }
    add_bits(m->com.age_us);
    add_bits(estimate->faults);
    add_bits(estimate->lost_joints);
    add(&estimate->trunk.hips_m.x, sizeof estimate->trunk / sizeof(float));
}

static void add_commands(const saddle_joint_commands_t *commands)
{
    add(&commands->joint[0][0].angle_rad, sizeof commands->joint / sizeof(float));
    add(&commands->cop_m.x, 2);
    add(commands->load_share, 2);
    add_bits(commands->fallback);
}

typedef enum { KINEMATICS, ESTIMATES, COMMANDS } part_t;

static void print(const char *name, bool absurd, part_t part)
{
    static device_t device;
    hash = 0xCBF29CE484222325u;
    device_begin(&device, absurd);
    while (device.updates < UPDATES) {
        device_update(&device);
        switch (part) {
        case KINEMATICS: add_kinematics(&device); break;
        case ESTIMATES: add_estimate(&device.estimate); break;
        default: add_commands(&device.commands); break;
        }
    }
    printf("%s %08lx%08lx\n", name, (unsigned long)(hash >> 32),
           (unsigned long)(hash & 0xFFFFFFFFu));
}

int main(void)
{
    print("kinematics", false, KINEMATICS);
    print("kinematics_absurd", true, KINEMATICS);
    print("estimates", false, ESTIMATES);
    print("estimates_absurd", true, ESTIMATES);
    print("commands", false, COMMANDS);
    print("commands_absurd", true, COMMANDS);
    return 0;
}
