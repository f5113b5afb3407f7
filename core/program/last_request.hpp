// The last request of an engineer's software, decoded from the bytes of a session. Pure.
#pragma once

#include <optional>
#include <string>

#include "core/base/bytes.hpp"
#include "core/base/time.hpp"
#include "core/protocol/declared/declaration.hpp"

namespace fieldcast::program {

class LastRequest {
 public:
  static constexpr std::size_t kMaxBytes = 4096;  // longer requests are not decoded

  struct Decoded {
    std::string text;  // "RD read DM, first 0100, count 0010"
    UtcTime sent_at;
  };

  // `protocol`: that of the device, or the name of `declaration`.
  LastRequest() = default;  // decodes nothing
  LastRequest(std::string protocol, declared::SharedDeclaration declaration)
      : protocol_(std::move(protocol)), declaration_(std::move(declaration)) {}

  // A request is what is sent between two responses.
  void on_sent(ByteView bytes, UtcTime at);
  void on_received();
  // Returns a request that was sent since the last call. Empty: there is none, or its bytes are no
  // frame of the protocol.
  [[nodiscard]] std::optional<Decoded> take();

 private:
  std::string protocol_;
  declared::SharedDeclaration declaration_;
  Bytes sent_;   // since the last response
  Bytes whole_;  // the last request with a response, not taken yet
  UtcTime sent_at_, whole_at_;
};

}  // namespace fieldcast::program
