// A pseudo-terminal in place of a serial adapter: a symbolic link at the path leads to
// its slave side.
//
// Owns the terminal and the link; both go with it. Never over a file that no program of ours made:
// a link is known as ours by the spelling of its target, and a living program by a socket name that
// dies with its process, so that a link left by a killed one is taken over.
#pragma once

#include <string>
#include <tl/expected.hpp>

#include "bridge/base/file_descriptor.hpp"

namespace fieldcast::sim {

class PtyPort {
 public:
  // The terminal, raw, with its link at `path`; or why not, for people.
  [[nodiscard]] static tl::expected<PtyPort, std::string> open(const std::string& path);
  PtyPort(PtyPort&&) = default;
  PtyPort& operator=(PtyPort&&) = delete;
  ~PtyPort();

  [[nodiscard]] int fd() const { return master_.get(); }                   // non-blocking
  [[nodiscard]] const std::string& terminal() const { return terminal_; }  // "/dev/pts/5"

  // A real adapter forgets exclusive use when its last user closes it; a terminal that the
  // simulator keeps open would not.
  void forget_exclusive_use();

 private:
  PtyPort() = default;
  FileDescriptor lock_, master_, slave_;
  std::string path_, terminal_;
};

}  // namespace fieldcast::sim
