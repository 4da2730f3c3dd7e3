#include "balance/energy.h"

#include "math/vec2.h"

static float kinetic_j(const saddle_model_t *model, saddle_vec2_t velocity_m_s)
{
    return 0.5f * model->config.body_mass_kg * saddle_vec2_dot(velocity_m_s, velocity_m_s);
}

/* What the potential energy falls by from the CoM to a place. */
static bool drop_j(const saddle_model_t *model, const saddle_support_t *support, saddle_vec2_t to_m,
                   float *drop)
{
    const saddle_surface_t to = saddle_surface(support->cop_m, to_m, model->body.pendulum_m);
    const bool reached = support->at_com.reached && to.reached;
    *drop = reached ? model->config.body_mass_kg * SADDLE_GRAVITY_M_S2 *
                          (support->at_com.height_m - to.height_m)
                    : 0.0f;
    return reached;
}

/* [E26] */
bool saddle_excess_stop_j(const saddle_model_t *model, const saddle_support_t *support,
                          const saddle_com_state_t *state, float *excess_j)
{
    const saddle_vec2_t exit_m = saddle_bos_exit_m(support->bos, state->com_m, state->velocity_m_s);
    float drop;
    const bool reached = drop_j(model, support, exit_m, &drop);
    *excess_j = reached ? kinetic_j(model, state->velocity_m_s) + drop : 0.0f;
    return reached;
}

/* [E26] */
bool saddle_excess_track_j(const saddle_model_t *model, const saddle_support_t *support,
                           const saddle_com_state_t *state, const saddle_com_state_t *planned,
                           float *excess_j)
{
    const saddle_vec2_t exit_m =
        saddle_bos_exit_m(support->bos, planned->com_m, planned->velocity_m_s);
    float drop;
    const bool reached = drop_j(model, support, exit_m, &drop);
    *excess_j = reached ? kinetic_j(model, state->velocity_m_s) -
                              kinetic_j(model, planned->velocity_m_s) + drop
                        : 0.0f;
    return reached;
}
