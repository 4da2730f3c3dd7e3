/** The angle of a direction in a plane, from the core's arcsine. */
#ifndef SADDLEWALK_ARCTANGENT_H
#define SADDLEWALK_ARCTANGENT_H

/**
 * Angle of (x, y) from the x axis in radians, within [-SADDLE_PI, SADDLE_PI]; 0 for the origin, for
 * NaN and where the length of (x, y) is not a float. Error at most 4e-7 rad.
 */
float saddle_arctangent(float y, float x);

#endif
