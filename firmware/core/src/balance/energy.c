#include "balance/energy.h"

#include "balance/saddle_space.h"
#include "math/vec2.h"

static float kinetic_j(const saddle_model_t *model, saddle_vec2_t velocity_m_s)
{
    return 0.5f * model->config.body_mass_kg * saddle_vec2_dot(velocity_m_s, velocity_m_s);
}

/* What the potential energy falls by from one place to another. */
static bool drop_j(const saddle_model_t *model, const saddle_vec2_t cop_m[2], saddle_vec2_t from_m,
                   saddle_vec2_t to_m, float *drop)
{
    float from_height_m;
    float to_height_m;
    const bool reached =
        saddle_surface_height_m(cop_m, from_m, model->body.pendulum_m, &from_height_m) &&
        saddle_surface_height_m(cop_m, to_m, model->body.pendulum_m, &to_height_m);
    *drop = reached
                ? model->config.body_mass_kg * SADDLE_GRAVITY_M_S2 * (from_height_m - to_height_m)
                : 0.0f;
    return reached;
}

bool saddle_excess_stop_j(const saddle_model_t *model, const saddle_vec2_t cop_m[2],
                          const saddle_bos_t *bos, const saddle_com_state_t *state, float *excess_j)
{
    const saddle_vec2_t exit_m = saddle_bos_exit_m(bos, state->com_m, state->velocity_m_s);
    float drop;
    const bool reached = drop_j(model, cop_m, state->com_m, exit_m, &drop);
    *excess_j = reached ? kinetic_j(model, state->velocity_m_s) + drop : 0.0f;
    return reached;
}

bool saddle_excess_track_j(const saddle_model_t *model, const saddle_vec2_t cop_m[2],
                           const saddle_bos_t *bos, const saddle_com_state_t *state,
                           const saddle_com_state_t *planned, float *excess_j)
{
    const saddle_vec2_t exit_m = saddle_bos_exit_m(bos, planned->com_m, planned->velocity_m_s);
    float drop;
    const bool reached = drop_j(model, cop_m, state->com_m, exit_m, &drop);
    *excess_j = reached ? kinetic_j(model, state->velocity_m_s) -
                              kinetic_j(model, planned->velocity_m_s) + drop
                        : 0.0f;
    return reached;
}
