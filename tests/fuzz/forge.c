#include "forge.h"

#include "math/checksum.h"
#include "model/state.h"

enum { CHANGES_AT_MOST = 64 };

void forge_checksum(uint8_t *block, size_t size)
{
    const uint32_t checksum = checksum_of(CHECKSUM_START, block + CHECKED_FROM, size - CHECKED_FROM);
    memcpy(block + HEADER_CHECKSUM, &checksum, sizeof checksum);
}

void forge_bound_work(uint8_t *block, int most_internal_steps)
{
    for (int i = 0; i < scene_variable_count; ++i) {
        if (scene_variables[i].row == ROW_solver_max_internal_steps) {
            uint8_t *at =
                block + HEADER_SIZE + offsetof(struct model_state, values) + scene_variables[i].offset;
            int32_t steps;
            memcpy(&steps, at, sizeof steps);
            steps = steps > most_internal_steps ? most_internal_steps : steps;
            memcpy(at, &steps, sizeof steps);
        }
    }
}

void forge_changes(uint8_t *block, size_t size, struct bytes *b)
{
    for (int i = 0; i < CHANGES_AT_MOST && b->left > 0; ++i) {
        uint16_t at = 0;
        const unsigned kind = bytes_choice(b, 4);
        bytes_copy(b, &at, sizeof at);
        size_t place = at % size;
        if (kind == 0) {
            block[place] ^= bytes_one(b);
        } else if (kind == 1) {
            place -= place % 4;
            const int32_t value = (int8_t)bytes_one(b);
            memcpy(block + place, &value, sizeof value);
        } else {
            place -= place % 8;
            const double value = bytes_real(b);
            memcpy(block + place, &value, place + 8 <= size ? 8 : size - place);
        }
    }
}
