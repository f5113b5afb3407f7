// Packs the bytes of a serial line into marker frames, one per instruction: CR is always its last
// character. Pure; owned by one end of a connection.
#pragma once

#include <optional>
#include <vector>

#include "core/program/marker_reader.hpp"

namespace fieldcast::program {

class MarkerWriter {
 public:
  explicit MarkerWriter(Sender sender) : sender_(sender) {}

  // An instruction without its CR waits. Returns the dropped data.
  [[nodiscard]] std::vector<BrokenFrame> write(ByteView bytes, Bytes& out);
  [[nodiscard]] bool partial() const { return !instruction_.empty() || skipped_ > 0; }
  [[nodiscard]] std::optional<BrokenFrame> give_up();

 private:
  Sender sender_;
  Bytes instruction_;
  std::size_t skipped_ = 0;  // of an instruction that is too long, so far
};

}  // namespace fieldcast::program
