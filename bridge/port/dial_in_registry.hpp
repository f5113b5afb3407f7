// Where the socket of a module that dialled in goes: to the bus that is configured for its number. Any thread.
#pragma once

#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "bridge/port/file_descriptor.hpp"

namespace fieldcast {

class DialInRegistry {
 public:
  // Called on whichever thread the module came in on, or inside claim(); it only posts.
  using Deliver = std::function<void(FileDescriptor socket)>;

  // A bus is there for this number, from now on until forget().
  void expect(const std::string& number);
  void forget(const std::string& number);

  // The bus takes modules of its number, the one that waits already too, until release().
  void claim(const std::string& number, Deliver deliver);
  void release(const std::string& number);

  // A module told this number. Given back when no bus is there for it; a module that nobody takes yet waits, the newest one.
  [[nodiscard]] std::optional<FileDescriptor> offer(const std::string& number, FileDescriptor socket);

 private:
  struct Entry {
    Deliver deliver;         // of the claim, or none
    FileDescriptor waiting;  // or invalid
  };
  std::mutex mutex_;
  std::map<std::string, Entry> entries_;  // one for each bus with such a port
};

}  // namespace fieldcast
