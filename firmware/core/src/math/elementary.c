#include "math/elementary.h"

#include <math.h>
#include <stdint.h>

/* Derived by tools/derive_elementary.py, 2026-11: Remez minimax fits in ascending powers, each
 * with the largest error of the rounded fit. A _HI constant has few enough bits for its products
 * with the integers of its use to be exact. */
static const float TWO_OVER_PI = 6.36619747e-01f;
static const float HALF_PI_HI = 1.57079601e+00f;
static const float HALF_PI_LO = 3.13916473e-07f;
static const float LOG2_E = 1.44269502e+00f;
static const float LN2_HI = 6.93145752e-01f;
static const float LN2_LO = 1.42860677e-06f;

/* sin r = r + r z S(z), z = r^2, |r| <= pi/4; relative: 8.3e-09 */
static const float SIN[] = {
    -1.66666552e-01f,
    8.33216030e-03f,
    -1.95152825e-04f,
};

/* cos r = 1 - z/2 + z^2 C(z), z = r^2, |r| <= pi/4; absolute: 5.1e-10 */
static const float COS[] = {
    4.16666456e-02f,
    -1.38873677e-03f,
    2.44384519e-05f,
};

/* asin s = s + s z A(z), z = s^2, 0 <= s <= 1/2; relative: 5.8e-09 */
static const float ASIN[] = {
    1.66667521e-01f, 7.49529749e-02f, 4.54703793e-02f, 2.41795015e-02f, 4.21663262e-02f,
};

/* exp r - 1 = r + r^2 E(r), |r| <= ln(2)/2; relative: 1.7e-08 */
static const float EXPM1[] = {
    4.99999970e-01f, 1.66665435e-01f, 4.16672006e-02f, 8.36651400e-03f, 1.38825248e-03f,
};

/* erf a = 1 - exp(a Q(a)), 0 <= a <= 4; relative: 5.2e-08 */
static const float ERF[] = {
    -1.12837923e+00f, -6.36616468e-01f, -1.02814414e-01f, 1.93217173e-02f,
    -2.05717748e-04f, -1.25174515e-03f, 3.81000049e-04f,  -4.07078333e-05f,
};

/* ln m = 2 s + 2 s z L(z), s = (m - 1)/(m + 1), z = s^2, sqrt(1/2) <= m < sqrt(2): the series of the
 * inverse hyperbolic tangent, whose next term is at most 8e-10 of it */
static const float LOG[] = {
    3.33333333e-01f, 2.00000000e-01f, 1.42857143e-01f, 1.11111111e-01f, 9.09090909e-02f,
};

static const float SMALLEST_NORMAL = 1.17549435e-38f;
static const float GREATEST = 3.40282347e+38f;
static const uint32_t ONE_BITS = 0x3F800000u;
static const uint32_t SQRT_HALF_BITS = 0x3F3504F3u;
static const float EXP_LOWEST = -87.0f;
static const float EXP_HIGHEST = 88.0f;
static const float DECAY_GONE = 40.0f;
static const float ERF_SATURATION = 4.0f;

static float sin_of_eighth(float r)
{
    const float z = r * r;
    return r + r * z * ((SIN[2] * z + SIN[1]) * z + SIN[0]);
}

static float cos_of_eighth(float r)
{
    const float z = r * r;
    return 1.0f - z * (0.5f - z * ((COS[2] * z + COS[1]) * z + COS[0]));
}

/** An angle as its nearest quarter turn and what is left of it. */
typedef struct {
    uint32_t quarters;
    float rest_rad;
} turn_t;

static turn_t turn_of(float x_rad)
{
    if (!(saddle_magnitude(x_rad) <= SADDLE_TWO_PI)) {
        x_rad = 0.0f;
    }
    const int32_t quarters = (int32_t)(x_rad * TWO_OVER_PI + (x_rad < 0.0f ? -0.5f : 0.5f));
    const float q = (float)quarters;
    return (turn_t){(uint32_t)quarters, (x_rad - q * HALF_PI_HI) - q * HALF_PI_LO};
}

/** y in the first two quarter turns, -y in the others. */
static float signed_by(uint32_t quarters, float y)
{
    return (quarters & 2u) != 0u ? -y : y;
}

static float sin_of(uint32_t quarters, float r)
{
    return signed_by(quarters, (quarters & 1u) != 0u ? cos_of_eighth(r) : sin_of_eighth(r));
}

float saddle_sin(float x_rad)
{
    const turn_t turn = turn_of(x_rad);
    return sin_of(turn.quarters, turn.rest_rad);
}

float saddle_cos(float x_rad)
{
    const turn_t turn = turn_of(x_rad);
    return sin_of(turn.quarters + 1u, turn.rest_rad);
}

saddle_sin_cos_t saddle_sin_cos(float x_rad)
{
    const turn_t turn = turn_of(x_rad);
    const float sine = sin_of_eighth(turn.rest_rad);
    const float cosine = cos_of_eighth(turn.rest_rad);
    const bool odd = (turn.quarters & 1u) != 0u;
    return (saddle_sin_cos_t){signed_by(turn.quarters, odd ? cosine : sine),
                              signed_by(turn.quarters + 1u, odd ? sine : cosine)};
}

float saddle_asin(float x)
{
    const float a = saddle_clamp(saddle_magnitude(x), 0.0f, 1.0f);
    const bool outer = a > 0.5f; /* asin a = pi/2 - 2 asin sqrt((1 - a)/2) */
    const float z = outer ? 0.5f * (1.0f - a) : a * a;
    const float s = outer ? sqrtf(z) : a;
    const float poly = (((ASIN[4] * z + ASIN[3]) * z + ASIN[2]) * z + ASIN[1]) * z + ASIN[0];
    const float inner_rad = s + s * z * poly;
    const float y_rad = outer ? HALF_PI_HI - (2.0f * inner_rad - HALF_PI_LO) : inner_rad;
    return x < 0.0f ? -y_rad : y_rad;
}

/** exp x = scale (1 + fraction), scale a power of two; kept apart, nothing is rounded off. */
typedef struct {
    float scale;
    float fraction;
} exp_parts_t;

static inline exp_parts_t exp_parts(float x)
{
    const int32_t biased_exponent = (int32_t)(x * LOG2_E + 127.5f);
    const float k = (float)(biased_exponent - 127);
    const float r = (x - k * LN2_HI) - k * LN2_LO;
    const float poly = (((EXPM1[4] * r + EXPM1[3]) * r + EXPM1[2]) * r + EXPM1[1]) * r + EXPM1[0];
    const union {
        uint32_t bits;
        float value;
    } scale = {(uint32_t)biased_exponent << 23};
    return (exp_parts_t){scale.value, r + r * r * poly};
}

float saddle_exp(float x)
{
    if (!(x >= EXP_LOWEST)) {
        return 0.0f;
    }
    const exp_parts_t e = exp_parts(x > EXP_HIGHEST ? EXP_HIGHEST : x);
    return e.scale * (1.0f + e.fraction);
}

float saddle_decay(float x)
{
    const exp_parts_t e = exp_parts(-saddle_clamp(x, 0.0f, DECAY_GONE));
    return e.scale * (1.0f + e.fraction);
}

float saddle_log(float x)
{
    if (!saddle_in_range(x, SMALLEST_NORMAL, GREATEST)) {
        return 0.0f;
    }
    union {
        float value;
        uint32_t bits;
    } mantissa = {x};
    const uint32_t biased_exponent = (mantissa.bits + (ONE_BITS - SQRT_HALF_BITS)) >> 23;
    mantissa.bits -= (biased_exponent << 23) - ONE_BITS;
    const float k = (float)((int32_t)biased_exponent - 127);
    const float f = mantissa.value - 1.0f;
    const float s = f / (2.0f + f);
    const float z = s * s;
    const float poly = (((LOG[4] * z + LOG[3]) * z + LOG[2]) * z + LOG[1]) * z + LOG[0];
    return k * LN2_HI + (2.0f * s + (2.0f * s * z * poly + k * LN2_LO));
}

float saddle_erf(float x)
{
    const float a = saddle_clamp(saddle_magnitude(x), 0.0f, ERF_SATURATION);
    const float high = ((ERF[7] * a + ERF[6]) * a + ERF[5]) * a + ERF[4];
    const float poly = (((high * a + ERF[3]) * a + ERF[2]) * a + ERF[1]) * a + ERF[0];
    const exp_parts_t e = exp_parts(a * poly);
    const float y = (1.0f - e.scale) - e.scale * e.fraction;
    return x < 0.0f ? -y : y;
}

static float min_jerk(float limited)
{
    const bool second_half = limited > 0.5f; /* f(s) = 1 - f(1 - s) keeps the landing exact */
    const float u = second_half ? 1.0f - limited : limited;
    const float y = u * u * u * (10.0f + u * (6.0f * u - 15.0f));
    return second_half ? 1.0f - y : y;
}

float saddle_min_jerk(float s)
{
    return min_jerk(saddle_clamp(s, 0.0f, 1.0f));
}

saddle_jerk_t saddle_min_jerk_both(float s)
{
    const float limited = saddle_clamp(s, 0.0f, 1.0f);
    const float product = limited * (1.0f - limited);
    return (saddle_jerk_t){min_jerk(limited), 30.0f * product * product};
}
