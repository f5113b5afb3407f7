// Thrown if DDS cannot be started or an entity cannot be created. It is the only exception of the
// DDS folders; main catches it.
#pragma once

#include <stdexcept>

namespace fieldcast {

class DdsError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace fieldcast
