/* cmocka with the headers it needs in front. */
#ifndef TREELINE_TESTS_TESTING_H
#define TREELINE_TESTS_TESTING_H

#include <setjmp.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#endif
