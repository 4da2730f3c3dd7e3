#include "balance/learned_walk.h"

#include "math/bytes.h"
#include "math/elementary.h"

#include <math.h>

/* The time that one measurement stands for, at first. */
#define FIRST_S 0.08f

/* A height that keeps its bits for longer has stopped to change. */
#define SAME_HEIGHT_MAX_S 0.24f

/* For how long learn_ripple_start counts against what is seen. */
#define RIPPLE_START_S 0.8f

/* Nobody walks more slowly: standing teaches no ripple. */
#define WALKING_SPEED_M_S 0.1f

/* One departure counts at most so many times the usual one, as squares: a push that has just begun
 * teaches little. */
#define RIPPLE_GROWTH_MAX 4.0f

/* Steadier than any sensor tells. */
#define RIPPLE_MIN 0.005f

/* Share of a new step in the usual one. */
#define STEP_SHARE 0.2f

void saddle_learning_init(saddle_learning_t *learning, const saddle_model_t *model)
{
    const float start = model->config.learn_ripple_start;
    saddle_clear(learning, sizeof *learning);
    learning->walk.ripple = start;
    learning->ripple_square = start * start;
    learning->watched_s = FIRST_S;
    learning->walked_s = RIPPLE_START_S;
    learning->lowest_margin = 1.0f;
}

void saddle_learning_gap(saddle_learning_t *learning)
{
    learning->height_known = false;
    learning->climb_m_s = 0.0f;
    learning->last_climb_m_s = 0.0f;
}

/* Over the time since the last height that was another: a sensor may be slower than the ticks. */
static void climb(saddle_learning_t *learning, float height_m)
{
    const float since_s = learning->same_height_s;
    const float risen_m = height_m - learning->last_height_m;
    if (since_s > 0.0f && (risen_m < 0.0f || risen_m > 0.0f)) {
        const float share = saddle_smaller(since_s / FIRST_S, 1.0f);
        learning->last_climb_m_s = learning->climb_m_s;
        learning->climb_m_s += share * (risen_m / since_s - learning->climb_m_s);
        learning->last_height_m = height_m;
        learning->same_height_s = 0.0f;
    } else if (since_s > SAME_HEIGHT_MAX_S) {
        learning->climb_m_s = 0.0f;
        learning->last_climb_m_s = 0.0f;
    }
}

void saddle_learning_watch(saddle_learning_t *learning, const saddle_measurement_t *measurement,
                           float dt_s)
{
    learning->velocity_m_s = measurement->com.velocity_m_s;
    if (learning->height_known) {
        learning->same_height_s += dt_s;
        climb(learning, measurement->com.height_m);
    } else {
        learning->last_height_m = measurement->com.height_m;
        learning->same_height_s = 0.0f;
        learning->height_known = true;
    }
}

void saddle_learning_begin(saddle_learning_t *learning)
{
    if (!learning->begun) {
        learning->begun = true;
        learning->walk.velocity_m_s = learning->velocity_m_s;
        learning->walk.height_m = learning->last_height_m;
    }
}

/* The plain mean at first, then one that forgets. */
static float share_of_new(float *learned_s, float dt_s, float forgetting_s)
{
    *learned_s = saddle_smaller(*learned_s + dt_s, forgetting_s);
    return saddle_smaller(dt_s / *learned_s, 1.0f);
}

/* [E32] */
static void learn_mean(saddle_learning_t *learning, const saddle_model_t *model, float dt_s)
{
    saddle_learned_walk_t *walk = &learning->walk;
    const saddle_vec2_t velocity_m_s = learning->velocity_m_s;
    const float share = share_of_new(&learning->watched_s, dt_s, model->config.learn_time_s);
    walk->velocity_m_s.x += share * (velocity_m_s.x - walk->velocity_m_s.x);
    walk->velocity_m_s.y += share * (velocity_m_s.y - walk->velocity_m_s.y);
    walk->height_m += share * (learning->last_height_m - walk->height_m);
}

/* departure_m_s: of the AP velocity from its mean. */
static void learn_ripple(saddle_learning_t *learning, const saddle_model_t *model,
                         float departure_m_s, float dt_s)
{
    const float climb_m_s = learning->climb_m_s;
    const float square = (departure_m_s * departure_m_s + climb_m_s * climb_m_s) /
                         (SADDLE_GRAVITY_M_S2 * learning->walk.height_m);
    const float most = RIPPLE_GROWTH_MAX * learning->ripple_square;
    const float share = share_of_new(&learning->walked_s, dt_s, model->config.learn_ripple_time_s);
    learning->ripple_square +=
        share * (saddle_clamp(square, RIPPLE_MIN * RIPPLE_MIN, most) - learning->ripple_square);
    learning->walk.ripple = sqrtf(learning->ripple_square);
}

static void learn_value(float *usual, float value)
{
    *usual = *usual > 0.0f ? *usual + STEP_SHARE * (value - *usual) : value;
}

static void learn_step(saddle_learning_t *learning, const saddle_step_tracker_t *steps)
{
    saddle_learned_walk_t *walk = &learning->walk;
    learn_value(&walk->step_time_s, steps->step_time_s);
    learn_value(&walk->step_length_m, 2.0f * saddle_magnitude(steps->half_step_m));
    learn_value(&walk->step_width_m, saddle_magnitude(steps->step_width_m));
    learn_value(&walk->step_margin, learning->lowest_margin);
}

void saddle_learning_update(saddle_learning_t *learning, const saddle_model_t *model,
                            float own_margin, float dt_s)
{
    const float departure_m_s = learning->velocity_m_s.x - learning->walk.velocity_m_s.x;
    learn_mean(learning, model, dt_s);
    if (own_margin > model->config.learn_margin &&
        saddle_magnitude(learning->walk.velocity_m_s.x) > WALKING_SPEED_M_S) {
        learn_ripple(learning, model, departure_m_s, dt_s);
    }
}

void saddle_learning_step(saddle_learning_t *learning, const saddle_step_tracker_t *steps,
                          float own_margin)
{
    if (own_margin < learning->lowest_margin) {
        learning->lowest_margin = own_margin;
    }
    if (steps->struck) {
        if (learning->lowest_margin > 0.0f && steps->v_comp_known && steps->half_step_known) {
            learn_step(learning, steps);
        }
        learning->lowest_margin = own_margin;
    }
}
