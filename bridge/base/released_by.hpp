// Deleter of std::unique_ptr for an object of a C library: calls the library's function. Stateless.
#pragma once

namespace fieldcast {

template <auto release>
struct ReleasedBy {
  template <typename T>
  void operator()(T* object) const {
    release(object);
  }
};

}  // namespace fieldcast
