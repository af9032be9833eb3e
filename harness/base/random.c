/* PCG-XSH-RR 64/32 (O'Neill 2014) and splitmix64's finaliser (Steele et al. 2014). */
#include "base/random.h"

struct random random_seed(uint64_t seed, uint64_t stream)
{
    struct random random = {0, stream << 1 | 1};
    random_u32(&random);
    random.state += seed;
    random_u32(&random);
    return random;
}

uint32_t random_u32(struct random *random)
{
    uint64_t old = random->state;
    random->state = old * 6364136223846793005u + random->stream;
    uint32_t shifted = (uint32_t)(((old >> 18) ^ old) >> 27);
    uint32_t turn = (uint32_t)(old >> 59);
    return shifted >> turn | shifted << (-turn & 31);
}

float random_float(struct random *random)
{
    return (float)(random_u32(random) >> 8) * 0x1p-24f;
}

double random_double(struct random *random)
{
    uint64_t high = random_u32(random), low = random_u32(random);
    return (double)((high << 32 | low) >> 11) * 0x1p-53;
}

uint32_t random_below(struct random *random, uint32_t bound)
{
    if (bound == 0)
        return 0;
    uint64_t product = (uint64_t)random_u32(random) * bound;
    if ((uint32_t)product < bound) {
        uint32_t threshold = -bound % bound;
        while ((uint32_t)product < threshold)
            product = (uint64_t)random_u32(random) * bound;
    }
    return (uint32_t)(product >> 32);
}

uint64_t random_mix(uint64_t x)
{
    x += 0x9e3779b97f4a7c15u;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}
