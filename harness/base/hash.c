/* Chained XXH3-64. */
#include "base/hash.h"

#include <string.h>
#include <xxhash.h>

uint64_t hash_u64(uint64_t hash, uint64_t value)
{
    uint64_t pair[2] = {hash, value};
    return XXH3_64bits(pair, sizeof pair);
}

uint64_t hash_bytes(uint64_t hash, const void *data, size_t size)
{
    uint64_t content = size ? XXH3_64bits(data, size) : 0;
    return hash_u64(hash_u64(hash, content), size);
}

uint64_t hash_text(uint64_t hash, const char *text)
{
    return hash_bytes(hash, text ? text : "", text ? strlen(text) : 0);
}

uint64_t hash_double(uint64_t hash, double value)
{
    value += 0.0; /* -0 becomes 0 */
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return hash_u64(hash, bits);
}
