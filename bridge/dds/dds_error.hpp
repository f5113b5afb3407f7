// DDS could not be started, or an entity could not be made: the one exception of the DDS folders,
// caught in main.
#pragma once

#include <stdexcept>

namespace fieldcast {

class DdsError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace fieldcast
