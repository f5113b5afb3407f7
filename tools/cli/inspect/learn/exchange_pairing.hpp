// Pairs the frames of one bus to exchanges: a request and what the device sent before the next one.
// Pure; owned by the reader of a capture.
#pragma once

#include <cstddef>
#include <set>
#include <vector>

#include "core/base/bytes.hpp"
#include "core/capture/capture_record.hpp"

namespace fieldcast::learn {

struct Exchange {
  Bytes request;  // empty: the device sent by itself
  Bytes response;
  friend auto operator<=>(const Exchange&, const Exchange&) = default;
};

class ExchangePairing {
 public:
  static constexpr std::size_t kMaxExchanges = 2000;  // more are only counted
  static constexpr std::size_t kMaxFrame = 4096;      // bytes; longer frames are only counted

  void take(Direction direction, ByteView frame);
  // Exchanges in the order of the capture, each different one once. No frame may follow.
  [[nodiscard]] std::vector<Exchange> finish();

  [[nodiscard]] std::size_t frames() const { return frames_; }
  [[nodiscard]] std::size_t without_response() const { return without_response_; }
  [[nodiscard]] std::size_t left_out() const { return left_out_; }  // beyond a limit

  // The adapter receives what it sends: each response began with its request, which is left out.
  [[nodiscard]] bool echoes() const { return echoes_; }

 private:
  void drop_echoes();

  std::vector<Exchange> exchanges_;
  std::set<Exchange> known_;
  Bytes request_;  // waits for its response
  bool echoes_ = false;
  std::size_t frames_ = 0, without_response_ = 0, left_out_ = 0;
};

}  // namespace fieldcast::learn
