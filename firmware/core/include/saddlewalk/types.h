/** What goes into the core and what comes out: configuration, command, measurement, plan, scores,
 *  verdict, and the faults and limits that go with them. The functions are in saddlewalk.h.
 *
 *  Frame: x forward, y to the left, z up; ground z = 0; walking line y = 0. SI units and radians.
 *
 *  The CoP of a foot, as in the paper, is a fixed point of its sole: the middle, midway between the heel
 *  and the metatarsus. It is measured by where the foot is. The centre of the pressure under the foot,
 *  which rolls from heel to toe in each step, must not be given for it. The one exception is
 *  saddle_reference_t. */
#ifndef SADDLEWALK_TYPES_H
#define SADDLEWALK_TYPES_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** Standard gravity, m/s^2. */
#define SADDLE_GRAVITY_M_S2 9.80665f

typedef struct {
    float x, y;
} saddle_vec2_t;

typedef struct {
    float x, y, z;
} saddle_vec3_t;

/** Index of every per-foot array. */
typedef enum { SADDLE_LEFT = 0, SADDLE_RIGHT = 1 } saddle_side_t;

/* ---- configuration ------------------------------------------------------------------------- */

typedef enum {
    SADDLE_ANKLE_ERF = 0,     /**< the paper's ankle strategy, [E12]; z jumps at heel strike */
    SADDLE_ANKLE_RIGID = 1,   /**< the inverted pendulum: the leg keeps its length */
    SADDLE_ANKLE_CYCLOID = 2, /**< smooth z with the human amplitude, [E24]; for driving joints */
    SADDLE_ANKLE_COUNT
} saddle_ankle_t;

/** Everything that may be fitted to a person or a device. Start from saddle_config_default(), then
 *  override; an all-zero configuration fails the check. Defaults are the paper's. Floats come first,
 *  in the order of saddle_config_field(). */
typedef struct {
    float body_mass_kg;              /**< of the wearer */
    float body_height_m;             /**< likewise */
    float pendulum_ratio;            /**< pendulum length / body height, [E1] */
    float cop_range_m;               /**< d_h: CoP to heel and metatarsal pivots, [E11] [E16] */
    float step_width_slow_m;         /**< below step_width_slow_speed_m_s, [E3] */
    float step_width_fast_m;         /**< above step_width_fast_speed_m_s, [E3] */
    float step_width_slow_speed_m_s; /**< the slower of the two speeds, [E3] */
    float step_width_fast_speed_m_s; /**< the faster one */
    float step_width_slope_s;        /**< between the two speeds, [E3] */
    float step_width_intercept_m;    /**< of that line at speed 0 */
    float half_step_slope_s;         /**< half a step over the speed, [E4] */
    float half_step_intercept_m;     /**< and at speed 0 */
    float vertical_slope_s;     /**< peak-to-peak vertical CoM excursion over the speed, [E5] */
    float vertical_intercept_m; /**< and at speed 0 */
    float vertical_offset_m; /**< of the mean CoM height, cycloid only; 0: the CoM is at its highest
                                  where the pendulum has it, [E24] */
    float vertical_delay_rad; /**< of the CoM's height, in angle of its own wave, [E24] */
    float lateral_factor;     /**< of the lateral CoM amplitude; 1: as printed, [E7] */
    float lateral_offset_m;   /**< of the CoM's path to the left of midway between the feet, [E7] */
    float lateral_delay_rad;  /**< of its sway, in gait phase, [E7] */
    float peak_speed_m_s;     /**< where reach and XCoM limit meet, [E6] */
    float ankle_time_constant_s; /**< of the erf profile, [E12] */
    float heel_strike_max_rad;   /**< a larger commanded angle is limited */
    float strike_share; /**< of a step, from passing the stance foot to the heel strike; 0: by the
                             foot's angle, [E38] */
    float acceleration_m_s2;        /**< largest change of the walking speed */
    float turn_acceleration_rad_s2; /**< largest change of the turning rate, [E48] */
    float turn_step_max_rad;        /**< largest turn in one step, [E48] */
    float shift_time_s;             /**< of the weight to the first stance leg, and back */
    float step_length_factor_left;  /**< steps that the left foot makes; 1: symmetric, [E4] */
    float step_length_factor_right; /**< that the right foot makes */
    float step_width_factor_left;   /**< left foot to the walking line; 1: symmetric, [E3] */
    float step_width_factor_right;  /**< right foot to it */
    float swing_clearance_m;        /**< height of the swing foot at mid-swing, [E10] */
    float swing_begin; /**< where the swing foot's way along x begins, in swings since lift-off; */
    float swing_end;   /**< where it ends; */
    float swing_skew;  /**< and how late it comes; 0: the line through stance foot and CoM, [E44] */
    float swing_approach;       /**< it comes down no flatter than this slope; 0: as high as the
                                     clearance alone makes it, [E10] */
    float double_support_share; /**< of a step, after its landing: both feet carry, [E39] */
    float cop_enter;            /**< where the CoP enters a foot, of cop_range_m, */
    float cop_leave;            /**< and where it leaves it, [E39] */
    float landing_early_s; /**< a foot that lands sooner by no more carries then; 0: none, [E43] */
    float landing_late_s;  /**< and one that is late is waited for so long */
    float placement_gain;  /**< of what the ankles can correct of the XCoM's departure, the landing
                                follows so much, and of the rest recovery_follow; 0: it stays
                                where it is planned, [E45] */
    float tick_max_s;      /**< the plan advances by no more than this in one tick */
    float command_max_age_s;    /**< an older command times out: the walk stops */
    float lost_inputs_stop;     /**< 1: lost inputs stop the walk; 0: for recordings, or a
                                     device with a safe state of its own */
    float resume_time_s;        /**< inputs that were lost must be good for so long, and nobody
                                     unstable */
    float resume_by_command;    /**< 1: a stand must be commanded too before the walk goes on; 0:
                                     it goes on by itself */
    float com_max_age_s;        /**< older measurements of the CoM are not used */
    float foot_max_age_s;       /**< nor of a foot's CoP and contact */
    float sensor_latency_s;     /**< that ages do not contain: of sensors and filters. Every
                                     measurement is older by it, also for the two above, [E46] */
    float flight_max_s;         /**< both feet in the air for longer is no walking */
    float crossing_max_m;       /**< the left CoP lies right of the right one by no more */
    float step_time_max_s;      /**< without a heel strike for longer nobody walks */
    float bos_factor;           /**< share of the geometric BoS that is used; 1: the paper's */
    float ankle_work_factor;    /**< W_max of m g d_h^2 / l_p, [E27] */
    float stop_margin_m;        /**< of the XCoM, to stop in the present posture; -10: any, as
                                     printed, [E36] */
    float prediction_horizon_s; /**< in an emergency the foot can land within this, [E28] */
    float cop_shift_ap_m;       /**< how far the wearer can move the CoP, [E30]; 0: as printed */
    float cop_shift_ml_m;       /**< and across */
    float recovery_width_min_m; /**< a recovery step is at least so wide, [E30] */
    float recovery_width_max_m; /**< and at most so wide */
    float recovery_margin_m;    /**< XCoM inside the landing CoP by this, [E30] */
    float recovery_follow;      /**< share of the XCoM's departure that the landing follows; 0:
                                     the nearest place to the planned one, [E30] */
    float departure_foresight;  /**< how far ahead, of 1 / natural frequency, [E33] */
    float departure_lateral_weight; /**< of a departure across, [E33] */
    float departure_step_share;     /**< of half the distance of the feet: no departure, [E33] */
    float departure_sink_share;     /**< of a sinking CoM's velocity that is, [E33] */
    float tolerance_max;            /**< departure that a walker of even speed tolerates, [E34] */
    float tolerance_ripple_slope;   /**< less tolerance per ripple of the speed, [E34] */
    float tolerance_min;            /**< and no less than this, [E34] */
    float plan_weight;    /**< of what the step to come can do, for a wearer on a plan, [E35] */
    float plan_reserve;   /**< and added to that */
    float caution_margin; /**< a margin below it is a caution, [E31] */
    float learn_time_s;   /**< forgetting time of mean velocity and height, [E32] */
    float learn_ripple_time_s; /**< and of the ripple, [E32] */
    float learn_ripple_start;  /**< ripple before a walk was seen; of a calibrated person */
    float learn_margin;        /**< ripple and steps are learned above this margin, [E32] */
    float previous_level;      /**< 1: the level as 0.1.0 decided it, for comparison, [E36] */
    float caution_score;       /**< a score below it is a caution, [E36] */
    float caution_xcom_ap_m;   /**< XCoM off the planned one by more is a caution, [E36] */
    float caution_xcom_ml_m;   /**< and across */
    float level_hold_ticks;    /**< a level holds this long before it is announced */
    saddle_ankle_t ankle;      /**< the model of the ankles, [E12] [E24] */
} saddle_config_t;

/** One float field of the configuration and the values that saddle_config_check() accepts. */
typedef struct {
    const char *name; /**< as in saddle_config_t and in configuration files */
    size_t offset;    /**< in saddle_config_t, bytes */
    float min, max;
} saddle_config_field_t;

/* ---- command ------------------------------------------------------------------------------- */

typedef enum {
    SADDLE_COMMAND_STAND = 0, /**< stop at the next place where the feet come side by side */
    SADDLE_COMMAND_WALK = 1   /**< walk; speed 0 is a stand */
} saddle_command_mode_t;

/** The slowest walk that is planned; a slower one, but for 0, is limited to it. */
#define SADDLE_SPEED_FLOOR_M_S 0.01f

/** What is asked of the planner, at any time. The speed is approached at acceleration_m_s2; the
 *  heel-strike angle holds from the heel strike after the next, the turning rate from the next landing
 *  on, approached at turn_acceleration_rad_s2. */
typedef struct {
    uint8_t mode;          /**< saddle_command_mode_t; a stand does not need the numbers below */
    float speed_m_s;       /**< along the way */
    float heel_strike_rad; /**< foot to ground when the heel strikes; erf ankles only */
    float turn_rate_rad_s; /**< of the way's heading, to the left; 0: straight on, [E48] */
} saddle_command_t;

/* ---- measurement --------------------------------------------------------------------------- */

/** Age of a measurement that never came. */
#define SADDLE_AGE_NEVER_US UINT32_MAX

/** The CoM as measured. */
typedef struct {
    float height_m;             /**< above the ground */
    saddle_vec2_t velocity_m_s; /**< in the frame of ground_m_s: on a floor, over it */
    uint32_t age_us;            /**< at the time of the tick, or SADDLE_AGE_NEVER_US */
} saddle_measured_com_t;

/** A foot as measured. */
typedef struct {
    saddle_vec2_t cop_m; /**< middle of the sole, relative to the CoM */
    float ground_m_s;    /**< speed along x of the ground under it: 0 on a floor, negative for a
                              treadmill's belt, which runs backward */
    bool contact;        /**< on the ground */
    uint32_t since_us; /**< how long the contact had lasted, or been lost, when it was measured; 0:
                            it changed then, or the date is not known */
    uint32_t age_us;   /**< at the time of the tick, or SADDLE_AGE_NEVER_US */
} saddle_measured_foot_t;

/** Each foot and the CoM have their own age. The axes are those of the wearer's heading, which turn with
 *  the pelvis: a device that has only its joints and its tilt measures in them. */
typedef struct {
    saddle_measured_com_t com;
    saddle_measured_foot_t foot[2]; /**< by saddle_side_t */
} saddle_measurement_t;

/** Why an input was not used or gave no score. */
typedef enum {
    SADDLE_FAULT_COMMAND = 1u << 0,          /**< not usable: the last good one holds */
    SADDLE_FAULT_COM_STALE = 1u << 1,        /**< older than com_max_age_s */
    SADDLE_FAULT_COM_RANGE = 1u << 2,        /**< not finite or absurd */
    SADDLE_FAULT_LEFT_STALE = 1u << 3,       /**< older than foot_max_age_s */
    SADDLE_FAULT_LEFT_RANGE = 1u << 4,       /**< not finite or absurd */
    SADDLE_FAULT_RIGHT_STALE = 1u << 5,      /**< as on the left */
    SADDLE_FAULT_RIGHT_RANGE = 1u << 6,      /**< as on the left */
    SADDLE_FAULT_FEET_TOGETHER = 1u << 7,    /**< CoPs within 1 mm: no saddle space */
    SADDLE_FAULT_SPEED_INFEASIBLE = 1u << 8, /**< v_CoMp cannot be walked: no step scores */
    SADDLE_FAULT_COM_FROZEN = 1u << 9,     /**< the same bits for com_max_age_s while the feet moved
                                                otherwise, or a walk was planned */
    SADDLE_FAULT_LEFT_FROZEN = 1u << 10,   /**< the same bits for foot_max_age_s as the CoM moved */
    SADDLE_FAULT_RIGHT_FROZEN = 1u << 11,  /**< as on the left */
    SADDLE_FAULT_AIRBORNE = 1u << 12,      /**< both feet in the air for longer than flight_max_s */
    SADDLE_FAULT_FEET_CROSSED = 1u << 13,  /**< by more than crossing_max_m */
    SADDLE_FAULT_COMMAND_STALE = 1u << 14, /**< no usable one for command_max_age_s */
    SADDLE_FAULT_COM_LOW = 1u << 15 /**< the CoM below the knees: somebody lies, or an offset */
} saddle_fault_t;

/** Faults that leave the CoM, or the feet, without a measurement to use. */
#define SADDLE_FAULTS_COM                                                  \
    ((uint32_t)SADDLE_FAULT_COM_STALE | (uint32_t)SADDLE_FAULT_COM_RANGE | \
     (uint32_t)SADDLE_FAULT_COM_FROZEN | (uint32_t)SADDLE_FAULT_COM_LOW)
#define SADDLE_FAULTS_LEFT                                                   \
    ((uint32_t)SADDLE_FAULT_LEFT_STALE | (uint32_t)SADDLE_FAULT_LEFT_RANGE | \
     (uint32_t)SADDLE_FAULT_LEFT_FROZEN)
#define SADDLE_FAULTS_RIGHT                                                    \
    ((uint32_t)SADDLE_FAULT_RIGHT_STALE | (uint32_t)SADDLE_FAULT_RIGHT_RANGE | \
     (uint32_t)SADDLE_FAULT_RIGHT_FROZEN)
#define SADDLE_FAULTS_FEET                                                        \
    (SADDLE_FAULTS_LEFT | SADDLE_FAULTS_RIGHT | (uint32_t)SADDLE_FAULT_AIRBORNE | \
     (uint32_t)SADDLE_FAULT_FEET_CROSSED)

/* ---- plan ---------------------------------------------------------------------------------- */

typedef enum {
    SADDLE_MODE_STANDING = 0,
    SADDLE_MODE_STARTING = 1, /**< weight goes to the first stance leg, then the first step */
    SADDLE_MODE_WALKING = 2,
    SADDLE_MODE_STOPPING = 3 /**< until the feet are side by side and the CoM between them */
} saddle_mode_t;

/** Limits that shaped an output. */
typedef enum {
    SADDLE_LIMIT_SPEED = 1u << 0,       /**< commanded speed not feasible: the nearest that is */
    SADDLE_LIMIT_HEEL_STRIKE = 1u << 1, /**< angle outside [0, heel_strike_max_rad] */
    SADDLE_LIMIT_TOE_OFF = 1u << 2,     /**< ankle angle outside the geometry, [E13] [E25] */
    SADDLE_LIMIT_FEET = 1u << 3,        /**< measured feet that no plan can start or go on from */
    SADDLE_LIMIT_TICK_GAP = 1u << 4,    /**< late tick: the plan advanced by tick_max_s only */
    SADDLE_LIMIT_SAFE_STOP = 1u << 5,   /**< inputs were lost: the walk stops until
                                             they have been good for resume_time_s */
    SADDLE_LIMIT_TURN = 1u << 6         /**< commanded turning rate more than a walk at that speed
                                             bears, [E48] */
} saddle_limit_t;

/** Longest time that is predicted; what never comes is said to come then. */
#define SADDLE_TIME_MAX_S 1000.0f

/** The pendulum that takes the planned steps: what a CoP within the feet can make of the plan. To stay
 *  on it, a wearer whose XCoM is off by e puts the CoP at cop_m + (1 + gain) e. */
typedef struct {
    saddle_vec2_t com_m;
    saddle_vec2_t xcom_m; /**< rate: natural frequency times its distance from cop_m, [E39];
                               that of com_m: times its distance from xcom_m */
    saddle_vec2_t cop_m;  /**< where the ground's force acts, of both feet together: rolls */
    float load[2];        /**< share of the weight that each foot carries; their sum is 1 */
} saddle_reference_t;

/** The plan at one instant. x is measured from the CoP of the planned stance foot in its heading, y from
 *  the walking line, z from the ground. Beside the stance foot the line is at origin_x_nm, origin_y_nm
 *  from where it began, beside the first stance foot, in the heading of that. A foot that stands neither
 *  moves nor turns; with each landing the axes turn to the heading of the foot that has landed. */
typedef struct {
    bool valid;            /**< false: the tick failed and all else is 0 */
    uint8_t mode;          /**< saddle_mode_t */
    uint8_t phase;         /**< 0 to 3: the quarter of the stride, from the left foot via point */
    uint8_t support;       /**< saddle_side_t; both feet carry while standing */
    uint32_t step_count;   /**< changes of the stance foot since the start */
    uint32_t stride_count; /**< times the left foot via point was passed since the start */
    float theta_rad;       /**< gait phase within the stride, [0, 2 pi), [E8] */
    int64_t origin_x_nm;   /**< walked distance to the stance foot; integer, so it never drifts */
    int64_t origin_y_nm;   /**< and to the left; 0 until the way turns, [E47] */
    float heading_rad; /**< of x, to the left of where the way began, [-pi, pi]; from an integer, so
                            it never drifts */
    float
        curvature_1_m[2]; /**< of the way behind and ahead of the stance foot, to the left, [E47] */
    float speed_m_s, step_length_m, step_width_m; /**< of the running quarter */
    float acceleration_m_s2;                      /**< rate of change of that speed */
    saddle_vec3_t com_m, com_velocity_m_s;
    saddle_vec3_t foot_m[2];            /**< middles of the soles */
    float foot_pitch_rad[2];            /**< sole to ground, positive heel up */
    float foot_yaw_rad[2];              /**< of the foot, to the left of x; 0 of the stance foot */
    float pelvis_yaw_rad;               /**< likewise: along the way beside the CoM */
    saddle_vec3_t swing_velocity_m_s;   /**< of the foot that is not in support */
    float leg_length_m;                 /**< stance leg */
    float knee_flexion_m;               /**< stance leg shorter than with a straight knee by this,
                                             cycloid only, [E25] */
    float toe_off_rad, heel_strike_rad; /**< ankle angles, sole to ground */
    float time_to_via_point_s;          /**< next via point, or end of a shift of weight */
    float time_to_heel_strike_s;        /**< next heel strike, [E12] */
    float time_to_toe_off_s;            /**< next change of support: the swing CoP arrives */
    saddle_vec2_t landing_m;            /**< where the swing CoP arrives; moved, [E45] */
    saddle_vec2_t last_step_m;          /**< from the stance foot before this one to this one */
    saddle_reference_t reference;       /**< to balance by, [E39] */
} saddle_plan_t;

/* ---- scores -------------------------------------------------------------------------------- */

#define SADDLE_BOS_VERTICES 16

/** Base of support: the disc around the midpoint of the CoPs, cut at +-half_depth_m along x_S; or the
 *  share of it that a person uses. */
typedef struct {
    saddle_vec2_t centre_m;
    saddle_vec2_t axis_x; /**< unit vector x_S; lambda = atan2(axis_x.y, axis_x.x) */
    float radius_m;       /**< half the distance between the CoPs, times the share */
    float half_depth_m;   /**< d_h, times the share */
    bool defined;         /**< false: feet together, every number above is 0 */
} saddle_bos_t;

/** Which fields of saddle_scores_t hold a result; the others are 0. xcom_m is known whenever the
 *  velocity is, and bos has its own flag (bos.defined). */
typedef enum {
    SADDLE_VALID_V_COMP = 1u << 0,
    SADDLE_VALID_STEP = 1u << 1, /**< s_pend and s_jump */
    SADDLE_VALID_S_SW = 1u << 2,
    SADDLE_VALID_MOS_COM = 1u << 3,
    SADDLE_VALID_MOS_XCOM = 1u << 4,
    SADDLE_VALID_GRAVITY = 1u << 5,
    SADDLE_VALID_STOP = 1u << 6, /**< excess_stop_j and can_stop: a leg reaches the CoM */
    SADDLE_VALID_ALL = (1u << 7) - 1u
} saddle_valid_t;

/** Scores of a posture, in its frame. */
typedef struct {
    uint32_t valid;       /**< saddle_valid_t bits */
    float v_comp_m_s;     /**< mean AP speed over the last completed step, else the planner's */
    float s_pend, s_jump; /**< [E20] */
    float s_sw;           /**< [E21] */
    float mos_com_m, mos_xcom_m; /**< margins in the instantaneous BoS, [E17] */
    saddle_vec2_t gravity_n;     /**< [E18] */
    float excess_stop_j;         /**< [E26] */
    bool can_stop;               /**< [E27] the ankles can absorb that */
    bool paper_stable;           /**< the paper's verdict: can_stop, or all three scores > 0 */
    saddle_vec2_t xcom_m;        /**< [E19] */
    saddle_bos_t bos;            /**< instantaneous (I-BoS) */
} saddle_scores_t;

/* ---- verdict ------------------------------------------------------------------------------- */

/** How far the wearer is from falling, [E31]. */
typedef enum {
    SADDLE_LEVEL_UNKNOWN = 0, /**< no input, or nobody was seen to walk: the reason says which */
    SADDLE_LEVEL_STABLE = 1,  /**< walks as usual */
    SADDLE_LEVEL_CAUTION = 2, /**< departs further from the usual walk than steady steps do */
    SADDLE_LEVEL_UNSTABLE = 3 /**< no margin is left: a fall is likely */
} saddle_level_t;

/** What decided the level. */
typedef enum {
    SADDLE_REASON_NONE = 0,
    SADDLE_REASON_INPUT = 1,   /**< unknown: the faults say which input */
    SADDLE_REASON_NO_WALK = 2, /**< unknown: nothing is planned, and nobody was seen to stand or to
                                    complete a step; with previous_level, as all up to 10 but
                                    NO_STEP */
    SADDLE_REASON_NO_STEP = 3, /**< the step to come does not catch the CoM */
    SADDLE_REASON_SPEED = 4,   /**< caution, here and below: v_CoMp cannot be walked */
    SADDLE_REASON_S_PEND = 5,
    SADDLE_REASON_S_JUMP = 6,
    SADDLE_REASON_S_SW = 7,
    SADDLE_REASON_XCOM_AP = 8, /**< the XCoM is off the planned one */
    SADDLE_REASON_XCOM_ML = 9,
    SADDLE_REASON_OFF_TRACK = 10, /**< more energy than the ankles can bring back to the plan's */
    SADDLE_REASON_SETTLING = 11,  /**< unknown: no level has held for level_hold_ticks yet */
    SADDLE_REASON_FORWARD = 12,   /**< the CoM departs ahead of the feet, here and below */
    SADDLE_REASON_BACKWARD = 13,
    SADDLE_REASON_LEFT = 14,
    SADDLE_REASON_RIGHT = 15,
    SADDLE_REASON_SINKING = 16 /**< or sinks */
} saddle_reason_t;

/** Points are measured from the stance CoP, the foot that does not step. */
typedef struct {
    bool found;   /**< false: no place within reach helps, and landing_m is 0 */
    bool stops;   /**< the XCoM will lie in the BoS of that posture: the step ends the walk */
    uint8_t foot; /**< saddle_side_t: the foot that steps */
    saddle_vec2_t landing_m; /**< the place nearest to the wanted one */
    float margin_m; /**< reach that is left on the scarcer axis; negative: what is lacking */
} saddle_recovery_t;

/** The measured posture against the wearer's own walk and the one that is planned. Where
 *  margin_known is false margin, caution_below and driver are 0; where compared is false all below
 *  it is. */
typedef struct {
    uint8_t level;  /**< saddle_level_t that is announced */
    uint8_t reason; /**< saddle_reason_t of it */
    uint8_t driver; /**< saddle_reason_t of this tick's margin: the largest part of the departure */
    bool margin_known;
    float margin;        /**< by it the level is decided: larger is safer, unstable at and below 0;
                              of the CoM's usual height, [E34] [E35] */
    float caution_below; /**< and caution at and below this, [E31] */
    bool compared;
    bool on_track;                 /**< [E27] the ankles can absorb excess_track_j */
    float excess_track_j;          /**< [E26]; it and on_track only with SADDLE_VALID_STOP */
    float ebos_com_m, ebos_xcom_m; /**< margins expected in the BoS of the next heel strike (E-BoS),
                                        [E29] */
    saddle_vec2_t xcom_deviation_m; /**< from the planned XCoM at the same phase */
    saddle_recovery_t recovery;     /**< [E30] */
} saddle_verdict_t;

/** The wearer's own walk, learned while it is steady: what is usual, [E32]. All but the ripple is 0
 *  before the first measurement; a step's numbers are 0 before the first steady step. */
typedef struct {
    saddle_vec2_t velocity_m_s; /**< mean over learn_time_s */
    float height_m;             /**< of the CoM, likewise */
    float ripple;               /**< RMS of the sagittal velocity about its mean while walking, of
                                     sqrt(g height_m); starts at learn_ripple_start */
    float step_time_s, step_length_m, step_width_m;
    float step_margin; /**< usual lowest margin of a step, before the plan has a say, [E34] */
} saddle_learned_walk_t;

/* ---- a tick -------------------------------------------------------------------------------- */

/** Did the call work? Whether there is an answer is in plan.valid and scores.valid. */
typedef enum {
    SADDLE_OK = 0,                  /**< the output is complete */
    SADDLE_ERROR_NULL = 1,          /**< an argument is NULL */
    SADDLE_ERROR_CONFIG = 2,        /**< saddle_config_check() names the field */
    SADDLE_ERROR_UNINITIALISED = 3, /**< saddle_init() has not succeeded on this context */
    SADDLE_ERROR_TIME = 4,          /**< time_us went backwards: no plan, no scores, state kept,
                                         until it has caught up or saddle_init() starts over */
    SADDLE_ERROR_COMMAND = 5,       /**< saddle_join() needs a walk with a speed > 0 */
    SADDLE_ERROR_BUILD = 6,         /**< the core's flags, or the processor's rounding mode, break
                                         its bits; docs/porting.md names those to use */
    SADDLE_ERROR_NUMBER = 7 /**< a result is not finite: the context is damaged, by a fault of
                                 its memory or by other code; saddle_init() starts over */
} saddle_status_t;

typedef struct {
    uint64_t time_us; /**< the caller's monotonic clock, any origin */
    saddle_command_t command;
    uint32_t command_age_us; /**< since the command was last confirmed */
    saddle_measurement_t measurement;
} saddle_input_t;

/** status: did the call work; limits: what clamped the plan; faults: which inputs were not used. */
typedef struct {
    saddle_status_t status;
    uint32_t limits; /**< saddle_limit_t bits */
    uint32_t faults; /**< saddle_fault_t bits */
    saddle_plan_t plan;
    saddle_scores_t scores;     /**< of the measured posture, in the frame of the CoM */
    saddle_verdict_t verdict;   /**< the measured posture against the wearer's walk and the plan */
    saddle_learned_walk_t walk; /**< the wearer's own, as learned so far */
} saddle_output_t;

#endif
