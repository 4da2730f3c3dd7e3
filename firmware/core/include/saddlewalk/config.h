/** Everything that may be fitted to a person or a device. Start from saddle_config_default(), then
 *  override; an all-zero configuration fails the check. Defaults are the paper's. */
#ifndef SADDLEWALK_CONFIG_H
#define SADDLEWALK_CONFIG_H

#include <stddef.h>

typedef enum {
    SADDLE_ANKLE_ERF = 0,   /**< the paper's ankle strategy, [E12]; z jumps at heel strike */
    SADDLE_ANKLE_RIGID = 1, /**< the inverted pendulum: the leg keeps its length */
    SADDLE_ANKLE_CYCLOID = 2, /**< smooth z with the human amplitude, [E24]; for driving joints */
    SADDLE_ANKLE_COUNT
} saddle_ankle_t;

/** Floats first and in the order of saddle_config_field(). */
typedef struct {
    float body_mass_kg;
    float body_height_m;
    float pendulum_ratio;             /**< pendulum length / body height, [E1] */
    float cop_range_m;                /**< d_h: CoP to heel and metatarsal pivots, [E11] [E16] */
    float step_width_slow_m;          /**< below step_width_slow_speed_m_s, [E3] */
    float step_width_fast_m;          /**< above step_width_fast_speed_m_s, [E3] */
    float step_width_slow_speed_m_s;
    float step_width_fast_speed_m_s;
    float step_width_slope_s;         /**< between the two speeds, [E3] */
    float step_width_intercept_m;
    float half_step_slope_s;          /**< [E4] */
    float half_step_intercept_m;
    float vertical_slope_s;           /**< peak-to-peak vertical CoM excursion, [E5] */
    float vertical_intercept_m;
    float lateral_factor;             /**< of the lateral CoM amplitude; 1: as printed, [E7] */
    float peak_speed_m_s;             /**< where reach and XCoM limit meet, [E6] */
    float ankle_time_constant_s;      /**< of the erf profile, [E12] */
    float heel_strike_max_rad;        /**< a larger commanded angle is limited */
    float acceleration_m_s2;          /**< largest change of the walking speed */
    float shift_time_s;               /**< of the weight to the first stance leg, and back */
    float step_length_factor_left;    /**< steps that the left foot makes; 1: symmetric, [E4] */
    float step_length_factor_right;
    float step_width_factor_left;     /**< left foot to the walking line; 1: symmetric, [E3] */
    float step_width_factor_right;
    float swing_clearance_m;          /**< height of the swing foot at mid-swing, [E10] */
    float tick_max_s;                 /**< the plan advances by no more than this in one tick */
    float command_max_age_s;          /**< an older command is not obeyed: the walk stops */
    float lost_inputs_stop;           /**< 1: lost inputs stop the walk; 0: for recordings, or a
                                           device with a safe state of its own */
    float resume_time_s;              /**< inputs that were lost must be good for so long */
    float com_max_age_s;              /**< older measurements of the CoM are not used */
    float foot_max_age_s;             /**< nor of a foot's CoP and contact */
    float flight_max_s;               /**< both feet in the air for longer is no walking */
    float crossing_max_m;             /**< the left CoP lies right of the right one by no more */
    float step_time_max_s;            /**< without a heel strike for longer nobody walks */
    float bos_factor;                 /**< share of the geometric BoS that is used; 1: the paper's */
    float ankle_work_factor;          /**< W_max of m g d_h^2 / l_p, [E27] */
    float stop_margin_m;              /**< of the XCoM, to stop in the present posture; -10: any, as
                                           printed, [E31] */
    float foresight_s;                /**< a wearer in need can put the foot down within this, [E28] */
    float cop_shift_ap_m;             /**< how far the wearer can move the CoP, [E30]; 0: as printed */
    float cop_shift_ml_m;
    float recovery_width_min_m;       /**< a recovery step is at least so wide, [E30] */
    float recovery_width_max_m;       /**< and at most so wide */
    float recovery_margin_m;          /**< XCoM inside the landing CoP by this, [E30] */
    float recovery_follow;            /**< share of the XCoM's departure that the landing follows; 0:
                                           the nearest place to the planned one, [E30] */
    float caution_score;              /**< a score below it is a caution, [E31] */
    float caution_xcom_ap_m;          /**< XCoM off the planned one by more is a caution, [E31] */
    float caution_xcom_ml_m;
    float level_hold_ticks;           /**< a level holds this long before it is announced */
    saddle_ankle_t ankle;
} saddle_config_t;

/** One float field of the configuration and the values that saddle_config_check() accepts. */
typedef struct {
    const char *name; /**< as in saddle_config_t and in configuration files */
    size_t offset;    /**< in saddle_config_t, bytes */
    float min, max;
} saddle_config_field_t;

/** The paper's parameters for a body. The arguments are judged by saddle_config_check(). */
saddle_config_t saddle_config_default(float body_height_m, float body_mass_kg);

/** Name of the first field that is not finite, out of range or at odds with the others;
 *  NULL when the configuration can be used. The text is constant and never freed.
 *  config must not be NULL. */
const char *saddle_config_check(const saddle_config_t *config);

/** Of the symmetric step, the longer one of the two feet; at least 1. */
float saddle_longer_step_factor(const saddle_config_t *config);

/** [E4] Half a symmetric step. */
float saddle_regressed_half_step_m(const saddle_config_t *config, float speed_m_s);

/** [E3] Step width between the two speeds. */
float saddle_regressed_width_m(const saddle_config_t *config, float speed_m_s);

/** The float field at an index, NULL past the last. For hosts that set fields by name. */
const saddle_config_field_t *saddle_config_field(size_t index);

#endif
