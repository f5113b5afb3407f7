// An assertion that stays on: a broken rule of our own ends the process with the place named, in every build.
#pragma once

#include <cstdio>
#include <cstdlib>

#define FIELDCAST_CHECK(condition)                                                      \
  do {                                                                                  \
    if (!(condition)) [[unlikely]] {                                                    \
      std::fprintf(stderr, "%s:%d: broken rule: %s\n", __FILE__, __LINE__, #condition); \
      std::abort();                                                                     \
    }                                                                                   \
  } while (false)
