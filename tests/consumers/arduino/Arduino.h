// What the example sketch uses of Arduino's own, for this machine: C's library alone.
#pragma once

#include <stdint.h>
#include <stdio.h>

inline uint32_t micros()
{
    static uint32_t now_us;
    return now_us += 10000;
}

struct Port {
    void begin(long) {}
    void print(float value, int digits)
    {
        printf("%.*f", digits, static_cast<double>(value));
    }
    void print(const char *text)
    {
        printf("%s", text);
    }
    void println(const char *text)
    {
        printf("%s\n", text);
    }
    void println(int value)
    {
        printf("%d\n", value);
    }
};

static Port Serial;

void setup();
void loop();

int main()
{
    setup();
    for (int i = 0; i < 80; i++) {
        loop();
    }
    return 0;
}
