#include "space/arctangent.h"

#include "math/elementary.h"

#include <math.h>

#define LENGTH_MAX 1.0e18f /* its square is a float */

float saddle_arctangent(float y, float x)
{
    const float length = sqrtf(x * x + y * y);
    if (!(length > 0.0f && length < LENGTH_MAX)) {
        return 0.0f;
    }
    /* By the shorter side: there the arcsine is steep by no more than sqrt 2. */
    if (saddle_magnitude(y) <= saddle_magnitude(x)) {
        const float angle_rad = saddle_asin(y / length);
        if (x >= 0.0f) {
            return angle_rad;
        }
        return y < 0.0f ? -SADDLE_PI - angle_rad : SADDLE_PI - angle_rad;
    }
    const float angle_rad = saddle_asin(x / length);
    return y < 0.0f ? angle_rad - SADDLE_HALF_PI : SADDLE_HALF_PI - angle_rad;
}
