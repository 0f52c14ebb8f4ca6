/*
 * An integrator outside of an instance of Model Exchange. Who includes this defines handle_event.
 */
#ifndef FUZZ_OUTSIDE_H
#define FUZZ_OUTSIDE_H

#include <stdlib.h>

#include "players.h"
#include "scene.h"

static fmi_status handle_event(fmi_instance c);

/* Each contact can change its regime a few times at one instant. */
enum { ITERATIONS_AT_MOST = 10 * SCENE_CONTACTS, VALUES = SCENE_STATES + SCENE_INDICATORS + 3 };

/* One of the functions that take a vector, of any length or missing. */
static fmi_status any_vector(struct player *player, struct bytes *b)
{
    fmi_instance c = player->instance;
    const unsigned function = bytes_choice(b, 5);
    const size_t right = function == 2 ? SCENE_INDICATORS : SCENE_STATES;
    const unsigned odd = bytes_one(b);
    const size_t count = odd < 200 ? right : odd % VALUES;
    double *values = odd == 255 ? NULL : calloc(count > 0 ? count : 1, sizeof *values);
    for (size_t i = 0; function == 4 && values != NULL && i < count; ++i) {
        values[i] = bytes_real(b);
    }
    fmi_status (*const get[])(fmi_instance, double[], size_t) = {
        FMI(GetContinuousStates), FMI_RATES, FMI(GetEventIndicators), FMI(GetNominalsOfContinuousStates)};
    const fmi_status status =
        function < 4 ? get[function](c, values, count) : FMI(SetContinuousStates)(c, values, count);
    for (size_t i = 0; status <= FMI(Warning) && i < count; ++i) {
        CLAIM(isfinite(values[i]));
    }
    CLAIM(status > FMI(Warning) || count == right);
    free(values);
    return status;
}

/* A few steps by Euler's method; where an indicator changes its sign, an event. */
static fmi_status march(struct player *player, struct bytes *b)
{
    fmi_instance c = player->instance;
    if (c == NULL) {
        return FMI(OK);
    }
    double time = bytes_power(b, -3.0, 1.0); /* on from there, or refused as over */
    const double size = bytes_power(b, -6.0, 0.0);
    double states[SCENE_STATES + 1], rates[SCENE_STATES + 1];
    double before[SCENE_INDICATORS + 1], after[SCENE_INDICATORS + 1];
    FMI(Boolean) enter = false, terminate = false;
    for (unsigned k = bytes_choice(b, 8); k > 0; --k) {
        fmi_status status = FMI(SetTime)(c, time += size);
        if (status > FMI(Warning) ||
            (status = FMI(GetContinuousStates)(c, states, SCENE_STATES)) > FMI(Warning) ||
            (status = FMI_RATES(c, rates, SCENE_STATES)) > FMI(Warning) ||
            (status = FMI(GetEventIndicators)(c, before, SCENE_INDICATORS)) > FMI(Warning)) {
            return status;
        }
        for (int i = 0; i < SCENE_STATES; ++i) {
            states[i] += size * rates[i];
        }
        if ((status = FMI(SetContinuousStates)(c, states, SCENE_STATES)) > FMI(Warning) ||
            (status = FMI(GetEventIndicators)(c, after, SCENE_INDICATORS)) > FMI(Warning) ||
            (status = FMI(CompletedIntegratorStep)(c, true, &enter, &terminate)) > FMI(Warning)) {
            return status;
        }
        CLAIM(!enter && !terminate);
        bool event = false;
        for (int i = 0; i < SCENE_INDICATORS; ++i) {
            event = event || (before[i] > 0.0) != (after[i] > 0.0);
        }
        if (event &&
            ((status = FMI(EnterEventMode)(c)) > FMI(Warning) || (status = handle_event(c)) > FMI(Warning))) {
            return status;
        }
    }
    return FMI(OK);
}

#endif
