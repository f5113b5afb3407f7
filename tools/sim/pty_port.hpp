// A pseudo-terminal in place of a serial adapter, with a symbolic link at the path to its slave
// side.
//
// Owns the terminal and the link and removes both. Never replaces a foreign file: the spelling of a
// link's target shows that this program created it. A bound socket name shows that its process is
// alive; it disappears with the process, so the link of a killed process is replaced.
#pragma once

#include <string>
#include <tl/expected.hpp>

#include "bridge/base/file_descriptor.hpp"

namespace fieldcast::sim {

class PtyPort {
 public:
  // Opens the raw terminal with its link at `path`; the error is human-readable.
  [[nodiscard]] static tl::expected<PtyPort, std::string> open(const std::string& path);
  PtyPort(PtyPort&&) = default;
  PtyPort& operator=(PtyPort&&) = delete;
  ~PtyPort();

  [[nodiscard]] int fd() const { return master_.get(); }                   // non-blocking
  [[nodiscard]] const std::string& terminal() const { return terminal_; }  // "/dev/pts/5"

  // Clears exclusive use (TIOCNXCL). A real adapter does so when its last user closes it; this
  // terminal stays open in the simulator.
  void forget_exclusive_use();

 private:
  PtyPort() = default;
  FileDescriptor lock_, master_, slave_;
  std::string path_, terminal_;
};

}  // namespace fieldcast::sim
