/** Shared value types. Frame: x forward, y to the left, z up; ground z = 0; walking line y = 0. */
#ifndef SADDLEWALK_SADDLE_TYPES_H
#define SADDLEWALK_SADDLE_TYPES_H

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

#endif
