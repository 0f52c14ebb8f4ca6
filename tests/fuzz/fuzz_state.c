/*
 * Saved states whose bytes somebody changed, with checksums that fit or not, brought back and gone on
 * with. A state is refused and changes nothing, or it is taken over and then every call answers as ever.
 */
#include <stdlib.h>

#include "forge.h"
#include "host.h"
#include "model/state.h"

enum { MOST_INTERNAL_STEPS = 100 };

/* The bodies near to each other, soft, by any method and law. */
static void choose_values(fmi2Component c, struct bytes *b)
{
    host_set_integer(c, ROW_solver_method, 0, 1 + (int)bytes_choice(b, 3));
    host_bound_work(c, MOST_INTERNAL_STEPS);
    host_set_integer(c, ROW_body_motion, 0, 3 - (int)bytes_choice(b, 3));
    host_set_integer(c, ROW_body_motion, 1, 1 + (int)bytes_choice(b, 3));
    host_set_integer(c, ROW_contact_location, 0, 1 + (int)bytes_choice(b, 3));
    host_set_integer(c, ROW_contact_method, 0, 2 - (int)bytes_choice(b, 2));
    host_set_integer(c, ROW_contact_penalty_control, 0, bytes_choice(b, 4) == 3 ? 3 : 2);
    host_set_integer(c, ROW_contact_dashpot, 0, 1 + (int)bytes_choice(b, 3));
    host_set_integer(c, ROW_body_finite_length, 1, (int)bytes_choice(b, 2));
    host_set_real(c, ROW_contact_penalty_factor, 0, 0, bytes_power(b, 2.0, 8.0));
    host_set_real(c, ROW_body_center, 0, 0, bytes_choice(b, 2) ? 0.61 : 0.37);
    host_set_real(c, ROW_body_center, 0, 2, 0.0);
    host_set_real(c, ROW_gravity, 0, 0, bytes_between(b, -20.0, 20.0));
}

/* Brings the instance to where it is saved: any phase, any number of steps. */
static void begin(fmi2Component c, struct bytes *b)
{
    choose_values(c, b);
    const unsigned far = bytes_one(b);
    if (far % 8 == 1 || fmi2SetupExperiment(c, fmi2False, 0.0, 0.0, fmi2False, 0.0) > fmi2Warning ||
        fmi2EnterInitializationMode(c) > fmi2Warning) {
        return;
    }
    if (far % 8 == 2 || fmi2ExitInitializationMode(c) > fmi2Warning) {
        return;
    }
    double time = 0.0;
    for (unsigned i = 0; i < far / 8; ++i) {
        const fmi2Status status = fmi2DoStep(c, time, 0.02, fmi2True);
        if (fmi2GetRealStatus(c, fmi2LastSuccessfulTime, &time) > fmi2Warning || status > fmi2Discard) {
            return;
        }
    }
    if (far % 8 == 3) {
        (void)fmi2Terminate(c);
    }
}

static size_t save(fmi2Component c, uint8_t *block)
{
    fmi2FMUstate state = NULL;
    size_t size = 0;
    fmi2Status status = fmi2GetFMUstate(c, &state);
    CLAIM(status == fmi2OK);
    status = fmi2SerializedFMUstateSize(c, state, &size);
    CLAIM(status == fmi2OK && size == HEADER_SIZE + sizeof(struct model_state) && size <= LARGEST_BLOCK);
    status = fmi2SerializeFMUstate(c, state, (fmi2Byte *)block, size);
    CLAIM(status == fmi2OK);
    status = fmi2FreeFMUstate(c, &state);
    CLAIM(status == fmi2OK && state == NULL);
    return size;
}

/* Whether its state says that only the end is left, and then that nothing else is answered. */
static bool is_fatal(fmi2Component c)
{
    fmi2FMUstate state = NULL;
    if (fmi2GetFMUstate(c, &state) == fmi2OK) {
        const fmi2Status status = fmi2FreeFMUstate(c, &state);
        CLAIM(status == fmi2OK);
        return false;
    }
    fmi2Status status = fmi2Reset(c);
    CLAIM(state == NULL && status == fmi2Error);
    status = fmi2DoStep(c, 0.0, 1.0, fmi2True);
    CLAIM(status == fmi2Error);
    return true;
}

/* What an importer may do with a state that was taken over. */
static void go_on(fmi2Component c)
{
    if (is_fatal(c)) {
        return;
    }
    host.shown = c;
    host_read_all(c);
    double time = 0.0;
    const double zero = 0.0;
    for (int i = 0; i < 4; ++i) {
        if (fmi2GetRealStatus(c, fmi2LastSuccessfulTime, &time) > fmi2Warning) {
            break;
        }
        const struct variable *force = host_variable(ROW_body_external_force, 0, i % 3);
        const fmi2Integer order = 1 + i % 2;
        (void)fmi2SetReal(c, &force->reference, 1, &zero);
        (void)fmi2SetRealInputDerivatives(c, &force->reference, 1, &order, &zero);
        const fmi2Status status = fmi2DoStep(c, time, 0.01 * (1 << (3 * i)), fmi2True);
        CLAIM(status <= fmi2Error);
        host_read_all(c);
    }
    uint8_t block[LARGEST_BLOCK];
    (void)save(c, block);
    (void)fmi2Terminate(c);
    host_read_all(c);
    const fmi2Status status = fmi2Reset(c);
    CLAIM(status == fmi2OK);
}

static void bring_back(fmi2Component c, const uint8_t *block, size_t size)
{
    uint8_t before[LARGEST_BLOCK], after[LARGEST_BLOCK];
    fmi2FMUstate state = NULL;
    const size_t whole = save(c, before);
    fmi2Byte *exact = malloc(size > 0 ? size : 1);
    CLAIM(exact != NULL);
    memcpy(exact, block, size);
    fmi2Status status = fmi2DeSerializeFMUstate(c, exact, size, &state);
    free(exact);
    CLAIM((status == fmi2OK) == (state != NULL));
    if (status == fmi2OK) {
        status = fmi2SetFMUstate(c, state);
    }
    CLAIM(status == fmi2OK || status == fmi2Error);
    if (status == fmi2OK) {
        go_on(c);
    } else {
        CLAIM(host.messages > 0);
        CLAIM(save(c, after) == whole && memcmp(before, after, whole) == 0);
    }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    struct bytes b = {data, size};
    uint8_t block[LARGEST_BLOCK];
    host_begin();
    fmi2Component giver = host_instance();
    begin(giver, &b);
    size_t block_size = save(giver, block);
    const unsigned how = bytes_one(&b);
    forge_changes(block, block_size, &b);
    if (how % 8 != 1) {
        forge_bound_work(block, MOST_INTERNAL_STEPS);
        forge_checksum(block, block_size);
    }
    if (how % 8 == 2) {
        block_size = block_size * (how / 8) / 32;
    }
    fmi2Component taker = how % 8 == 3 ? giver : host_instance();
    bring_back(taker, block, block_size);
    if (taker != giver) {
        fmi2FreeInstance(taker);
    }
    fmi2FreeInstance(giver);
    host_end();
    return 0;
}
