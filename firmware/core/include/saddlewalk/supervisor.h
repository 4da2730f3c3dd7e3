/** The stability supervisor: judges inputs, then scores the posture. */
#ifndef SADDLEWALK_SUPERVISOR_H
#define SADDLEWALK_SUPERVISOR_H

#include <saddlewalk/gait_model.h>
#include <saddlewalk/saddle_space.h>
#include <saddlewalk/saddle_types.h>
#include <stdbool.h>
#include <stdint.h>

/** Age of a measurement that never came. */
#define SADDLE_AGE_NEVER_US UINT32_MAX

/** Each foot and the CoM have their own age at the time of the tick. What is older than
 *  measurement_max_age_s, not finite or absurd is not used: a CoM outside 0.1 to 2.5 m of height or
 *  6 m/s along x or y, a CoP beyond 2.5 m along x or y. */
typedef struct {
    struct {
        float height_m; /**< above the ground */
        saddle_vec2_t velocity_m_s;
        uint32_t age_us;
    } com;
    struct {
        saddle_vec2_t cop_m; /**< relative to the CoM */
        bool contact;
        uint32_t age_us;
    } foot[2];
} saddle_measurement_t;

/** Why an input was not used or gave no score. */
typedef enum {
    SADDLE_FAULT_COMMAND = 1u << 0, /**< not usable: the last good one holds, see planner.h */
    SADDLE_FAULT_COM_STALE = 1u << 1,
    SADDLE_FAULT_COM_RANGE = 1u << 2, /**< not finite or absurd */
    SADDLE_FAULT_LEFT_STALE = 1u << 3,
    SADDLE_FAULT_LEFT_RANGE = 1u << 4,
    SADDLE_FAULT_RIGHT_STALE = 1u << 5,
    SADDLE_FAULT_RIGHT_RANGE = 1u << 6,
    SADDLE_FAULT_FEET_TOGETHER = 1u << 7,   /**< CoPs within 1 mm: no saddle space */
    SADDLE_FAULT_SPEED_INFEASIBLE = 1u << 8 /**< v_CoMp cannot be walked: no step scores */
} saddle_fault_t;

/** Which fields of saddle_scores_t hold a result; the others are 0. xcom_m is known whenever the
 *  velocity is, and bos says so itself (bos.defined). */
typedef enum {
    SADDLE_VALID_V_COMP = 1u << 0,
    SADDLE_VALID_STEP = 1u << 1, /**< s_pend and s_jump */
    SADDLE_VALID_S_SW = 1u << 2,
    SADDLE_VALID_MOS_COM = 1u << 3,
    SADDLE_VALID_MOS_XCOM = 1u << 4,
    SADDLE_VALID_GRAVITY = 1u << 5,
    SADDLE_VALID_ALL = (1u << 6) - 1u
} saddle_valid_t;

typedef struct {
    uint32_t valid;    /**< saddle_valid_t bits */
    float v_comp_m_s;  /**< mean AP speed over the last completed step, else the planner's */
    float s_pend, s_jump; /**< [E20] */
    float s_sw;        /**< [E21] */
    float mos_com_m, mos_xcom_m; /**< margins in the instantaneous BoS, [E17] */
    saddle_vec2_t gravity_n;     /**< [E18] */
    saddle_vec2_t xcom_m;        /**< [E19] in the frame of the posture */
    saddle_bos_t bos;            /**< instantaneous, in the frame of the posture */
} saddle_scores_t;

typedef enum {
    SADDLE_KNOWN_FEET = 1u << 0,
    SADDLE_KNOWN_VELOCITY = 1u << 1,
    SADDLE_KNOWN_SPEED = 1u << 2,     /**< v_comp_m_s */
    SADDLE_KNOWN_HALF_STEP = 1u << 3,
    SADDLE_KNOWN_ALL = (1u << 4) - 1u
} saddle_known_t;

/** A posture to score, in any frame with x forward and y left. */
typedef struct {
    saddle_vec2_t com_m, com_velocity_m_s, cop_m[2];
    float v_comp_m_s;  /**< walking speed that the scores refer to */
    float half_step_m; /**< half the AP distance of the CoPs at the last heel strike */
    uint32_t known;    /**< saddle_known_t bits; the numbers of the others are not read */
} saddle_posture_t;

/** Supervisor state, part of the context. */
typedef struct {
    float step_distance_m, step_duration_s; /**< since the last heel strike */
    float last_velocity_m_s;
    float v_comp_m_s, half_step_m;          /**< of the last completed step and heel strike */
    bool step_open;     /**< a heel strike was seen and the velocity was known ever since */
    bool v_comp_known, half_step_known;
    bool airborne[2];   /**< seen without contact at the last usable measurement of the foot */
} saddle_supervisor_t;

/** Score a posture. Whatever is not known is not scored. */
saddle_scores_t saddle_score_posture(const saddle_config_t *config, const saddle_body_t *body,
                                     const saddle_posture_t *posture);

/** Judge a measurement: age limit, finite, humanly possible. Returns saddle_fault_t bits. */
uint32_t saddle_supervisor_judge(const saddle_config_t *config,
                                 const saddle_measurement_t *measurement);

/** Follow the steps and score the posture in the frame of the CoM. faults: what
 *  saddle_supervisor_judge() said. planned_speed_m_s stands in for v_comp until a step is complete.
 *  Returns the faults and those of the scores. */
uint32_t saddle_supervisor_update(saddle_supervisor_t *supervisor, const saddle_config_t *config,
                                  const saddle_body_t *body,
                                  const saddle_measurement_t *measurement, uint32_t faults,
                                  float dt_s, float planned_speed_m_s, saddle_scores_t *scores);

#endif
