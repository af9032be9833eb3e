/* A method built for another version of the contract; treeline must refuse it. */
#include "method/method.h"

extern const struct method old_method;
const struct method old_method = {.abi = 1, .name = "old"};
