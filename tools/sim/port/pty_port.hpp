// A pseudo-terminal in place of a serial adapter, with a symbolic link at the path to its slave
// side. Owns and removes both.
//
// Never replaces a foreign file: the spelling of the link's target marks our links. A bound socket
// name, which disappears with its process, shows that the link is in use.
#pragma once

#include <string>
#include <tl/expected.hpp>

#include "bridge/base/file_descriptor.hpp"

namespace fieldcast::sim {

class PtyPort {
 public:
  [[nodiscard]] static tl::expected<PtyPort, std::string> open(const std::string& path);
  PtyPort(PtyPort&&) = default;
  PtyPort& operator=(PtyPort&&) = delete;
  ~PtyPort();

  [[nodiscard]] int fd() const { return master_.get(); }                   // non-blocking
  [[nodiscard]] const std::string& terminal() const { return terminal_; }  // "/dev/pts/5"

  // Clears TIOCEXCL as a real adapter does on its last close; this terminal stays open.
  void forget_exclusive_use();

 private:
  PtyPort() = default;
  FileDescriptor lock_, master_, slave_;
  std::string path_, terminal_;
};

}  // namespace fieldcast::sim
