/**
 * What the core measures a wearer by, from what a device has: a gyroscope and an accelerometer on the
 * trunk, joint encoders and the loads of both feet.
 *
 * The result is a saddle_measurement_t, ready for saddle_tick(), with ages that say how far to trust it.
 * The ground is level. x is where the feet point, so there is no compass to drift. Call it at 100 Hz to
 * 1 kHz. docs/joints.md has the equations, and what it reaches.
 */
#ifndef SADDLEWALK_ESTIMATOR_H
#define SADDLEWALK_ESTIMATOR_H

#include <saddlewalk/joints.h>

#ifdef __cplusplus
extern "C" {
#endif

/** Start from saddle_estimator_default(), then override; floats only. */
typedef struct {
    float imu_x_m, imu_y_m, imu_z_m;   /**< of the IMU from midway between the hips, trunk's axes */
    float gyro_range_rad_s;            /**< full scale; near it a reading is saturated */
    float accelerometer_range_m_s2;    /**< likewise */
    float contact_gain_1_s;            /**< how fast the stance foot corrects the velocity, [J13] */
    float posture_gain_1_s;            /**< how fast joints alone correct it, [J13] */
    float gravity_gain_1_s;            /**< how fast gravity corrects the tilt, [J10] */
    float sole_gain_1_s;               /**< and the flat sole, [J11] */
    float heading_gain_1_s;            /**< how fast the feet correct the heading, [J11] */
    float flat_max_rad;                /**< a sole that seems tilted further is not flat, [J11] */
    float roll_min_rad;                /**< one tilted by more rolls over heel or toe */
    float bias_time_s;                 /**< the gyroscope's bias is learned over so long, [J12] */
    float still_max_rad_s;             /**< while somebody stands who turns no faster than this */
    float settle_time_s;               /**< after the start, or a loss, the tilt settles so long */
    float contact_on_n, contact_off_n; /**< a load above is contact, below is none */
    float stance_share;                /**< a foot with this share of the load becomes the anchor */
    float sole_share;                  /**< and with this share its sole lies flat */
    float load_max_n;                  /**< a load above it is no measurement */
    float slip_m_s;                    /**< an anchor that seems to move faster slips, [J14] */
    float max_age_s;                   /**< older readings are lost */
    float frozen_time_s;               /**< the same bits for so long, while the foot travels, */
    float frozen_travel_m;             /**< by this much: the encoder is lost, [J15] */
    float angle_margin_rad;            /**< a joint this far beyond its range, or a leap of it */
} saddle_estimator_config_t;

/** Readings at one time. The accelerometer reads +g along the upward axis at rest. */
typedef struct {
    uint64_t time_us;                             /**< the caller's monotonic clock, any origin */
    saddle_vec3_t gyro_rad_s, accelerometer_m_s2; /**< along the trunk's axes */
    float angle_rad[2][SADDLE_LEG_JOINTS];
    float load_n[2]; /**< vertical force under each foot */
    uint32_t imu_age_us, joints_age_us[2], load_age_us[2];
} saddle_sensors_t;

/** What was found wrong with the sensors. */
typedef enum {
    SADDLE_SENSOR_IMU_STALE = 1u << 0, /**< older than max_age_s */
    SADDLE_SENSOR_IMU_RANGE = 1u << 1, /**< not finite */
    SADDLE_SENSOR_GYRO_SATURATED = 1u << 2,
    SADDLE_SENSOR_ACCELEROMETER_SATURATED = 1u << 3,
    SADDLE_SENSOR_LEFT_JOINTS = 1u << 4, /**< an encoder of that leg is lost: see lost_joints */
    SADDLE_SENSOR_RIGHT_JOINTS = 1u << 5,
    SADDLE_SENSOR_LEFT_LOAD = 1u << 6, /**< stale, not finite or absurd */
    SADDLE_SENSOR_RIGHT_LOAD = 1u << 7,
    SADDLE_SENSOR_SLIP = 1u << 8,      /**< the anchor moves against what the IMU says */
    SADDLE_SENSOR_TILT = 1u << 9,      /**< the loaded sole seems tilted beyond reason */
    SADDLE_SENSOR_SETTLING = 1u << 10, /**< the tilt is not known yet, or again */
    SADDLE_SENSOR_TIME = 1u << 11      /**< time stood, went back or leapt by over 50 ms */
} saddle_sensor_fault_t;

/** The wearer. Positions of trunk and body are from the anchor, the point of the sole that rests on
 *  the ground. */
typedef struct {
    saddle_measurement_t measurement; /**< for saddle_tick(); age 0 where it can be trusted */
    uint32_t faults;                  /**< saddle_sensor_fault_t bits */
    uint32_t lost_joints;             /**< SADDLE_JOINT_BIT: these hold their last sound angle */
    uint8_t anchor_foot;              /**< saddle_side_t */
    uint8_t anchor_point;             /**< saddle_sole_t */
    float load_n[2];                  /**< as used */
    float slip_m_s;                   /**< speed of the anchor against what the IMU says */
    saddle_trunk_t trunk;
    saddle_joints_t joints;   /**< angles as used; rates are 0 */
    saddle_whole_body_t body; /**< its feet have no velocity: they rest or swing, nobody knows */
} saddle_estimate_t;

typedef struct {
    float w, x, y, z;
} saddle_quaternion_t;

/** One encoder's history. Not for users. */
typedef struct {
    float sound_rad, raw_rad;
    float same_s;         /**< since its bits last changed */
    float unsound_s;      /**< until it is trusted again */
    saddle_vec3_t foot_m; /**< where the foot was when its bits last changed, trunk's axes */
} saddle_encoder_t;

/** A position and its velocity, corrected by measurements. Not for users. */
typedef struct {
    saddle_vec3_t value_m, rate_m_s;
} saddle_track_t;

/** State of the estimator; owned by the caller, may be static. Not for users. */
typedef struct {
    saddle_legs_t legs;
    saddle_estimator_config_t config;
    bool initialised, started;
    uint64_t time_us;
    uint64_t contact_from_us[2];  /**< when each foot's contact was first what it is */
    saddle_quaternion_t attitude; /**< of the trunk */
    saddle_vec3_t gyro_rad_s, bias_rad_s;
    float still_s;
    float bias_s; /**< so long the bias has been learned */
    float settling_s;
    saddle_encoder_t encoder[2][SADDLE_LEG_JOINTS];
    saddle_vec3_t sole_m[2]; /**< as last known, from the hips along the trunk's axes */
    float load_n[2];
    bool contact[2];
    uint8_t anchor_foot, anchor_point;
    saddle_track_t imu; /**< of the IMU from the anchor */
    saddle_track_t com; /**< of the CoM from the IMU */
    saddle_vec3_t slip_m_s;
    float slipping_s; /**< until the anchor is trusted again */
    float coasting_s; /**< so long the anchor has not corrected the velocity */
    float com_age_s, foot_age_s[2];
} saddle_estimator_t;

/** For a body with an IMU 10 cm above the hips; gains of 2026-11, docs/joints.md. */
saddle_estimator_config_t saddle_estimator_default(void);

/** Name of the first field that saddle_estimator_init() rejects, or NULL. */
const char *saddle_estimator_check(const saddle_estimator_config_t *config);

/** A field and its accepted range, or NULL beyond the last. */
const saddle_config_field_t *saddle_estimator_field(size_t index);

/** Copies both. SADDLE_ERROR_CONFIG if saddle_legs_check() or saddle_estimator_check() names a field,
 *  SADDLE_ERROR_BUILD if the compiler's flags break the arithmetic; then updates are rejected. */
saddle_status_t saddle_estimator_init(saddle_estimator_t *estimator, const saddle_legs_t *legs,
                                      const saddle_estimator_config_t *config);

/**
 * The wearer at sensors->time_us. [J9] to [J15]
 *
 * SADDLE_ERROR_UNINITIALISED: the estimate is all 0 with ages SADDLE_AGE_NEVER_US. Any reading may be
 * missing or absurd; what is not usable is said in `faults`, and the ages grow until it is sound again.
 */
saddle_status_t saddle_estimator_update(saddle_estimator_t *estimator,
                                        const saddle_sensors_t *sensors,
                                        saddle_estimate_t *estimate);

#ifdef __cplusplus
}
#endif

#endif
