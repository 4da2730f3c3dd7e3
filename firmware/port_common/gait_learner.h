/** A plan that follows its wearer: a person's shape, learned stride by stride from what is measured
 *  beside what is planned, and given to saddle_adapt().
 *
 *  Offset, size and delay of the CoM's way across ([E7]), mean and delay of its height ([E24], ankle model
 *  cycloid), the heel strike ([E38], strike_share > 0) and the delay of the swing ([E44], swing_skew > 0).
 *  A stride teaches only while a walk of even speed is planned and nothing is amiss: no fault, no limit, no
 *  `unstable`. What it shows is compared at the time at which it was measured. */
#ifndef SADDLEWALK_GAIT_LEARNER_H
#define SADDLEWALK_GAIT_LEARNER_H

#include <saddlewalk/saddlewalk.h>

/** How fast, and how far each field may go from where it began. Floats alone, in the order of
 *  saddle_learning_field(). */
typedef struct {
    float share; /**< of a stride's departure from the plan that the plan then follows; 0: off */
    float lateral_factor;
    float lateral_offset_m;
    float lateral_delay_rad;
    float vertical_offset_m;
    float vertical_delay_rad;
    float strike_share;
    float swing_delay; /**< of swing_begin and swing_end alike, in swings */
} saddle_learning_config_t;

/** Off, with bounds about twice the spread between people. */
saddle_learning_config_t saddle_learning_default(void);

/** The field at an index with its range, NULL past the last. */
const saddle_config_field_t *saddle_learning_field(size_t index);

/** Name of the first field that is not finite or out of range; NULL if there is none. */
const char *saddle_learning_check(const saddle_learning_config_t *learning);

/** What a departure does to one field: sums over a stride of departure times direction, and of the
 *  direction's square. */
typedef struct {
    float along, square;
} saddle_projection_t;

/** Each field belongs to the functions below, but for `config`. */
typedef struct {
    saddle_config_t config; /**< as learned so far: store it, and begin with it the next time */
    saddle_learning_config_t learning;
    saddle_config_t start;
    bool changed;       /**< since the plan took it over */
    bool ticked, whole; /**< a stride is seen from its beginning, and nothing was amiss */
    uint64_t last_us;
    uint32_t stride_count;
    float width_m; /**< of the step that the stance foot made; 0: not seen */
    uint8_t stance;
    bool airborne[2];
    float until_strike_s[2]; /**< planned, of a foot in the air */
    float samples;
    float across_m, height_m; /**< sums of the departures */
    saddle_projection_t size, delay, climb, swing, strike;
} saddle_gait_learner_t;

/** config and learning have passed their checks. */
void saddle_gait_learner_init(saddle_gait_learner_t *learner, const saddle_config_t *config,
                              const saddle_learning_config_t *learning);

/** After each saddle_tick(): learn from its input and output, and let the context take over what was
 *  learned as soon as it can. True: it did, and plans by `config` from the next tick on. Does nothing while
 *  learning.share is 0. */
bool saddle_gait_learner_tick(saddle_gait_learner_t *learner, saddle_context_t *context,
                              const saddle_input_t *input, const saddle_output_t *output);

#endif
