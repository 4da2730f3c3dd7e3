/** What is measured of the wearer, and whether it can be believed. */
#ifndef SADDLEWALK_MEASUREMENT_H
#define SADDLEWALK_MEASUREMENT_H

#include <saddlewalk/model.h>
#include <saddlewalk/saddle_types.h>
#include <stdbool.h>
#include <stdint.h>

/** Age of a measurement that never came. */
#define SADDLE_AGE_NEVER_US UINT32_MAX

/** Each foot and the CoM have their own age at the time of the tick. */
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

/** That nothing was ever measured: for a plan without a wearer. */
saddle_measurement_t saddle_no_measurement(void);

/** Why an input was not used or gave no score. */
typedef enum {
    SADDLE_FAULT_COMMAND = 1u << 0, /**< not usable: the last good one holds, see planner.h */
    SADDLE_FAULT_COM_STALE = 1u << 1,   /**< older than com_max_age_s */
    SADDLE_FAULT_COM_RANGE = 1u << 2,   /**< not finite or absurd; the CoM below the knees */
    SADDLE_FAULT_LEFT_STALE = 1u << 3,  /**< older than foot_max_age_s */
    SADDLE_FAULT_LEFT_RANGE = 1u << 4,
    SADDLE_FAULT_RIGHT_STALE = 1u << 5,
    SADDLE_FAULT_RIGHT_RANGE = 1u << 6,
    SADDLE_FAULT_FEET_TOGETHER = 1u << 7,    /**< CoPs within 1 mm: no saddle space */
    SADDLE_FAULT_SPEED_INFEASIBLE = 1u << 8, /**< v_CoMp cannot be walked: no step scores */
    SADDLE_FAULT_COM_FROZEN = 1u << 9,    /**< the same bits for com_max_age_s while the feet moved
                                               otherwise, or a walk was planned */
    SADDLE_FAULT_LEFT_FROZEN = 1u << 10,  /**< the same bits for foot_max_age_s while the CoM moved */
    SADDLE_FAULT_RIGHT_FROZEN = 1u << 11,
    SADDLE_FAULT_AIRBORNE = 1u << 12,     /**< both feet in the air for longer than flight_max_s */
    SADDLE_FAULT_FEET_CROSSED = 1u << 13, /**< by more than crossing_max_m */
    SADDLE_FAULT_COMMAND_STALE = 1u << 14 /**< no usable one for command_max_age_s */
} saddle_fault_t;

/** Faults that leave the CoM, or the feet, without a measurement to use. */
#define SADDLE_FAULTS_COM \
    ((uint32_t)SADDLE_FAULT_COM_STALE | (uint32_t)SADDLE_FAULT_COM_RANGE | \
     (uint32_t)SADDLE_FAULT_COM_FROZEN)
#define SADDLE_FAULTS_LEFT \
    ((uint32_t)SADDLE_FAULT_LEFT_STALE | (uint32_t)SADDLE_FAULT_LEFT_RANGE | \
     (uint32_t)SADDLE_FAULT_LEFT_FROZEN)
#define SADDLE_FAULTS_RIGHT \
    ((uint32_t)SADDLE_FAULT_RIGHT_STALE | (uint32_t)SADDLE_FAULT_RIGHT_RANGE | \
     (uint32_t)SADDLE_FAULT_RIGHT_FROZEN)
#define SADDLE_FAULTS_FEET \
    (SADDLE_FAULTS_LEFT | SADDLE_FAULTS_RIGHT | (uint32_t)SADDLE_FAULT_AIRBORNE | \
     (uint32_t)SADDLE_FAULT_FEET_CROSSED)

/** A number that keeps its bits: since when, and what the rest of the body did meanwhile. */
typedef struct {
    float still_s;
    saddle_vec2_t way_m; /**< of the CoM since then */
} saddle_still_t;

/** What judging remembers, part of the context. */
typedef struct {
    saddle_vec2_t velocity_m_s, cop_m[2]; /**< last believed */
    float height_m;
    saddle_still_t com_still, foot_still[2];
    saddle_vec2_t anchor_m[2]; /**< where a foot on the ground should stay: CoP + way_m of the CoM,
                                    since it landed or the CoM is still */
    bool stood[2];             /**< the foot was on the ground at the last judgement */
    float planned_way_m;       /**< since the CoM is still */
    bool com_contradicted;     /**< a foot has left its place, or the plan has */
    float flight_s;      /**< since both feet are in the air */
} saddle_watch_t;

/** Judge a measurement: age, finite, humanly possible, alive, not contradictory. dt_s: since the
 *  last call; planned_m_s: speed of the walk that was planned then, 0 for none. Absurd: a CoM below the knees (0.285 of the body's height) or above the body's height,
 *  faster than 6 m/s along x or y; a CoP beyond 2.5 m along x or y. Returns saddle_fault_t bits. */
uint32_t saddle_judge(saddle_watch_t *watch, const saddle_model_t *model,
                      const saddle_measurement_t *measurement, float planned_m_s, float dt_s);

#endif
