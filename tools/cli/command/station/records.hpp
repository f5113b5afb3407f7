#pragma once

#include "tools/cli/domain/connection.hpp"

namespace fieldcast::cli {

struct DevicesOptions {
  StoreSource source;
  bool json = false;
};
struct AuditOptions {
  StoreSource source;
  TimeSpan span;
  bool json = false;
};

}  // namespace fieldcast::cli
