// Puts the bytes of a serial line into marker frames: one frame for each instruction, so that its
// only CR is its last character and CR FEFF is nowhere but at its end. Pure; owned by one end of a
// connection.
#pragma once

#include <optional>
#include <vector>

#include "core/program/marker_reader.hpp"

namespace fieldcast::program {

class MarkerWriter {
 public:
  explicit MarkerWriter(Sender sender) : sender_(sender) {}

  // Appends the frames that are whole to `out`; an instruction whose CR has not come waits. Gives
  // what could not be carried.
  [[nodiscard]] std::vector<BrokenFrame> write(ByteView bytes, Bytes& out);
  [[nodiscard]] bool partial() const { return !instruction_.empty() || skipped_ > 0; }
  // The rest did not come in time. Nothing when there is none.
  [[nodiscard]] std::optional<BrokenFrame> give_up();

 private:
  Sender sender_;
  Bytes instruction_;
  std::size_t skipped_ = 0;  // of an instruction that is too long, so far
};

}  // namespace fieldcast::program
