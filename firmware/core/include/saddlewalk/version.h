/** The library's version, written here and nowhere else: CMake and the Python package read it. */
#ifndef SADDLEWALK_VERSION_H
#define SADDLEWALK_VERSION_H

#define SADDLE_VERSION "0.2.0"

#endif
