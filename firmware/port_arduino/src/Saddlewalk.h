/** The header by which Arduino finds the library. */
#ifndef SADDLEWALK_ARDUINO_H
#define SADDLEWALK_ARDUINO_H

#include <saddlewalk/saddlewalk.h>

#endif
