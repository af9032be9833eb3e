/* Content hashes (xxHash XXH3-64), as names of cached things. */
#ifndef TREELINE_BASE_HASH_H
#define TREELINE_BASE_HASH_H

#include <stddef.h>
#include <stdint.h>

/* Chains: hash = hash_bytes(hash, data, size); start from 0. Lengths are mixed in. */
uint64_t hash_bytes(uint64_t hash, const void *data, size_t size);
uint64_t hash_text(uint64_t hash, const char *text); /* NULL counts as "" */
uint64_t hash_u64(uint64_t hash, uint64_t value);
uint64_t hash_double(uint64_t hash, double value); /* -0 counts as 0 */

#endif
