#include "link.h"

#include "announce.h"

void saddle_link_set(saddle_link_t *link, saddle_link_state_t state, const char *what,
                     const char *why)
{
    if (link->state == state) {
        return;
    }
    link->losses += link->state == SADDLE_LINK_UP;
    link->state = state;
    if (state == SADDLE_LINK_UP) {
        saddle_announce("%s is back", what);
    } else {
        saddle_announce("%s is lost: %s%s", what, why,
                        state == SADDLE_LINK_DOWN ? "; ticks go on, and each one tries to reopen it"
                                                  : "");
    }
}
