#include "bridge/base/guarded_process.hpp"

#include <sys/prctl.h>
#include <sys/resource.h>

#include <cstdlib>
#include <string_view>

#include "bridge/base/secret.hpp"

namespace fieldcast {
namespace {

// The leak check of a sanitizer traces its own process, which needs PR_SET_DUMPABLE.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kTraced = true;
#else
constexpr bool kTraced = false;
#endif

bool dumps_are_wanted() {
  const char* wanted = std::getenv("FIELDCAST_CORE_DUMPS");
  return wanted != nullptr && std::string_view(wanted) == "1";
}

}  // namespace

void guard_memory() {
  if (dumps_are_wanted()) return;
  // The limit does not stop a core dump to a pipe in core_pattern. The flag alone does not stop one
  // to a file if fs.suid_dumpable is set.
  const rlimit none{0, 0};
  (void)::setrlimit(RLIMIT_CORE, &none);
  if (!kTraced) (void)::prctl(PR_SET_DUMPABLE, 0, 0, 0, 0);
}

std::string unguarded_memory() {
  if (!kTraced && ::prctl(PR_GET_DUMPABLE, 0, 0, 0, 0) != 0)
    return "a core dump of this process would hold its secrets (FIELDCAST_CORE_DUMPS=1)";
  if (!secrets_are_locked())
    return "secrets in memory may be written to swap: the limit of locked memory is too small; "
           "LimitMEMLOCK=8M in the service, or ulimit -l";
  return {};
}

}  // namespace fieldcast
