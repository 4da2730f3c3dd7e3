/** What a context consists of, so that its owner can reserve it. Private: no field is part of the
 *  interface, and each belongs to the module whose functions change it. */
#ifndef SADDLEWALK_PRIVATE_CONTEXT_H
#define SADDLEWALK_PRIVATE_CONTEXT_H

#include <saddlewalk/types.h>

/** Keeps a function's variables out of its caller's stack frame, where a compiler would inline it. */
#if defined(__GNUC__)
#define SADDLE_NOINLINE __attribute__((noinline))
#else
#define SADDLE_NOINLINE
#endif

/* ---- model: the configuration and what follows from it -------------------------------------- */

/** Fixed point: a speed in 2^-42 m/s or a position in 2^-42 um. */
typedef int64_t saddle_fixed_t;

/** How a person's CoM path differs from the paper's: offsets, and the sine and cosine of what its
 *  phase lags by, [E7] [E24]. */
typedef struct {
    float lateral_m, lateral_sin, lateral_cos;
    float vertical_m, vertical_sin, vertical_cos;
} saddle_shape_t;

/** The swing foot's way along x, [E44]. */
typedef struct {
    float begin, rate, skew; /**< of swings; skew 0: on the line through stance foot and CoM */
    float scale;             /**< so that the foot is there when it lands */
} saddle_swing_profile_t;

/** Coefficients, derived once. */
typedef struct {
    float pendulum_m;              /**< l_p, [E1] */
    float natural_frequency_rad_s; /**< w_n, [E2] */
    float half_step_max_m;         /**< reach, [E6] */
    float speed_ceiling_m_s;       /**< no speed at or above it is planned, [E6] */
    uint32_t half_step_slope[2];   /**< of the step that each foot makes, in 2^-31 s, [E4] */
    saddle_fixed_t half_step_intercept[2];
    float ankle_work_j;         /**< W_max, [E27] */
    float horizon_growth;       /**< of a deviation within prediction_horizon_s, [E29] */
    float trailing_share;       /**< of any growth: what a trailing foot takes off at most */
    float com_height_min_m;     /**< a lower CoM is below the knees */
    float crawl_m_s;            /**< a stop goes on at no less until it brakes, */
    float braked_in_a_step_m_s; /**< and at no more: every step is long enough to brake from it */
    float braked_in_a_tick_m_s; /**< what the longest tick can brake */
    float strike_lead;          /**< of half a step, from heel strike to landing, [E38] */
    float leg_m;                /**< with the sole flat and the knee straight, [E25] */
    saddle_shape_t shape;
    saddle_swing_profile_t swing;
    float command_max_age_us, com_max_age_us, foot_max_age_us; /**< to compare ages with */
    uint32_t latency_us;                                       /**< sensor_latency_s */
    uint32_t tick_max_us;
    uint32_t shift_us; /**< of a shift of weight */
} saddle_body_t;

typedef struct {
    saddle_config_t config;
    saddle_body_t body;
} saddle_model_t;

/* ---- motion --------------------------------------------------------------------------------- */

/** A value over a distance, and its derivative. */
typedef struct {
    float value;
    float slope;
} saddle_sample_t;

/** A mismatch that fades out. */
typedef struct {
    saddle_sample_t start; /**< mismatch where the fading begins */
    float start_m;         /**< where along it */
    float length_m;        /**< until it is gone; 0: no mismatch */
} saddle_blend_t;

/** One quarter of the stride: from beside the stance foot (foot via point) to midway between the
 *  feet (saddle via point), or back. */
typedef struct {
    saddle_side_t stance;
    float length_m;    /**< along x; half a step in steady walking */
    float width_m;     /**< between the lines of the two feet, > 0 */
    float amplitude_m; /**< A_y, at most width_m / pi, [E7] */
    float vertical_m;  /**< delta Z, peak to peak, [E5] */
} saddle_quarter_t;

/** The speed goes to its target at a constant rate and stays there. */
typedef struct {
    saddle_fixed_t speed;        /**< now, >= 0 */
    saddle_fixed_t target;       /**< >= 0 */
    float speed_m_s, target_m_s; /**< the same as floats */
    float rate_m_s2;             /**< >= 0, magnitude */
} saddle_speed_profile_t;

/** One swing, relative to the stance CoP. Progress runs from 0 at one saddle via point over 1/2
 *  beside the stance foot to 1 at the next; a first or last half swing is in the air for half. */
typedef struct {
    float lift_progress, land_progress; /**< in the air between them */
    float line_y_m;                     /**< where it lands, from the stance CoP */
    saddle_vec2_t offset_m;             /**< from the line to where it lifted off: fades out */
    float stretch_m; /**< along x, from its way in this quarter to that in the last: fades out */
    float clearance_m;
    float approach, approach_max_m;    /**< slope on which it comes down, and from what height */
    float path_width_m;                /**< of the quarter whose lateral path is followed */
    saddle_vec2_t moved_m;             /**< its landing, from where the walk alone has it, [E45] */
    saddle_blend_t moving_x, moving_y; /**< what the foot is off that, over the CoM's x */
} saddle_swing_t;

typedef struct {
    float angle_rad; /**< of the foot, commanded */
    float lead_m;    /**< CoM distance from there to the saddle via point, [E12] */
} saddle_heel_strike_t;

/** One step-to-step transition. */
typedef struct {
    saddle_heel_strike_t strike;
    float toe_off_rad;    /**< toe-off angle when the heel strikes, [E13] */
    bool toe_off_limited; /**< the geometry asks for an angle outside [0, pi] */
} saddle_transition_t;

/** An arc of the way, from where one foot landed to where the next one does: places are from the stance
 *  foot, along the way, [E47]. */
typedef struct {
    float curvature_1_m; /**< to the left */
    float begin_m;
    float before_1_m; /**< curvature of the arc before, less its own: fades out, */
    float fade_m;     /**< on this way from its begin */
} saddle_arc_t;

/** The walking line: what the gait cycle's x and y are measured along and across. */
typedef struct {
    int64_t origin_x_nm, origin_y_nm; /**< beside the stance foot, from where it began */
    saddle_fixed_t heading;           /**< there; an angle counts 2^-42 rad */
    saddle_fixed_t curvature;         /**< of the arc ahead, exactly */
    uint32_t walked_nm;               /**< to the stance foot, wraps */
    float turn_rate_rad_s;            /**< that the arc ahead was made for, */
    float wanted_rad_s;               /**< and that of the next arc; feasible */
    saddle_arc_t arcs[2];             /**< behind and ahead of the stance foot */
    bool bent;                        /**< else the arcs are straight and nothing fades */
} saddle_way_t;

/** The gait cycle. Every length is measured from the stance CoP, y from the walking line. */
typedef struct {
    saddle_speed_profile_t profile;
    saddle_fixed_t position; /**< CoM x, in [-quarter, quarter] */
    saddle_fixed_t quarter_length;
    float x_m;                  /**< the position as a float */
    float sin_phase, cos_phase; /**< of the phase angle there, com_path.h */
    saddle_quarter_t quarter;
    uint8_t phase;         /**< 0 to 3; even: towards the saddle via point */
    bool foot_is_late;     /**< the swing foot was to have landed and is seen in the air */
    bool last_swing;       /**< the running step ends beside the stance foot: a stop */
    uint32_t step_count;   /**< changes of the stance foot */
    uint32_t stride_count; /**< times that phase 0 was entered again */
    saddle_way_t way;
    float stance_y_m;
    saddle_blend_t lateral;  /**< mismatch of CoM y */
    saddle_blend_t vertical; /**< mismatch of CoM z, cycloid only */
    float lean_m;            /**< of the CoM to the left, to carry a turn, [E49], */
    saddle_blend_t leaning;  /**< and what it is off that */
    saddle_swing_t swing;
    float lift_pitch_rad;             /**< of the swing foot when it lifted off */
    saddle_heel_strike_t next_strike; /**< of the next landing */
    saddle_transition_t transition;   /**< of the nearest saddle via point, erf and rigid only */
    saddle_vec2_t last_step_m;        /**< from the old stance foot to the new one */
} saddle_cycle_t;

typedef struct {
    uint8_t mode;
    bool shifting;         /**< time moves the CoM between the feet, not the gait cycle */
    bool braking;          /**< a stop has begun that ends beside the stance foot */
    float speed_m_s;       /**< wanted, feasible; 0: stand */
    float heel_strike_rad; /**< wanted, in range */
    uint32_t shift_us;     /**< since the shift began */
    saddle_vec2_t shift_from_m, shift_to_m; /**< CoM from the stance CoP */
    saddle_vec2_t other_m; /**< the other foot, from the stance CoP, while both stand */
    uint8_t start_phase;   /**< where the cycle begins after the shift */
    bool foot_lifted;      /**< the swing foot was seen in the air in this swing */
    bool landing_open;     /**< the last landing has not been compared with the measured one */
    saddle_cycle_t cycle;
} saddle_planner_t;

/* ---- balance: of the plan ------------------------------------------------------------------- */

/** What is remembered of a plan, from its stance CoP: feet, and the reference's CoM and XCoM. */
typedef struct {
    uint32_t walked_nm;     /**< modulo 2^32: of plans so near the difference is exact */
    uint32_t until_next_us; /**< from this plan to the next one that is remembered */
    uint8_t support;        /**< saddle_side_t */
    bool carries[2];        /**< the reference loads the foot */
    saddle_vec2_t foot_m[2], com_m, xcom_m;
} saddle_past_plan_t;

#define SADDLE_PAST_PLANS 4u

/** The plan of this tick and of some before it: 0.2 s at least. */
typedef struct {
    saddle_past_plan_t plans[SADDLE_PAST_PLANS]; /**< a ring */
    uint8_t newest, count;
} saddle_past_t;

/* ---- senses --------------------------------------------------------------------------------- */

/** A number that keeps its bits: for how long, and how far the CoM moved meanwhile. */
typedef struct {
    float unchanged_s;
    saddle_vec2_t moved_m; /**< of the CoM since then */
} saddle_frozen_timer_t;

/** What the check of the measurements remembers. */
typedef struct {
    saddle_vec2_t velocity_m_s, cop_m[2]; /**< last accepted */
    float height_m;
    saddle_frozen_timer_t com_timer, foot_timer[2];
    saddle_vec2_t anchor_m[2]; /**< where a foot on the ground should stay: CoP + moved_m of the
                                    CoM, since it landed or the CoM is still */
    bool stood[2];             /**< the foot was on the ground at the last check */
    float planned_distance_m;  /**< since the CoM is still */
    bool com_contradicted;     /**< a foot has left its place, or the plan has */
    float flight_s;            /**< since both feet are in the air */
} saddle_plausibility_t;

/** Heel strikes, and what the last step was like. */
typedef struct {
    float step_distance_m, step_duration_s; /**< since the last heel strike */
    float last_velocity_m_s;
    float v_comp_m_s;   /**< mean AP speed over the last completed step; after a disturbed one it
                             has changed by 0.1 m/s at most */
    float step_time_s;  /**< of the last completed step; known with v_comp_m_s */
    float half_step_m;  /**< half of what the landed foot was ahead at the last heel strike */
    float step_width_m; /**< of the feet then, left minus right */
    float since_strike_s;
    float airborne_s[2]; /**< since the foot left the ground; 0 on it */
    bool step_open;      /**< a heel strike was seen and the velocity was known ever since */
    bool v_comp_known, half_step_known; /**< step_width_m goes with half_step_m */
    bool struck;                        /**< a heel strike came with the last measurement */
    bool disturbed; /**< set by the supervisor, until a heel strike: v_comp_m_s hardly follows
                         the step now made, so that it does not follow a fall */
    bool stands;    /**< was seen to stand, and no step was completed since */
    uint8_t stance; /**< saddle_side_t: the only foot on the ground, else the last that landed */
} saddle_step_tracker_t;

typedef struct {
    bool armed;           /**< a measurement has come: from then on all are needed */
    bool stopped;         /**< inputs were lost, and have not been good for resume_time_s since */
    float lost_s;         /**< since a measurement was last usable */
    float good_s;         /**< since all that is needed is usable */
    bool stand_commanded; /**< since the stop */
} saddle_safe_state_t;

/* ---- balance -------------------------------------------------------------------------------- */

/** How the walk is learned. */
typedef struct {
    saddle_learned_walk_t walk;
    saddle_vec2_t velocity_m_s; /**< last measured */
    float ripple_square;
    float watched_s, walked_s;          /**< learned from, up to the forgetting time */
    float last_height_m, same_height_s; /**< the last that was new, and since when */
    float climb_m_s, last_climb_m_s; /**< vertical velocity of the CoM, over 80 ms; that before */
    float lowest_margin;             /**< since the last heel strike */
    bool height_known;               /**< the last tick measured the CoM */
    bool begun;                      /**< a margin was known */
} saddle_learning_t;

typedef struct {
    uint8_t level, reason;   /**< announced */
    uint8_t caution_reason;  /**< of the last caution */
    uint8_t unstable_reason; /**< and of the last unstable tick */
    uint8_t ticks_since[4];  /**< since a tick had this level, at most 255 */
} saddle_level_state_t;

/** Where the swing foot is to land, [E45]. */
typedef struct {
    bool known;
    saddle_vec2_t landing_m; /**< from the stance CoP */
} saddle_placement_t;

typedef struct {
    saddle_step_tracker_t steps;
    saddle_learning_t learning;
    saddle_level_state_t level;
    saddle_placement_t placement; /**< of the last tick */
} saddle_supervisor_t;

/** Caller-owned state; treat the fields as private. */
typedef struct {
    uint64_t last_time_us;
    uint32_t initialised;
    saddle_model_t model;
    saddle_planner_t planner;
    saddle_past_t past;
    saddle_plausibility_t plausibility;
    saddle_supervisor_t supervisor;
    saddle_safe_state_t safe_state;
    saddle_command_t command; /**< the last usable one */
    uint32_t command_age_us;
    bool ticked;
} saddle_context_t;

#endif
